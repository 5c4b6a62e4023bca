"""The satellites that a monitor on board heard: who is in the position, who was excluded, and by how much a range is wrong there."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import araim, gnss, raim
from navbound.gnss.watched import Watched

EXAMPLES = Path(__file__).parents[1] / "examples" / "data"
TRUTH = (4189135.1896, 188029.6189, 4789919.6247)
FAULTY, FIRST_S, LAST_S, AT_FIRST_M, RATE_MPS = "G10", 4500.0, 5400.0, 40.0, 0.1
"""What happens to the station (examples/data/README.md)."""
WATCHES: dict[str, Any] = {"raim": raim.watch, "araim": araim.watch}


@cache
def watched(name: Literal["raim", "araim"]) -> Watched:
    observations, navigation = gnss.read_observations(EXAMPLES / "station.rnx"), gnss.read_navigation([EXAMPLES / "broadcast.rnx"])
    result: Watched = WATCHES[name](observations, navigation, keep_ranges=True)
    return result


@pytest.mark.parametrize("name", WATCHES)
def test_those_in_the_position_and_those_excluded_are_those_of_the_epochs(name: Literal["raim", "araim"]) -> None:
    heard, epochs = watched(name).heard, watched(name).epochs
    assert heard is not None
    above = heard.filter(pl.col("fate").is_in(["used", "excluded"])).group_by("time_ns").len().sort("time_ns")
    assert above["len"].to_list() == epochs["n_sv"].to_list()
    excluded = heard.filter(pl.col("fate") == "excluded").select("time_ns", "sv")
    stated = epochs.filter(pl.col("excluded_sv").is_not_null()).select("time_ns", sv=pl.col("excluded_sv").str.split(",")).explode("sv")
    assert excluded.sort("time_ns", "sv").equals(stated.sort("time_ns", "sv"))
    assert set(excluded["sv"]) == {FAULTY}


@pytest.mark.parametrize("name", WATCHES)
def test_the_residual_of_a_satellite_is_the_error_of_its_range(name: Literal["raim", "araim"]) -> None:
    heard = watched(name).heard
    assert heard is not None
    since_s = (pl.col("time_ns") - heard["time_ns"].min()) * 1e-9
    excluded = heard.filter(pl.col("fate") == "excluded").with_columns(wrong=AT_FIRST_M + RATE_MPS * (since_s - FIRST_S))
    assert excluded.select(since_s.is_between(FIRST_S - 1.0, LAST_S + 1.0).all()).item()
    # Noise, multipath and the error of the position at 46 degrees of elevation: some metres.
    assert np.abs((excluded["residual_m"] - excluded["wrong"]).to_numpy()).max() < 5.0
    used = heard.filter(pl.col("fate") == "used")
    assert np.abs(used["residual_m"].to_numpy()).max() < 5.0
    assert used.select(pl.col("sigma_m", "residual_m", "az_rad", "el_rad", "cn0_dbhz").null_count().sum()).row(0) == (0,) * 5


def test_directions_are_those_of_the_solution_without_a_monitor() -> None:
    observations, navigation = gnss.read_observations(EXAMPLES / "station.rnx"), gnss.read_navigation([EXAMPLES / "broadcast.rnx"])
    own, heard = gnss.solve(observations, navigation, systems="G", keep_ranges=True).heard, watched("raim").heard
    assert own is not None
    assert heard is not None
    both = heard.join(own, on=["time_ns", "sv"]).drop_nulls(["az_rad", "az_rad_right"])
    assert both.height > 1500
    # Two positions some metres apart, and satellites 20 000 km away.
    np.testing.assert_allclose(both["az_rad"].to_numpy(), both["az_rad_right"].to_numpy(), atol=1e-4)
    np.testing.assert_allclose(both["cn0_dbhz"].to_numpy(), both["cn0_dbhz_right"].to_numpy())


def test_nothing_is_kept_unless_it_is_requested() -> None:
    observations, navigation = gnss.read_observations(EXAMPLES / "station.rnx"), gnss.read_navigation([EXAMPLES / "broadcast.rnx"])
    assert raim.watch(observations, navigation).heard is None


@pytest.mark.parametrize("name", WATCHES)
def test_an_evaluation_with_a_monitor_shows_its_sky(tmp_path: Path, name: str) -> None:
    files = [EXAMPLES / "station.rnx", EXAMPLES / "broadcast.rnx"]
    truth = ",".join(map(str, TRUTH))
    run = navbound.evaluate(files, truth=truth, levels="LPV-200", protection=name, out=tmp_path / "run")
    assert run.satellites is not None
    assert (tmp_path / "run" / "satellites.parquet").exists()
    (row,) = [each for each in run.summary.satellites if each.sv == FAULTY]
    assert row.n_heard - row.n_used == 30
