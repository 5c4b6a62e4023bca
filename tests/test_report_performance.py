"""The performance report as a person meets it: the numbers on the page are those of the records, and a hazard cannot be overlooked."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import kpi_fixture
import report_fixture
from navbound.records.performance import LevelResult, Performance, StanfordCounts
from navbound.report import render

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: the report was NOT opened in a browser")
REGIONS = ("nominal", "mi", "hmi", "unavailable", "unavailable_mi")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu", "--no-first-run"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def record() -> Performance:
    return kpi_fixture.performance()


def _write(performance: Performance | None, out: Path, *, epochs: bool = False, n_tracks: int = 1) -> Path:
    fixture = report_fixture.flight(n_tracks, n=report_fixture.N if epochs else 200)
    summary = fixture.summary.model_copy(update={"performance": performance})
    table = fixture.epochs if epochs or n_tracks > 1 else fixture.epochs.head(0)
    return render(summary, fixture.record, table, fixture.events.head(0), fixture.waypoints, out / "report.html")


def _open(browser: Browser, report: Path, width: int = 1440, scheme: str = "light") -> Page:
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, offline=True)  # type: ignore[arg-type]
    page = context.new_page()
    problems: list[str] = []
    page.on("console", lambda message: problems.append(message.text) if message.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.goto(report.as_uri())
    page.wait_for_selector("#report[data-ready]")
    assert problems == []
    return page


@pytest.fixture(scope="module")
def report(record: Performance, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _write(record, tmp_path_factory.mktemp("performance"))


@pytest.fixture
def page(browser: Browser, report: Path) -> Iterator[Page]:
    page = _open(browser, report)
    yield page
    page.context.close()


def _value(page: Page, selector: str) -> str:
    return page.locator(selector).first.get_attribute("data-value") or ""


def _choose(page: Page, level: str) -> None:
    page.locator(f'#performance [data-choice="{level}"]').click()


def _counts(result: LevelResult, axis: str) -> StanfordCounts:
    return next(c for c in result.stanford if c.axis == axis)


def test_every_indicator_of_every_level_is_that_of_the_record(page: Page, record: Performance) -> None:
    shown = ("availability_expected", "availability_solution", "continuity_risk", "n_continuity_events", "continuity_risk_maritime")
    for result in record.levels:
        for key in (*shown, "n_hazard_epochs", "n_mi_epochs"):
            cell = f'#levels td[data-level="{result.level.id}"] [data-key="{key}"]'
            assert float(_value(page, cell)) == getattr(result, key), (result.level.id, key)
        words = page.locator(f'#levels td[data-level="{result.level.id}"]').all_inner_texts()
        interval = f"{100 * result.availability_low:.2f} % to {100 * result.availability_high:.2f} %, as from 812 independent epochs"
        assert any(interval in text for text in words), interval
        assert any("inferred" in text for text in words)


def test_errors_and_levels_are_spread_as_in_the_record(page: Page, record: Performance) -> None:
    rows = page.locator("#spread tbody tr")
    spreads = [s for a in record.axes for s in (a.error_m, a.level_m, a.safety_index) if s is not None]
    assert rows.count() == len(spreads) == 6
    for i, spread in enumerate(spreads):
        for key in ("n", "mean", "rms", "p50", "p95", "p99", "p999", "max", "max_time_ns"):
            assert float(rows.nth(i).locator(f'[data-key="{key}"]').get_attribute("data-value") or "nan") == getattr(spread, key)


@pytest.mark.parametrize("level", ["APV-I", "LPV-200", "APV-II"])
def test_each_region_of_the_stanford_diagrams_has_its_count_and_share(page: Page, record: Performance, level: str) -> None:
    _choose(page, level)
    result = next(r for r in record.levels if r.level.id == level)
    for axis in "hv":
        counts = _counts(result, axis)
        total = 0
        for region in REGIONS:
            n = getattr(counts, f"n_{region}")
            assert int(_value(page, f'#stanford-{axis} :is(svg, .note) [data-key="n_{region}"]')) == n
            total += n
        assert total == counts.n
        names = " ".join(page.locator(f"#stanford-{axis} :is(.region-name, .hazard, .aside)").all_text_contents())
        assert all(name in names for name in ("Nominal", "MI", "HMI", "Unavailable", "Unavail., MI"))
        percent = 100 * counts.n_nominal / counts.n
        shown = float(page.locator(f"#stanford-{axis} svg .name-nominal").nth(2).text_content().removesuffix(" %"))  # type: ignore[union-attr]
        # A share is shown to a twentieth of what is missing to all.
        assert abs(shown - percent) <= (100 - percent) / 20
        label = page.locator(f"#stanford-{axis} .stanford-box svg").get_attribute("aria-label") or ""
        assert f"hazardously misleading information {counts.n_hmi} (" in label


def test_three_hazards_among_eighty_thousand_epochs_are_seen(page: Page, record: Performance) -> None:
    counts = _counts(next(r for r in record.levels if r.level.id == "LPV-200"), "h")
    assert counts.n_hmi == 3
    assert counts.n > 80_000
    assert page.locator('#performance [data-choice="LPV-200"]').get_attribute("aria-pressed") == "true"
    assert page.locator("#stanford-h .name-hmi").first.text_content() == "■ HMI"
    assert page.locator(".performance-words").get_attribute("data-tone") == "warning"
    assert "LPV-200: 15 epochs, 1 of 2 runs longer than the time to alert" in page.locator(".performance-words").inner_text()
    # They lie beyond the axis, at a level of about 12 m: a square of the warning colour in the band at the edge, 6 of 424 units or more.
    red = """() => {
        const c = document.querySelector("#stanford-h canvas");
        const p = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
        let [n, left, top, bottom] = [0, c.width, c.height, 0];
        for (let i = 0; i < p.length; i += 4) if (p[i] > 180 && p[i + 1] < 40 && p[i + 2] < 60 && p[i + 3] > 250) {
            const [x, y] = [(i / 4) % c.width, Math.floor(i / 4 / c.width)];
            n += 1; left = Math.min(left, x); top = Math.min(top, y); bottom = Math.max(bottom, y);
        }
        return [n, left / c.width, 1 - bottom / c.height, 1 - top / c.height];
    }"""
    n, left, low, high = page.evaluate(red)
    assert n >= 36
    assert left >= 50 / 51.5 - 0.01
    assert 0.19 < low < high < 0.29
    _choose(page, "NPA")
    # Their limit is far beyond the axis: they are misleading, not hazardous, and not drawn in red.
    assert page.evaluate(red)[0] == 0
    assert int(_value(page, '#stanford-h .note [data-key="n_hmi"]')) == 0


def test_subsets_of_satellites_are_a_variant_with_counts_of_their_own(page: Page, record: Performance) -> None:
    page.locator('[data-choice="stanford-esa"]').click()
    assert page.locator("#stanford-v-esa").is_visible()
    assert "satellite subsets" in page.locator("#stanford-v-esa figcaption").inner_text()
    assert record.subsets is not None
    counts = next(c for c in record.subsets.stanford["LPV-200"] if c.axis == "v")
    assert counts.n_nominal != _counts(next(r for r in record.levels if r.level.id == "LPV-200"), "v").n_nominal
    assert int(_value(page, '#stanford-v-esa svg [data-key="n_nominal"]')) == counts.n_nominal


def test_the_gravest_subsets_are_listed_with_their_satellites(page: Page, record: Performance) -> None:
    assert record.subsets is not None
    rows = page.locator("#subsets tbody tr")
    assert rows.count() == len(record.subsets.listed) == 2
    for i, value in enumerate(record.subsets.listed):
        for key in ("time_ns", "safety_index", "hpe_m", "hpl_m", "vpe_m"):
            assert float(rows.nth(i).locator(f'[data-key="{key}"]').get_attribute("data-value") or "nan") == getattr(value, key)
        assert rows.nth(i).locator('[data-key="satellites"]').inner_text() == " ".join(value.satellites)
    text = page.locator("#subsets-section").inner_text()
    assert "One is misleading" in text
    assert "the gravest 2 of 7" in text
    assert "At 2 epochs with many satellites" in text


@pytest.mark.parametrize("experimental", ["", "experimental, not integrity"])
def test_where_only_indicators_were_requested_the_page_leads_with_them(
    browser: Browser, record: Performance, tmp_path: Path, experimental: str
) -> None:
    fixture = report_fixture.flight(1, n=200)
    indicators_only = record.model_copy(update={"experimental": experimental})
    changes = {
        "performance": indicators_only,
        "accuracy": [],
        "integrity": [],
        "honesty": None,
        "tracks": [],
        "phases": [],
        "title": "levels: receiver",
    }
    summary = fixture.summary.model_copy(update=changes)
    page = _open(browser, render(summary, fixture.record, fixture.epochs.head(0), fixture.events.head(0), [], tmp_path / "report.html"))
    panel = page.locator("#verdict")
    assert panel.get_attribute("data-tone") == "warning"
    text = panel.inner_text()
    assert text.startswith("Hazardous")
    assert all(result.level.id in text for result in record.levels)
    assert "RNP" not in text.replace("RNP 0.3", "")
    assert ("experimental, not integrity" in text) == (experimental != "")
    for i, result in enumerate(record.levels):
        value = panel.locator('[data-key="verdict.availability_expected"]').nth(i).get_attribute("data-value")
        assert float(value or "nan") == result.availability_expected
    # What would be empty is not there.
    assert page.locator("#tracks, #methods-section, #honesty").count() == 0
    page.context.close()


@pytest.mark.parametrize("bucket", [0, 500, 835, 1166, 1439])
def test_the_series_show_the_bucket_under_the_cursor(page: Page, record: Performance, bucket: int) -> None:
    page.locator("#bucket").evaluate("(slider, i) => { slider.value = i; slider.dispatchEvent(new Event('input')); }", bucket)
    for axis in "hv":
        for key in (f"{axis}pe_max_m", f"{axis}pl_max_m", f"{axis}pl_min_m"):
            value = getattr(record.series, key)[bucket]
            assert _value(page, f'#protection-{axis} .readout [data-key="{key}"]') == (
                "" if value is None else repr(value).removesuffix(".0")
            )
    for result in record.levels:
        name = result.level.id
        expected = record.series.cause[name][bucket] or "available"
        assert _value(page, f'#causes [data-key="cause {name}"]') == expected
    # UTC is 18 s behind GPS time, whose seconds began at 315 964 800 of Unix time.
    assert float(_value(page, '[data-key="bucket_utc_s"]')) == record.series.start_ns[bucket] / 1e9 + 315_964_800 - 18


def test_pressing_an_event_draws_its_level_and_goes_to_its_time(page: Page, record: Performance) -> None:
    index, event = next((i, e) for i, e in enumerate(record.events) if e.level == "APV-II" and e.kind == "hazard")
    page.locator("#performance-events .row").nth(index).click()
    assert page.locator('#performance [data-choice="APV-II"]').get_attribute("aria-pressed") == "true"
    assert "APV-II" in page.locator("#stanford h3").inner_text()
    bucket = int(page.locator("#bucket").input_value())
    assert 0 <= event.onset_ns - record.series.start_ns[bucket] + 30 * 10**9 <= 60 * 10**9
    assert page.get_by_role("button", name="All of the time").is_enabled()
    row = page.locator("#performance-events tbody tr").nth(index)
    assert float(row.locator('[data-key="duration_s"]').get_attribute("data-value") or "nan") == event.duration_s
    assert row.locator('[data-key="over_tta"]').inner_text() == ("yes" if event.over_tta else "no")
    assert "</script>" in row.inner_text()


def test_an_experimental_level_says_so_at_every_title_axis_and_column(browser: Browser, tmp_path: Path) -> None:
    words = "EE bound (experimental, not integrity)"
    page = _open(browser, _write(kpi_fixture.performance(experimental=words), tmp_path))
    for place in ("#stanford-h h4", "#stanford-v h4", "#protection-h h3", "#protection-v h3", "#performance > div"):
        assert words in page.locator(place).first.inner_text(), place
    for axis in page.locator("#stanford .axis-name").all():
        assert words in (axis.text_content() or "")
    assert words in page.locator('#protection-h .chip:has([data-key="hpl_max_m"])').inner_text()
    assert all(words in head for head in page.locator("#levels thead th").all_inner_texts()[1:])
    heads = page.locator("#performance-events thead th").all_inner_texts()
    assert {"HPL, experimental", "VPL, experimental"} <= set(heads)
    page.context.close()


def test_without_truth_nothing_is_stated_of_integrity(browser: Browser, tmp_path: Path) -> None:
    page = _open(browser, _write(kpi_fixture.performance(truth=False), tmp_path))
    assert "Integrity unknown" in page.locator(".performance-words").inner_text()
    assert page.locator("#levels [data-key=n_hazard_epochs]").count() == 0
    assert "no truth" in page.locator("#levels").inner_text()
    assert page.locator("#stanford").count() == 0
    assert page.locator('#protection-h [data-key="hpe_max_m"]').count() == 0
    assert page.locator("#protection-h canvas").is_visible()
    page.context.close()


def test_a_run_without_the_record_has_no_performance_part(browser: Browser, tmp_path: Path) -> None:
    page = _open(browser, _write(None, tmp_path, n_tracks=3))
    assert page.locator("#performance").count() == 0
    # The other tracks of the run are on the map all the same.
    page.wait_for_selector('.map-surface[data-others="2"]')
    assert page.locator(".map-legend", has_text="other tracks").is_visible()
    page.context.close()


def test_the_series_and_the_epochs_share_one_time(browser: Browser, record: Performance, tmp_path: Path) -> None:
    page = _open(browser, _write(record, tmp_path, epochs=True))
    page.locator("#epoch").evaluate("(slider) => { slider.value = 3000; slider.dispatchEvent(new Event('input')); }")
    assert int(page.locator("#bucket").input_value()) == 3000 // kpi_fixture.WIDTH_S
    assert int(page.locator("#epoch").input_value()) == 3000
    page.locator("#bucket").evaluate("(slider) => { slider.value = 10; slider.dispatchEvent(new Event('input')); }")
    assert 600 <= int(page.locator("#epoch").input_value()) < 660
    page.context.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_performance_part_is_readable_in_both_themes(browser: Browser, report: Path, scheme: str) -> None:
    page = _open(browser, report, scheme=scheme)
    probes = (Path(__file__).parent / "report_probes.js").read_text(encoding="utf-8").split("\n", 1)[1].strip()
    result = page.evaluate(f"() => {probes}.texts()")
    assert result["n"] > 400
    assert result["bad"] == []
    page.context.close()


@pytest.mark.parametrize("width", [320, 420, 1024])
def test_no_width_scrolls_sideways(browser: Browser, report: Path, width: int) -> None:
    page = _open(browser, report, width=width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.locator("#stanford-v canvas").is_visible()
    page.context.close()


def test_epochs_that_cannot_be_true_make_the_verdict_doubtful(browser: Browser, tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=200)
    verdict = fixture.summary.verdict.model_copy(update={"id": "not_shown", "inside": None, "n_implausible": 17})
    summary = fixture.summary.model_copy(update={"verdict": verdict})
    page = _open(
        browser, render(summary, fixture.record, fixture.epochs, fixture.events.head(0), fixture.waypoints, tmp_path / "report.html")
    )
    box = page.locator("#verdict")
    assert box.get_attribute("data-tone") == "caution"
    assert box.locator(".state").inner_text().startswith("Not shown")
    assert _value(page, '#verdict [data-key="n_implausible"]') == "17"
    # The sentence of the consistency stands once.
    assert page.locator("#honesty").inner_text().count("2.11") == 0
    assert float(_value(page, '#honesty [data-key="nees_mean"]')) == fixture.summary.honesty.nees_mean  # type: ignore[union-attr]
    page.context.close()
