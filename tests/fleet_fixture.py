"""Fleets for tests: what carries them, a server of NATS on this host, and the fleet that misbehaves on purpose as a feeder writes it."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

from live_fixture import FLEET, Sent
from navbound import _core, live
from navbound.live.fleet import Feeder, Worker, connect, create
from navbound.live.fleet.brokers import shared
from navbound.live.fleet.reading import records
from navbound.live.fleet.transport import Transport

RECORD: dict[str, Any] = {"settings": asdict(FLEET), "origin": {"kind": "recording", "source": "a test", "speed": 0.0}}


def server_binary() -> str:
    """The server of NATS that the lock file brings; without it a test is skipped aloud."""
    entry = shutil.which("nats-server", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))
    if entry is None:
        pytest.skip("SKIPPED ALOUD: no nats-server; uv sync brings one")
    return entry


class Server:
    """A server of NATS with a private folder, on this host alone."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._binary = folder, server_binary()
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = int(free.getsockname()[1])
        self.begin()

    def begin(self) -> None:
        """Start it, and wait until it answers."""
        log = self._folder / "nats.log"
        options = ["-a", "127.0.0.1", "-p", str(self.port), "-js", "-sd", str(self._folder / "store"), "-l", str(log)]
        self.process = subprocess.Popen([self._binary, *options])
        until = time.monotonic() + 30.0
        while time.monotonic() < until:
            try:
                socket.create_connection(("127.0.0.1", self.port), 0.2).close()
                return
            except OSError:
                time.sleep(0.05)
        pytest.fail(f"nats-server does not answer: {log.read_text() if log.exists() else 'no log'}")

    def kill(self) -> None:
        """End it as a power failure would."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def name(self, fleet: str) -> str:
        """Of a fleet on it."""
        return f"nats://127.0.0.1:{self.port}/{fleet}"


@contextmanager
def serving(folder: Path) -> Iterator[Server]:
    """A server for a while."""
    folder.mkdir(parents=True, exist_ok=True)
    server, before = Server(folder), shared.MOST_BYTES
    # A server sets aside what a log may take, and a test has many fleets.
    shared.MOST_BYTES = 16 << 20
    try:
        yield server
    finally:
        shared.MOST_BYTES = before
        server.process.kill()
        server.process.wait()


class Lines:
    """A recording of lines, some at a time."""

    live = False
    size: int | None = None
    up = True

    def __init__(self, sent: tuple[Sent, ...], per_piece: int = 100) -> None:
        self._pieces = ["".join(line for _, line in sent[k : k + per_piece]).encode() for k in range(0, len(sent), per_piece)]

    def read(self, timeout_s: float) -> bytes | None:
        del timeout_s
        return self._pieces.pop(0) if self._pieces else None

    def skip(self, n_bytes: int) -> None:
        """Nothing was read before."""

    def close(self) -> None:
        """Nothing is open."""


def fed(transport: Transport, sent: tuple[Sent, ...], spool: Transport | None = None) -> None:
    """Feed a fleet, through a spool where one is given."""
    feeder = Feeder(spool or transport, live.Settings(**transport.record["settings"]), target=None if spool is None else transport)
    feeder.run(Lines(sent))


def worked(transport: Transport) -> Worker:
    """Judge everything that was fed."""
    worker = Worker(transport)
    worker.run(finishing=lambda: True)
    return worker


def reported(name: str) -> list[dict[str, Any]]:
    """Every transition of a fleet, as somebody else reads them."""
    with connect(name) as transport:
        return list(records(transport, stop=lambda: False, follow=False))


def outputs(transport: Transport) -> list[list[tuple[int, bytes]]]:
    """Outputs of each lane, whatever was written at once and when."""
    entry = []
    for lane in range(transport.n_lanes):
        log, content = transport.went_out(lane), b""
        while len(content) < log.end():
            content += log.read(len(content))
        entry.append(_core.live_comparable(content))
    return entry


def made(name: str, n_lanes: int = 3) -> Any:
    return create(name, RECORD, n_lanes)
