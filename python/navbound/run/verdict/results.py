"""Numbers as a navigator says them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.read.columns.naming import declare
from navbound.read.statements.names import speaks_of_accuracy, speaks_of_level
from navbound.run.verdict.numbers import duration, length, level, share
from navbound.run.verdict.procedure import beside_procedure_words, incomplete_words
from navbound.run.verdict.rule import FEW_EPOCHS, has_approaches
from navbound.run.verdict.words import COPIED, contradicted_words, covered_words, refuted_words, short_words, truth_words
from navbound.status import REASONS
from navbound.time import utc_text
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from navbound.evaluation import Nees, Pit
    from navbound.records.run import CovarianceOrigin, MethodResult, ProtectionSummary, RegionCoverage, Verdict, Worst
    from navbound.records.verdict import VerdictId

HEADLINES: dict[VerdictId, str] = {
    "inside": "Inside",
    "outside": "Not always inside",
    "not_shown": "Not shown to be inside",
    "not_believable": "Not believable",
    "nothing_judged": "Nothing judged against",
}
"""The first words of each verdict."""


def verdict_words(
    verdict: Verdict, judged: MethodResult, risks: tuple[float, float], covariance: CovarianceOrigin, labels: Mapping[str, str]
) -> tuple[list[str], list[str]]:
    """What a navigator wants to know first, in sentences: all of them, and those whose numbers a page does not show beside them.

    First the verdict, then why, the gravest first, then what stands beside it. A track has its name of `labels`, as everywhere else.
    """
    assumed = _assumed(verdict, covariance)
    first = _first(verdict, risks)
    parts = [f"{assumed}: {first[0].lower()}{first[1:]}" if assumed else first]
    if verdict.id == "not_shown":
        parts += _not_shown(verdict)
    parts += [f"{doubt}." for doubt in verdict.position_doubts]
    parts += incomplete_words(verdict.beside)
    if verdict.n_implausible:
        parts.append(
            f"{counted(verdict.n_implausible, 'epoch')} cannot be true (see their reasons); what looks right beside them may be "
            "wrong as well."
        )
    parts += _contradicted(verdict)
    parts += _reasons(verdict)
    n_before_worst = len(parts)
    if verdict.n_long_steps and verdict.longest_step_s is not None:
        parts.append(
            f"Between epochs nothing is known: {counted(verdict.n_long_steps, 'step is', 'steps are')} longer than a position takes "
            "to become stale, "
            f"the longest {duration(verdict.longest_step_s)}."
        )
    parts += unread_words(verdict.unread)
    judged_by = f"Judged by {judged.title} ({judged.id}, {judged.provenance})."
    worst = [] if verdict.worst_accuracy is None else [_worst(verdict.worst_accuracy, labels)]
    of_truth, of_truth_beside = truth_words(verdict), truth_words(verdict, beside_numbers=True)
    words = [*parts[:n_before_worst], *worst, *parts[n_before_worst:], judged_by, *of_truth]
    return words, [*parts, *of_truth_beside]


def unread_words(unread: Sequence[str]) -> list[str]:
    """What a file says of accuracy or integrity that was not understood; nothing where there is none."""
    return (
        [f"Not understood and not used, though the names speak of accuracy, of integrity or of another position: {'; '.join(unread)}."]
        if unread
        else []
    )


def _assumed(verdict: Verdict, covariance: CovarianceOrigin) -> str:
    named = {
        "sigma_typed": _typed(covariance),
        "sigma_coded": "a sigma made of a quality indicator (NACp, NUCp, NIC or Rc)",
        "no_path": "no path (the circle of the position error is compared with RNP, without flight technical error)",
    }
    aside = [f"{', '.join(verdict.set_aside)} set aside by the user"] if verdict.set_aside else []
    assumed = [*(named[each] for each in verdict.assumed), *aside]
    return f"Assuming {' and '.join([*filter(None, [', '.join(assumed[:-1])]), *assumed[-1:]])}" if assumed else ""


def _typed(covariance: CovarianceOrigin) -> str:
    if covariance.sigma_m is None:
        return ""
    low, high = covariance.own_low_m, covariance.own_high_m
    own = "" if low is None or high is None else f" over the file's own accuracy (sigma {low:.3g} to {high:.3g} m)"
    return f"a sigma of {covariance.sigma_m:g} m in each axis, typed by the user{own}"


def _first(verdict: Verdict, risks: tuple[float, float]) -> str:
    accuracy, integrity = (level(risk) for risk in risks)
    shares = _shares(verdict)
    if verdict.id == "nothing_judged" or verdict.share_inside is None or verdict.share_contained is None:
        outside = (
            f" {counted(verdict.n_outside, 'epoch that is not ok has', 'epochs that are not ok have')} a bound beyond its limit."
            if verdict.n_outside
            else ""
        )
        return f"{HEADLINES[verdict.id]} {verdict.requirement}: {shares}.{outside}"
    if verdict.id == "not_believable":
        n = verdict.n_known_beyond
        beyond = f"at {counted(n, 'ok epoch')} the known error is beyond twice RNP though the bound is within it" if n else ""
        false = refuted_words(verdict.belief) if verdict.belief is not None and (not n or verdict.belief.state == "refuted") else ""
        why = "; ".join(each for each in (beyond, false) if each) or refuted_words(verdict.belief)
        return f"{HEADLINES[verdict.id]}, margins to {verdict.requirement} mean nothing: {why}; {shares}."
    more = f", and {_outside(verdict)}" if verdict.n_outside else ""
    return (
        f"{HEADLINES[verdict.id]} {verdict.requirement}: the {accuracy} bound is within RNP at {share(verdict.share_inside)} of "
        f"{counted(verdict.n_judged, 'judged epoch')}, the {integrity} bound within twice RNP at {share(verdict.share_contained)}{more}; "
        f"{shares}{covered_words(verdict.belief)}{_thin(verdict)}."
    )


def _outside(verdict: Verdict) -> str:
    """The epochs that are outside, by whatever comparison."""
    n = verdict.n_outside
    # Where every judged epoch is within, those that are outside are others: the worst margin beside them is of the judged ones.
    if verdict.share_inside == verdict.share_contained == 1.0:
        if not verdict.n_degraded:
            return f"{counted(n, 'epoch has', 'epochs have')} no protection level, where others have one"
        if n > verdict.n_degraded:
            one, many = ("epoch that is degraded or has no protection level is", "epochs that are degraded or have no protection level are")
            return f"{counted(n, one, many)} outside"
        return f"{counted(n, 'degraded epoch has', 'degraded epochs have')} a bound beyond its limit"
    return f"{counted(n, 'epoch with status ok or degraded has', 'epochs with status ok or degraded have')} a bound beyond its limit"


MANY_ABSENT = 0.01
"""Share of absent epochs beyond which the verdict names them: fewer are what rounded times leave. Provenance: ours. [1]"""
_MOST_REASONS = 3
"""Reasons that are named. [1]"""


def _reasons(verdict: Verdict) -> list[str]:
    """Why epochs are not ok: the most frequent reasons."""
    # To say that there is one more takes as long as to name it.
    most = _MOST_REASONS + (len(verdict.n_reason) == _MOST_REASONS + 1)
    named = [f"{REASONS[id_].words if id_ in REASONS else id_} ({n})" for id_, n in list(verdict.n_reason.items())[:most]]
    more = len(verdict.n_reason) - len(named)
    also = f"; {counted(more, 'more reason')}" if more else ""
    return [f"Epochs that are not ok: {'; '.join(named)}{also}."] if named else []


def _thin(verdict: Verdict) -> str:
    """That a verdict rests on fewer epochs than may be called evidence."""
    if not 0 < verdict.n_judged < FEW_EPOCHS:
        return ""
    step = "" if verdict.longest_step_s is None else f", up to {duration(verdict.longest_step_s)} apart"
    return f"; this is thin evidence, of only {counted(verdict.n_judged, 'judged epoch')}{step}"


def _shares(verdict: Verdict) -> str:
    """What became of all epochs."""
    many = verdict.n_absent > MANY_ABSENT * verdict.n_epochs
    room = "that the usual step leaves room for"
    n_absent = counted(verdict.n_absent, f"epoch {room} is", f"epochs {room} are")
    absent = f"; {n_absent} absent, in gaps too short to count" if many else ""
    unjudged = f"{absent}{_unjudged_approaches(verdict)}{beside_procedure_words(verdict.beside)}"
    if verdict.n_epochs == 0:
        return f"there is no epoch{unjudged}"
    if verdict.n_judged == verdict.n_epochs:
        if verdict.n_epochs == 1:
            return f"the one epoch{' that is there' if many else ''} is ok and judged{unjudged}"
        there = " that are there" if many else ""
        return f"all {verdict.n_epochs} epochs{there} are ok and judged{unjudged}"
    missing = f" ({counted(verdict.n_missing, 'epoch')} missing in gaps or without a usable time and position)" if verdict.n_missing else ""
    kinds = {"ok and judged": verdict.n_judged, "degraded": verdict.n_degraded, f"without a bound{missing}": verdict.n_unjudged}
    return (
        f"of {counted(verdict.n_epochs, 'epoch')} "
        f"{', '.join(f'{share(n / verdict.n_epochs)} are {kind}' for kind, n in kinds.items())}{unjudged}"
    )


def _unjudged_approaches(verdict: Verdict) -> str:
    """That passes along a centreline are no part of all these epochs."""
    n, n_all = verdict.n_unjudged_approaches, verdict.n_approaches + verdict.n_unjudged_approaches
    which = (
        "is not judged, since it strays or ends before it is one"
        if n == 1
        else "are not judged, since they stray or end before they are one"
    )
    n_elsewhere = verdict.n_tracks_elsewhere
    without = counted(n_elsewhere, "track has", "tracks have")
    elsewhere = f"; {without} no approach to these runways and {agreeing(n_elsewhere, 'is', 'are')} not judged"
    return (f"; {n} of {counted(n_all, 'approach', 'approaches')} {which}" if n else "") + (elsewhere if n_elsewhere else "")


def _not_shown(verdict: Verdict) -> list[str]:
    """Why the margins alone are not enough."""
    why = []
    if verdict.n_judged < verdict.least_share * verdict.n_epochs:
        why.append(f"At least {level(1.0 - verdict.least_share)} of the epochs must be ok and judged.")
    if not has_approaches(verdict.n_approaches, verdict.n_unjudged_approaches):
        why.append(f"At least {level(1.0 - verdict.least_share)} of the approaches must be judged.")
    if verdict.belief is not None and verdict.belief.state == "short":
        why += short_words(verdict.belief)
    if verdict.belief is not None and verdict.belief.state == "copied":
        why.append(COPIED)
    if verdict.belief is not None and verdict.belief.state == "contradicted":
        why += contradicted_words(verdict.belief)
    if verdict.n_stated_beyond:
        why.append(f"The recording itself states an error beyond RNP at {counted(verdict.n_stated_beyond, 'epoch')}.")
    if verdict.n_stated_alert:
        which = f" ({'; '.join(verdict.stated_alerts)})" if verdict.stated_alerts else ""
        why.append(f"The recording itself states an alert at {counted(verdict.n_stated_alert, 'epoch')}{which}.")
    if verdict.n_stated_worse:
        why.append(
            "The recording itself states an accuracy (95 % radius: EPU, NACp, NUCp, sigma) at "
            f"{counted(verdict.n_stated_worse, 'epoch')} that is "
            f"worse than the covariance allows.{_read_as_metres(verdict.unread)}"
        )
    if verdict.n_stated_uncontained:
        why.append(
            f"The recording itself states a containment radius (Rc, NIC, NUCp, PIC, a protection level) beyond twice RNP, or none, at "
            f"{counted(verdict.n_stated_uncontained, 'epoch')}.{_levels_read_as_metres(verdict.unread)}"
        )
    if verdict.n_apart and verdict.largest_apart_m is not None:
        why.append(
            f"{counted(verdict.n_apart, 'position stands', 'positions stand')} further from the line between "
            f"{agreeing(verdict.n_apart, 'its neighbours than its covariance allows', 'their neighbours than their covariances allow')} "
            f"(up to {verdict.largest_apart_m:.0f} m): two receivers under one name, or a covariance that is too small."
        )
    if verdict.n_without_level:
        why.append(
            "A column of horizontal protection levels holds none in the tracks of "
            f"{counted(verdict.n_without_level, 'judged epoch')}: their "
            "integrity was compared without a level."
        )
    return why


def beside_words(n_epochs: int, unread: Sequence[str]) -> list[str]:
    """That a table states what its own levels cannot hold; nothing where it does not."""
    if not n_epochs:
        return []
    return [
        f"Not shown: the file itself states an accuracy or an error (EPU, sigma) above its horizontal protection level at "
        f"{counted(n_epochs, 'epoch')}.{_read_as_metres(unread)}"
    ]


def _read_as_metres(unread: Sequence[str]) -> str:
    """What was compared though nothing says what it is, and how a person says it."""
    # A sentence of a receiver is no column: it is named, not compared.
    names = [f"“{name}”" for name in unread if speaks_of_accuracy(name) and not name.startswith("$")]
    if not names:
        return ""
    which = f"Compared, too, as a length of the unit that its name states, or metres: {', '.join(names)}."
    return f" {which} {declare('epu_m=COLUMN:UNIT')} where it is a 95 % radius in another unit."


def _levels_read_as_metres(unread: Sequence[str]) -> str:
    names = [f"“{name}”" for name in unread if speaks_of_level(name)]
    if not names:
        return ""
    return f" Compared as a length of the unit that its name states, or metres: {', '.join(names)}. {declare('hpl_m=COLUMN:UNIT')}."


def _contradicted(verdict: Verdict) -> list[str]:
    """What truth contradicts, where no earlier sentence of the verdict names it."""
    belief = verdict.belief
    if belief is None or (verdict.id == "not_shown" and belief.state == "contradicted"):
        return []
    # A verdict withdrawn by a false bound names all of them first.
    named_first = verdict.id == "not_believable" and (belief.state == "refuted" or not verdict.n_known_beyond)
    return [] if named_first else contradicted_words(belief)


def _worst(worst: Worst, labels: Mapping[str, str]) -> str:
    where = f" in {worst.phase}" if worst.phase else ""
    sign = "margin" if worst.margin_m >= 0 else "excess"
    return (
        f"Worst {sign} {length(abs(worst.margin_m))} (bound {length(worst.bound_m)}, limit {length(worst.limit_m)}) "
        f"at {utc_text(worst.time_ns)} UTC{where}, track {labels.get(worst.track, worst.track)}."
    )


def protection_words(protection: list[ProtectionSummary]) -> list[str]:
    """How protection levels stood against alert limits, and whether they bounded the true errors; nothing where there are none."""
    if not protection:
        return []
    n = sum(p.n_epochs for p in protection)
    available = share(sum(p.share_available * p.n_epochs for p in protection) / n)
    provenance = ", ".join(sorted({p.hal_held for p in protection}))
    misleading = sum(p.n_misleading for p in protection)
    within = f"Protection level within the alert limit ({provenance}) at {available} of {counted(n, 'epoch')}."
    above = f"At {counted(misleading, 'epoch')} the true error is above the protection level: misleading information."
    return [within, *([above] if misleading else [])]


def consistency_words(nees: Nees, pit: Pit, regions: Sequence[RegionCoverage] = ()) -> str:
    """Whether the covariance may be believed, with the factor by which it is off, and on how much evidence."""
    opening = (
        f"NEES {nees.nees_mean:.3g}, {nees.dimension} for a consistent covariance, "
        f"limits {nees.nees_low:.3g} to {nees.nees_high:.3g} for {counted(round(nees.n_effective), 'effective epoch')}"
    )
    return f"{opening}{_judgement(nees, pit)}{_regions(regions)}"


def _judgement(nees: Nees, pit: Pit) -> str:
    factor = (nees.nees_mean / nees.dimension) ** 0.5
    outside = not nees.nees_low <= nees.nees_mean <= nees.nees_high
    low, high = _core.chi_quantile(nees.dimension, np.array([0.975, 0.025])) ** 2
    if outside and nees.n_effective < FEW_EPOCHS and low <= nees.nees_mean <= high:
        return (
            ", outside. But so few say little, and where errors stay for a whole track even their number is a guess: a single epoch may "
            f"have {low:.2g} to {high:.2g}. More tracks decide it."
        )
    if outside:
        claims = (
            "smaller errors than there are: they are {:.2g} times what it says"
            if factor > 1
            else "larger errors than there are: they are {:.2g} times what it says"
        )
        return f": the covariance claims {claims.format(factor)}."
    n_outside = sum(not pit.low <= count <= pit.high for count in pit.counts)
    if n_outside == 0:
        return ": these data give no reason to doubt the covariance."
    largest = max(pit.counts) * len(pit.counts) / sum(pit.counts)
    return (
        f": no reason to doubt the size of the covariance. But {n_outside} of the {len(pit.counts)} bins of the histogram "
        f"{agreeing(n_outside, 'is', 'are')} outside the band (one in twenty is by chance), and the fullest holds {largest:.2g} times its "
        "share: errors are not spread as one Gaussian."
    )


def _regions(regions: Sequence[RegionCoverage]) -> str:
    shares = [f"the 95 % {r.region} held {share(r.share)} of the epochs ({share(r.low)} to {share(r.high)})" for r in regions]
    return f" Over all tracks {', '.join(shares)}; limits from drawing whole tracks again." if shares else ""
