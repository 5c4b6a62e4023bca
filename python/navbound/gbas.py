"""GBAS: error models, protection levels, what ground monitors must detect, and the covariance with an inertial system.

Source: Song, Milner and No 2024, NAVIGATION 71(4), navi.673, equations 2 to 10 and 18 to 20, rebuilt from its words and from RTCA DO-245A
and DO-253 (our copy lost its formulas). What was read and what was concluded stands in docs/methods/gbas.md and with every number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from navbound import _core
from navbound._arrays import flatten, unflatten
from navbound._gbas_models import (
    SERVICES,
    Allocation,
    Carrier,
    ErrorBudget,
    FaultRates,
    Mark,
    MonitorCurve,
    RangeSigma,
    Service,
    SubPhase,
    allocation,
    carrier_sigma,
    carriers,
    check_service,
    error_budget,
    fault_rates,
    model_marks,
    monitor_curves,
    range_sigma,
    sub_phases,
)
from navbound.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "SERVICES",
    "Allocation",
    "Carrier",
    "ErrorBudget",
    "Factors",
    "FaultRates",
    "Levels",
    "Mark",
    "MonitorCurve",
    "RangeSigma",
    "SubPhase",
    "accuracy_limit",
    "aided_covariance",
    "allocation",
    "bias_gain",
    "carrier_sigma",
    "carriers",
    "error_budget",
    "factors",
    "fault_probability",
    "fault_rates",
    "missed_by_monitor",
    "missed_detection_limit",
    "model_marks",
    "monitor_curves",
    "monitor_margin",
    "offset_variances",
    "protection_levels",
    "range_sigma",
    "sub_phases",
]

Ordering = Literal["exact", "rss", "sum"]
Form = Literal["major", "norm"]
NoiseForm = Literal["paper", "bound"]


@dataclass(frozen=True)
class Factors:
    """Multipliers of the hypotheses without a fault and with one faulty reference receiver [1].

    Attributes
    ----------
    k_ffmd, k_md : float
        Fault-free missed detection, missed detection.
    """

    k_ffmd: float
    k_md: float


@dataclass(frozen=True)
class Levels:
    """Protection levels and their parts; NaN exactly where ``status`` is not ``ok``.

    Attributes
    ----------
    hpl_h0_m, hpl_h1_m, hpl_m : ndarray
        Without a fault, with a faulty reference receiver, the larger. [m]
    accuracy_m : ndarray
        95 %: 1.96 deviations of the worst direction and the bias. [m]
    sigma_m : ndarray
        Deviation behind ``hpl_h0_m``. [m]
    bias_hor_m : ndarray
        Horizontal effect of the nominal biases. [m]
    sigma_major_m, sigma_norm_m, sigma_major_h1_m : ndarray
        Of the weighted solution: worst direction, root of the trace, worst direction with a faulty receiver. [m]
    bias_gain_exact, bias_gain_rss, bias_gain_sum : ndarray
        Metres of position for a metre of bias in every range. [1]
    worst_projection : ndarray
        Largest horizontal effect of one range. [1]
    covariance_enu_m2 : ndarray, shape (..., 3, 3)
        Covariance used: the aided one where given. [m²]
    n_sv : ndarray of int
        Satellites used. [1]
    status, reason : ndarray of str
        ``ok`` or ``not_available``, and why.
    """

    hpl_h0_m: NDArray[np.float64]
    hpl_h1_m: NDArray[np.float64]
    hpl_m: NDArray[np.float64]
    accuracy_m: NDArray[np.float64]
    sigma_m: NDArray[np.float64]
    bias_hor_m: NDArray[np.float64]
    sigma_major_m: NDArray[np.float64]
    sigma_norm_m: NDArray[np.float64]
    sigma_major_h1_m: NDArray[np.float64]
    bias_gain_exact: NDArray[np.float64]
    bias_gain_rss: NDArray[np.float64]
    bias_gain_sum: NDArray[np.float64]
    worst_projection: NDArray[np.float64]
    covariance_enu_m2: NDArray[np.float64]
    n_sv: NDArray[np.int64]
    status: NDArray[np.str_]
    reason: NDArray[np.str_]


def factors(integrity_risk: float, *, share: float = 0.25, axes: int = 1, receivers: int = 4, receiver_fault: float = 1e-5) -> Factors:
    """Multipliers from an integrity risk (RTCA DO-245A; standard): 6.54 and 4.06 for 1.25e-9.

    Parameters
    ----------
    integrity_risk : float
        Of the operation. [1]
    share : float
        Of it for both hypotheses. [1]
    axes : int
        Coordinates it is split among.
    receivers : int
        Reference receivers.
    receiver_fault : float
        Probability that one of them is faulty. [1]

    Raises
    ------
    InputError
        A number outside its domain, or a budget that cannot be met.
    """
    for name, count in (("axes", axes), ("receivers", receivers)):
        if not 0 <= count < 256:
            raise InputError(name, count, "1", "[0, 255]")
    return Factors(*_core.gbas_factors(integrity_risk, share, axes, receivers, receiver_fault))


def accuracy_limit(containment_m: float, budget: ErrorBudget | None = None) -> float:
    """Accuracy (95 %) that a containment leaves to navigation: 1.96 sqrt((TSC/4.8916)² - FTE² - PDE²) [m].

    Parameters
    ----------
    containment_m : float
        Total system containment. [m]
    budget : ErrorBudget, optional
        Instead of :func:`error_budget`.

    Raises
    ------
    InputError
        A containment that flight technical and path definition error alone leave too often.
    """
    b = budget or error_budget()
    return _core.gbas_accuracy_limit(containment_m, b.containment_risk, b.sigma_fte_m, b.sigma_pde_m)


def bias_gain(east_north: ArrayLike, ordering: Ordering = "exact") -> float:
    """Largest position, in metres, for biases of at most a metre in every range (navi.673 equation 6).

    Parameters
    ----------
    east_north : array_like, shape (n, 2)
        Position moved by a metre in each range, east and north. [1]
    ordering : {"exact", "rss", "sum"}
        The largest there is (farthest vertex of a zonotope), or one of two larger and quicker bounds.

    Raises
    ------
    InputError
        Wrong shape, more than 48 ranges, numbers that are not finite, an unknown ordering.
    """
    _, (rows,) = flatten(east_north=(east_north, (2,)))
    if len(rows) > 48 or not np.isfinite(rows).all():
        raise InputError("east_north", f"{len(rows)} rows", domain="at most 48 rows of finite numbers")
    return _core.gbas_bias_gain(rows, _named("ordering", ordering, ("exact", "rss", "sum")))


def protection_levels(
    az_rad: ArrayLike,
    el_rad: ArrayLike,
    constellation: Sequence[int] | NDArray[np.int64] | None = None,
    *,
    service: Service = "D",
    sigma_m: ArrayLike | None = None,
    sigma_h1_m: ArrayLike | None = None,
    integrity_risk: float = 1.25e-9,
    k: Factors | None = None,
    bias_m: ArrayLike = 0.0,
    b_values_m: ArrayLike | None = None,
    aided_covariance_m2: ArrayLike | None = None,
    ordering: Ordering = "exact",
    form: Form = "major",
) -> Levels:
    """Horizontal protection levels before coasting (navi.673 equation 5, rebuilt after RTCA DO-253).

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (..., n)
        Satellites, azimuth clockwise from true north; both NaN for one that is not used. [rad]
    constellation : sequence of int, shape (n,), optional
        Index of each satellite's system in ``gnss.CONSTELLATIONS``; without it all share one clock.
    service : {"D", "F"}
        Error model, where ``sigma_m`` is not given.
    sigma_m, sigma_h1_m : array_like, shape (..., n), optional
        Standard deviation of each range, and when one reference receiver is faulty, instead of the model's. [m]
    integrity_risk : float
        Of the operation; the default is the study's, inferred. [1]
    k : Factors, optional
        Multipliers instead of :func:`factors` of ``integrity_risk``.
    bias_m : array_like, shape (...)
        Largest nominal bias of a range. [m]
    b_values_m : array_like, shape (..., receivers, n), optional
        B-values. [m]
    aided_covariance_m2 : array_like, shape (..., 3, 3), optional
        Covariance with an inertial system, east-north-up, from :func:`aided_covariance`. [m²]
    ordering : {"exact", "rss", "sum"}
        Bound of the biases' effect.
    form : {"major", "norm"}
        Deviation of a covariance: worst direction, or the literal sum of equation 5, which claim C01 fails with.

    Returns
    -------
    Levels
        ``not_available`` where unknowns outnumber satellites or the geometry is singular.

    Raises
    ------
    InputError
        Numbers outside their domains, shapes that do not fit.
    """
    shape, (az, el) = flatten(az_rad=(az_rad, ()), el_rad=(el_rad, ()))
    width, leading = _width(shape), shape[:-1]
    sigma, sigma_h1 = _sigmas(np.reshape(el, shape), service, sigma_m, sigma_h1_m)
    multipliers = k or factors(integrity_risk)
    found = _core.gbas_levels(
        {
            "az_rad": az,
            "el_rad": el,
            "sigma_m": sigma,
            "sigma_h1_m": sigma_h1,
            "constellation": systems(width, constellation),
            "bias_m": spread("bias_m", bias_m, leading, ()),
            "aided_m2": spread("aided_covariance_m2", aided_covariance_m2, leading, (3, 3)),
            "b_values_m": _b_values(b_values_m, leading, width),
            "k_ffmd": multipliers.k_ffmd,
            "k_md": multipliers.k_md,
            "ordering": _named("ordering", ordering, ("exact", "rss", "sum")),
            "form": _named("form", form, ("major", "norm")),
        }
    )
    reason = np.array(found.pop("reason"), dtype=np.str_).reshape(leading)
    covariance = found.pop("cov_enu_m2").reshape(*leading, 3, 3)
    columns: dict[str, Any] = {name: unflatten(values, leading) for name, values in found.items()}
    status = np.where(reason == "", "ok", "not_available")
    return Levels(covariance_enu_m2=covariance, status=status, reason=reason, **columns)


def fault_probability(n_sv: ArrayLike, rate_per_hour: ArrayLike, tau_s: float = 100.0) -> float:
    """Probability of a satellite fault that monitors with memory do not yet show (navi.673 equation 9).

    Parameters
    ----------
    n_sv, rate_per_hour : array_like
        How many satellites have which rate: 18 at 1e-5 give 5.000e-6. [1, 1/h]
    tau_s : float
        Decorrelation time of the monitors. [s]

    Raises
    ------
    InputError
        A rate outside [0, 3600 / tau_s).
    """
    _, (n, rate) = flatten(n_sv=(n_sv, ()), rate_per_hour=(rate_per_hour, ()))
    return _core.gbas_fault_probability(list(zip(n.tolist(), rate.tolist(), strict=True)), tau_s)


def missed_by_monitor(error_m: ArrayLike, service: Service = "D", *, stretch: float | None = None) -> NDArray[np.float64]:
    """Probability that the ground monitors miss a range error (ICAO Annex 10 appendix B, from memory; GAST F inferred).

    Parameters
    ----------
    error_m : array_like
        Size of the range error. [m]
    service : {"D", "F"}
        Whose curve.
    stretch : float, optional
        How many times larger an error must be than under the standard's curve; the service's own without it. [1]

    Raises
    ------
    InputError
        An unknown service, a stretch that is not positive.
    """
    check_service(service)
    shape, (error,) = flatten(error_m=(error_m, ()))
    return unflatten(_core.gbas_missed_by_monitor(service, _stretch(service, stretch), error), shape)


def missed_detection_limit(
    error_m: ArrayLike,
    *,
    containment_m: ArrayLike,
    sigma_tse_m: ArrayLike,
    projection: ArrayLike,
    allotted_risk: ArrayLike,
    p_fault: ArrayLike,
    bias_hor_m: ArrayLike = 0.0,
) -> NDArray[np.float64]:
    """Largest missed detection of ground monitors that keeps the risk (navi.673 equations 7, 8 and 10).

    Parameters
    ----------
    error_m : array_like
        Size of the range error. [m]
    containment_m, sigma_tse_m : array_like
        Total system containment and standard deviation of the total system error. [m]
    projection : array_like
        Metres of position for a metre of range: 2 (GAST D), 0.7 (GAST F). [1]
    allotted_risk : array_like
        Risk allotted to the hypothesis. [1]
    p_fault : array_like
        Probability of the fault, :func:`fault_probability`. [1]
    bias_hor_m : array_like
        Horizontal effect of nominal biases. [m]

    Raises
    ------
    InputError
        A number outside its domain.
    """
    hazards = (containment_m, sigma_tse_m, bias_hor_m, projection, allotted_risk, p_fault)
    names = ("containment_m", "sigma_tse_m", "bias_hor_m", "projection", "allotted_risk", "p_fault")
    shape, (error, *rows) = flatten(error_m=(error_m, ()), **{n: (v, ()) for n, v in zip(names, hazards, strict=True)})
    return unflatten(_core.gbas_missed_detection_limit(error, np.ascontiguousarray(np.stack(rows, axis=-1))), shape)


def monitor_margin(
    *,
    service: Service,
    containment_m: ArrayLike,
    sigma_tse_m: ArrayLike,
    projection: ArrayLike,
    allotted_risk: ArrayLike,
    p_fault: ArrayLike,
    bias_hor_m: ArrayLike = 0.0,
    stretch: float | None = None,
) -> NDArray[np.float64]:
    """Decades between :func:`missed_detection_limit` and :func:`missed_by_monitor` where they are closest; the monitor suffices from 0 on.

    Parameters and errors as those two.
    """
    check_service(service)
    hazards = (containment_m, sigma_tse_m, bias_hor_m, projection, allotted_risk, p_fault)
    names = ("containment_m", "sigma_tse_m", "bias_hor_m", "projection", "allotted_risk", "p_fault")
    shape, rows = flatten(**{n: (v, ()) for n, v in zip(names, hazards, strict=True)})
    table = np.ascontiguousarray(np.stack(rows, axis=-1))
    return unflatten(_core.gbas_monitor_margin(service, _stretch(service, stretch), table), shape)


def aided_covariance(
    az_rad: ArrayLike,
    el_rad: ArrayLike,
    constellation: Sequence[int] | NDArray[np.int64] | None = None,
    *,
    lat_rad: float,
    service: Service = "D",
    noise: NoiseForm = "bound",
    seconds: float = 900.0,
) -> NDArray[np.float64]:
    """Covariance of a fix from GBAS-corrected ranges and an inertial system (navi.673 equations 3 and 4, rebuilt).

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (..., n)
        Satellites, which stand still; both NaN for one that is not used. [rad]
    constellation : sequence of int, shape (n,), optional
        Index of each satellite's system; without it all share one clock.
    service : {"D", "F"}
        Error model.
    noise : {"bound", "paper"}
        Smoothed multipath of unknown time constant: as Langel et al. 2021 bound it, or as the paper's words have it. Only the first may
        support a statement of safety; only the second makes the sigma smaller than that of the ranges alone.
    lat_rad : float
        Latitude. [rad]
    seconds : float
        How long the filter has run. [s]

    Returns
    -------
    ndarray, shape (..., 3, 3)
        East-north-up. [m²]

    Raises
    ------
    InputError
        A sky without satellites, numbers outside their domains.
    """
    check_service(service)
    shape, (az, el) = flatten(az_rad=(az_rad, ()), el_rad=(el_rad, ()))
    if not 0 <= seconds <= 86_400:
        raise InputError("seconds", seconds, "s", "[0, 86400]")
    job = {
        "service": service,
        "form": _named("noise", noise, ("paper", "bound")),
        "lat_rad": lat_rad,
        "seconds": seconds,
        "az_rad": az,
        "el_rad": el,
        "constellation": systems(_width(shape), constellation),
    }
    return _core.gbas_aided_covariance(job).reshape(*shape[:-1], 3, 3)


def offset_variances(
    true_constant_s: float, *, noise: NoiseForm = "bound", shortest_s: float = 54.0, longest_s: float = 2894.0, n: int = 901
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Variance of a constant offset seen every second through correlated noise of 1 m: as the filter has it, and as it is.

    Parameters
    ----------
    true_constant_s : float
        Time constant the noise really has. [s]
    noise : {"bound", "paper"}
        The filter's model.
    shortest_s, longest_s : float
        Between which the filter knows the constant to lie. [s]
    n : int
        Measurements.

    Returns
    -------
    filter_m2, true_m2 : ndarray, shape (n,)
        After each measurement. [m²]

    Raises
    ------
    InputError
        Constants that are not positive or not in order.
    """
    if not 1 <= n <= 1_000_000:
        raise InputError("n", n, "1", "[1, 1000000]")
    form = _named("noise", noise, ("paper", "bound"))
    found = _core.gbas_offset_variances(form, [shortest_s, longest_s], true_constant_s, n)
    return np.ascontiguousarray(found[:, 0]), np.ascontiguousarray(found[:, 1])


