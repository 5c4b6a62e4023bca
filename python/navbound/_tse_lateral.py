"""Total system error across the path; public as :mod:`navbound.tse`."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound._arrays import flatten, split_columns, unflatten
from navbound.errors import InputError

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


class Rotated(NamedTuple):
    """All lateral bounds in the paper's rotated frame."""

    fte_m: Floats
    """Signed: positive where the estimate is above the line y = k x. [m]"""
    sigma_m: Floats
    """Standard deviation across the line. [m]"""
    factor: Floats
    """K. [1]"""
    exact_m: Floats
    ltem_m: Floats
    sqsm_m: Floats
    ctem_m: Floats
    risk_ltem: Floats
    """True risk at the LTEM bound. [1]"""
    risk_sqsm: Floats
    risk_ctem: Floats


class Explanation(NamedTuple):
    """Everything behind a lateral bound."""

    fte_m: Floats
    """Signed flight technical error. [m]"""
    along_m: Floats
    sigma_m: Floats
    sigma_major_m: Floats
    """Largest horizontal deviation. [m]"""
    sigma_minor_m: Floats
    """Smallest. [m]"""
    factor: Floats
    """K. [1]"""
    exact_m: Floats
    ltem_m: Floats
    sqsm_m: Floats
    ctem_m: Floats
    ctem_foot_m: Floats


