"""What a map is worked out from: satellites and instants, a service's messages, stations on the ground."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field
from functools import lru_cache, reduce
from operator import add
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navbound import gnss
from navbound.errors import FormatError, InputError
from navbound.time import utc_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

NS = 1_000_000_000
ALMANAC_AGE_S = 7 * 86_400
"""An almanac farther from the day of the map is that of another week. [s]"""
MOST_INSTANTS = 100_000


@dataclass(frozen=True)
class Times:
    """Instants of a map.

    Attributes
    ----------
    start_ns : int, optional
        GPS time of the first; None for a day of nominal orbits, which belongs to no date. [ns]
    duration_s, step_s : float
        Length and step; the last instant is before the end. [s]
    """

    start_ns: int | None = None
    duration_s: float = 86_400.0
    step_s: float = 300.0

    def __post_init__(self) -> None:
        if not (self.step_s > 0 and math.isfinite(self.step_s)):
            raise InputError("step_s", self.step_s, "s", "(0, inf)")
        if not self.step_s <= self.duration_s <= MOST_INSTANTS * self.step_s:
            raise InputError("duration_s", self.duration_s, "s", f"[step_s, {MOST_INSTANTS} step_s]")

    def offsets_s(self) -> NDArray[np.float64]:
        """Since the first instant. [s]."""
        return np.asarray(np.arange(math.ceil(self.duration_s / self.step_s - 1e-9)) * self.step_s, dtype=np.float64)


@dataclass(frozen=True)
class Satellites:
    """Orbits and instants, seconds from the orbits' reference instant."""

    orbits: gnss.Orbits
    time_s: NDArray[np.float64]
    mask_rad: float
    h_m: float


def satellites(constellation: Sequence[str | Path], times: Times, mask_rad: float, h_m: float) -> Satellites:
    """Satellites of nominal constellations or almanacs at the instants of a map.

    Raises
    ------
    InputError
        No constellation, nominal orbits for a date, several almanacs of different instants, an almanac of another week, a mask outside
        [0, pi/2), a height that is not finite.
    FormatError
        A file that is no almanac.
    """
    if not constellation:
        raise InputError("constellation", "none", domain="at least one name or almanac")
    if not 0 <= mask_rad < math.pi / 2:
        raise InputError("mask_rad", mask_rad, "rad", "[0, pi/2)")
    if not math.isfinite(h_m):
        raise InputError("h_m", h_m, "m", "(-inf, inf)")
    parts = [gnss.constellation(name, near_ns=times.start_ns) for name in constellation]
    references = {part.reference_ns for part in parts}
    if len(references) > 1:
        raise InputError("constellation", ", ".join(map(str, constellation)), domain="nominal ones, or files of one reference instant")
    orbits = reduce(add, parts)
    since = 0.0
    if times.start_ns is not None:
        if orbits.reference_ns is None:
            raise InputError("start_ns", times.start_ns, "ns", "none with nominal orbits: they belong to no date")
        since = (times.start_ns - orbits.reference_ns) / NS
        if abs(since) > ALMANAC_AGE_S:
            days = since / 86_400
            of = f"{utc_text(orbits.reference_ns)} UTC, {abs(days):.1f} days {'before' if days > 0 else 'after'} it"
            why = "a week number of ten bits is read as the nearest to the day asked"
            raise InputError("start_ns", times.start_ns, "ns", f"a day within a week of the almanac, which is of {of}; {why}")
    return Satellites(orbits, since + times.offsets_s(), mask_rad, h_m)


@dataclass(frozen=True)
class File:
    """A file as part of a job: its place, and a digest that makes a changed file another job."""

    path: str
    sha256: str = field(default="")

    @classmethod
    def of(cls, path: str | Path) -> File:
        """From a path.

        Raises
        ------
        FormatError
            It cannot be read.
        """
        try:
            content = Path(path).read_bytes()
        except OSError as e:
            raise FormatError(path, e.strerror or str(e)) from e
        return cls(str(Path(path).resolve()), hashlib.sha256(content).hexdigest())


@lru_cache(maxsize=2)
def messages(path: str, _sha256: str, prn: int | None) -> object:
    """Messages of one satellite, read once a process."""
    from navbound import sbas  # noqa: PLC0415

    found = sbas.read(path)
    return found if prn is None else found.of(prn)
