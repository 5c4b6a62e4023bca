"""Tables of every kind and in every state: read, counted, or refused with file, line, field and text."""

from __future__ import annotations

import gzip
import json
import math
import os
from pathlib import Path

import polars as pl
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import navbound
from navbound import FormatError, InputError, NavboundError
from navbound.read import Reading, read
from navbound.read.pieces.reading import read_pieces

GPS_MINUS_UNIX_S = 315_964_800 - 18
"""Unix time of the GPS epoch, less the leap seconds of 2021 (IERS bulletin C)."""

HEADER = "icao24,timestamp,latitude,longitude,altitude,groundspeed,track,vertical_rate"
ROWS = [f"4ca63a,{1633608773000 + 1000 * i},48.9{i:02d},2.5{i:02d},3500,140,85.0,-700" for i in range(30)]


def write(folder: Path, content: str | bytes, name: str = "track.csv") -> Path:
    file = folder / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return file


def table(*rows: str, header: str = HEADER) -> str:
    return "\n".join([header, *rows]) + "\n"


def with_row(index: int, row: str) -> str:
    return table(*ROWS[:index], row, *ROWS[index + 1 :])


def same(a: Reading, b: Reading, names: tuple[str, ...] = ("time_ns", "est_lat_rad", "est_lon_rad", "altitude_m")) -> bool:
    return a.epochs.select(names).equals(b.epochs.select(names))


def test_aviation_units_and_utc_become_si_and_gps_time(tmp_path: Path) -> None:
    reading = read(write(tmp_path, table(*ROWS)))
    first = reading.epochs.row(0, named=True)
    assert first["track"] == "4ca63a"
    assert first["time_ns"] == (1633608773 - GPS_MINUS_UNIX_S) * 10**9
    assert first["est_lat_rad"] == pytest.approx(math.radians(48.9), rel=1e-15)
    assert first["altitude_m"] == pytest.approx(3500 * 0.3048, rel=1e-15)
    assert first["ground_speed_mps"] == pytest.approx(140 * 1852 / 3600, rel=1e-15)
    assert first["ground_track_rad"] == pytest.approx(math.radians(85), rel=1e-15)
    assert first["vertical_rate_mps"] == pytest.approx(-700 * 0.3048 / 60, rel=1e-15)
    assert reading.rejected == []
    assert reading.source.n_rows == 30


def test_one_table_in_eight_forms_is_one_table(tmp_path: Path) -> None:
    text = table(*ROWS)
    expected = read(write(tmp_path, text))
    frame = pl.read_csv(text.encode())
    columns = {c: {str(i): v for i, v in enumerate(frame[c])} for c in frame.columns}
    frame.write_parquet(tmp_path / "track.parquet")
    quoted = "\n".join(",".join(f'"{v}"' for v in line.split(",")) for line in text.splitlines())
    for name, content in {
        "track.csv.gz": gzip.compress(text.encode()),
        "windows.csv": ("\ufeff" + text.replace("\n", "\r\n")).encode(),
        "semicolons.txt": text.replace(",", ";").encode(),
        "quoted.csv": quoted.encode(),
        "columns.json": json.dumps(columns).encode(),
        "records.json": json.dumps(frame.to_dicts()).encode(),
        "remarks.csv": ("# made by hand\n\n" + text).encode(),
    }.items():
        assert same(read(write(tmp_path, content, name)), expected), name
    assert same(read(tmp_path / "track.parquet"), expected)


