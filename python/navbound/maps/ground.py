"""Maps from stations on the ground: DME/DME."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core, dme
from navbound.maps.limits import Limit
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from navbound.maps.kinds import Levels

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class _DmeLevels:
    network: dme.Stations
    numbers: tuple[float, float, float]
    h_m: float

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, NDArray[Any]]:
        rnp_m, fte_m, sigma_altitude_m = self.numbers
        coverage = dme.coverage(lat_rad, lon_rad, self.h_m, self.network, rnp_m=rnp_m, fte_m=fte_m, sigma_altitude_m=sigma_altitude_m)
        columns: dict[str, NDArray[Any]] = {
            name: np.asarray(getattr(coverage, name), dtype=np.float64)[:, None] for name in ("nse_best_m", "nse_all_m")
        }
        return columns | {"p_too_few": np.isnan(columns["nse_best_m"])}


@dataclass(frozen=True)
class Dme:
    """DME/DME: the navigation error of the best pair and of all stations, 95 %.

    Attributes
    ----------
    stations : str or Path, optional
        A table of stations; without it the shipped one.
    rnp_m, fte_m : float
        Lateral accuracy required, and flight technical error, both 95 %. [m]
    sigma_altitude_m, h_m : float
        Standard deviation of the altitude, and height of the users. [m]
    """

    stations: str | Path | None = None
    rnp_m: float = METRES_PER_NM
    fte_m: float = 0.5 * METRES_PER_NM
    sigma_altitude_m: float = 30.0
    h_m: float = 6_000.0

    def _network(self) -> dme.Stations:
        return dme.stations() if self.stations is None else dme.read_stations(self.stations)

    def levels(self) -> Levels:
        """What works out the numbers."""
        return _DmeLevels(self._network(), (self.rnp_m, self.fte_m, self.sigma_altitude_m), self.h_m)

    def n_epochs(self) -> int:
        """Instants. [1]."""
        return 1

    def limits(self) -> list[Limit]:
        """What is required without a word of the caller."""
        left = float(_core.nse_boundary(np.array([self.rnp_m], dtype=np.float64), np.array([self.fte_m], dtype=np.float64))[0])
        nm = f"RNP {self.rnp_m / METRES_PER_NM:g} with a flight technical error of {self.fte_m / METRES_PER_NM:g} NM"
        return [Limit("nse_best_m", left, f"what {nm} leaves for navigation", "ours")]

    def assumptions(self) -> list[str]:
        """What the numbers rest on."""
        named = "the shipped table" if self.stations is None else str(self.stations)
        return [
            f"{len(self._network())} stations ({named}), all of them working; service volumes as navbound.dme states them.",
            "No terrain: only the horizon of a smooth Earth of four thirds the radius hides a station; behind hills there is less.",
            f"Users at {self.h_m:g} m, altitude known to {self.sigma_altitude_m:g} m (one sigma).",
        ]
