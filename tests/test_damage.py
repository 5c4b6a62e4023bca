"""A small slice of `damage.py`: the judge finds what is wrong, and nothing is wrong in some hundred files."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from conftest import SHARED
from damage import FAILURES, Bench, Damage, run
from damage_kinds import KINDS, Kind, tracks

N = 200
CSV = b"timestamp,latitude,longitude\n" + b"".join(b"%d,%.4f,10.0\n" % (1_700_000_000 + k, 50 + k / 2000) for k in range(40))


def test_no_file_of_a_slice_is_wrong_in_silence(tmp_path: Path) -> None:
    if not (SHARED / "data").is_dir():
        pytest.skip(f"SKIPPED ALOUD: no real data at {SHARED / 'data'}")
    quick = [name for name, kind in KINDS.items() if kind.weight == 1.0]
    result = list(run(N, 2026, tmp_path, quick))
    verdicts = Counter(verdict for _, verdict, _, _ in result)
    assert not [(name, verdict, words) for name, verdict, words, _ in result if verdict in FAILURES]
    # Not one answer to everything.
    assert min(verdicts["refused"], verdicts["counted"], verdicts["same"]) > 5


def bench(tmp_path: Path, *, shift: float = 0.0) -> Bench:
    """A reader that moves another row where a line holds a word; with no shift the sound one."""

    def result(path: Path) -> object:
        cells, stated = tracks(path)
        if shift and b"51" in path.read_bytes():
            first = next(key for key in cells if key[1] == "est_lat_rad")
            cells[first] = float(cells[first]) + shift  # type: ignore[arg-type]
        return cells, stated

    return Bench(Kind(lambda: CSV, "a.csv", result), tmp_path)  # type: ignore[arg-type]


def replaced(old: bytes, new: bytes) -> Damage:
    at = CSV.index(old)
    return Damage("digit", CSV.replace(old, new, 1), at, at + len(old))


@pytest.mark.parametrize(("shift", "verdict"), [(0.0, "data"), (1e-6, "WRONG")])
def test_a_number_that_changes_elsewhere_is_wrong(tmp_path: Path, shift: float, verdict: str) -> None:
    assert bench(tmp_path, shift=shift).verdict(replaced(b",50.0100,", b",51.0100,"))[0] == verdict


def test_a_value_that_is_no_number_is_counted(tmp_path: Path) -> None:
    assert bench(tmp_path).verdict(replaced(b",50.0100,", b",5x.0100,"))[0] == "counted"


def test_a_row_that_is_lost_elsewhere_is_silent(tmp_path: Path) -> None:
    def result(path: Path) -> object:
        cells, stated = tracks(path)
        lost = next(iter(cells))[0] if b"51" in path.read_bytes() else None
        return {k: v for k, v in cells.items() if k[0] != lost}, stated

    judged = Bench(Kind(lambda: CSV, "a.csv", result), tmp_path)  # type: ignore[arg-type]
    assert judged.verdict(replaced(b",50.0100,", b",51.0100,"))[0] == "SILENT"


def test_an_exchange_that_the_sums_of_a_frame_cannot_see_is_data(tmp_path: Path) -> None:
    """Fletcher: an exchange of 32 bytes changes the second sum by 32 times the difference of theirs, here by 256; by 32 in the other."""

    def result(path: Path) -> object:
        return {("frame", "bytes"): path.read_bytes()}, ()

    for last, verdict in ((8, "data"), (1, "WRONG")):
        body = b"\x02\x15" + (64).to_bytes(2, "little") + bytes(32) + bytes([*bytes(31), last])
        first = second = 0
        for byte in body:
            first, second = (first + byte) % 256, (second + first + byte) % 256
        frame = b"\xb5b" + body + bytes([first, second])
        bench = Bench(Kind(lambda frame=frame: frame, "r.ubx", result, "record", binary=True), tmp_path)  # type: ignore[misc, arg-type]
        swapped = frame[:6] + frame[38:70] + frame[6:38] + frame[70:]
        assert bench.verdict(Damage("swapped", swapped, 6, 70))[0] == verdict