@pytest.mark.parametrize(
    ("name", "write_time"),
    [
        ("timestamp", lambda s: f"{s}"),
        ("timestamp", lambda s: f"{s * 1000}"),
        ("timestamp", lambda s: f"{s * 10**6}"),
        ("timestamp", lambda s: f"{s * 10**9}"),
        ("time", lambda s: f"2021-10-07T12:12:{s % 60:02d}Z"),
        ("time", lambda s: f"2021-10-07 12:12:{s % 60:02d}.000"),
        ("time", lambda s: f"2021-10-07T14:12:{s % 60:02d}+02:00"),
        ("gps_time_s", lambda s: f"{s - GPS_MINUS_UNIX_S}"),
        ("time_ns", lambda s: f"{(s - GPS_MINUS_UNIX_S) * 10**9}"),
    ],
)
def test_a_time_is_the_same_instant_however_it_is_written(tmp_path: Path, name: str, write_time: object) -> None:
    assert callable(write_time)
    # 2021-10-07 12:12:53 UTC.
    rows = [f"{write_time(1633608773 + i)},48.9,2.5" for i in range(5)]
    times = read(write(tmp_path, table(*rows, header=f"{name},lat,lon"))).epochs["time_ns"]
    assert times.to_list() == [(1633608773 + i - GPS_MINUS_UNIX_S) * 10**9 for i in range(5)]


def test_week_and_time_of_week_are_gps_time(tmp_path: Path) -> None:
    text = "GPS TOW (s),GPS Week,Latitude (deg),Longitude (deg),Ellipsoid Height (m)\n194670.2, 2270, 35.16536109, 136.88140866, 41.391\n"
    first = read(write(tmp_path, text)).epochs.row(0, named=True)
    assert first["time_ns"] == 2270 * 604_800 * 10**9 + 194_670_200_000_000
    assert first["est_h_m"] == 41.391


def test_a_declared_column_goes_before_a_known_name(tmp_path: Path) -> None:
    text = "zeit,breite,laenge,latitude\n" + "".join(f"{1633608773 + i},{0.85 + i * 1e-6},0.04,95\n" for i in range(5))
    declared = {"time": "zeit:utc_s", "est_lat_rad": "breite", "est_lon_rad": "laenge:rad"}
    reading = read(write(tmp_path, text), columns=declared)
    assert reading.epochs["est_lat_rad"][0] == 0.85
    assert reading.unused == ["latitude"]
    with pytest.raises(InputError, match="known quantities"):
        read(write(tmp_path, text), columns={"breitengrad": "breite"})
    with pytest.raises(InputError, match="units of est_lat_rad"):
        read(write(tmp_path, text), columns=declared | {"est_lat_rad": "breite:furlong"})
    with pytest.raises(FormatError, match="there is no column “breit”; found: breite"):
        read(write(tmp_path, text), columns=declared | {"est_lat_rad": "breit:rad"})


def test_a_missing_column_is_named_with_the_nearest_present(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"est_lat_rad: no column holds it .* lattitude, ") as refusal:
        read(write(tmp_path, "time_utc,lattitude,longitude\n2021-10-07T12:00:00Z,48,2\n"))
    assert refusal.value.field == "est_lat_rad"


def test_our_own_epoch_table_comes_back(tmp_path: Path) -> None:
    own = read(write(tmp_path, table(*ROWS))).epochs
    own.write_parquet(tmp_path / "epochs.parquet")
    back = read(tmp_path / "epochs.parquet").epochs
    assert back.select(sorted(own.columns)).equals(own.select(sorted(own.columns)))


def test_a_time_beyond_every_calendar_is_no_time(tmp_path: Path) -> None:
    """1e18 ms would wrap around sixty-four bits and come out as a date."""
    reading = read(write(tmp_path, with_row(10, "4ca63a,1000000000000000000,48.9,2.5,3500,140,85.0,-700")))
    assert [(r.reason, r.count) for r in reading.rejected] == [("timestamp: not a time", 1)]


def test_what_was_understood_is_recorded(tmp_path: Path) -> None:
    text = table(*[f"{row},1200" for row in ROWS], header=f"{HEADER},squawk")
    reading = read(write(tmp_path, text))
    assert reading.unused == ["squawk"]
    assert reading.columns["time"] == "timestamp:utc_ms"
    assert reading.columns["altitude_m"] == "altitude:ft"
    naive = read(write(tmp_path, "time,lat,lon\n2021-10-07 12:00:00,48,2\n"))
    assert any("no time zone" in note for note in naive.notes)
    assert not any("no time zone" in note for note in read(write(tmp_path, "time,lat,lon\n2021-10-07 12:00:00Z,48,2\n")).notes)


