"""Maps from orbits: dilutions, RAIM, ARAIM."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from navbound import gnss
from navbound.errors import InputError
from navbound.maps import sources
from navbound.maps.limits import Limit, limits_of
from navbound.maps.sources import Satellites, Times

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

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
    """

    constellation: tuple[str | Path, ...] = ("gps",)
    times: Times = field(default_factory=Times)
    mask_rad: float = math.radians(5.0)
    h_m: float = 0.0

    def sky(self) -> Satellites:
        """Satellites at the instants."""
        return sources.satellites(self.constellation, self.times, self.mask_rad, self.h_m)

    def n_epochs(self) -> int:
        """Instants. [1]."""
        return len(self.times.offsets_s())

    def assumptions(self) -> list[str]:
        """What the numbers rest on."""
        sky = self.sky()
        named = ", ".join(str(name) for name in self.constellation)
        dated = "orbits of no date, from their reference instant on" if sky.orbits.reference_ns is None else "orbits of the files"
        return [
            f"{len(sky.orbits.satellite)} satellites ({named}): {dated}, all healthy and tracked above {math.degrees(self.mask_rad):g}°; "
            "terrain is not considered.",
            f"{self.n_epochs()} instants, {self.times.step_s:g} s apart.",
        ]


@dataclass(frozen=True)
class _DopLevels:
    sky: Satellites

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, Floats]:
        s = self.sky
        found = gnss.dop_map(s.orbits, lat_rad, lon_rad, s.h_m, s.time_s, mask_rad=s.mask_rad)
        return {name: getattr(found, name) for name in ("hdop", "vdop", "pdop", "gdop", "n_sv")}


@dataclass(frozen=True)
class Dop(_Day):
    """Dilutions of precision."""

    def levels(self) -> Levels:
        """What works out the numbers."""
        return _DopLevels(self.sky())

    def limits(self) -> list[Limit]:
        """What is asked without a word of the caller."""
        return [Limit("pdop", 6.0, "GPS SPS performance standard, PDOP availability (from memory, clause to be cited)", "standard")]


@dataclass(frozen=True)
class _AraimLevels:
    sky: Satellites
    service: str
    model: str

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, Floats]:
        from navbound import araim  # noqa: PLC0415

        s = self.sky
        found = araim.predict(s.orbits, lat_rad, lon_rad, s.h_m, s.time_s, mask_rad=s.mask_rad, service=self.service, model=self.model)
        return {name: np.ascontiguousarray(getattr(found, name).T, dtype=np.float64) for name in ("hpl_m", "vpl_m", "emt_m", "n_sv")}


@dataclass(frozen=True)
class Araim(_Day):
    """Advanced RAIM: protection levels predicted from orbits.

    Attributes
    ----------
    service, model : str
        Names of ``araim.SERVICES`` and ``araim.ERROR_MODELS``.
    """

    constellation: tuple[str | Path, ...] = ("gps", "galileo")
    service: str = "lpv-200"
    model: str = "dual-frequency"

    def levels(self) -> Levels:
        """What works out the numbers."""
        return _AraimLevels(self.sky(), self.service, self.model)

    def limits(self) -> list[Limit]:
        """What is asked without a word of the caller."""
        from navbound import araim  # noqa: PLC0415

        if self.service not in araim.SERVICES:
            raise InputError("service", self.service, domain=f"one of {', '.join(araim.SERVICES)}")
        service = araim.SERVICES[self.service]
        if math.isnan(service.emt_limit_m):
            return limits_of("NPA", vertical=False)
        emt = Limit("emt_m", service.emt_limit_m, service.source, service.provenance)
        return [*limits_of("LPV-200"), emt]

    def assumptions(self) -> list[str]:
        """What the numbers rest on."""
        return [
            *super().assumptions(),
            f"Service {self.service}, error model {self.model}; promises of the satellites as shipped, inferred.",
        ]


@dataclass(frozen=True)
class Raim(_Day):
    """RAIM: horizontal levels of one fault at a time."""

    model: str = "single-frequency"

    def levels(self) -> Levels:
        """What works out the numbers."""
        return _AraimLevels(self.sky(), "raim", self.model)

    def limits(self) -> list[Limit]:
        """What is asked without a word of the caller."""
        return limits_of("NPA", vertical=False)

    def assumptions(self) -> list[str]:
        """What the numbers rest on."""
        return [*super().assumptions(), f"One faulty satellite at a time, error model {self.model}."]
