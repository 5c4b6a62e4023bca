"""The kinds of fault of the campaign: each with its sizes around the limit of detection, and what it does to a scenario."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Callable

Family = Literal["inertial", "satellites", "stations", "altimeter", "start", "tuning", "pair"]
Change = dict[str, Any]
"""``faults``: entries of ``[[sensors.faults]]``; ``filter``: keys of ``[filter]``."""

LASTING_S = 1e4
"""Longer than any flight: the fault stays."""
ONE_SIZE = (math.nan,)


@dataclass(frozen=True)
class Kind:
    """A kind of fault.

    Attributes
    ----------
    id, family : str
        Word of tables, and what fails.
    unit : str
        Of its sizes; empty where size has no meaning.
    sizes : tuple of float
        Around the limit of detection.
    change : callable
        Makes of a size and an onset [s] what differs from the healthy scenario.
    """

    id: str
    family: Family
    unit: str
    sizes: tuple[float, ...]
    change: Callable[[float, float], Change]


def _fault(kind: str, start_s: float, duration_s: float | None = LASTING_S, **numbers: object) -> Change:
    lasting = {} if duration_s is None else {"duration_s": duration_s}
    return {"faults": [{"kind": kind, "start_s": start_s, **lasting, **numbers}]}


def _both(first: Change, second: Change) -> Change:
    return {"faults": [*first.get("faults", []), *second.get("faults", [])], "filter": first.get("filter", {}) | second.get("filter", {})}


def _axis(index: int, size: float) -> list[float]:
    return [size if k == index else 0.0 for k in range(3)]


ZERO = [0.0, 0.0, 0.0]
STATIONS = ("VYK", "TAJ")
SATELLITES = ("G01", "G06")
ACCELERATIONS = (0.005, 0.02, 0.1, 0.5, 2.0, 10.0)
RATES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1)
STEPS_M = (3.0, 10.0, 30.0, 100.0, 300.0, 3000.0)
RAMPS_MPS = (0.01, 0.03, 0.1, 0.3, 1.0, 10.0)
LENGTHS_S = (0.2, 0.5, 1.0, 3.0, 10.0, 60.0)


def _trouble(what: str) -> Callable[[float, float], Change]:
    return lambda size, start_s: _fault("imu-trouble", start_s, size, what=what)


def _accelerometer(axis: int) -> Callable[[float, float], Change]:
    return lambda size, start_s: _fault("imu-bias-jump", start_s, None, gyro_radps=ZERO, accelerometer_mps2=_axis(axis, size))


def _gyroscope(axis: int) -> Callable[[float, float], Change]:
    return lambda size, start_s: _fault("imu-bias-jump", start_s, None, gyro_radps=_axis(axis, size), accelerometer_mps2=ZERO)


def _receiver(what: str) -> Callable[[float, float], Change]:
    return lambda size, start_s: _fault("receiver-trouble", start_s, size, what=what)


def _start(place: int) -> Callable[[float, float], Change]:
    return lambda size, _start_s: {"filter": {"start_factor": [size if k == place else 1.0 for k in range(3)]}}


DURATIONS_S = (1.0, 3.0, 10.0, 30.0, 100.0, LASTING_S)

INERTIAL = (
    Kind("imu-nan", "inertial", "s", (0.1, 0.5, 1.0, 10.0, 60.0, LASTING_S), _trouble("not-a-number")),
    Kind("imu-silent", "inertial", "s", (0.1, 0.5, 1.0, 10.0, 60.0, LASTING_S), _trouble("silent")),
    Kind("imu-late", "inertial", "s", DURATIONS_S, _trouble("late")),
    Kind("imu-zeros", "inertial", "s", DURATIONS_S, _trouble("zeros")),
    Kind("imu-frozen-accelerometers", "inertial", "s", DURATIONS_S, _trouble("frozen-accelerometers")),
    Kind("imu-frozen-gyroscopes", "inertial", "s", DURATIONS_S, _trouble("frozen-gyroscopes")),
    Kind("imu-frozen", "inertial", "s", DURATIONS_S, _trouble("frozen")),
    Kind("imu-swapped-axes", "inertial", "s", DURATIONS_S, _trouble("swapped-axes")),
    Kind("imu-repeated", "inertial", "s", DURATIONS_S, _trouble("repeated")),
    Kind("imu-lost", "inertial", "s", DURATIONS_S, _trouble("lost")),
    Kind("imu-reversed", "inertial", "s", DURATIONS_S, _trouble("reversed")),
    *(Kind(f"accelerometer-{axis}-step", "inertial", "m/s²", ACCELERATIONS, _accelerometer(k)) for k, axis in enumerate("xyz")),
    *(Kind(f"gyroscope-{axis}-step", "inertial", "rad/s", RATES, _gyroscope(k)) for k, axis in enumerate("xyz")),
    Kind(
        "accelerometer-ramp",
        "inertial",
        "m/s³",
        (1e-5, 1e-4, 3e-4, 1e-3, 1e-2, 0.1),
        lambda size, s: _fault("imu-ramp", s, gyro_radps2=ZERO, accelerometer_mps3=_axis(0, size)),
    ),
    Kind(
        "gyroscope-ramp",
        "inertial",
        "rad/s²",
        (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3),
        lambda size, s: _fault("imu-ramp", s, gyro_radps2=_axis(1, size), accelerometer_mps3=ZERO),
    ),
    Kind(
        "accelerometer-scale",
        "inertial",
        "1",
        (1e-4, 1e-3, 3e-3, 1e-2, 0.1, 0.5),
        lambda size, s: _fault("imu-scale", s, gyro=0.0, accelerometer=size),
    ),
    Kind(
        "gyroscope-scale",
        "inertial",
        "1",
        (1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0),
        lambda size, s: _fault("imu-scale", s, gyro=size, accelerometer=0.0),
    ),
    Kind("imu-noise", "inertial", "1", (3.0, 10.0, 30.0, 100.0, 300.0, 1000.0), lambda size, s: _fault("imu-noise", s, factor=size)),
    Kind(
        "imu-pulse-5g",
        "inertial",
        "s",
        LENGTHS_S,
        lambda size, s: _fault("imu-pulse", s, size, gyro_radps=ZERO, accelerometer_mps2=[49.0, 0.0, 0.0]),
    ),
    Kind(
        "imu-clip",
        "inertial",
        "m/s²",
        (1.0, 5.0, 9.0, 9.6, 9.80665, 10.5),
        lambda size, s: _fault("imu-clip", s, gyro_radps=10.0, accelerometer_mps2=size),
    ),
    Kind(
        "imu-clock-back", "inertial", "s", (0.05, 0.1, 0.3, 1.0, 10.0, 120.0), lambda d, s: _fault("imu-clock", s, offset_s=-d, drift=0.0)
    ),
    Kind(
        "imu-clock-ahead", "inertial", "s", (0.05, 0.1, 0.3, 1.0, 10.0, 1000.0), lambda d, s: _fault("imu-clock", s, offset_s=d, drift=0.0)
    ),
    Kind(
        "imu-clock-drift",
        "inertial",
        "s/s",
        (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.05),
        lambda d, s: _fault("imu-clock", s, offset_s=0.0, drift=d),
    ),
)

RECEIVER = (
    Kind("satellite-step", "satellites", "m", STEPS_M, lambda m, s: _fault("satellite-step", s, satellite=SATELLITES[0], step_m=m)),
    Kind("satellite-ramp", "satellites", "m/s", RAMPS_MPS, lambda v, s: _fault("satellite-ramp", s, satellite=SATELLITES[0], rate_mps=v)),
    Kind(
        "two-satellites-step", "satellites", "m", STEPS_M, lambda m, s: _fault("satellites-step", s, satellites=list(SATELLITES), step_m=m)
    ),
    Kind(
        "two-satellites-ramp",
        "satellites",
        "m/s",
        RAMPS_MPS,
        lambda v, s: _fault("satellites-ramp", s, satellites=list(SATELLITES), rate_mps=v),
    ),
    Kind("constellation-step", "satellites", "m", STEPS_M, lambda m, s: _fault("satellites-step", s, satellites=["E"], step_m=m)),
    Kind("constellation-ramp", "satellites", "m/s", RAMPS_MPS, lambda v, s: _fault("satellites-ramp", s, satellites=["E"], rate_mps=v)),
    Kind("receiver-frozen", "satellites", "s", DURATIONS_S, _receiver("frozen")),
    Kind("receiver-late", "satellites", "s", (0.1, 0.2, 0.5, 1.0, 2.0, 5.0), lambda d, s: _fault("receiver-delay", s, delay_s=d)),
    Kind(
        "receiver-late-from-the-start",
        "satellites",
        "s",
        (0.1, 0.2, 0.5, 1.0, 2.0, 5.0),
        lambda d, _s: _fault("receiver-delay", 0.0, delay_s=d),
    ),
    Kind("receiver-rows-repeated", "satellites", "s", DURATIONS_S, _receiver("repeated")),
    Kind("receiver-one-name", "satellites", "s", DURATIONS_S, _receiver("one-name")),
    Kind("rates-reversed", "satellites", "s", DURATIONS_S, _receiver("rates-reversed")),
    Kind(
        "spoofer-with-rates",
        "satellites",
        "m/s",
        (0.1, 0.3, 1.0, 3.0, 10.0, 100.0),
        lambda v, s: _fault("spoofing", s, right_mps=v, up_mps=0.0),
    ),
    Kind(
        "spoofer-without-rates",
        "satellites",
        "m/s",
        (0.1, 0.3, 1.0, 3.0, 10.0, 100.0),
        lambda v, s: _fault("spoofing", s, right_mps=v, up_mps=0.0, rates=False),
    ),
    Kind("outage", "satellites", "s", (1.0, 10.0, 30.0, 100.0, 300.0, LASTING_S), lambda d, s: _fault("interference", s, d)),
    Kind("sigma-too-small", "satellites", "1", (1.5, 2.0, 3.0, 5.0, 10.0, 30.0), lambda k, s: _fault("receiver-sigma", s, factor=1.0 / k)),
    Kind("sigma-too-large", "satellites", "1", (1.5, 2.0, 3.0, 5.0, 10.0, 30.0), lambda k, s: _fault("receiver-sigma", s, factor=k)),
)

OTHERS = (
    Kind(
        "dme-step",
        "stations",
        "m",
        (100.0, 300.0, 1000.0, 3000.0, 1e4, 1e5),
        lambda m, s: _fault("dme-bias", s, station=STATIONS[0], bias_m=m),
    ),
    Kind(
        "two-dme-step",
        "stations",
        "m",
        (100.0, 300.0, 1000.0, 3000.0, 1e4, 1e5),
        lambda m, s: _both(*(_fault("dme-bias", s, station=name, bias_m=m) for name in STATIONS)),
    ),
    Kind("dme-biases", "stations", "1", (2.0, 3.0, 5.0, 10.0, 30.0, 100.0), lambda k, s: _fault("dme-biases", s, factor=k)),
    Kind("altimeter-frozen", "altimeter", "s", DURATIONS_S, lambda d, s: _fault("baro-frozen", s, d)),
    Kind("altimeter-blocked", "altimeter", "s", DURATIONS_S, lambda d, s: _fault("baro-blockage", s, d)),
    Kind("start-position", "start", "1", (2.0, 3.0, 5.0, 10.0, 30.0, 100.0), _start(0)),
    Kind("start-tilt", "start", "1", (2.0, 3.0, 5.0, 10.0, 30.0, 100.0), _start(1)),
    Kind("start-heading", "start", "1", (2.0, 3.0, 5.0, 10.0, 30.0, 100.0), _start(2)),
    Kind("unit-declared-too-good", "tuning", "1", (2.0, 3.0, 10.0, 30.0, 100.0, 300.0), lambda k, _s: {"filter": {"unit_factor": 1.0 / k}}),
    Kind("unit-declared-too-bad", "tuning", "1", (2.0, 3.0, 10.0, 30.0, 100.0, 300.0), lambda k, _s: {"filter": {"unit_factor": k}}),
    Kind(
        "outage-and-accelerometer",
        "pair",
        "m/s²",
        ACCELERATIONS,
        lambda a, s: _both(_fault("interference", max(s - 120.0, 0.0)), _accelerometer(0)(a, s)),
    ),
    Kind(
        "outage-and-dme-step",
        "pair",
        "m",
        (100.0, 300.0, 1000.0, 3000.0, 1e4, 1e5),
        lambda m, s: _both(_fault("interference", s), _fault("dme-bias", s + 30.0, station=STATIONS[0], bias_m=m)),
    ),
    Kind(
        "accelerometer-and-satellite",
        "pair",
        "m/s²",
        ACCELERATIONS,
        lambda a, s: _both(_accelerometer(0)(a, s), _fault("satellite-step", s, satellite=SATELLITES[0], step_m=100.0)),
    ),
)

KINDS: tuple[Kind, ...] = (*INERTIAL, *RECEIVER, *OTHERS)
"""Every kind, single faults before pairs."""

ONSETS_S = (60.0, 200.0, 350.0, 520.0, 700.0)
"""Climb, turn, level, descent, approach of the campaign's flight."""
