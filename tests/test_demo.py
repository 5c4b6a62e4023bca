"""`navbound demo`: what happened in the order of time, whether the quiet flights' bounds contained the errors, and what to do next."""

from __future__ import annotations

import math
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import navbound
from navbound.exit_status import NO_VERDICT
from navbound.live.session import origin_of
from navbound.run.directory import load

CHROMIUM = shutil.which("chromium")
# The scenario's own file: interference from 6420 s for 120 s, spoofing from 6600 s for 400 s, of a flight that begins at midnight UTC
# of 2022-08-01.
BEGINS = {"interference begins": 6420, "interference ends": 6540, "spoofing begins": 6600, "spoofing ends": 7000}


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str, str]:
    out = tmp_path_factory.mktemp("demo")
    command = [sys.executable, "-m", "navbound", "demo", "--out", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stderr
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


def test_a_fault_that_lasts_keeps_what_follows() -> None:
    run = navbound.fly("beijing-shanghai-spoofed")
    (fault,) = run.summary.faults
    assert fault.moments[0].words == "spoofing begins"
    assert [m.time_ns for m in fault.moments] == sorted(m.time_ns for m in fault.moments)


def test_the_spoofed_approach_is_replayed_on_the_flight_display(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "navbound", "demo", "--live", "--out", str(tmp_path)]
    # No browser is opened on the machine of the test.
    quiet = {**os.environ, "BROWSER": "true"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=quiet) as process:
        assert process.stdout is not None
        sentences = list[str]()
        while not (sentences and sentences[-1].startswith("Display: http://127.0.0.1:")):
            sentences.append(process.stdout.readline())
            assert sentences[-1], "it ended before the display was there"
        # A minute of the flight.
        time.sleep(2.0)
        process.send_signal(signal.SIGINT)
        rest, trouble = process.communicate(timeout=30)
    # The rest of the recording was not judged.
    assert process.returncode == NO_VERDICT, trouble
    assert "stopped at byte" in rest + trouble
    assert "spoofing begins" in "".join(sentences)
    assert "epochs of 1 tracks" in rest
    origin = origin_of(tmp_path / "session")
    assert (origin["kind"], origin["speed"]) == ("replay", 60.0)
    # The path ahead is that of the flight: from Beijing (40 N, 117 E) to Shanghai (31 N, 121 E), to a degree.
    (first, last) = (origin["points"][0], origin["points"][-1])
    assert [round(math.degrees(x)) for x in (*first[:2], *last[:2])] == [40, 117, 31, 121]
