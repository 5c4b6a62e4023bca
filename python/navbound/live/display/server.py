"""The server of the display: this host only, one stream of server-sent events a page, and nothing that reaches the monitor."""

from __future__ import annotations

import asyncio
import contextlib
import json
import socket
import time
from dataclasses import dataclass
from http import HTTPStatus
from importlib.resources import files
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs

from navbound import __version__
from navbound.errors import FormatError, InputError
from navbound.live import journal
from navbound.live.display import hub, request
from navbound.live.display.request import RefusedError
from navbound.live.display.watch import Watch
from navbound.live.session import now_ns
from navbound.live.sinks import metrics

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

TICK_S = 0.1
"""Period of the pages. [s]"""
STATUS_S = 0.5
"""Longest time between two words to a page: it takes two seconds of silence for a lost link. [s]"""
WRITE_HIGH, SEND_BUFFER = 64 * 1024, 128 * 1024
UNSENT_MS = 10_000
"""Time after which the system gives up a connection that takes nothing. [ms]"""

PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>navbound live</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="/live.css">
</head>
<body>
<noscript>This page shows nothing without scripts. Nothing is monitored on this screen.</noscript>
<main id="display"></main>
<script src="/live.js"></script>
</body>
</html>
"""


@dataclass(frozen=True)
class Options:
    """How the display is served.

    Attributes
    ----------
    port : int
        Of this host; 0: one that is free.
    """

    port: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.port <= 65_535:
            raise InputError("port", self.port, "1", "[0, 65535]")


class Server:
    """The display of one session.

    Parameters
    ----------
    watch : Watch
        Its journals.
    options : Options
        How.
    """

    def __init__(self, watch: Watch, options: Options) -> None:
        self.watch, self.hub = watch, hub.Hub()
        self._sockets = _listening(options.port)
        self.port = int(self._sockets[0].getsockname()[1])
        self.door = request.Door(self.port)
        self._files = _files()
        self._tasks: set[asyncio.Task[None]] = set()

    @property
    def address(self) -> str:
        """Where a browser finds it. What follows the # is not sent: it stays in the browser."""
        return f"http://127.0.0.1:{self.port}/#{self.door.token}"

    async def run(self, stop: Callable[[], bool]) -> None:
        """Serve until `stop`."""
        servers = [await asyncio.start_server(self._connected, sock=each, limit=request.MOST_HEAD) for each in self._sockets]
        sent = 0.0
        try:
            while not stop():
                news = self.watch.poll()
                now = time.monotonic()
                if news or now - sent >= STATUS_S:
                    sent = now
                    self._tell(news.rows, news.transitions)
                self.hub.drop_silent(now)
                if not self.watch.behind:
                    await asyncio.sleep(TICK_S)
                else:
                    await asyncio.sleep(0)
        finally:
            for server in servers:
                server.close()
            for client in list(self.hub.clients.values()):
                client.close()
            for task in list(self._tasks):
                task.cancel()

    def _tell(self, rows: dict[str, list[Any]], transitions: list[dict[str, Any]]) -> None:
        for each in transitions:
            self.hub.tell("alert", each)
        status = self.watch.status() | {"tracks": list(self.watch.tracks)}
        for client in self.hub.clients.values():
            if client.track is None:
                client.track = next(iter(self.watch.tracks), None)
            client.show(rows.get(client.track or "", []), status | {"track": client.track})

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        if task is not None:
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
        peer = writer.get_extra_info("peername")
        try:
            query = await request.read(reader)
            self.door.check(query, str(peer[0]) if peer else "")
            await self._answer(query, reader, writer)
        except RefusedError as e:
            with contextlib.suppress(OSError):
                writer.write(request.answer(e.status))
                async with asyncio.timeout(request.REQUEST_S):
                    await writer.drain()
        except (OSError, TimeoutError, asyncio.CancelledError):
            pass
        finally:
            writer.close()
            with contextlib.suppress(OSError, TimeoutError, asyncio.CancelledError):
                async with asyncio.timeout(request.REQUEST_S):
                    await writer.wait_closed()
            # What a page does not take is given up.
            writer.transport.abort()

    async def _answer(self, query: request.Request, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        post = {"/session": self._begin, "/alive": self._alive, "/acknowledge": self._acknowledge}
        if query.method == "POST" and query.path in post:
            writer.write(post[query.path](query))
        elif query.method != "GET":
            raise RefusedError(HTTPStatus.METHOD_NOT_ALLOWED)
        elif query.path in self._files:
            body, kind = self._files[query.path]
            writer.write(request.answer(HTTPStatus.OK, body, kind))
        elif query.path == "/health":
            status, body = self._health()
            writer.write(request.answer(status, body, "application/json"))
        elif query.path == "/metrics":
            body = self.watch.metrics(len(self.hub.clients)).encode()
            writer.write(request.answer(HTTPStatus.OK, body, metrics.KIND))
        elif query.path == "/session":
            self.door.session(query)
            writer.write(request.answer(HTTPStatus.NO_CONTENT))
        elif query.path == "/events":
            self.door.session(query)
            await self._stream(query, reader, writer)
            return
        else:
            raise RefusedError(HTTPStatus.NOT_FOUND)
        async with asyncio.timeout(request.REQUEST_S):
            await writer.drain()

    def _begin(self, query: request.Request) -> bytes:
        token = query.json().get("token")
        return request.answer(HTTPStatus.NO_CONTENT, extra=self.door.open(token if isinstance(token, str) else ""))

    def _alive(self, query: request.Request) -> bytes:
        self.door.session(query)
        client = self.hub.clients.get(_whole(query.json().get("client")))
        if client is None:
            raise RefusedError(HTTPStatus.NOT_FOUND)
        client.alive_s = time.monotonic()
        return request.answer(HTTPStatus.NO_CONTENT)

    def _acknowledge(self, query: request.Request) -> bytes:
        number = self.door.session(query)
        alert = query.json().get("alert")
        if not isinstance(alert, str) or alert not in self.watch.open:
            raise RefusedError(HTTPStatus.NOT_FOUND)
        if alert not in self.watch.acknowledged:
            record = {"alert": alert, "acknowledged_ns": now_ns(), "session": number}
            try:
                with (self.watch.folder / journal.ACKNOWLEDGED).open("a", encoding="utf-8") as file:
                    file.write(json.dumps(record, separators=(",", ":")) + "\n")
            except OSError as e:
                raise RefusedError(HTTPStatus.INSUFFICIENT_STORAGE) from e
            self.watch.acknowledged.add(alert)
            self.hub.tell("acknowledged", {"alert": alert})
        return request.answer(HTTPStatus.NO_CONTENT)

    def _health(self) -> tuple[HTTPStatus, bytes]:
        status = self.watch.status()
        lost = status["feed"] == "lost"
        stale = not status["ages_s"] or min(status["ages_s"].values()) > self.watch.stale_s()
        word = "lost" if lost else "degraded" if stale or self.watch.open else "ok"
        last = self.watch.events[-1]["key"] if self.watch.events else None
        record = {"status": word, "age_s": min(status["ages_s"].values(), default=None), "last_alert": last, "version": __version__}
        return (HTTPStatus.SERVICE_UNAVAILABLE if lost else HTTPStatus.OK), json.dumps(record).encode()

    async def _stream(self, query: request.Request, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            requested = parse_qs(query.query, max_num_fields=4).get("track", [None])[0]
        except ValueError as e:
            raise RefusedError(HTTPStatus.BAD_REQUEST) from e
        client = self.hub.enter(requested if requested in self.watch.tracks else None, time.monotonic())
        if client is None:
            raise RefusedError(HTTPStatus.SERVICE_UNAVAILABLE)
        _narrow(writer)
        gone = asyncio.ensure_future(reader.read(1))
        gone.add_done_callback(lambda _: client.close())
        try:
            snapshot = self.watch.snapshot(client.track)
            client.track = snapshot["track"]
            writer.write(request.head(HTTPStatus.OK, "text/event-stream; charset=utf-8", None))
            writer.write(b"retry: 1000\n\n" + hub.event("snapshot", {"client": client.number, **snapshot}))
            while True:
                # A page that takes nothing ends here: it gives no sign of life either.
                drained = asyncio.ensure_future(writer.drain())
                while not drained.done() and not client.closed:
                    await asyncio.wait({drained}, timeout=TICK_S)
                if client.closed:
                    drained.cancel()
                    break
                drained.result()
                if data := await client.take():
                    writer.write(data)
        finally:
            gone.cancel()
            self.hub.leave(client)
            writer.transport.abort()


def _whole(value: Any) -> int:
    return value if isinstance(value, int) else 0


def _files() -> dict[str, tuple[bytes, str]]:
    """Everything that is served, made at the start: no path of a request reaches a file system."""
    web = files("navbound").joinpath("_web")
    script, sheet = "text/javascript; charset=utf-8", "text/css; charset=utf-8"
    return {
        "/": (PAGE.encode(), "text/html; charset=utf-8"),
        "/live.js": (web.joinpath("live.js").read_bytes(), script),
        "/clock.js": (web.joinpath("clock.js").read_bytes(), script),
        "/live.css": (web.joinpath("live.css").read_bytes(), sheet),
    }


def _listening(port: int) -> list[socket.socket]:
    """Sockets of this host alone: IPv4, and IPv6 where there is one."""
    try:
        first = _bound(socket.AF_INET, "127.0.0.1", port)
    except OSError as e:
        raise FormatError(f"http://127.0.0.1:{port}", f"cannot be listened on: {e.strerror or e}; choose another --port") from e
    sockets = [first]
    with contextlib.suppress(OSError):
        sockets.append(_bound(socket.AF_INET6, "::1", int(first.getsockname()[1])))
    return sockets


def _bound(family: socket.AddressFamily, host: str, port: int) -> socket.socket:
    made = socket.socket(family, socket.SOCK_STREAM)
    try:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:
            made.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        made.bind((host, port))
        # Who reads the address may ask at once.
        made.listen()
    except OSError:
        made.close()
        raise
    return made


def _narrow(writer: asyncio.StreamWriter) -> None:
    """Let little wait in buffers that nobody sees."""
    writer.transport.set_write_buffer_limits(high=WRITE_HIGH)
    line = writer.get_extra_info("socket")
    line.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
    line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    if hasattr(socket, "TCP_USER_TIMEOUT"):
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNSENT_MS)


def serve(folder: Path, options: Options, *, ready: Callable[[Server], None], stop: Callable[[], bool]) -> None:
    """Show the session in a folder until `stop`.

    Parameters
    ----------
    folder : Path
        Of a session that runs, or ran.
    options : Options
        How.
    ready : callable
        Takes the server once it listens.
    stop : callable
        Called every tenth of a second.

    Raises
    ------
    FormatError
        Not the folder of a session, or the port is taken.
    """
    server = Server(Watch(folder), options)
    ready(server)
    asyncio.run(server.run(stop))


def beside(folder: Path, options: Options, ready: Callable[[str], None], say: Callable[[str], None], stop: Callable[[], bool]) -> None:
    """:func:`serve` in a process beside a session."""
    del say  # a display speaks on its pages
    serve(folder, options, ready=lambda server: ready(server.address), stop=stop)
