"""Whole frames of receivers with wrong contents: right checksums around changed bytes. Frames are made here, by the makers' documents."""

from __future__ import annotations

import binascii
import math
import struct
from pathlib import Path

import numpy as np
import pytest

from navbound import FormatError, gnss, sbas
from navbound.read import read

Generator = np.random.Generator


def ubx(identity: bytes, payload: bytes) -> bytes:
    body = identity + struct.pack("<H", len(payload)) + payload
    a = b = 0
    for byte in body:
        a = (a + byte) & 0xFF
        b = (b + a) & 0xFF
    return b"\xb5\x62" + body + bytes([a, b])


def sbf(block: int, body: bytes) -> bytes:
    body += bytes(-len(body) % 4)
    checked = struct.pack("<HH", block, len(body) + 8) + body
    # CRC-16 of the CCITT, beginning with zero.
    return b"$@" + struct.pack("<H", binascii.crc_hqx(checked, 0)) + checked


def nmea(text: bytes) -> bytes:
    total = 0
    for byte in text:
        total ^= byte
    return b"$" + text + b"*%02X\r\n" % total


def novatel(message: int, body: bytes) -> bytes:
    head = b"\xaa\x44\x12\x1c" + struct.pack("<HBBHHBBHiIHH", message, 0, 0, len(body), 0, 100, 180, 1562, 515_265_000, 0, 0, 0)
    # CRC-32 without the inversions of the common one.
    crc = binascii.crc32(head + body, 0xFFFFFFFF) ^ 0xFFFFFFFF
    return head + body + struct.pack("<I", crc)


PVT = struct.pack("<IHBBBBBBIiBBBB", 1000, 2024, 6, 23, 12, 0, 1, 7, 20, -5, 3, 1, 0, 17)
PVT += struct.pack("<iiiiII", 60_000_000, 472_500_000, 371_496, 323_000, 1_700, 2_500).ljust(92 - len(PVT), b"\0")
PVT_GEODETIC = struct.pack("<IHBB3d5f", 456_000_000, 2361, 1, 0, 0.82, 0.1, 371.5, 47.0, 3.0, 4.0, -0.5, 90.0)
PVT_GEODETIC += struct.pack("<dfBBBBHHIBBHHHHBB", 0.0, 0.0, 0, 0, 12, 0, 0, 0, 0, 0, 0, 0, 0, 100, 200, 0, 0)
POS_COV_GEODETIC = struct.pack("<IHBB10f", 456_000_000, 2361, 1, 0, 4.0, 9.0, 16.0, 1.0, 0.5, -0.25, 0.0, 1.5, 0.0, 0.0)
BESTPOS = struct.pack("<II3dfI3f4sffBBBBBBBB", 0, 16, 51.0, -114.0, 1000.0, -16.0, 61, 1.5, 0.9, 2.1, b"0", 0.0, 0.0, *[9] * 4, 0, 0, 0, 0)
GGA = b"GPGGA,120001.00,4715.0,N,00600.0,E,1,12,0.9,100.0,M,40.0,M,,"
RMC = b"GPRMC,120000.00,A,4715.0,N,00600.0,E,0.0,,230624,,,A"
GST = b"GPGST,120001.00,1.0,4.0,2.0,45.0,3.0,3.0,5.0"


def test_septentrio_geodetic_blocks_make_a_row(tmp_path: Path) -> None:
    path = tmp_path / "geodetic.sbf"
    path.write_bytes(sbf(4007 | 2 << 13, PVT_GEODETIC) + sbf(5906, POS_COV_GEODETIC))
    reading = read(path)
    row = reading.epochs.row(0, named=True)
    assert (row["est_lat_rad"], row["est_lon_rad"], row["est_h_m"], row["n_sv"]) == (0.82, 0.1, 371.5, 12)
    assert row["time_ns"] == (2361 * 604_800 + 456_000) * 1_000_000_000
    assert (row["ground_speed_mps"], row["vertical_rate_mps"]) == (5.0, -0.5)
    # The block's order: latitude, longitude, height, clock; then latitude with longitude, height, clock; longitude with height.
    expected = {"nn": 4.0, "ee": 9.0, "uu": 16.0, "en": 0.5, "nu": -0.25, "eu": 1.5}
    assert {k: row[f"cov_{k}_m2"] for k in expected} == expected
    assert reading.columns["covariance"] == "PosCovGeodetic"


