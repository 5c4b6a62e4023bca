"""An allowed risk is at most one half and at least 1e-300, in every function that takes one; a confidence is refused."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from navbound import InputError, araim, gbas, kpi, raim, rnp, tse
from navbound.methods import bounds
from navbound.run.settings import Settings
from public_calls import CALLS

RISKS = ("risk", "integrity_risk", "allotted_risk", "continuity_risk", "risk_per_hour", "risk_per_epoch", "residual_risk", "false_alarm")
PAIRS = [(name, argument) for name, call in CALLS.items() for argument in call.numbers if argument in RISKS]
ONLY_95 = {"anp.circle_fit", "anp.circle_fit_as_printed", "anp.circle_geodesy", "anp.sphere_grubbs_as_printed"}
"""Fits that exist for 95 % only refuse every other risk by that rule."""


def with_risk(name: str, argument: str, value: float) -> Any:
    numbers = CALLS[name].numbers[argument]
    return CALLS[name](**{argument: value if isinstance(numbers, float) else np.full(np.shape(numbers), value)})


def test_many_functions_take_a_risk() -> None:
    assert len(PAIRS) > 35


@pytest.mark.parametrize(("name", "argument"), PAIRS)
@pytest.mark.parametrize("value", [np.nan, np.inf, -0.1, 0.0, 5e-324, 9e-301, 0.6, 0.99999, 1.0])
def test_what_is_no_risk_is_refused(name: str, argument: str, value: float) -> None:
    with pytest.raises(InputError) as refused:
        with_risk(name, argument, value)
    if name not in ONLY_95 and value in {0.6, 0.99999}:
        meant = {0.6: "0.4", 0.99999: "1e-05"}[value]
        assert f"risk is 1 - confidence; did you mean {meant}?" in str(refused.value)
        assert refused.value.argument == argument


NO_BUDGET = {"tse.fte_budget", "tse.sigma_budget"}
"""A limit may leave no budget at a risk, which is NaN by their contract."""


@pytest.mark.parametrize(("name", "argument"), [pair for pair in PAIRS if pair[0] not in NO_BUDGET])
def test_the_smallest_risk_is_answered_or_refused(name: str, argument: str) -> None:
    """No panic, and no NaN in the place of a bound."""
    try:
        result = with_risk(name, argument, 1e-300)
    except InputError:
        return
    if isinstance(result, np.ndarray | float):
        assert not np.isnan(result).any()


def test_a_bound_is_finite_and_grows_down_to_the_smallest_risk() -> None:
    risks = np.array([0.5, 0.05, 1e-5, 1e-9, 1e-100, 1e-300])
    levels = tse.exact(30.0, 8.5, risks)
    assert np.isfinite(levels).all()
    assert (np.diff(levels) > 0).all()
    # |fte| + 37.04 sigma: -norm.ppf(1e-300) = 37.0471 (SciPy); one tail, the other side being 60 m further away.
    assert levels[-1] == pytest.approx(30.0 + 37.0471 * 8.5, rel=1e-5)


def answered(call: Any) -> float | None:
    """A number, or None where the argument is refused."""
    try:
        return float(call())
    except InputError:
        return None


@pytest.mark.parametrize("degrees_of_freedom", [1.0, 2.0, 6.0, 100.0])
def test_a_students_bound_holds_its_risk_or_is_refused(degrees_of_freedom: float) -> None:
    """Closed form: at one degree of freedom and no mean both tails are 2 / (pi T), at two about 2 / T^2."""
    for risk in 10.0 ** -np.arange(1, 301, 23):
        if risk < 1e-120:
            bound = answered(lambda risk=risk: tse.student_t(0.0, 1.0, degrees_of_freedom, risk))
            if bound is None:
                continue
        else:
            bound = float(tse.student_t(0.0, 1.0, degrees_of_freedom, risk))
        if degrees_of_freedom == 1.0:
            assert bound == pytest.approx(1.0 / np.tan(np.pi * risk / 2.0), rel=1e-9)
        if degrees_of_freedom == 2.0:
            assert bound == pytest.approx((1.0 - risk) * np.sqrt(2.0 / (risk * (2.0 - risk))), rel=1e-9)


def test_settings_and_requirements_take_the_same_risks() -> None:
    service = araim.SERVICES["lpv-200"]
    calls = {
        "risk_integrity": lambda: Settings(risk_integrity=0.99999),
        "integrity_risk": lambda: rnp.Monitor(integrity_risk=0.99999),
        "integrity_h": lambda: CALLS["araim.protection_levels"](service=replace(service, integrity_h=0.99999)),
        "missed_detection": lambda: CALLS["raim.protection_levels"](requirement=replace(raim.RAIM, missed_detection=0.99999)),
        "risk": lambda: bounds(_one_epoch(), "tse-exact", 0.99999),
    }
    for argument, call in calls.items():
        with pytest.raises(InputError, match="did you mean 1e-05") as refused:
            call()  # type: ignore[no-untyped-call]
        assert refused.value.argument == argument


def _one_epoch() -> Any:
    import polars as pl  # noqa: PLC0415

    return pl.DataFrame({"course_rad": [0.1], "fte_m": [3.0], "cov_ee_m2": [4.0], "cov_en_m2": [0.0], "cov_nn_m2": [4.0]})


def test_probabilities_that_may_come_near_one_are_no_risks() -> None:
    assert tse.exceedance_risk(100.0, 5.0, 10.0) == pytest.approx(1.0, abs=1e-12)
    assert gbas.missed_by_monitor(0.0) == 1.0
    assert (kpi.rnp(0.3, tta_s=10.0).integrity_risk or 0.0) <= 0.5