def factors(risk: ArrayLike) -> Factors:
    """Factors of a risk in one, two and three dimensions.

    Parameters
    ----------
    risk : array_like, shape (...)
        Allowed risk in (0, 1). [1]

    Returns
    -------
    Factors
        ``two_sided``, ``one_sided``, ``circle``, ``sphere``, shape (...). [1]

    Raises
    ------
    InputError
        A risk outside (0, 1).
    """
    shape, [q] = flatten(risk=(risk, ()))
    return Factors(*split_columns(_core.tse_factors(q), shape))


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
        Allowed risk in (0, 1). [1]

    Raises
    ------
    InputError
        A risk outside (0, 1), or not a single number.
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
        Allowed risk in (0, 1). [1]

    Returns
    -------
    ndarray, shape (...)
        The bound. [m]

    Raises
    ------
    InputError
        Not finite, a negative deviation, or a risk outside (0, 1).
    """
    if _is_single(risk):
        return _prepared(_single(risk))(fte_m, sigma_m)
    shape, [f, s, q] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), risk=(risk, ()))
    return unflatten(_core.tse_exact(f, s, q), shape)


def ltem(fte_m: ArrayLike, sigma_m: ArrayLike, risk: ArrayLike) -> Floats:
    """Bound by the line tangent to the error ellipse: ``|fte| + K sigma`` (F-37 with the sign that E13 restores).

    Between the exact bound and 0.32 deviations above it (0.05) or 0.16 (1e-5); its true risk is between half the stated one and all of it.

    Parameters
    ----------
    fte_m : array_like, shape (...)
        Flight technical error, of either sign. [m]
    sigma_m : array_like, shape (...)
        Standard deviation of the navigation error across the path. [m]
    risk : array_like, shape (...)
        Allowed risk in (0, 1). [1]

    Returns
    -------
    ndarray, shape (...)
        The bound. [m]

    Raises
    ------
    InputError
        Not finite, a negative deviation, or a risk outside (0, 1).
    """
    if _is_single(risk):
        shape, [f, s] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()))
        return unflatten(_core.tse_ltem_at(f, s, _single(risk)), shape)
    shape, [f, s, q] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), risk=(risk, ()))
    return unflatten(_core.tse_ltem(f, s, q), shape)


def sqsm(fte_m: ArrayLike, covariance_en_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """Scalar sum with the largest horizontal deviation: ``|fte| + K max(sigma_a, sigma_b)`` (F-20).

    Parameters
    ----------
    fte_m : array_like, shape (...)
        Flight technical error, of either sign. [m]
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the navigation error, east and north. [m²]
    risk : array_like, shape (...)
        Allowed risk in (0, 1). [1]

    Returns
    -------
    ndarray, shape (...)
        The bound, never below :func:`ltem`. [m]

    Raises
    ------
    InputError
        Not finite, a covariance that is not symmetric or is indefinite, or a risk outside (0, 1).
    """
    shape, [f, c, q] = flatten(fte_m=(fte_m, ()), covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
    return unflatten(_core.tse_sqsm(f, c, q), shape)


def ctem(offset_en_m: ArrayLike, covariance_en_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """Bound by the circle tangent to the error ellipse: its farthest point from the expected point (F-22 to F-32, solved another way).

    The offset counts whole, along the track too, as published; :func:`ctem_foot` is the lateral form.

    Parameters
    ----------
    offset_en_m : array_like, shape (..., 2)
        Estimated position minus expected point, east and north. [m]
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the navigation error, east and north. [m²]
    risk : array_like, shape (...)
        Allowed risk in (0, 1). [1]

    Returns
    -------
    ndarray, shape (...)
        The bound, never below :func:`ltem`. [m]

    Raises
    ------
    InputError
        Not finite, a covariance that is not symmetric or is indefinite, or a risk outside (0, 1).
    """
    shape, [p, c, q] = flatten(offset_en_m=(offset_en_m, (2,)), covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
    return unflatten(_core.tse_ctem(p, c, q), shape)


def ctem_foot(fte_m: ArrayLike, course_rad: ArrayLike, covariance_en_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """CTEM from the closest point of the path, so that the offset along it does not count.

    Parameters
    ----------
    fte_m : array_like, shape (...)
        Flight technical error, positive right of the path. [m]
    course_rad : array_like, shape (...)
        Course of the path, clockwise from true north. [rad]
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the navigation error, east and north. [m²]
    risk : array_like, shape (...)
        Allowed risk in (0, 1). [1]

    Returns
    -------
    ndarray, shape (...)
        The bound, between :func:`ltem` and :func:`sqsm`. [m]

    Raises
    ------
    InputError
        Not finite, a covariance that is not symmetric or is indefinite, or a risk outside (0, 1).
    """
    shape, [f, chi, c, q] = flatten(
        fte_m=(fte_m, ()), course_rad=(course_rad, ()), covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ())
    )
    return unflatten(_core.tse_ctem_foot(f, chi, c, q), shape)


def rssm(
    sigma_fte_m: ArrayLike, sigma_nse_m: ArrayLike, sigma_pde_m: ArrayLike, risk: ArrayLike, *, correlation: ArrayLike = 0.0
) -> Floats:
    """Root sum square: K times the deviation of three errors of mean zero. A figure of many flights, not of this one.

    Parameters
    ----------
    sigma_fte_m, sigma_nse_m, sigma_pde_m : array_like, shape (...)
        Standard deviations of flight technical, navigation system and path definition error. [m]
    risk : array_like, shape (...)
        Allowed risk in (0, 1). [1]
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


