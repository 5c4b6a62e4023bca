"""`navbound export`: a finished run for programs that show maps, or that read positions."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from navbound.cli.parts import out_console
from navbound.errors import InputError
from navbound.words.plurals import counted

_ENDINGS = ".geojson, .kml or .pos"


def export_command(
    run_directory: Annotated[Path, typer.Argument(help="A run directory.")],
    file: Annotated[
        Path, typer.Argument(help="What to write: .geojson, .kml (tracks, path, ellipses, events) or .pos (RTKLIB, one track).")
    ],
    track: Annotated[str | None, typer.Option(help="Only this track.")] = None,
    ellipse_every_s: Annotated[float | None, typer.Option(help="Draw the 95 % ellipse of the position so often.")] = None,
) -> None:
    """Write the tracks of a finished run for a map, or as positions for another program."""
    import polars as pl  # noqa: PLC0415

    from navbound import write  # noqa: PLC0415
    from navbound.run import directory  # noqa: PLC0415

    if file.suffix not in {".geojson", ".kml", ".pos"}:
        raise InputError("file", str(file), domain=f"a name that ends in {_ENDINGS}")
    run = directory.load(run_directory)
    epochs = run.epochs
    if track is not None:
        names = epochs["track"].unique(maintain_order=True).to_list() if "track" in epochs.columns else []
        if track not in names:
            raise InputError("track", track, domain=f"one of {', '.join(map(str, names[:8]))}")
        epochs = epochs.filter(pl.col("track") == track)
    if file.suffix == ".pos":
        written = write.rtklib(epochs, file)
        out_console.print(
            f"{counted(written.n_rows, 'position')} written, {counted(written.n_left_out, 'epoch')} without one left out: {file}",
            markup=False,
            highlight=False,
        )
        return
    made = write.shapes(epochs, events=run.events, waypoints=run.waypoints, ellipse_every_s=ellipse_every_s)
    (write.geojson if file.suffix == ".geojson" else write.kml)(made, file)
    out_console.print(
        f"{len(made)} lines, points and ellipses of {counted(epochs.height, 'epoch')} written: {file}", markup=False, highlight=False
    )
