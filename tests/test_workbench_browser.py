"""The workbench as a person meets it who never uses a terminal: in a real browser, by mouse, by keyboard alone, on a telephone."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import navbound
from navbound.workbench import Server
from test_workbench import TRACK, opened, whole

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the workbench was NOT opened in a browser")
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
DATA = Path(__file__).parents[1] / "examples" / "data"
HOSTILE = "<img src=x onerror=document.title='taken'>.csv"
JOB_MS = 120_000
"""A job is a process that loads numbers: two seconds, or a minute on a machine that does other things. [ms]"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("own")
    for name in ("tracks.csv", "tracks-truth.csv", "levels.csv", "broadcast.rnx"):
        shutil.copy(DATA / name, place / name)
    (place / "damaged.csv.gz").write_bytes(b"\x1f\x8b\x08\x00broken")
    (place / HOSTILE).write_text("time,lat_deg\n", encoding="utf-8")
    whole(place / "out" / "before")
    whole(place / "out" / "broken")
    (place / "out" / "broken" / "report.html").write_text("changed")
    (place / "track.csv").write_text(TRACK, encoding="utf-8")
    for name, sigma_m in (("first", 5.0), ("second", 300.0)):
        navbound.analyze(place / "track.csv", spec="RNP 0.3", sigma_m=sigma_m, out=place / "out" / name)
    return place


