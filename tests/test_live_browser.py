"""The live display in a real browser: its numbers are those of the journal, and what it does not know it does not show."""

from __future__ import annotations

import base64
import os
import random
import shutil
import signal
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from display_fixture import SETTINGS, Fed, Feeder
from navbound import live
from navbound.live.child import Child
from navbound.live.display import Options
from navbound.live.display import child as display_child
from navbound.live.sinks import tables

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the display was NOT opened in a browser")
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
PROBES = (Path(__file__).parent / "report_probes.js").read_text(encoding="utf-8").split("\n", 1)[1].strip()
DIGITS = ("rnp_m", "anp_m", "fte_m", "anp_vertical_m", "fte_v_m", "accuracy_bound_m", "integrity_compared_m", "hpl_m", "vpl_m")
LINK_S = 2.0
"""Silence after which the page says that its link is lost: docs/methods/live.md."""
BUSY_S = 1.0
"""What a test machine that does other things may add to a time on the screen. Its own clock ticks each 0.2 s."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@dataclass
class Shown:
    """A session that is fed, its display, and a page that has it open."""

    fed: Fed
    feeder: Feeder
    child: Child
    page: Page
    problems: list[str]

    def word(self) -> str:
        return self.page.locator(".fresh-word").inner_text()

    def wait_for_word(self, word: str, timeout_s: float = 10.0) -> float:
        """Until the page says a word; how long that took."""
        began = time.monotonic()
        self.page.wait_for_function(
            "w => document.querySelector('.fresh-word').textContent === w", arg=word, timeout=1000 * timeout_s, polling=20
        )
        return time.monotonic() - began

    def digits(self) -> dict[str, tuple[str, str]]:
        """Shown text and full value of every number of the present."""
        script = """keys => Object.fromEntries(keys.map(k => {
            const e = document.querySelector(`.panel [data-key="${k}"]`); return [k, [e.textContent, e.dataset.value]]; }))"""
        return {key: (text, value) for key, (text, value) in self.page.evaluate(script, list(DIGITS)).items()}

    def stop(self) -> None:
        """The server stops where it is: its connections stay open and say nothing."""
        assert self.child._process.pid is not None
        os.kill(self.child._process.pid, signal.SIGSTOP)

    def go_on(self) -> None:
        assert self.child._process.pid is not None
        os.kill(self.child._process.pid, signal.SIGCONT)


@contextmanager
def shown(browser: Browser, folder: Path, width: int = 1440, scheme: Any = "light", fed: Fed | None = None) -> Iterator[Shown]:
    fed = fed or Fed(folder)
    problems: list[str] = []
    # A journal that a failed test leaves open is complained of in another test.
    with closing(fed), Feeder(fed) as feeder, display_child(fed.folder, Options()) as child:
        context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
        page = context.new_page()
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("console", lambda message: problems.append(message.text) if message.type in {"error", "warning"} else None)
        page.goto(child.text)
        page.wait_for_selector("#display[data-painted]", timeout=20_000)
        display = Shown(fed, feeder, child, page, problems)
        try:
            yield display
        finally:
            display.go_on()
            context.close()


@pytest.fixture
def normal(browser: Browser, tmp_path: Path) -> Iterator[Shown]:
    with shown(browser, tmp_path / "session") as display:
        display.wait_for_word("LIVE DATA")
        yield display
        assert display.problems == []


def test_numbers_of_the_page_are_those_of_the_journal(normal: Shown) -> None:
    normal.feeder.values = {"fte_m": 31.25, "hpl_m": 19.5}
    normal.page.wait_for_function("() => document.querySelector('[data-key=hpl_m]').dataset.value === '19.5'")
    shown_words = normal.digits()
    row = tables.epochs(normal.fed.folder).tail(1).to_dicts()[0]
    expected = {**row, "anp_m": row["anp_cross_m"]}
    for key, (text, value) in shown_words.items():
        # Twelve digits are sent.
        assert float(value) == pytest.approx(expected[key], rel=1e-11), key
        assert text not in {"---", "n/a"}
    assert shown_words["fte_m"][0] == "+31.25 m"
    assert shown_words["rnp_m"][0] == "0.300 NM · 555.6 m"
    assert normal.page.locator(".alert-none").inner_text() == "NORMAL"
    assert normal.page.locator('[data-key="nav_mode"]').inner_text() == "GNSS/INS"
    # The token is not kept where another page could read it.
    assert "#" not in normal.page.url
    # Margin of the bar against the limit that the record states.
    assert float(normal.page.locator('[data-key="hpl_m.margin"]').get_attribute("data-value") or "nan") == pytest.approx(40.0 - 19.5)


def test_the_ellipse_and_the_scales_have_the_size_of_their_numbers(normal: Shown) -> None:
    normal.feeder.values = {"cov_ee_m2": 90_000.0, "cov_nn_m2": 90_000.0, "fte_m": 100.0}
    normal.page.wait_for_function("() => document.querySelector('.map-surface').dataset.scale === '1'")
    script = "() => { const s = document.querySelector('.map-surface'); return [s.clientHeight, Number(s.dataset.pxPerM)]; }"
    height_px, px_per_m = normal.page.evaluate(script)
    # Seven RNP values stand in the height of the map.
    assert px_per_m == pytest.approx(height_px / (7 * 555.6), rel=1e-3)
    gauge = normal.page.locator(".gauge-box").first
    width = float(gauge.locator(".anp-bar").first.get_attribute("width") or "nan")
    shift = (gauge.locator(".pointer").get_attribute("transform") or "").removeprefix("translate(").split(" ")[0]
    # Half of the scale is 120 units for RNP; its middle is at 140. ANP of 300 m is 588 m: the bar is full.
    assert width == 120.0
    assert float(shift) == pytest.approx(140 + 120 * 100 / 555.6, abs=1e-6)


def signals(browser: Browser, picture: bytes) -> int:
    """Pixels of the red and of the amber of the light theme, with what smooth edges make of them, counted by a page of its own."""
    page = browser.new_page()
    script = """async text => {
        const b = await createImageBitmap(await (await fetch('data:image/png;base64,' + text)).blob());
        const pen = new OffscreenCanvas(b.width, b.height).getContext('2d');
        pen.drawImage(b, 0, 0);
        const d = pen.getImageData(0, 0, b.width, b.height).data;
        const near = (i, c) => Math.max(Math.abs(d[i] - c[0]), Math.abs(d[i + 1] - c[1]), Math.abs(d[i + 2] - c[2])) < 24;
        let n = 0;
        for (let i = 0; i < d.length; i += 4) if (near(i, [0xc1, 0x12, 0x1f]) || near(i, [0x8f, 0x56, 0x00])) n += 1;
        return n;
    }"""
    n = page.evaluate(script, base64.b64encode(picture).decode())
    page.close()
    return int(n)


def test_red_and_amber_are_for_alerts_alone(browser: Browser, normal: Shown) -> None:
    assert signals(browser, normal.page.screenshot(full_page=True)) == 0
    normal.feeder.values = {"fte_m": 2000.0}
    normal.page.wait_for_selector('.alert-row[data-tone="warning"]')
    assert signals(browser, normal.page.screenshot(full_page=True)) > 500


def test_what_a_record_does_not_state_is_dashes_and_not_the_last_number(normal: Shown) -> None:
    assert normal.digits()["hpl_m"][0] == "18.00 m"
    normal.feeder.values = {"hpl_m": None, "vpl_m": None, "fte_v_m": None, "nav_mode": None, "n_sv": None}
    normal.page.wait_for_function("() => document.querySelector('[data-key=hpl_m]').textContent === '---'")
    shown_words = normal.digits()
    assert {key: shown_words[key] for key in ("hpl_m", "vpl_m", "fte_v_m")} == dict.fromkeys(("hpl_m", "vpl_m", "fte_v_m"), ("---", ""))
    assert normal.page.locator('[data-key="nav_mode"]').inner_text() == "not stated"
    assert normal.page.locator('[data-key="n_sv"]').inner_text() == "---"
    # What is stated still stands.
    assert shown_words["rnp_m"][0] == "0.300 NM · 555.6 m"


def gone(display: Shown) -> None:
    """No number of the present stands on the page, no bar, no pointer."""
    assert all(value == ("---", "") for value in display.digits().values()), display.digits()
    assert display.page.locator(".gauge .pointer:not([visibility=hidden])").count() == 0
    widths = display.page.locator(".anp-bar, .bound-bar").evaluate_all("all => all.map(e => Number(e.getAttribute('width')))")
    assert len(widths) > 6
    assert set(widths) == {0}
    assert display.page.locator('.alert-none[data-state="normal"]').count() == 0


def test_data_that_stop_are_stale_within_the_stale_time_and_numbers_go(normal: Shown) -> None:
    normal.feeder.positions = False
    took = normal.wait_for_word("STALE")
    assert SETTINGS.stale_s - 0.5 < took < SETTINGS.stale_s + BUSY_S
    gone(normal)
    assert "STALE" in normal.page.locator(".band.trouble").inner_text()
    assert "old" not in normal.page.locator(".map-words").inner_text()
    assert normal.page.locator(".map-words").inner_text().startswith("Last position")
    normal.page.wait_for_function("() => document.title.startsWith('STALE')", timeout=2000)
    # The monitor notices the silence too, by the heartbeats of the reader.
    normal.page.wait_for_selector(".alert-row:has-text('UNAVAIL')")
    normal.feeder.positions = True
    normal.wait_for_word("LIVE DATA")
    normal.page.wait_for_function("() => document.querySelector('[data-key=hpl_m]').textContent === '18.00 m'")


def test_a_reader_that_is_silent_is_a_lost_feed(normal: Shown) -> None:
    normal.feeder.positions = normal.feeder.heartbeats = False
    normal.page.wait_for_function("() => ['STALE', 'FEED LOST'].includes(document.querySelector('.fresh-word').textContent)")
    normal.wait_for_word("FEED LOST")
    gone(normal)


def test_a_source_that_has_ended_is_not_the_present(browser: Browser, tmp_path: Path) -> None:
    fed = Fed(tmp_path / "session")
    with shown(browser, fed.folder, fed=fed) as display:
        display.wait_for_word("LIVE DATA")
        display.feeder.positions = display.feeder.heartbeats = False
        time.sleep(0.3)
        fed.end()
        display.wait_for_word("DATA ENDED")
        gone(display)


def test_a_server_that_stops_is_a_lost_link_by_the_pages_own_clock(normal: Shown) -> None:
    normal.stop()
    took = normal.wait_for_word("LINK LOST")
    # The server speaks each 0.1 s here.
    assert LINK_S - 0.7 < took < LINK_S + BUSY_S
    gone(normal)
    overlay = normal.page.locator(".lost")
    # A busy machine may have news of before still on the way: they are shown, and lost again by the same clock.
    overlay.wait_for(state="visible", timeout=10_000)
    assert overlay.inner_text() == "LINK LOST"
    assert "not monitored on this screen" in normal.page.locator(".band.trouble").inner_text()
    assert "LINK LOST" in normal.page.title()
    normal.go_on()
    normal.wait_for_word("LIVE DATA")
    assert not overlay.is_visible()
    normal.page.wait_for_function("() => document.querySelector('[data-key=hpl_m]').textContent === '18.00 m'")


def test_a_server_that_dies_is_a_lost_link_for_good(browser: Browser, tmp_path: Path) -> None:
    with shown(browser, tmp_path / "session") as display:
        display.wait_for_word("LIVE DATA")
        display.child._process.kill()
        display.wait_for_word("LINK LOST")
        time.sleep(2.5)
        assert display.word() == "LINK LOST"
        gone(display)
        # What the page did not receive it does not claim to have drawn.
        assert display.fed.session.n_epochs > 20


def test_after_cuts_of_any_length_the_page_has_every_alert_of_the_session(normal: Shown) -> None:
    seeded, cuts = random.Random(4), 0
    for _ in range(12):
        normal.feeder.values = {"fte_m": 2000.0 if seeded.random() < 0.5 else 20.0}
        length_s = seeded.uniform(0.1, 3.0)
        normal.stop()
        time.sleep(length_s)
        if length_s > LINK_S + 0.4:
            cuts += 1
            assert normal.word() == "LINK LOST", length_s
            gone(normal)
        normal.go_on()
        time.sleep(seeded.uniform(0.0, 0.6))
    assert cuts > 0, "no cut was long enough to be noticed"
    normal.feeder.values = {}
    time.sleep(7.0)
    normal.wait_for_word("LIVE DATA")
    keys = normal.page.locator("[data-event]").evaluate_all("all => all.map(e => e.dataset.event)")
    assert len(normal.fed.reported) > 2
    assert keys[::-1] == [each["key"] for each in normal.fed.reported]


def test_an_exceedance_is_counted_down_then_raised_and_painted_in_time(normal: Shown) -> None:
    normal.feeder.values = {"fte_m": 600.0}
    normal.page.wait_for_selector(".wait:not([hidden])")
    script = """() => new Promise(done => {
        const seen = [];
        const read = () => {
            const e = document.querySelector('.wait');
            if (e.hidden) { done(seen); return; }
            const v = Number(e.dataset.left);
            if (seen.at(-1) !== v) seen.push(v);
            setTimeout(read, 20);
        };
        read();
    })"""
    left = normal.page.evaluate(script)
    assert len(left) > 10
    assert left == sorted(left, reverse=True)
    assert all(0.0 <= v <= SETTINGS.raise_delay_s for v in left)
    assert "caution" in normal.page.locator(".alert-kind").first.inner_text().lower()
    normal.feeder.values = {"fte_m": 2000.0}
    until = time.monotonic() + 10.0
    while not any(each["kind"] == "warning" for each in normal.fed.reported) and time.monotonic() < until:
        time.sleep(0.005)
    emitted = time.monotonic()
    normal.page.wait_for_selector('.alert-row[data-tone="warning"]')
    # A16 allows half a second from the alert to the screen.
    assert time.monotonic() - emitted < 0.5 + BUSY_S
    kinds = normal.page.locator(".alert-kind").all_inner_texts()
    assert kinds == ["WARNING", "CAUTION"]


def test_the_keyboard_does_everything(normal: Shown) -> None:
    page = normal.page
    normal.feeder.values = {"fte_m": 2000.0}
    page.wait_for_selector('.alert-row[data-tone="warning"]')
    page.keyboard.press("j")
    assert "Acknowledge" in (page.evaluate("document.activeElement.textContent") or "")
    page.keyboard.press("a")
    page.wait_for_selector(".alert-row button[disabled]")
    assert page.locator(".alert-row").count() >= 1, "acknowledging ends no alert"
    page.keyboard.press("A")
    page.wait_for_function("() => !document.querySelector('.alert-row button:not([disabled])')")
    page.keyboard.press("/")
    page.keyboard.type("caution")
    page.wait_for_function("() => [...document.querySelectorAll('[data-event]')].every(e => e.dataset.event.includes('/caution/'))")
    page.keyboard.press("Escape")
    page.keyboard.press("m")
    assert page.evaluate("document.activeElement.className") == "map-surface"
    before = float(page.locator(".map-surface").get_attribute("data-px-per-m") or "nan")
    page.keyboard.press("+")
    assert float(page.locator(".map-surface").get_attribute("data-px-per-m") or "nan") == pytest.approx(2 * before, rel=1e-6)
    page.keyboard.press("?")
    assert page.locator("dialog").is_visible()
    page.keyboard.press("Escape")
    assert not page.locator("dialog").is_visible()
    page.keyboard.press(" ")
    assert page.locator(".band.paused").is_visible()
    # A view that stands still is no present either once the data are old.
    normal.feeder.positions = False
    normal.wait_for_word("STALE")
    gone(normal)


def test_text_from_the_air_is_text(browser: Browser, tmp_path: Path) -> None:
    with shown(browser, tmp_path / "session") as display:
        display.feeder.values = {"track": "<imgsrc=x>", "nav_mode": "<b>bold</b>"}
        display.page.wait_for_selector(".who select:not([hidden])")
        options = display.page.locator(".who option").all_inner_texts()
        assert options == ["F1", "?imgsrc?x?"]
        display.page.select_option(".who select", "<imgsrc=x>")
        display.page.wait_for_function("() => document.querySelector('.who select').value === '<imgsrc=x>'")
        assert display.page.locator("img, b").count() == 0
        assert display.problems == []


def test_a_replay_says_so_all_the_time(browser: Browser, tmp_path: Path) -> None:
    fed = Fed(tmp_path / "session", origin=live.Origin("replay", "a run", 60.0))
    with shown(browser, fed.folder, fed=fed) as display:
        display.wait_for_word("NOT LIVE")
        assert display.page.locator(".band.replay").inner_text() == "REPLAY × 60: not the present"
        assert display.page.locator(".band.replay").is_visible()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_narrow_page_is_read_without_scrolling_sideways_and_text_has_contrast(browser: Browser, tmp_path: Path, scheme: str) -> None:
    with shown(browser, tmp_path / "session", width=420, scheme=scheme) as display:
        display.feeder.values = {"fte_m": 2000.0}
        display.page.wait_for_selector('.alert-row[data-tone="warning"]')
        assert display.page.evaluate("document.documentElement.scrollWidth") <= 420
        # What is new blinks for ten seconds or until it is acknowledged.
        display.page.keyboard.press("A")
        display.page.wait_for_selector(".alert-row:not(.new)")
        contrast = display.page.evaluate(f"() => {PROBES}.texts()")
        assert contrast["n"] > 50
        assert contrast["bad"] == []


def test_a_browser_without_the_token_shows_what_to_do(browser: Browser, tmp_path: Path) -> None:
    with shown(browser, tmp_path / "session") as display:
        context = browser.new_context()
        page = context.new_page()
        page.goto(display.child.text.split("#")[0])
        page.wait_for_selector(".stranger")
        assert "whole address" in page.locator(".stranger").inner_text()
        assert page.locator(".fresh-word").inner_text() == "CONNECTING"
        context.close()
