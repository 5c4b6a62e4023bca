"""The fault campaign: flights of a quarter of an hour, each with a fault of a kind, a size and a time.

A tile is a kind in one size at one time on a few flights. Flights are drawn by their number alone, so the same flights meet every fault,
and the healthy ones are the same again.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import polars as pl

from navbound.errors import InputError
from navbound.run import fly
from navbound.run.judge import judge
from navbound.run.settings import Settings
from navbound.scale import map_tiles
from navbound.scenario import Scenario, load
from navbound.studies.fault_campaign.kinds import KINDS, ONSETS_S
from navbound.studies.fault_campaign.measures import COUNTS, measures
from navbound.studies.fault_campaign.records import Study, summed

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Unpack

    from numpy.typing import NDArray

    from navbound.scale import Work

SCENARIO = Path(__file__).parents[2] / "scenario" / "shipped" / "studies" / "fault-campaign.toml"
FLIGHTS = 5
HEALTHY = "healthy"
_BY_ID = {kind.id: kind for kind in KINDS}
_REASON_LENGTH = 400


class Tile(NamedTuple):
    """Flights ``0 .. flights`` with one fault: its kind, and the places of its size and its time in their lists."""

    kind: str
    size: int
    onset: int
    flights: int


@dataclass(frozen=True)
class Runs:
    """A row of counts for each flight of a tile. The scenario is text: its bytes are the same in every process."""

    scenario: str
    seed: int

    def __call__(self, tile: Tile) -> dict[str, NDArray[np.generic]]:
        """Fly and judge the flights of a tile."""
        scenario, onset_s = faulty(opened(self.scenario), tile)
        rows = [measures(frame, onset_s) for frame in flown(scenario, tile.flights, self.seed)]
        numbers = {name: np.array([row[name] for row in rows], dtype=float) for name in (*COUNTS, "delay_s", "error_most_m")}
        return numbers | {"reasons": np.array([str(row["reasons"])[:_REASON_LENGTH] for row in rows], dtype=f"U{_REASON_LENGTH}")}


@lru_cache(maxsize=1)
def opened(scenario: str) -> Scenario:
    """A scenario from its text, once in a process."""
    return Scenario.model_validate_json(scenario)


def flown(scenario: Scenario, flights: int, seed: int) -> list[pl.DataFrame]:
    """The judged epochs of each flight."""
    epochs = judge(fly.material(scenario, flights=flights, seed=seed), Settings(methods=())).epochs
    return [frame for _, frame in epochs.group_by("track", maintain_order=True)]


def faulty(scenario: Scenario, tile: Tile) -> tuple[Scenario, float]:
    """The scenario with the fault of a tile, and when it begins [s]; healthy flights have none at all, which begins after their end."""
    if tile.kind == HEALTHY:
        return scenario, scenario.duration_s
    kind = _BY_ID[tile.kind]
    change = kind.change(kind.sizes[tile.size], ONSETS_S[tile.onset])
    data: dict[str, Any] = scenario.model_dump()
    faults = change.get("faults", [])
    data["sensors"]["faults"] = faults
    data["filter"] |= change.get("filter", {})
    return Scenario.model_validate(data), min((fault["start_s"] for fault in faults), default=0.0)


def tiles(kinds: Sequence[str], sizes: Sequence[int], onsets: Sequence[int], flights: int) -> list[Tile]:
    """Every tile, the healthy flights first; a kind that acts from the begin is flown once whatever the times."""
    tiles = [Tile(HEALTHY, 0, 0, flights)]
    for name in kinds:
        kind = _BY_ID[name]
        for size in (s for s in sizes if s < len(kind.sizes)):
            changes: list[Any] = []
            for onset in onsets:
                change = kind.change(kind.sizes[size], ONSETS_S[onset])
                if change not in changes:
                    changes.append(change)
                    tiles.append(Tile(name, size, onset, flights))
    return tiles


def run(
    *,
    kinds: Sequence[str] | None = None,
    sizes: Sequence[int] = range(6),
    onsets: Sequence[int] = range(len(ONSETS_S)),
    flights: int = FLIGHTS,
    seed: int | None = None,
    **work: Unpack[Work],
) -> Study:
    """Fly the campaign, or a part of it.

    Parameters
    ----------
    kinds : sequence of str, optional
        Ids of :data:`navbound.studies.fault_campaign.kinds.KINDS`; all without it.
    sizes, onsets : sequence of int, optional
        Places in the lists of sizes and times. [1]
    flights : int, optional
        Of each kind, size and time. [1]
    seed : int, optional
        In place of the scenario's.
    **work
        Who flies, and what is kept: as in :func:`navbound.scale.map_tiles`; progress counts tiles.

    Returns
    -------
    Study
        A row for each kind and size; the same bits from any back end.

    Raises
    ------
    InputError
        An unknown kind, size or time, flights outside [1, 1000].
    """
    names = [kind.id for kind in KINDS] if kinds is None else list(kinds)
    for name in names:
        if name not in _BY_ID:
            raise InputError("kinds", name, domain=f"one of {', '.join(_BY_ID)}")
    if not set(onsets) <= set(range(len(ONSETS_S))):
        raise InputError("onsets", list(onsets), "1", f"[0, {len(ONSETS_S) - 1}]")
    scenario = load(SCENARIO)
    cut = tiles(names, sizes, onsets, flights)
    parts = map_tiles(Runs(scenario.model_dump_json(), scenario.seed if seed is None else seed), cut, **work)
    return summed([(_key(tile), table(part)) for tile, part in zip(cut, parts, strict=True)], flights=flights, n_tiles=len(cut))


def table(part: dict[str, NDArray[np.generic]]) -> pl.DataFrame:
    """The rows of a tile."""
    return pl.DataFrame({name: values.tolist() for name, values in part.items()})


def _key(tile: Tile) -> tuple[str, str, str, float]:
    if tile.kind == HEALTHY:
        return HEALTHY, "none", "", float("nan")
    kind = _BY_ID[tile.kind]
    return kind.id, kind.family, kind.unit, kind.sizes[tile.size]
