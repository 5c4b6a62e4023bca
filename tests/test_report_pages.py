"""Pages for engineers in a real browser: satellites, approaches, the filter; on paper the map is drawn and pages are numbered."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl
import pytest

import navbound
import report_fixture
from navbound.report import render
from navbound.run import directory
from navbound.run.evaluate.performance import Options, evaluate_files
from navbound.time import utc_text
from test_report_browser import CHROMIUM, FLAGS, _open, _probe, _write

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the report was NOT opened in a browser")
DATA = Path(__file__).parents[1] / "examples" / "data"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def station(tmp_path_factory: pytest.TempPathFactory) -> directory.Run:
    return navbound.analyze(
        [DATA / "station.rnx", DATA / "broadcast.rnx"],
        truth="4189135.1896,188029.6189,4789919.6247",
        spec="RNP 0.1",
        out=tmp_path_factory.mktemp("station") / "run",
    )


@pytest.fixture(scope="module")
def landings(tmp_path_factory: pytest.TempPathFactory) -> directory.Run:
    return navbound.analyze(
        DATA / "tracks.csv",
        path="LFPG/08R,LFPG/09L",
        spec="RNP 0.3",
        sigma_m=2.5,
        truth=DATA / "tracks-truth.csv",
        out=tmp_path_factory.mktemp("landings") / "run",
    )


FILLED = """() => {
    const c = document.querySelector('.map-surface canvas');
    const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
    let n = 0;
    for (let i = 3; i < d.length; i += 4) if (d[i]) n++;
    return n / (c.width * c.height);
}"""
"""Share of the map that is painted."""
COUNT_CLEARED = """() => {
    window.cleared = 0;
    const was = CanvasRenderingContext2D.prototype.clearRect;
    CanvasRenderingContext2D.prototype.clearRect = function (...a) {
        if (this.canvas.closest('.map-surface')) window.cleared++;
        return was.apply(this, a);
    };
    dispatchEvent(new Event('beforeprint'));
}"""
"""Lay paper out, and count how often the map is cleared meanwhile."""


def go(page: Page, epoch: int) -> None:
    page.locator("#epoch").evaluate("(slider, i) => { slider.value = i; slider.dispatchEvent(new Event('input')); }", epoch)


def test_the_sky_shows_who_was_used_and_who_was_excluded(browser: Browser, station: directory.Run) -> None:
    page = _open(browser, station.report)
    assert station.satellites is not None
    excluded = station.satellites.filter(fate="excluded")["time_ns"][0]
    row = station.epochs.with_row_index("row").filter(time_ns=excluded).row(0, named=True)
    go(page, row["row"])
    assert page.locator('#sky [data-key="n_used"]').get_attribute("data-value") == str(row["n_sv"])
    assert "G10: excluded by the residual test" in page.locator("#sky .sky-list").inner_text()
    assert "Excluded: G10" in page.locator("#satellites-used").inner_text()
    shown = {r.locator("td").first.inner_text(): r for r in page.locator("#satellites tbody tr").all()}
    assert set(shown) == {s.sv for s in station.summary.satellites}
    g10 = next(s for s in station.summary.satellites if s.sv == "G10")
    assert shown["G10"].locator('[data-key="n_used"]').get_attribute("data-value") == str(g10.n_used)
    for chart in ("#residuals", "#strength", "#scatter"):
        assert page.locator(f"{chart} canvas").is_visible()
    page.context.close()


@pytest.mark.parametrize("messages", [[], ["service.ems"]], ids=["own", "service"])
def test_an_evaluation_shows_the_sky_of_its_solutions(browser: Browser, tmp_path: Path, messages: list[str]) -> None:
    files = [DATA / name for name in ("station.rnx", "broadcast.rnx", *messages)]
    run = evaluate_files(files, Options(["APV-I"], truth="4189135.1896,188029.6189,4789919.6247"), out=tmp_path / "run")
    assert run.satellites is not None
    again = directory.load(tmp_path / "run").satellites
    assert again is not None
    assert run.satellites.equals(again)
    page = _open(browser, run.report)
    page.locator("#bucket").evaluate("(slider) => { slider.value = 7; slider.dispatchEvent(new Event('input')); }")
    # The series and the sky stand at one time.
    now = page.locator('[data-key="bucket_utc_s"]').inner_text()
    shown = page.locator("#sky .two > div > p.note").first.inner_text()
    assert shown.startswith(now.split(" ", 1)[1])
    start_ns = run.satellites["time_ns"].unique().sort()
    at = next(t for t in start_ns if utc_text(t)[11:19] == shown[:8])
    here = run.satellites.filter(time_ns=at)
    assert page.locator('#sky [data-key="n_used"]').get_attribute("data-value") == str(here.filter(fate="used").height)
    assert ("heard" in shown) != bool(messages)
    assert messages or f"of {here.height} satellites heard" in shown
    assert {r.locator("td").first.inner_text() for r in page.locator("#satellites tbody tr").all()} == {
        s.sv for s in run.summary.satellites
    }
    for chart in ("#satellites-used", "#residuals"):
        assert page.locator(f"{chart} canvas").is_visible()
    page.context.close()


@pytest.mark.parametrize("width", [420, 1440])
def test_approaches_are_laid_over_one_another_and_one_is_selected_by_a_click(browser: Browser, landings: directory.Run, width: int) -> None:
    page = _open(browser, landings.report, width=width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.wait_for_selector(".overlays[data-tracks='24']")
    page.locator('#approaches [data-choice="LFPG/09L"]').click()
    canvas = page.locator('.overlay[data-column="fte_m"] canvas')
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    assert box is not None
    # The approach that deviates most lies alone at the top: its highest point is pressed.
    band = next(b for b in landings.summary.bands if b.runway == "LFPG/09L" and b.column == "fte_m")
    group = next(g for g in landings.summary.groups if g.name == "LFPG/09L")
    row = landings.epochs.filter(track=group.most_track, fte_m=group.most_m).row(0, named=True)
    low, high = min(v for v in band.least_m if v is not None), max(v for v in band.most_m if v is not None)
    room = 0.06 * (high - low)
    far = max(band.before_m) + 0.25 * 1852.0
    x = 58 + (1 + row["along_m"] / far) * (box["width"] - 58 - 16)
    y = 18 + (high + room - group.most_m) / (high - low + 2 * room) * (box["height"] - 18 - 26)
    canvas.click(position={"x": x, "y": y})
    page.wait_for_function("(t) => document.querySelector('#track').value === t", arg=group.most_track)
    page.context.close()


def test_a_covariance_of_the_plane_alone_is_compared_with_truth(browser: Browser, landings: directory.Run) -> None:
    assert landings.summary.honesty is not None
    assert landings.summary.honesty.dimension == 2
    page = _open(browser, landings.report)
    assert "No truth" not in page.locator("#honesty").inner_text()
    assert page.locator("#verdict .words").inner_text().split("\n\n") == landings.summary.verdict.lead
    # Every epoch is far within RNP: the risk is below what is distinguished, in one sentence.
    assert page.locator("#risk").inner_text().startswith("Risk of leaving 2 RNP, throughout: beyond 2 RNP < 10⁻¹²")
    page.context.close()


def test_the_filter_shows_innovations_against_their_gate(browser: Browser, tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=300)
    epochs = fixture.epochs.with_columns(
        n_gated=pl.lit(0),
        nav_mode=pl.lit("gnss"),
        innovation_range=pl.int_range(pl.len()) / 200.0,
        bias_gyro_x_radps=pl.int_range(pl.len()) * 1e-9,
    )
    page = _open(browser, render(fixture.summary, fixture.record, epochs, fixture.events, fixture.waypoints, tmp_path / "report.html"))
    go(page, 250)
    assert float(page.locator('#filter [data-key="innovation_range"]').get_attribute("data-value") or "nan") == pytest.approx(1.25)
    # 250e-9 rad/s in degrees an hour.
    shown = float(page.locator('#filter [data-key="gyro_x"]').get_attribute("data-value") or "nan")
    assert shown == pytest.approx(250e-9 * 206264.806, rel=1e-5)
    page.context.close()


def test_no_line_crosses_a_time_without_epochs(browser: Browser, tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=300)
    holed = report_fixture.Fixture(
        fixture.summary, fixture.record, fixture.epochs.filter(~pl.int_range(pl.len()).is_between(100, 199)), fixture.events.head(0), []
    )
    page = _open(browser, _write(holed, tmp_path / "report.html"))
    page.get_by_role("button", name="Show all epochs").click()
    over, canvas = page.locator("#anp .u-over").bounding_box(), page.locator("#anp canvas").bounding_box()
    assert over is not None
    assert canvas is not None
    middle = round(over["x"] - canvas["x"] + over["width"] * 150 / 299)
    assert _probe(page, f"blue('#anp', {middle - 20}, {middle + 20})") == 0
    assert _probe(page, f"blue('#anp', {middle - 250}, {middle - 200})") > 0
    page.context.close()


def test_paper_has_the_map_and_numbered_pages(browser: Browser, landings: directory.Run, tmp_path: Path) -> None:
    page = _open(browser, landings.report, scheme="dark")
    text = landings.report.read_text(encoding="utf-8")
    assert re.search(r'content: ?"page " ?counter\(page\) ?" of " ?counter\(pages\)', text)
    assert f"24 recorded approaches to LFPG/08R, LFPG/09L \\b7  navbound {navbound.__version__}" in text
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    # Land, path, tunnel and track: more than the aircraft alone.
    assert page.evaluate(FILLED) > 0.9
    # A canvas that is cleared while paper is laid out is cleared through the sheet.
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    page.evaluate(COUNT_CLEARED)
    assert page.evaluate("window.cleared") == 0
    page.context.close()
