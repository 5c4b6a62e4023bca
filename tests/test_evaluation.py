"""Evaluation of bounds and covariances: known answers, and verdicts on data made to be consistent or not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from navbound import InputError, evaluation
from navbound.run.verdict.results import consistency_words

SEED = 20261121


def gauss_markov(shape: tuple[int, ...], memory: float, seed: int = SEED) -> NDArray[np.float64]:
    """Unit variance along the first axis."""
    rng = np.random.default_rng(seed)
    fresh = math.sqrt(1 - memory * memory) * rng.standard_normal(shape)
    fresh[0] /= math.sqrt(1 - memory * memory)
    for k in range(1, shape[0]):
        fresh[k] += memory * fresh[k - 1]
    return fresh


def test_scores_are_their_definitions() -> None:
    error, bound, risk = np.array([0.5, -3.0, 1.0, math.nan, 2.0]), np.array([1.0, 2.0, 1.0, 5.0, math.nan]), 0.05
    score = evaluation.bound(error, bound, risk)
    assert (score.n, score.n_without_bound, score.n_outside) == (3, 1, 1)
    assert score.coverage == pytest.approx(2 / 3, rel=1e-15)
    assert score.mean_m == pytest.approx(4 / 3, rel=1e-15)
    assert (score.median_m, score.max_m) == (1.0, 2.0)
    assert score.winkler_m == pytest.approx((2 + (4 + 2 / risk * 1.0) + 2) / 3, rel=1e-15)
    assert score.pinball_m == pytest.approx((risk * 0.5 + (1 - risk) * 1.0) / 3, rel=1e-14)


def test_limits_are_clopper_and_pearson() -> None:
    n, outside = 1000, 37
    error = np.where(np.arange(n) % 27 == 0, 2.0, 0.5)
    error[27 * outside :: 27] = 0.5
    # A sign that is drawn anew makes the error nearly white; the limits are compared at whatever size was found.
    error *= np.random.default_rng(3).choice([-1.0, 1.0], n)
    score = evaluation.bound(error, np.ones(n), 0.05)
    k, size = outside * score.n_effective / n, score.n_effective
    assert 0.5 * n < size <= n
    assert score.coverage_low == pytest.approx(1 - stats.beta.ppf(0.975, k + 1, size - k), rel=1e-9)
    assert score.coverage_high == pytest.approx(1 - stats.beta.ppf(0.025, k, size - k + 1), rel=1e-9)


def test_the_median_of_an_even_count_is_the_mean_of_the_middle_two() -> None:
    assert evaluation.bound(np.zeros(4), [4.0, 1.0, 2.0, 9.0], 0.05).median_m == 3.0
    nothing = evaluation.bound([math.nan], [1.0], 0.05)
    assert nothing.n == 0
    assert math.isnan(nothing.coverage)
    assert math.isnan(nothing.max_m)


def test_the_interval_of_an_exact_bound_holds_the_truth_as_often_as_it_says() -> None:
    """400 correlated tracks; a 95 % interval on a conservative size must hold 0.95 in at least the 99.9 % binomial limit of 95 %."""
    tracks = gauss_markov((1500, 400), 0.9)
    n_inside = 0
    for k in range(400):
        score = evaluation.bound(tracks[:, k], np.full(1500, 1.959963984540054), 0.05)
        n_inside += score.coverage_low <= 0.95 <= score.coverage_high
    assert n_inside >= stats.binom.ppf(0.001, 400, 0.95)


def test_too_small_a_bound_is_refuted() -> None:
    error = gauss_markov((20000,), 0.5)
    assert evaluation.bound(error, np.full(20000, 1.7), 0.05).coverage_high < 0.95


def test_no_constant_bound_scores_better_than_the_quantile() -> None:
    error = gauss_markov((200_000,), 0.0)
    scores = {b: evaluation.bound(error, np.full(len(error), b), 0.05) for b in (1.5, 1.96, 2.6)}
    assert scores[1.96].winkler_m < min(scores[1.5].winkler_m, scores[2.6].winkler_m)
    assert scores[1.96].pinball_m < min(scores[1.5].pinball_m, scores[2.6].pinball_m)


@pytest.mark.parametrize("memory", [0.0, 0.9, 0.99])
def test_the_effective_size_of_a_gauss_markov_error_is_known(memory: float) -> None:
    n = 400_000
    result = evaluation.effective_size(gauss_markov((n,), memory))
    # Four standard errors of a sum over five correlation times, as in the core's test.
    tolerance = 4 * math.sqrt(2 * (10 / (1 - memory) + 1) / n)
    assert result / n == pytest.approx((1 - memory) / (1 + memory), rel=tolerance)


def test_the_effective_size_is_the_plain_sum_over_all_lags() -> None:
    x = gauss_markov((4000,), 0.97)
    centred = x - x.mean()
    rho = np.correlate(centred, centred, "full")[len(x) - 1 :] / (centred @ centred)
    pairs = rho[:-1:2] + rho[1::2]
    end = int(np.argmax(pairs <= 0))
    plain = len(x) / (2 * pairs[:end].sum() - 1)
    # Where coarse lags end may differ by one pair of them.
    assert evaluation.effective_size(x) == pytest.approx(plain, rel=0.05)


def test_tracks_do_not_follow_each_other() -> None:
    error = np.repeat([1.0, -1.0], 500)
    apart = evaluation.bound(error, np.full(1000, 2.0), 0.05, track=np.repeat(["a", "b"], 500))
    assert apart.n_effective == pytest.approx(2.0, rel=0.02)


def test_a_consistent_covariance_is_inside_its_limits_and_another_outside() -> None:
    root = np.array([[2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.3, 0.2, 3.0]])
    error = gauss_markov((20000, 3), 0.8) @ root.T
    covariance = np.broadcast_to(root @ root.T, (20000, 3, 3))
    for dimension in (2, 3):
        e, v = error[:, :dimension], covariance[:, :dimension, :dimension]
        consistency = evaluation.nees(e, v)
        assert consistency.nees_low < consistency.nees_mean < consistency.nees_high
        assert consistency.nees_mean == pytest.approx(np.mean(np.einsum("ni,nij,nj->n", e, np.linalg.inv(v), e)), rel=1e-10)
        dof = consistency.n_effective * dimension
        assert consistency.nees_low == pytest.approx(stats.chi2.ppf(0.025, dof) / consistency.n_effective, rel=1e-9)
        assert consistency.nees_high == pytest.approx(stats.chi2.ppf(0.975, dof) / consistency.n_effective, rel=1e-9)
        assert evaluation.nees(e, 0.8 * v).nees_mean > consistency.nees_high
        assert evaluation.nees(e, 1.25 * v).nees_mean < consistency.nees_low


def test_the_transform_is_flat_for_a_consistent_covariance_only() -> None:
    n = 40000
    error, covariance = gauss_markov((n, 2), 0.0), np.broadcast_to(np.eye(2), (n, 2, 2))
    flat = evaluation.pit(error, covariance, n_bins=10)
    assert sum(flat.counts) == n
    # Of ten bins each outside with 5 %, four or more are outside once in a thousand.
    assert sum(not flat.low <= c <= flat.high for c in flat.counts) <= 3
    expected = [float(stats.binom.ppf(p, n, 0.1)) for p in (0.025, 0.975)]
    assert flat.low == pytest.approx(expected[0], rel=0.005)
    assert flat.high == pytest.approx(expected[1], rel=0.005)
    leaning = evaluation.pit(error, 0.5 * covariance, n_bins=10)
    assert leaning.counts[-1] > leaning.high
    assert leaning.counts[0] < leaning.low


def test_what_is_no_covariance_is_counted_and_not_used() -> None:
    error = np.ones((5, 2))
    covariance = np.array([np.eye(2)] * 5)
    covariance[1] = [[1.0, 1.0], [1.0, 1.0]]
    covariance[2, 0, 1] = 0.5
    covariance[3, 1, 1] = math.nan
    error[4, 0] = math.nan
    statistics = evaluation.nees(error, covariance)
    assert (statistics.n, statistics.n_unusable, statistics.nees_mean) == (1, 4, 2.0)


def test_the_bootstrap_resamples_tracks() -> None:
    # 50 tracks wholly inside or outside: the share of 45 of 50, binomial over tracks, not over 50 000 epochs.
    track = np.repeat(np.arange(50), 1000)
    error = np.where(track < 45, 0.0, 2.0)
    low, high = evaluation.bootstrap_coverage(error, np.ones(50000), track, n_replicates=20000, seed=7)
    # One track is 0.02; percentiles of a discrete law may fall one beside.
    assert low == pytest.approx(float(stats.binom.ppf(0.025, 50, 0.9)) / 50, abs=0.021)
    assert high == pytest.approx(float(stats.binom.ppf(0.975, 50, 0.9)) / 50, abs=0.021)
    assert (low, high) == evaluation.bootstrap_coverage(error, np.ones(50000), track, n_replicates=20000, seed=7)
    with pytest.raises(InputError, match="track"):
        evaluation.bootstrap_coverage(error, np.ones(50000), np.zeros(50000))


def test_each_score_says_which_coverage_it_is() -> None:
    assert evaluation.bound([0.0], [1.0], 0.05).coverage_kind == evaluation.REPEATED
    assert evaluation.bound([0.0], [1.0], 0.05, coverage_kind=evaluation.CONDITIONAL).coverage_kind == evaluation.CONDITIONAL
    with pytest.raises(InputError, match="coverage_kind"):
        evaluation.bound([0.0], [1.0], 0.05, coverage_kind="both")


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: evaluation.bound([0.0, 1.0], [1.0], 0.05), "bound_m"),
        (lambda: evaluation.bound([0.0], [-1.0], 0.05), r"bound_m\[0\]"),
        (lambda: evaluation.bound([0.0], [math.inf], 0.05), r"bound_m\[0\]"),
        (lambda: evaluation.bound([0.0], [1.0], 1.0), "risk"),
        (lambda: evaluation.bound([0.0], [1.0], 0.05, track=[1, 2]), "track"),
        (lambda: evaluation.nees(np.zeros((3, 4)), np.zeros((3, 4, 4))), "error_m"),
        (lambda: evaluation.nees(np.zeros((3, 2)), np.zeros((3, 3, 3))), "covariance_m2"),
        (lambda: evaluation.pit(np.zeros((3, 2)), np.zeros((3, 2, 2)), n_bins=1), "n_bins"),
    ],
)
def test_what_cannot_be_scored_is_refused(call: object, named: str) -> None:
    assert callable(call)
    with pytest.raises(InputError, match=named):
        call()


def test_a_histogram_outside_its_band_is_reported_though_the_mean_is_right() -> None:
    nees = evaluation.Nees(n=400, n_unusable=0, n_effective=80.0, dimension=3, nees_mean=3.0, nees_low=2.5, nees_high=3.5)
    flat = evaluation.Pit(n=400, n_effective=80.0, counts=[20] * 20, low=5.0, high=40.0)
    assert consistency_words(nees, flat).endswith("no reason to doubt the covariance.")
    heaped = evaluation.Pit(n=400, n_effective=80.0, counts=[120, *[10] * 18, 100], low=5.0, high=40.0)
    sentence = consistency_words(nees, heaped)
    assert "2 of the 20 bins" in sentence
    assert "6 times its share" in sentence


@pytest.mark.parametrize(
    ("mean", "says"),
    [(6.4, "More tracks decide it"), (12.0, "claims smaller errors"), (0.3, "More tracks decide it"), (0.1, "claims larger errors")],
)
def test_a_few_effective_epochs_decide_nothing_that_one_might_have(mean: float, says: str) -> None:
    flat = evaluation.Pit(n=400, n_effective=4.0, counts=[20] * 20, low=0.0, high=400.0)

    def sentence_of(n_effective: float) -> str:
        return consistency_words(evaluation.Nees(400, 0, n_effective, 3, mean, 1.1, 5.8), flat)

    # Chi-square with three degrees of freedom: 95 % between 0.216 and 9.35.
    assert says in sentence_of(4.0)
    assert "claims" in sentence_of(40.0)
