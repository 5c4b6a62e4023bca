"""The server of the workbench: what may be requested, which files can be named, what a job leaves, and who may ask."""

from __future__ import annotations

import asyncio
import hashlib
import json
import os
import re
import shlex
import signal
import socket
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

import pytest

from conftest import Ended
from display_fixture import Browser
from navbound.cli import analyze, compare, evaluate, forms, maps, predict, study
from navbound.cli.forms import form
from navbound.serve.service import Options
from navbound.storage import folders
from navbound.workbench import Server, Settings, jobs
from navbound.workbench import files as kept
from navbound.workbench import runs as kept_runs
from navbound.workbench import server as workbench_server
from navbound.workbench.files import tidy
from navbound.workbench.forms import arguments
from navbound.workbench.recognise import recognise
from navbound.workbench.runs import Runs

COMMANDS: dict[str, Callable[..., None]] = {
    "analyze": analyze.analyze_command,
    "evaluate": evaluate.evaluate_command,
    "map": maps.map_command,
    "predict": predict.predict_command,
    "study": study.study_command,
    "compare": compare.compare_command,
}
FORMS = [form(name, command) for name, command in COMMANDS.items()]
TRACK = "time,lat_deg,lon_deg,height_m\n" + "".join(f"{1400000000 + k},49.0,2.5,{300 - k}\n" for k in range(5))
FOREIGN = "http://attacker.example"


@contextmanager
def opened(folder: Path, logs: Path) -> Iterator[Server]:
    """A workbench of a folder in this process."""
    logs.mkdir(exist_ok=True)
    server, stop = Server(Settings(folder, FORMS), Options(), logs), threading.Event()
    server.files.look()
    thread = threading.Thread(target=lambda: asyncio.run(server.run(stop.is_set)))
    thread.start()
    try:
        yield server
    finally:
        stop.set()
        thread.join(20)
        server.jobs.end_all()
        assert not thread.is_alive()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = tmp_path / "own"
    place.mkdir()
    (place / "track.csv").write_text(TRACK, encoding="utf-8")
    return place


@pytest.fixture
def server(folder: Path, tmp_path: Path) -> Iterator[Server]:
    with opened(folder, tmp_path / "logs") as made:
        yield made


@pytest.fixture
def page(server: Server) -> Browser:
    return Browser(cast("Any", server)).begin()


def requested(page: Browser, path: str, **values: Any) -> dict[str, Any]:
    # A program that starts on a machine that does other things takes its time.
    answer = page.raw(page.text("POST", path, json.dumps(values)), 120.0)
    assert answer.status == 200, answer.body
    return dict(json.loads(answer.body))


def dropped(page: Browser, name: str, content: str) -> dict[str, Any]:
    answer = page.ask("POST", "/drop", content, X_Name=name)
    assert answer.status == 200, answer.body
    return dict(json.loads(answer.body))


def until(true: Callable[[], bool], what: str, timeout_s: float = 60.0) -> None:
    began = time.monotonic()
    while not true():
        assert time.monotonic() - began < timeout_s, what
        time.sleep(0.05)


def test_without_the_token_nothing_is_sent_and_nothing_starts(server: Server, folder: Path) -> None:
    page = Browser(cast("Any", server))
    asks = [("GET", path) for path in ("/workbench", "/files", "/runs", "/search?list=runways", "/output?job=1", "/events", "/report/0")]
    for method, path in [*asks, *(("POST", path) for path in ("/line", "/python", "/start", "/stop", "/drop"))]:
        assert page.ask(method, path, "{}" if method == "POST" else "").status == 401, path
    assert not server.jobs.all
    assert sorted(path.name for path in folder.iterdir()) == ["track.csv"]


def test_other_hosts_and_other_origins_are_refused(page: Browser, folder: Path) -> None:
    for host in ("attacker.example", f"attacker.example:{page.server.port}", None):
        assert page.ask("GET", "/files", Host=host).status == 421, host
    for origin in (FOREIGN, "null", None):
        for path in ("/start", "/drop", "/stop"):
            assert page.ask("POST", path, "{}", Origin=origin).status == 403, (path, origin)
    assert page.ask("GET", "/files", Origin=FOREIGN).status == 403
    assert not (folder / kept.DROPPED).exists()


