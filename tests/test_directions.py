"""Where speed and track lead between statements: what an aircraft may have flown, and what it cannot."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from test_who_and_when import DEG_PER_M, SPEED_MPS, analyzed, rows

WORDS = "positions end elsewhere"


def doubted(tmp_path: Path, table: list[dict[str, Any]]) -> bool:
    return any(WORDS in each for each in analyzed(tmp_path, table).summary.verdict.position_doubts)


def turning(speed_mps: float, rate_deg_s: float, every_s: int, stated_s: int, hold_s: float) -> list[dict[str, Any]]:
    """Straight for a while, round, and so on; a position each so many seconds, speed and track each so many."""
    n_s = 1500
    table, east, north, track_deg = list[dict[str, Any]](), 0.0, 0.0, 30.0
    leg_s = 180.0 / rate_deg_s
    for k in range(n_s):
        if k % every_s == 0:
            stated = {"ground_speed_mps": speed_mps, "track_deg": track_deg % 360.0} if k % stated_s == 0 else {}
            place = {"lat_deg": 48.0 + north * DEG_PER_M, "lon_deg": 2.0 + east * DEG_PER_M / math.cos(math.radians(48.0))}
            table += [{"time_s": 1_700_000_000 + k, "nac_p": 10, "ground_speed_mps": None, "track_deg": None} | place | stated]
        for _ in range(10):
            straight = hold_s > 0.0 and k % (leg_s + hold_s) < hold_s
            track_deg += 0.0 if straight else 0.1 * rate_deg_s
            east += 0.1 * speed_mps * math.sin(math.radians(track_deg))
            north += 0.1 * speed_mps * math.cos(math.radians(track_deg))
    return table


@pytest.mark.parametrize(
    "flight",
    [
        # A hold of a transport, statements each ten seconds between positions each second, and all in rows of 10 s.
        (110.0, 3.0, 1, 10, 60.0),
        (110.0, 3.0, 10, 10, 60.0),
        (110.0, 3.0, 15, 15, 60.0),
        # A glider in a thermal: circles of 24 s in rows of 4 s, and of 30 s, which say nothing.
        (28.0, 15.0, 4, 4, 0.0),
        (28.0, 15.0, 30, 30, 0.0),
        # A fighter.
        (200.0, 10.0, 1, 5, 0.0),
    ],
)
def test_turns_between_statements_are_no_lead(tmp_path: Path, flight: tuple[float, float, int, int, float]) -> None:
    doubts = analyzed(tmp_path, turning(*flight)).summary.verdict.position_doubts
    assert not [each for each in doubts if WORDS in each or "direction of the reported track" in each]


@pytest.mark.parametrize(("every_s", "stated_s"), [(15, 15), (20, 20), (40, 40), (1, 20), (5, 20)])
def test_a_lead_aside_shows_between_rows_and_statements_that_are_far_apart(tmp_path: Path, every_s: int, stated_s: int) -> None:
    def led(k: int) -> dict[str, Any]:
        stated = {"ground_speed_mps": SPEED_MPS, "track_deg": 0.0} if k % stated_s == 0 else {"ground_speed_mps": None, "track_deg": None}
        return stated | {"lon_deg": 2.0 + 60.0 * max(0, k - 600) * DEG_PER_M / 0.65}

    table = [row | led(k) for k, row in enumerate(rows(2400)) if k % every_s == 0]
    assert doubted(tmp_path, table)
    straight = [row | {"lon_deg": 2.0} for row in table]
    assert not doubted(tmp_path, straight)


def turned(n: int, at: int) -> list[dict[str, Any]]:
    """To the north, and from some second on to the east, which no track states."""
    east_m = [SPEED_MPS * max(0, k - at) for k in range(n)]
    table = rows(n, ground_speed_mps=SPEED_MPS, track_deg=0.0)
    place = [{"lat_deg": 48.0 + min(k, at) * SPEED_MPS * DEG_PER_M, "lon_deg": 2.0 + east_m[k] * DEG_PER_M / 0.65} for k in range(n)]
    return [row | at_k for row, at_k in zip(table, place, strict=True)]


@pytest.mark.parametrize(("spell", "of"), [(59, 104), (40, 110)])
def test_statements_in_spells_are_compared(tmp_path: Path, spell: int, of: int) -> None:
    stated = [row if k % of < spell else row | {"track_deg": None} for k, row in enumerate(turned(2400, 1200))]
    assert doubted(tmp_path, stated)
    right = [row if k % of < spell else row | {"track_deg": None} for k, row in enumerate(turned(2400, 2400))]
    assert not doubted(tmp_path, right)


def test_a_flight_that_is_right_at_first_hides_no_end_that_is_not(tmp_path: Path) -> None:
    """A track each 50 s is no direction between; the steps to its rows have one."""
    table = [row if k % 50 == 0 else row | {"track_deg": None} for k, row in enumerate(turned(4000, 2400))]
    words = "move aside of the reported track"
    for piece_rows in (None, 333):
        assert any(words in each for each in analyzed(tmp_path, table, piece_rows=piece_rows).summary.verdict.position_doubts)
    # Five minutes are not full.
    assert not any(words in each for each in analyzed(tmp_path, table[:2650]).summary.verdict.position_doubts)


@pytest.mark.parametrize("hold_s", [30, 90, 250])
def test_a_position_that_goes_on_from_where_it_stood_is_as_late_as_it_stood(tmp_path: Path, hold_s: int) -> None:
    def place(second: int) -> dict[str, Any]:
        return {"lat_deg": 48.0 + second * SPEED_MPS * DEG_PER_M}

    table, end = rows(1200, ground_speed_mps=SPEED_MPS, track_deg=0.0), 600 + hold_s
    stopped = [row | place(min(k, 600) if k < end else k - hold_s) for k, row in enumerate(table)]
    reasons = analyzed(tmp_path, stopped).epochs["reason_id"].to_list()
    assert set(reasons[:600]) == {None}
    assert set(reasons[605:]) == {"position_stale"}
    # One that is where the aircraft is after the hold is believed, and so is one that catches up in the end.
    at_once = [row | place(600 if 600 < k < end else k) for k, row in enumerate(table)]
    assert set(analyzed(tmp_path, at_once).epochs["reason_id"].to_list()[end:]) <= {None, "position_late"}
    later = [row | place(min(k, 600) if k < end else k - hold_s if k < 1000 else k) for k, row in enumerate(table)]
    assert analyzed(tmp_path, later).epochs["reason_id"].to_list()[-100:] == [None] * 100


@pytest.mark.parametrize("hold_s", [25, 45, 59])
def test_a_position_that_goes_on_behind_a_silence_is_as_late_as_one_that_stood(tmp_path: Path, hold_s: int) -> None:
    """A feed that leaves out what repeats has none of the rows of the hold: 45 s left 10.4 km that nobody saw."""

    def place(second: int) -> dict[str, Any]:
        return {"lat_deg": 48.0 + second * SPEED_MPS * DEG_PER_M}

    table, end = rows(1200, ground_speed_mps=SPEED_MPS, track_deg=0.0), 600 + hold_s
    heard = [(k, row) for k, row in enumerate(table) if not 600 < k < end]
    behind = analyzed(tmp_path, [row | place(k if k <= 600 else k - hold_s + 1) for k, row in heard]).epochs["reason_id"].to_list()
    assert set(behind[:601]) == {None}
    assert set(behind[605:]) == {"position_stale"}
    # Nobody is behind who was merely not heard, or catches up.
    assert set(analyzed(tmp_path, [row | place(k) for k, row in heard]).epochs["reason_id"].to_list()) == {None}
    later = [row | place(k if k <= 600 or k > 900 else k - hold_s + 1) for k, row in heard]
    assert analyzed(tmp_path, later).epochs["reason_id"].to_list()[-100:] == [None] * 100


@pytest.mark.parametrize("every_s", [1, 4])
def test_a_glider_that_circles_steeply_travels_as_far_as_it_says(tmp_path: Path, every_s: int) -> None:
    """22 degrees a second at 26 m/s are 45 degrees of bank: in ten seconds it has turned by more than half a turn."""
    assert analyzed(tmp_path, turning(26.0, 22.0, every_s, every_s, 0.0)).summary.verdict.position_doubts == []
