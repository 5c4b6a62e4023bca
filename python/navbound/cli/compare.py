"""`navbound compare`: which numbers moved from one run to another, and which epochs changed their alert."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from navbound.cli.calls import call
from navbound.cli.choices import Selectable, Written
from navbound.cli.parts import Json, out_console

if TYPE_CHECKING:
    from navbound.records.comparison import Comparison

RECORD, PAGE = "comparison.json", "comparison.html"
LISTED = 12
"""Numbers that are printed; all of them are on the page."""


def compare_command(
    a: Annotated[Path, typer.Argument(help="A run directory: before."), Selectable(runs=True)],
    b: Annotated[Path, typer.Argument(help="Another one: after."), Selectable(runs=True)],
    out: Annotated[
        Path | None,
        typer.Option("--out", help="Folder for the page and the record. [default: out/compare-<a>-<b>; none with --json]"),
        Written(),
    ] = None,
    json: Json = False,
) -> None:
    """Compare two finished runs: which numbers moved, and which epochs changed their alert."""
    from navbound.run.comparison.compare import compare  # noqa: PLC0415

    record = call("compare", compare, a, b)
    folder = out or (None if json else Path("out") / f"compare-{a.resolve().name}-{b.resolve().name}")
    if folder is not None:
        _write(record, folder)
    if json:
        sys.stdout.write(record.model_dump_json(indent=1) + "\n")
        return
    from navbound.report.comparison import number  # noqa: PLC0415

    for sentence in record.words:
        out_console.print(sentence, markup=False, highlight=False)
    for one in record.numbers[:LISTED]:
        out_console.print(f"  {one.group}, {one.name}: {number(one.a)} to {number(one.b)}", markup=False, highlight=False)
    if len(record.numbers) > LISTED:
        out_console.print(f"  ... and {len(record.numbers) - LISTED} more on the page.", markup=False, highlight=False)
    if folder is not None:
        out_console.print(f"Page: {(folder / PAGE).resolve()}", markup=False, highlight=False, soft_wrap=True)


def _write(record: Comparison, folder: Path) -> None:
    from navbound.report import comparison  # noqa: PLC0415
    from navbound.storage import folders  # noqa: PLC0415

    with folders.own(folder, {RECORD, PAGE}, "a comparison's") as writer:
        writer.text(RECORD, record.model_dump_json(indent=1))
        writer.text(PAGE, comparison.page(record))
