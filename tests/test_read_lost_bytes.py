"""Bytes that a damaged file has lost: no number is made of the rest, and every loss is stated."""

from __future__ import annotations

import gzip
import hashlib
import struct
from pathlib import Path

import numpy as np
import pytest

from conftest import SHARED
from navbound import FormatError, gnss, sbas
from navbound.read import read
from navbound.scale.checkpoint import Folder
from test_read_receivers_damaged import BESTPOS, GGA, PVT, RMC, nmea, novatel, ubx

DATA = SHARED / "data"
SECOND_NS = 1_000_000_000


def put(folder: Path, name: str, content: bytes) -> Path:
    path = folder / name
    path.write_bytes(content)
    return path


def test_a_sentence_with_a_byte_that_is_no_letter_is_counted(tmp_path: Path) -> None:
    sound = [nmea(RMC), *(nmea(GGA.replace(b"120001", b"1200%02d" % k)) for k in range(12))]
    assert read(put(tmp_path, "a.nmea", b"".join(sound))).rejected == []
    sound[3] = sound[3].replace(b"4715", b"47\xb15")
    reading = read(put(tmp_path, "a.nmea", b"".join(sound)))
    assert (reading.epochs.height, [r.count for r in reading.rejected]) == (11, [1])


def test_a_sentence_of_an_unknown_kind_is_no_damage(tmp_path: Path) -> None:
    sentences = nmea(RMC) + nmea(b"PXYZ,1,2,3") + nmea(GGA)
    assert read(put(tmp_path, "a.nmea", sentences)).rejected == []


def timegps(itow_ms: int, ftow_ns: int, week: int) -> bytes:
    return struct.pack("<IihbBI", itow_ms, ftow_ns, week, 18, 7, 10)


def test_a_time_whose_check_sum_is_wrong_dates_nothing(tmp_path: Path) -> None:
    pvt = ubx(b"\x01\x07", PVT)
    dating = ubx(b"\x01\x20", timegps(1000, 250, 2320))
    sound = pvt + dating
    sound += b"".join(ubx(b"\x01\x07", struct.pack("<I", 2000 + k) + PVT[4:]) for k in range(12))
    stated = 2320 * 604_800 * SECOND_NS + SECOND_NS + 250
    assert stated in read(put(tmp_path, "a.ubx", sound)).epochs["time_ns"]
    wrong = bytearray(sound)
    wrong[len(pvt) + 6 + 4] ^= 0x40
    reading = read(put(tmp_path, "a.ubx", bytes(wrong)))
    assert stated + 64 not in reading.epochs["time_ns"]
    assert stated not in reading.epochs["time_ns"]
    assert [r.count for r in reading.rejected if "checksum" in (r.example or "") + r.reason] == [1]


def test_novatel_bytes_outside_frames_are_stated(tmp_path: Path) -> None:
    frame = novatel(42, BESTPOS)
    assert not any("belong to no message" in note for note in read(put(tmp_path, "a.bin", frame)).notes)
    lost = frame + b"\0" + novatel(42, BESTPOS)[1:]
    notes = read(put(tmp_path, "a.bin", lost)).notes
    assert any(f"{len(frame)} of {2 * len(frame)} bytes belong to no message" in note for note in notes)


SOLUTIONS = """%  GPST                  latitude(deg) longitude(deg)  height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s)
2023/07/11 06:04:54.000   35.165360851  136.881409530    41.3947   1  19   0.0045   0.0045   0.0097   0.0027   0.0012  -0.0030   0.03
"""


def test_solutions_without_a_refusal_leave_no_row_out(tmp_path: Path) -> None:
    assert read(put(tmp_path, "a.pos", SOLUTIONS.encode())).left_out.is_empty()


OBSERVATIONS = (
    "     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE\n"
    "G    2 C1C L1C                                              SYS / # / OBS TYPES \n"
    "                                                            END OF HEADER       \n"
    "> 2025 02 15 17 00  0.0000000  0  2\n"
    "G20  22709399.626   119338700.415  \n"
    "G30  24707953.631   129841172.643  \n"
)


