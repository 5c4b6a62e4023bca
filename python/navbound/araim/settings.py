"""What ARAIM may risk and what satellites promise: configurations, each with where its numbers come from."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.gnss.constellations import CONSTELLATIONS
from navbound.table.arguments import checked_fields
from navbound.table.arrays import flatten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from navbound.gnss.constellations import Orbits

    Floats = NDArray[np.float64]


@checked_fields
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


@checked_fields
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
    defaults = _core.araim_support()
    ura, ure, bias, continuity, p_sat, p_const = zip(*defaults["support"], strict=True)
    return Support(ura, ure, bias, continuity, p_sat, p_const, defaults["source"], defaults["provenance"])


SERVICES: dict[str, Service] = {name: Service(**numbers) for name, numbers in _core.araim_services().items()}
"""The shipped services by name: ``lpv-200`` and ``horizontal``."""

SUPPORT: Support = _support()
"""The shipped promises; no integrity support message is broadcast, so they are those of a study, marked as inferred."""


@checked_fields
@dataclass(frozen=True)
class Requirement:
    """What receivers without priors must meet (RAIM): one fault at a time; each in (0, 1).

    Attributes
    ----------
    false_alarm, missed_detection, fault_free : float
        Risk of a false alarm of one test, of missing a fault as large as the level, of exceeding the level without a fault. [1]
    source, provenance : str
        Where the numbers come from, and how they are held.
    """

    false_alarm: float
    missed_detection: float
    fault_free: float
    source: str = "the caller"
    provenance: str = "ours"


@checked_fields
@dataclass(frozen=True)
class ErrorModel:
    """Receiver, multipath and what the atmosphere leaves of one range.

    Attributes
    ----------
    noise : tuple of float
        a [m], b [m], e_0 [rad] of a + b exp(-E / e_0).
    vertical_ionosphere_m : float
        Standard deviation of the vertical ionospheric delay that is left. [m]
    source, provenance : str
        Where the numbers come from, and how they are held.
    """

    noise: tuple[float, float, float]
    vertical_ionosphere_m: float = 0.0
    source: str = "the caller"
    provenance: str = "ours"


RAIM = Requirement(**_core.raim_requirement())
"""En route to non-precision approach."""

ERROR_MODELS: dict[str, ErrorModel] = {
    name: ErrorModel(tuple(m["noise"]), m["vertical_ionosphere_m"], m["source"], m["provenance"])
    for name, m in _core.araim_error_models().items()
}
"""The shipped error models by name: ``dual-frequency`` and ``single-frequency``."""


def rule_numbers(service: str | Service | Requirement) -> list[float]:
    """Numbers that the core takes: seven of a service, three of RAIM."""
    if isinstance(service, str):
        known = RAIM if service == "raim" else SERVICES.get(service)
        if known is None:
            raise InputError("service", service, domain=f"one of {', '.join([*SERVICES, 'raim'])}")
        service = known
    return [float(getattr(service, name)) for name in (_OF_A_SERVICE if isinstance(service, Service) else _OF_RAIM)]


_OF_A_SERVICE = tuple(f.name for f in fields(Service)[:7])
_OF_RAIM = tuple(f.name for f in fields(Requirement)[:3])


def requirement_numbers(requirement: Requirement) -> list[float]:
    """Three numbers that the core takes."""
    if not isinstance(requirement, Requirement):
        raise InputError("requirement", repr(requirement)[:60], domain="a Requirement, such as RAIM")
    return rule_numbers(requirement)


def error_model(model: str | ErrorModel) -> ErrorModel:
    """A shipped model by its name, or the caller's."""
    if isinstance(model, ErrorModel):
        return model
    if model not in ERROR_MODELS:
        raise InputError("model", model, domain=f"one of {', '.join(ERROR_MODELS)}")
    return ERROR_MODELS[model]


def support_rows(support: Support) -> list[tuple[Any, ...]]:
    """Six numbers a constellation."""
    columns = [getattr(support, f.name) for f in fields(Support)[:6]]
    lengths = {len(column) for column in columns}
    if lengths != {5}:
        raise InputError("support", f"{sorted(lengths)} numbers", domain="five numbers of each kind, one a constellation")
    return list(zip(*columns, strict=True))


def overhead(
    orbits: Orbits, users: tuple[ArrayLike, ArrayLike, ArrayLike], time_s: ArrayLike, mask_rad: float
) -> tuple[tuple[int, ...], tuple[Floats, list[int], Floats, Floats, Floats, Floats, float]]:
    """Shape of every user (latitude, longitude, height) at every instant, and the satellites, instants and users as the core takes them.

    Raises
    ------
    InputError
        A mask outside [0, pi/2), users that do not broadcast.
    """
    if not 0 <= mask_rad < np.pi / 2:
        raise InputError("mask_rad", mask_rad, "rad", "[0, pi/2)")
    shape, (lat, lon, h) = flatten(lat_rad=(users[0], ()), lon_rad=(users[1], ()), h_m=(users[2], ()))
    instants, (time,) = flatten(time_s=(time_s, ()))
    return instants + shape, (orbits.elements(), orbits.constellation.tolist(), time, lat, lon, h, mask_rad)


def airborne_numbers(model: str | ErrorModel) -> list[float]:
    """Four numbers that the core takes."""
    numbers = error_model(model)
    return [*map(float, numbers.noise), float(numbers.vertical_ionosphere_m)]


def systems_of(unit_enu: ArrayLike, constellation: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
    """Constellation of every satellite of some lines of sight.

    Raises
    ------
    InputError
        Not one a satellite, no satellite at all, an index that is none of CONSTELLATIONS.
    """
    of = np.asarray(constellation, dtype=np.int64)
    lines = np.shape(unit_enu)
    if of.shape != lines[-2:-1]:
        raise InputError("constellation", f"shape {of.shape}", domain=f"shape {lines[-2:-1]}, one for each satellite of unit_enu")
    if of.size == 0:
        raise InputError("unit_enu", f"shape {lines}", domain="shape (..., n, 3) with at least one satellite; NaN for one not used")
    if of.min() >= 0 and of.max() < len(CONSTELLATIONS):
        return of
    for k in np.flatnonzero((of < 0) | (of >= len(CONSTELLATIONS)))[:1]:
        raise InputError("constellation", int(of[k]), domain=f"indices of CONSTELLATIONS, 0 to {len(CONSTELLATIONS) - 1}", index=int(k))
    return of


def stated(configured: Service | Requirement | Support | ErrorModel) -> str:
    """Where a configuration comes from and how it is held, the word not twice."""
    provenance = f"({configured.provenance})"
    return configured.source if configured.source.endswith(provenance) else f"{configured.source} {provenance}"