@pytest.mark.parametrize(
    ("row", "reason", "text"),
    [
        ("4ca63a,1633608783000,95.0,2.5,3500,140,85,-700", "latitude: outside [-90, 90] deg", "95.0"),
        ("4ca63a,1633608783000,48.9,-200,3500,140,85,-700", "longitude: outside [-180, 360] deg", "-200"),
        ("4ca63a,1633608783000,nan,2.5,3500,140,85,-700", "latitude: empty", "nan"),
        ("4ca63a,1633608783000,inf,2.5,3500,140,85,-700", "latitude: not finite", "inf"),
        ("4ca63a,1633608783000,48°9,2.5,3500,140,85,-700", "latitude: not a number", "48°9"),
        ("4ca63a,1633608783000,,2.5,3500,140,85,-700", "latitude: empty", "None"),
        ("4ca63a,,48.9,2.5,3500,140,85,-700", "timestamp: empty", "None"),
        ("4ca63a,yesterday,48.9,2.5,3500,140,85,-700", "timestamp: not a time", "yesterday"),
        ("4ca63a,-5,48.9,2.5,3500,140,85,-700", "timestamp: time outside 1980 to 2100", "-5"),
        ("4ca63a,1633608782000,48.9,2.5,3500,140,85,-700", "time repeated within a track", "track 4ca63a"),
        ("4ca63a,1633608783000,48.9,2.5", "a row with another number of fields", "4ca63a,1633608783000,48.9,2.5"),
        ("4ca63a,1633608783000,48.9,2.5,3500,140,85,-700,9", "a row with another number of fields", "-700,9"),
        ('4ca63a,1633608783000,"48.9,2.5,3500,140,85,-700', "a row with another number of fields", '"48.9'),
    ],
)
def test_a_bad_row_is_left_out_and_counted_with_its_line_and_text(tmp_path: Path, row: str, reason: str, text: str) -> None:
    reading = read(write(tmp_path, with_row(10, row)))
    assert reading.epochs.height == 29
    (rejection,) = reading.rejected
    assert rejection.reason.startswith(reason)
    assert (rejection.count, rejection.first_line) == (1, 12)
    assert text in rejection.example


def test_a_bad_value_of_an_optional_column_costs_the_value_not_the_row(tmp_path: Path) -> None:
    reading = read(write(tmp_path, with_row(10, "4ca63a,1633608783000,48.9,2.5,3500,fast,85,-700")))
    assert reading.epochs.height == 30
    assert reading.epochs["ground_speed_mps"].null_count() == 1
    assert [(r.reason, r.first_line, r.example) for r in reading.rejected] == [
        ("groundspeed: not a number; row used without it", 12, "fast")
    ]


@pytest.mark.parametrize("nothing", ["nan", "NaN", "-nan", "nan(ind)", ""])
def test_an_outage_written_as_nan_is_a_row_without_levels_and_no_damage(tmp_path: Path, nothing: str) -> None:
    rows = [f"{1633608773 + i},{nothing if i % 4 == 0 else 9.5},{nothing if i % 4 == 0 else 14.5}" for i in range(40)]
    reading = read(write(tmp_path, table(*rows, header="unix_time,hpl_m,vpl_m")), needs=("hpl_m", "vpl_m"))
    assert reading.epochs.height == 40
    assert reading.epochs["hpl_m"].null_count() == reading.epochs["vpl_m"].null_count() == 10
    assert reading.rejected == []