# Cut behind the last number; within the second number, the first, behind the satellite's name, and before it. A line that ends between two
# numbers is a whole one: what was not measured may be left out.
@pytest.mark.parametrize(("keep", "n_values", "n_refused"), [(0, 2, 0), (-8, 2, 1), (-22, 1, 1), (-30, 1, 0), (-34, 0, 1)], ids=str)
def test_no_number_is_made_of_what_a_cut_line_leaves(tmp_path: Path, keep: int, n_values: int, n_refused: int) -> None:
    whole = OBSERVATIONS.rstrip("\n") + "  " if keep == 0 else OBSERVATIONS.rstrip("\n ")[:keep]
    o = gnss.read_observations(put(tmp_path, "a.rnx", whole.encode()))
    ranges = o.column("G", "C1C")
    phases = o.column("G", "L1C")
    values = set(ranges["value"].drop_nans()) | set(phases["value"].drop_nans())
    assert values <= {22709399.626, 119338700.415, 24707953.631, 129841172.643}
    assert len(set(ranges["value"].drop_nans())) == n_values
    assert "G03" not in set(ranges["satellite"])
    assert o.n_refused == n_refused


@pytest.mark.parametrize("name", [" C\xb1C", " C C", "xC1C", "  1C"])
def test_what_is_no_name_of_an_observation_is_refused(tmp_path: Path, name: str) -> None:
    wrong = OBSERVATIONS.replace(" C1C", name, 1).encode("latin-1")
    with pytest.raises(FormatError, match="is not the name of an observation"):
        gnss.read_observations(put(tmp_path, "a.rnx", wrong))


def test_a_satellite_name_of_two_columns_has_lost_its_digit(tmp_path: Path) -> None:
    at = OBSERVATIONS.index("G30") + 2
    o = gnss.read_observations(put(tmp_path, "a.rnx", OBSERVATIONS[:at].encode()))
    assert set(o.column("G", "C1C")["satellite"]) <= {"G20"}
    assert o.n_refused == 1


def record() -> tuple[str, str]:
    """Head and first record of a real navigation file."""
    if not DATA.is_dir():
        pytest.skip(f"SKIPPED ALOUD: no real data at {DATA}")
    text = (DATA / "sbas" / "gps_2025046_17h_rinex3.nav").read_text()
    head, body = text.split("END OF HEADER", 1)
    lines = body.splitlines(keepends=True)
    return head + "END OF HEADER" + lines[0], "".join(lines[1:9])


def test_a_navigation_record_that_is_cut_within_a_number_is_refused(tmp_path: Path) -> None:
    head, one = record()
    assert gnss.read_navigation(put(tmp_path, "a.nav", (head + one).encode())).n_ephemerides == 1
    row = one.splitlines()
    for lost in (5, 10):
        rows = [*row[:6], row[6][:80].rstrip()[:-lost]]
        n = gnss.read_navigation(put(tmp_path, "a.nav", (head + "\n".join(rows)).encode()))
        assert (n.n_ephemerides, len(n.refused)) == (0, 1)


def test_a_fit_interval_that_is_no_number_is_refused(tmp_path: Path) -> None:
    head, one = record()
    rows = one.splitlines()
    rows[7] = rows[7][:23] + "       x           " + rows[7][42:]
    n = gnss.read_navigation(put(tmp_path, "a.nav", (head + "\n".join(rows) + "\n").encode()))
    assert (n.n_ephemerides, len(n.refused)) == (0, 1)


def test_two_positions_of_one_satellite_in_one_epoch_are_none(tmp_path: Path) -> None:
    if not DATA.is_dir():
        pytest.skip(f"SKIPPED ALOUD: no real data at {DATA}")
    text = (DATA / "gnss" / "igs_2010_182" / "igs15904.sp3").read_text()
    epochs = text.split("\n*")
    epochs[3] = epochs[3].replace("PG22", "PG26")
    sound = gnss.read_orbits(DATA / "gnss" / "igs_2010_182" / "igs15904.sp3")
    p = gnss.read_orbits(put(tmp_path, "a.sp3", "\n*".join(epochs).encode()))
    assert (p.n_positions, p.n_clocks) == (sound.n_positions - 2, sound.n_clocks - 2)
    assert [r.reason for r in p.refused] == ["a second and other position in one epoch; neither is taken"]


