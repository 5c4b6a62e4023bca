"""The skies of the surface-movement study: whose satellites stand where at the fix and after each coasting time."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navbound import gnss
from navbound.errors import FormatError, InputError
from navbound.gnss import Orbits
from navbound.read import formats
from navbound.scenario.models import GPS_EPOCH
from navbound.storage import packed
from navbound.studies.surface_movement import scenario as surface

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from navbound.studies.surface_movement.scenario import SurfaceMovement

    Floats = NDArray[np.float64]

SYSTEMS = ("gps", "galileo")
TITLES = {"gps": "GPS", "galileo": "Galileo"}
NOMINAL_WORDS = {"gps": "nominal", "gps-expanded": "nominal and expanded", "galileo": "nominal"}
WEEK_S = 604_800.0
DAY_NS = 86_400_000_000_000
MOST_AGE_S = 14_400.0
"""Broadcast records farther than this from the day are of another day."""


@dataclass(frozen=True)
class Sky:
    """Satellites at the fix and after each coasting time; both angles NaN for one that is not there.

    Attributes
    ----------
    words : str
        Whose satellites.
    dated : bool
        Whether every constellation comes from a file.
    systems : ndarray of int, shape (n,)
        Index in ``gnss.CONSTELLATIONS``.
    az_rad, el_rad : ndarray, shape (epochs, n)
        At the fix. [rad]
    az_now_rad, el_now_rad : ndarray, shape (times, epochs, n)
        After each coasting time. [rad]
    """

    words: str
    dated: bool
    systems: NDArray[np.int64]
    az_rad: Floats
    el_rad: Floats
    az_now_rad: Floats
    el_now_rad: Floats

    def of(self, names: tuple[str, ...]) -> Sky:
        """The satellites of some constellations only."""
        kept = np.isin(self.systems, [gnss.CONSTELLATIONS.index(name) for name in names])
        parts = (self.az_rad, self.el_rad, self.az_now_rad, self.el_now_rad)
        return Sky(self.words, self.dated, self.systems[kept], *(np.ascontiguousarray(part[..., kept]) for part in parts))


@dataclass(frozen=True)
class _Source:
    """One constellation and the second on its own clock at which the day begins."""

    orbits: Orbits
    begins_s: float
    words: str
    dated: bool


def look(config: SurfaceMovement, own: Mapping[str, tuple[Orbits, str]] | None = None) -> Sky:
    """Work out the skies.

    Parameters
    ----------
    config : SurfaceMovement
        Whose satellites, where and when.
    own : mapping, optional
        Orbits of the caller's own and their name, by constellation; the day begins at their reference instant.

    Raises
    ------
    InputError
        A file that is of another week or day than ``start``, or holds no satellite of its constellation.
    FormatError
        A file that cannot be read.
    """
    geometry, airport = config.geometry, config.airport
    sources = []
    for system in SYSTEMS:
        if own is not None and system in own:
            orbits, words = own[system]
            sources.append(_Source(orbits, 0.0, words, dated=False))
        else:
            sources.append(_source(system, getattr(geometry, system), geometry.start, geometry.duration_s))
    fixes = np.arange(0.0, geometry.duration_s, geometry.step_s)
    place = np.radians(airport.lat_deg), np.radians(airport.lon_deg), airport.h_m
    at_fix, later = [], []
    for source in sources:
        times = source.begins_s + fixes
        at_fix.append(gnss.directions(source.orbits, *place, times))
        after = times + np.asarray(config.grid.coasting_s)[:, None]
        later.append(gnss.directions(source.orbits, *place, after))
    az, el = (np.concatenate([part[k] for part in at_fix], axis=-1) for k in (0, 1))
    az_now, el_now = (np.concatenate([part[k] for part in later], axis=-1) for k in (0, 1))
    seen = el >= np.radians(geometry.mask_deg)
    # An elevation of zero has no error model; one must be above it.
    followed = seen & (el_now >= np.radians(geometry.coasting_mask_deg)) & (el_now > 0)
    return Sky(
        words=", ".join(s.words for s in sources),
        dated=all(s.dated for s in sources),
        systems=np.concatenate([s.orbits.constellation for s in sources]),
        az_rad=np.where(seen, az, np.nan),
        el_rad=np.where(seen, el, np.nan),
        az_now_rad=np.where(followed, az_now, np.nan),
        el_now_rad=np.where(followed, el_now, np.nan),
    )


def _source(system: str, name: str, start: datetime | None, duration_s: float) -> _Source:
    shipped = surface.nominal(system, name)
    if shipped is not None:
        orbits = gnss.constellation(shipped)
        return _Source(orbits, 0.0, f"{len(orbits.satellite)} {NOMINAL_WORDS[shipped]} {TITLES[system]} satellites", dated=False)
    path = Path(name)
    if not path.exists():
        known = ", ".join(("nominal", *surface.NOMINAL[system]))
        raise InputError(f"geometry.{system}", name, domain=f"{known}, or the path of a file that is there")
    start_ns = None if start is None else _gps_ns(start)
    if is_rinex(path):
        return _from_navigation(system, path, start_ns, duration_s)
    if system != "gps":
        raise InputError(f"geometry.{system}", name, domain="nominal, or a RINEX navigation file: almanac files are of GPS")
    orbits = gnss.constellation(path, near_ns=start_ns)
    begins_s = 0.0
    if start_ns is not None:
        if orbits.reference_ns is None:
            raise InputError("geometry.start", str(start), domain="left out: the almanac's week is not known")
        begins_s = (start_ns - orbits.reference_ns) * 1e-9
        if not abs(begins_s + duration_s / 2) <= WEEK_S:
            days = begins_s / 86_400
            raise InputError(
                "geometry.start", str(start), domain=f"a day within a week of the almanac {path.name}, which is {days:.1f} days earlier"
            )
    notes = f" ({' '.join(orbits.notes)})" if orbits.notes else ""
    return _Source(orbits, begins_s, f"{len(orbits.satellite)} {TITLES[system]} satellites of {path.name}{notes}", dated=True)


def _from_navigation(system: str, path: Path, start_ns: int | None, duration_s: float) -> _Source:
    navigation = gnss.read_navigation(path)
    index = gnss.CONSTELLATIONS.index(system)
    if start_ns is None:
        times = np.asarray(navigation.records()["orbit_time_ns"].to_numpy())
        if times.size == 0:
            raise InputError(f"geometry.{system}", str(path), domain="a file with broadcast orbits")
        start_ns = int(np.median(times)) // DAY_NS * DAY_NS
    middle_ns = start_ns + round(duration_s / 2 * 1e9)
    orbits = navigation.orbits(system, middle_ns)
    if not orbits.satellite:
        raise InputError(f"geometry.{system}", str(path), domain=f"a file with healthy satellites of {gnss.CONSTELLATIONS[index]}")
    if navigation.nearest_age_s(system, middle_ns) > duration_s / 2 + MOST_AGE_S:
        raise InputError("geometry.start", start_ns, "ns", f"a day that {path.name} has broadcast orbits of")
    refused = f" ({len(navigation.refused)} records refused)" if navigation.refused else ""
    return _Source(orbits, -duration_s / 2, f"{len(orbits.satellite)} {TITLES[system]} satellites of {path.name}{refused}", dated=True)


def _gps_ns(start: datetime) -> int:
    if start.tzinfo is not None:
        raise InputError("geometry.start", str(start), domain="GPS time, without a time zone")
    return round((start - GPS_EPOCH).total_seconds() * 1e9)


def is_rinex(path: Path) -> bool:
    """Whether a file, plain or packed, is RINEX."""
    try:
        with path.open("rb") as file:
            head = file.read(4096)
    except OSError as e:
        raise FormatError(path, e.strerror or str(e)) from e
    if "packed" in formats.of(head).holds:
        head = packed.read(path)[:4096]
    return formats.of(head).id.startswith("rinex-")
