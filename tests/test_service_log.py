"""The messages of an augmentation service as the report shows them: counts, gaps and time-outs by type, UDRE and GIVE over time."""

from __future__ import annotations

import math
import re
import shutil
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import navbound
from navbound import sbas
from navbound.records.performance import GridPoint, MessageCount, ServiceLog, UdreHistory
from navbound.report import render
from navbound.report.coast import grid_region
from navbound.run.evaluate import service
from navbound.sbas import Decoded, grid
from test_report_browser import FLAGS, _open

if TYPE_CHECKING:
    from playwright.sync_api import Browser

ROOT = Path(__file__).parents[1]
NS = 1_000_000_000
MASK = {"iodp": 1, "prn": [3, 7, 40, 122]}


def sent(*messages: tuple[int, int, dict[str, Any]]) -> list[Decoded]:
    return [Decoded(second * NS, 122, kind, fields) for second, kind, fields in messages]


def fast(*udrei: int, iodp: int = 1, first: int = 1) -> dict[str, Any]:
    return {"iodp": iodp, "position": list(range(first, first + len(udrei))), "udrei": list(udrei)}


def histories(messages: list[Decoded], first_s: int = 0, bin_s: int = 10, n_bins: int = 3) -> tuple[dict[str, Any], list[list[int]], int]:
    made = service._Histories(first_s * NS, bin_s * NS, n_bins)
    for message in messages:
        made.take(message)
    udre, give, n_points = made.end()
    return {each.sv: each.worst for each in udre}, give, n_points


def test_the_worst_indicator_of_a_bin_counts_and_a_bin_without_one_has_none() -> None:
    udre, _, _ = histories(
        sent((-5, 1, MASK), (1, 2, fast(5, 14, 3, 0)), (4, 2, fast(9, 14, 3, 0)), (7, 2, fast(6, 14, 3, 15)), (25, 6, {"udrei": [2] * 51}))
    )
    # G07 is monitored by message 6 alone.
    assert udre == {"G03": [9, None, 2], "G07": [14, None, 2], "R03": [3, None, 2], "S122": [15, None, 2]}


def test_a_message_of_another_mask_or_before_any_says_nothing() -> None:
    assert histories(sent((1, 2, fast(5)), (2, 1, MASK), (3, 2, fast(5, iodp=2))))[0] == {}


def test_grid_points_count_by_their_last_indicator_until_they_are_too_old() -> None:
    mask = {"bands": 1, "band": 4, "iodi": 1, "point": list(range(101, 118))}
    metre = [1.0] * 15
    full = {"band": 4, "iodi": 1, "block": 0, "givei": [3] * 14 + [15], "delay_m": metre}
    rest = {"band": 4, "iodi": 1, "block": 1, "givei": [7, 8, *[0] * 13], "delay_m": metre}
    other = {"band": 4, "iodi": 2, "block": 0, "givei": [1] * 15, "delay_m": metre}
    _, give, n_points = histories(sent((0, 18, mask), (1, 26, full), (12, 26, rest), (13, 26, other)), bin_s=310)
    assert n_points == 17
    # Of block 1 the mask has two points. After 600 s nothing counts: message 26 of 12 s is too old at 620 s no less than that of 1 s.
    at = {3: 14, 15: 1, 7: 1, 8: 1}
    assert give == [[at.get(k, 0) for k in range(16)], [0] * 16, [0] * 16]


def test_every_point_has_its_place_and_its_state_at_the_end_of_each_bin() -> None:
    # Corners of the table: of band 4 the numbers 101 and 128, of band 9 the last.
    masks = [(0, 18, {"bands": 2, "band": 4, "iodi": 1, "point": [101, 128]}), (0, 18, {"bands": 2, "band": 9, "iodi": 1, "point": [192]})]
    none = [0.0] * 12

    def delays(band: int, givei: list[int], delay_m: list[float | None]) -> dict[str, Any]:
        rest = [0] * (15 - len(givei))
        return {"band": band, "iodi": 1, "block": 0, "givei": givei + rest, "delay_m": [*delay_m, *none, 0.0, 0.0, 0.0][:15]}

    messages = [
        *masks,
        (1, 26, delays(4, [10, 15], [2.0, 2.0])),
        (12, 26, delays(4, [10, 2], [None, 2.0])),
        (13, 26, delays(9, [14], [9.0])),
    ]
    made = service._Histories(0, 10 * NS, 63)
    for message in sent(*messages):
        made.take(message)
    _, give, _ = made.end()
    grid = {(round(math.degrees(p.lat_rad)), round(math.degrees(p.lon_rad))): p.states for p in made.grid()}
    # Ten seconds a bin; 600 s after 12 s and 13 s, with the bin that ends at 620 s, both are too old.
    assert grid == {(-75, 0): "A" + "X" * 60 + "..", (85, 0): "F" + "2" * 60 + "..", (85, 150): "." + "E" * 60 + ".."}
    # A point that must not be used counts as one that is not monitored.
    assert (give[0][10], give[0][15], give[1][15], give[1][2], give[1][14], sum(give[62])) == (1, 1, 1, 1, 1, 0)


