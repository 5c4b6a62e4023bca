"""A flight that is yet to be flown: when a monitor on board could not detect or not exclude a fault, at a place or on a route."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import __version__, gnss, kpi
from navbound.algorithms import Place, entry
from navbound.errors import InputError
from navbound.maps.sources import NS, Satellites, satellites
from navbound.read.routes import load_route
from navbound.read.runways import runway
from navbound.records.prediction import Hole, PredictedLimit, PredictedLine, PredictedPlace, PredictedTimes, Prediction
from navbound.time import utc_text
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from navbound.maps.sources import Times
    from navbound.records.prediction import Function

    Floats = NDArray[np.float64]

ROUTE_STEP_M = 30.0 * METRES_PER_NM
"""Points of a route are at most this far apart: in 30 NM the elevation of a satellite changes by half a degree. [m]"""
MOST_POINTS = 20_000_000
"""Points times instants: what fits a gigabyte or two."""


@dataclass(frozen=True)
class Request:
    """What is requested of a prediction.

    Attributes
    ----------
    constellation : sequence of str or Path
        Nominal constellations, or YUMA and SEM almanacs and RINEX navigation files.
    times : Times
        Instants.
    limits : sequence of str
        ``RNP 0.3`` and the like, or names of :func:`navbound.kpi.levels`.
    without : sequence of str
        Satellites out of service, as ``G05``.
    systems : str, optional
        Letters of the constellations that the receiver uses (G, E, C). Without it GPS, which is what RAIM receivers use, and the nominal
        constellations that were named.
    mask_rad : float
        Lowest elevation. [rad]
    model : str
        Error model of a range, a name of ``raim.ERROR_MODELS``.
    kind : str
        Whose levels: a name of the places of :mod:`navbound.algorithms`.
    """

    constellation: Sequence[str | Path]
    times: Times
    limits: Sequence[str] = ("RNP 0.3", "RNP 1")
    without: Sequence[str] = ()
    systems: str | None = None
    mask_rad: float = math.radians(5.0)
    model: str = "single-frequency"
    kind: str = "raim"


def place(text: str) -> PredictedPlace:
    """A place from ``LAT,LON`` or ``LAT,LON,H`` (degrees, metres), or the threshold of a runway, ``LFPG/08R``.

    Raises
    ------
    InputError
        Neither; no such runway; a latitude or longitude that is none.
    """
    if "/" in text:
        threshold = runway(text, argument="at")
        return PredictedPlace(name=threshold.name, lat_rad=[threshold.lat_rad], lon_rad=[threshold.lon_rad], h_m=[threshold.elevation_m])
    domain = "LAT,LON or LAT,LON,H in degrees and metres, latitude within 90 and longitude within 180; or a runway, as LFPG/08R"
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError as e:
        raise InputError("at", text, domain=domain) from e
    lat, lon, h = [*numbers, 0.0][:3] if len(numbers) in {2, 3} else (math.nan,) * 3
    if not (abs(lat) <= 90 and abs(lon) <= 180 and -1000 <= h <= 100_000):
        raise InputError("at", text, domain=f"{domain}; height from -1000 to 100000")
    return PredictedPlace(name=text, lat_rad=[math.radians(lat)], lon_rad=[math.radians(lon)], h_m=[h])


def route(file: str | Path) -> PredictedPlace:
    """A route's points, at most 30 NM apart, as one place: what fails at one point fails on the route.

    Raises
    ------
    FormatError
        Not a route.
    """
    loaded = load_route(file)
    count = 1 + max(1, math.ceil(loaded.path.length_m / ROUTE_STEP_M))
    points = loaded.path.at(np.linspace(0.0, loaded.path.length_m, count))
    name = f"route {loaded.name}, {count} points of {loaded.path.length_m / METRES_PER_NM:.0f} NM"
    return PredictedPlace(name=name, lat_rad=points.lat_rad.tolist(), lon_rad=points.lon_rad.tolist(), h_m=[0.0] * count)


def predict(request: Request, places: Sequence[PredictedPlace], *, command: str = "") -> Prediction:
    """Holes of detection and of exclusion at every place.

    Raises
    ------
    InputError
        No place or limit, a place twice, a limit that is none, satellites to leave out that are not there, an almanac of another week,
        nominal orbits for a date.
    FormatError
        A file that is no almanac.
    """
    if not places:
        raise InputError("at", "none", domain="one place or route, or more")
    called = entry(Place, "kind", request.kind)
    names = [p.name for p in places]
    if len(set(names)) < len(names):
        raise InputError("at", ", ".join(names), domain="every place once")
    limits = [limit(name) for name in dict.fromkeys(request.limits)]
    if not limits:
        raise InputError("spec", "none", domain="one limit or more")
    points = sum(len(p.lat_rad) for p in places)
    if points * len(request.times.offsets_s()) > MOST_POINTS:
        raise InputError("every_s", request.times.step_s, "s", f"at most {MOST_POINTS} points times instants; here are {points} points")
    sky = _sky(request)
    orbits = sky.orbits.without(list(dict.fromkeys(request.without)))
    start_ns = request.times.start_ns if request.times.start_ns is not None else sky.orbits.reference_ns
    when = _Instants(request.times.offsets_s(), request.times.step_s, start_ns)
    unhealthy = _unhealthy(request, sky.orbits.satellite)
    lines: list[PredictedLine] = []
    holes: list[Hole] = []
    for each in places:
        levels = called(orbits, each.lat_rad, each.lon_rad, each.h_m, sky.time_s, mask_rad=request.mask_rad, model=request.model)
        for required in limits:
            line, more = _judge(each.name, required, levels, when)
            lines.append(line)
            holes += more
    length_s = len(when.offsets_s) * when.step_s
    times = PredictedTimes(
        start_utc=when.utc(0.0),
        end_utc=when.utc(length_s),
        duration_s=length_s,
        step_s=request.times.step_s,
        n=len(when.offsets_s),
    )
    return Prediction(
        navbound_version=__version__,
        kind=request.kind,
        command=command,
        orbits=[str(name) for name in request.constellation],
        satellites=list(orbits.satellite),
        without=list(dict.fromkeys(request.without)),
        unhealthy=unhealthy,
        times=times,
        mask_rad=request.mask_rad,
        model=request.model,
        places=list(places),
        limits=limits,
        lines=lines,
        holes=sorted(holes, key=lambda h: (h.start_s, h.place, h.limit, h.function)),
        assumptions=_assumptions(request, unhealthy, start_ns, sky.orbits.notes),
    )


def _letters(request: Request) -> set[str]:
    """Constellations that the receiver uses."""
    named = {letter for letter, words in gnss.SYSTEMS.items() if words.lower() in request.constellation}
    letters = named | {"G"} if request.systems is None else set(request.systems)
    if not letters or not letters <= set(gnss.SYSTEMS):
        raise InputError("systems", request.systems, domain=f"letters of {''.join(gnss.SYSTEMS)}")
    return letters


def _sky(request: Request) -> Satellites:
    """Satellites of the receiver's constellations, at the instants."""
    letters = _letters(request)
    try:
        sky = satellites(request.constellation, request.times, request.mask_rad, 0.0)
    except InputError as e:
        if e.argument != "start_ns" or request.times.start_ns is None:
            raise
        raise InputError("date", f"{utc_text(request.times.start_ns)} UTC", domain=e.domain) from e
    orbits = sky.orbits.without([name for name in sky.orbits.satellite if name[0] not in letters])
    if not orbits.satellite:
        there = ", ".join(sorted({name[0] for name in sky.orbits.satellite}))
        raise InputError(
            "systems", "".join(sorted(letters)), domain=" ".join([f"one of the orbits that may be used: {there}.", *sky.orbits.notes])
        )
    absent = [words for letter, words in gnss.SYSTEMS.items() if letter in letters and letter not in {name[0] for name in orbits.satellite}]
    notes = [f"{words} is among the constellations of the receiver, and no satellite of it is in the orbits." for words in absent]
    return replace(sky, orbits=replace(orbits, notes=(*orbits.notes, *notes)))


