"""The truth of a table in pieces: none, columns of its own, a fixed point, or a recording."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from navbound.read.pieces import Beside, read_pieces
from navbound.read.pieces.truth import RowsOnDisk
from navbound.read.tables.epochs import read_beside
from navbound.read.truth import AllRows, Comparison, at_fixed_point, fixed_words, require_positions, with_error
from navbound.records.truth import TruthDoubts

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    import polars as pl

    from navbound.read.checks.limits import Limits
    from navbound.read.pieces import PiecedReading
    from navbound.read.tables.epochs import Reading
    from navbound.read.truth import Truth


class PiecedTruth:
    """Compares whole tracks with a truth, and counts.

    Parameters
    ----------
    truth : Truth
        As the caller names it.
    is_large : callable
        Whether a recording is read in pieces.
    piece_rows : int
        About how many rows are worked on at a time.

    Attributes
    ----------
    stated : bool
        Whether there is a truth.
    recording : Reading or PiecedReading, optional
        What was read of its file.
    """

    def __init__(self, truth: Truth, *, is_large: Callable[[Path], bool], piece_rows: int) -> None:
        self._truth, self._is_large, self._piece_rows = truth, is_large, piece_rows
        self.stated = truth.stated is not None
        self.recording: Reading | PiecedReading | None = None
        self._comparison: Comparison | None = None
        self._doubts = TruthDoubts()

    def see_columns(self, quantities: Collection[str]) -> None:
        """What the table holds: columns of the true position are a truth where none is named."""
        self.stated = self.stated or {"truth_lat_rad", "truth_lon_rad"} <= set(quantities)

    def limits(self, limits: Limits) -> Limits:
        """A fixed truth says that the receiver stands: its position may repeat."""
        return limits if self._truth.ecef_m is None else replace(limits, moving_mps=math.inf)

    def compared(self, epochs: pl.DataFrame) -> pl.DataFrame:
        """Whole tracks with the truth and the navigation error."""
        if self._truth.stated is None:
            compared, doubts = with_error(epochs)
        elif self._truth.ecef_m is None:
            require_positions(epochs.columns)
            self._comparison = self._comparison or self._recorded()
            return self._comparison.join(epochs)
        else:
            require_positions(epochs.columns)
            compared, doubts = at_fixed_point(epochs, self._truth)
        self._doubts += doubts
        return compared

    def _recorded(self) -> Comparison:
        truth, path = self._truth, Path(str(self._truth.stated))
        if self._is_large(path):
            self.recording = pieced = read_pieces(
                path, columns=truth.columns_of_truth, piece_rows=self._piece_rows, beside=Beside(truth.columns_of_estimates)
            )
            on_disk = RowsOnDisk(pieced.epochs(), self._piece_rows)
            pieced.pieces.close()
            return Comparison(on_disk, pieced.source.path, truth.tolerance_s)
        self.recording = whole = read_beside(path, truth.columns_of_truth, truth.columns_of_estimates)
        rows = AllRows()
        rows.see(whole.epochs)
        return Comparison(rows, whole.source.path, truth.tolerance_s)

    @property
    def doubts(self) -> TruthDoubts:
        """What speaks against the truth, of the epochs so far."""
        return self._doubts if self._comparison is None else self._comparison.doubts

    def words(self) -> list[str]:
        """What is said of the truth.

        Raises
        ------
        InputError
            Not one epoch with a truth.
        """
        if not self.stated:
            return []
        if self._comparison is not None:
            return [self._comparison.words()]
        if self._truth.ecef_m is not None:
            return [fixed_words(self._truth, self.doubts)]
        return [f"Truth: from the file itself. {self.doubts.words}".rstrip()]