def test_an_epoch_of_a_compact_file_with_a_line_too_many_is_left_out(tmp_path: Path) -> None:
    head = (
        "3.0                 COMPACT RINEX FORMAT                    CRINEX VERS   / TYPE\n"
        "RNX2CRX ver.4.0.7                       24-Jun-20 00:00     CRINEX PROG / DATE  \n" + OBSERVATIONS.split("> 2025", maxsplit=1)[0]
    )
    epoch = "> 2025 02 15 17 00  0.0000000  0  2      G20G30\n\n"
    lines = ["3&22709399626 3&119338700415\n", "3&24707953631 3&129841172643\n"]
    second = "                   3\n\n" + "1000 2000\n" + "3000 4000\n"
    sound = gnss.read_observations(put(tmp_path, "a.crx", (head + epoch + "".join(lines) + second).encode()))
    assert (sound.n_epochs, sound.n_refused) == (2, 0)
    wrong = head + epoch + "3&21000000000 3&110000000000\n" + "".join(lines) + second
    o = gnss.read_observations(put(tmp_path, "a.crx", wrong.encode()))
    assert o.n_epochs == 0
    assert o.n_refused > 0


def test_two_messages_of_one_satellite_in_one_second_are_none(tmp_path: Path) -> None:
    if not DATA.is_dir():
        pytest.skip(f"SKIPPED ALOUD: no real data at {DATA}")
    lines = gzip.decompress((DATA / "sbas" / "more" / "prn137_2025046_17h.ems.gz").read_bytes()).decode().splitlines()[:40]
    assert len(sbas.read(put(tmp_path, "a.ems", "\n".join([*lines, lines[-1]]).encode())).time_ns) == 41
    first, second = lines[20].split(), lines[21].split()
    lines[21] = " ".join([*first[:7], *second[7:]])
    log = sbas.read(put(tmp_path, "a.ems", "\n".join(lines).encode()))
    assert [(r.line, r.reason) for r in log.refused] == [
        (n, "another message of this satellite has the same time; neither is taken") for n in (21, 22)
    ]


def test_an_almanac_with_an_angle_of_many_turns_is_refused(tmp_path: Path) -> None:
    if not DATA.is_dir():
        pytest.skip(f"SKIPPED ALOUD: no real data at {DATA}")
    text = (DATA / "gnss" / "almanacs" / "20160331.alm").read_text()
    line = next(line for line in text.splitlines() if line.startswith("Mean Anom"))
    wrong = text.replace(line, line.split(":")[0] + ":  0.9E+299", 1)
    with pytest.raises(FormatError, match="mean anomaly"):
        gnss.constellation(put(tmp_path, "a.alm", wrong.encode()))


def test_a_file_with_the_digest_of_something_else_is_no_tile(tmp_path: Path) -> None:
    folder = Folder(tmp_path, "a job")
    folder.store(0, "a tile", {"level_m": np.arange(3.0)})
    file = folder.file(0, "a tile")
    for other in (b"\xd6", b"PK\x03\x04", b"\x93NUMPY\x01\0"):
        file.write_bytes(other + hashlib.sha256(other).hexdigest().encode())
        assert folder.load(0, "a tile") is None


def test_bytes_outside_the_frames_of_a_raw_log_are_counted(tmp_path: Path) -> None:
    epoch = ubx(b"\x02\x15", struct.pack("<dHbBBBBB", 1000.0, 2361, 18, 0, 1, 1, 0, 0))
    later = ubx(b"\x02\x15", struct.pack("<dHbBBBBB", 1001.0, 2361, 18, 0, 1, 1, 0, 0))
    assert gnss.read_observations(put(tmp_path, "a.ubx", epoch + later)).skipped == {}
    lost = gnss.read_observations(put(tmp_path, "a.ubx", epoch + b"\0" + later[1:] + later))
    assert sum(n for kind, n in lost.skipped.items() if "outside frames" in kind) == len(later)
