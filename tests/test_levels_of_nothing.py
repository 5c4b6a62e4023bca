"""A protection level of nothing is none, for tracks and for service levels alike."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import navbound
from test_verdict import command, table

N = 400


@pytest.mark.parametrize("name", ["hpl", "hpl_m"])
def test_a_level_of_zero_is_no_level(tmp_path: Path, name: str) -> None:
    summary = navbound.analyze(table(tmp_path / "a.csv", N, added={name: np.zeros(N)})).summary
    assert summary.verdict.id == "not_shown"
    assert "holds none in the tracks of 400 judged epochs" in summary.verdict.words
    assert [(each.reason, each.count) for each in summary.rejected] == [
        (f"{name}: 0 or less is no protection level; row used without it", N)
    ]


def test_a_level_above_zero_is_one(tmp_path: Path) -> None:
    assert navbound.analyze(table(tmp_path / "a.csv", N, added={"hpl": np.full(N, 15.0)})).summary.verdict.id == "inside"


def test_epochs_without_a_level_are_named_as_that(tmp_path: Path) -> None:
    levels = np.where(np.arange(N) < 12, np.nan, 15.0)
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, added={"hpl": levels})).summary.verdict
    assert (verdict.id, verdict.n_outside, verdict.n_degraded) == ("outside", 12, 0)
    assert "12 epochs have no protection level, where others have one" in verdict.words
    assert "degraded epochs" not in verdict.words


def test_service_levels_have_the_same_rule(tmp_path: Path) -> None:
    path = tmp_path / "l.csv"
    rows = "".join(f"{1_600_000_000 + k},1.0,1.0,1.0,0,0\n" for k in range(60))
    path.write_text("time,nse_e_m,nse_n_m,nse_u_m,hpl_m,vpl_m\n" + rows)
    done = command("evaluate", path, "--levels", "LPV-200", "--out", tmp_path / "run")
    assert done.returncode == 4, done.stderr
    assert "no epoch has a protection level" in " ".join(done.stdout.split())


@pytest.mark.parametrize(
    ("column", "against", "fine"),
    [("valid", "0", "1"), ("alert", "warning", "normal"), ("raim_alert", "yes", "no"), ("gps_ok", "false", "true")],
)
def test_what_a_table_of_levels_states_against_an_epoch_takes_its_level(tmp_path: Path, column: str, against: str, fine: str) -> None:
    head = f"time,hpl_m,vpl_m,nse_e_m,nse_n_m,nse_u_m,{column}"
    for word, expected in ((against, 0.5), (fine, 1.0)):
        rows = [f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z,12,15,1,-1,{k % 3},{word if k % 2 else fine}" for k in range(600)]
        (tmp_path / "a.csv").write_text("\n".join([head, *rows]) + "\n")
        results = navbound.evaluate(tmp_path / "a.csv", levels=("APV-I",)).summary.performance
        assert results is not None
        assert results.levels[0].availability_expected == expected
