"""A report that opens on what happened says which part of the time its charts show, and shows all by a key."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl
import pytest

import report_fixture
from navbound.report import render
from test_report_browser import CHROMIUM, FLAGS, _open

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the report was NOT opened in a browser")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


def _utc(fixture: report_fixture.Fixture, epoch: int, offset_s: float) -> str:
    return datetime.fromtimestamp(int(fixture.epochs["time_ns"][epoch]) / 1e9 + offset_s, UTC).strftime("%H:%M:%S")


def test_a_report_that_opens_zoomed_says_so_and_shows_all_by_a_key(browser: Browser, tmp_path: Path) -> None:
    fixture = report_fixture.flight()
    onset, clear = (int(fixture.epochs["time_ns"][k]) for k in (4000, 4300))
    events = fixture.events.with_columns(onset_ns=pl.lit(onset), clear_ns=pl.lit(clear))
    page = _open(browser, render(fixture.summary, fixture.record, fixture.epochs, events, fixture.waypoints, tmp_path / "report.html"))
    line = page.locator(".charts > .shown-span")
    # What happened took 300 epochs of a second; a fifth of that is shown on both sides.
    offset_s = page.evaluate("(p => p.gps_epoch_unix_s - p.utc_offset_s)(JSON.parse(document.getElementById('navbound-data').textContent))")
    utc = [_utc(fixture, k, offset_s) for k in (3940, 4360, 0, len(fixture.epochs) - 1)]
    assert line.inner_text().split("\n")[0] == f"The charts show what happened, {utc[0]} to {utc[1]}, of {utc[2]} to {utc[3]} UTC."
    line.get_by_role("button", name="Show all").focus()
    page.keyboard.press("Enter")
    assert line.is_hidden()
    assert page.locator(".reset", has_text="All").is_disabled()
    assert page.evaluate("document.activeElement.closest('.charts') !== null")
    page.keyboard.press("e")
    assert line.is_visible()
    page.locator('.cursor-bar [data-choice="along"]').click()
    along = fixture.epochs["along_m"].to_numpy() / 1852.0
    text = line.inner_text().replace("\u2212", "-")
    assert f"what happened, {along[3940]:.2f} to {along[4360]:.2f}, of {along[0]:.2f} to {along[-1]:.2f} NM." in text
    page.context.close()


def test_no_line_stands_over_charts_that_show_all(browser: Browser, tmp_path: Path) -> None:
    fixture = report_fixture.flight()
    page = _open(
        browser, render(fixture.summary, fixture.record, fixture.epochs, fixture.events, fixture.waypoints, tmp_path / "report.html")
    )
    assert page.locator("#lateral .plot").is_visible()
    assert page.locator(".charts > .shown-span").is_hidden()
    page.context.close()
