"""The path that recorded tracks should have followed: approaches to runways, a route, or none; and what a report says of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import InputError
from navbound.read.approaches import seek, statistics
from navbound.read.routes import follow, load_route
from navbound.read.runways import runway
from navbound.records.material import LEFT_OUT
from navbound.records.run import Rejection, Waypoint
from navbound.run.pieces import NoWay, OnApproach, OnRoute, without_path
from navbound.units import METRES_PER_NM
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from navbound.read.approaches import Gates, Landings
    from navbound.read.routes import Route
    from navbound.records.material import Operation
    from navbound.records.procedure import BesideProcedure, ProcedureFlown
    from navbound.records.run import CrossTrack, InputFile
    from navbound.run.pieces import Way
    from navbound.storage.frames import Frames
    from navbound.storage.tables import Table


@dataclass(frozen=True)
class OnPath:
    """Epochs with the path they should have followed, and what the report says about it."""

    epochs: Table
    words: list[str]
    heading: str
    waypoints: list[Waypoint] = field(default_factory=list)
    inputs: list[InputFile] = field(default_factory=list)
    cross_track: list[CrossTrack] = field(default_factory=list)
    tracks: dict[str, str] = field(default_factory=dict)
    due: dict[str, int] = field(default_factory=dict)
    n_approaches: int = 0
    n_unjudged: int = 0
    n_elsewhere: int = 0
    beside: BesideProcedure | None = None
    left_out: pl.DataFrame = field(default_factory=lambda: pl.DataFrame(schema=LEFT_OUT))
    operation: Operation = "en-route"
    flights: list[ProcedureFlown] = field(default_factory=list)


def follow_path(path: str | Path | None, epochs: pl.DataFrame, gates: Gates, rejected: list[Rejection]) -> OnPath:
    """Epochs of a table in memory on the path that the caller names; `path` as of :func:`navbound.run.analyze.material`.

    Raises
    ------
    InputError, FormatError
        No epoch on the path, an unknown runway, a route that cannot be read.
    """
    if path is None:
        return OnPath(without_path(epochs), [_NO_PATH], "Recorded tracks")
    if _is_route(path):
        route = load_route(path)
        followed, n_beyond = follow(epochs, route)
        _refuse_beyond(route, followed.height, n_beyond, rejected)
        return _route_path(followed, route, statistics(route.name, followed.select(cross_m="fte_m", segment="track")))
    names = _runway_names(path)
    approaches = seek(epochs, None if names is None else [runway(name) for name in names], gates)
    judged = approaches.between(epochs)
    _refuse_without_approach(path, judged.height, approaches.notes, gates)
    return _approach_path(judged, approaches, gates, epochs.height)


def _is_route(path: str | Path) -> bool:
    return Path(path).suffix.lower() in {".toml", ".csv"}


def _runway_names(path: str | Path) -> list[str] | None:
    return None if str(path) == "auto" else [name.strip() for name in str(path).split(",")]


def _refuse_without_approach(path: str | Path, n_judged: int, notes: Sequence[str], gates: Gates) -> None:
    if n_judged == 0:
        names = _runway_names(path)
        where = "any runway of the table" if names is None else ", ".join(names)
        passes = " ".join(["", *notes])
        raise InputError("path", str(path), domain=f"paths that a track follows: no approach to {where} ({_gates_words(gates)}).{passes}")


def _gates_words(gates: Gates) -> str:
    """What counts as an approach, in the units of charts."""
    descending = ", descending" if gates.descending else ""
    return (
        f"an approach is at least {gates.span_min_m / METRES_PER_NM:.3g} NM and {gates.n_min} points between "
        f"{gates.before_min_m / METRES_PER_NM:.3g} and "
        f"{gates.before_max_m / METRES_PER_NM:.3g} NM before a threshold, within {gates.cross_max_m:.0f} m of the extended centreline, "
        f"and comes within {gates.lands_within_m / METRES_PER_NM:.3g} NM of the threshold{descending}"
    )


_NO_PATH = "Path: none given, so there is no flight technical error; only the navigation system is judged."


def _refuse_beyond(route: Route, n_followed: int, n_beyond: int, rejected: list[Rejection]) -> None:
    """Refuse a route that no epoch follows; epochs beyond its ends are counted."""
    if n_followed == 0:
        raise InputError(
            "path", route.source.path, domain="routes that a track follows: every epoch lies before its start or beyond its end"
        )
    if n_beyond:
        reason = "before the start or beyond the end of the route"
        rejected.append(Rejection(file=route.source.path, reason=reason, count=n_beyond, first_line=None, example=""))


def _route_path(epochs: Table, route: Route, cross_track: CrossTrack) -> OnPath:
    words = f"Path: route {route.source.path}, {len(route.waypoints)} waypoints, {route.path.length_m / METRES_PER_NM:.2f} NM."
    return OnPath(epochs, [words], f"Route {route.name}", route.waypoints, [route.source], [cross_track])


def _approach_path(epochs: Table, approaches: Landings, gates: Gates, n_recorded: int) -> OnPath:
    n, runways = len(approaches.tracks), ", ".join(r.name for r in approaches.runways)
    words = [
        f"Path: the centreline through the runway ends of the shipped table (OurAirports), {gates.before_max_m / METRES_PER_NM:g} to "
        f"{gates.before_min_m / METRES_PER_NM:g} NM before the landing threshold; {counted(n, 'approach', 'approaches')}.",
        f"Judged are all epochs from the first to the last point of an approach, {epochs.height} of {n_recorded} recorded, and where an "
        "aircraft leaves the centreline in the last mile those after it while it comes nearer to the threshold; "
        "what came before the first point is not. The path is the extended centreline, not a coded procedure: its own error counts as "
        "flight technical error.",
    ]
    waypoints = [Waypoint(name=r.name, lat_rad=r.lat_rad, lon_rad=r.lon_rad, kind="runway") for r in approaches.runways]
    cross, tracks = approaches.cross_track, approaches.tracks
    heading = (
        f"{counted(n, 'recorded approach', 'recorded approaches')} to "
        f"{runways if len(approaches.runways) <= 4 else f'{len(approaches.runways)} runways'}"
    )
    words += [r.doubt for r in approaches.runways if r.doubt is not None]
    notes = words + approaches.notes
    return OnPath(
        epochs,
        notes,
        heading,
        waypoints,
        cross_track=cross,
        tracks=tracks,
        due=approaches.due,
        n_approaches=n,
        n_unjudged=approaches.n_unjudged,
        n_elsewhere=approaches.n_elsewhere,
        operation="approach",
    )


def way_of(path: str | Path | None, gates: Gates, piece_rows: int) -> Way:
    """The path of a table in pieces, as :func:`follow_path`."""
    if path is None:
        return NoWay()
    if _is_route(path):
        return OnRoute(load_route(path))
    names = _runway_names(path)
    return OnApproach(str(path), None if names is None else [runway(name) for name in names], gates, piece_rows)


def path_of(way: Way, epochs: Frames, gates: Gates, rejected: list[Rejection]) -> OnPath:
    """What the report says of a path that was followed in pieces."""
    if isinstance(way, OnRoute):
        _refuse_beyond(way.route, epochs.height, way.n_beyond, rejected)
        return _route_path(epochs, way.route, way.cross_track(epochs))
    if isinstance(way, OnApproach):
        _refuse_without_approach(way.stated, way.n_judged, way.landings.notes, gates)
        return _approach_path(epochs, way.landings, gates, way.n_recorded)
    return OnPath(epochs, [_NO_PATH], "Recorded tracks")
