"""What transports of brokers have in common: how a fleet is begun and joined, who works on which lane, and messages of several parts."""

from __future__ import annotations

import contextlib
import hashlib
import json
import re
import struct
import time
import uuid
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Self
from urllib.parse import urlsplit

from navbound.errors import FormatError, InputError
from navbound.live.fleet.brokers import processes
from navbound.live.fleet.brokers.numbered import MOST_PAYLOAD
from navbound.live.fleet.transport import WAIT_S, UnreachableError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from navbound.live.fleet.brokers.numbered import NumberedLog

CONNECT_S = 3.0
ANSWER_S = 5.0
LEASE_S = 4.0
"""Time without a renewal after which a lane's worker counts as gone, by the clock of who looks. [s]"""
MOST_BYTES = 256 << 20
"""Bytes of a log that the broker keeps; the oldest go first. [B]"""
MOST_SHOWN = 64
"""Messages of states of a lane that wait for who shows them."""
_LENGTH = struct.Struct("<I")
_DIGEST_B = hashlib.sha256().digest_size


class Broker(ABC):
    """A fleet on a broker.

    Parameters
    ----------
    name : str
        As `navbound.live.fleet.transport.connect` takes it.
    port : int
        Where the name says none.
    """

    hint = ""
    """How a broker is started, for who has none."""

    def __init__(self, name: str, port: int) -> None:
        self._server, self._fleet, self.name = _parts(name, port)
        self.record: dict[str, Any] = {}
        self.n_lanes = 0
        self._me = uuid.uuid4().hex
        self._mark = f"{self._me} {processes.mark()}".encode()
        self._leases: dict[int, int] = {}
        self._fences: dict[int, tuple[int, int]] = {}
        self._seen: dict[str, tuple[int, float]] = {}
        self._counted = False

    @classmethod
    def create(cls, name: str, record: dict[str, Any], n_lanes: int) -> Self:
        """Begin a fleet on a broker."""
        made = cls(name)  # type: ignore[call-arg]
        with made._opened():
            entry = made._newest("fleet")
            known: dict[str, Any] = {"record": record, "n_lanes": n_lanes} if entry is None else json.loads(entry[0])
            if known["record"]["settings"] != record["settings"] or known["n_lanes"] != n_lanes:
                raise FormatError(made.name, "holds a fleet of other settings or another number of lanes; choose another NAME")
            made._make(n_lanes)
            if entry is None:
                made._put(("fleet",), json.dumps(known).encode())
            made.record, made.n_lanes = record, n_lanes
        return made

    @classmethod
    def connect(cls, name: str, patience_s: float) -> Self:
        """Open a fleet on a broker."""
        until = time.monotonic() + patience_s
        while True:
            try:
                return cls._joined(name)
            except FormatError:
                if time.monotonic() >= until:
                    raise
                time.sleep(WAIT_S)

    @classmethod
    def _joined(cls, name: str) -> Self:
        made = cls(name)  # type: ignore[call-arg]
        with made._opened():
            entry = made._newest("fleet")
            if entry is None:
                raise FormatError(made.name, f"there is no such fleet; begin one with navbound live feed SOURCE --to {made.name}")
            current = json.loads(entry[0])
            made.record, made.n_lanes = current["record"], current["n_lanes"]
        return made

    @contextlib.contextmanager
    def _opened(self) -> Iterator[None]:
        """Close what cannot be used, and say why."""
        try:
            yield
        except UnreachableError as e:
            self.close()
            raise FormatError(self.name, f"{e}; {self.hint}") from e
        except FormatError:
            self.close()
            raise

    @abstractmethod
    def _make(self, n_lanes: int) -> None:
        """Make what holds the logs and the rest, where it is not there yet."""

    @abstractmethod
    def _newest(self, *key: object) -> tuple[bytes, int] | None:
        """What is kept under a key, and its number, which grows with each writing."""

    @abstractmethod
    def _put(self, key: tuple[object, ...], content: bytes, last: int | None = None) -> int | None:
        """Keep something under a key; its number. With `last` only where that is the number of what is kept (0: nothing), else None."""

    @abstractmethod
    def _members(self) -> Iterable[str]:
        """Names of which something is kept under worker."""

    @abstractmethod
    def _remove(self, *key: object) -> None:
        """Keep nothing under a key any more."""

    @abstractmethod
    def _log(self, kind: str, lane: int, written: tuple[int, int] | None = None) -> NumberedLog:
        """A log of a lane: in or out."""

    @abstractmethod
    def close(self) -> None:
        """Give everything back."""

    def came_in(self, lane: int) -> NumberedLog:
        """What the feeder wrote."""
        return self._log("in", lane)

    def went_out(self, lane: int) -> NumberedLog:
        """What the worker wrote. Who has claimed the lane writes behind what shut the others out, and behind nothing later."""
        return self._log("out", lane, self._fences.pop(lane, None))

    def _unchanged_s(self, key: str, number: int) -> float:
        """For how long what is kept under a key has had its number, as far as this process has seen. [s]."""
        before = self._seen.get(key)
        if before is None or before[0] != number:
            self._seen[key] = (number, time.monotonic())
            return 0.0
        return time.monotonic() - before[1]

    def _lives(self, key: str, content: bytes, number: int) -> bool:
        """Whether the worker that keeps something under a key may still live: it said so lately, and is not known to have ended."""
        return not processes.is_gone(content.decode(errors="replace").partition(" ")[2]) and self._unchanged_s(key, number) < LEASE_S

    def claim(self, lane: int) -> bool:
        """Take the lease of a lane that is free, or whose worker is gone, and shut who had it out of the log."""
        try:
            current, number = self._newest("lease", lane) or (b"", 0)
            if current and self._lives(f"lease.{lane}", current, number):
                return False
            taken = self._put(("lease", lane), self._mark, last=number)
            if taken is None:
                return False
            self._fences[lane] = self._log("out", lane).fence()
            # Only now: a lease that is renewed and not worked on would keep the lane from everybody.
            self._leases[lane] = taken
        except UnreachableError:
            return False
        return True

    def renew(self) -> list[int]:
        """Renew leases; those that another has taken."""
        lost = []
        with contextlib.suppress(UnreachableError):
            self._put(("worker", self._me), self._mark)
            self._counted = True
            for lane, number in list(self._leases.items()):
                renewed = self._put(("lease", lane), self._mark, last=number)
                if renewed is not None:
                    self._leases[lane] = renewed
                    continue
                # It may be this worker's own renewal whose answer was lost.
                current = self._newest("lease", lane)
                if current is not None and current[0] == self._mark:
                    self._leases[lane] = current[1]
                else:
                    lost.append(lane)
                    del self._leases[lane]
        return lost

    def release(self, lane: int) -> None:
        """Give a lane back."""
        number = self._leases.pop(lane)
        self._fences.pop(lane, None)
        with contextlib.suppress(UnreachableError):
            self._put(("lease", lane), b"", last=number)

    def n_workers(self) -> int:
        """Workers that said lately that they live; what another left long ago is removed."""
        n = 0
        for member in self._members():
            entry = self._newest("worker", member)
            alive = entry is not None and (member == self._me or self._lives(f"worker.{member}", *entry))
            n += alive
            if not alive:
                self._remove("worker", member)
        return n

    def _give_back(self) -> None:
        """Give lanes back, and count as a worker no more."""
        with contextlib.suppress(UnreachableError):
            for lane in list(self._leases):
                self.release(lane)
            if self._counted:
                self._remove("worker", self._me)


