"""Recorded rows to epochs that are ready to be judged, piece by piece."""

from __future__ import annotations

from collections import Counter, deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core, status
from navbound.read.checks.axes import Axes
from navbound.read.checks.plausible import Checker, Limits, Plausibility
from navbound.read.covariance import Claimed, Claims
from navbound.read.pieces import Frames, PiecedReading, read_pieces
from navbound.read.pieces.chunks import Chunks
from navbound.read.pieces.parquet import is_parquet, shape
from navbound.read.source import LARGE_BYTES, is_text_table
from navbound.read.speeds import Speeds
from navbound.read.tables.columns import POSITION_TIME, assign
from navbound.read.tables.table import layout_of
from navbound.run.pieces.flights import Flights
from navbound.table.columns import COVARIANCE, HORIZONTAL

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

AUXILIARY = (
    "callsign",
    "nac_p",
    "nic",
    "rc_m",
    "epu_m",
    "sigma_e_m",
    "sigma_n_m",
    "sigma_u_m",
    "unread_accuracy_m",
    "unread_level_m",
    "setting_hpa",
    POSITION_TIME,
)
"""Columns that no later stage reads."""


def states_truth(path: Path, columns: Mapping[str, str] | None) -> bool:
    """Whether a table has columns of the true position, recognised by their names."""
    names = list[str]()
    if is_parquet(path):
        names = shape(path)[1]
    else:
        for lines in Chunks(path):
            if not lines.is_empty():
                names = [name for name in layout_of(path, lines).names if name]
                break
    return bool(names) and {"truth_lat_rad", "truth_lon_rad"} <= set(assign(names, columns, path).columns)


LARGE_ROWS = 1 << 19
"""Rows from which a Parquet file is read in pieces. [1] Provenance: ours; below it the whole takes less than about 0.6 GB."""


def is_large(path: Path, columns: Mapping[str, str] | None, piece_rows: int | None) -> bool:
    """Whether a file is a table that is read in pieces: a large one, or any where pieces are requested; a truth needs whole series."""
    if is_parquet(path):
        large = piece_rows is not None or shape(path)[0] >= LARGE_ROWS
    else:
        large = is_text_table(path, LARGE_BYTES if piece_rows is None else 0)
    return large and not states_truth(path, columns)


def without_path(epochs: pl.DataFrame) -> pl.DataFrame:
    """Epochs of which nobody says where they should have been."""
    absent = (pl.lit(None, pl.Float64).alias(c) for c in ("course_rad", "fte_m"))
    return epochs.with_columns(*absent, pl.lit("recorded track").alias("phase"))


def covariance_status(epochs: pl.DataFrame) -> pl.DataFrame:
    """Status of epochs whose position may be believed, but not the covariance. Written so that a NaN is on the bad side."""
    ee, en, nn = (pl.col(name) for name in HORIZONTAL)
    # 1e-9 of the squared largest variance: the sixteen digits of a double less those the determinant loses.
    determinant = ee * nn - en**2 >= -1e-9 * pl.max_horizontal(ee, nn) ** 2
    positive = pl.all_horizontal(ee.is_finite(), nn.is_finite(), en.is_finite(), ee >= 0, nn >= 0, determinant).fill_null(value=False)
    believed = pl.col("status").is_in(status.USABLE)
    fault = (
        pl.when(~believed).then(pl.lit(None, pl.String))
        .when(pl.any_horizontal(c.is_null() for c in (ee, nn, en))).then(pl.lit("no_covariance"))
        .when(~positive).then(pl.lit("not_a_covariance"))
        .when(pl.any_horizontal(ee == 0, nn == 0, pl.col("cov_uu_m2") == 0)).then(pl.lit("zero_covariance"))
    )  # fmt: skip
    epochs = status.overridden(epochs, epochs.select(fault.alias("reason_id"))["reason_id"])
    return epochs.with_columns(pl.when(pl.col("status").is_in(status.USABLE)).then(pl.col(c)).alias(c) for c in COVARIANCE)


@dataclass(frozen=True)
class InPieces:
    """A table read in pieces, and what was learnt on the way.

    Attributes
    ----------
    left_out : DataFrame
        Rows that cannot be judged, as those of the reading, by the flights of their tracks.
    claimed : Claimed
        Where the covariance comes from; its epochs are those of the last piece.
    labels : dict
        Track to the callsign it mostly has, or to its own name.
    with_levels : frozenset of str
        Tracks with a protection level anywhere.
    period_s : float
        Usual time between epochs of a track; 1 s where no track has two. [s]
    doubts : list of str
        That the positions do not move as the recording says, and how many tracks were divided.
    position_doubts : list of str
        That they do not travel as its speeds say.
    """

    reading: PiecedReading
    epochs: Frames
    left_out: pl.DataFrame
    claimed: Claimed
    plausibility: Plausibility
    labels: dict[str, str]
    with_levels: frozenset[str]
    period_s: float
    doubts: list[str]
    position_doubts: list[str]


