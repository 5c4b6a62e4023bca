"""`navbound fly`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import navbound
from navbound.cli.calls import call
from navbound.cli.choices import Selectable
from navbound.cli.parts import Backend, Bar, Checkpoint, Cluster, Json, NWorkers, Out, command_line, work_of
from navbound.cli.show import show
from navbound.run.settings import DEFAULT_METHODS, Settings

DEFAULT = ",".join(DEFAULT_METHODS)
Methods = Annotated[
    str,
    typer.Option("--methods", help="Comma-separated method ids; see `navbound methods`."),
    Selectable(lists="methods", commas=True),
]


def settings_of(methods: str) -> Settings:
    """Settings with these methods."""
    ids = tuple(m.strip() for m in methods.split(",") if m.strip())
    return Settings(methods=ids)


def fly_command(
    scenario: Annotated[str, typer.Argument(help="A shipped scenario (beijing-shanghai, barcelona-taxi) or a TOML file.")],
    flights: Annotated[int, typer.Option(help="How many flights, with random streams of their own.")] = 1,
    seed: Annotated[int | None, typer.Option(help="Overrides the scenario's seed.")] = None,
    methods: Methods = DEFAULT,
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
        run = call(
            "navbound.fly",
            navbound.fly,
            scenario,
            flights=flights,
            seed=seed,
            settings=settings_of(methods),
            out=out,
            command=command_line(),
            **work,
        )
    show(run, json=json)
