"""The codes of all satellites are led off toward one place, their carrier phases are not: no position and no level of it is ok."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl
import pytest

import navbound
from led_off_station import NAVIGATION, OBSERVATIONS, led_off
from navbound import araim, gnss, raim

FROM, UNTIL, GAP = 20, 60, 80
"""Epochs: led off from, until; the file has a gap of 5.5 minutes, and the receiver flags each phase as lost, before the last. [1]"""
STEP_S = 30.0


def step(epoch: int, _letter: str) -> float:
    return 100.0 if FROM <= epoch < UNTIL else 0.0


def ramp(epoch: int, _letter: str) -> float:
    return 0.3 * STEP_S * max(0, epoch - FROM)


def solved(path: Path, signals: str = "single") -> pl.DataFrame:
    read = gnss.read_observations(path), gnss.read_navigation([NAVIGATION])
    return gnss.solve(*read, systems="GE", signals=signals).epochs  # type: ignore[arg-type]


@pytest.mark.parametrize("signals", ["single", "dual"])
def test_a_step_is_named_to_its_end_and_the_rest_stays_as_it_was(tmp_path: Path, signals: str) -> None:
    before, after = solved(OBSERVATIONS, signals), solved(led_off(tmp_path, step), signals)
    led = (after["reason_id"] == "codes_led_off").fill_null(value=False).to_numpy()
    assert led[FROM:UNTIL].all()
    assert not led[:FROM].any()
    assert not led[UNTIL:].any()
    assert (after["status"].to_numpy()[FROM:UNTIL] == "degraded").all()
    assert (before["status"].to_numpy()[:FROM] == after["status"].to_numpy()[:FROM]).all()
    # The covariance reaches the place without the lead: 95 % of a Gaussian of one axis are within two deviations.
    east = after["cov_ee_m2"].to_numpy()[FROM:UNTIL]
    assert (2.0 * np.sqrt(east) > 100.0).all()


def test_a_ramp_is_named_before_its_error_reaches_sixty_metres(tmp_path: Path) -> None:
    reasons = solved(led_off(tmp_path, ramp))["reason_id"]
    led = (reasons == "codes_led_off").fill_null(value=False).to_numpy()
    first = int(np.argmax(led))
    assert FROM < first <= FROM + 60.0 / (0.3 * STEP_S)
    assert led[first:GAP].all()
    # It stands until codes are compared again, and begins anew then, as at the begin of a file.
    assert led[GAP]
    again = GAP + 1 + int(np.argmax(led[GAP + 1 :]))
    assert GAP < again <= GAP + 60.0 / (0.3 * STEP_S)
    assert led[again:].all()


def test_a_station_that_is_carried_off_moves_its_phases_too(tmp_path: Path) -> None:
    reasons = solved(led_off(tmp_path, ramp, phase_share=1.0))["reason_id"]
    assert "codes_led_off" not in set(reasons)


def test_no_level_covers_it(tmp_path: Path) -> None:
    read = gnss.read_observations(led_off(tmp_path, step)), gnss.read_navigation([NAVIGATION])
    for epochs in (raim.watch(*read, systems="GE").epochs, araim.watch(*read, systems="GE").epochs):
        part = epochs[FROM:UNTIL]
        assert (part["reason_id"] == "codes_led_off").all()
        assert part["hpl_m"].null_count() == part.height
        assert epochs[:FROM]["hpl_m"].null_count() < FROM


def test_the_run_names_it(tmp_path: Path) -> None:
    epochs = navbound.analyze([led_off(tmp_path, step), NAVIGATION]).epochs
    led = epochs.filter(epochs["reason_id"] == "codes_led_off")
    assert led.height == UNTIL - FROM
    assert set(led["status"]) == {"degraded"}
