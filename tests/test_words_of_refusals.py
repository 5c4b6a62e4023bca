"""A refusal speaks of the file and of what is allowed, in units of charts and never in names of the program."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import InputError
from test_verdict import START_NS, table


def test_a_track_without_an_approach_is_refused_in_words(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="NM before a threshold") as refused:
        navbound.analyze(table(tmp_path / "a.csv"), path="auto")
    assert "Gates(" not in str(refused.value)
    assert "_m=" not in str(refused.value)


@pytest.mark.parametrize("step_s", [3600, 3601, 86_400])
def test_steps_of_an_hour_and_more_are_judged_or_refused_in_words(tmp_path: Path, step_s: int) -> None:
    path = table(tmp_path / "a.csv", 5)
    frame = pl.read_csv(path).with_columns(time_ns=pl.Series(START_NS + np.arange(5) * step_s * 1_000_000_000))
    frame.write_csv(path)
    verdict = navbound.analyze(path).summary.verdict
    assert verdict.n_long_steps == 4
