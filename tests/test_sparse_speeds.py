"""A speed that changed between two sparse reports is a speed, and no reason for a jump."""

from __future__ import annotations

from pathlib import Path

import pytest

import navbound

DEG_PER_M = 1.0 / 111_195.0


def judged(path: Path, reports: list[tuple[float, float, float]]) -> list[str | None]:
    """Reasons of a flight to the north: time [s], speed [m/s] and way [m] of each report."""
    lines = ["time_s,lat_deg,lon_deg,ground_speed_mps"]
    lines += [f"{1_700_000_000 + time_s},{48 + way_m * DEG_PER_M:.8f},2.0,{speed}" for time_s, speed, way_m in reports]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return navbound.analyze(path, sigma_m=10.0).epochs["reason_id"].to_list()


@pytest.mark.parametrize(("first_mps", "second_mps", "gap_s", "mean_mps"), [(226, 84, 923, 157), (136, 8, 913, 36), (197, 6, 1149, 105)])
def test_an_aircraft_that_slows_in_a_gap_does_not_jump(
    tmp_path: Path, first_mps: float, second_mps: float, gap_s: float, mean_mps: float
) -> None:
    assert judged(tmp_path / "a.csv", [(0, first_mps, 0), (gap_s, second_mps, mean_mps * gap_s)]) == [None, None]
    # Faster than either of the two allows it is one.
    off_m = (1.25 * first_mps + 60) * (gap_s + 10)
    assert judged(tmp_path / "b.csv", [(0, first_mps, 0), (gap_s, second_mps, off_m)])[1] == "position_jump"


def test_a_wild_speed_among_dense_ones_is_not_believed(tmp_path: Path) -> None:
    """At 80 m/s one row states 300 and is 3 km further on, where 1.25 times 80 and 25 m/s allow 1.5 km in 11 s and 100 m."""
    dense = [(float(k), 300.0 if k == 10 else 80.0, 80.0 * k + (3000.0 if k >= 10 else 0.0)) for k in range(20)]
    assert judged(tmp_path / "a.csv", dense)[10] == "position_jump"


def test_a_sparse_flight_is_plausible(tmp_path: Path) -> None:
    speeds = [80.0, 160.0, 226.0, 240.0, 240.0, 200.0, 150.0, 80.0]
    way = 0.0
    reports = [(0.0, speeds[0], 0.0)]
    for k in range(1, len(speeds)):
        way += 300.0 * (speeds[k - 1] + speeds[k]) / 2
        reports.append((300.0 * k, speeds[k], way))
    assert judged(tmp_path / "a.csv", reports) == [None] * len(speeds)
