"""Total system error across the path; public as :mod:`navbound.tse`."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, split_columns, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


class Factors(NamedTuple):
    """How many standard deviations a risk leaves outside."""

    two_sided: Floats
    """K: on both sides of a line. [1]"""
    one_sided: Floats
    """z: on one side. [1]"""
    circle: Floats
    """Radius for two equal deviations. [1]"""
    sphere: Floats
    """Radius for three. [1]"""


class Projection(NamedTuple):
    """The lateral situation."""

    fte_m: Floats
    """Flight technical error, positive right of the path. [m]"""
    along_m: Floats
    """Estimate ahead of the expected point. [m]"""
    sigma_m: Floats
    """Standard deviation of the navigation error across the path. [m]"""


@checked
def factors(risk: ArrayLike) -> Factors:
    """Factors of a risk in one, two and three dimensions.

    Parameters
    ----------
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    Factors
        ``two_sided``, ``one_sided``, ``circle``, ``sphere``, shape (...). [1]

    Raises
    ------
    InputError
        A risk outside [1e-300, 0.5].
    """
    shape, [q] = flatten(risk=(risk, ()))
    return Factors(*split_columns(_core.tse_factors(q), shape))


@checked
def project(offset_en_m: ArrayLike, covariance_en_m2: ArrayLike, course_rad: ArrayLike) -> Projection:
    """Project the horizontal situation onto the line across the path.

    ``fte = n . p``, ``along = t . p``, ``sigma^2 = n' C n`` with ``t = (sin chi, cos chi)`` and ``n = (cos chi, -sin chi)``.

    Parameters
    ----------
    offset_en_m : array_like, shape (..., 2)
        Estimated position minus expected point, east and north. [m]
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the navigation error, east and north. [m²]
    course_rad : array_like, shape (...)
        Course of the path, clockwise from true north. [rad]

    Returns
    -------
    Projection
        ``fte_m`` (positive right), ``along_m``, ``sigma_m``, shape (...). [m]

    Raises
    ------
    InputError
        Not finite, or a covariance that is not symmetric (1e-9) or is indefinite.
    """
    shape, [p, c, chi] = flatten(offset_en_m=(offset_en_m, (2,)), covariance_en_m2=(covariance_en_m2, (2, 2)), course_rad=(course_rad, ()))
    return Projection(*split_columns(_core.tse_project(p, c, chi), shape))


class Exact:
    """The exact bound prepared for one risk: a table worked out once, then a few operations an epoch.

    The results agree with the iterative solver to 1e-13 relative for every risk from 1e-9 to 0.5 and every ratio of error to deviation.

    Parameters
    ----------
    risk : float
        Allowed risk in [1e-300, 0.5]. [1]

    Raises
    ------
    InputError
        A risk outside [1e-300, 0.5], or not a single number.
    """

    def __init__(self, risk: float) -> None:
        self.risk = _single(risk)
        self._prepared = _core.TsePrepared(self.risk)

    def __call__(self, fte_m: ArrayLike, sigma_m: ArrayLike) -> Floats:
        """Exact bounds.

        Parameters
        ----------
        fte_m : array_like, shape (...)
            Flight technical error, of either sign. [m]
        sigma_m : array_like, shape (...)
            Standard deviation of the navigation error across the path. [m]

        Returns
        -------
        ndarray, shape (...)
            Total system error not exceeded but with the prepared risk. [m]

        Raises
        ------
        InputError
            Not finite, or a negative deviation.
        """
        shape, [f, s] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()))
        return unflatten(self._prepared.exact(f, s), shape)


_prepared = lru_cache(maxsize=32)(Exact)


@checked
def exact(fte_m: ArrayLike, sigma_m: ArrayLike, risk: ArrayLike) -> Floats:
    """Exact bound of the total system error (F-7, F-11 in one dimension).

    The root T of ``Q((T - fte)/sigma) + Q((T + fte)/sigma) = risk``. One risk for all epochs is answered from a table that is kept
    (:class:`Exact`); a risk for each epoch is solved by three Halley steps. The two agree to 1e-13.

    Parameters
    ----------
    fte_m : array_like, shape (...)
        Flight technical error, of either sign. [m]
    sigma_m : array_like, shape (...)
        Standard deviation of the navigation error across the path. [m]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    ndarray, shape (...)
        The bound. [m]

    Raises
    ------
    InputError
        Not finite, a negative deviation, or a risk outside [1e-300, 0.5].
    """
    if _is_single(risk):
        return _prepared(_single(risk))(fte_m, sigma_m)
    shape, [f, s, q] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), risk=(risk, ()))
    return unflatten(_core.tse_exact(f, s, q), shape)


@checked
def ltem(fte_m: ArrayLike, sigma_m: ArrayLike, risk: ArrayLike) -> Floats:
    """Bound by the line tangent to the error ellipse: ``|fte| + K sigma`` (F-37 with the sign that E13 restores).

    Between the exact bound and 0.32 deviations above it (0.05) or 0.16 (1e-5); its true risk is between half the stated one and all of it.

    Parameters
    ----------
    fte_m, sigma_m, risk : array_like, shape (...)
        As :func:`exact`. [m, m, 1]

    Returns
    -------
    ndarray, shape (...)
        The bound. [m]

    Raises
    ------
    InputError
        As :func:`exact`.
    """
    if _is_single(risk):
        shape, [f, s] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()))
        return unflatten(_core.tse_ltem_at(f, s, _single(risk)), shape)
    shape, [f, s, q] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), risk=(risk, ()))
    return unflatten(_core.tse_ltem(f, s, q), shape)


@checked
def sqsm(fte_m: ArrayLike, covariance_en_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """Scalar sum with the largest horizontal deviation: ``|fte| + K max(sigma_a, sigma_b)`` (F-20).

    Parameters
    ----------
    fte_m, risk : array_like, shape (...)
        As :func:`exact`. [m, 1]
    covariance_en_m2 : array_like, shape (..., 2, 2)
        As :func:`project`. [m²]

    Returns
    -------
    ndarray, shape (...)
        The bound, never below :func:`ltem`. [m]

    Raises
    ------
    InputError
        As :func:`project`, or a risk outside [1e-300, 0.5].
    """
    shape, [f, c, q] = flatten(fte_m=(fte_m, ()), covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
    return unflatten(_core.tse_sqsm(f, c, q), shape)


@checked
def ctem(offset_en_m: ArrayLike, covariance_en_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """Bound by the circle tangent to the error ellipse: its farthest point from the expected point (F-22 to F-32, solved another way).

    The offset counts whole, along the track too, as published; :func:`ctem_foot` is the lateral form.

    Parameters
    ----------
    offset_en_m, covariance_en_m2 : array_like, shapes (..., 2) and (..., 2, 2)
        As :func:`project`. [m, m²]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    ndarray, shape (...)
        The bound, never below :func:`ltem`. [m]

    Raises
    ------
    InputError
        As :func:`project`, or a risk outside [1e-300, 0.5].
    """
    shape, [p, c, q] = flatten(offset_en_m=(offset_en_m, (2,)), covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
    return unflatten(_core.tse_ctem(p, c, q), shape)


@checked
def ctem_foot(fte_m: ArrayLike, course_rad: ArrayLike, covariance_en_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """CTEM from the closest point of the path, so that the offset along it does not count.

    Parameters
    ----------
    fte_m : array_like, shape (...)
        Flight technical error, positive right of the path. [m]
    course_rad, covariance_en_m2 : array_like, shapes (...) and (..., 2, 2)
        As :func:`project`. [rad, m²]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    ndarray, shape (...)
        The bound, between :func:`ltem` and :func:`sqsm`. [m]

    Raises
    ------
    InputError
        As :func:`project`, or a risk outside [1e-300, 0.5].
    """
    shape, [f, chi, c, q] = flatten(
        fte_m=(fte_m, ()), course_rad=(course_rad, ()), covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ())
    )
    return unflatten(_core.tse_ctem_foot(f, chi, c, q), shape)


@checked
def rssm(
    sigma_fte_m: ArrayLike, sigma_nse_m: ArrayLike, sigma_pde_m: ArrayLike, risk: ArrayLike, *, correlation: ArrayLike = 0.0
) -> Floats:
    """Root sum square: K times the deviation of three errors of mean zero. A figure of many flights, not of this one.

    Parameters
    ----------
    sigma_fte_m, sigma_nse_m, sigma_pde_m : array_like, shape (...)
        Standard deviations of flight technical, navigation system and path definition error. [m]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]
    correlation : array_like, shape (...)
        Correlation of flight technical and navigation system error, in [-1, 1]. [1]

    Returns
    -------
    ndarray, shape (...)
        The bound. [m]

    Raises
    ------
    InputError
        Not finite, a negative deviation, or a correlation or risk outside its domain.
    """
    shape, [f, n, p, rho, q] = flatten(
        sigma_fte_m=(sigma_fte_m, ()),
        sigma_nse_m=(sigma_nse_m, ()),
        sigma_pde_m=(sigma_pde_m, ()),
        correlation=(correlation, ()),
        risk=(risk, ()),
    )
    return unflatten(_core.tse_rssm(np.column_stack([np.zeros_like(f), f, n, p, rho]), q), shape)


@checked
def exceedance_risk(fte_m: ArrayLike, sigma_m: ArrayLike, limit_m: ArrayLike) -> Floats:
    """Risk that the total system error exceeds a limit: ``Q((limit - fte)/sigma) + Q((limit + fte)/sigma)``. An alert needs no root.

    Parameters
    ----------
    fte_m, sigma_m : array_like, shape (...)
        As :func:`exact`. [m]
    limit_m : array_like, shape (...)
        The limit, e.g. RNP or twice RNP. [m]

    Returns
    -------
    ndarray, shape (...)
        The risk, zero where it underflows (see :func:`log_exceedance_risk`). [1]

    Raises
    ------
    InputError
        Not finite, or a negative deviation or limit.
    """
    shape, [f, s, limit] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), limit_m=(limit_m, ()))
    return unflatten(np.ascontiguousarray(_core.tse_exceedance(f, s, limit)[:, 0]), shape)


@checked
def log_exceedance_risk(fte_m: ArrayLike, sigma_m: ArrayLike, limit_m: ArrayLike) -> Floats:
    """Natural logarithm of :func:`exceedance_risk`, finite where the risk itself underflows; -inf only where sigma is zero.

    Parameters
    ----------
    fte_m, sigma_m, limit_m : array_like, shape (...)
        As :func:`exceedance_risk`. [m]

    Returns
    -------
    ndarray, shape (...)
        ln of the risk. [1]

    Raises
    ------
    InputError
        Not finite, or a negative deviation or limit.
    """
    shape, [f, s, limit] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), limit_m=(limit_m, ()))
    return unflatten(np.ascontiguousarray(_core.tse_exceedance(f, s, limit)[:, 1]), shape)


def _is_single(risk: ArrayLike) -> bool:
    return type(risk) is float or np.ndim(risk) == 0


def _single(risk: ArrayLike) -> float:
    if type(risk) is float:
        return risk
    shape, [q] = flatten(risk=(risk, ()))
    if shape != ():
        raise InputError("risk", f"shape {shape}", domain="a single number")
    return float(q[0])