@pytest.mark.parametrize(
    "path", ["/../../etc/passwd", "/report/../track.csv", "/report/%2e%2e%2fown%2ftrack.csv", "/report/", "/track.csv", "/_web/"]
)
def test_no_path_reaches_a_file(page: Browser, path: str) -> None:
    assert page.ask("GET", path).status == 404


def test_a_file_outside_the_folder_cannot_be_named(page: Browser, folder: Path, tmp_path: Path) -> None:
    outside = tmp_path / "secret.csv"
    outside.write_text(TRACK, encoding="utf-8")
    (folder / "link.csv").symlink_to(outside)
    (folder / "way").symlink_to(tmp_path)
    rows = {row["name"]: row for row in json.loads(page.ask("GET", "/files").body)["files"]}
    assert {name: row["refused"] for name, row in rows.items()} == {"track.csv": False, "link.csv": True, "way": True}
    assert rows["link.csv"]["words"] == rows["way"]["words"] == "a link, which is not followed"
    for name in (str(outside), "../secret.csv", "link.csv", "way/secret.csv", "track.csv/../../secret.csv", "/etc/passwd"):
        refused = requested(page, "/line", command="analyze", values={"files": [name]})
        assert refused["field"] == "files", name
        for field in ("path", "truth"):
            assert requested(page, "/line", command="analyze", values={"files": ["track.csv"], field: name})["field"] == field, name
    # What no file is, still goes: a runway, a point.
    line = requested(page, "/line", command="analyze", values={"files": ["track.csv"], "path": "LFPG/08R,LFPG/09L", "truth": "1,2,-3.5"})[
        "line"
    ]
    assert shlex.split(line)[:7] == ["navbound", "analyze", "track.csv", "--path", "LFPG/08R,LFPG/09L", "--truth", "1,2,-3.5"]


def test_what_is_written_stays_in_the_folder(page: Browser, folder: Path, tmp_path: Path) -> None:
    values = {"files": ["track.csv"]}
    for name in ("../away", "/tmp/away", "a/b", ".hidden", "x\0y"):
        assert "plain name" in requested(page, "/start", command="analyze", values=values, name=name)["refused"], name
    away = tmp_path / "away"
    away.mkdir()
    (folder / "out").symlink_to(away)
    assert "is a link" in requested(page, "/start", command="analyze", values=values)["refused"]
    (folder / kept.DROPPED).symlink_to(away)
    assert "is a link" in dropped(page, "a.csv", TRACK)["refused"]
    assert not list(away.iterdir())


def test_the_text_of_a_field_is_never_an_option(page: Browser) -> None:
    values = {"files": ["track.csv"], "spec": "--out=/tmp/x", "systems": "-G", "column": ["--json"]}
    line = shlex.split(requested(page, "/line", command="analyze", values=values)["line"])
    assert {"--spec=--out=/tmp/x", "--systems=-G", "--map=--json"} <= set(line)
    for other in ({"json": True}, {"levels": "x"}):
        refused = requested(page, "/line", command="analyze", values={"files": ["track.csv"], **other})["refused"]
        assert "no such argument" in refused
    assert page.ask("POST", "/line", json.dumps({"command": "live", "values": {}})).status == 400
    assert page.ask("POST", "/line", json.dumps({"command": "analyze", "values": [1]})).status == 400


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "files is needed"),
        ({"files": [7.5, True]}, "text or a number"),
        ({"files": "track.csv", "spec": ["a", "b"]}, "[0, 1]"),
        ({"files": "track.csv", "sigma_m": "five"}, "a number"),
        ({"files": "track.csv", "spec": "RNP\n0.3"}, "can be seen"),
        ({"files": "track.csv", "spec": "9" * 1001}, "1000 characters"),
    ],
)
def test_what_a_command_does_not_take_is_refused_with_a_sentence(page: Browser, values: dict[str, Any], words: str) -> None:
    assert words in requested(page, "/line", command="analyze", values=values)["refused"]


def test_every_option_of_the_command_line_is_on_the_page_or_about_the_screen() -> None:
    import typer  # noqa: PLC0415

    for one, command in zip(FORMS, COMMANDS.values(), strict=True):
        app = typer.Typer(add_completion=False)
        app.command()(command)
        made: Any = typer.main.get_command(app)
        declared = {parameter.name for parameter in made.params if not getattr(parameter, "hidden", False)}
        assert {field.name for field in one.fields} == declared - {"json"}, one.command
        assert declared >= {"json"}


