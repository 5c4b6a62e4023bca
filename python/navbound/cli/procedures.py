"""`navbound procedures`: what a navigation database holds, one procedure of it, and what contradicts itself."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer
from rich.table import Table

from navbound.cli.parts import Json, err_console, out_console
from navbound.errors import ConflictError, FormatError, InputError
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from navbound.procedures import Database, Procedure
    from navbound.procedures.vertical import Shape
    from navbound.report.procedure import Heights
    from navbound.run.procedure import Flown

KELVIN = 273.15
"""0 °C. [K]"""
app = typer.Typer(help="Published procedures of a navigation database (ARINC 424).", no_args_is_help=True, rich_markup_mode=None)
File = Annotated[Path, typer.Argument(help="Navigation database: ARINC 424, 132 characters a line, plain or gzip.")]


@app.command("list")
def list_command(
    file: File,
    airport: Annotated[str | None, typer.Option(help="Only one airport.")] = None,
    kind: Annotated[str | None, typer.Option(help="Only sid, star or approach.")] = None,
    json: Json = False,
) -> None:
    """List procedures with their transitions and lines of minima."""
    if kind not in {None, "sid", "star", "approach"}:
        raise InputError("kind", str(kind), domain="sid, star or approach")
    database = _read(file)
    shown = [e for e in database.entries if airport in {None, e.airport} and kind in {None, e.kind}]
    if not shown:
        raise InputError("airport", str(airport), domain=f"airports with procedures in {file}")
    if json:
        from navbound.cli.printed import write  # noqa: PLC0415
        from navbound.cli.procedure_records import ProcedureList  # noqa: PLC0415

        write(ProcedureList(str(file), database.header, database.counts, shown))
        return
    table = Table(title=f"{file.name}: {len(shown)} procedure{'s' if len(shown) != 1 else ''}")
    for heading in ("airport", "kind", "procedure", "transitions", "legs", "lines of minima", "line"):
        table.add_column(heading, overflow="fold")
    for e in shown:
        names = ", ".join(dict.fromkeys(r.transition for r in e.routes if r.transition))
        levels = ", ".join(f"RNP {x.rnp_m / METRES_PER_NM:.3g}" for x in e.levels)
        table.add_row(e.airport, e.kind, e.ident, names, str(sum(r.n_legs for r in e.routes)), levels, str(e.line))
    out_console.print(table)
    _say(database)


@app.command("show")
def show_command(
    file: File,
    name: Annotated[str, typer.Argument(help="AIRPORT/PROCEDURE[:TRANSITION], such as KDEN/H26-Z:FUZZZ.")],
    line: Annotated[str | None, typer.Option("--line", help="Line of minima that is flown, such as 'RNP 0.3'.")] = None,
    missed: Annotated[bool, typer.Option("--missed", help="With the missed approach.")] = False,
    defaults: Annotated[bool, typer.Option("--defaults", help="Legs without a coded RNP take the default of the specification.")] = False,
    lowest_c: Annotated[
        float | None,
        typer.Option("--lowest-c", help="Lowest temperature at the threshold in °C, for the obstacle clearance surface of RNP AR."),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="HTML page with plan and profile to write.")] = None,
    json: Json = False,
) -> None:
    """Show the legs of one procedure, its vertical path, and with --out its plan and profile as a page."""
    from navbound.procedures.names import parts  # noqa: PLC0415
    from navbound.report import procedure as drawn  # noqa: PLC0415

    database = _read(file)
    airport, ident, transition = parts(name)
    procedure = database.procedure(airport, ident, transition, missed=missed, line=line, defaults=defaults)
    lines = {x.line for x in procedure.legs} | {x.line for x in procedure.levels}
    findings = [f for f in database.contradictions(airport) if f.procedure == ident and f.line in lines]
    heights = _heights(database, procedure, lowest_c)
    if out is not None:
        _write(out, drawn.page(procedure, findings, heights))
    if json:
        from navbound.cli import printed, procedure_records  # noqa: PLC0415

        record = procedure_records.ShownProcedure(
            name=procedure.name,
            file=procedure.file,
            line=procedure.line,
            length_m=procedure.length_m,
            legs=list(procedure.legs),
            levels=list(procedure.levels),
            notes=[*procedure.notes, *procedure.doubts],
            vertical_path=heights.path,
            obstacle_surface=None if heights.surface is None else procedure_records.ObstacleSurface(**heights.surface._asdict()),
            vertical_words=list(heights.words),
            findings=findings,
        )
        printed.write(record)
        return
    table = Table(
        title=f"{procedure.name}, {procedure.length_m / METRES_PER_NM:.2f} NM" if math.isfinite(procedure.length_m) else procedure.name
    )
    for heading in drawn.HEADINGS:
        table.add_column(heading, overflow="fold")
    for leg in procedure.legs:
        table.add_row(*drawn.cells(leg))
    out_console.print(table)
    for note in drawn.notes(procedure, findings, heights):
        out_console.print(note.text, markup=False, highlight=False)
    if out is not None:
        out_console.print(f"Page: {out.resolve()}", markup=False, highlight=False, soft_wrap=True)


@app.command("check")
def check_command(
    file: File,
    airport: Annotated[str | None, typer.Option(help="Only one airport.")] = None,
    remarks: Annotated[bool, typer.Option("--remarks", help="List remarks too, which contradict nothing.")] = False,
    json: Json = False,
) -> None:
    """Find contradictions in the published data, each with its line."""
    database = _read(file)
    findings = database.contradictions(airport)
    contradictions = [f for f in findings if not f.remark]
    others = Counter(f.kind for f in findings if f.remark)
    if json:
        from navbound.cli.printed import write  # noqa: PLC0415
        from navbound.cli.procedure_records import CheckedProcedures, LocatedFinding  # noqa: PLC0415

        rows = [LocatedFinding(**asdict(f), where=f.where) for f in findings]
        write(CheckedProcedures(str(file), database.counts, database.n_refused, database.refused, rows))
        return
    table = Table(title=f"{file.name}: {len(contradictions)} contradiction{'s' if len(contradictions) != 1 else ''}")
    for heading in ("line", "where", "what"):
        table.add_column(heading, overflow="fold")
    for f in findings if remarks else contradictions:
        table.add_row(str(f.line), f.where, f.words)
    out_console.print(table)
    if others:
        counted = ", ".join(f"{n} {kind}" for kind, n in sorted(others.items()))
        out_console.print(f"Remarks: {counted}" + ("." if remarks else " (--remarks lists them)."), markup=False, highlight=False)
    _say(database)


class Stated(NamedTuple):
    """What a caller of `navbound analyze` states of a procedure; None: nothing."""

    line: str | None
    defaults: bool | None
    missed: bool | None
    vertical_path: Shape | None
    setting_hpa: float | None
    undulation_m: float | None


def flown(name: str | None, database: Path | None, stated: Stated) -> Flown | None:
    """The procedure that `navbound analyze` judges against; options that would do nothing without it are refused."""
    if name is None:
        for option, value in {"database": database, **stated._asdict()}.items():
            if value is not None:
                raise ConflictError(option, needs=("procedure",))
        return None
    if database is None:
        raise ConflictError("procedure", needs=("database",), because="a navigation database (ARINC 424)")
    from navbound.run.procedure import Flown  # noqa: PLC0415

    return Flown(
        database,
        name,
        line=stated.line,
        defaults=bool(stated.defaults),
        missed=bool(stated.missed),
        shape=stated.vertical_path or "barometric",
        setting_hpa=stated.setting_hpa,
        undulation_m=stated.undulation_m,
    )


def _read(file: Path) -> Database:
    from navbound import procedures  # noqa: PLC0415

    return procedures.read(file)


def _heights(database: Database, procedure: Procedure, lowest_c: float | None) -> Heights:
    """Vertical path and obstacle clearance surface of an approach."""
    from navbound.procedures import surface_below, vertical_path  # noqa: PLC0415
    from navbound.procedures.names import as_sentence  # noqa: PLC0415
    from navbound.report.procedure import Heights  # noqa: PLC0415

    if procedure.kind != "approach":
        if lowest_c is not None:
            raise InputError("lowest_c", lowest_c, "°C", "an approach: the surface lies below its final part")
        return Heights(None, None, ())
    path, words = vertical_path(database, procedure)
    sentence = as_sentence(words)
    if path is None:
        return Heights(None, None, (sentence,))
    surface, more = surface_below(path, procedure, None if lowest_c is None else lowest_c + KELVIN)
    return Heights(path, surface, (sentence, more))


def _say(database: Database) -> None:
    for words in database.notes:
        err_console.print(words, markup=False, highlight=False)


def _write(out: Path, page: str) -> None:
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(page, encoding="utf-8")
    except OSError as e:
        raise FormatError(out, f"the page cannot be written: {e.strerror}") from e
