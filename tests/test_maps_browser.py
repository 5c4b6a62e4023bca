"""The page of a map in a real browser: its numbers are those of the records, its cells answer, its picture leaves it."""

from __future__ import annotations

import math
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import pytest

from navbound import maps
from navbound.maps.sources import Times

if TYPE_CHECKING:
    from playwright.sync_api import Page

CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the map was NOT opened in a browser")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> maps.Map:
    grid = maps.Grid.degrees(10.0, (20.0, 70.0, -30.0, 50.0))
    return maps.make("dop", grid=grid, limits={"pdop": 2.5}, times=Times(step_s=1800.0), out=tmp_path_factory.mktemp("map") / "dop")


@pytest.fixture(scope="module")
def page(made: maps.Map) -> Iterator[Page]:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    assert made.path is not None
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        failures: list[str] = []
        page.on("pageerror", lambda error: failures.append(str(error)))
        page.on("console", lambda message: failures.append(message.text) if message.type == "error" else None)
        page.goto((made.path / "report.html").as_uri())
        page.wait_for_selector("[data-ready=true]", timeout=60_000)
        yield page
        assert not failures
        browser.close()


def value(page: Page, key: str) -> float:
    return float(page.locator(f'[data-key="{key}"]').first.get_attribute("data-value") or "nan")


def test_the_numbers_of_the_page_are_those_of_the_records(page: Page, made: maps.Map) -> None:
    for coverage in made.summary.coverage:
        assert value(page, f"coverage_{coverage.available:g}") == coverage.share
    for column in made.summary.columns:
        for percentile, typical in column.typical.items():
            assert value(page, f"{column.name}_{percentile}") == typical
    assert made.summary.words in page.inner_text("#verdict-place")


def test_every_cell_answers_to_pointer_and_keys(page: Page, made: maps.Map) -> None:
    page.select_option("#layer", "pdop_p95")
    surface = page.locator(".world-surface")
    surface.scroll_into_view_if_needed()
    box = page.locator(".world-surface svg").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 3)
    words = page.inner_text(".world-readout")
    lat, lon = (float(part.split("°")[0]) for part in words.split(":")[0].split(", "))
    points = made.points
    near = (points["lat_rad"] - math.radians(lat)).abs() + (points["lon_rad"] - math.radians(lon)).abs()
    row = int(near.arg_min() or 0)
    # The page keeps a thousandth of a dilution.
    assert value(page, "cell") == pytest.approx(points["pdop_p95"][row], abs=0.51e-3)
    surface.focus()
    page.keyboard.press("ArrowRight")
    assert value(page, "cell") == pytest.approx(points["pdop_p95"][row + 1], abs=0.51e-3)
    page.keyboard.press("ArrowUp")
    assert value(page, "cell") == pytest.approx(points["pdop_p95"][row + 1 + made.summary.grid.n_lon], abs=0.51e-3)


def test_classes_share_out_the_whole_area(page: Page) -> None:
    page.select_option("#layer", "share_available")
    shares = [float(t.split()[0]) for t in page.locator(".world-key .also").all_inner_texts()]
    assert len(shares) > 1
    # Each share is rounded to two decimals or better.
    assert sum(shares) == pytest.approx(100.0, abs=0.005 * len(shares))
    label = page.locator(".world-surface svg").get_attribute("aria-label") or ""
    assert label.startswith("Availability. ")


def test_lines_of_availability_part_what_the_values_part_and_can_be_left_out(page: Page, made: maps.Map, tmp_path: Path) -> None:
    page.select_option("#layer", "share_available")
    share = 100.0 * made.points["p_available"]
    levels = [95.0, 99.0, 99.9]
    # Each parts some cells from others, and some from those beyond the next one.
    expected = [
        f"{a:g} %" for a, b in zip(levels, [*levels[1:], 101.0], strict=True) if (share < a).any() and ((share >= a) & (share < b)).any()
    ]
    assert expected, "the fixture's map has nothing to part"
    lines = page.locator(".world-surface path.isoline")
    assert [line.get_attribute("data-level") for line in lines.all()] == expected
    keys = page.locator(".world-key.world-line").all_inner_texts()
    assert [key.strip() for key in keys] == [f"line of {level}" for level in expected]
    assert all(f"line of {level}" in (page.locator(".world-surface svg").first.get_attribute("aria-label") or "") for level in expected)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save SVG").click()
    download.value.save_as(tmp_path / "lines.svg")
    saved = [e for e in ElementTree.parse(tmp_path / "lines.svg").iter("{http://www.w3.org/2000/svg}path") if e.get("class") == "isoline"]
    assert [e.get("d") for e in saved] == [line.get_attribute("d") for line in lines.all()]
    page.get_by_label("Lines").focus()
    page.keyboard.press("Space")
    assert lines.count() == 0
    page.keyboard.press("Space")
    assert lines.count() == len(expected)
    page.select_option("#layer", "pdop_p95")
    assert lines.count() == 0
    assert page.get_by_label("Lines").is_hidden()


def test_the_saved_picture_says_what_it_shows(page: Page, made: maps.Map, tmp_path: Path) -> None:
    page.select_option("#layer", "pdop_p95")
    with page.expect_download() as download:
        page.get_by_role("button", name="Save SVG").click()
    download.value.save_as(tmp_path / "picture.svg")
    words = " ".join("".join(e.itertext()) for e in ElementTree.parse(tmp_path / "picture.svg").iter("{http://www.w3.org/2000/svg}text"))
    keys = page.locator(".world-key").all_inner_texts()
    assert len(keys) > 1
    assert all("".join(key.split()) in "".join(words.split()) for key in keys), words
    assert "Position dilution of precision, 95 % of the time" in words
    assert made.summary.title in words


def test_outcomes_share_out_time_and_area(page: Page, made: maps.Map) -> None:
    shown = {o.name: value(page, f"outcome_{o.name}") for o in made.summary.outcomes if o.share > 0}
    assert set(shown) == {"p_available", "beyond"}
    assert sum(shown.values()) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(("kind", "magic"), [("PNG", b"\x89PNG\r\n\x1a\n"), ("SVG", b"<svg ")])
def test_the_picture_leaves_the_page(page: Page, kind: str, magic: bytes, tmp_path: Path) -> None:
    with page.expect_download() as download:
        page.get_by_role("button", name=f"Save {kind}").click()
    file = tmp_path / "picture"
    download.value.save_as(file)
    assert file.read_bytes()[: len(magic)] == magic
    assert file.stat().st_size > 5_000
