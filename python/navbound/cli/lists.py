"""`navbound methods`, `navbound levels` and `navbound scenarios`: what there is, with source and provenance."""

from __future__ import annotations

import json as encoder
import sys
from typing import TYPE_CHECKING

from navbound.algorithms import algorithms
from navbound.cli.parts import Json, out_console

if TYPE_CHECKING:
    from collections.abc import Sequence


def methods_command(json: Json = False) -> None:
    """List every method with its source, provenance and promises."""
    from navbound.methods import methods as all_methods  # noqa: PLC0415

    entries, levels = list(all_methods().values()), [algorithm.declared for algorithm in algorithms().values()]
    if json:
        from navbound.cli.printed import Methods, write  # noqa: PLC0415

        write(Methods(entries, levels))
        return
    print_list(
        "Methods",
        ("id", "what", "bounds |…|", "source", "provenance", "assumes", "may alert"),
        [(m.id, m.title, m.error_column, m.source, m.provenance, m.assumes, "yes" if m.may_alert else "no") for m in entries],
    )
    print_list(
        "Protection levels",
        ("id", "what", "source", "provenance", "covers", "assumes", "integrity"),
        [(p.id, p.title, p.source, p.provenance, p.covers, p.assumes, "yes" if p.integrity else "no, experimental") for p in levels],
    )


def levels_command(json: Json = False) -> None:
    """List the service levels with their limits, source and provenance."""
    from navbound import kpi  # noqa: PLC0415

    levels = list(kpi.levels().values())
    if json:
        sys.stdout.write(encoder.dumps([level.model_dump() for level in levels], indent=1) + "\n")
        return
    rows = []
    sources = list(dict.fromkeys(level.source for level in levels))
    for level in levels:
        vertical, accuracy_v = ("-" if value is None else f"{value:g}" for value in (level.val_m, level.accuracy_v_m))
        accuracy = f"{level.accuracy_h_m:g} / {accuracy_v}"
        numbers = (f"{level.hal_m:g}", vertical, accuracy, f"{level.tta_s:g}")
        rows.append((level.id, level.title, *numbers, level.provenance["hal_m"], f"[{sources.index(level.source) + 1}]"))
    headings = ("id", "operation", "HAL, m", "VAL, m", "accuracy H/V, m", "time to alert, s", "limits", "source")
    print_list("Service levels", headings, rows)
    for number, source in enumerate(sources, 1):
        out_console.print(f"\n[{number}] {source}", markup=False, highlight=False)


def scenarios_command(json: Json = False) -> None:
    """List the scenarios that ship with navbound: `navbound fly NAME` flies one."""
    from navbound import scenario  # noqa: PLC0415

    shipped = {name: scenario.read(name) for name in scenario.shipped()}
    if json:
        from navbound.cli.printed import ListedScenario, write  # noqa: PLC0415

        write([ListedScenario(name, each.kind, each.title) for name, each in shipped.items()])
        return
    print_list("Scenarios", ("name", "kind", "title"), [(name, each.kind, each.title) for name, each in shipped.items()], wide=NARROW)


NARROW, WIDE = 80, 110
"""Columns of a screen from which a list of a few, and of many columns, is a table."""


def print_list(title: str, headings: Sequence[str], rows: Sequence[Sequence[str]], *, wide: int = WIDE) -> None:
    """Print rows: a table where the screen is wide enough for one, otherwise one block a row, its first cell as the heading."""
    from rich.padding import Padding  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    if out_console.width >= wide:
        table = Table(title=title, show_lines=wide > NARROW)
        for k, heading in enumerate(headings):
            table.add_column(heading, overflow="fold", no_wrap=k == 0)
        for row in rows:
            table.add_row(*row)
        out_console.print(table)
        return
    out_console.print(title, style="bold", markup=False, highlight=False)
    for row in rows:
        block = Table.grid(padding=(0, 2))
        for heading, cell in zip(headings[1:], row[1:], strict=True):
            block.add_row(heading, cell)
        out_console.print(f"\n{row[0]}", style="bold", markup=False, highlight=False)
        out_console.print(Padding(block, (0, 0, 0, 2)), markup=False, highlight=False)
