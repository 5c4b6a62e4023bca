"""Where bytes come from: a file, standard input, a TCP connection, UDP datagrams, a serial port. Nothing here looks into the bytes."""

from __future__ import annotations

import os
import random
import select
import socket
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Protocol
from urllib.parse import urlsplit

from navbound.errors import FormatError, InputError
from navbound.live.settings import FORMATS
from navbound.read import formats

if TYPE_CHECKING:
    from collections.abc import Iterable

CHUNK = 32 * 1024
"""Bytes that are read at once. [B]"""
_RETRY_FIRST_S, _RETRY_MOST_S = 0.5, 30.0
_CONNECT_S = 5.0
_LEAST_BAUD, _USUAL_BAUD = 1200, 115_200


class Source(Protocol):
    """Bytes in pieces.

    Attributes
    ----------
    live : bool
        Whether the time at which bytes arrive means something.
    """

    live: bool

    @property
    def size(self) -> int | None:
        """Its bytes, where it has an end that is known. [B]."""
        ...

    @property
    def up(self) -> bool:
        """Whether the connection is there."""
        ...

    def read(self, timeout_s: float) -> bytes | None:
        """The next bytes; b"" where none came in time; None at the end."""
        ...

    def skip(self, n_bytes: int) -> None:
        """Leave out what was read by a session before."""
        ...

    def close(self) -> None:
        """Give it back."""
        ...


class File:
    """A file: its bytes have no time of arrival."""

    live = False
    up = True

    def __init__(self, path: Path, chunk: int = CHUNK) -> None:
        self._chunk = chunk
        try:
            self._file = path.open("rb")
        except OSError as e:
            raise FormatError(path, f"cannot be opened: {e.strerror}; a source is {SOURCES}") from e
        # Peeking takes nothing from a pipe.
        packing = formats.of(self._file.peek(64), path.name)
        if packing.holds == ("packed",):
            self._file.close()
            raise FormatError(path, f"is packed ({packing.title}); unpack it first: live reads the bytes of a source as they are")
        self.size: int | None = path.stat().st_size if path.is_file() else None

    def read(self, timeout_s: float) -> bytes | None:
        """Take the next bytes: as :class:`Source` says."""
        del timeout_s
        return self._file.read(self._chunk) or None

    def skip(self, n_bytes: int) -> None:
        """Leave out what was read by a session before."""
        self._file.seek(n_bytes)

    def begins_with(self, parts: Iterable[bytes]) -> bool:
        """Whether the file begins with these bytes."""
        self._file.seek(0)
        return all(self._file.read(len(part)) == part for part in parts)

    def close(self) -> None:
        """Give it back."""
        self._file.close()


class Pipe:
    """What another program writes: standard input, or a pipe that has a name."""

    live = True
    up = True
    size: int | None = None

    def __init__(self, path: Path | None = None) -> None:
        self._own = None if path is None else path.open("rb", buffering=0)
        self._descriptor = (self._own or sys.stdin).fileno()

    def read(self, timeout_s: float) -> bytes | None:
        """Take the next bytes: as :class:`Source` says."""
        if not select.select([self._descriptor], [], [], timeout_s)[0]:
            return b""
        return os.read(self._descriptor, CHUNK) or None

    def skip(self, n_bytes: int) -> None:
        """What was read is gone from a pipe."""

    def close(self) -> None:
        """Give a pipe back; standard input belongs to the process."""
        if self._own is not None:
            self._own.close()


