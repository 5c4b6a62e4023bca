"""Whether the covariance agrees with the errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import anp
from navbound.evaluation import sizes
from navbound.evaluation.pieces import Squares, TrackCounts
from navbound.methods import column_of
from navbound.records.run import CovarianceConsistency, RegionCoverage
from navbound.run.verdict.results import consistency_words
from navbound.status import USABLE
from navbound.storage.tables import Places, has_values, pieces
from navbound.table.columns import COVARIANCE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from navbound.storage.tables import Table


TRACKS_TO_DRAW = 10
"""Fewer tracks drawn again say little of how tracks differ."""


REGION_RISK = 0.05


@dataclass(frozen=True)
class _Known:
    """Epochs with an error and a covariance."""

    error_m: NDArray[np.float64]
    covariance_m2: NDArray[np.float64]
    track: NDArray[np.uint32]


def consistency_of(epochs: Table) -> CovarianceConsistency | None:
    """NEES and PIT in three dimensions where the vertical is known, otherwise in two."""
    # A typed sigma is one of the horizontal axes alone.
    vertical = all(has_values(epochs, name) for name in ("nse_u_m", "cov_uu_m2"))
    errors = ("nse_e_m", "nse_n_m", "nse_u_m") if vertical else ("nse_e_m", "nse_n_m")
    if not set(errors) <= set(epochs.columns) or "cov_ee_m2" not in epochs.columns:
        return None
    dimension = len(errors)
    # One number an epoch is kept at a time: the series of the squares, and then that of their transform.
    squares, tracks = Squares(dimension), set[int]()
    for known in _known(epochs, errors):
        squares.see(known.error_m, known.covariance_m2, known.track)
        tracks |= set(np.unique(known.track).tolist())
    if not tracks:
        return None
    nees = squares.nees()
    squares = Squares(dimension)
    for known in _known(epochs, errors):
        squares.see(known.error_m, known.covariance_m2, known.track)
    pit = squares.pit()
    regions = _regions(epochs, errors) if len(tracks) >= TRACKS_TO_DRAW else []
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


def _known(epochs: Table, errors: tuple[str, ...]) -> Iterator[_Known]:
    """Piece by piece."""
    vertical, places = len(errors) == 3, Places()
    names = COVARIANCE[: 6 if vertical else 3]
    for piece in pieces(epochs, ["track", "status", *errors, *names]):
        track = places.of(piece["track"])
        error = np.column_stack([column_of(piece, name) for name in errors])
        upper = np.column_stack([column_of(piece, name) for name in names])
        usable = piece.get_column("status").is_in(USABLE).to_numpy()
        known = usable & np.isfinite(error).all(axis=1) & np.isfinite(upper).all(axis=1)
        if not known.any():
            continue
        ee, en, nn, *rest = upper[known].T
        rows = [[ee, en], [en, nn]]
        if vertical:
            eu, nu, uu = rest
            rows = [[ee, en, eu], [en, nn, nu], [eu, nu, uu]]
        yield _Known(error[known], np.moveaxis(np.array(rows), 2, 0), track[known])


def _regions(epochs: Table, errors: tuple[str, ...]) -> list[RegionCoverage]:
    """The 95 % circle and sphere against the error, of tracks that are enough to draw again."""
    counts = {region: TrackCounts() for region in ("circle", "sphere")[: len(errors) - 1]}
    for known in _known(epochs, errors):
        error, covariance = known.error_m, known.covariance_m2
        circle = anp.circle(np.ascontiguousarray(covariance[:, :2, :2]), REGION_RISK)
        counts["circle"].see(sizes.horizontal(error), circle, known.track)
        if "sphere" in counts:
            counts["sphere"].see(sizes.spatial(error), anp.sphere(covariance, REGION_RISK), known.track)
    regions = []
    for region, count in counts.items():
        low, high = count.bootstrap()
        regions.append(RegionCoverage.model_validate({"region": region, "share": count.share, "low": low, "high": high}))
    return regions
