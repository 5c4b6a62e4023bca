"""Rows in the order of track and time without holding them all: distributed to pieces, each of which is sorted when it is taken."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.storage.frames import Spool

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray


class Pieces:
    """Rows of a table, distributed by track and time.

    Parameters
    ----------
    names : sequence of str
        Every track.
    sample : DataFrame
        ``track`` and ``time_ns`` of some rows, of every so many of the file.
    every : int
        How many of these make a piece.
    """

    def __init__(self, names: Sequence[str], sample: pl.DataFrame, every: int) -> None:
        self._rank = pl.DataFrame({"track": sorted(names), "rank": range(len(names))}, schema={"track": pl.String, "rank": pl.Int64})
        # Rows of one time are never parted: they have one key.
        self._starts = np.unique(np.sort(self._keys(sample))[every::every]) if sample.height else np.empty(0, dtype=np.complex128)
        self._spool = Spool()
        self._places: list[list[tuple[int, int]]] = [[] for _ in range(len(self._starts) + 1)]
        self._spans: dict[str, tuple[int, int]] = {}
        self._schema: dict[str, pl.DataType] = {}

    def _keys(self, rows: pl.DataFrame) -> NDArray[np.complex128]:
        """Numbers in the order of track and time: complex ones are compared by their parts. Close times may become one."""
        rank = rows["track"].replace_strict(self._rank["track"], self._rank["rank"], return_dtype=pl.Int64).to_numpy()
        keys = np.empty(rows.height, dtype=np.complex128)
        keys.real, keys.imag = rank, rows["time_ns"].to_numpy()
        return keys

    def put(self, rows: pl.DataFrame) -> None:
        """The next rows, in the order of the file."""
        self._schema |= {name: dtype for name, dtype in rows.schema.items() if name not in self._schema}
        marked = rows.with_columns(pl.Series("__piece", np.searchsorted(self._starts, self._keys(rows), side="right")))
        for track, low, high in marked.group_by("track").agg(low=pl.col("__piece").min(), high=pl.col("__piece").max()).iter_rows():
            before = self._spans.get(track, (low, high))
            self._spans[track] = (min(low, before[0]), max(high, before[1]))
        for (piece,), part in marked.partition_by("__piece", as_dict=True, maintain_order=True, include_key=False).items():
            self._places[int(piece)].append(self._spool.put(part))

    def has(self, track: str) -> bool:
        """Whether a track has rows."""
        return track in self._spans

    def spread(self) -> dict[str, tuple[int, int]]:
        """Tracks in more than one piece: the first and the last."""
        return {track: span for track, span in self._spans.items() if span[0] < span[1]}

    def __len__(self) -> int:
        """How many pieces, some of them without rows."""
        return len(self._places)

    def piece(self, index: int) -> pl.DataFrame:
        """The rows of a piece in the order of track, time and file; no columns where there are no rows."""
        parts = [self._whole(self._spool.get(place)) for place in self._places[index]]
        return pl.concat(parts).sort("track", "time_ns", maintain_order=True) if parts else pl.DataFrame()

    def _whole(self, part: pl.DataFrame) -> pl.DataFrame:
        """A part with the columns of all: what no row of it states is stated elsewhere, and a status that none doubts is good."""
        lacking = {name: dtype for name, dtype in self._schema.items() if name not in part.columns}
        added = [pl.lit("ok" if name == "status" else None, dtype).alias(name) for name, dtype in lacking.items()]
        return part.with_columns(added).select(list(self._schema))

    def __iter__(self) -> Iterator[pl.DataFrame]:
        """Every piece that has rows."""
        pieces = (self.piece(index) for index in range(len(self)))
        return (piece for piece in pieces if not piece.is_empty())

    def close(self) -> None:
        """Give the disk back."""
        self._spool.close()
