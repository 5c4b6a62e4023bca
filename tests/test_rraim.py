"""RRAIM through the public functions: Monte Carlo of propagation and safety; reference numbers stand in vectors/rraim-levels.toml."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from navbound import InputError, gbas, rraim

AZ = np.radians([10.0, 60.0, 120.0, 180.0, 230.0, 290.0, 330.0, 95.0])
EL = np.radians([70.0, 25.0, 40.0, 15.0, 55.0, 20.0, 35.0, 60.0])
AZ_NOW, EL_NOW = AZ + np.radians([4.0, -2.0, 1.0, 2.0, -3.0, 1.0, -1.0, 3.0]), EL + np.radians([2.0, -3.0, 4.0, 1.0, -4.0, 3.0, -2.0, 1.0])
TD = 0.2


def rows(az: np.ndarray, el: np.ndarray) -> np.ndarray:
    return np.column_stack([-np.cos(el) * np.sin(az), -np.cos(el) * np.cos(az), -np.sin(el), np.ones(len(az))])


def solution(h: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    w = np.diag(sigma**-2)
    return np.asarray(np.linalg.inv(h.T @ w @ h) @ h.T @ w)


class Drawn:
    """Fixes and phases drawn and solved with every clock in the equations; nothing here is the code under test."""

    def __init__(self, n: int, seed: int) -> None:
        self.generator = np.random.Generator(np.random.Philox(seed))
        self.sigma = gbas.range_sigma(EL, "F").sigma_m
        self.h, self.h0 = rows(AZ_NOW, EL_NOW), rows(AZ, EL)
        # Error is estimated minus true throughout.
        self.fix = self.generator.normal(0.0, self.sigma, (n, len(AZ))) @ solution(self.h0, self.sigma).T
        self.phase = self.generator.normal(0.0, TD, (n, len(AZ)))

    def travelled(self, kept: np.ndarray, fault: np.ndarray) -> np.ndarray:
        """Errors now: the change solved from differences whose known part was computed with the old, wrong position."""
        sd = np.zeros((4, len(AZ)))
        sd[:, kept] = solution(self.h[kept], np.full(kept.sum(), TD))
        change = (self.phase + fault - self.fix @ (self.h - self.h0).T) @ sd.T
        return np.asarray((self.fix + change)[:, :2])


def levels(**settings: object) -> rraim.Levels:
    return rraim.protection_levels(AZ, EL, AZ_NOW, EL_NOW, TD, service="F", **settings)  # type: ignore[arg-type]


def test_the_propagated_covariance_is_that_of_drawn_errors() -> None:
    n = 100_000
    drawn = Drawn(n, 11)
    errors = drawn.travelled(np.ones(len(AZ), dtype=bool), np.zeros(len(AZ)))
    expected = levels().covariance_enu_m2[:2, :2]
    # A variance of 1e5 samples scatters by sqrt(2/n) = 0.45 %; a hundredth is what the specification allows.
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert np.abs((np.cov(errors.T) - expected) / scale).max() < 0.01


@pytest.mark.parametrize("size", [0.5, 1.0, 2.0, 4.0])
def test_ramps_that_hurt_are_detected_as_often_as_allotted(size: float) -> None:
    """Single ramps of either sign on a random satellite: error above the level and no alarm stays below the risk of 1e-3."""
    n, risk, continuity = 60_000, 1e-3, 1e-3
    drawn = Drawn(n, int(100 * size))
    fault = np.zeros((n, len(AZ)))
    fault[np.arange(n), drawn.generator.integers(len(AZ), size=n)] = size * drawn.generator.choice([-1.0, 1.0], n)
    k = gbas.Factors(k_ffmd=float(stats.norm.isf(risk / 2)), k_md=0.0)
    settings = {"k": k, "continuity_risk": continuity, "allotted_risk": risk, "p_sat": {0: 1.0 / len(AZ) * 0.999999}}
    computed = levels(**settings)
    every = np.ones(len(AZ), dtype=bool)
    whole = drawn.travelled(every, fault)
    alarm = np.zeros(n, dtype=bool)
    k_false = float(stats.norm.isf(continuity / (2 * len(AZ))))
    for i in range(len(AZ)):
        kept = every.copy()
        kept[i] = False
        apart = np.linalg.norm(drawn.travelled(kept, fault) - whole, axis=1)
        alarm |= apart > computed.subset_threshold_m[i]
        # SciPy's tail, to the digits of both.
        assert computed.subset_threshold_m[i] == pytest.approx(k_false * computed.subset_separation_m[i], rel=1e-12)
    hurt = (np.linalg.norm(whole, axis=1) > computed.hpl_m) & ~alarm
    low = stats.binomtest(int(hurt.sum()), n).proportion_ci(0.99).low
    assert low <= risk, f"{hurt.mean()} of {n}"
    assert size < 1.0 or alarm.mean() > 0.3, "ramps that no monitor sees would prove nothing"


def test_without_motion_and_noise_the_levels_are_those_of_the_fix() -> None:
    still = rraim.protection_levels(AZ, EL, AZ, EL, 1e-6, service="F", bias_m=0.2)
    fix = gbas.protection_levels(AZ, EL, service="F", bias_m=0.2)
    # A micrometre of phase.
    assert abs(still.hpl_h0_m - fix.hpl_h0_m) < 1e-5
    assert abs(still.hpl_h1_m - fix.hpl_h1_m) < 1e-5
    assert abs(still.accuracy_m - fix.accuracy_m) < 1e-5


def test_a_lost_satellite_is_still_in_the_fix() -> None:
    az_now, el_now = AZ_NOW.copy(), EL_NOW.copy()
    az_now[3] = el_now[3] = np.nan
    less = rraim.protection_levels(AZ, EL, az_now, el_now, TD, service="F")
    assert less.n_sv == 7
    assert less.sigma_major_m > levels().sigma_major_m
    assert np.isnan(less.subset_sigma_m[3])
    # The travel without it is what the subset without it already was.
    assert abs(less.sigma_major_m - levels().subset_sigma_m[3]) < 1e-12


def test_more_faults_cost_more() -> None:
    one, two = levels(), levels(p_sat={0: 1e-4})
    assert two.hpl_multi_m > one.hpl_multi_m
    assert two.n_modes == 8 + 28
    assert one.n_modes == 8
    assert one.hpl_multi_m == pytest.approx(np.hypot(one.hpl_multi_e_m, one.hpl_multi_n_m), rel=1e-15)


def test_the_multi_fault_level_solves_its_equation() -> None:
    """Summed term by term from covariances of the whole normal equations, with the exact tail."""
    p_sat, allotted, continuity, bias = 1e-7, 2.34375e-10, 1.25e-5, 0.1
    computed = levels(p_sat={0: p_sat}, bias_m=bias)
    sigma = gbas.range_sigma(EL, "F").sigma_m
    s0 = solution(rows(AZ, EL), sigma)
    p0 = (s0 * sigma**2) @ s0.T
    h, h0 = rows(AZ_NOW, EL_NOW), rows(AZ, EL)

    def travel(kept: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        sd = np.zeros((4, len(AZ)))
        sd[:, kept] = solution(h[kept], np.full(kept.sum(), TD))
        return sd @ h0, sd

    every = np.ones(len(AZ), dtype=bool)
    m, sd = travel(every)
    alarm = float(stats.norm.isf(continuity / (4 * len(AZ))))
    n = len(AZ)
    rest = n * (n - 1) / 2 * p_sat**2 + (n * p_sat) ** 3 / 6
    for axis, level in ((0, float(computed.hpl_multi_e_m)), (1, float(computed.hpl_multi_n_m))):

        def spread(a: np.ndarray, b: np.ndarray) -> float:
            return float(np.sqrt((a @ p0 @ a.T + TD**2 * b @ b.T)[axis, axis]))  # noqa: B023 - called at once

        total = 2 * stats.norm.sf((level - bias * np.abs((m @ s0)[axis]).sum()) / spread(m, sd))
        for i in range(n):
            mk, sdk = travel(np.arange(n) != i)
            threshold = alarm * spread(mk - m, sdk - sd) + bias * np.abs(((mk - m) @ s0)[axis]).sum()
            total += p_sat * stats.norm.sf((level - threshold - bias * np.abs((mk @ s0)[axis]).sum()) / spread(mk, sdk))
        # A level wrong by 1e-9 m moves the sum by 1e-9 times a hazard near 6 / 0.3 m.
        assert abs(total / ((allotted - rest) / 2) - 1.0) < 1e-6


def test_too_few_satellites_and_a_budget_that_cannot_be_met_are_results() -> None:
    few = rraim.protection_levels(AZ[:4], EL[:4], AZ_NOW[:4], EL_NOW[:4], TD)
    assert few.status == "not_available"
    assert "satellites are needed" in str(few.reason)
    assert np.isnan(few.hpl_m)
    # Five satellites: with two away four are not left, so pairs cannot be monitored and are likelier than the budget.
    five = rraim.protection_levels(AZ[:5], EL[:5], AZ_NOW[:5], EL_NOW[:5], TD, p_sat={0: 1e-4})
    assert five.status == "ok"
    assert np.isnan(five.hpl_multi_m)
    assert "cannot be monitored" in str(five.multi_reason)
    assert np.isfinite(five.hpl_m)


@pytest.mark.parametrize(
    ("settings", "argument"),
    [
        ({"p_sat": {0: 1.0}}, "p_sat"),
        ({"p_sat": {7: 0.1}}, "p_sat"),
        ({"p_const": {0: -1.0}}, "p_const"),
        ({"p_threshold": np.nan}, "p_threshold"),
        ({"continuity_risk": 0.0}, "continuity_risk"),
        ({"allotted_risk": 2.0}, "allotted_risk"),
        ({"bias_m": -1.0}, "bias_m"),
        ({"ordering": "best"}, "ordering"),
        ({"form": "best"}, "form"),
        ({"sigma_m": 0.3}, "sigma_m"),
        ({"constellation": [0, 1]}, "constellation"),
    ],
)
def test_bad_input_is_refused_by_name(settings: dict[str, object], argument: str) -> None:
    with pytest.raises(InputError) as refusal:
        levels(**settings)
    assert refusal.value.argument == argument


def test_a_phase_without_a_sigma_is_refused() -> None:
    with pytest.raises(InputError, match="sigma_td_m"):
        rraim.protection_levels(AZ, EL, AZ_NOW, EL_NOW, 0.0)