def test_novatel_frames_of_our_own_are_read(tmp_path: Path) -> None:
    path = tmp_path / "bestpos.bin"
    path.write_bytes(novatel(42, BESTPOS))
    row = read(path).epochs.row(0, named=True)
    assert math.degrees(row["est_lat_rad"]) == pytest.approx(51.0)
    assert row["cov_nn_m2"] == pytest.approx(2.25)


def _changed(random: Generator, body: bytes) -> bytes:
    """Bytes at a few places replaced; often by extremes, now and then cut or lengthened."""
    changed = bytearray(body)
    for at in random.integers(0, len(changed), random.integers(1, 12)):
        changed[at] = int(random.choice([0, 1, 0x7F, 0x80, 0xFF, int(random.integers(0, 256))]))
    if random.random() < 0.2:
        return bytes(changed[: random.integers(0, len(changed))])
    return bytes(changed + bytes(random.integers(0, 9))) if random.random() < 0.2 else bytes(changed)


def _ubx(random: Generator) -> bytes:
    kinds = [(b"\x01\x07", PVT), (b"\x01\x36", bytes(64)), (b"\x01\x62", bytes(52)), (b"\x01\x04", bytes(18)), (b"\x01\x20", bytes(16))]
    return ubx(b"\x01\x07", PVT) + b"".join(ubx(identity, _changed(random, body)) for identity, body in kinds)


def _sbf(random: Generator) -> bytes:
    kinds = [(4007 | 2 << 13, PVT_GEODETIC), (5906, POS_COV_GEODETIC), (4006, bytes(88)), (5905, POS_COV_GEODETIC), (4001, bytes(24))]
    return sbf(*kinds[0]) + b"".join(sbf(block, _changed(random, body)) for block, body in kinds)


def _nmea(random: Generator) -> bytes:
    return nmea(RMC) + nmea(GGA) + b"".join(nmea(_changed(random, body)) for body in (RMC, GGA, GST, b"GPGBS,120001.00,1.0,2.0,3.0,,,,"))


def _novatel(random: Generator) -> bytes:
    return novatel(42, BESTPOS) + novatel(42, _changed(random, BESTPOS)) + novatel(int(random.integers(0, 2000)), _changed(random, BESTPOS))


@pytest.mark.parametrize("make", [_ubx, _sbf, _nmea, _novatel], ids=["ubx", "sbf", "nmea", "novatel"])
def test_whole_frames_with_wrong_contents_are_read_counted_or_refused(tmp_path: Path, make: object) -> None:
    assert callable(make)
    random = np.random.default_rng(20261122)
    path = tmp_path / "changed.log"
    n_read = n_refused = 0
    for _ in range(150):
        path.write_bytes(b"".join(make(random) for _ in range(int(random.integers(1, 4)))))
        try:
            reading = read(path).epochs
        except FormatError:
            n_refused += 1
            continue
        n_read += 1
        assert reading["time_ns"].is_sorted()
        for name in ("est_lat_rad", "est_lon_rad"):
            assert reading[name].is_finite().all()
        assert reading["est_lat_rad"].abs().max() <= math.pi / 2  # type: ignore[operator]
    # Both happen, so neither answer is given to everything.
    assert n_read > 20
    assert n_read + n_refused == 150


@pytest.mark.parametrize("identity", [b"\x02\x15", b"\x02\x13", b"\x02\x10", b"\x02\x11"])
def test_raw_frames_with_wrong_contents_are_counted_or_refused(tmp_path: Path, identity: bytes) -> None:
    random = np.random.default_rng(20261123)
    path = tmp_path / "raw.ubx"
    epoch = ubx(b"\x02\x15", struct.pack("<dHbBBBBB", 1000.0, 2361, 18, 0, 1, 1, 0, 0))
    for _ in range(60):
        path.write_bytes(epoch + ubx(identity, _changed(random, bytes(random.integers(0, 256, 72, dtype=np.uint8)))))
        assert gnss.read_observations(path).n_epochs >= 1
        assert gnss.read_navigation(path).n_ephemerides == 0
        with pytest.raises(FormatError, match="SBAS"):
            sbas.read(path)
