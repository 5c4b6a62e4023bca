"""Campaigns whose epochs go to the disk flight by flight: the bits of the whole, and no more in memory for more flights."""

from __future__ import annotations

import gc
import json
import weakref
from datetime import datetime
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

from navbound import scale
from navbound.examples.tracks import approach
from navbound.read.runways import runway
from navbound.report import payload
from navbound.run import campaign, flight, fly
from navbound.run.directory import Run
from navbound.run.judge import judge
from navbound.run.settings import Settings
from navbound.scenario import Scenario
from navbound.storage.frames import Frames

FEW = Settings(methods=("anp-circle", "anp-sphere"))


@pytest.fixture(scope="module")
def short() -> Scenario:
    """Twenty minutes, an approach at their end."""
    return approach(runway("LFPG/08R"), 0.0, datetime(2026, 1, 1))


def page(run: Run) -> payload.Page:
    return payload.build(run.summary, run.record, run.table, run.events, run.waypoints)


def test_flights_on_the_disk_give_the_bits_of_those_in_memory(short: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flight, "_DRAWN_AT_ONCE", 4)
    monkeypatch.setattr(campaign, "PIECE_ROWS", 2000)
    whole, run = (judge(fly.material(short, flights=11, pieces=pieces), FEW) for pieces in (False, True))
    assert isinstance(whole.table, pl.DataFrame)
    assert isinstance(run.table, Frames)
    assert run.summary.model_dump_json() == whole.summary.model_dump_json()
    honesty = run.summary.honesty
    # Eleven flights are enough for the interval of circle and sphere.
    assert honesty is not None
    assert [each.region for each in honesty.regions] == ["circle", "sphere"]
    assert run.epochs.equals(whole.epochs)
    assert run.epochs.schema == whole.epochs.schema
    assert run.events.equals(whole.events)
    one, other = page(whole), page(run)
    assert one.tracks == other.tracks
    assert one.data | {"record": None} == other.data | {"record": None}


def most_rows(short: Scenario, flights: int, monkeypatch: pytest.MonkeyPatch) -> int:
    """Rows of all tables that are alive at once, when a flight is put away."""
    put, most = Frames.put, 0

    def counted(frames: Frames, piece: pl.DataFrame) -> None:
        nonlocal most
        gc.collect()
        alive = [each for each in gc.get_objects() if isinstance(each, pl.DataFrame) and "track" in each.columns]
        most = max(most, sum(table.height for table in alive))
        put(frames, piece)

    with monkeypatch.context() as patched:
        patched.setattr(Frames, "put", counted)
        judge(fly.material(short, flights=flights, pieces=True), FEW)
    return most


def test_tables_in_memory_do_not_grow_with_the_number_of_flights(short: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flight, "_DRAWN_AT_ONCE", 1)
    few, many = (most_rows(short, flights, monkeypatch) for flights in (2, 5))
    assert 0 < many == few


class Tracked:
    """A tile's result whose array can be seen to be alive."""

    def __init__(self) -> None:
        self.arrays: list[weakref.ref[NDArray[np.generic]]] = []

    def __call__(self, tile: int) -> dict[str, NDArray[np.generic]]:
        array = np.full(3, tile)
        self.arrays.append(weakref.ref(array))
        return {"x": array}


def test_results_that_were_worked_off_are_freed() -> None:
    tracked = Tracked()
    for tile, result in enumerate(scale.in_order(tracked, range(20))):
        assert result["x"].tolist() == [tile] * 3
        assert sum(array() is not None for array in tracked.arrays) <= 2


def test_lists_of_the_page_are_cut_but_for_the_tracks_that_it_shows(short: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    run = judge(fly.material(short, flights=3))
    event = {
        "kind": "caution",
        "onset_ns": 0,
        "annunciation_ns": None,
        "clear_ns": None,
        "peak_m": 1.0,
        "limit_m": 1.0,
        "min_margin_m": 0.0,
    }
    rows: list[dict[str, Any]] = [{"track": f"flight-00{k % 3}"} | event | {"words": f"event {k}"} for k in range(30)]
    events = pl.DataFrame(rows, schema=run.events.schema)
    monkeypatch.setattr(payload, "MOST_LISTED", {"events": 7, "faults": 200})
    # No room but for the worst track, which is always there.
    made = payload.build(run.summary, run.record, run.table, events, run.waypoints, budget_bytes=0)
    (head,) = made.data["tracks"]
    listed = made.data["summary"]["events"]
    assert [e["words"] for e in listed if e["track"] == head["track"]] == [r["words"] for r in rows if r["track"] == head["track"]]
    assert [e["words"] for e in listed[:7]] == [r["words"] for r in rows[:7]]
    assert len(listed) < 30
    assert f"The page lists {len(listed)} of 30 events; all of them are in events.parquet." in json.dumps(
        made.data["summary"]["assumptions"]
    )
