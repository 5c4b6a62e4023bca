"""What a user meets who tries the tool on a public recording: refusals that state what is missing, columns that are what they look like."""

from __future__ import annotations

import datetime as dt
import gzip
import json
import re
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import polars as pl
import pytest

import navbound
from navbound import FormatError, InputError, write
from navbound.cli import main as cli
from navbound.read import read
from navbound.read.columns.place_names import other_place
from navbound.read.pieces.reading import read_pieces
from navbound.words.plurals import counted
from test_write import table as solution

if TYPE_CHECKING:
    from navbound.run.directory import Run


def test_a_solution_file_without_a_vertical_covariance_is_refused_by_what_it_lacks(tmp_path: Path) -> None:
    vertical = [pl.lit(None, pl.Float64).alias(name) for name in ("cov_eu_m2", "cov_nu_m2", "cov_uu_m2")]
    with pytest.raises(
        InputError, match=r"a table of 2 epochs, 2 without a vertical covariance \(cov_eu_m2, cov_nu_m2, cov_uu_m2\) is not"
    ):
        write.rtklib(solution(2).with_columns(vertical), tmp_path / "a.pos")
    with pytest.raises(
        InputError, match=r"a table of 1 epoch, 1 without a height \(est_h_m\) is .* \.geojson and \.kml need no covariance"
    ):
        write.rtklib(solution(1).drop("est_h_m"), tmp_path / "a.pos")


def _way(n: int = 60, /, **columns: Any) -> pl.DataFrame:
    """Positions of n seconds on end, some 60 m apart, and further columns."""
    at = pl.int_range(n, eager=True)
    start = dt.datetime(2024, 5, 13, 12, 30)
    times = [f"{start + dt.timedelta(seconds=k):%Y-%m-%dT%H:%M:%SZ}" for k in range(n)]
    plain: dict[str, Any] = {"time": times, "lat": 48.0 + at * 5e-4, "lon": 11.0 + at * 3e-4}
    return pl.DataFrame({name: values for name, values in (plain | columns).items() if values is not None})


def _analyzed(tmp_path: Path, table: pl.DataFrame, name: str = "a.csv", **settings: Any) -> Run:
    table.write_csv(tmp_path / name)
    stated: dict[str, Any] = {"sigma_m": 5.0, "out": tmp_path / "run"}
    return navbound.analyze(tmp_path / name, **stated | settings)


def test_resets_of_a_position_are_no_other_place(tmp_path: Path) -> None:
    # `vehicle_global_position` of PX4 counts the resets of its position, and has the step of the last one in degrees.
    later = [0] * 30 + [3] * 30
    resets = {"lat_lon_reset_counter": later, "delta_lat_lon[0]": [k * 1e-2 for k in later], "delta_lat_lon[1]": [k * -2e-2 for k in later]}
    run = _analyzed(tmp_path, _way(**resets, lat_dot=[k * 1e-2 for k in later]))
    assert run.summary.verdict.id == "inside"
    assert "another position" not in run.summary.verdict.words
    assert not any(other_place(name) for name in (*resets, "lat_rate", "lon_variance"))
    assert other_place("lat2") is not None


@pytest.mark.parametrize("name", ["gps2_{}_reset", "{}_count", "count_{}", "delta_{}", "true_{}_reset_counter", "gps_delta_{}"])
def test_a_name_of_a_count_or_a_step_hides_no_place(tmp_path: Path, name: str) -> None:
    at = pl.int_range(60, eager=True)
    other = {name.format("lat"): 48.5 + at * 5e-4, name.format("lon"): 11.0 + at * 3e-4}
    assert _analyzed(tmp_path, _way(**other)).summary.verdict.id == "not_shown"


@pytest.mark.parametrize(
    ("name", "value", "verdict"), [("ANP (nm)", 1.0, "outside"), ("ANP [m]", 2000.0, "outside"), ("anp_nm", 0.01, "inside")]
)
def test_a_navigation_performance_that_is_stated_is_an_accuracy(tmp_path: Path, name: str, value: float, verdict: str) -> None:
    run = _analyzed(tmp_path, _way(**{name: [value] * 60}), sigma_m=None)
    assert run.summary.verdict.id == verdict