def test_rows_that_cannot_be_taken_apart_were_recorded_all_the_same(tmp_path: Path) -> None:
    cut = table(*(row.rsplit(",", 2)[0] if k in {11, 22} else row for k, row in enumerate(ROWS)))
    reading = read(write(tmp_path, cut))
    assert (reading.epochs.height, reading.left_out.height) == (28, 2)
    assert reading.left_out["time_ns"].null_count() == 2


@pytest.mark.parametrize(("begin", "line"), [(0, 1), (20, 21)])
def test_lines_that_end_in_cr_alone_are_refused(tmp_path: Path, begin: int, line: int) -> None:
    lines = table(*ROWS).splitlines()
    with pytest.raises(FormatError, match=rf":{line}.*CR alone"):
        read(write(tmp_path, "".join(f"{each}\n" for each in lines[:begin]) + "\r".join(lines[begin:])))
    assert read(write(tmp_path, "\r\n".join(lines))).epochs.height == 30


@pytest.mark.parametrize("digits", [400, 5000])
def test_an_integer_of_any_length_is_a_number(tmp_path: Path, digits: int) -> None:
    rows = [{"time": 1_633_608_773 + k, "lat": 48.9 + 0.001 * k, "lon": 2.5} for k in range(30)]
    texts = [json.dumps(row) for row in rows]
    texts[10] = texts[10].replace("}", ', "n": ' + "9" * digits + "}")
    assert read(write(tmp_path, "\n".join(texts), "track.jsonl")).epochs.height == 30


def test_a_row_with_three_bad_values_is_one_malformed_row(tmp_path: Path) -> None:
    bad = [f"4ca63a,{1633608773000 + 1000 * i},48.9,2.5,high,fast,85.0,down" for i in range(3)]
    reading = read(write(tmp_path, table(*bad, *ROWS[3:])))
    assert reading.epochs.height == 30
    assert [r.count for r in reading.rejected] == [3, 3, 3]
    with pytest.raises(FormatError, match="4 of 30 rows are malformed"):
        read(write(tmp_path, table(*bad, ROWS[3].replace("140", "fast"), *ROWS[4:])))


def test_a_leap_second_in_text_is_an_instant_of_its_own(tmp_path: Path) -> None:
    """IERS bulletin C 52: 2016-12-31 ended with 23:59:60."""
    times = ["2016-12-31T23:59:59Z", "2016-12-31T23:59:60Z", "2016-12-31T23:59:60.5Z", "2017-01-01T00:00:00Z", "2017-01-01 05:29:60+05:30"]
    reading = read(write(tmp_path, "time,lat,lon\n" + "".join(f"{t},48,2\n" for t in times[:4])))
    assert reading.epochs["time_ns"].diff().to_list()[1:] == [1_000_000_000, 500_000_000, 500_000_000]
    assert reading.rejected == []
    zoned = read(write(tmp_path, f"time,lat,lon\n{times[4]},48,2\n", "zoned.csv"))
    assert zoned.epochs["time_ns"][0] == reading.epochs["time_ns"][1]


def test_a_sixty_first_second_where_none_was_is_no_time(tmp_path: Path) -> None:
    rows = [f"2021-10-07T12:{m:02d}:00Z,48,2" for m in range(20)]
    reading = read(write(tmp_path, "\n".join(["time,lat,lon", *rows, "2021-10-07T12:20:60Z,48,2"]) + "\n"))
    (rejection,) = reading.rejected
    assert (rejection.reason, rejection.example) == ("time: not a time", "2021-10-07T12:20:60Z")


def test_rows_out_of_order_are_put_in_order_and_reported(tmp_path: Path) -> None:
    reading = read(write(tmp_path, table(ROWS[1], ROWS[0], *ROWS[2:])))
    assert same(reading, read(write(tmp_path, table(*ROWS), "sorted.csv")))
    assert any("1 row stood after a later one of its track and was put in order" in note and "line 3" in note for note in reading.notes)


