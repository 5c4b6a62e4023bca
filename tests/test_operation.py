"""What is flown is stated, and travels from the scenario or the caller to the summary; the size of RNP says nothing of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import InputError
from navbound.records.material import Material
from navbound.records.run import CovarianceOrigin
from navbound.run.judge import judge

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.records.material import Operation

N = 200


def epochs(rnp_m: float) -> pl.DataFrame:
    """A straight leg north at 60 m/s, with a covariance and a deviation of some metres; seed 1."""
    random = np.random.default_rng(1)
    return pl.DataFrame(
        {
            "track": ["one"] * N,
            "time_ns": np.arange(N) * 1_000_000_000,
            "est_lat_rad": 0.7 + np.arange(N) * 1e-5,
            "est_lon_rad": np.full(N, 0.3),
            "course_rad": np.zeros(N),
            "fte_m": random.normal(0.0, 1.0, N),
            "rnp_m": np.full(N, rnp_m),
            "cov_ee_m2": np.full(N, 0.5),
            "cov_en_m2": np.zeros(N),
            "cov_nn_m2": np.full(N, 0.5),
            "status": ["ok"] * N,
            "reason": pl.Series([None] * N, dtype=pl.String),
        }
    )


@pytest.mark.parametrize("rnp_m", [5.0, 1852.0])
@pytest.mark.parametrize("operation", ["en-route", "approach", "ground"])
def test_only_what_is_stated_to_roll_has_no_states_of_flight(rnp_m: float, operation: Operation) -> None:
    made = Material(epochs(rnp_m), "analyze", "a leg", "RNP", 1.0, ["made for a test"], CovarianceOrigin(id="file"), operation)
    summary = judge(made).summary
    assert summary.operation == operation
    assert bool(summary.states) is (operation != "ground")


def recording(folder: Path) -> Path:
    file = folder / "leg.csv"
    rows = "".join(f"{1_700_000_000 + k},a,{40.0 + k * 5e-4:.6f},15.0,1000\n" for k in range(60))
    file.write_text("timestamp,icao24,latitude,longitude,altitude\n" + rows, encoding="utf-8")
    return file


@pytest.mark.parametrize("stated", [None, "approach", "ground"])
def test_a_recording_is_what_the_caller_states(tmp_path: Path, stated: Operation | None) -> None:
    run = navbound.analyze(recording(tmp_path), sigma_m=5.0, operation=stated)
    assert run.summary.operation == (stated or "en-route")


def test_an_operation_that_is_none_is_refused_with_those_that_are(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="en-route, approach, ground"):
        navbound.analyze(recording(tmp_path), sigma_m=5.0, operation="taxi")
