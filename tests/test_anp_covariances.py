"""What a region with corners takes for a covariance, against NumPy's eigenvalues; its boxes against one integral."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from navbound import InputError, anp


def symmetric(values: list[float], rng: np.random.Generator) -> np.ndarray:
    a = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    v = a @ np.diag(values) @ a.T
    return np.asarray(0.5 * (v + v.T))


def is_taken(v: np.ndarray) -> bool:
    try:
        anp.cylinder(v, 1.0, 1.0)
    except InputError:
        return False
    return True


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e8])
def test_only_what_has_no_negative_eigenvalue_is_taken(scale: float) -> None:
    rng = np.random.default_rng(5)
    sizes = (1.0, 0.3, 1e-2, 1e-4, 1e-7)
    for signs in itertools.product((1.0, -1.0), repeat=3):
        for three in itertools.combinations_with_replacement(sizes, 3):
            values = [scale * s * x for s, x in zip(signs, three, strict=True)]
            v = symmetric(values, rng)
            # Nothing here stands near the limit of -1e-10 of the largest: rounding cannot decide.
            assert is_taken(v) == (min(values) > 0.0), values


def test_a_single_pair_that_correlates_beyond_one_is_refused() -> None:
    for i, j in ((0, 1), (0, 2), (1, 2)):
        for variances in itertools.product((0.1, 1.0, 20.0), repeat=3):
            for share, taken in ((0.999, True), (-0.999, True), (1.001, False), (-1.001, False), (1.5, False), (6.0, False)):
                v = np.diag(variances)
                v[i, j] = v[j, i] = share * np.sqrt(v[i, i] * v[j, j])
                assert is_taken(v) == taken, (i, j, variances, share)


def test_what_rounding_pushed_below_zero_is_taken_and_what_is_further_is_not() -> None:
    for least, taken in ((-1e-12, True), (-0.9e-10, True), (-1.1e-10, False), (-1e-8, False), (-1e-3, False)):
        for diagonal in itertools.permutations((1.0, 0.5, least)):
            assert is_taken(np.diag(diagonal)) == taken, diagonal
    for factor, taken in ((1e-280, True), (1e-281, False), (9e279, True), (1e280, False)):
        assert is_taken(np.diag([factor, 0.0, 0.0])) == taken, factor


def one_cause(k: float, loads: np.ndarray) -> float:
    """P(some |z_i| > k) for z_i = l_i t + sqrt(1 - l_i^2) n_i: given the common cause t they are independent."""
    rest = np.sqrt(1.0 - loads**2)

    def beyond(t: float) -> float:
        out = norm.sf((k - loads * t) / rest) + norm.sf((k + loads * t) / rest)
        return float(-np.expm1(np.log1p(-np.minimum(out, 1.0 - 1e-16)).sum()) * norm.pdf(t))

    edges = sorted({s * k / abs(x) for x in loads for s in (-1, 1) if abs(x) > 0.1})
    return float(quad(beyond, -12.0, 12.0, points=[e for e in edges if abs(e) < 12.0], limit=400, epsabs=0.0, epsrel=1e-11)[0])


@pytest.mark.parametrize(
    "loads", [(0.0, 0.0, 0.0), (0.5, 0.5, 0.5), (0.9, -0.7, 0.3), (0.99, 0.95, -0.2), (-0.8, 0.05, 0.6), (0.9999, 0.1, 0.9999)]
)
@pytest.mark.parametrize("risk", [0.5, 0.05, 1e-3, 1e-7])
def test_a_box_leaves_its_risk_outside(loads: tuple[float, float, float], risk: float) -> None:
    factors = np.array(loads)
    v = np.outer(factors, factors)
    np.fill_diagonal(v, 1.0)
    sigma = np.array([3.0, 0.2, 7.0])
    for order in ((0, 1, 2), (2, 0, 1), (1, 0, 2)):
        turn = np.ix_(order, order)
        k = anp.box_factor(v[turn] * np.outer(sigma, sigma), risk)
        # Both integrals carry ten digits of the risk.
        assert one_cause(float(k), factors[list(order)]) == pytest.approx(risk, rel=1e-9)
    k = anp.box_factor(np.diag([4.0, 1.0, 0.0]) + np.diag([2.0 * v[0, 1], 0.0], 1) + np.diag([2.0 * v[0, 1], 0.0], -1), risk)
    assert one_cause(float(k), factors[:2]) == pytest.approx(risk, rel=1e-9)


@pytest.mark.parametrize("risk", [0.3, 0.05, 1e-5])
@pytest.mark.parametrize("mean", [(0.0, 0.0, 0.0), (1.0, -0.7, 0.4), (9.0, 3.0, -20.0)])
def test_a_rectangle_and_a_cylinder_meet_their_risk(mean: tuple[float, float, float], risk: float) -> None:
    rng = np.random.default_rng(8)
    for values in ([9.0, 1.0, 0.04], [1.0, 1.0, 1.0], [5.0, 0.0, 0.0], [2.0, 0.3, 0.0]):
        v = symmetric(values, rng)
        # An error in a plane enters the disc like a square root, which panels of 32 nodes carry to five digits.
        digits = 1e-5 if np.count_nonzero(values) == 2 else 1e-9
        s = anp.cylinder_scale(v, 2.0, 3.0, risk, mean)
        sides = anp.cylinder(v, 2.0 * s, 3.0 * s, mean)
        assert sides.outside == pytest.approx(risk, rel=digits)
        assert sides.inside == pytest.approx(1.0 - risk, rel=digits)
        s = anp.rectangle_scale(v[:2, :2], 2.0, 3.0, risk, mean[:2])
        sides = anp.rectangle(v[:2, :2], 2.0 * s, 3.0 * s, mean[:2])
        assert sides.outside == pytest.approx(risk, rel=1e-9)
        assert sides.inside == pytest.approx(1.0 - risk, rel=1e-9)


def test_a_rectangle_around_a_line_of_errors_is_one_tail() -> None:
    """A perfectly correlated error moves along a line: the side that it meets first decides, whichever way rounding pushes the matrix."""
    rng = np.random.default_rng(1)
    for _ in range(300):
        a, b = rng.normal(size=2)
        half = np.exp(rng.normal(size=2))
        inside = 1.0 - 2.0 * norm.sf(min(half[0] / abs(a), half[1] / abs(b)))
        for push in (0.0, -1e-15, 1e-15):
            v = np.array([[a * a, a * b], [a * b, b * b]]) + push * np.eye(2)
            sides = anp.rectangle(v, half[0], half[1])
            # A variance of 1e-15 m² beside the line moves its end by 3e-8 m.
            assert sides.inside == pytest.approx(inside, abs=2e-7)


def slices(v: np.ndarray, m: np.ndarray, radius: float, half: float) -> float:
    """Given the height, the horizontal error is Gaussian again: the disc's law of the conditional covariance, over the height."""
    slope, sigma = v[:2, 2] / v[2, 2], np.sqrt(v[2, 2])
    rest = v[:2, :2] - np.outer(slope, v[:2, 2])

    def weighted(u: float) -> float:
        return float(norm.pdf(u, m[2], sigma) * anp.circle_law(rest, radius, m[:2] + slope * (u - m[2])).inside)

    lo, hi = max(-half, m[2] - 12.0 * sigma), min(half, m[2] + 12.0 * sigma)
    return float(quad(weighted, lo, hi, limit=300, epsabs=1e-11, epsrel=1e-10)[0])


def test_a_cylinder_is_an_integral_over_its_height() -> None:
    rng = np.random.default_rng(2)
    for values, mean in (([4.0, 1.0, 0.25], (0.0, 0.0, 0.0)), ([9.0, 0.04, 2.0], (1.0, -2.0, 0.5)), ([1.0, 0.6, 30.0], (0.3, 0.2, -6.0))):
        v, m = symmetric(values, rng), np.array(mean)
        for radius, half in ((1.0, 2.0), (3.0, 0.7), (6.0, 9.0)):
            assert anp.cylinder(v, radius, half, mean).inside == pytest.approx(slices(v, m, radius, half), rel=1e-8)
