"""What is predicted, as records: detection and exclusion at places, navigation along a flight; and how a flight agreed with it."""

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


LegStatus = Literal["kept", "not_kept", "no_stations_known", "no_rnp"]


class ExpectedLeg(Record):
    """One leg under one RNP."""

    leg: str
    phase: str
    rnp_m: float | None
    """None where nobody has stated one: nothing is judged then, and what is compared with it is None, too. [m]"""
    start_s: float
    """Since departure. [s]"""
    end_s: float
    modes: dict[str, float]
    """Navigation mode to share of the leg's time. [1]"""
    status: LegStatus
    anp_max_m: float | None
    """Largest 95 % circle of the navigation error. [m]"""
    anp_max_s: float | None
    """When. [s]"""
    p_anp_within: float | None
    """Share of the time that the circle is within the RNP. [1]"""
    tse_max_m: float | None
    """Largest 95 % bound of the total error across the path, flight technical error included. [m]"""
    p_tse_within: float | None
    """Share of the time that it is within the RNP. [1]"""
    first_without_s: float | None
    """First time at which the total error is not within the RNP; None where it always is. [s]"""
    longest_without_s: float | None
    """Longest time without. [s]"""
    hal_m: float | None
    """Alert limit of the level. [m]"""
    hpl_max_m: float | None
    """Largest protection level; None where there is none at all. [m]"""
    p_level: float | None
    """Share of the instants with a level inside the alert limit. [1]"""
    n_holes: int | None
    longest_hole_s: float | None
    p_without_hole: float | None
    """Probability that the leg has no hole, over the sets of satellites out of service that were worked out: a lower bound. None where
    the plan states no probability of an outage, or nobody an RNP. [1]"""
    n_dme_least: int
    """Fewest DME in view and in service. [1]"""
    p_dme_pair: float
    """Share of the instants with an admissible pair of DME. [1]"""
    dme_circle_max_m: float | None
    """Largest 95 % circle of a position by the best pair alone; None where some instant has no pair. [m]"""
    risk_2rnp: float | None
    """Bound of the risk to be beyond twice the RNP at least once on the leg; None where some instant has no position or no RNP. [1]"""


class LevelHole(Record):
    """A time on a leg without a level inside its alert limit."""

    leg: str
    start_s: float
    end_s: float
    reason: Literal["jamming", "satellites", "service"]
    """``service``: an augmentation service offers no satellite there."""
    n_sv_least: int
    hpl_max_m: float | None


class Shift(Record):
    """The levels of the same flight with another departure."""

    shift_s: float
    p_level: float | None
    """None, as the two below, where no leg has an RNP. [1]"""
    n_holes: int | None
    longest_hole_s: float | None


class Hold(Record):
    """How long an RNP is kept after all aids but the inertial unit are lost."""

    rnp_m: float
    model: str
    provenance: str
    hold_s: float | None
    """None where it is kept for longer than was worked out. [s]"""
    longest_s: float
    """How long was worked out. [s]"""


class Outage(Record):
    """Something that is not there for a time."""

    what: Literal["jamming", "satellites", "stations"]
    names: list[str]
    start_s: float
    end_s: float


class ExpectedFlight(Record):
    """A prediction of navigation along a flight."""

    schema_version: Literal[1] = 1
    navbound_version: str
    command: str
    title: str
    scenario: str
    departure_utc: str | None
    duration_s: float
    length_m: float
    orbits: list[str]
    satellites: list[str]
    monitor: str
    monitor_systems: str
    mask_rad: float
    fte_95_m: float
    """En route; the approach has half. [m]"""
    outages: list[Outage]
    p_unexamined: float | None
    """Probability of more satellites out at once than were worked out; None where the plan states no probability of an outage. [1]"""
    legs: list[ExpectedLeg]
    holes: list[LevelHole]
    shifts: list[Shift]
    hold: list[Hold]
    words: list[str]
    """Sentences for the flight, the first the most important."""
    warnings: list[str]
    assumptions: list[str]


class Agreement(Record):
    """Predicted and flown of one navigation mode, or of all."""

    mode: str
    n: int
    ratio_5: float
    ratio_median: float
    ratio_95: float
    """Predicted over flown 95 % circle: quantiles of the epochs. [1]"""
    p_within_5_percent: float
    coverage: float | None
    """Share of the epochs whose true error is inside the predicted circle; None without truth. [1]"""
    n_independent: float | None
    coverage_low: float | None
    coverage_high: float | None
    """95 % limits of the probability, Clopper and Pearson. [1]"""
    nees: float | None
    """Mean of the squared normalised horizontal error over its dimension, by the predicted covariance. [1]"""
    nees_low: float | None
    nees_high: float | None


class Assessment(Record):
    """A prediction against the flights that followed it."""

    schema_version: Literal[1] = 1
    navbound_version: str
    command: str
    prediction: str
    flight: str
    n_tracks: int
    joined_by: Literal["time", "along"]
    p_mode_agrees: float
    agreement: list[Agreement]
    legs: list[Agreement]
    words: list[str]
