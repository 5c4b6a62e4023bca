"""A flight against a published procedure, as a record: its legs, its heights, and the three answers."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from navbound.records.base import Record


class HeightResult(Record):
    """Deviations of one kind of height from the vertical path of the final approach."""

    by: Literal["altimeter", "geometry"]
    """The altimeter: pressure altitude with a setting. Geometry: height above the ellipsoid less the undulation."""
    path: Literal["barometric", "straight"]
    n: int
    mean_m: float
    rms_m: float
    p95_m: float
    """95 % of the sizes."""
    least_m: float
    most_m: float
    limit_m: float
    n_inside: int
    required_m: float
    """Least of what 99.7 % of the aircraft's vertical errors have to be below (FAA AC 90-101A, standard), over the positions."""
    n_inside_required: int
    n_bound: int = 0
    """Epochs with a bound of the vertical total error."""
    n_bound_inside: int = 0
    """Epochs whose bound is inside the limit."""
    risk_below_max: float | None = None
    """Largest risk of an epoch that the aircraft is below the path by more than the limit."""


class SettingResult(Record):
    """What the heights of a descent say of the altimeter setting. It cannot tell a wrong setting from a wrong geometric height."""

    setting_hpa: float
    origin: Literal["given", "broadcast"]
    n: int
    intercept_m: float
    """Geometric less indicated height at the aerodrome; negative where the setting is too high."""
    slope: float
    """Growth of the difference with height: the temperature."""
    residual_sigma_m: float
    threshold_m: float
    """A larger intercept is an alarm."""
    detectable_m: float
    """Found with 90 %."""
    alarm: bool


class LegFlown(Record):
    """A flight on one leg."""

    sequence: int
    fix: str
    terminator: str
    state: str
    rnp_m: float | None
    rnp_origin: str
    length_m: float | None
    n: int
    n_transition: int
    duration_s: float
    mean_m: float | None
    rms_m: float | None
    p95_m: float | None
    max_abs_m: float | None
    n_inside: int
    n_inside_twice: int
    n_bound: int = 0
    """Epochs with a bound of the total error."""
    n_bound_inside: int = 0
    n_bound_inside_twice: int = 0
    worst_time_ns: int | None
    worst_along_m: float | None


class BesideProcedure(Record):
    """What a procedure does not judge of a recording, and what it lacks itself."""

    n_recorded: int
    """Positions of the recording."""
    n_status: dict[str, int]
    """Of these, the positions that are no part of a flight along the procedure (before and after it, in turns, beside holds), by what they
    are."""
    n_short: int = 0
    """Flights that end, or leave the path, before the end of the procedure."""
    short: Literal["ends", "leaves"] | None = None
    """What the earliest of them does."""
    short_m: float | None = None
    """How far before the end of the procedure it does so; None where that is not defined."""
    begin_m: float | None = None
    """How far after the begin of the procedure the latest of the flights is first judged, where it is more than a nautical mile."""
    doubts: list[str] = Field(default_factory=list)
    """Why the legs may not be the whole procedure; the verdict cannot be "inside" beside one."""


class ProcedureFlown(Record):
    """One flight against a procedure."""

    track: str
    procedure: str
    line: str | None
    first_ns: int
    """From when on it was judged."""
    n_status: dict[str, int]
    """Positions by what they are worth, from the first that was judged to the last."""
    n: int
    """Positions judged, on legs with an RNP; those that stray from the path are among them."""
    n_inside: int
    n_inside_twice: int
    n_without_rnp: int
    end: Literal["reached", "ends", "leaves"] = "reached"
    """Whether a position beyond the end of the procedure follows, the track ends before it, or the aircraft has left the path."""
    short_m: float | None = None
    """How far before the end of the procedure the last position near the path is; None beyond it, or where that is not defined."""
    begin_m: float | None = None
    """How far after the begin of the procedure the first position judged is; None where that is not defined."""
    n_bound: int = 0
    n_bound_inside: int = 0
    n_bound_inside_twice: int = 0
    n_effective: float
    most_exceeding: float | None
    """Share outside RNP that no exceedance in so many independent positions leaves open at 95 % confidence; None where there was one."""
    legs: list[LegFlown]
    heights: list[HeightResult] = Field(default_factory=list)
    setting: SettingResult | None = None
    answers: list[str]
    """Whether it was inside: recorded positions, bounds of the total error, what the data can decide; then the heights."""