def test_a_navigation_performance_without_a_unit_is_named_and_compared_in_metres(tmp_path: Path) -> None:
    verdict = _analyzed(tmp_path, _way(ANP=[2000.0] * 60)).summary.verdict
    assert (verdict.id, verdict.unread, verdict.n_stated_worse) == ("not_shown", ["ANP"], 60)


@pytest.mark.parametrize("name", ["Altitude (Ellipsoid)", "Alt (HAE)", "height-above-ellipsoid", "altitude_ellipsoid", "alt_ellipsoid_m"])
def test_a_height_above_the_ellipsoid_beside_an_altitude_is_the_height(tmp_path: Path, name: str) -> None:
    run = _analyzed(tmp_path, _way(**{"Altitude (ft)": [1000.0] * 60, name: [351.5] * 60}))
    assert run.epochs["est_h_m"].to_list() == [351.5] * 60
    assert run.epochs["altitude_m"].to_list() == pytest.approx([304.8] * 60)


def test_of_two_heights_of_one_kind_nothing_is_guessed(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"“Altitude” and “altitude \(m\)” are one name in another writing"):
        _analyzed(tmp_path, _way(**{"Altitude": [1000.0] * 60, "altitude (m)": [304.8] * 60}))
    # An autopilot writes it in metres in one table and in millimetres in another.
    assert "est_h_m" not in _analyzed(tmp_path, _way(alt_ellipsoid=[351_500] * 60)).epochs.columns


def _clock(n: int = 60, pattern: str = "%H:%M:%S.5") -> list[str]:
    return [f"{dt.datetime(2024, 5, 13, 12, 30) + dt.timedelta(seconds=k):{pattern}}" for k in range(n)]


FIRST = dt.datetime(2024, 5, 13, 12, 30, 0, 500_000)


@pytest.mark.parametrize(
    ("date", "text", "time"),
    [
        ("Date", "2024-05-13", "Time"),
        ("UTC Date", "2024/5/13", "UTC Time"),
        ("date", "20240513", "utc"),
        ("date", "13-May-2024", "time"),
        ("UTC_date", "13.05.2024", "UTC_time"),
        ("date", "05/13/2024", "time_utc"),
        ("date", "2024-05-13 00:00:00", "time"),
    ],
)
@pytest.mark.parametrize("piece_rows", [None, 20])
def test_a_date_and_a_time_of_day_are_one_time(tmp_path: Path, date: str, text: str, time: str, piece_rows: int | None) -> None:
    _way(**{"time": None, date: [text] * 60, time: _clock()}).write_csv(tmp_path / "a.csv")
    if piece_rows is None:
        epochs, notes = (reading := read(tmp_path / "a.csv")).epochs, reading.notes
    else:
        in_pieces = read_pieces(tmp_path / "a.csv", piece_rows=piece_rows)
        epochs, notes = pl.concat(in_pieces.epochs()), in_pieces.notes
    assert epochs["time_ns"][0] == gps_ns(FIRST)
    assert epochs["time_ns"][-1] == gps_ns(FIRST + dt.timedelta(seconds=59))
    assert any("have no time zone and were read as UTC" in note for note in notes) == ("utc" not in (date + time).lower())


