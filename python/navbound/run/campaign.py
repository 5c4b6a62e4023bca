"""Many flights of one scenario: cut into tiles, worked off by whoever is there, put together in order."""

from __future__ import annotations

import hashlib
import io
import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import polars as pl

from navbound.errors import InputError
from navbound.judge import with_levels
from navbound.records.run import InputFile
from navbound.scale import in_order
from navbound.storage.frames import Frames

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path
    from typing import Unpack

    from numpy.typing import NDArray

    from navbound.records.run import CovarianceOrigin, EventSummary, Waypoint
    from navbound.scale import Work

    Fly = Callable[[range], tuple[pl.DataFrame, list[Any]]]

MAX_FLIGHTS = 1000
"""Flights of one run. [1]"""
PIECE_ROWS = 1 << 14
"""Rows from which flights are put away. [1] Provenance: ours; it decides memory and time, and no bit of the results."""


@dataclass(frozen=True)
class Context:
    """What a simulator says of its epochs; the fields of :class:`navbound.records.material.Material`."""

    requirement: str
    assumptions: list[str]
    covariance: CovarianceOrigin
    waypoints: list[Waypoint]
    settings: dict[str, object]
    events: list[EventSummary] = field(default_factory=list)
    limits_held: dict[str, str] = field(default_factory=dict)


class Campaign(Protocol):
    """All flights of one scenario with one seed. It depends on nothing else, and pickle takes it."""

    @property
    def at_once(self) -> int:
        """Flights of one tile: worth at least 0.2 s, and enough to keep the threads of one process busy."""

    def __call__(self, flights: range) -> tuple[pl.DataFrame, list[Any]]:
        """Epochs of some flights, and whatever JSON holds besides."""

    def context(self, flights: int, reported: list[Any]) -> Context:
        """What is said of the epochs of all flights."""


def check_flights(flights: int) -> None:
    """Refuse another number than 1 to 1000, with an :class:`InputError`."""
    if not (isinstance(flights, int) and 1 <= flights <= MAX_FLIGHTS):
        raise InputError("flights", flights, "1", f"[1, {MAX_FLIGHTS}]")


def seed_in_force(flights: int, seed: int | None, own: int) -> int:
    """The seed of a campaign that can be flown: the one given, or the scenario's own.

    Raises
    ------
    InputError
        Flights outside [1, 1000], a seed outside [0, 2^64).
    """
    check_flights(flights)
    seed_in_force = own if seed is None else seed
    if not (isinstance(seed_in_force, int) and 0 <= seed_in_force < 2**64):
        raise InputError("seed", seed_in_force, "1", "[0, 2^64)")
    return seed_in_force


def track_name(number: int) -> str:
    """The track of a flight, by its number from 0."""
    return f"flight-{number:03d}"


def scenario_file(path: Path) -> InputFile:
    """The file of a scenario, for the run record."""
    data = path.read_bytes()
    return InputFile(path=str(path), sha256=hashlib.sha256(data).hexdigest(), n_bytes=len(data), n_rows=None)


@dataclass(frozen=True)
class _Packed:
    """Flights as a function of a tile: a dictionary of arrays, which any worker can send and any folder keep."""

    fly: Fly

    def __call__(self, flights: range) -> dict[str, NDArray[np.generic]]:
        epochs, reported = self.fly(flights)
        table = io.BytesIO()
        epochs.write_ipc(table)
        return {"epochs": _bytes(table.getbuffer()), "told": _bytes(json.dumps(reported).encode())}


def _bytes(content: memoryview | bytes) -> NDArray[np.uint8]:
    return np.frombuffer(content, dtype=np.uint8)


def fly_all(fly: Fly, flights: int, at_once: int, **work: Unpack[Work]) -> Iterator[tuple[pl.DataFrame, list[Any]]]:
    """Fly a campaign, tile by tile.

    Parameters
    ----------
    fly : callable
        Makes of the numbers of some flights their epochs, and a list of whatever JSON holds besides. It depends on nothing else, and pickle
        takes it.
    flights : int
        How many. [1]
    at_once : int
        Flights of one tile: worth at least 0.2 s, and enough to keep the threads of one process busy. [1]
    **work
        As in :func:`navbound.scale.map_tiles`; progress counts flights.

    Yields
    ------
    epochs : DataFrame
        Of the flights of the next tile, in order; the same bits whoever flew them.
    reported : list
        What was reported besides, in order.
    """
    tiles = [range(first, min(first + at_once, flights)) for first in range(0, flights, at_once)]
    tell = work.get("progress")
    if tell is not None:
        work["progress"] = lambda done, _tiles: tell(min(done * at_once, flights), flights)
    for part in in_order(_Packed(fly), tiles, **work):
        # Packed epochs are given up as soon as they are read.
        yield pl.read_ipc(part.pop("epochs").tobytes()), json.loads(part.pop("told").tobytes())


@dataclass
class Flown:
    """Epochs of a campaign in pieces on the disk, and what was learnt on the way.

    Attributes
    ----------
    with_levels : set of str
        Tracks with a protection level anywhere.
    """

    epochs: Frames = field(default_factory=Frames)
    reported: list[Any] = field(default_factory=list)
    with_levels: set[str] = field(default_factory=set)

    def see(self, epochs: pl.DataFrame, reported: list[Any]) -> None:
        """The flights of the next tile, which are put away in pieces of whole flights."""
        self.reported += reported
        self.with_levels |= {track for track, has in with_levels(epochs).items() if has}
        first = end = 0
        for n in epochs["track"].rle().struct.field("len"):
            end += n
            if end - first >= PIECE_ROWS or end == epochs.height:
                self.epochs.put(epochs[first:end])
                first = end
