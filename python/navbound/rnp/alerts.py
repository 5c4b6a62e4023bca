"""The sentences of alerts: what a run's events say, and the live page (web/src/records.gen.ts)."""

from __future__ import annotations

from typing import Literal

AlertKind = Literal["caution", "warning", "unavailable", "quiet", "clock", "garbled", "fleet_full", "source_lost"]
"""Kinds of alerts in the order of the core's list. A finished run has the first three; the others are of a live source."""

ALERT_WORDS: dict[AlertKind, str] = {
    "caution": "accuracy bound not within RNP",
    "warning": "integrity bound not within twice RNP",
    "unavailable": "no usable epoch: loss of monitoring",
    "quiet": "the source sends nothing",
    "clock": "the times of the source do not agree with their arrival",
    "garbled": "a tenth of the frames of the source is damaged",
    "fleet_full": "more tracks than are watched",
    "source_lost": "the connection to the source is lost",
}
"""What each kind means, as one sentence for people."""