def test_points_of_the_grid_are_where_the_standard_has_them() -> None:
    """Corners of the table of bands, with the number of points of each band."""
    table = {band: grid.points(band) for band in range(11)}
    assert [len(points) for points in table.values()] == [*[201] * 8, 200, 192, 192]
    corners = {
        (0, 1): (-75, -180), (0, 28): (85, -180), (0, 29): (-55, -175), (0, 201): (55, -145), (1, 1): (-85, -140), (1, 28): (75, -140),
        (4, 101): (-75, 0), (4, 128): (85, 0), (7, 151): (-85, 130), (8, 1): (-75, 140), (8, 200): (55, 175), (9, 1): (60, -180),
        (9, 73): (65, -180), (9, 181): (85, -180), (9, 192): (85, 150), (10, 181): (-85, -170), (10, 192): (-85, 160),
    }  # fmt: skip
    assert {key: table[key[0]][key[1] - 1] for key in corners} == corners


def test_gaps_are_time_outs_only_where_no_other_message_says_the_same() -> None:
    whole = sent(
        (0, 2, fast(1)),
        (20, 2, fast(1)),
        (26, 6, {"udrei": [1] * 51}),
        (38, 2, fast(1)),
        (39, 25, {"long_term": []}),
        (400, 25, {"long_term": []}),
    )
    counts = {each.type: each for each in service._counts(whole)}
    # 20 s are a time-out; 18 s with a message 6 within are none. 361 s are one of long-term corrections.
    assert (counts[2].n, counts[2].longest_gap_s, counts[2].n_time_outs) == (3, 20.0, 1)
    assert (counts[25].longest_gap_s, counts[25].n_time_outs) == (361.0, 1)
    assert (counts[6].longest_gap_s, counts[6].time_out_s) == (None, None)
    mixed = sent((0, 2, fast(1)), (11, 24, {**fast(1), "long_term": []}), (22, 2, fast(1)))
    assert {each.type: each.n_time_outs for each in service._counts(mixed)}[2] == 0


def test_time_outs_are_those_that_the_core_declares() -> None:
    text = (ROOT / "crates/core/src/signal/sbas/timeout.rs").read_text(encoding="utf-8")
    declared = {name: int(seconds) for name, seconds in re.findall(r"pub const (\w+): TimeOut = TimeOut\((\d[\d_]*),", text)}
    types = {
        "PRN_MASK": (1,),
        "UDRE": (2, 3, 4, 5),
        "LONG_TERM": (25,),
        "GEO_NAVIGATION": (9,),
        "FAST_DEGRADATION": (7,),
        "DEGRADATION": (10,),
        "GRID_MASK": (18,),
        "GRID": (26,),
        "REGIONS": (27,),
        "COVARIANCE": (28,),
    }
    assert set(types) == set(declared)
    assert {kind: out for kind, (_, out) in service.TYPES.items() if out is not None} == {
        kind: declared[name] for name, kinds in types.items() for kind in kinds
    }


def test_a_recorded_hour_is_counted_as_its_lines_say(shared_data: Path) -> None:
    """Types and bits read from the text: eight fields before the 250 bits; UDRE indicators behind 14 + 4 + 13 x 12 bits."""
    path = shared_data / "sbas" / "msas137_2025046_17h.ems"
    lines = [line.split() for line in path.read_text(encoding="ascii").splitlines()]
    read = sbas.read(path)
    log = service.service_log(read, int(read.time_ns[0]))
    assert {each.type: each.n for each in log.types} == Counter(int(line[7]) for line in lines)
    assert (log.prn, log.n_messages, log.n_missing, log.longest_silence_s) == (137, len(lines), 0, 1.0)
    worst: dict[int, int] = {}
    masked = False
    for line in lines:
        bits = f"{int(line[8], 16):0{4 * len(line[8])}b}"
        masked |= line[7] == "1"
        if line[7] in {"2", "3"} and masked:
            for k in range(13):
                # The mask of this hour is PRN 1 to 32 and 137.
                prn = 13 * (int(line[7]) - 2) + k + 1
                worst[prn] = max(worst.get(prn, 0), int(bits[174 + 4 * k : 178 + 4 * k], 2))
    shown = {each.sv: max(u for u in each.worst if u is not None) for each in log.udre}
    assert {sv: u for sv, u in shown.items() if sv <= "G26"} == {f"G{prn:02d}": worst[prn] for prn in worst if f"G{prn:02d}" in shown}
    # The grid of every bin counts what the table counts, point by point.
    states = [Counter(point.states[k] for point in log.grid) for k in range(len(log.give))]
    assert all(counts["X"] + counts["F"] == log.give[k][15] for k, counts in enumerate(states))
    assert all(counts[f"{i:X}"] == log.give[k][i] for k, counts in enumerate(states) for i in range(15))
    assert Counter(point.states[-1] for point in log.grid) == _last_states(lines)
    # What is not shown was never monitored.
    assert all(worst[prn] >= service.NOT_MONITORED for prn in worst if f"G{prn:02d}" not in shown)