def systems(width: int, constellation: Sequence[int] | NDArray[np.int64] | None) -> list[int]:
    """Index of each satellite's system."""
    indices = np.zeros(width, dtype=np.int64) if constellation is None else np.asarray(constellation)
    if indices.shape != (width,) or not np.issubdtype(indices.dtype, np.integer) or indices.min() < 0:
        raise InputError("constellation", f"shape {indices.shape}", domain=f"{width} indices of gnss.CONSTELLATIONS")
    return [int(c) for c in indices]


def spread(name: str, value: ArrayLike | None, leading: tuple[int, ...], item: tuple[int, ...]) -> NDArray[np.float64] | None:
    """An optional argument broadcast to the leading shape, flat; None where it was not given."""
    if value is None:
        return None
    array = _numbers(name, value)
    try:
        return np.ascontiguousarray(np.broadcast_to(array, leading + item)).reshape(-1)
    except ValueError as e:
        raise InputError(name, f"shape {array.shape}", domain=f"shapes that broadcast to {leading + item}") from e


def _width(shape: tuple[int, ...]) -> int:
    if not shape or shape[-1] == 0:
        raise InputError("az_rad", f"shape {shape}", domain="shape (..., n), n at least 1")
    return shape[-1]


def _numbers(name: str, value: ArrayLike) -> NDArray[np.float64]:
    _, (flat,) = flatten(**{name: (value, ())})
    return flat.reshape(np.shape(value))


