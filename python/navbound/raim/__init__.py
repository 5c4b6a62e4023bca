"""RAIM by least-squares residuals: one faulty satellite at a time, the weighted slope method.

Brown and Chin 1997 with the weights of Walter and Enge 1995 (inferred: the text was not
read). RAIM by solution separation, and faults of several
satellites or constellations, are in :mod:`navbound.araim`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound.araim.settings import (
    ERROR_MODELS,
    RAIM,
    SUPPORT,
    ErrorModel,
    Requirement,
    Support,
    airborne_numbers,
    overhead,
    requirement_numbers,
    support_rows,
    systems_of,
)
from navbound.errors import InputError
from navbound.gnss.constellations import Orbits
from navbound.gnss.monitor_fit import Fit
from navbound.gnss.watched import Watched
from navbound.raim.recorded import SOURCES, watch
from navbound.table.arguments import checked
from navbound.table.arrays import flatten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "ERROR_MODELS",
    "RAIM",
    "SOURCES",
    "SUPPORT",
    "ErrorModel",
    "Fit",
    "Levels",
    "Monitored",
    "Requirement",
    "Support",
    "Watched",
    "factors",
    "monitor",
    "predict",
    "protection_levels",
    "watch",
]


@dataclass(frozen=True)
class Levels:
    """Protection levels; arrays of the leading shape.

    Levels are infinite where a fault cannot be detected, those after exclusion where it cannot be excluded; all are NaN where there is no
    position.

    Attributes
    ----------
    hpl_m, vpl_m : ndarray
        Horizontal and vertical protection level of detection, the noise of the position in it. [m]
    hel_m, vel_m : ndarray
        Horizontal and vertical exclusion level: the largest level of detection after the exclusion of any one satellite, never below the
        level of detection. [m]
    hpl_slope_m, vpl_slope_m : ndarray
        The published level of detection, without the noise; shown beside the others, since it does not hold what it promises where the
        noise is not small against it (docs/methods/raim.md). [m]
    sigma_e_m, sigma_n_m, sigma_u_m : ndarray
        Standard deviation of the position. [m]
    n_redundant : ndarray of int
        Ranges beyond the unknowns: one is needed for detection, two for exclusion. [1]
    n_sv : ndarray of int
        Satellites used. [1]
    status : ndarray of str
        ``ok``, ``not_monitored`` (a fault cannot be detected), ``too_few_satellites``, ``singular``, ``too_many`` (satellites).
    """

    hpl_m: NDArray[np.float64]
    vpl_m: NDArray[np.float64]
    hel_m: NDArray[np.float64]
    vel_m: NDArray[np.float64]
    hpl_slope_m: NDArray[np.float64]
    vpl_slope_m: NDArray[np.float64]
    sigma_e_m: NDArray[np.float64]
    sigma_n_m: NDArray[np.float64]
    sigma_u_m: NDArray[np.float64]
    n_redundant: NDArray[np.int64]
    n_sv: NDArray[np.int64]
    status: NDArray[np.str_]


@dataclass(frozen=True)
class Monitored:
    """Epochs after detection and exclusion; arrays of the leading shape.

    Attributes
    ----------
    levels : Levels
        ``hpl_m``, ``vpl_m`` and their like of the satellites that are left; ``hel_m`` and ``vel_m`` of all, as predicted before the test.
    decision : ndarray of str
        ``none`` (the residuals agree), ``excluded``, ``not_excluded`` (a fault, and no single satellite explains it: the position is not to
        be used); empty where there is no position. Without a redundant range nothing was tested: ``none`` with infinite levels.
    excluded : ndarray of bool, shape (..., n)
        The satellite excluded.
    ratio : ndarray
        Root of the weighted sum of squared residuals before exclusion, against its threshold. [1]
    step_enu_m : ndarray, shape (..., 3)
        The position from the place of the residuals, east, north, up. [m]
    """

    levels: Levels
    decision: NDArray[np.str_]
    excluded: NDArray[np.bool_]
    ratio: NDArray[np.float64]
    step_enu_m: NDArray[np.float64]


@checked
def factors(n_redundant: ArrayLike, requirement: Requirement = RAIM) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Threshold and missed bias of a test, by the number of redundant ranges.

    T² is what a chi-square variable exceeds with the risk of a false alarm; the variable of non-centrality bias² is at most T² with the
    risk of a missed detection (Brown and Chin 1997; inferred, the text was not read).

    Parameters
    ----------
    n_redundant : array_like of int
        Ranges beyond the unknowns. [1]
    requirement : Requirement, optional
        Risks.

    Returns
    -------
    threshold, missed_bias : ndarray
        Both of the shape of ``n_redundant``. [1]

    Raises
    ------
    InputError
        A number outside [1, 60], risks outside [1e-300, 0.5].
    """
    n = np.asarray(n_redundant)
    if not np.issubdtype(n.dtype, np.integer):
        raise InputError("n_redundant", repr(n_redundant)[:60], domain="whole numbers")
    pairs = np.array(_core.raim_factors(n.ravel().tolist(), requirement_numbers(requirement)), dtype=np.float64).reshape(-1, 2)
    return pairs[:, 0].reshape(n.shape), pairs[:, 1].reshape(n.shape)


