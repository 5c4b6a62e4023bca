"""What is expected of a flight before it is flown, and how a flight agreed with it, as records."""

from __future__ import annotations

from typing import Literal

from navbound.records.base import Record

LegStatus = Literal["kept", "not_kept", "no_stations_known"]


class ExpectedLeg(Record):
    """One leg under one RNP."""

    leg: str
    phase: str
    rnp_m: float
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
    p_anp_within: float
    """Share of the time that the circle is within the RNP. [1]"""
    tse_max_m: float | None
    """Largest 95 % bound of the total error across the path, flight technical error included. [m]"""
    p_tse_within: float
    """Share of the time that it is within the RNP. [1]"""
    first_without_s: float | None
    """First time at which the total error is not within the RNP; None where it always is. [s]"""
    longest_without_s: float
    """Longest time without. [s]"""
    hal_m: float
    """Alert limit of the level. [m]"""
    hpl_max_m: float | None
    """Largest protection level; None where there is none at all. [m]"""
    p_level: float
    """Share of the instants with a level inside the alert limit. [1]"""
    n_holes: int
    longest_hole_s: float
    risk_2rnp: float | None
    """Bound of the risk to be beyond twice the RNP at least once on the leg; None where some instant has no position. [1]"""


class LevelHole(Record):
    """A time on a leg without a level inside its alert limit."""

    leg: str
    start_s: float
    end_s: float
    reason: Literal["jamming", "satellites"]
    n_sv_least: int
    hpl_max_m: float | None


class Shift(Record):
    """The levels of the same flight with another departure."""

    shift_s: float
    p_level: float
    n_holes: int
    longest_hole_s: float


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