def test_more_than_a_tenth_of_bad_rows_refuses_the_file(tmp_path: Path) -> None:
    rows = [row.replace("48.9", "98.9") if i < 4 else row for i, row in enumerate(ROWS)]
    assert len(read(write(tmp_path, table(*ROWS[:3], *rows[3:]))).rejected) == 1
    with pytest.raises(FormatError, match=r"track\.csv:2: latitude: outside \[-90, 90\] deg: found “98\.900”; 4 of 30 rows") as refusal:
        read(write(tmp_path, table(*rows)))
    assert (refusal.value.line, refusal.value.field) == (2, "latitude")


def test_degrees_that_may_be_radians_are_reported(tmp_path: Path) -> None:
    rows = [f"{1633608773 + i},0.8541,0.0447" for i in range(5)]
    reading = read(write(tmp_path, table(*rows, header="timestamp,latitude,longitude")))
    assert any("small enough to be radians" in doubt for doubt in reading.position_doubts)
    assert not any("radians" in doubt for doubt in read(write(tmp_path, table(*ROWS))).position_doubts)


def test_state_vectors_in_si_are_not_taken_for_feet(tmp_path: Path) -> None:
    header = "time,icao24,lat,lon,velocity,heading,vertrate,callsign,onground,baroaltitude,geoaltitude"
    first = read(write(tmp_path, f"{header}\n1633608773,4ca63a,48.9,2.5,72.0,85.0,-3.5,AFR1,False,1000,1050\n")).epochs.row(0, named=True)
    assert (first["altitude_m"], first["est_h_m"], first["ground_speed_mps"], first["vertical_rate_mps"]) == (1000, 1050, 72, -3.5)
    assert first["ground_track_rad"] == pytest.approx(math.radians(85), rel=1e-15)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "the file is empty"),
        (b"  \n \n", "the file is empty"),
        (HEADER.encode(), "no rows below the header"),
        (b"# only\n# remarks\n", "nothing but comments"),
        (gzip.compress(table(*ROWS).encode(), mtime=0)[:-20], "gzip stream is damaged"),
        (gzip.compress(table(*ROWS).encode(), mtime=0)[:30] + b"\0" * 40, "gzip stream is damaged"),
        (b"latitude,longitude\n\xff\xfe1,2\n", "not UTF-8 text: bytes ff fe 31"),
        (b"a,b\0c\n1,2\n", "zero bytes"),
        (b"PAR1 but not really", "damaged Parquet file"),
        (b'{"latitude": {"0": 1}', "not JSON"),
        (b"[1, 2, 3]", "a list of records"),
        (b"{}", "no columns"),
        (b'{"latitude": 3}', "neither a column"),
        (b'{"latitude": {"0": 1}, "longitude": {"1": 1}}', "name different rows"),
        (b'{"latitude": [1], "longitude": [1, 2]}', "columns of 1 and 2 items"),
        (b'{"time": [1], "latitude": [[1]], "longitude": [1]}', "holds List(Int64)"),
        (b"[" * 200_000, "nested too deeply"),
        (b'[{"time": 1, "lat": 1, "lon": 2, "icao24": "\\ud800"}]', "half of a character: \\ud800"),
        (b"time,time,lat,lon\n1,2,3,4\n", "named twice"),
        (b'{"timestamp": 1, "trace": [[1, 2]]}', "not a readsb trace"),
        (b"%  GPST latitude(deg)\n", "the columns after 'latitude(deg)'"),
        (b"%  GPST latitude(deg) longitude(deg) height(m)\n", "no row holds"),
        (b"% nothing\n1 2 3\n", "names the columns"),
        (b"timestamp,lat,lon\n5,1,2\n", "are not Unix times"),
        (b"gps_s,lat,lon\n1176498287,452206015,-931453379\n", 'are declared with --map "est_lat_rad=lat:deg_e7"'),
    ],
)
def test_a_file_that_cannot_be_interpreted_is_refused_in_words(tmp_path: Path, content: bytes, says: str) -> None:
    with pytest.raises(FormatError, match=r"/file(:\d+)?: ") as refusal:
        read(write(tmp_path, content, "file"))
    assert says in str(refusal.value)
    assert refusal.value.path == tmp_path / "file"


