"""navbound.anp against SciPy's general integrators and fifty-digit tables."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from navbound import anp

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "oracle"))

import anp_scipy  # noqa: E402
import anp_tables  # noqa: E402

CASES = [
    # sigma, mean, radius
    ((1.0, 0.3), (0.0, 0.0), 1.7),
    ((1.0, 0.3), (0.8, -0.4), 2.2),
    ((5.0, 0.2), (4.0, 3.0), 6.0),
    ((1.0, 0.9), (9.0, 2.0), 10.0),
    ((1.0, 0.8, 0.5), (0.0, 0.0, 0.0), 2.0),
    ((1.0, 0.8, 0.5), (0.7, -1.0, 0.4), 2.0),
]


def turned(sigma: tuple[float, ...], seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    a = np.linalg.qr(rng.normal(size=(len(sigma), len(sigma))))[0]
    v = a @ np.diag(np.square(sigma)) @ a.T
    return np.asarray(0.5 * (v + v.T), dtype=np.float64)


@pytest.mark.parametrize(("sigma", "mean", "radius"), CASES)
def test_probabilities_agree_with_nested_quadrature(sigma: tuple[float, ...], mean: tuple[float, ...], radius: float) -> None:
    v = turned(sigma, 3)
    law = (anp.circle_law if len(sigma) == 2 else anp.sphere_law)(v, radius, mean)
    # The tolerances of the oracle's integrator, in two and in three dimensions.
    assert law.inside == pytest.approx(anp_scipy.ball(v, np.array(mean), radius), abs=1e-9 if len(sigma) == 2 else 1e-7)


def test_a_round_error_with_a_mean_is_non_central_chi_square() -> None:
    for distance in (0.5, 3.0, 6.0, 12.0, 40.0):
        for risk in (0.5, 0.05, 1e-5):
            circle = anp.circle(4.0 * np.eye(2), risk, [0.6 * distance, 0.8 * distance])
            assert circle == pytest.approx(anp_scipy.rice_radius(2.0, distance, risk), rel=1e-9)
            sphere = anp.sphere(4.0 * np.eye(3), risk, [0.0, 0.6 * distance, 0.8 * distance])
            assert sphere == pytest.approx(anp_scipy.maxwell_radius(2.0, distance, risk), rel=1e-9)


def test_a_biased_line_agrees_with_the_two_tails() -> None:
    for bias, risk in [(0.0, 0.05), (0.3, 0.05), (-4.0, 1e-5), (50.0, 1e-9), (1e-9, 0.5), (3.0, 0.4)]:
        bounds = anp.along(4.0 * np.eye(3), [0.0, 1.0, 0.0], risk, [7.0, bias, 7.0])
        assert bounds == pytest.approx(anp_scipy.folded_half_width(bias, 2.0, risk), rel=1e-12)


def test_imhof_agrees_where_it_converges() -> None:
    variances, delta = np.array([4.0, 2.0, 0.5]), np.array([0.5, 1.0, 0.2])
    mean = np.sqrt(variances) * delta
    for x in (4.0, 12.0, 25.0):
        result = anp.sphere_risk(np.diag(variances), np.sqrt(x), mean)
        # The truncated oscillation of the integral decays as u^(-5/2).
        assert result == pytest.approx(anp_scipy.imhof_outside(variances, delta**2, x), abs=1e-6)


def test_correlated_boxes_agree_with_the_multivariate_normal() -> None:
    v = turned((3.0, 1.0, 0.5), 11)
    half = anp.box(v, 0.05)
    assert anp_scipy.box_inside(v, half) == pytest.approx(0.95, abs=1e-6)
    assert anp.rectangle(v[:2, :2], 1.0, 2.0).inside == pytest.approx(anp_scipy.box_inside(v[:2, :2], np.array([1.0, 2.0])), abs=1e-9)


def test_the_tables_hold_fifty_digit_nodes() -> None:
    def numbers(path: str, name: str) -> list[float]:
        text = (ROOT / "crates/core/src/special" / path).read_text(encoding="utf-8")
        block = text[text.index(f"const {name}:") :]
        block = block[block.index("= [") + 3 : block.index("\n];")]
        return [float(x) for x in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", block)]

    with mp.workdps(anp_tables.DIGITS):
        for name, nodes in anp_tables.contours().items():
            exact = [float(x) for c, a in nodes for x in (c.real, c.imag, a.real, a.imag)]
            assert numbers("radius/nodes.rs", name) == exact
        exact = [float(x) for node in anp_tables.gauss_legendre(32) for x in node]
    assert numbers("quadrature.rs", "GAUSS_32") == exact
