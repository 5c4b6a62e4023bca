"""`navbound study`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

import navbound
from navbound.cli.calls import call
from navbound.cli.choices import Selectable, Written
from navbound.cli.parts import Backend, Bar, Checkpoint, Cluster, Json, NWorkers, out_console, work_of


def study_command(
    name: Annotated[
        str,
        typer.Argument(
            help="anp-comparison, decorrelation-time, error-extraction, fault-campaign, healthy-flights, "
            "multipath-time-constants, surface-movement, "
            "tse-coverage, ukraine-rnav, vertical-budget"
        ),
        Selectable(lists="studies"),
    ],
    files: Annotated[list[Path] | None, typer.Argument(help="Recorded data or a configuration, for a study that takes some.")] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", help="Directory to write, for a study of a flight (ukraine-rnav) or with a page (fault-campaign, surface-movement)."
        ),
        Written("name", "studies with a folder"),
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
        result = call("navbound.study", navbound.study, name, files or [], out=out, **work)
    if json:
        sys.stdout.write(result.model_dump_json(indent=1) + "\n")
    else:
        out_console.print(result.table())