def test_no_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="no such file"):
        read(tmp_path / "absent.csv")
    with pytest.raises(FormatError, match="cannot be read"):
        read(tmp_path)


@given(
    content=st.one_of(
        st.binary(max_size=200),
        st.text(max_size=200).map(str.encode),
        st.lists(
            st.lists(st.sampled_from(["1633608773", "48.9", "", "x", '"', "nan", "-1e400", "2021-10-07T12:00:00Z"]), max_size=4), max_size=6
        ).map(lambda rows: ("timestamp,latitude,longitude\n" + "\n".join(",".join(r) for r in rows)).encode()),
        st.recursive(
            st.none() | st.booleans() | st.floats() | st.text(max_size=5),
            lambda v: st.lists(v) | st.dictionaries(st.text(max_size=4), v),
            max_leaves=12,
        ).map(lambda v: json.dumps({"timestamp": [v, 1], "latitude": [1, v], "longitude": [v, v]}).encode()),
    )
)
@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes_are_read_or_refused(tmp_path: Path, content: bytes) -> None:
    file = write(tmp_path, content, "any")
    try:
        reading = read(file)
    except NavboundError:
        return
    assert reading.epochs.height > 0
    assert reading.epochs.select(pl.col("time_ns", "est_lat_rad", "est_lon_rad").is_not_null().all()).row(0) == (True, True, True)
    assert reading.source.n_rows is not None
    used_without = sum(r.count for r in reading.rejected if "used without" not in r.reason)
    assert reading.epochs.height + used_without == reading.source.n_rows


def of_columns(tmp_path: Path, *names: str, value: str = "1.0") -> Path:
    """A table with these columns beside time and position."""
    rows = [",".join(("time", "lat", "lon", *names))]
    rows += [f"2026-11-22T12:00:{k:02d}Z,{49 + k * 3e-4:.6f},2.5" + f",{value}" * len(names) for k in range(30)]
    path = tmp_path / "units.csv"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("name", "metres"),
    [
        ("HPL [NM]", 1852.0),
        ("HPL [nmi]", 1852.0),
        ("HPL / NM", 1852.0),
        ("hpl_NM", 1852.0),
        ("HPL (nautical miles)", 1852.0),
        ("HPL [km]", 1000.0),
        ("hpl_km", 1000.0),
        ("HPL (kilometres)", 1000.0),
        ("hpl [feet]", 0.3048),
        ("hpl_cm", 0.01),
        ("hpl", 1.0),
        ("hpl ()", 1.0),
    ],
)
def test_a_unit_in_the_name_of_a_column_is_the_unit(tmp_path: Path, name: str, metres: float) -> None:
    assert read(of_columns(tmp_path, name)).epochs["hpl_m"].to_list() == [metres] * 30


@pytest.mark.parametrize("name", ["HPL [furlong]", "sdn [95%]", "hpl (2 sigma)", "Height [hPa]", "sde [nmile]"])
def test_a_unit_that_is_not_known_is_no_other(tmp_path: Path, name: str) -> None:
    with pytest.raises(FormatError, match=r"its unit “.*” is not known \(known: m, metre"):
        read(of_columns(tmp_path, name))


def test_a_pipe_is_refused_with_what_to_do(tmp_path: Path) -> None:
    """Every file is looked at before it is read, and what was looked at is gone from a pipe: the reading waited for ever."""
    os.mkfifo(tmp_path / "pipe.csv")
    with pytest.raises(FormatError, match="a pipe, not a file; write what comes out of it to a file first"):
        read(tmp_path / "pipe.csv")


def test_a_device_is_no_file() -> None:
    with pytest.raises(FormatError, match="a device, not a file"):
        read("/dev/zero")


