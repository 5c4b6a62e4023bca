"""One airframe flies several flights: what lies between two of them is no gap in which epochs are missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest

import navbound
from test_verdict import table

if TYPE_CHECKING:
    from pathlib import Path

N = 400


def recorded(folder: Path, callsigns: list[str | None], gap_s: int, *, track: str = "4b1234") -> Path:
    """Two parts of 200 s, the second `gap_s` after the end of the first, with the callsigns of both."""
    names = [callsigns[0]] * 200 + [callsigns[1]] * 200
    path = table(folder / "a.csv", N, added={"track": [track] * N, "callsign": names})
    late = pl.when(pl.int_range(pl.len()) >= 200).then(pl.lit((gap_s - 1) * 1_000_000_000, pl.Int64)).otherwise(0)
    frame = pl.read_csv(path).with_columns(pl.col("time_ns") + late)
    frame.write_csv(path)
    return path


@pytest.mark.parametrize(
    ("callsigns", "gap_s", "divided"),
    [
        (["SWR1", "SWR2"], 7200, True),
        (["SWR1", "SWR2"], 1801, True),
        (["SWR1", "SWR2"], 1800, False),
        (["SWR1", "SWR1"], 7200, False),
        (["SWR1", "SWR1  "], 7200, False),
        (["SWR1", None], 7200, False),
        ([None, "SWR2"], 7200, False),
    ],
)
def test_a_callsign_that_changes_in_a_long_gap_begins_another_flight(
    tmp_path: Path, callsigns: list[str | None], gap_s: int, divided: bool
) -> None:
    path = recorded(tmp_path, callsigns, gap_s)
    for piece_rows in (None, 150):
        run = navbound.analyze(path, piece_rows=piece_rows)
        assert run.summary.verdict.n_missing == (0 if divided else gap_s - 1)
        assert run.epochs["track"].unique(maintain_order=True).to_list() == (["4b1234", "4b1234 #002"] if divided else ["4b1234"])
        assert any("1 track was divided into 2 flights" in each for each in run.summary.assumptions) == divided


def test_rows_that_cannot_be_judged_stay_within_their_flight(tmp_path: Path) -> None:
    path = recorded(tmp_path, ["SWR1", "SWR2"], 7200)
    frame = pl.read_csv(path).with_columns(
        pl.when(~pl.int_range(pl.len()).is_in([50, 51, 250, 251, 252, 253, 254, 255])).then("est_lat_rad")
    )
    frame.write_csv(path)
    verdicts = [navbound.analyze(path, piece_rows=rows).summary.verdict for rows in (None, 7)]
    assert verdicts[0] == verdicts[1]
    assert (verdicts[0].n_missing, verdicts[0].n_epochs) == (8, N)


def test_three_flights_and_another_aircraft_stay_in_order(tmp_path: Path) -> None:
    frames = []
    for track, n in (("a", 3), ("b", 1)):
        frame = pl.read_csv(table(tmp_path / "t.csv", N, added={"track": [track] * N, "callsign": [f"X{k * n // N}" for k in range(N)]}))
        frames.append(frame.with_columns(time_ns=pl.col("time_ns") + pl.col("callsign").str.slice(1).cast(pl.Int64) * 3_600_000_000_000))
    pl.concat(frames).write_csv(tmp_path / "a.csv")
    whole = navbound.analyze(tmp_path / "a.csv")
    pieces = navbound.analyze(tmp_path / "a.csv", piece_rows=60)
    assert whole.epochs["track"].unique(maintain_order=True).to_list() == ["a", "a #002", "a #003", "b"]
    assert whole.summary.verdict == pieces.summary.verdict
    assert whole.summary.verdict.n_missing == 0
    assert np.array_equal(whole.epochs["track"].to_numpy(), pieces.epochs["track"].to_numpy())
