"""Scenarios of kind ``taxi``: a landing, a taxi route to a stand, and how the aircraft knows where it is on the way."""

from __future__ import annotations

import tomllib
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, field_validator, model_validator

from navbound.errors import FormatError, InputError
from navbound.scenario.models import GPS_EPOCH
from navbound.scenario.part import Part
from navbound.scenario.sensors import Imu
from navbound.scenario.units import Place, RepeatedKeyError, Written, to_si

FOLDER = Path(__file__).parent / "shipped" / "taxiing"

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
    """A landing and the way to the stand."""

    kind: Literal["taxi"]
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

    @property
    def start_ns(self) -> int:
        """GPS time of the first epoch, since 1980-01-06 [ns]."""
        return round((self.start_gps - GPS_EPOCH).total_seconds()) * 1_000_000_000

    @property
    def second_of_day(self) -> float:
        """Of the first epoch [s]: the nominal constellations begin at midnight."""
        midnight = self.start_gps.replace(hour=0, minute=0, second=0, microsecond=0)
        return (self.start_gps - midnight).total_seconds()


def shipped() -> list[str]:
    """Names of the taxi scenarios that ship with navbound."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def is_taxi(path: Path) -> bool:
    """Whether a scenario file says, itself or through its base, that it is of kind ``taxi``."""
    try:
        return _table(path).get("kind") == "taxi"
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError):
        # The reader of flights says what is wrong with it.
        return False


def load(path: Path) -> Taxi:
    """Read a taxi scenario.

    Raises
    ------
    FormatError
        Not TOML, a key that is unknown or missing, a value outside its domain.
    """
    written: dict[Place, Written] = {}
    try:
        return Taxi.model_validate(to_si(_table(path), written))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
        raise FormatError(path, f"not TOML: {e}") from e
    except OSError as e:
        raise FormatError(path, f"cannot be read: {e.strerror}") from e
    except RepeatedKeyError as e:
        raise FormatError(path, f"{e.value!r} is outside {e.domain}", field=e.argument) from e
    except ValidationError as e:
        first = e.errors()[0]
        place = tuple(part for part in first["loc"] if part not in {"range-step", "range-ramp"})
        entry = written.get(place)
        shown = "" if entry is None else f"{entry.value!r}: "
        raise FormatError(path, f"{shown}{first['msg']}", field=entry.key if entry else ".".join(map(str, place))) from e


def route_file(name_or_path: str | Path) -> Path | None:
    """File of a taxi scenario by its name or path; None for anything else."""
    if str(name_or_path) in shipped():
        return FOLDER / f"{name_or_path}.toml"
    path = Path(name_or_path)
    return path if path.is_file() and is_taxi(path) else None


def _table(path: Path) -> dict[str, Any]:
    """Table of a file, laid over the shipped scenario that it names as its ``base``."""
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    base = table.pop("base", None)
    if base not in shipped():
        return table if base is None else table | {"base": base}
    below = _table(FOLDER / f"{base}.toml")
    both = {k for k in table if isinstance(table[k], dict) and isinstance(below.get(k), dict)}
    return {**below, **table, **{k: {**below[k], **table[k]} for k in both}}


def check_satellites(taxi: Taxi, names: tuple[str, ...]) -> None:
    """Refuse a fault of a satellite that is not there."""
    for k, fault in enumerate(taxi.faults):
        if fault.satellite not in names:
            raise InputError(f"faults[{k}].satellite", fault.satellite, domain=f"{names[0]} to {names[-1]}")