def test_an_option_that_is_added_stands_on_the_page() -> None:
    from typing import Annotated  # noqa: PLC0415

    import typer  # noqa: PLC0415

    def toy(files: list[Path], depth_m: Annotated[float, typer.Option(help="How deep.")] = 3.0, tags: list[str] | None = None) -> None:
        """Do a toy."""

    toy.__annotations__ = {"files": list[Path], "depth_m": Annotated[float, typer.Option(help="How deep.")], "tags": list[str] | None}
    made = forms.form("toy", toy)
    assert [(f.name, f.flag, f.kind, f.several) for f in made.fields] == [
        ("files", "", "file", "repeated"),
        ("depth_m", "--depth-m", "number", ""),
        ("tags", "--tags", "text", "repeated"),
    ]
    line = arguments(made, {"files": ["a"], "depth_m": "4", "tags": ["x", "y"]}, {"a"}, out="", parts="")
    assert line == ["toy", "a", "--depth-m", "4", "--tags", "x", "--tags", "y"]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("track.csv", "track.csv"),
        ("../../etc/cron.d/x", "x"),
        ("C:\\logs\\day.ubx", "day.ubx"),
        ("<img src=x onerror=alert(1)>.csv", "_img src=x onerror=alert(1)_.csv"),
        ("-rf.csv", "rf.csv"),
        (".bashrc", "bashrc"),
        ("..", "file"),
        ("Tag 7 Überflug.csv", "Tag 7 Überflug.csv"),
        ("a\u202egnp.csv", "a_gnp.csv"),
        ("a\nb\0c", "a_b_c"),
    ],
)
def test_a_hostile_name_becomes_a_plain_one(name: str, expected: str) -> None:
    assert tidy(name) == expected
    assert len(tidy("x" * 5000 + ".csv")) <= kept.MOST_NAME_BYTES
    assert tidy("x" * 5000 + ".csv").endswith(".csv")


def test_a_dropped_file_is_kept_for_this_user_alone_and_never_over_another(page: Browser, folder: Path) -> None:
    names = [dropped(page, name, TRACK)["name"] for name in ("track.csv", "track.csv", "..%2F..%2Fx%00%3Cb%3E.csv")]
    assert names == ["dropped/track.csv", "dropped/track-2.csv", "dropped/x__b_.csv"]
    assert stat.S_IMODE((folder / "dropped").stat().st_mode) == 0o700
    assert {stat.S_IMODE((folder / name).stat().st_mode) for name in names} == {0o600}
    assert (folder / names[1]).read_text(encoding="utf-8") == TRACK
    rows = {row["name"]: row for row in json.loads(page.ask("GET", "/files").body)["files"]}
    assert "Table of 4 columns" in rows["dropped/track.csv"]["words"]


