"""A truth that is the estimate, and errors of too few independent epochs: neither supports a bound."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import navbound
from navbound.run.verdict import rule
from test_verdict import M_PER_RAD, START_NS, table, white

N = 400
GOOD = rule.BeliefFacts(n_effective=100.0, p_values=[0.5], short=False, excluded=False)


@pytest.mark.parametrize("shift_rad", [0.0, math.radians(1e-9)], ids=["equal", "a billionth of a degree"])
def test_a_truth_that_is_the_estimate_is_none(tmp_path: Path, shift_rad: float) -> None:
    error = np.full((N, 2), shift_rad * M_PER_RAD)
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, error_en_m=error)).summary.verdict
    assert verdict.belief is not None
    assert (verdict.id, verdict.belief.state) == ("not_shown", "copied")
    assert "The truth is the estimate itself" in verdict.words


def test_a_copy_of_half_of_the_epochs_is_none(tmp_path: Path) -> None:
    error = white(N)
    error[: N // 2] = 0.0
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, error_en_m=error)).summary.verdict
    assert verdict.belief is not None
    assert verdict.belief.state == "copied"


def test_errors_far_below_a_careful_sigma_are_errors(tmp_path: Path) -> None:
    """Errors of 0.1 m beside a sigma of 30 m: a careless sigma, no copy."""
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=30.0, error_en_m=white(N, 0.1))).summary.verdict
    assert verdict.belief is not None
    assert (verdict.id, verdict.belief.state) == ("inside", "small")
    assert "The squared errors are more than 100 times smaller than the covariance states" in verdict.words
    assert "this supports no bound" in verdict.words
    # Squares of white errors of 0.2 sigma are 25 times smaller, within what 400 pairs leave to chance (a twentieth each way).
    careful = navbound.analyze(table(tmp_path / "c.csv", N, sigma_m=5.0, error_en_m=white(N, 1.0))).summary.verdict
    factor = re.search(r"The squared errors are ([\d.]+) times smaller than the covariance states", careful.words)
    assert factor is not None
    assert float(factor[1]) == pytest.approx(25.0, rel=0.15)
    usual = navbound.analyze(table(tmp_path / "b.csv", N, error_en_m=white(N))).summary.verdict
    assert "times smaller" not in usual.words


def test_few_independent_epochs_support_nothing(tmp_path: Path) -> None:
    """An error that stays for a whole track is one independent epoch."""
    slow_m = 1.0 + 0.5 * np.sin(np.linspace(0.0, 1.0, N))
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, error_en_m=np.column_stack([slow_m, slow_m]))).summary.verdict
    assert verdict.belief is not None
    assert (verdict.id, verdict.belief.state) == ("inside", "few")
    assert "at least 10 independent epochs are needed, and these are worth 1" in verdict.words


@pytest.mark.parametrize("offset_m", [0.01, 0.5, 3.0])
def test_one_solution_with_an_offset_is_no_truth(tmp_path: Path, offset_m: float) -> None:
    error = np.full((N, 2), offset_m)
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, error_en_m=error)).summary.verdict
    assert verdict.belief is not None
    assert (verdict.id, verdict.belief.state) == ("not_shown", "copied")


def test_the_rule_of_few_and_copied() -> None:
    assert rule.of_belief(replace(GOOD, square_share=0.1)) == "supported"
    assert rule.of_belief(replace(GOOD, square_share=0.099)) == "small"
    assert rule.of_belief(replace(GOOD, square_share=0.099, n_effective=9.9)) == "few"
    assert rule.of_belief(GOOD) == "supported"
    assert rule.of_belief(replace(GOOD, n_effective=9.9)) == "few"
    assert rule.of_belief(replace(GOOD, n_effective=10.0)) == "supported"
    assert rule.of_belief(replace(GOOD, copied_share=0.5)) == "copied"
    assert rule.of_belief(replace(GOOD, copied_share=0.5, p_values=[1e-6])) == "refuted"


@pytest.mark.parametrize(
    ("error_m", "expected"), [(0.0, "not_shown"), (1e-4, "not_shown"), (0.3, "inside")], ids=["zero", "a tenth of a millimetre", "an error"]
)
def test_a_copied_truth_shows_nothing_of_protection_levels_either(tmp_path: Path, error_m: float, expected: str) -> None:
    rows = [f"{START_NS + k * 1_000_000_000},{error_m},{error_m},{error_m},15.0,20.0" for k in range(N)]
    (tmp_path / "a.csv").write_text("\n".join(["time_ns,nse_e_m,nse_n_m,nse_u_m,hpl_m,vpl_m", *rows]))
    verdict = navbound.evaluate(tmp_path / "a.csv", levels="APV-I").summary.verdict
    assert (verdict.id, "The truth is the estimate itself" in verdict.words) == (expected, expected == "not_shown")


def test_positions_with_their_own_copy_as_truth_show_nothing_of_levels(tmp_path: Path) -> None:
    rows = [f"{START_NS + k * 1_000_000_000},{48 + k * 1e-5},2.0,100.0,{48 + k * 1e-5},2.0,100.0,15.0,20.0" for k in range(N)]
    header = "time_ns,lat_deg,lon_deg,height_m,truth_lat_deg,truth_lon_deg,truth_h_m,hpl_m,vpl_m"
    (tmp_path / "a.csv").write_text("\n".join([header, *rows]))
    assert navbound.evaluate(tmp_path / "a.csv", levels="APV-I").summary.verdict.id == "not_shown"


@pytest.mark.parametrize(
    ("column", "value", "words"),
    [
        ("status", "not_available", "its own recording states that it is not valid"),
        ("fix", "0", "its own recording states that it is not valid"),
        ("sigma_m", "5000", "its own standard deviation is no smaller than that of the position"),
        ("sigma_m", "8", "its own standard deviation is no smaller than that of the position"),
        ("sigma_m", "0.02", ""),
        ("epu", "5000", "its own standard deviation is no smaller than that of the position"),
        ("hpl", "3000", "its own standard deviation is no smaller than that of the position"),
        ("raim", "fault", "its own recording states that it is not valid"),
        ("status", "ok", ""),
    ],
)
def test_a_truth_that_states_against_itself_is_none(tmp_path: Path, column: str, value: str, words: str) -> None:
    noise = np.random.default_rng(5).normal(0.0, 8.0, (N, 2)) / 111_000.0
    names = {"sigma_m": "sigma_e_m,sigma_n_m"}.get(column, column)
    values = {"sigma_m": f"{value},{value}"}.get(column, value)
    own, truth = ["time,lat_deg,lon_deg,sigma_e_m,sigma_n_m"], [f"time,lat_deg,lon_deg,{names}"]
    for k in range(N):
        at = f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z"
        own.append(f"{at},{7e-4 * k + noise[k, 0]:.9f},{noise[k, 1]:.9f},8,8")
        truth.append(f"{at},{7e-4 * k:.9f},0.0,{values}")
    (tmp_path / "a.csv").write_text("\n".join(own) + "\n")
    (tmp_path / "t.csv").write_text("\n".join(truth) + "\n")
    verdict = navbound.analyze(tmp_path / "a.csv", truth=tmp_path / "t.csv").summary.verdict
    assert verdict.id == ("not_shown" if words else "inside")
    assert (verdict.belief is not None and verdict.belief.state == "supported") == (not words)
    assert words in verdict.words
    assert verdict.n_truth_doubted == (N if words else 0)


@pytest.mark.parametrize(("decimals", "state"), [(4, "copied"), (5, "copied"), (6, "copied"), (9, "copied"), (None, "supported")])
def test_a_truth_that_is_the_rounded_estimate_is_none(tmp_path: Path, decimals: int | None, state: str) -> None:
    """Three kilometres beside the track, as any receiver may be: the truth is written from the same positions."""
    noise = np.random.default_rng(6).normal(0.0, 8.0, (N, 2)) / 111_000.0
    own, truth = ["time,lat_deg,lon_deg,sigma_e_m,sigma_n_m"], ["time,lat_deg,lon_deg"]
    for k in range(N):
        at = f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z"
        lat, lon = 7e-4 * k + noise[k, 0], 0.027 + noise[k, 1]
        own.append(f"{at},{lat:.9f},{lon:.9f},8,8")
        truth.append(f"{at},{7e-4 * k:.9f},0.027" if decimals is None else f"{at},{lat:.{decimals}f},{lon:.{decimals}f}")
    (tmp_path / "a.csv").write_text("\n".join(own) + "\n")
    (tmp_path / "t.csv").write_text("\n".join(truth) + "\n")
    verdict = navbound.analyze(tmp_path / "a.csv", truth=tmp_path / "t.csv").summary.verdict
    assert verdict.belief is not None
    assert verdict.belief.state == state
    assert verdict.id == ("inside" if state == "supported" else "not_shown")
