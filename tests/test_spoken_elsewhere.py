"""What another row says of a position counts for it: a second row of its time, a row of a speed alone, one velocity a row."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import navbound
from navbound.run.directory import Run

DEG_PER_M = 1.0 / 111_195.0
SPEED_MPS = 120.0
N = 400


def stand(k: int) -> dict[str, Any]:
    """A position that stands, with a metre of noise."""
    return {"time_s": 1_700_000_000 + k, "lat_deg": 48.0 + (1.3 * (k % 5) - 2.0) * DEG_PER_M, "lon_deg": 2.0, "nac_p": 10}


def judged(path: Path, rows: list[dict[str, Any]], piece_rows: int | None = None) -> Run:
    path.write_text(json.dumps([{"ground_speed_mps": None} | row for row in rows]), encoding="utf-8")
    return navbound.analyze(path, piece_rows=piece_rows)


def n_stale(run: Run) -> int:
    return int((run.epochs["reason_id"] == "position_stale").fill_null(value=False).sum())


def test_the_second_row_of_a_time_states_what_the_first_leaves_empty(tmp_path: Path) -> None:
    spoken = [each for k in range(N) for each in (stand(k), stand(k) | {"ground_speed_mps": SPEED_MPS})]
    assert n_stale(judged(tmp_path / "a.json", spoken)) > 0.9 * N
    against = [each for k in range(N) for each in (stand(k) | {"hpe": None}, stand(k) | {"hpe": 5000.0})]
    assert judged(tmp_path / "b.json", against).summary.verdict.id == "not_shown"
    # Without either nothing speaks against it.
    assert judged(tmp_path / "c.json", [stand(k) for k in range(N)]).summary.verdict.id == "inside"


def test_of_two_speeds_of_one_time_the_larger_counts(tmp_path: Path) -> None:
    both = [stand(k) | {"ground_speed_mps": speed} for k in range(N) for speed in (0.0, SPEED_MPS)]
    assert n_stale(judged(tmp_path / "a.json", both)) > 0.9 * N


def csv(path: Path, every: int) -> Path:
    """Positions each second, and at every so many a row that states the speed alone."""
    lines = ["time_s,lat_deg,lon_deg,nac_p,ground_speed_mps"]
    for k in range(N):
        each = stand(k)
        lines.append(f"{each['time_s']},{each['lat_deg']:.9f},2.0,10,")
        lines += [f"{each['time_s'] + 0.5},,,,{SPEED_MPS}"] * (k % every == 0)
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


@pytest.mark.parametrize("every", [1, 7, 30])
def test_a_row_of_a_speed_alone_is_heard(tmp_path: Path, every: int) -> None:
    path = csv(tmp_path / "a.csv", every)
    whole = navbound.analyze(path)
    assert n_stale(whole) > 0.85 * N
    pieces = navbound.analyze(path, piece_rows=29)
    assert whole.epochs["status"].to_list() == pieces.epochs["status"].to_list()


def led_aside(path: Path, side_mps: float) -> Path:
    """A flight to the north with a second speed to the east; rows of their own state speed and track, each 22 s."""
    lines = ["time_s,lat_deg,lon_deg,nac_p,ground_speed_mps,track_deg"]
    for k in range(N):
        lat, lon = 48.0 + SPEED_MPS * k * DEG_PER_M, 2.0 + side_mps * k * DEG_PER_M / 0.669
        lines.append(f"{1_700_000_000 + k},{lat:.9f},{lon:.9f},10,,")
        lines += [f"{1_700_000_000 + k},,,,{(SPEED_MPS**2 + side_mps**2) ** 0.5},0.0"] * (k % 22 == 0)
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


@pytest.mark.parametrize(("side_mps", "shown"), [(0.0, True), (40.0, False)])
def test_a_row_of_speed_and_track_alone_says_whither(tmp_path: Path, side_mps: float, shown: bool) -> None:
    whole = navbound.analyze(led_aside(tmp_path / "a.csv", side_mps))
    assert whole.summary.verdict.id == ("inside" if shown else "not_shown")
    # The row after it has the direction, and no other: it is soon another one.
    assert whole.epochs["ground_track_rad"].count() == N // 22 + 1
    for piece_rows in (7, 150):
        pieces = navbound.analyze(led_aside(tmp_path / "a.csv", side_mps), piece_rows=piece_rows)
        assert pieces.epochs["ground_track_rad"].equals(whole.epochs["ground_track_rad"], null_equal=True)
        assert pieces.summary.verdict.position_doubts == whole.summary.verdict.position_doubts


@pytest.mark.parametrize(("age_s", "shown"), [(0.3, True), (60.0, False)])
def test_ages_that_few_rows_state_speak_for_the_others(tmp_path: Path, age_s: float, shown: bool) -> None:
    """Each 25th row states an age: that of the others is not known where these are old."""
    moving = [
        stand(0) | {"time_s": 1_700_000_000 + k, "lat_deg": 48.0 + k * SPEED_MPS * DEG_PER_M} | ({} if k % 25 else {"seen_pos": age_s})
        for k in range(N)
    ]
    moving[1]["seen_pos"] = None
    for piece_rows in (None, 50):
        verdict = judged(tmp_path / "a.json", moving, piece_rows).summary.verdict
        assert verdict.id == ("inside" if shown else "not_shown")
        assert any("how old those positions are is not known" in each for each in verdict.position_doubts) != shown


def split(folder: Path, every_s: float, n: int = N) -> Path:
    """One velocity a row, in turn."""
    lines = ["time_s,lat_deg,lon_deg,nac_p,vel_n_mps,vel_e_mps"]
    for k in range(n):
        each = stand(k)
        velocities = ",85.0" if k % 2 else "85.0,"
        lines.append(f"{1_700_000_000 + every_s * k},{each['lat_deg']:.9f},2.0,10,{velocities}")
    path = folder / f"{every_s:g}.csv"
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def test_one_velocity_a_row_is_a_speed(tmp_path: Path) -> None:
    whole = navbound.analyze(split(tmp_path, 1.0))
    assert n_stale(whole) > 0.9 * N
    for n, piece_rows in ((30, 1), (N, 29)):
        whole, pieces = (navbound.analyze(split(tmp_path, 1.0, n), piece_rows=rows) for rows in (None, piece_rows))
        assert whole.epochs.select("status", "ground_speed_mps").equals(pieces.epochs.select("status", "ground_speed_mps"))
    # The other velocity of more than ten seconds ago is none of now.
    assert navbound.analyze(split(tmp_path, 11.0)).epochs["ground_speed_mps"].null_count() == N


@pytest.mark.parametrize(("age_s", "reported"), [(-1.0, 0), (-2.5, N), (-3600.0, N)])
@pytest.mark.parametrize("name", ["seen_pos", "fix_age", "position_age"])
def test_an_age_of_the_future_is_of_another_clock(tmp_path: Path, name: str, age_s: float, reported: int) -> None:
    moving = [stand(0) | {"time_s": 1_700_000_000 + k, "lat_deg": 48.0 + k * SPEED_MPS * DEG_PER_M, name: age_s} for k in range(N)]
    assert (judged(tmp_path / "a.json", moving).epochs["reason_id"] == "reported").sum() == reported


def test_a_column_of_pairs_beside_latitude_and_longitude_is_compared(tmp_path: Path) -> None:
    for off, doubted in ((0.0, False), (1.0, True)):
        lines = ["time_s,lat,lon,Position"]
        lines += [f'{1_700_000_000 + k},{48 + k * 1e-3:.6f},2.0,"{48 + off + k * 1e-3:.6f},2.0"' for k in range(60)]
        path = tmp_path / "a.csv"
        path.write_text("\n".join(lines) + "\n", encoding="ascii")
        doubts = navbound.analyze(path, sigma_m=5.0).summary.verdict.position_doubts
        assert any("two columns of one quantity" in each for each in doubts) == doubted
