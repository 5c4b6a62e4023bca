"""The usual step of recorded epochs, where some of them are absent, and the silence after which nothing is known."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from navbound.rnp.exposure import LONGEST_STEP_S

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

USUAL = 0.25
"""The usual step is the shortest that is at least this share of the steps of at most two seconds, to the millisecond: a table without every
other or third row has two, and a receiver whose steps wander has none. Provenance: ours. [1]"""
RESOLVED_MS = 10
"""A shorter usual step is not known well enough from milliseconds: stamps of 600 in a second are 1 and 2 ms apart. Provenance: ours."""
WHOLE = 0.1
"""Times of absent epochs are whole steps apart to this share of one: transponders wander between 0.4 and 0.6 s. Provenance: ours. [1]"""
_LONGEST_MS = 2000
"""Steps beyond it are those of sources that speak now and then. [ms]"""
_AT_ONCE = 1 << 18
"""Steps that are counted at once. [1]"""
_MOST = 3
"""Usual steps in the median one: beyond it a receiver that speaks in bursts is as likely. Provenance: ours. [1]"""


def usual_ms(n_of_steps: Mapping[int, int], *, of: int | None = None) -> int:
    """The usual step; 0 where no step is usual. [ms].

    Parameters
    ----------
    n_of_steps : mapping
        How many steps have a length. [ms]
    of : int, optional
        Steps of which it has a share. Default: those of `n_of_steps`.
    """
    n = sum(n_of_steps.values()) if of is None else of
    usual = min((ms for ms, count in n_of_steps.items() if count >= USUAL * n), default=0)
    return usual if usual >= RESOLVED_MS else 0


def absent_in(steps: float) -> int:
    """Epochs that a step of so many usual ones leaves room for; 0 where it is no whole number of them."""
    return round(steps) - 1 if abs(steps - round(steps)) <= WHOLE else 0


def period_s(steps_ns: NDArray[np.int64]) -> float:
    """The period of a receiver by the steps between its epochs; 1 s where there are none. [s].

    It is the median of the steps, or the usual step where that is a half or a third of it: of a receiver that lost nearly half of its
    positions the median is the step across a lost one. The steps are put in another order.
    """
    n_of_steps = Counter[int]()
    for begin in range(0, steps_ns.size, _AT_ONCE):
        short_ms = np.rint(steps_ns[begin : begin + _AT_ONCE] * 1e-6)
        lengths_ms, counts = np.unique(short_ms[(short_ms > 0) & (short_ms <= _LONGEST_MS)], return_counts=True)
        n_of_steps.update(dict(zip(lengths_ms.astype(int).tolist(), counts.tolist(), strict=True)))
    # A copy of the steps of a large table is not made.
    median_s = float(np.median(steps_ns, overwrite_input=True)) * 1e-9 if steps_ns.size else 0.0
    if not median_s > 0:
        return 1.0
    usual = usual_ms(n_of_steps, of=steps_ns.size)
    steps = median_s * 1e3 / usual if usual else 0.0
    return usual * 1e-3 if 0 < absent_in(steps) < _MOST else median_s


def breaks(times_ns: NDArray[np.int64]) -> NDArray[np.intp]:
    """Epochs of a recording, in the order of time, after which so much time passes that nothing is known before the next one."""
    steps_ns = np.diff(times_ns)
    return np.flatnonzero(steps_ns > 1e9 * stale_after_s(period_s(steps_ns.copy())))


def stale_after_s(of_period_s: float) -> float:
    """Time after an epoch of a recording from which the monitor has nothing. [s]."""
    from navbound.rnp import Monitor  # noqa: PLC0415  (which imports the modules of this folder)

    return Monitor(sample_period_s=min(of_period_s, LONGEST_STEP_S), time_to_alert_s=math.inf).stale_after_s