def test_a_file_that_does_not_arrive_whole_leaves_nothing(page: Browser, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = page.text("POST", "/drop", X_Name="cut.csv", Content_Length="1000")
    with socket.create_connection(("127.0.0.1", page.server.port), 10.0) as line:
        line.sendall(text + b"a" * 500)
    until(lambda: (folder / "dropped").is_dir() and not list((folder / "dropped").iterdir()), "half a file stayed")
    monkeypatch.setattr(kept, "MOST_FILE_BYTES", 10)
    assert "may have" in dropped(page, "large.csv", "x" * 11)["refused"]
    monkeypatch.setattr(kept, "LEFT_BYTES", 1 << 60)
    assert "must keep" in dropped(page, "small.csv", "x")["refused"]
    assert not list((folder / "dropped").iterdir())


def test_a_file_of_200_mb_is_taken_in_pieces(page: Browser, folder: Path) -> None:
    n_bytes, piece = 200 << 20, b"\0" * (1 << 20)
    text = page.text("POST", "/drop", X_Name="large.bin", Content_Length=str(n_bytes))
    with socket.create_connection(("127.0.0.1", page.server.port), 60.0) as line:
        line.sendall(text)
        for _ in range(n_bytes // len(piece)):
            line.sendall(piece)
        assert json.loads(page.read(line).body) == {"name": "dropped/large.bin"}
    assert (folder / "dropped" / "large.bin").stat().st_size == n_bytes
    refused = next(row for row in json.loads(page.ask("GET", "/files").body)["files"] if row["name"] == "dropped/large.bin")
    assert refused["refused"] is True


@pytest.mark.parametrize(
    ("name", "content", "words", "refused"),
    [
        ("a.csv", TRACK.encode(), "Table of 4 columns: time, lat_deg, lon_deg, height_m", False),
        ("a.rnx", b"     3.04           N: GNSS NAV DATA    M: MIXED            RINEX VERSION / TYPE\n", "RINEX navigation", False),
        ("a.csv.gz", b"\x1f\x8b\x08\x00broken", "the gzip stream is damaged", True),
        ("a.csv", b"", "the file is empty", True),
        ("a.xz", b"\xfd7zXZ\0\0", "unpack it, or pack it by gzip", True),
        ("a.bin", bytes(range(256)) * 20, "binary, of no kind that is known here", True),
        ("a.txt", b"One morning.\nThe end.\n", "no column is known by its name", False),
        ("plan.toml", b"title = 'x'\n", "TOML", False),
        ("plan.toml", b"title = \n", "not TOML", True),
        ("a.dat", b"S" * 132 + b"\n", "ARINC 424", False),
    ],
)
def test_a_file_is_recognised_or_refused_with_a_sentence(name: str, content: bytes, words: str, refused: bool, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    seen = recognise(path)
    assert words in seen.words
    assert seen.refused is refused
    assert str(tmp_path) not in seen.words


def test_a_pipe_is_neither_listed_nor_read(page: Browser, folder: Path) -> None:
    os.mkfifo(folder / "pipe.csv")
    rows = json.loads(page.ask("GET", "/files").body)["files"]
    assert {row["name"]: row["words"] for row in rows if row["refused"]} == {"pipe.csv": "is not a file"}
    assert requested(page, "/line", command="analyze", values={"files": ["pipe.csv"]})["field"] == "files"


def test_what_cannot_be_used_is_listed_with_its_reason(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "a\u202eb.csv").write_text(TRACK, encoding="utf-8")
    (folder / os.fsdecode(b"\xff.csv")).write_text(TRACK, encoding="utf-8")
    (folder / "one" / "two" / "three").mkdir(parents=True)
    (folder / "closed").mkdir()
    (folder / "out" / "closed").mkdir(parents=True)
    (folder / "out" / "a\nb").mkdir()
    scandir = os.scandir

    def refusing(path: Any) -> Any:
        if Path(path).name == "closed":
            raise PermissionError(13, "Permission denied")
        return scandir(path)

    monkeypatch.setattr(os, "scandir", refusing)
    files, runs = kept.Files(folder), Runs(folder)
    files.look()
    runs.look(set())
    assert {row["name"]: row["words"] for row in files.rows() if row["refused"]} == {
        "a\\u202eb.csv": "its name has characters that cannot be shown: rename it",
        "\\udcff.csv": "its name has characters that cannot be shown: rename it",
        "one/two/three": "a folder 3 deep: its files are not listed",
        "closed": "a folder that cannot be read: Permission denied",
    }
    assert set(files.known) == {"track.csv"}
    assert {run.name: run.trouble for run in runs.known.values()} == {
        "closed": "cannot be read: Permission denied",
        "out/closed": "cannot be read: Permission denied",
        "out/a\\nb": "its name has characters that cannot be shown: rename it",
    }
    monkeypatch.setattr(kept, "MOST_UNUSABLE", 1)
    files.look()
    assert (len(files.rows()), files.n_left_out) == (2, 3)


def rewritten(place: Path, name: str, content: bytes) -> None:
    """A file of a run and its digest in the manifest, as somebody who means to deceive writes them."""
    (place / name).write_bytes(content)
    manifest = json.loads((place / "manifest.json").read_bytes())
    manifest["files"][name] = hashlib.sha256(content).hexdigest()
    (place / "manifest.json").write_text(json.dumps(manifest))


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("summary.json", b"{", "summary.json: is damaged"),
        ("summary.json", b"[]", "summary.json: is damaged: no object of JSON"),
        ("summary.json", b"[" * 100_000, "summary.json: is damaged"),
        ("run.json", b"\xff", "run.json: is damaged"),
        ("run.json", b" " * 2000, "run.json: has 2000 bytes"),
    ],
)
def test_a_damaged_record_is_never_a_whole_run(
    folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, content: bytes, words: str
) -> None:
    monkeypatch.setattr(kept_runs, "_MOST_RECORD", 1999)
    whole(folder / "out" / "run", epochs=True)
    content = content if len(content) < 2000 or name == "run.json" else content[:1999]
    rewritten(folder / "out" / "run", name, content)
    runs = Runs(folder)
    runs.look(set())
    (run,) = runs.known.values()
    assert run.trouble.startswith(words)
    assert (run.verdict, run.page, run.comparable, runs.report(run.id)) == ("", "", False, None)


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ({}, "its manifest lacks"),
        ({"run.json": None, "summary.json": None}, "its manifest lacks report.html"),
        ({"run.json": None, "summary.json": None, "report.html": None, "a\0b": ""}, "names what no file can be called"),
        ({"run.json": None, "summary.json": None, "report.html": None, "\ud800": ""}, "names what no file can be called"),
        ({"run.json": None, "summary.json": None, "report.html": None, "..": ""}, "is not a file"),
        ([], "is damaged"),
    ],
)
def test_a_hostile_manifest_is_never_a_whole_run(folder: Path, files: Any, words: str) -> None:
    place = folder / "out" / "run"
    whole(place)
    own = json.loads((place / "manifest.json").read_bytes())["files"]
    stated = {name: own[name] if digest is None else digest for name, digest in files.items()} if isinstance(files, dict) else files
    (place / "manifest.json").write_text(json.dumps({"files": stated}))
    runs = Runs(folder)
    runs.look(set())
    (run,) = runs.known.values()
    assert words in run.trouble
    assert runs.report(run.id) is None


