"""How the parts of a fleet reach each other: one contract, held by every transport.

A lane has two logs, what came in and what went out, each a row of journal frames. A position is the number of bytes before it in the log,
whatever the transport: the same input has the same positions and so the same outputs in files and in a broker. To append again what stands
at a position already changes nothing, so a writer that does not know whether it was heard simply repeats itself.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from navbound.errors import InputError, NavboundError

if TYPE_CHECKING:
    from types import TracebackType

MOST_LANES = 64
TRANSPORTS = "a folder, nats://host:port/NAME or kafka://host:port/NAME"
WAIT_S = 0.05
"""Longest time that a reader waits for something new. [s]"""


class FencedError(NavboundError):
    """Another writer has taken the log over: this one ends."""


class UnreachableError(NavboundError):
    """Nobody answers. What was to be written may stand there or not; to repeat it is right."""


class Log(Protocol):
    """Frames of one lane that are only added to."""

    def end(self) -> int:
        """Position behind the last whole frame. [B]."""
        ...

    def append(self, frames: bytes, at: int) -> None:
        """Write whole frames that begin at a position; they are durable when this returns.

        Raises
        ------
        FencedError
            Something else stands there: another wrote it.
        UnreachableError
            Nobody answers.
        """
        ...

    def read(self, begin: int) -> bytes:
        """Whole frames that begin at a position, a part of what is there; b"" at the end. Never what was given already."""
        ...


class Transport(Protocol):
    """The logs of a fleet, who works on them, and what is kept of a lane.

    Attributes
    ----------
    name : str
        For people: no secret is in it.
    n_lanes : int
        Fixed for the life of the fleet.
    record : dict
        What the fleet was begun with.
    """

    name: str
    n_lanes: int
    record: dict[str, Any]

    def came_in(self, lane: int) -> Log:
        """What the feeder wrote."""
        ...

    def went_out(self, lane: int) -> Log:
        """What the worker wrote."""
        ...

    def keep(self, lane: int, snapshot: bytes) -> None:
        """Keep a snapshot of a lane; one before it stays until this one is whole."""
        ...

    def kept(self, lane: int) -> list[bytes]:
        """Snapshots of a lane, the newest first. What is damaged is found by who restores it."""
        ...

    def show(self, lane: int, status: bytes, states: list[bytes]) -> None:
        """Newest states of a lane, for who shows them; the next ones take their place."""
        ...

    def shown(self, lane: int) -> list[tuple[bytes, bytes]]:
        """Status and states since the last call, the oldest first; states may be missed."""
        ...

    def claim(self, lane: int) -> bool:
        """Become the only worker of a lane; False where another has it. Who had it before is fenced."""
        ...

    def renew(self) -> list[int]:
        """Say, about once a second, that the lanes that were claimed are worked on; lanes that another has taken over meanwhile."""
        ...

    def release(self, lane: int) -> None:
        """Give a lane back."""
        ...

    def n_workers(self) -> int:
        """Workers that are alive, this one among them.

        Raises
        ------
        UnreachableError
            Nobody answers, so nobody knows.
        """
        ...

    def wait(self) -> None:
        """Until something may be new, `WAIT_S` at most."""
        ...

    def close(self) -> None:
        """Give everything back."""
        ...


class Opened:
    """A transport as a context that closes it."""

    def __init__(self, transport: Transport) -> None:
        self.transport = transport

    def __enter__(self) -> Transport:
        """Begin."""
        return self.transport

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Close it."""
        self.transport.close()


def create(name: str, record: dict[str, Any], n_lanes: int) -> Opened:
    """Begin a fleet; one that is there with the same record is gone on with.

    Raises
    ------
    FormatError
        It cannot be opened, or holds another fleet.
    InputError
        No name of a transport, or no number of lanes.
    """
    if not 1 <= n_lanes <= MOST_LANES:
        raise InputError("lanes", n_lanes, "1", f"[1, {MOST_LANES}]")
    return Opened(_kind(name).create(name, record, n_lanes))


def connect(name: str, *, patience_s: float = 0.0) -> Opened:
    """Open a fleet that was begun.

    Parameters
    ----------
    name : str
        A folder, ``nats://host:port/NAME`` or ``kafka://host:port/NAME``.
    patience_s : float
        How long it may take to appear. [s]

    Raises
    ------
    FormatError
        There is none.
    """
    return Opened(_kind(name).connect(name, patience_s))


def _kind(name: str) -> Any:
    scheme, separator, _ = name.partition("://")
    if not separator:
        from navbound.live.fleet.files import Files  # noqa: PLC0415

        return Files
    if scheme in {"nats", "tls"}:
        from navbound.live.fleet.brokers.nats import Nats  # noqa: PLC0415 - its library is optional

        return Nats
    if scheme == "kafka":
        from navbound.live.fleet.brokers.kafka import Kafka  # noqa: PLC0415 - its library is optional

        return Kafka
    raise InputError("to", name, domain=TRANSPORTS)


def is_folder(name: str) -> bool:
    """Whether a fleet stands in a folder of this host."""
    return "://" not in name and Path(name).is_dir()
