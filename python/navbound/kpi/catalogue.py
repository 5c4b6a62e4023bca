"""Service levels by their names; public in `navbound.kpi`."""

from __future__ import annotations

import re
from collections.abc import Sequence

from navbound.errors import InputError, NotFoundError
from navbound.kpi import records
from navbound.records.performance import Level
from navbound.table.arguments import checked
from navbound.units import METRES_PER_NM

RNP_TTA_S = 10.0
"""Time to alert of a level that is named by its RNP value: that of non-precision approach, inferred. [s]"""


def levels() -> dict[str, Level]:
    """Every service level by its name, with limits, demands, source and provenance."""
    return {level.id: level for level in records.table_of_levels()}


@checked
def level(wanted: str | Level) -> Level:
    """A level by its name, or the RNP value as horizontal limit where the name is ``RNP 0.3`` or the like.

    Raises
    ------
    InputError
        No such level; the message lists those that exist.
    """
    if isinstance(wanted, Level):
        return wanted
    known = levels()
    if wanted in known:
        return known[wanted]
    value = re.fullmatch(r"RNP (\d+(?:\.\d+)?)", wanted.strip(), re.IGNORECASE)
    if value is None:
        raise NotFoundError("levels", wanted, "service level", known, "or RNP x with x in NM")
    required = rnp(float(value.group(1)), tta_s=RNP_TTA_S)
    source = "alert limit inferred from the RNP value; time to alert that of non-precision approach"
    return required.model_copy(update={"source": source, "provenance": {"hal_m": "inferred", "tta_s": "inferred"}})


@checked
def rnp(rnp_nm: float, *, tta_s: float, containment: int = 1) -> Level:
    """A level whose horizontal limit is an RNP value. That the limit is the RNP value is inferred, and marked so.

    Parameters
    ----------
    rnp_nm : float
        RNP value. [NM]
    tta_s : float
        Time to alert of the operation. [s]
    containment : {1, 2}
        The limit as a multiple of the RNP value.

    Raises
    ------
    InputError
        A value that is not positive, or another multiple.
    """
    for name, value, unit in (("rnp_nm", rnp_nm, "NM"), ("tta_s", tta_s, "s")):
        if not 0 < value < float("inf"):
            raise InputError(name, value, unit, "(0, inf)")
    if containment not in {1, 2}:
        raise InputError("containment", containment, "1", "{1, 2}")
    name = f"RNP {rnp_nm:g}"
    return Level(
        id=name if containment == 1 else f"{name} x 2",
        title=f"{name}, alert limit {containment} x RNP",
        hal_m=containment * rnp_nm * METRES_PER_NM,
        val_m=None,
        accuracy_h_m=None,
        accuracy_v_m=None,
        tta_s=tta_s,
        integrity_risk=None,
        integrity_per=None,
        continuity_risk=None,
        continuity_per=None,
        source="alert limit inferred from the RNP value; time to alert given by the caller",
        provenance={"hal_m": "inferred", "tta_s": "ours"},
    )


def selected_levels(named: str | Level | Sequence[str | Level]) -> list[Level]:
    """One level or more, each once; names may be joined by commas."""
    levels = [named] if isinstance(named, (str, Level)) else list(named)
    names = [part for item in levels for part in ([p.strip() for p in item.split(",")] if isinstance(item, str) else [item])]
    required = [level(name) for name in names if name != ""]
    if not required:
        raise InputError("levels", "nothing", domain="one level or more")
    for index, each in enumerate(required):
        if any(each.id == other.id for other in required[:index]):
            raise InputError("levels", each.id, domain="levels named once")
    return required
