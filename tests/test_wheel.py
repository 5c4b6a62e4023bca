"""The wheel, installed into an empty environment: what a person gets who has neither the repository nor a compiler.

Its demonstration says what happened in the order of time, whether the quiet flights' bounds contained the errors, and what to do next.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from navbound.run.directory import load

ROOT = Path(__file__).parents[1]
UV = shutil.which("uv") or shutil.which("uv", path=ROOT / ".dev" / "uv" / "bin")
CHROMIUM = shutil.which("chromium")
# The scenario's own file: interference from 6420 s for 120 s, spoofing from 6600 s for 400 s, of a flight that begins at midnight UTC
# of 2022-08-01.
BEGINS = {"interference begins": 6420, "interference ends": 6540, "spoofing begins": 6600, "spoofing ends": 7000}
pytestmark = pytest.mark.skipif(UV is None, reason="uv is not installed: the wheel was NOT built and NOT tried")


def ended(*command: str | Path, cwd: Path, status: int = 0) -> subprocess.CompletedProcess[str]:
    # Nothing of the repository may be found by the package that is tried.
    environment = {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "VIRTUAL_ENV"}}
    done = subprocess.run(list(map(str, command)), cwd=cwd, env=environment, capture_output=True, text=True, check=False, timeout=1200)
    assert done.returncode == status, (command, done.returncode, done.stdout[-2000:], done.stderr[-4000:])
    return done


def called(*command: str | Path, cwd: Path, status: int = 0) -> str:
    return ended(*command, cwd=cwd, status=status).stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the programs of an environment that holds the wheel and what it depends on, nothing else."""
    folder = tmp_path_factory.mktemp("wheel")
    called(UV or "uv", "build", "--quiet", "--wheel", "--out-dir", folder / "dist", ROOT, cwd=folder)
    (wheel,) = (folder / "dist").glob("*.whl")
    # Of every Python from 3.11.
    assert "-cp311-abi3-" in wheel.name
    called(UV or "uv", "venv", "--quiet", "--python", sys.executable, folder / "env", cwd=folder)
    programs = folder / "env" / ("Scripts" if sys.platform == "win32" else "bin")
    called(UV or "uv", "pip", "install", "--quiet", "--python", programs / "python", wheel, cwd=folder)
    return programs


def test_the_package_is_the_installed_one_and_brings_its_bill_of_materials(installed: Path, tmp_path: Path) -> None:
    place = Path(called(installed / "python", "-c", "import navbound; print(navbound.__file__)", cwd=tmp_path).strip())
    assert place.is_relative_to(installed.parent)
    packages = place.parents[1]
    (bill,) = packages.glob("navbound-*.dist-info/sboms/*.cyclonedx.json")
    assert '"nalgebra"' in bill.read_text(encoding="utf-8")
    assert called(installed / "navbound", "--version", cwd=tmp_path).startswith("navbound ")


def test_the_reference_vectors_are_met(installed: Path, tmp_path: Path) -> None:
    assert "tse-exact" in called(installed / "navbound", "verify", cwd=tmp_path)


