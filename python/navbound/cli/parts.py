"""What the commands share: the screen, the progress bar, and the options that mean the same everywhere.

Nothing here needs numbers or tables: a command loads what it needs when it runs, so that `navbound --help` answers at once.
"""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from navbound.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.progress import Progress, TaskID

    from navbound.scale import Work

PAPER_WIDTH = 140
"""Columns of a table that goes to a file or a pipe, where the width of a terminal means nothing."""

out_console = Console(width=None if sys.stdout.isatty() else PAPER_WIDTH)
err_console = Console(stderr=True)

Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")]
Backend = Annotated[str | None, typer.Option(help="Who works: serial (this process, on all cores), processes, dask. [default: serial]")]
NWorkers = Annotated[int | None, typer.Option("--workers", help="Worker processes. [default: one a core]")]
Cluster = Annotated[str | None, typer.Option(help="Address of a Dask scheduler. [default: one on this machine]")]
Checkpoint = Annotated[
    Path | None, typer.Option(help="Folder that keeps finished parts: started again, interrupted work goes on from there.")
]


def command_line() -> str:
    """The command as it was given, for the run record."""
    return shlex.join(["navbound", *sys.argv[1:]])


def work_of(backend: str | None, workers: int | None, cluster: str | None, checkpoint: Path | None) -> Work:
    """Who works and what is kept, as far as it was asked for; refused where it would mean nothing."""
    found: Work = {}
    if cluster is not None and backend != "dask":
        raise InputError("cluster", cluster, domain="none without --backend dask")
    if workers is not None and backend in {None, "serial"}:
        raise InputError("workers", workers, domain="none without --backend processes or dask")
    if backend is not None:
        found["backend"] = backend
    if workers is not None or cluster is not None:
        from navbound.scale import Workers  # noqa: PLC0415

        found["workers"] = Workers(workers, cluster)
    if checkpoint is not None:
        found["checkpoint"] = checkpoint
    return found


class Bar:
    """A bar with the time that is left, on a terminal and for work of more than one part; nothing elsewhere."""

    def __init__(self, what: str) -> None:
        self._what = what
        self._shown: tuple[Progress, TaskID] | None = None

    def __enter__(self) -> Callable[[int, int], None]:
        return self._tell

    def __exit__(self, *_: object) -> None:
        if self._shown is not None:
            self._shown[0].stop()

    def _tell(self, done: int, total: int) -> None:
        if self._shown is None:
            if total < 2 or not err_console.is_terminal:
                return
            self._shown = self._start(total)
        bar, task = self._shown
        bar.update(task, completed=done, total=total)

    def _start(self, total: int) -> tuple[Progress, TaskID]:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: PLC0415

        columns = (TextColumn(self._what), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), TextColumn("left"))
        # A part may take many seconds: the speed is that of the last ten minutes.
        bar = Progress(*columns, console=err_console, speed_estimate_period=600.0)
        bar.start()
        return bar, bar.add_task(self._what, total=total)
