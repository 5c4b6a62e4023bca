"""Where the aircraft really was: a fixed point, or a second recording joined by time; and the navigation error that follows."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
import polars as pl

from navbound import _core, status
from navbound.errors import ConflictError, InputError
from navbound.read.checks.established import contradicting, established
from navbound.read.checks.stated import ALERT, CONTAINMENT, LEVEL_SIGMAS, TWO_DRMS
from navbound.read.columns.column import NO_COLUMN
from navbound.read.tables.epochs import read_beside
from navbound.records.truth import TruthDoubts
from navbound.time import utc_text
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from navbound.read.tables.epochs import Reading

_OF_TRUTH = {"truth_time": "time", "truth_lat_rad": "est_lat_rad", "truth_lon_rad": "est_lon_rad", "truth_h_m": "est_h_m"}
"""What is declared of a recorded truth, to what it is called in its file."""

TOLERANCE_S = 0.01
"""How far apart in time an estimate and its truth may lie. At 70 m/s a hundredth of a second is 0.7 m."""

_LIMITS = ((-90.0, 90.0), (-180.0, 180.0), (-1e3, 1e5))
"""Of a latitude and a longitude [deg], and of a height [m]."""
_POINTS = (
    "LAT,LON,H in degrees and metres above the ellipsoid (latitude within 90, longitude within 180, height from -1000 to 100000), "
    "X,Y,Z in metres, Earth-fixed, of a point within 100 km of the Earth's surface, or a file"
)


@dataclass(frozen=True)
class Truth:
    """Where the receiver really was: a fixed point, or a recording.

    Attributes
    ----------
    stated : str or None
        As it was given.
    ecef_m : ndarray, shape (3,), or None
        A fixed point, Earth-fixed. [m]
    tolerance_s : float
        How far apart in time an estimate and its recorded truth may lie. [s]
    columns : mapping
        What the caller declares of columns, of the estimates and of the truth.
    place : str
        A fixed point in words.
    """

    stated: str | None
    ecef_m: NDArray[np.float64] | None
    tolerance_s: float
    columns: Mapping[str, str] = field(default_factory=dict)
    place: str = ""

    @property
    def set_aside(self) -> list[str]:
        """Quantities that no column is to be read as."""
        return sorted(name for name, column in self.columns.items() if column == NO_COLUMN)

    @property
    def columns_of_estimates(self) -> Mapping[str, str]:
        """What is declared of the estimates' columns: with a recorded truth those of the truth are in its own file."""
        if self.stated is None or self.ecef_m is not None:
            return self.columns
        return {name: column for name, column in self.columns.items() if name not in _OF_TRUTH}

    @property
    def columns_of_truth(self) -> dict[str, str]:
        """What is declared of the columns in the file of a recorded truth."""
        return {_OF_TRUTH[name]: column for name, column in self.columns.items() if name in _OF_TRUTH}


def truth_of(source: str | Path | None, tolerance_s: float, columns: Mapping[str, str] | None = None) -> Truth:
    """Read ``X,Y,Z`` (Earth-fixed, metres) or ``LAT,LON,H`` (degrees, metres above the WGS-84 ellipsoid), or take a file's name.

    Three numbers within 100 km of the Earth's surface as ``X,Y,Z`` are that; no height is as large.

    Raises
    ------
    InputError
        Numbers that are neither.
    """
    if source is None:
        return Truth(None, None, tolerance_s, columns or {})
    text = str(source)
    if text.strip() in {"", "."}:
        raise InputError("truth", text, domain=_POINTS)
    number = r"\s*[-+]?\d+(?:\.\d*)?\s*"
    if re.fullmatch(f"{number}(?:,{number})+", text) is None or Path(text).exists():
        return Truth(text, None, tolerance_s, columns or {})
    values = [float(part) for part in text.split(",")]
    if len(values) == 3 and 6.3e6 < math.hypot(*values) < 6.5e6:
        return Truth(text, np.array(values), tolerance_s, columns or {}, f"{text} m, Earth-fixed")
    if len(values) != 3 or any(not low <= value <= high for value, (low, high) in zip(values, _LIMITS, strict=True)):
        raise InputError("truth", text, domain=_POINTS)
    lat_deg, lon_deg, h_m = values
    words = f"latitude {lat_deg:.12g} deg, longitude {lon_deg:.12g} deg, height {h_m:.12g} m above the ellipsoid (WGS-84)"
    place = np.array(_core.ecef_from_geodetic(math.radians(lat_deg), math.radians(lon_deg), h_m))
    return Truth(text, place, tolerance_s, columns or {}, words)


