"""What a prediction of detection and exclusion says, as records."""

from __future__ import annotations

from typing import Literal

from navbound.records.base import Record

Function = Literal["detection", "exclusion"]


class PredictedPlace(Record):
    """Where: a place, or the points of a route together."""

    name: str
    lat_rad: list[float]
    lon_rad: list[float]
    h_m: list[float]


class PredictedLimit(Record):
    """What is required of the horizontal level."""

    id: str
    hal_m: float
    source: str
    provenance: str


class Hole(Record):
    """A time without detection, or without exclusion, inside the limit."""

    place: str
    limit: str
    function: Function
    start_s: float
    """First instant without, since the start of the prediction. [s]"""
    end_s: float
    """First instant with again; the end of the prediction where there is none. [s]"""
    start_utc: str | None
    """None for nominal orbits, which belong to no date."""
    end_utc: str | None
    cut: bool
    """It reaches to the start or the end of the prediction, so that it may be longer."""
    n_sv_least: int
    """Fewest satellites meanwhile. [1]"""
    level_max_m: float | None
    """Largest level meanwhile; None where there is none. [m]"""


class PredictedLine(Record):
    """One place and one limit."""

    place: str
    limit: str
    p_detection: float
    """Share of the instants with the level of detection inside the limit. [1]"""
    p_exclusion: float | None
    """Share of the instants with the level of exclusion inside the limit; None where the levels say nothing of exclusion. [1]"""
    p_detection_published: float | None
    """The same as detection by the published slope level, which leaves the noise out; None where there is none. [1]"""
    n_holes_detection: int
    n_holes_exclusion: int | None
    longest_detection_s: float
    longest_exclusion_s: float | None


class PredictedTimes(Record):
    """Instants."""

    start_utc: str | None
    end_utc: str | None
    duration_s: float
    step_s: float
    n: int


class Prediction(Record):
    """Detection and exclusion holes over a time, place by place."""

    navbound_version: str
    command: str
    kind: str
    """Whose levels, as ``raim``."""
    orbits: list[str]
    satellites: list[str]
    without: list[str]
    unhealthy: list[str]
    times: PredictedTimes
    mask_rad: float
    model: str
    places: list[PredictedPlace]
    limits: list[PredictedLimit]
    lines: list[PredictedLine]
    holes: list[Hole]
    assumptions: list[str]
