"""The report as a person meets it: opened from disk without a network, read, moved and printed in a real browser."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl
import pytest

import report_fixture
from navbound.report import render

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the report was NOT opened in a browser")
PROBES = (Path(__file__).parent / "report_probes.js").read_text(encoding="utf-8").split("\n", 1)[1].strip()
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]

# Which column's value stands where on the page.
SHOWN = [
    *((key, ".cursor-bar") for key in ("fte_m", "tse_m", "nse_h_m", "along_m")),
    *((key, "#lateral") for key in ("tse_exact_m", "tse_ltem_m", "tse_exact_integrity_m")),
    *((key, "#vertical") for key in ("fte_v_m", "tse_vertical_m")),
    *((key, "#anp") for key in ("anp_circle_m", "anp_sphere_m")),
    *((key, ".scales") for key in ("rnp_m", "anp_cross_m")),
]

# Lengths on the page are kept to 1 mm: half of it is rounding, the rest the sum in doubles.
LENGTH_M = 0.5001e-3


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def one() -> report_fixture.Fixture:
    return report_fixture.flight()


def _write(fixture: report_fixture.Fixture, out: Path) -> Path:
    return render(fixture.summary, fixture.record, fixture.epochs, fixture.events, fixture.waypoints, out)


@pytest.fixture(scope="module")
def report(one: report_fixture.Fixture, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _write(one, tmp_path_factory.mktemp("report") / "report.html")


def _open(browser: Browser, report: Path, width: int = 1440, scheme: str = "light", touch: bool = False) -> Page:
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, offline=True, has_touch=touch)  # type: ignore[arg-type]
    page = context.new_page()
    problems: list[str] = []
    requested: list[str] = []
    page.on("console", lambda message: problems.append(message.text) if message.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("request", lambda request: requested.append(request.url))
    page.goto(report.as_uri())
    page.wait_for_selector("#report[data-ready]")
    assert problems == []
    assert requested == [report.as_uri()]
    return page


@pytest.fixture
def page(browser: Browser, report: Path) -> Iterator[Page]:
    page = _open(browser, report)
    yield page
    page.context.close()


def _probe(page: Page, call: str) -> Any:
    return page.evaluate(f"() => {PROBES}.{call}")


def _value(page: Page, key: str, within: str = ".cursor-bar") -> float:
    return float(page.locator(f'{within} [data-key="{key}"]').first.get_attribute("data-value") or "nan")


def _go(page: Page, epoch: int) -> None:
    page.locator("#epoch").evaluate("(slider, i) => { slider.value = i; slider.dispatchEvent(new Event('input')); }", epoch)


def _check_epoch(page: Page, fixture: report_fixture.Fixture, epoch: int) -> None:
    row = fixture.epochs.row(epoch, named=True)
    for key, within in SHOWN:
        expected = row[key]
        np.testing.assert_allclose(_value(page, key, within), np.nan if expected is None else expected, rtol=0, atol=LENGTH_M, err_msg=key)
    expected_risk = np.nan if row["p_exceed_2rnp"] is None else row["p_exceed_2rnp"]
    np.testing.assert_allclose(_value(page, "p_exceed_2rnp", "#risk"), expected_risk, rtol=1.2e-4)
    np.testing.assert_allclose(_value(page, "p_state_2", "#states"), row["p_state_2"], rtol=1.2e-4)
    assert page.locator('.cursor-bar [data-key="alert"]').get_attribute("data-value") == row["alert"]


def test_the_verdict_stands_first_and_holds_the_numbers_of_the_summary(page: Page, one: report_fixture.Fixture) -> None:
    verdict = one.summary.verdict
    assert page.locator("#verdict .words").inner_text() == verdict.words
    assert page.locator("#verdict .state").inner_text().startswith("Inside")
    assert verdict.worst_accuracy is not None
    assert _value(page, "share_inside", "#verdict") == verdict.share_inside
    assert _value(page, "worst_accuracy.margin_m", "#verdict") == verdict.worst_accuracy.margin_m
    boxes = [page.locator(s).first.bounding_box() for s in ("#verdict", "#map", "#lateral", "#honesty", "#tables", "#run")]
    tops = [box["y"] for box in boxes if box is not None]
    assert len(tops) == 6
    assert tops == sorted(tops)
    # GPS time minus 18 leap seconds, computed here by NumPy's calendar.
    utc = np.datetime64("1980-01-06T00:00:00", "ns") + np.timedelta64(verdict.worst_accuracy.time_ns - 18_000_000_000, "ns")
    assert str(utc)[11:19] in page.locator("#verdict .facts").inner_text()


@pytest.mark.parametrize("epoch", [0, 699, report_fixture.SPIKE, report_fixture.GAP[0] + 5, 6360, 7080])
def test_every_chart_shows_the_epoch_under_the_cursor(page: Page, one: report_fixture.Fixture, epoch: int) -> None:
    _go(page, epoch)
    _check_epoch(page, one, epoch)


def test_a_gap_is_a_gap_and_says_why(page: Page) -> None:
    _go(page, report_fixture.GAP[0] + 5)
    assert "three satellites, four needed" in page.locator('.cursor-bar [data-key="alert"]').inner_text()
    assert page.locator('#anp [data-key="anp_circle_m"]').inner_text() == "n/a"


def test_the_keyboard_moves_the_cursor_and_says_the_values(page: Page, one: report_fixture.Fixture) -> None:
    _go(page, 1000)
    page.locator("#epoch").focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    _check_epoch(page, one, 1003)
    page.keyboard.press("ArrowLeft")
    _check_epoch(page, one, 1002)
    page.keyboard.press("End")
    _check_epoch(page, one, 7080)
    page.wait_for_function("() => document.querySelector('#cursor-words').textContent.includes('epoch 7081 of 7081')")
    spoken = page.locator("#cursor-words")
    assert spoken.get_attribute("aria-live") == "polite"
    assert "FTE" in spoken.inner_text()


def test_the_mouse_moves_the_cursor_of_all_charts(page: Page, one: report_fixture.Fixture) -> None:
    over = page.locator("#lateral .u-over")
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] * 0.25, box["y"] + box["height"] / 2)
    epoch = int(page.locator("#epoch").input_value())
    # A quarter of the way, to a pixel.
    assert abs(epoch - 0.25 * 7080) <= 7080 / box["width"] + 1
    _check_epoch(page, one, epoch)
    lines = page.locator(".u-cursor-x").evaluate_all("all => all.map(e => e.getBoundingClientRect().right)")
    assert len(lines) == 5
    assert max(lines) - min(lines) < 1.5


def test_dragging_zooms_every_chart_and_all_resets(page: Page) -> None:
    over = page.locator("#anp .u-over")
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    assert page.locator(".reset").is_disabled()
    page.mouse.move(box["x"] + box["width"] * 0.4, middle)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.5, middle, steps=4)
    page.mouse.up()
    assert page.locator(".reset").is_enabled()
    page.mouse.move(box["x"] + box["width"] - 1, middle)
    right = int(page.locator("#epoch").input_value())
    assert abs(right - 0.5 * 7080) < 30
    page.locator(".reset").click()
    page.mouse.move(box["x"] + box["width"] - 1, middle)
    assert int(page.locator("#epoch").input_value()) > 7000


def test_a_spike_of_one_epoch_is_drawn_though_six_epochs_share_a_pixel(page: Page, one: report_fixture.Fixture) -> None:
    page.locator('#lateral [data-choice="data"]').click()
    for chip in page.locator("#lateral .chip").all():
        if not (chip.inner_text().startswith("FTE")) and chip.get_attribute("aria-pressed") == "true":
            chip.click()
    over = page.locator("#lateral .u-over").bounding_box()
    canvas = page.locator("#lateral canvas").bounding_box()
    assert over is not None
    assert canvas is not None
    column = round(over["x"] - canvas["x"] + over["width"] * report_fixture.SPIKE / 7080)
    heights = _probe(page, "ink('#lateral')")
    around = [max(heights[c - 2 : c + 3]) for c in (column, column - 20, column + 20)]
    fte = one.epochs["fte_m"].to_numpy()
    share = (fte[report_fixture.SPIKE] - fte[report_fixture.SPIKE - 1]) / (fte.max() - fte.min())
    assert around[0] > 0.8 * share * over["height"]
    assert around[0] > 2 * max(around[1:])


def test_a_lone_epoch_between_two_gaps_is_drawn(page: Page) -> None:
    chart = page.locator("#anp .u-over")
    chart.scroll_into_view_if_needed()
    over = chart.bounding_box()
    assert over is not None
    left, right = (over["x"] + over["width"] * (report_fixture.ALONE + d) / 7080 for d in (-35, 35))
    page.mouse.move(left, over["y"] + 50)
    page.mouse.down()
    page.mouse.move(right, over["y"] + 50, steps=3)
    page.mouse.up()
    _go(page, report_fixture.ALONE)
    cursor, canvas = page.locator("#anp .u-cursor-x").bounding_box(), page.locator("#anp canvas").bounding_box()
    assert cursor is not None
    assert canvas is not None
    column = round(cursor["x"] - canvas["x"])
    # Around it the gap is hatched in grey; only the line has this blue. A line cut to one epoch would leave four pixels.
    assert _probe(page, f"blue('#anp', {column - 3}, {column + 4})") >= 9
    assert _probe(page, f"blue('#anp', {column - 60}, {column - 4})") == 0
    assert _probe(page, f"blue('#anp', {column + 5}, {column + 60})") == 0


def test_the_axis_changes_to_distance(page: Page, one: report_fixture.Fixture) -> None:
    page.locator('.cursor-bar [data-choice="along"]').click()
    over = page.locator("#lateral .u-over")
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] * 0.5, box["y"] + 20)
    epoch = int(page.locator("#epoch").input_value())
    along = one.epochs["along_m"].to_numpy()
    assert abs(along[epoch] / along[-1] - 0.5) < 2 / box["width"]
    _check_epoch(page, one, epoch)


def test_the_map_zooms_by_key_button_and_wheel_and_finds_the_aircraft(page: Page) -> None:
    surface = page.locator(".map-surface")
    surface.scroll_into_view_if_needed()

    def k() -> float:
        return float(surface.get_attribute("data-k") or "nan")

    whole = k()
    page.get_by_role("button", name="Zoom in").click()
    assert k() == pytest.approx(2 * whole)
    surface.focus()
    page.keyboard.press("-")
    assert k() == pytest.approx(whole)
    box = surface.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 50, box["y"] + 50)
    page.mouse.wheel(0, -240)
    page.wait_for_function("(k) => Number(document.querySelector('.map-surface').dataset.k) > 1.9 * k", arg=whole)
    page.get_by_role("button", name="Error at cursor").click()
    assert "to scale" in page.locator(".map-words").inner_text()
    page.get_by_role("button", name="Whole route").click()
    assert k() == pytest.approx(whole)
    assert "times its size" in page.locator(".map-words").inner_text()


def test_pressing_an_event_goes_to_it(page: Page, one: report_fixture.Fixture) -> None:
    page.locator("#events .row").first.click()
    assert one.epochs["time_ns"][int(page.locator("#epoch").input_value())] == one.summary.events[0].onset_ns
    assert page.locator("#events").inner_text().count("</script><b>not markup</b>") == 1


def test_the_keyboard_reaches_everything_that_can_be_pressed(page: Page) -> None:
    reachable = _probe(page, "markReachable()")
    reached = set()
    for _ in range(reachable + 40):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.dataset.reach ?? null"))
    assert reachable > 30
    assert {str(i) for i in range(reachable)} <= reached


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_contrast_in_both_themes(browser: Browser, report: Path, scheme: str) -> None:
    page = _open(browser, report, scheme=scheme)
    result = _probe(page, "texts()")
    assert result["n"] > 200
    assert result["bad"] == []
    # Names at the lines' ends have the lines' colours, so these count as text.
    lines = _probe(page, "lines()")
    assert len(lines) == 12
    assert min(lines.values()) >= 4.5, lines
    page.context.close()


def test_the_theme_button_overrules_the_system(browser: Browser, report: Path) -> None:
    page = _open(browser, report, scheme="dark")
    ground = "getComputedStyle(document.body).backgroundColor"
    assert page.evaluate(ground) == "rgb(15, 19, 22)"
    page.locator('[data-choice="light"]').click()
    assert page.evaluate(ground) == "rgb(255, 255, 255)"
    page.locator('[data-choice="dark"]').click()
    page.emulate_media(color_scheme="light")
    assert page.evaluate(ground) == "rgb(15, 19, 22)"
    page.context.close()


def test_paper_is_white_whatever_the_theme_and_has_no_controls(browser: Browser, report: Path) -> None:
    page = _open(browser, report, scheme="dark")
    page.locator('[data-choice="dark"]').click()
    page.emulate_media(media="print")
    page.wait_for_function("() => document.documentElement.classList.contains('printing')")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert page.evaluate("getComputedStyle(document.body).color") == "rgb(0, 0, 0)"
    assert not page.locator("#epoch").is_visible()
    assert not page.get_by_role("button", name="Zoom in").is_visible()
    # Canvases were drawn again in ink on white: the lateral chart's darkest pixels are the error, drawn in the print ink.
    page.wait_for_function(f"() => {PROBES}.black('#lateral') > 200")
    page.context.close()


@pytest.mark.parametrize("width", [320, 420, 768, 1024, 1440])
def test_no_width_scrolls_sideways(browser: Browser, report: Path, width: int) -> None:
    page = _open(browser, report, width=width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.locator("#lateral canvas").is_visible()
    page.context.close()


def test_touch_moves_the_cursor(browser: Browser, report: Path, one: report_fixture.Fixture) -> None:
    page = _open(browser, report, width=420, touch=True)
    over = page.locator("#lateral .u-over")
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    assert box is not None
    page.touchscreen.tap(box["x"] + box["width"] * 0.75, box["y"] + 40)
    epoch = int(page.locator("#epoch").input_value())
    assert abs(epoch - 0.75 * 7080) <= 2 * 7080 / box["width"]
    _check_epoch(page, one, epoch)
    page.context.close()


def test_tracks_sort_and_are_selected(browser: Browser, tmp_path: Path) -> None:
    fixture = report_fixture.flight(6, n=200)
    page = _open(browser, _write(fixture, tmp_path / "report.html"))
    head = page.locator("#tracks th", has_text="FTE std")
    head.locator("button").click()
    assert head.get_attribute("aria-sort") == "descending"
    shown = [float(cell.get_attribute("data-value") or "nan") for cell in page.locator('#tracks [data-key="fte_std_m"]').all()]
    assert shown == sorted((t.fte_std_m or 0.0 for t in fixture.summary.tracks), reverse=True)
    head.locator("button").click()
    shown = [float(cell.get_attribute("data-value") or "nan") for cell in page.locator('#tracks [data-key="fte_std_m"]').all()]
    assert shown == sorted(t.fte_std_m or 0.0 for t in fixture.summary.tracks)
    page.get_by_role("button", name="Fixture 3", exact=True).click()
    page.wait_for_function("() => document.querySelector('#track').value === 'flight-003'")
    _go(page, 77)
    expected = fixture.epochs.filter(track="flight-003")["fte_m"][77]
    assert _value(page, "fte_m") == pytest.approx(expected, abs=LENGTH_M)
    page.locator("#track").select_option("flight-005")
    page.wait_for_function("() => document.querySelector('tr[aria-current] [data-key=label]').textContent === 'Fixture 5'")
    assert page.locator(".chart#lateral").count() == 1
    page.context.close()


def test_what_is_missing_says_why(browser: Browser, tmp_path: Path) -> None:
    fixture = report_fixture.flight(truth=False, n=100)
    keep = ["track", "time_ns", "est_lat_rad", "est_lon_rad", "cov_ee_m2", "cov_en_m2", "cov_nn_m2", "anp_circle_m", "status", "rnp_m"]
    bare = report_fixture.Fixture(fixture.summary, fixture.record, fixture.epochs.select(keep), fixture.events.head(0), [])
    page = _open(browser, _write(bare, tmp_path / "report.html"))
    text = page.locator("#report").inner_text()
    for why in ("No path was given", "No truth", "The state classifier was not run", "The risk was not computed", "No path: no tunnel"):
        assert why in text
    assert page.locator("#anp canvas").is_visible()
    page.context.close()


def test_an_empty_run_shows_its_verdict(browser: Browser, tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=5)
    empty = report_fixture.Fixture(fixture.summary, fixture.record, fixture.epochs.head(0), fixture.events.head(0), [])
    page = _open(browser, _write(empty, tmp_path / "report.html"))
    assert page.locator("#verdict .state").inner_text().startswith("Nothing judged")
    page.context.close()


def test_a_declared_column_is_drawn_without_code_of_its_own(browser: Browser, one: report_fixture.Fixture, tmp_path: Path) -> None:
    distance_m = np.linspace(1.25, 9.5, one.epochs.height)
    epochs = one.epochs.with_columns(separation_m=pl.Series(distance_m), separation_limit_m=pl.lit(60.0))
    page = _open(browser, render(one.summary, one.record, epochs, one.events, one.waypoints, tmp_path / "report.html"))
    chart = page.locator("figure.chart", has_text="Filters with and without satellites")
    assert "may be where both are right" in chart.locator("figcaption").inner_text()
    _go(page, 700)
    for key, expected in (("separation_m", distance_m[700]), ("separation_limit_m", 60.0)):
        shown = float(chart.locator(f'[data-key="{key}"]').first.get_attribute("data-value") or "nan")
        assert shown == pytest.approx(expected, abs=LENGTH_M)
    page.context.close()
