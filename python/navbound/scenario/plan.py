"""A flight that is planned: the shape of ``PLAN.toml`` in SI units, and its reader.

A plan names a scenario for the aircraft (profile, sensors, filter, phases) and says what differs on the day: route, departure, equipment,
satellites, notices, jamming.
"""

from __future__ import annotations

import tomllib
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, ValidationError, model_validator

from navbound.errors import FormatError
from navbound.scenario.models import Phase
from navbound.scenario.part import Part
from navbound.scenario.sensors import Station, grades
from navbound.scenario.units import RepeatedKeyError, Written, to_si
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

Steering = Literal["autopilot", "flight-director", "manual"]
FTE_95_NM: dict[Steering, tuple[float, float]] = {
    "autopilot": (0.25, 0.125),
    "flight-director": (0.5, 0.25),
    "manual": (1.0, 0.5),
}
"""95 % flight technical error en route and on approach. Provenance: inferred; clause unknown. [NM]"""


class Window(Part):
    """A time, from the departure, by the clock, or along the route; without an end it lasts to the end of the flight."""

    from_s: float | None = Field(default=None, ge=0)
    until_s: float | None = None
    from_utc: datetime | None = None
    until_utc: datetime | None = None
    from_along_m: float | None = Field(default=None, ge=0)
    until_along_m: float | None = None

    @model_validator(mode="after")
    def _one_kind_of_place(self) -> Window:
        for time in (self.from_utc, self.until_utc):
            if time is not None and time.tzinfo is None:
                raise ValueError("needs times with a zone, as 2026-11-22T06:00:00Z")
        clock = [None if t is None else t.timestamp() for t in (self.from_utc, self.until_utc)]
        kinds = [(self.from_s, self.until_s), (clock[0], clock[1]), (self.from_along_m, self.until_along_m)]
        used = [kind for kind in kinds if kind != (None, None)]
        if len(used) > 1:
            raise ValueError("is one of from_s/until_s (or _min), from_utc/until_utc, from_along_m/until_along_m (or _nm), not several")
        for begin, end in used:
            if begin is None:
                raise ValueError("has an end and no begin")
            if end is not None and not begin < end:
                raise ValueError("ends before it begins")
        return self


class Notice(Window):
    """Satellites or stations out of service; without a begin the whole flight."""

    satellites: list[str] = Field(default=[])
    stations: list[str] = Field(default=[])

    @model_validator(mode="after")
    def _of_something(self) -> Notice:
        if not self.satellites and not self.stations:
            raise ValueError("names neither satellites nor stations")
        return self


class Jamming(Window):
    """No satellite can be received."""


class PlannedProcedure(Part):
    """A published departure, arrival or approach that is flown."""

    database: str = Field(min_length=1)
    """Navigation database of ARINC 424, beside the plan."""
    name: str = Field(min_length=1)
    """``KDEN/H26-Z:FUZZZ``."""
    line: str | None = None
    """Line of minima that is flown, such as ``RNP 0.3``."""
    defaults: bool = False
    """Legs without a coded RNP take the default of the specification."""


class SbasLog(Part):
    """Messages of an augmentation service that were sent before, for the levels of monitor "sbas"."""

    messages: str = Field(min_length=1)
    """Message log, beside the plan."""
    navigation: list[str] = Field(min_length=1)
    """RINEX navigation files of the log's day."""
    prn: int | None = None
    """Whose messages, where the log holds several satellites'."""
    mode: Literal["auto", "pa", "npa"] = "auto"


class Equipment(Part):
    """What the aircraft has, where it differs from the scenario."""

    constellations: list[Literal["gps", "gps-expanded", "galileo", "beidou"]] | None = None
    mask_rad: float | None = Field(default=None, ge=0, lt=1.57)
    inertial: str | None = None
    """A grade of navbound/data/imu-grades.toml."""
    without: list[Literal["gnss", "dme", "vor", "baro"]] = Field(default=[])
    monitor: str = "raim"
    """Whose levels: a name that ``navbound predict`` knows, or "sbas" with messages that were sent before."""
    monitor_systems: str | None = None
    """Letters of the constellations that the monitor uses; by default G for RAIM, else those of the receiver."""
    model: str = "single-frequency"
    satellite_outage_probability: float = Field(default=0.0, ge=0.0, le=0.1)
    """That a satellite is out of service without a notice, each for itself; nobody has published one to be taken. [1]"""
    outages: Literal[0, 1, 2] = 1
    """Satellites out at once that are worked out where the probability is not zero."""
    steering: Steering = "autopilot"
    fte_95_m: float | None = Field(default=None, ge=0)
    """In place of the usual one of the steering."""
    fte_correlation_s: float = Field(default=60.0, gt=0)
    """Correlation time of the total error, for the risk of a leg. Provenance: inferred."""


