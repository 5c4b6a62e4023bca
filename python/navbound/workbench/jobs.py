"""Jobs: command lines that run as processes of their own, in the folder, and can be stopped."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from navbound.errors import ConflictError, visible
from navbound.exit_status import MEANINGS, NO_VERDICT, STOPPED

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

MOST_RUNNING = 2
"""Jobs at a time; each takes every core that it can use. [1]"""
MOST_KEPT = 200
GENTLE_S = 3.0
"""Time that a job has to end by itself after it was requested to. [s]"""
MOST_OUTPUT = 1 << 20
"""What of a job's output a page receives. [B]"""
PROGRESS = "NAVBOUND_PROGRESS"
"""Environment of a job: the file in which it says how far it is."""


def program(*arguments: str) -> list[str]:
    """The command line of this very navbound."""
    return [sys.executable, "-m", "navbound", *arguments]


@dataclass
class Job:
    """One command line that runs, or ran.

    Attributes
    ----------
    id : int
        Its number, from 1.
    command : str
        Name of the command.
    values : dict
        What was requested, to ask it again.
    arguments : list of str
        Its command line.
    out : str
        Folder that it writes, within the folder of the workbench; empty where it writes none.
    state : str
        ``running``, ``stopping``, ``done``, ``no_verdict``, ``failed`` or ``stopped``.
    """

    id: int
    command: str
    values: dict[str, Any]
    arguments: list[str]
    out: str
    process: subprocess.Popen[bytes]
    logs: Path
    began_s: float = field(default_factory=time.time)
    ended_s: float | None = None
    state: str = "running"
    words: str = ""
    stop_requested_s: float | None = None

    @property
    def runs(self) -> bool:
        """Whether it has not ended."""
        return self.ended_s is None

    def progress(self) -> dict[str, Any] | None:
        """How far it is, as it says itself."""
        try:
            reported = json.loads((self.logs / "progress").read_bytes())
        except (OSError, ValueError):
            return None
        return reported if isinstance(reported, dict) else None

    def output(self) -> dict[str, str]:
        """What it printed, the end where it is long."""
        return {name: _tail(self.logs / name) for name in ("stdout", "stderr")}

    def row(self) -> dict[str, Any]:
        """For a page."""
        return {
            "id": self.id,
            "command": self.command,
            "values": self.values,
            "line": shlex.join(["navbound", *self.arguments]),
            "out": self.out,
            "state": self.state,
            "words": self.words,
            "began_s": self.began_s,
            "ended_s": self.ended_s,
            "progress": self.progress() if self.runs else None,
        }


class Jobs:
    """Every job of this workbench.

    Parameters
    ----------
    folder : Path
        Where they run.
    logs : Path
        A private folder for what they print.
    """

    def __init__(self, folder: Path, logs: Path) -> None:
        self.folder, self._logs = folder, logs
        self.all: dict[int, Job] = {}

    def start(self, arguments: Sequence[str], *, command: str, values: dict[str, Any], out: str) -> Job:
        """Start a job.

        Raises
        ------
        ConflictError
            As many run already as may, or one that writes the same folder.
        """
        running = [job for job in self.all.values() if job.runs]
        if len(running) >= MOST_RUNNING:
            raise ConflictError("start", because=f"{len(running)} jobs run; wait for one to end, or stop one")
        if out and any(job.out == out for job in running):
            raise ConflictError("out", because=f"a job that runs writes {out}")
        number = max(self.all, default=0) + 1
        logs = self._logs / str(number)
        logs.mkdir(mode=0o700)
        environment = os.environ | {PROGRESS: str(logs / "progress"), "COLUMNS": "100", "PYTHONIOENCODING": "utf-8"}
        with (logs / "stdout").open("wb") as out_file, (logs / "stderr").open("wb") as err_file:
            process = subprocess.Popen(
                program(*arguments),
                cwd=self.folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=out_file,
                stderr=err_file,
                # A group of its own: what it starts ends with it, and a Ctrl-C at the terminal is not its own.
                start_new_session=True,
            )
        job = Job(number, command, values, list(arguments), out, process, logs)
        self.all[number] = job
        for oldest in [each for each in self.all.values() if not each.runs][: max(0, len(self.all) - MOST_KEPT)]:
            del self.all[oldest.id]
        return job

    def stop(self, job: Job) -> None:
        """Ask a job to end; one that does not is ended."""
        if job.runs and job.stop_requested_s is None:
            job.stop_requested_s = time.monotonic()
            job.state = "stopping"
            _signal(job, signal.SIGINT)

    def look(self) -> bool:
        """See who has ended; whether anyone has."""
        ended = False
        for job in self.all.values():
            if not job.runs:
                continue
            status = job.process.poll()
            if status is not None:
                self._end(job, status)
                ended = True
            elif job.stop_requested_s is not None and time.monotonic() - job.stop_requested_s > GENTLE_S:
                _signal(job, getattr(signal, "SIGKILL", signal.SIGTERM))
        return ended

    def end_all(self) -> None:
        """Stop every job and wait until each has ended."""
        for job in self.all.values():
            self.stop(job)
        while any(job.runs for job in self.all.values()):
            self.look()
            time.sleep(0.05)

    def _end(self, job: Job, status: int) -> None:
        printed = job.output()["stderr"].strip()
        last = printed.splitlines()[-1].removeprefix("navbound: ") if printed else ""
        if job.stop_requested_s is not None and status != 0:
            job.state, job.words = "stopped", last if status == STOPPED and last else "stopped; nothing of it reads as a result"
        elif status == 0:
            job.state, job.words = "done", ""
        elif status == NO_VERDICT:
            job.state, job.words = "no_verdict", MEANINGS[NO_VERDICT]
        else:
            job.state, job.words = "failed", last or f"it ended with status {status}"
        # The last thing: who sees that it has ended sees how, whatever thread that is.
        job.ended_s = time.time()


def _signal(job: Job, number: int) -> None:
    try:
        if hasattr(os, "killpg"):
            os.killpg(job.process.pid, number)
        else:
            job.process.terminate()
    except ProcessLookupError:
        # It ended a moment ago.
        return


def _tail(path: Path) -> str:
    try:
        with path.open("rb") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - MOST_OUTPUT))
            text = file.read().decode("utf-8", "replace")
    except OSError:
        return ""
    return "\n".join(visible(line) for line in text.split("\n"))
