"""Contradictions in published data, in words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True)
class Finding:
    """One contradiction or remark.

    Attributes
    ----------
    line : int
        Line in the file.
    airport, procedure, transition : str
        Where; the transition is empty for the final part.
    sequence : int or None
        The leg.
    kind : str
        ``centre``, ``radius``, ``course``, ``length``, ``rnp_grows``, ``rnp_grows_early``, ``rnp_and_level``, ``rnp_too_large``,
        ``rnp_missing``, ``height``, ``unresolved``, ``not_whole`` or ``missing``.
    remark : bool
        Whether no two records contradict each other.
    published, expected : float
        What the file has, and what the other records, the fixes or the record numbers have, both in `unit`.
    unit : str
        ``m``, ``rad``, or ``1`` for numbers of records.
    words : str
        The same as a sentence.
    """

    line: int
    airport: str
    procedure: str
    transition: str
    sequence: int | None
    kind: str
    remark: bool
    published: float
    expected: float
    unit: str
    words: str

    @property
    def where(self) -> str:
        """``KAUS/H18RZ/SMRFF/60``."""
        return f"{self.airport}/{self.procedure}/{self.transition}/{'' if self.sequence is None else self.sequence}"


def finding(row: dict[str, Any]) -> Finding:
    """A finding from the core's row."""
    words = _WORDS[row["kind"]](row["published"], row["expected"])
    return Finding(**row, unit=_UNITS.get(row["kind"], "m"), words=words)


def _rnp(m: float) -> str:
    return f"RNP {m / METRES_PER_NM:.3g}"


def _course(published: float, expected: float) -> str:
    off = abs((published - expected + math.pi) % math.tau - math.pi)
    return f"coded course {math.degrees(published):.1f}° true, the fixes give {math.degrees(expected):.1f}°: {math.degrees(off):.1f}° apart"


_UNITS = {"course": "rad", "missing": "1"}

_WORDS: dict[str, Callable[[float, float], str]] = {
    "centre": lambda p, e: (
        f"the fixes are {p:.1f} m and {e:.1f} m from the published centre: no circle; it moves by at least {abs(p - e) / 2:.1f} m"
    ),
    "radius": lambda p, e: f"coded radius {p / METRES_PER_NM:.3f} NM, the fixes give {e / METRES_PER_NM:.3f} NM: {abs(p - e):.1f} m apart",
    "course": _course,
    "length": lambda p, e: f"coded length {p / METRES_PER_NM:.1f} NM, the fixes give {e / METRES_PER_NM:.2f} NM",
    "rnp_grows": lambda p, e: f"{_rnp(p)} after {_rnp(e)}: it grows towards the runway",
    "rnp_grows_early": lambda p, e: f"{_rnp(p)} after {_rnp(e)} inside a transition",
    "rnp_and_level": lambda p, e: f"the leg has {_rnp(p)}, the nearest line of minima {_rnp(e)}: a factor of {max(p / e, e / p):.0f}",
    "rnp_too_large": lambda p, e: f"{_rnp(p)}; no specification of such a procedure has more than {_rnp(e)}",
    "rnp_missing": lambda _, e: f"no RNP on the last leg of the final approach; the first line of minima is {_rnp(e)}",
    "height": lambda p, e: f"threshold of the path point {p:.1f} m above mean sea level, of the runway record {e:.1f} m",
    "unresolved": lambda _p, _e: "a fix, centre or navaid that the leg needs is not in the file, or stands there twice",
    "not_whole": lambda _p, _e: "this line is refused, so the route is not whole",
    "missing": lambda _, e: f"records missing before this line, by the record numbers: {e:.0f}",
}
