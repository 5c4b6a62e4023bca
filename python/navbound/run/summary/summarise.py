"""Judged epochs to the records that a person reads first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound import evaluation
from navbound.methods import method
from navbound.records.run import EventSummary, Summary
from navbound.run.summary.approaches import deviation_bands, deviation_groups
from navbound.run.summary.consistency import consistency_of
from navbound.run.summary.groups import phases, protection_of, tracks
from navbound.run.summary.margins import by_status, with_margins
from navbound.run.summary.methods import evaluated
from navbound.run.summary.satellites import satellites_of
from navbound.run.summary.verdict import facts_of, verdict_of

if TYPE_CHECKING:
    from navbound.records.material import Material


LISTED_EVENTS = 500
"""Events in summary.json; all of them are in events.parquet, and the report says how many are not listed."""


def summarise(
    material: Material,
    epochs: pl.DataFrame,
    events: pl.DataFrame,
    *,
    ids: list[str],
    judging: str,
    states: list[str],
    risks: tuple[float, float],
) -> Summary:
    """Every record of summary.json.

    Parameters
    ----------
    material : Material
        Where the epochs came from.
    epochs, events : DataFrame
        After judging.
    ids : list of str
        Methods evaluated, the judging one first.
    judging : str
        The method whose bound is compared with RNP.
    states : list of str
        Names behind ``p_state_1``, ...
    risks : (float, float)
        Of accuracy and of integrity. [1]
    """
    risk_accuracy, risk_integrity = risks
    judged = method(judging)
    margins = with_margins(epochs, judged)
    coverage_kind = evaluation.CLOSED_LOOP if material.kind == "fly" else evaluation.REPEATED
    accuracy = [evaluated(epochs, i, risk_accuracy, coverage_kind, integrity=False) for i in ids]
    protection = protection_of(epochs, material.limits_held)
    verdict = verdict_of(material, facts_of(material, margins, accuracy, risks), accuracy, risks, protection)
    return Summary(
        kind=material.kind,
        operation=material.operation,
        title=material.title,
        verdict=verdict,
        coverage_kind=coverage_kind,
        assumptions=material.assumptions,
        covariance=material.covariance,
        phases=phases(margins, judged.column, material.sample_period_s, events),
        protection=protection,
        tracks=tracks(margins, material.labels, events),
        accuracy=accuracy,
        integrity=[evaluated(epochs, i, risk_integrity, coverage_kind, integrity=True) for i in ids],
        honesty=consistency_of(epochs),
        states=states,
        events=listed(events),
        cross_track=material.cross_track,
        procedures=material.procedures,
        rejected=material.rejected,
        n_status=by_status(epochs),
        groups=deviation_groups(margins, material.labels),
        bands=deviation_bands(epochs),
        satellites=satellites_of(material.satellites),
    )


def listed(events: pl.DataFrame) -> list[EventSummary]:
    """The events of summary.json."""
    return [EventSummary(**row) for row in events.head(LISTED_EVENTS).iter_rows(named=True)]