def in_pieces(
    path: Path, columns: Mapping[str, str] | None, *, sigma_m: float | None, limits: Limits, rnp_m: float, piece_rows: int
) -> InPieces:
    """Read a text table or a Parquet file in pieces of about so many rows and make its epochs ready to be judged.

    Raises
    ------
    FormatError, InputError
        As :func:`navbound.run.analyze.material`.
    """
    reading = read_pieces(path, columns=columns, piece_rows=piece_rows)
    checker, claims, epochs = Checker(limits), Claims(sigma_m), Frames()
    axes, speeds, flights = Axes(), Speeds(), Flights()
    steps, labels = _Steps(reading.n_rows), _Labels(reading.names)
    for part in reading.spread():
        checker.see(part)
    for piece, after in _with_the_next(reading.epochs(), _core.SPEEDS_BESIDE):
        axes.see(piece)
        claimed = claims.claim(piece)
        speeds.see(claimed.epochs)
        ready = covariance_status(without_path(checker.check(claimed.epochs, after))).with_columns(pl.lit(float(rnp_m)).alias("rnp_m"))
        ready = flights.divide(ready)
        labels.see(ready)
        steps.see(ready)
        epochs.put(ready.drop(AUXILIARY, strict=False))
    reading.pieces.close()
    of_tracks = (labels.usual(), frozenset(labels.with_levels), steps.median_s())
    doubts = [*axes.words(), *flights.words()]
    lost = flights.divide_left_out(reading.left_out)
    return InPieces(reading, epochs, lost, claimed, checker.plausibility(), *of_tracks, doubts, speeds.doubts())


def _with_the_next(pieces: Iterator[pl.DataFrame], n: int) -> Iterator[tuple[pl.DataFrame, pl.DataFrame]]:
    """Each piece with the ``n`` rows after it, as far as there are any."""
    waiting: deque[pl.DataFrame] = deque()
    for piece in pieces:
        waiting.append(piece)
        while waiting and sum(later.height for later in list(waiting)[1:]) >= n:
            yield _first_with_rest(waiting, n)
    while waiting:
        yield _first_with_rest(waiting, n)


def _first_with_rest(waiting: deque[pl.DataFrame], n: int) -> tuple[pl.DataFrame, pl.DataFrame]:
    first = waiting.popleft()
    return first, pl.concat([first.clear(), *(later.head(n) for later in waiting)], how="diagonal_relaxed").head(n)


class _Steps:
    """Times between the epochs of each track."""

    def __init__(self, most: int) -> None:
        self._steps, self._n = np.empty(most, dtype=np.int64), 0
        self._last: tuple[str, int] | None = None

    def see(self, epochs: pl.DataFrame) -> None:
        track, time_ns = epochs["track"], epochs["time_ns"]
        steps = epochs.select(pl.col("time_ns").diff().over("track"))["time_ns"].drop_nulls().to_numpy()
        if self._last is not None and self._last[0] == track[0]:
            steps = np.concatenate([[time_ns[0] - self._last[1]], steps])
        self._steps[self._n : self._n + len(steps)] = steps
        self._n += len(steps)
        self._last = (track[-1], time_ns[-1])

    def median_s(self) -> float:
        step = float(np.median(self._steps[: self._n], overwrite_input=True)) * 1e-9 if self._n else 0.0
        return step if step > 0 else 1.0


class _Labels:
    """How often each track has each callsign."""

    def __init__(self, names: list[str]) -> None:
        self._counts: dict[str, Counter[str]] = {name: Counter() for name in names}
        self.with_levels = set[str]()

    def see(self, epochs: pl.DataFrame) -> None:
        for track in epochs["track"].unique():
            self._counts.setdefault(track, Counter())
        if "hpl_m" in epochs.columns:
            self.with_levels |= set(epochs.drop_nulls("hpl_m")["track"].unique())
        if "callsign" in epochs.columns:
            counted = epochs.drop_nulls("callsign").group_by("track", "callsign").len()
            for track, callsign, n in counted.iter_rows():
                self._counts[track][callsign] += n

    def usual(self) -> dict[str, str]:
        """Of several that are as frequent the first of the alphabet."""
        return {track: _most(counts) or track for track, counts in sorted(self._counts.items())}


def _most(counts: Counter[str]) -> str | None:
    return min(counts, key=lambda name: (-counts[name], name)) if counts else None
