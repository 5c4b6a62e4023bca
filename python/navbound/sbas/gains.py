"""What the Error Extraction filter does to noise, the factors of its bound, and the worst bias; **experimental, not integrity**.

Source: Vassilev and Vassileva 2012, equations 5 and 7; the gains are ours (docs/methods/error-extraction.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.status import availability, reasons_of
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

_DECLARED = _core.ee_declaration()

MU_MOST_M = float(_DECLARED["mu_most_m"])
"""Largest bias of a range in the paper. [m]"""
ALPHA = float(_DECLARED["alpha"])
"""The paper's allowance for weights; it is not one."""


def whole(name: str, values: ArrayLike, domain: str) -> NDArray[np.int64] | NDArray[np.uint64]:
    """Give whole numbers as they are; anything else is refused."""
    array = np.asarray(values)
    if array.dtype.kind not in "iu":
        raise InputError(name, f"{array.dtype}", domain=domain)
    return array


def _columns(table: Floats, shape: tuple[int, ...]) -> list[Floats]:
    return [unflatten(np.ascontiguousarray(table[:, k]), shape) for k in range(table.shape[1])]


@dataclass(frozen=True)
class ExtractionGains:
    """What the filter does to noise; closed forms (ours).

    Attributes
    ----------
    white_var_gain : ndarray
        var(u) / var(position error) for white errors.
    nyquist_gain : ndarray
        Gain at half the sampling rate.
    velocity_sd_gain_s : ndarray
        sd(u) for white velocity noise of 1 m/s. [s]
    corrected_white_var_gain : ndarray
        var(corrected) / var(position error) for white errors.
    n_settle_5_percent, n_settle_1_percent : ndarray
        Samples after which the answer to a step stays below the share.
    """

    white_var_gain: Floats
    nyquist_gain: Floats
    velocity_sd_gain_s: Floats
    corrected_white_var_gain: Floats
    n_settle_5_percent: Floats
    n_settle_1_percent: Floats


@checked
def extraction_gains(rho: ArrayLike, period_s: ArrayLike = 1.0) -> ExtractionGains:
    """Gains of the filter.

    Parameters
    ----------
    rho : array_like
        Pole, in (0, 1).
    period_s : array_like
        Sample period. [s]

    Raises
    ------
    InputError
        A number outside its domain.
    """
    shape, (poles, periods) = flatten(rho=(rho, ()), period_s=(period_s, ()))
    gains = _core.ee_gains(poles, periods)
    return ExtractionGains(*_columns(gains, shape))


@dataclass(frozen=True)
class ExtractionBeta:
    """What a Gauss-Markov error of one correlation time makes of the filter.

    Attributes
    ----------
    beta : ndarray
        sd(position error) / sd(u).
    corrected_sd_ratio : ndarray
        sd(corrected) / sd(position error); above 1 the filter makes matters worse.
    tau_s : ndarray
        The correlation time that was assumed. [s]
    """

    beta: Floats
    corrected_sd_ratio: Floats
    tau_s: Floats


@checked
def extraction_beta(tau_s: ArrayLike, *, rho: ArrayLike = 0.98, period_s: ArrayLike = 1.0) -> ExtractionBeta:
    """Beta for an error that forgets in ``tau_s``: it has no upper bound, but grows as the root of tau.

    Parameters
    ----------
    tau_s : array_like
        Correlation time; 0 for white errors. [s]
    rho : array_like
        Pole, in (0, 1).
    period_s : array_like
        Sample period. [s]

    Raises
    ------
    InputError
        A number outside its domain.
    """
    shape, (taus, poles, periods) = flatten(tau_s=(tau_s, ()), rho=(rho, ()), period_s=(period_s, ()))
    betas = _core.ee_beta(poles, periods, taus)
    beta, ratio = _columns(betas, shape)
    return ExtractionBeta(beta, ratio, unflatten(taus, shape))


@checked
def extraction_beta_from_autocorrelation(autocorrelation_m2: ArrayLike, *, rho: float = 0.98) -> float:
    """Beta from the measured autocorrelation of the position error.

    Parameters
    ----------
    autocorrelation_m2 : array_like, shape (n,)
        At lags 0, T, 2T, ...; the first is the variance. [m²]
    rho : float
        Pole, in (0, 1).

    Raises
    ------
    InputError
        Values that are no autocorrelation, or too few to determine the gain to 1 %.
    """
    shape, (values,) = flatten(autocorrelation_m2=(autocorrelation_m2, ()))
    if len(shape) != 1:
        raise InputError("autocorrelation_m2", f"shape {shape}", domain="shape (n,)")
    return _core.ee_beta_autocorrelation(float(rho), values)


@checked
def extraction_beta_from_spectrum(
    frequency_hz: ArrayLike, density_m2_per_hz: ArrayLike, *, rho: float = 0.98, period_s: float = 1.0
) -> float:
    """Beta from the spectrum of the position error.

    Parameters
    ----------
    frequency_hz : array_like, shape (n,)
        Increasing, from 0 to half the sampling rate. [Hz]
    density_m2_per_hz : array_like, shape (n,)
        Power spectral density; only its shape matters. [m²/Hz]
    rho : float
        Pole, in (0, 1).
    period_s : float
        Sample period. [s]

    Raises
    ------
    InputError
        Frequencies that do not increase or are beyond half the sampling rate, a density that is negative, no power at all.
    """
    shape, (frequency, density) = flatten(frequency_hz=(frequency_hz, ()), density_m2_per_hz=(density_m2_per_hz, ()))
    if len(shape) != 1:
        raise InputError("frequency_hz", f"shape {shape}", domain="shape (n,)")
    return _core.ee_beta_spectrum(float(rho), float(period_s), frequency, density)


