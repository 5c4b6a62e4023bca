"""From epochs to a judged run: bounds, monitor, states, evaluation. It does not ask whether the epochs were flown or recorded."""

from __future__ import annotations

import math
import platform
import sys
from dataclasses import asdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import __version__, rnp, status, tse
from navbound.errors import InputError
from navbound.methods import BoundColumn, bounds, column_of, method, with_errors
from navbound.records.run import RunRecord
from navbound.rnp.exposure import LONGEST_STEP_S
from navbound.run import pieces
from navbound.run.directory import Run
from navbound.run.inputs.doubts import tracks_with_levels
from navbound.run.settings import Settings
from navbound.run.summary.summarise import summarise
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.read.pieces import Frames
    from navbound.records.material import Material
    from navbound.records.run import EventSummary

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
    if material.frames is not None:
        return _judge_pieces(material, material.frames, settings, command)
    if material.epochs.height == 0:
        raise InputError("epochs", 0, "1", "at least one epoch")
    epochs = with_errors(material.epochs)
    judging = WITH_PATH if _has_values(epochs, "fte_m") else WITHOUT_PATH
    ids = list(dict.fromkeys((judging, *settings.methods)))
    epochs = _with_bounds(epochs, ids, judging, settings)
    epochs = _with_risks(epochs)
    epochs, events, counters = _with_alerts(epochs, judging, material.sample_period_s, settings.risk_integrity)
    events = _with_points(events, material.events)
    epochs, states = _with_states(epochs, settings.risk_accuracy)
    shown = [i for i in ids if i == judging or _has_values(epochs, method(i).column)]
    risks = (settings.risk_accuracy, settings.risk_integrity)
    summary = summarise(material, epochs, events, ids=shown, judging=judging, states=states, risks=risks)
    return Run(summary, _record(material, settings, shown, counters, command), epochs, events, material.waypoints)


def _judge_pieces(material: Material, epochs: Frames, settings: Settings, command: str) -> Run:
    """The same of a table in pieces on the disk, which has neither path nor truth."""
    ids = list(dict.fromkeys((WITHOUT_PATH, *settings.methods)))
    monitor = _monitor(material.sample_period_s, settings.risk_integrity)
    monitors = monitor.tracks({track: track in material.with_levels for track in material.labels}, accuracy=WITHOUT_PATH)

    def bounded(piece: pl.DataFrame) -> pl.DataFrame:
        return _with_bounds(with_errors(piece), ids, WITHOUT_PATH, settings)

    judged = pieces.judged(epochs, bounded, monitors, with_levels=bool(material.with_levels))
    events, total, _ = monitors.decided()
    events = _in_words(events)
    summary = pieces.summary(material, judged, events, ids, (settings.risk_accuracy, settings.risk_integrity))
    shown = [result.id for result in summary.accuracy]
    return Run(summary, _record(material, settings, shown, _counters(monitor, total), command), judged, events, material.waypoints)


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


def _has_values(epochs: pl.DataFrame, name: str) -> bool:
    return name in epochs.columns and bool(np.isfinite(column_of(epochs, name)).any())


def _with_bounds(epochs: pl.DataFrame, ids: list[str], judging: str, settings: Settings) -> pl.DataFrame:
    usable = _usable(epochs)
    columns: dict[str, NDArray[np.float64]] = {}
    for method_id in ids:
        wanted = method(method_id)
        accuracy = bounds(epochs, method_id, settings.risk_accuracy)
        integrity = bounds(epochs, method_id, settings.risk_integrity)
        columns[wanted.column] = np.where(usable, accuracy.bound_m, np.nan)
        columns[wanted.integrity_column] = np.where(usable, integrity.bound_m, np.nan)
        if method_id == judging:
            epochs = _with_reasons(epochs, accuracy, usable)
    return epochs.with_columns(pl.Series(name, values, nan_to_null=True) for name, values in columns.items())


def _with_reasons(epochs: pl.DataFrame, judged: BoundColumn, usable: NDArray[np.bool_]) -> pl.DataFrame:
    """An epoch that cannot be judged says why, unless its reader said so already."""
    code = np.where(usable, judged.reason, 0).astype(np.int64)
    ids, sentences = (pl.Series([None, *names], dtype=pl.String) for names in ([r[k] for r in judged.reasons] for k in (0, 1)))
    return status.overridden(epochs, ids.gather(code), sentences.gather(code))


