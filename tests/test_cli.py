"""The command line as a stranger uses it: every refusal is a sentence with the right exit status, never a traceback."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl
import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from conftest import Ended

    Command = Callable[..., Ended]

USAGE, UNREADABLE = 2, 3

TRACK = """time_ns,est_lat_rad,est_lon_rad,est_h_m,sigma_e_m,sigma_n_m
1400000000000000000,0.85,0.04,1000,4,4
1400000001000000000,0.85001,0.04,1000,4,4
1400000002000000000,0.85002,0.04,1000,4,4
1400000003000000000,0.85003,0.04,1000,4,4
"""


def started(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """In a process of its own."""
    return subprocess.run([sys.executable, "-m", "navbound", *map(str, arguments)], capture_output=True, text=True, check=False)


@pytest.fixture
def track(tmp_path: Path) -> Path:
    path = tmp_path / "track.csv"
    path.write_text(TRACK, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("arguments", "status", "named"),
    [
        (["fly", "nowhere"], USAGE, "beijing-shanghai"),
        (["fly", "beijing-shanghai", "--flights", "0"], USAGE, "[1, 1000]"),
        (["evaluate", "day.csv", "--levels", "APV-I", "--min-satellites", "5"], USAGE, "--stanford-esa"),
        (["analyze", "day.csv", "--listed-from", "0.5"], USAGE, "navbound evaluate"),
        (["analyze", "day.csv", "--mask", "90"], USAGE, "mask = 90.0 [deg]"),
        (["analyze", "day.csv", "--mask", "nan"], USAGE, "[0, 90)"),
        (["fly", "beijing-shanghai", "--flights", "many"], USAGE, "--flights"),
        (["fly", "barcelona-taxi", "--methods", "tse-exakt"], USAGE, "tse-exact"),
        (["fly", "--wrong"], USAGE, "--wrong"),
        (["analyze"], USAGE, "Missing argument"),
        (["analyze", "missing.csv"], UNREADABLE, "missing.csv"),
        (["study", "nothing"], USAGE, "tse-coverage"),
        (["study", "tse-coverage", "a.pos"], USAGE, "files"),
        (["study", "tse-coverage", "--out", "x"], USAGE, "ukraine-rnav"),
        (["study", "ukraine-rnav", "a.csv"], USAGE, "files"),
        (["study", "error-extraction", "missing.pos"], UNREADABLE, "missing.pos"),
        (["show", "missing"], UNREADABLE, "missing"),
        (["nothing"], USAGE, "nothing"),
    ],
)
def test_a_wrong_call_is_a_sentence(arguments: list[str], status: int, named: str, tmp_path: Path, navbound: Command) -> None:
    done = navbound(*arguments, *(["--out", str(tmp_path / "run")] if arguments[0] == "fly" else []))
    assert done.status == status, done.stderr
    assert named in done.stderr
    assert "Traceback" not in done.stderr
    assert "bug" not in done.stderr


@pytest.mark.parametrize(
    ("option", "named"),
    [
        (["--spec", "RNPX"], "RNP AR"),
        (["--spec", "RNP 0"], "(0, 20]"),
        (["--spec", "RNP AR 0.7"], "[185.2, 555.6]"),
        (["--path", "LFPG/99X"], "08R"),
        (["--sigma-m", "-3"], "--sigma-m = -3.0 [m]"),
        (["--map", "latitude"], "canonical=column"),
    ],
)
def test_a_wrong_option_names_what_is_allowed(option: list[str], named: str, track: Path, tmp_path: Path, navbound: Command) -> None:
    done = navbound("analyze", track, *option, "--out", tmp_path / "run")
    assert done.status == USAGE, done.stderr
    assert named in done.stderr


@pytest.mark.parametrize(
    ("content", "named"),
    [
        (b"", "empty"),
        (b"\x1f\x8b\x08\x00broken", "gzip"),
        (b"a,b\n1,2\n", "time"),
        (b"latitude,longitude,timestamp\n91.5,2,2021-10-07T12:00:00\n", "91.5"),
    ],
)
def test_unreadable_data_say_where(content: bytes, named: str, tmp_path: Path, navbound: Command) -> None:
    path = tmp_path / "bad.csv"
    path.write_bytes(content)
    done = navbound("analyze", path, "--out", tmp_path / "run")
    assert done.status == UNREADABLE, done.stderr
    assert named in done.stderr
    assert "bad.csv" in done.stderr


def test_what_is_refused_in_a_process_of_its_own_is_the_same_sentence(tmp_path: Path, navbound: Command) -> None:
    """The other refusals are seen in the process of the test."""
    for arguments, status in ((["fly", "nowhere", "--out", str(tmp_path / "run")], USAGE), (["analyze", "missing.csv"], UNREADABLE)):
        alone, here = started(*arguments), navbound(*arguments)
        assert alone.returncode == here.status == status
        assert (alone.stdout, alone.stderr) == (here.stdout, here.stderr)


def test_a_column_can_be_named(track: Path, tmp_path: Path) -> None:
    renamed = track.with_name("renamed.csv")
    renamed.write_text(TRACK.replace("est_lat_rad", "phi"), encoding="utf-8")
    done = started("analyze", renamed, "--map", "est_lat_rad=phi:rad", "--out", tmp_path / "run", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["verdict"]["n_judged"] == 4


def test_a_run_can_be_shown_again(track: Path, tmp_path: Path) -> None:
    first = started("analyze", track, "--out", tmp_path / "run", "--json")
    again = started("show", tmp_path / "run", "--json")
    assert first.returncode == again.returncode == 0, first.stderr
    assert json.loads(first.stdout) == json.loads(again.stdout)
    assert "later job" not in again.stderr
    (tmp_path / "run" / "summary.json.partial").write_text("{", encoding="utf-8")
    killed = started("show", tmp_path / "run", "--json")
    assert json.loads(killed.stdout) == json.loads(first.stdout)
    assert "a later job began here and has not finished (summary.json.partial); this is the run before it." in killed.stderr


def test_a_directory_with_other_files_is_left_alone(track: Path, tmp_path: Path) -> None:
    (tmp_path / "letter.txt").write_text("dear")
    done = started("analyze", track, "--out", tmp_path)
    assert done.returncode == UNREADABLE
    assert "letter.txt" in done.stderr


def test_verify_prints_every_vector_file() -> None:
    done = started("verify", "--json")
    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)
    assert sum(row["n_cases"] for row in rows) > 1000
    assert all(not row["failures"] for row in rows)


def test_the_run_record_says_how_to_do_it_again(flown) -> None:  # type: ignore[no-untyped-def]
    assert flown.path is not None
    record = json.loads((flown.path / "run.json").read_text())
    assert record["scenario"] is not None
    assert record["seed"] is not None
    epochs = pl.read_parquet(flown.path / "epochs.parquet")
    assert epochs.height == 7081
