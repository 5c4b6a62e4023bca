"""Maps from orbits: dilutions, and the algorithms of protection levels that take orbits."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, make_dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from navbound import gnss
from navbound.maps import sources
from navbound.maps.limits import Limit, limits_of
from navbound.maps.sources import Satellites, Times
from navbound.time import utc_text

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.algorithms import Grid
    from navbound.maps.kinds import Levels

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class _Day:
    """Satellites over a day.

    Attributes
    ----------
    constellation : tuple of str or Path
        Nominal constellations, or the paths of almanacs (YUMA, SEM), joined.
    times : Times
        Instants.
    mask_rad, h_m : float
        Lowest elevation used, and height of the users. [rad, m]
    without : tuple of str
        Satellites out of service the whole time, as ``G05``.
    """

    constellation: tuple[str | Path, ...] = ("gps",)
    times: Times = field(default_factory=Times)
    mask_rad: float = math.radians(5.0)
    h_m: float = 0.0
    without: tuple[str, ...] = ()

    def sky(self) -> Satellites:
        """Satellites at the instants."""
        return sources.satellites(self.constellation, self.times, self.mask_rad, self.h_m, self.without)

    def n_epochs(self) -> int:
        """Instants. [1]."""
        return len(self.times.offsets_s())

    def assumptions(self) -> list[str]:
        """What the numbers rest on."""
        sky = self.sky()
        named = ", ".join(str(name) for name in self.constellation)
        reference = sky.orbits.reference_ns
        dated = "nominal orbits, which belong to no date" if reference is None else f"orbits of {utc_text(reference)} UTC"
        out = f" without {', '.join(self.without)}," if self.without else ""
        first = None if reference is None else reference + round(float(sky.time_s[0]) * sources.NS)
        return [
            f"{len(sky.orbits.satellite)} satellites ({named}),{out} {dated}: all healthy and tracked above "
            f"{math.degrees(self.mask_rad):g}°; terrain is not considered.",
            *sky.orbits.notes,
            self.times.words(self.n_epochs(), first),
            *([f"Users {self.h_m:g} m above the ellipsoid."] if self.h_m else []),
        ]


@dataclass(frozen=True)
class _DopLevels:
    sky: Satellites

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, NDArray[Any]]:
        s = self.sky
        dilutions = gnss.dop_map(s.orbits, lat_rad, lon_rad, s.h_m, s.time_s, mask_rad=s.mask_rad)
        columns = {name: getattr(dilutions, name) for name in ("hdop", "vdop", "pdop", "gdop", "n_sv")}
        return columns | {"p_too_few": np.isnan(dilutions.pdop)}


@dataclass(frozen=True)
class Dop(_Day):
    """Dilutions of precision."""

    def levels(self) -> Levels:
        """What works out the numbers."""
        return _DopLevels(self.sky())

    def limits(self) -> list[Limit]:
        """What is required without a word of the caller."""
        return [Limit("pdop", 6.0, "GPS SPS performance standard, PDOP availability (the text was not read)", "inferred")]


@dataclass(frozen=True)
class _Predicted:
    sky: Satellites
    entry: Grid
    options: tuple[tuple[str, Any], ...]

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, NDArray[Any]]:
        s = self.sky
        levels = self.entry(s.orbits, lat_rad, lon_rad, s.h_m, s.time_s, mask_rad=s.mask_rad, **dict(self.options))
        names = [column.name for column in self.entry.columns] + ["n_sv"]
        columns: dict[str, NDArray[Any]] = {name: np.ascontiguousarray(getattr(levels, name).T, dtype=np.float64) for name in names}
        return columns | {cause.name: np.isin(levels.status, cause.statuses).T for cause in self.entry.causes}


@dataclass(frozen=True)
class _Algorithm(_Day):
    """Protection levels predicted from orbits by an algorithm of the list."""

    ENTRY: ClassVar[Grid]

    def _options(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in self.ENTRY.options}

    def levels(self) -> Levels:
        """What works out the numbers."""
        return _Predicted(self.sky(), self.ENTRY, tuple(self._options().items()))

    def limits(self) -> list[Limit]:
        """What is required without a word of the caller."""
        level, vertical, more = self.ENTRY.limits(**({"service": self._options()["service"]} if "service" in self.ENTRY.options else {}))
        return [*limits_of(level, vertical=vertical), *(Limit(*one) for one in more)]

    def assumptions(self) -> list[str]:
        """What the numbers rest on."""
        return [*super().assumptions(), *([self.ENTRY.words.format(**self._options())] if self.ENTRY.words else [])]


@cache
def options_of(entry: Grid) -> type[_Algorithm]:
    """The arguments of a map of one algorithm: those of orbits and users, and its own."""
    own = [("constellation", tuple[str | Path, ...], field(default=entry.constellation))]
    own += [(name, type(default), field(default=default)) for name, default in entry.options.items()]
    return make_dataclass(entry.name, own, bases=(_Algorithm,), namespace={"ENTRY": entry}, frozen=True)
