"""Several rows of a track at one time: messages of one instant are one epoch; what contradicts itself is not judged."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import navbound
from navbound.read.pieces import read_pieces
from navbound.run.directory import Run
from test_fixes_of_one_second import START_S, row, written

N = 60


def message(k: float, **states: Any) -> dict[str, Any]:
    """A row of the time of `k` without a position."""
    return dict.fromkeys(row(0), "") | {"hex": "3c6444", "now": START_S + k} | states


def of(tmp_path: Path, rows: list[dict[str, Any]]) -> Run:
    return navbound.analyze(written(tmp_path, rows), spec="RNP 0.3")


def repeated(run: Run) -> dict[str, int]:
    return {each.reason: each.count for each in run.summary.rejected}


@pytest.mark.parametrize("first", [True, False])
def test_messages_without_a_position_belong_to_the_instant_of_one_that_has_it(tmp_path: Path, first: bool) -> None:
    def second(k: int) -> list[dict[str, Any]]:
        others = [message(k, speed_mps=200.0, track_deg=0.0), message(k)]
        return [row(k), *others] if first else [*others, row(k)]

    run = of(tmp_path, [each for k in range(N) for each in second(k)])
    assert (run.summary.verdict.id, run.summary.verdict.n_epochs, run.summary.verdict.n_missing) == ("inside", N, 0)
    assert any(f"{2 * N} rows without a position have the time of one with a position" in each for each in run.summary.assumptions)


@pytest.mark.parametrize("states", [{"nac_p": 0}, {"status": "not_available"}, {"spoofed": 1}], ids=str)
def test_a_message_that_speaks_of_the_position_is_no_part_of_its_instant(tmp_path: Path, states: dict[str, Any]) -> None:
    name = next(iter(states))
    rows = [each for k in range(N) for each in (row(k, **({} if name == "nac_p" else {name: ""})), message(k, **states))]
    assert of(tmp_path, rows).summary.verdict.n_missing == N


def test_an_instant_of_many_messages_without_a_position_hides_no_loss(tmp_path: Path) -> None:
    rows = [each for k in range(N) for each in (row(k), *(message(k) for _ in range(12)))]
    assert (of(tmp_path, rows).summary.verdict.id, of(tmp_path, rows).summary.verdict.n_missing) == ("not_shown", 12 * N)


@pytest.mark.parametrize("times", [3, 12])
def test_an_instant_that_is_written_as_often_as_all_others_is_one_epoch(tmp_path: Path, times: int) -> None:
    run = of(tmp_path, [row(k) for k in range(N) for _ in range(times)])
    assert (run.summary.verdict.id, run.summary.verdict.n_epochs) == ("inside", N)
    assert repeated(run) == {"time repeated within a track": N * (times - 1)}


def test_several_positions_of_one_instant_are_named_and_no_clock_is_blamed(tmp_path: Path) -> None:
    rows = [row(k, lat=48.0 + k * 0.002 + j * 0.0003, speed_mps="", track_deg="") for k in range(N) for j in range(3)]
    run = of(tmp_path, rows)
    assert run.summary.verdict.n_judged == 0
    assert repeated(run) == {"time repeated within a track with another position, bound or status": 2 * N}
    assert any(f"{N} of them another position of the same time" in each for each in run.summary.assumptions)


@pytest.mark.parametrize("moves", [True, False])
def test_a_time_that_comes_far_more_often_than_others_is_many_epochs(tmp_path: Path, moves: bool) -> None:
    """Behind the last good second time stands for as many rows again; where positions move meanwhile, that is the clock."""
    rows = [row(k) for k in range(N)] + [row(N + k if moves else N - 1) | {"now": START_S + N - 1} for k in range(N)]
    run = of(tmp_path, rows)
    assert (run.summary.verdict.id, run.summary.verdict.n_missing) == ("not_shown", N)
    (reason,) = repeated(run)
    assert ("clock that stands" in reason) is moves


@pytest.mark.parametrize("piece_rows", [1, 7, 1000])
def test_pieces_of_any_length_find_the_same(tmp_path: Path, piece_rows: int) -> None:
    path = written(tmp_path, [each for k in range(N) for each in (message(k), row(k), row(k))])
    reading = read_pieces(path, piece_rows=piece_rows)
    n = sum(piece.height for piece in reading.epochs())
    assert (n, reading.left_out.height) == (N, 0)
    assert any(f"{N} rows without a position" in each for each in reading.notes)


def hover(k: int, stamp: float) -> dict[str, Any]:
    """A row of a vehicle that stands in the air, with noise of decimetres."""
    noise = {"lat": 48.0 + (k * 7 % 11) * 3e-7, "lon": 2.0 + (k * 5 % 13) * 3e-7}
    return row(0) | noise | {"now": START_S + stamp, "speed_mps": round(0.1 * (k * 3 % 7), 2), "track_deg": k % 360}


@pytest.mark.parametrize("stands_s", [20, 45])
@pytest.mark.parametrize("fraction", [0.0, 0.25])
def test_a_vehicle_that_hovers_under_a_clock_that_stands_is_not_inside(tmp_path: Path, stands_s: int, fraction: float) -> None:
    """A row a second, under a stamp that goes on each so many seconds: no time comes more often than others."""
    run = of(tmp_path, [hover(k, k // stands_s * stands_s + fraction) for k in range(10 * stands_s)])
    assert run.summary.verdict.id == "not_shown"
    assert any("clock that stands" in reason for reason in repeated(run))


def test_a_vehicle_that_hovers_under_whole_seconds_is_inside(tmp_path: Path) -> None:
    """Twenty fixes a second, whose stamps are rounded."""
    run = of(tmp_path, [hover(k, k // 20) for k in range(1200)])
    assert run.summary.verdict.id == "inside"
