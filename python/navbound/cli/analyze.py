"""`navbound analyze`: tracks against a path and a specification."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

import navbound
from navbound.cli import evaluate, procedures
from navbound.cli.calls import call
from navbound.cli.choices import RUNWAY, Selectable
from navbound.cli.fly import DEFAULT, Methods, settings_of
from navbound.cli.parts import (
    SIGNAL,
    SIGNALS,
    SYSTEMS,
    Bar,
    Columns,
    Files,
    Ionosphere,
    Json,
    Mask,
    Out,
    Solve,
    Truth,
    TruthTolerance,
    command_line,
    err_console,
    mapping,
    mask_rad,
    run_folder,
    tolerance,
)
from navbound.cli.show import show
from navbound.errors import ConflictError

MOVED = "analyze --levels is navbound evaluate --levels; the old spelling goes with the next release"


def analyze_command(
    files: Files,
    path: Annotated[
        str | None,
        typer.Option(help="Where the aircraft should be: a runway (LFPG/08R), auto (the runway each aircraft lands on), or a route file."),
        Selectable(words=("auto",), search="runways", files=True, free=RUNWAY),
    ] = None,
    procedure: Annotated[
        str | None,
        typer.Option(
            help="Instead of --path: AIRPORT/PROCEDURE[:TRANSITION] of --database, such as KDEN/H26-Z:FUZZZ; "
            "each leg has its own RNP, and --spec has no part in it."
        ),
        Selectable(search="procedures", typed=True),
    ] = None,
    database: Annotated[Path | None, typer.Option(help="With --procedure: navigation database of ARINC 424.")] = None,
    line: Annotated[str | None, typer.Option(help="With --procedure: line of minima that is flown, such as 'RNP 0.3'.")] = None,
    defaults: Annotated[
        bool, typer.Option("--defaults", help="With --procedure: legs without a coded RNP take the default of the specification.")
    ] = False,
    missed: Annotated[bool, typer.Option("--missed", help="With --procedure: with the missed approach.")] = False,
    vertical_path: Annotated[
        Literal["barometric", "straight"] | None,
        typer.Option(
            help="With --procedure: barometric (default; a constant slope over the curved Earth, baro-VNAV) or straight (ILS, LPV, GLS)."
        ),
        Selectable(words=("barometric", "straight")),
    ] = None,
    setting_hpa: Annotated[
        float | None,
        typer.Option(help="With --procedure: altimeter setting. Default: what the aircraft broadcasts; without one nothing is said by it."),
    ] = None,
    undulation_m: Annotated[
        float | None,
        typer.Option(help="With --procedure: height of the sea above the ellipsoid. Default: by the two heights of the runway."),
    ] = None,
    spec: Annotated[
        str,
        typer.Option(help="Navigation specification, such as 'RNP 0.3', 'RNP AR 0.1' or 'RNP APCH'."),
        Selectable(lists="specifications", typed=True),
    ] = "RNP 0.3",
    operation: Annotated[
        str | None,
        typer.Option(
            help="en-route, approach or ground. Default: approach with runways or an approach procedure as the path, otherwise en-route."
        ),
        Selectable(words=("en-route", "approach", "ground")),
    ] = None,
    truth: Truth = None,
    truth_tolerance_s: TruthTolerance = None,
    sigma_m: Annotated[
        float | None,
        typer.Option(help="Stated standard deviation of the position per axis, where the file has no covariance."),
        Selectable(first=True),
    ] = None,
    column: Columns = None,
    methods: Methods = DEFAULT,
    solve: Solve = False,
    signals: Annotated[str | None, typer.Option(help=SIGNALS.format("auto")), SIGNAL] = None,
    systems: Annotated[str | None, typer.Option(help=SYSTEMS.format("GEC"))] = None,
    ionosphere: Ionosphere = None,
    mask: Mask = None,
    levels: evaluate.OldLevels = None,
    prn: evaluate.OldPrn = None,
    period_s: evaluate.OldPeriod = None,
    exclude_missing: evaluate.OldExcludeMissing = False,
    stanford_esa: evaluate.OldStanfordEsa = False,
    min_satellites: evaluate.OldMin = None,
    max_satellites: evaluate.OldMax = None,
    listed_from: evaluate.OldListed = None,
    experimental: evaluate.OldExperimental = "",
    protection: evaluate.OldProtection = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Judge recorded tracks against a path and a navigation specification, epoch by epoch."""
    stated = procedures.Stated(line, defaults or None, missed or None, vertical_path, setting_hpa, undulation_m)
    flown = procedures.flown(procedure, database, stated)
    of_levels = evaluate.Options(
        prn, period_s, exclude_missing, stanford_esa, min_satellites, max_satellites, listed_from, experimental, protection
    )
    reading: dict[str, Any] = {
        "truth": truth,
        **tolerance(truth_tolerance_s),
        "columns": mapping(column),
        "solve": solve,
        "signals": signals,
        "systems": systems,
        "ionosphere": ionosphere,
        "mask_rad": mask_rad(mask),
    }
    if levels is not None:
        if flown is not None or path is not None or sigma_m is not None or operation is not None:
            raise ConflictError("levels", excludes=("path", "procedure", "sigma_m", "operation"), because="they judge a track")
        err_console.print(f"navbound: {MOVED}", markup=False, highlight=False, soft_wrap=True)
        evaluate.run(files, levels, of_levels, reading, out, json=json)
        return
    reading |= {} if flown is None else {"procedure": flown}
    of_levels.refuse_any()
    folder = run_folder(files, out)
    with Bar("steps") as progress:
        run = call(
            "navbound.analyze",
            navbound.analyze,
            files,
            path=path,
            spec=spec,
            sigma_m=sigma_m,
            operation=operation,
            settings=settings_of(methods),
            out=folder,
            progress=progress,
            command=command_line(),
            **reading,
        )
    show(run, json=json)
