"""Positions that do not travel as the recording's own speeds say show nothing."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import navbound
from navbound.read.speeds import Speeds, doubts_of_speeds

N = 400
M_PER_DEG = math.radians(1.0) * 6_371_000.0


def table(path: Path, moved_mps: float, stated: np.ndarray | float, unit: str = "mps", *, sigma_m: float = 2.0) -> Path:
    """A flight northwards at one speed, with white noise of the stated covariance."""
    noise = np.random.default_rng(1).normal(0.0, sigma_m, N)
    column = {"mps": "speed_mps", "kt": "ground_speed_kt"}[unit]
    rows = [f"time,lat_deg,lon_deg,h_m,cov_ee_m2,cov_en_m2,cov_nn_m2,{column}"]
    speeds = np.broadcast_to(stated, N)
    for k in range(N):
        lat = 49.0 + (moved_mps * k + noise[k]) / M_PER_DEG
        rows.append(f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z,{lat:.8f},2.5,100.0,{sigma_m**2},0.0,{sigma_m**2},{speeds[k]}")
    path.write_text("\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize(
    ("moved", "stated", "unit", "word"),
    [
        (11.0, 0.0, "mps", "further"),
        (80.0, 40.0, "mps", "further"),
        (1.0, 60.0, "mps", "less far"),
        (80.0, 80.0, "mps", ""),
        (80.0, 80.0 / 0.514444, "kt", ""),
        (80.0, 80.0 / 0.514444, "mps", "less far"),
        (2.0, 0.0, "mps", ""),
    ],
)
def test_a_way_that_the_stated_speeds_cannot_explain_is_a_doubt(tmp_path: Path, moved: float, stated: float, unit: str, word: str) -> None:
    verdict = navbound.analyze(table(tmp_path / "a.csv", moved, stated, unit)).summary.verdict
    assert (verdict.id, bool(verdict.position_doubts)) == (("not_shown", True) if word else ("inside", False))
    assert word in " ".join(verdict.position_doubts)


def test_noise_of_the_stated_size_is_no_way(tmp_path: Path) -> None:
    assert navbound.analyze(table(tmp_path / "a.csv", 0.0, 0.0, sigma_m=60.0)).summary.verdict.position_doubts == []


def test_two_minutes_that_contradict_are_no_doubt_yet(tmp_path: Path) -> None:
    stated = np.full(N, 80.0)
    stated[60:180] = 0.0
    assert navbound.analyze(table(tmp_path / "a.csv", 80.0, stated)).summary.verdict.position_doubts == []


@pytest.mark.parametrize("rows", [1, 7, 59, 61, 1000])
def test_pieces_of_any_length_give_the_same_words(tmp_path: Path, rows: int) -> None:
    epochs = navbound.analyze(table(tmp_path / "a.csv", 11.0, 0.0)).epochs
    speeds = Speeds()
    for begin in range(0, epochs.height, rows):
        speeds.see(epochs[begin : begin + rows])
    assert speeds.doubts() == doubts_of_speeds(epochs) != []
