"""Numbers as a navigator says them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.time import utc_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from navbound.evaluation import Nees, Pit
    from navbound.run.records import Held, MethodResult, ProtectionSummary, Verdict, Worst

METRES_PER_NM = 1852.0


def length(metres: float) -> str:
    """A length with three significant digits; nautical miles from half a mile up."""
    if abs(metres) >= 0.5 * METRES_PER_NM:
        return f"{metres / METRES_PER_NM:.3g} NM"
    return f"{metres:.3g} m" if abs(metres) < 100 else f"{metres:.0f} m"


def share(fraction: float) -> str:
    """A share that never rounds up to all or down to none."""
    percent = 100 * fraction
    if fraction in (0.0, 1.0):
        return f"{percent:.0f} %"
    digits = 1
    while digits < 6 and (round(percent, digits) in (0.0, 100.0)):
        digits += 1
    return f"{percent:.{digits}f} %"


def level(risk: float) -> str:
    """A probability level: 0.05 is 95 %, 1e-5 is 99.999 %."""
    return f"{100 * (1 - risk):.10g} %"


def verdict_words(verdict: Verdict, judged: MethodResult, risks: tuple[float, float]) -> str:
    """What a navigator wants to know first, in sentences."""
    parts = [_inside(verdict, risks)]
    if verdict.worst_accuracy is not None:
        parts.append(_worst(verdict.worst_accuracy))
    if verdict.n_judged < verdict.n_epochs:
        parts.append(
            f"{verdict.n_epochs - verdict.n_judged} of {verdict.n_epochs} epochs could not be judged and count as loss of monitoring."
        )
    if verdict.n_implausible:
        parts.append(
            f"{verdict.n_implausible} epochs cannot be true (see their reasons); what looks right beside them may be wrong as well."
        )
    parts.append(f"Judged by {judged.title} ({judged.id}, {judged.provenance}).")
    if verdict.truth_known and judged.coverage is not None:
        parts.append(f"Truth is known: the {level(risks[0])} bound held the error at {share(judged.coverage)} of {judged.n} epochs.")
    elif not verdict.truth_known:
        parts.append("No truth: the honesty of the covariance could not be checked.")
    return " ".join(parts)


def _inside(verdict: Verdict, risks: tuple[float, float]) -> str:
    accuracy, integrity = (level(risk) for risk in risks)
    if verdict.share_inside is None or verdict.share_contained is None:
        return f"Not judged against {verdict.requirement}: no epoch has a bound."
    words = {True: "Inside", False: "Not always inside", None: "Not shown to be inside"}[verdict.inside]
    where = "" if verdict.n_judged == verdict.n_epochs else " where it could be judged"
    return (
        f"{words} {verdict.requirement}{where}: the {accuracy} bound is within RNP "
        f"at {share(verdict.share_inside)} of {verdict.n_judged} judged epochs, "
        f"the {integrity} bound within twice RNP at {share(verdict.share_contained)}."
    )


def _worst(worst: Worst) -> str:
    where = f" in {worst.phase}" if worst.phase else ""
    sign = "margin" if worst.margin_m >= 0 else "excess"
    return (
        f"Worst {sign} {length(abs(worst.margin_m))} (bound {length(worst.bound_m)}, limit {length(worst.limit_m)}) "
        f"at {utc_text(worst.time_ns)} UTC{where}, track {worst.track}."
    )


def protection_words(protection: list[ProtectionSummary]) -> str:
    """How protection levels stood against alert limits, and whether they told the truth; nothing where there are none."""
    if not protection:
        return ""
    n = sum(p.n_epochs for p in protection)
    available = share(sum(p.share_available * p.n_epochs for p in protection) / n)
    held = ", ".join(sorted({p.hal_held for p in protection}))
    misled = sum(p.n_misleading for p in protection)
    truth = f" At {misled} epochs the true error is above the protection level: misleading information." if misled else ""
    return f" Protection level within the alert limit ({held}) at {available} of {n} epochs.{truth}"


FEW_EPOCHS = 10.0
"""Effective epochs below which their number is no better known than by its own size: it comes from the same correlated data."""


def honesty_words(nees: Nees, pit: Pit, regions: Sequence[Held] = ()) -> str:
    """Whether the covariance may be believed, with the factor by which it is off, and on how much evidence."""
    found = (
        f"NEES {nees.nees_mean:.3g}, {nees.dimension} for an honest covariance, "
        f"limits {nees.nees_low:.3g} to {nees.nees_high:.3g} for {nees.n_effective:.0f} effective epochs"
    )
    return f"{found}{_judgement(nees, pit)}{_regions(regions)}"


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
            "too little; the errors are {:.2g} times larger than it says"
            if factor > 1
            else "too much; the errors are {:.2g} times what it says"
        )
        return f": the covariance claims {claims.format(factor)}."
    n_outside = sum(not pit.low <= count <= pit.high for count in pit.counts)
    if n_outside == 0:
        return ": these data give no reason to doubt the covariance."
    largest = max(pit.counts) * len(pit.counts) / sum(pit.counts)
    return (
        f": no reason to doubt the size of the covariance. But {n_outside} of the {len(pit.counts)} bins of the histogram "
        f"{'is' if n_outside == 1 else 'are'} outside the band (one in twenty is by chance), and the fullest holds {largest:.2g} times its "
        "share: errors are not spread as one Gaussian."
    )


def _regions(regions: Sequence[Held]) -> str:
    held = [f"the 95 % {r.region} held {share(r.share)} of the epochs ({share(r.low)} to {share(r.high)})" for r in regions]
    return f" Over all tracks {', '.join(held)}; limits from drawing whole tracks again." if held else ""
