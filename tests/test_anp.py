"""navbound.anp as a caller meets it: shapes, refusals, the relations its documentation states."""

from __future__ import annotations

import math

import numpy as np
import pytest

from navbound import InputError, anp

TILTED = np.array([[4.0, -5.0, 3.2], [-5.0, 9.0, 7.0], [3.2, 7.0, 64.0]])
FLAT = TILTED[:2, :2]
EQUAL = np.eye(3)


def test_arrays_broadcast_over_leading_axes() -> None:
    covariances = np.stack([FLAT, 4 * FLAT, 9 * FLAT])[:, np.newaxis]
    risks = np.array([0.5, 0.05])
    radii = anp.circle(covariances, risks)
    assert radii.shape == (3, 2)
    # Eight lanes, one lane and a search that is not prepared for one risk give the same bits.
    for i in range(3):
        for j in range(2):
            assert radii[i, j] == anp.circle(covariances[i, 0], risks[j])
    assert anp.sphere(TILTED, 0.05).shape == ()
    assert anp.ellipsoid(np.stack([TILTED] * 4), 0.05).axes.shape == (4, 3, 3)


def test_a_batch_gives_the_bits_of_single_calls() -> None:
    rng = np.random.default_rng(5)
    root = rng.normal(size=(1043, 3, 3))
    covariances = root @ root.swapaxes(-1, -2)
    batch = anp.sphere(covariances, 0.05)
    single = np.array([anp.sphere(v, 0.05) for v in covariances])
    assert np.array_equal(batch, single)


def test_an_empty_batch_is_empty() -> None:
    assert anp.circle(np.empty((0, 2, 2)), 0.05).shape == (0,)
    assert anp.ellipsoid(np.empty((0, 3, 3)), 0.05).semi_axes_m.shape == (0, 3)


@pytest.mark.parametrize("risk", [0.0, 1.0, -0.1, 1.5, math.nan, math.inf])
def test_a_risk_outside_the_unit_interval_is_refused(risk: float) -> None:
    for call in (
        lambda: anp.circle(FLAT, risk),
        lambda: anp.sphere(TILTED, risk, [1.0, 0.0, 0.0]),
        lambda: anp.along(TILTED, [1.0, 0.0, 0.0], risk),
        lambda: anp.ellipsoid(TILTED, risk),
        lambda: anp.chi_factor(3, risk),
        lambda: anp.box_factor(TILTED, risk),
        lambda: anp.rectangle_scale(FLAT, 1.0, 1.0, risk),
        lambda: anp.cylinder_scale(TILTED, 1.0, 1.0, risk),
        lambda: anp.sphere_grubbs(TILTED, risk),
        lambda: anp.circle_fit(FLAT, risk),
    ):
        with pytest.raises(InputError) as refused:
            call()
        assert refused.value.argument == "risk"


BAD = {
    "asymmetric": [[1.0, 0.5], [0.4, 1.0]],
    "indefinite": [[1.0, 2.0], [2.0, 1.0]],
    "negative": [[-1.0, 0.0], [0.0, 1.0]],
    "nan": [[math.nan, 0.0], [0.0, 1.0]],
    "infinite": [[math.inf, 0.0], [0.0, 1.0]],
}


@pytest.mark.parametrize("kind", BAD)
def test_what_is_no_covariance_is_refused_by_place(kind: str) -> None:
    stack = np.stack([np.eye(2), np.eye(2), np.array(BAD[kind]), np.array(BAD[kind])])
    for call in (
        lambda: anp.circle(stack, 0.05),
        lambda: anp.circle(stack, 1e-8),
        lambda: anp.circle(stack, 0.05, [1.0, 0.0]),
        lambda: anp.circle_law(stack, 1.0),
        lambda: anp.circle_fit(stack),
        lambda: anp.cep(stack),
    ):
        with pytest.raises(InputError) as refused:
            call()
        assert (refused.value.argument, refused.value.index) == ("covariance_en_m2", 2)


