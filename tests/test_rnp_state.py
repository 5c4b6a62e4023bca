"""The RNP-state classifier: errata of its source as exhibits, and an independent transcription."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest

from navbound import InputError, rnp

sys.path.insert(0, str(Path(__file__).parents[1] / "oracle"))
import rnp_states as oracle

NM = 1852.0
LEVELS = [0.3, 1.0, 2.0, 5.0]
TABLES = [
    (LEVELS, [0.0] * 4),
    (LEVELS, [0.15, 0.5, 1.0, 2.5]),
    (LEVELS, [0.25, 0.5, 1.0, 2.5]),
    ([0.1, 0.3, 1.0, 2.0], [0.05, 0.125, 0.5, 0.5]),
]


def test_b1_the_printed_recursion_takes_the_root_of_a_negative_number() -> None:
    assert oracle.printed_radicands(LEVELS) == pytest.approx([-8.692, -8.600, -7.212, -10.986], abs=5e-4)
    states = rnp.StateClassifier(LEVELS)
    for k, boundary in enumerate(states.boundary_m[:1]):
        here = states.posterior(boundary)
        assert here[k] == pytest.approx(here[k + 1], rel=1e-12)


@pytest.mark.parametrize(("levels", "fte"), TABLES)
def test_b3_with_equal_priors_the_most_likely_state_is_the_threshold_rule(levels: list[float], fte: list[float]) -> None:
    states = rnp.StateClassifier(levels, fte)
    x = np.linspace(0.0, 12.0, 4801) * NM
    # Exactly on a boundary two states tie and rounding would decide.
    x = x[np.min(np.abs(x[:, None] - states.boundary_m), axis=1) > 1e-6]
    assert len(x) > 4790
    assert np.array_equal(np.argmax(states.posterior(x), axis=-1), states.threshold_class(x))
    assert np.array_equal(states.classify(x), states.threshold_class(x))


def test_b3_a_wide_state_that_is_no_neighbour_wins_in_between() -> None:
    levels, fte = [0.3, 1.0, 2.0, 4.0, 5.0, 10.0], [0.25, 0.5, 1.0, 2.0, 2.5, 5.0]
    with pytest.raises(InputError, match="only gets worse"):
        rnp.StateClassifier(levels, fte)
    states = rnp.StateClassifier(levels, fte, require_order=False)
    x = np.array([3.37, 3.40, 3.50, 3.54]) * NM
    assert np.argmax(states.posterior(x), axis=-1).tolist() == [3, 5, 5, 4]
    assert states.classify(x).tolist() == [3, 3, 4, 4]
    assert not states.ordered


def test_b4_the_printed_bivariate_form_is_too_good_off_the_diagonal() -> None:
    lateral, longitudinal = np.zeros(3), np.array([0.5, 1.2, 7.0]) * NM
    result = rnp.state_of_errors(LEVELS, lateral, longitudinal)
    assert result.paper_state.tolist() == [0, 1, 3]
    assert result.state.tolist() == result.threshold_state.tolist() == [1, 2, 4]
    # Grid of the specification; its percentages carry one digit after the point.
    axis = np.linspace(0.0, 6.0, 121) * NM
    grid = rnp.state_of_errors(LEVELS, *np.meshgrid(axis, axis))
    assert 100 * np.mean(grid.paper_state < grid.threshold_state) == pytest.approx(27.9, abs=0.2)
    assert 100 * np.mean(grid.paper_state > grid.threshold_state) == pytest.approx(1.2, abs=0.2)


def test_b5_a_narrow_last_state_loses_far_outside_unless_it_is_guarded() -> None:
    states = rnp.StateClassifier([0.3, 1.0, 5.0, 5.5], require_order=False)
    x = np.array([7.0, 8.0, 10.0, 20.0]) * NM
    assert np.argmax(states.log_posterior_as_printed(x), axis=-1).tolist() == [2] * 4
    assert np.argmax(states.log_posterior(x), axis=-1).tolist() == [4] * 4
    assert states.classify(x).tolist() == [4] * 4


@pytest.mark.parametrize(("levels", "fte"), TABLES)
def test_out_of_rnp_never_becomes_less_likely_outwards(levels: list[float], fte: list[float]) -> None:
    states = rnp.StateClassifier(levels, fte)
    last = states.log_posterior(np.linspace(states.mean_m[-1], 30 * NM, 2000))[:, -1]
    assert np.all(np.diff(last) >= 0)


@pytest.mark.parametrize(("levels", "fte"), TABLES)
def test_an_independent_transcription_agrees(levels: list[float], fte: list[float]) -> None:
    states = rnp.StateClassifier(levels, fte)
    boundaries = states.boundary_m.tolist()
    mean, sigma = oracle.table(boundaries)
    assert states.mean_m == pytest.approx([float(m) for m in mean], rel=1e-12)
    assert states.sigma_m == pytest.approx([float(s) for s in sigma], rel=1e-14)
    for x in np.linspace(0.013, 1.7, 23) * boundaries[-1]:
        for guarded, value in ((True, states.log_posterior(x)), (False, states.log_posterior_as_printed(x))):
            assert value == pytest.approx(oracle.log_posterior(boundaries, float(x), guarded=guarded), rel=1e-11, abs=1e-10)


def test_probabilities_are_the_mass_between_the_boundaries() -> None:
    states = rnp.StateClassifier(LEVELS)
    for offset, sigma in [(0.0, 200.0), (400.0, 150.0), (-400.0, 150.0), (1e4, 30.0), (0.0, 5000.0)]:
        probabilities = states.probabilities(offset, sigma)
        assert probabilities == pytest.approx(oracle.probabilities(states.boundary_m.tolist(), offset, sigma), rel=1e-11, abs=1e-300)
        assert probabilities.sum() == pytest.approx(1.0, abs=1e-15)
    for offset, sigma, named in [(math.nan, 1.0, "offset_m"), (0.0, 0.0, "sigma_m"), (0.0, math.nan, "sigma_m")]:
        with pytest.raises(InputError, match=named):
            states.probabilities(offset, sigma)


def test_residuals_give_the_posterior_of_the_error_itself() -> None:
    states = rnp.StateClassifier(LEVELS)
    sum_of_squares, n = 12 * 260.0**2, 12
    probabilities = states.probabilities_from_residuals(sum_of_squares, n)
    within = [oracle.probability_within(b, sum_of_squares, n) for b in states.boundary_m]
    assert np.cumsum(probabilities)[:-1] == pytest.approx(within, rel=1e-9)
    assert 0.1 < probabilities[0] < 0.9


def test_a_lost_error_is_out_of_rnp_and_leaves_the_memory_alone() -> None:
    states = rnp.StateClassifier(LEVELS)
    assert states.classify([math.nan, 0.1]).tolist() == [4, 0]
    x = np.array([0.1, math.nan, 0.5]) * NM
    result = states.remember(x)
    assert np.isnan(result[1]).all()
    assert result[2] == pytest.approx(states.remember(x[[0, 2]])[1], rel=1e-15)


def test_priors_and_stay_outside_their_domain_are_refused() -> None:
    states = rnp.StateClassifier(LEVELS)
    for prior in ([0.5, 0.5], [1.0, 1.0, 0.0, 0.0, 0.0], [-1.0, 2.0, 0.0, 0.0, 0.0], [math.nan] * 5):
        with pytest.raises(InputError, match="prior"):
            states.posterior(1.0, prior)
    with pytest.raises(InputError, match="stay"):
        states.remember([1.0], stay=1.5)


def test_the_best_dme_pair_of_every_place() -> None:
    from navbound import dme  # noqa: PLC0415

    stations = {"A": [0, 0, 0.1], "B": [60, 10, 0.05], "C": [-35, 70, 0.2], "D": [20, -90, 0.02], "E": [21, 23, 0.1]}
    stations_m = {name: np.asarray(place) * NM for name, place in stations.items()}
    # ref-bayes.json, dme_dme.
    for place, best in [((20, 25, 5), "AC"), ((20, 60, 6), "AC"), ((-10, -40, 3), "BD"), ((300, 300, 6), None), ((24, 4, 5), "BE")]:
        result = dme.best_pair(np.asarray(place) * NM, stations_m)
        assert (None if result is None else "".join(result.stations)) == best