def exceedance_risk(fte_m: ArrayLike, sigma_m: ArrayLike, limit_m: ArrayLike) -> Floats:
    """Risk that the total system error exceeds a limit: ``Q((limit - fte)/sigma) + Q((limit + fte)/sigma)``. An alert needs no root.

    Parameters
    ----------
    fte_m : array_like, shape (...)
        Flight technical error, of either sign. [m]
    sigma_m : array_like, shape (...)
        Standard deviation of the navigation error across the path. [m]
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


def rotated_frame(
    k: ArrayLike, x0_m: ArrayLike, y0_m: ArrayLike, sigma_a_m: ArrayLike, sigma_b_m: ArrayLike, *, risk: ArrayLike
) -> Rotated:
    """All lateral bounds in the frame of the paper: axes along the ellipse, the path the line y = k x, the estimate at (x0, y0).

    For comparison with published numbers; :func:`project` needs neither slope nor eigenvectors.

    Parameters
    ----------
    k : array_like, shape (...)
        Slope of the path, plus or minus infinity along the second axis. [1]
    x0_m, y0_m : array_like, shape (...)
        Estimated position. [m]
    sigma_a_m, sigma_b_m : array_like, shape (...)
        Standard deviations along the two axes. [m]
    risk : array_like, shape (...)
        Allowed risk in (0, 1). [1]

    Returns
    -------
    Rotated
        Bounds, and the true risk at each quicker one, shape (...).

    Raises
    ------
    InputError
        A NaN slope, not finite, a negative deviation, or a risk outside (0, 1).
    """
    shape, [slope, x, y, a, b, q] = flatten(
        k=(k, ()), x0_m=(x0_m, ()), y0_m=(y0_m, ()), sigma_a_m=(sigma_a_m, ()), sigma_b_m=(sigma_b_m, ()), risk=(risk, ())
    )
    columns = split_columns(_core.tse_rotated(slope, np.column_stack([x, y]), np.column_stack([a, b]), q), shape)
    fte, sigma, *bounds = columns
    risks = [exceedance_risk(fte, sigma, bound) for bound in bounds[1:]]
    return Rotated(fte, sigma, unflatten(factors(q).two_sided, shape), *bounds, *risks)


def explain(offset_en_m: ArrayLike, covariance_en_m2: ArrayLike, course_rad: ArrayLike, risk: ArrayLike) -> Explanation:
    """Everything behind a lateral bound: projection, axes, factor and each method's result.

    Parameters
    ----------
    offset_en_m : array_like, shape (..., 2)
        Estimated position minus expected point, east and north. [m]
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the navigation error, east and north. [m²]
    course_rad : array_like, shape (...)
        Course of the path, clockwise from true north. [rad]
    risk : array_like, shape (...)
        Allowed risk in (0, 1). [1]

    Returns
    -------
    Explanation
        Lengths of shape (...). [m]

    Raises
    ------
    InputError
        As :func:`project`, or a risk outside (0, 1).
    """
    shape, [p, c, chi, q] = flatten(
        offset_en_m=(offset_en_m, (2,)), covariance_en_m2=(covariance_en_m2, (2, 2)), course_rad=(course_rad, ()), risk=(risk, ())
    )
    fte, along, sigma = project(p, c, chi)
    major, minor = split_columns(_core.tse_axes(c), (len(c),))
    bounds = [exact(fte, sigma, q), ltem(fte, sigma, q), sqsm(fte, c, q), ctem(p, c, q), ctem_foot(fte, chi, c, q)]
    columns = [fte, along, sigma, major, minor, factors(q).two_sided, *bounds]
    return Explanation(*(unflatten(column, shape) for column in columns))


def ltem_as_printed(offset_en_m: ArrayLike, covariance_en_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """LTEM exactly as printed (F-39, slope cot phi, factors 1.96 and 4.41): an exhibit of errata E2, E3 and E13, not a bound.

    Parameters
    ----------
    offset_en_m : array_like, shape (..., 2)
        Estimated position minus expected point, east and north. [m]
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the navigation error, east and north. [m²]
    risk : array_like, shape (...)
        0.05 or 1e-5, the two the paper prints. [1]

    Returns
    -------
    ndarray, shape (...)
        What the printed formula gives; it may be negative. [m]

    Raises
    ------
    InputError
        As :func:`ctem`, or another risk.
    """
    shape, [p, c, q] = flatten(offset_en_m=(offset_en_m, (2,)), covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
    return unflatten(_core.tse_ltem_as_printed(p, c, q), shape)


def _is_single(risk: ArrayLike) -> bool:
    return np.ndim(risk) == 0


def _single(risk: ArrayLike) -> float:
    shape, [q] = flatten(risk=(risk, ()))
    if shape != ():
        raise InputError("risk", f"shape {shape}", domain="a single number")
    return float(q[0])
