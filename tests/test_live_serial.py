"""A serial port, played by a pseudo-terminal: every byte arrives, a pulled plug is an event, and nothing is sent."""

from __future__ import annotations

import json
import os
import pty
import select
import threading
import time
from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from display_fixture import SETTINGS, WHOLE
from navbound import live
from navbound.errors import FormatError, InputError
from navbound.live import source
from navbound.live.session import now_ns
from navbound.live.source import Serial, open_source

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture
def port() -> Iterator[tuple[int, str]]:
    """The far end of a line, and the name of the device at this end."""
    far, near = pty.openpty()
    name = os.ttyname(near)
    os.close(near)
    yield far, name
    os.close(far)


def read(serial: source.Source, n_bytes: int) -> bytes:
    """So many bytes, in at most five seconds."""
    content, until = b"", time.monotonic() + 5.0
    while len(content) < n_bytes and time.monotonic() < until:
        content += serial.read(0.05) or b""
    return content


def test_every_byte_arrives_as_it_was_sent(port: tuple[int, str]) -> None:
    """All 256 values: line ends, control characters and flow control are bytes like others."""
    far, name = port
    with closing(open_source(f"serial://{name}?baud=115200")) as serial:
        assert serial.live
        assert serial.up
        sent = bytes(range(256)) * 8
        for k in range(0, len(sent), 512):
            os.write(far, sent[k : k + 512])
            assert read(serial, 512) == sent[k : k + 512]
        assert serial.read(0.0) == b""
        # Nothing was echoed or answered.
        assert not select.select([far], [], [], 0.1)[0]


def test_a_pulled_plug_is_down_and_comes_back(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(source, "_RETRY_FIRST_S", 0.01)
    far, near = pty.openpty()
    link = tmp_path / "ttyACM0"
    link.symlink_to(os.ttyname(near))
    os.close(near)
    with closing(Serial(str(link), 9600)) as serial:
        os.write(far, b"abc")
        assert read(serial, 3) == b"abc"
        os.close(far)
        link.unlink()
        until = time.monotonic() + 5.0
        while serial.up and time.monotonic() < until:
            assert serial.read(0.05) == b""
        assert not serial.up
        assert serial.read(0.02) == b""
        far, near = pty.openpty()
        link.symlink_to(os.ttyname(near))
        os.close(near)
        while not serial.up and time.monotonic() < until:
            serial.read(0.05)
        assert serial.up
        os.write(far, b"again")
        assert read(serial, 5) == b"again"
    os.close(far)


def test_a_session_on_a_serial_port_judges_what_arrives(port: tuple[int, str], tmp_path: Path) -> None:
    far, name = port
    session = live.Session(tmp_path / "out", SETTINGS, origin=live.Origin("live", name))
    n_sent, stop = 30, threading.Event()

    def send() -> None:
        for _ in range(n_sent):
            line = json.dumps({"v": 1, "track": "F1", "time_ns": now_ns(), **WHOLE, "fte_m": 2000.0}) + "\n"
            os.write(far, line.encode())
            time.sleep(0.05)
        time.sleep(0.5)
        stop.set()

    thread = threading.Thread(target=send)
    thread.start()
    session.run(open_source(f"serial://{name}"), stop=stop.is_set)
    thread.join()
    assert session.n_epochs == n_sent
    kinds = {json.loads(line)["kind"] for line in (tmp_path / "out" / "events.jsonl").read_text().splitlines()}
    assert "warning" in kinds


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("serial:///dev/none-such", "cannot be opened: No such file or directory"),
        ("serial:///dev/null", "cannot be opened"),
        ("serial://host/dev/x", "a file, -, tcp://host:port"),
        ("serial:///dev/ttyS0?baud=12", "speeds of a serial port: 1200"),
        ("serial:///dev/ttyS0?baud=x", "a device of this host and its speed"),
        ("serial:///dev/ttyS0?parity=e", "a device of this host and its speed"),
        ("serial:", "cannot be opened"),
    ],
)
def test_what_is_no_serial_port_is_refused(name: str, says: str) -> None:
    with pytest.raises((FormatError, InputError)) as refusal:
        open_source(name)
    assert says in str(refusal.value)
