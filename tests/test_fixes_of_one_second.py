"""Stamps that are whole seconds: two fixes of one second share a stamp, and are no two places of one time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import polars as pl
import pytest

import navbound
from navbound.read.pieces import Beside, read_pieces
from navbound.read.tables.epochs import Reading, read, read_beside
from test_who_and_when import DEG_PER_M, SPEED_MPS

START_S, N, AT = 1_700_000_000, 60, 20
EARLIER = "time repeated within a track by a fix that was flown on from within the same second; the later one counts"
OTHER = "time repeated within a track with another position, bound or status"


def row(second: float, **changes: Any) -> dict[str, Any]:
    """A flight to the north, by what it reports: a row at the time of `second`."""
    own = {"hex": "3c6444", "now": START_S + second, "lat": 48.0 + second * SPEED_MPS * DEG_PER_M, "lon": 2.0, "speed_mps": SPEED_MPS}
    return own | {"track_deg": 0.0, "nac_p": 10, "alt_geom": 9000} | changes


def recording(tmp_path: Path, second: dict[str, Any], *, fraction: float = 0.0) -> Path:
    """A row a second, and another one beside that of `AT`; `fraction` is added to one stamp elsewhere."""
    rows = [row(k) for k in range(N)]
    rows[5]["now"] += fraction
    rows.insert(AT + 1, second)
    return written(tmp_path, rows)


def written(tmp_path: Path, rows: list[dict[str, Any]]) -> Path:
    text = "\n".join([",".join(rows[0]), *(",".join(map(str, each.values())) for each in rows)])
    (tmp_path / "rows.csv").write_text(text + "\n", encoding="utf-8")
    return tmp_path / "rows.csv"


def within(second: float, **changes: Any) -> dict[str, Any]:
    """Where the aircraft was so long after the row of `AT`, under the same stamp."""
    return row(AT + second) | {"now": START_S + AT} | changes


@pytest.mark.parametrize("second", [0.4, 0.95])
def test_of_two_fixes_of_one_second_the_later_counts(tmp_path: Path, second: float) -> None:
    path = recording(tmp_path, within(second, alt_geom=9025))
    run = navbound.analyze(path)
    assert set(run.epochs["status"]) == {"ok"}
    assert run.epochs.height == N
    reading = read(path)
    assert [(each.reason, each.count) for each in reading.rejected] == [(EARLIER, 1)]
    assert reading.left_out.is_empty()
    assert reading.epochs["est_lat_rad"].degrees()[AT] == pytest.approx(within(second)["lat"], abs=1e-12)


@pytest.mark.parametrize(
    "changes",
    [
        {"lat": row(AT + 1.5)["lat"]},
        {"lat": row(AT - 0.4)["lat"]},
        {"lon": 2.0 + 60.0 * DEG_PER_M},
        {"alt_geom": 9000 + 400},
        {"speed_mps": ""},
        {"track_deg": ""},
        {"track_deg": 180.0},
        {"nac_p": 8},
    ],
    ids=str,
)
def test_what_was_not_flown_within_the_second_contradicts(tmp_path: Path, changes: dict[str, Any]) -> None:
    reading = read(recording(tmp_path, within(0.5, **changes)))
    assert [(each.reason, each.count) for each in reading.rejected] == [(OTHER, 1)]
    assert reading.epochs["status"][AT] == "invalid_input"


def test_what_creeps_is_in_one_place(tmp_path: Path) -> None:
    rows = [row(k, lat=48.0 + k * 8.0 * DEG_PER_M, speed_mps=8.0) for k in range(N)]
    path = written(tmp_path, [*rows[: AT + 1], row(AT, lat=48.0 + (AT + 0.5) * 8.0 * DEG_PER_M, speed_mps=8.0), *rows[AT + 1 :]])
    assert [(each.reason, each.count) for each in read(path).rejected] == [(OTHER, 1)]


@pytest.mark.parametrize("accuracy", [{"sde": 3.0, "sdn": 3.0}, {"cov_ee_m2": 9.0, "cov_en_m2": 0.0, "cov_nn_m2": 9.0}], ids=str)
def test_a_position_with_a_covariance_is_of_its_stamp(tmp_path: Path, accuracy: dict[str, float]) -> None:
    rows = [row(k) for k in range(N)]
    path = written(tmp_path, [each | accuracy for each in (*rows[: AT + 1], within(0.5), *rows[AT + 1 :])])
    assert [(each.reason, each.count) for each in read(path).rejected] == [(OTHER, 1)]


def test_finer_stamps_say_that_a_position_is_of_its_time(tmp_path: Path) -> None:
    reading = read(recording(tmp_path, within(0.5), fraction=0.25))
    assert [(each.reason, each.count) for each in reading.rejected] == [(OTHER, 1)]


def test_a_truth_is_of_its_stamp(tmp_path: Path) -> None:
    path = recording(tmp_path, within(0.5))
    for reading in (read_beside(path, {}, {}), read_pieces(path, beside=Beside({}))):
        epochs = reading.epochs if isinstance(reading, Reading) else pl.concat(list(reading.epochs()), how="diagonal_relaxed")
        assert epochs["status"][AT] == "invalid_input"
        assert [(each.reason, each.count) for each in reading.rejected] == [(OTHER, 1)]


@pytest.mark.parametrize("piece_rows", [1, 7])
@pytest.mark.parametrize("changes", [{}, {"lon": 2.001}])
def test_pieces_hold_the_same_rows(tmp_path: Path, piece_rows: int, changes: dict[str, Any]) -> None:
    path = recording(tmp_path, within(0.5, **changes))
    whole, reading = read(path), read_pieces(path, piece_rows=piece_rows)
    rows = pl.concat(list(reading.epochs()), how="diagonal_relaxed")
    assert rows.select("time_ns", "est_lat_rad", "est_lon_rad").equals(whole.epochs.select("time_ns", "est_lat_rad", "est_lon_rad"))
    assert [(each.reason, each.count, each.first_line) for each in reading.rejected] == [
        (each.reason, each.count, each.first_line) for each in whole.rejected
    ]
