"""Logs of receivers to the epoch table; figures of the data catalogue and of independent decoders. Skipped, aloud, without the files."""

from __future__ import annotations

import gzip
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import FormatError
from navbound.read import formats, read

NS = 1_000_000_000
WEEK_NS = 604_800 * NS


@pytest.fixture(scope="module")
def logs(shared_data: Path) -> Path:
    return shared_data / "rxlogs"


def gps_ns(unix_s: int, leap_s: int) -> int:
    return (unix_s - 315_964_800 + leap_s) * NS


# --- frames of our own making, by the makers' documents -----------------------------------------------------------------------------


def ubx(identity: bytes, payload: bytes) -> bytes:
    body = identity + struct.pack("<H", len(payload)) + payload
    a = b = 0
    for byte in body:
        a = (a + byte) & 0xFF
        b = (b + a) & 0xFF
    return b"\xb5\x62" + body + bytes([a, b])


def nav_pvt(itow: int, *, fix: int = 3, valid: int = 0b111, flags: int = 1) -> bytes:
    payload = struct.pack("<IHBBBBBBIiBBBB", itow, 2024, 6, 23, 12, 0, (itow // 1000) % 60, valid, 20, -5, fix, flags, 0, 17)
    payload += struct.pack("<iiiiII", 60_000_000, 472_500_000, 371_496, 323_000, 1_700, 2_500)
    payload += struct.pack("<iiiiiIIHH", 3, 4, -1_500, 5, 9_000_000, 100, 200, 150, 0)
    return ubx(b"\x01\x07", payload.ljust(92, b"\0"))


def nav_cov(itow: int, *, valid: int = 1) -> bytes:
    values = (4.0, 0.5, -0.25, 9.0, 1.5, 16.0)
    payload = struct.pack("<IBBB9x", itow, 0, valid, 1) + struct.pack("<12f", *values, *([0.0] * 6))
    return ubx(b"\x01\x36", payload)


def nav_pl(itow: int, *, frame: int, valid: int = 1) -> bytes:
    payload = struct.pack("<BBbBBBBB4xI", 1, 5, -7, valid, frame, 0, 0, 0, itow) + struct.pack(
        "<IIIIIIHHI4x", 3_000, 4_000, 7_000, 0, 0, 0, 0, 0, 0
    )
    return ubx(b"\x01\x62", payload)


def sentence(text: str) -> bytes:
    total = 0
    for byte in text.encode():
        total ^= byte
    return f"${text}*{total:02X}\r\n".encode()


def only(tmp_path: Path, content: bytes) -> dict[str, Any]:
    path = tmp_path / "log.bin"
    path.write_bytes(content)
    epochs = read(path).epochs
    assert epochs.height == 1
    return epochs.row(0, named=True)


# --- u-blox --------------------------------------------------------------------------------------------------------------------------


def test_ubx_fields_become_columns_in_si(tmp_path: Path) -> None:
    row = only(tmp_path, nav_pvt(43_200_000) + nav_cov(43_200_000) + nav_pl(43_200_000, frame=3))
    # 2024-06-23 12:00:00 UTC less 5 ns; GPS leads UTC by 18 s since 2017.
    assert row["time_ns"] == gps_ns(1_719_144_000, 18) - 5
    assert (row["est_lat_rad"], row["est_lon_rad"]) == pytest.approx((math.radians(47.25), math.radians(6.0)), abs=1e-15)
    assert (row["est_h_m"], row["n_sv"], row["ground_speed_mps"], row["vertical_rate_mps"]) == (371.496, 17, 0.005, 1.5)
    # North-east-down to east-north-up: down terms change sign, north and east their places.
    expected = {"ee": 9.0, "en": 0.5, "nn": 4.0, "eu": -1.5, "nu": 0.25, "uu": 16.0}
    assert {k: row[f"cov_{k}_m2"] for k in expected} == expected
    # Along the axes of the ellipse the larger; 7 m vertical.
    assert (row["hpl_m"], row["vpl_m"]) == (4.0, 7.0)
    assert only(tmp_path, nav_pvt(0) + nav_pl(0, frame=1))["hpl_m"] == 5.0


def test_without_nav_cov_the_accuracies_stand_in_and_the_report_says_so(tmp_path: Path) -> None:
    path = tmp_path / "pvt.ubx"
    path.write_bytes(nav_pvt(0) + nav_cov(0, valid=0))
    reading = read(path)
    row = reading.epochs.row(0, named=True)
    # hAcc is the root of both variances: 1.7 m; vAcc 2.5 m.
    assert row["cov_ee_m2"] + row["cov_nn_m2"] == pytest.approx(1.7**2)
    assert row["cov_uu_m2"] == 6.25
    assert "circular" in reading.notes[0]
    assert reading.columns["covariance"] == "NAV-PVT hAcc, vAcc"


def test_epochs_without_fix_or_time_and_damaged_frames_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "cold.ubx"
    good = b"".join(nav_pvt(1000 * k) + nav_cov(1000 * k) for k in range(30))
    broken = bytearray(nav_pvt(31_000))
    broken[20] ^= 1
    path.write_bytes(nav_pvt(40_000, fix=0) + nav_pvt(41_000, valid=0b011) + nav_pvt(42_000, flags=0) + bytes(broken) + good)
    reading = read(path)
    assert reading.epochs.height == 30
    assert {r.reason: r.count for r in reading.rejected} == {"no 3-D fix": 2, "time not valid": 1, "damaged message": 1}


def test_a_covariance_of_another_epoch_is_not_borrowed(tmp_path: Path) -> None:
    path = tmp_path / "gap.ubx"
    path.write_bytes(nav_pvt(0) + nav_cov(0) + nav_pvt(1000) + nav_cov(2000) + nav_pvt(3000) + nav_cov(3000))
    epochs = read(path).epochs
    assert epochs["cov_ee_m2"].to_list() == [9.0, 1.7**2 / 2, 9.0]


def test_the_u_blox_hour_has_the_catalogue_s_figures(logs: Path, shared_data: Path) -> None:
    epochs = read(logs / "ubx_16dB" / "16dBatt_no_interference_coldstart.ubx.gz").epochs
    # Catalogue: 552 3-D fixes; median of sqrt(nn + ee) 1.7374 m; 1.872 m RMS about the mean (flat Earth of its own: 0.1 %).
    assert epochs.height == 552
    assert float(np.median(np.sqrt(epochs["cov_ee_m2"] + epochs["cov_nn_m2"]))) == pytest.approx(1.7374, abs=5e-5)
    lat, lon = epochs["est_lat_rad"].to_numpy(), epochs["est_lon_rad"].to_numpy()
    north, east = (lat - lat.mean()) * 6.37e6, (lon - lon.mean()) * 6.387e6 * np.cos(lat.mean())
    assert float(np.sqrt(np.mean(north**2 + east**2))) == pytest.approx(1.872, abs=6e-3)
    # Every second once.
    assert epochs["time_ns"].diff().drop_nulls().is_between(0.99e9, 1.01e9).all()


# --- Septentrio, NovAtel, NMEA -------------------------------------------------------------------------------------------------------


def test_septentrio_covariances_are_turned_from_earth_fixed_axes(logs: Path) -> None:
    reading = read(logs / "pysbf2" / "sbfdata.log")
    first = reading.epochs.row(0, named=True)
    assert reading.epochs.height == 58
    # Catalogue: variances 11.08, 4.58, 34.58 m² of the first epoch; full block as pysbf2 prints it.
    c = np.array([[11.08477783, 0.40846223, 1.55891252], [0.40846223, 4.58438826, -7.81758833], [1.55891252, -7.81758833, 34.57521057]])
    lat, lon = first["est_lat_rad"], first["est_lon_rad"]
    sl, cl, sp, cp = math.sin(lon), math.cos(lon), math.sin(lat), math.cos(lat)
    turn = np.array([[-sl, cl, 0.0], [-sp * cl, -sp * sl, cp], [cp * cl, cp * sl, sp]])
    enu = turn @ c @ turn.T
    result = [[first[f"cov_{k}_m2"] for k in row] for row in (("ee", "en", "eu"), ("en", "nn", "nu"), ("eu", "nu", "uu"))]
    np.testing.assert_allclose(result, enu, rtol=1e-6, atol=1e-5)
    # Week 2367; the independent decoder shows 12:38:05 UTC, which is 18 s behind GPS time.
    assert first["time_ns"] % (86_400 * NS) == (12 * 3600 + 38 * 60 + 5 + 18) * NS
    assert first["time_ns"] // WEEK_NS == 2367
    assert read(logs / "pysbf2" / "pygpsdata_x5pvt.log").epochs.height == 16


def test_novatel_standard_deviations_are_those_of_the_catalogue(logs: Path) -> None:
    reading = read(logs / "novatel" / "oemv_200911218.gps")
    # 49 messages, of which the first three have no time yet; the log is cut within a frame.
    assert (reading.epochs.height, {r.reason: r.count for r in reading.rejected}) == (
        46,
        {"time not known": 3, "damaged message of no position": 1},
    )
    last = reading.epochs.row(-1, named=True)
    sigma = [math.sqrt(last[f"cov_{k}_m2"]) for k in ("nn", "ee", "uu")]
    assert sigma == pytest.approx([1.50, 0.92, 2.13], abs=5e-3)
    # Week 1562, 515265 s; height above the geoid and its undulation as the independent decoder prints them.
    assert last["time_ns"] == 1562 * WEEK_NS + 515_265 * NS
    assert last["est_h_m"] == pytest.approx(964.28248 + 39.25026, abs=1e-4)
    assert any("uncorrelated" in note for note in reading.notes)


def test_nmea_positions_are_dated_and_carry_gst(logs: Path) -> None:
    reading = read(logs / "gpsd" / "ublox-zed-f9p-nmea.log")
    assert reading.epochs.height == 29
    first = reading.epochs.row(0, named=True)
    # 2019-04-12 00:39:56 UTC; stdLat 2.3, stdLong 3.5, stdAlt 4.0; 14.2 m above the geoid, which is 1.8 m up.
    assert first["time_ns"] == gps_ns(1_555_029_596, 18)
    assert [first[f"cov_{k}_m2"] for k in ("nn", "ee", "uu")] == pytest.approx([2.3**2, 3.5**2, 16.0])
    assert first["est_h_m"] == pytest.approx(16.0)


def test_nmea_midnight_ellipse_and_gbs(tmp_path: Path) -> None:
    gga = "GNGGA,{},4715.0,N,00600.0,W,1,12,0.9,100.0,M,-40.0,M,,"
    text = [sentence("GNRMC,235959.50,A,4715.0,N,00600.0,W,0.0,,311223,,,A,V")]
    text += [sentence(gga.format("000000.50")), sentence("GNGST,000000.50,1.0,4.0,2.0,45.0,3.0,3.0,5.0")]
    text += [sentence(gga.format("000001.50")), sentence("GNGBS,000001.50,1.0,2.0,3.0,,,,,,")]
    path = tmp_path / "night.nmea"
    path.write_bytes(b"".join(text))
    reading = read(path)
    ellipse, gbs = reading.epochs.rows(named=True)
    # The second after 2023-12-31 23:59:59.5 is of the next year.
    assert ellipse["time_ns"] == gps_ns(1_704_067_200, 18) + NS // 2
    assert ellipse["est_lon_rad"] == pytest.approx(math.radians(-6.0))
    assert ellipse["est_h_m"] == 60.0
    # Major axis to the north-east: correlation (16 - 4) / (16 + 4) at the scale of the standard deviations, 9 m² each.
    assert ellipse["cov_en_m2"] == pytest.approx(9.0 * 0.6)
    assert [gbs[f"cov_{k}_m2"] for k in ("nn", "ee", "uu")] == [1.0, 4.0, 9.0]
    assert any("GBS" in note for note in reading.notes)


def test_positions_that_nothing_dates_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "undated.nmea"
    path.write_bytes(sentence("GPGGA,000000.00,4715.0,N,00600.0,E,1,12,0.9,100.0,M,40.0,M,,") * 3)
    with pytest.raises(FormatError, match=r"3 GGA sentences hold a time of day and no date.*add one ZDA sentence"):
        read(path)
    dated = b"$GPRMC,000000.00,A,4715.0,N,00600.0,E,0.0,,311223,,,A*00\r\n"
    path.write_bytes(dated + path.read_bytes())
    with pytest.raises(FormatError, match=r"1 sentence is damaged.*a wrong checksum refuses one"):
        read(path)
    # What the sentence advises works.
    path.write_bytes(sentence("GPZDA,000000.00,31,12,2023,00,00") + path.read_bytes().removeprefix(dated))
    assert read(path).epochs.height == 1


# --- all ------------------------------------------------------------------------------------------------------------------------------


def test_the_kind_follows_from_the_content(logs: Path) -> None:
    assert formats.of(b"time,lat,lon\n1,2,3\n").id == "csv"
    assert formats.of(b"\x00" * 1000).id == "csv"
    # UBX frames without a position beside NMEA with one.
    assert formats.of((logs / "gpsd" / "ublox-zed-f9p_hpg1.11.log").read_bytes()).id == "nmea"
    assert formats.of((logs / "gpsd" / "ublox-zed-f9r.log").read_bytes()).id == "ubx"
    with pytest.raises(FormatError, match="NAV-PVT"):
        read(logs / "gpsd" / "ublox-x20p.log")


@pytest.mark.parametrize(
    "name",
    [
        "ubx_16dB/16dBatt_no_interference_coldstart.ubx.gz",
        "pysbf2/sbfdata.log",
        "novatel/oemv_200911218.gps",
        "gpsd/ublox-zed-f9p-nmea.log",
        "gpsd/ublox-zed-f9r.log",
    ],
)
def test_damaged_logs_are_read_or_refused(logs: Path, tmp_path: Path, name: str) -> None:
    raw = (logs / name).read_bytes()
    content = gzip.decompress(raw) if name.endswith("gz") else raw
    random = np.random.default_rng(20261121)
    path = tmp_path / "damaged.log"
    for _ in range(12):
        damaged = bytearray(content[:40_000])
        for at in random.integers(0, len(damaged), 40):
            damaged[at] = random.integers(0, 256)
        path.write_bytes(bytes(damaged[: random.integers(1, len(damaged))]))
        try:
            reading = read(path).epochs
        except FormatError:
            continue
        # What is read passed its checksum: it is near the receiver, a fixed place.
        assert reading["est_lat_rad"].abs().max() < math.pi / 2  # type: ignore[operator]
        assert reading["time_ns"].is_sorted()


@pytest.mark.parametrize(
    ("name", "judged", "recorded"),
    [
        # Thirty epochs of the cold start, and three of the other, are without a position or a time: less than 95 % are judged.
        ("ubx_16dB/16dBatt_no_interference_coldstart.ubx.gz", 552, 582),
        ("pysbf2/sbfdata.log", 58, 58),
        ("novatel/oemv_200911218.gps", 46, 49),
        ("gpsd/ublox-zed-f9p-nmea.log", 29, 29),
    ],
)
def test_a_log_is_judged_like_any_track(logs: Path, tmp_path: Path, name: str, judged: int, recorded: int) -> None:
    run = navbound.analyze(logs / name, spec="RNP 0.3", out=tmp_path / "run")
    assert run.summary.verdict.id == ("inside" if judged >= 0.95 * recorded else "not_shown")
    assert (run.summary.verdict.n_judged, run.summary.verdict.n_epochs) == (judged, recorded)
    assert isinstance(run.epochs, pl.DataFrame)
