"""The verdict: who is judged, when truth withdraws it, what was assumed, and how a command ends."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

import navbound
from navbound import InputError, evaluation, exit_status
from navbound.records.performance import Performance
from navbound.records.run import CovarianceOrigin, Summary
from navbound.records.verdict import BeliefState
from navbound.run import analyze as recorded
from navbound.run.judge import judge
from navbound.run.verdict import rule
from navbound.run.verdict.numbers import share

START_NS = 1_400_000_000_000_000_000
M_PER_RAD = 6.37e6
"""Enough for errors of metres."""


def table(
    path: Path,
    n: int = 400,
    *,
    sigma_m: float | None = 3.0,
    error_en_m: NDArray[np.float64] | None = None,
    degraded: int = 0,
    drop: slice | None = None,
    error_u_m: float | NDArray[np.float64] = 0.0,
    added: Mapping[str, object] | None = None,
) -> Path:
    """A straight track at 50 m/s with a stated sigma, its truth, and some epochs without variance (degraded)."""
    k = np.arange(n)
    error = np.zeros((n, 2)) if error_en_m is None else error_en_m
    lat, lon = 0.85 + 50.0 * k / M_PER_RAD, np.full(n, 0.04)
    columns = {
        "time_ns": START_NS + k * 1_000_000_000,
        "est_lat_rad": lat + error[:, 1] / M_PER_RAD,
        "est_lon_rad": lon + error[:, 0] / (M_PER_RAD * math.cos(0.85)),
        "est_h_m": np.full(n, 1000.0),
    }
    if sigma_m is not None:
        columns["sigma_e_m"] = columns["sigma_n_m"] = np.where(k < degraded, 0.0, sigma_m)
    if error_en_m is not None:
        columns |= {"truth_lat_rad": lat, "truth_lon_rad": lon, "truth_h_m": np.full(n, 1000.0) + error_u_m}
    frame = pl.DataFrame(columns | dict(added or {}))
    if drop is not None:
        frame = frame.filter(~pl.int_range(pl.len()).is_in(list(range(n))[drop]))
    frame.write_csv(path)
    return path


def command(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "navbound", *map(str, arguments)], capture_output=True, text=True, check=False)


def first_sentence(words: str) -> str:
    return words.split(". ", maxsplit=1)[0]


# Who is judged.


def test_degraded_epochs_never_make_inside(tmp_path: Path) -> None:
    """957 of 986 degraded: what is left is 2.9 % of the flight."""
    verdict = navbound.analyze(table(tmp_path / "a.csv", 986, degraded=957)).summary.verdict
    assert (verdict.id, verdict.inside) == ("not_shown", None)
    assert (verdict.n_epochs, verdict.n_judged, verdict.n_degraded) == (986, 29, 957)
    sentence = first_sentence(verdict.words)
    assert "not shown to be inside RNP 0.3" in sentence
    assert "2.9 % are ok and judged, 97.1 % are degraded" in verdict.words
    assert "100 % of 986" not in verdict.words


def test_tables_of_tracks_and_phases_speak_of_ok_epochs_too(tmp_path: Path) -> None:
    summary = navbound.analyze(table(tmp_path / "a.csv", degraded=400)).summary
    assert [t.share_inside for t in summary.tracks] == [p.share_inside for p in summary.phases] == [None]


@pytest.mark.parametrize(("degraded", "expected"), [(20, "inside"), (21, "not_shown")])
def test_inside_needs_the_least_share_of_ok_epochs(tmp_path: Path, degraded: int, expected: str) -> None:
    assert navbound.analyze(table(tmp_path / "a.csv", 400, degraded=degraded)).summary.verdict.id == expected


def test_epochs_missing_in_a_gap_count_as_not_judged(tmp_path: Path) -> None:
    verdict = navbound.analyze(table(tmp_path / "a.csv", 400, drop=slice(100, 200))).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_judged, verdict.n_missing) == ("not_shown", 400, 300, 100)
    assert "25.0 % are without a bound (100 epochs missing in gaps or without a usable time and position)" in verdict.words


def test_a_degraded_epoch_outside_is_outside(tmp_path: Path) -> None:
    """Degraded epochs count against, never for."""
    facts = rule.TrackFacts(100, 98, 2, 0, 0, 0, "unchecked")
    assert rule.of_tracks(facts) == "outside"
    assert rule.of_tracks(replace(facts, n_outside=0)) == "inside"


def test_all_degraded_is_nothing_judged_and_no_success(tmp_path: Path) -> None:
    done = command("analyze", table(tmp_path / "a.csv", degraded=400), "--out", tmp_path / "run")
    assert done.returncode == exit_status.NO_VERDICT == 4
    assert "nothing judged against RNP 0.3" in done.stdout
    shown = command("show", tmp_path / "run", "--json")
    assert shown.returncode == 4
    assert json.loads(shown.stdout)["verdict"]["id"] == "nothing_judged"


GOOD = rule.TrackFacts(1000, 1000, 0, 0, 0, 0, "unchecked")


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({}, "inside"),
        ({"belief": "supported"}, "inside"),
        ({"belief": "short"}, "not_shown"),
        ({"belief": "contradicted"}, "not_shown"),
        ({"belief": "contradicted", "n_outside": 1}, "outside"),
        ({"belief": "refuted"}, "not_believable"),
        ({"belief": "refuted", "n_outside": 3}, "not_believable"),
        ({"belief": "refuted", "n_judged": 0}, "not_believable"),
        ({"n_misleading": 1}, "not_believable"),
        ({"n_outside": 1}, "outside"),
        ({"n_outside": 1, "n_implausible": 1}, "outside"),
        ({"n_beyond_alert_limit": 1}, "outside"),
        ({"n_implausible": 1}, "not_shown"),
        ({"n_judged": 950}, "inside"),
        ({"n_judged": 949}, "not_shown"),
        ({"n_judged": 0}, "nothing_judged"),
        ({"n_judged": 0, "n_outside": 1}, "nothing_judged"),
        ({"n_judged": 0, "n_beyond_alert_limit": 1000}, "nothing_judged"),
        ({"n_epochs": 0, "n_judged": 0}, "nothing_judged"),
    ],
)
def test_the_rule_of_tracks(changed: dict[str, object], expected: str) -> None:
    assert rule.of_tracks(replace(GOOD, **changed)) == expected  # type: ignore[arg-type]


AVAILABLE = rule.LevelFacts(1000, 1000, 1000, 0, None, truth_known=True)


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({}, "inside"),
        ({"truth_known": False}, "not_shown"),
        ({"n_misleading_events": 1, "p_misleading": 1e-4}, "not_believable"),
        ({"n_misleading_events": 1, "p_misleading": 0.02}, "not_shown"),
        ({"n_misleading_events": 1, "p_misleading": None}, "not_shown"),
        ({"n_solution": 0, "n_available": 0}, "nothing_judged"),
        ({"n_available": 949}, "outside"),
        ({"n_solution": 949, "n_available": 949}, "not_shown"),
    ],
)
def test_the_rule_of_levels(changed: dict[str, object], expected: str) -> None:
    facts = replace(AVAILABLE, **changed)  # type: ignore[arg-type]
    assert rule.of_levels([facts]) == expected
    # Of two levels the graver counts.
    assert rule.of_levels([AVAILABLE, facts]) == expected
    assert rule.of_levels([]) == "nothing_judged"


# What truth withdraws.


def test_a_bound_that_contains_nothing_withdraws_the_verdict(tmp_path: Path) -> None:
    """One error that never changes, six times its sigma: no independent epochs to count, and still no sigma that is large enough."""
    path = table(tmp_path / "a.csv", 536, sigma_m=2.0, error_en_m=np.tile([12.0, 0.0], (536, 1)))
    done = command("analyze", path, "--out", tmp_path / "run")
    assert done.returncode == 4
    assert "not believable" in done.stdout
    assert "Inside" not in done.stdout.split("Assumed")[0]
    verdict = Summary.model_validate_json((tmp_path / "run" / "summary.json").read_bytes()).verdict
    assert (verdict.id, verdict.inside) == ("not_believable", None)
    assert verdict.belief is not None
    assert verdict.belief.state == "refuted"
    assert [c.coverage for c in verdict.belief.bounds] == [0.0, 0.0]
    assert command("analyze", path, "--json", "--out", tmp_path / "run").returncode == 4
    assert command("show", tmp_path / "run").returncode == 4


def test_a_few_independent_epochs_below_the_claim_are_not_shown(tmp_path: Path) -> None:
    """One draw of 2.6 sigma: a sigma that is right does it in 3 % of flights, so nothing is refuted and nothing is shown."""
    path = table(tmp_path / "a.csv", 400, sigma_m=2.0, error_en_m=np.tile([5.2, 0.0], (400, 1)))
    verdict = navbound.analyze(path).summary.verdict
    assert verdict.id == "not_shown"
    assert verdict.belief is not None
    assert verdict.belief.state == "short"
    assert verdict.belief.n_effective == pytest.approx(1.0, abs=0.05)
    # The interval and the effective number stand beside the share.
    (circle, _) = verdict.belief.bounds
    assert (circle.coverage, circle.coverage_low) == (0.0, 0.0)
    assert circle.coverage_high > 0.95
    assert "of the errors at these epochs 0 % (0 % to " in verdict.words
    assert "are within the 95 % circle (95 % intervals as from 1 independent epoch)" in verdict.words


def test_a_bound_that_covers_leaves_the_verdict(tmp_path: Path) -> None:
    error = 3.0 * np.random.default_rng(20261122).standard_normal((400, 2))
    verdict = navbound.analyze(table(tmp_path / "a.csv", error_en_m=error)).summary.verdict
    assert verdict.id == "inside"
    assert verdict.belief is not None
    assert verdict.belief.state == "supported"
    assert command("show", tmp_path / "nothing").returncode == exit_status.UNREADABLE


def white(n: int, sigma_m: float = 3.0, seed: int = 20261122) -> NDArray[np.float64]:
    return sigma_m * np.random.default_rng(seed).standard_normal((n, 2))


def test_truth_that_contradicts_the_vertical_bound_is_no_support(tmp_path: Path) -> None:
    """Heights of truth above sea level, 45 m off at a vertical sigma of 0.5 m: the plane is right and the run states a false bound."""
    path = table(tmp_path / "a.csv", 400, error_en_m=white(400), error_u_m=-45.0, added={"sigma_u_m": np.full(400, 0.5)})
    done = command("analyze", path, "--out", tmp_path / "run")
    verdict = Summary.model_validate_json((tmp_path / "run" / "summary.json").read_bytes()).verdict
    assert verdict.belief is not None
    assert (verdict.id, verdict.inside, verdict.belief.state, done.returncode) == ("not_shown", None, "contradicted", 4)
    assert "the 95 % vertical interval contains 0 % (0 % to " in verdict.words
    assert "the 99.999 % sphere contains 0 % (0 % to " in verdict.words
    assert "of 400 errors" in verdict.words
    # The first screen is the terminal's: before what was assumed.
    assert "vertical interval contains 0 %" in done.stdout.split("Assumed and found")[0].replace("\n", " ")
    assert command("show", tmp_path / "run").returncode == 4


@pytest.mark.parametrize(
    ("added", "rnp_m", "expected"),
    [
        # Nothing is judged; every epoch is outside; an ok epoch is known to be beyond twice RNP.
        ({"status": ["degraded"] * 400}, 555.6, "nothing_judged"),
        ({}, 5.0, "outside"),
        ({"beyond": True}, 8.0, "not_believable"),
    ],
)
def test_every_verdict_names_every_bound_that_truth_contradicts(
    tmp_path: Path, added: Mapping[str, object], rnp_m: float, expected: str
) -> None:
    """Heights 45 m off at a vertical sigma of 0.5 m: interval and sphere are false whatever becomes of the plane."""
    error = white(400)
    columns: dict[str, object] = {name: values for name, values in added.items() if name != "beyond"}
    if "beyond" in added:
        error[7] = 20.0, 0.0
    path = table(tmp_path / "a.csv", 400, error_en_m=error, error_u_m=-45.0, added=columns | {"sigma_u_m": np.full(400, 0.5)})
    verdict = judge(recorded.material(path, requirement="RNP", rnp_m=rnp_m)).summary.verdict
    assert verdict.id == expected
    assert verdict.words.count("the 95 % vertical interval contains 0 % (0 % to ") == 1
    assert verdict.words.count("the 95 % sphere contains ") == 1
    assert verdict.words.count("the 99.999 % sphere contains ") == 1


def test_a_vertical_bound_whose_interval_excludes_its_claim_is_not_inside(tmp_path: Path) -> None:
    """24 of 400 heights are 2 km off, all at once, so that they are one error or two: not beyond doubt, but below the claim."""
    error_m = 3.0 * np.stack([np.cos(np.arange(400) / 200.0), np.sin(np.arange(400) / 200.0)], axis=1)
    up_m = np.where(np.arange(400) < 24, 2000.0, 0.0)
    path = table(tmp_path / "a.csv", 400, error_en_m=error_m, error_u_m=up_m, added={"sigma_u_m": np.full(400, 5.0)})
    verdict = navbound.analyze(path).summary.verdict
    assert verdict.belief is not None
    assert (verdict.id, verdict.belief.state) == ("not_shown", "short")
    assert "The vertical bounds claim more than their intervals allow: the 99.999 % vertical interval contains 94.0 %" in verdict.words
    assert verdict.words.count("the 99.999 % vertical interval contains") == 1


def test_a_vertical_bound_that_chance_may_explain_is_no_claim_beside_inside(tmp_path: Path) -> None:
    """One of 400 true errors is beyond the 99.999 % interval, which happens in one of 250 runs."""
    up_m = 5.0 * np.random.default_rng(902).standard_normal(400)
    path = table(tmp_path / "a.csv", 400, error_en_m=white(400, seed=2), error_u_m=up_m, added={"sigma_u_m": np.full(400, 5.0)})
    verdict = navbound.analyze(path).summary.verdict
    assert verdict.id == "inside"
    assert "This verdict is lateral alone: the vertical claim is withdrawn." in verdict.words


@pytest.mark.parametrize("seed", range(4))
def test_a_true_vertical_leaves_the_verdict(tmp_path: Path, seed: int) -> None:
    up = 5.0 * np.random.default_rng(900 + seed).standard_normal(400)
    path = table(tmp_path / "a.csv", 400, error_en_m=white(400, seed=seed), error_u_m=up, added={"sigma_u_m": np.full(400, 5.0)})
    verdict = navbound.analyze(path).summary.verdict
    assert verdict.belief is not None
    assert (verdict.id, verdict.belief.state) == ("inside", "supported")
    assert {check.method for check in verdict.belief.beside} == {"anp-vertical", "anp-sphere"}


def test_a_false_lateral_bound_names_the_vertical_beside_it(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", 400, error_en_m=white(400, 30.0), error_u_m=-45.0, added={"sigma_u_m": np.full(400, 0.5)})
    verdict = navbound.analyze(path).summary.verdict
    assert verdict.id == "not_believable"
    withdrawn = verdict.words.split("all 400 epochs are ok")[0]
    assert "the 95 % circle contains" in withdrawn
    assert "vertical interval contains 0 %" in withdrawn


def test_an_error_above_the_recorded_level_withdraws_the_verdict(tmp_path: Path) -> None:
    """The lateral verdict compares with the protection level; one epoch above it is misleading information."""
    error = np.clip(white(400), -7.0, 7.0)
    error[200] = [11.0, 0.0]
    levels = {"hpl_m": np.full(400, 10.5), "vpl_m": np.full(400, 30.0)}
    verdict = navbound.analyze(table(tmp_path / "a.csv", 400, error_en_m=error, added=levels)).summary.verdict
    assert verdict.id == "not_believable"
    assert "the horizontal error is above HPL at 1 of 400 epochs (at most 1.05 times the level)" in verdict.words
    high = {"hpl_m": np.full(400, 60.0), "vpl_m": np.full(400, 30.0)}
    verdict = navbound.analyze(table(tmp_path / "b.csv", 400, error_en_m=error, added=high)).summary.verdict
    assert verdict.id == "inside"
    assert "No error is above HPL at any of 400 epochs or VPL at any of 400 epochs." in verdict.words


def test_an_error_above_the_recorded_vertical_level_is_no_support(tmp_path: Path) -> None:
    up = np.zeros(400)
    up[7] = 31.0
    levels = {"hpl_m": np.full(400, 60.0), "vpl_m": np.full(400, 30.0)}
    verdict = navbound.analyze(table(tmp_path / "a.csv", 400, error_en_m=white(400), error_u_m=up, added=levels)).summary.verdict
    assert verdict.belief is not None
    assert (verdict.id, verdict.belief.state) == ("not_shown", "contradicted")
    assert "the vertical error is above VPL at 1 of 400 epochs" in verdict.words


def test_the_share_of_truth_stands_in_the_verdict(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", 1200, error_en_m=white(1200))
    known = pl.int_range(pl.len()) < 20
    frame = pl.read_csv(path).with_columns(pl.when(known).then(pl.col(name)).alias(name) for name in ("truth_lat_rad", "truth_lon_rad"))
    frame.write_csv(path)
    words = navbound.analyze(path).summary.verdict.words
    assert "Truth is known at 20 of 1200 checked epochs (1.7 %), and the bounds of the others could not be checked" in words


def test_truth_without_a_covariance_is_truth(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", 300, error_en_m=white(300))
    pl.read_csv(path).drop("sigma_e_m", "sigma_n_m").write_csv(path)
    verdict = navbound.analyze(path).summary.verdict
    assert (verdict.id, verdict.truth_known) == ("nothing_judged", True)
    assert "No truth" not in verdict.words
    assert "Truth is known at 300 epochs, but at none that has a covariance" in verdict.words


# The test behind it.

R95, R5 = (math.sqrt(-2 * math.log(risk)) for risk in (0.05, 1e-5))


def gauss_markov(n: int, count: int, memory_epochs: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Unit Gauss-Markov series, shape (n, count); an infinite memory is one draw."""
    fresh = rng.standard_normal((n, count))
    if math.isinf(memory_epochs):
        return np.repeat(fresh[:1], n, axis=0)
    phi = math.exp(-1 / memory_epochs) if memory_epochs else 0.0
    fresh[1:] *= math.sqrt(1 - phi * phi)
    for k in range(1, n):
        fresh[k] += phi * fresh[k - 1]
    return fresh


