"""Places that nobody was at, and errors under names that nobody reads: counted or named, and never in silence."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest

import navbound
from navbound.read import read
from navbound.read.pieces.reading import read_pieces
from navbound.run import analyze
from navbound.run.judge import judge
from test_false_inside import RNP_M, START_S, N, columns, run

if TYPE_CHECKING:
    from pathlib import Path

NOWHERE = "latitude 0, longitude 0: no position of a track that is elsewhere"


def with_zeros(rows: list[int], **changed: object) -> dict[str, object]:
    """The flight, with 0, 0 in some rows."""
    flown = columns(**changed)
    zero = np.isin(np.arange(N), rows)
    return flown | {name: np.where(zero, 0.0, flown[name]) for name in ("lat", "lon")}


@pytest.mark.parametrize("rows", [[0], [0, 1, 2], [300], [300, 301, 302], [N - 1], list(range(100, 500))])
def test_zeros_among_places_elsewhere_are_no_position_and_counted(tmp_path: Path, rows: list[int]) -> None:
    result = run(tmp_path, **with_zeros(rows))
    verdict = result.summary.verdict
    assert [(r.reason, r.count, r.first_line, r.example) for r in result.summary.rejected] == [(NOWHERE, len(rows), rows[0] + 2, "0, 0")]
    assert (verdict.n_epochs, verdict.n_missing, verdict.n_implausible) == (N, len(rows), 0)
    assert (result.epochs["est_lat_rad"] > 0.8).all()


def test_a_track_that_crosses_the_meridian_at_the_equator_keeps_its_rows(tmp_path: Path) -> None:
    k = np.arange(N) - 300
    file = tmp_path / "crossing.csv"
    # 70 m/s to the north east through 0, 0 to the last bit.
    pl.DataFrame(columns(lat=49.5 / 111_200.0 * k, lon=49.5 / 111_200.0 * k)).write_csv(file)
    reading = read(file)
    assert reading.rejected == []
    assert reading.epochs.height == N


def test_each_track_of_a_file_has_places_of_its_own(tmp_path: Path) -> None:
    lost = pl.DataFrame(with_zeros([5, 6])).with_columns(track_id=pl.lit("lost"))
    k = np.arange(N) - 300
    crossing = pl.DataFrame(columns(lat=49.5 / 111_200.0 * k, lon=49.5 / 111_200.0 * k)).with_columns(track_id=pl.lit("there"))
    file = tmp_path / "two.csv"
    pl.concat([lost, crossing]).write_csv(file)
    reading = read(file)
    assert reading.epochs.group_by("track").len().sort("track").rows() == [("lost", N - 2), ("there", N)]
    assert reading.left_out["track"].to_list() == ["lost"] * 2
    # In pieces the rows that decide may come later.
    pieces = read_pieces(file, piece_rows=256)
    assert pl.concat(list(pieces.epochs())).height == 2 * N - 2
    assert [(r.reason, r.count) for r in pieces.rejected] == [(NOWHERE, 2)]


def test_zeros_of_a_solution_file_are_no_position(tmp_path: Path) -> None:
    place = [f"{48.0 + 1e-5 * k:.9f} 2.000000000 100.0" if k != 40 else "0.000000000 0.000000000 0.0" for k in range(90)]
    rows = [f"2020/06/25 00:{k // 60:02d}:{k % 60:02d}.000 {each} 1 9 1.0 1.0 1.0 0.0 0.0 0.0" for k, each in enumerate(place)]
    head = "%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m)"
    (tmp_path / "a.pos").write_text("\n".join([head, *rows]) + "\n")
    reading = read(tmp_path / "a.pos")
    assert [(r.reason, r.count, r.first_line) for r in reading.rejected] == [(NOWHERE, 1, 42)]
    assert (reading.epochs.height, reading.left_out.height) == (89, 1)


@pytest.mark.parametrize(
    ("name", "second", "same"),
    [("h_m", 4000.0, False), ("altitude_ft", 12_000.0, False), ("altitude_ft", 1100.0, True), ("alt_m", 3000.0, False)],
)
def test_two_heights_of_one_instant_contradict_each_other(tmp_path: Path, name: str, second: float, same: bool) -> None:
    """Each time twice at the same place, 1000 and something else: a step of 100 ft is none."""
    twice: dict[str, object] = {key: np.repeat(values, 2) for key, values in columns().items()}
    verdict = run(tmp_path, **twice | {name: np.tile([1000.0, second], N)}).summary.verdict
    assert (verdict.id, verdict.n_implausible) == (("inside", 0) if same else ("nothing_judged", N))


@pytest.mark.parametrize(
    "name",
    [
        "dist_to_truth", "distance_to_truth_m", "DistToTruth", "truth_distance", "disttotruth", "offset_from_truth", "delta_truth",
        "difference_to_reference", "dist_ref_m", "distance_to_true_position", "gt_dist_truth",
    ],
)  # fmt: skip
def test_a_distance_from_the_truth_is_compared_under_any_name(tmp_path: Path, name: str) -> None:
    # 8.49 m are twice the distance root mean square of 3 m in each axis.
    fine, bad = (run(tmp_path, sde=np.full(N, 3.0), sdn=np.full(N, 3.0), **{name: np.full(N, m)}).summary.verdict for m in (5.0, 900.0))
    assert (bad.id, bad.n_stated_worse) == ("not_shown", N)
    assert all(name in of.unread for of in (bad, fine))
    assert all(name in of.words for of in (bad, fine))
    assert fine.n_stated_worse == 0
    rows = ["time,hpl,vpl,hpe,vpe," + name, *(f"{1_400_000_000 + k},20,25,1,1,900" for k in range(300))]
    (tmp_path / "levels.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    levels = navbound.evaluate([tmp_path / "levels.csv"], levels="APV-I").summary.verdict
    assert (levels.id, levels.n_stated_worse) == ("not_shown", 300)


@pytest.mark.parametrize("name", ["truth_x", "groundTruthEast"])
def test_a_truth_that_nothing_reads_is_named(tmp_path: Path, name: str) -> None:
    verdict = run(tmp_path, **{name: np.full(N, 9e5)}).summary.verdict
    assert verdict.unread == [name]
    assert (verdict.id, verdict.n_stated_worse) == ("inside", 0)


@pytest.mark.parametrize(
    "name",
    [
        "distance", "dist_to_runway", "true_airspeed", "true_heading", "truth_speed", "distance_to_ref_station",
        "reference_distance_runway", "offset_s", "true_distance_nm",
    ],
)  # fmt: skip
def test_other_distances_and_other_truths_are_not(tmp_path: Path, name: str) -> None:
    verdict = run(tmp_path, **{name: np.full(N, 9e5)}).summary.verdict
    assert (verdict.id, verdict.unread, verdict.n_stated_worse) == ("inside", [], 0)


@pytest.mark.parametrize("rows", [30, N, 1900])
@pytest.mark.parametrize("sigma", [5.0, 0.5])
def test_a_stand_under_stamps_that_crawl_is_not_shown_to_be_inside(tmp_path: Path, rows: int, sigma: float) -> None:
    """Rows that came once a second, stamped a millisecond apart: the aircraft has been elsewhere for minutes."""
    time = START_S + 1e-3 * np.arange(rows)
    file = tmp_path / "stands.csv"
    pl.DataFrame({"time": time, "lat": 48.0, "lon": 2.0, "sde": sigma, "sdn": sigma}).write_csv(file)
    result = judge(analyze.material(file, requirement="RNP 0.3", rnp_m=RNP_M))
    assert result.summary.verdict.inside is None
    assert set(result.epochs["reason_id"]) == {"position_stale"}


def test_a_fast_table_of_a_stand_is_as_it_was(tmp_path: Path) -> None:
    """A hundred rows a second are a receiver's, and a position that stands in them is old after 2 s."""
    file = tmp_path / "fast.csv"
    pl.DataFrame({"time": START_S + 1e-2 * np.arange(400), "lat": 48.0, "lon": 2.0, "sde": 5.0, "sdn": 5.0}).write_csv(file)
    result = judge(analyze.material(file, requirement="RNP 0.3", rnp_m=RNP_M))
    assert result.epochs["reason_id"].null_count() == 201
