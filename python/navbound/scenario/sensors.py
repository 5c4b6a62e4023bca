"""The shape of a scenario's ``[sensors]`` part, in SI units: names and types.

What the numbers mean and which are allowed is declared once, where they are used (``crates/simulate/src/sensors/settings.rs``).
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from navbound.scenario.faults import SensorFault
from navbound.scenario.part import Part

_GRADES = Path(__file__).parents[1] / "data" / "imu-grades.toml"


def grades() -> dict[str, dict[str, float]]:
    """Grades of inertial units, as written: keys end in their units."""
    return tomllib.loads(_GRADES.read_text(encoding="utf-8"))


class Imu(Part):
    """Errors of an inertial unit."""

    gyro_bias_radps: float
    gyro_in_run_radps: float
    gyro_noise_radprts: float
    gyro_scale: float
    gyro_misalignment_rad: float
    accelerometer_bias_mps2: float
    accelerometer_in_run_mps2: float
    accelerometer_noise_mpsprts: float
    accelerometer_scale: float
    accelerometer_misalignment_rad: float
    in_run_time_s: float


class Envelope(Part):
    """What the inertial unit can measure and the vehicle can do."""

    force_range_mps2: float
    rate_range_radps: float
    force_most_mps2: float
    rate_most_radps: float
    force_change_mps3: float


class RangeParts(Part):
    """Errors of a code range in real mode."""

    noise_sigma_m: float
    ranging_sigma_m: float
    ranging_time_s: float
    ionosphere_sigma_m: float
    ionosphere_time_s: float
    troposphere_sigma_m: float
    troposphere_time_s: float
    multipath_share: float
    multipath_time_s: float


class Gnss(Part):
    """A satellite receiver."""

    constellations: list[Literal["gps", "gps-expanded", "galileo", "beidou"]]
    mask_rad: float
    interval_s: float
    mode: Literal["seed", "real"]
    seed_sigma_m: float
    parts: RangeParts
    rate_sigma_mps: float
    phase_sigma_m: float
    clock_sigma_m: float
    drift_sigma_mps: float
    clock_density_m2ps: float
    drift_density_m2ps3: float
    system_bias_sigma_m: float


class Coverage(Part):
    """Where a station may be used."""

    range_least_m: float
    range_most_m: float
    elevation_most_rad: float


class Dme(Part):
    """Ranges to DME stations."""

    interval_s: float
    bias_sigma_m: float
    noise_least_m: float
    noise_share: float
    coverage: Coverage


class Vor(Part):
    """Bearings from VOR stations."""

    interval_s: float
    bias_sigma_rad: float
    noise_sigma_rad: float
    coverage: Coverage


class Baro(Part):
    """A barometric altimeter."""

    interval_s: float
    bias_sigma_m: float
    bias_time_s: float
    temperature_sigma_k: float
    temperature_share: float
    noise_sigma_m: float
    lag_s: float


class Station(Part):
    """A station on the ground."""

    name: str = Field(min_length=1)
    kind: Literal["dme", "vor", "vor-dme"]
    lat_rad: float
    lon_rad: float
    height_m: float


class Sensors(Part):
    """What the aircraft carries."""

    path: Literal["planned", "flown"]
    rate_hz: int
    imu: Imu
    envelope: Envelope | None = None
    gnss: Gnss | None = None
    dme: Dme | None = None
    vor: Vor | None = None
    baro: Baro | None = None
    stations: list[Station] = Field(default=[])
    faults: list[SensorFault] = Field(default=[])


def with_grade(table: dict[str, Any]) -> dict[str, Any]:
    """Put the numbers of a named grade in the place of its name; numbers given beside it win.

    Raises
    ------
    KeyError
        A grade that is not there.
    """
    imu = table.get("sensors", {}).get("imu", {}) if isinstance(table.get("sensors", {}), dict) else {}
    if not isinstance(imu, dict) or "grade" not in imu:
        return table
    own = {key: value for key, value in imu.items() if key != "grade"}
    return table | {"sensors": table["sensors"] | {"imu": grades()[imu["grade"]] | own}}
