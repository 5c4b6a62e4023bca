"""A truth that contradicts its own motion, or stands while the positions travel, is no reference; and the verdict states both."""

from __future__ import annotations

import math
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import navbound
from navbound import InputError
from navbound.records.run import Verdict
from test_verdict import M_PER_RAD, START_NS, first_sentence, table, white

N = 400


def moved_truth(tmp_path: Path, offset_m: NDArray[np.float64]) -> Verdict:
    """A sound track of 3 m whose truth is moved north by so much at each epoch."""
    lat = 0.85 + 50.0 * np.arange(N) / M_PER_RAD
    truth = {"truth_lat_rad": lat + offset_m / M_PER_RAD, "truth_lon_rad": np.full(N, 0.04)}
    return navbound.analyze(table(tmp_path / "a.csv", N, error_en_m=white(N), added=truth)).summary.verdict


def test_a_truth_that_jumps_and_stays_is_split_and_its_established_part_is_the_reference(tmp_path: Path) -> None:
    offset = np.zeros(N)
    offset[340:] = 700.0
    verdict = moved_truth(tmp_path, offset)
    assert (verdict.id, verdict.n_truth, verdict.n_truth_doubted) == ("inside", 340, 60)
    assert "Truth is not believable at 60 epochs" in verdict.words
    leap_s = 18
    jump = datetime(1980, 1, 6, tzinfo=UTC) + timedelta(seconds=START_NS // 1_000_000_000 + 340 - leap_s)
    assert f"it jumps at {jump:%Y-%m-%d %H:%M:%S}" in verdict.words.replace("T", " ")
    assert "known at 85.0 % of the checked epochs only" in first_sentence(verdict.words)


def test_the_first_part_is_not_the_truth_for_being_first(tmp_path: Path) -> None:
    offset = np.zeros(N)
    offset[:60] = 700.0
    verdict = moved_truth(tmp_path, offset)
    # The established part begins with the jump, after which it settles for 30 s, both ends counted.
    assert (verdict.id, verdict.n_truth) == ("inside", 309)


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
def test_of_comparable_parts_none_is_the_truth(tmp_path: Path, share: float) -> None:
    offset = np.zeros(N)
    offset[int(share * N) :] = 700.0
    verdict = moved_truth(tmp_path, offset)
    assert (verdict.id, verdict.n_truth, verdict.n_truth_doubted) == ("not_shown", 0, N)
    assert "Truth is not believable at 400 epochs" in verdict.words


def test_a_truth_that_comes_back_is_one_part(tmp_path: Path) -> None:
    offset = np.zeros(N)
    offset[200:210] = 700.0
    verdict = moved_truth(tmp_path, offset)
    assert (verdict.id, verdict.n_truth) == ("inside", N - 41)


def test_a_truth_that_moves_as_the_positions_do_has_no_doubt(tmp_path: Path) -> None:
    verdict = moved_truth(tmp_path, np.zeros(N))
    assert (verdict.id, verdict.n_truth, verdict.n_truth_doubted, verdict.truth_doubts) == ("inside", N, 0, "")


def test_a_moving_receiver_under_a_standing_truth_is_not_a_false_bound(tmp_path: Path) -> None:
    x, y, z = _ecef(0.85, 0.04, 1000.0)
    verdict = navbound.analyze(table(tmp_path / "a.csv", N), truth=f"{x:.3f},{y:.3f},{z:.3f}").summary.verdict
    assert (verdict.id, verdict.n_truth, verdict.n_truth_doubted) == ("not_shown", 0, N)
    assert "it stands still while the positions travel up to 199" in verdict.words
    assert "truth contradicts the bounds" not in verdict.words


def _ecef(lat: float, lon: float, h_m: float) -> tuple[float, float, float]:
    a, f = 6378137.0, 1 / 298.257223563
    e2 = f * (2 - f)
    n = a / math.sqrt(1 - e2 * math.sin(lat) ** 2)
    return (n + h_m) * math.cos(lat) * math.cos(lon), (n + h_m) * math.cos(lat) * math.sin(lon), (n * (1 - e2) + h_m) * math.sin(lat)


def test_false_positions_of_a_standing_receiver_are_still_false_bounds(tmp_path: Path) -> None:
    """Errors of 60 m at a sigma of 3 m about a fixed point, without a course."""
    x, y, z = _ecef(0.85, 0.04, 1000.0)
    k = np.arange(N)
    error = white(N, 60.0)
    lat, lon = 0.85 + error[:, 1] / M_PER_RAD, 0.04 + error[:, 0] / (M_PER_RAD * math.cos(0.85))
    rows = {"est_lat_rad": lat, "est_lon_rad": lon, "time_ns": START_NS + k * 1_000_000_000}
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, added=rows), truth=f"{x:.3f},{y:.3f},{z:.3f}").summary.verdict
    assert verdict.id == "not_believable"


def test_a_truth_that_freezes_under_way_is_none_from_there_on(tmp_path: Path) -> None:
    lat = 0.85 + 50.0 * np.arange(N) / M_PER_RAD
    truth = {"truth_lat_rad": np.minimum(lat, lat[340]), "truth_lon_rad": np.full(N, 0.04)}
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, error_en_m=white(N), added=truth)).summary.verdict
    assert (verdict.id, verdict.n_truth, verdict.n_truth_doubted) == ("inside", 340, 60)
    assert "it stands still while the positions travel" in verdict.words


def test_a_truth_without_a_character_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time,lat_deg,lon_deg\n2026-11-22T12:00:00Z,49.0,2.5\n")
    with pytest.raises(InputError, match="truth"):
        navbound.analyze(path, truth="", sigma_m=3.0)
