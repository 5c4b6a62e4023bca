"""Total system error: bounds of the error across and above the path, one epoch or millions.

The flight technical error is known at each epoch and the navigation error is normal, so the error across the path is normal with a known
mean. Every function takes the allowed risk (0.05, 1e-5), never the probability, and broadcasts over leading axes. A number that is not
finite, or outside its domain, is refused with an :class:`~navbound.errors.InputError` that names its flat index.

Sources: Fu, Zhang, Li 2014 (equations cited as F-n); docs/methods/tse.md says which we derived again and why.
"""

from __future__ import annotations

from navbound.tse.explained import Explanation, Rotated, explain, ltem_as_printed, rotated_frame
from navbound.tse.extended import (
    Box,
    RandomFte,
    Vertical,
    box,
    box_risk,
    mixture,
    paired_overbound,
    random_fte,
    rf_fte,
    student_t,
    vertical,
)
from navbound.tse.lateral import (
    Exact,
    Factors,
    Projection,
    ctem,
    ctem_foot,
    exact,
    exceedance_risk,
    factors,
    log_exceedance_risk,
    ltem,
    project,
    rssm,
    sqsm,
)
from navbound.tse.margins import Gradient, fte_budget, gradient, margin, sigma_budget

__all__ = [
    "Box",
    "Exact",
    "Explanation",
    "Factors",
    "Gradient",
    "Projection",
    "RandomFte",
    "Rotated",
    "Vertical",
    "box",
    "box_risk",
    "ctem",
    "ctem_foot",
    "exact",
    "exceedance_risk",
    "explain",
    "factors",
    "fte_budget",
    "gradient",
    "log_exceedance_risk",
    "ltem",
    "ltem_as_printed",
    "margin",
    "mixture",
    "paired_overbound",
    "project",
    "random_fte",
    "rf_fte",
    "rotated_frame",
    "rssm",
    "sigma_budget",
    "sqsm",
    "student_t",
    "vertical",
]
