"""Total system error in Python: shapes, refusals, and an independent transcription in 50 digits."""

from __future__ import annotations

import sys
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from navbound import InputError, tse

sys.path.insert(0, str(Path(__file__).parents[1] / "oracle"))
import tse_mpmath as oracle

COVARIANCE = np.array([[60.0, 12.0], [12.0, 110.0]])
RNG = np.random.Generator(np.random.Philox(7))


def relative(actual: object, expected: object) -> float:
    return float(abs(mp.mpf(float(np.asarray(actual))) / mp.mpf(expected) - 1))


@pytest.mark.parametrize("risk", [1e-9, 3e-8, 1e-5, 7e-4, 0.05, 0.21, 0.5])
def test_prepared_and_iterative_bounds_meet_fifty_digits(risk: float) -> None:
    """The contract is 1e-12; a sample of ratios over twelve decades, dense where the bound bends."""
    for ratio in [0.0, 1e-9, 1e-3, 0.03, 0.11, 0.2371, 0.5, 0.77, 1.3, 2.6, 4.4, 37.0, 1e6]:
        sigma = 7.25
        expected = oracle.exact(ratio * sigma, sigma, risk)
        assert relative(tse.Exact(risk)(ratio * sigma, sigma), expected) <= 1e-12
        assert relative(tse.exact([ratio * sigma], sigma, [risk])[0], expected) <= 5e-15


def test_the_one_dimensional_law_is_the_two_dimensional_one() -> None:
    """The risk of the two-dimensional law outside the strip, by quadrature, is the requested risk."""
    for offset, course, risk in [((3.0, -4.0), 0.2333, 0.05), ((-12.0, 2.0), 2.1, 1e-5), ((0.5, 30.0), 4.4, 1e-3)]:
        fte, _, sigma = tse.project(offset, COVARIANCE, course)
        bound = float(tse.exact(fte, sigma, risk))
        # The bound is a double: a tail of 5 deviations multiplies its rounding by about 25.
        assert float(abs(oracle.strip_risk(offset, COVARIANCE.tolist(), course, bound) / risk - 1)) <= 1e-12


def test_student_bounds_have_their_risk() -> None:
    for fte, nu, risk in [(0.0, 3.0, 0.05), (5.0, 5.0, 1e-5), (2.0, 1.0, 1e-3), (30.0, 40.0, 1e-7), (1.0, 2.5, 0.4)]:
        bound = float(tse.student_t(fte, 10.0, nu, risk))
        assert float(abs(oracle.student_risk(bound, fte, 10.0, nu) / risk - 1)) <= 1e-11


def test_box_risks_meet_quadrature() -> None:
    for _ in range(12):
        fte, fte_v = RNG.uniform(-20, 20, 2)
        sigma, sigma_v = RNG.uniform(2, 20, 2)
        rho = RNG.uniform(-0.98, 0.98)
        limit, limit_v = abs(fte) + RNG.uniform(0, 5) * sigma, abs(fte_v) + RNG.uniform(0, 5) * sigma_v
        result = tse.box_risk(fte, sigma, fte_v, sigma_v, limit_m=limit, limit_v_m=limit_v, correlation=rho)
        assert relative(result.risk, oracle.box_risk(fte, sigma, fte_v, sigma_v, rho=rho, limit_l=limit, limit_v=limit_v)) <= 1e-11


def test_ctem_is_the_largest_root_of_the_quartic() -> None:
    for _ in range(20):
        offset = RNG.uniform(-40, 40, 2)
        a, b = RNG.uniform(0.5, 30, 2)
        k = float(tse.factors(0.05).two_sided)
        result = tse.ctem(offset, np.diag([a * a, b * b]), 0.05)
        # The half axes are products of doubles.
        assert relative(result, oracle.farthest(offset[0], offset[1], k * a, k * b)) <= 2e-15


