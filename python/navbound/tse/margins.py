"""Margins, budgets, risks and slopes of the total system error; public as :mod:`navbound.tse`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, split_columns, unflatten
from navbound.tse.lateral import exact

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


class Gradient(NamedTuple):
    """How the exact bound answers to its inputs."""

    by_fte: Floats
    """dT / d fte. [1]"""
    by_sigma: Floats
    """dT / d sigma. [1]"""


@checked
def margin(fte_m: ArrayLike, sigma_m: ArrayLike, limit_m: ArrayLike, risk: ArrayLike) -> Floats:
    """Limit minus exact bound; negative means the bound is beyond the limit.

    Parameters
    ----------
    fte_m, sigma_m : array_like, shape (...)
        As :func:`exact`. [m]
    limit_m : array_like, shape (...)
        The limit. [m]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    ndarray, shape (...)
        The margin. [m]

    Raises
    ------
    InputError
        As :func:`exact`, or a limit that is not finite or is negative.
    """
    shape, [limit, fte, sigma, q] = flatten(limit_m=(limit_m, ()), fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), risk=(risk, ()))
    _refuse_unless("limit_m", limit, (limit >= 0) & np.isfinite(limit), "[0, inf)")
    return unflatten(limit - exact(fte, sigma, q), shape)


@checked
def gradient(fte_m: ArrayLike, sigma_m: ArrayLike, risk: ArrayLike) -> Gradient:
    """Gradient of the exact bound by its two inputs, in closed form from the implicit function.

    Parameters
    ----------
    fte_m, sigma_m, risk : array_like, shape (...)
        As :func:`exact`.

    Returns
    -------
    Gradient
        ``by_fte`` (with the sign of the error) and ``by_sigma``, shape (...); at ``sigma_m = 0`` from above. [1]

    Raises
    ------
    InputError
        As :func:`exact`.
    """
    shape, [f, s, q] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), risk=(risk, ()))
    return Gradient(*split_columns(_core.tse_gradient(f, s, q), shape))


@checked
def fte_budget(limit_m: ArrayLike, sigma_m: ArrayLike, risk: ArrayLike) -> Floats:
    """Largest flight technical error whose exact bound is within a limit.

    Parameters
    ----------
    limit_m : array_like, shape (...)
        The limit. [m]
    sigma_m : array_like, shape (...)
        Standard deviation of the navigation error across the path. [m]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    ndarray, shape (...)
        The budget, NaN exactly where even an error of zero is too much. [m]

    Raises
    ------
    InputError
        Not finite, a negative limit or deviation, or a risk outside [1e-300, 0.5].
    """
    shape, [limit, s, q] = flatten(limit_m=(limit_m, ()), sigma_m=(sigma_m, ()), risk=(risk, ()))
    return unflatten(_core.tse_fte_budget(limit, s, q), shape)


@checked
def sigma_budget(limit_m: ArrayLike, fte_m: ArrayLike, risk: ArrayLike) -> Floats:
    """Largest standard deviation whose exact bound is within a limit at this flight technical error.

    Parameters
    ----------
    limit_m : array_like, shape (...)
        The limit. [m]
    fte_m : array_like, shape (...)
        Flight technical error, of either sign. [m]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    ndarray, shape (...)
        The budget, NaN exactly where the error alone is beyond the limit. [m]

    Raises
    ------
    InputError
        Not finite, a negative limit, or a risk outside [1e-300, 0.5].
    """
    shape, [limit, f, q] = flatten(limit_m=(limit_m, ()), fte_m=(fte_m, ()), risk=(risk, ()))
    return unflatten(_core.tse_sigma_budget(limit, f, q), shape)


def _refuse_unless(argument: str, values: Floats, good: NDArray[np.bool_], domain: str) -> None:
    """Refuse the first value that is not good."""
    if not good.all():
        index = int(np.argmin(good))
        raise InputError(argument, float(values[index]), "m", domain, index)
