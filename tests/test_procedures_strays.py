"""What a procedure does not judge is never silently inside: strays, tracks that end early, databases that lack a record."""

from __future__ import annotations

import gzip
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import path, procedures
from navbound.procedures.strays import follow
from navbound.records.procedure import BesideProcedure
from navbound.run.procedure import Flown

if TYPE_CHECKING:
    from collections.abc import Callable

    from navbound.records.run import Summary

DATA = Path(__file__).parents[1] / "examples" / "data"
DATABASE = DATA / "procedure.txt"
SAMPLE = Path(__file__).parent / "procedures" / "KDEN_H26-Z.txt"
NAME = "XNAV/H27:NORTH"
NM = 1852.0
NORTH_DEG_PER_M = 57.29577951308232 / 6_367_500.0
"""Degrees of latitude of a metre: M = 6,367.5 km at 45 degrees (derived)."""
FINAL = 88
"""The first row of the track on the final approach, which goes to the west: north of it is right. One row every 2 s, 147 in all."""


@cache
def flown() -> pl.DataFrame:
    return pl.read_csv(DATA / "procedure-track.csv")


def moved(rows: pl.DataFrame, first: int, last: int, north_deg: float, east_deg: float = 0.0) -> pl.DataFrame:
    """Rows from `first` to before `last`, moved."""
    here = pl.int_range(pl.len()).is_between(first, last - 1).cast(pl.Float64)
    return rows.with_columns(pl.col("lat_deg") + here * north_deg, pl.col("lon_deg") + here * east_deg)


def without(rows: pl.DataFrame, first: int, last: int) -> pl.DataFrame:
    return pl.concat([rows[:first], rows[last:]])


def judged(rows: pl.DataFrame, folder: Path, database: Path = DATABASE, name: str = NAME) -> Summary:
    file = folder / "track.csv"
    rows.write_csv(file)
    return navbound.analyze(file, procedure=Flown(database, name, "RNP 0.3")).summary


def test_the_whole_flight_is_inside_and_nothing_is_apart(tmp_path: Path) -> None:
    verdict = judged(flown(), tmp_path).verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_judged) == ("inside", 147, 147)
    assert verdict.beside == BesideProcedure(n_recorded=147, n_status={})
    assert "no part of this" not in verdict.words


def test_a_flight_that_leaves_the_final_approach_is_outside(tmp_path: Path) -> None:
    # A step of 12 km is a jump for its first epochs; the rest of the 47 rows is ok and 12 km off.
    summary = judged(moved(flown(), 100, 147, 12_000.0 * NORTH_DEG_PER_M), tmp_path)
    verdict = summary.verdict
    assert verdict.id == "outside"
    assert verdict.n_epochs == 147
    assert verdict.n_outside > 20
    assert verdict.worst_accuracy is not None
    # The path deviation is 12 km and at most 35 m of the flight's own; the bound is beyond it.
    assert verdict.worst_accuracy.bound_m > 11_960.0
    (flight,) = summary.procedures
    assert (flight.n_status["strayed"], flight.end, flight.n, flight.n_inside) == (47, "leaves", 147, 100)
    assert "the track leaves the path 4." in verdict.words


def test_a_detour_within_the_flight_is_outside_and_the_way_back_too(tmp_path: Path) -> None:
    # Away and back by 5 km over 15 rows each at up to 167 m/s across; more than 2 RNP + 1 NM off in its middle.
    ramp = np.interp(np.arange(147), [90, 105, 120, 135], [0.0, 5_000.0, 5_000.0, 0.0], left=0.0, right=0.0)
    rows = flown().with_columns(pl.col("lat_deg") + pl.Series(ramp) * NORTH_DEG_PER_M)
    summary = judged(rows, tmp_path)
    (flight,) = summary.procedures
    assert (flight.n, flight.end) == (147, "ends")
    # 0.3 NM of the ramp are 1.67 of its rows on either side: 2 rows there and 2 back are within RNP, and the 35 m of the flight's own
    # deviation move none across; so 90 rows and 12 rows and 4 rows are inside.
    assert flight.n_inside == 147 - sum(ramp > 0.3 * NM)
    assert summary.verdict.id == "outside"


