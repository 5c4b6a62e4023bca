"""ARAIM: protection levels by solution separation over the fault modes of satellites and constellations.

Blanch et al. 2015, baseline advanced RAIM user algorithm, with the modes of Working Group C's airborne algorithm description v3.0
(standard; checked against MAAST for ARAIM 2). Which risks a service may take, and what satellites promise, are configurations with their
provenance: :data:`SERVICES` and :data:`SUPPORT`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound.araim.recorded import watch
from navbound.araim.settings import (
    ERROR_MODELS,
    RAIM,
    SERVICES,
    SUPPORT,
    ErrorModel,
    Requirement,
    Service,
    Support,
    airborne_numbers,
    overhead,
    rule_numbers,
    support_rows,
    systems_of,
)
from navbound.errors import InputError
from navbound.gnss.constellations import CONSTELLATIONS, Orbits
from navbound.gnss.monitor_fit import Fit
from navbound.gnss.watched import Watched
from navbound.table.arguments import checked
from navbound.table.arrays import flatten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "ERROR_MODELS",
    "RAIM",
    "SERVICES",
    "SUPPORT",
    "ErrorModel",
    "Fit",
    "Levels",
    "Monitored",
    "Requirement",
    "Service",
    "Support",
    "Watched",
    "monitor",
    "predict",
    "protection_levels",
    "watch",
]


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


@dataclass(frozen=True)
class Monitored:
    """Epochs after detection and exclusion; arrays of the leading shape.

    Attributes
    ----------
    levels : Levels
        Of the satellites that are left.
    decision : ndarray of str
        ``none`` (all solutions agree), ``excluded``, ``not_excluded`` (a fault, and no exclusion brings agreement: the position is not
        to be used); empty where there is no position.
    excluded : ndarray of bool, shape (..., n)
        Satellites excluded.
    worst_ratio : ndarray
        Largest separation before exclusion against its threshold. [1]
    step_enu_m : ndarray, shape (..., 3)
        The position from the place of the residuals, east, north, up. [m]
    """

    levels: Levels
    decision: NDArray[np.str_]
    excluded: NDArray[np.bool_]
    worst_ratio: NDArray[np.float64]
    step_enu_m: NDArray[np.float64]


@checked
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
    service: str | Service | Requirement = "lpv-200",
    exclusion: bool = False,
) -> Levels:
    """Protection levels of many epochs from lines of sight, as long as no detection test fails.

    For each axis 2 Q((PL - b_0)/s_0) + sum_k p_k Q((PL - T_k - b_k)/s_k) = P_HMI (1 - P_nm/P_HMI,total), T_k = K_FA s_ss,k (Blanch et
    al. 2015; standard). For RAIM max over satellites of K_FA s_ss,i + K_MD s_i (Brown and McBurney 1988; standard).

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
    service : str, Service or Requirement, optional
        A name of :data:`SERVICES` or ``raim``, or budgets of one's own. RAIM knows no priors and no biases.
    exclusion : bool, optional
        The largest level after excluding any one likely fault, instead of that of detection.

    Returns
    -------
    Levels

    Raises
    ------
    InputError
        Vectors that are not of length one, sigmas or biases outside their domain, a prior outside (0, 1), budgets that cannot be met.
    """
    numbers = rule_numbers(service)
    shape, columns, of, constants = _columns(
        unit_enu, constellation, (sigma_int_m, sigma_acc_m), (bias_m, bias_continuity_m, p_sat), p_const
    )
    unit, sigma_int, sigma_acc, bias, continuity, prior = columns
    computed = _core.araim_levels(unit, sigma_int, sigma_acc, bias, continuity, prior, of, constants, numbers, exclusion)
    return _levels(computed, shape[:-1])


@checked
def monitor(
    unit_enu: ArrayLike,
    constellation: Sequence[int] | NDArray[np.int64],
    residual_m: ArrayLike,
    sigma_int_m: ArrayLike,
    sigma_acc_m: ArrayLike,
    *,
    bias_m: ArrayLike | None = None,
    bias_continuity_m: ArrayLike | None = None,
    p_sat: ArrayLike | None = None,
    p_const: Sequence[float] | None = None,
    service: str | Service = "lpv-200",
) -> Monitored:
    """Detection and exclusion on residuals of many epochs, and the levels of what is left.

    Every solution without a fault mode's satellites is compared with the one with all. Where a separation exceeds its threshold, modes are
    tried for exclusion from the largest ratio on; the first is taken without which the rest agrees. The integrity risk is shared equally
    by all decisions (ours, docs/methods/araim.md).

    Parameters
    ----------
    residual_m : array_like, shape (..., n)
        Measured less computed ranges at the place of the lines of sight; receiver clocks may be in them. [m]
    unit_enu, constellation, sigma_int_m, sigma_acc_m, bias_m, bias_continuity_m, p_sat, p_const
        As in :func:`protection_levels`.
    service : str or Service, optional
        A name of :data:`SERVICES`, or budgets of one's own.

    Raises
    ------
    InputError
        As :func:`protection_levels`; a residual of a satellite in use that is not finite.
    """
    numbers = rule_numbers(service)
    if len(numbers) != 7:
        raise InputError("service", service, domain=f"one of {', '.join(SERVICES)}, or a Service")
    together, (lines, residual) = flatten(unit_enu=(unit_enu, (3,)), residual_m=(residual_m, ()))
    shape, columns, of, constants = _columns(
        lines.reshape(*together, 3), constellation, (sigma_int_m, sigma_acc_m), (bias_m, bias_continuity_m, p_sat), p_const
    )
    if shape != together:
        raise InputError("residual_m", f"shape {together}", domain=f"shape {shape}, one for each range")
    unit, sigma_int, sigma_acc, bias, continuity, prior = columns
    computed = _core.araim_monitor(unit, residual, sigma_int, sigma_acc, bias, continuity, prior, of, constants, numbers)
    leading = shape[:-1]
    step = np.stack([computed.pop(f"step_{axis}_m") for axis in "enu"], axis=-1).reshape(*leading, 3)
    decision = np.array(computed.pop("decision"), dtype=np.str_).reshape(leading)
    excluded, ratio = computed.pop("excluded").reshape(shape), computed.pop("worst_ratio").reshape(leading)
    computed["n_sv"] = np.isfinite(unit).reshape(-1, len(of), 3).all(axis=-1).sum(axis=-1)
    return Monitored(_levels(computed, leading), decision, excluded, ratio, step)


@checked
def predict(
    orbits: Orbits,
    lat_rad: ArrayLike,
    lon_rad: ArrayLike,
    h_m: ArrayLike,
    time_s: ArrayLike,
    *,
    mask_rad: float = float(np.radians(5.0)),
    service: str | Service | Requirement = "lpv-200",
    support: Support = SUPPORT,
    model: str | ErrorModel = "dual-frequency",
    exclusion: bool = False,
) -> Levels:
    """Protection levels of every user at every instant, from orbits.

    Parameters
    ----------
    orbits : Orbits
        From ``gnss.constellation``: nominal, or an almanac; join several with ``+``.
    lat_rad, lon_rad, h_m : array_like
        Users, WGS-84; shapes that broadcast. [rad, rad, m]
    time_s : array_like
        Instants since the reference instant of the orbits. [s]
    mask_rad : float, optional
        Lowest elevation. [rad]
    service, exclusion
        As in :func:`protection_levels`.
    support : Support, optional
        What is promised of the satellites.
    model : str or ErrorModel, optional
        A name of :data:`ERROR_MODELS`, or a model of one's own.

    Returns
    -------
    Levels
        Arrays of the shape of ``time_s`` followed by that of the users.

    Raises
    ------
    InputError
        A user that is not on the Earth, a time that is not finite, promises outside their domain, a mask outside [0, pi/2).
    """
    shape, sky = overhead(orbits, (lat_rad, lon_rad, h_m), time_s, mask_rad)
    promises, airborne = support_rows(support), airborne_numbers(model)
    return _levels(_core.araim_predict(*sky, promises, airborne, rule_numbers(service), exclusion), shape)


def _columns(
    unit_enu: ArrayLike,
    constellation: Sequence[int] | NDArray[np.int64],
    sigmas_m: tuple[ArrayLike, ArrayLike],
    stated: tuple[ArrayLike | None, ArrayLike | None, ArrayLike | None],
    p_const: Sequence[float] | None,
) -> tuple[tuple[int, ...], list[NDArray[np.float64]], list[int], list[float]]:
    """Shape with the satellites, flat columns, constellation of each satellite, priors of constellations."""
    of = systems_of(unit_enu, constellation)
    bias, continuity, prior = (column[of] if own is None else own for own, column in zip(stated, _PROMISED, strict=True))
    shape, (unit, *columns) = flatten(
        unit_enu=(unit_enu, (3,)),
        sigma_int_m=(sigmas_m[0], ()),
        sigma_acc_m=(sigmas_m[1], ()),
        bias_m=(bias, ()),
        bias_continuity_m=(continuity, ()),
        p_sat=(prior, ()),
    )
    if shape[-1:] != of.shape:
        raise InputError("unit_enu", f"{of.size} satellites", domain=f"shape (..., {shape[-1]}, 3)")
    constants = list(SUPPORT.p_const) if p_const is None else [float(p) for p in p_const]
    if len(constants) != len(CONSTELLATIONS):
        raise InputError("p_const", f"{len(constants)} numbers", domain=f"{len(CONSTELLATIONS)} numbers, one a constellation")
    for k in sorted(set(of.tolist())):
        if not 0.0 < constants[k] < 1.0:
            raise InputError("p_const", constants[k], "1", "(0, 1)", index=k)
    return shape, [unit.ravel(), *columns], of.tolist(), constants


def _levels(computed: dict[str, Any], shape: tuple[int, ...]) -> Levels:
    status = _words(tuple(computed.pop("words")))[computed.pop("outcome")]
    return Levels(status=status.reshape(shape), **{name: values.reshape(shape) for name, values in computed.items()})


_PROMISED = tuple(np.asarray(column) for column in (SUPPORT.bias_m, SUPPORT.bias_continuity_m, SUPPORT.p_sat))
"""Biases and priors of :data:`SUPPORT` by constellation, for whoever states none."""

_words = lru_cache(maxsize=1)(np.array)
"""The words of the core's outcomes as an array."""


def demand(service: str) -> tuple[str, bool, tuple[tuple[str, float, str, str], ...]]:
    """What a service asks of levels: a service level's name, whether its vertical limit counts, and the effective monitor threshold.

    Raises
    ------
    InputError
        No such service.
    """
    if service not in SERVICES:
        raise InputError("service", service, domain=f"one of {', '.join(SERVICES)}")
    limits = SERVICES[service]
    if math.isnan(limits.emt_limit_m):
        return "NPA", False, ()
    return "LPV-200", True, (("emt_m", limits.emt_limit_m, limits.source, limits.provenance),)


def assumptions(model: str) -> list[str]:
    """What predicted levels rest on, as sentences."""
    errors, horizontal = ERROR_MODELS[model], SERVICES["horizontal"]
    return [
        f"Levels: solution separation over satellite and constellation faults; service horizontal: {horizontal.source} "
        f"({horizontal.provenance}).",
        f"Range errors: {errors.source} ({errors.provenance}); orbits, clocks and fault rates: {SUPPORT.source} ({SUPPORT.provenance}).",
    ]
