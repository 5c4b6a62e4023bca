"""Epochs that cannot be read were measured all the same: they count as not judged, wherever in the recording they stand."""

from __future__ import annotations

import gzip
import math
import struct
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import navbound
from navbound import gnss
from navbound.errors import FormatError
from navbound.examples.files import STATION

if TYPE_CHECKING:
    from collections.abc import Container

    from navbound.run.directory import Run


@pytest.fixture
def whole(shared_data: Path, tmp_path: Path) -> tuple[Path, Path]:
    folder = shared_data / "gnss" / "taroz_static"
    text = gzip.decompress((folder / "rover.obs.gz").read_bytes()).decode("latin-1")
    path = tmp_path / "whole.obs"
    path.write_text(text, encoding="latin-1")
    return path, folder / "base.nav"


def damaged(path: Path, every: int, *, from_share: float = 0.0) -> Path:
    """With a letter for a digit in the year of every so many epoch lines behind this share of them."""
    lines = path.read_text(encoding="latin-1").splitlines(keepends=True)
    epochs = [k for k, line in enumerate(lines) if line.startswith(">")]
    for k in epochs[int(from_share * len(epochs)) :: every]:
        lines[k] = lines[k].replace("> 20", "> 2O", 1)
    out = path.with_name(f"damaged_{every}_{from_share}.obs")
    out.write_text("".join(lines), encoding="latin-1")
    return out


