"""Numbers of a speed that are no speed: taken as not stated, counted, and no way to hide what a speed contradicts."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import navbound
from navbound import _core, live
from navbound.errors import FormatError
from navbound.live.settings import Settings
from navbound.live.sinks import tables
from navbound.read.pieces import read_pieces
from navbound.read.tables.epochs import read
from navbound.run.directory import Run

N, SPEED_MPS, DEG_PER_M = 300, 80.0, 1 / 111_195


def flight(tmp_path: Path, speed: Callable[[int], object], name: str = "speed_mps", lat: Callable[[int], float] | None = None) -> Path:
    """Straight to the north, by a stated track and speed, a row a second."""
    north = lat or (lambda k: 48.0 + k * SPEED_MPS * DEG_PER_M)
    rows = [f"{1_700_000_000 + k},3c6444,{north(k):.7f},2.0,{speed(k)},0,9,8,3" for k in range(N)]
    (tmp_path / "flight.csv").write_text("\n".join([f"time,icao24,lat,lon,{name},track_deg,nac_p,nic,sil", *rows]) + "\n")
    return tmp_path / "flight.csv"


def analyzed(*args: object) -> Run:
    return navbound.analyze(flight(*args), spec="RNP 0.3")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "usual", "number"),
    [
        ("speed_mps", 80.0, 9999),
        ("gs", 155.5, 9999),
        ("gs", 155.5, 1023),
        ("gs", 155.5, 999),
        ("speed", 80.0, 9999),
        ("speed_mps", 80.0, 655.35),
        ("speed_mps", 80.0, -1),
        ("gs", 155.5, -1),
        ("speed", 80.0, -1),
    ],
)
@pytest.mark.parametrize("at", [lambda k: k % 20 == 3, lambda k: 100 <= k < 140], ids=["now and then", "together"])
def test_a_number_that_is_no_speed_is_not_stated(tmp_path: Path, name: str, usual: float, number: int, at: Callable[[int], bool]) -> None:
    run = analyzed(tmp_path, lambda k: number if at(k) else usual, name)
    assert run.summary.verdict.id == "inside"
    (rejected,) = run.summary.rejected
    assert (rejected.reason, rejected.count, rejected.example) == (
        f"{name}: no speed that an aircraft has; taken as not stated",
        sum(map(at, range(N))),
        str(number),
    )


def test_a_few_rows_of_rubbish_harm_no_others(tmp_path: Path) -> None:
    assert analyzed(tmp_path, lambda k: (1100 + 777 * k) if k % 25 == 4 else SPEED_MPS).summary.verdict.id == "inside"


@pytest.mark.parametrize("number", [399, 700, 998, 1000])
def test_another_large_number_is_a_speed_that_contradicts(tmp_path: Path, number: int) -> None:
    assert analyzed(tmp_path, lambda k: number if k % 20 == 3 else SPEED_MPS).summary.verdict.id == "not_shown"


def test_nines_within_what_aircraft_fly_are_a_speed(tmp_path: Path) -> None:
    """999 km/h is 277 m/s."""
    run = analyzed(tmp_path, lambda k: 999 if k % 4 == 3 else 3.6 * SPEED_MPS, "speed_kmh")
    assert (run.summary.verdict.id, run.summary.rejected) == ("not_shown", [])


def test_a_column_of_which_much_is_no_speed_leaves_nothing_shown(tmp_path: Path) -> None:
    run = analyzed(tmp_path, lambda k: 9999 if k % 4 == 3 else SPEED_MPS)
    assert run.summary.verdict.id == "not_shown"
    assert "75 of 300 numbers of “speed_mps” are no speed that an aircraft has" in " ".join(run.summary.verdict.position_doubts)


@pytest.mark.parametrize("name", ["speed_mps", "speed"])
def test_what_is_below_any_length_is_not_stated_however_often(tmp_path: Path, name: str) -> None:
    """-1 is written where an empty field could stand, and says nothing of the unit of the others."""
    run = analyzed(tmp_path, lambda k: -1 if k % 3 == 0 else SPEED_MPS, name)
    assert run.summary.verdict.id == "inside"
    assert [(each.count, each.example) for each in run.summary.rejected] == [(100, "-1")]


def test_other_numbers_below_zero_are_malformed(tmp_path: Path) -> None:
    with pytest.raises(FormatError):
        analyzed(tmp_path, lambda k: -80 if k % 3 == 0 else SPEED_MPS)


@pytest.mark.parametrize("number", [1023.0, -1.0, 655.35, 999.9, 9999.0])
def test_live_takes_the_same_numbers_as_not_stated(tmp_path: Path, number: float) -> None:
    record = {"v": 1, "track": "A", "est_lon_rad": 0.03, "sigma_m": 5.0}
    lines = [
        record
        | {
            "time_ns": 1_317_644_000_000_000_000 + k * 1_000_000_000,
            "est_lat_rad": 0.7 + k * SPEED_MPS / 6_371_000,
            "ground_speed_mps": number if k % 20 == 3 else SPEED_MPS,
        }
        for k in range(N)
    ]
    session = live.Session(tmp_path / "out", Settings(format="json", rnp_m=555.6))
    session.take(_core.live_input("chunk", None, b"".join(json.dumps(each).encode() + b"\n" for each in lines)))
    session.finish()
    assert set(tables.epochs(tmp_path / "out")["reason_id"]) == {None}


@pytest.mark.parametrize("at", [lambda k: 100 <= k < 150, lambda k: k % 20 == 3], ids=["together", "now and then"])
def test_a_hold_is_not_hidden_by_numbers_that_are_no_speeds(tmp_path: Path, at: Callable[[int], bool]) -> None:
    """The positions stand for 50 s, and go on from where the aircraft is."""
    frozen = lambda k: 48.0 + (100 if 100 <= k < 150 else k) * SPEED_MPS * DEG_PER_M  # noqa: E731
    assert analyzed(tmp_path, lambda k: 9999 if at(k) else SPEED_MPS, "speed_mps", frozen).summary.verdict.id != "inside"


def test_positions_that_the_other_speeds_contradict_are_not_shown(tmp_path: Path) -> None:
    slow = lambda k: 48.0 + k * 0.5 * SPEED_MPS * DEG_PER_M  # noqa: E731
    assert analyzed(tmp_path, lambda k: 9999 if k % 20 == 3 else SPEED_MPS, "speed_mps", slow).summary.verdict.id != "inside"


@pytest.mark.parametrize("piece_rows", [1, 50])
@pytest.mark.parametrize("name", ["speed_mps", "speed"])
def test_pieces_find_the_same(tmp_path: Path, piece_rows: int, name: str) -> None:
    path = flight(tmp_path, lambda k: 9999 if k % 4 == 3 else SPEED_MPS, name)
    pieces, whole = read_pieces(path, piece_rows=piece_rows), read(path)
    n_known = sum(piece["ground_speed_mps"].count() for piece in pieces.epochs())
    assert n_known == whole.epochs["ground_speed_mps"].count()
    assert pieces.position_doubts == whole.position_doubts != []
    assert pieces.rejected == whole.rejected