def limit(name: str) -> PredictedLimit:
    """A limit by its name: ``RNP 0.3``, or a service level's.

    Raises
    ------
    InputError
        No such limit.
    """
    required = kpi.level(name)
    return PredictedLimit(id=required.id, hal_m=required.hal_m, source=required.source, provenance=required.provenance["hal_m"])


@dataclass(frozen=True)
class _Instants:
    """When: since the start, and the start itself where the orbits have a date."""

    offsets_s: Floats
    step_s: float
    start_ns: int | None

    def utc(self, since_s: float) -> str | None:
        return None if self.start_ns is None else utc_text(self.start_ns + round(since_s * NS))


def _judge(name: str, limit: PredictedLimit, levels: Any, when: _Instants) -> tuple[PredictedLine, list[Hole]]:
    """One place, or one route whose every point counts, against one limit."""
    n_sv = levels.n_sv.min(axis=-1)
    detection = _worst(levels.hpl_m)
    seen = _holes(_Kind(name, limit, "detection"), detection, n_sv, when)
    exclusion, published = (_worst(getattr(levels, column)) if hasattr(levels, column) else None for column in ("hel_m", "hpl_slope_m"))
    left = [] if exclusion is None else _holes(_Kind(name, limit, "exclusion"), exclusion, n_sv, when)
    line = PredictedLine(
        place=name,
        limit=limit.id,
        p_detection=float((detection <= limit.hal_m).mean()),
        p_exclusion=None if exclusion is None else float((exclusion <= limit.hal_m).mean()),
        p_detection_published=None if published is None else float((published <= limit.hal_m).mean()),
        n_holes_detection=len(seen),
        n_holes_exclusion=None if exclusion is None else len(left),
        longest_detection_s=max((h.end_s - h.start_s for h in seen), default=0.0),
        longest_exclusion_s=None if exclusion is None else max((h.end_s - h.start_s for h in left), default=0.0),
    )
    return line, seen + left


