"""A recorded truth that is too large for memory: on the disk, and joined to epochs by its pieces about them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.read.truth import truth_rows
from navbound.storage.frames import Frames
from navbound.storage.tables import whole_tracks

if TYPE_CHECKING:
    from collections.abc import Iterator


class RowsOnDisk:
    """Rows of a truth in the order of track and time, with the attributes of :class:`navbound.read.truth.Rows`.

    Parameters
    ----------
    recorded : iterator of DataFrame
        The recording in the order of track and time, in pieces. A track is held whole.
    piece_rows : int
        About how many rows are read at a time.
    """

    def __init__(self, recorded: Iterator[pl.DataFrame], piece_rows: int) -> None:
        self.names, self.jumps = set[str](), list[int]()
        self._rows, self._spans = Frames(), list[tuple[str, int, int]]()
        for part in whole_tracks(recorded):
            truth, jumps = truth_rows(part)
            self.jumps += jumps
            for track in truth.partition_by("track", maintain_order=True):
                self._put(track, piece_rows)
        self.jumps.sort()
        self.span_ns = (min(first for _, first, _ in self._spans), max(last for *_, last in self._spans))

    def _put(self, track: pl.DataFrame, piece_rows: int) -> None:
        name, times = track["track"][0], track["time_ns"]
        self.names.add(name)
        for begin in range(0, track.height, piece_rows):
            piece = track[begin : begin + piece_rows]
            self._rows.put(piece)
            self._spans.append((name, times[begin], times[begin + piece.height - 1]))

    def around(self, epochs: pl.DataFrame, tolerance_ns: int) -> pl.DataFrame:
        """The pieces within the tolerance of each track's epochs; of a truth of one track those about all of them."""
        times = epochs.group_by("track").agg(first=pl.col("time_ns").min(), last=pl.col("time_ns").max())
        ends = {track: (first - tolerance_ns, last + tolerance_ns) for track, first, last in times.iter_rows()}
        whole = (min(first for first, _ in ends.values()), max(last for _, last in ends.values()))
        parts = []
        for index, (track, first, last) in enumerate(self._spans):
            between = ends.get(track) if len(self.names) > 1 else whole
            if between is not None and first <= between[1] and last >= between[0]:
                parts.append(self._rows.piece(index).filter(pl.col("time_ns").is_between(*between)))
        return pl.concat(parts) if parts else pl.DataFrame(schema=self._rows.schema)
