"""How each method did."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound.evaluation.pieces import Bounds
from navbound.methods import column_of, method
from navbound.records.run import MethodResult
from navbound.storage.tables import Places, numbers, pieces

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from navbound.records.run import Belief
    from navbound.storage.tables import Table


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


def of_belief(results: Sequence[MethodResult], belief: Belief | None) -> list[MethodResult]:
    """The results with the interval that the verdict rests on, where it has checked the same epochs: a share has one interval in a run."""
    checks = {} if belief is None else {(each.method, each.risk, each.n): each for each in (*belief.bounds, *belief.beside)}
    return [
        result
        if (check := checks.get((result.id, result.risk, result.n))) is None or check.coverage != result.coverage
        else result.model_copy(update={name: getattr(check, name) for name in ("coverage_low", "coverage_high", "n_effective")})
        for result in results
    ]


def evaluated(epochs: Table, method_id: str, risk: float, *, integrity: bool) -> MethodResult:
    """How one method did at one risk, over epochs that carry its bound."""
    m = method(method_id)
    bound = m.integrity_column if integrity else m.column
    scored: dict[str, float | None] = dict.fromkeys(_SCORES)
    if m.error_column in epochs.columns:
        bounds, places = Bounds(), Places()
        for piece in pieces(epochs, ["track", m.error_column, bound]):
            track = places.of(piece["track"])
            limit, error = column_of(piece, bound), np.abs(column_of(piece, m.error_column))
            both = np.isfinite(limit) & np.isfinite(error)
            bounds.see(error[both], limit[both], track[both])
        if bounds.n:
            score = bounds.score(risk)
            scored = {name: score[name] for name in _SCORES}
        # The series of the errors is given back before the column of the bounds is read.
        del bounds
    return method_result(method_id, risk, numbers(epochs, bound), scored)
