"""`navbound verify`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

import navbound
from navbound.cli.lists import WIDE
from navbound.cli.parts import Json, err_console, out_console
from navbound.exit_status import OUR_BUG
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from rich.table import Table

    from navbound.verify import Outcome


def verify_command(json: Json = False) -> None:
    """Run the reference vectors on this machine; exit status 70 if one fails."""
    from navbound import verify as vectors  # noqa: PLC0415

    files = list(vectors.files())
    if not files:
        err_console.print(f"navbound: {vectors.VECTORS}: this installation has no reference vectors", markup=False, soft_wrap=True)
        raise typer.Exit(OUR_BUG)
    outcomes = [vectors.run(file) for file in files]
    failures = [f"{o.file.id}: {text}" for o in outcomes for text in o.failures]
    if json:
        from navbound.cli.printed import Verified, write  # noqa: PLC0415

        write(
            [
                Verified(
                    id=o.file.id,
                    function=f"navbound.{o.file.call}",
                    source=o.file.source,
                    provenance=o.file.provenance,
                    n_cases=o.checked,
                    worst_relative=o.worst_relative,
                    worst_share_of_tolerance=o.worst_share,
                    failures=o.failures,
                )
                for o in outcomes
            ]
        )
    else:
        out_console.print(_verified(outcomes))
        out_console.print(
            f"{counted(sum(o.checked for o in outcomes), 'case')} of {counted(len(outcomes), 'file')}, {counted(len(failures), 'failure')}."
        )
        for text in failures[:20]:
            err_console.print(text, markup=False)
    if failures:
        raise typer.Exit(OUR_BUG)


def _verified(outcomes: list[Outcome]) -> Table:
    from rich.table import Table  # noqa: PLC0415

    table = Table(title=f"navbound {navbound.__version__}: reference vectors on this machine")
    table.add_column("vectors", no_wrap=True)
    # A narrow screen has room for the numbers alone; --json has all.
    wide = out_console.width >= WIDE
    if wide:
        table.add_column("function", no_wrap=True)
        table.add_column("checked against", overflow="fold", ratio=1)
    for heading in ("cases", "worst relative" if wide else "worst", "of tolerance"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for o in outcomes:
        verdict = "ok" if not o.failures else f"{len(o.failures)} FAILED"
        against = f"{o.file.source} ({o.file.provenance})"
        share = f"{100 * o.worst_share:.2g} %"
        what = (o.file.call, against) if wide else ()
        table.add_row(o.file.id, *what, str(o.checked), f"{o.worst_relative:.1e}", share, verdict)
    return table
