"""Maps from orbits: dilutions, RAIM, ARAIM."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import gnss
from navbound.errors import InputError
from navbound.maps import sources
from navbound.maps.limits import Limit, limits_of
from navbound.maps.sources import Satellites, Times
from navbound.time import utc_text

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
            self.times.words(self.n_epochs(), first),
            *([f"Users {self.h_m:g} m above the ellipsoid."] if self.h_m else []),
        ]


@dataclass(frozen=True)
class _DopLevels:
    sky: Satellites

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, NDArray[Any]]:
        s = self.sky
        found = gnss.dop_map(s.orbits, lat_rad, lon_rad, s.h_m, s.time_s, mask_rad=s.mask_rad)
        columns = {name: getattr(found, name) for name in ("hdop", "vdop", "pdop", "gdop", "n_sv")}
        return columns | {"p_too_few": np.isnan(found.pdop)}


@dataclass(frozen=True)
class Dop(_Day):
    """Dilutions of precision."""

    def levels(self) -> Levels:
        """What works out the numbers."""
        return _DopLevels(self.sky())

    def limits(self) -> list[Limit]:
        """What is asked without a word of the caller."""
        return [Limit("pdop", 6.0, "GPS SPS performance standard, PDOP availability (the text was not read)", "inferred")]


_CAUSES = {"p_too_few": ("too_few_satellites", "singular"), "p_too_many": ("too_many",), "p_not_monitored": ("not_monitored",)}
"""The statuses of ``navbound.araim`` behind each cause."""


@dataclass(frozen=True)
class _AraimLevels:
    sky: Satellites
    service: str
    model: str

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, NDArray[Any]]:
        from navbound import araim  # noqa: PLC0415

        s = self.sky
        found = araim.predict(s.orbits, lat_rad, lon_rad, s.h_m, s.time_s, mask_rad=s.mask_rad, service=self.service, model=self.model)
        columns: dict[str, NDArray[Any]] = {
            name: np.ascontiguousarray(getattr(found, name).T, dtype=np.float64) for name in ("hpl_m", "vpl_m", "emt_m", "n_sv")
        }
        return columns | {cause: np.isin(found.status, words).T for cause, words in _CAUSES.items()}


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
