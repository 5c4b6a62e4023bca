"""`navbound map`: the arguments of a map on the command line."""

from __future__ import annotations

import math
import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navbound.algorithms import Grid as MapOf
from navbound.algorithms import Sent, entries
from navbound.cli.calls import call
from navbound.cli.choices import Selectable, Written
from navbound.cli.parts import Backend, Bar, Checkpoint, Cluster, Json, NWorkers, command_line, out_console, work_of
from navbound.errors import InputError

if TYPE_CHECKING:
    from navbound.maps import Map
    from navbound.maps.sources import Times

_OF_ORBITS = f"[dop, {', '.join(entries(MapOf))}]"


def map_command(
    kind: Annotated[
        str, typer.Argument(help=f"What to map: dop, {', '.join([*entries(MapOf), *entries(Sent)])}, dme."), Selectable(lists="maps")
    ],
    step_deg: Annotated[float, typer.Option(help="Side of a cell."), Selectable(first=True)] = 5.0,
    region: Annotated[
        str | None, typer.Option(help="South,north,west,east in degrees. [default: the world]"), Selectable(first=True)
    ] = None,
    constellation: Annotated[
        list[str] | None,
        typer.Option(help=f"gps, galileo, beidou, or a YUMA or SEM almanac or RINEX navigation file; may be repeated. {_OF_ORBITS}"),
        Selectable(lists="constellations", files=True),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(help="First instant, UTC, as 2026-11-21T00:00. [default: the orbits' own; ten minutes into the messages]"),
    ] = None,
    hours: Annotated[float | None, typer.Option(help="Length. [default: 24; of sbas to the end of the messages]")] = None,
    every_s: Annotated[float | None, typer.Option(help="Step between instants. [default: 300]")] = None,
    mask_deg: Annotated[float | None, typer.Option(help="Lowest elevation used. [default: 5]")] = None,
    height_m: Annotated[float | None, typer.Option(help="Height of the users above the ellipsoid.")] = None,
    without: Annotated[list[str] | None, typer.Option(help=f"Satellite out of service, as G05; may be repeated. {_OF_ORBITS}")] = None,
    service: Annotated[
        str | None, typer.Option(help="Service of araim: lpv-200, horizontal."), Selectable(words=("lpv-200", "horizontal"))
    ] = None,
    model: Annotated[
        str | None, typer.Option(help="Error model of levels of orbits: dual-frequency, single-frequency."), Selectable(lists="models")
    ] = None,
    messages: Annotated[Path | None, typer.Option(help="Message log of sbas.")] = None,
    navigation: Annotated[list[Path] | None, typer.Option(help="RINEX navigation file of sbas; may be repeated.")] = None,
    prn: Annotated[int | None, typer.Option(help="Whose SBAS messages, where a log holds several.")] = None,
    mode: Annotated[str | None, typer.Option(help="Of sbas: pa, npa, auto."), Selectable(words=("pa", "npa", "auto"))] = None,
    stations: Annotated[Path | None, typer.Option(help="Table of stations of dme. [default: the shipped one]")] = None,
    rnp_nm: Annotated[float | None, typer.Option(help="Lateral accuracy required of dme. [default: 1]")] = None,
    fte_nm: Annotated[float | None, typer.Option(help="Flight technical error of dme, 95 %. [default: 0.5]")] = None,
    limit: Annotated[list[str] | None, typer.Option(help="Limit instead: column=number; may be repeated.")] = None,
    level: Annotated[
        str | None, typer.Option(help="Limit instead: alert limits of a service level; see `navbound levels`."), Selectable(lists="levels")
    ] = None,
    backend: Backend = None,
    workers: NWorkers = None,
    cluster: Cluster = None,
    checkpoint: Checkpoint = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder to write. [default: out/map-<kind>]"), Written()] = None,
    json: Json = False,
) -> None:
    """Map what a grid of users gets over a day, and say on what share of the area that is enough."""
    from navbound import maps  # noqa: PLC0415
    from navbound.units import METRES_PER_NM  # noqa: PLC0415

    work = work_of(backend, workers, cluster, checkpoint)
    options: dict[str, Any] = {
        "constellation": tuple(constellation) if constellation else None,
        "times": _times(start, hours, every_s),
        "mask_rad": None if mask_deg is None else math.radians(mask_deg),
        "h_m": height_m,
        "without": tuple(without) if without else None,
        "service": service,
        "model": model,
        "messages": messages,
        "navigation": tuple(navigation) if navigation else None,
        "prn": prn,
        "mode": mode,
        "stations": stations,
        "rnp_m": None if rnp_nm is None else rnp_nm * METRES_PER_NM,
        "fte_m": None if fte_nm is None else fte_nm * METRES_PER_NM,
    }
    with Bar("tiles") as work["progress"]:
        made = call(
            "maps.make",
            maps.make,
            kind,
            grid=maps.Grid.degrees(step_deg, *_region(region)),
            limits=_limits(limit or []),
            level=level,
            out=out or Path("out") / f"map-{kind}",
            command=command_line(),
            **work,
            **{name: value for name, value in options.items() if value is not None},
        )
    _show(made, json=json)


def _region(text: str | None) -> tuple[()] | tuple[tuple[float, float, float, float]]:
    if text is None:
        return ()
    try:
        south, north, west, east = (float(part) for part in text.split(","))
    except ValueError as e:
        raise InputError("region", text, domain="four numbers in degrees: south,north,west,east") from e
    return ((south, north, west, east),)


def _times(start: str | None, hours: float | None, every_s: float | None) -> Times | None:
    if start is None and hours is None and every_s is None:
        return None
    from navbound.maps.sources import Times  # noqa: PLC0415

    usual = Times()
    return Times(
        None if start is None else _instant(start),
        None if hours is None else hours * 3600.0,
        usual.step_s if every_s is None else every_s,
    )


def _instant(text: str) -> int:
    from navbound.time import gps_ns  # noqa: PLC0415

    try:
        when = datetime.fromisoformat(text)
    except ValueError as e:
        raise InputError("start", text, domain="a date and time, as 2026-11-21T00:00") from e
    return gps_ns(when if when.tzinfo else when.replace(tzinfo=UTC))


def _limits(pairs: list[str]) -> dict[str, float]:
    limits = {}
    for pair in pairs:
        name, _, number = pair.partition("=")
        try:
            limits[name] = float(number)
        except ValueError as e:
            raise InputError("limit", pair, domain="column=number, as hpl_m=40") from e
    return limits


def _show(made: Map, *, json: bool) -> None:
    if json:
        sys.stdout.write(made.summary.model_dump_json(indent=1) + "\n")
        return
    show = out_console.print
    show(made.summary.title, style="bold", markup=False)
    show(made.summary.words, markup=False, highlight=False)
    for outcome in made.summary.outcomes:
        if outcome.share > 0:
            show(f"  {100 * outcome.share:6.2f} % of time and area: {outcome.title}", markup=False, highlight=False)
    for limit in made.summary.limits:
        show(f"  {limit.column} <= {limit.limit:.6g} ({limit.source}; {limit.provenance})", markup=False, highlight=False)
    for assumption in made.summary.assumptions:
        show(f"  - {assumption}", markup=False, highlight=False)
    if made.path is not None:
        show(f"Report: {(made.path / 'report.html').resolve()}", markup=False, highlight=False, soft_wrap=True)
