"""Which constellation's ranges contradict the others, where most positions of a file cannot be vouched for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.gnss.receivers import SYSTEMS

if TYPE_CHECKING:
    from collections.abc import Callable

    from navbound.gnss.receivers import Positions

_RESIDUALS = ("residuals_contradict", "recent_residuals_contradict", "constellations_contradict", "exclusion_unconfirmed")
"""Reasons that ranges which do not agree give an epoch."""
_MOST = 0.25
"""A larger share of the solved epochs with such a reason is worth a search. Provenance: ours. [1]"""
_REMAINS = 0.25
"""At most this part of it must remain without a constellation for it to be the one. Provenance: ours. [1]"""


def contradicting(solution: Positions, solve: Callable[[str], Positions]) -> list[str]:
    """What a person can do where one constellation contradicts the others; empty where none does, or nothing is wrong.

    The positions are solved again without each constellation; none is taken away unasked.

    Parameters
    ----------
    solution : Positions
        Of all constellations.
    solve : callable
        Gives the positions of the letters that it is handed.
    """
    letters = [letter for letter, codes in solution.codes.items() if codes]
    share, _ = _shares(solution)
    if len(letters) < 2 or share <= _MOST:
        return []
    without = {letter: _shares(solve("".join(each for each in letters if each != letter))) for letter in letters}
    # Where nothing is ok without it, nothing was tested: ranges without one to spare contradict nobody.
    settling = [letter for letter in letters if without[letter][0] <= _REMAINS * share and without[letter][1] > 0.0]
    if not settling:
        return []
    seen = f"the residuals speak against {share:.0%} of the solved epochs"
    if len(settling) > 1:
        names = " and ".join(SYSTEMS[letter] for letter in settling)
        return [f"The ranges of {names} contradict each other: {seen}, and each fits without the other; nothing says which is wrong"]
    remaining, ok = without[settling[0]]
    others = "".join(each for each in letters if each != settling[0])
    return [
        f"The ranges of {SYSTEMS[settling[0]]} contradict the others: {seen}, and against {remaining:.0%} without it,"
        f" where {ok:.0%} are ok; --systems {others} leaves it out"
    ]


def _shares(solution: Positions) -> tuple[float, float]:
    """Of the solved epochs: those with a reason of contradicting ranges, and those with status ok; all are contradicted where none is."""
    solved = solution.epochs.filter(solution.epochs["est_lat_rad"].is_not_null())
    if solved.is_empty():
        return 1.0, 0.0
    return float(solved["reason_id"].is_in(_RESIDUALS).fill_null(value=False).mean()), float((solved["status"] == "ok").mean())  # type: ignore[arg-type]