def with_truth(epochs: pl.DataFrame, truth: Truth) -> tuple[pl.DataFrame, str, Reading | None, TruthDoubts]:
    """Form the navigation error against a truth that was named; words about it, what was read of its file, what speaks against it.

    What the caller declares of the estimates' columns counts for a recorded truth too, where it has them; ``truth_lat_rad``,
    ``truth_lon_rad``, ``truth_h_m`` and ``truth_time`` are declared of its own.

    Raises
    ------
    InputError
        Epochs without positions; a recording as in :func:`join`.
    """
    require_positions(epochs.columns)
    if truth.ecef_m is None:
        other = _recorded(truth)
        joined, words, doubts = join(epochs, other, truth.tolerance_s)
        return joined, words, other, doubts
    compared, doubts = at_fixed_point(epochs, truth)
    return compared, fixed_words(truth, doubts), None, doubts


def require_positions(columns: Sequence[str]) -> None:
    """Refuse a table without positions, with an :class:`InputError`."""
    if not {"est_lat_rad", "est_lon_rad"} <= set(columns):
        raise ConflictError("truth", because="the table holds no positions to compare with it")


def at_fixed_point(epochs: pl.DataFrame, truth: Truth) -> tuple[pl.DataFrame, TruthDoubts]:
    """Form the navigation error of a receiver that does not move; of whole tracks."""
    from navbound import gnss  # noqa: PLC0415  (only with a fixed point)

    place = gnss.geodetic(np.asarray(truth.ecef_m))
    names = ("truth_lat_rad", "truth_lon_rad", "truth_h_m")
    return with_error(epochs.with_columns(pl.lit(float(value)).alias(name) for name, value in zip(names, place, strict=True)))


def fixed_words(truth: Truth, doubts: TruthDoubts) -> str:
    """What is said of a fixed point."""
    return _sentences(f"Truth: the fixed point {truth.place}.", doubts.words)


def _recorded(truth: Truth) -> Reading:
    return read_beside(str(truth.stated), truth.columns_of_truth, truth.columns_of_estimates)


def join(epochs: pl.DataFrame, truth: Reading, tolerance_s: float = TOLERANCE_S) -> tuple[pl.DataFrame, str, TruthDoubts]:
    """Join the nearest truth in time, and form the navigation error.

    Parameters
    ----------
    epochs : DataFrame
        Epoch table, sorted by track and time.
    truth : Reading
        The other recording. With several tracks it is joined by track; with one it is the truth of all.
    tolerance_s : float
        Largest difference in time; epochs without a truth this near have none. [s]

    Returns
    -------
    epochs : DataFrame
        With ``truth_lat_rad``, ``truth_lon_rad``, ``truth_h_m`` and the navigation error.
    words : str
        How many epochs have a truth, and the largest difference in time.
    doubts : TruthDoubts
        What speaks against it.

    Raises
    ------
    InputError
        A tolerance below zero, or not one epoch with a truth (a wrong time scale shows itself so).
    """
    rows = AllRows()
    rows.see(truth.epochs)
    comparison = Comparison(rows, truth.source.path, tolerance_s)
    joined = comparison.join(epochs)
    words = comparison.words()
    return joined, words, comparison.doubts


_RENAMED = {"est_lat_rad": "truth_lat_rad", "est_lon_rad": "truth_lon_rad", "est_h_m": "truth_h_m"}


class Rows(Protocol):
    """A recorded truth, ready to be joined."""

    names: set[str]
    jumps: list[int]
    span_ns: tuple[int, int]

    def around(self, epochs: pl.DataFrame, tolerance_ns: int) -> pl.DataFrame:
        """At least the rows that may be joined to some epochs."""


