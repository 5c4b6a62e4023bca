"""Whose position a row states and when it was valid: one aircraft's accuracy is none of another's, and an old position is none of now."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import FormatError
from navbound.read.beside import utm
from navbound.run.directory import Run

if TYPE_CHECKING:
    from collections.abc import Callable

N = 120
SPEED_MPS = 250.0
DEG_PER_M = 1.0 / 111_195.0


def rows(n: int = N, *, begin_s: int = 0, **added: Any) -> list[dict[str, Any]]:
    """A flight to the north at 250 m/s, one row a second, that states NACp 10; a callable is of the second."""
    return [
        {
            "time_s": 1_700_000_000 + k,
            "lat_deg": 48.0 + k * SPEED_MPS * DEG_PER_M,
            "lon_deg": 2.0,
            "ground_speed_mps": SPEED_MPS,
            "nac_p": 10,
        }
        | {name: value(k) if callable(value) else value for name, value in added.items()}
        for k in range(begin_s, begin_s + n)
    ]


def column(name: str, value: object) -> dict[str, Any]:
    return {name: value}


def analyzed(tmp_path: Path, table: list[dict[str, Any]], **more: Any) -> Run:
    path = tmp_path / "a.json"
    path.write_text(json.dumps(table), encoding="utf-8")
    return navbound.analyze(path, **more)


def reasons(run: Run) -> set[str | None]:
    return set(run.epochs["reason_id"].to_list())


@pytest.mark.parametrize(
    ("age_s", "reason", "verdict"),
    [(0.5, None, "inside"), (1.0, None, "inside"), (1.5, "position_held", "nothing_judged"), (5.0, "position_stale", "nothing_judged")],
)
@pytest.mark.parametrize("name", ["last_position", "lastposupdate", "time_position", "PosTime", "time_of_applicability", "fix_time"])
def test_an_old_position_is_as_one_that_repeats(tmp_path: Path, name: str, age_s: float, reason: str | None, verdict: str) -> None:
    run = analyzed(tmp_path, rows(**column(name, lambda k: 1_700_000_000 + k - age_s)))
    assert (reasons(run), run.summary.verdict.id) == ({reason}, verdict)


@pytest.mark.parametrize(("age_s", "reason"), [(0.5, None), (1.0, None), (1.9, "position_held"), (2.5, "reported")])
@pytest.mark.parametrize(
    ("name", "unit_s"),
    [("seen_pos", 1.0), ("fix_age", 1.0), ("age_s", 1.0), ("seen_pos_ms", 1e-3), ("position_latency_s", 1.0), ("posDelay", 1.0)],
)
def test_an_age_of_a_position_dates_it(tmp_path: Path, name: str, unit_s: float, age_s: float, reason: str | None) -> None:
    assert reasons(analyzed(tmp_path, rows(**column(name, age_s / unit_s)))) == {reason}


@pytest.mark.parametrize(("n_rows", "shown"), [(1, False), (3, True)])
def test_positions_that_are_the_only_one_of_their_track_are_compared_with_nothing(tmp_path: Path, n_rows: int, shown: bool) -> None:
    table = [row | {"icao24": f"{k // n_rows:06x}"} for k, row in enumerate(rows())]
    verdict = analyzed(tmp_path, table).summary.verdict
    assert verdict.id == ("inside" if shown else "not_shown")
    assert any("the only one of its track" in each for each in verdict.position_doubts) != shown


def test_the_words_state_the_way_in_the_age_of_a_position(tmp_path: Path) -> None:
    """0.8 s at 250 m/s are 200 m."""
    (words,) = (a for a in analyzed(tmp_path, rows(seen_pos=0.8)).summary.assumptions if a.startswith("Plausibility"))
    assert "up to 0.8 s old, in which the aircraft moved up to 200 m" in words


def test_of_two_callsigns_each_is_an_aircraft(tmp_path: Path) -> None:
    first, second = rows(callsign="DLH1"), rows(begin_s=N, nac_p=None, callsign="AFR2")
    run = analyzed(tmp_path, [*first, *second])
    assert run.epochs["track"].unique().sort().to_list() == ["AFR2", "DLH1"]
    of_second = run.epochs.filter(run.epochs["track"] == "AFR2")
    assert set(of_second["status"]) == {"not_available"}
    assert run.summary.verdict.id == "not_shown"
    assert any("each of 2 callsigns is a track of its own" in a for a in run.summary.assumptions)


def test_a_callsign_that_comes_later_or_is_absent_for_a_while_is_of_one_track(tmp_path: Path) -> None:
    run = analyzed(tmp_path, rows(callsign=lambda k: "DLH1" if 20 <= k < 40 or k > 90 else None))
    assert run.epochs["track"].unique().to_list() == ["DLH1"]
    assert run.summary.verdict.id == "inside"
    table = "\n".join([",".join(rows(1, callsign="")[0]), *(",".join("" if v is None else str(v) for v in row.values()) for row in
                       rows(callsign=lambda k: "DLH1" if 20 <= k < 40 or k > 90 else None))])  # fmt: skip
    (tmp_path / "a.csv").write_text(table + "\n", encoding="utf-8")
    for piece_rows in (20, 30, 1000):
        assert navbound.analyze(tmp_path / "a.csv", piece_rows=piece_rows).epochs["track"].unique().to_list() == ["DLH1"]


@pytest.mark.parametrize("name", ["hex", "registration", "mode_s", "icao_address", "ModeS", "Tail Number"])
def test_a_column_that_names_the_aircraft_divides_tracks(tmp_path: Path, name: str) -> None:
    run = analyzed(tmp_path, [*rows(**column(name, "3c6444")), *rows(begin_s=N, nac_p=None, **column(name, "39bda1"))])
    assert run.epochs["track"].unique().sort().to_list() == ["39bda1", "3c6444"]
    assert run.summary.verdict.id == "not_shown"


@pytest.mark.parametrize(
    ("name", "source", "own"),
    [
        ("type", "adsb_icao", True),
        ("type", "mlat", False),
        ("type", "tisb_trackfile", False),
        ("type", "adsr_icao", False),
        ("source", "MLAT", False),
        ("position_source", "0", True),
        ("position_source", "2", False),
    ],
)
def test_a_position_that_others_computed_is_none_of_the_aircraft(tmp_path: Path, name: str, source: str, own: bool) -> None:
    assert reasons(analyzed(tmp_path, rows(**column(name, source)))) == {None if own else "reported"}


def test_a_type_of_aircraft_says_nothing_against_a_position(tmp_path: Path) -> None:
    run = analyzed(tmp_path, rows(type="A320"))
    assert run.summary.verdict.id == "inside"
    assert run.summary.verdict.unread == ["type (a320)"]


def test_an_object_of_json_a_line_is_a_row(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text("\n".join(json.dumps(row) for row in rows()) + "\n", encoding="utf-8")
    run = navbound.analyze(path)
    assert (run.epochs.height, run.summary.verdict.id) == (N, "inside")
    columns = ["time_ns", "est_lat_rad", "est_lon_rad", "cov_ee_m2"]
    assert run.epochs.select(columns).equals(analyzed(tmp_path, rows()).epochs.select(columns))


def test_a_line_that_is_no_object_of_json_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    lines = [json.dumps(row) for row in rows()]
    lines[7] = lines[7][:30]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(FormatError, match="not an object of JSON on each line") as refused:
        navbound.analyze(path)
    assert refused.value.line == 8


def led_off(k: int) -> float:
    """A longitude that goes to the east by 15 m a second."""
    return 2.0 + k * 15.0 * DEG_PER_M / 0.669


@pytest.mark.parametrize("direction", [{"track_deg": 0.0}, {"vn": SPEED_MPS, "ve": 0.0}])
@pytest.mark.parametrize(("lon_deg", "doubted"), [(led_off, False), (lambda k: led_off(5 * k), True), (lambda _: 2.0, False)])
def test_positions_that_end_elsewhere_than_speed_and_track_lead_are_doubted(
    tmp_path: Path, direction: dict[str, Any], lon_deg: Any, doubted: bool
) -> None:
    """75 m a second aside of 250 m/s are 4500 m a minute, where 5 % and 3 m/s leave 930 m; 15 m a second are 900 m, a drift in time."""
    verdict = analyzed(tmp_path, rows(150, lon_deg=lon_deg, **direction)).summary.verdict
    assert any("positions end elsewhere" in each for each in verdict.position_doubts) == doubted
    assert (verdict.id == "inside") != doubted
    left_out = {"ground_track_rad": "-"}
    without = navbound.analyze(tmp_path / "a.json", columns=left_out).summary.verdict
    assert (without.id, "ground_track_rad set aside by the user: inside" in without.lead[0]) == ("inside", True)


def test_a_time_of_the_position_that_cannot_be_read_shows_nothing(tmp_path: Path) -> None:
    clock = rows(time_position=lambda k: f"22:{12 + k // 60:02d}:{k % 60:02d}")
    verdict = analyzed(tmp_path, clock).summary.verdict
    assert verdict.id == "not_shown"
    assert verdict.position_doubts == [
        f"a.json: “time_position” says when positions were valid, and {N} of its {N} fields cannot be read as a time"
    ]
    some = rows(time_position=lambda k: "n/a?" if k % 3 == 0 else 1_700_000_000 + k)
    assert analyzed(tmp_path, some).summary.verdict.position_doubts == []


def test_the_velocity_of_opensky_is_in_metres_per_second(tmp_path: Path) -> None:
    led = [
        {"icao24": "3c6444", "velocity": 250.0} | {k: v for k, v in row.items() if k != "ground_speed_mps"}
        for row in rows(600, lat_deg=lambda k: 48.0 + (250.0 * k + 90.0 * max(0, k - 200)) * DEG_PER_M)
    ]
    run = analyzed(tmp_path, led)
    assert run.epochs["ground_speed_mps"].unique().to_list() == [250.0]
    assert "position_ahead" in reasons(run)


@pytest.mark.parametrize(
    ("indicators", "contained"),
    [({"nic": 0, "rc": 0}, False), ({"nic": 0, "rc": 186}, False), ({"nic": 8, "rc": 186}, True), ({"rc": 0}, False)],
)
def test_a_radius_of_nothing_contains_nothing(tmp_path: Path, indicators: dict[str, int], contained: bool) -> None:
    verdict = analyzed(tmp_path, rows(**indicators)).summary.verdict
    assert (verdict.id == "inside") == contained
    assert (verdict.n_stated_uncontained > 0) != contained


def test_of_two_speeds_the_larger_counts(tmp_path: Path) -> None:
    """A position that stands with noise under a speed of 0 beside velocities of 250 m/s."""
    noise = (0.0, 1.3, -0.9, 0.4, -1.1)
    stand = rows(200, lat_deg=lambda k: 48.0 + noise[k % 5] * DEG_PER_M, ground_speed_mps=0.0)
    assert analyzed(tmp_path, stand).summary.verdict.id == "inside"
    for moving in ({"vn": SPEED_MPS, "ve": 0.0}, {"gs_kt": 486.0}, {"groundspeed": 486.0}):
        verdict = analyzed(tmp_path, [row | moving for row in stand]).summary.verdict
        assert verdict.id != "inside", moving


@pytest.mark.parametrize(("off_deg", "doubted", "worse"), [(0.0, False, 0), (0.00005, False, 0), (0.0005, False, N), (0.02, True, N)])
@pytest.mark.parametrize("name", ["latitude", "lat", "Latitude"])
def test_two_columns_of_one_latitude_must_agree(tmp_path: Path, name: str, off_deg: float, doubted: bool, worse: int) -> None:
    """0.00005 degrees are 6 m, as much as a radius of 10 m explains; 0.0005 degrees 56 m, 0.02 degrees 2.2 km."""
    table = [row | {name: row["lat_deg"] + off_deg} for row in rows()]
    run = analyzed(tmp_path, table)
    verdict = run.summary.verdict
    assert any("two columns of one quantity" in each for each in verdict.position_doubts) == doubted
    assert (verdict.id, verdict.n_stated_worse) == ("not_shown" if worse else "inside", worse)
    assert any("up to 55.6 m apart" in each for each in run.summary.assumptions) == (off_deg == 0.0005)
    path = tmp_path / "a.json"
    assert navbound.analyze(path, columns={"est_lat_rad": "lat_deg:deg"}).summary.verdict.id == "inside"


@pytest.mark.parametrize(("off_deg", "doubted"), [(0.0, False), (0.01, False), (0.5, True)])
@pytest.mark.parametrize("name", ["gps_lat", "lat2", "True Latitude", "fusedLat", "irs.lat", "dr_lat_rad"])
def test_another_place_of_the_vehicle_is_not_far_away(tmp_path: Path, name: str, off_deg: float, doubted: bool) -> None:
    """0.01 degrees are 1.1 km, 0.5 degrees 56 km."""
    to_unit = math.pi / 180.0 if name.endswith("_rad") else 1.0
    table = [row | {name: (row["lat_deg"] + off_deg) * to_unit} for row in rows()]
    verdict = analyzed(tmp_path, table).summary.verdict
    assert any("are places of one vehicle" in each for each in verdict.position_doubts) == doubted
    assert verdict.id == ("not_shown" if doubted else "inside")
    assert navbound.analyze(tmp_path / "a.json", columns={"est_lat_rad": "lat_deg:deg"}).summary.verdict.id == "inside"


def _dms(degrees: float, letters: str) -> str:
    minutes = abs(degrees) * 60.0
    return f"{minutes // 60:.0f}°{minutes % 60 // 1:02.0f}'{minutes % 1 * 60:07.4f}\"{letters[degrees < 0]}"


def _ddmm(degrees: float, letters: str) -> str:
    return f"{int(abs(degrees))}{abs(degrees) % 1 * 60:07.4f}{letters[degrees < 0]}"


def _geohash(lat: float, lon: float) -> str:
    """By halves, as it is described."""
    low, high, bits = [-180.0, -90.0], [180.0, 90.0], ""
    for k in range(45):
        axis, middle = k % 2, (low[k % 2] + high[k % 2]) / 2
        more = (lon, lat)[axis] >= middle
        (low if more else high)[axis] = middle
        bits += "01"[more]
    return "".join("0123456789bcdefghjkmnpqrstuvwxyz"[int(bits[k : k + 5], 2)] for k in range(0, 45, 5))


def _minutes(degrees: float) -> str:
    return f"{int(degrees)} {degrees % 1 * 60:.4f}"


FORMS: dict[str, Callable[[float, float], dict[str, Any]]] = {
    "integers of 1e-7 degrees": lambda lat, lon: {"gps_lat_e7": round(lat * 1e7), "gps_lon_e7": round(lon * 1e7)},
    "semicircles": lambda lat, lon: {"gps_lat_semi": round(lat / 180 * 2**31), "gps_lon_semi": round(lon / 180 * 2**31)},
    "a hemisphere behind": lambda lat, lon: {"gps_lat": f"{lat:.7f}N", "gps_lon": f"{lon:.7f}E"},
    "a hemisphere before": lambda lat, lon: {"gps_lat": f"N {lat:.7f}", "gps_lon": f"E {lon:.7f}"},
    "degrees, minutes, seconds": lambda lat, lon: {"gps_lat_dms": _dms(lat, "NS"), "gps_lon_dms": _dms(lon, "EW")},
    "two numbers in a field": lambda lat, lon: {"gps_position": f"{lat:.7f}, {lon:.7f}"},
    "a list of two": lambda lat, lon: {"gps_pos": [lat, lon]},
    "longitude first": lambda lat, lon: {"geom": f"POINT({lon:.7f} {lat:.7f})"},
    "Earth-fixed axes": lambda lat, lon: dict(zip(("ecef_x", "ecef_y", "ecef_z"), _ecef(lat, lon), strict=True)),
    "axes of one letter": lambda lat, lon: dict(zip("XYZ", _ecef(lat, lon), strict=True)),
    "three numbers": lambda lat, lon: {"geom": f"SRID=4326;POINT Z ({lon:.7f} {lat:.7f} 100.0)"},
    "Earth-fixed axes in kilometres": lambda lat, lon: dict(zip(("X_km", "Y_km", "Z_km"), [m / 1e3 for m in _ecef(lat, lon)], strict=True)),
    "degrees and minutes in one number": lambda lat, lon: {"nmea_lat": _ddmm(lat, "NS"), "nmea_lon": _ddmm(lon, "EW")},
    "Earth-fixed axes in centimetres": lambda lat, lon: dict(
        zip(("ecefX", "ecefY", "ecefZ"), [round(1e2 * m) for m in _ecef(lat, lon)], strict=True)
    ),
    "ISO 6709 under any name": lambda lat, lon: {"annotation": f"{lat:+011.7f}{lon:+012.7f}/"},
    "ISO 6709 with minutes": lambda lat, lon: {"gps_place": f"+{_ddmm(lat, '  ').strip()}+00{_ddmm(lon, '  ').strip()}/"},
    "degrees and minutes in one field": lambda lat, lon: {"gps": f"{_minutes(lat)} N {_minutes(lon)} E"},
    "hemispheres in front": lambda lat, lon: {"aux": f"N{_minutes(lat)}' E{_minutes(lon)}'"},
    "a point under any name": lambda lat, lon: {"aux": f"SRID=4326;POINT({lon:.7f} {lat:.7f})"},
    "GeoJSON in a text": lambda lat, lon: {"aux": json.dumps({"type": "Point", "coordinates": [lon, lat]})},
    "GeoJSON": lambda lat, lon: {"aux": {"type": "Point", "coordinates": [lon, lat]}},
    "an object in a text": lambda lat, lon: {"aux": json.dumps({"gnss": {"lat": lat, "lon": lon}, "n": 1})},
    "an object of another language": lambda lat, lon: {"aux": str({"lat": lat, "lng": lon, "ok": True})},
    "a geohash": lambda lat, lon: {"geohash9": _geohash(lat, lon)},
    "UTM": lambda lat, lon: {
        "utm_easting": 500_000.0 - 0.9996 * 74_625.0 * (3.0 - lon),
        "utm_northing": 5_316_790.0 + (lat - 48.0) * 111_150.0,
    },
    "an object in a list": lambda lat, lon: {"aux": [{"of": "gps", "position": {"lat": lat, "lon": lon}}]},
    "in one word": lambda lat, lon: {"truelat": lat, "truelon": lon},
    "in another language": lambda lat, lon: {"latitud_real": lat, "longitud_real": lon},
}


def _ecef(lat_deg: float, lon_deg: float) -> list[float]:
    """WGS-84, by its own formula."""
    lat, lon = math.radians(lat_deg), math.radians(lon_deg)
    n = 6378137.0 / math.sqrt(1.0 - 6.69437999014e-3 * math.sin(lat) ** 2)
    return [n * math.cos(lat) * math.cos(lon), n * math.cos(lat) * math.sin(lon), n * (1.0 - 6.69437999014e-3) * math.sin(lat)]


@pytest.mark.parametrize(("off_deg", "shown"), [(0.01, True), (0.03, False)])
@pytest.mark.parametrize("form", FORMS)
def test_another_place_in_any_form_is_compared(tmp_path: Path, form: str, off_deg: float, shown: bool) -> None:
    """1.1 km and 3.3 km to the north."""
    table = [row | FORMS[form](row["lat_deg"] + off_deg, row["lon_deg"]) for row in rows()]
    verdict = analyzed(tmp_path, table).summary.verdict
    assert any("are places of one vehicle" in each for each in verdict.position_doubts) == (not shown)
    assert verdict.id == ("inside" if shown else "not_shown")


@pytest.mark.parametrize(
    "more",
    [
        {"position": "Gate 12, Terminal 3"},
        {"location": "12, 3"},
        {"x": 12.0, "y": 3.0, "z": 5.0},
        {"dest_position": "48.1, 11.5"},
        {"gps_lat": "n/a", "gps_lon": ""},
        {"accel_x": 0.1, "accel_y": 0.2, "accel_z": 9.8},
        {"gps_pos": []},
        {"destination": "SRID=4326;POINT(11.5 48.1)"},
        {"aux": json.dumps({"dest": {"lat": 48.1, "lon": 11.5}, "wind": [3.5, 2.5]})},
        {"aux": "+33 1 42 68 53 00"},
        {"aux": "N3 E5"},
        {"aux": "{"},
    ],
)
def test_what_is_no_place_of_the_vehicle_contradicts_nothing(tmp_path: Path, more: dict[str, Any]) -> None:
    assert analyzed(tmp_path, [row | more for row in rows()]).summary.verdict.id == "inside"


@pytest.mark.parametrize("name", ["gps", "true"])
def test_another_place_that_moves_along_a_meridian_is_no_origin(tmp_path: Path, name: str) -> None:
    """Its longitude stays; a degree is 74 km."""
    table = [row | {f"{name}_lat": row["lat_deg"], f"{name}_lon": row["lon_deg"] + 1.0} for row in rows()]
    assert len({row["lon_deg"] for row in table}) == 1
    verdict = analyzed(tmp_path, table).summary.verdict
    assert any(f"“{name}_lon” are places of one vehicle" in each for each in verdict.position_doubts)
    origin = [row | {f"{name}_lat": 45.0, f"{name}_lon": 3.0} for row in rows()]
    assert analyzed(tmp_path, origin).summary.verdict.id == "inside"


def test_a_second_latitude_of_the_same_name_that_is_nowhere_is_no_fix_of_another_receiver(tmp_path: Path) -> None:
    verdict = analyzed(tmp_path, [row | {"latitude": 0.0} for row in rows()]).summary.verdict
    assert any("two columns of one quantity" in each for each in verdict.position_doubts)


@pytest.mark.parametrize(("name", "off_deg", "doubted"), [("irs_lat", 0.1, False), ("gps_lat", 0.1, True)])
def test_what_inertial_sensors_keep_may_be_miles_off(tmp_path: Path, name: str, off_deg: float, doubted: bool) -> None:
    """0.1 degrees are 6 NM: RNP 10 allows them 10."""
    verdict = analyzed(tmp_path, [row | {name: row["lat_deg"] + off_deg} for row in rows()]).summary.verdict
    assert verdict.id == ("not_shown" if doubted else "inside")


@pytest.mark.parametrize(
    ("name", "lat_deg"), [("lat0", 45.0), ("ref_lat", 45.0), ("gps_lat", 0.0), ("runway_lat", None), ("next_lat", None)]
)
def test_an_origin_and_a_receiver_without_a_fix_contradict_nothing(tmp_path: Path, name: str, lat_deg: float | None) -> None:
    """Nor do places of other things, which move along three degrees away."""
    table = [row | {name: row["lat_deg"] + 3.0 if lat_deg is None else lat_deg} for row in rows()]
    assert analyzed(tmp_path, table).summary.verdict.id == "inside"


@pytest.mark.parametrize(("flags", "shown"), [([], True), (["healthy", "3D"], True), (["late", "spoofed"], False), (["GPS LOST"], False)])
def test_words_in_a_list_are_read_as_a_text(tmp_path: Path, flags: list[str], shown: bool) -> None:
    table = [row | {"flags": flags if 100 <= k < 200 else []} for k, row in enumerate(rows())]
    assert (analyzed(tmp_path, table).summary.verdict.id == "inside") == shown


@pytest.mark.parametrize(("valid", "shown"), [(True, True), (False, False)])
def test_objects_in_a_list_are_read_each(tmp_path: Path, valid: bool, shown: bool) -> None:
    sensors = [{"name": "a", "valid": True}, {"name": "b", "valid": valid}]
    verdict = analyzed(tmp_path, [row | {"sensors": sensors} for row in rows()]).summary.verdict
    assert (verdict.id == "inside") == shown


@pytest.mark.parametrize(("source", "n_ok"), [("GPS", None), ("gps/ins", None), ("IRS", 0), ("inertial", 0)])
def test_a_position_that_inertial_sensors_alone_keep_is_not_judged(tmp_path: Path, source: str, n_ok: int | None) -> None:
    summary = analyzed(tmp_path, [row | {"navSource": source} for row in rows()]).summary
    assert summary.n_status.get("ok", 0) == (len(rows()) if n_ok is None else n_ok)


@pytest.mark.parametrize(("pic", "shown"), [(8, True), (7, True), (6, False), (1, False), (0, False)])
def test_a_position_integrity_category_is_a_radius(tmp_path: Path, pic: int, shown: bool) -> None:
    """0.5, 0.6, 1 and 20 NM, and none; twice RNP 0.3 is 0.6 NM."""
    verdict = analyzed(tmp_path, [row | {"pic": pic} for row in rows()]).summary.verdict
    assert verdict.id == ("inside" if shown else "not_shown")


@pytest.mark.parametrize(("later_s", "doubted"), [(0.0, False), (1.5, False), (1000.0, True)])
def test_two_columns_of_one_time_must_agree(tmp_path: Path, later_s: float, doubted: bool) -> None:
    table = [row | {"timestamp": row["time_s"] + later_s} for row in rows()]
    verdict = analyzed(tmp_path, table).summary.verdict
    assert any("two columns of time" in each for each in verdict.position_doubts) == doubted
    assert verdict.id == ("not_shown" if doubted else "inside")
    assert navbound.analyze(tmp_path / "a.json", columns={"time": "time_s:utc_s"}).summary.verdict.id == "inside"


def test_a_clock_since_the_start_is_no_second_time(tmp_path: Path) -> None:
    assert analyzed(tmp_path, [row | {"time_us": 1_000_000 * k} for k, row in enumerate(rows())]).summary.verdict.id == "inside"


@pytest.mark.parametrize("name", ["true_lat_deg", "gt_lat", "lat_truth_deg", "ref_lat", "rtk_latitude", "ins_lon", "lat2"])
def test_another_place_that_nothing_reads_is_named(tmp_path: Path, name: str) -> None:
    assert analyzed(tmp_path, rows(**column(name, 48.1))).summary.verdict.unread == [name]


@pytest.mark.parametrize("name", ["dest_lat", "runway_lon", "home_latitude", "wpt_lat", "wp_lat", "route_lon", "vor_latitude"])
def test_a_place_of_something_else_is_not(tmp_path: Path, name: str) -> None:
    assert analyzed(tmp_path, rows(**column(name, 48.1))).summary.verdict.unread == []


def test_a_column_of_durations_is_refused_by_its_name(tmp_path: Path) -> None:
    table = pl.DataFrame(rows()).with_columns(time_s=pl.duration(seconds=pl.col("time_s")))
    table.write_parquet(tmp_path / "a.parquet")
    with pytest.raises(FormatError, match="time_s: holds Duration"):
        navbound.analyze(tmp_path / "a.parquet")


def stands_from_30(**added: Any) -> list[dict[str, Any]]:
    """Flies for 30 s and stands with a metre of noise then, under a reported speed of 250 m/s."""
    noise = (0.0, 1.3, -0.9, 0.4, -1.1)
    return rows(240, lat_deg=lambda k: 48.0 + (min(k, 30) * SPEED_MPS + noise[k % 5]) * DEG_PER_M, **added)


@pytest.mark.parametrize("every", [2, 5, 15, 19])
def test_an_empty_speed_now_and_then_turns_no_rule_off(tmp_path: Path, every: int) -> None:
    run = analyzed(tmp_path, stands_from_30(ground_speed_mps=lambda k: None if k % every == 1 else SPEED_MPS))
    assert run.summary.verdict.id != "inside"
    assert "position_stale" in reasons(run)


def test_positions_that_catch_up_after_a_hold_are_stale_until_they_have(tmp_path: Path) -> None:
    """Held for ten seconds, then interpolated to where the aircraft is four seconds later: 7.5 s late, 5 s, 2.5 s."""

    def lat_deg(k: int) -> float:
        seconds = k if k < 60 or k >= 73 else 59.0 if k < 70 else 59.0 + 3.5 * (k - 69)
        return 48.0 + SPEED_MPS * seconds * DEG_PER_M

    reasons_of = analyzed(tmp_path, rows(240, lat_deg=lat_deg)).epochs["reason_id"].to_list()
    assert reasons_of[62:72] == ["position_stale"] * 10
    assert set(reasons_of[:60]) | set(reasons_of[72:]) == {None}


def test_an_empty_speed_before_a_stop_that_nobody_flew_explains_nothing(tmp_path: Path) -> None:
    speeds = stands_from_30(ground_speed_mps=lambda k: SPEED_MPS if k < 23 else None if k < 30 else 0.0)
    assert "position_stale" in reasons(analyzed(tmp_path, speeds))


def mirrored(name: str, *, wrong: bool, step_s: int = 1, **added: Any) -> list[dict[str, Any]]:
    sign = -1.0 if wrong else 1.0
    values: dict[str, Any] = {"hex": name, "track_deg": 0.0, "lat_deg": lambda k: 48.0 + sign * k * SPEED_MPS * DEG_PER_M} | added
    return rows(900, **values)[::step_s]


@pytest.mark.parametrize("n_right", [0, 5, 11])
def test_tracks_that_agree_hide_none_that_does_not(tmp_path: Path, n_right: int) -> None:
    right = [row for n in range(n_right) for row in mirrored(f"39bd{n:02x}", wrong=False)]
    verdict = analyzed(tmp_path, right + mirrored("3c6444", wrong=True)).summary.verdict
    assert verdict.id == "not_shown"
    assert all("3c6444" in each for each in verdict.position_doubts) or not n_right
    if n_right == 5:
        assert analyzed(tmp_path, right).summary.verdict.id == "inside"


@pytest.mark.parametrize(
    "how",
    [
        {"track_deg": lambda k: None if k % 60 == 7 else 0.0},
        {"ground_speed_mps": lambda k: None if k % 2 else SPEED_MPS},
        {"ground_speed_mps": None},
        {"step_s": 12},
    ],
)
def test_a_direction_that_contradicts_shows_with_empty_fields_and_long_steps_too(tmp_path: Path, how: dict[str, Any]) -> None:
    assert analyzed(tmp_path, mirrored("3c6444", wrong=True, **how)).summary.verdict.id != "inside"
    right = analyzed(tmp_path, mirrored("3c6444", wrong=False, **how)).summary.verdict
    assert right.position_doubts == []


def test_ten_minutes_of_an_hour_in_which_a_track_is_led_aside_are_doubted(tmp_path: Path) -> None:
    aside = rows(3600, track_deg=0.0, lon_deg=lambda k: 2.0 + 30.0 * min(max(k - 900, 0), 600) * DEG_PER_M / 0.66)
    assert any("positions end elsewhere" in each for each in analyzed(tmp_path, aside).summary.verdict.position_doubts)


def bursts(n_s: int, every_s: int, burst_s: int, aside_mps: float, **added: Any) -> list[dict[str, Any]]:
    """Flies north and is led to the east now and then."""

    def lon_deg(k: int) -> float:
        return 2.0 + aside_mps * ((k // every_s) * burst_s + min(k % every_s, burst_s)) * DEG_PER_M / 0.66

    values: dict[str, Any] = {"track_deg": 0.0, "lon_deg": lon_deg} | added
    return rows(n_s, **values)[::4]


@pytest.mark.parametrize(
    ("flight", "doubted"),
    [
        # A tenth of the minutes, each by half its way.
        ((3600, 900, 120, 120.0), True),
        # A sixth of them, by a fifth: 20 windows by 2 km more than their margins, of 120.
        ((7200, 360, 60, 50.0), True),
        ((3600, 1800, 60, 120.0), False),
    ],
)
def test_leads_now_and_then_add_up(tmp_path: Path, flight: tuple[int, int, int, float], doubted: bool) -> None:
    verdict = analyzed(tmp_path, bursts(*flight)).summary.verdict
    assert any("positions end elsewhere" in each for each in verdict.position_doubts) == doubted


@pytest.mark.parametrize("speed", [None, lambda k: SPEED_MPS if k % 90 == 0 else None])
def test_a_direction_without_a_speed_is_compared_with_the_way_of_the_positions(tmp_path: Path, speed: Any) -> None:
    led, flown = (bursts(1800, 3600, 3600, mps, ground_speed_mps=speed) for mps in (120.0, 0.0))
    for k, row in enumerate(led[:250]):
        row["lon_deg"] = flown[k]["lon_deg"]
    verdict = analyzed(tmp_path, led).summary.verdict
    assert any("positions end elsewhere" in each for each in verdict.position_doubts)
    assert analyzed(tmp_path, flown).summary.verdict.position_doubts == []


def test_a_speed_and_a_track_that_repeat_for_a_while_in_a_turn_show_nothing(tmp_path: Path) -> None:
    """As state vectors repeat what was last heard: here for 90 s, while the aircraft turns by 40 degrees."""
    north, east = (SPEED_MPS * DEG_PER_M * part(math.radians(40.0)) for part in (math.cos, math.sin))

    def lat_deg(k: int) -> float:
        return 48.0 + SPEED_MPS * DEG_PER_M * min(k, 600) + north * max(0, k - 600)

    def lon_deg(k: int) -> float:
        return 2.0 + east / math.cos(math.radians(49.35)) * max(0, k - 600)

    turned = rows(1800, track_deg=lambda k: 0.0 if k < 690 else 40.0, lat_deg=lat_deg, lon_deg=lon_deg)[::4]
    assert not any("positions end elsewhere" in each for each in analyzed(tmp_path, turned).summary.verdict.position_doubts)


@pytest.mark.parametrize("twin", ["ABC123", "0xabc123", "0xABC123"])
def test_an_address_is_one_in_any_writing(tmp_path: Path, twin: str) -> None:
    run = analyzed(tmp_path, [row for k in range(N) for row in rows(1, begin_s=k, hex="abc123" if k % 2 else twin)])
    assert run.epochs["track"].unique().to_list() == ["abc123"]


def test_a_callsign_is_one_in_any_writing(tmp_path: Path) -> None:
    run = analyzed(tmp_path, rows(callsign=lambda k: ("DLH1", "dlh1", "DLH1____", " DLH1 ")[k % 4]))
    assert run.epochs["track"].unique().to_list() == ["DLH1"]


@pytest.mark.parametrize(
    ("added", "named"),
    [
        ({"last_position": 1_700_000_000, "time_position": 1_699_999_000}, "time_position"),
        ({"fix_lag_ms": 30000}, "fix_lag_ms"),
    ],
)
def test_an_age_that_is_not_understood_is_named(tmp_path: Path, added: dict[str, Any], named: str) -> None:
    assert named in analyzed(tmp_path, [row | added for row in rows()]).summary.verdict.unread


@pytest.mark.parametrize(("ahead_s", "reported"), [(0.0, 0), (1.9, 0), (2.5, 300), (3600.0, 300)])
@pytest.mark.parametrize("name", ["last_position", "time_position"])
def test_a_position_of_a_later_time_than_its_row_is_reported(tmp_path: Path, name: str, ahead_s: float, reported: int) -> None:
    """One of the two clocks is wrong, and nothing says which."""
    table = rows(300)
    run = analyzed(tmp_path, [row | {name: row["time_s"] + ahead_s} for row in table])
    assert (run.epochs["reason_id"] == "reported").sum() == reported
    assert (run.summary.verdict.id == "inside") == (not reported)


def test_a_time_and_a_position_cannot_be_left_out(tmp_path: Path) -> None:
    analyzed(tmp_path, rows())
    for quantity in ("time", "est_lat_rad"):
        with pytest.raises(FormatError):
            navbound.analyze(tmp_path / "a.json", columns={quantity: "-"})


@pytest.mark.parametrize("where", ["row", "details"])
@pytest.mark.parametrize("kind", ["mlat", "tisb_icao", "adsr_icao", "mode_s", "adsc", "adsb_icao"])
def test_a_position_of_a_readsb_trace_that_others_computed_is_reported(tmp_path: Path, kind: str, where: str) -> None:
    source = kind if where == "row" else None
    rows = []
    for k in range(N):
        details = {"nac_p": 10, "nic": 8, "type": kind} if k == 0 else None
        rows.append([k, 48.0 + k * SPEED_MPS * DEG_PER_M, 2.0, 30_000, SPEED_MPS / 0.514444, 0.0, 0, 0, details, source, 30_500])
    path = tmp_path / "trace.json"
    path.write_text(json.dumps({"icao": "3c6444", "timestamp": 1_700_000_000, "trace": rows}), encoding="utf-8")
    run = navbound.analyze(path)
    expected = (set[str | None]({None}), "inside") if kind == "adsb_icao" else (set[str | None]({"reported"}), "nothing_judged")
    assert (reasons(run), run.summary.verdict.id) == expected


@pytest.mark.parametrize(("one", "other", "verdict"), [(10, 2, "outside"), (2, 10, "outside"), (10, 9, "inside")])
def test_of_two_accuracy_categories_the_smaller_counts(tmp_path: Path, one: int, other: int, verdict: str) -> None:
    """NACp 2 is 4 NM, beyond RNP 0.3."""
    run = analyzed(tmp_path, rows(nac_p=one, NACp=other))
    assert run.summary.verdict.id == verdict
    assert run.summary.verdict.unread == []


@pytest.mark.parametrize(("other_mps", "doubted"), [(250.0, False), (260.0, False), (340.0, True), (0.0, True)])
@pytest.mark.parametrize("name", ["groundspeed_mps", "velocity"])
def test_two_speeds_that_contradict_each_other_show_nothing(tmp_path: Path, name: str, other_mps: float, doubted: bool) -> None:
    """The larger would hide positions that are led ahead, the smaller those that stand."""
    added = {"vel_n_mps": other_mps, "vel_e_mps": 0.0} if name == "velocity" else {name: other_mps}
    verdict = analyzed(tmp_path, [row | added for row in rows()]).summary.verdict
    assert (verdict.id, bool(verdict.position_doubts)) == (("not_shown", True) if doubted else ("inside", False))


def test_utm_is_that_of_a_known_place() -> None:
    """The Eiffel Tower, 48.8583 N 2.2945 E, is at 448 252 E 5 411 933 N in zone 31; its neighbours have it beside their borders."""
    near = np.radians([[48.9, 2.0], [-48.9, 2.0]])
    east, north = np.array([448_252.0, 448_252.0]), np.array([5_411_933.0, 1e7 - 5_411_933.0])
    assert np.degrees(utm.places(east, north, near, 0)) == pytest.approx(np.array([[48.8583, 2.2945], [-48.8583, 2.2945]]), abs=2e-4)
    assert np.degrees(utm.places(east, north, near, 1))[:, 1] == pytest.approx(8.2945, abs=2e-4)
