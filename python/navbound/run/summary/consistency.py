"""Whether the covariance agrees with the errors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import anp, evaluation
from navbound.methods import column_of
from navbound.records.run import CovarianceConsistency, RegionCoverage
from navbound.run.verdict.results import consistency_words
from navbound.status import USABLE
from navbound.table.columns import COVARIANCE

if TYPE_CHECKING:
    from numpy.typing import NDArray


TRACKS_TO_DRAW = 10
"""Fewer tracks drawn again say little of how tracks differ."""


REGION_RISK = 0.05


def consistency_of(epochs: pl.DataFrame) -> CovarianceConsistency | None:
    """NEES and PIT in three dimensions where the vertical is known, otherwise in two."""
    # A typed sigma is one of the horizontal axes alone.
    vertical = all(name in epochs.columns and np.isfinite(column_of(epochs, name)).any() for name in ("nse_u_m", "cov_uu_m2"))
    errors = ("nse_e_m", "nse_n_m", "nse_u_m") if vertical else ("nse_e_m", "nse_n_m")
    if not set(errors) <= set(epochs.columns) or "cov_ee_m2" not in epochs.columns:
        return None
    error = np.column_stack([column_of(epochs, name) for name in errors])
    upper = np.column_stack([column_of(epochs, name) for name in COVARIANCE[: 6 if vertical else 3]])
    usable = epochs.get_column("status").is_in(USABLE).to_numpy()
    known = usable & np.isfinite(error).all(axis=1) & np.isfinite(upper).all(axis=1)
    if not known.any():
        return None
    ee, en, nn, *rest = upper[known].T
    rows = [[ee, en], [en, nn]]
    if vertical:
        eu, nu, uu = rest
        rows = [[ee, en, eu], [en, nn, nu], [eu, nu, uu]]
    covariance = np.moveaxis(np.array(rows), 2, 0)
    track = codes(epochs)[known]
    nees = evaluation.nees(error[known], covariance, track=track)
    pit = evaluation.pit(error[known], covariance, track=track)
    regions = _regions(error[known], covariance, track)
    return CovarianceConsistency(
        n=nees.n,
        n_effective=nees.n_effective,
        dimension=nees.dimension,
        nees_mean=nees.nees_mean,
        nees_low=nees.nees_low,
        nees_high=nees.nees_high,
        pit_counts=pit.counts,
        pit_low=pit.low,
        pit_high=pit.high,
        regions=regions,
        words=consistency_words(nees, pit, regions),
    )


def _regions(error: NDArray[np.float64], covariance: NDArray[np.float64], track: NDArray[np.int64]) -> list[RegionCoverage]:
    """The 95 % circle and sphere against the error, where there are tracks enough to draw again."""
    if len(np.unique(track)) < TRACKS_TO_DRAW:
        return []
    sizes = {"circle": (np.hypot(error[:, 0], error[:, 1]), anp.circle(np.ascontiguousarray(covariance[:, :2, :2]), REGION_RISK))}
    if error.shape[1] == 3:
        sizes["sphere"] = (np.linalg.norm(error, axis=1), anp.sphere(covariance, REGION_RISK))
    regions = []
    for region, (size, radius) in sizes.items():
        low, high = evaluation.bootstrap_coverage(size, radius, track)
        regions.append(RegionCoverage.model_validate({"region": region, "share": float((size <= radius).mean()), "low": low, "high": high}))
    return regions


def codes(epochs: pl.DataFrame) -> NDArray[np.int64]:
    """Tracks as integers in order of appearance."""
    return epochs.get_column("track").rle_id().cast(pl.Int64).to_numpy()