def truth_rows(recorded: pl.DataFrame) -> tuple[pl.DataFrame, list[int]]:
    """Whole tracks of a recording as a truth: which of its rows are none, and the times of its jumps (GPS ns)."""
    other = recorded.rename({k: v for k, v in _RENAMED.items() if k in recorded.columns})
    places = [v for v in _RENAMED.values() if v in other.columns]
    other = other.select("track", "time_ns", *places, truth_time_ns="time_ns", invalid=_invalid(other), truth_sigma_m=_truth_sigma_m(other))
    return contradicting(other.sort("track", "time_ns"))


def _both(one: tuple[int, int] | None, times: pl.Series) -> tuple[int, int]:
    first, last = int(times.min()), int(times.max())  # type: ignore[arg-type]
    return (first, last) if one is None else (min(one[0], first), max(one[1], last))


class AllRows:
    """A truth that is held in memory."""

    def __init__(self) -> None:
        self.names, self.jumps = set[str](), list[int]()
        self.span_ns = (0, 0)
        self._table = pl.DataFrame()

    def see(self, recorded: pl.DataFrame) -> None:
        """All of it."""
        self._table, self.jumps = truth_rows(recorded)
        self.names = set(self._table["track"].unique())
        self.span_ns = _both(None, self._table["time_ns"])

    def around(self, _epochs: pl.DataFrame, _tolerance_ns: int) -> pl.DataFrame:
        """All rows."""
        return self._table


class Comparison:
    """Joins the nearest truth to epochs that come at once or in pieces of whole tracks, and counts.

    Attributes
    ----------
    doubts : TruthDoubts
        What speaks against the truth, of the epochs so far.

    Raises
    ------
    InputError
        A tolerance below zero.
    """

    def __init__(self, rows: Rows, path: str, tolerance_s: float) -> None:
        if not (np.isfinite(tolerance_s) and tolerance_s >= 0):
            raise InputError("truth_tolerance_s", tolerance_s, "s", "[0, inf)")
        self._rows, self._path, self._tolerance_s = rows, path, tolerance_s
        self._n = self._n_known = self._largest_ns = 0
        self._span_ns: tuple[int, int] | None = None
        self.doubts = TruthDoubts()

    def join(self, epochs: pl.DataFrame) -> pl.DataFrame:
        """Epochs with the nearest truth in time, and the navigation error."""
        several, tolerance_ns = len(self._rows.names) > 1, round(self._tolerance_s * 1e9)
        other = self._rows.around(epochs, tolerance_ns)
        joined = (
            epochs.drop([v for v in _RENAMED.values() if v in epochs.columns])
            .sort("time_ns")
            .join_asof(
                other.sort("time_ns") if several else other.drop("track").sort("time_ns"),
                on="time_ns",
                by="track" if several else None,
                strategy="nearest",
                tolerance=tolerance_ns,
                check_sortedness=False,
            )
            .sort("track", "time_ns")
        )
        self._count(joined)
        # Each epoch is lost for one reason.
        joined = joined.with_columns(contradicted=pl.col("contradicted") & ~pl.col("invalid"))
        imprecise = (pl.col("truth_sigma_m") >= _sigma_m(joined)) & ~pl.col("invalid") & ~pl.col("contradicted")
        joined = joined.with_columns(imprecise=imprecise.fill_null(value=False))
        kept = ~pl.any_horizontal("contradicted", "invalid", "imprecise")
        n_contradicted, n_invalid, n_imprecise = (int(joined[name].sum()) for name in ("contradicted", "invalid", "imprecise"))
        joined = joined.with_columns(pl.when(kept).then(pl.col(name)).alias(name) for name in _RENAMED.values() if name in joined.columns)
        compared, doubts = with_error(joined.drop("truth_time_ns", "contradicted", "invalid", "imprecise", "truth_sigma_m"))
        jumps = tuple(self._rows.jumps) if n_contradicted else ()
        self.doubts += doubts + TruthDoubts(n_contradicted, jumps, n_invalid=n_invalid, n_imprecise=n_imprecise)
        return compared

    def _count(self, joined: pl.DataFrame) -> None:
        apart = (joined["truth_time_ns"] - joined["time_ns"]).abs()
        largest = apart.max()
        self._n += len(apart)
        self._n_known += len(apart) - apart.null_count()
        self._largest_ns = max(self._largest_ns, largest if isinstance(largest, int) else 0)
        self._span_ns = _both(self._span_ns, joined["time_ns"])

    def words(self) -> str:
        """How many epochs have a truth, the largest difference in time, and what speaks against it.

        Raises
        ------
        InputError
            Not one epoch with a truth (a wrong time scale shows itself so).
        """
        if self._n_known == 0:
            spans = f"it spans {_span(self._rows.span_ns)}, the estimates span {_span(self._span_ns or (0, 0))} (UTC)"
            because = f"no epoch of {Path(self._path).name} is within {self._tolerance_s:g} s of one: {spans}"
            raise ConflictError("truth", because=because)
        words = (
            f"Truth: {self._path}, joined to the nearest epoch in time; {self._n_known} of {counted(self._n, 'epoch')} "
            f"{agreeing(self._n_known, 'has', 'have')} one, at most "
            f"{self._largest_ns * 1e-6:g} ms apart (allowed {self._tolerance_s * 1e3:g} ms)."
        )
        return _sentences(words, self.doubts.words)


