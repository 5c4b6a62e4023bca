"""`navbound open`: the workbench in the browser."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from navbound.cli.parts import err_console, out_console, stop_requested

if TYPE_CHECKING:
    from collections.abc import Callable


def open_command(
    folder: Annotated[Path, typer.Argument(help="Folder with your files; runs are written there, in out/.")] = Path(),
    port: Annotated[int, typer.Option(help="Port of this host; 0: one that is free.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in the browser of this machine.")] = True,
) -> None:
    """Open the workbench: a page of this machine on which files are dropped, jobs chosen and started, and reports read. Ctrl-C ends it."""
    from navbound import workbench  # noqa: PLC0415 - loads what no other command needs
    from navbound.cli import analyze, compare, evaluate, forms, maps, predict, study  # noqa: PLC0415
    from navbound.serve.service import Options  # noqa: PLC0415

    commands: dict[str, Callable[..., None]] = {
        "analyze": analyze.analyze_command,
        "evaluate": evaluate.evaluate_command,
        "map": maps.map_command,
        "predict": predict.predict_command,
        "study": study.study_command,
        "compare": compare.compare_command,
    }
    settings = workbench.Settings(folder.resolve(), [forms.form(name, command) for name, command in commands.items()])

    def ready(server: workbench.Server) -> None:
        out_console.print(f"Workbench of {server.folder}: {server.address}", markup=False, highlight=False, soft_wrap=True)
        out_console.print("Ctrl-C ends it, and the jobs that still run.", markup=False, highlight=False)
        if browser and not webbrowser.open(server.address):
            err_console.print("navbound: no browser was found on this machine: open the address in one", markup=False, soft_wrap=True)

    workbench.serve(settings, Options(port), ready=ready, stop=stop_requested())
