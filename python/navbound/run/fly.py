"""A simulated flight as material for judging: estimate, truth, covariance and path, second by second."""

from __future__ import annotations

import hashlib
import itertools
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.run.material import Material
from navbound.run.records import InputFile, Waypoint
from navbound.scenario import Scenario, find, load

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["material"]

_CHUNK = 8
"""Flights between two reports of progress: enough to keep the cores busy."""
_CODES = ("leg", "phase", "available", "flight", "reason")
"""Columns that become words."""


def material(
    scenario: str | Path | Scenario,
    *,
    flights: int = 1,
    seed: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Material:
    """Fly a scenario.

    Parameters
    ----------
    scenario : str, Path or Scenario
        Name of a shipped scenario, path of a file, or one already read.
    flights : int, optional
        How many flights; each has random streams of its own, chosen by its number.
    seed : int, optional
        In place of the scenario's.
    progress : callable, optional
        Called with the flights done and their total.

    Returns
    -------
    Material
        Tracks ``flight-000``, ``flight-001``, ...; the same scenario, seed and number give the same epochs on any number of cores.

    Raises
    ------
    InputError
        A scenario that is not there, fewer than one flight, a seed outside [0, 2^64).
    FormatError
        A scenario file that cannot be flown.
    """
    found = scenario if isinstance(scenario, Scenario) else load(scenario)
    if not (isinstance(flights, int) and 1 <= flights <= 100_000):
        raise InputError("flights", flights, domain="[1, 100000]")
    chosen = found.seed if seed is None else seed
    if not (isinstance(chosen, int) and 0 <= chosen < 2**64):
        raise InputError("seed", chosen, domain="[0, 2^64)")
    outlook = _core.Outlook(found.core_json())
    parts = []
    for first in range(0, flights, _CHUNK):
        count = min(_CHUNK, flights - first)
        parts.append(_table(outlook.fly(chosen, first, count), found))
        if progress is not None:
            progress(first + count, flights)
    plan = outlook.plan()
    return Material(
        epochs=pl.concat(parts),
        kind="fly",
        title=found.title,
        requirement="RNP by phase of flight",
        sample_period_s=1.0,
        assumptions=_assumptions(found),
        labels={_track(i): f"Flight {i + 1}" for i in range(flights)},
        waypoints=[Waypoint(name=w.name, lat_rad=w.lat_rad, lon_rad=w.lon_rad, kind=w.kind) for w in found.waypoints],
        inputs=[] if isinstance(scenario, Scenario) else [_input_file(find(scenario))],
        scenario=found.model_dump(mode="json"),
        seed=chosen,
        settings={"flights": flights, **{key: plan[key] for key in ("length_m", "cruise_speed_mps", "top_of_climb_s", "top_of_descent_s")}},
    )


def _table(columns: dict[str, Any], scenario: Scenario) -> pl.DataFrame:
    available = columns["available"] == 1
    reasons = np.full(available.shape, None, dtype=object)
    reasons[~available] = columns["reason"]
    names = [w.name for w in scenario.waypoints]
    legs = [f"{a}-{b}" for a, b in itertools.pairwise(names)]
    words = {
        "track": _words([_track(i) for i in range(int(columns["flight"].max()) + 1)], columns["flight"]),
        "leg": _words(legs, columns["leg"]),
        "phase": _words([p.name for p in scenario.phases], columns["phase"]),
        "status": _words(["not_available", "ok"], columns["available"]),
        "reason": pl.Series(reasons, dtype=pl.String),
    }
    numbers = {name: values for name, values in columns.items() if name not in _CODES}
    table = pl.DataFrame({"track": words.pop("track"), "time_ns": numbers.pop("time_ns"), **numbers, **words})
    # A value that does not exist is null in a table.
    return table.with_columns(pl.col(pl.Float64).fill_nan(None)).with_columns(pl.col("n_sv").cast(pl.Int32))


def _words(words: list[str], codes: np.ndarray[Any, Any]) -> pl.Series:
    return pl.Series(words, dtype=pl.String).gather(pl.Series(codes.astype(np.uint32)))


def _track(number: int) -> str:
    return f"flight-{number:03d}"


def _assumptions(scenario: Scenario) -> list[str]:
    said = list(scenario.assumptions)
    scale = scenario.navigation.claimed_sigma_scale
    if scale != 1.0:
        said.append(f"The covariance claims {scale:g} times the true standard deviation: it is dishonest on purpose.")
    if scenario.faults:
        said.append(f"Faults are injected: {', '.join(f'{f.kind} from {f.start_s:g} s for {f.duration_s:g} s' for f in scenario.faults)}.")
    return said


def _input_file(path: Path) -> InputFile:
    data = path.read_bytes()
    return InputFile(path=str(path), sha256=hashlib.sha256(data).hexdigest(), n_bytes=len(data), n_rows=None)