def state_of(error: NDArray[np.float64]) -> str:
    """Belief in a unit covariance, as the judging stage asks for it."""
    n = len(error)
    size = evaluation.magnitude(error, np.tile(np.eye(2), (n, 1, 1)))
    radius = np.hypot(error[:, 0], error[:, 1])
    p_values = [size.p_value]
    for limit, risk in ((R95, 0.05), (R5, 1e-5)):
        contained = evaluation.containment(int((radius > limit).sum()), n, size.n_effective, risk)
        p_values += [contained.p_value, contained.p_value_any]
    return rule.of_belief(rule.BeliefFacts(size.n_effective, p_values, short=False, excluded=False))


SHAPES = {
    "white": [(0.0, 1.0)],
    "a tenth of the track": [(30.0, 1.0)],
    "a third of the track": [(100.0, 1.0)],
    "the track": [(300.0, 1.0)],
    "one bias": [(math.inf, 1.0)],
    "bias and noise": [(math.inf, 0.5), (0.0, 0.5)],
}
"""Parts of an error: memory in epochs, share of the variance."""


def refuted(shape: str, count: int, scale: float) -> int:
    """How many of `count` tracks of 300 epochs refute a unit covariance."""
    rng = np.random.default_rng(20261122)
    parts = [math.sqrt(share) * gauss_markov(300, 2 * count, memory, rng) for memory, share in SHAPES[shape]]
    error = scale * np.sum(parts, axis=0).reshape(300, count, 2)
    return sum(state_of(error[:, k]) == "refuted" for k in range(count))


