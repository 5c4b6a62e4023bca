"""A speed whose column states no unit is read in the unit in which it is the speed of the positions, or contradicts them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

import navbound
from navbound.read.beside import speed_unit

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.run.directory import Run

N = 400
MPS = {"mps": 1.0, "kt": 1852 / 3600, "km/h": 1 / 3.6, "mph": 0.44704}


def analysed(tmp_path: Path, name: str, speed: list[float], mps: list[float], *, track_deg: float | None = None, **how: object) -> Run:
    """A flight to the north at `mps`, whose column `name` states `speed`."""
    beside = "" if track_deg is None else ",track_true"
    rows, lat = [f"time,lat,lon,{name}{beside}"], 48.0
    for k, (stated, moved) in enumerate(zip(speed, mps, strict=True)):
        value = "" if track_deg is None else f",{track_deg}"
        rows.append(f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z,{lat:.8f},2.5,{stated:.2f}{value}")
        lat += moved / 111_195.0
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    return navbound.analyze(tmp_path / "a.csv", sigma_m=5.0, out=tmp_path / "run", **how)  # type: ignore[arg-type]


@pytest.mark.parametrize("unit", MPS)
@pytest.mark.parametrize("name", ["speed", "velocity", "gnd_spd", "Speed Over Ground", "hspeed"])
def test_the_unit_is_that_of_the_positions(tmp_path: Path, name: str, unit: str) -> None:
    run = analysed(tmp_path, name, [120.0 / MPS[unit]] * N, [120.0] * N)
    assert run.summary.verdict.id == "inside"
    assert run.epochs["ground_speed_mps"].to_list() == pytest.approx([120.0] * N, rel=1e-4)
    (words,) = [each for each in run.summary.assumptions if "states no unit" in each]
    assert f"is read in {unit}, in which it is the speed of the positions on 40 of 40 ways" in words


def test_a_speed_that_is_that_of_the_positions_in_no_unit_shows_nothing(tmp_path: Path) -> None:
    """60 m/s by the positions; 90 by the column is 60 in no unit."""
    run = analysed(tmp_path, "speed", [90.0] * N, [60.0] * N)
    assert run.summary.verdict.id == "not_shown"
    assert "“speed” states no unit, and is the speed of the positions in none of mps, kt, km/h, mph" in run.summary.verdict.words
    left_out = analysed(tmp_path, "speed", [90.0] * N, [60.0] * N, columns={"ground_speed_mps": "-"})
    assert left_out.summary.verdict.id == "inside"


def test_positions_that_fall_behind_their_speed_are_seen(tmp_path: Path) -> None:
    """At half of the speed for the last 150 s: 9 km behind."""
    run = analysed(tmp_path, "speed", [120.0] * N, [120.0] * 250 + [60.0] * 150)
    assert run.summary.verdict.id == "not_shown"


def test_a_track_under_another_name_is_compared(tmp_path: Path) -> None:
    assert analysed(tmp_path, "speed_mps", [120.0] * N, [120.0] * N, track_deg=0.0).summary.verdict.id == "inside"
    aside = analysed(tmp_path, "speed_mps", [120.0] * N, [120.0] * N, track_deg=37.0)
    assert aside.summary.verdict.id == "not_shown"


@pytest.mark.parametrize("speed", [60.0, 120.0, 250.0])
@pytest.mark.parametrize("mps", [0.0, 3.0])
def test_a_speed_beside_positions_that_stand_or_creep_shows_nothing(tmp_path: Path, speed: float, mps: float) -> None:
    """In the smallest of the units 60 are 17 m/s."""
    run = analysed(tmp_path, "speed", [speed] * N, [mps + 0.1 * (-1) ** k for k in range(N)])
    assert run.summary.verdict.id == "not_shown"


def test_a_few_rows_decide_too(tmp_path: Path) -> None:
    assert analysed(tmp_path, "speed", [75.0] * 13, [150.0] * 13).summary.verdict.position_doubts
    assert not analysed(tmp_path, "speed", [150.0] * 13, [150.0] * 13).summary.verdict.position_doubts


@pytest.mark.parametrize(("kt", "shown"), [(233.3, True), (450.0, False)])
def test_a_number_with_its_unit_is_read(tmp_path: Path, kt: float, shown: bool) -> None:
    analysed(tmp_path, "speed", [kt] * N, [120.0] * N)
    path = tmp_path / "a.csv"
    path.write_text(path.read_text().replace(f",{kt:.2f}\n", f",{kt:.1f} kt\n"))
    assert (navbound.analyze(path, sigma_m=5.0).summary.verdict.id == "inside") == shown


def test_a_column_of_zeros_states_nothing(tmp_path: Path) -> None:
    assert analysed(tmp_path, "speed", [0.0] * N, [120.0] * N).summary.verdict.id == "inside"


def test_a_vehicle_that_hardly_moves_decides_nothing(tmp_path: Path) -> None:
    run = analysed(tmp_path, "speed", [5.0] * N, [1.5] * N)
    assert run.summary.verdict.id == "inside"
    assert "ground_speed_mps" not in run.epochs.columns
    assert any("columns not used: speed" in each for each in run.summary.assumptions)


@pytest.mark.parametrize("piece_rows", [20, 77, 250])
def test_pieces_of_any_length_decide_the_same(tmp_path: Path, piece_rows: int) -> None:
    from navbound.read.pieces.reading import read_pieces  # noqa: PLC0415

    moved = [120.0 + 10.0 * math.sin(0.02 * k) for k in range(N)]
    whole = analysed(tmp_path, "speed", [each / MPS["kt"] for each in moved], moved)
    reading = read_pieces(tmp_path / "a.csv", columns=None, piece_rows=piece_rows)
    speeds = [each for piece in reading.epochs() for each in piece["ground_speed_mps"].to_list()]
    reading.pieces.close()
    assert speeds == whole.epochs["ground_speed_mps"].to_list()


def test_a_recording_that_begins_at_the_gate_is_decided_by_what_moves(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """More rows of taxiing than decide, and then half of the speed, or none of it."""
    monkeypatch.setattr(speed_unit, "HEAD_ROWS", 100)
    speed = [6.0] * 150 + [120.0] * 250
    assert analysed(tmp_path, "speed", speed, speed).summary.verdict.id == "inside"
    for mps in (66.0, 0.0):
        slow = [6.0] * 150 + [120.0] * 50 + [mps + 0.1 * (-1) ** k for k in range(200)]
        assert analysed(tmp_path, "speed", speed, slow).summary.verdict.id == "not_shown", mps


def test_positions_of_a_slow_vehicle_that_stand_beside_its_speed_show_nothing(tmp_path: Path) -> None:
    assert analysed(tmp_path, "speed", [12.0] * N, [0.1 * (-1) ** k for k in range(N)]).summary.verdict.id == "not_shown"
    assert analysed(tmp_path, "speed", [12.0] * N, [12.0] * N).summary.verdict.id == "inside"


def circuit(tmp_path: Path, radius_m: float, mps: float, stated: float) -> Run:
    """Laps of a circle, four rows a second, with a column `speed`."""
    rows = ["time,lat,lon,speed"]
    for k in range(4 * 120):
        turned = mps * 0.25 * k / radius_m
        lat, lon = (
            48.0 + radius_m * math.sin(turned) / 111_195.0,
            2.5 + radius_m * math.cos(turned) / 111_195.0 / math.cos(math.radians(48.0)),
        )
        rows.append(f"{1_700_000_000 + 0.25 * k:.2f},{lat:.8f},{lon:.8f},{stated:.2f}")
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    return navbound.analyze(tmp_path / "a.csv", sigma_m=5.0)


def test_laps_are_as_long_as_their_way_and_not_their_chords(tmp_path: Path) -> None:
    """At 30 m/s round 120 m a chord of 10 s is 0.76 of its way."""
    run = circuit(tmp_path, 120.0, 30.0, 30.0)
    assert run.summary.verdict.id == "inside"
    assert run.epochs["ground_speed_mps"].to_list() == pytest.approx([30.0] * 480, rel=1e-4)


def test_laps_hide_no_speed_of_another_unit(tmp_path: Path) -> None:
    assert circuit(tmp_path, 120.0, 30.0, 30.0 / MPS["kt"]).epochs["ground_speed_mps"].to_list() == pytest.approx([30.0] * 480, rel=1e-3)
    assert circuit(tmp_path, 120.0, 30.0, 36.0).summary.verdict.id == "not_shown"


def test_two_ways_find_no_unit_and_doubt_nothing(tmp_path: Path) -> None:
    run = analysed(tmp_path, "speed", [3.0] * 200 + [90.0] * 15 + [3.0] * 185, [3.0] * 200 + [60.0] * 15 + [3.0] * 185)
    assert run.summary.verdict.id == "inside"
    assert "ground_speed_mps" not in run.epochs.columns
    assert any("too few to find it: it is not read" in each for each in run.summary.assumptions)


@pytest.mark.parametrize("field", ["{:.3f} km/h", "{:.3f}KM/H"])
def test_a_unit_in_each_field_needs_no_ways(tmp_path: Path, field: str) -> None:
    """A boat at anchor and under way, slower than what decides a unit; heights have theirs behind them as well."""
    rows, lat = ["time,lat,lon,HEIGHT,SPEED"], 48.0
    for k in range(120):
        mps = 0.0 if k < 60 else 3.0
        rows.append(f"{1_700_000_000 + k},{lat:.8f},2.5,513.863 M,{field.format(3.6 * mps)}")
        lat += mps / 111_195.0
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    run = navbound.analyze(tmp_path / "a.csv", sigma_m=5.0)
    assert run.summary.verdict.id == "inside"
    assert run.epochs["ground_speed_mps"].to_list() == pytest.approx([0.0] * 60 + [3.0] * 60)
    assert run.epochs["est_h_m"].to_list() == pytest.approx([513.863] * 120)
