"""One of two constellations is consistent with a false place: nothing says which of both is right, and no position is ok."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import navbound
from led_off_station import NAVIGATION, OBSERVATIONS
from led_off_station import led_off as station_led_off
from navbound import gnss

SECOND_NS = 1_000_000_000


def led_off(folder: Path, letter: str, way_m: float, *, from_epoch: int = 0, until_epoch: int = 10**9) -> Path:
    """The station with every range of a constellation as it would be so far east."""
    return station_led_off(folder, lambda epoch, of: way_m if of == letter and from_epoch <= epoch < until_epoch else 0.0)


@pytest.mark.parametrize("letter", ["G", "E"])
@pytest.mark.parametrize("east_m", [300.0, 5000.0])
@pytest.mark.parametrize("signals", ["single", "dual"])
def test_no_position_is_ok_while_one_of_two_constellations_is_led_off(tmp_path: Path, letter: str, east_m: float, signals: str) -> None:
    observations = gnss.read_observations(led_off(tmp_path, letter, east_m))
    solved = gnss.solve(observations, gnss.read_navigation([NAVIGATION]), systems="GE", signals=signals)  # type: ignore[arg-type]
    assert solved.epochs.filter(solved.epochs["status"] == "ok").height == 0
    assert "constellations_contradict" in set(solved.epochs["reason_id"])


def test_the_verdict_names_both(tmp_path: Path) -> None:
    verdict = navbound.analyze([led_off(tmp_path, "E", 5000.0), NAVIGATION]).summary.verdict
    assert verdict.id == "nothing_judged"
    assert verdict.n_judged == 0
    assert any("Galileo and GPS contradict each other" in each for each in verdict.position_doubts)


def test_constellations_that_agree_again_settle_it(tmp_path: Path) -> None:
    """Led off for ten minutes: 20 epochs of 30 s."""
    observations = gnss.read_observations(led_off(tmp_path, "G", 1000.0, from_epoch=60, until_epoch=80))
    healthy = gnss.solve(gnss.read_observations(OBSERVATIONS), gnss.read_navigation([NAVIGATION]), systems="GE")
    solved = gnss.solve(observations, gnss.read_navigation([NAVIGATION]), systems="GE")
    ok, before = ((each.epochs["status"] == "ok").to_numpy() for each in (solved, healthy))
    assert not ok[60:80].any()
    assert ok[:60].sum() == before[:60].sum()
    # Exclusions of the last minute count for a minute more.
    assert np.array_equal(ok[83:], before[83:])
