"""Positions that contradict those beside them by more than their covariances allow are not shown to be inside."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import navbound
from navbound.records.run import Verdict
from test_verdict import M_PER_RAD, table, white

N = 400
SIGMA_M = 77.0 / math.sqrt(-2.0 * math.log(0.05))
"""Of a 95 % circle of 77 m."""


def moved(tmp_path: Path, error_en_m: NDArray[np.float64], speed_mps: float = 50.0, sigma_m: float = SIGMA_M) -> Verdict:
    k = np.arange(N)
    place = {
        "est_lat_rad": 0.85 + (speed_mps * k + error_en_m[:, 1]) / M_PER_RAD,
        "est_lon_rad": 0.04 + error_en_m[:, 0] / (M_PER_RAD * math.cos(0.85)),
    }
    path = table(tmp_path / "a.csv", N, sigma_m=sigma_m, added=place)
    whole = navbound.analyze(path).summary.verdict
    assert whole == navbound.analyze(path, piece_rows=41).summary.verdict
    return whole


@pytest.mark.parametrize("axis", [0, 1], ids=["across", "along"])
@pytest.mark.parametrize("speed_mps", [0.0, 2.0, 50.0])
def test_two_receivers_in_alternate_rows_under_one_name(tmp_path: Path, axis: int, speed_mps: float) -> None:
    error = white(N, 1.0)
    error[1::2, axis] += 397.0
    verdict = moved(tmp_path, error, speed_mps)
    assert verdict.id == "not_shown"
    if verdict.n_implausible == 0:
        assert verdict.n_apart > N - 10
        assert "stand further from the line between their neighbours than their covariances allow" in verdict.words


def test_noise_of_the_stated_size_has_no_doubt(tmp_path: Path) -> None:
    verdict = moved(tmp_path, white(N, SIGMA_M))
    assert (verdict.id, verdict.n_apart) == ("inside", 0)


def test_a_turn_of_one_g_and_a_stop_are_manoeuvres(tmp_path: Path) -> None:
    """A circle at 50 m/s with 9 m/s2 and centimetres of sigma; then the same way at half the speed from one second to the next."""
    radius_m = 50.0**2 / 9.0
    angle = 50.0 * np.arange(N) / radius_m
    circle = radius_m * np.column_stack([np.cos(angle), np.sin(angle)])
    verdict = moved(tmp_path, circle, 0.0, 0.05)
    assert verdict.n_apart == 0


def test_one_epoch_aside_is_seen_by_its_neighbours(tmp_path: Path) -> None:
    error = white(N, 1.0)
    error[200, 0] += 90.0
    verdict = moved(tmp_path, error, sigma_m=3.0)
    assert verdict.id == "not_shown"
    assert verdict.n_apart >= 1


@pytest.mark.parametrize("rows", [2, 3, 10, 50])
def test_two_receivers_in_blocks_at_the_speed_of_an_aircraft(tmp_path: Path, rows: int) -> None:
    """Each switch may be chance, all of them may not."""
    error = white(N, 1.0)
    error[(np.arange(N) // rows) % 2 == 1, 0] += 397.0
    verdict = moved(tmp_path, error, 250.0)
    assert verdict.id == "not_shown"
    assert verdict.n_apart > 0 or verdict.n_implausible > 0


@pytest.mark.parametrize(("step_m", "n"), [(0.0, 0), (95.0, 2)])
def test_a_step_along_the_track_that_stays_is_seen_where_positions_come_fast(tmp_path: Path, step_m: float, n: int) -> None:
    """10 Hz at 20 m/s, sigma 3 m: half the step less a manoeuvre of 2.05 m and a position late by 2 m, against 6.4 x 3.7 m."""
    along = [2.0 * k + (step_m if k >= 200 else 0.0) for k in range(N)]
    rows = [f"{1_400_000_000 + 0.1 * k:.1f},{math.degrees(0.85 + m / M_PER_RAD)},2.0,3,3" for k, m in enumerate(along)]
    path = tmp_path / "fast.csv"
    path.write_text("\n".join(["time,lat,lon,sigma_e_m,sigma_n_m", *rows]) + "\n", encoding="utf-8")
    verdict = navbound.analyze(path).summary.verdict
    assert (verdict.id, verdict.n_apart) == ("inside" if n == 0 else "not_shown", n)