def test_one_flight_by_itself_has_its_strays_as_well() -> None:
    procedure = path.procedure(DATABASE, "XNAV", "H27", "NORTH", line="RNP 0.3")
    rows = moved(flown(), 100, 147, -12_000.0 * NORTH_DEG_PER_M)
    flight = procedures.judge(procedure, 2.0 * np.arange(147), np.radians(rows["lat_deg"]), np.radians(rows["lon_deg"]))
    assert (flight.n, flight.n_inside, flight.n_inside_twice) == (147, 100, 100)
    assert flight.verdict.startswith("not within RNP; not within twice RNP")
    strays = flight.followed.status == "strayed"
    assert strays.sum() == 47
    assert np.abs(flight.followed.cross_m[strays] + 12_000.0).max() < 60.0


def test_straight_on_where_the_path_turns_is_a_deviation_of_the_whole_way(tmp_path: Path) -> None:
    procedure = path.procedure(DATABASE, "XNAV", "H27", "NORTH", line="RNP 0.3")
    # On from BOUND to the south along the meridian of the leg, 10 km: nothing of it is beside the leg, it is beyond.
    leg = procedure.core.at(1, np.arange(0.0, procedure.legs[1].length_m + 10_000.0, 200.0))
    flight = procedures.judge(procedure, 2.0 * np.arange(leg["lat_rad"].size), leg["lat_rad"], leg["lon_rad"])
    off = flight.followed.cross_m[-1]
    assert flight.followed.status[-1] == "strayed"
    assert abs(off) > 5_000.0
    assert flight.n_inside < flight.n


def test_a_turn_back_along_the_path_is_due_and_not_judged() -> None:
    # All legs go to the west: nothing agrees with the way back.
    procedure = path.procedure(SAMPLE, "KDEN", "H26-Z", "FUZZZ", line="RNP 0.3")
    along = np.concatenate([np.arange(500.0, 7_000.0, 200.0), np.arange(7_000.0, 1_000.0, -200.0)])
    leg = procedure.core.at(1, along)
    flight = procedures.judge(procedure, 2.0 * np.arange(along.size), leg["lat_rad"], leg["lon_rad"])
    # 33 positions there, 30 back; the first 30 m back are no turn.
    assert (flight.n, flight.n_inside, flight.n_astray) == (34, 34, 29)
    assert "29 positions off the path could not be judged" in flight.verdict


def test_a_turn_back_beyond_the_begin_is_as_far_off_as_it_is_from_the_begin() -> None:
    procedure = path.procedure(SAMPLE, "KDEN", "H26-Z", "FUZZZ", line="RNP 0.3")
    along = np.concatenate([np.arange(500.0, 7_000.0, 200.0), np.arange(7_000.0, -10_000.0, -200.0)])
    leg = procedure.core.at(1, along)
    flight = procedures.judge(procedure, 2.0 * np.arange(along.size), leg["lat_rad"], leg["lon_rad"])
    back = (np.arange(along.size) > 33) & (along < -1.0 * NM)
    assert (flight.followed.status[back] == "strayed").all()
    assert np.abs(np.abs(flight.followed.cross_m[back]) + along[back]).max() < 1.0
    assert flight.n_inside == flight.n - back.sum()


def test_a_procedure_with_an_open_end_has_no_end_to_be_short_of(tmp_path: Path) -> None:
    lines = SAMPLE.read_text(encoding="ascii").splitlines(keepends=True)
    file = tmp_path / "climb.txt"
    # The climb of the missed approach stands in line 25; the way to its hold is left out.
    file.write_text("".join(lines[:25]), encoding="ascii")
    for missed, on, end in ((True, 4, "reached"), (True, 3, "ends"), (False, 3, "ends")):
        procedure = path.procedure(file, "KDEN", "H26-Z", "FUZZZ", line="RNP 0.3", missed=missed)
        leg = procedure.core.at(on, np.arange(0.0, 4_000.0, 200.0))
        _, (flight,) = follow(procedure, np.linspace(0.0, 38.0, 20), (leg["lat_rad"], leg["lon_rad"]))
        assert (flight.end, flight.last) == (end, 19)
        assert missed or flight.short_m == pytest.approx(procedure.legs[3].length_m - 3_800.0, abs=0.01)


