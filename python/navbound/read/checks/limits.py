"""What an aircraft can do, for whoever judges positions."""

from __future__ import annotations

from dataclasses import dataclass

from navbound import _core
from navbound.read.statements.kinds import STALE_AFTER_S


@dataclass(frozen=True)
class Limits:
    """What an aircraft can do; docs/methods/recorded-tracks.md has the rule. Provenance: ours.

    Attributes
    ----------
    max_speed_mps : float
        Fastest speed over the ground, and the one assumed where none is reported.
    speed_factor, speed_margin_mps : float
        Allowed over a reported speed: rounding, acceleration.
    latency_s : float
        How much older than its time stamp a position may be.
    fix_latency_s : float
        The same where the recording says when a position was valid: what such times are wrong by.
    noise_m : float
        A distance that is never called a jump.
    moving_mps : float
        Reported speed from which an unchanged position counts as held; infinite for a receiver that is known to stand.
    stale_after_s : float
        Age from which a held position is no position.
    settle_s : float
        How long after a jump no position is believed.
    """

    max_speed_mps: float = _core.FASTEST_MPS
    speed_factor: float = 1.25
    speed_margin_mps: float = 25.0
    latency_s: float = 10.0
    fix_latency_s: float = 1.0
    noise_m: float = 100.0
    moving_mps: float = 15.0
    stale_after_s: float = STALE_AFTER_S
    settle_s: float = 30.0