@checked
def protection_levels(
    unit_enu: ArrayLike,
    constellation: Sequence[int] | NDArray[np.int64],
    sigma_m: ArrayLike,
    *,
    requirement: Requirement = RAIM,
) -> Levels:
    """Protection levels of many epochs from lines of sight, of detection and after exclusion.

    With slope_i = ``|s_i|`` / sqrt(w_i (1 - leverage_i)) the published level is max slope_i · missed_bias; the level is
    max(K_ff d, max slope_i · missed_bias + K d) with K = Q⁻¹(P_MD/2), K_ff = Q⁻¹(P_ff/2) and d the standard deviation upwards, or
    sqrt(sigma_e² + sigma_n²) (Brown and Chin 1997, standard; noise ours).

    Parameters
    ----------
    unit_enu : array_like, shape (..., n, 3)
        Unit vectors from the receiver to the satellites, east-north-up; three NaN for one that is not used. [1]
    constellation : sequence of int, shape (n,)
        Index of each satellite's system in ``gnss.CONSTELLATIONS``; each has a clock of its own.
    sigma_m : array_like, shape (..., n)
        Standard deviation of each range. [m]
    requirement : Requirement, optional
        Risks.

    Returns
    -------
    Levels

    Raises
    ------
    InputError
        Vectors that are not of length one, sigmas that are not positive, risks outside [1e-300, 0.5].
    """
    shape, unit, sigma, of = _columns(unit_enu, constellation, sigma_m)
    return _levels(_core.raim_levels(unit, sigma, of, requirement_numbers(requirement)), shape[:-1])


@checked
def monitor(
    unit_enu: ArrayLike,
    constellation: Sequence[int] | NDArray[np.int64],
    residual_m: ArrayLike,
    sigma_m: ArrayLike,
    *,
    requirement: Requirement = RAIM,
) -> Monitored:
    """Detection and exclusion on residuals of many epochs, and the levels of what is left.

    The weighted sum of squared residuals is compared with its threshold; above it the satellite is left out without which the sum falls
    most, if the rest then agrees (least-squares residuals, data snooping; standard).

    Parameters
    ----------
    residual_m : array_like, shape (..., n)
        Measured less computed ranges at the place of the lines of sight; receiver clocks may be in them. [m]
    unit_enu, constellation, sigma_m, requirement
        As in :func:`protection_levels`.

    Raises
    ------
    InputError
        As :func:`protection_levels`; a residual of a satellite in use that is not finite.
    """
    together, (lines, residual) = flatten(unit_enu=(unit_enu, (3,)), residual_m=(residual_m, ()))
    shape, unit, sigma, of = _columns(lines.reshape(*together, 3), constellation, sigma_m)
    if shape != together:
        raise InputError("residual_m", f"shape {together}", domain=f"shape {shape}, one for each range")
    computed = _core.raim_monitor(unit, residual, sigma, of, requirement_numbers(requirement))
    leading = shape[:-1]
    step = np.stack([computed.pop(f"step_{axis}_m") for axis in "enu"], axis=-1).reshape(*leading, 3)
    decision = np.array(computed.pop("decision"), dtype=np.str_).reshape(leading)
    excluded, ratio = computed.pop("excluded").reshape(shape), computed.pop("ratio").reshape(leading)
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
    requirement: Requirement = RAIM,
    support: Support = SUPPORT,
    model: str | ErrorModel = "single-frequency",
) -> Levels:
    """Protection levels of every user at every instant, from orbits.

    Parameters
    ----------
    orbits : Orbits
        From ``gnss.constellation``: nominal, or an almanac; join several with ``+``, leave satellites out with ``without``.
    lat_rad, lon_rad, h_m : array_like
        Users, WGS-84; shapes that broadcast. [rad, rad, m]
    time_s : array_like
        Instants since the reference instant of the orbits. [s]
    mask_rad : float, optional
        Lowest elevation. [rad]
    requirement : Requirement, optional
        Risks.
    support : Support, optional
        What is promised of the satellites: of it RAIM takes ``sigma_ura_m``, since it knows no priors and no biases.
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
    return _levels(_core.raim_predict(*sky, promises, airborne, requirement_numbers(requirement)), shape)


def _columns(
    unit_enu: ArrayLike, constellation: Sequence[int] | NDArray[np.int64], sigma_m: ArrayLike
) -> tuple[tuple[int, ...], NDArray[np.float64], NDArray[np.float64], list[int]]:
    """Shape with the satellites, flat columns, constellation of each satellite."""
    of = systems_of(unit_enu, constellation)
    shape, (unit, sigma) = flatten(unit_enu=(unit_enu, (3,)), sigma_m=(sigma_m, ()))
    if shape[-1:] != of.shape:
        raise InputError("unit_enu", f"{of.size} satellites", domain=f"shape (..., {shape[-1]}, 3)")
    return shape, unit.ravel(), sigma, of.tolist()


def _levels(computed: dict[str, Any], shape: tuple[int, ...]) -> Levels:
    status = np.array(computed.pop("words"))[computed.pop("outcome")]
    return Levels(status=status.reshape(shape), **{name: values.reshape(shape) for name, values in computed.items()})


def assumptions(model: str) -> list[str]:
    """What predicted levels rest on, as sentences."""
    errors = ERROR_MODELS[model]
    return [
        f"Levels: {SOURCES[0]}; {SOURCES[1]}. No aiding by a barometric altimeter.",
        f"Risks: false alarm {RAIM.false_alarm:g}, missed detection {RAIM.missed_detection:g}, without a fault {RAIM.fault_free:g}: "
        f"{RAIM.source}; together {RAIM.provenance}.",
        f"Range errors: {errors.source} ({errors.provenance}); orbits and clocks: {SUPPORT.source} ({SUPPORT.provenance}).",
        "One satellite fails at a time.",
    ]
