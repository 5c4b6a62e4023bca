"""A simulated campaign as material for judging: any kind of scenario, estimate, truth, covariance and path, second by second."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.records.material import Material
from navbound.run import flight, ground
from navbound.run.campaign import Flown, fly_all, scenario_file, seed_in_force, track_name
from navbound.scenario import Scenario, Taxi, find, read

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path
    from typing import Unpack

    from navbound.run.campaign import Campaign
    from navbound.scale import Work

__all__ = ["material"]

SIMULATORS: dict[str, Callable[[str, int], Campaign]] = {"flight": flight.Flights, "taxi": ground.Flights}
"""Who flies each of :data:`navbound.scenario.KINDS`, from the text of the scenario and a seed."""


def material(
    scenario: str | Path | Scenario | Taxi,
    *,
    flights: int = 1,
    seed: int | None = None,
    pieces: bool = False,
    **work: Unpack[Work],
) -> Material:
    """Fly a scenario.

    Parameters
    ----------
    scenario : str, Path, Scenario or Taxi
        Name of a shipped scenario, path of a file, or one already read.
    flights : int, optional
        How many flights; each has random streams of its own, chosen by its number.
    seed : int, optional
        In place of the scenario's.
    pieces : bool, optional
        Epochs go to the disk flight by flight, so that the memory does not grow with their number; see :class:`Material`.
    **work
        Who flies, what is kept, who follows the progress: as in :func:`navbound.scale.map_tiles`; progress counts flights.

    Returns
    -------
    Material
        Tracks ``flight-000``, ``flight-001``, ...; the same scenario, seed and number give the same epochs on any number of cores, from
        any back end.

    Raises
    ------
    InputError
        A scenario that is not there, flights outside [1, 1000], a seed outside [0, 2^64), an unknown back end, a fault of a satellite that
        is not there, a taxi route that cannot be driven.
    FormatError
        A scenario file that cannot be flown, a folder that cannot keep tiles.
    """
    loaded = scenario if isinstance(scenario, (Scenario, Taxi)) else read(scenario)
    seed_used = seed_in_force(flights, seed, loaded.seed)
    campaign = SIMULATORS[loaded.kind](loaded.model_dump_json(), seed_used)
    flown, tables = Flown(), list[pl.DataFrame]()
    for epochs, reported in fly_all(campaign, flights, campaign.at_once, **work):
        if pieces:
            flown.see(epochs, reported)
        else:
            flown.reported += reported
            tables.append(epochs)
    context = campaign.context(flights, flown.reported)
    return Material(
        epochs=pl.DataFrame(schema=flown.epochs.schema) if pieces else pl.concat(tables),
        frames=flown.epochs if pieces else None,
        with_levels=frozenset(flown.with_levels),
        kind="fly",
        title=loaded.title,
        operation=loaded.operation,
        sample_period_s=1.0,
        labels={track_name(i): f"Flight {i + 1}" for i in range(flights)},
        inputs=[] if isinstance(scenario, (Scenario, Taxi)) else [scenario_file(find(scenario))],
        scenario=loaded.model_dump(mode="json"),
        seed=seed_used,
        requirement=context.requirement,
        assumptions=context.assumptions,
        covariance=context.covariance,
        waypoints=context.waypoints,
        settings={"flights": flights} | context.settings,
        events=context.events,
        limits_held=context.limits_held,
    )
