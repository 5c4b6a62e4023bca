"""ARAIM: the reference cases, the downdates against whole inversions, what a geometry cannot do, and what is refused."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from navbound import araim, gnss
from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

REFERENCE = Path(__file__).parents[1].parent / "shared" / "reference" / "ref-araim.json"
GPS, GALILEO = 0, 2


def sky(n: int, seed: int = 1) -> NDArray[np.float64]:
    """Lines of sight above five degrees, seeded."""
    rng = np.random.default_rng(seed)
    az, el = rng.uniform(0, 2 * math.pi, n), np.arcsin(rng.uniform(math.sin(math.radians(5)), 1, n))
    return np.stack([np.cos(el) * np.sin(az), np.cos(el) * np.cos(az), np.sin(el)], axis=-1)


def test_the_simulator_and_the_published_example_are_met() -> None:
    if not REFERENCE.is_file():
        pytest.skip(f"{REFERENCE} is not here")
    cases = json.loads(REFERENCE.read_text())["araim_cases"]
    assert len(cases) == 17
    for case in cases:
        g = np.array(case["G"])
        systems = np.array([GPS, GALILEO])[np.argmax(g[:, 3:], axis=1)]
        p_const = [1e-8] * 5
        for system, p in zip((GPS, GALILEO), case["p_const"], strict=False):
            p_const[system] = p
        levels = araim.protection_levels(
            -g[:, :3],
            systems,
            np.sqrt(case["sig2_int"]),
            np.sqrt(case["sig2_acc"]),
            bias_m=case["b_nom"],
            bias_continuity_m=case["b_cont"],
            p_sat=case["p_sat"],
            p_const=p_const,
            service="lpv-200" if case["settings"]["name"].startswith("LPV") else "horizontal",
        )
        maast = case["expected_maast"]
        assert levels.n_modes == maast["n_modes"], case["id"]
        # Printed to ten digits, and found there by subtracting from one.
        assert abs(levels.p_unmonitored - maast["p_not_monitored"]) <= 1e-9 * maast["p_not_monitored"] + 4e-15, case["id"]
        if maast["vpl"] is None:
            assert np.isposinf(levels.vpl_m)
            assert np.isposinf(levels.hpl_m)
            assert levels.status == "not_monitored"
            continue
        # Its ten bisections leave up to 4 mm; the specification allows 10.
        for name, key in (("vpl_m", "vpl"), ("hpl_m", "hpl"), ("emt_m", "emt"), ("sigma_acc_u_m", "sig_acc_v")):
            assert abs(float(getattr(levels, name)) - maast[key]) <= 0.01, (case["id"], name)


def independent(unit: NDArray[np.float64], systems: NDArray[np.int64], sigma: NDArray[np.float64], bias: float, p_sat: float) -> float:
    """VPL of the published equations with every subset inverted anew and the root by bisection: no shortcut of the core."""
    service = araim.SERVICES["lpv-200"]
    n = len(unit)

    def gains(out: set[int]) -> NDArray[np.float64] | None:
        kept = [i for i in range(n) if i not in out]
        clocks = sorted({int(systems[i]) for i in kept})
        h = np.array([[*-unit[i], *(float(systems[i] == c) for c in clocks)] for i in kept])
        if len(kept) < max(h.shape[1], 4):
            return None
        w = 1 / sigma[kept] ** 2
        s = np.zeros((3, n))
        s[:, kept] = (np.linalg.inv(h.T @ (h * w[:, None])) @ (h.T * w))[:3]
        return s

    clocks = sorted(set(systems.tolist()))
    p_const = {c: araim.SUPPORT.p_const[c] for c in clocks}
    events = [(p_sat, frozenset([i])) for i in range(n)] + [(p_const[c], frozenset(np.flatnonzero(systems == c).tolist())) for c in clocks]
    odds = [p / (1 - p) for p, _ in events]
    none = math.prod(1 - p for p, _ in events)
    modes: dict[frozenset[int], float] = {frozenset(): none}
    for size in (1, 2):
        for selected in combinations(range(len(events)), size):
            out = frozenset().union(*(events[k][1] for k in selected))
            modes[out] = modes.get(out, 0.0) + none * math.prod(odds[k] for k in selected)
    rest = 1 - math.fsum(modes.values())
    for _, whole in events[n:]:
        limit = 0.01 * modes[whole]
        for out in [m for m in modes if m and m < whole and modes[m] < limit]:
            modes[whole] += modes.pop(out)
    left = rest + math.fsum(p for p in modes.values() if p <= 1e-7)
    monitored: list[tuple[float, NDArray[np.float64]]] = []
    for out, p in sorted(modes.items(), key=lambda m: len(m[0])):
        if p <= 1e-7:
            if left <= service.unmonitored:
                continue
            left -= p
        s = gains(set(out))
        if s is None:
            left += p
        else:
            monitored.append((p, s))
    all_in = monitored[0][1]
    z = _quantile(service.false_alarm_v / 2 / (len(monitored) - 1))
    terms = [
        (
            2.0 if k == 0 else p,
            z * math.sqrt(((s[2] - all_in[2]) ** 2 * sigma**2).sum()) + bias * np.abs(s[2]).sum(),
            math.sqrt((s[2] ** 2 * sigma**2).sum()),
        )
        for k, (p, s) in enumerate(monitored)
    ]
    budget = service.integrity_v * (1 - left / (service.integrity_v + service.integrity_h))
    low, high = 0.0, 1000.0
    for _ in range(60):
        x = (low + high) / 2
        total = sum(w * (0.5 * math.erfc((x - t) / s / math.sqrt(2)) if x >= t else 1.0) for w, t, s in terms)
        low, high = (x, high) if total > budget else (low, x)
    return high


def _quantile(q: float) -> float:
    low, high = 0.0, 40.0
    for _ in range(80):
        x = (low + high) / 2
        low, high = (x, high) if 0.5 * math.erfc(x / math.sqrt(2)) > q else (low, x)
    return low


@pytest.mark.parametrize(("n", "p_sat"), [(9, 1e-5), (12, 1e-4), (16, 3e-5), (18, 1e-4)])
def test_downdates_agree_with_a_new_inversion_for_every_mode(n: int, p_sat: float) -> None:
    unit = sky(n, seed=n)
    systems = np.where(np.arange(n) < n // 2, GPS, GALILEO)
    sigma = np.linspace(0.8, 2.5, n)
    levels = araim.protection_levels(unit, systems, sigma, sigma, bias_m=0.5, p_sat=p_sat)
    # Bisection to 1000 / 2^60 m; conditions of these geometries are below 1e4, so the gains agree to 1e-11.
    assert abs(float(levels.vpl_m) - independent(unit, systems, sigma, 0.5, p_sat)) <= 1e-7 * float(levels.vpl_m)


def test_levels_grow_with_noise_bias_and_priors_and_ignore_the_order_of_epochs() -> None:
    unit = np.stack([sky(16, seed) for seed in range(40)])
    systems = np.repeat([GPS, GALILEO], 8)
    base = araim.protection_levels(unit, systems, 1.2, 1.0)
    ok = base.status == "ok"
    assert ok.sum() > 30
    for worse in (
        araim.protection_levels(unit, systems, 1.5, 1.25),
        araim.protection_levels(unit, systems, 1.2, 1.0, bias_m=1.0),
        araim.protection_levels(unit, systems, 1.2, 1.0, p_const=[1e-3] * 5),
    ):
        assert (worse.hpl_m[ok] > base.hpl_m[ok]).all()
        assert (worse.vpl_m[ok] > base.vpl_m[ok]).all()
    backwards = araim.protection_levels(unit[::-1], systems, 1.2, 1.0)
    assert np.array_equal(backwards.vpl_m[::-1], base.vpl_m, equal_nan=True)


def test_turning_north_leaves_the_vertical_and_scaling_scales_all() -> None:
    unit, systems = sky(14, 5), np.repeat([GPS, GALILEO], 7)
    base = araim.protection_levels(unit, systems, 1.2, 1.0)
    c, s = math.cos(0.7), math.sin(0.7)
    turned = araim.protection_levels(unit @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]), systems, 1.2, 1.0)
    # Roots are exact to 1e-9 m, and rotated vectors to the last digit.
    assert abs(turned.vpl_m - base.vpl_m) <= 1e-8
    assert abs(turned.sigma_acc_u_m - base.sigma_acc_u_m) <= 1e-12
    doubled = araim.protection_levels(unit, systems, 2.4, 2.0, bias_m=2 * 0.75)
    assert abs(doubled.hpl_m - 2 * base.hpl_m) <= 1e-8
    assert abs(doubled.emt_m - 2 * base.emt_m) <= 1e-11


def test_what_the_sky_cannot_give_is_a_status() -> None:
    unit = np.full((4, 8, 3), np.nan)
    unit[0, :3] = sky(3)
    unit[1, :8] = sky(8)
    cone = np.linspace(0, 2 * math.pi, 8, endpoint=False)
    unit[2] = np.stack([np.cos(cone) * 0.8, np.sin(cone) * 0.8, np.full(8, 0.6)], axis=-1)
    unit[3, :4] = sky(4)
    levels = araim.protection_levels(unit, [GPS] * 8, 1.0, 1.0, p_const=[1e-8] * 5)
    assert levels.status.tolist() == ["too_few_satellites", "ok", "singular", "not_monitored"]
    assert np.isnan(levels.hpl_m[[0, 2]]).all()
    assert np.isposinf(levels.hpl_m[3])
    assert levels.n_sv.tolist() == [3, 8, 8, 4]
    many = araim.protection_levels(sky(70), [GPS] * 70, 1.0, 1.0)
    assert many.status == "too_many"
    assert np.isnan(many.hpl_m)
    # Priors under which nearly every pair, and more, must be monitored.
    likely = araim.protection_levels(sky(60), [GPS] * 60, 1.0, 1.0, p_sat=0.01)
    assert likely.status == "too_many"


def test_what_cannot_be_meant_is_refused_by_name() -> None:
    unit, systems = sky(8), [GPS] * 8
    good: dict[str, Any] = {"unit_enu": unit, "constellation": systems, "sigma_int_m": 1.0, "sigma_acc_m": 1.0}
    spent = araim.Service(1e-9, 1e-9, 1e-6, 1e-6, unmonitored=8e-8)
    changes: list[tuple[dict[str, Any], str]] = [
        ({"p_sat": 0.0}, "p_sat"),
        ({"p_sat": 1.0}, "p_sat"),
        ({"p_sat": math.nan}, "p_sat"),
        ({"p_const": [0.0] * 5}, "p_const"),
        ({"p_const": [1e-4]}, "p_const"),
        ({"sigma_int_m": -1.0}, "sigma_int_m"),
        ({"sigma_acc_m": math.inf}, "sigma_acc_m"),
        ({"bias_m": -0.1}, "bias_m"),
        ({"unit_enu": 2 * unit}, "unit"),
        ({"unit_enu": unit[:, :2]}, "unit_enu"),
        ({"constellation": [9] * 8}, "constellation"),
        ({"constellation": [0] * 7}, "constellation"),
        ({"service": "cat-iii"}, "service"),
        ({"service": spent}, "unmonitored"),
        ({"service": araim.Service(0.0, 1e-9, 1e-6, 1e-6, 1e-10)}, "integrity_v"),
    ]
    for change, name in changes:
        with pytest.raises(InputError) as refusal:
            araim.protection_levels(**{**good, **change})
        assert refusal.value.argument == name


def test_a_refusal_shows_the_number_of_the_input() -> None:
    unit = sky(8)

    def refused(**change: Any) -> InputError:
        good: dict[str, Any] = {"unit_enu": unit, "constellation": [GPS] * 8, "sigma_int_m": 1.0, "sigma_acc_m": 1.0}
        with pytest.raises(InputError) as refusal:
            araim.protection_levels(**{**good, **change})
        return refusal.value

    assert refused(sigma_int_m=-0.5).value == -0.5
    # Only constellations in use need a prior; the one refused is named by its index.
    refusal = refused(constellation=[GALILEO] * 8, p_const=[0.0, 0.0, 1.5, 0.0, 0.0])
    assert (refusal.argument, refusal.index, refusal.value) == ("p_const", GALILEO, 1.5)
    refusal = refused(constellation=[GPS] * 7 + [9])
    assert (refusal.argument, refusal.index, refusal.value) == ("constellation", 7, 9)
    assert refused(unit_enu=np.zeros((0, 3)), constellation=[]).argument == "unit_enu"


def test_more_decisions_than_can_be_weighed_are_reported() -> None:
    # 16 satellites of which any two fail together more often than the integrity risk: 136 decisions, and room for 72.
    levels = araim.protection_levels(sky(16), [GPS] * 16, 1.0, 1.0, p_sat=1e-3, exclusion=True)
    assert levels.status == "too_many"


def test_only_faults_with_a_share_of_the_risk_are_excluded() -> None:
    unit, systems = sky(16, 13), [GPS] * 8 + [GALILEO] * 8
    residual = np.where(np.arange(16) < 8, np.random.default_rng(13).normal(0, 60, 16), 0.0)
    # Little may be left unmonitored, so that the fault of all GPS is a mode in both cases, and its separation is the largest.
    service = replace(araim.SERVICES["lpv-200"], unmonitored=1e-9)
    settings: dict[str, Any] = {"sigma_int_m": 1.0, "sigma_acc_m": 1.0, "p_sat": 1e-6, "service": service}
    likely = araim.monitor(unit, systems, residual, p_const=[1e-4, 1e-9, 1e-9, 1e-9, 1e-9], **settings)
    assert likely.decision == "excluded"
    assert likely.excluded.tolist() == [True] * 8 + [False] * 8
    # Less likely than the integrity risk of 1e-7: more modes, so a little more false-alarm multiplier, and no share for this decision.
    rare = araim.monitor(unit, systems, residual, p_const=[9e-8, 1e-9, 1e-9, 1e-9, 1e-9], **settings)
    assert abs(rare.worst_ratio / likely.worst_ratio - 1.0) < 0.01
    assert rare.decision == "not_excluded"


def test_shipped_configurations_say_where_they_come_from() -> None:
    assert set(araim.SERVICES) == {"lpv-200", "horizontal"}
    configurations: list[araim.Service | araim.Support] = [*araim.SERVICES.values(), araim.SUPPORT]
    for configured in configurations:
        assert configured.source
        assert configured.provenance in {"standard", "inferred"}
    assert len(araim.SUPPORT.p_const) == len(gnss.CONSTELLATIONS)


def test_the_published_equation_of_raim_is_met_by_whole_inversions() -> None:
    unit, sigma = sky(9, 3), np.linspace(1.0, 3.0, 9)
    computed = araim.protection_levels(unit, [GPS] * 9, sigma, sigma, service="raim")
    h = np.column_stack([-unit, np.ones(9)])

    def gains(kept: list[int]) -> NDArray[np.float64]:
        w = 1 / sigma[kept] ** 2
        s = np.zeros((3, 9))
        s[:, kept] = (np.linalg.inv(h[kept].T @ (h[kept] * w[:, None])) @ (h[kept].T * w))[:3]
        return s

    full = gains(list(range(9)))
    k_fa, k_md, k_ff = _quantile(araim.RAIM.false_alarm / 18), _quantile(araim.RAIM.missed_detection), _quantile(araim.RAIM.fault_free / 2)
    hpl, vpl = [k_ff * np.sqrt((full[:2] ** 2 * sigma**2).sum())], [k_ff * np.sqrt((full[2] ** 2 * sigma**2).sum())]
    for i in range(9):
        s = gains([j for j in range(9) if j != i])
        for levels, axes in ((hpl, slice(0, 2)), (vpl, slice(2, 3))):
            separation = np.sqrt(((s[axes] - full[axes]) ** 2 * sigma**2).sum())
            levels.append(k_fa * separation + k_md * np.sqrt((s[axes] ** 2 * sigma**2).sum()))
    # Bisections of the quantiles to 1e-12, and inversions of matrices whose condition is below 1e3.
    assert abs(computed.hpl_m - max(hpl)) <= 1e-9 * max(hpl)
    assert abs(computed.vpl_m - max(vpl)) <= 1e-9 * max(vpl)
    # Five satellites detect and cannot exclude.
    five = araim.protection_levels(sky(5, 2), [GPS] * 5, 1.0, 1.0, service="raim")
    excluding = araim.protection_levels(sky(5, 2), [GPS] * 5, 1.0, 1.0, service="raim", exclusion=True)
    assert five.status == "ok"
    assert excluding.status == "not_monitored"


def test_a_faulty_satellite_is_identified_and_the_error_stays_inside_the_levels() -> None:
    """Seeded noise of half the integrity sigma; a fault of 60 m on every satellite in turn, then on a whole constellation."""
    unit, systems = sky(18, 11), np.repeat([GPS, GALILEO], 9)
    rng = np.random.default_rng(7)
    noise = rng.normal(0.0, 0.5, (19, 18)) + np.where(systems == GPS, 1234.5, -321.0)
    fault = np.vstack([60.0 * np.eye(18), np.zeros(18)])
    levels = araim.monitor(unit, systems, noise + fault, 1.0, 0.7)
    assert levels.decision.tolist() == ["excluded"] * 18 + ["none"]
    assert np.array_equal(levels.excluded[:18], np.eye(18, dtype=bool))
    assert (np.hypot(levels.step_enu_m[:, 0], levels.step_enu_m[:, 1]) < levels.levels.hpl_m).all()
    assert (np.abs(levels.step_enu_m[:, 2]) < levels.levels.vpl_m).all()
    assert (levels.worst_ratio[:18] > 1).all()
    assert levels.worst_ratio[18] <= 1
    assert levels.levels.n_sv.tolist() == [18] * 19
    # Errors of a constellation that no clock explains: a shift of the position that all its ranges share.
    shared = noise[18] + np.where(systems == GALILEO, unit @ np.array([40.0, -30.0, 60.0]), 0.0)
    whole = araim.monitor(unit, systems, shared, 1.0, 0.7)
    assert whole.decision == "excluded"
    assert np.array_equal(whole.excluded, systems == GALILEO) or np.array_equal(whole.excluded, systems == GPS)
    # Without redundancy beyond detection nothing can be excluded.
    small, of = sky(5, 2), [GPS] * 5
    lost = araim.monitor(small, of, [0, 0, 1000.0, 0, 0], 1.0, 1.0, p_const=[1e-9] * 5)
    assert lost.decision == "not_excluded"


def test_residuals_that_are_none_are_refused() -> None:
    unit = sky(8)
    with pytest.raises(InputError, match="residual_m"):
        araim.monitor(unit, [GPS] * 8, [math.nan] * 8, 1.0, 1.0)
    with pytest.raises(InputError, match="service"):
        araim.monitor(unit, [GPS] * 8, 0.0, 1.0, 1.0, service="raim")


@pytest.mark.parametrize("service", ["lpv-200", "horizontal", "raim"])
def test_a_prediction_is_that_of_its_geometry_and_exclusion_costs(service: str) -> None:
    orbits = gnss.constellation("gps") + gnss.constellation("galileo")
    lat, lon, time = np.radians([-60.0, 5.0, 47.0]), np.radians([10.0, 100.0, -120.0]), np.array([0.0, 9000.0])
    levels = araim.predict(orbits, lat, lon, 0.0, time, service=service)
    assert levels.hpl_m.shape == (2, 3)
    az, el = gnss.directions(orbits, lat, lon, 0.0, time[:, None])
    seen = el >= math.radians(5)
    unit = np.where(seen[..., None], np.stack([np.cos(el) * np.sin(az), np.cos(el) * np.cos(az), np.sin(el)], axis=-1), np.nan)
    model = araim.ERROR_MODELS["dual-frequency"]
    a, b, scale = model.noise
    local = (a + b * np.exp(-el / scale)) ** 2 + (0.12 * 1.001) ** 2 / (0.002001 + np.sin(el) ** 2)
    sigma = [np.sqrt(np.array(c)[orbits.constellation] ** 2 + local) for c in (araim.SUPPORT.sigma_ura_m, araim.SUPPORT.sigma_ure_m)]
    computed = araim.protection_levels(unit, orbits.constellation, *sigma, service=service)
    # Angles and back cost a few units in the last place of vectors of 1, and gains up to 10.
    np.testing.assert_allclose(levels.vpl_m, computed.vpl_m, rtol=1e-9)
    np.testing.assert_allclose(levels.hpl_m, computed.hpl_m, rtol=1e-9)
    assert np.array_equal(levels.n_sv, computed.n_sv)
    with_exclusion = araim.predict(orbits, lat, lon, 0.0, time, service=service, exclusion=True)
    assert (with_exclusion.hpl_m > levels.hpl_m).all()
    assert (with_exclusion.vpl_m > levels.vpl_m).all()


def test_the_recorded_day_stays_inside_its_levels(shared_data: Path) -> None:
    folder = shared_data / "gnss" / "ESBC_2020_177"
    observations = gnss.read_observations(folder / "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz")
    navigation = gnss.read_navigation(folder / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz")
    truth = json.loads((shared_data / "baselines.json").read_text(encoding="utf-8"))["ESBC_2020_177"]["reference_ecef_m"]
    levels = araim.watch(observations, navigation, truth_ecef_m=truth)
    epochs = levels.epochs
    assert epochs.height == 2880
    with_levels = epochs.drop_nulls(["hpl_m", "nse_e_m"])
    assert with_levels.height > 0.99 * 2880
    hpe = np.hypot(with_levels["nse_e_m"].to_numpy(), with_levels["nse_n_m"].to_numpy())
    assert (hpe < with_levels["hpl_m"].to_numpy()).all()
    assert (with_levels["nse_u_m"].abs() < with_levels["vpl_m"]).all()
    assert "inferred" in levels.models["promises of satellites"]
    with pytest.raises(InputError, match="systems"):
        araim.watch(observations, navigation, systems="X")
