"""The one place that decides a verdict: counts and facts in, an id out. It reads no table and writes no sentence."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from navbound.records.verdict import LEAST_SHARE

if TYPE_CHECKING:
    from navbound.records.verdict import BeliefState, VerdictId

REFUTED_AT = 1e-3
"""Probability of the data under the claimed bounds at which they are taken as false (docs/methods/coverage.md). Provenance: ours."""

DOUBTED_AT = 0.05
"""The same at which they are not supported either. Provenance: ours."""

DOUBTED_BESIDE_AT = 0.01
"""The same of the tests beside the lateral bounds: these carry no lateral verdict, so that one error by chance is no doubt of it, and
withdraws the vertical claim alone. Provenance: ours. Of 400 runs of 400 true errors that no choice was made on it takes "inside" from 3,
as the lateral bounds do from 3, and the vertical claim is withdrawn in 11."""

MEANS_INSIDE: dict[VerdictId, bool | None] = {
    "inside": True,
    "outside": False,
    "not_shown": None,
    "not_believable": None,
    "nothing_judged": None,
}
"""What each id says of the requirement; None: nothing."""


@dataclass(frozen=True)
class TrackFacts:
    """What the verdict on judged tracks rests on, one flight or a campaign.

    Attributes
    ----------
    n_epochs : int
        Expected: those of the table and those missing in gaps.
    n_judged : int
        With status ok and a bound.
    n_outside : int
        With status ok or degraded and a bound beyond its limit.
    n_beyond_alert_limit : int
        With a protection level beyond the alert limit, or without one where one is due.
    n_implausible : int
        Whose input cannot be true.
    n_misleading : int
        Whose true horizontal error is above the horizontal protection level.
    belief : str
        What truth says of the bounds.
    n_known_beyond : int
        With status ok, a bound within its limit and a true error beyond twice RNP, which no epoch may have unnoticed.
    n_stated_against : int
        With status ok or degraded, where the recording itself states an error beyond RNP or an alert.
    n_without_level : int
        Judged, of tracks with a column of horizontal protection levels that holds none.
    n_apart : int
        Positions that contradict those beside them by more than their covariances allow.
    truth_lost : bool
        A truth was there, and at half of its epochs or more it cannot be one.
    position_doubted : bool
        Positions may not be what they are read as: their unit, or their motion against the stated speed.
    path_doubted : bool
        The path may not be the whole of what was to be flown.
    n_approaches, n_unjudged_approaches : int
        Approaches that were judged, and passes along a centreline that strayed before they were one.
    """

    n_epochs: int
    n_judged: int
    n_outside: int
    n_beyond_alert_limit: int
    n_implausible: int
    n_misleading: int
    belief: BeliefState
    n_known_beyond: int = 0
    n_stated_against: int = 0
    n_without_level: int = 0
    truth_lost: bool = False
    position_doubted: bool = False
    path_doubted: bool = False
    n_apart: int = 0
    n_approaches: int = 0
    n_unjudged_approaches: int = 0


def of_tracks(facts: TrackFacts) -> VerdictId:
    """Verdict on judged tracks. A false bound comes first: no margin counts beside it."""
    if facts.belief == "refuted" or facts.n_misleading or facts.n_known_beyond:
        return "not_believable"
    if facts.n_judged == 0:
        return "nothing_judged"
    if facts.n_outside or facts.n_beyond_alert_limit:
        return "outside"
    doubts = facts.n_implausible + facts.n_stated_against + facts.n_without_level + facts.n_apart
    doubts += facts.truth_lost + facts.position_doubted + facts.path_doubted
    judged = facts.n_judged >= LEAST_SHARE * facts.n_epochs and has_approaches(facts.n_approaches, facts.n_unjudged_approaches)
    return "not_shown" if doubts or facts.belief in UNSUPPORTED or not judged else "inside"


def has_approaches(n_judged: int, n_unjudged: int) -> bool:
    """Whether enough approaches are judged: the least share of epochs is that of approaches too, since who strays early has few epochs."""
    return n_judged >= LEAST_SHARE * (n_judged + n_unjudged)


UNSUPPORTED: frozenset[BeliefState] = frozenset({"copied", "short", "contradicted"})
"""Beliefs beside which margins show nothing: a truth that is the estimate, too few errors within, a false bound beside them."""


@dataclass(frozen=True)
class LevelFacts:
    """What the verdict on one service level rests on.

    Attributes
    ----------
    n_expected, n_solution, n_available : int
        Epochs expected; with a protection level; with one within the limits.
    n_misleading_events : int
        Runs of epochs whose true error is above the protection level.
    p_misleading : float or None
        Largest probability of as many for a level that keeps its integrity risk; None where there are none.
    truth_known : bool
        Errors are known.
    doubted : bool
        The truth is the estimate itself, or the file states an accuracy or an error above its own levels.
    """

    n_expected: int
    n_solution: int
    n_available: int
    n_misleading_events: int
    p_misleading: float | None
    truth_known: bool
    doubted: bool = False


_GRAVEST: tuple[VerdictId, ...] = ("not_believable", "nothing_judged", "outside", "not_shown", "inside")


def of_levels(levels: list[LevelFacts]) -> VerdictId:
    """Verdict on several service levels: the gravest of theirs."""
    each = {_of_level(level) for level in levels}
    return next((verdict for verdict in _GRAVEST if verdict in each), "nothing_judged")


def _of_level(facts: LevelFacts) -> VerdictId:
    if facts.n_misleading_events and facts.p_misleading is not None and not facts.p_misleading > REFUTED_AT:
        return "not_believable"
    if facts.n_solution == 0:
        return "nothing_judged"
    if facts.n_solution - facts.n_available > (1.0 - LEAST_SHARE) * facts.n_expected:
        return "outside"
    if facts.doubted or facts.n_misleading_events or not facts.truth_known or not facts.n_available >= LEAST_SHARE * facts.n_expected:
        return "not_shown"
    return "inside"


@dataclass(frozen=True)
class BeliefFacts:
    """Bounds against truth.

    Attributes
    ----------
    n_effective : float
        Independent epochs.
    p_values : list of float
        Of every test of the bounds that the lateral verdict rests on.
    short : bool
        A coverage of these is below its claim.
    excluded : bool
        The 95 % interval of a coverage of these lies below its claim.
    p_values_beside : list of float
        Of every test of the other bounds that the run states: vertical, spatial, along the axes of the path.
    excluded_vertical : bool
        The 95 % interval of the coverage of a vertical bound lies below its claim.
    n_above_vertical_level : int
        Epochs whose vertical error is above the vertical protection level.
    truth_share : float
        Share of the checked epochs whose truth is known.
    copied_share : float
        Share of the epochs with truth at which it is the estimate itself.
    square_share : float or None
        Mean squared error over what the covariance states.
    """

    n_effective: float
    p_values: list[float]
    short: bool
    excluded: bool
    p_values_beside: list[float] = field(default_factory=list)
    excluded_vertical: bool = False
    n_above_vertical_level: int = 0
    truth_share: float = 1.0
    copied_share: float = 0.0
    square_share: float | None = None


SQUARE_OF_TRUE = 2.0
"""Mean of e' V^-1 e of a horizontal error under its true covariance. Derived: two axes. [1]"""