def test_every_second_epoch_without_a_date_is_half_of_them_not_judged(whole: tuple[Path, Path]) -> None:
    path, navigation = whole
    n = gnss.read_observations(path).n_epochs
    observations = gnss.read_observations(damaged(path, 2))
    assert (observations.n_epochs, observations.n_lost_epochs) == (n // 2, n - n // 2)
    verdict = navbound.analyze([observations.path, navigation]).summary.verdict
    assert verdict.id == "not_shown"
    assert verdict.n_unjudged >= n - n // 2


def test_an_end_without_dates_is_not_judged_either(whole: tuple[Path, Path]) -> None:
    path, navigation = whole
    verdict = navbound.analyze([damaged(path, 1, from_share=0.4), navigation]).summary.verdict
    assert verdict.id == "not_shown"


def test_indicators_over_time_are_refused_where_a_tenth_of_the_epochs_is_lost(whole: tuple[Path, Path]) -> None:
    path, navigation = whole
    with pytest.raises(
        FormatError, match=r"\d+ of \d+ epochs cannot be read, more than the 10% that may be lost; the first: epoch is not a date"
    ):
        navbound.evaluate([damaged(path, 5), navigation], levels="NPA")


def ubx(kind: bytes, payload: bytes) -> bytes:
    body = kind + struct.pack("<H", len(payload)) + payload
    a = b = 0
    for byte in body:
        a = (a + byte) & 0xFF
        b = (b + a) & 0xFF
    return b"\xb5\x62" + body + bytes((a, b))


def pvt(second: int, *, fix: int = 3, accuracy_mm: int = 2000) -> bytes:
    payload = bytearray(92)
    struct.pack_into("<IHBBBBBB", payload, 0, 1000 * second, 2026, 11, 22, 12, second // 60, second % 60, 0b111)
    payload[20], payload[21], payload[23] = fix, int(fix > 0), 12
    struct.pack_into("<iiii", payload, 24, 25_000_000, 490_000_000 + 300 * second, 100_000, 60_000)
    struct.pack_into("<II", payload, 40, accuracy_mm, accuracy_mm)
    # 3e-5 degrees of latitude each second: 3.34 m/s to the north, as velocity and as speed over ground.
    struct.pack_into("<iiii", payload, 48, 3336, 0, 0, 3336)
    return ubx(b"\x01\x07", bytes(payload))


def cov(second: int, variance: float = 2.0) -> bytes:
    terms = struct.pack("<6f", variance, 0.0, 0.0, variance, 0.0, variance)
    return ubx(b"\x01\x36", struct.pack("<IBBB9x", 1000 * second, 0, 1, 1) + terms + bytes(24))


@pytest.mark.parametrize(
    ("without", "expected"),
    [(range(0), "inside"), (range(100), "not_shown"), (range(80, 200), "not_shown"), (range(0, 200, 2), "not_shown"), (range(5), "inside")],
)
def test_epochs_in_which_a_receiver_had_no_fix_are_not_judged(tmp_path: Path, without: range, expected: str) -> None:
    path = tmp_path / "log.ubx"
    path.write_bytes(b"".join(pvt(k, fix=0 if k in without else 3) + cov(k) for k in range(200)))
    verdict = navbound.analyze(path).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_judged) == (expected, 200, 200 - len(without))


def test_damage_of_other_messages_takes_no_position_away(tmp_path: Path) -> None:
    raw = bytearray(ubx(b"\x02\x15", bytes(400)))
    raw[50] ^= 1
    path = tmp_path / "log.ubx"
    path.write_bytes(b"".join(bytes(raw) + pvt(k) + cov(k) for k in range(100)))
    run = navbound.analyze(path)
    assert (run.summary.verdict.id, run.summary.verdict.n_judged) == ("inside", 100)
    assert {r.reason: r.count for r in run.summary.rejected} == {"damaged message of no position": 100}


def test_a_damaged_position_is_an_epoch_that_is_not_judged(tmp_path: Path) -> None:
    frames = [bytearray(pvt(k)) for k in range(200)]
    for frame in frames[190:]:
        frame[40] ^= 1
    path = tmp_path / "log.ubx"
    path.write_bytes(b"".join(bytes(frame) + cov(k) for k, frame in enumerate(frames)))
    verdict = navbound.analyze(path).summary.verdict
    assert (verdict.n_epochs, verdict.n_judged) == (200, 190)


def test_an_accuracy_that_is_worse_than_the_covariance_beside_it_counts(tmp_path: Path) -> None:
    path = tmp_path / "log.ubx"
    path.write_bytes(b"".join(pvt(k, accuracy_mm=20_000_000) + cov(k) for k in range(60)))
    run = navbound.analyze(path)
    assert run.summary.verdict.id == "outside"
    assert any("hAcc or vAcc is worse than NAV-COV" in words for words in run.summary.assumptions)
    # Half of 20 km squared on each axis.
    assert run.epochs["cov_ee_m2"][0] == pytest.approx(2e8, rel=1e-6)


def test_a_refused_evaluation_leaves_nothing_behind(whole: tuple[Path, Path], tmp_path: Path) -> None:
    path, navigation = whole
    with pytest.raises(FormatError, match="cannot be read"):
        navbound.evaluate([damaged(path, 5), navigation], levels="NPA", out=tmp_path / "run")
    assert not (tmp_path / "run").exists() or not list((tmp_path / "run").iterdir())


EXAMPLES = Path(__file__).parents[1] / "examples" / "data"


def with_own_positions(log: Path, n: int, *, off_deg: float = 0.0, of: Container[int] = range(10**9)) -> Run:
    """The example of a log with positions of the receiver itself, each second; some of them are elsewhere."""
    times_ns = gnss.read_observations(EXAMPLES / "receiver.ubx").time_ns
    begin = datetime(1980, 1, 6, tzinfo=UTC) + timedelta(seconds=int(times_ns[0]) // 10**9 - 18)
    own = b""
    for second in range(n):
        at = begin + timedelta(seconds=second)
        payload = bytearray(pvt(second)[6:-2])
        struct.pack_into("<IHBBBBBB", payload, 0, 0, at.year, at.month, at.day, at.hour, at.minute, at.second, 0b111)
        off = off_deg if second in of else 0.0
        place = (round(1e7 * math.degrees(angle)) for angle in (STATION.lon_rad, STATION.lat_rad + math.radians(off)))
        struct.pack_into("<ii", payload, 24, *place)
        own += ubx(b"\x01\x07", bytes(payload))
    log.write_bytes((EXAMPLES / "receiver.ubx").read_bytes() + own)
    return navbound.analyze([log, EXAMPLES / "receiver-broadcast.rnx"], solve=True)


@pytest.mark.parametrize(("off_deg", "of", "shown"), [(0.01, range(180), True), (0.02, range(180), False), (0.5, range(1), True)])
def test_a_receiver_that_was_elsewhere_speaks_against_the_solved_positions(tmp_path: Path, off_deg: float, of: range, shown: bool) -> None:
    """0.01 degrees are 1.1 km, 0.02 degrees 2.2 km; the first position after a cold start may be anywhere."""
    verdict = with_own_positions(tmp_path / "log.ubx", 180, off_deg=off_deg, of=of).summary.verdict
    assert any("the receiver's own position is more than 1852 m" in words for words in verdict.position_doubts) != shown
    assert (verdict.id == "inside") == shown


@pytest.mark.parametrize(("n_more", "shown"), [(0, True), (1, True), (600, False)])
def test_a_log_that_goes_on_without_measurements_has_lost_those_epochs(tmp_path: Path, n_more: int, shown: bool) -> None:
    """The receiver says each second that it has a position, for some seconds longer than the three minutes that it measures."""
    run = with_own_positions(tmp_path / "log.ubx", 180 + n_more)
    verdict = run.summary.verdict
    assert (verdict.id == "inside") == shown
    assert any("the log holds no measurements" in words for words in run.summary.assumptions) != shown
    # One second beside a measurement is of its epoch; those between it and the first that is lost are a gap.
    assert verdict.n_epochs == 180 + (0 if shown else n_more)
