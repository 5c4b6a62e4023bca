"""SBAS protection levels from a covariance and from terms that are all given; public in `navbound.sbas`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class FromTerms:
    """What given terms lead to; arrays have shape (n,), one value a satellite.

    Attributes
    ----------
    e_fc_m, e_iono_m : ndarray
        Degradation of the fast correction and of the grid. [m]
    sigma_flt_m, sigma_uive_m, sigma_uire_m, sigma_tropo_m, sigma_air_m, sigma_m : ndarray
        Standard deviations: corrected range, vertical and slant ionosphere, troposphere, receiver, all. [m]
    obliquity : ndarray
        Slant over vertical ionosphere.
    cov_ee_m2, cov_en_m2, cov_nn_m2, cov_uu_m2 : float
        Covariance of the weighted solution. [m²]
    d_major_m : float
        Largest horizontal standard deviation. [m]
    hdop, vdop : float
        Dilution of precision.
    hpl_pa_m, hpl_npa_m, vpl_m : float
        Levels. [m]
    """

    e_fc_m: NDArray[np.float64]
    e_iono_m: NDArray[np.float64]
    sigma_flt_m: NDArray[np.float64]
    sigma_uive_m: NDArray[np.float64]
    obliquity: NDArray[np.float64]
    sigma_uire_m: NDArray[np.float64]
    sigma_tropo_m: NDArray[np.float64]
    sigma_air_m: NDArray[np.float64]
    sigma_m: NDArray[np.float64]
    cov_ee_m2: float
    cov_en_m2: float
    cov_nn_m2: float
    cov_uu_m2: float
    d_major_m: float
    hdop: float
    vdop: float
    hpl_pa_m: float
    hpl_npa_m: float
    vpl_m: float


@checked
def covariance_levels(covariance_m2: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """HPL = 6.0 d_major and VPL = 5.33 d_U of covariances of the position (DO-229D J.2, precision approach; standard).

    They are integrity levels only where the covariance is that of the SBAS error model.

    Parameters
    ----------
    covariance_m2 : array_like, shape (..., 6)
        ee, en, nn, eu, nu, uu; east, north, up. [m²]

    Returns
    -------
    hpl_m, vpl_m : ndarray, shape (...)
        NaN where the six numbers are no covariance. [m]

    Raises
    ------
    InputError
        Another shape.
    """
    shape, (flat,) = flatten(covariance_m2=(covariance_m2, (6,)))
    levels = _core.sbas_covariance_levels(flat)
    return unflatten(levels["hpl_m"], shape), unflatten(levels["vpl_m"], shape)


@checked
def levels_from_terms(
    *,
    az_rad: ArrayLike,
    el_rad: ArrayLike,
    udrei: ArrayLike,
    givei: ArrayLike,
    x_pp: ArrayLike,
    y_pp: ArrayLike,
    delta_udre: ArrayLike = 1.0,
    fast_mps2: ArrayLike = 0.0,
    fast_age_s: ArrayLike = 0.0,
    latency_s: ArrayLike = 0.0,
    e_rrc_m: ArrayLike = 0.0,
    e_ltc_m: ArrayLike = 0.0,
    e_er_m: ArrayLike = 0.0,
    rss_udre: ArrayLike = 0,
    iono_step_m: ArrayLike = 0.0,
    iono_interval_s: ArrayLike = 1.0,
    iono_ramp_mps: ArrayLike = 0.0,
    iono_age_s: ArrayLike = 0.0,
    rss_iono: ArrayLike = 0,
    noise_m: ArrayLike = 0.36,
    divergence_m: ArrayLike = 0.0,
) -> FromTerms:
    """Levels of one solution whose error-model terms are all given.

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (n,)
        Azimuth clockwise from north, elevation. [rad]
    udrei : array_like of int, shape (n,)
        UDRE indicators, 0 to 13.
    givei : array_like of int, shape (n, 4)
        GIVE indicators, 0 to 14, of the cell's corners: north-east, north-west, south-west, south-east.
    x_pp, y_pp : array_like, shape (n,)
        Place of the pierce point in its cell from the south-west corner, in cell widths and heights.
    delta_udre : array_like
        Factor of the UDRE, at least 1.
    fast_mps2, fast_age_s, latency_s : array_like
        Degradation factor a [m/s²], age and system latency [s]: e_fc = a (age + latency)² / 2.
    e_rrc_m, e_ltc_m, e_er_m : array_like
        Further degradations. [m]
    rss_udre, rss_iono : array_like of bool
        Degradations are added as squares.
    iono_step_m, iono_interval_s, iono_ramp_mps, iono_age_s : array_like
        e_iono = step floor(age / interval) + ramp age. [m, s, m/s, s]
    noise_m, divergence_m : array_like
        Receiver. [m]

    Returns
    -------
    FromTerms
        DO-229D appendices A.4.5 and J.2.

    Raises
    ------
    InputError
        An indicator that forbids use, a negative term, or satellites that do not determine a position.
    """
    numbers = (az_rad, el_rad, udrei, delta_udre, fast_mps2, fast_age_s, latency_s, e_rrc_m, e_ltc_m, e_er_m, rss_udre, x_pp, y_pp)
    rest = (iono_step_m, iono_interval_s, iono_ramp_mps, iono_age_s, rss_iono, noise_m, divergence_m)
    names = [
        "az_rad",
        "el_rad",
        "udrei",
        "delta_udre",
        "fast_mps2",
        "fast_age_s",
        "latency_s",
        "e_rrc_m",
        "e_ltc_m",
        "e_er_m",
        "rss_udre",
        "x_pp",
        "y_pp",
    ]
    names_rest = ["iono_step_m", "iono_interval_s", "iono_ramp_mps", "iono_age_s", "rss_iono", "noise_m", "divergence_m"]
    named: dict[str, tuple[ArrayLike, tuple[int, ...]]] = {n: (v, ()) for n, v in zip(names, numbers, strict=True)}
    named["givei"] = (givei, (4,))
    named |= {n: (v, ()) for n, v in zip(names_rest, rest, strict=True)}
    shape, columns = flatten(**named)
    if len(shape) != 1:
        raise InputError("az_rad", f"shape {shape}", domain="shape (n,)")
    try:
        return FromTerms(**_core.sbas_from_terms(np.column_stack(columns)))
    except InputError:
        raise
    except ValueError as e:
        raise InputError("az_rad", f"{shape[0]} satellites", domain=f"satellites that determine a position: {e}") from e