class _Line:
    """Something with a descriptor that is opened again for ever once it was there."""

    live = True
    size: int | None = None

    def __init__(self) -> None:
        self._wait_s, self._next_s = _RETRY_FIRST_S, 0.0
        self._jitter = random.Random()
        self._descriptor: int | None = self._opened()

    def _opened(self) -> int:
        """Open it: a descriptor, which `_Line` closes.

        Raises
        ------
        OSError
            It is not there.
        """
        raise NotImplementedError

    @property
    def up(self) -> bool:
        """Whether the connection is there."""
        return self._descriptor is not None

    def read(self, timeout_s: float) -> bytes | None:
        """Take the next bytes: as :class:`Source` says."""
        if self._descriptor is None:
            self._again(timeout_s)
            return b""
        try:
            if not select.select([self._descriptor], [], [], timeout_s)[0]:
                return b""
            data = os.read(self._descriptor, CHUNK)
        except OSError:
            data = b""
        if not data:
            self.close()
            self._next_s = time.monotonic()
        return data

    def _again(self, timeout_s: float) -> None:
        wait_s = self._next_s - time.monotonic()
        if wait_s > 0:
            time.sleep(min(wait_s, timeout_s))
            return
        try:
            self._descriptor = self._opened()
            self._wait_s = _RETRY_FIRST_S
        except OSError:
            self._next_s = time.monotonic() + self._wait_s * self._jitter.uniform(0.8, 1.2)
            self._wait_s = min(2 * self._wait_s, _RETRY_MOST_S)

    def skip(self, n_bytes: int) -> None:
        """A connection begins where it begins."""

    def close(self) -> None:
        """Give it back."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


class Tcp(_Line):
    """A connection."""

    def __init__(self, host: str, port: int) -> None:
        self._address = (host, port)
        try:
            super().__init__()
        except OSError as e:
            what = f"cannot be reached: {e.strerror or e}; start what sends there, or check host and port"
            raise FormatError(f"tcp://{host}:{port}", what) from e

    def _opened(self) -> int:
        return socket.create_connection(self._address, _CONNECT_S).detach()


class Serial(_Line):
    """A serial port, eight bits without parity; nothing is written to it."""

    def __init__(self, device: str, baud: int) -> None:
        self._device, self._baud = device, baud
        speed = _speeds().get(baud)
        if speed is None:
            raise InputError("source", f"baud={baud}", domain=f"speeds of a serial port: {', '.join(map(str, sorted(_speeds())))}")
        self._speed = speed
        try:
            super().__init__()
        except OSError as e:
            what = f"cannot be opened: {e.strerror or e}; check the device, and that you may read it"
            raise FormatError(f"serial://{device}", what) from e

    def _opened(self) -> int:
        import fcntl  # noqa: PLC0415 - there are no serial ports of this kind on every system
        import termios  # noqa: PLC0415

        descriptor = os.open(self._device, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
        try:
            fcntl.ioctl(descriptor, termios.TIOCEXCL)
            settings = termios.tcgetattr(descriptor)
            # No translation of any kind, no signals, eight bits, the line of the modem ignored.
            settings[0] = settings[1] = settings[3] = 0
            settings[2] = termios.CS8 | termios.CREAD | termios.CLOCAL
            settings[4] = settings[5] = self._speed
            termios.tcsetattr(descriptor, termios.TCSANOW, settings)
        except termios.error as e:
            os.close(descriptor)
            raise OSError(*e.args[:2]) from e
        except OSError:
            os.close(descriptor)
            raise
        return descriptor


def _speeds() -> dict[int, int]:
    """Speeds of serial ports of this system by their number; nothing where it has no such ports. [baud]."""
    try:
        import termios  # noqa: PLC0415 - see above
    except ImportError:
        return {}
    return {
        int(name[1:]): value
        for name, value in vars(termios).items()
        if name[0] == "B" and name[1:].isdigit() and int(name[1:]) >= _LEAST_BAUD
    }


class Udp:
    """Datagrams to a port of this host; each ends a line."""

    live = True
    up = True
    size: int | None = None

    def __init__(self, host: str, port: int, *, lines: bool) -> None:
        self._lines = lines
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((host, port))
        except OSError as e:
            raise FormatError(f"udp://{host}:{port}", f"cannot be listened on: {e.strerror or e}; choose an address of this host") from e

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return int(self._socket.getsockname()[1])

    def read(self, timeout_s: float) -> bytes | None:
        """Take the next bytes: as :class:`Source` says."""
        if not select.select([self._socket], [], [], timeout_s)[0]:
            return b""
        data = self._socket.recv(65_535)
        return data + b"\n" if self._lines and not data.endswith(b"\n") else data

    def skip(self, n_bytes: int) -> None:
        """Datagrams that were read are gone."""

    def close(self) -> None:
        """Give it back."""
        self._socket.close()


HEARD = "-, tcp://host:port, udp://host:port or serial:///dev/ttyACM0?baud=115200"
SOURCES = "a file, -, tcp://host:port, udp://host:port or serial:///dev/ttyACM0?baud=115200"


def is_pipe(name: str) -> bool:
    """Whether a source is standard input or a pipe: what is read of it is gone."""
    try:
        return name == "-" or ("://" not in name and Path(name).is_fifo())
    except (OSError, ValueError):
        return False


def is_stream(name: str) -> bool:
    """Whether the time at which bytes of a source arrive means something; nothing is looked at before they are judged."""
    return "://" in name or is_pipe(name)


def open_source(name: str, *, lines: bool = False, undated: bool = False, chunk: int = CHUNK) -> Source:
    """Open a source.

    Parameters
    ----------
    name : str
        A file, a run directory, ``-`` for standard input, ``tcp://host:port``, ``udp://host:port`` or ``serial:///dev/ttyACM0?baud=115200``.
    lines : bool
        Whether it sends lines of text.
    undated : bool
        Whether what it sends has no time but that of its arrival: nothing of a file does.
    chunk : int
        Bytes that are read of a file at once. [B]

    Raises
    ------
    FormatError
        It cannot be opened.
    InputError
        Not the name of a source.
    """
    if name == "-":
        return Pipe()
    if is_pipe(name):
        return Pipe(Path(name))
    if "://" not in name:
        if undated:
            raise InputError("source", name, domain=f"{HEARD}: these messages have no time but that of their arrival, which a file lacks")
        if not Path(name).is_dir():
            return File(Path(name), chunk)
        from navbound.live.recording import Recording  # noqa: PLC0415  (workers read no run, and a library of tables takes memory of each)

        return Recording(Path(name), chunk)
    try:
        parts = urlsplit(name)
        host, port = parts.hostname, parts.port
    except ValueError as e:
        raise InputError("source", name, domain=SOURCES) from e
    if parts.scheme == "serial" and not host and parts.path.startswith("/"):
        return Serial(parts.path, _baud(name, parts.query))
    if parts.scheme not in {"tcp", "udp"} or not host or port is None:
        raise InputError("source", name, domain=SOURCES)
    return Tcp(host, port) if parts.scheme == "tcp" else Udp(host, port, lines=lines)


def _baud(name: str, query: str) -> int:
    if not query:
        return _USUAL_BAUD
    key, _, value = query.partition("=")
    if key != "baud" or not (value.isascii() and value.isdigit() and len(value) <= 8):
        raise InputError("source", name, domain="serial:///dev/ttyACM0?baud=115200: a device of this host and its speed")
    return int(value)


def format_of(name: str) -> str | None:
    """What a file holds, by its first bytes; None where that is not seen.

    Raises
    ------
    InputError
        It holds something that is not judged as it arrives.
    """
    if Path(name).is_dir():
        return "json"
    try:
        with Path(name).open("rb") as file:
            start = file.read(1 << 16)
    except OSError:
        return None
    known = formats.of(start)
    if known.id in FORMATS:
        return known.id
    if known.id != "csv" and "packed" not in known.holds:
        otherwise = "which navbound analyze reads" if known.instead is None else f"which is not read: {known.instead}"
        raise InputError("source", name, domain=f"{', '.join(FORMATS)}; this is {known.title}, {otherwise}")
    return None
