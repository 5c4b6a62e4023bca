"""What the commands share: a bar on a terminal and nothing elsewhere, an answer at once, help that names everything there is."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

import navbound
from navbound import InputError, maps, scale
from navbound.cli import main, parts
from navbound.cli.main import app
from navbound.studies.registry import STUDIES

HEAVY = {"numpy", "polars", "navbound.run.judge"}


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    """A terminal of which every character is kept."""
    kept = io.StringIO()
    monkeypatch.setattr(parts, "err_console", Console(file=kept, force_terminal=True, width=100))
    return kept


def test_a_bar_counts_and_says_how_long_it_takes(screen: io.StringIO) -> None:
    with parts.Bar("flights") as tell:
        tell(0, 3)
        tell(2, 3)
        tell(3, 3)
    shown = screen.getvalue()
    assert "flights" in shown
    assert "3/3" in shown
    assert "0:00:00" in shown
    assert "left" in shown


def test_work_of_one_part_needs_no_bar(screen: io.StringIO) -> None:
    with parts.Bar("flights") as tell:
        tell(0, 1)
        tell(1, 1)
    assert screen.getvalue() == ""


def test_off_a_terminal_there_is_no_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    kept = io.StringIO()
    monkeypatch.setattr(parts, "err_console", Console(file=kept))
    with parts.Bar("flights") as tell:
        tell(0, 3)
        tell(3, 3)
    assert kept.getvalue() == ""


def test_off_a_terminal_lines_say_how_far_the_work_is(monkeypatch: pytest.MonkeyPatch) -> None:
    kept = io.StringIO()
    monkeypatch.setattr(parts, "err_console", Console(file=kept))
    monkeypatch.setattr(parts, "SAY_EVERY_S", 0.01)
    with parts.Bar("flights", "part 1 of 2 begins") as tell:
        assert kept.getvalue().splitlines()[0] == "part 1 of 2 begins"
        until(lambda: "flights: at work after 0 s\n" in kept.getvalue())
        tell(2, 3)
        until(lambda: "flights: 2 of 3 after 0 s\n" in kept.getvalue())
    ended = kept.getvalue()
    time.sleep(0.05)
    assert kept.getvalue() == ended


def test_nothing_stands_on_standard_error_where_a_file_is_read(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    kept = io.StringIO()
    monkeypatch.setattr(parts, "err_console", Console(file=kept))
    monkeypatch.setattr(parts, "SAY_EVERY_S", 0.01)
    monkeypatch.setenv(parts.PROGRESS, str(tmp_path / "far.json"))
    with parts.Bar("flights", "part 1 of 2 begins") as tell:
        tell(1, 3)
        time.sleep(0.05)
    assert kept.getvalue() == ""
    assert json.loads((tmp_path / "far.json").read_text(encoding="utf-8")) == {"what": "flights", "done": 1, "total": 3}


def test_work_goes_on_where_nobody_reads_standard_error() -> None:
    program = """
import time
from navbound.cli import parts
parts.SAY_EVERY_S = 0.01
with parts.Bar("flights", "part 1 of 2 begins") as tell:
    tell(1, 3)
    time.sleep(0.1)
print("done")
"""
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=write, check=False)
    os.close(write)
    assert (done.returncode, done.stdout) == (0, b"done\n")


def until(true: Callable[[], bool]) -> None:
    began_s = time.monotonic()
    while not true():
        assert time.monotonic() - began_s < 10.0
        time.sleep(0.005)


def test_what_was_not_requested_is_left_to_the_job() -> None:
    assert parts.work_of(None, None, None, None) == {}
    assert parts.work_of("processes", 2, None, None) == {"backend": "processes", "workers": scale.Workers(2)}


@pytest.mark.parametrize(
    ("backend", "workers", "cluster", "named"),
    [
        (None, 2, None, "workers"),
        ("serial", 2, None, "workers"),
        ("processes", None, "tcp://a:1", "cluster"),
        (None, None, "tcp://a:1", "cluster"),
    ],
)
def test_workers_that_would_not_be_used_are_refused(backend: str | None, workers: int | None, cluster: str | None, named: str) -> None:
    with pytest.raises(InputError, match=named):
        parts.work_of(backend, workers, cluster, None)


@pytest.mark.parametrize("arguments", [["--help"], ["methods", "--json"]])
def test_the_command_line_answers_without_loading_tables(arguments: list[str]) -> None:
    program = f"""
import sys
from navbound.cli.main import app
try:
    app({arguments!r})
except SystemExit:
    pass
print([name for name in {sorted(HEAVY)!r} if name in sys.modules], file=sys.stderr)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout
    assert done.stderr.strip() == "[]"


def test_help_names_everything_there_is() -> None:
    def helped(command: str) -> str:
        return CliRunner().invoke(app, [command, "--help"], terminal_width=200).output

    assert all(kind in helped("map") for kind in maps.KINDS)
    assert all(name in helped("study") for name in STUDIES)
    for command in ("fly", "map", "study"):
        assert all(backend in helped(command) for backend in scale.BACKENDS), command


def test_the_version_is_printed() -> None:
    printed = CliRunner().invoke(app, ["--version"])
    assert (printed.output, printed.exit_code) == (f"navbound {navbound.__version__}\n", 0)


def test_subjects_and_jobs_are_listed_and_loaded_when_they_are_used() -> None:
    program = (
        "import sys, navbound; dir(navbound); print(any(m in sys.modules for m in ('numpy', 'polars')));"
        "print(navbound.tse.exact(30.0, 8.0, 1e-5))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded, bound = done.stdout.split()
    assert loaded == "False"
    assert float(bound) > 30.0
    assert {*navbound.SUBJECTS, "fly", "analyze", "study"} <= set(dir(navbound))
    assert all(getattr(navbound, name).__name__ == f"navbound.{name}" for name in navbound.SUBJECTS)


def test_a_missing_file_is_refused_without_loading_tables() -> None:
    program = (
        "import sys\nfrom navbound.cli.main import app\n"
        "try:\n    app(['analyze', 'nowhere.csv'], standalone_mode=False)\nexcept Exception as e:\n    print(e)\n"
        f"print([name for name in {sorted(HEAVY)!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["nowhere.csv: no such file", "[]"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full: a full disk was NOT tried")
def test_a_full_disk_is_no_bug_of_ours(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def full(**_: object) -> None:
        with Path("/dev/full").open("w", encoding="utf-8") as file:
            file.write("x")

    monkeypatch.setattr(main, "app", full)
    with pytest.raises(SystemExit) as ended:
        main.main()
    assert ended.value.code == 3
    assert "No space left on device" in capsys.readouterr().err
