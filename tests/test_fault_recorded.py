"""The fault campaign on recordings: each kind changes what it names and nothing else, its rows are what its runs say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import ins_fixture as body
from navbound import ins
from navbound.errors import InputError
from navbound.studies.fault_campaign import recorded
from navbound.studies.fault_campaign.recorded import KINDS, Kind, Recording

SECOND = 1_000_000_000
SECONDS = 120
ONSET_S = 60.0
METRES = np.array([6.3625e6, 6.3875e6 * np.cos(body.PLACE[0]), 1.0])


@pytest.fixture(scope="module")
def still() -> Recording:
    """A unit at rest with a position of 1 m each second, whose truth is known to a point."""
    unit = body.standing(7, float(SECONDS))
    time_ns = np.arange(1, SECONDS) * SECOND
    draw = np.random.default_rng(7)
    position = np.array(body.PLACE) + draw.normal(size=(time_ns.size, 3)) / METRES
    fixes = ins.Fixes(time_ns, position, np.tile(np.eye(3), (time_ns.size, 1, 1)), hpl_m=10.0, vpl_m=30.0)
    return Recording(unit.imu, fixes, unit.start, ins.ImuModel(), time_ns, np.tile(body.PLACE, (time_ns.size, 1)))


def content(recording: Recording) -> dict[str, tuple[np.ndarray, ...]]:
    """What the filter is given, by family of fault; times are seconds since the start, and the first array of samples and positions."""
    unit, fixes = recording.imu, recording.fixes
    noises = recording.model.gyroscope, recording.model.accelerometer
    return {
        "inertial": (recording.since_s(unit.time_ns), np.asarray(unit.angle_rad), np.asarray(unit.velocity_mps)),
        "receiver": (recording.since_s(fixes.time_ns), np.asarray(fixes.position), np.asarray(fixes.covariance_enu_m2)),
        "tuning": tuple(np.array([noise.white, noise.bias]) for noise in noises),
    }


def same(first: tuple[np.ndarray, ...], second: tuple[np.ndarray, ...]) -> bool:
    return all(a.shape == b.shape and np.array_equal(a, b, equal_nan=True) for a, b in zip(first, second, strict=True))


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.id)
def test_a_kind_changes_its_own_family_after_its_onset(still: Recording, kind: Kind) -> None:
    before = content(still)
    # A limit of the range cuts more the lower it is.
    after = content(kind.change(still, kind.sizes[0 if kind.id == "imu-clip" else -1], ONSET_S))
    changed = {family for family in before if not same(before[family], after[family])}
    assert changed == ({"inertial", "receiver"} if kind.family == "pair" else {kind.family})
    for family in changed - {"tuning"}:
        head = int(np.searchsorted(before[family][0], ONSET_S))
        assert same(tuple(a[:head] for a in before[family]), tuple(a[:head] for a in after[family]))
    assert same(before["inertial"], content(still)["inertial"]), "the recording itself is changed"


def test_there_are_as_many_kinds_as_the_page_says() -> None:
    assert (len(KINDS), sum(kind.family == "pair" for kind in KINDS)) == (37, 2)
    assert all(len(kind.sizes) == 6 and list(kind.sizes) == sorted(kind.sizes) for kind in KINDS)


def test_counts_of_a_recording_that_declares_too_much(still: Recording) -> None:
    """The truth is moved 15 m to the east: every `ok` epoch with a level of 10 m is wrong, and an error of 5 m is inside."""
    healthy = recorded.counts(still, 0.0)
    assert healthy["n_ok"] == healthy["n_epochs"]
    assert float(healthy["n_ok"]) > 200
    assert healthy["n_ok_wrong"] == 0
    for east_m, share in ((15.0, 1.0), (5.0, 0.0)):
        truth = still.truth + np.array([0.0, east_m, 0.0]) / still.metres
        counts = recorded.counts(replace(still, truth=truth), 0.0)
        assert counts["n_ok"] == healthy["n_ok"]
        assert counts["n_ok_wrong"] == share * float(healthy["n_ok"])


def test_a_small_part_of_the_campaign(still: Recording) -> None:
    study = recorded.run([still], kinds=["fix-step", "imu-nan", "unit-declared-too-bad"], sizes=[0, 5], onsets=[2])
    assert [(row.kind, row.size, row.n_runs) for row in study.rows] == [
        ("fix-step", 3.0, 1),
        ("fix-step", 3000.0, 1),
        ("imu-nan", 0.1, 1),
        ("imu-nan", 1e4, 1),
        ("unit-declared-too-bad", 2.0, 1),
        ("unit-declared-too-bad", 300.0, 1),
    ]
    assert study.single.epochs == 0.0
    rows = {(row.kind, row.size): row for row in study.rows}
    assert rows["fix-step", 3000.0].detected == 1
    assert rows["fix-step", 3000.0].delay_median_s is not None
    assert rows["fix-step", 3000.0].delay_median_s <= 1.0


def test_an_unknown_kind_is_refused_by_name(still: Recording) -> None:
    with pytest.raises(InputError, match=r"fix-stepp.*fix-step"):
        recorded.run([still], kinds=["fix-stepp"])
