"""A session that a test feeds by hand, and requests to its display as a hostile program would write them."""

from __future__ import annotations

import asyncio
import json
import re
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from navbound import _core, live
from navbound.live.display import Options, Server, Watch
from navbound.live.session import now_ns

# Alerts end sooner than by default, so that a test sees several.
SETTINGS = live.Settings(format="json", rnp_m=555.6, method="tse-exact", sample_period_s=0.1, clear_delay_s=5.0, clear_ratio=0.9)
"""Ten positions a second; stale after two seconds."""
WHOLE = {
    "est_lat_rad": 0.85,
    "est_lon_rad": 0.04,
    "est_h_m": 500.0,
    "fte_m": 20.0,
    "fte_v_m": -4.0,
    "course_rad": 1.0,
    "ground_speed_mps": 0.0,
    "cov_ee_m2": 25.0,
    "cov_en_m2": 0.0,
    "cov_nn_m2": 9.0,
    "cov_eu_m2": 0.0,
    "cov_nu_m2": 0.0,
    "cov_uu_m2": 64.0,
    "hpl_m": 18.0,
    "vpl_m": 27.0,
    "hal_m": 40.0,
    "val_m": 35.0,
    "n_sv": 9,
    "nav_mode": "gnss",
}


class Fed:
    """A live session; each position arrives when it is given."""

    def __init__(self, folder: Path, settings: live.Settings = SETTINGS, origin: live.Origin | None = None) -> None:
        self.folder, self.settings = folder, settings
        self.reported: list[dict[str, Any]] = []
        self.ended = False
        origin = origin or live.Origin("live", "tcp://192.0.2.1:2000")
        self.session = live.Session(folder, settings, origin=origin, report=self.reported.append)

    def position(self, track: str = "F1", time_ns: int | None = None, **values: Any) -> None:
        """One position of now. A value that is None is left out."""
        time = now_ns() if time_ns is None else time_ns
        fields = {name: value for name, value in {**WHOLE, **values}.items() if value is not None}
        line = json.dumps({"v": 1, "track": track, "time_ns": time, **fields}) + "\n"
        self.session.take(_core.live_input("chunk", now_ns(), line.encode()))

    def heartbeat(self) -> None:
        """The reader is alive."""
        self.session.take(_core.live_input("heartbeat", now_ns(), b""))

    def end(self) -> None:
        """The source has ended."""
        self.session.finish()
        self.ended = True

    def close(self) -> None:
        """Leave the folder as a killed session would."""
        if not self.ended:
            self.session.close()
            self.ended = True


@contextmanager
def served(folder: Path) -> Iterator[Server]:
    """A display of a folder in this process."""
    server, stop = Server(Watch(folder), Options()), threading.Event()
    thread = threading.Thread(target=lambda: asyncio.run(server.run(stop.is_set)))
    thread.start()
    try:
        yield server
    finally:
        stop.set()
        thread.join(20)
        assert not thread.is_alive()


@dataclass
class Answer:
    """What came back."""

    status: int
    headers: dict[str, str]
    body: str


@dataclass
class Browser:
    """Requests to a display, with the cookie of a session where one was begun."""

    server: Server
    cookie: str = ""
    host: str = field(init=False)

    def __post_init__(self) -> None:
        self.host = f"127.0.0.1:{self.server.port}"

    def raw(self, data: bytes, timeout_s: float = 10.0) -> Answer:
        """Bytes as they are, until the server closes."""
        with socket.create_connection(("127.0.0.1", self.server.port), timeout_s) as line:
            line.sendall(data)
            return self.read(line)

    @staticmethod
    def read(line: socket.socket) -> Answer:
        """One answer."""
        received = b""
        while part := line.recv(65536):
            received += part
        head, _, body = received.decode().partition("\r\n\r\n")
        first, *lines = head.split("\r\n")
        return Answer(int(first.split()[1]), {k.lower(): v for k, v in (x.split(": ", 1) for x in lines)}, body)

    def text(self, method: str, path: str, body: str = "", **headers: str | None) -> bytes:
        """A request as our own page sends it; a header that is None is left out, another replaces ours."""
        own = {"Host": self.host, "Origin": f"http://{self.host}" if method == "POST" else None, "Cookie": self.cookie or None}
        own |= {"Content_Length": str(len(body)) if body else None} | headers
        lines = "".join(f"{name.replace('_', '-')}: {value}\r\n" for name, value in own.items() if value is not None)
        return f"{method} {path} HTTP/1.1\r\n{lines}\r\n{body}".encode()

    def ask(self, method: str, path: str, body: str = "", **headers: str | None) -> Answer:
        """One request, answered whole."""
        return self.raw(self.text(method, path, body, **headers))

    def begin(self) -> Browser:
        """Buy a session with the token."""
        answer = self.ask("POST", "/session", json.dumps({"token": self.server.door.token}))
        assert answer.status == 204
        self.cookie = answer.headers["set-cookie"].split(";")[0]
        return self

    @contextmanager
    def stream(self, query: str = "") -> Iterator[Stream]:
        """The events of a page."""
        with socket.create_connection(("127.0.0.1", self.server.port), 10.0) as line:
            line.sendall(self.text("GET", f"/events{query}"))
            yield Stream(line)


class Stream:
    """Server-sent events as they come."""

    def __init__(self, line: socket.socket) -> None:
        self.line, self._left = line, b""
        self.head = self._until(b"\r\n\r\n").decode()
        self.status = int(self.head.split()[1])

    def _until(self, end: bytes) -> bytes:
        while end not in self._left:
            part = self.line.recv(65536)
            if not part:
                raise EOFError
            self._left += part
        part, _, self._left = self._left.partition(end)
        return part

    def next(self, name: str) -> dict[str, Any]:
        """The next event of a name."""
        while True:
            text = self._until(b"\n\n").decode()
            match = re.fullmatch(r"event: (\w+)\ndata: (.*)", text)
            if match and match[1] == name:
                return dict(json.loads(match[2]))


class Feeder:
    """Feeds a session ten times a second in a thread of its own."""

    def __init__(self, fed: Fed, period_s: float = 0.1) -> None:
        self.fed, self.period_s = fed, period_s
        self.values: dict[str, Any] = {}
        self.positions = self.heartbeats = True
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        turn = 0
        while not self._stop.wait(self.period_s):
            turn += 1
            if self.positions:
                self.fed.position(**self.values)
            if self.heartbeats and turn % 5 == 0:
                self.fed.heartbeat()

    def __enter__(self) -> Feeder:
        """Begin."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End."""
        self._stop.set()
        self._thread.join()
