"""A landing and the way to the stand as material for judging: estimate, truth, covariance, path and protection levels, second by second."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import gbas
from navbound.gbas.modes import K95
from navbound.records.material import Material
from navbound.records.run import CovarianceOrigin, EventSummary, Waypoint
from navbound.run.campaign import fly_all, scenario_file, seed_in_force, track_name
from navbound.run.ground import errors
from navbound.run.ground.motion import move
from navbound.run.ground.navigation import Navigated, Navigator
from navbound.scenario import taxi as scenarios
from navbound.status import USABLE
from navbound.table.columns import HORIZONTAL

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Unpack

    from navbound.gbas import SubPhase
    from navbound.run.ground.motion import Movement
    from navbound.scale import Work
    from navbound.scenario.taxi import Taxi

_AT_ONCE = 4
"""Flights of one tile, of some tenths of a second each."""

__all__ = ["limits", "material"]


def limits() -> dict[str, SubPhase]:
    """What each sub-phase asks; the landing roll, for which nothing was found, what the rapid exit taxiway asks (inferred)."""
    phases = gbas.sub_phases()
    return {"RWY": replace(phases["RET"], id="RWY", title="landing roll")} | phases


def material(file: Path, *, flights: int = 1, seed: int | None = None, **work: Unpack[Work]) -> Material:
    """Land and taxi.

    Parameters
    ----------
    file : Path
        A scenario of kind ``taxi``.
    flights : int, optional
        How many; each has random streams of its own, chosen by its number.
    seed : int, optional
        In place of the scenario's.
    **work
        Who flies, what is kept, who is told: as in :func:`navbound.scale.map_tiles`; progress counts flights.

    Returns
    -------
    Material
        Tracks ``flight-000``, ...; the same scenario, seed and number give the same epochs, from any back end.

    Raises
    ------
    InputError
        Flights outside [1, 1000], a seed outside [0, 2^64), a fault of a satellite that is not there, a route that cannot be driven.
    FormatError
        A scenario file that cannot be read.
    """
    found = scenarios.load(file)
    chosen = seed_in_force(flights, seed, found.seed)
    fly = _Flights(found.model_dump_json(), chosen)
    ground = _ground(fly.taxi)
    epochs, events = fly_all(fly, flights, _AT_ONCE, **work)
    return Material(
        epochs=epochs,
        kind="fly",
        title=found.title,
        requirement="surface movement: twice RNP is the total system containment of each sub-phase (inferred)",
        sample_period_s=1.0,
        assumptions=_assumptions(found, ground.navigator, ground.asked),
        covariance=CovarianceOrigin(id="simulated"),
        labels={track_name(i): f"Flight {i + 1}" for i in range(flights)},
        waypoints=[Waypoint(name=p.name, lat_rad=p.lat_rad, lon_rad=p.lon_rad, kind="waypoint") for p in found.points],
        inputs=[scenario_file(file)],
        scenario=found.model_dump(mode="json"),
        seed=chosen,
        settings={"flights": flights, "length_m": float(ground.movement.along_m[-1]), "transition_s": ground.navigator.fixes},
        events=[EventSummary.model_validate(event) for event in events],
        limits_held={p.title: _held(p) for p in ground.asked.values()},
    )


@dataclass(frozen=True)
class _Ground:
    """What all flights of a scenario share."""

    taxi: Taxi
    asked: dict[str, SubPhase]
    movement: Movement
    navigator: Navigator


@lru_cache(maxsize=1)
def _ground(taxi: str) -> _Ground:
    """From a scenario as text, worked out once a process."""
    found, asked = scenarios.Taxi.model_validate_json(taxi), limits()
    movement = move(found, asked)
    navigator = Navigator(found, movement, asked)
    scenarios.check_satellites(found, navigator.sky.names)
    return _Ground(found, asked, movement, navigator)


@dataclass(frozen=True)
class _Flights:
    """Flights of a scenario by their numbers. The scenario is text: its bytes are the same in every process."""

    taxi: str
    seed: int

    def __call__(self, flights: range) -> tuple[pl.DataFrame, list[Any]]:
        ground = _ground(self.taxi)
        parts, events = [], []
        for track in flights:
            navigated = ground.navigator.fly(self.seed, track)
            parts.append(_table(ground.taxi, ground.movement, navigated, ground.asked, self.seed, track))
            events += [event.model_dump(mode="json") for event in _events(ground.taxi, navigated, parts[-1])]
        return pl.concat(parts), events


def _table(taxi: Taxi, movement: Movement, found: Navigated, asked: dict[str, SubPhase], seed: int, track: int) -> pl.DataFrame:  # noqa: PLR0917 - a scenario, its parts, and which flight
    n = len(movement.along_m)
    east_m, north_m = movement.per_radian_m
    budget = gbas.error_budget()
    fte = budget.sigma_fte_m * errors.gauss_markov(
        errors.stream(seed, track, errors.STEERING).standard_normal(n), taxi.motion.steering_time_s
    )
    # The aircraft steers by its estimate; where it really is lies an nse away.
    est_lat = movement.lat_rad - fte * np.sin(movement.course_rad) / north_m
    est_lon = movement.lon_rad + fte * np.cos(movement.course_rad) / east_m
    nse = -found.error_enu_m
    usable = np.isin(found.status.astype(np.str_), USABLE)
    phases = [asked[name] for name in movement.phase]
    numbers = {
        "est_lat_rad": np.where(usable, est_lat, np.nan),
        "est_lon_rad": np.where(usable, est_lon, np.nan),
        "truth_lat_rad": est_lat + nse[:, 1] / north_m,
        "truth_lon_rad": est_lon + nse[:, 0] / east_m,
        "path_lat_rad": movement.lat_rad,
        "path_lon_rad": movement.lon_rad,
        "course_rad": movement.course_rad,
        "along_m": movement.along_m,
        "ground_speed_mps": movement.speed_mps,
        "rnp_m": np.array([p.containment_m / 2 for p in phases]),
        "hal_m": np.array([p.hal_m for p in phases]),
        "accuracy_limit_m": np.array([gbas.accuracy_limit(p.containment_m, budget) for p in phases]),
        "fte_m": np.where(usable, fte, np.nan),
        "nse_e_m": nse[:, 0],
        "nse_n_m": nse[:, 1],
        **{name: found.covariance_m2[:, i, j] for name, (i, j) in zip(HORIZONTAL, ((0, 0), (0, 1), (1, 1)), strict=True)},
        "hpl_m": found.hpl_m,
        "hpl_multi_m": found.hpl_multi_m,
        "accuracy_m": found.accuracy_m,
    }
    legs = [f"{a.name}-{b.name}" for a, b in zip(taxi.points[:-1], taxi.points[1:], strict=True)]
    return pl.DataFrame(
        {
            "track": [track_name(track)] * n,
            "time_ns": taxi.start_ns + np.arange(n) * 1_000_000_000,
            **numbers,
            "n_sv": found.n_sv.astype(np.int64),
            "leg": [legs[k] for k in movement.leg],
            "phase": [p.title for p in phases],
            "mode": np.where(movement.coasts, "rraim", "gbas"),
            "status": pl.Series(found.status.tolist(), dtype=pl.String),
            "reason_id": pl.Series(found.reason_id.tolist(), dtype=pl.String),
            "reason": pl.Series(found.reason.tolist(), dtype=pl.String),
        }
    ).with_columns(pl.col(pl.Float64).fill_nan(None))


def _events(taxi: Taxi, found: Navigated, epochs: pl.DataFrame) -> list[EventSummary]:
    """Faults, what the monitors did, and where a protection level was above the alert limit."""
    track = epochs["track"][0]

    def at(second: int | None) -> int | None:
        return None if second is None else taxi.start_ns + second * 1_000_000_000

    events = [_point(track, h.kind, at(h.second), at(h.until), h.words) for h in found.happened]
    for column, words in (("hpl_m", "protection level for one fault"), ("hpl_multi_m", "protection level for all faults together")):
        level, limit = epochs[column].to_numpy(), epochs["hal_m"].to_numpy()
        above = np.concatenate([[False], level > limit, [False]])
        edges = np.flatnonzero(above[1:] != above[:-1])
        for first, last in zip(edges[::2], edges[1::2], strict=True):
            worst = first + int(np.argmin((limit - level)[first:last]))
            end = at(int(last)) if last < len(level) else None
            event = _point(track, f"{column[:-2]}_above_hal", at(int(first)), end, f"{words} above the alert limit (inferred)")
            events.append(
                event.model_copy(
                    update={
                        "peak_m": float(level[worst]),
                        "limit_m": float(limit[worst]),
                        "min_margin_m": float(limit[worst] - level[worst]),
                    }
                )
            )
    return events


def _point(track: str, kind: str, onset_ns: int | None, clear_ns: int | None, words: str) -> EventSummary:
    return EventSummary.model_validate(
        {"track": track, "kind": kind, "onset_ns": onset_ns, "annunciation_ns": onset_ns, "clear_ns": clear_ns, "words": words}
        | dict.fromkeys(("peak_m", "limit_m", "min_margin_m"))
    )


def _held(phase: SubPhase) -> str:
    return next(m.held for m in phase.marks if m.name == "hal")


def _assumptions(taxi: Taxi, navigator: Navigator, asked: dict[str, SubPhase]) -> list[str]:
    """What the report must say beside every number."""
    budget, navigation = gbas.error_budget(), taxi.navigation
    limit_words = ", ".join(f"{p.title} {p.hal_m:g} m" for p in asked.values())
    said = [
        f"Alert limits and containments are inferred: {limit_words}; nothing was found for the landing roll, it has the rapid exit's.",
        f"Mode {navigator.mode.id} ({navigator.mode.words}), case {navigation.case}; nominal range biases up to {navigation.bias_m:g} m.",
        f"Flight technical error of {budget.sigma_fte_m:g} m ({_mark(budget.marks, 'fte')}); "
        f"accuracy is {K95:.3g} deviations and the bias.",
        f"Coordinates: {taxi.source}.",
        *taxi.assumptions,
    ]
    if navigation.covariance == "paper":
        said.append("The covariance of the fix is the paper's form, which nothing shows to bound.")
    for f in taxi.faults:
        said.append(
            f"A fault is injected: {f.kind} of {f.satellite} from {f.start_s:g} s{', missed by the ground monitors' if f.missed else ''}."
        )
    return said


def _mark(marks: tuple[gbas.Mark, ...], part: str) -> str:
    return next((m.held for m in marks if part in m.name), "inferred")