def test_a_recording_is_analysed(installed: Path, tmp_path: Path) -> None:
    rows = [f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z,{49 + k * 7e-4:.7f},2.5,100.0,8.0,8.0" for k in range(600)]
    (tmp_path / "track.csv").write_text("\n".join(["time,lat,lon,h_m,sigma_e_m,sigma_n_m", *rows]) + "\n")
    words = called(installed / "navbound", "analyze", tmp_path / "track.csv", "--spec", "RNP 0.3", "--out", tmp_path / "run", cwd=tmp_path)
    assert "inside RNP 0.3" in words
    assert (tmp_path / "run" / "report.html").is_file()


@pytest.fixture(scope="module")
def demo(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str, str]:
    """Of the wheel: what a stranger runs first."""
    out = tmp_path_factory.mktemp("demo")
    done = ended(installed / "navbound", "demo", "--out", out, cwd=out)
    return out, done.stdout, done.stderr


def test_off_a_terminal_every_part_says_that_it_begins_and_how_far_it_is(demo: tuple[Path, str, str]) -> None:
    lines = demo[2].splitlines()
    begun = [line for line in lines if not re.fullmatch(r"flights: (at work|\d+ of (1|12)) after \d+ s", line)]
    assert begun == ["navbound demo: part 1 of 2 begins", "navbound demo: part 2 of 2 begins"]
    assert not set(lines) & set(demo[1].splitlines())


def seconds(clock: str) -> int:
    hours, minutes, rest = map(int, clock.split(":"))
    return 3600 * hours + 60 * minutes + rest


def test_what_happened_is_printed_in_the_order_of_time(demo: tuple[Path, str, str]) -> None:
    lines = re.findall(r"^  (\d\d:\d\d:\d\d) UTC  (.*)$", demo[1], re.MULTILINE)
    at = {words: seconds(clock) for clock, words in lines}
    assert [seconds(clock) for clock, _ in lines] == sorted(at[words] for _, words in lines)
    first = at["interference begins"]
    assert {words: t - first for words, t in at.items() if words in BEGINS} == {words: t - 6420 for words, t in BEGINS.items()}
    epochs = load(demo[0] / "interference").epochs
    truly_outside = epochs.filter(epochs["tse_m"].abs() > epochs["rnp_m"])["time_ns"][0]
    begin_ns = load(demo[0] / "interference").summary.faults[0].start_ns
    assert at["the true error leaves RNP"] - first == round((truly_outside - begin_ns) * 1e-9)
    alerts = [words for words in at if words.startswith("first alert")]
    assert len(alerts) == 1
    ahead = at["the true error leaves RNP"] - at[alerts[0]]
    assert ahead > 0
    assert f"Of the spoofing: the first alert came {ahead} s before the true error left RNP." in demo[1]


def test_what_the_second_fault_does_is_not_put_down_to_the_first(demo: tuple[Path, str, str]) -> None:
    interference, spoofing = load(demo[0] / "interference").summary.faults
    assert interference.end_ns is not None
    assert max(m.time_ns for m in interference.moments) < spoofing.start_ns
    assert interference.outcome == "no alert needed"
    assert spoofing.outcome == "before"


def test_the_quiet_flights_hold_what_the_first_screen_says(demo: tuple[Path, str, str]) -> None:
    run = load(demo[0] / "quiet")
    assert run.summary.verdict.id == "inside"
    belief = run.summary.verdict.belief
    assert belief is not None
    for bound in belief.bounds:
        # The interval of what was contained reaches the stated probability.
        assert bound.coverage_high >= 1 - bound.risk
        assert f"{bound.method}, stated for {100 * (1 - bound.risk):g} %: contains {100 * bound.coverage:.1f} %" in demo[1]


def test_the_last_lines_say_what_to_do_next(demo: tuple[Path, str, str]) -> None:
    following = demo[1].split("What to do next\n")[1]
    commands = [line.strip() for line in following.splitlines() if line.startswith("  ") and not line.startswith("   ")]
    assert len(commands) == 3
    assert Path(commands[0].removeprefix("open ")).is_file()
    assert commands[1].startswith("navbound analyze YOUR_FILE")


def test_the_flight_is_judged_again_live(demo: tuple[Path, str, str], installed: Path, tmp_path: Path) -> None:
    lines = called(installed / "navbound", "live", demo[0] / "interference", "--speed", "100000", "--out", tmp_path / "live", cwd=tmp_path)
    assert "warning" in lines


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the report was NOT opened in a browser")
def test_the_report_opens_on_the_event_and_a_key_shows_the_whole(demo: tuple[Path, str, str]) -> None:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto((demo[0] / "interference" / "report.html").as_uri())
        page.wait_for_selector("#report[data-ready]")
        story = page.locator(".story").inner_text()
        assert story.index("spoofing begins") < story.index("first alert") < story.index("the true error leaves RNP")
        whole = page.get_by_role("button", name="Show all epochs", exact=True)
        assert whole.is_enabled()
        page.keyboard.press("e")
        assert whole.is_disabled()
        page.keyboard.press("e")
        assert whole.is_enabled()
        page.goto((demo[0] / "quiet" / "report.html").as_uri())
        page.wait_for_selector("#report[data-ready]")
        assert page.locator(".story").count() == 0
        assert whole.is_disabled()
        browser.close()
