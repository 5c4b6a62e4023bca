"""A table in memory or in pieces, read in the same way: at once is one piece."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.storage.frames import Frames

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

Table = pl.DataFrame | Frames
"""Epochs in memory, or in pieces on the disk."""


def pieces(table: Table, names: Sequence[str]) -> Iterator[pl.DataFrame]:
    """Of the named columns those that the table has, piece by piece, in order."""
    have = set(table.columns)
    present = [name for name in dict.fromkeys(names) if name in have]
    if isinstance(table, pl.DataFrame):
        yield table.select(present)
    else:
        yield from table.select(present)


def tracks(table: Table, names: Sequence[str]) -> Iterator[pl.DataFrame]:
    """The same in pieces that hold whole tracks, of a table in the order of tracks; `names` has ``track``. The longest is held whole."""
    if isinstance(table, pl.DataFrame):
        yield from pieces(table, names)
        return
    yield from whole_tracks(pieces(table, names))


def whole_tracks(parts: Iterator[pl.DataFrame]) -> Iterator[pl.DataFrame]:
    """Pieces in the order of tracks, cut anew where a track begins.

    A column that a piece lacks is null there: rows that contradict nothing have no status of their own.
    """
    waiting = list[pl.DataFrame]()
    for part in parts:
        track = part["track"]
        begins = part.height - int(track.rle()[-1]["len"])
        if begins or (waiting and waiting[-1]["track"][-1] != track[0]):
            done = [*waiting, part[:begins]]
            yield pl.concat([each for each in done if each.height], how="diagonal", rechunk=True)
            waiting = []
        waiting.append(part[begins:])
    if waiting:
        yield pl.concat(waiting, how="diagonal", rechunk=True)


def numbers(table: Table, name: str) -> NDArray[np.float64]:
    """The numbers of a column that are finite, in order."""
    if isinstance(table, Frames):
        return table.numbers(name)
    values = table.get_column(name).cast(pl.Float64).fill_null(np.nan).to_numpy()
    finite: NDArray[np.float64] = values[np.isfinite(values)]
    return finite


def has_values(table: Table, name: str) -> bool:
    """Whether a column is there and holds a finite number anywhere."""
    if name not in table.columns:
        return False
    parts = (part[name].cast(pl.Float64).fill_null(np.nan).to_numpy() for part in pieces(table, [name]))
    return any(bool(np.isfinite(values).any()) for values in parts)


class Places:
    """Tracks of a table in the order of tracks as numbers, in order of appearance, piece after piece."""

    def __init__(self) -> None:
        self._last: str | None = None
        self._n = -1

    def of(self, track: pl.Series) -> NDArray[np.uint32]:
        """Of the next rows."""
        if track.is_empty():
            return np.empty(0, dtype=np.uint32)
        goes_on = self._n >= 0 and track[0] == self._last
        first = self._n if goes_on else self._n + 1
        places = track.rle_id().cast(pl.Int64).to_numpy() + first
        self._last, self._n = track[-1], int(places[-1])
        return places.astype(np.uint32)
