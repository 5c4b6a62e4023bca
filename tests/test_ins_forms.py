"""The tight, the loose and the federated form, and the filter without satellites beside them, on simulated flights."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ins_fixture import true_start
from navbound import anp, ins
from navbound.errors import InputError
from navbound.scenario import Scenario, load

FIGURES = {"tight": (2.47, 2.14, 5.24), "loose": (2.48, 2.15, 5.36), "federated": (2.70, 2.62, 5.53)}
"""Claimed deviations east, north, up of fifty flights (docs/methods/ins.md) \\[m\\]: covariances hardly depend on what was drawn."""


def across(position: Any, reference: Any) -> Any:
    """Horizontal distance; a mean radius is off by a third of a hundredth of it. [m]"""
    north = (position[:, 0] - reference[:, 0]) * (6.371e6 + reference[:, 2])
    east = (position[:, 1] - reference[:, 1]) * (6.371e6 + reference[:, 2]) * np.cos(reference[:, 0])
    return np.hypot(east, north)


@pytest.fixture(scope="module")
def real() -> Scenario:
    """Two hours with correlated range errors, the unit at 10 Hz to be quick."""
    scenario = load("beijing-shanghai-real")
    assert scenario.sensors is not None
    return scenario.model_copy(update={"sensors": scenario.sensors.model_copy(update={"rate_hz": 10})})


@pytest.mark.parametrize("form", FIGURES)
def test_every_form_is_what_it_says(real: Scenario, form: Any) -> None:
    table = ins.consistency(real, 2, first=4, settings=ins.FilterSettings(form=form, reversion=True))
    assert table["n_stopped"].sum() == 0
    claimed = [table[f"sigma_{axis}_m"].mean() for axis in "enu"]
    # A station that is left out for a while makes up to two per cent.
    assert claimed == pytest.approx(FIGURES[form], rel=0.03)
    # Two flights are worth some eight samples of three degrees: deviation sqrt(2 / 24) = 0.29 of the mean; three of them, not below zero.
    assert 0.2 * 3 < table["nees"].mean() < 1.9 * 3  # type: ignore[operator]
    # The filter without satellites; twice as many degrees of freedom would be far beyond what fifty flights show (1.1 to 2.6).
    assert table["separation_mean_square"].max() < 4.0  # type: ignore[operator]
    assert table["n_disagreements"].sum() == 0
    assert table["n_compared"].min() == table["n_epochs"][0]
    assert 0.3 * 3 < table["reversion_nees"].mean() < 1.7 * 3  # type: ignore[operator]
    assert table["reversion_p_gnss"].max() == 0.0


def test_solved_positions_taken_for_new_each_time_fail(real: Scenario) -> None:
    table = ins.consistency(real, 1, settings=ins.FilterSettings(form="loose", errors="white"))
    # 4 m of errors that stay against decimetres, as in the tight form.
    assert table["p_sphere"][0] < 0.2
    assert table["nees"][0] > 30
    assert "reversion_nees" not in table.columns


def test_a_form_and_a_risk_that_are_none_are_refused(real: Scenario) -> None:
    with pytest.raises(InputError, match="form"):
        ins.consistency(real, 1, settings=ins.FilterSettings(form="ultra-tight"))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="separation_risk"):
        ins.consistency(real, 1, settings=ins.FilterSettings(separation_risk=0.0))


@pytest.fixture(scope="module")
def jammed() -> tuple[ins.Sensed, ins.Fused]:
    """Twenty minutes without satellites from 2400 s on: sensors, and the filter with the one without satellites beside it."""
    scenario = load("beijing-shanghai-jammed")
    assert scenario.sensors is not None
    quick = scenario.model_copy(update={"sensors": scenario.sensors.model_copy(update={"rate_hz": 10})})
    sensed = ins.simulate(quick)
    aiding = ins.Aiding.of_tables(satellites=sensed.satellites, dme=sensed.dme, vor=sensed.vor, baro=sensed.baro)
    start = true_start(sensed)
    return sensed, ins.fuse(ins.Imu.of_table(sensed.imu), aiding, start, settings=ins.FilterSettings(reversion=True))


def test_without_satellites_the_main_filter_is_that_of_the_mode_and_remembers_more(jammed: tuple[ins.Sensed, ins.Fused]) -> None:
    sensed, fused = jammed
    beside = fused.reversion
    assert beside is not None
    assert set(beside.mode) <= {"dme_dme", "vor_dme", "coasting"}
    lost = slice(2420, 3600)
    assert set(fused.mode[lost]) == {"dme_dme"}
    # It has had everything the other has, and satellites before: along no axis is it worse. A thousandth for rounding and linearisation.
    for ours, other in zip(fused.covariance_enu_m2[lost], beside.covariance_enu_m2[lost], strict=True):
        assert np.linalg.eigvalsh(other[:2, :2] - ours[:2, :2])[0] > -1e-3 * np.trace(other[:2, :2])
    truth = sensed.truth.select("truth_lat_rad", "truth_lon_rad", "truth_h_m").to_numpy()[1:]
    assert np.all(sensed.truth["time_ns"].to_numpy()[1:] == fused.time_ns)
    for position, covariance in ((fused.position, fused.covariance_enu_m2), (beside.position, beside.covariance_enu_m2)):
        # Of this stretch of few independent errors none may be beyond the circle of 1e-5.
        assert np.all(across(position[lost], truth[lost]) < anp.circle(covariance[lost, :2, :2], 1e-5))
    assert np.nanmax(beside.separation_m / beside.separation_limit_m) < 1.0


def test_the_separation_is_the_distance_of_both_positions(jammed: tuple[ins.Sensed, ins.Fused]) -> None:
    _, fused = jammed
    beside = fused.reversion
    assert beside is not None
    known = np.isfinite(beside.separation_m)
    assert beside.separation_m[known] == pytest.approx(across(fused.position, beside.position)[known], rel=0.004)
    # All but where the main filter, long without satellites, hardly knows more than the other.
    assert known[200:].mean() > 0.9
