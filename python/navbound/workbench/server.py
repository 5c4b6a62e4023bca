"""The server of the workbench: what its pages ask and receive beyond any other page of this host."""

from __future__ import annotations

import asyncio
import contextlib
import json
import shlex
import subprocess
import tempfile
import time
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs, unquote

from navbound import __version__
from navbound.errors import FormatError, InputError, NavboundError, visible
from navbound.serve import request
from navbound.serve.request import RefusedError
from navbound.serve.service import HTML, Options, Service, pages, shell
from navbound.workbench import files, search
from navbound.workbench.forms import Form, arguments
from navbound.workbench.jobs import Jobs, program
from navbound.workbench.runs import Runs

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from navbound.serve import hub

STATUS_S = 1.0
"""Longest time between two words to a page. [s]"""
IDLE_S = 30.0
"""Time without a byte after which a file that is dropped is entered up. [s]"""
PIECE_BYTES = 256 * 1024
PYTHON_S = 100.0
"""Time that the Python lines of a command line may take. [s]"""
MOST_DIGITS = 9
WITHOUT_SCRIPTS = "The workbench needs a browser that runs scripts."
REPORT_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self'; sandbox allow-scripts allow-modals allow-downloads"
)
"""A report is shown in a frame of its own: its script reaches neither the workbench nor the network."""


@dataclass(frozen=True)
class Settings:
    """What the workbench shows.

    Attributes
    ----------
    folder : Path
        Whose files are used and where runs are written; nothing else of the disk can be named by a page.
    forms : sequence of Form
        Commands that can be requested.
    """

    folder: Path
    forms: Sequence[Form]


@dataclass(frozen=True)
class Requested:
    """A job as a page asks for it.

    Attributes
    ----------
    form : Form
        Of its command.
    line : list of str
        Its command line, without the program.
    values : dict
        As they were requested.
    out : str
        Folder that it writes; empty where it writes none.
    """

    form: Form
    line: list[str]
    values: dict[str, Any]
    out: str


