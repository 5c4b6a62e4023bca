"""Logs of makers that are not read, binary files of no kind, and texts that are no table: the sentence names what it is and what to do.

The files are made here by the frames of the public protocol descriptions, with random contents.
"""

from __future__ import annotations

import functools
import operator
import random
import struct
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import FormatError, InputError, araim, gnss, live, raim
from navbound.exit_status import NO_VERDICT, of_verdict
from navbound.read import formats
from test_live_receivers import RNP_M, lived

RANDOM = random.Random(3)
START_S = 1_741_096_809


def junk(n: int) -> bytes:
    return bytes(RANDOM.randrange(256) for _ in range(n))


def doubled(content: bytes) -> bytes:
    return content.replace(b"\x10", b"\x10\x10")


def garmin(identifier: int, data: bytes) -> bytes:
    """Identifier, size and data; the sum of all with the last byte is 0 modulo 256."""
    content = bytes([len(data)]) + data
    return b"\x10" + bytes([identifier]) + doubled(content + bytes([-(identifier + sum(content)) & 255])) + b"\x10\x03"


def tsip(identifier: int, data: bytes) -> bytes:
    return b"\x10" + bytes([identifier]) + doubled(data) + b"\x10\x03"


def tsip_1(identifier: int, part: int, data: bytes) -> bytes:
    """The second form: part, length, mode, data, exclusive or."""
    content = bytes([identifier, part]) + struct.pack(">H", len(data) + 2) + b"\x02" + data
    return b"\x10" + content[:1] + doubled(content[1:] + bytes([functools.reduce(operator.xor, content)])) + b"\x10\x03"


def casic(group: int, identifier: int, payload: bytes) -> bytes:
    total = (identifier << 24) + (group << 16) + len(payload) + sum(struct.unpack(f"<{len(payload) // 4}I", payload))
    return b"\xba\xce" + struct.pack("<HBB", len(payload), group, identifier) + payload + struct.pack("<I", total & 0xFFFFFFFF)


def skytraq(message: bytes) -> bytes:
    return b"\xa0\xa1" + struct.pack(">H", len(message)) + message + bytes([functools.reduce(operator.xor, message)]) + b"\r\n"


def javad(name: bytes, body: bytes) -> bytes:
    return name + b"%03X" % len(body) + body


def hemisphere(number: int, block: bytes) -> bytes:
    return b"$BIN" + struct.pack("<HH", number, len(block)) + block + struct.pack("<H", sum(block) & 0xFFFF) + b"\r\n"


ANDROID = """#
# Header Description:
#
# Version: v3.0.6.4 Platform: 13 Manufacturer: Google Model: Pixel 6
#
# Raw,utcTimeMillis,TimeNanos,LeapSecond,TimeUncertaintyNanos,FullBiasNanos,BiasNanos
#
# Fix,Provider,LatitudeDegrees,LongitudeDegrees,AltitudeMeters,SpeedMps,AccuracyMeters,BearingDegrees,UnixTimeMillis
#
"""
FIXES = "".join(f"Fix,GPS,52.1{k:04d},0.17,86.5,1.05,3.5,324.2,{START_S}398\n" for k in range(50))
LONG = 1500
"""Frames of a log: enough that the two bytes of another maker's frame stand somewhere among them."""
LOGS = {
    "garmin": b"".join(garmin(0x33, junk(64)) for _ in range(LONG)),
    "tsip": b"".join(tsip(0x8F, junk(40)) for _ in range(LONG)),
    "tsip, second form": b"".join(tsip_1(0xA1, 0x11, junk(50)) for _ in range(LONG)),
    "casic": b"".join(casic(1, 3, junk(80)) for _ in range(LONG)),
    "skytraq": b"".join(skytraq(b"\xe5" + junk(60)) for _ in range(LONG)),
    "javad": javad(b"JP", b"RLOGF JPS") + b"\r\n" + b"".join(javad(b"~~", junk(5)) + javad(b"PV", junk(30)) + b"\n" for _ in range(LONG)),
    "hemisphere": b"".join(hemisphere(1, junk(52)) for _ in range(LONG)),
    "gnss-logger": (ANDROID + FIXES).encode(),
    "gnss-logger, without its head": FIXES.encode(),
    "dataflash": b"\xa3\x95\x80\x80\x59FMT\0BBnNZ\0" + junk(400),
    "git-lfs": b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n",
    "ais": b"!AIVDM,1,1,,A,15M67FC000G?ufbE`FepT@3n00Sa,0*5C\r\n" * 20,
    "igc": b"AXCS001\r\nHFDTE150722\r\n" + b"B1101355206343N00006198WA0058700558\r\n" * 9,
    "gpx": b'<?xml version="1.0"?>\n<gpx><trk><trkpt lat="48" lon="2"/></trk></gpx>',
}


