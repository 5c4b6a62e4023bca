"""The shape of a scenario, in SI units: names and types.

What the numbers mean and which are allowed is declared once, where they are used (``crates/simulate/src/scenario.rs``).
"""

from __future__ import annotations

import json
from datetime import datetime, timedelta
from typing import Annotated, Literal

from pydantic import Field, field_validator

from navbound import _core
from navbound.scenario.part import Part
from navbound.scenario.sensors import Sensors

GPS_EPOCH = datetime(1980, 1, 6)


class Waypoint(Part):
    """A point of the route, WGS-84."""

    name: str = Field(min_length=1)
    lat_rad: float
    lon_rad: float
    kind: Literal["waypoint", "runway", "station"] = "waypoint"
    radius_m: float | None = None
    """Of the turn at it; 0 is a corner. Without it the bank decides."""


class Turns(Part):
    """Bank of a fly-by turn: half the track change, between these limits, and no faster than the rate."""

    bank_min_rad: float
    bank_max_rad: float
    rate_max_radps: float


class Profile(Part):
    """Heights above the ellipsoid and speeds over the ground."""

    departure_height_m: float
    arrival_height_m: float
    cruise_height_m: float
    roll_acceleration_mps2: float
    rotation_speed_mps: float
    initial_climb_speed_mps: float
    initial_climb_height_m: float
    acceleration_height_m: float
    climb_step_heights_m: list[float]
    climb_rates_mps: list[float]
    descent_angle_rad: float
    landing_speed_mps: float


class Guidance(Part):
    """Guidance law and response of the aircraft."""

    lateral_frequency_radps: float
    lateral_damping: float
    bank_lag_s: float
    bank_limit_rad: float
    vertical_gain_per_s: float
    path_angle_lag_s: float
    vertical_acceleration_mps2: float
    vertical_lead_s: float


class Gusts(Part):
    """Gusts: first-order Gauss-Markov along the flown way."""

    lateral_sigma_mps: float
    vertical_sigma_mps: float
    length_m: float


class Navigation(Part):
    """How the aircraft knows where it is."""

    constellations: list[Literal["gps", "gps-expanded", "galileo", "beidou"]]
    mask_rad: float
    ranging_sigma_m: float
    ionosphere_sigma_m: float
    troposphere_sigma_m: float
    noise_sigma_m: float
    multipath_share: float
    correlation_time_s: float
    claimed_sigma_scale: float = 1.0


class Phase(Part):
    """A phase of flight and the RNP value in force; the last has no end."""

    name: str = Field(min_length=1)
    rnp_m: float
    until_waypoint: str | None = None
    until_before_end_m: float | None = None


class LateralRamp(Part):
    """The navigation error grows across the path, positive right, and the claimed covariance knows nothing of it."""

    kind: Literal["lateral-ramp"]
    start_s: float
    duration_s: float
    rate_mps: float


class DegradedRanging(Part):
    """Ranging gets worse: the error and the claimed covariance grow together."""

    kind: Literal["degraded-ranging"]
    start_s: float
    duration_s: float
    sigma_factor: float


class Filter(Part):
    """The navigation filter that joins the sensors."""

    mode: Literal["correlated", "white"]
    form: Literal["tight", "loose", "federated"] = "tight"
    reversion: bool = True
    """A filter without satellites beside the main one, which it is compared with."""
    separation_risk: float = 1e-7
    gate_risk: float
    samples_per_step: int
    restart_after_s: float
    start_factor: list[float] = Field(default=[1.0, 1.0, 1.0], min_length=3, max_length=3)
    """How many times as far as declared the start is off: position, tilt, heading."""
    unit_factor: float = 1.0
    """Deviations of the inertial unit as declared to the filter over those that it has."""
    position_sigma_m: list[float] = Field(min_length=3, max_length=3)
    velocity_sigma_mps: float
    attitude_sigma_rad: list[float] = Field(min_length=3, max_length=3)


Fault = Annotated[LateralRamp | DegradedRanging, Field(discriminator="kind")]


class Scenario(Part):
    """One simulated flight, or many of them."""

    kind: Literal["flight"] = "flight"
    operation: Literal["en-route", "approach"] = "en-route"
    """What is flown; the epochs, the summary and the report take it from here."""
    title: str = Field(min_length=1)
    start_gps: datetime
    """GPS time of the first epoch, without a zone."""
    duration_s: float
    seed: int = Field(ge=0, lt=2**64)
    assumptions: list[str]
    waypoints: list[Waypoint]
    turns: Turns
    profile: Profile
    guidance: Guidance
    gusts: Gusts
    navigation: Navigation
    phases: list[Phase] = Field(min_length=1)
    faults: list[Fault] = Field(default=[])
    sensors: Sensors | None = None
    filter: Filter | None = None
    """Without one the position errors are drawn from the covariance of the satellite geometry."""

    @field_validator("start_gps")
    @classmethod
    def _gps_time_has_no_zone(cls, value: datetime) -> datetime:
        if value.tzinfo is not None:
            raise ValueError("GPS time has no zone: write it without Z or an offset")
        return value

    @property
    def start_ns(self) -> int:
        """GPS time of the first epoch, since 1980-01-06 [ns]."""
        return (self.start_gps - GPS_EPOCH) // timedelta(microseconds=1) * 1000

    def check(self) -> None:
        """Refuse, with an :class:`InputError`, what cannot be flown."""
        _core.Outlook.check(self.core_json())

    def core_json(self) -> str:
        """Write what the core reads."""
        data = self.model_dump(mode="json", exclude={"kind", "operation", "title", "start_gps", "seed", "assumptions", "waypoints"})
        data["waypoints"] = [w.model_dump(exclude={"kind"}, exclude_none=True) for w in self.waypoints]
        return json.dumps(data | {"start_ns": self.start_ns})
