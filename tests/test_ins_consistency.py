"""Simulated flights through the filter, judged against their truth."""

from __future__ import annotations

import pytest

from navbound import ins
from navbound.errors import InputError
from navbound.scenario import Scenario, load


@pytest.fixture(scope="module")
def real() -> Scenario:
    """Two hours with correlated range errors, the unit at 50 Hz to be quick."""
    scenario = load("beijing-shanghai-real")
    assert scenario.sensors is not None
    return scenario.model_copy(update={"sensors": scenario.sensors.model_copy(update={"rate_hz": 50})})


def test_flights_with_errors_that_stay_are_what_the_filter_says(real: Scenario) -> None:
    table = ins.consistency(real, 3)
    assert table["n_epochs"].to_list() == [table["n_epochs"][0]] * 3
    assert table["n_stopped"].sum() == 0
    # Errors stay for half an hour, so a flight is worth some four samples of each axis: NEES of 12 samples of three degrees has a
    # deviation of sqrt(2 / 36) = 0.24 of its mean; three of them either way.
    assert 0.3 * 3 < table["nees"].mean() < 1.7 * 3  # type: ignore[operator]
    # Some 450000 innovations: their mean square and their memory are known to 1 %.
    assert table["range_mean_square"].to_list() == pytest.approx([1.0] * 3, abs=0.02)
    assert table["range_lag_one"].to_list() == pytest.approx([0.0] * 3, abs=0.02)
    # A flight is the same in any company.
    assert ins.consistency(real, 1, first=2).row(0) == table.row(2)


def test_flights_whose_slow_errors_are_taken_for_white_fail(real: Scenario) -> None:
    table = ins.consistency(real, 2, settings=ins.FilterSettings(errors="white"))
    # 10 m that stay against a sigma of decimetres; the specification's own prototype holds 0.4 %.
    assert table["p_sphere"].to_list() == pytest.approx([0.0, 0.0], abs=0.1)
    assert min(table["nees"]) > 30
    assert max(table["range_mean_square"]) < 1.0
    assert min(table["range_lag_one"]) > 0.5


def test_numbers_of_flights_that_are_none_are_refused(real: Scenario) -> None:
    with pytest.raises(InputError, match="flights"):
        ins.consistency(real, 0)
    with pytest.raises(InputError, match="sensors"):
        ins.consistency("beijing-shanghai-drawn", 1)
