"""The example of an SBAS service: what a writer of its own sent is what the reader reads, and the levels that follow hold."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import navbound
from navbound import InputError, sbas, write
from navbound.examples.files import PLACE_ECEF_M, SERVICE
from navbound.examples.service import PRN

DATA = Path(__file__).parents[1] / "examples" / "data"
LOG = DATA / "service.ems"


def fields(**changed: object) -> write.Sent:
    return write.Sent(**({"begin_s": 3, "kind": 63, "fields": []} | changed))  # type: ignore[arg-type]


def test_an_empty_message_has_the_preamble_of_its_time_and_the_parity_of_the_standard(tmp_path: Path) -> None:
    # Blocks that a satellite sent: shared log of PRN 137, 2025-02-15 17:00:03 and 17:00:04, messages 63 tagged with their end.
    begin_s = (2353 * 7 + 6) * 86_400 + 17 * 3600 + 2
    write.ems([fields(begin_s=begin_s), fields(begin_s=begin_s + 1)], 137, tmp_path / "a.ems")
    assert (tmp_path / "a.ems").read_text() == (
        "137 25 02 15 17 00 03 63 C6FC0000000000000000000000000000000000000000000000000000085C16C0\n"
        "137 25 02 15 17 00 04 63 53FC0000000000000000000000000000000000000000000000000000018036C0\n"
    )


# The first second of 2080, GPS time: its year has no two digits that a reader takes for it.
AFTER_S = int((datetime(2080, 1, 1, tzinfo=UTC) - datetime(1980, 1, 6, tzinfo=UTC)).total_seconds())


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"fields": [(4, 2)]}, "fields[0]"),
        ({"fields": [(-3, 2)]}, "fields[0]"),
        ({"fields": [(0, 213)]}, "bits of fields[0]"),
        ({"fields": [(0, 200), (0, 13)]}, "fields"),
        ({"fields": [(0, 1), (0, 0)]}, "bits of fields[1]"),
        ({"fields": [(0, -1)]}, "bits of fields[0]"),
        ({"fields": [(0, 10**10)]}, "bits of fields[0]"),
        ({"fields": [(0, 2.0)]}, "bits of fields[0]"),
        ({"fields": [(1.0, 2)]}, "fields[0]"),
        ({"fields": [("1", 2)]}, "fields[0]"),
        ({"fields": [(True, 2)]}, "fields[0]"),
        ({"fields": [(np.float64(1.0), 2)]}, "fields[0]"),
        ({"fields": [(1,)]}, "fields"),
        ({"fields": [1, 2]}, "fields"),
        ({"fields": "12"}, "fields"),
        ({"kind": 64}, "kind"),
        ({"kind": -1}, "kind"),
        ({"kind": 6.0}, "kind"),
        ({"kind": True}, "kind"),
        ({"begin_s": -1}, "begin_s"),
        ({"begin_s": 3.0}, "begin_s"),
        ({"begin_s": 2**70}, "begin_s"),
        ({"begin_s": AFTER_S - 1}, "begin_s"),
    ],
    ids=str,
)
def test_a_message_that_is_none_is_refused_by_its_part(tmp_path: Path, wrong: dict[str, object], named: str) -> None:
    with pytest.raises(InputError) as refusal:
        write.ems([fields(**wrong)], PRN, tmp_path / "a.ems")
    assert refusal.value.argument == named
    assert not (tmp_path / "a.ems").exists()


@pytest.mark.parametrize("prn", [119, 159, 120.0, "120", True, None])
def test_a_satellite_that_is_none_is_refused(tmp_path: Path, prn: object) -> None:
    with pytest.raises(InputError) as refusal:
        write.ems([fields()], prn, tmp_path / "a.ems")  # type: ignore[arg-type]
    assert refusal.value.argument == "prn"


@pytest.mark.parametrize(
    "messages", [[], fields(), [fields(), fields()], [fields(begin_s=4), fields()], [fields(), None], "messages"], ids=lambda _: ""
)
def test_messages_that_make_no_log_are_refused(tmp_path: Path, messages: Any) -> None:
    with pytest.raises(InputError) as refusal:
        write.ems(messages, PRN, tmp_path / "a.ems")
    assert refusal.value.argument == "messages"
    assert not (tmp_path / "a.ems").exists()


def test_whole_numbers_of_numpy_and_items_one_by_one_are_what_they_are(tmp_path: Path) -> None:
    plain = write.ems([fields(fields=[(5, 4), (-1, 3)])], PRN, tmp_path / "a.ems")
    of_numpy = fields(begin_s=np.int64(3), kind=np.uint8(63), fields=((np.int16(5), np.uint8(4)), (np.int8(-1), 3)))
    other = write.ems(iter([of_numpy]), np.int32(PRN), tmp_path / "b.ems")  # type: ignore[arg-type]
    assert plain.read_bytes() == other.read_bytes()


def test_the_last_second_that_two_digits_name_is_read_back(tmp_path: Path) -> None:
    messages = sbas.read(write.ems([fields(begin_s=AFTER_S - 2)], PRN, tmp_path / "a.ems"))
    assert [m.time_ns for m in sbas.decode(messages)] == [(AFTER_S - 1) * 1_000_000_000]


@pytest.fixture(scope="module")
def decoded() -> list[sbas.Decoded]:
    messages = sbas.read(LOG)
    assert not messages.refused
    assert messages.late_s == {PRN: 0}
    return sbas.decode(messages)


def after_s(message: sbas.Decoded) -> int:
    """Seconds from the first message; times are those of the end."""
    return message.time_ns // 1_000_000_000 - 1 - SERVICE.begin_s


def test_every_second_has_a_message_but_for_the_gap(decoded: list[sbas.Decoded]) -> None:
    silent = set(range(*SERVICE.silent[0]))
    assert [after_s(m) for m in decoded] == [k for k in range(3600) if k not in silent]


def test_the_points_of_the_grid_are_those_of_the_table(decoded: list[sbas.Decoded]) -> None:
    # Band 3 begins at 60 W: columns of 27 and 23 points in turn, and one at 85 S at 50 W. 40 W is the fifth: it begins with number 102, at
    # 75 S, so that 55 S is 104 and 20 N is 119.
    masks = {m.fields["band"]: m.fields["point"] for m in decoded if m.type == 18}
    assert masks[3][:8] == list(range(119, 127))
    # Band 9 begins with 60 N from 180 W every 5 degrees: 40 W is the 29th, 45 E the 46th; then 65 N every 10 degrees from the 73rd on.
    assert masks[9] == [*range(29, 47), *range(87, 96)]
    assert {band: len(points) for band, points in masks.items()} == {3: 4 * 8, 4: 8 * 8, 5: 6 * 8, 9: 27}


def test_a_satellite_that_must_not_be_used_is_alerted_at_once(decoded: list[sbas.Decoded]) -> None:
    # G24 is the eleventh of the second thirteen, which messages 3 correct.
    sent = [(after_s(m), m.fields["iodf"], m.fields["udrei"][10]) for m in decoded if m.type == 3]
    assert [(iodf, udrei) for k, iodf, udrei in sent if 1500 <= k < 1504] == [(3, 15)] * 4
    assert {udrei for k, _, udrei in sent if 1504 <= k < 1800} == {15}
    assert 15 not in {udrei for k, _, udrei in sent if not 1500 <= k < 1800}


def test_the_levels_hold_and_the_alert_and_the_gap_are_seen() -> None:
    files = [DATA / "station.rnx", DATA / "broadcast.rnx", LOG]
    epochs = navbound.evaluate(files, levels="APV-I", truth=",".join(map(str, PLACE_ECEF_M))).epochs
    k = (epochs["time_ns"].to_numpy() // 1_000_000_000 - SERVICE.begin_s).astype(int)
    has_level = epochs["vpl_m"].is_not_null().to_numpy()
    # Masks and corrections are whole after less than three minutes; the station receives nothing from 2400 s to 2700 s.
    judged = (k >= 180) & (k < 3600)
    assert set(k[judged & ~has_level]) == {3000, 3030}
    assert not has_level[k > 3630].any()
    n_sv = dict(zip(k.tolist(), epochs["n_sv"].to_list(), strict=True))
    assert [n_sv[s] - n_sv[1470] for s in (1500, 1530, 1770)] == [0, -1, -1]
    for error, level in (("hpe_m", "hpl_m"), ("vpe_m", "vpl_m")):
        shares = epochs[error].to_numpy()[has_level] / epochs[level].to_numpy()[has_level]
        assert np.abs(shares).max() < 1.0


def test_messages_that_an_analysis_does_not_use_are_named() -> None:
    run = navbound.analyze([DATA / "station.rnx", DATA / "broadcast.rnx", DATA / "service.ems"])
    words = "service.ems: messages of an augmentation service are not used here; navbound evaluate corrects positions with them."
    assert run.summary.assumptions.count(words) == 1
