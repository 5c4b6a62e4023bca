"""A file whose own accuracies contradict each other shows nothing by the smaller of them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import navbound
from test_verdict import table

N = 400
SIGMA_M = 3.0
TWO_DRMS_M = 2.0 * math.sqrt(2.0) * SIGMA_M


@pytest.mark.parametrize(("epu_m", "expected"), [(5000.0, "not_shown"), (1.01 * TWO_DRMS_M, "not_shown"), (0.99 * TWO_DRMS_M, "inside")])
def test_an_epu_beyond_the_covariance_is_against_it(tmp_path: Path, epu_m: float, expected: str) -> None:
    summary = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={"epu_m": np.full(N, epu_m)})).summary
    assert summary.verdict.id == expected
    assert summary.verdict.n_stated_worse == (N if expected == "not_shown" else 0)
    assert any("Stated beside it and not used: EPU" in words for words in summary.assumptions)
