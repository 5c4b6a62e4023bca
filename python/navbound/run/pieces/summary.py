"""The records of a run whose epochs are in pieces and have neither path nor truth: every count and column as of the whole at once."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import polars as pl

from navbound import evaluation
from navbound.methods import method
from navbound.read.checks.neighbours import COLUMNS as NEIGHBOURS
from navbound.read.checks.stated import ALERT, CONTAINMENT, ERROR, WORSE
from navbound.records.run import PhaseSummary, Summary, TrackSummary, Worst
from navbound.run.inputs.doubts import Doubts
from navbound.run.summary.margins import OUTSIDE, by_reason, by_status, judged_margins, with_margins, worst_of
from navbound.run.summary.methods import method_result
from navbound.run.summary.missing import Gaps
from navbound.run.summary.summarise import listed
from navbound.run.summary.verdict import VerdictFacts, verdict_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from navbound.read.pieces import Frames
    from navbound.records.material import Material
    from navbound.records.run import MethodResult


@dataclass
class _Group:
    """What is counted of the epochs of a phase or a track."""

    n: int = 0
    n_ok: int = 0
    n_inside: int = 0
    worst_ratio: float | None = None
    worst_margin_m: float | None = None
    start_ns: int = 2**63 - 1
    end_ns: int = -(2**63)

    def add(self, other: _Group) -> None:
        self.n, self.n_ok, self.n_inside = self.n + other.n, self.n_ok + other.n_ok, self.n_inside + other.n_inside
        self.worst_ratio = max((r for r in (self.worst_ratio, other.worst_ratio) if r is not None), default=None)
        self.worst_margin_m = min((m for m in (self.worst_margin_m, other.worst_margin_m) if m is not None), default=None)
        self.start_ns, self.end_ns = min(self.start_ns, other.start_ns), max(self.end_ns, other.end_ns)

    @property
    def share_inside(self) -> float | None:
        return self.n_inside / self.n_ok if self.n_ok else None


class _Sums:
    """What one pass over the pieces counts."""

    def __init__(self, material: Material, judging: str, events: pl.DataFrame) -> None:
        self.doubts = Doubts(material.with_levels)
        self.gaps = Gaps(material.left_out, material.sample_period_s)
        self.n = self.n_judged = self.n_inside = self.n_contained = self.n_outside = 0
        self.n_status: Counter[str] = Counter()
        self.n_reason: Counter[str] = Counter()
        self.worst: list[Worst | None] = [None, None]
        self.phases: dict[tuple[str, float], _Group] = {}
        self.tracks: dict[str, _Group] = {}
        self.alerts: Counter[tuple[str, float, str]] = Counter()
        self._judging = judging
        alerting = events.filter(pl.col("kind").is_in(["caution", "warning"]))
        self._onsets = alerting.select("track", "kind", time_ns="onset_ns")

    def see(self, epochs: pl.DataFrame) -> None:
        margins = with_margins(epochs, method(self._judging))
        judged = judged_margins(margins)
        self.gaps.see(epochs)
        self.doubts.see(margins)
        self.n += epochs.height
        self.n_judged += judged.height
        self.n_inside += int((judged["_margin"] >= 0).sum())
        self.n_contained += int((judged["_margin_integrity"] >= 0).sum())
        self.n_outside += int(margins.select(OUTSIDE.sum()).item())
        self.n_status.update(by_status(margins))
        self.n_reason.update(by_reason(margins))
        for k, worst in enumerate(worst_of(margins, self._judging)):
            before = self.worst[k]
            if worst is not None and (before is None or worst.margin_m < before.margin_m):
                self.worst[k] = worst
        for (phase, limit), group in _groups(margins, ["phase", "rnp_m"]):
            self.phases.setdefault((phase, limit), _Group()).add(group)
        for (track,), group in _groups(margins, ["track"]):
            self.tracks.setdefault(track, _Group()).add(group)
        at = self._onsets.join(margins.select("track", "time_ns", "phase", "rnp_m"), on=["track", "time_ns"])
        self.alerts.update({(p, limit, kind): n for p, limit, kind, n in at.group_by("phase", "rnp_m", "kind").len().iter_rows()})


def _groups(margins: pl.DataFrame, by: list[str]) -> Iterator[tuple[tuple[Any, ...], _Group]]:
    inside = pl.col("_inside")
    grouped = margins.group_by(by, maintain_order=True).agg(
        pl.len().alias("n"),
        inside.count().alias("n_ok"),
        inside.sum().cast(pl.Int64).alias("n_inside"),
        pl.col("_ratio").max().alias("worst_ratio"),
        pl.col("_margin").min().alias("worst_margin_m"),
        pl.col("time_ns").min().alias("start_ns"),
        pl.col("time_ns").max().alias("end_ns"),
    )
    for row in grouped.iter_rows(named=True):
        yield tuple(row.pop(name) for name in by), _Group(**row)


def summary(material: Material, epochs: Frames, events: pl.DataFrame, ids: Sequence[str], risks: tuple[float, float]) -> Summary:
    """Every record of summary.json, as :func:`navbound.run.summary.summarise.summarise` makes them.

    Parameters
    ----------
    material : Material
        Where the epochs came from.
    epochs : Frames
        After judging.
    events : DataFrame
        Of the monitors.
    ids : sequence of str
        Methods, the judging one first; those of the others that have no bound are left out.
    risks : (float, float)
        Of accuracy and of integrity. [1]
    """
    judging = ids[0]
    read = ("phase", "rnp_m", "along_m", "integrity_compared_m", "reason_id", *NEIGHBOURS)
    doubted = ("hpl_m", ERROR, ALERT, WORSE, CONTAINMENT)
    names = [*read, *doubted, method(judging).column, method(judging).integrity_column]
    sums = _Sums(material, judging, events)
    for piece in epochs.select([name for name in names if name in epochs.columns]):
        sums.see(piece)
    accuracy = _results(epochs, ids, risks[0], integrity=False)
    shown = [result.id for result in accuracy]
    facts = VerdictFacts(
        n_recorded=sums.n,
        n_missing=sums.gaps.n_missing(),
        n_judged=sums.n_judged,
        n_inside=sums.n_inside,
        n_contained=sums.n_contained,
        n_outside=sums.n_outside,
        n_status=dict(sorted(sums.n_status.items())),
        n_reason=dict(sorted(sums.n_reason.items(), key=lambda each: (-each[1], each[0]))),
        worst=(sums.worst[0], sums.worst[1]),
        doubts=sums.doubts,
    )
    return Summary(
        kind=material.kind,
        operation=material.operation,
        title=material.title,
        verdict=verdict_of(material, facts, accuracy, risks, []),
        coverage_kind=evaluation.REPEATED,
        assumptions=material.assumptions,
        covariance=material.covariance,
        phases=_phases(sums, material.sample_period_s),
        protection=[],
        tracks=_tracks(sums, material.labels, events),
        accuracy=accuracy,
        integrity=_results(epochs, shown, risks[1], integrity=True),
        honesty=None,
        states=[],
        events=listed(events),
        cross_track=material.cross_track,
        rejected=material.rejected,
        n_status=facts.n_status,
    )


def _results(epochs: Frames, ids: Sequence[str], risk: float, *, integrity: bool) -> list[MethodResult]:
    """One column at a time. Of methods without an accuracy bound only the judging one is shown."""
    results = []
    for id_ in ids:
        known = epochs.numbers(method(id_).integrity_column if integrity else method(id_).column)
        if integrity or len(known) or id_ == ids[0]:
            results.append(method_result(id_, risk, known))
    return results


def _phases(sums: _Sums, period_s: float) -> list[PhaseSummary]:
    return [
        PhaseSummary(
            phase=phase,
            rnp_m=limit,
            n_epochs=group.n,
            duration_s=group.n * period_s,
            share_inside=group.share_inside,
            worst_ratio=group.worst_ratio,
            p_exceed_2rnp_max=None,
            p_exceed_2rnp_mean=None,
            coverage=None,
            n_cautions=sums.alerts[phase, limit, "caution"],
            n_warnings=sums.alerts[phase, limit, "warning"],
        )
        for (phase, limit), group in sums.phases.items()
    ]


def _tracks(sums: _Sums, labels: dict[str, str], events: pl.DataFrame) -> list[TrackSummary]:
    counts = {(track, kind): n for track, kind, n in events.group_by("track", "kind").len().iter_rows()}
    return [
        TrackSummary(
            track=track,
            label=labels.get(track, track),
            n_epochs=group.n,
            start_ns=group.start_ns,
            duration_s=float(group.end_ns - group.start_ns) * 1e-9,
            fte_mean_m=None,
            fte_std_m=None,
            fte_abs95_m=None,
            share_inside=group.share_inside,
            worst_ratio=group.worst_ratio,
            worst_margin_m=group.worst_margin_m,
            n_cautions=counts.get((track, "caution"), 0),
            n_warnings=counts.get((track, "warning"), 0),
            n_unavailable=counts.get((track, "unavailable"), 0),
        )
        for track, group in sums.tracks.items()
    ]
