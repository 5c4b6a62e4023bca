"""Positions that do not travel as the recording's own speeds say show nothing."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import navbound
from navbound.read.motion.speeds import Speeds, speeds_of

N = 400
M_PER_DEG = math.radians(1.0) * 6_371_000.0


def table(path: Path, moved_mps: float, stated: np.ndarray | float, unit: str = "mps", *, sigma_m: float = 2.0) -> Path:
    """A flight northwards at one speed, with white noise of the stated covariance."""
    noise = np.random.default_rng(1).normal(0.0, sigma_m, N)
    column = {"mps": "speed_mps", "kt": "ground_speed_kt"}[unit]
    rows = [f"time,lat_deg,lon_deg,h_m,cov_ee_m2,cov_en_m2,cov_nn_m2,{column}"]
    speeds = np.broadcast_to(stated, N)
    for k in range(N):
        lat = 49.0 + (moved_mps * k + noise[k]) / M_PER_DEG
        rows.append(f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z,{lat:.8f},2.5,100.0,{sigma_m**2},0.0,{sigma_m**2},{speeds[k]}")
    path.write_text("\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize(
    ("moved", "stated", "unit", "word"),
    [
        (11.0, 0.0, "mps", "further"),
        (80.0, 40.0, "mps", "further"),
        (31.0, 60.0, "mps", "less far"),
        (80.0, 80.0, "mps", ""),
        (80.0, 80.0 / 0.514444, "kt", ""),
        (80.0, 80.0 / 0.514444, "mps", "less far"),
        (2.0, 0.0, "mps", ""),
    ],
)
def test_a_way_that_the_stated_speeds_cannot_explain_is_a_doubt(tmp_path: Path, moved: float, stated: float, unit: str, word: str) -> None:
    verdict = navbound.analyze(table(tmp_path / "a.csv", moved, stated, unit)).summary.verdict
    assert (verdict.id, bool(verdict.position_doubts)) == (("not_shown", True) if word else ("inside", False))
    assert word in " ".join(verdict.position_doubts)


def test_rows_of_a_stand_are_stale_and_no_doubt(tmp_path: Path) -> None:
    """At less than half of the way the positions are stale."""
    verdict = navbound.analyze(table(tmp_path / "a.csv", 1.0, 60.0)).summary.verdict
    assert (verdict.id, verdict.position_doubts) == ("not_shown", [])
    assert verdict.n_reason["position_stale"] > 0.9 * verdict.n_epochs


def test_noise_of_the_stated_size_is_no_way(tmp_path: Path) -> None:
    assert navbound.analyze(table(tmp_path / "a.csv", 0.0, 0.0, sigma_m=60.0)).summary.verdict.position_doubts == []


def test_two_minutes_that_contradict_are_no_doubt_yet(tmp_path: Path) -> None:
    stated = np.full(N, 80.0)
    stated[60:180] = 0.0
    assert navbound.analyze(table(tmp_path / "a.csv", 80.0, stated)).summary.verdict.position_doubts == []


@pytest.mark.parametrize("rows", [1, 7, 59, 61, 1000])
def test_pieces_of_any_length_give_the_same_words(tmp_path: Path, rows: int) -> None:
    epochs = navbound.analyze(table(tmp_path / "a.csv", 11.0, 0.0)).epochs
    speeds = Speeds()
    for begin in range(0, epochs.height, rows):
        speeds.see(epochs[begin : begin + rows])
    assert speeds.scatter() == speeds_of(epochs).scatter() is not None
    assert speeds.doubts() == speeds_of(epochs).doubts() != []


def behind(path: Path, moved_mps: float, *, stands_each: int = 0, turning: bool = False, left_out: bool = False) -> Path:
    """A flight of an hour at 200 m/s, to the north or in turns of a minute to the north and the south; a second is held now and then."""
    rows, (lat, lon) = ["time,lat_deg,lon_deg,sigma_e_m,sigma_n_m,speed_mps"], (40.0, 2.5)
    for k in range(3600):
        holds = stands_each > 0 and k % stands_each == stands_each - 1
        course = math.radians(3.0 * (k % 120)) if turning else 0.0
        if not holds:
            lat += moved_mps * math.cos(course) / M_PER_DEG
            lon += moved_mps * math.sin(course) / (M_PER_DEG * math.cos(math.radians(lat)))
        if not (holds and left_out):
            rows.append(f"2026-11-22T{12 + k // 3600:02d}:{k // 60 % 60:02d}:{k % 60:02d}Z,{lat:.8f},{lon:.8f},10,10,200")
    path.write_text("\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize("left_out", [False, True])
def test_holds_that_are_never_made_good_add_up(tmp_path: Path, left_out: bool) -> None:
    """One second in 26 is 27.7 km in an hour, each time within what a position may be late."""
    verdict = navbound.analyze(behind(tmp_path / "a.csv", 200.0, stands_each=26, left_out=left_out)).summary.verdict
    assert verdict.id == "not_shown"
    (doubt,) = verdict.position_doubts
    lacks_m = float(doubt.partition("speeds by ")[2].partition(" m")[0])
    # Steps over the ends of windows of a minute are none's.
    assert lacks_m == pytest.approx(3600 / 26 * 200.0, rel=0.05)


@pytest.mark.parametrize(
    ("moved_mps", "turning", "shown"), [(160.0, False, False), (194.0, False, False), (198.0, False, True), (199.5, True, True)]
)
def test_a_track_that_falls_behind_its_own_speed_shows_nothing(tmp_path: Path, moved_mps: float, turning: bool, shown: bool) -> None:
    """144, 21.6, 7.2 and 1.8 km in an hour, of 720: shown are 5 km and a fiftieth of the way."""
    verdict = navbound.analyze(behind(tmp_path / "a.csv", moved_mps, turning=turning)).summary.verdict
    assert (verdict.id, not verdict.position_doubts) == (("inside", True) if shown else ("not_shown", False))


@pytest.mark.parametrize("rows", [1, 61, 1000])
def test_pieces_of_any_length_fall_behind_alike(tmp_path: Path, rows: int) -> None:
    epochs = navbound.analyze(behind(tmp_path / "a.csv", 190.0)).epochs.head(2000)
    speeds = Speeds()
    for begin in range(0, epochs.height, rows):
        speeds.see(epochs[begin : begin + rows])
    assert speeds.doubts() == speeds_of(epochs).doubts() != []


def late(path: Path, age_s: float, sigma_m: float) -> Path:
    """A flight northwards at 100 m/s, a row each ten seconds, whose positions are older than their rows by any time up to an age."""
    ages = np.random.default_rng(5).uniform(0.0, age_s, 200)
    rows = ["time,lat_deg,lon_deg,sigma_e_m,sigma_n_m,speed_mps"]
    for k in range(200):
        lat = 49.0 + 100.0 * (10 * k - ages[k]) / M_PER_DEG
        rows.append(f"2026-11-22T12:{k // 6:02d}:{10 * (k % 6):02d}Z,{lat:.8f},2.5,{sigma_m},{sigma_m},100")
    path.write_text("\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize(
    ("age_s", "sigma_m", "spec", "shown"),
    [
        # Up to 500 m late: 95 % of the steps leave 390 m (a triangle of 500 m), of which turns and rounding hide 30 m and noise 28 m.
        (5.0, 10.0, "RNP 0.1", False),
        (5.0, 10.0, "RNP 0.3", True),
        (0.5, 10.0, "RNP 0.1", True),
        # The covariance holds it.
        (2.0, 60.0, "RNP 0.1", True),
    ],
)
def test_positions_that_scatter_along_their_way_by_more_than_the_margin_show_nothing(
    tmp_path: Path, age_s: float, sigma_m: float, spec: str, shown: bool
) -> None:
    verdict = navbound.analyze(late(tmp_path / "a.csv", age_s, sigma_m), spec=spec).summary.verdict
    assert verdict.id == ("inside" if shown else "not_shown")
    if not shown:
        # 332 m, over the root of two, by bins of 6 %.
        along_m = float(verdict.position_doubts[0].split(" by ")[1].split(" m ")[0])
        assert 0.9 * 332.0 / math.sqrt(2.0) < along_m < 1.1 * 332.0 / math.sqrt(2.0)


def stand(path: Path, seconds: int, column: str, stated: float) -> Path:
    """Noise of the stated size about one place."""
    noise = np.random.default_rng(3).normal(0.0, 8.0, (seconds, 2)) / M_PER_DEG
    rows = [
        f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z,{49 + noise[k, 0]:.8f},{noise[k, 1]:.8f},8,8,{stated}"
        for k in range(11, 11 + seconds - 11)
    ]
    path.write_text("\n".join([f"time,lat_deg,lon_deg,sigma_e_m,sigma_n_m,{column}", *rows]) + "\n")
    return path


@pytest.mark.parametrize(
    ("seconds", "column", "stated"),
    [
        (600, "speed_mps", 14.0),
        (600, "ground_speed_kt", 28.0),
        (600, "speed_kmh", 100.0),
        (170, "speed_mps", 14.0),
        (110, "speed_mps", 14.0),
    ],
)
def test_a_stand_with_noise_while_the_recording_states_a_speed_shows_nothing(
    tmp_path: Path, seconds: int, column: str, stated: float
) -> None:
    """The noise of each second adds up to ten metres a second of way, and is none."""
    verdict = navbound.analyze(stand(tmp_path / "a.csv", seconds, column, stated)).summary.verdict
    assert verdict.id == "not_shown"
    assert "less far" in " ".join(verdict.position_doubts)


def test_positions_that_repeat_now_and_then_do_not_hide_their_minute(tmp_path: Path) -> None:
    """Ten minutes of a stand with noise at a stated speed, written to a ten-thousandth of a degree: some are the same as the one before."""
    path = stand(tmp_path / "a.csv", 600, "ground_speed_kt", 40.0)
    head, *rows = path.read_text().splitlines()
    coarse = [",".join([row.split(",")[0], *(f"{float(x):.4f}" for x in row.split(",")[1:3]), *row.split(",")[3:]]) for row in rows]
    path.write_text("\n".join([head, *coarse]) + "\n")
    verdict = navbound.analyze(path).summary.verdict
    assert verdict.n_reason["position_held"] > 5
    assert verdict.id == "not_shown"
    assert "less far" in " ".join(verdict.position_doubts)


def test_turns_of_an_aircraft_are_no_shorter_way(tmp_path: Path) -> None:
    """A holding pattern and a circle at three degrees a second, twice the usual rate of a light aircraft's steep turn."""
    rows = ["time,lat_deg,lon_deg,sigma_e_m,sigma_n_m,speed_mps"]
    for k in range(600):
        angle = math.radians(6.0 * k)
        radius = 60.0 / math.radians(6.0)
        lat, lon = radius * math.sin(angle) / M_PER_DEG, radius * math.cos(angle) / M_PER_DEG
        rows.append(f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z,{lat:.8f},{lon:.8f},2,2,60")
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    assert navbound.analyze(tmp_path / "a.csv").summary.verdict.position_doubts == []


@pytest.mark.parametrize(("led_mps", "ahead"), [(80.0, True), (30.0, True), (5.0, False)])
def test_a_lead_of_a_minute_is_seen_without_a_track_column(tmp_path: Path, led_mps: float, ahead: bool) -> None:
    """124 m/s by its word: 30 t > 9.2 t + 1340 m after 65 s; 5 m/s are within the 9.2 m/s that nothing shows."""
    file = tmp_path / "a.csv"
    rows = ["time,lat_deg,lon_deg,h_m,cov_ee_m2,cov_en_m2,cov_nn_m2,speed_mps"]
    for k in range(N):
        lat = 49.0 + (124.0 * k + led_mps * min(max(k - 100, 0), 100)) / M_PER_DEG
        rows.append(f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z,{lat:.8f},2.5,100.0,4.0,0.0,4.0,124.0")
    file.write_text("\n".join(rows) + "\n")
    run = navbound.analyze(file)
    assert bool(run.summary.verdict.n_reason.get("position_ahead", 0)) == ahead
    assert (run.summary.verdict.id == "inside") == (not ahead)
    marked = (run.epochs["reason_id"] == "position_ahead").fill_null(value=False)
    # None before the lead, and none more than the 128 s that a place is remembered after it.
    assert not marked[:100].any()
    assert not marked[330:].any()
    assert ("further on than the speeds reported" in " ".join(run.summary.assumptions)) == ahead