def test_arrays_broadcast_and_single_numbers_stay_single() -> None:
    assert tse.exact(3.0, 7.0, 0.05).shape == ()
    assert tse.exact(np.zeros((4, 1)), np.ones(3), 0.05).shape == (4, 3)
    assert tse.exact(0.0, 1.0, [0.05, 1e-5]).shape == (2,)
    assert tse.exact([], [], 0.05).shape == (0,)
    assert tse.project(np.zeros((5, 2)), COVARIANCE, 0.1).sigma_m.shape == (5,)
    assert tse.vertical(np.zeros(3), np.eye(3), np.zeros((2, 4)), 0.0, 0.05).tse_v_m.shape == (2, 4)
    assert tse.mixture([0.5, 0.5], np.zeros((6, 2)), [1.0, 2.0], 0.05).shape == (6,)


def test_large_batches_give_the_same_as_single_epochs() -> None:
    n = 150_000
    fte, sigma = RNG.normal(0, 30, n), RNG.uniform(0, 20, n)
    whole = tse.exact(fte, sigma, 1e-5)
    for i in RNG.integers(n, size=200):
        assert whole[i] == tse.exact(fte[i], sigma[i], 1e-5)


@pytest.mark.parametrize(
    ("call", "argument", "index"),
    [
        (lambda: tse.exact([1.0, np.nan], 1.0, 0.05), "fte_m", 1),
        (lambda: tse.exact([1.0, 2.0, 3.0], [1.0, 1.0, -1.0], 0.05), "sigma_m", 2),
        (lambda: tse.exact(1.0, np.inf, 0.05), "sigma_m", 0),
        (lambda: tse.exact(1.0, 1.0, 0.0), "risk", None),
        (lambda: tse.exact(1.0, 1.0, [0.05, 1.0]), "risk", 1),
        (lambda: tse.exact(1.0, 1.0, np.nan), "risk", None),
        (lambda: tse.Exact(1.5), "risk", None),
        (lambda: tse.exact("x", 1.0, 0.05), "fte_m", None),
        (lambda: tse.exact([1.0, 2.0], [1.0, 2.0, 3.0], 0.05), "sigma_m", None),
        (lambda: tse.ltem(np.nan, 1.0, 0.05), "fte_m", 0),
        (lambda: tse.sqsm(1.0, [[1.0, 0.5], [0.4, 1.0]], 0.05), "covariance_en_m2", 0),
        (lambda: tse.sqsm(1.0, [[1.0, 2.0], [2.0, 1.0]], 0.05), "covariance_en_m2", 0),
        (lambda: tse.ctem([1.0, np.nan], COVARIANCE, 0.05), "offset_en_m", 0),
        (lambda: tse.ctem([1.0, 2.0], [[np.nan, 0.0], [0.0, 1.0]], 0.05), "covariance_en_m2", 0),
        (lambda: tse.ctem_foot(1.0, np.inf, COVARIANCE, 0.05), "course_rad", 0),
        (lambda: tse.ctem_foot(1.0, [6.28, 270.0], COVARIANCE, 0.05), "course_rad", 1),
        (lambda: tse.project([1.0, 0.0], COVARIANCE, 270.0), "course_rad", 0),
        (lambda: tse.explain([0.0, 0.0], COVARIANCE, -6.3, 1e-5), "course_rad", 0),
        (lambda: tse.project([1.0], COVARIANCE, 0.0), "offset_en_m", None),
        (lambda: tse.exceedance_risk(1.0, 1.0, -1.0), "limit_m", 0),
        (lambda: tse.margin(1.0, 1.0, [1.0, np.nan], 0.05), "limit_m", 1),
        (lambda: tse.rssm(1.0, -1.0, 0.0, 0.05), "sigma_nse_m", 0),
        (lambda: tse.random_fte(np.nan, 1.0, 1.0, 0.05), "mean_fte_m", 0),
        (lambda: tse.random_fte(0.0, 1.0, 1.0, 0.05, correlation=1.5), "correlation", 0),
        (lambda: tse.student_t(0.0, -1.0, 3.0, 0.05), "scale_m", 0),
        (lambda: tse.student_t(0.0, 1.0, 0.5, 0.05), "degrees_of_freedom", 0),
        (lambda: tse.mixture([0.5, 0.4], [0.0, 0.0], [1.0, 1.0], 0.05), "weight", 0),
        (lambda: tse.mixture([1.5, -0.5], [0.0, 0.0], [1.0, 1.0], 0.05), "weight", 0),
        (lambda: tse.mixture([], [], [], 0.05), "weight", None),
        (lambda: tse.paired_overbound(0.0, 1.0, -1.0, 0.05), "bias_m", 0),
        (lambda: tse.rf_fte(0.0, 0.0, 1.0, 0.0), "radius_m", 0),
        (lambda: tse.vertical([0.0, 0.0, 0.0], np.eye(3), 0.0, np.pi / 2 + 0.1, 0.05), "path_angle_rad", 0),
        (lambda: tse.vertical([0.0, 0.0, 0.0], -np.eye(3), 0.0, 0.0, 0.05), "covariance_enu_m2", 0),
        (lambda: tse.box_risk(0.0, 1.0, 0.0, -1.0, limit_m=1.0, limit_v_m=1.0), "sigma_v_m", 0),
        (lambda: tse.box(0.0, 1.0, 0.0, 1.0, 0.05, share=1.0), "share", 0),
        (lambda: tse.rotated_frame(np.nan, 0.0, 0.0, 1.0, 1.0, risk=0.05), "k", 0),
        (lambda: tse.ltem_as_printed([0.0, 0.0], COVARIANCE, 0.01), "risk", 0),
    ],
)
def test_a_wrong_argument_is_named(call: object, argument: str, index: int | None) -> None:
    assert callable(call)
    with pytest.raises(InputError) as refusal:
        call()
    assert refusal.value.argument == argument
    assert refusal.value.index == index