def _last_states(lines: list[list[str]]) -> Counter[str]:
    """Read from the text: masks behind 14 + 4 bits, blocks of 13 bits for a point behind 22, the issue of the mask behind those."""
    masks: dict[str, tuple[str, list[int]]] = {}
    last: dict[tuple[str, int], str] = {}
    for line in lines:
        bits = f"{int(line[8], 16):0{4 * len(line[8])}b}"
        if line[7] == "18":
            masks[bits[18:22]] = bits[22:24], [k for k in range(201) if bits[24 + k] == "1"]
        if line[7] == "26" and masks.get(bits[14:18], ("", []))[0] == bits[217:219]:
            for k, point in enumerate(masks[bits[14:18]][1][15 * int(bits[18:22], 2) :][:15]):
                delay, indicator = bits[22 + 13 * k : 31 + 13 * k], int(bits[31 + 13 * k : 35 + 13 * k], 2)
                last[bits[14:18], point] = "X" if delay == "1" * 9 else f"{indicator:X}"
    return Counter(last.get((band, point), ".") for band, (_, points) in masks.items() for point in points)


CHROMIUM = shutil.which("chromium")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    if CHROMIUM is None:
        pytest.skip("chromium is not installed: the report was NOT opened in a browser")
    from playwright.sync_api import sync_playwright  # noqa: PLC0415 - its driver starts only where chromium exists

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


def log() -> ServiceLog:
    udre, give, n_points = service._Histories(0, 20 * NS, 3).end()
    assert (udre, n_points) == ([], 0)
    return ServiceLog(
        prn=122,
        first_ns=1_456_390_800 * NS,
        last_ns=1_456_390_859 * NS,
        n_messages=57,
        n_missing=3,
        longest_silence_s=4.0,
        types=[MessageCount(type=2, what="fast", n=9, longest_gap_s=13.0, time_out_s=12, n_time_outs=1)],
        bin_ns=20 * NS,
        udre=[UdreHistory(sv="G03", worst=[5, 12, 15]), UdreHistory(sv="G07", worst=[5, None, 5])],
        give=[*give[:2], [0] * 3 + [14] + [0] * 11 + [3]],
        n_points=17,
        grid=[
            GridPoint(lat_rad=math.radians(lat), lon_rad=math.radians(lon), states=states)
            for lat, lon, states in [(50, 175, "35X"), (50, -180, ".3F"), (55, -175, "..E")]
        ],
        words=[],
    )


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("service")
    table = folder / "levels.csv"
    rows = (f"2026-03-01T09:00:{k:02d}Z,1.0,1.0,1.0,20.0,30.0\n" for k in range(60))
    table.write_text("time,nse_e_m,nse_n_m,nse_u_m,hpl_m,vpl_m\n" + "".join(rows), encoding="utf-8")
    run = navbound.evaluate(table, levels="APV-I")
    assert run.summary.performance is not None
    # A table was corrected by no messages.
    assert run.summary.performance.service is None
    performance = run.summary.performance.model_copy(update={"service": log()})
    summary = run.summary.model_copy(update={"performance": performance})
    return render(summary, run.record, run.epochs, run.events, [], folder / "report.html")


