"""Bounds of judged epochs against truth, as far as the verdict rests on them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
import polars as pl

from navbound import evaluation
from navbound.evaluation import copies, sizes
from navbound.evaluation.pieces import Series, Sizes
from navbound.methods import column_of, method
from navbound.read.checks.stated import LEVEL_SIGMAS
from navbound.records.run import Belief, BoundCheck, LevelCheck
from navbound.run.verdict import rule
from navbound.status import USABLE
from navbound.storage.tables import Places, pieces, tracks
from navbound.table.columns import HORIZONTAL

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from navbound.evaluation import Magnitude
    from navbound.methods import Method
    from navbound.records.performance import LevelResult
    from navbound.storage.tables import Table

CIRCLE = "anp-circle"
"""The covariance itself as a bound: every lateral bound rests on it."""

LEVELS: tuple[tuple[Literal["hpl_m", "vpl_m"], str], ...] = (("hpl_m", "nse_h_m"), ("vpl_m", "nse_u_m"))
"""Protection levels and the errors that they bound."""

COMPONENTS = {"nse_h_m": ("nse_e_m", "nse_n_m"), "nse_3d_m": ("nse_e_m", "nse_n_m", "nse_u_m")}
"""Signed components of errors that are a length. A length is never negative, so that its correlation about zero says nothing."""

VERTICAL = frozenset({"nse_u_m", "tse_v_m", "nse_3d_m"})
"""Errors in which the vertical is."""

MOST_RATIO = 1e9
"""Largest error over level that is stated: a level of zero has no finite one."""

RISK_UNNAMED = 1e-4
"""Integrity risk of an hour where a level names none: a thousand times what any service level of the table allows, so that a level is never
withdrawn for a demand that it does not make. Provenance: ours. [1]"""

APPROACH_S, HOUR_S = 150.0, 3600.0
"""Exposure of an integrity risk by approach (ICAO Annex 10: any approach, 150 s taken) and by hour."""


@dataclass(frozen=True)
class _Tested:
    """One bound at one risk, with the probabilities of its tests."""

    check: BoundCheck
    p_values: list[float]


@dataclass(frozen=True)
class _Usable:
    """The epochs over which bounds are checked, of a table at once or in pieces."""

    table: Table
    statuses: tuple[str, ...]
    height: int

    @property
    def columns(self) -> set[str]:
        return set(self.table.columns)

    def pieces(self, *names: str) -> Iterator[pl.DataFrame]:
        """Some columns, piece by piece."""
        return (self._of(piece) for piece in pieces(self.table, [*names, "status"]))

    def tracks(self, *names: str) -> Iterator[pl.DataFrame]:
        """The same in pieces of whole tracks."""
        return (self._of(piece) for piece in tracks(self.table, ["track", *names, "status"]))

    def _of(self, piece: pl.DataFrame) -> pl.DataFrame:
        return piece.filter(pl.col("status").is_in(self.statuses))


def _usable(epochs: Table) -> _Usable:
    """Epochs with status ok; where there is none, those that are degraded."""
    counts: Counter[str] = Counter()
    for piece in pieces(epochs, ["status"]):
        counts.update(dict(piece["status"].value_counts().iter_rows()))
    statuses = ("ok",) if counts["ok"] else tuple(USABLE)
    return _Usable(epochs, statuses, sum(counts[each] for each in statuses))


def of_epochs(epochs: Table, judging: str, risks: tuple[float, float], stated: Sequence[str] = ()) -> Belief | None:
    """Check every bound and protection level that the run states against truth; None where no truth is known.

    The lateral verdict rests on the judging method and on the circle; the other stated methods stand beside them. Over epochs with status
    ok; where there is none, over those that are degraded: a bound that nobody vouches for may be false too.

    Parameters
    ----------
    epochs : DataFrame or Frames
        After judging.
    judging : str
        Id of the method that judges.
    risks : (float, float)
        Of accuracy and of integrity. [1]
    stated : sequence of str
        Ids of all methods whose bounds the run states. Exhibits of a misprint claim nothing and are left out.
    """
    usable = _usable(epochs)
    levels = [check for check in (_level(epochs, *names) for names in LEVELS) if check is not None]
    size = _magnitude(usable)
    carrying = list(dict.fromkeys((judging, CIRCLE)))
    bounds = _tested(usable, carrying, risks, lambda _: 0.0 if size is None or not size.n else size.n_effective / size.n)
    if not bounds and not levels:
        return None
    others = [id_ for id_ in dict.fromkeys(stated) if id_ not in carrying and method(id_).may_alert]
    beside = _tested(usable, others, risks, lambda id_: _independent(usable, method(id_)))
    p_values = [] if size is None or not bounds else [size.p_value]
    p_values += [p for tested in bounds for p in tested.p_values]
    p_beside = [p for tested in beside for p in tested.p_values]
    checks = [tested.check for tested in bounds]
    n_truth = sum(int(np.isfinite(column_of(piece, "nse_h_m")).sum()) for piece in usable.pieces("nse_h_m") if "nse_h_m" in piece.columns)
    facts = rule.BeliefFacts(
        n_effective=min((check.n_effective for check in checks), default=1.0),
        p_values=p_values,
        short=any(check.coverage < 1.0 - check.risk for check in checks),
        excluded=any(check.coverage_high < 1.0 - check.risk for check in checks),
        p_values_beside=p_beside,
        excluded_vertical=any(is_excluded_vertical(each.check) for each in beside),
        n_above_vertical_level=sum(check.n_above for check in levels if check.level == "vpl_m"),
        truth_share=n_truth / max(usable.height, 1),
        copied_share=_copied_share(usable),
        square_share=None if size is None else size.square_mean / rule.SQUARE_OF_TRUE,
    )
    return Belief(
        state=rule.of_belief(facts),
        n_epochs=usable.height,
        n_truth=n_truth,
        n_effective=facts.n_effective,
        square_mean=None if size is None else size.square_mean,
        p_value=rule.joint_probability(p_values),
        bounds=_marked(bounds, len(p_values)),
        beside=_marked(beside, len(p_beside)),
        levels=levels,
    )


def is_vertical(check: BoundCheck) -> bool:
    """Whether the vertical is in what a bound judges."""
    return method(check.method).error_column in VERTICAL


def is_excluded_vertical(check: BoundCheck) -> bool:
    """Whether a bound in which the vertical is holds less than it claims by its whole interval."""
    return is_vertical(check) and check.coverage_high < 1.0 - check.risk


def _tested(epochs: _Usable, ids: Sequence[str], risks: tuple[float, float], independent: Callable[[str], float]) -> list[_Tested]:
    """Every method at both risks that has a bound and a true error somewhere; ``independent``: share of its epochs that is independent."""
    tested = []
    for id_ in ids:
        columns = (method(id_).column, method(id_).integrity_column)
        counted = [_outside(epochs, column, method(id_).error_column) for column in columns]
        share = independent(id_) if any(n for _, n in counted) else 0.0
        for risk, (n_outside, n) in zip(risks, counted, strict=True):
            if n:
                tested.append(_test(id_, risk, n_outside, n, share))
    return tested


def _test(id_: str, risk: float, n_outside: int, n: int, share: float) -> _Tested:
    n_effective = min(float(n), max(1.0, share * n))
    contained = evaluation.containment(n_outside, n, n_effective, risk)
    check = BoundCheck(
        method=id_,
        risk=risk,
        n=n,
        n_outside=n_outside,
        n_effective=n_effective,
        coverage=contained.coverage,
        coverage_low=contained.coverage_low,
        coverage_high=contained.coverage_high,
    )
    return _Tested(check, [contained.p_value, contained.p_value_any])


def _marked(tested: Sequence[_Tested], n_tests: int) -> list[BoundCheck]:
    """Which bounds are false. A method has one sigma for all its risks: where one of its bounds is refuted, so is each below its claim."""
    false = {each.check.method for each in tested if rule.is_refuted(each.p_values, n_tests)}
    checks = [each.check for each in tested]
    return [c.model_copy(update={"refuted": c.method in false and c.coverage < 1.0 - c.risk}) for c in checks]


def _independent(epochs: _Usable, of: Method) -> float:
    """Share of the epochs that is independent: the least of the error's components in units of the bound, about zero."""
    shares = []
    for name in COMPONENTS.get(of.error_column, (of.error_column,)):
        series, places = Series(), Places()
        for piece in epochs.pieces("track", of.column, name):
            track = places.of(piece["track"])
            bound = column_of(piece, of.column)
            scaled = column_of(piece, name) / np.where(bound > 0.0, bound, np.nan)
            known = np.isfinite(scaled)
            series.see(scaled[known], track[known])
        if series.n:
            shares.append(series.effective_size(about_zero=True) / series.n)
    return min(shares, default=0.0)


