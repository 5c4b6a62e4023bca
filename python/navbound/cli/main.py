"""The command line. What its exit statuses mean stands in exit_status.py."""

from __future__ import annotations

import json as encoder
import math
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import navbound
from navbound import _core
from navbound.algorithms import Recorded, algorithms, entries
from navbound.cli import live, maps, predict, procedures
from navbound.cli.parts import Backend, Bar, Checkpoint, Cluster, Json, NWorkers, command_line, err_console, out_console, work_of
from navbound.errors import FormatError, InputError, InternalError, NavboundError
from navbound.exit_status import OUR_BUG, UNREADABLE, USAGE, listed, of_verdict
from navbound.run.settings import DEFAULT_METHODS, Settings
from navbound.storage.packed import require_there

if TYPE_CHECKING:
    from rich.table import Table

    from navbound.kpi import SubsetOptions
    from navbound.run.directory import Run
    from navbound.verify import Outcome

app = typer.Typer(
    help=f"How wrong an aircraft's position may be, and when that is not good enough.\n\nExit status: {listed()}.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(value: bool) -> None:
    if value:
        sys.stdout.write(f"navbound {navbound.__version__}\n")
        raise typer.Exit


@app.callback()
def _about(
    version: Annotated[bool, typer.Option("--version", help="Print the version, nothing else.", callback=_version, is_eager=True)] = False,
) -> None:
    pass


LISTED_FAULTS = 10
"""Faults that are said at the end of a run; all of them are in its records."""

Out = Annotated[Path | None, typer.Option("--out", help="Run directory to write. [default: out/<name>]")]
Methods = Annotated[str, typer.Option("--methods", help="Comma-separated method ids; see `navbound methods`.")]


def _settings(methods: str) -> Settings:
    ids = tuple(m.strip() for m in methods.split(",") if m.strip())
    return Settings(methods=ids)


def _mapping(pairs: list[str]) -> dict[str, str]:
    """`--map canonical=column[:unit]`, as often as it was given."""
    split = [pair.partition("=") for pair in pairs]
    for pair, (name, sign, column) in zip(pairs, split, strict=True):
        if not (name and sign and column):
            raise InputError("map", pair, domain="canonical=column or canonical=column:unit")
    return {name: column for name, _, column in split}


@app.command()
def fly(
    scenario: Annotated[str, typer.Argument(help="A shipped scenario (beijing-shanghai, barcelona-taxi) or a TOML file.")],
    flights: Annotated[int, typer.Option(help="How many flights, with random streams of their own.")] = 1,
    seed: Annotated[int | None, typer.Option(help="Overrides the scenario's seed.")] = None,
    methods: Methods = ",".join(DEFAULT_METHODS),
    backend: Backend = None,
    workers: NWorkers = None,
    cluster: Cluster = None,
    checkpoint: Checkpoint = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Fly a scenario, judge every epoch, write the report."""
    out = out or Path("out") / Path(scenario).stem
    work = work_of(backend, workers, cluster, checkpoint)
    with Bar("flights") as work["progress"]:
        run = navbound.fly(scenario, flights=flights, seed=seed, settings=_settings(methods), out=out, command=command_line(), **work)
    _show(run, json=json)


@app.command()
def analyze(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Tables (CSV, Parquet, JSON), RTKLIB .pos files, receiver logs (UBX, SBF, NMEA, NovAtel), RINEX observations with "
            "navigation files; plain, gzip, compress (.Z) or zip."
        ),
    ],
    path: Annotated[
        str | None,
        typer.Option(help="Where the aircraft should be: a runway (LFPG/08R), auto (the runway each aircraft lands on), or a route file."),
    ] = None,
    procedure: Annotated[
        str | None,
        typer.Option(
            help="Instead of --path: AIRPORT/PROCEDURE[:TRANSITION] of --database, such as KDEN/H26-Z:FUZZZ; "
            "each leg has its own RNP, and --spec has no part in it."
        ),
    ] = None,
    database: Annotated[Path | None, typer.Option(help="With --procedure: navigation database of ARINC 424.")] = None,
    line: Annotated[str | None, typer.Option(help="With --procedure: line of minima that is flown, such as 'RNP 0.3'.")] = None,
    defaults: Annotated[
        bool, typer.Option("--defaults", help="With --procedure: legs without a coded RNP take the default of the specification.")
    ] = False,
    missed: Annotated[bool, typer.Option("--missed", help="With --procedure: with the missed approach.")] = False,
    spec: Annotated[str, typer.Option(help="Navigation specification, such as 'RNP 0.3', 'RNP AR 0.1' or 'RNP APCH'.")] = "RNP 0.3",
    truth: Annotated[
        str | None, typer.Option(help="A file with true positions, joined by time; or X,Y,Z of a fixed point (Earth-fixed, metres).")
    ] = None,
    truth_tolerance_s: Annotated[float | None, typer.Option(help="How far apart in time a truth epoch may be. [default: 0.01]")] = None,
    sigma_m: Annotated[
        float | None, typer.Option(help="Stated standard deviation of the position per axis, where the file has no covariance.")
    ] = None,
    column: Annotated[list[str] | None, typer.Option("--map", help="Column mapping: canonical=column[:unit]; may be repeated.")] = None,
    methods: Methods = ",".join(DEFAULT_METHODS),
    levels: Annotated[
        str | None,
        typer.Option(help="Evaluate protection levels against service levels instead (APV-I,LPV-200,RNP 0.3,...); see `navbound levels`."),
    ] = None,
    prn: Annotated[int | None, typer.Option(help="With --levels: whose SBAS messages, where a log holds several.")] = None,
    period_s: Annotated[float | None, typer.Option(help="With --levels: sampling period. [default: the usual step]")] = None,
    exclude_missing: Annotated[bool, typer.Option("--exclude-missing", help="With --levels: absent epochs are not expected.")] = False,
    stanford_esa: Annotated[
        bool,
        typer.Option("--stanford-esa", help="With --levels, observations and --truth: every subset of satellites as a point of its own."),
    ] = False,
    min_satellites: Annotated[int | None, typer.Option(help="With --stanford-esa: fewest satellites of a subset. [default: 4]")] = None,
    max_satellites: Annotated[
        int | None,
        typer.Option(
            help="With --stanford-esa: at most 2 to this power subsets an epoch; beyond, fewer satellites are left out. [default: 14]"
        ),
    ] = None,
    listed_from: Annotated[
        float | None, typer.Option(help="With --stanford-esa: safety index from which a subset is listed. [default: 0.7]")
    ] = None,
    experimental: Annotated[
        str, typer.Option(help="With --levels: words beside levels that no integrity rests on ('experimental, not integrity').")
    ] = "",
    solve: Annotated[
        bool, typer.Option("--solve", help="Solve positions from the raw measurements of receiver logs instead of taking the receiver's.")
    ] = False,
    signals: Annotated[
        str | None,
        typer.Option(
            help="Measurements to solve: single (L1, E1, B1I), dual (ionosphere-free pairs), or auto, the smaller declared covariance. "
            "[default: auto; with --levels single]"
        ),
    ] = None,
    systems: Annotated[
        str | None, typer.Option(help="Constellations to solve from: letters of GEC. [default: GEC; with --levels G]")
    ] = None,
    ionosphere: Annotated[
        str | None,
        typer.Option(
            help="Model of single signals: broadcast (GPS message), galileo (NTCM-G by Galileo's message), climatology, none, or auto, the "
            "first of these that the navigation files have. [default: auto]"
        ),
    ] = None,
    mask: Annotated[
        float | None, typer.Option(help="Lowest elevation of satellites to solve from, degrees, 0 to below 90. [default: 5]")
    ] = None,
    protection: Annotated[
        str | None,
        typer.Option(help=f"With --levels: protection levels of observations from given (the files), {', '.join(entries(Recorded))}."),
    ] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Judge recorded tracks against a path and a specification; with --levels, evaluate errors and protection levels.

    With --levels the files are tables with protection levels (any number, joined by time), or RINEX observations with navigation files and,
    where a service corrects them, SBAS message logs; without messages the levels are the position's own and experimental. With --solve a
    receiver's log may be all three. A run that was interrupted goes on when it is started again with the same --out.
    """
    out = out or Path("out") / files[0].name.split(".")[0]
    mask_rad = _mask_rad(mask)
    tolerance: dict[str, Any] = {} if truth_tolerance_s is None else {"truth_tolerance_s": truth_tolerance_s}
    subsets = _subsets(min_satellites, max_satellites, listed_from, asked=stanford_esa)
    flown = procedures.flown(procedure, database, line, defaults=defaults, missed=missed)
    against: dict[str, Any] = {} if flown is None else {"procedure": flown}
    require_there(files)
    if levels is not None:
        if flown is not None:
            raise InputError("procedure", procedure, domain="it without --levels, which judges no track")
        if path is not None or sigma_m is not None:
            raise InputError("levels", levels, domain="it without --path and --sigma-m, which judge a track")
        with Bar("files") as progress:
            run = navbound.analyze(
                files,
                levels=levels,
                truth=truth,
                **tolerance,
                columns=_mapping(column or []),
                prn=prn,
                period_s=period_s,
                exclude_missing=exclude_missing,
                stanford_esa=subsets,
                experimental=experimental,
                solve=solve,
                signals=signals,
                systems=systems,
                ionosphere=ionosphere,
                mask_rad=mask_rad,
                protection=protection or "given",
                out=out,
                progress=progress,
                command=command_line(),
            )
        _show(run, json=json)
        return
    if prn is not None or period_s is not None or exclude_missing or stanford_esa or experimental or protection:
        domain = "--levels together with --prn, --period-s, --exclude-missing, --stanford-esa, --experimental and --protection"
        raise InputError("levels", "none", domain=domain)
    run = navbound.analyze(
        files,
        path=path,
        **against,
        spec=spec,
        truth=truth,
        **tolerance,
        sigma_m=sigma_m,
        columns=_mapping(column or []),
        solve=solve,
        signals=signals,
        systems=systems,
        ionosphere=ionosphere,
        mask_rad=mask_rad,
        settings=_settings(methods),
        out=out,
        command=command_line(),
    )
    _show(run, json=json)


def _mask_rad(mask_deg: float | None) -> float | None:
    """The elevation mask; refused here in the unit that it was typed in."""
    if mask_deg is None:
        return None
    if not 0 <= mask_deg < 90:
        raise InputError("mask", mask_deg, "deg", "[0, 90)")
    return math.radians(mask_deg)


def _subsets(min_satellites: int | None, max_satellites: int | None, listed_from: float | None, *, asked: bool) -> SubsetOptions | None:
    """Options of subsets; refused where no subsets are asked for, since they would do nothing."""
    given = {"min_satellites": min_satellites, "max_satellites": max_satellites, "listed_from": listed_from}
    known = {name: value for name, value in given.items() if value is not None}
    if asked:
        from navbound.kpi import SubsetOptions  # noqa: PLC0415

        return SubsetOptions(**known)  # type: ignore[arg-type]
    for name, value in known.items():
        raise InputError(name, value, domain="it together with --stanford-esa: without subsets of satellites it would do nothing")
    return None


@app.command()
def study(
    name: Annotated[
        str,
        typer.Argument(
            help="anp-comparison, decorrelation-time, error-extraction, fault-campaign, healthy-flights, "
            "multipath-time-constants, surface-movement, "
            "tse-coverage, ukraine-rnav"
        ),
    ],
    files: Annotated[list[Path] | None, typer.Argument(help="Recorded data or a configuration, for a study that takes some.")] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", help="Directory to write, for a study of a flight (ukraine-rnav) or with a page (fault-campaign, surface-movement)."
        ),
    ] = None,
    backend: Backend = None,
    workers: NWorkers = None,
    cluster: Cluster = None,
    checkpoint: Checkpoint = None,
    json: Json = False,
) -> None:
    """Repeat a published evaluation and say which of its numbers come out.

    Who works and what is kept can be chosen for studies that are cut into parts: anp-comparison, fault-campaign, healthy-flights,
    tse-coverage.
    """
    work = work_of(backend, workers, cluster, checkpoint)
    with Bar(name) as work["progress"]:
        result = navbound.study(name, files or [], out=out, **work)
    if json:
        sys.stdout.write(result.model_dump_json(indent=1) + "\n")
    else:
        out_console.print(result.table())


