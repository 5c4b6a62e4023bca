"""Satellites fail: the probability of a leg without a hole as a mixture over the satellites that are out of service."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

from navbound.run.expected.table import levels

if TYPE_CHECKING:
    import polars as pl

    from navbound.run.expected.setup import Setup


def without_hole(setup: Setup, rows: pl.DataFrame, spans: list[tuple[float, float]]) -> tuple[list[float] | None, float | None]:
    """Probability of no hole on each leg, and that of more satellites out than were worked out.

    ``sum over sets of P(set) [no hole in the set]``, each satellite out with the same probability, for itself. Sets larger than the plan's
    ``outages`` count as a hole, so the sum is a lower bound.

    Parameters
    ----------
    setup : Setup
        The plan.
    rows : DataFrame
        Rows that are shown.
    spans : list of (float, float)
        Begin and end of every leg. [s]
    """
    q, most = setup.plan.equipment.satellite_outage_probability, setup.plan.equipment.outages
    if q == 0.0:
        return None, None
    names = [s for s in setup.orbits.satellite if s[0] in setup.systems()]
    totals = [0.0] * len(spans)
    examined = 0.0
    for size in range(most + 1):
        p = q**size * (1.0 - q) ** (len(names) - size)
        examined += p * math.comb(len(names), size)
        for out in itertools.combinations(names, size):
            hpl = levels(setup, rows, without=frozenset(out))["hpl_m"].to_list()
            # A leg without an RNP has no probability: the caller leaves it out.
            good = [level <= rnp for level, rnp in zip(hpl, rows["rnp_m"], strict=True)]
            for k, (begin, end) in enumerate(spans):
                if all(g for g, t in zip(good, rows["time_s"], strict=True) if begin <= t < end):
                    totals[k] += p
    return totals, max(0.0, 1.0 - examined)
