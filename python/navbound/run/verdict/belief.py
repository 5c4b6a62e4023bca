"""Bounds of judged epochs against truth, as far as the verdict rests on them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import evaluation
from navbound.methods import column_of, method
from navbound.run.records import Belief, BoundCheck
from navbound.run.verdict import rule
from navbound.status import USABLE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.run.kpi_records import LevelResult

CIRCLE = "anp-circle"
"""The covariance itself as a bound: every lateral bound rests on it."""

RISK_UNNAMED = 1e-4
"""Integrity risk of an hour where a level names none: a thousand times what any service level of the table allows, so that a level is never
withdrawn for a demand that it does not make. Provenance: ours. [1]"""

APPROACH_S, HOUR_S = 150.0, 3600.0
"""Exposure of an integrity risk by approach (ICAO Annex 10: any approach, 150 s taken) and by hour."""


def of_epochs(epochs: pl.DataFrame, judging: str, risks: tuple[float, float]) -> Belief | None:
    """Check the judging method and the circle at both risks against truth; None where no truth is known.

    Over epochs with status ok; where there is none, over those that are degraded: a bound that nobody vouches for may be false too.

    Parameters
    ----------
    epochs : DataFrame
        After judging.
    judging : str
        Id of the method that judges.
    risks : (float, float)
        Of accuracy and of integrity. [1]
    """
    vouched = epochs.filter(pl.col("status") == "ok")
    usable = vouched if vouched.height else epochs.filter(pl.col("status").is_in(USABLE))
    counted = [
        (id_, risk, *_outside(usable, method(id_).integrity_column if integrity else method(id_).column, method(id_).error_column))
        for id_ in dict.fromkeys((judging, CIRCLE))
        for risk, integrity in zip(risks, (False, True), strict=True)
    ]
    counted = [each for each in counted if each[3] > 0]
    if not counted:
        return None
    size = _magnitude(usable)
    n_known, n_independent, square_mean, p_size = (
        (0, 1.0, None, None) if size is None else (size.n, size.n_effective, size.square_mean, size.p_value)
    )
    # The error of the navigation system alone scatters: how long it stays decides for every bound.
    share = n_independent / n_known if n_known else 0.0
    checks, p_values = [], [] if p_size is None else [p_size]
    for id_, risk, n_outside, n in counted:
        n_effective = min(float(n), max(1.0, share * n))
        contained = evaluation.containment(n_outside, n, n_effective, risk)
        p_values += [contained.p_value, contained.p_value_any]
        checks.append(
            BoundCheck(
                method=id_,
                risk=risk,
                n=n,
                n_outside=n_outside,
                n_effective=n_effective,
                coverage=contained.coverage,
                coverage_low=contained.coverage_low,
                coverage_high=contained.coverage_high,
            )
        )
    facts = rule.BeliefFacts(
        n_effective=min(check.n_effective for check in checks),
        p_values=p_values,
        short=any(check.coverage < 1.0 - check.risk for check in checks),
        excluded=any(check.coverage_high < 1.0 - check.risk for check in checks),
    )
    return Belief(
        state=rule.of_belief(facts),
        n_effective=facts.n_effective,
        square_mean=square_mean,
        p_value=rule.joint_probability(p_values),
        bounds=checks,
    )


def _outside(epochs: pl.DataFrame, bound: str, error: str) -> tuple[int, int]:
    """Epochs beyond the bound, and epochs with both."""
    if not {bound, error} <= set(epochs.columns):
        return 0, 0
    limit, size = column_of(epochs, bound), np.abs(column_of(epochs, error))
    known = np.isfinite(limit) & ~np.isnan(size)
    return int((size[known] > limit[known]).sum()), int(known.sum())


def _magnitude(epochs: pl.DataFrame) -> evaluation.Magnitude | None:
    """The horizontal error in units of its covariance; None where no epoch has both."""
    names = ("nse_e_m", "nse_n_m", "cov_ee_m2", "cov_en_m2", "cov_nn_m2")
    if not set(names) <= set(epochs.columns):
        return None
    east, north, ee, en, nn = (column_of(epochs, name) for name in names)
    covariance = np.moveaxis(np.array([[ee, en], [en, nn]]), 2, 0)
    known = np.isfinite(covariance).all(axis=(1, 2)) & np.isfinite(east) & np.isfinite(north)
    if not known.any():
        return None
    track: NDArray[np.int64] = epochs.get_column("track").rle_id().cast(pl.Int64).to_numpy()
    error = np.column_stack([east, north])
    found = evaluation.magnitude(error[known], covariance[known], track[known])
    return found if found.n > 0 else None


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
