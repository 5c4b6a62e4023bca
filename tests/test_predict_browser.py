"""The page of a prediction as a person meets it: opened from disk without a network, on a telephone, in the dark, on one sheet of paper."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

import pytest

from navbound.run.expected.flight import PAGE, Expected, predict_flight, write
from navbound.run.expected.page import leg_rows

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from playwright.sync_api import Browser, Page

CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the page was NOT opened in a browser")
PLAN = """title = "Peking - Schanghai <b>&amp;</b>"
flight = "beijing-shanghai"
stations = []
[[requirements]]
name = "en route"
rnp_nm = 0.02
[[jamming]]
from_min = 40
until_min = 60
"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> Expected:
    file = tmp_path_factory.mktemp("plan") / "plan.toml"
    file.write_text(PLAN, encoding="utf-8")
    return predict_flight(file)


@pytest.fixture(scope="module")
def written(expected: Expected, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(expected, tmp_path_factory.mktemp("out") / "plan") / PAGE


def opened(browser: Browser, file: Path, width: int = 1440, scheme: str = "light") -> Page:
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, offline=True)  # type: ignore[arg-type]
    page = context.new_page()
    problems: list[str] = []
    requested: list[str] = []
    page.on("console", lambda message: problems.append(message.text) if message.type in {"error", "warning"} else None)
    page.on("request", lambda request: requested.append(request.url))
    page.goto(file.as_uri())
    assert problems == []
    assert requested == [file.as_uri()]
    return page


def test_every_cell_and_sentence_is_that_of_the_record(browser: Browser, written: Path, expected: Expected) -> None:
    page = opened(browser, written)
    cells = page.eval_on_selector("table", "t => [...t.rows].map(r => [...r.cells].map(c => c.textContent))")
    assert [tuple(row) for row in cells] == leg_rows(expected.record)
    text = page.inner_text("body")
    for sentence in (*expected.record.words, *expected.record.warnings):
        assert sentence in text
    # A title is text, not markup.
    assert page.inner_text("h1") == "Peking - Schanghai <b>&amp;</b>"
    page.context.close()


def test_what_is_not_kept_is_marked(browser: Browser, written: Path, expected: Expected) -> None:
    page = opened(browser, written)
    n = sum(leg.status != "kept" for leg in expected.record.legs)
    assert n == len(expected.record.legs)
    assert page.locator("td.warn").count() == n
    # A mark beside each leg on the route, and the jammed time on the time line.
    assert page.locator("text.bad").count() > 0
    out = page.locator("rect.out")
    assert out.count() == 1
    box, line = out.bounding_box(), page.locator("svg").first.bounding_box()
    assert box is not None
    assert line is not None
    assert box["width"] / line["width"] == pytest.approx(20 / 118 * (1040 - 64 - 14) / 1040, rel=0.02)
    page.context.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_contrast(browser: Browser, written: Path, scheme: str) -> None:
    """Ratios of WCAG 2.1, 4.5 to 1 for text."""
    page = opened(browser, written, scheme=scheme)
    luminance = """c => { const v = c.match(/[0-9.]+/g).slice(0, 3).map(x => x / 255)
            .map(x => x <= .04045 ? x / 12.92 : ((x + .055) / 1.055) ** 2.4);
        return .2126 * v[0] + .7152 * v[1] + .0722 * v[2]; }"""
    ratios = page.evaluate(
        f"""() => {{ const l = {luminance}, paper = l(getComputedStyle(document.body).backgroundColor);
        return [...document.querySelectorAll('h1, h2, p, td, th, svg text')].filter(e => e.textContent.trim())
            .map(e => l(getComputedStyle(e)[e.closest('svg') ? 'fill' : 'color']))
            .map(x => (Math.max(x, paper) + .05) / (Math.min(x, paper) + .05)); }}"""
    )
    assert len(ratios) > 60
    assert min(ratios) >= 4.5
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert ground == ("rgb(255, 255, 255)" if scheme == "light" else "rgb(15, 19, 22)")
    page.context.close()


@pytest.mark.parametrize("width", [320, 420, 1024])
def test_no_width_scrolls_sideways(browser: Browser, written: Path, width: int) -> None:
    page = opened(browser, written, width=width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.context.close()


def test_a_dark_screen_prints_on_one_white_sheet(browser: Browser, written: Path) -> None:
    page = opened(browser, written, scheme="dark")
    pdf = page.pdf(prefer_css_page_size=True)
    assert pdf.count(b"/Type /Page\n") + pdf.count(b"/Type /Page ") + pdf.count(b"/Type /Page/") == 1
    page.emulate_media(media="print", color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    page.context.close()