def test_objects_within_objects_without_end_are_text(tmp_path: Path) -> None:
    """A type of 300 levels took minutes."""
    deep = "0"
    for _ in range(300):
        deep = f'{{"a": {deep}}}'
    rows = ", ".join(f'{{"time": {1764300000 + k}, "lat": {49 + 1e-3 * k}, "lon": 2.5, "nac_p": 9, "x": {deep}}}' for k in range(30))
    (tmp_path / "a.json").write_text(f"[{rows}]")
    assert read(tmp_path / "a.json").epochs.height == 30


@pytest.mark.parametrize("text", ['[{"time": 1, "time": 2, "lat": 1, "lon": 2}]', '{"time": [1], "lat": [1], "lon": [2], "lat": [3]}'])
def test_a_key_that_stands_twice_in_an_object_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(FormatError, match=r"a.json: (time|lat): an object has the key “(time|lat)” twice"):
        read(tmp_path / "a.json")


WEEK_ROWS = [[2300, 100.0 + k, 48.0 + 1e-5 * k, 2.0, 3.0, 3.0] for k in range(5)]


@pytest.mark.parametrize(
    ("names", "declared"),
    [
        (("GpsWeek", "GpsTow [s]"), {"gps_week": "GpsWeek", "gps_tow_s": "GpsTow [s]"}),
        (("gps_week", "my_tow"), {"gps_tow_s": "my_tow"}),
        (("my_week", "tow"), {"gps_week": "my_week"}),
        (("my_week", "tow"), {"time": "my_week:gps_week"}),
        (("week", "my_tow"), {"time": "my_tow:gps_tow_s"}),
    ],
)
def test_week_and_time_of_week_are_declared_by_their_own_keys(tmp_path: Path, names: tuple[str, str], declared: dict[str, str]) -> None:
    head = ",".join((*names, "lat", "lon", "sigma_e_m", "sigma_n_m"))
    path = tmp_path / "a.csv"
    path.write_text("\n".join([head, *(",".join(map(str, row)) for row in WEEK_ROWS)]) + "\n", encoding="utf-8")
    reading = read(path, columns=declared)
    # 2300 weeks of 604 800 s and 100 s of the next one.
    assert reading.epochs["time_ns"][0] == (2300 * 604_800 + 100) * 1_000_000_000


@pytest.mark.parametrize("declared", [{"time": "a:gps_week"}, {"time": "a:gps_tow_s"}, {"gps_week": "a"}, {"gps_tow_s": "a"}])
def test_a_week_without_a_time_of_week_is_refused_with_the_way_out(tmp_path: Path, declared: dict[str, str]) -> None:
    path = tmp_path / "a.csv"
    path.write_text("a,lat,lon\n2300,48,2\n2300,48,2\n", encoding="utf-8")
    with pytest.raises(FormatError, match=r"no column is a (GPS week|time of week); declare it: --map \"gps_(week|tow_s)=COLUMN\""):
        read(path, columns=declared)


@pytest.mark.parametrize(("unit", "scale"), [("gps_s", 1), ("gps_ms", 10**3), ("gps_us", 10**6), ("gps_ns", 10**9)])
def test_gps_times_are_read_in_every_unit_and_small_ones_are_doubted(tmp_path: Path, unit: str, scale: int) -> None:
    for second, doubted in ((1_400_000_000, False), (7, True)):
        path = tmp_path / f"{unit}_{second}.csv"
        path.write_text("t,lat,lon\n" + "".join(f"{(second + k) * scale},48,2\n" for k in range(5)), encoding="utf-8")
        reading = read(path, columns={"time": f"t:{unit}"})
        assert reading.epochs["time_ns"].to_list() == [(second + k) * 10**9 for k in range(5)]
        assert any("time since some start" in note for note in reading.notes) == doubted


