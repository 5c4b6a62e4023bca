"""Bounds and covariances against truth: does the bound bound, how sharp it is, and whether the covariance may be believed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten
from navbound.tse import exceedance_risk

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from navbound.table.arguments import Labels

CONDITIONAL = (
    "Conditional coverage: the estimate is given and the true position scatters about it, as every bound of the total system error "
    "assumes; an exact bound covers 1 - risk of the epochs."
)
"""The kind of coverage of a simulation whose navigation error does not depend on where the aircraft was steered."""

CLOSED_LOOP = (
    "Closed-loop coverage, between the two kinds: the aircraft steers by its estimate, so slow navigation errors reach the true track "
    "(conditional coverage, 1 - risk) and fast ones only the estimate (repeated-sampling coverage, more than 1 - risk); an exact bound of "
    "the total system error covers at least 1 - risk of the epochs."
)
"""The kind of coverage of a flight whose guidance follows the estimate (docs/methods/coverage.md)."""

REPEATED = (
    "Repeated-sampling coverage: the true deviation is given and the estimate scatters about it; an exact bound of the total system "
    "error then covers more than 1 - risk where the deviation is small (all of it up to about two standard deviations)."
)
"""The kind of coverage of a validation on real flights that keep to their path (docs/methods/coverage.md)."""


@dataclass(frozen=True)
class BoundScore:
    """How one bound at one risk did.

    Attributes
    ----------
    n, n_without_bound, n_outside : int
        Epochs with bound and error; with an error but no bound; with the error not within the bound.
    n_effective : float
        Epochs the coverage is worth: ``n / (1 + 2 sum rho)``.
    coverage, coverage_low, coverage_high : float
        Share of epochs within, and its exact binomial 95 % limits for the effective sample size.
    mean_m, median_m, max_m : float
        Of the bound: its sharpness. [m]
    winkler_m : float
        Mean interval score of ±bound; a bound is better only if it is lower. [m]
    pinball_m : float
        Mean pinball loss of the bound as the quantile ``1 - risk`` of the error's magnitude. [m]
    risk : float
        The risk requested of the bound.
    coverage_kind : str
        Which of the two kinds of coverage this is, as a sentence.

    Notes
    -----
    All are NaN where nothing was counted.
    """

    n: int
    n_without_bound: int
    n_outside: int
    n_effective: float
    coverage: float
    coverage_low: float
    coverage_high: float
    mean_m: float
    median_m: float
    max_m: float
    winkler_m: float
    pinball_m: float
    risk: float
    coverage_kind: str


@dataclass(frozen=True)
class Nees:
    """Mean of e' V⁻¹ e against the chi-square limits (95 %) of a consistent covariance.

    Attributes
    ----------
    n, n_unusable : int
        Epochs used; epochs without an error or with a covariance that is singular, unsymmetric or not a number.
    n_effective : float
        Epochs the mean is worth.
    dimension : int
        What the mean is for a consistent covariance.
    nees_mean, nees_low, nees_high : float
        Above the limits the covariance is too small, below them too large.
    """

    n: int
    n_unusable: int
    n_effective: float
    dimension: int
    nees_mean: float
    nees_low: float
    nees_high: float


@dataclass(frozen=True)
class Pit:
    """Histogram of the probability integral transform of e' V⁻¹ e; flat for a consistent covariance.

    Attributes
    ----------
    n : int
        Epochs used.
    n_effective : float
        Epochs it is worth.
    counts : list of int
        Epochs in each of equal bins.
    low, high : float
        Band (95 %) of one bin, in epochs.
    """

    n: int
    n_effective: float
    counts: list[int]
    low: float
    high: float


@checked
def bound(
    error_m: ArrayLike,
    bound_m: ArrayLike,
    risk: float,
    track: Labels | None = None,
    *,
    coverage_kind: str = REPEATED,
) -> BoundScore:
    """Score a bound against the error, epoch by epoch.

    Parameters
    ----------
    error_m : array_like, shape (n,)
        Error against truth, signed if it has a sign; NaN where truth is not known. [m]
    bound_m : array_like, shape (n,)
        Bound of its magnitude; NaN where there is none. [m]
    risk : float
        The risk requested of the bound.
    track : array_like, shape (n,), optional
        Which epochs follow each other, in order; any labels. All do if not given.
    coverage_kind : {CONDITIONAL, CLOSED_LOOP, REPEATED}
        What scatters in these data. Not known from the data; the weaker statement if not given.

    Returns
    -------
    BoundScore

    Raises
    ------
    InputError
        Columns of unequal length, a risk outside [1e-300, 0.5], a bound that is negative or infinite, or another kind of coverage.

    Notes
    -----
    The correlation is the error's own, not that of its exceedances: for a Gaussian error no function of an epoch is more correlated
    than the epoch, so the effective size is never too large, and it exists without a single exceedance.
    """
    if coverage_kind not in (CONDITIONAL, CLOSED_LOOP, REPEATED):
        domain = "evaluation.CONDITIONAL, evaluation.CLOSED_LOOP, evaluation.REPEATED"
        raise InputError("coverage_kind", repr(coverage_kind)[:60], domain=domain)
    error, limit = _columns(error_m=error_m, bound_m=bound_m)
    return BoundScore(**_core.evaluate_bound(error, limit, risk, _labels(track)), risk=risk, coverage_kind=coverage_kind)


@checked
def bootstrap_coverage(
    error_m: ArrayLike, bound_m: ArrayLike, track: Labels, *, n_replicates: int = 2000, seed: int = 0
) -> tuple[float, float]:
    """Resample whole tracks for a 95 % interval of the coverage (cluster bootstrap).

    Parameters
    ----------
    error_m, bound_m, track : array_like, shape (n,)
        As in `bound`. [m]
    n_replicates : int
        Resamplings.
    seed : int
        The result is a function of it and of the data alone.

    Returns
    -------
    low, high : float

    Raises
    ------
    InputError
        Columns of unequal length, fewer than two tracks, or replicates outside [100, 100000].
    """
    error, limit = _columns(error_m=error_m, bound_m=bound_m)
    if not 0 <= seed < 1 << 64:
        raise InputError("seed", seed, "1", "[0, 2^64)")
    return _core.bootstrap_coverage(error, limit, _labels(track), _count("n_replicates", n_replicates), seed)


@checked
def nees(error_m: ArrayLike, covariance_m2: ArrayLike, track: Labels | None = None) -> Nees:
    """Mean of e' V⁻¹ e with chi-square limits for the effective sample size.

    Parameters
    ----------
    error_m : array_like, shape (n, 2) or (n, 3)
        Navigation error, east-north(-up). [m]
    covariance_m2 : array_like, shape (n, 2, 2) or (n, 3, 3)
        Its claimed covariance. [m²]
    track : array_like, shape (n,), optional
        Which epochs follow each other, in order.

    Raises
    ------
    InputError
        Shapes that do not fit.
    """
    dimension, error, covariance = _vectors(error_m, covariance_m2)
    return Nees(**_core.evaluate_nees(dimension, error, covariance, _labels(track)))


@checked
def pit(error_m: ArrayLike, covariance_m2: ArrayLike, track: Labels | None = None, *, n_bins: int = 20) -> Pit:
    """Histogram of the probability integral transform of e' V⁻¹ e, with its band.

    Parameters
    ----------
    error_m, covariance_m2, track
        As in `nees`.
    n_bins : int
        Equal bins, 2 to 1000.

    Raises
    ------
    InputError
        Shapes that do not fit, or another number of bins.
    """
    dimension, error, covariance = _vectors(error_m, covariance_m2)
    return Pit(**_core.evaluate_pit(dimension, error, covariance, _labels(track), _count("n_bins", n_bins)))


@dataclass(frozen=True)
class Magnitude:
    """Horizontal error in units of its covariance, and how many independent epochs it is worth.

    Attributes
    ----------
    n : int
        Epochs used.
    n_effective : float
        Epochs that the error's components are worth about zero, the smaller of both axes: an error that stays for a whole track is one.
    square_mean : float
        Mean of e' V⁻¹ e, each at most 23.03 (what a true covariance exceeds once in 100 000); 2 for a true covariance.
    p_value : float
        Largest probability of a mean as large for a true covariance, over every dependence between epochs.
    """

    n: int
    n_effective: float
    square_mean: float
    p_value: float


@dataclass(frozen=True)
class Containment:
    """How often a bound contained the error.

    Attributes
    ----------
    coverage, coverage_low, coverage_high : float
        Share of epochs within, and its exact binomial 95 % limits for the effective sample size.
    p_value : float
        Probability of as many epochs outside for a bound that keeps its risk, by a binomial law of the effective size.
    p_value_any : float
        The same over every dependence between epochs.
    """

    coverage: float
    coverage_low: float
    coverage_high: float
    p_value: float
    p_value_any: float


@checked
def magnitude(error_m: ArrayLike, covariance_m2: ArrayLike, track: Labels | None = None) -> Magnitude:
    """Size of the horizontal error against its covariance, with a probability that needs no effective sample size.

    ``p = min(1, exp(1 - m / 2))`` with the time mean m of e' V⁻¹ e: a mean of equally distributed values is in the convex order no larger
    than one of them, so it exceeds their expected shortfall at p with probability p at most (ours, docs/methods/coverage.md).

    Parameters
    ----------
    error_m : array_like, shape (n, 2)
        Navigation error, east-north. [m]
    covariance_m2 : array_like, shape (n, 2, 2)
        Its claimed covariance. [m²]
    track : array_like, shape (n,), optional
        Which epochs follow each other, in order.

    Raises
    ------
    InputError
        Shapes that do not fit.
    """
    dimension, error, covariance = _vectors(error_m, covariance_m2)
    if dimension != 2:
        raise InputError("error_m", f"shape {np.shape(error_m)}", domain="shape (n, 2)")
    return Magnitude(**_core.evaluate_magnitude(error, covariance, _labels(track)))


@checked
def containment(n_outside: int, n: int, n_effective: float, risk: float) -> Containment:
    """How often a bound contained the error, and how probable that is for a bound that keeps its risk.

    Parameters
    ----------
    n_outside, n : int
        Epochs with an error beyond the bound; all epochs with both.
    n_effective : float
        Independent epochs that they are worth, in (0, n].
    risk : float
        The risk requested of the bound.

    Raises
    ------
    InputError
        Counts that cannot be, or a risk outside (0, 1).
    """
    return Containment(**_core.evaluate_containment(_count("n_outside", n_outside), _count("n", n), n_effective, risk))


@checked
def crps(error_m: ArrayLike, sigma_m: ArrayLike) -> NDArray[np.float64]:
    """Continuous ranked probability score of a centred Gaussian: how far its law is from the error that came.

    ``sigma (z (2 Phi(z) - 1) + 2 phi(z) - 1 / sqrt(pi))``, ``z = |error| / sigma`` (Gneiting and Raftery 2007, standard). It is small for a
    law that is sharp and right; a law that claims too little pays as one that claims too much does.

    Parameters
    ----------
    error_m : array_like, shape (n,)
        Error against truth. [m]
    sigma_m : array_like, shape (n,)
        Its claimed standard deviation. [m]

    Returns
    -------
    ndarray, shape (n,)
        [m]

    Raises
    ------
    InputError
        Columns of unequal length, a deviation that is not positive or an error that is not finite.
    """
    error, sigma = _columns(error_m=error_m, sigma_m=sigma_m)
    if error.shape != sigma.shape:
        raise InputError("sigma_m", f"shape {sigma.shape}", domain=f"shape {error.shape}, that of error_m")
    wrong = ~((sigma > 0.0) & np.isfinite(sigma))
    if wrong.any():
        raise InputError("sigma_m", float(sigma[wrong][0]), "m", "(0, inf)")
    if not np.isfinite(error).all():
        raise InputError("error_m", float(error[~np.isfinite(error)][0]), "m", "finite errors")
    z = np.abs(error) / sigma
    inside = 1.0 - exceedance_risk(0.0, 1.0, z)
    density = np.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi)
    return np.asarray(sigma * (z * inside + 2.0 * density - 1.0 / math.sqrt(math.pi)))


@checked
def effective_size(values: ArrayLike, track: Labels | None = None, *, about_zero: bool = False) -> float:
    """Epochs the mean of a correlated series is worth, ``n / (1 + 2 sum rho)``, pooled over tracks; NaN left out.

    Parameters
    ----------
    values : array_like, shape (n,)
        The series.
    track : array_like, shape (n,), optional
        Which values follow each other, in order.
    about_zero : bool
        The mean is known to be zero, as that of an error whose covariance claims no bias: a bias that stays is then correlation.
    """
    (column,) = _columns(values=values)
    return _core.effective_size(column, _labels(track), about_zero)


def _columns(**arguments: ArrayLike) -> list[NDArray[np.float64]]:
    columns = []
    for name, value in arguments.items():
        shape, (column,) = flatten(**{name: (value, ())})
        if len(shape) != 1:
            raise InputError(name, f"shape {shape}", domain="shape (n,)")
        columns.append(column)
    return columns


def _vectors(error_m: ArrayLike, covariance_m2: ArrayLike) -> tuple[int, NDArray[np.float64], NDArray[np.float64]]:
    dimension = np.shape(error_m)[-1] if np.ndim(error_m) == 2 else 0
    if dimension not in (2, 3):
        raise InputError("error_m", f"shape {np.shape(error_m)}", domain="shape (n, 2) or (n, 3)")
    if np.shape(covariance_m2) != (len(np.asarray(error_m)), dimension, dimension):
        raise InputError("covariance_m2", f"shape {np.shape(covariance_m2)}", domain=f"shape (n, {dimension}, {dimension})")
    _, (error, covariance) = flatten(error_m=(error_m, (dimension,)), covariance_m2=(covariance_m2, (dimension, dimension)))
    return dimension, error.ravel(), covariance.ravel()


def _labels(track: Labels | None) -> NDArray[np.uint32]:
    if track is None:
        return np.zeros(0, dtype=np.uint32)
    labels = np.asarray(track)
    if labels.ndim != 1:
        raise InputError("track", f"shape {labels.shape}", domain="shape (n,)")
    try:
        places = np.unique(labels, return_inverse=True)[1]
    except TypeError as e:
        raise InputError("track", "labels of several kinds", domain="numbers, or texts") from e
    return np.ascontiguousarray(places, dtype=np.uint32)


def _count(name: str, value: int) -> int:
    if value < 0:
        raise InputError(name, value, "1", "[0, inf)")
    return int(value)