@dataclass(frozen=True)
class _Kind:
    """What is missing in a hole, and where."""

    place: str
    limit: PredictedLimit
    function: Function


def _worst(level_m: Floats) -> Floats:
    """The largest level of the points at each instant; none is infinite."""
    worst: Floats = np.nan_to_num(level_m, nan=np.inf, posinf=np.inf).max(axis=-1)
    return worst


def _runs(out: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last index of every run of True."""
    edges = np.diff(np.concatenate([[False], out, [False]]).astype(np.int8))
    return list(zip(np.flatnonzero(edges == 1).tolist(), (np.flatnonzero(edges == -1) - 1).tolist(), strict=True))


def _holes(kind: _Kind, level_m: Floats, n_sv: NDArray[np.int64], when: _Instants) -> list[Hole]:
    """Every time that the level is outside the limit."""
    holes = []
    for first, last in _runs(level_m > kind.limit.hal_m):
        start_s, end_s = float(when.offsets_s[first]), float(when.offsets_s[last]) + when.step_s
        largest = float(level_m[first : last + 1].max())
        hole = Hole(
            place=kind.place,
            limit=kind.limit.id,
            function=kind.function,
            start_s=start_s,
            end_s=end_s,
            start_utc=when.utc(start_s),
            end_utc=when.utc(end_s),
            cut=first == 0 or last == len(level_m) - 1,
            n_sv_least=int(n_sv[first : last + 1].min()),
            level_max_m=largest if math.isfinite(largest) else None,
        )
        holes.append(hole)
    return holes


def _unhealthy(request: Request, used: Sequence[str]) -> list[str]:
    """Satellites of the receiver that an almanac or a record of the file does not promise: they are not used."""
    every = {
        s for name in request.constellation for s in gnss.constellation(name, near_ns=request.times.start_ns, unhealthy=True).satellite
    }
    letters = _letters(request)
    return sorted(name for name in every - set(used) if name[0] in letters)


def _assumptions(request: Request, unhealthy: list[str], start_ns: int | None, notes: Sequence[str]) -> list[str]:
    dated = "Orbits of no date: times count from their reference instant." if start_ns is None else "Orbits of the files at those times."
    return [
        # Those that are have a note of their file.
        dated if unhealthy else f"{dated} None is called unhealthy.",
        *notes,
        f"Satellites are tracked above {math.degrees(request.mask_rad):g}°. Terrain, bank and interference are not modelled.",
        *entry(Place, "kind", request.kind).words(request.model),
        f"A hole is exact to the step of {request.times.step_s:g} s; one that is shorter may be missed.",
    ]
