"""ARAIM: protection levels by solution separation over the fault modes of satellites and constellations.

Blanch et al. 2015, baseline advanced RAIM user algorithm, with the modes of Working Group C's airborne algorithm description v3.0
(standard; checked against MAAST for ARAIM 2). Which risks a service may take, and what satellites promise, are configurations with their
provenance: :data:`SERVICES` and :data:`SUPPORT`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound._arrays import flatten
from navbound._constellations import CONSTELLATIONS
from navbound.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = ["SERVICES", "SUPPORT", "Levels", "Service", "Support", "protection_levels"]


@dataclass(frozen=True)
class Service:
    """Risks that a service may take, and how they are split; each in (0, 1).

    Attributes
    ----------
    integrity_v, integrity_h : float
        Integrity risk of the vertical and of the horizontal level. [1]
    false_alarm_v, false_alarm_h : float
        Risk of a false alarm. [1]
    unmonitored : float
        Fault modes together below this need not be monitored; what they have counts against the integrity risk. [1]
    effective_monitor : float
        Modes at least this likely enter the effective monitor threshold. [1]
    consolidation : float
        Sets of satellites of one constellation less likely than this share of its own fault count with it. [1]
    emt_limit_m : float
        Largest effective monitor threshold; NaN where the service has none. [m]
    source, provenance : str
        Where the numbers come from, and how they are held.
    """

    integrity_v: float
    integrity_h: float
    false_alarm_v: float
    false_alarm_h: float
    unmonitored: float
    effective_monitor: float = 1e-5
    consolidation: float = 0.01
    emt_limit_m: float = float("nan")
    source: str = "the caller"
    provenance: str = "ours"


@dataclass(frozen=True)
class Support:
    """What is promised of satellites, one number a constellation in the order of ``gnss.CONSTELLATIONS``.

    Attributes
    ----------
    sigma_ura_m, sigma_ure_m : tuple of float
        Orbit and clock for integrity, and for accuracy. [m]
    bias_m, bias_continuity_m : tuple of float
        Nominal bias for integrity and for continuity. [m]
    p_sat, p_const : tuple of float
        Probability that a satellite is in fault, and that its constellation is, each in (0, 1). [1]
    source, provenance : str
        Where the numbers come from, and how they are held.
    """

    sigma_ura_m: tuple[float, ...]
    sigma_ure_m: tuple[float, ...]
    bias_m: tuple[float, ...]
    bias_continuity_m: tuple[float, ...]
    p_sat: tuple[float, ...]
    p_const: tuple[float, ...]
    source: str = "the caller"
    provenance: str = "ours"


def _support() -> Support:
    found = _core.araim_support()
    ura, ure, bias, continuity, p_sat, p_const = zip(*found["support"], strict=True)
    return Support(ura, ure, bias, continuity, p_sat, p_const, found["source"], found["provenance"])


SERVICES: dict[str, Service] = {name: Service(**numbers) for name, numbers in _core.araim_services().items()}
"""The shipped services by name: ``lpv-200`` and ``horizontal``."""

SUPPORT: Support = _support()
"""The shipped promises; no integrity support message is broadcast, so they are those of a study, marked as inferred."""


@dataclass(frozen=True)
class Levels:
    """Protection levels; arrays of the leading shape.

    Levels are infinite where ``status`` is ``not_monitored``, NaN for any other status but ``ok``.

    Attributes
    ----------
    hpl_m, vpl_m : ndarray
        Horizontal and vertical protection level. [m]
    hpl_e_m, hpl_n_m : ndarray
        East and north; ``hpl_m`` is the root of the sum of their squares. [m]
    emt_m : ndarray
        Effective monitor threshold. [m]
    sigma_acc_e_m, sigma_acc_n_m, sigma_acc_u_m : ndarray
        Standard deviation of the position for accuracy. [m]
    n_modes, n_monitored : ndarray of int
        Fault modes, the fault-free one among them, and those that the geometry can monitor. [1]
    p_unmonitored : ndarray
        Probability of everything that is not monitored. [1]
    n_sv : ndarray of int
        Satellites used. [1]
    status : ndarray of str
        ``ok``, ``not_monitored`` (the integrity risk is spent on modes that cannot be monitored), ``too_few_satellites``, ``singular``,
        ``too_many`` (satellites, or modes to monitor).
    """

    hpl_m: NDArray[np.float64]
    vpl_m: NDArray[np.float64]
    hpl_e_m: NDArray[np.float64]
    hpl_n_m: NDArray[np.float64]
    emt_m: NDArray[np.float64]
    sigma_acc_e_m: NDArray[np.float64]
    sigma_acc_n_m: NDArray[np.float64]
    sigma_acc_u_m: NDArray[np.float64]
    n_modes: NDArray[np.int64]
    n_monitored: NDArray[np.int64]
    p_unmonitored: NDArray[np.float64]
    n_sv: NDArray[np.int64]
    status: NDArray[np.str_]


def protection_levels(
    unit_enu: ArrayLike,
    constellation: Sequence[int] | NDArray[np.int64],
    sigma_int_m: ArrayLike,
    sigma_acc_m: ArrayLike,
    *,
    bias_m: ArrayLike | None = None,
    bias_continuity_m: ArrayLike | None = None,
    p_sat: ArrayLike | None = None,
    p_const: Sequence[float] | None = None,
    service: str | Service = "lpv-200",
) -> Levels:
    """Protection levels of many epochs from lines of sight, as long as no detection test fails.

    For each axis 2 Q((PL - b_0)/s_0) + sum_k p_k Q((PL - T_k - b_k)/s_k) = P_HMI (1 - P_nm/P_HMI,total), T_k = K_FA s_ss,k (Blanch et
    al. 2015; standard).

    Parameters
    ----------
    unit_enu : array_like, shape (..., n, 3)
        Unit vectors from the receiver to the satellites, east-north-up; three NaN for one that is not used. [1]
    constellation : sequence of int, shape (n,)
        Index of each satellite's system in ``gnss.CONSTELLATIONS``.
    sigma_int_m, sigma_acc_m : array_like, shape (..., n)
        Standard deviation of each range for integrity, and for accuracy and continuity. [m]
    bias_m, bias_continuity_m : array_like, shape (..., n), optional
        Nominal biases; without them those of :data:`SUPPORT`. [m]
    p_sat : array_like, shape (..., n), optional
        Prior of each satellite, in (0, 1); without it that of :data:`SUPPORT`. [1]
    p_const : sequence of float, shape (5,), optional
        Prior of each constellation in the order of ``gnss.CONSTELLATIONS``; without it those of :data:`SUPPORT`. [1]
    service : str or Service, optional
        A name of :data:`SERVICES`, or budgets of one's own.

    Returns
    -------
    Levels

    Raises
    ------
    InputError
        Vectors that are not of length one, sigmas or biases outside their domain, a prior outside (0, 1), budgets that cannot be met.
    """
    of = np.asarray(constellation, dtype=np.int64)
    lines = np.shape(unit_enu)
    if of.shape != lines[-2:-1] or not 0 <= of.min(initial=0) <= of.max(initial=0) < len(CONSTELLATIONS):
        raise InputError("constellation", f"shape {of.shape}", domain=f"shape {lines[-2:-1]}, indices of CONSTELLATIONS")
    bias, continuity, prior = (
        np.asarray(column)[of] if given is None else given
        for given, column in ((bias_m, SUPPORT.bias_m), (bias_continuity_m, SUPPORT.bias_continuity_m), (p_sat, SUPPORT.p_sat))
    )
    shape, (unit, sigma_int, sigma_acc, bias, continuity, prior) = flatten(
        unit_enu=(unit_enu, (3,)),
        sigma_int_m=(sigma_int_m, ()),
        sigma_acc_m=(sigma_acc_m, ()),
        bias_m=(bias, ()),
        bias_continuity_m=(continuity, ()),
        p_sat=(prior, ()),
    )
    if shape[-1:] != of.shape:
        raise InputError("unit_enu", f"{of.size} satellites", domain=f"shape (..., {shape[-1]}, 3)")
    constants = SUPPORT.p_const if p_const is None else tuple(float(p) for p in p_const)
    if len(constants) != len(CONSTELLATIONS):
        raise InputError("p_const", f"{len(constants)} numbers", domain=f"{len(CONSTELLATIONS)} numbers, one a constellation")
    found = _core.araim_levels(unit.ravel(), sigma_int, sigma_acc, bias, continuity, prior, of.tolist(), list(constants), _numbers(service))
    return _levels(found, shape[:-1])


def _numbers(service: str | Service) -> list[float]:
    """The seven numbers that the core takes."""
    if isinstance(service, str):
        if service not in SERVICES:
            raise InputError("service", service, domain=f"one of {', '.join(SERVICES)}")
        service = SERVICES[service]
    return [float(getattr(service, f.name)) for f in fields(Service)[:7]]


def _levels(found: dict[str, Any], shape: tuple[int, ...]) -> Levels:
    status = np.array(found.pop("words"))[found.pop("outcome")]
    return Levels(status=status.reshape(shape), **{name: values.reshape(shape) for name, values in found.items()})