@pytest.mark.parametrize("kind", LOGS)
def test_a_foreign_log_is_refused_by_its_name(tmp_path: Path, kind: str) -> None:
    expected = kind.split(",", maxsplit=1)[0]
    assert formats.of(LOGS[kind]).id == expected
    file = tmp_path / "log.bin"
    file.write_bytes(LOGS[kind])
    title = next(each for each in formats.FORMATS if each.id == expected)
    with pytest.raises(FormatError, match="which is not read: ") as refused:
        navbound.analyze(file)
    assert title.title in str(refused.value)
    assert title.instead
    assert title.instead in str(refused.value)


def test_a_foreign_log_that_begins_in_a_frame_is_known_too() -> None:
    for kind, log in LOGS.items():
        if not kind.startswith(("gnss", "igc", "gpx", "dataflash", "git", "ais")):
            assert formats.of(log[17:]).id == kind.split(",")[0], kind


def test_real_logs_of_receivers_are_what_they_were(shared_data: Path) -> None:
    """By the kind that their readers take; the Crescent's was not known."""
    assert formats.of((shared_data / "sbas" / "cres_20080526.bin").read_bytes()).id == "hemisphere"
    logs = [path for path in (shared_data / "rxlogs").rglob("*") if path.suffix in {".ubx", ".log", ".gps"}]
    kinds = {path.name: formats.of(path.read_bytes()).id for path in logs}
    assert len(kinds) > 12
    assert set(kinds.values()) <= {"ubx", "sbf", "novatel", "nmea"}, kinds
    assert {kinds[name] for name in ("sbfdata.log", "pygpsdata_x5pvt.log")} == {"sbf"}
    assert kinds["pygpsdata-RXMRAWX.log"] == "ubx"


@pytest.mark.parametrize("kind", ["random", "zeros", "floats"])
def test_binary_data_of_no_kind_are_called_so(tmp_path: Path, kind: str) -> None:
    file = tmp_path / "track.bin"
    of_kind = {"random": junk(300_000), "zeros": bytes(1000) + b"\x01", "floats": np.linspace(0.0, 1.0, 4000).tobytes()}
    file.write_bytes(of_kind[kind])
    with pytest.raises(FormatError, match="binary, of no kind that is known here; convert it"):
        navbound.analyze(file)


def test_a_text_with_damage_is_no_binary_file(tmp_path: Path) -> None:
    file = tmp_path / "track.csv"
    rows = "".join(f"{START_S + k},52.1{k:04d},0.17\n" for k in range(50))
    file.write_bytes(b"timestamp,latitude,longitude\n" + rows.encode() + b"\xff1,2\n")
    with pytest.raises(FormatError, match=r"track\.csv:52: not UTF-8 text"):
        navbound.analyze(file)


def track(**more: object) -> str:
    names = ["timestamp", "latitude", "longitude", "altitude", *more]
    rows = [[START_S + k, f"52.1{k:04d}", 0.17, 86, *more.values()] for k in range(60)]
    return "\n".join([",".join(names), *(",".join(map(str, row)) for row in rows)]) + "\n"


def test_a_field_that_goes_on_behind_its_quotation_mark_is_a_row_that_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "track.csv"
    lines = track().splitlines()
    lines[30] = lines[30].replace("52.1", '"52.1"', 1)
    file.write_text("\n".join(lines) + "\n")
    run = navbound.analyze(file, sigma_m=5.0)
    (rejected,) = run.summary.rejected
    assert (rejected.count, rejected.first_line) == (1, 31)
    # Nothing of the library that takes tables apart is shown to anybody.
    assert "dtype" not in rejected.reason
    assert "parse" not in rejected.reason


