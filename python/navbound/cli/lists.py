"""`navbound methods` and `navbound levels`: what there is, with source and provenance."""

from __future__ import annotations

import json as encoder
import sys

from navbound.algorithms import algorithms
from navbound.cli.parts import Json, out_console


def methods_command(json: Json = False) -> None:
    """List every method with its source, provenance and promises."""
    from navbound.methods import methods as all_methods  # noqa: PLC0415

    entries, levels = list(all_methods().values()), [algorithm.declared for algorithm in algorithms().values()]
    if json:
        both = {"methods": [m.__dict__ for m in entries], "protection_levels": [p.__dict__ for p in levels]}
        sys.stdout.write(encoder.dumps(both, indent=1) + "\n")
        return
    from rich.table import Table  # noqa: PLC0415

    table = Table(title="Methods", show_lines=True)
    for heading in ("id", "what", "bounds |…|", "source", "provenance", "assumes", "may alert"):
        table.add_column(heading, overflow="fold")
    for m in entries:
        table.add_row(m.id, m.title, m.error_column, m.source, m.provenance, m.assumes, "yes" if m.may_alert else "no")
    out_console.print(table)
    table = Table(title="Protection levels", show_lines=True)
    for heading in ("id", "what", "source", "provenance", "covers", "assumes", "integrity"):
        table.add_column(heading, overflow="fold")
    for p in levels:
        table.add_row(p.id, p.title, p.source, p.provenance, p.covers, p.assumes, "yes" if p.integrity else "no, experimental")
    out_console.print(table)


def levels_command(json: Json = False) -> None:
    """List the service levels with their limits, source and provenance."""
    from navbound import kpi  # noqa: PLC0415

    levels = list(kpi.levels().values())
    if json:
        sys.stdout.write(encoder.dumps([level.model_dump() for level in levels], indent=1) + "\n")
        return
    from rich.table import Table  # noqa: PLC0415

    table = Table(title="Service levels")
    for heading in ("id", "operation", "HAL, m", "VAL, m", "accuracy H/V, m", "time to alert, s", "limits", "source"):
        table.add_column(heading, overflow="fold")
    for level in levels:
        vertical, accuracy_v = ("-" if value is None else f"{value:g}" for value in (level.val_m, level.accuracy_v_m))
        accuracy = f"{level.accuracy_h_m:g} / {accuracy_v}"
        table.add_row(
            level.id, level.title, f"{level.hal_m:g}", vertical, accuracy, f"{level.tta_s:g}", level.provenance["hal_m"], level.source
        )
    out_console.print(table)
