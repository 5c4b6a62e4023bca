"""A track has one name, in the terminal, in the verdict and in the report: its label."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import polars as pl
import typer

import navbound
from navbound.cli.show import show
from navbound.records.faults import FaultSummary
from test_verdict import table

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

N = 60


def test_terminal_and_verdict_say_the_label_of_the_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    frames = [
        pl.read_csv(table(tmp_path / "t.csv", N, added={"track": [track] * N, "callsign": [callsign] * N}))
        for track, callsign in (("4b1234", "SWR1"), ("4b5678", "SWR2"))
    ]
    pl.concat(frames).write_csv(tmp_path / "a.csv")
    run = navbound.analyze(tmp_path / "a.csv")
    summary = run.summary
    assert {each.track: each.label for each in summary.tracks} == {"4b1234": "SWR1", "4b5678": "SWR2"}
    worst = summary.verdict.worst_accuracy
    assert worst is not None
    assert f"track {'SWR1' if worst.track == '4b1234' else 'SWR2'}." in summary.verdict.words
    # Its words alone are printed.
    stated: dict[str, Any] = {"track": "4b5678", "kind": "spoofing", "words": "what the monitors said"}
    faulty = summary.model_copy(update={"faults": [FaultSummary.model_construct(**stated)]})
    with contextlib.suppress(typer.Exit):
        show(replace(run, summary=faulty), json=False)
    printed = capsys.readouterr().out
    assert "SWR2, spoofing: what the monitors said" in printed
    assert "4b1234" not in printed
    assert "4b5678" not in printed