class Server(Service):
    """The workbench of one folder.

    Parameters
    ----------
    settings : Settings
        What it shows.
    options : Options
        How it is served.
    logs : Path
        A private folder for what jobs print.
    """

    most_body = 256 * 1024

    def __init__(self, settings: Settings, options: Options, logs: Path) -> None:
        policy = request.HEADERS["Content-Security-Policy"] + "; frame-src 'self'"
        page = shell("navbound workbench", "workbench", WITHOUT_SCRIPTS, "workbench")
        super().__init__(options, pages(page, "workbench.js", "workbench.css"), policy)
        self.folder = settings.folder
        self.forms = {form.command: form for form in settings.forms}
        self.files, self.jobs, self.runs = files.Files(self.folder), Jobs(self.folder, logs), Runs(self.folder)
        self._reported_s, self._changes = 0.0, 0
        self.handlers |= {
            ("GET", "/workbench"): self._workbench,
            ("GET", "/files"): self._list_files,
            ("GET", "/runs"): self._list_runs,
            ("GET", "/search"): self._search,
            ("GET", "/output"): self._output,
            ("POST", "/line"): self._line,
            ("POST", "/python"): self._python,
            ("POST", "/start"): self._start,
            ("POST", "/stop"): self._stop,
        }

    def turn(self, now_s: float) -> bool:
        """Tell the pages which jobs run, how far they are, and that files or runs have changed."""
        if self.jobs.look():
            self._changes += 1
        if now_s - self._reported_s >= STATUS_S / 2:
            self._reported_s = now_s
            for client in self.hub.clients.values():
                client.show([], self._state())
        return False

    def snapshot(self, client: hub.Client) -> dict[str, Any]:
        """What a page receives first."""
        del client
        return self._state()

    async def other(self, query: request.Request, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Take a file that is dropped, or send a report."""
        self.door.session(query)
        if (query.method, query.path) == ("POST", "/drop"):
            writer.write(await self._drop(query, reader))
        elif query.method == "GET" and query.path.startswith("/report/"):
            await self._report(query.path.removeprefix("/report/"), writer)
        else:
            await super().other(query, reader, writer)

    def _state(self) -> dict[str, Any]:
        return {"jobs": [job.row() for job in self.jobs.all.values()], "changes": self._changes, "now_s": time.time()}

    def _workbench(self, query: request.Request) -> bytes:
        self.door.session(query)
        forms = [
            {"command": form.command, "summary": form.summary, "fields": [vars(f) for f in form.fields]} for form in self.forms.values()
        ]
        limits = {"most_file_bytes": files.MOST_FILE_BYTES, "left_bytes": files.LEFT_BYTES}
        return _json({"folder": str(self.folder), "version": __version__, "forms": forms, "limits": limits})

    async def _list_files(self, query: request.Request) -> bytes:
        self.door.session(query)
        rows = await asyncio.to_thread(self._seen_files)
        return _json({"files": rows, "n_left_out": self.files.n_left_out})

    def _seen_files(self) -> list[dict[str, object]]:
        self.files.look()
        return self.files.rows()

    async def _list_runs(self, query: request.Request) -> bytes:
        self.door.session(query)
        busy = {job.out for job in self.jobs.all.values() if job.runs and job.out}
        await asyncio.to_thread(self.runs.look, busy)
        return _json({"runs": [run.row() for run in self.runs.known.values()]})

    async def _search(self, query: request.Request) -> bytes:
        self.door.session(query)
        requested = _query_of(query)
        words, file = requested.get("words", "")[:100], requested.get("file", "")
        if requested.get("list") == "runways":
            return _json({"matches": await asyncio.to_thread(search.runways, words)})
        if requested.get("list") != "procedures" or file not in self.files.known:
            raise RefusedError(HTTPStatus.NOT_FOUND)
        try:
            return _json({"matches": await asyncio.to_thread(search.procedures, self.folder / file, words)})
        except NavboundError as e:
            return _json({"matches": [], "refused": self._within(str(e))})

    def _output(self, query: request.Request) -> bytes:
        self.door.session(query)
        return _json(self._job(_query_of(query).get("job")).output())

    def _line(self, query: request.Request) -> bytes:
        self.door.session(query)
        return self._asking(query, lambda requested: {"line": shlex.join(["navbound", *requested.line])})

    async def _python(self, query: request.Request) -> bytes:
        self.door.session(query)
        requested = list[Requested]()

        def take(one: Requested) -> dict[str, Any]:
            requested.append(one)
            return {}

        refused = self._asking(query, take)
        if not requested:
            return refused
        line = program("--python", *requested[0].line)
        try:
            done = await asyncio.to_thread(subprocess.run, line, cwd=self.folder, capture_output=True, timeout=PYTHON_S, check=False)
        except subprocess.TimeoutExpired:
            return _json({"refused": f"the lines were not there after {PYTHON_S:g} s: this machine is busy"})
        if done.returncode:
            return _json({"refused": visible(done.stderr.decode("utf-8", "replace").removeprefix("navbound: ").strip())})
        return _json({"python": done.stdout.decode("utf-8", "replace")})

    def _start(self, query: request.Request) -> bytes:
        self.door.session(query)

        def start(requested: Requested) -> dict[str, Any]:
            return {
                "job": self.jobs.start(requested.line, command=requested.form.command, values=requested.values, out=requested.out).row()
            }

        return self._asking(query, start)

    def _stop(self, query: request.Request) -> bytes:
        self.door.session(query)
        self.jobs.stop(self._job(query.json().get("job")))
        return request.answer(HTTPStatus.NO_CONTENT)

    def _asking(self, query: request.Request, then: Callable[[Requested], dict[str, Any]]) -> bytes:
        """Answer a page that asks for a job: with what is done with it, or with the sentence that refuses it."""
        requested = query.json()
        form, values = self.forms.get(str(requested.get("command"))), requested.get("values")
        if form is None or not isinstance(values, dict):
            raise RefusedError(HTTPStatus.BAD_REQUEST)
        try:
            name = self._name_of(form, values, requested.get("name"))
            out, parts = (f"{folder}/{name}" for folder in (files.OUT, files.PARTS))
            line = arguments(form, values, self.files.known, runs=self.runs.comparable(), out=out, parts=parts)
            return _json(then(Requested(form, line, values, out if form.writes(values) else "")))
        except InputError as e:
            flags = {field.name: field.flag.removeprefix("--").replace("-", " ") or field.name for field in form.fields}
            return _json({"refused": visible(e.words(lambda argument: flags.get(argument, argument))), "field": e.argument})
        except (NavboundError, OSError) as e:
            return _json({"refused": self._within(str(e))})

    def _name_of(self, form: Form, values: dict[str, Any], requested: Any) -> str:
        """Name of the folder of a run: as a page asks, to go on there; otherwise a new one."""
        if isinstance(requested, str) and requested:
            name = files.tidy(requested)
            if name != requested:
                raise InputError("name", requested, domain=f"a plain name of a folder, as {name}")
            return name
        entered = [values.get(field.name) for field in form.fields]
        first = next((str(value[0] if isinstance(value, list) else value) for value in entered if value and value is not True), "")
        name = files.tidy(f"{form.command}-{first.rpartition('/')[2].split('.')[0].lower()}".rstrip("-"))
        taken = {path.name for path in self._out().iterdir()} if self._out().is_dir() else set()
        taken |= {job.out.rpartition("/")[2] for job in self.jobs.all.values() if job.runs}
        return next(each for n in range(1, 100_000) if (each := name if n == 1 else f"{name}-{n}") not in taken)

    def _out(self) -> Path:
        out = self.folder / files.OUT
        if out.is_symlink():
            raise FormatError(files.OUT, "is a link; runs are not written there")
        return out

    def _job(self, number: Any) -> Any:
        job = self.jobs.all.get(int(number)) if str(number).isdecimal() and len(str(number)) < MOST_DIGITS else None
        if job is None:
            raise RefusedError(HTTPStatus.NOT_FOUND)
        return job

    def _within(self, sentence: str) -> str:
        """A sentence without the place of the folder on this disk."""
        return visible(sentence.replace(f"{self.folder}/", ""))

    async def _drop(self, query: request.Request, reader: asyncio.StreamReader) -> bytes:
        name = unquote(query.headers.get("x-name", ""), errors="replace")
        try:
            coming = self.files.take(name, query.length)
            left = query.length
            with coming as file:
                while left:
                    async with asyncio.timeout(IDLE_S):
                        piece = await reader.read(min(left, PIECE_BYTES))
                    if not piece:
                        raise RefusedError(HTTPStatus.BAD_REQUEST)
                    file.write(piece)
                    left -= len(piece)
        except TimeoutError as e:
            raise RefusedError(HTTPStatus.REQUEST_TIMEOUT) from e
        except FormatError as e:
            await self._drain(reader, query.length)
            return _json({"refused": self._within(str(e))})
        except OSError as e:
            return _json({"refused": f"{visible(name)}: cannot be kept: {e.strerror or e}"})
        self._changes += 1
        return _json({"name": coming.name})

    @staticmethod
    async def _drain(reader: asyncio.StreamReader, length: int) -> None:
        """Take what a page sends of a file that is refused, as far as it is little: it reads the answer after that."""
        left = min(length, 4 * request.MOST_HEAD)
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(request.REQUEST_S):
                while left and (piece := await reader.read(left)):
                    left -= len(piece)

    async def _report(self, id_: str, writer: asyncio.StreamWriter) -> None:
        path = await asyncio.to_thread(self.runs.report, id_)
        if path is None:
            raise RefusedError(HTTPStatus.NOT_FOUND)
        kind = HTML if path.suffix == ".html" else "text/plain; charset=utf-8"
        try:
            size = path.stat().st_size
            with path.open("rb") as file:
                writer.write(
                    request.head(
                        HTTPStatus.OK, kind, size, {"Content-Security-Policy": REPORT_POLICY, "Cross-Origin-Opener-Policy": "unsafe-none"}
                    )
                )
                while piece := await asyncio.to_thread(file.read, PIECE_BYTES):
                    writer.write(piece)
                    async with asyncio.timeout(IDLE_S):
                        await writer.drain()
        except OSError as e:
            raise RefusedError(HTTPStatus.NOT_FOUND) from e


def _query_of(query: request.Request) -> dict[str, str]:
    try:
        return {name: values[0] for name, values in parse_qs(query.query, max_num_fields=8).items()}
    except ValueError as e:
        raise RefusedError(HTTPStatus.BAD_REQUEST) from e


def _json(value: dict[str, Any]) -> bytes:
    return request.answer(HTTPStatus.OK, json.dumps(value, separators=(",", ":")).encode(), "application/json")


def serve(settings: Settings, options: Options, *, ready: Callable[[Server], None], stop: Callable[[], bool]) -> None:
    """Show the workbench of a folder until `stop`; jobs that run then are stopped.

    Raises
    ------
    FormatError
        Not a folder that can be read, or the port is taken.
    """
    folder = settings.folder
    if not folder.is_dir():
        raise FormatError(folder, "is not a folder" if folder.exists() else "no such folder")
    with tempfile.TemporaryDirectory(prefix="navbound-") as logs:
        server = Server(settings, options, Path(logs))
        server.files.look()
        ready(server)
        try:
            asyncio.run(server.run(stop))
        finally:
            server.jobs.end_all()