def _level(epochs: Table, level: Literal["hpl_m", "vpl_m"], error: str) -> LevelCheck | None:
    """A protection level against truth; None where no epoch has both."""
    if not {level, error} <= set(epochs.columns):
        return None
    n, n_above, largest = 0, 0, 0.0
    for piece in pieces(epochs, [level, error, "status"]):
        both = piece.filter(pl.col("status").is_in(USABLE)).select(level=pl.col(level), size=pl.col(error).abs()).drop_nulls().drop_nans()
        if both.is_empty():
            continue
        ratio = both.select(pl.when(pl.col("size") == 0.0).then(0.0).otherwise(pl.col("size") / pl.col("level")).max()).item()
        n, largest = n + both.height, max(largest, float(ratio))
        n_above += int(both.select((pl.col("size") > pl.col("level")).sum()).item())
    return LevelCheck(level=level, n=n, n_above=n_above, largest_ratio=min(largest, MOST_RATIO)) if n else None


def _outside(epochs: _Usable, bound: str, error: str) -> tuple[int, int]:
    """Epochs beyond the bound, and epochs with both."""
    n_outside = n = 0
    if {bound, error} <= epochs.columns:
        for piece in epochs.pieces(bound, error):
            limit, size = column_of(piece, bound), np.abs(column_of(piece, error))
            known = np.isfinite(limit) & ~np.isnan(size)
            n_outside, n = n_outside + int((size[known] > limit[known]).sum()), n + int(known.sum())
    return n_outside, n


