"""A receiver that leads a fused position off under levels that it states: found where the unit would have to be another than declared."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl
import pytest

from navbound import ins

DATA = Path(__file__).parents[1] / "examples" / "data"
BEGIN_S = 30.0
"""The positions are led off from here on."""
METRES = np.array([6.3706e6, 6.3879e6 * np.cos(np.radians(48.99)), 1.0])
"""Of a radian of latitude and of longitude at 49 degrees, and of a metre: WGS-84, to a thousandth."""


def table(name: str) -> pl.DataFrame:
    return pl.read_csv(DATA / f"{name}.csv")


def led(north_mps: float, up_mps: float, deviations: float) -> tuple[ins.Fused, np.ndarray]:
    """The shipped log of four minutes led off at constant speed, its covariance this many times in deviations; and the errors. [m]"""
    fixes, motion = table("fixes"), table("motion")
    full = [f"cov_{axes}_m2" for axes in ("ee", "en", "eu", "en", "nn", "nu", "eu", "nu", "uu")]
    covariance = np.stack([fixes[name].to_numpy() for name in full], 1).reshape(-1, 3, 3) * deviations**2
    time_ns = fixes["time_ns"].to_numpy()
    since_s = np.clip((time_ns - time_ns[0]) * 1e-9 - BEGIN_S, 0.0, None)
    position = fixes.select("lat_rad", "lon_rad", "h_m").to_numpy() + since_s[:, None] * np.array([north_mps, 0.0, up_mps]) / METRES
    measured = ins.Fixes(time_ns, position, covariance, hpl_m=25.0, vpl_m=40.0)
    fused = ins.fuse(ins.Imu.of_table(table("imu")), ins.Aiding(fixes=measured), ins.Start.of_table(motion))
    true = [np.interp(fused.time_ns, motion["time_ns"], motion[name]) for name in ("lat_rad", "lon_rad", "h_m")]
    return fused, np.abs(fused.position - np.column_stack(true)) * METRES


@pytest.mark.parametrize(
    ("deviations", "north_mps", "up_mps"),
    [(1.0, 0.0, 0.7), (1.0, 0.0, -1.0), (1.0, 0.6, 0.0), (1.0, -1.0, 1.0), (2.0, 0.0, 2.0), (2.0, 0.8, 0.0), (2.0, -1.0, 0.0)],
)
def test_what_needs_another_unit_is_not_ok_beyond_its_level_and_stays_so(deviations: float, north_mps: float, up_mps: float) -> None:
    fused, error = led(north_mps, up_mps, deviations)
    ok = np.array(fused.status) == "ok"
    horizontal = np.hypot(error[:, 0], error[:, 1])
    assert ok[: int(BEGIN_S)].mean() > 0.9
    assert not (ok & ~((horizontal <= fused.hpl_m) & (error[:, 2] <= fused.vpl_m))).any()
    # The offset stays when the bias has faded: nothing takes it back.
    assert max(horizontal[-1], error[-1, 2]) > 120.0
    assert not ok[-100:].any()


def test_it_is_named_and_has_no_level() -> None:
    fused, _ = led(0.0, 1.0, 1.0)
    named = np.array(["imu_bias" in reasons for reasons in fused.reasons])
    first = int(np.argmax(named))
    assert BEGIN_S < first < 60
    assert named[first:].all()
    assert np.isnan(fused.hpl_m[first:]).all()
    assert np.isnan(fused.vpl_m[first:]).all()
    # Without positions the filter goes on with a bias that it has learnt from them.
    assert set(np.array(fused.status)[first:]) == {"degraded", "not_available"}


def test_the_healthy_log_names_no_bias() -> None:
    for deviations in (1.0, 2.0):
        fused, _ = led(0.0, 0.0, deviations)
        # 181 positions, the outage and ten seconds of trust after it.
        assert fused.status.count("ok") == 171
        assert not any("imu_bias" in reasons for reasons in fused.reasons)
