"""What comes to the filter twice, under another's name, late, or with numbers that no sensor has."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import ins_fixture as body
from navbound import ins

SECOND = 1_000_000_000
METRES = np.array([6.3625e6, 6.3875e6 * np.cos(body.PLACE[0]), 1.0])


def fixes(seed: int, time_ns: np.ndarray, sigma_m: float = 3.0) -> ins.Fixes:
    """Positions of the body that stands, with white errors."""
    error = sigma_m * np.random.default_rng(seed).normal(size=(time_ns.size, 3))
    return ins.Fixes(time_ns, np.array(body.PLACE) + error / METRES, np.tile(sigma_m**2 * np.eye(3), (time_ns.size, 1, 1)))


def copied(once: ins.Fixes, times: int, apart_ns: int = 0) -> ins.Fixes:
    """Each of them so many times, later copies with later tags."""
    time_ns = np.repeat(np.asarray(once.time_ns), times) + np.tile(np.arange(times) * apart_ns, np.asarray(once.time_ns).size)
    return ins.Fixes(time_ns, np.repeat(once.position, times, 0), np.repeat(once.covariance_enu_m2, times, 0))


@pytest.mark.parametrize("apart_ns", [0, 10_000_000])
def test_the_same_fix_twenty_times_is_one_measurement(apart_ns: int) -> None:
    still = body.standing(3, 120.0, 100)
    once = fixes(3, np.arange(1, 120) * SECOND)
    alone, many = (ins.fuse(still.imu, ins.Aiding(fixes=f), still.start) for f in (once, copied(once, 20, apart_ns)))
    assert many.refusals["repeated"] == 19 * 119
    assert alone.refusals["repeated"] == 0
    np.testing.assert_array_equal(many.position, alone.position)
    np.testing.assert_array_equal(many.covariance_enu_m2, alone.covariance_enu_m2)


def test_satellites_under_one_name_are_one_source() -> None:
    still = body.standing(4, 300.0)
    sky = body.satellites(4, still.time_ns[9::10], white_m=1.0, slow_m=5.0, tau_s=60.0)
    fused = ins.fuse(still.imu, ins.Aiding(satellites=replace(sky, satellite=["G01"] * len(sky.satellite))), still.start)
    # Nine an instant: the first is used.
    assert fused.refusals["same_name"] == 8 * len(sky.satellite) // 9
    error, p = body.error_enu(fused)[60:], fused.covariance_enu_m2[60:]
    worst = np.sqrt(np.einsum("ni,nij,nj->n", error, np.linalg.inv(p), error).max())
    # Three components that are right about themselves: 5.5 deviations at 1e-6.
    assert worst < 5.5


def spoiled(seed: int, what: str) -> tuple[ins.Aiding, ins.Aiding]:
    """Fixes and ranges of two minutes with one number of one row spoiled, and the same without that row."""
    still = body.standing(seed, 120.0)
    second = still.time_ns[9::10]
    if what.startswith("fix"):
        once = fixes(seed, second)
        bad = np.array(once.covariance_enu_m2)
        bad[40] = {"fix-tiny": 1e-30 * np.eye(3), "fix-huge": 1e300 * np.eye(3), "fix-flat": np.diag([1.0, 1e-14, 1.0])}[what]
        rest = np.arange(second.size) != 40
        without = ins.Fixes(second[rest], np.asarray(once.position)[rest], np.asarray(once.covariance_enu_m2)[rest])
        return ins.Aiding(fixes=replace(once, covariance_enu_m2=bad)), ins.Aiding(fixes=without)
    sky = body.satellites(seed, second, white_m=1.0, slow_m=0.0, tau_s=60.0)
    n = len(sky.satellite)
    number, value = {
        "range-huge": ("sigma_white_m", 1e300),
        "range-tiny": ("sigma_white_m", 1e-300),
        "range-nan": ("sigma_white_m", np.nan),
        "range-far": ("range_m", 1e30),
    }[what]
    column = np.broadcast_to(np.asarray(getattr(sky, number), dtype=float), (n,)).copy()
    column[361] = value
    rest = np.arange(n) != 361
    changed: dict[str, Any] = {number: column}
    return ins.Aiding(satellites=replace(sky, **changed)), ins.Aiding(satellites=body.some(sky, rest))


@pytest.mark.parametrize("what", ["fix-tiny", "fix-huge", "fix-flat", "range-huge", "range-tiny", "range-nan", "range-far"])
def test_a_number_out_of_range_is_refused_alone(what: str) -> None:
    still = body.standing(5, 120.0)
    bad, without = (ins.fuse(still.imu, aiding, still.start) for aiding in spoiled(5, what))
    assert bad.stopped is None
    assert bad.refusals["out_of_range"] == 1
    np.testing.assert_array_equal(bad.position, without.position)
    np.testing.assert_array_equal(bad.covariance_enu_m2, without.covariance_enu_m2)
    assert np.isfinite(bad.position).all()
