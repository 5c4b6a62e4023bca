"""Where the truth is the estimate itself: no error at all, or one that no true covariance leaves so small."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.methods import column_of
from navbound.units import EARTH_RADIUS_M

if TYPE_CHECKING:
    from numpy.typing import NDArray

SAME_M, SAME_AT = 0.005, 1e-6
"""An error at most this large [m] that a true covariance leaves at most so improbable [1] is no error of a measurement: half of what 1e-7
degree are, in which tables state positions. A precise truth beside a precise estimate has a covariance that makes such errors probable.
Provenance: ours."""

_TRAVELS_M = 100.0
"""Extent of a track above which an error that stays the same to `SAME_M` is an offset of one solution: the error of two measurements
moves with satellites and reflections. Provenance: ours."""

DECIMALS = range(3, 8)
"""Decimals of a degree in which positions are written: 111 m to 1 cm. [1]"""


DEGREES = ("est_lat_rad", "truth_lat_rad", "est_lon_rad", "truth_lon_rad")
"""Positions of which the decimals are compared."""


def is_none(size_m: NDArray[np.float64], variance_m2: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where errors are no errors of a measurement, by their size and the smaller variance of both axes.

    P(e' V^-1 e <= x) = 1 - exp(-x / 2); the smaller variance makes x largest, which is the careful side.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        improbable = -np.expm1(-0.5 * size_m**2 / variance_m2) <= SAME_AT
    none: NDArray[np.bool_] = (size_m == 0.0) | ((size_m <= SAME_M) & improbable)
    return none


def shifted(epochs: pl.DataFrame) -> NDArray[np.bool_]:
    """Epochs of moving tracks whose truth is the estimate but for one constant offset."""
    none = np.zeros(epochs.height, dtype=np.bool_)
    if not {"est_lat_rad", "est_lon_rad", "cov_ee_m2", "cov_nn_m2"} <= set(epochs.columns):
        return none
    north_m = pl.col("est_lat_rad") * EARTH_RADIUS_M
    east_m = pl.col("est_lon_rad") * pl.col("est_lat_rad").cos() * EARTH_RADIUS_M
    extent_m = pl.max_horizontal((each.max() - each.min()).over("track") for each in (north_m, east_m))
    moved_m = [pl.col(name) - pl.col(name).median().over("track") for name in ("nse_e_m", "nse_n_m")]
    size_m = pl.sum_horizontal(each**2 for each in moved_m).sqrt()
    variance = pl.min_horizontal("cov_ee_m2", "cov_nn_m2")
    improbable = -(-0.5 * size_m**2 / variance).exp() + 1.0 <= SAME_AT
    same = epochs.select(((extent_m > _TRAVELS_M) & (size_m <= SAME_M) & improbable).fill_null(value=False).alias("same"))["same"]
    return same.to_numpy()


def in_degrees(epochs: pl.DataFrame) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Latitude and longitude of estimate and truth, shape (2, 2, n), and where all are known."""
    degrees: NDArray[np.float64] = np.degrees([column_of(epochs, name) for name in DEGREES]).reshape(2, 2, -1)
    known: NDArray[np.bool_] = np.asarray(np.isfinite(degrees).all(axis=(0, 1)))
    return degrees, known


def rounded(epochs: pl.DataFrame, decimals: int) -> NDArray[np.bool_]:
    """Epochs whose truth is the estimate rounded so."""
    degrees, known = in_degrees(epochs)
    apart = np.abs(np.round(degrees[:, 0], decimals) - degrees[:, 1])
    # A thousandth of the resolution: radians in between and back.
    same: NDArray[np.bool_] = np.all(apart <= 10.0 ** -(decimals + 3), axis=0) & known
    return same
