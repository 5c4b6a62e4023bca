"""Flights of kind ``taxi``, a landing and the taxi-in: estimate, truth, covariance, path and protection levels, second by second."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import gbas
from navbound.gbas.modes import K95
from navbound.ground.motion import move
from navbound.ground.navigation import Navigated, Navigator
from navbound.records.run import CovarianceOrigin, EventSummary, Waypoint
from navbound.run.campaign import Context, track_name
from navbound.scenario import taxi as scenarios
from navbound.status import USABLE
from navbound.table.columns import HORIZONTAL

if TYPE_CHECKING:
    from navbound.gbas import SubPhase
    from navbound.ground.motion import Movement
    from navbound.scenario.taxi import Taxi

_AT_ONCE = 4
"""Flights of one tile, of some tenths of a second each."""

__all__ = ["Flights", "limits"]


def limits() -> dict[str, SubPhase]:
    """What each sub-phase asks; the landing roll, for which nothing was found, what the rapid exit taxiway asks (inferred)."""
    phases = gbas.sub_phases()
    return {"RWY": replace(phases["RET"], id="RWY", title="landing roll")} | phases


@dataclass(frozen=True)
class _Ground:
    """What all flights of a scenario share."""

    taxi: Taxi
    required: dict[str, SubPhase]
    movement: Movement
    navigator: Navigator


@lru_cache(maxsize=1)
def _ground(taxi: str) -> _Ground:
    """From a scenario as text, worked out once a process."""
    scenario, required = scenarios.Taxi.model_validate_json(taxi), limits()
    movement = move(scenario)
    navigator = Navigator(scenario, movement, required)
    return _Ground(scenario, required, movement, navigator)


@dataclass(frozen=True)
class Flights:
    """Flights of a scenario by their numbers. The scenario is text: its bytes are the same in every process."""

    scenario: str
    seed: int

    def __call__(self, flights: range) -> tuple[pl.DataFrame, list[Any]]:
        """Epochs of some flights, and their events."""
        ground = _ground(self.scenario)
        parts, events = [], []
        for track in flights:
            navigated = ground.navigator.fly(self.seed, track)
            parts.append(_table(ground.taxi, ground.movement, navigated, ground.required, self.seed, track))
            events += [event.model_dump(mode="json") for event in _events(ground.taxi, navigated, parts[-1])]
        return pl.concat(parts), events

    @property
    def at_once(self) -> int:
        """Flights of one tile."""
        # A scenario that cannot be driven is refused before any flight.
        _ground(self.scenario)
        return _AT_ONCE

    def context(self, flights: int, events: list[Any]) -> Context:  # noqa: ARG002 - another kind counts its filters
        """What is said of the epochs."""
        ground = _ground(self.scenario)
        taxi = ground.taxi
        return Context(
            requirement="surface movement: twice RNP is the total system containment of each sub-phase (inferred)",
            assumptions=_assumptions(taxi, ground.navigator, ground.required),
            covariance=CovarianceOrigin(id="simulated"),
            waypoints=[Waypoint(name=p.name, lat_rad=p.lat_rad, lon_rad=p.lon_rad, kind="waypoint") for p in taxi.points],
            settings={"length_m": float(ground.movement.along_m[-1]), "transition_s": ground.navigator.fixes},
            events=[EventSummary.model_validate(event) for event in events],
            limits_held={p.title: _provenance(p) for p in ground.required.values()},
        )


def _table(taxi: Taxi, movement: Movement, navigated: Navigated, required: dict[str, SubPhase], seed: int, track: int) -> pl.DataFrame:  # noqa: PLR0917 - a scenario, its parts, and which flight
    n = len(movement.along_m)
    east_m, north_m = movement.per_radian_m
    budget = gbas.error_budget()
    fte = budget.sigma_fte_m * movement.core.steering((seed, track), n)
    # The aircraft steers by its estimate; where it really is lies an nse away.
    est_lat, est_lon = movement.beside(fte)
    nse = -navigated.error_enu_m
    usable = np.isin(navigated.status.astype(np.str_), USABLE)
    phases = [required[name] for name in movement.phase]
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
        **{name: navigated.covariance_m2[:, i, j] for name, (i, j) in zip(HORIZONTAL, ((0, 0), (0, 1), (1, 1)), strict=True)},
        "hpl_m": navigated.hpl_m,
        "hpl_multi_m": navigated.hpl_multi_m,
        "accuracy_m": navigated.accuracy_m,
    }
    legs = [f"{a.name}-{b.name}" for a, b in zip(taxi.points[:-1], taxi.points[1:], strict=True)]
    return pl.DataFrame(
        {
            "track": [track_name(track)] * n,
            "time_ns": taxi.start_ns + np.arange(n) * 1_000_000_000,
            **numbers,
            "n_sv": navigated.n_sv.astype(np.int64),
            "leg": [legs[k] for k in movement.leg],
            "phase": [p.title for p in phases],
            "mode": np.where(movement.coasts, "rraim", "gbas"),
            "status": pl.Series(navigated.status.tolist(), dtype=pl.String),
            "reason_id": pl.Series(navigated.reason_id.tolist(), dtype=pl.String),
            "reason": pl.Series(navigated.reason.tolist(), dtype=pl.String),
        }
    ).with_columns(pl.col(pl.Float64).fill_nan(None))


def _events(taxi: Taxi, navigated: Navigated, epochs: pl.DataFrame) -> list[EventSummary]:
    """Faults, what the monitors did, and where a protection level was above the alert limit."""
    track = epochs["track"][0]

    def at(second: int | None) -> int | None:
        return None if second is None else taxi.start_ns + second * 1_000_000_000

    events = [_point(track, h.kind, at(h.second), at(h.until), h.words) for h in navigated.happened]
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


def _provenance(phase: SubPhase) -> str:
    return next(m.held for m in phase.marks if m.name == "hal")


def _assumptions(taxi: Taxi, navigator: Navigator, required: dict[str, SubPhase]) -> list[str]:
    """What the report must say beside every number."""
    budget, navigation = gbas.error_budget(), taxi.navigation
    limit_words = ", ".join(f"{p.title} {p.hal_m:g} m" for p in required.values())
    sentences = [
        f"Alert limits and containments are inferred: {limit_words}; nothing was found for the landing roll, it has the rapid exit's.",
        f"Mode {navigator.mode.id} ({navigator.mode.words}), case {navigation.case}; nominal range biases up to {navigation.bias_m:g} m.",
        f"Flight technical error of {budget.sigma_fte_m:g} m ({_mark(budget.marks, 'fte')}); "
        f"accuracy is {K95:.3g} deviations and the bias.",
        f"Coordinates: {taxi.source}.",
        *taxi.assumptions,
    ]
    if navigation.covariance == "paper":
        sentences.append("The covariance of the fix is the paper's form, which nothing shows to bound.")
    for f in taxi.faults:
        sentences.append(
            f"A fault is injected: {f.kind} of {f.satellite} from {f.start_s:g} s{', missed by the ground monitors' if f.missed else ''}."
        )
    return sentences


def _mark(marks: tuple[gbas.Mark, ...], part: str) -> str:
    return next((m.held for m in marks if part in m.name), "inferred")
