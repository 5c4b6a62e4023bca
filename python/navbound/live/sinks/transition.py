"""An alert that began or ended, as JSON: schemas/transition.json."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from navbound import _core

if TYPE_CHECKING:
    from collections.abc import Mapping

    from navbound._core import _TransitionRow
    from navbound.live.settings import Settings

VERSION = 1
FIELDS = (
    "v",
    "key",
    "track",
    "incarnation",
    "kind",
    "transition",
    "annunciation_ns",
    "onset_ns",
    "clear_ns",
    "event_ns",
    "arrival_ns",
    "emitted_ns",
    "peak_m",
    "limit_m",
    "min_margin_m",
    "latency_s",
    "within_time_to_alert",
    "replayed",
    "position",
    "sigma_m",
)


def record(row: _TransitionRow, settings: Settings, *, replayed: bool) -> dict[str, Any]:
    """One transition. What is not known is None; a latency is claimed only where the arrival is known."""
    names, times, lengths, position = row
    key, track, incarnation, kind, turn = names
    annunciation, onset, clear, event, arrival, emitted = times
    latency_s = None if arrival is None or replayed else (emitted - event) / 1e9
    peak, limit, margin = (None if math.isnan(x) else x for x in lengths)
    values = (
        *(VERSION, key, track, incarnation, kind, turn, annunciation, onset, clear, event, arrival, emitted, peak, limit, margin),
        *(latency_s, None if latency_s is None else latency_s <= settings.time_to_alert_s, replayed, position, settings.sigma_m),
    )
    return dict(zip(FIELDS, values, strict=True))


def records(frames: bytes, settings: Settings, *, origin: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Every transition of whole frames of a journal out; those of data that did not arrive just then are replayed."""
    replayed = origin["kind"] != "live"
    return [record(row, settings, replayed=replayed) for row in _core.live_transitions(frames)]


def line(transition: dict[str, Any]) -> str:
    """One line of JSON; an infinite length is text, since JSON has no such number."""
    finite = {k: str(v) if isinstance(v, float) and not math.isfinite(v) else v for k, v in transition.items()}
    return json.dumps(finite, separators=(",", ":"), allow_nan=False)


def turned_ns(transition: Mapping[str, Any]) -> int:
    """When it began or ended: a silence is noticed only when the next record comes, and is older than that. [ns]."""
    began = transition["annunciation_ns"] if transition["transition"] == "raised" else transition["clear_ns"]
    return int(transition["event_ns"] if began is None else began)


def words(transition: dict[str, Any], utc: str) -> str:
    """One line for a person."""
    who = transition["track"] or "source"
    margin = transition["min_margin_m"]
    least = "" if margin is None else f", least margin {margin:.1f} m"
    return f"{utc} UTC  {who}: {transition['kind']} {transition['transition']}{least}"