@app.command()
def methods(json: Json = False) -> None:
    """List every method with its source, provenance and promises."""
    from navbound.methods import methods as all_methods  # noqa: PLC0415

    found, levels = list(all_methods().values()), [algorithm.declared for algorithm in algorithms().values()]
    if json:
        both = {"methods": [m.__dict__ for m in found], "protection_levels": [p.__dict__ for p in levels]}
        sys.stdout.write(encoder.dumps(both, indent=1) + "\n")
        return
    from rich.table import Table  # noqa: PLC0415

    table = Table(title="Methods", show_lines=True)
    for heading in ("id", "what", "bounds |…|", "source", "provenance", "assumes", "may alert"):
        table.add_column(heading, overflow="fold")
    for m in found:
        table.add_row(m.id, m.title, m.error_column, m.source, m.provenance, m.assumes, "yes" if m.may_alert else "no")
    out_console.print(table)
    table = Table(title="Protection levels", show_lines=True)
    for heading in ("id", "what", "source", "provenance", "covers", "assumes", "integrity"):
        table.add_column(heading, overflow="fold")
    for p in levels:
        table.add_row(p.id, p.title, p.source, p.provenance, p.covers, p.assumes, "yes" if p.integrity else "no, experimental")
    out_console.print(table)


@app.command()
def levels(json: Json = False) -> None:
    """List the service levels with their limits, source and provenance."""
    from navbound import kpi  # noqa: PLC0415

    found = list(kpi.levels().values())
    if json:
        sys.stdout.write(encoder.dumps([level.model_dump() for level in found], indent=1) + "\n")
        return
    from rich.table import Table  # noqa: PLC0415

    table = Table(title="Service levels")
    for heading in ("id", "operation", "HAL, m", "VAL, m", "accuracy H/V, m", "time to alert, s", "limits", "source"):
        table.add_column(heading, overflow="fold")
    for level in found:
        vertical, accuracy_v = ("-" if value is None else f"{value:g}" for value in (level.val_m, level.accuracy_v_m))
        accuracy = f"{level.accuracy_h_m:g} / {accuracy_v}"
        table.add_row(
            level.id, level.title, f"{level.hal_m:g}", vertical, accuracy, f"{level.tta_s:g}", level.provenance["hal_m"], level.source
        )
    out_console.print(table)