def test_the_page_shows_types_udre_and_grid(browser: Browser, report: Path) -> None:
    page = _open(browser, report, width=420, scheme="dark")
    words = page.locator("#service").inner_text()
    assert "57 messages, in 3 seconds none was received, the longest silence is 4 s" in words
    assert "At 1 time data of a type were older" in words
    assert page.locator('#message-types [data-key="n_time_outs"]').get_attribute("data-value") == "1"
    drawn = page.evaluate("() => [...document.querySelectorAll('#udre rect')].map((cell) => cell.getAttribute('class').slice(8))")
    # Of G07 a bin has no indicator: nothing is drawn there, and its neighbours are not joined.
    assert drawn == ["close", "route", "stop", "close", "close"]
    assert "not monitored or not to be used at times: G03" in str(page.locator("#udre").get_attribute("aria-label"))
    assert "14 of 17 points of the grid are monitored" in str(page.locator("#give").get_attribute("aria-label"))
    assert page.evaluate("document.documentElement.scrollWidth") <= 420
    page.context.close()


def test_the_map_shows_the_grid_as_it_stood_at_the_cursor(browser: Browser, report: Path) -> None:
    page = _open(browser, report)
    points = page.locator("#grid-map [data-state]")

    def move_to(second: int) -> None:
        page.locator("#bucket").evaluate("(slider, i) => { slider.value = i; slider.dispatchEvent(new Event('input')); }", second)

    # Twenty seconds a bin; row k of the table, of 09:00:00 UTC and k seconds, is 18 + k seconds after the first message.
    for second, states in ((0, "3.."), (5, "53."), (25, "XFE")):
        move_to(second)
        assert "".join(points.evaluate_all("all => all.map((e) => e.dataset.state)")) == states
    keys = page.locator("#grid-map .key .value").evaluate_all("all => all.map((e) => [e.dataset.key, e.dataset.value])")
    assert keys == [["grid_4", "1"], ["grid_F", "1"], ["grid_X", "1"]]
    assert "15 and 45 m: 1; not monitored: 1; not to be used: 1" in str(
        page.locator("#grid-map .grid-surface svg").get_attribute("aria-label")
    )
    page.locator("#grid-map summary").focus()
    page.keyboard.press("Enter")
    page.locator("#grid-map tbody tr").first.wait_for()
    assert page.locator("#grid-map tbody tr").all_inner_texts() == [
        "50° N, 175° E\tnot to be used",
        "50° N, 180° W\tnot monitored",
        "55° N, 175° W\tGIVE 45 m (indicator 14)",
    ]
    # Across the antimeridian each point is 5 degrees east of the one before.
    x = points.evaluate_all("all => all.map((e) => Number(/translate\\(([-0-9.]+)/.exec(e.getAttribute('transform'))[1]))")
    assert x[1] - x[0] > 10
    # Places are written to a tenth of the picture's units.
    assert x[2] - x[1] == pytest.approx(x[1] - x[0], abs=0.2)
    # Of the last 18 rows there is no message.
    move_to(45)
    assert "".join(points.evaluate_all("all => all.map((e) => e.dataset.state)")) == "..."
    assert "No message of the log is of the time under the cursor" in page.locator("#grid-map").inner_text()
    page.context.close()


def test_the_region_of_a_grid_begins_after_its_widest_gap() -> None:
    def region(*places: tuple[int, int]) -> tuple[float, float, float, float] | None:
        return grid_region([GridPoint(lat_rad=math.radians(lat), lon_rad=math.radians(lon), states="") for lat, lon in places])

    assert region((20, -40), (65, 45)) == (15, -45.0, 70, 50.0)
    assert region((50, 175), (50, -180), (55, -175)) == (45, 170.0, 60, 190.0)
    assert region((-85, 10), (85, 10)) == (-90, 5.0, 90, 15.0)
    # All around the Earth it is one turn, no more.
    assert region(*((0, lon) for lon in range(-180, 180, 5))) == (-5, -182.5, 5, 177.5)
    assert region() is None


def test_give_of_an_indicator_agrees_with_the_variances_of_the_core() -> None:
    """Two columns of one table of the standard: the variance is that of an error whose 99.9 % (3.29 deviations) is the GIVE."""
    page = (ROOT / "web/src/panel/gridstates.ts").read_text(encoding="utf-8")
    core = (ROOT / "crates/core/src/bound/sbas/model.rs").read_text(encoding="utf-8")
    give, variances = (
        re.search(pattern, text) for pattern, text in ((r"GIVE_M = \[([^\]]*)\]", page), (r"GIVE_M2: \[f64; 15\] =\s*\[([^\]]*)\]", core))
    )
    assert give is not None
    assert variances is not None
    pairs = [tuple(map(float, pair)) for pair in zip(give[1].split(","), variances[1].split(","), strict=True)]
    assert len(pairs) == 15
    for give_m, variance_m2 in pairs:
        # The standard prints the variance to four decimals, and that of 0.3 m as 0.0084 for 0.00831.
        assert (give_m / 3.29) ** 2 == pytest.approx(variance_m2, abs=1e-4, rel=2e-5)