def _invalid(truth: pl.DataFrame) -> pl.Expr:
    """Rows of a recording that states itself that they are none, or an alert."""
    against = [~pl.col("status").is_in(status.USABLE).fill_null(value=True)] if "status" in truth.columns else []
    alerts = [pl.col(ALERT).is_not_null()] if ALERT in truth.columns else []
    return pl.any_horizontal(*against, *alerts) if against or alerts else pl.lit(value=False)


def _sigma_m(epochs: pl.DataFrame) -> pl.Expr:
    """Root of both horizontal variances as a recording states them; null where it does not. [m]."""
    have = set(epochs.columns)
    if {"cov_ee_m2", "cov_nn_m2"} <= have:
        return (pl.col("cov_ee_m2") + pl.col("cov_nn_m2")).sqrt()
    if {"sigma_e_m", "sigma_n_m"} <= have:
        return (pl.col("sigma_e_m") ** 2 + pl.col("sigma_n_m") ** 2).sqrt()
    return pl.lit(None, pl.Float64)


def _truth_sigma_m(truth: pl.DataFrame) -> pl.Expr:
    """The same of a truth, or what it is at least by the accuracy, level and containment radius that its recording states."""
    bounds = {"epu_m": TWO_DRMS, "unread_accuracy_m": TWO_DRMS, "hpl_m": LEVEL_SIGMAS, "unread_level_m": LEVEL_SIGMAS}
    bounds |= {CONTAINMENT: LEVEL_SIGMAS}
    least = [pl.col(name) / factor for name, factor in bounds.items() if name in truth.columns]
    return pl.max_horizontal(_sigma_m(truth), *least)


def with_error(epochs: pl.DataFrame) -> tuple[pl.DataFrame, TruthDoubts]:
    """Navigation error, true minus estimated, where a truth is known; upwards only where both heights are.

    A truth that contradicts itself is none (:func:`navbound.read.checks.established.established`): the doubts say at how many epochs.
    """
    epochs, doubts = established(epochs)

    def places(prefix: str, fallback: pl.Expr) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        height = pl.coalesce(pl.col(f"{prefix}_h_m"), fallback) if f"{prefix}_h_m" in epochs.columns else fallback
        table = epochs.select(pl.col(f"{prefix}_lat_rad"), pl.col(f"{prefix}_lon_rad"), height.alias("h"))
        return np.ascontiguousarray(table.fill_null(np.nan).to_numpy())

    # A missing height moves the radii by one part in a million, not more: it is no reason to lose the horizontal error.
    error = _core.navigation_error(places("est", pl.lit(0.0)), places("truth", pl.lit(0.0)))
    epochs = epochs.with_columns(pl.Series(f"nse_{axis}_m", error[:, i]).fill_nan(None) for i, axis in enumerate("enu"))
    heights = [pl.col(c).is_not_null() if c in epochs.columns else pl.lit(value=False) for c in ("est_h_m", "truth_h_m")]
    return epochs.with_columns(pl.when(pl.all_horizontal(heights)).then("nse_u_m")), doubts


def _sentences(*words: str) -> str:
    return " ".join(each for each in words if each)


def _span(times_ns: tuple[int, int]) -> str:
    return f"{utc_text(times_ns[0])} to {utc_text(times_ns[1])}"
