"""What truth says of the bounds that a run states, in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.methods import method
from navbound.records.verdict import LEAST_SHARE
from navbound.run.verdict.belief import is_excluded_vertical
from navbound.run.verdict.numbers import in_metres, independent, level, share
from navbound.run.verdict.rule import FEW_EPOCHS, SQUARE_OF_TRUE, TOO_SMALL
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from navbound.records.run import Belief, BoundCheck, LevelCheck, Verdict

WHOLE_BELOW = 0.01
"""Risk below which a bound that every error respects needs no interval: hardly an epoch was to be expected beyond it."""

_NAMES = {
    "anp-circle": "circle",
    "tse-exact": "bound of the total system error",
    "anp-vertical": "vertical interval",
    "anp-sphere": "sphere",
    "anp-along": "interval along the course",
    "anp-cross": "interval across the course",
    "tse-vertical": "vertical bound of the total system error",
}
_LEVELS = {"hpl_m": ("horizontal", "HPL"), "vpl_m": ("vertical", "VPL")}


def refuted_words(belief: Belief | None) -> str:
    """Every bound and level that truth contradicts, with its figures; the reason that withdraws the verdict first."""
    if belief is None:
        return "errors are above the protection level"
    named = _false(belief.bounds + belief.beside, belief.levels)
    if belief.state != "refuted":
        return "; ".join(named) or "errors are above the protection level"
    low = f"probability of these errors under true lateral bounds at most {belief.p_value:.1g}"
    return f"truth contradicts the bounds ({low}){': ' if named else ''}{'; '.join(named)}"


def contradicted_words(belief: Belief) -> list[str]:
    """Every bound and level that truth contradicts, with its figures; the lateral ones first."""
    lateral, beside = _false(belief.bounds, []), _false(belief.beside, belief.levels)
    words = [f"Truth contradicts the lateral bounds: {'; '.join(lateral)}."] if lateral else []
    if beside:
        words.append(f"Truth contradicts what this run states beside the lateral bounds: {'; '.join(beside)}.")
        words.append("A covariance that is false in one axis is no evidence for the others.")
    return words


def _false(bounds: list[BoundCheck], levels: list[LevelCheck]) -> list[str]:
    named = [f"the {_bound(check)} contains {_figures(check)} of {check.n} errors" for check in bounds if check.refuted]
    for each in levels:
        if each.n_above:
            axis, name = _LEVELS[each.level]
            most = f"(at most {each.largest_ratio:.3g} times the level)"
            named.append(f"the {axis} error is above {name} at {each.n_above} of {counted(each.n, 'epoch')} {most}")
    return named


def short_words(belief: Belief) -> list[str]:
    """Which bounds hold less than they claim, though not beyond doubt."""
    false = [
        f"the {_bound(check)} contains {_figures(check)} of {check.n} errors" for check in belief.beside if is_excluded_vertical(check)
    ]
    lateral = any(check.coverage < 1.0 - check.risk for check in belief.bounds)
    words = []
    if lateral or not false:
        words.append(
            "The error is within the bounds less often than they claim, on too few independent epochs to decide whether they are false."
        )
    if false:
        words.append(f"The vertical bounds claim more than their intervals allow: {'; '.join(false)}.")
    return words


def truth_words(verdict: Verdict, *, beside_numbers: bool = False) -> list[str]:
    """How far truth is known, and how often each bound contained the error, with its interval and what the epochs are worth.

    Beside the numbers of the lateral bounds the sentences that say the same are left out.
    """
    return ([verdict.truth_doubts] if verdict.truth_doubts else []) + _checked(verdict)[1 if beside_numbers else 0 :]


def _checked(verdict: Verdict) -> list[str]:
    """The first sentence says how far truth is known; a page has that beside the verdict."""
    belief = verdict.belief
    if not verdict.truth_known:
        return ["No truth: the covariance could not be checked."]
    if belief is None or not (belief.bounds or belief.beside):
        return [
            f"Truth is known at {counted(verdict.n_truth, 'epoch')}, but at none that has a covariance: the bounds could not be checked."
        ]
    lateral = _contained(belief.bounds)
    # What truth contradicts stands in the first sentence already.
    other = _contained([check for check in belief.beside if check.method == "anp-vertical" and not check.refuted])
    vertical = [f"Of the vertical errors {'; '.join(other)}."] if other else []
    if verdict.largest_height_error_m is not None:
        vertical.append(
            f"Heights differ from the truth by up to {in_metres(verdict.largest_height_error_m)}; no vertical bound judges them."
        )
    known = f"{_known(belief)}: of the errors at these epochs {'; '.join(lateral)}."
    return [known, *_small(belief), *_few(belief), *vertical, *_below(belief), *_levels(belief)]


COPIED = (
    "The truth is the estimate itself: at most of the epochs their distance is nil, far below what two measurements leave, or the same to "
    "the millimetre while the aircraft moves. "
    "It says nothing of the errors."
)


def covered_words(belief: Belief | None) -> str:
    """The share of the checked epochs whose truth is known, where it is not all; for the first sentence."""
    if belief is None or not 0 < belief.n_truth < belief.n_epochs:
        return ""
    return f"; the true position is known at {share(belief.n_truth / belief.n_epochs)} of the checked epochs only"


def _small(belief: Belief) -> list[str]:
    """Errors that no covariance of this size explains."""
    if belief.square_mean is None or belief.state == "copied" or not belief.square_mean < TOO_SMALL * SQUARE_OF_TRUE:
        return []
    ratio = SQUARE_OF_TRUE / belief.square_mean if belief.square_mean > 0.0 else float("inf")
    times = f"{ratio:.2g}" if ratio < 100.0 else "more than 100"
    unsupported = "; this supports no bound" if belief.state == "small" else ""
    return [
        f"The squared errors are {times} times smaller than the covariance states: either the covariance is far too large, or "
        f"the truth is not independent of the estimate{unsupported}."
    ]


def _few(belief: Belief) -> list[str]:
    if belief.state != "few":
        return []
    return [
        f"These data do not contradict the bounds, and do not support them either: at least {FEW_EPOCHS:g} independent epochs are needed, "
        f"and these are worth {independent(belief.n_effective)}."
    ]


def _known(belief: Belief) -> str:
    if belief.n_truth == belief.n_epochs:
        return f"Truth is known at {'all ' if belief.n_epochs != 1 else ''}{counted(belief.n_epochs, 'checked epoch')}"
    less = f", which are too many to call the bounds supported (least share {share(LEAST_SHARE)})" if belief.state == "partial" else ""
    known = f"{belief.n_truth} of {counted(belief.n_epochs, 'checked epoch')} ({share(belief.n_truth / belief.n_epochs)})"
    return f"Truth is known at {known}, and the bounds of the others could not be checked{less}"


def _contained(bounds: list[BoundCheck]) -> list[str]:
    whole = [check for check in bounds if check.n_outside == 0 and check.risk < WHOLE_BELOW]
    one = [f"{_figures(check)} are within the {_bound(check)}" for check in bounds if check not in whole]
    n_effective = min((check.n_effective for check in bounds), default=0.0)
    of = agreeing(float(independent(n_effective)), "epoch")
    parts = [f"{' and '.join(one)} (95 % intervals as from {independent(n_effective)} independent {of})"] if one else []
    return parts + ([f"none is beyond the {' or the '.join(_bound(check) for check in whole)}"] if whole else [])


def _below(belief: Belief) -> list[str]:
    """Bounds beside the lateral ones whose coverage lies below the claim with its whole interval, and that are not refuted by name."""
    named_first = belief.state == "short"
    low = [
        check
        for check in belief.beside
        if check.coverage_high < 1.0 - check.risk and not check.refuted and not (named_first and is_excluded_vertical(check))
    ]
    each = "; ".join(f"the {_bound(check)} contains {_figures(check)}" for check in low)
    alone = " This verdict is lateral alone: the vertical claim is withdrawn." if any(map(is_excluded_vertical, low)) else ""
    return [f"Below its claim, though not beyond doubt: {each}.{alone}"] if low else []


def _levels(belief: Belief) -> list[str]:
    respected = [f"{_LEVELS[each.level][1]} at any of {counted(each.n, 'epoch')}" for each in belief.levels if not each.n_above]
    return [f"No error is above {' or '.join(respected)}."] if respected else []


def _figures(check: BoundCheck) -> str:
    return f"{share(check.coverage)} ({share(check.coverage_low)} to {share(check.coverage_high)})"


def _bound(check: BoundCheck) -> str:
    return f"{level(check.risk)} {_NAMES.get(check.method, method(check.method).title)}"