def _with_risks(epochs: pl.DataFrame) -> pl.DataFrame:
    if not _has_values(epochs, "fte_m") or "sigma_cross_m" not in epochs.columns:
        return epochs
    fte, sigma, limit = (column_of(epochs, name) for name in ("fte_m", "sigma_cross_m", "rnp_m"))
    known = np.isfinite(fte) & np.isfinite(sigma) & np.isfinite(limit) & _usable(epochs)
    added = {}
    for name, factor in (("p_exceed_rnp", 1.0), ("p_exceed_2rnp", 2.0)):
        risk = np.full(epochs.height, np.nan)
        risk[known] = tse.exceedance_risk(np.abs(fte[known]), sigma[known], factor * limit[known])
        added[name] = risk
    return epochs.with_columns(pl.Series(name, values, nan_to_null=True) for name, values in added.items())


def _with_alerts(
    epochs: pl.DataFrame, judging: str, sample_period_s: float, risk_integrity: float
) -> tuple[pl.DataFrame, pl.DataFrame, dict[str, object]]:
    monitor = _monitor(sample_period_s, risk_integrity)
    # A track whose column holds no level anywhere is counted by the verdict, which is then not "inside".
    with_levels = tracks_with_levels(epochs)
    monitors = monitor.tracks({track: track in with_levels for track in epochs["track"].unique(maintain_order=True)}, accuracy=judging)
    alert, compared_m = monitors.judge(epochs)
    if with_levels:
        epochs = epochs.with_columns(compared_m)
    events, total, _ = monitors.decided()
    return epochs.with_columns(alert.alias("alert")), _in_words(events), _counters(monitor, total)


def _monitor(sample_period_s: float, risk_integrity: float) -> rnp.Monitor:
    # A finished flight alerts nobody: the chain to the crew is a matter of the live monitor.
    return rnp.Monitor(sample_period_s=min(sample_period_s, LONGEST_STEP_S), time_to_alert_s=math.inf, integrity_risk=risk_integrity)


def _counters(monitor: rnp.Monitor, counters: rnp.Counters) -> dict[str, object]:
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
    sentence = {
        "caution": "accuracy bound not within RNP",
        "warning": "integrity bound not within twice RNP",
        "unavailable": "no usable epoch: loss of monitoring",
    }
    return events.with_columns(pl.col("kind").replace_strict(sentence).alias("words"))


def _with_states(epochs: pl.DataFrame, risk_accuracy: float) -> tuple[pl.DataFrame, list[str]]:
    """How likely the total system error is in each level's band, and the tightest level that its accuracy bound supports.

    The probabilities come from the law of the error itself (docs/methods/rnp-state.md), with the boundaries at the RNP values, since the
    flight technical error of every epoch is known.
    """
    if not _has_values(epochs, "fte_m") or "sigma_cross_m" not in epochs.columns:
        return epochs, []
    # Where metres are asked for, everything is in the tightest level's band: on the ground the levels of flight say nothing.
    if not (10.0 * column_of(epochs, "rnp_m") >= STATE_LEVELS_NM[0] * METRES_PER_NM).any():
        return epochs, []
    classifier = rnp.StateClassifier(STATE_LEVELS_NM)
    fte, sigma = column_of(epochs, "fte_m"), column_of(epochs, "sigma_cross_m")
    known = _usable(epochs) & np.isfinite(fte) & (sigma > 0)
    probability = np.full((epochs.height, len(classifier.names)), np.nan)
    probability[known] = classifier.probabilities(fte[known], sigma[known])
    names = classifier.tightest(probability, risk_accuracy)
    return epochs.with_columns(
        pl.Series("state", names, dtype=pl.String),
        *(pl.Series(f"p_state_{k + 1}", probability[:, k], nan_to_null=True) for k in range(len(classifier.names))),
    ), classifier.names


def _usable(epochs: pl.DataFrame) -> NDArray[np.bool_]:
    return epochs.get_column("status").is_in(rnp.USABLE).to_numpy()
