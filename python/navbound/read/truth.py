"""Where the aircraft really was: a fixed point, or a second recording joined by time; and the navigation error that follows."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core, status
from navbound.errors import ConflictError, InputError
from navbound.read.checks.established import contradicting, established
from navbound.read.checks.stated import ALERT, CONTAINMENT, LEVEL_SIGMAS, TWO_DRMS
from navbound.read.tables.epochs import read_beside
from navbound.records.truth import TruthDoubts
from navbound.time import utc_text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from navbound.read.tables.epochs import Reading

_OF_TRUTH = {"truth_time": "time", "truth_lat_rad": "est_lat_rad", "truth_lon_rad": "est_lon_rad", "truth_h_m": "est_h_m"}
"""What is declared of a recorded truth, to what it is called in its file."""

TOLERANCE_S = 0.01
"""How far apart in time an estimate and its truth may lie. At 70 m/s a hundredth of a second is 0.7 m."""


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
    """

    stated: str | None
    ecef_m: NDArray[np.float64] | None
    tolerance_s: float
    columns: Mapping[str, str] = field(default_factory=dict)

    @property
    def columns_of_estimates(self) -> Mapping[str, str]:
        """What is declared of the estimates' columns: with a recorded truth those of the truth are in its own file."""
        if self.stated is None or self.ecef_m is not None:
            return self.columns
        return {name: column for name, column in self.columns.items() if name not in _OF_TRUTH}


def truth_of(source: str | Path | None, tolerance_s: float, columns: Mapping[str, str] | None = None) -> Truth:
    """Read ``X,Y,Z`` (Earth-fixed, metres), or take a file's name.

    Raises
    ------
    InputError
        Three numbers that are no place near the Earth's surface.
    """
    if source is None:
        return Truth(None, None, tolerance_s, columns or {})
    text = str(source)
    number = r"\s*[-+]?\d+(?:\.\d*)?\s*"
    if re.fullmatch(f"{number},{number},{number}", text) is None:
        return Truth(text, None, tolerance_s, columns or {})
    point = np.array([float(part) for part in text.split(",")])
    if not 6.3e6 < float(np.linalg.norm(point)) < 6.5e6:
        raise InputError("truth", text, "m", "X,Y,Z of a point within 100 km of the Earth's surface, or a file")
    return Truth(text, point, tolerance_s, columns or {})


def with_truth(epochs: pl.DataFrame, truth: Truth) -> tuple[pl.DataFrame, str, Reading | None, TruthDoubts]:
    """Form the navigation error against a truth that was named; words about it, what was read of its file, what speaks against it.

    What the caller declares of the estimates' columns counts for a recorded truth too, where it has them; ``truth_lat_rad``,
    ``truth_lon_rad``, ``truth_h_m`` and ``truth_time`` are declared of its own.

    Raises
    ------
    InputError
        Epochs without positions; a recording as in :func:`join`.
    """
    if not {"est_lat_rad", "est_lon_rad"} <= set(epochs.columns):
        raise ConflictError("truth", because="the table holds no positions to compare with it")
    if truth.ecef_m is None:
        other = _recorded(truth)
        joined, words, doubts = join(epochs, other, truth.tolerance_s)
        return joined, words, other, doubts
    from navbound import gnss  # noqa: PLC0415  (only with a fixed point)

    place = gnss.geodetic(truth.ecef_m)
    names = ("truth_lat_rad", "truth_lon_rad", "truth_h_m")
    fixed = epochs.with_columns(pl.lit(float(value)).alias(name) for name, value in zip(names, place, strict=True))
    compared, doubts = with_error(fixed)
    return compared, _sentences(f"Truth: the fixed point {truth.stated} m, Earth-fixed.", doubts.words), None, doubts


def _recorded(truth: Truth) -> Reading:
    declared = {_OF_TRUTH[name]: column for name, column in truth.columns.items() if name in _OF_TRUTH}
    return read_beside(str(truth.stated), declared, truth.columns_of_estimates)


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
    if not (np.isfinite(tolerance_s) and tolerance_s >= 0):
        raise InputError("truth_tolerance_s", tolerance_s, "s", "[0, inf)")
    renamed = {"est_lat_rad": "truth_lat_rad", "est_lon_rad": "truth_lon_rad", "est_h_m": "truth_h_m"}
    other = truth.epochs.rename({k: v for k, v in renamed.items() if k in truth.epochs.columns})
    places = [v for v in renamed.values() if v in other.columns]
    other = other.select("track", "time_ns", *places, truth_time_ns="time_ns", invalid=_invalid(other), truth_sigma_m=_truth_sigma_m(other))
    other, jumps = contradicting(other.sort("track", "time_ns"))
    several = other["track"].n_unique() > 1
    joined = (
        epochs.drop([v for v in renamed.values() if v in epochs.columns])
        .sort("time_ns")
        .join_asof(
            other.sort("time_ns") if several else other.drop("track").sort("time_ns"),
            on="time_ns",
            by="track" if several else None,
            strategy="nearest",
            tolerance=round(tolerance_s * 1e9),
            check_sortedness=False,
        )
        .sort("track", "time_ns")
    )
    apart = (joined["truth_time_ns"] - joined["time_ns"]).abs()
    known = len(apart) - apart.null_count()
    if known == 0:
        of = Path(truth.source.path).name
        because = f"no epoch of {of} is within {tolerance_s:g} s of one: it spans {_span(other)}, the estimates span {_span(epochs)} (UTC)"
        raise ConflictError("truth", because=because)
    largest = apart.max()
    words = (
        f"Truth: {truth.source.path}, joined to the nearest epoch in time; {known} of {joined.height} epochs have one, at most "
        f"{float(largest) * 1e-6 if isinstance(largest, int) else 0.0:g} ms apart (allowed {tolerance_s * 1e3:g} ms)."
    )
    # Each epoch is lost for one reason.
    joined = joined.with_columns(contradicted=pl.col("contradicted") & ~pl.col("invalid"))
    imprecise = (pl.col("truth_sigma_m") >= _sigma_m(joined)) & ~pl.col("invalid") & ~pl.col("contradicted")
    joined = joined.with_columns(imprecise=imprecise.fill_null(value=False))
    kept = ~pl.any_horizontal("contradicted", "invalid", "imprecise")
    n_contradicted, n_invalid, n_imprecise = (int(joined[name].sum()) for name in ("contradicted", "invalid", "imprecise"))
    joined = joined.with_columns(pl.when(kept).then(pl.col(name)).alias(name) for name in renamed.values() if name in joined.columns)
    epochs, doubts = with_error(joined.drop("truth_time_ns", "contradicted", "invalid", "imprecise", "truth_sigma_m"))
    doubts += TruthDoubts(n_contradicted, tuple(jumps) if n_contradicted else (), n_invalid=n_invalid, n_imprecise=n_imprecise)
    return epochs, _sentences(words, doubts.words), doubts


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


def _span(frame: pl.DataFrame) -> str:
    times = frame["time_ns"].sort().to_list()
    return f"{utc_text(times[0])} to {utc_text(times[-1])}"