def _sigmas(
    el: NDArray[np.float64], service: Service, sigma_m: ArrayLike | None, sigma_h1_m: ArrayLike | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Given standard deviations, or the model's, in the shape of the elevations and flat."""
    if sigma_m is None and sigma_h1_m is None:
        model = range_sigma(el, service)
        return model.sigma_m.reshape(-1), model.sigma_h1_m.reshape(-1)
    if sigma_m is None or sigma_h1_m is None:
        raise InputError("sigma_h1_m" if sigma_h1_m is None else "sigma_m", "none", domain="both sigmas, or neither")
    given = [spread(name, value, el.shape, ()) for name, value in (("sigma_m", sigma_m), ("sigma_h1_m", sigma_h1_m))]
    return np.asarray(given[0]), np.asarray(given[1])


def _b_values(value: ArrayLike | None, leading: tuple[int, ...], width: int) -> NDArray[np.float64] | None:
    if value is None:
        return None
    shape = np.shape(value)
    if len(shape) < 2 or shape[-1] != width or shape[-2] == 0:
        raise InputError("b_values_m", f"shape {shape}", domain=f"shape (..., receivers, {width})")
    flat = spread("b_values_m", value, leading, (shape[-2], width))
    if flat is not None and not np.isfinite(flat).all():
        raise InputError("b_values_m", "not finite", "m", "finite numbers")
    return flat


def _stretch(service: Service, stretch: float | None) -> float:
    return monitor_curves()[service].stretch if stretch is None else stretch


def _named(argument: str, value: str, allowed: tuple[str, ...]) -> str:
    if value not in allowed:
        raise InputError(argument, value, domain=", ".join(allowed))
    return value