def test_what_is_off_the_path_where_a_heading_may_be_flown_is_due_and_not_judged() -> None:
    # The missed approach climbs, and turns at a height that nobody knows: the way to the next fix has no path.
    procedure = path.procedure(SAMPLE, "KDEN", "H26-Z", "FUZZZ", line="RNP 0.3", missed=True)
    leg = procedure.core.at(4, np.arange(100.0, 4_000.0, 200.0))
    # On to the north, at right angles to the runway.
    lat = np.concatenate([leg["lat_rad"], leg["lat_rad"][-1] + 200.0 / 6_361_000.0 * np.arange(1.0, 41.0)])
    lon = np.concatenate([leg["lon_rad"], np.full(40, leg["lon_rad"][-1])])
    flight = procedures.judge(procedure, 2.0 * np.arange(lat.size), lat, lon)
    assert "strayed" not in flight.n_status
    assert flight.n_astray == flight.n_status["off_path"] > 10


def test_positions_before_the_flight_are_counted_in_the_verdict(tmp_path: Path) -> None:
    # The first leg to the south and a part of the turn 0.1 degrees of longitude, 8 km, to the east: vectors to the turn.
    summary = judged(moved(flown(), 0, 60, 0.0, 0.1), tmp_path)
    verdict = summary.verdict
    assert verdict.beside is not None
    n = sum(verdict.beside.n_status.values())
    assert n + verdict.n_epochs == 147
    assert n >= 60
    assert f"{n} of 147 recorded positions are no part of this and are not judged (" in verdict.words
    assert "off the path" in verdict.words


def test_a_gap_within_the_procedure_is_missing(tmp_path: Path) -> None:
    verdict = judged(without(flown(), 96, 145), tmp_path).verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_missing) == ("not_shown", 147, 49)


def test_a_track_that_ends_before_the_procedure_says_so_and_lacks_the_rest(tmp_path: Path) -> None:
    verdict = judged(flown()[:96], tmp_path).verdict
    assert verdict.id == "not_shown"
    # 15.89 NM in all, 11.42 NM of them flown (reference of the finding).
    assert verdict.beside is not None
    assert verdict.beside.short_m == pytest.approx(4.47 * NM, abs=0.01 * NM)
    assert "the track ends 4.47 NM before the end of the procedure" in verdict.words
    # The rest at the mean speed of 10.96 NM in 190 s is 77.5 s, 39 epochs.
    assert verdict.n_missing == 39


def test_a_track_that_ends_shortly_before_the_runway_is_inside_and_says_so(tmp_path: Path) -> None:
    verdict = judged(flown()[:143], tmp_path).verdict
    assert verdict.id == "inside"
    assert "before the end of the procedure" in verdict.words


def test_a_track_that_begins_in_the_middle_of_the_procedure_says_where(tmp_path: Path) -> None:
    verdict = judged(flown()[-30:], tmp_path).verdict
    assert (verdict.id, verdict.n_epochs) == ("inside", 30)
    assert verdict.beside is not None
    # The last 30 of 147 rows of the whole flight, 15.89 NM, which ends within 35 m of the runway. A row is 2 s apart at 62.5 to 124 m/s.
    assert verdict.beside.begin_m is not None
    assert 15.89 * NM - 30 * 2.0 * 124.0 < verdict.beside.begin_m < 15.89 * NM - 29 * 2.0 * 62.5
    assert f"judged on a part of the procedure alone, from {verdict.beside.begin_m / NM:.3g} NM after its begin on" in verdict.words