@pytest.mark.parametrize("shape", SHAPES)
def test_a_true_covariance_is_withdrawn_at_most_once_in_a_thousand(shape: str) -> None:
    """4000 tracks: more than 11 refusals are improbable (3e-3, binomial) at a rate of 1e-3."""
    assert refuted(shape, 4000, 1.0) <= 11


@pytest.mark.parametrize(
    ("shape", "scale"),
    [("white", 1.25), ("a tenth of the track", 2.5), ("a third of the track", 4.0), ("the track", 5.0), ("one bias", 12.0)],
)
def test_a_false_covariance_is_withdrawn(shape: str, scale: float) -> None:
    """Nine tracks in ten at the factors that docs/methods/coverage.md states; 162 of 200 is the 1e-4 binomial limit of 90 %."""
    assert refuted(shape, 200, scale) >= 162


def test_the_probability_without_independence_is_that_of_one_draw() -> None:
    """exp(1 - m/2) bounds the mean of any series of unit errors; for one draw of square m the exact tail is exp(-m/2)."""
    for k in (1.0, 2.0, 4.0, 4.7):
        statistics = evaluation.magnitude(np.tile([k, 0.0], (50, 1)), np.tile(np.eye(2), (50, 1, 1)))
        assert statistics.p_value == pytest.approx(min(1.0, math.exp(1 - k * k / 2)), rel=1e-12)
        assert statistics.p_value >= math.exp(-k * k / 2)
    # One epoch whose truth is wrong by kilometres is one epoch.
    error = np.zeros((50, 2))
    error[7] = 1e6
    assert evaluation.magnitude(error, np.tile(np.eye(2), (50, 1, 1))).square_mean == pytest.approx(-2 * math.log(1e-5) / 50, rel=1e-9)


