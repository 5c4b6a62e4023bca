"""`navbound example`: files to try navbound on."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from navbound.cli.parts import out_console


def example_command(
    names: Annotated[
        list[str] | None, typer.Argument(help="rinex, ubx, tracks, levels, imu, procedure, plan. [default: all]", show_default=False)
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the files.")] = Path("out/examples"),
) -> None:
    """Make files to try navbound on: simulated, with truth, the same bytes every time."""
    from navbound import examples  # noqa: PLC0415 - loads numbers

    for file in examples.make(names or [], out):
        out_console.print(str(file), markup=False, highlight=False, soft_wrap=True)
    place = ",".join(f"{axis:.4f}" for axis in examples.PLACE_ECEF_M)
    out_console.print(f"The antenna stood at --truth {place}", markup=False, highlight=False, soft_wrap=True)