@app.command()
def verify(json: Json = False) -> None:
    """Run the reference vectors on this machine; exit status 70 if one fails."""
    from navbound import verify as vectors  # noqa: PLC0415

    outcomes = [vectors.run(file) for file in vectors.files()]
    failures = [f"{o.file.id}: {text}" for o in outcomes for text in o.failures]
    if json:
        rows = [
            {
                "id": o.file.id,
                "function": f"navbound.{o.file.call}",
                "source": o.file.source,
                "provenance": o.file.provenance,
                "n_cases": o.checked,
                "worst_relative": o.worst_relative,
                "worst_share_of_tolerance": o.worst_share,
                "failures": o.failures,
            }
            for o in outcomes
        ]
        sys.stdout.write(encoder.dumps(rows, indent=1) + "\n")
    else:
        out_console.print(_verified(outcomes))
        out_console.print(f"{sum(o.checked for o in outcomes)} cases of {len(outcomes)} files, {len(failures)} failures.")
        for text in failures[:20]:
            err_console.print(text, markup=False)
    if failures or not outcomes:
        raise typer.Exit(OUR_BUG)


def _verified(outcomes: list[Outcome]) -> Table:
    from rich.table import Table  # noqa: PLC0415

    table = Table(title=f"navbound {navbound.__version__}: reference vectors on this machine")
    table.add_column("vectors", no_wrap=True)
    table.add_column("function", no_wrap=True)
    table.add_column("checked against", overflow="fold", ratio=1)
    for heading in ("cases", "worst relative", "of tolerance"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for o in outcomes:
        verdict = "ok" if not o.failures else f"{len(o.failures)} FAILED"
        against = f"{o.file.source} ({o.file.provenance})"
        share = f"{100 * o.worst_share:.2g} %"
        table.add_row(o.file.id, o.file.call, against, str(o.checked), f"{o.worst_relative:.1e}", share, verdict)
    return table


@app.command()
def show(
    run_directory: Annotated[Path, typer.Argument(help="A run directory.")],
    json: Json = False,
) -> None:
    """Print the verdict of a finished run."""
    from navbound.run import directory  # noqa: PLC0415

    _show(directory.load(run_directory), json=json)


app.command("map")(maps.map_command)
app.command("predict")(predict.predict_command)
app.add_typer(procedures.app, name="procedures")
app.add_typer(live.app, name="live")


def _show(run: Run, *, json: bool) -> None:
    """Print a run and end with the status of its verdict."""
    if json:
        sys.stdout.write(run.summary.model_dump_json(indent=1) + "\n")
    else:
        _print(run)
    verdict = run.summary.verdict
    status = of_verdict(verdict.id, None if verdict.belief is None else verdict.belief.state)
    if status:
        raise typer.Exit(status)


def _print(run: Run) -> None:
    summary = run.summary
    out_console.print(summary.title, style="bold", markup=False)
    out_console.print(summary.verdict.words, markup=False, highlight=False)
    out_console.print("Assumed and found:", markup=False)
    for assumption in summary.assumptions:
        out_console.print(f"  - {assumption}", markup=False, highlight=False)
    rejected = sum(r.count for r in summary.rejected)
    if rejected:
        out_console.print(f"{rejected} rows or records were not used:", markup=False)
        for r in summary.rejected:
            where = "" if r.first_line is None else f", first in line {r.first_line}: {r.example}"
            out_console.print(f"  {r.count} x {r.reason} ({Path(r.file).name}{where})", markup=False, highlight=False)
    if summary.tracks:
        cautions, warnings = (sum(getattr(t, n) for t in summary.tracks) for n in ("n_cautions", "n_warnings"))
        unavailable = sum(t.n_unavailable for t in summary.tracks)
        out_console.print(
            f"Alerts: {cautions} cautions, {warnings} warnings, {unavailable} losses of monitoring, over {len(summary.tracks)} tracks."
        )
        for fault in summary.faults[:LISTED_FAULTS]:
            out_console.print(f"{fault.track}, {fault.kind}: {fault.words}", markup=False, highlight=False)
        if len(summary.faults) > LISTED_FAULTS:
            out_console.print(f"... and {len(summary.faults) - LISTED_FAULTS} more in summary.json.")
    if run.path is not None:
        out_console.print(f"Report: {run.report.resolve()}", markup=False, highlight=False, soft_wrap=True)


def main() -> None:
    """Entry point: every refusal is a sentence, every surprise is ours."""
    try:
        status = app(standalone_mode=False)
        sys.exit(status if isinstance(status, int) else 0)
    except typer.Abort:
        sys.exit(130)
    except KeyboardInterrupt:
        sys.exit(130)
    except InternalError as e:
        if os.environ.get("NAVBOUND_TRACEBACK"):
            raise
        _die(f"{e} (set NAVBOUND_TRACEBACK=1 for the traceback)", OUR_BUG)
    except FormatError as e:
        _die(str(e), UNREADABLE)
    except (InputError, NavboundError) as e:
        _die(str(e), USAGE)
    except MemoryError:
        _die("the data need more memory than there is", UNREADABLE)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (Exception, _core.PanicException) as e:
        if hasattr(e, "format_message"):  # a usage error of the command-line parser
            _die(e.format_message(), USAGE)
        if os.environ.get("NAVBOUND_TRACEBACK"):
            raise
        _die(f"this is a bug in navbound, please report it: {type(e).__name__}: {e} (set NAVBOUND_TRACEBACK=1 for the traceback)", OUR_BUG)


def _die(message: str, status: int) -> None:
    err_console.print(f"navbound: {message}", markup=False, highlight=False, soft_wrap=True)
    sys.exit(status)
