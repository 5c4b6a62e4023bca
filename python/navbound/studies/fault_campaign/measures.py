"""What a flight with a fault says of the status and the alert: counts of one run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import anp
from navbound.methods import column_of

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Flags = NDArray[np.bool_]

RISK = 1e-5
"""Of the bound that an epoch called good promises."""
TIME_TO_ALERT_S = 10.0
"""Time for which an error may be outside RNP before an alert is late: en route. [s]"""
SETTLED_S = 30.0
"""Seconds after the begin of a flight in which the filter settles and nothing counts as a false alert. [s]"""

COUNTS = (
    "n_epochs",
    "n_ok",
    "n_ok_wrong",
    "n_normal",
    "n_normal_wrong",
    "n_late",
    "healthy_s",
    "n_false_alerts",
    "healthy_not_ok_s",
)
"""Columns of counts; with them come ``delay_s``, ``error_most_m`` and ``reasons``."""


def levels(frame: pl.DataFrame) -> tuple[Floats, Floats]:
    """The bounds that the position promises, horizontal and vertical [m]: its levels, or where it has none those of its covariance."""
    ee, en, nn, uu = (column_of(frame, f"cov_{axis}_m2") for axis in ("ee", "en", "nn", "uu"))
    known = np.isfinite(ee) & np.isfinite(uu) & (ee * nn - en * en > 0) & (uu > 0)
    horizontal, vertical = np.full(ee.shape, np.nan), np.full(ee.shape, np.nan)
    if known.any():
        pairs = np.moveaxis(np.array([[ee, en], [en, nn]]), 2, 0)[known]
        horizontal[known] = anp.circle(pairs, RISK)
        vertical[known] = float(anp.chi_factor(1, RISK)) * np.sqrt(uu[known])
    for name, values in (("hpl_m", horizontal), ("vpl_m", vertical)):
        if name in frame.columns:
            own = column_of(frame, name)
            values[np.isfinite(own)] = own[np.isfinite(own)]
    return horizontal, vertical


def measures(frame: pl.DataFrame, onset_s: float) -> dict[str, float | str]:
    """Counts of one judged flight whose fault begins at a time after its begin [s]."""
    since = (frame["time_ns"].to_numpy() - int(frame["time_ns"][0])) * 1e-9
    after = since >= onset_s
    ok, normal = frame["status"].to_numpy() == "ok", frame["alert"].to_numpy() == "normal"
    horizontal, vertical = levels(frame)
    error_h, error_u = column_of(frame, "nse_h_m"), np.abs(column_of(frame, "nse_u_m"))
    # An error that is not known to be inside is outside.
    wrong = ~((error_h <= horizontal) & (error_u <= vertical))
    late = _lasting(np.abs(column_of(frame, "tse_m")) > column_of(frame, "rnp_m"), since) > TIME_TO_ALERT_S
    before = ~after & (since >= SETTLED_S)
    raised = ~normal & np.append(False, normal[:-1])
    first = np.flatnonzero(after & ~ok)
    column = "nav_reasons" if "nav_reasons" in frame.columns else "reason"
    told = sorted({reason for cell in frame.filter(after & ~ok)[column].drop_nulls().unique() for reason in str(cell).split()})
    good = after & ok & np.isfinite(error_h)
    return {
        "n_epochs": float(after.sum()),
        "n_ok": float((after & ok).sum()),
        "n_ok_wrong": float((after & ok & wrong).sum()),
        "n_normal": float((after & normal).sum()),
        "n_normal_wrong": float((after & normal & wrong).sum()),
        "n_late": float((after & normal & late).sum()),
        "healthy_s": float(before.sum()),
        "n_false_alerts": float((before & raised).sum()),
        "healthy_not_ok_s": float((before & ~ok).sum()),
        "delay_s": float(since[first[0]] - onset_s) if first.size else float("nan"),
        "error_most_m": float(error_h[good].max()) if good.any() else 0.0,
        "reasons": "|".join(told),
    }


def _lasting(outside: Flags, since_s: Floats) -> Floats:
    """How long each epoch has been outside without a break [s]; negative inside."""
    inside = np.where(outside, -np.inf, since_s)
    last = np.maximum.accumulate(inside)
    begin = np.where(np.isfinite(last), last, since_s[0])
    lasting: Floats = np.where(outside, since_s - begin, -1.0)
    return lasting
