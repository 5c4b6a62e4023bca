"""A setting reaches everything that states it."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import polars as pl
import pytest

from navbound import InputError
from navbound.methods import bounds
from navbound.records.material import Material
from navbound.records.run import CovarianceOrigin
from navbound.run.judge import judge
from navbound.run.settings import Settings

DEFAULTS = {"risk_accuracy": 0.05, "risk_integrity": 1e-5}


def epochs(n: int = 400) -> pl.DataFrame:
    """A straight leg with an error whose covariance is right; seed 3."""
    random = np.random.default_rng(3)
    nse = random.normal(0.0, 8.5, (n, 2))
    return pl.DataFrame(
        {
            "track": ["one"] * n,
            "time_ns": np.arange(n) * 1_000_000_000,
            "est_lat_rad": np.full(n, 0.7),
            "est_lon_rad": np.full(n, 0.3),
            "course_rad": np.full(n, 0.4),
            "fte_m": random.normal(0.0, 30.0, n),
            "rnp_m": np.full(n, 555.6),
            "nse_e_m": nse[:, 0],
            "nse_n_m": nse[:, 1],
            "cov_ee_m2": np.full(n, 72.25),
            "cov_en_m2": np.zeros(n),
            "cov_nn_m2": np.full(n, 72.25),
            "status": ["ok"] * n,
            "reason": pl.Series([None] * n, dtype=pl.String),
        }
    )


def judged(settings: Settings) -> Any:
    return judge(Material(epochs(), "analyze", "a leg", "RNP 0.3", 1.0, ["made for a test"], CovarianceOrigin(id="file")), settings)


def stated(value: object, where: str = "") -> list[tuple[str, float | str]]:
    """Every number and text of a record, with its place."""
    if isinstance(value, dict):
        return [each for key, part in value.items() for each in stated(part, f"{where}.{key}")]
    if isinstance(value, list):
        return [each for key, part in enumerate(value) for each in stated(part, f"{where}[{key}]")]
    return [(where, value)] if isinstance(value, float | str) else []


def says(value: float | str, risk: float) -> bool:
    """Whether it states a risk, as a number, in words, or as its confidence in per cent."""
    if isinstance(value, float):
        return value == risk
    confidence = f"{100 * (1 - risk):.10g} %"
    # An interval of an estimate has a confidence of its own.
    value = value.replace("95 % intervals", "intervals")
    return (
        re.search(rf"(?<![\d.e-]){re.escape(f'{risk:g}')}(?!\d)", value) is not None
        or re.search(rf"(?<![\d.]){confidence}", value) is not None
    )


def test_the_search_sees_a_risk_in_every_form() -> None:
    for value in (1e-5, "risk 1e-05 per epoch", "the 99.999 % bound"):
        assert says(value, 1e-5)
    for value in (1e-7, "risk 1e-07 per epoch", "the 99.99999 % bound"):
        assert not says(value, 1e-5)


@pytest.mark.parametrize(("name", "other"), [("risk_accuracy", 0.01), ("risk_integrity", 1e-7)])
def test_a_changed_risk_is_stated_everywhere_and_the_default_nowhere(name: str, other: float) -> None:
    run = judged(Settings(**{name: other}))  # type: ignore[arg-type]
    places = stated({"record": run.record.model_dump(mode="json"), "summary": run.summary.model_dump(mode="json")})
    assert [where for where, value in places if says(value, DEFAULTS[name])] == []
    new = [where for where, value in places if says(value, other)]
    assert f".record.{name}" in new
    if name == "risk_integrity":
        assert ".record.settings.monitor.exposure" in new
    column = {"risk_accuracy": "tse_exact_m", "risk_integrity": "tse_exact_integrity_m"}[name]
    assert np.array_equal(run.epochs[column].to_numpy(), bounds(epochs(), "tse-exact", other).bound_m)


@pytest.mark.parametrize("name", sorted(DEFAULTS))
@pytest.mark.parametrize("value", [0.99999, 0.0, float("nan"), 5e-324])
def test_a_setting_that_is_no_risk_is_refused_by_its_name(name: str, value: float) -> None:
    with pytest.raises(InputError, match=name) as refused:
        Settings(**{name: value})  # type: ignore[arg-type]
    assert ("did you mean 1e-05?" in str(refused.value)) == (value == 0.99999)