def test_budgets_say_where_there_is_none() -> None:
    assert np.isnan(tse.fte_budget(1.0, 1.0, 0.05))
    assert np.isnan(tse.sigma_budget(1.0, 2.0, 0.05))
    assert tse.fte_budget(20.0, 0.0, 0.05) == 20.0
    assert tse.sigma_budget(20.0, 20.0, 0.05) == 0.0


def test_margin_is_limit_minus_bound() -> None:
    assert tse.margin(3.0, 7.0, 555.6, 0.05) == 555.6 - tse.exact(3.0, 7.0, 0.05)


def test_a_curved_leg_adds_its_second_order() -> None:
    assert float(tse.rf_fte(-5.0, 30.0, 40.0, 5000.0)) == pytest.approx(5.0 + (30.0**2 + 40.0**2) / 1e4, rel=1e-15)


@settings(max_examples=200, deadline=None)
@given(st.floats(-1e4, 1e4), st.floats(0, 1e3), st.floats(1e-9, 0.5), st.floats(0, 2e4))
@example(2.0, 5e-324, 0.5, 1.0)  # a deviation so small that the ratios overflow
def test_the_alert_needs_no_root(fte: float, sigma: float, risk: float, limit: float) -> None:
    """The bound is beyond the limit exactly where the risk beyond the limit is more than allowed, apart from rounding."""
    bound = float(tse.exact(fte, sigma, risk))
    if abs(bound - limit) > 1e-9 * max(bound, limit):
        assert (bound > limit) == (float(tse.exceedance_risk(fte, sigma, limit)) > risk)


def test_every_provision_of_a_batch_is_one_epoch_at_a_time() -> None:
    """Arrays of situations give what each situation gives alone."""
    offsets, courses = RNG.normal(0, 20, (7, 2)), RNG.uniform(0, 6, 7)
    together = tse.explain(offsets, COVARIANCE, courses, 0.05)
    for i in range(7):
        alone = tse.explain(offsets[i], COVARIANCE, courses[i], 0.05)
        for a, b in zip(together, alone, strict=True):
            assert a[i] == b
