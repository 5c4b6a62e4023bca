"""Recorded rows to epochs that are ready to be judged, piece by piece."""

from __future__ import annotations

from collections import Counter, deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core, status
from navbound.read.checks.limits import Limits
from navbound.read.checks.plausible import Checker, Plausibility
from navbound.read.covariance import Claimed, Claims
from navbound.read.motion.axes import Axes
from navbound.read.motion.speeds import Speeds
from navbound.read.pieces import Frames, PiecedReading, read_pieces
from navbound.read.pieces.parquet import is_parquet, shape
from navbound.read.quantities import POSITION_TIME
from navbound.read.source import LARGE_BYTES, is_text_table
from navbound.rnp.usual import period_s
from navbound.run.inputs.doubts import of_motion
from navbound.run.pieces.flights import Flights
from navbound.storage.tables import whole_tracks
from navbound.table.columns import COVARIANCE, HORIZONTAL, VARIANCES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from navbound.records.material import Scatter
    from navbound.run.pieces.truth import PiecedTruth
    from navbound.run.pieces.ways import Way

AUXILIARY = (
    "callsign",
    "nac_p",
    "nic",
    "nuc_p",
    "pic",
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


LARGE_ROWS = 1 << 19
"""Rows from which a Parquet file is read in pieces. [1] Provenance: ours; below it the whole takes less than about 0.6 GB."""


def is_large(path: Path, piece_rows: int | None) -> bool:
    """Whether a file is a table that is read in pieces: a large one, or any where pieces are requested."""
    if is_parquet(path):
        return piece_rows is not None or shape(path)[0] >= LARGE_ROWS
    return is_text_table(path, LARGE_BYTES if piece_rows is None else 0)


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
        .when(pl.any_horizontal(pl.col(name) < _core.LEAST_VARIANCE_M2 for name in VARIANCES)).then(pl.lit("zero_covariance"))
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
    labels, labels_before : dict
        Track to the callsign it mostly has, or to its own name; of the epochs that are judged, and of all.
    with_levels : frozenset of str
        Tracks with a protection level anywhere.
    period_s : float
        Usual time between epochs of a track; 1 s where no track has two. [s]
    flights : list of str
        How many tracks were divided.
    position_doubts : list of str
        That they do not travel as far, or whither, its speeds and tracks say.
    scatter : Scatter, optional
        How far they scatter along their way.
    ends : DataFrame
        ``track``, ``start`` and ``end`` of every track that is judged. [GPS ns]
    """

    reading: PiecedReading
    epochs: Frames
    left_out: pl.DataFrame
    claimed: Claimed
    plausibility: Plausibility
    labels: dict[str, str]
    labels_before: dict[str, str]
    with_levels: frozenset[str]
    period_s: float
    flights: list[str]
    position_doubts: list[str]
    scatter: Scatter | None
    ends: pl.DataFrame


@dataclass(frozen=True)
class Request:
    """How a table is read in pieces, and what its positions are compared with; the rest as of :func:`navbound.run.analyze.material`."""

    columns: Mapping[str, str] | None
    sigma_m: float | None
    limits: Limits
    rnp_m: float
    piece_rows: int
    truth: PiecedTruth
    way: Way


def in_pieces(path: Path, request: Request) -> InPieces:
    """Read a text table or a Parquet file in pieces of about so many rows and make its epochs ready to be judged.

    With a truth or a route the pieces hold whole tracks: both are looked at along a whole track.

    Raises
    ------
    FormatError, InputError
        As :func:`navbound.run.analyze.material`.
    """
    reading = read_pieces(path, columns=request.columns, piece_rows=request.piece_rows)
    request.truth.see_columns(reading.columns)
    checks, epochs, flights = _Checks(reading, request), Frames(), Flights(dividing=not request.way.named)
    steps, labels, ends = _Steps(reading.n_rows), _Labels(reading.names), _Ends()
    parts = checks.parts()
    if request.truth.stated or request.way.along_tracks:
        parts = whole_tracks(parts)
    if request.truth.stated:
        parts = (request.truth.compared(part) for part in parts)
    for part in request.way.on_path(parts):
        ready = covariance_status(part).with_columns(pl.lit(float(request.rnp_m)).alias("rnp_m"))
        ready = flights.divide(ready)
        labels.see(ready)
        steps.see(ready)
        ends.see(ready)
        epochs.put(ready.drop(AUXILIARY, strict=False))
    reading.pieces.close()
    plausibility = checks.checker.plausibility()
    return InPieces(
        reading,
        epochs,
        left_out=flights.divide_left_out(reading.left_out),
        claimed=checks.claimed,
        plausibility=plausibility,
        labels=labels.usual(),
        labels_before=checks.labels.usual(),
        with_levels=frozenset(labels.with_levels),
        period_s=steps.period_s(),
        flights=flights.words(),
        position_doubts=of_motion(plausibility, checks.speeds, checks.axes),
        scatter=checks.speeds.scatter(),
        ends=ends.table(),
    )


class _Checks:
    """Claims and plausibility of every epoch, and what the recording says of itself."""

    def __init__(self, reading: PiecedReading, request: Request) -> None:
        self._reading, self._claims = reading, Claims(request.sigma_m)
        self.checker, self.axes, self.speeds = Checker(request.truth.limits(request.limits)), Axes(), Speeds()
        self.labels = _Labels(reading.names)
        self.claimed: Claimed

    def parts(self) -> Iterator[pl.DataFrame]:
        """Pieces with their covariance and status."""
        for part in self._reading.spread():
            self.checker.see(part)
        for piece, after in _with_the_next(self._reading.epochs(), _core.SPEEDS_BESIDE):
            self.claimed = self._claims.claim(piece)
            self.labels.see(piece)
            checked = self.checker.check(self.claimed.epochs, after)
            self.axes.see(checked)
            self.speeds.see(checked)
            yield checked


class _Ends:
    """First and last epoch of every track."""

    def __init__(self) -> None:
        self._spans: dict[str, tuple[int, int]] = {}

    def see(self, epochs: pl.DataFrame) -> None:
        times = epochs.group_by("track").agg(start=pl.col("time_ns").min(), end=pl.col("time_ns").max())
        for track, start, end in times.iter_rows():
            before = self._spans.get(track, (start, end))
            self._spans[track] = (min(start, before[0]), max(end, before[1]))

    def table(self) -> pl.DataFrame:
        rows = [(track, *span) for track, span in self._spans.items()]
        return pl.DataFrame(rows, schema={"track": pl.String, "start": pl.Int64, "end": pl.Int64}, orient="row")


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

    def period_s(self) -> float:
        return period_s(self._steps[: self._n])


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
