"""GBAS: error models, protection levels, what ground monitors must detect, and the covariance with an inertial system.

Source: Song, Milner and No 2024, NAVIGATION 71(4), navi.673, equations 2 to 10 and 18 to 20, rebuilt from its words and from RTCA DO-245A
and DO-253 (our copy lost its formulas). What was read and what was concluded stands in docs/methods/gbas.md and with every number.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from navbound import _core
from navbound.errors import ConflictError, InputError
from navbound.gbas.arguments import named, spread, systems, width_of
from navbound.gbas.detection import fault_probability, missed_by_monitor, missed_detection_limit, monitor_margin
from navbound.gbas.filter import aided_covariance, offset_variances
from navbound.gbas.models import (
    SERVICES,
    Allocation,
    Carrier,
    ErrorBudget,
    FaultRates,
    Inertial,
    Mark,
    MonitorCurve,
    RangeSigma,
    Service,
    SubPhase,
    allocation,
    carrier_sigma,
    carriers,
    error_budget,
    fault_rates,
    inertial,
    model_marks,
    monitor_curves,
    multipath_times,
    range_sigma,
    sub_phases,
)
from navbound.status import availability, reasons_of
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

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
    "Inertial",
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
    "inertial",
    "missed_by_monitor",
    "missed_detection_limit",
    "model_marks",
    "monitor_curves",
    "monitor_margin",
    "multipath_times",
    "offset_variances",
    "protection_levels",
    "range_sigma",
    "sub_phases",
]

Ordering = Literal["exact", "rss", "sum"]
Form = Literal["major", "norm"]


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
    status, reason, reason_id : ndarray of str
        ``ok`` or ``not_available``; why, for people; the same as an id of ``navbound.status.REASONS``.
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
    reason_id: NDArray[np.str_]


@checked
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


@checked
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


@checked
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
    return _core.gbas_bias_gain(rows, named("ordering", ordering, ("exact", "rss", "sum")))


@checked
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
    width, leading = width_of(shape), shape[:-1]
    sigma, sigma_h1 = _sigmas(np.reshape(el, shape), service, sigma_m, sigma_h1_m)
    multipliers = k or factors(integrity_risk)
    levels = _core.gbas_levels(
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
            "ordering": named("ordering", ordering, ("exact", "rss", "sum")),
            "form": named("form", form, ("major", "norm")),
        }
    )
    reason, reason_id = reasons_of(levels, leading)
    covariance = levels.pop("cov_enu_m2").reshape(*leading, 3, 3)
    columns: dict[str, Any] = {name: unflatten(values, leading) for name, values in levels.items()}
    status = availability(reason_id)
    return Levels(covariance_enu_m2=covariance, status=status, reason=reason, reason_id=reason_id, **columns)


def _sigmas(
    el: NDArray[np.float64], service: Service, sigma_m: ArrayLike | None, sigma_h1_m: ArrayLike | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Given standard deviations, or the model's, in the shape of the elevations and flat."""
    if sigma_m is None and sigma_h1_m is None:
        model = range_sigma(el, service)
        return model.sigma_m.reshape(-1), model.sigma_h1_m.reshape(-1)
    if sigma_m is None or sigma_h1_m is None:
        raise ConflictError("sigma_m", needs=("sigma_h1_m",)) if sigma_h1_m is None else ConflictError("sigma_h1_m", needs=("sigma_m",))
    sigmas = [spread(name, value, el.shape, ()) for name, value in (("sigma_m", sigma_m), ("sigma_h1_m", sigma_h1_m))]
    return np.asarray(sigmas[0]), np.asarray(sigmas[1])


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
