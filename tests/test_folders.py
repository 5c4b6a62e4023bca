"""Folders of results: whole or refused, whatever stops the job that writes them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from navbound import FormatError
from navbound.run import directory
from navbound.storage import folders

NAMES = ("run.json", "epochs.parquet", "report.html")


def write(out: Path, word: str) -> None:
    with folders.own(out, NAMES, "a run's") as folder:
        for name in NAMES:
            folder.text(name, f"{name} of the {word} job")


KILLED = """
import os, signal, sys
from pathlib import Path
from test_folders import write

def job(out, last):
    seen = 0
    def stop(event, arguments):
        nonlocal seen
        if event in ("open", "os.rename", "os.remove", "os.mkdir") and str(out) in str(arguments[0]):
            seen += 1
            if seen > last:
                os.kill(os.getpid(), signal.SIGKILL)
    sys.addaudithook(stop)
    write(out, "new")

for last in range(100):
    child = os.fork()
    if child == 0:
        job(Path(sys.argv[1]) / str(last), last)
        os._exit(0)
    if os.waitpid(child, 0)[1] == 0:
        print(last)
        break
"""


def words(out: Path) -> set[str]:
    """Which job's files a reader takes; none where it refuses the folder."""
    try:
        folders.require_whole(out, NAMES, "a run directory")
    except FormatError:
        return set()
    return {(out / name).read_text().split(" of the ")[1] for name in NAMES}


@pytest.mark.parametrize("before", [True, False])
def test_a_job_killed_at_any_write_leaves_no_folder_that_reads_as_its_result(tmp_path: Path, *, before: bool) -> None:
    for last in range(100 if before else 0):
        write(tmp_path / str(last), "old")
    # A process of its own without threads, which forks one for every operation on a file to be killed at.
    killed = [sys.executable, "-c", KILLED, str(tmp_path)]
    done = subprocess.run(killed, capture_output=True, text=True, check=True, cwd=Path(__file__).parent)
    finished = int(done.stdout)
    assert finished >= 3 * len(NAMES), "operations were not seen"
    outcomes = [words(tmp_path / str(last)) for last in range(finished + 1)]
    assert set(map(tuple, outcomes)) <= {(), ("new job",), *([("old job",)] if before else [])}
    assert outcomes[-1] == {"new job"}
    # While the new files are written the old ones stand; only the renaming takes them away.
    assert outcomes.count({"old job"}) >= (2 * len(NAMES) if before else 0)
    places = [tmp_path / str(last) for last in range(finished + 1)]
    began = [place.is_dir() and bool(folders.unfinished(place)) for place in places]
    # Every job that wrote a byte and did not finish is seen, also where the folder reads as the one before it.
    assert not began[-1]
    assert sum(seen and outcome == {"old job"} for seen, outcome in zip(began, outcomes, strict=True)) >= (len(NAMES) if before else 0)
    for last in range(finished + 1):
        write(tmp_path / str(last), "next")
        assert words(tmp_path / str(last)) == {"next job"}, "what a killed job leaves must not stop the next one"
        assert sorted(p.name for p in (tmp_path / str(last)).iterdir()) == sorted([*NAMES, folders.MANIFEST])


def test_two_jobs_do_not_write_in_one_folder(tmp_path: Path) -> None:
    with folders.own(tmp_path, NAMES, "a run's") as folder:
        with pytest.raises(FormatError, match="another job is writing here"):
            write(tmp_path, "second")
        for name in NAMES:
            folder.text(name, f"{name} of the first job")
    assert words(tmp_path) == {"first job"}


@pytest.mark.parametrize("suffix", ["", ".partial"])
def test_a_link_in_the_folder_is_not_followed(tmp_path: Path, suffix: str) -> None:
    outside = tmp_path / "outside"
    outside.write_text("somebody else's")
    out = tmp_path / "out"
    out.mkdir()
    (out / f"run.json{suffix}").symlink_to(outside)
    write(out, "new")
    assert outside.read_text() == "somebody else's"
    assert words(out) == {"new job"}


def test_a_file_changed_after_the_job_is_detected(tmp_path: Path) -> None:
    write(tmp_path, "first")
    report = tmp_path / "report.html"
    report.write_bytes(report.read_bytes().replace(b"first", b"other"))
    with pytest.raises(FormatError, match="its digest differs"):
        folders.require_whole(tmp_path, NAMES, "a run directory")


def test_a_run_without_a_manifest_is_no_run(tmp_path: Path) -> None:
    write(tmp_path, "first")
    (tmp_path / folders.MANIFEST).unlink()
    with pytest.raises(FormatError, match="did not finish"):
        directory.load(tmp_path)


FULL = """
import resource, signal, sys
from navbound.cli.main import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
sys.argv = ["navbound", "fly", "beijing-shanghai-seed", "--out", sys.argv[1]]
main()
"""


def test_a_disk_that_takes_no_more_is_a_sentence_and_leaves_no_result(tmp_path: Path) -> None:
    out = tmp_path / "run"
    done = subprocess.run([sys.executable, "-c", FULL, str(out)], capture_output=True, text=True, check=False)
    assert done.returncode == 3, done.stderr
    assert "cannot be written" in done.stderr
    assert "bug" not in done.stderr
    assert list(out.iterdir()) == []


@pytest.mark.parametrize("name", [folders.MANIFEST, "run.json"])
def test_a_pipe_in_the_place_of_a_file_is_refused_and_not_waited_for(tmp_path: Path, name: str) -> None:
    write(tmp_path / "out", "new")
    (tmp_path / "out" / name).unlink()
    os.mkfifo(tmp_path / "out" / name)
    with pytest.raises(FormatError, match=f"{name}: is not a file"):
        folders.require_whole(tmp_path / "out", NAMES, "a run directory")


def test_a_page_that_was_changed_after_the_job_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "out", "new")
    (tmp_path / "out" / "report.html").write_text("")
    with pytest.raises(FormatError, match=r"report.html: is not the file that the job wrote"):
        folders.require_whole(tmp_path / "out", ("run.json",), "a run directory")


def test_a_manifest_nested_too_deeply_is_damaged(tmp_path: Path) -> None:
    write(tmp_path / "out", "new")
    (tmp_path / "out" / folders.MANIFEST).write_text("[" * 100_000)
    with pytest.raises(FormatError, match=f"{folders.MANIFEST}: is damaged"):
        folders.require_whole(tmp_path / "out", NAMES, "a run directory")
