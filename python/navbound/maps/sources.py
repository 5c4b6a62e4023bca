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

from navbound import gnss, sbas
from navbound.errors import ConflictError, FormatError, InputError
from navbound.time import utc_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

NS = 1_000_000_000
DAY_S = 86_400.0
ALMANAC_AGE_S = 7 * 86_400
"""An almanac farther from the day of the map is that of another week. [s]"""
MOST_INSTANTS = 100_000


@dataclass(frozen=True)
class Times:
    """Instants of a map.

    Attributes
    ----------
    start_ns : int, optional
        GPS time of the first; None for what the kind begins with: a day of nominal orbits belongs to no date. [ns]
    duration_s : float, optional
        Length; the last instant is before the end. Without it a day of orbits, or to the end of a log. [s]
    step_s : float
        Step. [s]
    """

    start_ns: int | None = None
    duration_s: float | None = None
    step_s: float = 300.0

    def __post_init__(self) -> None:
        if not (self.step_s > 0 and math.isfinite(self.step_s)):
            raise InputError("step_s", self.step_s, "s", "(0, inf)")
        if self.duration_s is not None:
            self._within(self.duration_s)

    def _within(self, duration_s: float) -> float:
        if not self.step_s <= duration_s <= MOST_INSTANTS * self.step_s:
            raise InputError("duration_s", duration_s, "s", f"[step_s, {MOST_INSTANTS} step_s]")
        return duration_s

    def length_s(self, usual_s: float = DAY_S) -> float:
        """The duration, or the usual one where none was requested. [s]."""
        return self._within(usual_s) if self.duration_s is None else self.duration_s

    def offsets_s(self, usual_s: float = DAY_S) -> NDArray[np.float64]:
        """Since the first instant. [s]."""
        return np.asarray(np.arange(math.ceil(self.length_s(usual_s) / self.step_s - 1e-9)) * self.step_s, dtype=np.float64)

    def words(self, n: int, first_ns: int | None) -> str:
        """How many, how far apart, and from when where there is a date."""
        since = "" if first_ns is None else f", from {utc_text(first_ns)} UTC on"
        return f"{n} instants, {self.step_s:g} s apart{since}."


@dataclass(frozen=True)
class Satellites:
    """Orbits and instants, seconds from the orbits' reference instant."""

    orbits: gnss.Orbits
    time_s: NDArray[np.float64]
    mask_rad: float
    h_m: float


def satellites(constellation: Sequence[str | Path], times: Times, mask_rad: float, h_m: float, without: Sequence[str] = ()) -> Satellites:
    """Satellites of nominal constellations or almanacs at the instants of a map, without those named.

    Raises
    ------
    InputError
        No constellation, nominal orbits for a date, several almanacs of different instants, an almanac of another week, a mask outside
        [0, pi/2), a height that is not finite, a satellite to leave out that is not there.
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
    orbits = reduce(add, parts).without(without)
    if not orbits.satellite:
        raise InputError("without", ", ".join(without), domain="satellites that leave at least one")
    since = 0.0
    if times.start_ns is not None:
        if orbits.reference_ns is None:
            raise InputError("start_ns", times.start_ns, "ns", "none with nominal orbits: they belong to no date")
        since = (times.start_ns - orbits.reference_ns) / NS
        if abs(since) > ALMANAC_AGE_S:
            days = since / 86_400
            of = f"{utc_text(orbits.reference_ns)} UTC, {abs(days):.1f} days {'before' if days > 0 else 'after'} it"
            why = "a week number of ten bits is read as the nearest to the day requested"
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


def messages(log: File, prn: int | None) -> sbas.Messages:
    """Messages of one satellite of a log, which is read once a process.

    Raises
    ------
    InputError
        No message; several satellites' without a choice; none of the satellite chosen.
    FormatError
        Not a message log.
    """
    messages_read = _read(log.path, log.sha256)
    senders = ", ".join(map(str, np.unique(messages_read.prn)))
    if not senders:
        raise InputError("messages", log.path, domain="a log that holds a message")
    if prn is None and "," in senders:
        raise ConflictError(
            "messages", needs=("prn",), because=f"the log holds the messages of several satellites, {senders}", value=log.path
        )
    selected = messages_read if prn is None else messages_read.of(prn)
    if len(selected.prn) == 0:
        raise InputError("prn", prn, domain=f"one of {senders}, whose messages the log holds")
    return selected


@lru_cache(maxsize=2)
def _read(path: str, _sha256: str) -> sbas.Messages:
    return sbas.read(path)
