"""Maps from what stations on the ground send or are: SBAS messages, DME stations."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from navbound import _core, dme
from navbound.errors import InputError
from navbound.maps import sources
from navbound.maps.limits import Limit, limits_of
from navbound.maps.sources import File, Times

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from navbound.maps.kinds import Levels

    Floats = NDArray[np.float64]

METRES_PER_NM = 1852.0


@dataclass(frozen=True)
class _SbasLevels:
    messages: File
    navigation: tuple[File, ...]
    prn: int | None
    mode: Literal["auto", "pa", "npa"]
    time_ns: NDArray[np.int64]
    mask_rad: float
    h_m: float

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, Floats]:
        from navbound import sbas  # noqa: PLC0415

        heard: Any = sources.messages(self.messages.path, self.messages.sha256, self.prn)
        found = sbas.protection_levels(
            heard,
            [file.path for file in self.navigation],
            self.time_ns[:, None],
            lat_rad=lat_rad,
            lon_rad=lon_rad,
            h_m=self.h_m,
            mode=self.mode,
            mask_rad=self.mask_rad,
        )
        return {name: np.ascontiguousarray(getattr(found, name).T, dtype=np.float64) for name in ("hpl_m", "vpl_m", "n_sv")}


@dataclass(frozen=True)
class Sbas:
    """SBAS: protection levels from the messages that a service sent.

    Attributes
    ----------
    messages : str or Path
        Message log.
    navigation : tuple of str or Path
        RINEX navigation files of that day.
    prn : int, optional
        Whose messages, where the log holds several satellites'.
    times : Times
        Instants; without a start from the first message on.
    mode : {"auto", "pa", "npa"}
        What the level is for.
    mask_rad, h_m : float
        Lowest elevation used, and height of the users. [rad, m]
    """

    messages: str | Path = ""
    navigation: tuple[str | Path, ...] = ()
    prn: int | None = None
    times: Times = field(default_factory=Times)
    mode: Literal["auto", "pa", "npa"] = "pa"
    mask_rad: float = math.radians(5.0)
    h_m: float = 0.0

    def levels(self) -> Levels:
        """What works out the numbers."""
        if not (self.messages and self.navigation):
            raise InputError("messages, navigation", "none", domain="a message log and the navigation files of its day")
        heard = File.of(self.messages)
        files = tuple(File.of(path) for path in self.navigation)
        found: Any = sources.messages(heard.path, heard.sha256, self.prn)
        if len(found.time_ns) == 0:
            raise InputError("messages", str(self.messages), domain="a log with messages of the satellite asked for")
        first, last = int(found.time_ns.min()), int(found.time_ns.max())
        start = first if self.times.start_ns is None else self.times.start_ns
        time_ns = start + np.rint(self.times.offsets_s() * sources.NS).astype(np.int64)
        if time_ns[-1] < first or time_ns[0] > last:
            raise InputError("start_ns", start, "ns", f"[{first}, {last}], the time of the messages")
        return _SbasLevels(heard, files, self.prn, self.mode, time_ns, self.mask_rad, self.h_m)

    def n_epochs(self) -> int:
        """Instants. [1]."""
        return len(self.times.offsets_s())

    def limits(self) -> list[Limit]:
        """What is asked without a word of the caller."""
        return limits_of("NPA", vertical=False) if self.mode == "npa" else limits_of("APV-I")

    def assumptions(self) -> list[str]:
        """What the numbers rest on."""
        return [
            f"Every user hears every message and every satellite above {math.degrees(self.mask_rad):g}°; mode {self.mode}.",
            f"{self.n_epochs()} instants, {self.times.step_s:g} s apart.",
            "What was sent before the log begins is not known: its first minutes have no level.",
        ]


@dataclass(frozen=True)
class _DmeLevels:
    network: dme.Stations
    numbers: tuple[float, float, float]
    h_m: float

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, Floats]:
        rnp_m, fte_m, sigma_altitude_m = self.numbers
        found = dme.coverage(lat_rad, lon_rad, self.h_m, self.network, rnp_m=rnp_m, fte_m=fte_m, sigma_altitude_m=sigma_altitude_m)
        return {name: np.asarray(getattr(found, name), dtype=np.float64)[:, None] for name in ("nse_best_m", "nse_all_m")}


@dataclass(frozen=True)
class Dme:
    """DME/DME: the navigation error of the best pair and of all stations, 95 %.

    Attributes
    ----------
    stations : str or Path, optional
        A table of stations; without it the shipped one.
    rnp_m, fte_m : float
        Lateral accuracy asked for, and flight technical error, both 95 %. [m]
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
        """What is asked without a word of the caller."""
        left = float(_core.nse_boundary(np.array([self.rnp_m], dtype=np.float64), np.array([self.fte_m], dtype=np.float64))[0])
        nm = f"RNP {self.rnp_m / METRES_PER_NM:g} with a flight technical error of {self.fte_m / METRES_PER_NM:g} NM"
        return [Limit("nse_best_m", left, f"what {nm} leaves for navigation", "ours")]

    def assumptions(self) -> list[str]:
        """What the numbers rest on."""
        named = "the shipped table" if self.stations is None else str(self.stations)
        return [
            f"{len(self._network())} stations ({named}), all of them working; service volumes as navbound.dme states them; no terrain.",
            f"Users at {self.h_m:g} m, altitude known to {self.sigma_altitude_m:g} m (one sigma).",
        ]
