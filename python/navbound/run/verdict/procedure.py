"""What a procedure does not judge of a recording, for the first sentence of a verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.run.verdict.numbers import length
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from navbound.records.procedure import BesideProcedure

_BESIDE = {
    "off_path": "off the path",
    "not_established": "not established",
    "outside": "before the begin or beyond the end",
    "transition": "in fly-by turns",
    "holding": "beside a hold",
    "missing": "without a position",
}


def beside_procedure_words(beside: BesideProcedure | None) -> str:
    """Where flights end before the end of the procedure, and how many recorded positions are no part of a flight along it."""
    if beside is None:
        return ""
    n = sum(beside.n_status.values())
    kinds = ", ".join(f"{count} {_BESIDE.get(status, status)}" for status, count in beside.n_status.items())
    apart = (
        f"; {n} of {counted(beside.n_recorded, 'recorded position')} {agreeing(n, 'is', 'are')} no part of this and "
        f"{agreeing(n, 'is', 'are')} not judged ({kinds})"
        if n
        else ""
    )
    return f"{_late(beside)}{_short(beside)}{apart}"


def _late(beside: BesideProcedure) -> str:
    if beside.begin_m is None:
        return ""
    return f"; judged on a part of the procedure alone, from {length(beside.begin_m)} after its begin on"


def _short(beside: BesideProcedure) -> str:
    if not beside.n_short:
        return ""
    what = "leaves the path" if beside.short == "leaves" else "ends"
    where = f"{'' if beside.short_m is None else f'{length(beside.short_m)} '}before the end of the procedure"
    if beside.n_short == 1:
        return f"; the track {what} {where}"
    return (
        f"; {counted(beside.n_short, 'flight ends or leaves', 'flights end or leave')} the path before the end of the procedure, "
        f"the earliest {what} {where}"
    )


def incomplete_words(beside: BesideProcedure | None) -> list[str]:
    """That the legs may not be the whole procedure; nothing where nothing says so."""
    if beside is None or not beside.doubts:
        return []
    return [f"The procedure may not be whole in its database: {' '.join(beside.doubts)}"]
