"""What became of a declared fault, as a record."""

from __future__ import annotations

from typing import Literal

from navbound.records.base import Record

Outcome = Literal["no alert needed", "before", "within the time to alert", "late", "missed"]


class Moment(Record):
    """What happened at an instant of a fault."""

    time_ns: int
    words: str


class FaultSummary(Record):
    """One fault on one flight. Times count from its begin, in seconds; None where it never came to that."""

    track: str
    kind: str
    start_ns: int
    end_ns: int | None
    """None for one that stays."""
    gate_after_s: float | None
    """Measurements thrown away by the filter's gate, several seconds on end."""
    memory_after_s: float | None
    """The innovations of the ranges remembered more than white ones do at the risk of the separation."""
    disagree_after_s: float | None
    """The filters with and without satellites were said to disagree."""
    mode_after_s: float | None
    mode: str | None
    """What the navigation fell back to first."""
    alert_after_s: float | None
    alert: str | None
    """The first alert of the monitor that was not there before: caution, warning, unavailable."""
    outside_after_s: float | None
    """The true cross-track error left RNP."""
    outside_twice_after_s: float | None
    """It left twice RNP."""
    nse_h_max_m: float | None
    """Largest true horizontal error while the fault lasted and in the ten minutes after."""
    nse_u_max_m: float | None
    outcome: Outcome
    """Of the alert against the error leaving RNP."""
    outcome_words: str
    moments: list[Moment]
    """The same in the order of time."""
    words: str
