"""Campaigns of many flights: the same bits whoever flies them, nothing flown twice after an interruption, nothing flown for nothing."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import navbound
from navbound import FormatError, InputError, scale, scenario
from navbound.records.material import Material
from navbound.run import campaign, flight, fly
from navbound.run import ground as taxi
from navbound.scenario import Scenario
from navbound.studies.anp_comparison import study as anp_comparison
from navbound.studies.tse_coverage import study as tse_coverage

TAXI = "barcelona-taxi"


@pytest.fixture(scope="module")
def quick() -> Scenario:
    """Sensors and a filter, few of both: ranges of one constellation and ten samples a second."""
    loaded = scenario.load("beijing-shanghai")
    assert loaded.sensors is not None
    assert loaded.sensors.gnss is not None
    sensors = loaded.sensors.model_copy(update={"rate_hz": 10, "gnss": loaded.sensors.gnss.model_copy(update={"constellations": ["gps"]})})
    return loaded.model_copy(update={"sensors": sensors})


@pytest.fixture
def one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tile a flight, so that few flights are many tiles."""
    for module in (flight, taxi):
        for name in ("_FUSED_AT_ONCE", "_DRAWN_AT_ONCE", "_AT_ONCE"):
            if hasattr(module, name):
                monkeypatch.setattr(module, name, 1)


def same(first: Material, second: Material) -> bool:
    """Bit for bit: polars compares floats by value, and no column holds a NaN or a negative zero beside a zero."""
    return first.epochs.equals(second.epochs) and first.settings == second.settings and first.events == second.events


@pytest.mark.usefixtures("one_by_one")
def test_fused_flights_have_the_same_bits_from_processes(quick: Scenario) -> None:
    alone = fly.material(quick, flights=2)
    assert same(fly.material(quick, flights=2, backend="processes", workers=scale.Workers(2)), alone)
    reported = alone.settings["filter"]
    assert isinstance(reported, dict)
    # One restart more or less would be a filter more: two flights, two filters.
    assert reported["restarts"] == 0
    assert reported["samples"]["done"] == 2 * 70_800


@pytest.mark.usefixtures("one_by_one")
def test_flights_have_the_same_bits_from_a_cluster() -> None:
    pytest.importorskip("distributed", reason="SKIPPED ALOUD: Dask is not installed")
    alone = fly.material("beijing-shanghai-drawn", flights=3)
    assert same(fly.material("beijing-shanghai-drawn", flights=3, backend="dask", workers=scale.Workers(2)), alone)


@pytest.mark.usefixtures("one_by_one")
def test_taxiing_has_the_same_bits_from_processes() -> None:
    alone = fly.material(TAXI, flights=3)
    assert same(fly.material(TAXI, flights=3, backend="processes", workers=scale.Workers(2)), alone)
    assert {e.track for e in alone.events} == {"flight-000", "flight-001", "flight-002"}


@pytest.mark.usefixtures("one_by_one")
def test_an_interrupted_campaign_goes_on_where_it_was(tmp_path: Path) -> None:
    def interrupt(done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fly.material("beijing-shanghai-drawn", flights=4, checkpoint=tmp_path, progress=interrupt)
    reported: list[tuple[int, int]] = []
    material = fly.material(
        "beijing-shanghai-drawn", flights=4, checkpoint=tmp_path, progress=lambda done, total: reported.append((done, total))
    )
    assert reported == [(2, 4), (3, 4), (4, 4)]
    assert same(material, fly.material("beijing-shanghai-drawn", flights=4))
    # Another seed is another campaign.
    reported.clear()
    fly.material(
        "beijing-shanghai-drawn", flights=4, seed=1, checkpoint=tmp_path, progress=lambda done, total: reported.append((done, total))
    )
    assert reported[0] == (0, 4)


def test_a_tile_is_known_again_by_another_process(quick: Scenario) -> None:
    # The name of a kept tile is a digest of this; a set or a hash in it would differ from process to process.
    text = quick.model_dump_json()
    assert flight.Flights(text, 1) == flight.Flights(Scenario.model_validate_json(text).model_dump_json(), 1)
    assert json.loads(text) == quick.model_dump(mode="json")


def test_progress_of_the_comparison_counts_the_flights_of_all_cases(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(anp_comparison, "CASES", (("a", "x", 1), ("b", "y", 2)))
    requested: list[tuple[str, int]] = []

    def case(name: str, scenario: str, flights: int, **work: Any) -> Any:
        requested.append((name, flights))
        work["progress"](flights, flights)
        return SimpleNamespace(flights=flights)

    monkeypatch.setattr(anp_comparison, "_case", case)
    monkeypatch.setattr(anp_comparison, "Study", lambda **_: None)
    for part in ("_entries", "_words"):
        monkeypatch.setattr(anp_comparison, part, lambda _: [])
    reported: list[tuple[int, int]] = []
    anp_comparison.run(flights=6, progress=lambda done, total: reported.append((done, total)))
    assert requested == [("a", 6), ("b", 3)]
    assert reported == [(6, 9), (9, 9)]
    with pytest.raises(InputError, match="flights"):
        anp_comparison.run(flights=0)


def test_the_drawn_row_of_the_coverage_study_is_kept_in_parts(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tse_coverage, "DRAWN_AT_ONCE", 4_000)
    first = tse_coverage.run(step_s=3600, monte_carlo=10_000, checkpoint=tmp_path)
    drawn = next(row for row in first.rows if row.origin == "monte carlo")
    assert drawn.n_samples == 10_000
    # Five laws and three parts of the drawn row.
    assert len(list(tmp_path.glob("*.npz"))) == 8
    reported: list[tuple[int, int]] = []
    again = tse_coverage.run(
        step_s=3600, monte_carlo=10_000, checkpoint=tmp_path, progress=lambda done, total: reported.append((done, total))
    )
    assert again == first
    assert reported == [(8, 8)]
    # Each part has a stream of its own: the first part alone says something else.
    assert tse_coverage.run(step_s=3600, monte_carlo=4_000).rows[2].accuracy != drawn.accuracy


@pytest.mark.parametrize("name", ["surface-movement", "decorrelation-time"])
def test_a_study_that_is_not_cut_refuses_who_should_work(name: str) -> None:
    refused: tuple[scale.Work, ...] = ({"backend": "processes"}, {"workers": scale.Workers(2)}, {"checkpoint": "x"})
    for work in refused:
        with pytest.raises(InputError, match="this study runs in one process"):
            navbound.study(name, **work)


def test_a_directory_that_cannot_be_written_is_refused_before_the_flights(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def flown(*_: object, **__: object) -> Material:
        pytest.fail("flown for nothing")

    monkeypatch.setattr(fly, "material", flown)
    (tmp_path / "letter.txt").write_text("dear")
    for name in ("beijing-shanghai", "barcelona-taxi"):
        with pytest.raises(FormatError, match=r"letter\.txt"):
            navbound.fly(name, flights=1000, out=tmp_path)


@pytest.mark.parametrize("flights", [0, 1001, -3, 2.5])
def test_a_campaign_of_no_flights_or_too_many_is_refused(flights: int) -> None:
    with pytest.raises(InputError, match=r"flights = .* outside \[1, 1000\]"):
        campaign.seed_in_force(flights, None, 7)


def test_the_scenarios_seed_counts_where_the_input_has_none() -> None:
    assert campaign.seed_in_force(1, None, 7) == 7
    assert campaign.seed_in_force(1, 0, 7) == 0
    with pytest.raises(InputError, match="seed"):
        campaign.seed_in_force(1, 2**64, 7)