def columns_of(epochs: pl.DataFrame, *names: str) -> NDArray[np.float64]:
    """Columns side by side, shape (n, k)."""
    return np.column_stack([column_of(epochs, name) for name in names])


def copied(epochs: pl.DataFrame) -> tuple[int, int]:
    """Epochs of errors and levels at which the truth is the estimate, by a sixth of the level as sigma; and epochs with a true error."""
    size = np.fmax(np.abs(column_of(epochs, "hpe_m")), sizes.horizontal(columns_of(epochs, "nse_e_m", "nse_n_m")))
    known = np.isfinite(size)
    same = copies.is_none(size, np.square(column_of(epochs, "hpl_m") / LEVEL_SIGMAS))
    return int(same[known].sum()), int(known.sum())


def _copied_share(epochs: _Usable) -> float:
    """Share of the epochs with truth where it is the estimate itself: no error at all, or one that no true covariance leaves so small."""
    if not {"nse_e_m", "nse_n_m"} <= epochs.columns:
        return 0.0
    decimals = _decimals_of_copies(epochs)
    n = n_same = 0
    for piece in epochs.tracks("nse_e_m", "nse_n_m", "cov_ee_m2", "cov_nn_m2", *copies.DEGREES):
        size = sizes.horizontal(columns_of(piece, "nse_e_m", "nse_n_m"))
        known = np.isfinite(size)
        same = (size == 0.0) | copies.shifted(piece)
        if decimals is not None:
            same |= copies.rounded(piece, decimals)
        if {"cov_ee_m2", "cov_nn_m2"} <= set(piece.columns):
            same |= copies.is_none(size, np.fmin(column_of(piece, "cov_ee_m2"), column_of(piece, "cov_nn_m2")))
        n, n_same = n + int(known.sum()), n_same + int(same[known].sum())
    return n_same / n if n else 0.0


_LEAST_COPIES, _LEAST_PLACES = 0.95, 10
"""Share of the epochs whose truth is the rounded estimate, and places that such a truth must have: one that stands is near by chance.
Provenance: ours."""


def _decimals_of_copies(epochs: _Usable) -> int | None:
    """Decimals of a degree to which the truth is the rounded estimate: to the resolution of such a truth there is no error."""
    if not set(copies.DEGREES) <= epochs.columns:
        return None
    places, n = np.empty((2, 0)), 0
    n_same = dict.fromkeys(copies.DECIMALS, 0)
    for piece in epochs.pieces(*copies.DEGREES):
        degrees, known = copies.in_degrees(piece)
        n += int(known.sum())
        if places.shape[1] < _LEAST_PLACES:
            places = np.unique(np.hstack([places, degrees[:, 1, known]]), axis=1)[:, :_LEAST_PLACES]
        for decimals in copies.DECIMALS:
            n_same[decimals] += int(copies.rounded(piece, decimals).sum())
    if places.shape[1] < _LEAST_PLACES:
        return None
    return next((decimals for decimals in copies.DECIMALS if n_same[decimals] >= _LEAST_COPIES * n), None)


def _magnitude(epochs: _Usable) -> Magnitude | None:
    """The horizontal error in units of its covariance; None where no epoch has both."""
    names = ("nse_e_m", "nse_n_m", *HORIZONTAL)
    if not set(names) <= epochs.columns:
        return None
    axes = [_of_axis(epochs, names, axis) for axis in (0, 1)]
    return replace(axes[0], n_effective=min(each.n_effective for each in axes)) if axes[0].n > 0 else None


def _of_axis(epochs: _Usable, names: Sequence[str], axis: int) -> Magnitude:
    """The same with the effective size of one axis: one series at a time."""
    sizes, places = Sizes(axis), Places()
    for piece in epochs.pieces("track", *names):
        track = places.of(piece["track"])
        east, north, ee, en, nn = (column_of(piece, name) for name in names)
        covariance = np.moveaxis(np.array([[ee, en], [en, nn]]), 2, 0)
        known = np.isfinite(covariance).all(axis=(1, 2)) & np.isfinite(east) & np.isfinite(north)
        sizes.see(np.column_stack([east, north])[known], covariance[known], track[known])
    return sizes.magnitude()


def of_level(result: LevelResult, period_s: float) -> float | None:
    """Largest probability of as many runs of misleading information for a level that keeps its integrity risk.

    ``p = min(1, exposures x risk / runs)`` (Markov), an exposure being an approach of 150 s or an hour with a protection level; None where
    there is no misleading information. A level that names no risk is taken to allow `RISK_UNNAMED`.
    """
    level = result.level
    n_events = result.n_mi_events + result.n_hazard_events
    if n_events == 0:
        return None
    named = level.integrity_risk is not None
    exposure_s = APPROACH_S if named and level.integrity_per == "approach" else HOUR_S
    exposures = max(1.0, result.n_solution * period_s / exposure_s)
    return min(1.0, exposures * (RISK_UNNAMED if level.integrity_risk is None else level.integrity_risk) / n_events)
