"""What a wrong sensor makes of a fused position: found in time, and never called `ok` beyond its level."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import numpy as np
import polars as pl
import pytest

from navbound import scenario
from navbound.run import fly
from navbound.scenario import Scenario

RATE_HZ = 10
"""The path is smooth: ten samples a second lose millimetres and save nineteen parts of twenty of the time."""
START_S = 2700
STEP = {"kind": "imu-bias-jump", "start_s": START_S, "gyro_radps": [0.0, 0.0, 0.0], "accelerometer_mps2": [2.0, 0.0, 0.0]}
NO_SATELLITES = {"kind": "interference", "start_s": 2000.0, "duration_s": 8000.0}


def flown(
    faults: list[dict[str, Any]], name: str = "beijing-shanghai", flights: int = 1, systems: tuple[str, ...] = ("gps", "galileo")
) -> Any:
    return _flown(json.dumps(faults), name, flights, systems)


@cache
def _flown(faults: str, name: str, flights: int, systems: tuple[str, ...]) -> Any:
    """Several tests look at one flight."""
    data = scenario.load(name).model_dump()
    data["sensors"]["rate_hz"] = RATE_HZ
    data["sensors"]["gnss"]["constellations"] = list(systems)
    data["sensors"]["faults"] = json.loads(faults)
    return fly.material(Scenario.model_validate(data), flights=flights)


def with_errors(epochs: pl.DataFrame) -> pl.DataFrame:
    return epochs.with_columns(
        second=(pl.col("time_ns") - pl.col("time_ns").min()) / 1e9,
        error_m=(pl.col("nse_e_m") ** 2 + pl.col("nse_n_m") ** 2).sqrt(),
    )


def beyond(epochs: pl.DataFrame) -> int:
    """Epochs called ``ok`` whose error is beyond their level, or that have none."""
    inside = (pl.col("error_m") <= pl.col("hpl_m")) & (pl.col("nse_u_m").abs() <= pl.col("vpl_m"))
    return epochs.filter(pl.col("status") == "ok", ~inside.fill_null(value=False)).height


def unit(what: str, duration_s: float) -> list[dict[str, Any]]:
    return [{"kind": "imu-trouble", "start_s": START_S, "duration_s": duration_s, "what": what}]


def pulse(duration_s: float) -> list[dict[str, Any]]:
    return [STEP | {"kind": "imu-pulse", "duration_s": duration_s, "accelerometer_mps2": [49.0, 0.0, 0.0]}]


def clock(offset_s: float) -> list[dict[str, Any]]:
    return [{"kind": "imu-clock", "start_s": START_S, "duration_s": 9000.0, "offset_s": offset_s, "drift": 0.0}]


CLIP = [{"kind": "imu-clip", "start_s": START_S, "duration_s": 9000.0, "gyro_radps": 10.0, "accelerometer_mps2": 9.80665}]


@pytest.mark.parametrize(
    "faults",
    [
        pytest.param([STEP], id="accelerometer step"),
        pytest.param([NO_SATELLITES, STEP], id="accelerometer step without satellites"),
        pytest.param(pulse(0.1), id="5 g for 0.1 s"),
        pytest.param(pulse(1.0), id="5 g for 1 s"),
        pytest.param(pulse(10.0), id="5 g for 10 s"),
        pytest.param(unit("frozen-gyroscopes", 9000.0), id="gyroscopes frozen"),
        pytest.param(CLIP, id="clipped at 1 g"),
        pytest.param(clock(-0.5), id="clock half a second back"),
        pytest.param(clock(-120.0), id="samples 120 s late"),
        pytest.param(unit("not-a-number", 9000.0), id="not a number"),
    ],
)
def test_no_epoch_is_ok_beyond_its_level_after_a_fault_of_the_unit(faults: list[dict[str, Any]]) -> None:
    epochs = with_errors(flown(faults).epochs)
    assert beyond(epochs) == 0
    before = epochs.filter(pl.col("second") > 1, pl.col("second") < 2000)
    assert before["status"].unique().to_list() == ["ok"]
    after = epochs.filter(pl.col("second") >= START_S, pl.col("status") == "ok")
    # Satellites carry the position to some metres, whatever the unit does.
    assert after["error_m"].max() is None or after["error_m"].max() < 15.0  # type: ignore[operator]


def test_an_accelerometer_step_is_contradicted_within_two_seconds() -> None:
    epochs = with_errors(flown([STEP]).epochs)
    contradicted = epochs.filter(pl.col("nav_reasons").str.contains("filter_contradicted"))
    first = contradicted.row(0, named=True)
    assert START_S < first["second"] <= START_S + 2
    assert first["error_m"] <= 10.0
    assert first["nav_source"] == "snapshot"
    later = epochs.filter(pl.col("second") >= START_S)
    # What is given is within some metres for the rest of the flight: the filter alone would be 120 km off.
    assert later["error_m"].max() < 15.0  # type: ignore[operator]


def test_satellites_alone_carry_the_position_of_a_unit_that_says_nothing_that_is_a_number() -> None:
    faults = [{"kind": "imu-trouble", "start_s": 300.0, "duration_s": 9000.0, "what": "not-a-number"}]
    epochs = with_errors(flown(faults).epochs).filter(pl.col("second") >= 300)
    assert set(epochs["status"].unique().to_list()) <= {"ok", "degraded"}
    assert epochs["nav_source"].unique().to_list() == ["snapshot"]
    assert epochs.filter(pl.col("second") >= 311)["status"].unique().to_list() == ["ok"]
    assert epochs["error_m"].max() <= 15.0  # type: ignore[operator]


@pytest.mark.parametrize("duration_s", [0.1, 1.0, 10.0])
def test_a_transient_of_the_unit_is_over_within_ninety_seconds(duration_s: float) -> None:
    epochs = with_errors(flown(pulse(duration_s)).epochs)
    after = epochs.filter(pl.col("second") >= START_S + duration_s + 90)
    assert after["nav_source"].unique().to_list() == ["filter"]
    assert (after["status"] == "ok").mean() > 0.99  # type: ignore[operator]


def test_without_satellites_nothing_is_ok() -> None:
    epochs = with_errors(flown([NO_SATELLITES, STEP]).epochs).filter(pl.col("second") > 2010)
    assert "ok" not in epochs["status"].to_list()
    assert set(epochs["nav_mode"].unique().to_list()) <= {"dme_dme", "vor_dme", "coasting", "stopped"}


@pytest.mark.parametrize("name", ["beijing-shanghai-spoofed", "beijing-shanghai-spoofed-approach"])
def test_a_spoofer_whose_rates_agree_is_never_ok_beyond_the_level(name: str) -> None:
    data = scenario.load(name)
    assert data.sensors is not None
    result = flown([fault.model_dump() for fault in data.sensors.faults], name, systems=("gps", "beidou"))
    assert beyond(with_errors(result.epochs)) == 0


@pytest.fixture(scope="module")
def healthy() -> Any:
    return flown([], flights=4, systems=("gps", "galileo", "beidou"))


def test_a_healthy_flight_is_ok_and_its_level_holds_the_error(healthy: Any) -> None:
    epochs = with_errors(healthy.epochs)
    late = epochs.filter(pl.col("second") >= 120)
    assert beyond(epochs) == 0
    assert (late["status"] == "ok").mean() >= 0.999  # type: ignore[operator]
    assert late["nav_reasons"].drop_nulls().str.contains("filter_contradicted").sum() == 0
    # The level of the filter is that of the snapshot and what lies between both.
    assert np.isfinite(late.filter(pl.col("status") == "ok")["hpl_m"].to_numpy()).all()


def test_filter_and_snapshot_differ_by_what_is_expected(healthy: Any) -> None:
    reported = healthy.settings["filter"]["snapshot_tests"]
    assert reported["n_raised"] == 0
    # The covariance of the difference is widened by 1.6, so that its mean square lies below one.
    assert 0.3 <= reported["position_horizontal"]["mean_square"] <= 1.2
    assert 0.8 <= reported["velocity_horizontal"]["mean_square"] <= 1.1
