"""`navbound predict`: the arguments of a prediction on the command line."""

from __future__ import annotations

import math
import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from navbound.algorithms import Place, entries, entry
from navbound.cli.calls import call
from navbound.cli.choices import Selectable, Written
from navbound.cli.flight_plan import predict_flight_command
from navbound.cli.parts import command_line, out_console
from navbound.errors import ConflictError, InputError

if TYPE_CHECKING:
    from navbound.maps.sources import Times
    from navbound.records.prediction import Hole, Prediction

LISTED = 40
"""Holes that the table lists; `--json` has all."""


def predict_command(
    kind: Annotated[
        str,
        typer.Argument(help=f"What to predict: {', '.join(entries(Place))}; or flight, the navigation along a plan."),
        Selectable(lists="predictions"),
    ],
    constellation: Annotated[
        list[str],
        typer.Argument(
            help="YUMA or SEM almanac, RINEX navigation file, or gps, galileo, beidou (nominal, of no date); of a flight the PLAN.toml."
        ),
        Selectable(lists="constellations", files=True),
    ],
    at: Annotated[
        list[str] | None,
        typer.Option("--at", help="LAT,LON[,H] in degrees and metres, or a runway (LFPG/08R); may be repeated."),
        Selectable(search="runways", typed=True),
    ] = None,
    route: Annotated[list[Path] | None, typer.Option(help="Route file (.toml, .csv): every point of it counts; may be repeated.")] = None,
    date: Annotated[
        str | None,
        typer.Option(help="Start, UTC: 2026-11-22 or 2026-11-22T06:00. [default: the reference instant of the orbits]"),
        Selectable(first=True),
    ] = None,
    hours: Annotated[float, typer.Option(help="Length.")] = 24.0,
    every_s: Annotated[float, typer.Option(help="Step between instants.")] = 60.0,
    spec: Annotated[
        list[str] | None,
        typer.Option(help="RNP 0.3, RNP 1, ... or a service level (NPA); may be repeated. [default: RNP 0.3, RNP 1]"),
        Selectable(lists="limits", typed=True),
    ] = None,
    without: Annotated[list[str] | None, typer.Option(help="Satellite out of service (a NANU), as G05; may be repeated.")] = None,
    systems: Annotated[
        str | None, typer.Option(help="Constellations that the receiver uses, letters of GEC. [default: G, and nominal ones as named]")
    ] = None,
    mask_deg: Annotated[float, typer.Option(help="Lowest elevation used.")] = 5.0,
    model: Annotated[
        str, typer.Option(help="Error of a range: single-frequency, dual-frequency."), Selectable(lists="models")
    ] = "single-frequency",
    out: Annotated[
        Path | None, typer.Option("--out", help="Of a flight: folder for record, epoch table and page."), Written("kind", "flights")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Say when, over a day, a monitor on board could not detect or not exclude a faulty satellite at a place or on a route."""
    from navbound import raim  # noqa: PLC0415
    from navbound.run import predict as predict_raim  # noqa: PLC0415

    if kind == "flight":
        unused = {"at": at, "route": route, "date": date, "spec": spec, "without": without, "systems": systems}
        predict_flight_command(list(constellation), unused, out, json)
        return
    if out is not None:
        raise ConflictError("out", because=f"only a flight leaves a folder; --json prints the result of {kind}", value=out)
    entry(Place, "kind", kind)
    if model not in raim.ERROR_MODELS:
        raise InputError("model", model, domain=f"one of {', '.join(raim.ERROR_MODELS)}")
    request = predict_raim.Request(
        constellation=tuple(constellation),
        times=_times(date, hours, every_s),
        limits=tuple(spec) if spec else ("RNP 0.3", "RNP 1"),
        without=tuple(without or ()),
        systems=systems,
        mask_rad=math.radians(mask_deg),
        model=model,
        kind=kind,
    )
    places = [predict_raim.place(text) for text in at or ()] + [predict_raim.route(file) for file in route or ()]
    prediction = call("predict", predict_raim.predict, request, places, command=command_line())
    if json:
        sys.stdout.write(prediction.model_dump_json(indent=1) + "\n")
        return
    _show(prediction)


def _times(date: str | None, hours: float, every_s: float) -> Times:
    from navbound.maps.sources import Times  # noqa: PLC0415
    from navbound.time import gps_ns  # noqa: PLC0415

    if date is None:
        return Times(None, hours * 3600.0, every_s)
    try:
        when = datetime.fromisoformat(date)
    except ValueError as e:
        raise InputError("date", date, domain="a date, or a date and time, as 2026-11-22T06:00") from e
    return Times(gps_ns(when if when.tzinfo else when.replace(tzinfo=UTC)), hours * 3600.0, every_s)


def _show(prediction: Prediction) -> None:
    from navbound import gnss  # noqa: PLC0415
    from navbound.run.verdict.numbers import length, share  # noqa: PLC0415

    out = out_console
    span = "from the reference instant of the orbits" if prediction.times.start_utc is None else f"from {prediction.times.start_utc} UTC"
    gone = f", without {', '.join(prediction.without)}" if prediction.without else ""
    systems = ", ".join(words for letter, words in gnss.SYSTEMS.items() if any(s[0] == letter for s in prediction.satellites))
    out.print(
        f"{prediction.kind.upper()}, {len(prediction.satellites)} satellites of {systems} ({', '.join(prediction.orbits)}){gone}",
        style="bold",
        markup=False,
        highlight=False,
    )
    out.print(f"{prediction.times.duration_s / 3600:g} h {span}, every {prediction.times.step_s:g} s", markup=False, highlight=False)
    table = Table()
    for heading in ("where", "required", "alert limit", "detection", "holes", "longest", "exclusion", "holes", "longest"):
        table.add_column(heading, overflow="fold")
    limits = {limit.id: limit for limit in prediction.limits}
    for line in prediction.lines:
        hal = limits[line.limit]
        table.add_row(
            line.place,
            line.limit,
            f"{length(hal.hal_m)} ({hal.provenance})",
            share(line.p_detection),
            str(line.n_holes_detection),
            _lasting(line.longest_detection_s),
            "-" if line.p_exclusion is None else share(line.p_exclusion),
            "-" if line.n_holes_exclusion is None else str(line.n_holes_exclusion),
            "-" if line.longest_exclusion_s is None else _lasting(line.longest_exclusion_s),
        )
    out.print(table)
    for hole in prediction.holes[:LISTED]:
        out.print(f"  {_words(hole)}", markup=False, highlight=False)
    if len(prediction.holes) > LISTED:
        out.print(f"  ... and {len(prediction.holes) - LISTED} more holes; --json has all.", highlight=False)
    for assumption in prediction.assumptions:
        out.print(f"  - {assumption}", markup=False, highlight=False)


def _lasting(seconds: float) -> str:
    return "-" if seconds == 0 else f"{seconds / 60:g} min"


def _words(hole: Hole) -> str:
    from navbound.run.verdict.numbers import length  # noqa: PLC0415

    if hole.start_utc is None or hole.end_utc is None:
        when = f"+{_clock(hole.start_s)} to +{_clock(hole.end_s)}"
    else:
        when = f"{hole.start_utc} to {hole.end_utc} UTC"
    level = "no level" if hole.level_max_m is None else f"level up to {length(hole.level_max_m)}"
    cut = ", at an end of the prediction" if hole.cut else ""
    return f"{when}: no {hole.function} for {hole.limit} at {hole.place} ({hole.n_sv_least} satellites, {level}{cut})"


def _clock(seconds: float) -> str:
    whole = round(seconds)
    return f"{whole // 3600:02d}:{whole % 3600 // 60:02d}:{whole % 60:02d}"