def _parts(name: str, port: int) -> tuple[str, str, str]:
    """Address of the broker, name of the fleet, and the whole without secrets."""
    scheme = name.partition("://")[0]
    try:
        parts = urlsplit(name)
        host, port = parts.hostname, parts.port or port
    except ValueError as e:
        raise InputError("to", name, domain=f"{scheme}://host:port/NAME") from e
    fleet = parts.path.strip("/")
    if not host or not re.fullmatch(r"[A-Za-z0-9_-]{1,32}", fleet):
        raise InputError("to", name, domain=f"{scheme}://host:port/NAME, the name of 1 to 32 letters, digits, - and _")
    return f"{scheme}://{parts.netloc}", fleet, f"{scheme}://{host}:{port}/{fleet}"


def cut(snapshot: bytes) -> list[bytes]:
    """A snapshot as messages, each of which knows the whole that it is of and how many there are."""
    parts = [snapshot[k : k + MOST_PAYLOAD] for k in range(0, len(snapshot), MOST_PAYLOAD)] or [b""]
    head = hashlib.sha256(snapshot).digest() + _LENGTH.pack(len(parts))
    return [head + part for part in parts]


def n_parts(message: bytes) -> int:
    """Of how many messages a snapshot is."""
    return int(_LENGTH.unpack_from(message, _DIGEST_B)[0])


def digest(message: bytes) -> bytes:
    """Of the whole snapshot that a message is of."""
    return message[:_DIGEST_B]


def joined(messages: Iterable[bytes | None]) -> bytes | None:
    """The snapshot of its messages in order; None where they are not all of one."""
    present = [message for message in messages if message is not None]
    whole = b"".join(message[_DIGEST_B + _LENGTH.size :] for message in present)
    return whole if present and hashlib.sha256(whole).digest() == digest(present[0]) else None


def shown_parts(status: bytes, states: list[bytes]) -> list[bytes]:
    """Status and states as messages, with as many states as each may hold."""
    parts = list[bytes]()
    for frame in states:
        if parts and len(parts[-1]) + len(frame) <= MOST_PAYLOAD:
            parts[-1] += frame
        else:
            parts.append(frame)
    return [_LENGTH.pack(len(status)) + status + part for part in parts or [b""]]


def shown_of(message: bytes) -> tuple[bytes, bytes] | None:
    """Status and states of a message; None where it is none."""
    if len(message) < _LENGTH.size:
        return None
    length = _LENGTH.size + _LENGTH.unpack_from(message)[0]
    return message[_LENGTH.size : length], message[length:]