@pytest.fixture(scope="module")
def server(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with opened(folder, tmp_path_factory.mktemp("logs")) as made:
        yield made


@contextmanager
def shown(browser: Browser, server: Server, width: int = 1440, scheme: Any = "light") -> Iterator[Page]:
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
    page = context.new_page()
    problems: list[str] = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("console", lambda message: problems.append(message.text) if message.type in {"error", "warning"} else None)
    page.goto(server.address)
    page.wait_for_selector("#workbench[data-painted]", timeout=20_000)
    yield page
    assert problems == []
    context.close()


def row(page: Page, name: str) -> str:
    return page.locator(f'tr[data-file="{name}"]').inner_text()


def start(page: Page) -> None:
    page.get_by_role("button", name="Start", exact=True).click()


def report(page: Page) -> str:
    """The report that opens by itself when the job has ended; its words."""
    page.wait_for_selector("iframe", timeout=JOB_MS)
    page.frame_locator("iframe").locator("h1").first.wait_for()
    return page.frame_locator("iframe").locator("body").inner_text()


def test_the_engineer_judges_a_days_tracks_against_the_runways(browser: Browser, server: Server, folder: Path) -> None:
    with shown(browser, server) as page:
        assert "#" not in page.url
        page.get_by_label("Use tracks.csv").check()
        page.locator('[data-input="path"]').fill("lfpg/0")
        page.locator("li", has_text="LFPG/08R").click()
        assert page.locator('[data-input="path"]').input_value() == "LFPG/08R"
        page.locator('[data-input="path"]').fill("auto")
        page.locator('[data-input="truth"]').fill("truth")
        page.locator("li", has_text="tracks-truth.csv").click()
        page.locator('[data-input="sigma_m"]').fill("8")
        page.get_by_text("The same from a terminal").click()
        page.wait_for_function("() => document.querySelector('[data-lines=terminal]').textContent.includes('--sigma-m 8')")
        line = page.locator("[data-lines=terminal]").inner_text().splitlines()[1]
        start(page)
        words = report(page)
        assert "24 recorded approaches to LFPG/08R, LFPG/09L" in words
        page.get_by_role("button", name="Back").click()
        job = page.locator('.wb-job[data-state="done"], .wb-job[data-state="no_verdict"]').first
        assert line in job.inner_text()
        assert line == "navbound analyze tracks.csv --path auto --truth tracks-truth.csv --sigma-m 8 --out out/analyze-tracks"
        # A second tab has it too, and finds the run.
        with shown(browser, server) as other:
            other.get_by_role("button", name="24 recorded approaches to LFPG/08R, LFPG/09L").click()
            assert "24 recorded approaches" in report(other)
            assert other.locator(f'.wb-job:has-text("{line}")').count() == 1
    assert (folder / "out" / "analyze-tracks" / "manifest.json").is_file()


def test_the_analyst_evaluates_levels_with_the_keyboard_alone(browser: Browser, server: Server) -> None:
    def to(page: Page, selector: str) -> None:
        """Tab until there."""
        for _ in range(120):
            if page.evaluate("s => document.activeElement.matches(s)", selector):
                return
            page.keyboard.press("Tab")
        raise AssertionError(f"the Tab key does not reach {selector}")

    with shown(browser, server, scheme="dark") as page:
        to(page, '[aria-label="Use levels.csv"]')
        page.keyboard.press("Space")
        to(page, '[data-choice="evaluate"]')
        page.keyboard.press("Enter")
        to(page, '.wb-tick input[value="APV-I"]')
        page.keyboard.press("Space")
        to(page, ".wb-start")
        page.keyboard.press("Enter")
        assert "APV-I" in report(page)
        # The way back is where the focus is.
        assert page.evaluate("() => document.activeElement.textContent") == "Back"
        page.keyboard.press("Enter")
        assert page.evaluate("() => document.activeElement.textContent") == "Start"


def test_the_student_predicts_raim_on_a_telephone(browser: Browser, server: Server) -> None:
    with shown(browser, server, width=420) as page:
        page.locator('[data-choice="predict"]').click()
        page.locator('[data-input="kind"]').select_option("raim")
        page.locator('[data-input="constellation"]').fill("gps")
        page.locator('[data-input="at"]').first.fill("lfpg/08r")
        page.locator("li", has_text="LFPG/08R").click()
        page.get_by_text("More options").click()
        page.locator('[data-input="hours"]').fill("1")
        assert page.evaluate("() => document.documentElement.scrollWidth") <= 420
        start(page)
        page.wait_for_selector(".wb-output", timeout=JOB_MS)
        assert "LFPG/08R" in page.locator(".wb-output").inner_text()
        assert page.evaluate("() => document.documentElement.scrollWidth") <= 420


def test_the_newcomer_drops_a_file_and_sees_what_is_wrong(browser: Browser, server: Server) -> None:
    with shown(browser, server) as page:
        assert "Not usable: the gzip stream is damaged" in row(page, "damaged.csv.gz")
        assert page.get_by_label("Use damaged.csv.gz").is_disabled()
        files = [
            {"name": HOSTILE, "mimeType": "text/csv", "buffer": b"a,b\n1,2\n"},
            {"name": "empty.csv", "mimeType": "text/csv", "buffer": b""},
        ]
        page.locator('input[type="file"]').set_input_files(files)  # type: ignore[arg-type]
        page.wait_for_selector('tr[data-file="dropped/empty.csv"]')
        assert "Not usable: the file is empty" in row(page, "dropped/empty.csv")
        # A name is text, wherever it stands.
        assert page.locator("img").count() == 0
        assert page.title().startswith("navbound workbench")
        assert page.get_by_label(f"Use {HOSTILE}").count() == 1
        start(page)
        refused = page.get_by_role("alert").filter(has_text="column")
        card = page.locator('.wb-job[data-state="failed"]')
        refused.or_(card).first.wait_for(timeout=JOB_MS)
        assert page.locator("iframe").count() == 0


def test_earlier_runs_stand_on_the_page_and_broken_ones_are_no_results(browser: Browser, server: Server) -> None:
    with shown(browser, server) as page:
        page.get_by_role("button", name="A <b>run</b>").click()
        page.frame_locator("iframe").get_by_text("report").wait_for()
        page.get_by_role("button", name="Back").click()
        broken = page.locator('tr[data-run="out/broken"]')
        assert "Not whole" in broken.inner_text()
        assert broken.locator("button").count() == 0


def test_two_runs_are_compared_with_the_keyboard_alone(browser: Browser, server: Server, folder: Path) -> None:
    with shown(browser, server, width=420, scheme="dark") as page:
        page.get_by_role("button", name="Compare out/first with another run").focus()
        page.keyboard.press("Enter")
        # The first of the two is chosen, and the other is requested.
        assert page.locator('[data-input="a"]').input_value() == "out/first"
        assert page.evaluate("() => document.activeElement.dataset.input") == "b"
        assert page.evaluate("() => document.documentElement.scrollWidth") <= 420
        options = page.locator('[data-input="b"] option').all_inner_texts()
        assert not any(name in option for name in ("out/broken", "out/before") for option in options)
        page.keyboard.type("out/second")
        assert page.locator('[data-input="b"]').input_value() == "out/second"
        page.locator(".wb-start").focus()
        page.keyboard.press("Enter")
        words = report(page)
        # Five epochs of one second each; a sigma of 300 m leaves none inside RNP 0.3.
        assert "5 epochs of both runs are compared" in words
        assert "Back" in page.evaluate("() => document.activeElement.textContent")
        page.keyboard.press("Enter")
        page.get_by_role("button", name="out/first compared with out/second").wait_for()
    assert (folder / "out" / "compare-first" / "comparison.json").is_file()


def test_a_job_is_stopped_and_goes_on(browser: Browser, server: Server, folder: Path) -> None:
    with shown(browser, server) as page:
        page.locator('[data-choice="map"]').click()
        page.locator('[data-input="kind"]').select_option("araim")
        page.locator('[data-input="step_deg"]').fill("2")
        page.get_by_text("More options").click()
        page.get_by_label("Keep finished parts").check()
        start(page)
        card = page.locator(".wb-job").first
        page.wait_for_function("() => /of \\d+ tiles/.test(document.querySelector('.wb-job .note').textContent)", timeout=JOB_MS)
        card.get_by_role("button", name="Stop").click()
        page.wait_for_selector('.wb-job[data-state="stopped"]', timeout=JOB_MS)
        assert not (folder / "out" / "map-araim" / "manifest.json").exists()
        card.get_by_role("button", name="Go on").click()
        page.wait_for_selector('.wb-job[data-state="running"]', timeout=JOB_MS)
        again = page.locator('.wb-job[data-state="running"]')
        again.get_by_role("button", name="Stop").click()
        page.wait_for_function("() => document.querySelectorAll('.wb-job[data-state=stopped]').length === 2", timeout=JOB_MS)
        lines = page.locator('.wb-job[data-state="stopped"] code').all_inner_texts()
        assert lines[0] == lines[1]


def test_a_page_without_the_token_shows_how_to_get_in_and_nothing_else(browser: Browser, server: Server) -> None:
    page = browser.new_context().new_page()
    page.goto(server.address.split("#", maxsplit=1)[0])
    page.wait_for_selector('#workbench[data-painted="stranger"]')
    assert "the address that `navbound open` printed" in page.locator("#workbench").inner_text()
    assert page.locator("table").count() == 0
    page.context.close()
