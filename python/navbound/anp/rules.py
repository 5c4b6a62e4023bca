"""Closed approximations and rules of thumb, public through navbound.anp; each says how far off it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


@checked
def circle_fit(covariance_en_m2: ArrayLike, risk: ArrayLike = 0.05) -> Floats:
    """95 % circle by the published cubic, corrected: up to 0.87 % short, holding 94.743 % at worst.

    ``R = sigma_major (1.9625 + 0.4852 r^3)``, r = minor/major; Dai et al. 2022, eq. 11 to 13 with the ratio the right way up.

    Parameters
    ----------
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the horizontal error, east-north. [m²]
    risk : array_like, shape (...)
        0.05; the formula exists for no other. [1]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance, or another risk.
    """
    shape, (v, q) = flatten(covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
    return unflatten(_core.anp_circle_fit(v, q), shape)


@checked
def circle_geodesy(covariance_en_m2: ArrayLike, risk: ArrayLike = 0.05) -> Floats:
    """95 % circle by geodesy's cubic: from 0.0042 sigma_major short to 0.0034 long, holding 94.946 % at worst.

    ``R = sigma_major (1.960790 + 0.004071 r + 0.114276 r^2 + 0.371625 r^3)``, r = minor/major.

    Parameters
    ----------
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the horizontal error, east-north. [m²]
    risk : array_like, shape (...)
        0.05; the formula exists for no other. [1]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance, or another risk.
    """
    shape, (v, q) = flatten(covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
    return unflatten(_core.anp_circle_geodesy(v, q), shape)


@checked
def circle_fit_as_printed(covariance_en_m2: ArrayLike, risk: ArrayLike = 0.05) -> Floats:
    """95 % circle by the published cubic as printed: an exhibit, 2.9 times too long at an axis ratio of two.

    ``R = sigma_major (1.9625 + 0.4852/ratio^3)``, ratio = minor/major; Dai et al. 2022, eq. 11 to 13 as printed. Never for use.

    Parameters
    ----------
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the horizontal error, east-north. [m²]
    risk : array_like, shape (...)
        0.05; the formula exists for no other. [1]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance, a minor axis of zero, or another risk.
    """
    shape, (v, q) = flatten(covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
    return unflatten(_core.anp_circle_fit_as_printed(v, q), shape)


@checked
def sphere_grubbs(covariance_enu_m2: ArrayLike, risk: ArrayLike, mean_enu_m: ArrayLike | None = None) -> Floats:
    """Sphere by Grubbs' use of Wilson and Hilferty's approximation, corrected.

    ``R = sqrt(T) (z sqrt(v/9) + 1 - v/9)^(3/2)``; Dai et al. 2022, eq. 17 with z on its own term. Relative error over all axis
    ratios: risk 0.5 +0.33 to +2.73 %; 0.05 -1.24 to +0.16 %; 0.01 -2.24 to +0.10 %; 1e-5 -4.3 to +5.4 %.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error, east-north-up. [m²]
    risk : array_like, shape (...)
        Risk to be outside. [1]
    mean_enu_m : array_like, shape (..., 3), optional
        Mean of the error, east-north-up; zero when absent. [m]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance, a mean that is not finite, or a risk outside [1e-300, 0.5].
    """
    mean = np.zeros(3) if mean_enu_m is None else mean_enu_m
    shape, (v, q, m) = flatten(covariance_enu_m2=(covariance_enu_m2, (3, 3)), risk=(risk, ()), mean_enu_m=(mean, (3,)))
    return unflatten(_core.anp_sphere_grubbs(v, m, q), shape)


@checked
def sphere_grubbs_as_printed(covariance_enu_m2: ArrayLike, risk: ArrayLike = 0.05) -> Floats:
    """95 % sphere by eq. 17 of Dai et al. 2022 as printed: an exhibit, 17.5 to 34.1 % too long.

    ``R = 1.65 sqrt(T) (sqrt(v/9) + 1 - v/9)^(3/2)``. Never for use.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error, east-north-up. [m²]
    risk : array_like, shape (...)
        0.05; the formula exists for no other. [1]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance, or another risk.
    """
    shape, (v, q) = flatten(covariance_enu_m2=(covariance_enu_m2, (3, 3)), risk=(risk, ()))
    return unflatten(_core.anp_sphere_grubbs_as_printed(v, q), shape)


def _horizontal_sigmas(covariance_en_m2: ArrayLike) -> tuple[Floats, Floats]:
    """Return the larger and the smaller standard deviation of horizontal errors."""
    shape, (v,) = flatten(covariance_en_m2=(covariance_en_m2, (2, 2)))
    spatial = np.zeros((len(v), 3, 3))
    spatial[:, :2, :2] = v
    try:
        sigmas = _core.anp_principal_sigmas(spatial)
    except InputError as e:
        raise InputError("covariance_en_m2", e.value, e.unit, e.domain, e.index) from e
    return sigmas[:, 0].reshape(shape), sigmas[:, 1].reshape(shape)


def _sigmas(covariance_enu_m2: ArrayLike) -> Floats:
    """Return standard deviations along the principal axes, longest first, shape (..., 3)."""
    shape, (v,) = flatten(covariance_enu_m2=(covariance_enu_m2, (3, 3)))
    return _core.anp_principal_sigmas(v).reshape(*shape, 3)


@checked
def cep(covariance_en_m2: ArrayLike) -> Floats:
    """Circular error probable (50 %) by the rule ``0.589 (sigma_1 + sigma_2)``.

    From 12.7 % short to 2.2 % long of ``circle(..., 0.5)``; meant for axis ratios above 0.3.

    Parameters
    ----------
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the error. [m²]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance.
    """
    major, minor = _horizontal_sigmas(covariance_en_m2)
    return np.asarray(0.589 * (major + minor), dtype=np.float64)


@checked
def two_drms(covariance_en_m2: ArrayLike) -> Floats:
    """95 % circle by the rule ``2 sqrt(sigma_1^2 + sigma_2^2)``.

    From 2.0 to 15.6 % longer than ``circle(..., 0.05)``; it holds 95.4 to 98.2 %.

    Parameters
    ----------
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the error. [m²]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance.
    """
    major, minor = _horizontal_sigmas(covariance_en_m2)
    return np.asarray(2.0 * np.hypot(major, minor), dtype=np.float64)


@checked
def circle_major(covariance_en_m2: ArrayLike) -> Floats:
    """95 % circle by the rule ``2.4477 sigma_1``.

    Never short of ``circle(..., 0.05)``, up to 24.9 % longer.

    Parameters
    ----------
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the error. [m²]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance.
    """
    major, _ = _horizontal_sigmas(covariance_en_m2)
    return np.asarray(_core.chi_factor(2, np.array([0.05]))[0] * major, dtype=np.float64)


@checked
def sep_sum(covariance_enu_m2: ArrayLike) -> Floats:
    """Spherical error probable (50 %) by the rule ``0.513 (sigma_1 + sigma_2 + sigma_3)``.

    From 23.9 % short to 0.8 % long of ``sphere(..., 0.5)``.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error. [m²]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance.
    """
    sigmas = _sigmas(covariance_enu_m2)
    return np.asarray(0.513 * sigmas.sum(axis=-1), dtype=np.float64)


@checked
def sphere_rms(covariance_enu_m2: ArrayLike) -> Floats:
    """95 % sphere by the rule ``2.7955 sqrt(T/3)``, T the sum of the variances.

    Never longer than ``sphere(..., 0.05)``, up to 17.7 % short.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error. [m²]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance.
    """
    sigmas = _sigmas(covariance_enu_m2)
    return np.asarray(_core.chi_factor(3, np.array([0.05]))[0] * np.sqrt((sigmas**2).mean(axis=-1)), dtype=np.float64)


@checked
def sphere_mean_sigma(covariance_enu_m2: ArrayLike) -> Floats:
    """95 % sphere by the rule ``2.7955 mean(sigma)``.

    Never longer than ``sphere(..., 0.05)``, up to 52 % short.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error. [m²]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance.
    """
    sigmas = _sigmas(covariance_enu_m2)
    return np.asarray(_core.chi_factor(3, np.array([0.05]))[0] * sigmas.mean(axis=-1), dtype=np.float64)


@checked
def sphere_major(covariance_enu_m2: ArrayLike) -> Floats:
    """95 % sphere by the rule ``2.7955 sigma_1``.

    Never short of ``sphere(..., 0.05)``, up to 42.6 % longer.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error. [m²]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance.
    """
    sigmas = _sigmas(covariance_enu_m2)
    return np.asarray(_core.chi_factor(3, np.array([0.05]))[0] * sigmas[..., 0], dtype=np.float64)