def gps_ns(utc: dt.datetime) -> int:
    """18 leap seconds since 2017."""
    since = utc - dt.datetime(1980, 1, 6)
    return (since // dt.timedelta(microseconds=1)) * 1000 + 18 * 10**9


def _dates(tmp_path: Path, dates: list[str], **settings: Any) -> pl.DataFrame:
    n = len(dates)
    _way(n, time=None, Date=dates, Time=_clock(n)).write_csv(tmp_path / "a.csv")
    return read(tmp_path / "a.csv", **settings).epochs


def test_the_order_of_day_and_month_is_decided_by_rows_or_by_the_caller_and_never_guessed(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r'“03/04/2024” is one day .* --map "utc_date=Date:dmy" or --map "utc_date=Date:mdy"'):
        _dates(tmp_path, ["03/04/2024"] * 20)
    for order, month, day in (("dmy", 4, 3), ("mdy", 3, 4)):
        epochs = _dates(tmp_path, ["03/04/2024"] * 20, columns={"utc_date": f"Date:{order}"})
        assert epochs["time_ns"][0] == gps_ns(FIRST.replace(month=month, day=day))
    # A later row decides, and the note says which.
    dates = ["12/05/2024"] * 10 + ["13/05/2024"] * 10
    assert _dates(tmp_path, dates)["time_ns"][0] == gps_ns(FIRST.replace(day=12))
    assert any("“Date” has the day first in all rows, as “13/05/2024” shows" in note for note in read(tmp_path / "a.csv").notes)
    # Both orders give this day.
    assert _dates(tmp_path, ["05/05/2024"] * 20)["time_ns"][0] == gps_ns(FIRST.replace(day=5))
    with pytest.raises(FormatError, match="“13/05/2024” has the day first, and “05/13/2024” the month"):
        _dates(tmp_path, ["13/05/2024"] * 10 + ["05/13/2024"] * 10)
    with pytest.raises(FormatError, match=r"Date and Time: not a time: found “13/05/24 12:30:00\.5”"):
        _dates(tmp_path, ["13/05/24"] * 20)
    with pytest.raises(FormatError, match="Date and Time: not a time"):
        _dates(tmp_path, ["03/04/2024"] * 20, columns={"utc_date": "Date:ymd"})
    with pytest.raises(InputError, match="orders of a date: ymd, dmy, mdy"):
        _dates(tmp_path, ["03/04/2024"] * 20, columns={"utc_date": "Date:dym"})


@pytest.mark.parametrize(("pattern", "last"), [("%I:%M:%S %p", 59), ("%H:%M:%SZ", 59), ("%H:%M:%S,0", 59)])
def test_a_time_of_day_may_be_of_half_a_day(tmp_path: Path, pattern: str, last: int) -> None:
    _way(time=None, date=["2024-05-13"] * 60, utc=_clock(pattern=pattern)).write_csv(tmp_path / "a.csv")
    assert read(tmp_path / "a.csv").epochs["time_ns"][-1] == gps_ns(FIRST.replace(microsecond=0) + dt.timedelta(seconds=last))


def test_a_whole_time_goes_before_a_time_of_day(tmp_path: Path) -> None:
    # The tables of Ornitela's loggers.
    apart = {"UTC_datetime": _clock(pattern="%Y-%m-%d %H:%M:%S"), "UTC_date": ["2024-05-13"] * 60, "UTC_time": _clock(pattern="%H:%M:%S")}
    run = _analyzed(tmp_path, _way(time=None, **apart))
    assert run.summary.verdict.id == "inside"
    assert run.epochs["time_ns"][0] == gps_ns(FIRST.replace(microsecond=0))


def test_a_time_of_day_without_a_date_says_what_is_missing(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r'“time” holds times of day and no date, .*--map "utc_date=COLUMN" --map "utc_time_of_day=time"'):
        _analyzed(tmp_path, _way(time=_clock()))
    day = _way(time=None, jour=["2024-05-13"] * 60, heure=_clock())
    declared = {"utc_date": "jour", "utc_time_of_day": "heure"}
    assert _analyzed(tmp_path, day, columns=declared).epochs["time_ns"][0] == gps_ns(FIRST)
    with pytest.raises(FormatError, match="“jour” is a date, and no column is a time of day"):
        _analyzed(tmp_path, day, columns={"utc_date": "jour"})
    with pytest.raises(FormatError, match="Times of day are read as 12:30:01, with a column of their dates"):
        _analyzed(tmp_path, _way(time=[123_000 + k for k in range(60)], date=[130_524] * 60))


def _sentence(words: str) -> str:
    checksum = 0
    for letter in words:
        checksum ^= ord(letter)
    return f"${words}*{checksum:02X}\r\n"


def _rmc(n: int = 3) -> str:
    return "".join(_sentence(f"GPRMC,1230{k:02d}.00,A,4800.{k:04d},N,01100.0000,E,120.0,021.0,130524,,,A") for k in range(n))


def _gll(n: int = 3) -> str:
    return "".join(_sentence(f"GPGLL,4800.{k:04d},N,01100.0000,E,1230{k:02d}.00,A,A") for k in range(n))


def test_sentences_of_a_place_alone_say_what_they_lack(tmp_path: Path) -> None:
    (tmp_path / "a.nmea").write_text(_gll())
    with pytest.raises(FormatError, match=r"its 3 GLL sentences state latitude and longitude without a date.*Switch GGA on .*--sigma-m"):
        read(tmp_path / "a.nmea")
    undated = (_sentence(f"GPRMC,1230{k:02d}.00,A,4800.{k:04d},N,01100.0000,E,120.0,21.0,,,,A") for k in range(3))
    (tmp_path / "b.nmea").write_text("".join(undated))
    with pytest.raises(FormatError, match=r"3 RMC sentences hold a time of day and no date"):
        read(tmp_path / "b.nmea")


def test_live_says_which_sentences_are_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.nmea").write_text(_gll())
    assert _navbound("live", tmp_path / "a.nmea", "--format", "nmea", "--sigma-m", "5", "--out", tmp_path / "live") == 4
    words = " ".join(capsys.readouterr().out.split())
    assert "positions are read of GGA, or RMC where no GGA comes, dated by RMC or ZDA" in words


def _navbound(*arguments: object) -> int:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("sys.argv", ["navbound", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
    return int(ended.value.code or 0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--speed", "fast"), "--speed = fast is not accepted; expected a number; it is: Of a file: times its own pace, 0 or more;"),
        (("--speed", "-1"), "--speed = -1.0 [1] is outside [0, inf)"),
        (("--port", "1.5"), "--port = 1.5 is not accepted; expected a whole number; it is: Port of the display."),
        (("--format", "csv"), "--format = csv is not accepted; expected one of json, readsb,"),
    ],
)
def test_a_wrong_number_says_what_is_allowed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, str], words: str
) -> None:
    (tmp_path / "a.nmea").write_text(_rmc())
    assert _navbound("live", tmp_path / "a.nmea", *arguments) == 2
    assert words in capsys.readouterr().err


