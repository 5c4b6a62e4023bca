"""Positions that stand far apart are no flight, and a row without a time is one epoch, whatever was written as its time."""

from __future__ import annotations

from pathlib import Path

import pytest

import navbound
from navbound.live.sinks import transition


def recorded(path: Path, times_s: list[int], more: str = "") -> Path:
    rows = [f"{1_700_000_000 + t},{48.0 + t * 1e-5:.6f},2.5,5,5" for t in times_s]
    path.write_text("\n".join(["time,lat,lon,sigma_e_m,sigma_n_m", *rows]) + "\n" + more)
    return path


@pytest.mark.parametrize(("period_s", "verdict"), [(60, "inside"), (61, "not_shown"), (600, "not_shown")])
def test_positions_more_than_a_minute_apart_show_nothing(tmp_path: Path, period_s: int, verdict: str) -> None:
    run = navbound.analyze(recorded(tmp_path / "a.csv", [period_s * k for k in range(50)]), spec="RNP 0.3")
    assert run.summary.verdict.id == verdict
    assert ("apart as a rule" in run.summary.verdict.words) == (verdict != "inside")


def test_a_row_with_a_time_that_is_none_is_one_epoch_that_is_missing(tmp_path: Path) -> None:
    run = navbound.analyze(recorded(tmp_path / "a.csv", list(range(500)), "3600,48.1,2.5,5,5\n"), spec="RNP 0.3")
    assert (run.summary.verdict.n_epochs, run.summary.verdict.n_missing, run.summary.verdict.id) == (501, 1, "inside")
    (rejection,) = run.summary.rejected
    assert (rejection.reason, rejection.count) == ("time: time outside 1980 to 2100", 1)


@pytest.mark.parametrize(("turn", "expected_ns"), [("raised", 12), ("cleared", 30), ("ended", 40)])
def test_a_line_has_the_time_at_which_an_alert_began_or_ended(turn: str, expected_ns: int) -> None:
    clear_ns = 30 if turn == "cleared" else None
    assert transition.turned_ns({"transition": turn, "annunciation_ns": 12, "clear_ns": clear_ns, "event_ns": 40}) == expected_ns