class Plan(Part):
    """A flight to be predicted."""

    title: str = Field(default="Planned flight", min_length=1)
    flight: str = Field(min_length=1)
    """A shipped scenario, or the path of a scenario file; it needs sensors and a filter."""
    departure_utc: datetime | None = None
    duration_s: float | None = Field(default=None, gt=0)
    orbits: list[str] = Field(default=[])
    """Almanacs (YUMA, SEM), RINEX navigation files, or nominal constellations; without any the nominal ones of the receiver."""
    route: str | None = None
    procedures: list[PlannedProcedure] = Field(default=[])
    """In the order flown: departures, then the route, then arrivals and approaches."""
    departure_height_m: float | None = None
    cruise_height_m: float | None = None
    arrival_height_m: float | None = None
    """In place of the scenario's, above the ellipsoid."""
    step_s: float = Field(default=60.0, ge=1.0, le=3600.0)
    approach_step_s: float = Field(default=10.0, ge=1.0, le=3600.0)
    approach_m: float = Field(default=20.0 * METRES_PER_NM, ge=0)
    """The approach is the last part of the route of this length. Provenance: ours."""
    departure_shifts_s: list[float] = Field(default=[-1800.0, 0.0, 1800.0, 3600.0])
    requirements: list[Phase] | None = None
    """In place of the scenario's phases."""
    stations: list[Station] | None = None
    """In place of the scenario's."""
    sbas: SbasLog | None = None
    equipment: Equipment = Equipment()
    notices: list[Notice] = Field(default=[])
    jamming: list[Jamming] = Field(default=[])

    @model_validator(mode="after")
    def _dated(self) -> Plan:
        if self.departure_utc is not None and self.departure_utc.tzinfo is None:
            raise ValueError("departure_utc needs a zone, as 2026-11-22T06:00:00Z")
        if self.departure_utc is None and any(w.from_utc is not None for w in (*self.notices, *self.jamming)):
            raise ValueError("from_utc needs departure_utc: a flight of no date meets no time of day")
        if self.sbas is not None and self.departure_utc is None:
            raise ValueError("sbas needs departure_utc: a flight of no date meets no messages")
        return self


def read_plan(path: str | Path) -> Plan:
    """Read a plan.

    Raises
    ------
    FormatError
        Not there, not TOML, a key that is unknown or missing, a value of the wrong type or outside its domain: with file, key and what is
        allowed.
    """
    written: dict[tuple[str | int, ...], Written] = {}
    try:
        table = to_si(tomllib.loads(Path(path).read_text(encoding="utf-8")), written)
        plan = Plan.model_validate(table)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
        raise FormatError(path, f"not TOML: {e}") from e
    except OSError as e:
        raise FormatError(path, f"cannot be read: {e.strerror}") from e
    except RepeatedKeyError as e:
        raise FormatError(path, f"{e.value!r} is outside {e.domain}", field=e.argument) from e
    except ValidationError as e:
        raise _explained(path, e.errors()[0], written) from e
    grade = plan.equipment.inertial
    if grade is not None and grade not in grades():
        raise FormatError(path, f"{grade!r} is not one of {', '.join(grades())}", field="equipment.inertial")
    return plan


def _explained(path: str | Path, error: ErrorDetails, written: dict[tuple[str | int, ...], Written]) -> FormatError:
    place: tuple[str | int, ...] = tuple(error["loc"])
    entry = written.get(place)
    key = entry.key if entry else ".".join(str(part) for part in place) or None
    if error["type"] == "missing":
        return FormatError(path, "is missing (it may end in another unit of the same kind)", field=key)
    if error["type"] == "extra_forbidden":
        return FormatError(path, f"is not a key of a plan; there {_keys(place)}", field=key)
    sentence = error["msg"].removeprefix("Value error, ")
    return FormatError(
        path, sentence if entry is None or isinstance(entry.value, dict) else f"{entry.value!r}: {sentence}"[:200], field=key
    )


def _keys(place: tuple[str | int, ...]) -> str:
    """The keys of the table that a place is in."""
    tables: dict[str, type[Part]] = {
        "equipment": Equipment,
        "notices": Notice,
        "jamming": Jamming,
        "procedures": PlannedProcedure,
        "sbas": SbasLog,
        "requirements": Phase,
        "stations": Station,
    }
    fields: dict[str, Any] = (tables.get(str(place[0]), Plan) if len(place) > 1 else Plan).model_fields
    return f"are {', '.join(fields)}"