def test_a_manifest_alone_is_no_run_and_runs_beyond_the_limit_are_counted(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("a", "b", "c"):
        (folder / "out" / name).mkdir(parents=True)
        (folder / "out" / name / "manifest.json").write_text('{"files": {}}')
    runs = Runs(folder)
    runs.look(set())
    assert {run.trouble for run in runs.known.values()} == {"no record says what it is"}
    monkeypatch.setattr(kept_runs, "MOST_RUNS", 1)
    runs.look(set())
    assert {run.name: run.trouble for run in runs.known.values()}["."] == "1 of its runs are listed, 2 more are not"


def whole(place: Path, report: str = "<p>report</p>", *, epochs: bool = False) -> None:
    """A run as a job leaves it; of its epochs the file alone."""
    record = {"command": "navbound analyze track.csv"}
    summary = {"title": "A <b>run</b>", "verdict": {"id": "inside", "words": "Inside."}}
    names = {"run.json", "summary.json", "report.html", *(["epochs.parquet"] if epochs else [])}
    with folders.own(place, names, "a run's") as writer:
        if epochs:
            writer.text("epochs.parquet", "")
        writer.text("run.json", json.dumps(record))
        writer.text("summary.json", json.dumps(summary))
        writer.text("report.html", report)


def listed(page: Browser) -> dict[str, dict[str, Any]]:
    return {run["name"]: run for run in json.loads(page.ask("GET", "/runs").body)["runs"]}


def test_two_runs_of_the_folder_are_compared_and_nothing_else(page: Browser, folder: Path, tmp_path: Path) -> None:
    for place in (folder / "out" / "one", folder / "out" / "two", tmp_path / "secret"):
        whole(place, epochs=True)
    whole(folder / "out" / "without")
    (folder / "out" / "way").symlink_to(tmp_path / "secret")
    assert {name for name, run in listed(page).items() if run["comparable"]} == {"out/one", "out/two"}
    line = requested(page, "/line", command="compare", values={"a": "out/one", "b": "out/two"})["line"]
    assert line == "navbound compare out/one out/two --out out/compare-one"
    for name in ("out/without", "out/way", "../secret", str(tmp_path / "secret"), "out/one/../two", "track.csv"):
        refused = requested(page, "/line", command="compare", values={"a": "out/one", "b": name})
        assert (refused["field"], "a finished run of the list" in refused["refused"]) == ("b", True), name
    lacking = requested(page, "/line", command="compare", values={"a": "out/one"})
    assert lacking["refused"] == "b is needed: a finished run of the list"


def test_earlier_runs_are_listed_and_broken_ones_named_as_such(page: Browser, folder: Path, tmp_path: Path) -> None:
    for name in ("good", "changed", "cut", "linked"):
        whole(folder / "out" / name)
    (folder / "out" / "changed" / "report.html").write_text("<p>other</p>")
    (folder / "out" / "cut" / "manifest.json").rename(folder / "out" / "cut" / "manifest.json.partial")
    (folder / "out" / "began").mkdir()
    (folder / "out" / "began" / "run.json.partial").write_text("{")
    secret = tmp_path / "secret.html"
    secret.write_text("<p>report</p>")
    (folder / "out" / "linked" / "report.html").unlink()
    (folder / "out" / "linked" / "report.html").symlink_to(secret)
    (folder / "out" / "way").symlink_to(tmp_path)
    runs = listed(page)
    assert set(runs) == {"out/good", "out/changed", "out/cut", "out/began", "out/linked", "out/way"}
    assert runs["out/way"]["trouble"] == "a link, which is not followed"
    assert (runs["out/good"]["title"], runs["out/good"]["verdict"], runs["out/good"]["trouble"]) == ("A <b>run</b>", "inside", "")
    assert "digest differs" in runs["out/changed"]["trouble"]
    assert runs["out/cut"]["trouble"] == runs["out/began"]["trouble"] == "the job that wrote here did not finish"
    assert "is a link" in runs["out/linked"]["trouble"]
    for name, run in runs.items():
        assert page.ask("GET", f"/report/{run['id']}").status == (200 if name == "out/good" else 404), name


def test_a_report_runs_in_a_frame_that_reaches_nothing(page: Browser, folder: Path) -> None:
    whole(folder / "out" / "run", "<script>fetch('/start')</script>")
    run = listed(page)["out/run"]
    answer = page.ask("GET", f"/report/{run['id']}")
    policy = answer.headers["content-security-policy"]
    assert answer.body == "<script>fetch('/start')</script>"
    assert all(part in policy for part in ("default-src 'none'", "sandbox allow-scripts", "frame-ancestors 'self'"))
    assert "allow-same-origin" not in policy
    assert "frame-src 'self'" in page.ask("GET", "/").headers["content-security-policy"]
    # Changed after it was listed, it is not shown any more.
    (folder / "out" / "run" / "report.html").write_text("<p>longer than it was before, much longer</p>")
    assert page.ask("GET", f"/report/{run['id']}").status == 404


def test_a_job_is_the_command_line_and_two_pages_see_it(page: Browser, server: Server, folder: Path) -> None:
    (folder / "empty.csv").write_text("", encoding="utf-8")
    server.files.look()
    with page.stream() as one, page.stream() as other:
        job = requested(page, "/start", command="analyze", values={"files": ["empty.csv"]})["job"]
        assert job["line"] == "navbound analyze empty.csv --out out/analyze-empty"
        for stream in (one, other):
            while not (rows := stream.next("state")["status"]["jobs"]) or rows[0]["state"] == "running":
                pass
            assert (rows[0]["state"], rows[0]["words"]) == ("failed", "empty.csv: the file is empty")
    assert "the file is empty" in json.loads(page.ask("GET", f"/output?job={job['id']}").body)["stderr"]
    assert page.ask("GET", "/output?job=77").status == 404
    assert "analyze-empty" not in "".join(name for name, run in listed(page).items() if not run["trouble"])


LONG = {"kind": "araim", "step_deg": "2", "checkpoint": True}


def test_a_stopped_job_leaves_nothing_that_reads_as_whole_and_goes_on(page: Browser, server: Server, folder: Path) -> None:
    first = requested(page, "/start", command="map", values=LONG)["job"]
    assert "runs" not in requested(page, "/start", command="map", values=LONG, name=first["out"].split("/")[1])
    parts = folder / "parts" / "map-araim"
    until(lambda: bool(server.jobs.all[1].progress()), "the job says nothing of its progress")
    until(lambda: bool(list(parts.glob("*.npz"))), "no part was finished")
    assert page.ask("POST", "/stop", json.dumps({"job": 1})).status == 204
    until(lambda: not server.jobs.all[1].runs, "the job did not end", jobs.GENTLE_S + 5.0)
    stopped = server.jobs.all[1].row()
    assert stopped["state"] == "stopped"
    assert stopped["words"] == "stopped. Finished parts are kept in parts/map-araim: the same command goes on from there."
    assert all(run["trouble"] for run in listed(page).values())
    # Again, under the same name: what is finished is not worked out again.
    n_parts = len(list(parts.glob("*.npz")))
    again = requested(page, "/start", command="map", values=stopped["values"], name="map-araim")["job"]
    assert again["line"] == first["line"]
    until(lambda: (server.jobs.all[2].progress() or {"done": 0})["done"] >= n_parts, "it began anew")
    server.jobs.end_all()
    assert len(list(parts.glob("*.npz"))) >= n_parts


def test_only_so_many_jobs_run_at_a_time(page: Browser, server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    waiting = [sys.executable, "-c", "import time; time.sleep(60)"]
    monkeypatch.setattr(jobs, "program", lambda *_: waiting)
    monkeypatch.setattr(jobs, "GENTLE_S", 0.1)
    values = {"files": ["track.csv"]}
    outs = [requested(page, "/start", command="analyze", values=values)["job"]["out"] for _ in range(jobs.MOST_RUNNING)]
    assert outs == ["out/analyze-track", "out/analyze-track-2"]
    assert "wait for one to end" in requested(page, "/start", command="analyze", values=values)["refused"]
    server.jobs.end_all()
    assert {job.state for job in server.jobs.all.values()} == {"stopped"}


def test_runways_and_procedures_are_listed_by_a_part_of_their_name(page: Browser, folder: Path, server: Server) -> None:
    matches = [each["value"] for each in json.loads(page.ask("GET", "/search?list=runways&words=lfpg/0").body)["matches"]]
    assert {"LFPG/08L", "LFPG/08R", "LFPG/09L", "LFPG/09R"} <= set(matches)
    database = Path(__file__).parent / "procedures" / "KDEN_H26-Z.txt"
    (folder / "database.txt").write_bytes(database.read_bytes())
    server.files.look()
    answer = json.loads(page.ask("GET", "/search?list=procedures&file=database.txt&words=h26").body)
    assert "KDEN/H26-Z:FUZZZ" in [each["value"] for each in answer["matches"]]
    assert page.ask("GET", "/search?list=procedures&file=../database.txt&words=h26").status == 404


def test_the_page_shows_the_lines_of_python_of_a_job(page: Browser) -> None:
    # That they do the same is tested in test_cli_lists.py.
    values = {"files": ["track.csv"], "sigma_m": "5", "spec": "RNP 1"}
    lines = requested(page, "/python", command="analyze", values=values)["python"]
    assert all(part in lines for part in ("import navbound", '["track.csv"]', "sigma_m=5.0", 'spec="RNP 1"', 'out="out/analyze-track"'))


def test_lines_of_python_that_take_too_long_are_a_sentence(page: Browser, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workbench_server, "program", lambda *_: [sys.executable, "-c", "import time; time.sleep(60)"])
    monkeypatch.setattr(workbench_server, "PYTHON_S", 0.1)
    assert "busy" in requested(page, "/python", command="analyze", values={"files": ["track.csv"]})["refused"]


def test_the_command_prints_the_address_and_ends_in_order(folder: Path, navbound: Callable[..., Ended]) -> None:
    missing = navbound("open", folder / "nothing", "--no-browser")
    assert (missing.status, "no such folder" in missing.stderr) == (3, True)
    line = [sys.executable, "-u", "-m", "navbound", "open", str(folder), "--no-browser"]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ | {"COLUMNS": "400"}) as process:
        assert process.stdout is not None
        printed = process.stdout.readline()
        try:
            port, token = re.search(r"http://127\.0\.0\.1:(\d+)/#([0-9a-f]{32})$", printed.strip()).groups()  # type: ignore[union-attr]
            body = json.dumps({"token": token})
            host = f"127.0.0.1:{port}"
            head = f"POST /session HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Length: {len(body)}\r\n\r\n"
            with socket.create_connection(("127.0.0.1", int(port)), 60.0) as way:
                way.sendall((head + body).encode())
                assert Browser.read(way).status == 204
        finally:
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
