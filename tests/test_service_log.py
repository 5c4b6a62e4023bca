"""The messages of an augmentation service as the report shows them: counts, gaps and time-outs by type, UDRE and GIVE over time."""

from __future__ import annotations

import re
import shutil
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import navbound
from navbound import sbas
from navbound.records.performance import MessageCount, ServiceLog, UdreHistory
from navbound.report import render
from navbound.run.evaluate import service
from navbound.sbas import Decoded
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
    full = {"band": 4, "iodi": 1, "block": 0, "givei": [3] * 14 + [15]}
    rest = {"band": 4, "iodi": 1, "block": 1, "givei": [7, 8, *[0] * 13]}
    other = {"band": 4, "iodi": 2, "block": 0, "givei": [1] * 15}
    _, give, n_points = histories(sent((0, 18, mask), (1, 26, full), (12, 26, rest), (13, 26, other)), bin_s=310)
    assert n_points == 17
    # Of block 1 the mask has two points. After 600 s nothing counts: message 26 of 12 s is too old at 620 s no less than that of 1 s.
    at = {3: 14, 15: 1, 7: 1, 8: 1}
    assert give == [[at.get(k, 0) for k in range(16)], [0] * 16, [0] * 16]


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
    # What is not shown was never monitored.
    assert all(worst[prn] >= service.NOT_MONITORED for prn in worst if f"G{prn:02d}" not in shown)


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
