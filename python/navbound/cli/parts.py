"""What the commands share: the screen, the progress bar, and the options that mean the same everywhere.

Nothing here needs numbers or tables: a command loads what it needs when it runs, so that `navbound --help` answers at once.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import shlex
import signal
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from navbound.cli import interrupt
from navbound.cli.choices import POINT, Selectable, Written
from navbound.errors import ConflictError, FormatError, InputError
from navbound.storage.packed import require_there

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.progress import Progress, TaskID

    from navbound.scale import Work

PROGRESS = "NAVBOUND_PROGRESS"
EVERY_S = 0.2
"""Shortest time between two words on how far the work is. [s]"""
SAY_EVERY_S = 10.0
"""Time between two lines on how far the work is, where there is no terminal. [s]"""
LEAST_WORKERS = 2
"""Worker processes that any machine may be requested for."""
PAPER_WIDTH = 140
"""Columns of a table that goes to a file or a pipe, where the width of a terminal means nothing; COLUMNS states another one."""

out_console = Console(width=None if sys.stdout.isatty() or os.environ.get("COLUMNS") else PAPER_WIDTH)
if not out_console.is_terminal:
    # Nothing is coloured there: what would be coloured need not be looked for.
    out_console = Console(width=out_console.width, highlight=False)
err_console = Console(stderr=True)

Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")]
Backend = Annotated[
    str | None,
    typer.Option(help="Who works: serial (this process, on all cores), processes, dask. [default: serial]"),
    Selectable(words=("serial", "processes", "dask")),
]
NWorkers = Annotated[int | None, typer.Option("--workers", help="Worker processes. [default: one a core]")]
Cluster = Annotated[str | None, typer.Option(help="Address of a Dask scheduler. [default: one on this machine]")]
Out = Annotated[Path | None, typer.Option("--out", help="Run directory to write. [default: out/<name>]"), Written()]
OutOfLevels = Annotated[Path | None, typer.Option("--out", help="Run directory to write. [default: out/evaluate-<name>]"), Written()]
Files = Annotated[
    list[Path],
    typer.Argument(
        help="Tables (CSV, Parquet, JSON), RTKLIB .pos files, receiver logs (UBX, SBF, NMEA, NovAtel), RINEX observations with "
        "navigation files; plain, gzip, compress (.Z) or zip."
    ),
]
Truth = Annotated[
    str | None,
    typer.Option(
        help="A file with true positions, joined by time; or a fixed point: LAT,LON,H (degrees, metres above the WGS-84 ellipsoid) "
        "or X,Y,Z (Earth-fixed, metres)."
    ),
    Selectable(files=True, free=POINT),
]
TruthTolerance = Annotated[float | None, typer.Option(help="How far apart in time a truth epoch may be. [default: 0.01]")]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--map",
        help="What a column is, where its name does not say: sigma_n_m=sd_north, time=t:gps_s, est_lat_rad=lat:deg_e7, "
        "ground_track_rad=- for none; may be repeated. "
        "Columns of a truth file: truth_time, truth_lat_rad, truth_lon_rad, truth_h_m. Names and units: docs/notation.md.",
    ),
]
Solve = Annotated[
    bool, typer.Option("--solve", help="Solve positions from the raw measurements of receiver logs instead of taking the receiver's.")
]
Ionosphere = Annotated[
    str | None,
    typer.Option(
        help="Model of single signals: broadcast (GPS message), galileo (NTCM-G by Galileo's message), climatology, none, or auto, the "
        "first of these that the navigation files have. [default: auto]"
    ),
    Selectable(words=("auto", "broadcast", "galileo", "climatology", "none")),
]
Mask = Annotated[float | None, typer.Option(help="Lowest elevation of satellites to solve from, degrees, 0 to below 90. [default: 5]")]
SIGNALS = (
    "Measurements to solve: single (L1, E1, B1I), dual (ionosphere-free pairs), or auto, the smaller declared covariance. [default: {}]"
)
SIGNAL = Selectable(words=("auto", "single", "dual"))
SYSTEMS = "Constellations to solve from: letters of GEC. [default: {}]"
Checkpoint = Annotated[
    Path | None, typer.Option(help="Folder that keeps finished parts: started again, interrupted work goes on from there.")
]


def command_line() -> str:
    """The command as it was given, for the run record."""
    return shlex.join(["navbound", *sys.argv[1:]])


def mapping(pairs: list[str] | None) -> dict[str, str]:
    """`--map canonical=column[:unit]`, as often as it was given."""
    split = [pair.partition("=") for pair in pairs or []]
    for pair, (name, sign, column) in zip(pairs or [], split, strict=True):
        if not (name and sign and column):
            raise InputError("map", pair, domain="canonical=column or canonical=column:unit")
    return {name: column for name, _, column in split}


def mask_rad(mask_deg: float | None) -> float | None:
    """The elevation mask; refused here in the unit that it was typed in."""
    if mask_deg is None:
        return None
    if not 0 <= mask_deg < 90:
        raise InputError("mask", mask_deg, "deg", "[0, 90)")
    return math.radians(mask_deg)


def tolerance(truth_tolerance_s: float | None) -> dict[str, float]:
    """The tolerance of truth as an argument, where it was named."""
    return {} if truth_tolerance_s is None else {"truth_tolerance_s": truth_tolerance_s}


def run_folder(files: list[Path], out: Path | None, before: str = "") -> Path:
    """Where a run is written; every file must be there first, before tables are loaded.

    Parameters
    ----------
    files : list of Path
        What is read; the first names the folder.
    out : Path or None
        A folder that was named.
    before : str
        Stands before the name, so that another command's run of the same file stays.

    Raises
    ------
    FormatError
        A file that is not there, or a folder in the place of one.
    """
    require_there(files)
    for path in files:
        if path.is_dir():
            raise FormatError(path, "is a folder; name the files in it")
    return out or Path("out") / f"{before}{files[0].name.split('.')[0]}"


def work_of(backend: str | None, workers: int | None, cluster: str | None, checkpoint: Path | None) -> Work:
    """Who works and what is kept, as far as it was requested; refused where it would mean nothing."""
    options: Work = {}
    if cluster is not None and backend != "dask":
        raise ConflictError("cluster", needs=("backend",), because="dask")
    if workers is not None and backend in {None, "serial"}:
        raise ConflictError("workers", needs=("backend",), because="processes or dask")
    cores = os.cpu_count() or 1
    if workers is not None and cluster is None and not 1 <= workers <= max(cores, LEAST_WORKERS):
        raise InputError("workers", workers, "1", f"[1, {max(cores, LEAST_WORKERS)}]: this machine has {cores} cores")
    if backend is not None:
        options["backend"] = backend
    if workers is not None or cluster is not None:
        from navbound.scale import Workers  # noqa: PLC0415

        options["workers"] = Workers(workers, cluster)
    if checkpoint is not None:
        options["checkpoint"] = checkpoint
        interrupt.keep(f"Finished parts are kept in {checkpoint}: the same command goes on from there.")
    return options


def stop_requested() -> Callable[[], bool]:
    """Whether an end was requested; requested twice, the command ends at once."""
    interrupt.unwatch()
    requested = list[int]()

    def ask(number: int, _: object) -> None:
        if requested:
            raise KeyboardInterrupt
        requested.append(number)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, ask)
    return lambda: bool(requested)


class Bar:
    """How far the work is: a bar with the time that is left on a terminal, for work of more than one part; lines elsewhere.

    A line stands on standard error after every ten seconds, so that work of less than that says nothing.
    Who waits for the command in place of a person names a file in ``NAVBOUND_PROGRESS``: how far the work is stands there as JSON.

    Parameters
    ----------
    what : str
        The parts that are counted.
    begins : str
        What begins; a line of its own at once, where there is no terminal.
    """

    def __init__(self, what: str, begins: str = "") -> None:
        self._what, self._begins = what, begins
        self._shown: tuple[Progress, TaskID] | None = None
        self._file = os.environ.get(PROGRESS)
        self._written_s = -math.inf
        self._last: tuple[int, int] | None = None
        self._ended = threading.Event()
        self._sayer: threading.Thread | None = None

    def __enter__(self) -> Callable[[int, int], None]:
        if self._file is None and not err_console.is_terminal:
            if self._begins:
                _say(self._begins)
            # Work of a single part tells nothing before its end.
            self._sayer = threading.Thread(target=self._say_often, daemon=True)
            self._sayer.start()
        return self._tell

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        if self._sayer is not None:
            self._sayer.join()
        if self._shown is not None:
            self._shown[0].stop()

    def _say_often(self) -> None:
        began_s = time.monotonic()
        while not self._ended.wait(SAY_EVERY_S):
            far = "at work" if self._last is None else f"{self._last[0]} of {self._last[1]}"
            _say(f"{self._what}: {far} after {time.monotonic() - began_s:.0f} s")

    def _tell(self, done: int, total: int) -> None:
        self._last = done, total
        self._write(done, total)
        if self._shown is None:
            if total < 2 or not err_console.is_terminal:
                return
            self._shown = self._start(total)
        bar, task = self._shown
        bar.update(task, completed=done, total=total)

    def _write(self, done: int, total: int) -> None:
        now_s = time.monotonic()
        if self._file is None or (now_s - self._written_s < EVERY_S and done < total):
            return
        self._written_s = now_s
        partial = Path(f"{self._file}.partial")
        try:
            partial.write_text(json.dumps({"what": self._what, "done": done, "total": total}), encoding="utf-8")
            partial.replace(self._file)
        except OSError:
            # Nobody waits any more.
            self._file = None

    def _start(self, total: int) -> tuple[Progress, TaskID]:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: PLC0415

        columns = (TextColumn(self._what), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), TextColumn("left"))
        # A part may take many seconds: the speed is that of the last ten minutes.
        bar = Progress(*columns, console=err_console, speed_estimate_period=600.0)
        bar.start()
        return bar, bar.add_task(self._what, total=total)


def _say(line: str) -> None:
    """A plain line on standard error; where nobody reads it any more, the work goes on."""
    # A console of rich ends the command where nobody reads.
    with contextlib.suppress(OSError, ValueError):
        print(line, file=err_console.file, flush=True)
