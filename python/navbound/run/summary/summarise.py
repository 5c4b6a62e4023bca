"""Judged epochs to the records that a person reads first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound import evaluation
from navbound.methods import method
from navbound.records.run import EventSummary, Summary
from navbound.run.summary.approaches import approaches_of, deviation_bands, deviation_groups
from navbound.run.summary.consistency import consistency_of
from navbound.run.summary.groups import phases, protection_of, tracks
from navbound.run.summary.methods import evaluated, of_belief
from navbound.run.summary.satellites import satellites_of
from navbound.run.summary.sums import Sums
from navbound.run.summary.verdict import facts_of, verdict_of

if TYPE_CHECKING:
    import polars as pl

    from navbound.records.material import Material
    from navbound.storage.tables import Table


LISTED_EVENTS = 500
"""Events in summary.json; all of them are in events.parquet, and the report says how many are not listed."""


def summarise(
    material: Material,
    epochs: Table,
    events: pl.DataFrame,
    *,
    with_levels: frozenset[str],
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
    epochs : DataFrame or Frames
        After judging; in pieces the results are those of the whole.
    events : DataFrame
        Of the monitors.
    with_levels : set of str
        Tracks with a protection level anywhere.
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
    sums = Sums(material, judging, events, with_levels)
    sums.see_all(epochs)
    accuracy = [evaluated(epochs, i, risk_accuracy, integrity=False) for i in ids]
    protection = protection_of(epochs, material.limits_held)
    approaches = approaches_of(epochs, method(judging))
    facts = facts_of(sums, epochs, accuracy, risks)
    verdict = verdict_of(material, facts, accuracy, risks, protection)
    integrity = [evaluated(epochs, i, risk_integrity, integrity=True) for i in ids]
    return Summary(
        kind=material.kind,
        operation=material.operation,
        title=material.title,
        verdict=verdict,
        coverage_kind=evaluation.CLOSED_LOOP if material.kind == "fly" else evaluation.REPEATED,
        assumptions=material.assumptions,
        covariance=material.covariance,
        phases=phases(sums, material.sample_period_s),
        protection=protection,
        tracks=tracks(sums, material.labels, events),
        accuracy=of_belief(accuracy, facts.belief),
        integrity=of_belief(integrity, facts.belief),
        honesty=consistency_of(epochs),
        states=states,
        events=listed(events),
        cross_track=material.cross_track,
        procedures=material.procedures,
        rejected=material.rejected,
        n_status=facts.n_status,
        groups=deviation_groups(approaches, material.labels),
        bands=deviation_bands(approaches),
        satellites=satellites_of(material.satellites),
    )


def listed(events: pl.DataFrame) -> list[EventSummary]:
    """The events of summary.json."""
    return [EventSummary(**row) for row in events.head(LISTED_EVENTS).iter_rows(named=True)]