def test_a_truth_may_call_its_positions_so(tmp_path: Path) -> None:
    own, truth = tmp_path / "track.csv", tmp_path / "reference.csv"
    own.write_text(track(sde=2, sdn=2, sdu=3))
    # 0.000002 to 0.000006 deg north of the estimate: 0.2 to 0.7 m.
    lines = [f"{START_S + k},{float(f'52.1{k:04d}') + 2e-6 * (1 + k % 3):.7f},0.17,86" for k in range(60)]
    truth.write_text("\n".join(["timestamp,truth_lat,truth_lon,truth_h", *lines]) + "\n")
    run = navbound.analyze(own, truth=truth)
    north_m = run.epochs["nse_n_m"].to_numpy()
    expected = np.radians([2e-6 * (1 + k % 3) for k in range(60)]) * 6.378e6
    # Radius of curvature within half a per cent, and the last digit of the file.
    assert np.allclose(north_m, expected, rtol=0.01, atol=0.006)
    with pytest.raises(FormatError, match="name it with --truth beside the recording"):
        navbound.analyze(truth)


def sentence(body: str) -> str:
    return f"${body}*{functools.reduce(operator.xor, body.encode()):02X}\r\n"


def nmea(n: int, few: set[int], count: int = 0) -> str:
    """GGA with a valid quality, and RMC with its date; of some epochs GGA counts too few satellites."""
    out = ""
    for k in range(n):
        time = f"1200{k:02d}.00"
        out += sentence(f"GPGGA,{time},4804.{k:04d},N,00230.0000,E,1,{count if k in few else 9:02d},1.0,100.0,M,47.0,M,,")
        out += sentence(f"GPRMC,{time},A,4804.{k:04d},N,00230.0000,E,0.4,0.0,150725,,,A")
    return out


@pytest.mark.parametrize(
    ("count", "of_few"), [(0, "not_available reported"), (2, "not_available reported"), (3, "degraded few_satellites")]
)
@pytest.mark.parametrize("few", [set(), {5, 6}, set(range(60))])
def test_a_valid_fix_of_too_few_satellites_is_not_ok_and_counted(tmp_path: Path, few: set[int], count: int, of_few: str) -> None:
    file = tmp_path / "log.nmea"
    file.write_text(nmea(60, few, count))
    run = navbound.analyze(file, sigma_m=5.0)
    status, reason_id = of_few.split()
    assert run.summary.n_status == {kind: n for kind, n in ((status, len(few)), ("ok", 60 - len(few))) if n}
    stated = run.epochs.filter(pl.col("status") != "ok")
    assert set(stated["reason_id"]) == ({reason_id} if few else set())
    assert status == "degraded" or set(stated["reason"]) == ({f"the recording states {count} satellites"} if few else set())
    # A stream of the same bytes decides the same.
    epochs = lived(file, tmp_path / "live", live.Settings(format="nmea", rnp_m=RNP_M, sigma_m=5.0, standing=True))
    both = epochs.join(run.epochs, on="time_ns", suffix="_batch")
    assert both.height == 60
    assert (both["status"] == both["status_batch"]).all()
    assert both["reason_id"].eq_missing(both["reason_id_batch"]).all()
    counted = [words for words in run.summary.assumptions if "count fewer satellites than determine one" in words]
    assert [f" {len(few)} positions" in words for words in counted] == ([True] if few else [])
    if len(few) == 60:
        assert of_verdict(run.summary.verdict.id) == NO_VERDICT


HEADER = """     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE
G    1 C1C                                                  SYS / # / OBS TYPES
                                                            END OF HEADER
"""


def test_measurements_without_an_epoch_are_an_input_error(tmp_path: Path) -> None:
    file = tmp_path / "nothing.rnx"
    file.write_text(HEADER)
    observations = gnss.read_observations(file)
    assert observations.n_epochs == 0
    folder = Path(__file__).parents[1] / "examples" / "data"
    navigation = gnss.read_navigation(folder / "broadcast.rnx")
    with pytest.raises(InputError, match=r"nothing\.rnx: no epoch"):
        gnss.solve(observations, navigation)
    with pytest.raises(InputError, match=r"nothing\.rnx: no epoch"):
        raim.watch(observations, navigation)
    with pytest.raises(InputError, match=r"nothing\.rnx: no epoch"):
        araim.watch(observations, navigation)
    with pytest.raises(InputError, match=r"nothing\.rnx: no epoch"):
        gnss.solve(observations, navigation, signals="auto")
