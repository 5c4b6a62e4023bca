"""Whether the residuals and the detections of a monitor on board agree with the error model that its levels rest on."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound.evaluation import effective_size
from navbound.gnss.constellations import CONSTELLATIONS
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from numpy.typing import NDArray

DISBELIEF = "may not be believed"
"""Words that mark protection levels whose error model the data contradict."""

RISK = 0.05
"""Both intervals hold with 95 %."""

_NORMAL_QUANTILE = 1.959963984540054


@dataclass(frozen=True)
class Fit:
    """Squared residuals against the error model, and detections against their allocation.

    Attributes
    ----------
    ratio, ratio_low, ratio_high : float
        Sum of the weighted squared residuals over the sum of their redundancies, of the epochs without a detection, with its two-sided
        95 % interval; 1 where the model is right, larger where its sigmas are too small. NaN without redundancy. [1]
    ratio_of_system : dict of str to float
        The same of the ranges of one constellation. [1]
    n_epochs, n_detected : int
        Epochs that were tested, and those where a fault was detected. [1]
    n_effective : float
        Independent epochs that the tested ones are worth, by the autocorrelation of the statistic. [1]
    n_events : int
        Detections of other satellites than the one before, or further apart than one independent epoch is long. [1]
    p_detected_low, p_detected_high : float
        Exact binomial two-sided 95 % interval of the probability of a detection in an independent epoch. [1]
    p_false_alert : float
        What the allocation allows. [1]
    """

    ratio: float
    ratio_low: float
    ratio_high: float
    ratio_of_system: dict[str, float]
    n_epochs: int
    n_detected: int
    n_effective: float
    n_events: int
    p_detected_low: float
    p_detected_high: float
    p_false_alert: float

    @property
    def residuals_fit(self) -> bool:
        """Whether the squared residuals are not larger than the model allows; False where nothing could be compared."""
        return bool(self.ratio_low <= 1.0)

    @property
    def detections_fit(self) -> bool:
        """Whether the detections are not more than the allocation allows, a single event apart, which a fault of a satellite may be."""
        return bool(self.n_events < 2 or self.p_detected_low <= self.p_false_alert)

    @property
    def believable(self) -> bool:
        """Whether neither residuals nor detections contradict the model."""
        return self.residuals_fit and self.detections_fit

    @property
    def words(self) -> str:
        """The comparison as sentences; with :data:`DISBELIEF` where the model is contradicted."""
        if not np.isfinite(self.ratio):
            why = "a fault was detected at every epoch" if self.n_detected else "no redundancy"
            return f"The error model could not be compared with residuals: {why}. The protection levels {DISBELIEF}."
        systems = ", ".join(f"{name} {ratio:.2f}" for name, ratio in self.ratio_of_system.items())
        words = [
            f"Squared residuals are {self.ratio:.2f} times what the error model states ({self.ratio_low:.2f} to {self.ratio_high:.2f} from "
            f"{counted(round(self.n_effective), 'independent epoch')}; by constellation {systems}).",
            f"A fault was detected at {self.n_detected} of {counted(self.n_epochs, 'epoch')}, "
            f"{counted(self.n_events, 'separate event')}: "
            f"{self.p_detected_low:.2g} to {self.p_detected_high:.2g} per independent epoch; the allocation allows "
            f"{self.p_false_alert:.2g} without a fault.",
        ]
        if not self.residuals_fit:
            words.append(f"The error model is too small for these ranges: the protection levels {DISBELIEF}.")
        elif not self.detections_fit:
            words.append(f"Either several satellites were in fault or the error model has no tails: the protection levels {DISBELIEF}.")
        elif self.n_events == 1 and self.p_detected_low > self.p_false_alert:
            words.append("The one event is no false alert by the allocation; a satellite may have been in fault.")
        elif self.ratio > 1.0:
            words.append("The error model may be too small for these ranges; so few independent epochs do not decide it.")
        elif self.ratio_high < 1.0:
            words.append("The error model is larger than these residuals.")
        return " ".join(words)


def fit_of(statistic: NDArray[np.float64], redundancy: NDArray[np.float64], decision: NDArray[np.str_], p_false_alert: float) -> Fit:
    """Compare a monitor's epochs with its error model.

    Parameters
    ----------
    statistic, redundancy : ndarray, shape (n, 5)
        Weighted squared residuals and redundancies by constellation in the order of ``gnss.CONSTELLATIONS``; NaN without a position. [1]
    decision : ndarray of str, shape (n,)
        ``none``, or what was excluded (``G05``), or ``not_excluded``; empty where nothing was tested.
    p_false_alert : float
        Allocated risk of a false alert of one epoch. [1]

    Notes
    -----
    A detected fault is no error of the model, so its epochs are left out of the residuals; as false alerts they are too rare to matter,
    and too many of them show in the detections. The mean is worth ``n_effective`` epochs of the file. Its interval takes the scatter of
    the epochs' own statistic, so it needs no distribution of the residuals (ours); the interval of the detections is that of Clopper and
    Pearson (standard), of events: detections of other satellites than before, or further apart than an independent epoch is long.
    """
    tested = (decision != "") & (np.nansum(redundancy, axis=1) > 0.5)
    n, nan = int(tested.sum()), float("nan")
    if n == 0:
        return Fit(nan, nan, nan, {}, 0, 0, 0.0, 0, 0.0, 1.0, p_false_alert)
    quiet = tested & (decision == "none")
    detected = np.flatnonzero((decision != "none")[tested])
    if not quiet.any():
        low, high = exact_interval(1, 1)
        return Fit(nan, nan, nan, {}, n, n, 1.0, 1, low, high, p_false_alert)
    sums, spare = statistic[quiet], redundancy[quiet]
    total, degrees = sums.sum(axis=1), spare.sum(axis=1)
    ratio = float(total.sum() / degrees.sum())
    excess = total - ratio * degrees
    m = excess.size
    n_effective = float(np.clip(effective_size(excess), 1.0, m)) if m > 2 else 1.0
    half = float("inf")
    if n_effective > 2.0:
        half = float(_student_quantile(n_effective - 1.0) * excess.std(ddof=1) / degrees.mean() / np.sqrt(n_effective))
    names = decision[tested][detected]
    apart = (np.diff(detected, prepend=-n) > m / n_effective) | (names != np.roll(names, 1))
    n_events, trials = int(apart.sum()), max(round(n_effective), 1)
    n_events = min(n_events, trials)
    low, high = exact_interval(n_events, trials)
    systems = {name: float(sums[:, k].sum() / spare[:, k].sum()) for k, name in enumerate(CONSTELLATIONS) if spare[:, k].sum() > 0.5}
    return Fit(ratio, max(ratio - half, 0.0), ratio + half, systems, n, int(detected.size), n_effective, n_events, low, high, p_false_alert)


def exact_interval(n_events: int, n_trials: int, risk: float = RISK) -> tuple[float, float]:
    """Exact two-sided interval of a probability by Clopper and Pearson (1934): each side is exceeded with half the risk (standard)."""

    def at_most(k: int, p: float) -> float:
        terms = (_log_choose(n_trials, i) + i * math.log(p) + (n_trials - i) * math.log1p(-p) for i in range(k + 1))
        return math.fsum(map(math.exp, terms))

    def root(k: int, level: float) -> float:
        """The probability at which at most k events are as likely as the level: the sum falls as it grows."""
        low, high = 0.0, 1.0
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if 0.0 < middle < 1.0 and at_most(k, middle) > level else (low, middle)
        return high

    lower = root(n_events - 1, 1.0 - risk / 2) if n_events else 0.0
    return lower, root(n_events, risk / 2) if n_events < n_trials else 1.0


def _log_choose(n: int, k: int) -> float:
    return math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)


def _student_quantile(degrees: float) -> float:
    """Two-sided 95 % quantile of Student's law, Abramowitz and Stegun 26.7.5 (printed); within 2 % from four degrees on."""
    z = _NORMAL_QUANTILE
    terms = (z**3 + z) / 4, (5 * z**5 + 16 * z**3 + 3 * z) / 96, (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384
    return z + sum(term / degrees ** (k + 1) for k, term in enumerate(terms))