def test_other_wrong_arguments_are_named() -> None:
    for call, argument in (
        (lambda: anp.circle(TILTED, 0.05), "covariance_en_m2"),
        (lambda: anp.sphere(TILTED, 0.05, [0.0, math.nan, 0.0]), "mean_enu_m"),
        (lambda: anp.circle(FLAT, 0.05, [0.0, math.inf]), "mean_en_m"),
        (lambda: anp.sphere(FLAT, 0.05), "covariance_enu_m2"),
        (lambda: anp.along(TILTED, [0.0, 0.0, 0.0], 0.05), "direction"),
        (lambda: anp.circle_law(FLAT, -1.0), "radius_m"),
        (lambda: anp.track(TILTED, math.nan, 0.05), "course_rad"),
        (lambda: anp.track(TILTED, 270.0, 0.05), "course_rad"),
        (lambda: anp.chi_factor(4, 0.05), "dimension"),
        (lambda: anp.rectangle(FLAT, 0.0, 1.0), "half_cross_m"),
        (lambda: anp.rectangle([[1.0, 2.0], [2.0, 1.0]], 1.0, 1.0), "covariance_cu_m2"),
        (lambda: anp.cylinder(TILTED, 1.0, math.nan), "half_height_m"),
        (lambda: anp.circle_fit(FLAT, 0.01), "risk"),
        (lambda: anp.circle_fit_as_printed([[1.0, 0.0], [0.0, 0.0]]), "covariance_en_m2"),
        (lambda: anp.box_factor(np.zeros((3, 3)), 0.05), "covariance_enu_m2"),
    ):
        with pytest.raises(InputError) as refused:
            call()
        assert refused.value.argument == argument


def test_the_simultaneous_box_of_uncorrelated_axes() -> None:
    # Solved by hand: erf(k/sqrt 2)^n = 0.95; the specification prints seven digits (section 2.6).
    assert anp.box_factor(EQUAL, 0.05) == pytest.approx(2.387738, abs=5e-7)
    assert anp.box_factor(np.diag([1.0, 9.0, 0.0]), 0.05) == pytest.approx(2.236477, abs=5e-7)
    assert anp.box(np.diag([1.0, 4.0, 9.0]), 0.05) == pytest.approx(2.387738 * np.array([1, 2, 3]), abs=2e-6)
    # Perfectly correlated axes are one axis.
    assert anp.box_factor(np.ones((3, 3)), 0.05) == pytest.approx(1.9599639845, abs=1e-9)


def test_a_stretched_region_is_left_with_the_risk() -> None:
    mean = [0.5, -1.0, 2.0]
    for risk in (0.5, 0.05, 1e-5, 1e-9):
        s = anp.cylinder_scale(TILTED, 2.0, 3.0, risk, mean)
        assert anp.cylinder_risk(TILTED, 2.0 * s, 3.0 * s, mean) == pytest.approx(risk, rel=1e-9)
        s = anp.rectangle_scale(FLAT, 2.0, 3.0, risk, mean[:2])
        assert anp.rectangle_risk(FLAT, 2.0 * s, 3.0 * s, mean[:2]) == pytest.approx(risk, rel=1e-9)


def test_a_rectangle_of_independent_errors_is_a_product() -> None:
    inside = math.erf(1.5 / math.sqrt(2)) * math.erf(0.5 / math.sqrt(2))
    sides = anp.rectangle(np.diag([4.0, 9.0]), 3.0, 1.5)
    assert sides.inside == pytest.approx(inside, rel=1e-13)
    assert sides.outside == pytest.approx(1 - inside, rel=1e-13)
    flat = anp.rectangle(np.diag([4.0, 0.0]), 3.0, 1.5)
    assert flat.inside == pytest.approx(math.erf(1.5 / math.sqrt(2)), rel=1e-13)