def test_counts_that_cannot_be_are_refused() -> None:
    for n_outside, n, n_effective, risk in (
        (1, 0, 1.0, 0.05),
        (3, 2, 1.0, 0.05),
        (1, 2, 3.0, 0.05),
        (1, 2, math.nan, 0.05),
        (1, 2, 1.0, 1.5),
    ):
        with pytest.raises(InputError):
            evaluation.containment(n_outside, n, n_effective, risk)
    with pytest.raises(InputError):
        evaluation.magnitude(np.zeros((4, 3)), np.tile(np.eye(3), (4, 1, 1)))


# What was assumed.


def test_the_first_sentence_says_what_the_user_typed(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv")
    run = navbound.analyze(path, sigma_m=5.0)
    sentence = first_sentence(run.summary.verdict.words)
    assert sentence.startswith(
        "Assuming a sigma of 5 m in each axis, typed by the user over the file's own accuracy (sigma 3 to 3 m) and no path"
    )
    assert "inside RNP 0.3" in sentence
    assert run.summary.verdict.assumed == ["sigma_typed", "no_path"]
    assert run.summary.covariance == CovarianceOrigin(id="typed", sigma_m=5.0, own_low_m=3.0, own_high_m=3.0)
    stated = navbound.analyze(path).summary
    assert (stated.covariance.id, stated.verdict.assumed) == ("file_axes", ["no_path"])
    assert "typed" not in stated.verdict.words


def test_a_share_is_never_rounded_to_all_or_none() -> None:
    assert [share(x) for x in (0.0, 1.0, 1 - 1e-4, 1 - 1e-12, 1e-12)] == [
        "0 %",
        "100 %",
        "99.99 %",
        "above 99.999999 %",
        "below 0.000001 %",
    ]


# How a command ends.


def test_help_and_documentation_list_every_status() -> None:
    shown = " ".join(command("--help").stdout.split())
    page = (Path(__file__).parents[1] / "docs" / "report.md").read_text(encoding="utf-8")
    for status, words in exit_status.MEANINGS.items():
        assert f"{status}: {words}" in shown
        assert f"| {status} | {words} |" in page


def test_every_verdict_has_its_status() -> None:
    exit_codes = {verdict: exit_status.of_verdict(verdict) for verdict in rule.MEANS_INSIDE}
    assert exit_codes == {"inside": 0, "outside": 0, "not_shown": 0, "not_believable": 4, "nothing_judged": 4}
    of_belief = {state: exit_status.of_verdict("not_shown", state) for state in get_args(BeliefState)}
    assert of_belief == {
        "unchecked": 0,
        "supported": 0,
        "partial": 0,
        "few": 0,
        "small": 0,
        "copied": 0,
        "short": 0,
        "contradicted": 4,
        "refuted": 4,
    }


def test_a_level_that_misleads_is_not_believable(tmp_path: Path) -> None:
    """One run beyond the level in an hour: 24 approaches at 2e-7 each leave 5e-6."""
    n = 3600
    error = np.tile([1.0, 0.0], (n, 1))
    error[1000:1010] = [30.0, 0.0]
    path = table(tmp_path / "levels.csv", n, error_en_m=error)
    frame = pl.read_csv(path).with_columns(hpl_m=pl.lit(10.0), vpl_m=pl.lit(15.0))
    frame.write_csv(path)
    done = command("evaluate", path, "--levels", "LPV-200", "--out", tmp_path / "run", "--json")
    summary = json.loads(done.stdout)
    assert (summary["verdict"]["id"], done.returncode) == ("not_believable", 4)
    assert Performance.model_validate(summary["performance"]).n_mi_epochs == 10
    assert summary["verdict"]["words"].startswith("Not believable: ")


@pytest.mark.parametrize("times", [2, 5, 20])
def test_rows_repeated_at_other_times_are_no_further_evidence(tmp_path: Path, times: int) -> None:
    """A receiver that stands still and repeats its last fix: as many independent errors as fixes, and no better probability."""
    n = 200
    error = np.repeat(white(n), times, axis=0)
    covariance = np.tile(9.0 * np.eye(2), (n * times, 1, 1))
    # Four standard errors of a sum over M correlations, 4 sqrt(2 (2M + 1) / N), with the M of the block.
    tolerance = 4.0 * math.sqrt(2.0 * (2 * times + 1) / (n * times))
    assert evaluation.magnitude(error, covariance).n_effective <= n * (1.0 + tolerance)
    assert evaluation.nees(error, covariance).n_effective <= n * (1.0 + tolerance)


def test_one_ok_epoch_with_a_known_error_beyond_twice_rnp_is_never_inside() -> None:
    assert rule.of_tracks(GOOD) == "inside"
    assert rule.of_tracks(replace(GOOD, n_known_beyond=1)) == "not_believable"


def test_improbable_errors_are_no_support_before_they_refute() -> None:
    facts = rule.BeliefFacts(n_effective=100.0, p_values=[0.004, 0.5], short=True, excluded=False)
    assert rule.of_belief(facts) == "short"
    assert rule.of_belief(replace(facts, p_values=[0.1, 0.5])) == "supported"
    # More coverage than claimed is no doubt of a bound.
    assert rule.of_belief(replace(facts, short=False)) == "supported"


def _cruise(tmp_path: Path, wild: dict[int, float]) -> Path:
    """A straight flight of 20 minutes at 50 m/s, a row a second, without speeds; some rows further north by metres."""
    lines = ["time_ns,lat_deg,lon_deg,h_m,sigma_n_m,sigma_e_m,sigma_u_m"]
    for k in range(1200):
        north_m = 50.0 * k + wild.get(k, 0.0)
        lines.append(f"{1_300_000_000_000_000_000 + k * 1_000_000_000},{49.0 + north_m / 111_200.0:.9f},2.0,3000.0,2,2,3")
    path = tmp_path / "cruise.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_a_track_without_speeds_is_judged_by_its_own(tmp_path: Path) -> None:
    quiet = navbound.analyze(_cruise(tmp_path, {}))
    assert quiet.summary.verdict.id == "inside"
    assert set(quiet.epochs["status"]) == {"ok"}
    # Half a minute elsewhere: latency of ten seconds at 50 m/s with factor and margin is less than 2.5 km.
    away = navbound.analyze(_cruise(tmp_path, dict.fromkeys(range(600, 630), 2500.0)))
    assert "ok" not in set(away.epochs["status"][600:630])
    # There and back at every second row: no aircraft.
    shaken = navbound.analyze(_cruise(tmp_path, dict.fromkeys(range(1, 1200, 2), 850.0)))
    assert shaken.summary.verdict.id != "inside"


def test_a_verdict_is_its_sentences_why_before_how_many_and_older_ones_are_still_read(tmp_path: Path) -> None:
    lat_deg = np.degrees(0.85 + 50.0 * np.arange(400) / M_PER_RAD) + 0.5
    recording = table(tmp_path / "a.csv", degraded=300, added={"gps_lat": lat_deg, "gps_lon": [math.degrees(0.04)] * 400})
    verdict = navbound.analyze(recording).summary.verdict
    assert verdict.words == " ".join(verdict.sentences)
    assert "not shown" in verdict.sentences[0]
    assert set(verdict.lead) < set(verdict.sentences)
    (doubt,) = verdict.position_doubts
    counts = next(sentence for sentence in verdict.sentences if sentence.startswith("Epochs that are not ok"))
    assert 0 < verdict.sentences.index(f"{doubt}.") < verdict.sentences.index(counts)
    older = json.loads(verdict.model_dump_json()) | {"lead": "Not shown. Because."}
    del older["sentences"]
    read = type(verdict).model_validate(older)
    assert (read.lead, read.sentences) == (["Not shown. Because."], [verdict.words])