def test_evaluate_names_the_commands_for_positions_without_levels(tmp_path: Path) -> None:
    write.rtklib(solution(20), tmp_path / "a.pos")
    _way(20).write_csv(tmp_path / "a.csv")
    for name in ("a.pos", "a.csv"):
        with pytest.raises(FormatError, match=r"hpl_m: no column holds .*`navbound analyze`; .* by `navbound evaluate --protection`"):
            navbound.evaluate(tmp_path / name, levels="APV-I", out=tmp_path / "run")


def _json(n: int = 20) -> list[dict[str, Any]]:
    return _way(n).to_dicts()


@pytest.mark.parametrize("back", [1, 3, 7, 21, 40, 60])
def test_a_json_file_that_is_cut_says_where_it_ends(tmp_path: Path, back: int) -> None:
    """Within a number, a name, a time and between them."""
    whole = json.dumps(_json(), indent=1)
    (tmp_path / "a.json").write_text(part := whole[:-back].rstrip())
    with pytest.raises(FormatError, match=rf"ends in line \d+, after byte {len(part)}, .*the file looks cut: get it whole") as refused:
        read(tmp_path / "a.json")
    assert refused.value.line == part.count("\n") + 1


@pytest.mark.parametrize("back", [1, 5, 12, 30])
def test_json_lines_that_are_cut_say_so(tmp_path: Path, back: int) -> None:
    whole = "\n".join(json.dumps(record) for record in _json())
    (tmp_path / "a.json").write_text(whole[:-back])
    with pytest.raises(FormatError, match=rf"on each line: the text ends in line 20, after byte {len(whole) - back}, .*looks cut"):
        read(tmp_path / "a.json")


