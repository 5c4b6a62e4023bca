"""From epochs to a judged run: bounds, monitor, states, evaluation. It does not ask whether the epochs were flown or recorded."""

from __future__ import annotations

import math
import platform
import sys
from dataclasses import asdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import polars as pl

from navbound import __version__, rnp
from navbound.errors import InputError
from navbound.judge import Judges, with_levels
from navbound.judge import Settings as Rules
from navbound.records.run import RunRecord
from navbound.rnp.alerts import ALERT_WORDS
from navbound.rnp.exposure import LONGEST_STEP_S
from navbound.run.directory import Run
from navbound.run.settings import Settings
from navbound.run.summary.summarise import summarise
from navbound.storage.frames import Frames
from navbound.storage.tables import has_values

if TYPE_CHECKING:
    from navbound.records.material import Material
    from navbound.records.run import EventSummary
    from navbound.storage.tables import Table

STATE_LEVELS_NM = (0.3, 1.0, 2.0, 5.0)
"""The levels of the state classifier's authors (Ostroumov and Kuzmenko 2018)."""

WITHOUT_PATH = "anp-circle"
"""What judges when there is no path to deviate from: the 95 % horizontal radius against RNP, as ANP against RNP on a flight deck."""

WITH_PATH = "tse-exact"


def judge(material: Material, settings: Settings | None = None, command: str = "") -> Run:
    """Bound every epoch, run the monitor over every track, evaluate against truth where there is one.

    Parameters
    ----------
    material : Material
        Epochs of any origin.
    settings : Settings, optional
        Methods and risks.
    command : str
        What the user typed, for the run record.

    Raises
    ------
    InputError
        An unknown method, no epochs, or a judging method that may not feed an alert.
    """
    settings = settings or Settings()
    table: Table = material.epochs if material.frames is None else material.frames
    if table.height == 0:
        raise InputError("epochs", 0, "1", "at least one epoch")
    judging = WITH_PATH if has_values(table, "fte_m") else WITHOUT_PATH
    rules = _rules(material, settings, judging, states=_classifier(material) if judging == WITH_PATH else None)
    levels = _with_levels(material)
    judges = Judges(rules, levels)
    epochs = _judged(judges, table)
    events, counters, _ = judges.decided()
    events = _with_points(_in_words(events), material.events)
    shown = [m.id for m in (rules.method, *rules.beside) if m.id == judging or has_values(epochs, m.column)]
    summary = summarise(
        material,
        epochs,
        events,
        with_levels=frozenset(track for track, has in levels.items() if has),
        ids=shown,
        judging=judging,
        states=rules.state_names if "state" in epochs.columns else [],
        risks=(settings.risk_accuracy, settings.risk_integrity),
    )
    record = _record(material, settings, shown, _counters(material, settings, counters), command)
    heard = material.satellites if material.satellites is not None and material.satellites.height else None
    return Run(summary, record, epochs, events, material.waypoints, satellites=heard)


def _with_levels(material: Material) -> dict[str, bool]:
    """Every track in the order of the table, and whether it has a protection level anywhere."""
    if material.frames is None:
        return with_levels(material.epochs)
    return {track: track in material.with_levels for track in material.labels}


def _judged(judges: Judges, table: Table) -> Table:
    if isinstance(table, pl.DataFrame):
        return judges.judge(table)
    epochs = Frames()
    for piece in table:
        epochs.put(judges.judge(piece))
    return epochs


def _rules(material: Material, settings: Settings, judging: str, states: rnp.StateClassifier | None = None) -> Rules:
    monitor = _monitor(material, settings)
    return Rules(monitor, method=judging, beside=settings.methods, risk_accuracy=settings.risk_accuracy, states=states)


def _classifier(material: Material) -> rnp.StateClassifier | None:
    # On the ground everything is in the tightest level's band: the levels of flight say nothing.
    return None if material.operation == "ground" else rnp.StateClassifier(STATE_LEVELS_NM)


def _record(material: Material, settings: Settings, shown: list[str], counters: dict[str, object], command: str) -> RunRecord:
    return RunRecord(
        navbound_version=__version__,
        command=command,
        created_utc=datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        kind=material.kind,
        scenario=material.scenario,
        seed=material.seed,
        inputs=material.inputs,
        methods=shown,
        risk_accuracy=settings.risk_accuracy,
        risk_integrity=settings.risk_integrity,
        settings=material.settings | {"monitor": counters},
        platform=f"Python {platform.python_version()}, {sys.platform} {platform.machine()}",
    )


def _monitor(material: Material, settings: Settings) -> rnp.Monitor:
    # A finished flight alerts nobody: the chain to the crew is a matter of the live monitor.
    period_s = min(material.sample_period_s, LONGEST_STEP_S)
    return rnp.Monitor(sample_period_s=period_s, time_to_alert_s=math.inf, integrity_risk=settings.risk_integrity)


def _counters(material: Material, settings: Settings, counters: rnp.Counters) -> dict[str, object]:
    monitor = _monitor(material, settings)
    return {
        "exposure": monitor.exposure,
        "stale_after_s": monitor.stale_after_s,
        "time_to_crew_s": monitor.time_to_crew_s,
        **asdict(counters),
    }


def _with_points(events: pl.DataFrame, points: list[EventSummary]) -> pl.DataFrame:
    """The monitor's alerts and the points of the flight, in the order of time."""
    if not points:
        return events
    added = pl.DataFrame([p.model_dump() for p in points], infer_schema_length=None).select(events.columns).cast(events.schema)
    return pl.concat([events, added]).sort("track", "onset_ns", maintain_order=True)


def _in_words(events: pl.DataFrame) -> pl.DataFrame:
    return events.with_columns(pl.col("kind").replace_strict(ALERT_WORDS).alias("words"))