def test_a_singular_ellipsoid_says_why_it_has_no_intercept() -> None:
    plane = anp.ellipsoid([np.diag([4.0, 1.0, 0.0]), EQUAL], 0.05)
    assert np.isnan(plane.intercept_enu_m[0]).all()
    assert "singular" in plane.reason[0]
    assert plane.reason[1] == ""
    assert plane.volume_m3[0] == 0.0
    assert plane.support_enu_m[0] == pytest.approx(2.7954834829151 * np.array([2, 1, 0]), rel=1e-13)
    assert np.isnan(anp.intercept(np.ones((3, 3)), [1.0, 0.0, 0.0], 0.05))


def test_sorted_semi_axes_are_not_east_north_up() -> None:
    # Specification, section 2.6: sigma = (1, 1, 1), rho_EN = 0.9; the short semi-axis taken for an axis of sigma one holds 62 %.
    v = np.array([[1.0, 0.9, 0.0], [0.9, 1.0, 0.0], [0.0, 0.0, 1.0]])
    e = anp.ellipsoid(v, 0.05)
    assert e.semi_axes_m == pytest.approx([3.853, 2.795, 0.884], abs=1e-3)
    assert e.support_enu_m == pytest.approx([2.7955] * 3, abs=1e-4)
    assert math.erf(e.semi_axes_m[2] / math.sqrt(2)) == pytest.approx(0.62, abs=0.005)


def test_track_extents_turn_with_the_course() -> None:
    east = anp.track(TILTED, math.pi / 2, 0.05)
    e = anp.ellipsoid(TILTED, 0.05).support_enu_m
    assert (east.along_m, east.cross_m, east.up_m) == pytest.approx((e[0], e[1], e[2]), rel=1e-14)


def test_names_of_other_makers_are_the_same_number() -> None:
    assert anp.epu(FLAT) == anp.circle(FLAT, 0.05)
    assert anp.vepu(TILTED) == anp.marginal(TILTED, [0.0, 0.0, 1.0], 0.05)
    assert anp.vepu(TILTED) == pytest.approx(8 * 1.9599639845400545, rel=1e-15)


RULES = [
    # rule, exact, risk, error range stated by the documentation, in per cent
    (anp.two_drms, anp.circle, 0.05, 2.0, 15.6),
    (anp.circle_major, anp.circle, 0.05, 0.0, 24.9),
    (anp.cep, anp.circle, 0.5, -12.67, 2.2),
    (anp.sep_sum, anp.sphere, 0.5, -23.9, 0.8),
    (anp.sphere_rms, anp.sphere, 0.05, -17.7, 0.0),
    (anp.sphere_mean_sigma, anp.sphere, 0.05, -52.4, 0.0),
    (anp.sphere_major, anp.sphere, 0.05, 0.0, 42.6),
    (anp.circle_fit, anp.circle, 0.05, -0.87, 0.13),
    (anp.circle_geodesy, anp.circle, 0.05, -0.19, 0.16),
    (lambda v: anp.sphere_grubbs(v, 0.05), anp.sphere, 0.05, -1.24, 0.16),
    (anp.sphere_grubbs_as_printed, anp.sphere, 0.05, 17.5, 34.1),
]


@pytest.mark.parametrize(("rule", "exact", "risk", "least", "most"), RULES)
def test_a_rule_is_as_far_off_as_its_documentation_says(rule, exact, risk, least, most) -> None:  # type: ignore[no-untyped-def]
    sigma = np.linspace(0.0, 1.0, 41)
    d = 3 if exact is anp.sphere else 2
    grid = np.stack(np.meshgrid(*[sigma] * (d - 1), [1.0], indexing="ij"), axis=-1).reshape(-1, d)
    covariances = grid[:, :, np.newaxis] ** 2 * np.eye(d)
    error = 100 * (rule(covariances) / exact(covariances, risk) - 1)
    # The grid reaches the ends of the range, which are printed to a tenth (or a hundredth) of a per cent.
    assert error.min() == pytest.approx(least, abs=0.06)
    assert error.max() == pytest.approx(most, abs=0.06)
