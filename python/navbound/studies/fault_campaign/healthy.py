"""Healthy flights in large numbers: how often an alert is false, and how often a bound that is called good does not hold."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import polars as pl

from navbound.errors import InputError
from navbound.scale import map_tiles
from navbound.scenario import load
from navbound.studies.fault_campaign.measures import measures
from navbound.studies.fault_campaign.records import HealthyStudy, healthy
from navbound.studies.fault_campaign.study import SCENARIO, flown, opened, table

if TYPE_CHECKING:
    from typing import Unpack

    from numpy.typing import NDArray

    from navbound.scale import Work

HOURS = 3800.0
"""Hours of flight from which none false shows less than 1e-3 an hour: -ln(0.025) / 1e-3, and the seconds in which a flight settles. [h]"""
HOURS_MOST = 1e5
FLIGHTS_OF_TILE = 5
BEFORE = ("healthy_s", "n_false_alerts", "healthy_not_ok_s")
WHOLE = ("n_ok", "n_ok_wrong", "n_late")


class Tile(NamedTuple):
    """Flights with a seed of their own."""

    seed: int
    flights: int


@dataclass(frozen=True)
class Flights:
    """A row of counts for each flight of a tile."""

    scenario: str

    def __call__(self, tile: Tile) -> dict[str, NDArray[np.generic]]:
        """Fly and judge the flights of a tile."""
        scenario = opened(self.scenario)
        frames = flown(scenario, tile.flights, tile.seed)
        before, whole = ([measures(frame, onset_s) for frame in frames] for onset_s in (scenario.duration_s, 0.0))
        counted = {name: [row[name] for row in before] for name in BEFORE} | {name: [row[name] for row in whole] for name in WHOLE}
        return {name: np.array(values, dtype=float) for name, values in counted.items()}


def run(*, hours: float = HOURS, seed: int = 1, **work: Unpack[Work]) -> HealthyStudy:
    """Fly the scenario of the fault campaign without a fault.

    Parameters
    ----------
    hours : float, optional
        Flight time at least. [h]
    seed : int, optional
        Of the first tile; each tile has the next one. [1]
    **work
        Who flies, and what is kept: as in :func:`navbound.scale.map_tiles`; progress counts tiles of five flights.

    Returns
    -------
    HealthyStudy
        Sums over all flights; the same bits from any back end.

    Raises
    ------
    InputError
        Hours outside (0, 1e5].
    """
    if not 0 < hours <= HOURS_MOST:
        raise InputError("hours", hours, "h", f"(0, {HOURS_MOST:g}]")
    scenario = load(SCENARIO)
    n = ceil(hours * 3600 / scenario.duration_s / FLIGHTS_OF_TILE)
    parts = map_tiles(Flights(scenario.model_dump_json()), [Tile(seed + k, FLIGHTS_OF_TILE) for k in range(n)], **work)
    rows = pl.concat([table(part) for part in parts])
    n_ok, n_ok_wrong, n_late = (int(rows[name].sum()) for name in WHOLE)
    return HealthyStudy(flights=rows.height, seed=seed, healthy=healthy(rows), n_ok=n_ok, n_ok_wrong=n_ok_wrong, n_late=n_late)
