"""Recordings that must not be called inside: what is missing, doubted or contradicted counts against the verdict."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl
import pytest

from navbound import status
from navbound.run import analyze
from navbound.run.directory import Run
from navbound.run.judge import judge

N = 600
START_S = 1_600_000_000.0
RNP_M = 0.3 * 1852.0


def columns(**changed: object) -> dict[str, object]:
    """70 m/s along the meridian of 2 degrees east, with a stated standard deviation of 5 m."""
    k = np.arange(N)
    flown: dict[str, object] = {
        "time": START_S + k,
        "lat": 48.0 + 70.0 / 111_200.0 * k,
        "lon": np.full(N, 2.0),
        "sde": np.full(N, 5.0),
        "sdn": np.full(N, 5.0),
    }
    return flown | changed


def run(folder: Path, **changed: object) -> Run:
    table, route = folder / "track.csv", folder / "route.csv"
    pl.DataFrame(columns(**changed)).write_csv(table)
    route.write_text("name,lat_deg,lon_deg\nA,47.9,2.0\nB,49.0,2.0\n")
    return judge(analyze.material(table, requirement="RNP 0.3", rnp_m=RNP_M, path=route))


def test_the_track_itself_is_inside(tmp_path: Path) -> None:
    verdict = run(tmp_path).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_judged) == ("inside", N, N)


@pytest.mark.parametrize("name", ["lat", "time"])
def test_rows_without_a_position_or_a_time_are_expected_and_not_judged(tmp_path: Path, name: str) -> None:
    values = [float(v) if k < 60 else None for k, v in enumerate(columns()[name])]  # type: ignore[call-overload]
    verdict = run(tmp_path, **{name: values}).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_judged, verdict.n_missing) == ("not_shown", N, 60, N - 60)


def test_a_row_without_a_position_inside_a_gap_counts_once(tmp_path: Path) -> None:
    lat = [None if 100 <= k < 200 else float(v) for k, v in enumerate(columns()["lat"])]  # type: ignore[call-overload]
    verdict = run(tmp_path, lat=lat).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_missing) == ("not_shown", N, 100)


def test_two_positions_at_one_time_contradict_each_other(tmp_path: Path) -> None:
    # Every time twice, 7.5 km apart.
    result = run(tmp_path, time=np.repeat(START_S + np.arange(N // 2), 2), lon=np.where(np.arange(N) % 2, 2.1, 2.0))
    verdict = result.summary.verdict
    assert (verdict.inside, verdict.n_judged, verdict.n_epochs, verdict.n_implausible) == (None, 0, N, N // 2)
    assert result.epochs["status"].unique().to_list() == ["invalid_input"]
    assert result.epochs["reason_id"].unique().to_list() == ["position_jump"]


def test_identical_repeats_are_left_out_and_do_no_harm(tmp_path: Path) -> None:
    twice = {name: np.repeat(values, 2) for name, values in columns().items()}  # type: ignore[call-overload]
    result = run(tmp_path, **twice)
    assert (result.summary.verdict.id, result.summary.verdict.n_epochs) == ("inside", N)
    assert [(r.reason, r.count) for r in result.summary.rejected] == [("time repeated within a track", N)]


def test_a_clock_that_stands_still_is_not_shown_to_be_inside(tmp_path: Path) -> None:
    time = START_S + np.minimum(np.arange(N), 99)
    verdict = run(tmp_path, time=time).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_judged, verdict.n_missing) == ("not_shown", N, 99, N - 100)


@pytest.mark.parametrize(
    ("written", "becomes", "reason_id"),
    [
        ("degraded", "degraded", "reported"),
        ("not_available", "not_available", "reported"),
        (" Invalid_Input", "invalid_input", "reported"),
        ("bad", "not_available", "reported"),
        ("", "not_available", "reported"),
    ],
)
def test_a_recorded_status_is_not_ignored(tmp_path: Path, written: str, becomes: str, reason_id: str) -> None:
    result = run(tmp_path, status=np.where(np.arange(N) < 60, "ok", written))
    assert result.summary.verdict.id == "not_shown"
    assert result.summary.verdict.n_judged == 60
    later = result.epochs[60:]
    assert set(later["status"]) == {becomes}
    assert set(later["reason_id"]) == {reason_id}


@pytest.mark.parametrize(
    ("written", "becomes"), [("position_stale", "not_available"), ("kept_by_dme", "degraded"), ("no such", "not_available")]
)
def test_a_recorded_reason_outweighs_a_better_status(tmp_path: Path, written: str, becomes: str) -> None:
    result = run(tmp_path, status=["ok"] * N, reason_id=[None if k < 60 else written for k in range(N)])
    assert result.summary.verdict.id == "not_shown"
    assert set(result.epochs[60:]["status"]) == {becomes}
    assert set(result.epochs[60:]["reason_id"]) == {written if written in status.REASONS else "reported"}


def test_the_graver_of_the_recorded_status_and_ours_stands(tmp_path: Path) -> None:
    # Held for a second at 70 m/s: degraded by our rule, not available by the file's.
    lat = np.array(columns()["lat"])
    lat[301] = lat[300]
    said = ["not_available" if k == 301 else "ok" for k in range(N)]
    result = run(tmp_path, lat=lat, speed_mps=np.full(N, 70.0), status=said)
    assert result.epochs["status"][301] == "not_available"
    without = run(tmp_path, lat=lat, speed_mps=np.full(N, 70.0))
    assert without.epochs["status"][301] == "degraded"


@pytest.mark.parametrize("name", ["hpl", "hpl_m"])
def test_a_recorded_protection_level_is_compared_with_twice_rnp(tmp_path: Path, name: str) -> None:
    verdict = run(tmp_path, **{name: np.full(N, 3000.0)}).summary.verdict
    assert (verdict.id, verdict.n_outside, verdict.share_contained) == ("outside", N, 0.0)
    small = run(tmp_path, **{name: np.full(N, 100.0)})
    assert small.summary.verdict.id == "inside"
    assert small.epochs["integrity_compared_m"].min() >= 100.0  # type: ignore[operator]


def test_columns_that_nobody_reads_are_named(tmp_path: Path) -> None:
    result = run(tmp_path, wind_mps=np.zeros(N))
    assert any("columns not used: wind_mps" in words for words in result.summary.assumptions)
