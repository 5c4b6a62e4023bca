"""How each method did."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import evaluation
from navbound.methods import column_of, method
from navbound.records.run import MethodResult
from navbound.run.summary.consistency import codes

if TYPE_CHECKING:
    from numpy.typing import NDArray


_SCORES = ("coverage", "coverage_low", "coverage_high", "n_effective", "winkler_m", "pinball_m")


def method_result(method_id: str, risk: float, known: NDArray[np.float64], scored: dict[str, float | None] | None = None) -> MethodResult:
    """A method at one risk: what it is, and its bounds where there are any."""
    m = method(method_id)
    described = {
        "id": m.id,
        "title": m.title,
        "source": m.source,
        "provenance": m.provenance,
        "assumes": m.assumes,
        "error_column": m.error_column,
        "may_alert": m.may_alert,
        "risk": risk,
        "n": len(known),
        "mean_m": float(known.mean()) if len(known) else None,
        "max_m": float(known.max()) if len(known) else None,
    }
    return MethodResult.model_validate(described | (scored or dict.fromkeys(_SCORES)))


def evaluated(epochs: pl.DataFrame, method_id: str, risk: float, coverage_kind: str, *, integrity: bool) -> MethodResult:
    """How one method did at one risk, over epochs that carry its bound."""
    m = method(method_id)
    bound = column_of(epochs, m.integrity_column if integrity else m.column)
    known = np.isfinite(bound)
    scored: dict[str, float | None] = dict.fromkeys(_SCORES)
    if m.error_column in epochs.columns:
        error = np.abs(column_of(epochs, m.error_column))
        both = known & np.isfinite(error)
        if both.any():
            score = evaluation.bound(error[both], bound[both], risk, track=codes(epochs)[both], coverage_kind=coverage_kind)
            scored = {
                "coverage": score.coverage,
                "coverage_low": score.coverage_low,
                "coverage_high": score.coverage_high,
                "n_effective": score.n_effective,
                "winkler_m": score.winkler_m,
                "pinball_m": score.pinball_m,
            }
    return method_result(method_id, risk, bound[known], scored)
