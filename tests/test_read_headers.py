"""How a text table names its columns: with capitals, behind the mark of a remark, separated by blanks, in no known way."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from navbound import FormatError
from navbound.read import read
from navbound.read.pieces.reading import read_pieces

if TYPE_CHECKING:
    from pathlib import Path


def table(folder: Path, header: str, row: str = "{t},47.0,8.{t}") -> Path:
    path = folder / "track.csv"
    path.write_text("\n".join([header, *(row.format(t=1_600_000_000 + k) for k in range(3))]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "header",
    [
        "timestamp,latDeg,lonDeg",
        "timestamp,Latitude,Longitude",
        "#timestamp [s],latitude [deg],longitude [deg]",
        "# made by hand\n# time,lat,lon",
    ],
)
def test_a_header_that_a_person_understands_is_understood(tmp_path: Path, header: str) -> None:
    reading = read(table(tmp_path, header))
    assert reading.epochs.height == 3
    assert reading.columns["est_lat_rad"].endswith("deg")
    assert reading.rejected == []


def test_a_separator_at_the_end_of_the_header_alone_is_no_column(tmp_path: Path) -> None:
    reading = read(table(tmp_path, "time,lat,lon,"))
    assert (reading.epochs.height, reading.rejected) == (3, [])
    # Rows that have the field keep it, and a row without it is damaged.
    path = table(tmp_path, "time,lat,lon,", "{t},47.0,8.{t},")
    assert (read(path).epochs.height, read(path).rejected) == (3, [])
    path.write_text(path.read_text(encoding="utf-8") + "1600000003,47.0,8.3\n" + "".join(f"{1600000004 + k},47,8,\n" for k in range(20)))
    (refused,) = read(path).rejected
    assert (refused.count, "fields" in refused.reason) == (1, True)


@pytest.mark.parametrize(("name", "written", "n"), [("NSAT (USED/VIEW)", "3(7)", 3), ("nsat", "9/12", 9), ("sats", "7 (11)", 7)])
def test_satellites_that_are_used_stand_before_those_in_view(tmp_path: Path, name: str, written: str, n: int) -> None:
    reading = read(table(tmp_path, f"time,lat,lon,{name}", "{t},47.0,8.{t}," + written))
    assert (reading.columns["n_sv"], reading.epochs["n_sv"].to_list(), reading.rejected) == (f"{name}:1", [n] * 3, [])


def test_a_remark_with_other_fields_than_the_rows_is_none_of_their_names(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="time: no column holds it"):
        read(table(tmp_path, "# time,lat,lon,h"))
    # Names are there: the remark above them is one.
    assert read(table(tmp_path, "# east,north,up\ntime,lat,lon")).epochs.height == 3


def test_every_vessel_is_a_track_of_its_own(tmp_path: Path) -> None:
    reading = read(table(tmp_path, "MMSI,time,lat,lon", "21100000{t:.1},{t},47.0,8.{t}".replace("{t:.1}", "7")))
    assert reading.epochs["track"].unique().to_list() == ["211000007"]


def test_two_writings_of_one_name_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="are one name in another writing"):
        read(table(tmp_path, "time,latDeg,lon,lat_deg", "{t},47.0,8.{t},48.0"))


ROW = "2026/03/01 09:00:0{t}.000 48.99 2.57 120.0 5 12 0.01 0.01 0.02 0.0 0.0 0.0 0.0 0.0"


def test_a_solution_without_a_header_is_read_with_the_line_that_its_refusal_names(tmp_path: Path) -> None:
    path = tmp_path / "track.pos"
    rows = "".join(ROW.format(t=t) + "\n" for t in range(3))
    path.write_text(rows, encoding="utf-8")
    with pytest.raises(FormatError, match="The rows have no header") as refused:
        read(path)
    line = re.search("“(%.*?)”", str(refused.value))
    assert line
    path.write_text(f"{line.group(1)}\n{rows}", encoding="utf-8")
    reading = read(path)
    assert reading.epochs["est_h_m"].to_list() == [120.0] * 3
    # 1 cm to the north: 1e-4 m2.
    assert reading.epochs["cov_nn_m2"].to_list() == pytest.approx([1e-4] * 3)
    with pytest.raises(FormatError, match="add a line of names, with commas"):
        read(table(tmp_path, "0 48.99 2.57", "{t} 48.99 2.57"))


def test_fields_between_blanks_are_named_as_such(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="no comma, semicolon or tab") as refusal:
        read(table(tmp_path, "time lat lon", "{t} 47.0 8.{t}"))
    assert refusal.value.line == 1


@pytest.mark.parametrize(("name", "unit"), [("zeit", "UNIT"), ("zeit_ms", "utc_ms"), ("gpsZeit", "gps_s"), ("unix zeit", "utc_s")])
def test_a_unit_of_time_is_proposed_only_where_the_name_has_one(tmp_path: Path, name: str, unit: str) -> None:
    with pytest.raises(FormatError, match=f'--map "time=COLUMN:{unit}"'):
        read(table(tmp_path, f"{name},lat,lon"))


def test_the_rows_of_a_clock_that_stands_are_expected_and_not_judged(tmp_path: Path) -> None:
    rows = [f"{1_600_000_000 + min(k, 5)},47.0,8.0" for k in range(40)]
    path = tmp_path / "still.csv"
    path.write_text("\n".join(["time,lat,lon", *rows]) + "\n", encoding="utf-8")
    reading = read(path)
    assert (reading.epochs.height, reading.left_out.height) == (6, 34)
    # A file that holds every row twice lost nothing.
    path.write_text("\n".join(["time,lat,lon", *rows[:6], *rows[:6]]) + "\n", encoding="utf-8")
    twice = read(path)
    assert (twice.epochs.height, twice.left_out.height) == (6, 0)


def test_another_header_in_the_middle_ends_the_table(tmp_path: Path) -> None:
    path = table(tmp_path, "time,lat,lon,sigma_e_m")
    path.write_text("time,lat,lon,sigma_e_m,sigma_n_m\n1600000000,47,8,3,3\ntime,lat,lon,sigma_e_km,sigma_n_km\n1600000001,47,8,3,3\n")
    with pytest.raises(FormatError, match="another header in the middle") as refusal:
        read(path)
    assert refusal.value.line == 3


def test_the_same_header_again_is_a_row_that_is_counted(tmp_path: Path) -> None:
    header, rows = "time,lat,lon", [f"{1_600_000_000 + k},47.0,8.0{k}" for k in range(30)]
    path = tmp_path / "two.csv"
    path.write_text("\n".join([header, *rows[:15], header, *rows[15:]]) + "\n")
    reading = read(path)
    assert reading.epochs.height == 30
    assert sum(one.count for one in reading.rejected) == 1


@pytest.mark.parametrize(("scale", "refused"), [("GPST", False), ("UTC", True)])
def test_another_header_of_a_solution_file_is_refused(tmp_path: Path, scale: str, refused: bool) -> None:
    header = "%  {}                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)"
    rows = [f"2024/03/15 12:00:{k:02d}.000   48.5000000   2.000000{k % 10}   100.0000   5   9   1.0   1.0   2.0" for k in range(20)]
    path = tmp_path / "joined.pos"
    path.write_text("\n".join([header.format("GPST"), *rows[:10], header.format(scale), *rows[10:]]) + "\n", encoding="utf-8")
    if not refused:
        assert read(path).epochs.height == 20
        return
    with pytest.raises(FormatError, match="another header in the middle") as refusal:
        read(path)
    assert refusal.value.line == 12


@pytest.mark.parametrize(("n_sv", "status"), [(9, None), (2, "degraded"), (0, "degraded")])
def test_a_solution_of_fewer_satellites_than_determine_one_is_kept_by_something_else(tmp_path: Path, n_sv: int, status: str | None) -> None:
    header = "%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)"
    rows = [f"2024/03/15 12:00:{k:02d}.000   48.5000000   2.000000{k % 10}   100.0000   5   {n_sv}   1.0   1.0   2.0" for k in range(20)]
    path = tmp_path / "few.pos"
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    epochs = read(path).epochs
    assert ("status" in epochs.columns) == (status is not None)
    if status is not None:
        assert epochs["status"].unique().to_list() == [status]
    # A file without the field states none.
    path.write_text("\n".join([header, *rows]).replace("  ns", "").replace(f"   5   {n_sv}   ", "   5   ") + "\n", encoding="utf-8")
    assert "status" not in read(path).epochs.columns


UNITS_ROW = "UTC,deg,deg,m,{}"


def with_units(folder: Path, unit: str, name: str = "epu", above: str = "") -> Path:
    rows = [f"{1_600_000_000 + k},47.0,8.{k},500,0.9" for k in range(3)]
    path = folder / "track.csv"
    path.write_text("\n".join([f"{above}time,lat,lon,h_m,{name}", UNITS_ROW.format(unit), *rows]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(("name", "unit"), [("epu", "NM"), ("hpl", "ft"), ("epu", "furlong"), ("hAcc", "NM"), ("epu", "[NM]")])
def test_a_row_of_units_that_are_not_those_read_is_refused(tmp_path: Path, name: str, unit: str) -> None:
    with pytest.raises(FormatError, match=f"states the unit “{unit.strip('[]').lower()}” of “{name}”") as refusal:
        read(with_units(tmp_path, unit, name))
    assert refusal.value.line == 2


@pytest.mark.parametrize("unit", ["m", "metres", "", "[m]"])
def test_a_row_of_the_units_that_are_read_is_no_row(tmp_path: Path, unit: str) -> None:
    reading = read(with_units(tmp_path, unit))
    assert (reading.epochs.height, reading.rejected) == (3, [])
    assert any("line 2 holds the units of the columns" in note for note in reading.notes)


@pytest.mark.parametrize("remark", ["# units: epu [NM]\n", "# epu (NM), lat (deg)\n", "# unit of EPU: nm\n", "# units: time s, epu = NM\n"])
def test_a_remark_of_another_unit_refuses_the_file(tmp_path: Path, remark: str) -> None:
    with pytest.raises(FormatError, match="states the unit “nm” of “epu”") as refusal:
        read(table(tmp_path, f"{remark}time,lat,lon,epu", "{t},47.0,8.{t},0.9"))
    assert refusal.value.line == 1
    with pytest.raises(FormatError, match="states the unit “nm” of “epu”"):
        read_pieces(tmp_path / "track.csv")
    assert read(table(tmp_path, "# units: epu [m]\ntime,lat,lon,epu", "{t},47.0,8.{t},0.9")).epochs["epu_m"].to_list() == [0.9] * 3


def test_a_refusal_names_every_column_that_may_be_the_one_it_misses(tmp_path: Path) -> None:
    names = [f"voltage{k}" for k in range(12)] + ["moment"]
    with pytest.raises(FormatError, match="time: no column holds it") as refusal:
        read(table(tmp_path, ",".join((*names, "lat", "lon")), ",".join(["{t}"] * 13 + ["47.0", "8.0"])))
    assert all(name in str(refusal.value) for name in (*names, "lat", "lon"))
    assert " more;" not in str(refusal.value)


def test_a_refusal_names_no_more_columns_than_a_person_reads(tmp_path: Path) -> None:
    names = [f"voltage{k}" for k in range(98)]
    with pytest.raises(FormatError, match="and 70 more;"):
        read(table(tmp_path, ",".join((*names, "lat", "lon")), ",".join(["{t}"] * 98 + ["47.0", "8.0"])))


@pytest.mark.parametrize(("epu", "shown"), [("8.0", True), ("0.05", False)])
def test_an_uncertainty_without_a_unit_may_be_in_nautical_miles(tmp_path: Path, epu: str, shown: bool) -> None:
    """Flight displays state it in NM; as small as 0.05 it may be either."""
    path = table(tmp_path, "time,lat,lon,EPU", f"{{t}},47.0,8.{{t}},{epu}")
    reading = read(path)
    words = [each for each in (*reading.notes, *reading.position_doubts) if "“EPU” states no unit and is read in metres" in each]
    assert len(words) == 1
    assert (words[0] in reading.notes) == shown
    assert not any("EPU" in each for each in read(path, columns={"epu_m": "EPU:nm"}).position_doubts)


@pytest.mark.parametrize(("beside", "named"), [("", True), (",icao24", False)])
def test_a_height_in_feet_by_its_name_alone_is_named(tmp_path: Path, beside: str, named: bool) -> None:
    """States of transponders have it in feet; a logger of a rocket had metres."""
    reading = read(table(tmp_path, f"time,lat,lon,Altitude{beside}", "{t},47.0,8.{t},27.4" + (",4ca123" if beside else "")))
    assert any("“Altitude” states no unit and is read in feet; if it is in metres, declare it" in each for each in reading.notes) == named
