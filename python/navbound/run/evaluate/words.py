"""The indicators as sentences: what a reader wants to know first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.gnss.monitor_fit import DISBELIEF
from navbound.records.verdict import LEAST_SHARE
from navbound.run.verdict.numbers import length, share
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from navbound.records.performance import LevelResult, Performance, Subsets
    from navbound.records.verdict import VerdictId


def levels_verdict(verdict: VerdictId, result: Performance) -> list[str]:
    """The sentence that withdraws the numbers after it, or says before them what is not fulfilled; nothing where all is."""
    if verdict == "not_believable":
        return ["Not believable: errors exceed the protection level more often than its integrity risk allows."]
    if verdict == "nothing_judged":
        return ["Nothing judged: no epoch has a protection level."]
    if verdict == "outside":
        below = [each.level.id for each in result.levels if each.availability_expected < LEAST_SHARE]
        return [f"Not always available: {', '.join(below)} at less than {share(LEAST_SHARE)} of the expected epochs."] if below else []
    return []


def performance_words(result: Performance) -> list[str]:
    """What was required: integrity first, then availability, continuity and accuracy."""
    words = [f"The protection levels {_predicate(result.experimental)}."] if result.experimental else []
    words += [_integrity(result), _availability(result), _continuity(result)]
    both = [axis.error_m for axis in result.axes]
    if both[0] is not None:
        vertical = "" if both[1] is None else f", vertical {length(both[1].p95)}"
        words.append(f"Accuracy (95 %): horizontal {length(both[0].p95)}{vertical}.")
    if result.subsets is not None:
        words.append(_subsets(result.subsets))
    return words


def _predicate(label: str) -> str:
    return label if label.startswith(DISBELIEF) else f"are {label}"


def _integrity(result: Performance) -> str:
    if not result.truth_known:
        return "Without truth neither integrity nor accuracy can be judged."
    hazards = [
        f"{each.level.id} at {counted(each.n_hazard_epochs, 'epoch')} ({each.n_hazard_over_tta} of "
        f"{counted(each.n_hazard_events, 'run')} longer than "
        f"{each.level.tta_s:g} s)"
        for each in result.levels
        if each.n_hazard_epochs
    ]
    known = _known(result)
    if hazards:
        return f"Hazardously misleading information: {', '.join(hazards)}. {known}"
    if result.n_mi_epochs:
        return f"No hazard, but misleading information at {counted(result.n_mi_epochs, 'epoch')}. {known}"
    return f"No misleading information at any epoch whose error is known. {known}"


def _known(result: Performance) -> str:
    """At how many epochs with a protection level the error is known, an axis each; and what could not be judged."""
    vertical = any(each.level.val_m is not None for each in result.levels)
    words, unknown = [], []
    for axis, name in zip(result.axes, ("horizontal", "vertical"), strict=True):
        n = 0 if axis.error_m is None else axis.error_m.n
        if n:
            words.append(f"{name} at {n} of {counted(result.n_solution, 'epoch')} with a protection level ({share(n / result.n_solution)})")
        elif name == "horizontal" or vertical:
            unknown.append(f"The {name} was not judged: no {name} error is known.")
    return " ".join([f"Errors are known: {', '.join(words)}." if words else "", *unknown]).strip()


def _availability(result: Performance) -> str:
    hours = result.n_expected * result.period_s / 3600
    span = f"{hours:.3g} h" if hours < 48 else f"{hours / 24:.4g} days"
    absent = "absent epochs are not expected" if result.exclude_missing else f"{result.n_missing} absent"
    repeated = (
        f"; {counted(result.n_repeated, 'row shares', 'rows share')} an epoch with another, the worst counts" if result.n_repeated else ""
    )
    each = [
        f"{each.level.id} {share(each.availability_expected)} ({share(each.availability_low)} to {share(each.availability_high)}, "
        f"as from {counted(round(each.n_effective), 'independent epoch')})"
        for each in result.levels
    ]
    return (
        f"Available, of {counted(result.n_expected, 'expected epoch')} ({span}, one every {result.period_s:g} s; {absent}, "
        f"{result.n_no_solution} "
        f"without a level{repeated}): {', '.join(each)}."
    )


def _continuity(result: Performance) -> str:
    def one(level: LevelResult) -> str:
        if level.continuity_risk is None:
            return f"{level.level.id} never available"
        losses = f"{level.level.id} {counted(level.n_continuity_events, 'loss', 'losses')}"
        return f"{losses}, risk {level.continuity_risk:.2g}" if level.window_meaningful else losses

    first = result.levels[0]
    head = f"Continuity in {first.window_s:g} s" if first.window_meaningful else "Continuity (no risk at this sampling period)"
    return f"{head}: {', '.join(one(each) for each in result.levels)}."


def _subsets(subsets: Subsets) -> str:
    largest = max(subsets.safety_index_h_max, subsets.safety_index_v_max)
    misleading = {0: "none is misleading", 1: "one is misleading"}.get(subsets.n_mi, f"{subsets.n_mi} are misleading")
    return f"Of {subsets.n_subsets} satellite subsets {misleading}; the largest safety index is {largest:.3g}."
