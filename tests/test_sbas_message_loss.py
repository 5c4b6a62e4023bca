"""Four seconds without a message, and what the preambles say of a log's times; recorded messages with some taken out."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from conftest import SHARED
from navbound import _core, sbas

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

WEEK_NS = 2353 * 604_800 * 1_000_000_000
NS = 1_000_000_000
USER: dict[str, Any] = {"lat_rad": 0.6169, "lon_rad": 2.4352, "h_m": 100.0}
"""Near Tokyo, in the middle of the service."""
REFERENCE = SHARED / "reference" / "ref-dfmc.json"


@pytest.fixture(scope="module")
def folder(shared_data: Path) -> Path:
    return shared_data / "sbas"


@pytest.fixture(scope="module")
def log(folder: Path) -> sbas.Messages:
    return sbas.read(folder / "more" / "prn137_2025046_17h.ems.gz")


def without(messages: sbas.Messages, first_tow: int, last_tow: int) -> sbas.Messages:
    """The messages that do not end in the stated seconds."""
    tow = (messages.time_ns - WEEK_NS) // NS
    kept = (tow < first_tow) | (tow > last_tow)
    return replace(messages, time_ns=messages.time_ns[kept], prn=messages.prn[kept], data=messages.data[kept])


def seconds(first: int, last: int) -> NDArray[np.int64]:
    return WEEK_NS + np.arange(first, last + 1, dtype=np.int64) * NS


def cases() -> list[dict[str, Any]]:
    if not REFERENCE.is_file():
        pytest.skip(f"SKIPPED ALOUD: no reference series at {REFERENCE}")
    return list(json.loads(REFERENCE.read_text(encoding="utf-8"))["l1_loss"])


@pytest.mark.parametrize("which", [0, 1, 2])
def test_the_indicators_in_force_are_those_of_the_reference_series(log: sbas.Messages, which: int) -> None:
    """Columns of the series: messages 2 to 4 in approach and en route, 1 where an indicator of that message is in force."""
    case = cases()[which]
    lost = without(log, *case["missing_messages_end_tow"])
    rows = np.array(case["rows"])
    result = _core.sbas_indicators(lost.time_ns, lost.data, WEEK_NS + rows[:, 0] * NS)
    mask = next(d.fields["prn"] for d in sbas.decode(log) if d.type == 1)
    for k, use in enumerate(result):
        for message in range(3):
            # Thirteen satellites of the mask a message.
            own = mask[13 * message : 13 * message + 13]
            in_force = [int(any(prn in at for prn in own)) for at in use]
            assert in_force == rows[:, 1 + 2 * message + k].tolist(), (k, 2 + message)


def test_the_level_is_gone_for_the_silence_and_its_reason_is_reported(log: sbas.Messages, folder: Path) -> None:
    navigation = folder / "gps_2025046_17h_rinex3.nav"
    instants = seconds(581_000, 581_030)
    mode = {n: sbas.protection_levels(without(log, 581_003, 581_002 + n), navigation, instants, **USER, mode="pa") for n in (0, 3, 4)}
    assert (mode[0].mode == "pa").all()
    assert (mode[3].mode == "pa").all()
    # The last message heard ended at 581002: at 581007 nobody has an indicator, whatever came at 581006.
    out = np.flatnonzero(mode[4].mode != "pa")
    assert out[0] == 7
    assert (np.diff(out) == 1).all()
    ids = {mode[4].reason_ids[mode[4].reason[k] - 1] for k in out}
    assert ids == {"message_loss"}
    assert (mode[4].status[out] == "not_available").all()
    # En route silence takes nothing.
    assert (sbas.protection_levels(without(log, 581_003, 581_006), navigation, instants, **USER, mode="npa").mode == "npa").all()


def test_the_damaged_hour_loses_15_levels_by_the_rule_and_33_where_every_fast_correction_is_erased(folder: Path) -> None:
    """Both counts are against ages alone: the same log with an empty message in each second that is lost."""
    navigation = folder / "gps_2025046_17h_rinex3.nav"
    whole = sbas.read(folder / "more" / "prn137_2025046_17h.ems.gz")
    damaged = sbas.read(folder / "more" / "prn137_loss_2025046_17h.ems.gz")
    tow = (damaged.time_ns - WEEK_NS) // NS
    types = np.array([message.type for message in sbas.decode(damaged)])
    lost = np.setdiff1d((whole.time_ns - WEEK_NS) // NS, tow)
    runs = [(int(run[0]), int(run[-1])) for run in np.split(lost, np.flatnonzero(np.diff(lost) > 1) + 1) if run.size >= 4]
    assert [last - first + 1 for first, last in runs] == [4, 5, 10, 4, 20]

    # An empty message (type 63) has one of three preambles: the one of its second.
    empty: dict[int, int] = {}
    for k in np.flatnonzero(types == 63):
        empty.setdefault(int(tow[k]) % 3, int(k))
    source = np.array([empty[int(t) % 3] for t in lost])
    time_ns = np.concatenate([damaged.time_ns, WEEK_NS + lost * NS])
    order = np.argsort(time_ns, kind="stable")
    heard = replace(
        damaged,
        time_ns=time_ns[order],
        prn=np.concatenate([damaged.prn, damaged.prn[source]])[order],
        data=np.concatenate([damaged.data, damaged.data[source]])[order],
    )

    by_rule, by_erasure = [], []
    for first, last in runs:
        instants = seconds(first + 4, last + 60)
        by_age = sbas.protection_levels(heard, navigation, instants, **USER, mode="pa").mode == "pa"
        rule = sbas.protection_levels(damaged, navigation, instants, **USER, mode="pa").mode == "pa"
        # The reading that the specification declines: with the silence every fast correction goes, so that each satellite waits for two.
        kept = ~(np.isin(types, [2, 3, 4, 5, 6, 24]) & (tow < first))
        erased = replace(damaged, time_ns=damaged.time_ns[kept], prn=damaged.prn[kept], data=damaged.data[kept])
        erasure = sbas.protection_levels(erased, navigation, instants, **USER, mode="pa").mode == "pa"
        by_rule.append(int((by_age & ~rule).sum()))
        by_erasure.append(int((by_age & ~erasure).sum()))
    assert by_rule == [3, 3, 3, 3, 3]
    assert by_erasure == [9, 9, 3, 9, 3]


def test_preambles_say_which_second_a_log_means(folder: Path) -> None:
    late = sbas.read(folder / "msas137_2025046_17h.ems")
    assert late.late_s == {137: 1}
    assert "ended one second before" in late.tag_words()[0]
    for name in ("more/prn137_2025046_17h.ems.gz", "more/egnos_2012299.ems", "046r_sbas.txt.gz"):
        right = sbas.read(folder / name)
        assert right.late_s
        assert set(right.late_s.values()) == {0}, name
        assert right.tag_words() == []
    # The same log declared as tagged at the start ends a second later than it is.
    stated = sbas.read(folder / "more" / "prn137_2025046_17h.ems.gz", tag="start")
    assert stated.late_s == {137: 1}
    assert stated.of(137).late_s == {137: 1}