TOO_SMALL = 0.1
"""Share of the squared error that the covariance states below which truth supports nothing. Provenance: ours."""

FEW_EPOCHS = 10.0
"""Independent epochs below which their number is no better known than by its own size: it comes from the same correlated data.

Also the least number that may be called support: without one error beyond it, the 95 % interval of a coverage from 10 epochs begins at
69 %, from a single one at 2.5 %. Provenance: ours."""

COPIED_SHARE = 0.5
"""Share of the epochs at which a truth equal to the estimate is no truth: positions that were measured twice never agree so often.
Provenance: ours."""


def joint_probability(p_values: list[float]) -> float:
    """Of the least of several tests, whatever their dependence (Bonferroni); a NaN counts as no evidence."""
    return min(1.0, len(p_values) * min((p for p in p_values if p == p), default=1.0))  # noqa: PLR0124 - NaN is not itself


def is_refuted(p_values: list[float], n_tests: int) -> bool:
    """Whether these tests, of ``n_tests`` made together, refute what they test."""
    known = [p for p in p_values if p == p]  # noqa: PLR0124 - NaN is not itself
    return bool(known) and n_tests * min(known) <= REFUTED_AT


def of_belief(facts: BeliefFacts) -> BeliefState:
    """Whether truth supports the claimed bounds.

    Refuted where the data are too improbable for true bounds of those that the lateral verdict rests on; contradicted where they are too
    improbable for another bound that the run states (docs/decisions/0029); short where a coverage, of the lateral bounds or of a vertical
    one, is below its claim and its interval excludes the claim, or so few independent epochs stand behind it that they decide nothing, or
    where the data are improbable though not enough to refute. Truth that is the estimate itself says nothing: copied. Truth that is known
    at less than the least share of judged epochs supports the bounds of these epochs alone: partial. Fewer independent epochs than
    `FEW_EPOCHS` contradict nothing and support nothing: few. Errors below `TOO_SMALL` of what is stated may be those of a truth that
    comes from the estimate: small.
    """
    if is_refuted(facts.p_values, len(facts.p_values)):
        return "refuted"
    if facts.n_above_vertical_level or is_refuted(facts.p_values_beside, len(facts.p_values_beside)):
        return "contradicted"
    if facts.copied_share >= COPIED_SHARE:
        return "copied"
    doubted = facts.short and joint_probability(facts.p_values) <= DOUBTED_AT
    doubted |= facts.excluded_vertical and joint_probability(facts.p_values_beside) <= DOUBTED_BESIDE_AT
    if facts.excluded or doubted or (facts.short and facts.n_effective < FEW_EPOCHS):
        return "short"
    return _of_believed(facts)


def _of_believed(facts: BeliefFacts) -> BeliefState:
    """Of a truth that speaks against nothing."""
    if facts.truth_share < LEAST_SHARE:
        return "partial"
    if facts.n_effective < FEW_EPOCHS:
        return "few"
    return "small" if facts.square_share is not None and facts.square_share < TOO_SMALL else "supported"
