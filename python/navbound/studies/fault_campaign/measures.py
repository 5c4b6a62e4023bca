"""What a flight with a fault says of the status and the alert: counts of one run."""

from __future__ import annotations

from dataclasses import dataclass
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


@dataclass(frozen=True)
class Outcome:
    """What the navigation said at each epoch, and how wrong it was.

    Attributes
    ----------
    since_s : ndarray, shape (n,)
        Time since the begin. [s]
    period_s : float
        Of the epochs. [s]
    ok : ndarray of bool, shape (n,)
        The status is ``ok``.
    error_h_m, error_u_m : ndarray, shape (n,)
        Horizontal error and size of the vertical one. [m]
    horizontal_m, vertical_m : ndarray, shape (n,)
        The bounds that the position promises. [m]
    reasons : list of str, length n
        Ids of reasons, with blanks between.
    """

    since_s: Floats
    period_s: float
    ok: Flags
    error_h_m: Floats
    error_u_m: Floats
    horizontal_m: Floats
    vertical_m: Floats
    reasons: list[str]

    @property
    def wrong(self) -> Flags:
        """Not known to be inside the bounds: an error that is not known is outside."""
        wrong: Flags = ~((self.error_h_m <= self.horizontal_m) & (self.error_u_m <= self.vertical_m))
        return wrong

    def counted(self, onset_s: float, judged: Flags | None = None) -> dict[str, float | str]:
        """Counts of the status; those of alerts are nought. Epochs outside ``judged`` are not counted."""
        judged = np.ones(self.ok.size, dtype=bool) if judged is None else judged
        after = judged & (self.since_s >= onset_s)
        before = judged & (self.since_s < onset_s) & (self.since_s >= SETTLED_S)
        left, good = np.flatnonzero(after & ~self.ok), after & self.ok & np.isfinite(self.error_h_m)
        counts: dict[str, float | str] = dict.fromkeys(COUNTS, 0.0)
        return counts | {
            "n_epochs": float(after.sum()),
            "n_ok": float((after & self.ok).sum()),
            "n_ok_wrong": float((after & self.ok & self.wrong).sum()),
            "healthy_s": float(before.sum()) * self.period_s,
            "healthy_not_ok_s": float((before & ~self.ok).sum()) * self.period_s,
            "delay_s": float(self.since_s[left[0]] - onset_s) if left.size else float("nan"),
            "error_most_m": float(self.error_h_m[good].max()) if good.any() else 0.0,
            "reasons": "|".join(sorted({reason for k in left for reason in self.reasons[k].split()})),
        }


def promised(covariance_m2: Floats, hpl_m: Floats, vpl_m: Floats) -> tuple[Floats, Floats]:
    """The bounds that positions promise, horizontal and vertical [m]: their levels, or where there are none those of their covariance.

    Covariances east, north, up, shape (n, 3, 3) [m²]; NaN where there is neither.
    """
    plane, up = covariance_m2[:, :2, :2], covariance_m2[:, 2, 2]
    known = np.isfinite(plane).all((1, 2)) & np.isfinite(up) & (plane[:, 0, 0] * plane[:, 1, 1] - plane[:, 0, 1] ** 2 > 0) & (up > 0)
    horizontal, vertical = np.full(up.shape, np.nan), np.full(up.shape, np.nan)
    if known.any():
        horizontal[known] = anp.circle(plane[known], RISK)
        vertical[known] = float(anp.chi_factor(1, RISK)) * np.sqrt(up[known])
    return np.where(np.isfinite(hpl_m), hpl_m, horizontal), np.where(np.isfinite(vpl_m), vpl_m, vertical)


def _outcome(frame: pl.DataFrame) -> Outcome:
    """An outcome of the judged epochs of a flight, a second apart."""
    ee, en, nn, uu = (column_of(frame, f"cov_{axis}_m2") for axis in ("ee", "en", "nn", "uu"))
    zero, missing = np.zeros(ee.shape), np.full(ee.shape, np.nan)
    covariance = np.moveaxis(np.array([[ee, en, zero], [en, nn, zero], [zero, zero, uu]]), 2, 0)
    horizontal, vertical = promised(covariance, *(column_of(frame, c) if c in frame.columns else missing for c in ("hpl_m", "vpl_m")))
    column = "nav_reasons" if "nav_reasons" in frame.columns else "reason"
    return Outcome(
        since_s=(frame["time_ns"].to_numpy() - int(frame["time_ns"][0])) * 1e-9,
        period_s=1.0,
        ok=frame["status"].to_numpy() == "ok",
        error_h_m=column_of(frame, "nse_h_m"),
        error_u_m=np.abs(column_of(frame, "nse_u_m")),
        horizontal_m=horizontal,
        vertical_m=vertical,
        reasons=[str(cell or "") for cell in frame[column]],
    )


def measures(frame: pl.DataFrame, onset_s: float) -> dict[str, float | str]:
    """Counts of one judged flight whose fault begins at a time after its begin [s]."""
    outcome = _outcome(frame)
    since, normal = outcome.since_s, frame["alert"].to_numpy() == "normal"
    late = _lasting(np.abs(column_of(frame, "tse_m")) > column_of(frame, "rnp_m"), since) > TIME_TO_ALERT_S
    after, before = since >= onset_s, (since < onset_s) & (since >= SETTLED_S)
    raised = ~normal & np.append(False, normal[:-1])
    return outcome.counted(onset_s) | {
        "n_normal": float((after & normal).sum()),
        "n_normal_wrong": float((after & normal & outcome.wrong).sum()),
        "n_late": float((after & normal & late).sum()),
        "n_false_alerts": float((before & raised).sum()),
    }


def _lasting(outside: Flags, since_s: Floats) -> Floats:
    """How long each epoch has been outside without a break [s]; negative inside."""
    inside = np.where(outside, -np.inf, since_s)
    last = np.maximum.accumulate(inside)
    begin = np.where(np.isfinite(last), last, since_s[0])
    lasting: Floats = np.where(outside, since_s - begin, -1.0)
    return lasting
