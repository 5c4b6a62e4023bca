"""GBAS protection levels, error models and monitors through the public functions; reference numbers stand in vectors/gbas-*.toml."""

from __future__ import annotations

import itertools
import math
from typing import Literal

import numpy as np
import pytest

from navbound import InputError, gbas

AZ = np.radians([10.0, 60.0, 120.0, 180.0, 230.0, 290.0, 330.0])
EL = np.radians([70.0, 25.0, 40.0, 15.0, 55.0, 20.0, 35.0])


def responses(service: Literal["D", "F"] = "D") -> np.ndarray:
    """S of the whole normal equation, position rows only."""
    h = np.column_stack([-np.cos(EL) * np.sin(AZ), -np.cos(EL) * np.cos(AZ), -np.sin(EL), np.ones(len(AZ))])
    w = np.diag(gbas.range_sigma(EL, service).sigma_m ** -2)
    return np.asarray((np.linalg.inv(h.T @ w @ h) @ h.T @ w)[:3])


def tail(x: float) -> float:
    return 0.5 * math.erfc(x / math.sqrt(2.0))


def test_levels_are_those_of_the_whole_normal_equation() -> None:
    s = responses()
    sigma = gbas.range_sigma(EL, "D")
    levels = gbas.protection_levels(AZ, EL, bias_m=0.3)
    p = (s * sigma.sigma_m**2) @ s.T
    assert np.abs(levels.covariance_enu_m2 - p).max() < 1e-13  # two ways of solving four equations of condition 1e2
    signs = np.array(list(itertools.product((-1, 1), repeat=len(AZ))))
    worst = np.linalg.norm(signs @ s[:2].T, axis=1).max()
    assert abs(levels.bias_gain_exact - worst) < 1e-13
    k = gbas.factors(1.25e-9)
    assert abs(levels.hpl_h0_m - (k.k_ffmd * np.sqrt(np.linalg.eigvalsh(p[:2, :2])[-1]) + 0.3 * worst)) < 1e-12


def test_b_values_move_the_level_of_a_faulty_receiver_only() -> None:
    b = np.random.default_rng(3).normal(0.0, 0.1, (4, len(AZ)))
    plain, moved = gbas.protection_levels(AZ, EL), gbas.protection_levels(AZ, EL, b_values_m=b)
    shift = np.linalg.norm(responses()[:2] @ b.T, axis=0).max()
    assert abs(moved.hpl_h1_m - plain.hpl_h1_m - shift) < 1e-13
    assert moved.hpl_h0_m == plain.hpl_h0_m


def test_an_aided_covariance_replaces_the_solutions_and_scales_the_faulty_one() -> None:
    plain = gbas.protection_levels(AZ, EL)
    aided = gbas.protection_levels(AZ, EL, aided_covariance_m2=4.0 * plain.covariance_enu_m2)
    for name in ("hpl_h0_m", "hpl_h1_m", "sigma_m", "accuracy_m"):
        # Twice the deviation, without bias: twice everything; an eigenvalue rounds.
        assert abs(getattr(aided, name) / getattr(plain, name) - 2.0) < 1e-14
    assert aided.sigma_major_m == plain.sigma_major_m


def test_the_literal_sum_is_never_smaller() -> None:
    major, norm = (gbas.protection_levels(AZ, EL, form=form) for form in ("major", "norm"))
    assert norm.hpl_h0_m > major.hpl_h0_m
    assert norm.sigma_norm_m == major.sigma_norm_m


def test_skies_broadcast_and_a_poor_one_is_a_status() -> None:
    az, el = np.tile(AZ, (3, 1)), np.tile(EL, (3, 1))
    az[1, 3:], el[1, 3:] = np.nan, np.nan
    levels = gbas.protection_levels(az, el, bias_m=[0.0, 0.1, 0.2])
    assert levels.status.tolist() == ["ok", "not_available", "ok"]
    assert "4 satellites are needed, 3 are usable" in levels.reason[1]
    assert np.isnan(levels.hpl_m[1])
    assert levels.hpl_m[2] > levels.hpl_m[0]
    assert levels.n_sv.tolist() == [7, 3, 7]
    assert levels.covariance_enu_m2.shape == (3, 3, 3)


def test_two_constellations_pay_for_two_clocks() -> None:
    one, two = (gbas.protection_levels(AZ, EL, systems) for systems in (None, [0, 2, 0, 2, 0, 0, 0]))
    assert two.hpl_m > one.hpl_m


def test_the_missed_detection_limit_keeps_the_risk() -> None:
    numbers = {"containment_m": 4.5, "sigma_tse_m": 0.36, "projection": 2.0, "allotted_risk": 4.7e-10, "p_fault": 5e-6, "bias_hor_m": 0.4}
    for error in (0.5, 1.2, 1.8, 2.5, 6.0):
        limit = float(gbas.missed_detection_limit(error, **numbers))
        moved = 2.0 * error + 0.4
        beyond = tail((4.5 - moved) / 0.36) + tail((4.5 + moved) / 0.36)
        assert limit <= 1.0
        if limit < 1.0:
            assert abs(limit * beyond * 5e-6 / 4.7e-10 - 1.0) < 1e-12  # a product of three and a tail of 1e-16
        else:
            assert beyond * 5e-6 <= 4.7e-10
    margin = float(gbas.monitor_margin(service="D", **numbers))
    errors = np.linspace(0.0, 6.0, 60_001)
    ratio = np.log10(gbas.missed_detection_limit(errors, **numbers) / gbas.missed_by_monitor(errors, "D"))
    # Where the limit is 1 it is capped, so the scan is at most the margin; steps of 0.1 mm on a side of 40 decades a metre.
    assert -5e-3 < min(margin, 0.0) - min(float(ratio.min()), 0.0) < 5e-3


