"""Scenarios of kind ``taxi``: a landing, a taxi route to a stand, and how the aircraft knows where it is on the way."""

from __future__ import annotations

import json
from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from navbound import _core
from navbound.errors import InputError
from navbound.scenario.models import GPS_EPOCH
from navbound.scenario.part import Part
from navbound.scenario.sensors import Imu

PhaseId = Literal["RWY", "RET", "NTW", "ATW", "TL", "SLL"]
"""The landing roll, and the sub-phases of :func:`navbound.gbas.sub_phases`."""


class Point(Part):
    """A point of the route, WGS-84, with the radius flown around it and the sub-phase that begins there."""

    name: str = Field(min_length=1)
    lat_rad: float = Field(ge=-1.5, le=1.5)
    lon_rad: float = Field(ge=-3.15, le=3.15)
    radius_m: float = Field(default=20.0, ge=0, le=2000)
    phase: PhaseId | None = None


class Motion(Part):
    """How fast: besides the sub-phases' largest speeds."""

    touchdown_along_m: float = Field(ge=0)
    touchdown_speed_mps: float = Field(gt=0, le=120)
    braking_mps2: float = Field(gt=0, le=5)
    acceleration_mps2: float = Field(gt=0, le=5)
    lateral_acceleration_mps2: float = Field(gt=0, le=5)
    steering_time_s: float = Field(gt=0, le=600)
    """Correlation time of the flight technical error."""


class Navigation(Part):
    """GBAS with an inertial system up to the transition point, RRAIM behind it."""

    mode: Literal["D", "F1", "F2"]
    case: Literal["A", "B"]
    covariance: Literal["snapshot", "paper", "bound"]
    """Noise that the inertial filter believes of smoothed multipath; ``snapshot``: ranges without an inertial system."""
    gps: Literal["gps", "gps-expanded"] = "gps"
    """Shipped slots of GPS."""
    settled_s: float = Field(ge=60, le=900)
    """How long the filter has run at the threshold."""
    transition: str
    """Point of the route from which no code is used."""
    bias_m: float = Field(ge=0, le=5)
    code_time_s: float = Field(gt=0, le=5000)
    """Correlation time of smoothed code."""
    phase_time_s: float = Field(gt=0, le=5000)
    """Correlation time of the noise of carrier phase."""
    mask_rad: float = Field(gt=0, lt=1.5)
    coasting_mask_rad: float = Field(ge=0, lt=1.5)


class _Fault(Part):
    satellite: str = Field(pattern="^[GE][0-9]{2}$")
    start_s: float = Field(ge=0)
    duration_s: float = Field(gt=0)
    missed: bool = False
    """Whether the ground monitors miss it for certain; otherwise chance decides, by their curve."""


class RangeStep(_Fault):
    """A differential range error that is there at once."""

    kind: Literal["range-step"]
    size_m: float


class RangeRamp(_Fault):
    """A differential range error that grows."""

    kind: Literal["range-ramp"]
    rate_mps: float


Fault = Annotated[RangeStep | RangeRamp, Field(discriminator="kind")]


class Taxi(Part):
    """A landing and the taxi-in."""

    kind: Literal["taxi"]
    operation: Literal["ground"] = "ground"
    title: str = Field(min_length=1)
    start_gps: datetime
    seed: int = Field(ge=0, lt=2**64)
    height_m: float = Field(ge=-1000, le=10_000)
    assumptions: list[str]
    source: str = Field(min_length=1)
    """Where the coordinates come from."""
    motion: Motion
    navigation: Navigation
    imu: Imu
    points: list[Point] = Field(min_length=3)
    faults: list[Fault] = Field(default=[])

    @field_validator("start_gps")
    @classmethod
    def _gps_time_has_no_zone(cls, value: datetime) -> datetime:
        if value.tzinfo is not None:
            raise ValueError("GPS time has no zone: write it without Z or an offset")
        return value

    @model_validator(mode="after")
    def _points_fit(self) -> Taxi:
        if self.points[0].phase is None:
            raise ValueError("the first point says which sub-phase begins")
        names = [p.name for p in self.points]
        if len(set(names)) < len(names):
            raise ValueError("points have names of their own")
        if self.navigation.transition not in names[1:-1]:
            raise ValueError(f"navigation.transition {self.navigation.transition!r} is no point between the first and the last")
        return self

    def check(self) -> None:
        """Refuse, with an :class:`InputError`, what cannot be driven."""
        _core.Ground(self.core_json())

    def core_json(self) -> str:
        """Write what the core reads."""
        kept = {"transition", "bias_m", "code_time_s", "phase_time_s"}
        faults = {"satellite", "missed"}
        return json.dumps(
            {
                "motion": self.motion.model_dump(),
                "navigation": self.navigation.model_dump(include=kept),
                "points": [p.model_dump() for p in self.points],
                "faults": [f.model_dump(exclude=faults) for f in self.faults],
            }
        )

    @property
    def start_ns(self) -> int:
        """GPS time of the first epoch, since 1980-01-06 [ns]."""
        return round((self.start_gps - GPS_EPOCH).total_seconds()) * 1_000_000_000

    @property
    def second_of_day(self) -> float:
        """Of the first epoch [s]: the nominal constellations begin at midnight."""
        midnight = self.start_gps.replace(hour=0, minute=0, second=0, microsecond=0)
        return (self.start_gps - midnight).total_seconds()


def check_satellites(taxi: Taxi, names: tuple[str, ...]) -> None:
    """Refuse a fault of a satellite that is not there."""
    for k, fault in enumerate(taxi.faults):
        if fault.satellite not in names:
            raise InputError(f"faults[{k}].satellite", fault.satellite, domain=f"{names[0]} to {names[-1]}")