def test_remarks_between_rows_are_counted(tmp_path: Path) -> None:
    """Thirty lines of `# GPS LOST` vanished without a word."""
    rows = [
        f"2026-11-22T12:00:{k:02d}Z,{49 + k * 1e-4:.5f},2.5" + ("" if k % 2 == 0 else "\n# recorder v2" if k == 1 else "\n# GPS LOST")
        for k in range(60)
    ]
    text = "\n".join(["# what it is", "time,lat,lon", *rows]) + "\n"
    (tmp_path / "a.csv").write_text(text)
    reading = read(tmp_path / "a.csv")
    (rejection,) = reading.rejected
    assert (rejection.reason, rejection.count, rejection.first_line) == ("a line that begins with #, which is a remark", 30, 8)
    assert rejection.example == "# GPS LOST"
    assert len(reading.epochs) == 60
    pieces = read_pieces(tmp_path / "a.csv", piece_rows=20)
    assert sum(piece.height for piece in pieces.epochs()) == 60
    assert [(each.count, each.first_line) for each in pieces.rejected] == [(30, 8)]
    pieces.pieces.close()


def test_sentences_without_a_position_are_no_table(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("$LXWP0,Y,222.3,1665.5,0.03,0.03,0.03*4E\r\n" * 20)
    with pytest.raises(FormatError, match="sentences such as “\\$LXWP0"):
        read(tmp_path / "a.txt")


def test_an_accuracy_that_a_row_of_units_gives_in_degrees_is_no_length(tmp_path: Path) -> None:
    """FlySight writes `cAcc`, the accuracy of the course."""
    for name in ("cAcc", "heading_accuracy_of_receiver", "accuracy_x1"):
        rows = [f"2017-06-03T11:58:{k:02d}Z,{48 + k * 1e-5:.5f},2.5,1200.0,170.0" for k in range(60)]
        (tmp_path / "a.csv").write_text("\n".join(["time,lat,lon,hMSL," + name, ",(deg),(deg),(m),(deg)", *rows]) + "\n")
        assert navbound.analyze(tmp_path / "a.csv", sigma_m=5.0).summary.verdict.n_stated_worse == 0


def test_a_row_with_two_faults_is_malformed_once(tmp_path: Path) -> None:
    """Six of 100 rows lack a place, and say nonsense of their speed: no more than the tenth that may be left out."""
    rows = [f"{1_700_000_000 + k},{'bad' if k % 17 == 3 else 48 + k * 1e-4},2.5,{'?!' if k % 17 == 3 else 11.1}" for k in range(100)]
    (tmp_path / "a.csv").write_text("\n".join(["time,lat,lon,speed_mps", *rows]) + "\n")
    assert navbound.analyze(tmp_path / "a.csv", sigma_m=5.0).summary.verdict.n_missing == 6


def test_a_decimal_comma_is_named(tmp_path: Path) -> None:
    rows = [f"{1_700_000_000 + k};48,38{k:02d};2,5" for k in range(60)]
    (tmp_path / "a.csv").write_text("\n".join(["time;lat;lon", *rows]) + "\n")
    with pytest.raises(
        FormatError, match=r"60 of 60 rows are malformed.*numbers with a decimal comma are not read: write them with a point"
    ):
        navbound.analyze(tmp_path / "a.csv", sigma_m=5.0)


@pytest.mark.parametrize("names", [("BaseDateTime", "LAT", "LON"), ("timestamp", "location-lat", "location-long")])
def test_names_of_ships_and_of_animals_are_known(tmp_path: Path, names: tuple[str, str, str]) -> None:
    rows = [f"2023-05-01T12:00:{k:02d},{48 + k * 1e-5:.5f},2.5" for k in range(60)]
    (tmp_path / "a.csv").write_text("\n".join([",".join(names), *rows]) + "\n")
    assert navbound.analyze(tmp_path / "a.csv", sigma_m=5.0).summary.verdict.id == "inside"