@pytest.mark.parametrize("text", ['[{"a": foo', "[1, 2}", "[1] 5", '{"a": 1} 5', '[{"a" 1}]'])
def test_other_faults_of_json_are_no_cut(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(FormatError) as refused:
        read(tmp_path / "a.json")
    assert "cut" not in refused.value.message


def test_a_gzip_file_that_is_cut_says_how_much_of_it_there_is(tmp_path: Path) -> None:
    plain = _way().write_csv().encode()
    whole = gzip.compress(plain, mtime=0)
    two = gzip.compress(plain[:100], mtime=0) + whole
    for stored in (
        whole[:-1],
        whole[:-8],
        whole[: len(whole) // 2],
        whole[:11],
        two[:-20],
        two[: len(two) - len(whole) + 2],
        two[: len(two) - len(whole) + 1],
    ):
        (tmp_path / "a.csv.gz").write_bytes(stored)
        n_plain = _unpacked(stored)
        words = rf"the gzip stream is damaged: it ends .* after {len(stored)} bytes, which unpack to {n_plain}; the file looks cut: get it"
        with pytest.raises(FormatError, match=words):
            read(tmp_path / "a.csv.gz")
    (tmp_path / "a.csv.gz").write_bytes(whole[:-8] + b"\0" * 8)
    with pytest.raises(FormatError, match="the gzip stream is damaged: ") as refused:
        read(tmp_path / "a.csv.gz")
    assert "cut" not in refused.value.message


def _unpacked(stored: bytes) -> int:
    """By another way: one byte at a time, of each member."""
    stream, n = zlib.decompressobj(31), 0
    for k in range(len(stored)):
        if stream.eof:
            stream = zlib.decompressobj(31)
        n += len(stream.decompress(stored[k : k + 1]))
    return n


def _altitudes(n: int = 60) -> list[float]:
    return [500.0 + 2.0 * k for k in range(n)]


@pytest.mark.parametrize(
    "beside",
    [
        # Sensor Logger, Android, OwnTracks, a browser.
        {"horizontalAccuracy": 4.0, "verticalAccuracy": 6.0, "speedAccuracy": 1.0, "bearingAccuracy": 3.0},
        {"accuracy": 4.0, "verticalAccuracyMeters": 6.0},
        {"horizontal_accuracy": 4.0, "vertical_accuracy": 6.0},
        {"accuracy": 4.0, "altitudeAccuracy": 6.0},
    ],
)
def test_the_altitude_of_a_phone_is_in_metres(tmp_path: Path, beside: dict[str, float]) -> None:
    table = _way(altitude=_altitudes()).with_columns(**{name: pl.lit(value) for name, value in beside.items()})
    table.write_csv(tmp_path / "a.csv")
    reading = read(tmp_path / "a.csv")
    assert reading.epochs["altitude_m"].to_list() == _altitudes()
    (note,) = [each for each in reading.notes if "“altitude”" in each]
    assert "states no unit and is read in metres, as the names “" in note
    assert '--map "altitude_m=altitude:ft"' in note
    in_feet = read(tmp_path / "a.csv", columns={"altitude_m": "altitude:ft"})
    assert in_feet.epochs["altitude_m"][0] == pytest.approx(152.4)
    # States of transponders have it in feet, whatever else they have.
    table.with_columns(icao24=pl.lit("4ca123")).write_csv(tmp_path / "a.csv")
    assert read(tmp_path / "a.csv").epochs["altitude_m"][0] == pytest.approx(152.4)


@pytest.mark.parametrize("piece_rows", [None, 20])
@pytest.mark.parametrize(
    ("beside", "metres"),
    [
        ({"Altitude (Ellipsoid)": [547.0 + 2.0 * k for k in range(60)]}, True),
        ({"height_m": [547.0 + 2.0 * k for k in range(60)]}, True),
        ({"height_m": [0.3048 * (500.0 + 2.0 * k) + 47.0 for k in range(60)]}, False),
        # Its unit rests on its name, too.
        ({"height": [547.0 + 2.0 * k for k in range(60)]}, False),
        ({"climb_rate_mps": [2.0] * 60}, True),
        ({"climb_rate_mps": [2.0 * 0.3048] * 60}, False),
        ({"vertical_rate (m/s)": [2.0] * 60}, True),
        ({"vertical_rate": [2.0 * 60] * 60}, False),
        ({"height_m": [547.0 + 2.0 * k for k in range(60)], "climb_rate_mps": [2.0 * 0.5] * 60}, False),
    ],
)
def test_a_height_or_a_climb_rate_decides_the_unit_of_an_altitude(
    tmp_path: Path, beside: dict[str, list[float]], metres: bool, piece_rows: int | None
) -> None:
    _way(altitude=_altitudes(), **beside).write_csv(tmp_path / "a.csv")
    if piece_rows is None:
        epochs, notes = (reading := read(tmp_path / "a.csv")).epochs, reading.notes
    else:
        in_pieces = read_pieces(tmp_path / "a.csv", piece_rows=piece_rows)
        epochs, notes = pl.concat(in_pieces.epochs()), in_pieces.notes
    assert epochs["altitude_m"].to_list() == pytest.approx([value * (1.0 if metres else 0.3048) for value in _altitudes()])
    agrees = f"“altitude” states no unit and is read in metres, in which it agrees with “{next(iter(beside))}” at "
    assert any(agrees in each for each in notes) == metres
    assert any("“altitude” states no unit and is read in feet" in each for each in notes) != metres


_WRONG_PLURAL = re.compile(r"(?<![\d.,])\b1 (?:[a-z]+ ){0,3}(?:[a-z]+s)\b(?<!has)(?<!is)(?<!was)(?<!ss)(?<!this)")


def test_of_one_there_is_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One epoch, one track, one row that is not used."""
    plain = _way(2).with_columns(epu_m=pl.lit(20.0), hpl=pl.lit(30.0), hpe=pl.lit(10.0), vpl=pl.lit(30.0), vpe=pl.lit(5.0))
    table = plain.with_columns(lat=pl.when(pl.col("lat") > 48.0).then(pl.lit("none")).otherwise(pl.col("lat").cast(pl.String)))
    table[:1].write_csv(tmp_path / "one.csv")
    _navbound("analyze", tmp_path / "one.csv", "--out", tmp_path / "run")
    _navbound("show", tmp_path / "run")
    _navbound("evaluate", tmp_path / "one.csv", "--levels", "APV-I", "--out", tmp_path / "levels")
    (tmp_path / "one.nmea").write_text(_rmc(1) + _sentence("GPGGA,123000.00,4800.0000,N,01100.0000,E,1,08,1.0,500.0,M,47.0,M,,"))
    _navbound("live", tmp_path / "one.nmea", "--sigma-m", "5", "--out", tmp_path / "live")
    words = " ".join(capsys.readouterr().out.split())
    for each in ("the one epoch is ok and judged", "over 1 track.", "1 epoch of 1 track, "):
        assert each in words
    assert not (wrong := [match[0] for match in _WRONG_PLURAL.finditer(words)]), wrong


@pytest.mark.parametrize(
    ("n", "words"), [(0, "0 losses are"), (1, "1 loss is"), (2, "2 losses are"), (1.0, "1 loss is"), (1_234_567, "1234567 losses are")]
)
def test_a_noun_agrees_with_its_number(n: float, words: str) -> None:
    assert counted(n, "loss is", "losses are") == words
    assert counted(n, "epoch") == f"{n:.0f} epoch" + "s" * (n != 1)