def test_the_bound_of_correlated_noise_bounds() -> None:
    for tau in (54.0, 100.0, 200.0, 500.0, 1000.0, 2894.0):
        filtered, true = gbas.offset_variances(tau)
        assert (filtered >= true).all()
        assert abs(filtered[900] - 1.954) < 3e-3  # printed for 900 s; white noise it does not state lifts 1.952
        assert true[900] < 0.996  # "at most 0.991"
    assert filtered[0] == pytest.approx(2 / (1 + 54 / 2894), rel=1e-7)  # the first sample, seen from a prior of 1e8 m²


def test_only_the_papers_noise_gains_from_an_inertial_system() -> None:
    snapshot = gbas.protection_levels(AZ, EL).covariance_enu_m2
    paper, bound = (gbas.aided_covariance(AZ, EL, lat_rad=0.72, noise=noise) for noise in ("paper", "bound"))
    assert np.trace(paper) < np.trace(snapshot) < np.trace(bound) / 4


def test_every_inferred_number_carries_its_mark() -> None:
    for phase in gbas.sub_phases().values():
        provenance = {m.name: m.held for m in phase.marks}
        assert provenance["containment"] == provenance["hal"] == provenance["integrity"] == provenance["continuity"] == "inferred"
        assert provenance["speed"] == "ours"
    assert {m.name: m.held for m in gbas.monitor_curves()["F"].marks}["curve"] == "inferred"
    assert {m.name: m.held for m in gbas.carriers()["dual"].marks}["clock"] == "inferred"
    assert {m.name: m.held for m in gbas.allocation().marks}["coasting"] == "inferred"


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: gbas.protection_levels(AZ, -EL), "el_rad"),
        (lambda: gbas.protection_levels(AZ, EL, service="E"), "service"),  # type: ignore[arg-type]
        (lambda: gbas.protection_levels(AZ, EL, bias_m=-0.1), "bias_m"),
        (lambda: gbas.protection_levels(AZ, EL, bias_m=np.nan), "bias_m"),
        (lambda: gbas.protection_levels(AZ, EL, bias_m=[0.1, 0.2]), "bias_m"),
        (lambda: gbas.protection_levels(AZ, EL, ordering="best"), "ordering"),  # type: ignore[arg-type]
        (lambda: gbas.protection_levels(AZ, EL, form="best"), "form"),  # type: ignore[arg-type]
        (lambda: gbas.protection_levels(AZ, EL, sigma_m=0.3), "sigma_m"),
        (lambda: gbas.protection_levels(AZ, EL, sigma_m=0.3, sigma_h1_m=0.2), "sigma_h1_m"),
        (lambda: gbas.protection_levels(AZ, EL, sigma_m=0.0, sigma_h1_m=0.2), "sigma_m"),
        (lambda: gbas.protection_levels(AZ, EL, b_values_m=np.zeros(7)), "b_values_m"),
        (lambda: gbas.protection_levels(AZ, EL, b_values_m=np.full((4, 7), np.nan)), "b_values_m"),
        (lambda: gbas.protection_levels(AZ, EL, aided_covariance_m2=-np.eye(3)), "covariance"),
        (lambda: gbas.protection_levels(AZ, EL, aided_covariance_m2=np.eye(2)), "aided_covariance_m2"),
        (lambda: gbas.protection_levels(AZ, EL, [0, 1]), "constellation"),
        (lambda: gbas.protection_levels(AZ, EL, [9] * 7), "constellation"),
        (lambda: gbas.protection_levels([], []), "az_rad"),
        (lambda: gbas.factors(0.0), "integrity_risk"),
        (lambda: gbas.factors(1e-9, receiver_fault=0.0), "receiver_fault"),
        (lambda: gbas.factors(1e-9, axes=-1), "axes"),
        (lambda: gbas.accuracy_limit(0.5), "containment_m"),
        (lambda: gbas.carrier_sigma(0.5, -1.0, 10.0, gbas.carriers()["dual"]), "speed_mps"),
        (lambda: gbas.bias_gain(np.ones((49, 2))), "east_north"),
        (lambda: gbas.fault_probability(1, -1.0), "rate_per_hour"),
        (lambda: gbas.missed_by_monitor(1.0, "F", stretch=0.0), "stretch"),
        (lambda: gbas.aided_covariance(np.full(3, np.nan), np.full(3, np.nan), lat_rad=0.7), "n_sv"),
        (lambda: gbas.offset_variances(-1.0), "true_constant_s"),
        (lambda: gbas.offset_variances(60.0, shortest_s=100.0, longest_s=50.0), "shortest_s"),
    ],
)
def test_bad_input_is_refused_by_name(call, argument: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as refusal:
        call()
    assert refusal.value.argument == argument