@dataclass(frozen=True)
class ExtractionFactor:
    """The multiplier of the noise part, and what risk it carries for independent exponential errors, the law it is made for.

    Attributes
    ----------
    k : float
        P^(-1/M) - 1, on the sum.
    k_for_weights : float
        The multiplier that carries the risk with unequal weights.
    risk_outside, risk_inside : float
        Risk of ``k`` for an error outside the window, and for the newest one inside, as the paper has it.
    risk_as_printed : float
        Risk of ``k`` on the mean, outside the window: equation 5 as printed.
    """

    k: float
    k_for_weights: float
    risk_outside: float
    risk_inside: float
    risk_as_printed: float


@checked
def extraction_factor(risk: float, *, window: int = 50, weight: float = 0.5) -> ExtractionFactor:
    """The multiplier of the noise part (Vassilev 2012, equation 5; re-derived).

    Parameters
    ----------
    risk : float
        Stated risk.
    window : int
        Samples in the window, even, 2 to 1024.
    weight : float
        Weight of the older half, in [0, 1].

    Raises
    ------
    InputError
        A number outside its domain.
    """
    return ExtractionFactor(*_core.ee_factor(float(risk), int(whole("window", window, "a whole number")), float(weight)))


@dataclass(frozen=True)
class ExtractionBias:
    """Both readings of the bias part: **experimental, not integrity**. NaN exactly where ``status`` is not ``ok``.

    Attributes
    ----------
    from_dop_h_m, from_dop_v_m : ndarray
        alpha mu sqrt(N) DOP, as published. [m]
    exact_h_m, exact_v_m : ndarray
        The worst bias of the weighted solution itself. [m]
    n_sv : ndarray of int
        Satellites used.
    status, reason, reason_id : ndarray of str
        ``ok`` or ``not_available``; why, for people; the same as an id of ``navbound.status.REASONS``.
    """

    from_dop_h_m: Floats
    from_dop_v_m: Floats
    exact_h_m: Floats
    exact_v_m: Floats
    n_sv: NDArray[np.int64]
    status: NDArray[np.str_]
    reason: NDArray[np.str_]
    reason_id: NDArray[np.str_]


@checked
def extraction_bias(
    az_rad: ArrayLike,
    el_rad: ArrayLike,
    sigma_m: ArrayLike,
    *,
    mu_most_m: float = MU_MOST_M,
    alpha: float = ALPHA,
    constellation: Sequence[int] | None = None,
) -> ExtractionBias:
    """Worst position bias when every range may be biased by ``mu_most_m``, in both readings.

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (..., n)
        Satellites, azimuth clockwise from true north; both NaN for one that is not used. [rad]
    sigma_m : array_like, shape (..., n) or ()
        Standard deviation of each range, for its weight. [m]
    mu_most_m : float
        Largest bias of a range (printed, 1.125). [m]
    alpha : float
        Factor of the published form (printed, 1.1).
    constellation : sequence of int, shape (n,), optional
        Index of each satellite's system; without it all share one clock.

    Returns
    -------
    ExtractionBias
        Vassilev 2012, equation 7, and its exact counterpart (ours).

    Raises
    ------
    InputError
        Angles outside their domain, a sigma that is not positive, shapes that do not fit.
    """
    shape, (az, el, sigma) = flatten(az_rad=(az_rad, ()), el_rad=(el_rad, ()), sigma_m=(sigma_m, ()))
    if not shape or shape[-1] == 0:
        raise InputError("az_rad", f"shape {shape}", domain="shape (..., n) with at least one satellite")
    systems = [0] * shape[-1] if constellation is None else [int(c) for c in constellation]
    if len(systems) != shape[-1]:
        raise InputError("constellation", f"{len(systems)} satellites", domain=f"one index for each of {shape[-1]} satellites")
    biases = _core.ee_bias_sights((az, el, sigma), systems, float(mu_most_m), float(alpha))
    leading = shape[:-1]
    reason, reason_id = reasons_of(biases, leading)
    (from_dop_h, from_dop_v), (exact_h, exact_v) = (_columns(biases[name], leading) for name in ("from_dop", "exact"))
    n_sv = biases["n_sv"].reshape(leading)
    return ExtractionBias(from_dop_h, from_dop_v, exact_h, exact_v, n_sv, availability(reason_id), reason, reason_id)


@checked
def extraction_bias_dop(
    hdop: ArrayLike, vdop: ArrayLike, n_sv: ArrayLike, *, mu_most_m: float = MU_MOST_M, alpha: float = ALPHA
) -> tuple[Floats, Floats]:
    """Published bias part from dilutions of precision (Vassilev 2012, equation 7; printed): **experimental, not integrity**.

    Parameters
    ----------
    hdop, vdop : array_like
        Dilutions.
    n_sv : array_like of int
        Satellites used, at least 4.
    mu_most_m : float
        Largest bias of a range. [m]
    alpha : float
        The paper's allowance for weights; it does not cover them.

    Returns
    -------
    bias_h_m, bias_v_m : ndarray
        [m]

    Raises
    ------
    InputError
        A negative number, or fewer than four satellites.
    """
    whole("n_sv", n_sv, "whole numbers")
    shape, (h, v, n) = flatten(hdop=(hdop, ()), vdop=(vdop, ()), n_sv=(n_sv, ()))
    bias_h, bias_v = _columns(_core.ee_bias_dop(h, v, n.astype(np.int64), float(mu_most_m), float(alpha)), shape)
    return bias_h, bias_v
