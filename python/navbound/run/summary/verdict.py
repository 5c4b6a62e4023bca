"""From counts of epochs to the verdict of a run and its words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from navbound.methods import method
from navbound.records.run import Belief, MethodResult, ProtectionSummary, Verdict, Worst
from navbound.run.verdict import rule
from navbound.run.verdict.belief import is_vertical, of_epochs
from navbound.run.verdict.numbers import duration
from navbound.run.verdict.results import protection_words, verdict_words
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from navbound.records.material import Material
    from navbound.run.inputs.doubts import Doubts
    from navbound.run.summary.sums import Sums
    from navbound.storage.tables import Table


SPARSE_S = 60.0
"""Period beyond which nothing is shown: within it an airliner flies 14 km, and an alert begins and ends. Provenance: ours. [s]"""


@dataclass(frozen=True)
class VerdictFacts:
    """What the verdict says and rests on, of every epoch.

    Attributes
    ----------
    n_recorded, n_missing : int
        Epochs that are there, and that should have been.
    n_judged, n_inside, n_contained : int
        With status ok and both margins; of these within RNP, and within twice RNP.
    n_status : dict
        Epochs by status.
    n_reason : dict
        Epochs that are not ok by reason, the most frequent first.
    worst : (Worst or None, Worst or None)
        Epochs of the least margin, of accuracy and of integrity.
    doubts : Doubts
        What the recording says against itself.
    """

    n_recorded: int
    n_missing: int
    n_judged: int
    n_inside: int
    n_contained: int
    n_outside: int
    n_status: dict[str, int]
    n_reason: dict[str, int]
    worst: tuple[Worst | None, Worst | None]
    doubts: Doubts
    belief: Belief | None = None
    n_known_beyond: int = 0
    n_truth: int = 0
    n_absent: int = 0
    largest_height_error_m: float | None = None


def facts_of(sums: Sums, epochs: Table, stated: list[MethodResult], risks: tuple[float, float]) -> VerdictFacts:
    """What the verdict says and rests on. The first of the stated methods judges."""
    return VerdictFacts(
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
        belief=of_epochs(epochs, stated[0].id, risks, [each.id for each in stated]),
        n_known_beyond=sums.n_known_beyond,
        n_truth=sums.n_truth,
        n_absent=sums.gaps.n_absent(),
        largest_height_error_m=sums.largest_height_error_m,
    )


def verdict_of(
    material: Material, known: VerdictFacts, stated: list[MethodResult], risks: tuple[float, float], protection: list[ProtectionSummary]
) -> Verdict:
    """The verdict and its words."""
    judge, belief = stated[0], known.belief
    position_doubts = [*material.position_doubts, *_scattered(material, known, judge.id), *_sparse(material.sample_period_s)]
    n_epochs, n_degraded = known.n_recorded + known.n_missing, known.n_status.get("degraded", 0)
    facts = rule.TrackFacts(
        n_epochs=n_epochs,
        n_judged=known.n_judged,
        n_outside=known.n_outside,
        n_beyond_alert_limit=sum(p.n_epochs - round(p.share_available * p.n_epochs) for p in protection),
        n_implausible=known.n_status.get("invalid_input", 0),
        n_misleading=sum(check.n_above for check in belief.levels if check.level == "hpl_m") if belief is not None else 0,
        belief="unchecked" if belief is None else belief.state,
        n_known_beyond=known.n_known_beyond,
        n_stated_against=known.doubts.n_stated_against,
        n_without_level=known.doubts.n_without_level,
        n_apart=0 if known.doubts.neighbours is None else known.doubts.neighbours.n,
        truth_lost=material.truth_doubts.n > 0 and known.n_truth <= material.truth_doubts.n,
        position_doubted=bool(position_doubts),
        path_doubted=material.beside is not None and bool(material.beside.doubts),
        n_approaches=material.n_approaches,
        n_unjudged_approaches=material.n_unjudged_approaches,
    )
    decided = rule.of_tracks(facts)
    verdict = Verdict(
        id=decided,
        inside=rule.MEANS_INSIDE[decided],
        words="",
        requirement=material.requirement,
        method=judge.id,
        share_inside=known.n_inside / known.n_judged if known.n_judged else None,
        share_contained=known.n_contained / known.n_judged if known.n_judged else None,
        n_epochs=n_epochs,
        n_judged=known.n_judged,
        n_degraded=n_degraded,
        n_unjudged=n_epochs - known.n_judged - n_degraded,
        n_missing=known.n_missing,
        n_absent=known.n_absent,
        largest_height_error_m=None if belief and any(map(is_vertical, belief.beside)) else known.largest_height_error_m,
        n_reason=known.n_reason,
        n_approaches=facts.n_approaches,
        n_unjudged_approaches=facts.n_unjudged_approaches,
        n_tracks_elsewhere=material.n_tracks_elsewhere,
        beside=material.beside,
        n_outside=facts.n_outside,
        n_known_beyond=facts.n_known_beyond,
        n_stated_beyond=known.doubts.n_stated_beyond,
        n_stated_alert=known.doubts.n_stated_alert,
        stated_alerts=list(known.doubts.stated_alerts),
        n_stated_worse=known.doubts.n_stated_worse,
        n_stated_uncontained=known.doubts.n_stated_uncontained,
        unread=material.unread,
        set_aside=material.set_aside,
        position_doubts=position_doubts,
        n_apart=facts.n_apart,
        largest_apart_m=known.doubts.neighbours.largest_m if known.doubts.neighbours is not None and facts.n_apart else None,
        n_without_level=known.doubts.n_without_level,
        n_long_steps=known.doubts.n_long_steps,
        longest_step_s=known.doubts.longest_step_s,
        assumed=_assumed(material, judge.id),
        belief=belief,
        n_implausible=facts.n_implausible,
        worst_accuracy=known.worst[0],
        worst_integrity=known.worst[1],
        truth_known=known.n_truth > 0,
        n_truth=known.n_truth,
        n_truth_doubted=material.truth_doubts.n,
        truth_doubts=material.truth_doubts.words,
    )
    sentences, lead = verdict_words(verdict, judge, risks, material.covariance, material.labels)
    of_levels = protection_words(protection)
    return verdict.stating([*sentences, *of_levels], [*lead, *of_levels])


def _scattered(material: Material, known: VerdictFacts, judging: str) -> list[str]:
    """A doubt where positions scatter along their way by more than the covariance leaves of the limit, and no truth checks it.

    A deviation that is typed or coded holds no age of a position, and a covariance of a table seldom does.
    """
    worst, scatter = known.worst[0], material.scatter
    if scatter is None or worst is None or known.n_truth or method(judging).error_column != "nse_h_m" or worst.margin_m < 0.0:
        return []
    if scatter.along_m <= worst.margin_m:
        return []
    return [
        f"The positions scatter along their way by {scatter.along_m:.0f} m (95 % of {counted(scatter.n, 'step')} of track "
        f"{scatter.track}, less what "
        f"their own speeds say): positions are older or younger than their rows, which the covariance does not hold, and the bound leaves "
        f"{worst.margin_m:.0f} m of the limit"
    ]


def _sparse(period_s: float) -> list[str]:
    """A doubt where each position is alone: the monitor has nothing nearly all the time."""
    if round(period_s, 3) <= SPARSE_S:
        return []
    return [f"Positions stand {duration(period_s)} apart as a rule: what is said of them is true of each by itself, and of no flight"]


def _assumed(material: Material, judging: str) -> list[Literal["sigma_typed", "sigma_coded", "no_path"]]:
    """What no data says and the first sentence must."""
    assumed: list[Literal["sigma_typed", "sigma_coded", "no_path"]] = []
    if material.covariance.id == "typed":
        assumed.append("sigma_typed")
    elif material.covariance.id in {"nac_p", "nuc_p", "containment_radius"}:
        assumed.append("sigma_coded")
    return [*assumed, "no_path"] if method(judging).error_column == "nse_h_m" else assumed
