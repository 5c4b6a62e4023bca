"""Kinds of files: packed ones are unpacked, those that nobody reads are refused by their name, and a log behind a banner is a log."""

from __future__ import annotations

import io
import random
import shutil
import subprocess
import zipfile
from typing import TYPE_CHECKING

import pytest

from navbound import _core
from navbound.errors import FormatError
from navbound.read import formats
from navbound.read.source import load
from navbound.read.tables.epochs import read
from packing import compress

if TYPE_CHECKING:
    from pathlib import Path

TRACK = "timestamp,latitude,longitude\n" + "".join(f"{1_700_000_000 + k},{50 + k * 1e-4:.4f},10.0\n" for k in range(200))


def zipped(*files: tuple[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    with zipfile.ZipFile(made := io.BytesIO(), "w", method) as archive:
        for name, content in files:
            archive.writestr(name, content)
    return made.getvalue()


@pytest.mark.parametrize(
    "packed", [compress(TRACK.encode()), zipped(("a.csv", TRACK.encode())), zipped(("a.csv", TRACK.encode()), method=0)]
)
def test_a_packed_table_is_the_table(tmp_path: Path, packed: bytes) -> None:
    (tmp_path / "plain.csv").write_text(TRACK)
    (tmp_path / "packed").write_bytes(packed)
    columns = ("time_ns", "est_lat_rad", "est_lon_rad")
    assert read(tmp_path / "packed").epochs.select(columns).equals(read(tmp_path / "plain.csv").epochs.select(columns))


@pytest.mark.parametrize("clear_every", [None, 700])
def test_compress_is_unpacked_as_gzip_unpacks_it(tmp_path: Path, clear_every: int | None) -> None:
    plain = bytes(random.Random(1).choices(b"0123456789 .", k=200_000))
    packed = compress(plain, clear_every=clear_every)
    assert _core.unpack(packed, "made here", 1 << 20, 200) == plain
    if (gzip := shutil.which("gzip")) is None:
        pytest.skip("SKIPPED ALOUD: no gzip to check the encoder with")
    (tmp_path / "made.Z").write_bytes(packed)
    assert subprocess.run([gzip, "-dc", str(tmp_path / "made.Z")], capture_output=True, check=True).stdout == plain


def test_damaged_and_ambiguous_packings_are_sentences_with_the_file(tmp_path: Path) -> None:
    whole = zipped(("a.csv", TRACK.encode()))
    changed = bytearray(whole)
    changed[60] ^= 0x55
    cases = {
        "list of contents is missing": whole[:-30],
        "damaged": bytes(changed),
        "2 files (a.csv, b.csv)": zipped(("a.csv", b"1"), ("b.csv", b"2")),
        "holds no file": zipped(),
        "never defined": b"\x1f\x9d\x90" + bytes([65, 0xFE, 0xFF, 0xFF]),
        "codes of 31 bits": b"\x1f\x9d\x9f\x00\x00",
        "bzip2": b"BZh91AY&SY",
    }
    for words, content in cases.items():
        (path := tmp_path / "file").write_bytes(content)
        with pytest.raises(FormatError) as refused:
            load(path)
        assert words in str(refused.value), refused.value
        assert str(path) in str(refused.value)


def rtcm(message: bytes) -> bytes:
    frame = b"\xd3" + len(message).to_bytes(2) + message
    crc = 0
    for byte in frame:
        crc ^= byte << 16
        for _ in range(8):
            crc = crc << 1 ^ (0x1864CFB if crc & 0x800000 else 0)
    return frame + crc.to_bytes(3)


def sirf(message: bytes) -> bytes:
    return b"\xa0\xa2" + len(message).to_bytes(2) + message + (sum(message) & 0x7FFF).to_bytes(2) + b"\xb0\xb3"


STREAMS = {
    "RTCM 3": b"".join(rtcm(bytes([0x3E, 0xD0]) + bytes(range(k, k + 17))) for k in range(20)),
    "SiRF": b"".join(sirf(bytes([2, *range(k, k + 40)])) for k in range(20)),
    "TSIP": b"".join(b"\x10\x8f\xab" + bytes([k + 32] * 16).replace(b"\x10", b"\x10\x10") + b"\x10\x03" for k in range(20)),
    "ULog": b"ULog\x01\x12\x35\x01" + bytes(range(64)),
}


@pytest.mark.parametrize("name", STREAMS)
def test_a_kind_that_is_not_read_is_refused_by_its_name(tmp_path: Path, name: str) -> None:
    # A stream begins where someone began to listen, but an autopilot's file has a beginning.
    for content in (STREAMS[name], STREAMS[name] if name == "ULog" else STREAMS[name][5:]):
        (path := tmp_path / "log.bin").write_bytes(content)
        with pytest.raises(FormatError, match=name):
            load(path)


def test_the_crc_of_a_published_message_is_met() -> None:
    """RTCM 10403 message 1005, the example that the standard prints."""
    message = bytes.fromhex("D300133ED7D30202980EDEEF34B4BD62AC0941986F33360B98")
    assert rtcm(message[3:-3]) == message
    assert formats.of(message).id == "rtcm3"
    assert formats.of(message[:-1] + b"\x99").id == "csv"


def test_logs_that_are_read_are_no_foreign_stream(shared_data: Path) -> None:
    files = [f for f in sorted((shared_data / "rxlogs").rglob("*")) if f.is_file()]
    assert len(files) > 5
    for file in files:
        assert formats.of(file.read_bytes()).instead is None, file


NMEA = [
    "GPRMC,235958.00,A,5000.0000,N,01000.0000,E,0.0,0.0,311216,,",
    "GPGGA,235959.00,5000.0000,N,01000.0000,E,1,09,0.9,300.0,M,47.0,M,,",
    "GPGGA,235960.00,5000.0010,N,01000.0000,E,1,09,0.9,300.0,M,47.0,M,,",
    "GPGGA,000000.00,5000.0020,N,01000.0000,E,1,09,0.9,300.0,M,47.0,M,,",
]


def sentences(lines: list[str]) -> bytes:
    def checked(line: str) -> str:
        check = 0
        for c in line:
            check ^= ord(c)
        return f"${line}*{check:02X}\r\n"

    return "".join(map(checked, lines)).encode()


def test_second_60_of_a_sentence_is_a_second_of_its_own(tmp_path: Path) -> None:
    (path := tmp_path / "leap.nmea").write_bytes(sentences(NMEA))
    # 2016-12-31 ended with a leap second: GPS - UTC went from 17 to 18 s, and three sentences are three seconds.
    assert (read(path).epochs["time_ns"].diff().drop_nulls() == 1_000_000_000).all()
    ordinary = [line.replace("311216", "311215") for line in NMEA]
    more = [NMEA[3].replace("000000.00", f"0000{k:02d}.00") for k in range(1, 31)]
    path.write_bytes(sentences(ordinary + more))
    reading = read(path)
    assert reading.epochs.height == 32
    assert [(r.count, r.example) for r in reading.rejected if "second 60" in r.reason] == [(1, "record 3: 235960.00")]


def test_a_log_behind_a_banner_of_json_is_the_log(tmp_path: Path) -> None:
    (plain := tmp_path / "plain.nmea").write_bytes(sentences(NMEA))
    banner = b'{"class":"VERSION","release":"3.25"}\r\n{"class":"DEVICES","devices":[]}\r\n'
    (behind := tmp_path / "plain.json").write_bytes(banner + sentences(NMEA))
    assert read(behind).epochs.drop("track").equals(read(plain).epochs.drop("track"))
    # JSON that merely holds such text stays JSON.
    (rows := tmp_path / "rows.jsonl").write_text(
        '{"latitude": 50.0, "longitude": 10.0, "timestamp": 1700000000, "raw": "$GPGGA,1*00"}\n' * 3
    )
    assert load(rows).kind == "json"


@pytest.mark.parametrize(("first", "step"), [(112_345_678, 100_000), (2_000_000_000, 100_000), (5_000_000, 20_000)])
def test_microseconds_since_the_start_are_named_as_such(tmp_path: Path, first: int, step: int) -> None:
    rows = "".join(f"{first + step * k},{50 + k * 1e-4:.4f},10.0\n" for k in range(50))
    (path := tmp_path / "boot.csv").write_text("timestamp,latitude,longitude\n" + rows)
    with pytest.raises(FormatError, match="microseconds since the computer or receiver started"):
        read(path)
    (declared := tmp_path / "us.csv").write_text("time_us,latitude,longitude\n" + rows)
    with pytest.raises(FormatError, match="since the computer or receiver started"):
        read(declared)
