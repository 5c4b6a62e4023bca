"""What became of each declared fault: what it did to the position, and when the monitors spoke."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import anp, rnp
from navbound.methods import column_of
from navbound.records.faults import FaultSummary, Moment, Outcome
from navbound.scenario import Scenario, Taxi
from navbound.storage.tables import tracks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.storage.tables import Table


PERSISTENT_S = 3
"""The gate throws away a good measurement now and then; measurements thrown away in as many seconds on end are no accident: of thirty a
second at 1e-4 each, once in a hundred flights of two hours."""


_READ = (
    "track",
    "time_ns",
    "n_gated",
    "nav_mode",
    "tse_m",
    "rnp_m",
    "innovation_memory",
    "separation_m",
    "separation_limit_m",
    "nse_h_m",
    "nse_u_m",
)
"""Columns that speak of a fault."""

_AFTER_S = 600.0
"""What happens so long after a fault is over is still put down to it, unless another fault has begun. Provenance: ours."""
_SECOND_NS = 1_000_000_000
_NEVER = 2**63 - 1


def fault_summaries(scenario: Scenario | Taxi, epochs: Table, events: pl.DataFrame) -> list[FaultSummary]:
    """Every declared fault of the sensors, flight by flight.

    Parameters
    ----------
    scenario : Scenario or Taxi
        Whose ``sensors.faults`` were flown; one that simulates no sensors has none.
    epochs : DataFrame or Frames
        After judging.
    events : DataFrame
        Of the monitors.

    Notes
    -----
    An alert is in time that comes no later than the shortest time to alert of any RNP specification after the error left RNP.
    """
    if not isinstance(scenario, Scenario) or scenario.sensors is None or scenario.filter is None:
        return []
    time_to_alert_s = min(cell.time_to_alert_s for cell in rnp.specifications() if cell.containment_m is not None)
    summaries = []
    flights = (flight for part in tracks(epochs, _READ) for flight in part.group_by("track", maintain_order=True))
    for key, frame in flights:
        alerts = events.filter(pl.col("track") == key[0]).sort("onset_ns").select("onset_ns", "kind").rows()
        for window in _windows(scenario):
            summaries.append(_summary(window, frame, alerts, (time_to_alert_s, scenario.filter.separation_risk)))
    return summaries


@dataclass(frozen=True)
class _Window:
    """A fault, its begin and end, and until when what happens is put down to it. [GPS ns]."""

    kind: str
    start: int
    end: int | None
    last: int


def _windows(scenario: Scenario) -> list[_Window]:
    """Of the declared faults, in their order; what begins after one is over has effects of its own."""
    faults = scenario.sensors.faults if scenario.sensors is not None else []
    starts = [scenario.start_ns + round(fault.start_s * _SECOND_NS) for fault in faults]
    windows = []
    for fault, start in zip(faults, starts, strict=True):
        duration = getattr(fault, "duration_s", None)
        end = None if duration is None else start + round(duration * _SECOND_NS)
        last = _NEVER if end is None else min([end + round(_AFTER_S * _SECOND_NS), *(other - 1 for other in starts if other > end)])
        windows.append(_Window(fault.kind, start, end, last))
    return windows


def _summary(window: _Window, frame: pl.DataFrame, alerts: list[tuple[Any, ...]], limits: tuple[float, float]) -> FaultSummary:
    (time_to_alert_s, separation_risk), start, last = limits, window.start, window.last
    time = frame["time_ns"].to_numpy()
    during = (time >= start) & (time <= last)

    def first(flags: NDArray[np.bool_]) -> float | None:
        hits = np.flatnonzero(flags & during)
        return float((time[hits[0]] - start) / _SECOND_NS) if hits.size else None

    gated = frame["n_gated"].to_numpy() > 0
    run = np.convolve(gated, np.ones(PERSISTENT_S), mode="full")[: gated.size] >= PERSISTENT_S
    modes = frame["nav_mode"].to_numpy()
    before = modes[max(int(np.searchsorted(time, start)) - 1, 0)]
    fallen = (modes != before) & (modes != "gnss") & during
    error, limit = np.abs(column_of(frame, "tse_m")), column_of(frame, "rnp_m")
    spoke = next(((onset, word) for onset, word in alerts if start <= onset <= last), None)
    alert_after = None if spoke is None else float((spoke[0] - start) / _SECOND_NS)
    outside = first(error > limit)
    outcome = _outcome(alert_after, outside, time_to_alert_s)
    values = {
        "gate_after_s": first(run),
        "memory_after_s": first(_values(frame, "innovation_memory") > float(anp.chi_factor(1, separation_risk))),
        "disagree_after_s": first(_values(frame, "separation_m") > _values(frame, "separation_limit_m")),
        "mode_after_s": first(fallen),
        "mode": str(modes[np.flatnonzero(fallen)[0]]) if fallen.any() else None,
        "alert_after_s": alert_after,
        "alert": None if spoke is None else spoke[1],
        "outside_after_s": outside,
        "outside_twice_after_s": first(error > 2 * limit),
        "nse_h_max_m": _largest(frame, "nse_h_m", during),
        "nse_u_max_m": _largest(frame, "nse_u_m", during),
        "outcome": outcome,
        "outcome_words": _outcome_words(outcome, alert_after, outside, time_to_alert_s),
    }
    words = _words(values, compared=bool((np.isfinite(_values(frame, "separation_m")) & during).any()))
    return FaultSummary.model_validate(
        {"track": frame["track"][0], "kind": window.kind, "start_ns": start, "end_ns": window.end, "words": words}
        | values
        | {"moments": _moments(window, values)}
    )


def _moments(window: _Window, values: dict[str, Any]) -> list[Moment]:
    """Begin, effects, alert and end in the order of time."""
    after_s = {
        f"{window.kind} begins": 0.0,
        f"the mode falls to {values['mode']}": values["mode_after_s"],
        "the filters with and without satellites disagree": values["disagree_after_s"],
        "the filter's gate rejects measurements": values["gate_after_s"],
        "the innovations have memory": values["memory_after_s"],
        f"first alert: {values['alert']}": values["alert_after_s"],
        "the true error leaves RNP": values["outside_after_s"],
        "the true error leaves twice RNP": values["outside_twice_after_s"],
    }
    moments = [Moment(time_ns=window.start + round(s * _SECOND_NS), words=words) for words, s in after_s.items() if s is not None]
    if window.end is not None:
        moments.append(Moment(time_ns=window.end, words=f"{window.kind} ends"))
    return sorted(moments, key=lambda moment: moment.time_ns)


def _values(frame: pl.DataFrame, name: str) -> NDArray[np.float64]:
    """Without the filter that a column is about there is nothing in it."""
    return column_of(frame, name) if name in frame.columns else np.full(frame.height, np.nan)


def _largest(frame: pl.DataFrame, name: str, during: NDArray[np.bool_]) -> float | None:
    values = np.abs(column_of(frame, name)[during])
    return float(np.nanmax(values)) if np.isfinite(values).any() else None


def _outcome(alert_s: float | None, outside_s: float | None, time_to_alert_s: float) -> Outcome:
    if outside_s is None:
        return "no alert needed"
    if alert_s is None:
        return "missed"
    if alert_s <= outside_s:
        return "before"
    return "within the time to alert" if alert_s <= outside_s + time_to_alert_s else "late"


def _words(v: dict[str, Any], *, compared: bool) -> str:
    """One statement a sentence: each monitor in its turn, and what it meant at last."""
    gate, memory, disagreed, fell, alert = (v[f"{each}_after_s"] for each in ("gate", "memory", "disagree", "mode", "alert"))
    agreed = ["the filters with and without satellites agreed"] if compared else []
    statements = [
        f"the filter's gate rejected measurements after {gate:.0f} s"
        if gate is not None
        else "the filter's gate rejected no run of measurements",
        *([f"the innovations had memory after {memory:.0f} s"] if memory is not None else []),
        *([f"the filters with and without satellites disagreed after {disagreed:.0f} s"] if disagreed is not None else agreed),
        f"the mode fell to {v['mode']} after {fell:.0f} s" if fell is not None else "the mode did not fall",
        f"the first alert ({v['alert']}) came after {alert:.0f} s" if alert is not None else "there was no alert",
        v["outcome_words"],
    ]
    return " ".join(f"{each[0].upper()}{each[1:]}." for each in statements)


def _outcome_words(outcome: Outcome, alert_s: float | None, outside_s: float | None, time_to_alert_s: float) -> str:
    apart_s = abs((outside_s or 0.0) - (alert_s or 0.0))
    return {
        "no alert needed": "the true error stayed inside RNP",
        "before": f"the first alert came {apart_s:.0f} s before the true error left RNP",
        "within the time to alert": f"the first alert came {apart_s:.0f} s after the true error left RNP, within the {time_to_alert_s:g} s "
        "to alert",
        "late": f"the first alert came {apart_s:.0f} s after the true error left RNP, later than the {time_to_alert_s:g} s to alert",
        "missed": "the true error left RNP without an alert",
    }[outcome]