def test_a_position_that_is_led_ahead_along_the_path_is_not_believed(tmp_path: Path) -> None:
    # 80 m/s more than its speed of 124 m/s, westwards along the final approach, from row 90 on.
    east_deg = -160.0 * NORTH_DEG_PER_M / np.cos(np.radians(45.0))
    led = pl.Series(np.maximum(np.arange(147) - 90.0, 0.0)) * east_deg
    verdict = judged(flown().with_columns(pl.col("lon_deg") + led), tmp_path).verdict
    assert verdict.id == "not_shown"
    # 80 t > 9.2 (t + 8) + 1340 m: within 21 s, 11 rows, and 8 s between places.
    assert verdict.n_reason["position_ahead"] > 10
    assert verdict.n_judged <= 90 + 11 + 4


def damaged(folder: Path, change: Callable[[list[str]], None], *, pack: bool = False) -> Path:
    lines = DATABASE.read_text(encoding="ascii").splitlines(keepends=True)
    change(lines)
    file = folder / ("damaged.txt.gz" if pack else "damaged.txt")
    data = "".join(lines).encode("latin-1")
    file.write_bytes(gzip.compress(data) if pack else data)
    return file


def replaced(number: int, old: str, new: str) -> Callable[[list[str]], None]:
    def change(lines: list[str]) -> None:
        assert old in lines[number - 1]
        lines[number - 1] = lines[number - 1].replace(old, new, 1)

    return change


@pytest.mark.parametrize(
    ("change", "words"),
    [
        # The first record of the transition belongs to another procedure.
        (replaced(11, "FH27", "F027"), "begins with leg 020 BOUND TF"),
        # The last one of the transition does.
        (replaced(14, "FH27", "F027"), "No leg leads from LATER to FINAL"),
        # One in the middle stands at another airport: the record numbers of its neighbours are compared with it.
        (replaced(13, "XNAVXXF", "XNAWXXF"), "goes from leg 020 BOUND TF to leg 040 FINAL TF"),
        # The leg to the runway does.
        (replaced(21, "FH27", "F027"), "does not end at a missed approach point"),
        # A fix that no record has.
        (replaced(6, "LATER", "LATEX"), "has no path: its fix is not in the file"),
    ],
)
def test_a_procedure_that_lacks_a_record_is_not_inside(tmp_path: Path, change: Callable[[list[str]], None], words: str) -> None:
    procedure = path.procedure(damaged(tmp_path, change), "XNAV", "H27", "NORTH")
    assert any(words in doubt for doubt in procedure.doubts)


def test_the_verdict_says_that_the_procedure_is_not_whole(tmp_path: Path) -> None:
    verdict = judged(flown(), tmp_path, damaged(tmp_path, replaced(11, "FH27", "F027"))).verdict
    assert (verdict.id, verdict.n_judged) == ("not_shown", 111)
    assert verdict.beside is not None
    assert sum(verdict.beside.n_status.values()) == 36
    assert "36 of 147 recorded positions are no part of this" in verdict.words
    assert "The procedure may not be whole in its database: H27, transition NORTH begins with leg 020 BOUND TF" in verdict.words
    assert "the track ends" not in verdict.words


@pytest.mark.parametrize("pack", [False, True])
def test_a_refused_line_of_the_airport_leaves_nothing_shown(tmp_path: Path, pack: bool) -> None:
    # A waypoint that the transition does not need: its latitude is none.
    file = damaged(tmp_path, replaced(9, "N44515964", "N94515964"), pack=pack)
    verdict = judged(flown(), tmp_path, file).verdict
    assert verdict.id == "not_shown"
    assert f"Line 9 of {file.name} is refused" in verdict.words


def test_published_procedures_are_whole() -> None:
    for file, airport, ident, transition in (
        (DATABASE, "XNAV", "H27", "NORTH"),
        (DATABASE, "XNAV", "H27", "SOUTH"),
        (SAMPLE, "KDEN", "H26-Z", "FUZZZ"),
        (SAMPLE, "KDEN", "H26-Z", "CAPTJ"),
    ):
        for missed in (False, True):
            assert path.procedure(file, airport, ident, transition, missed=missed).doubts == ()
