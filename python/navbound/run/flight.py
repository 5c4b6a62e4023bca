"""Flights of kind ``flight``: estimate, truth, covariance and path, second by second."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core, status
from navbound.records.run import CovarianceOrigin, Waypoint
from navbound.run.campaign import Context, track_name
from navbound.scenario import Scenario

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["Flights"]

_DRAWN_AT_ONCE = 16
"""Flights of one tile, of some hundredths of a second each."""
_FUSED_AT_ONCE = 4
"""The same where every flight runs a filter for some seconds: enough for the cores of most machines, and the bar still moves."""
_BIASES = tuple(f"{sensor}_{axis}_{unit}" for sensor, unit in (("gyro", "radps"), ("accel", "mps2")) for axis in "xyz")
_WATCHED = (
    "separation_m",
    "separation_limit_m",
    "innovation_memory",
    *(f"innovation_{kind}" for kind in ("range", "station", "baro")),
    *(f"{what}_{axis}" for what in ("bias", "sigma_bias") for axis in _BIASES),
)
"""Columns of the monitors across measurements, and of the filter's own state."""
_JUDGED = ("decided", "source", "reasons", "leading")
"""Codes of what the core decided of a filtered position."""
_CODES = ("nav_mode", "leg", "phase", "available", "doubt", "flight", "reason", "reason_id", *_JUDGED)
"""Columns that become words."""
_TESTS = ("position_horizontal", "velocity_horizontal", "position_vertical", "velocity_vertical")
"""Tests of the filter against the snapshot, in the order of the core."""
_COUNTS = ("samples", "clock_jumps", "snapshot_tests")
"""What a filter counts besides its innovations."""


@dataclass(frozen=True)
class Flights:
    """Flights of a scenario by their numbers. The scenario is text: its bytes are the same in every process."""

    scenario: str
    seed: int

    def __call__(self, flights: range) -> tuple[pl.DataFrame, list[Any]]:
        """Epochs of some flights, and what their filters say of themselves."""
        loaded, flyer = _opened(self.scenario)
        if isinstance(flyer, _core.Outlook):
            return _table(flyer.fly(self.seed, flights.start, len(flights)), loaded), []
        columns, verdicts = flyer.navigate(self.seed, flights.start, len(flights))
        return _table(columns, loaded), verdicts

    @property
    def at_once(self) -> int:
        """Flights of one tile."""
        return _DRAWN_AT_ONCE if _opened(self.scenario)[0].filter is None else _FUSED_AT_ONCE

    def context(self, flights: int, verdicts: list[Any]) -> Context:
        """What is said of the epochs."""
        loaded, _ = _opened(self.scenario)
        plan = _core.Outlook(loaded.core_json()).plan()
        reported = {"filter": filter_verdict(verdicts) | {"restarts": len(verdicts) - flights}} if verdicts else {}
        return Context(
            requirement="RNP by phase of flight",
            assumptions=_assumptions(loaded),
            covariance=CovarianceOrigin(id="simulated" if loaded.filter is None else "filter"),
            waypoints=[Waypoint(name=w.name, lat_rad=w.lat_rad, lon_rad=w.lon_rad, kind=w.kind) for w in loaded.waypoints],
            settings={key: plan[key] for key in ("length_m", "cruise_speed_mps", "top_of_climb_s", "top_of_descent_s")} | reported,
        )


@lru_cache(maxsize=1)
def _opened(scenario: str) -> tuple[Scenario, _core.Outlook | _core.Sensors]:
    """What all flights of a scenario share, worked out once a process."""
    loaded = Scenario.model_validate_json(scenario)
    return loaded, _core.Outlook(loaded.core_json()) if loaded.filter is None else _core.Sensors(loaded.core_json(), None)


def _table(columns: dict[str, Any], scenario: Scenario) -> pl.DataFrame:
    available = columns["available"] == 1
    names = [w.name for w in scenario.waypoints]
    legs = [f"{a}-{b}" for a, b in itertools.pairwise(names)]
    words = {
        "track": _words([track_name(i) for i in range(int(columns["flight"].max()) + 1)], columns["flight"]),
        "leg": _words(legs, columns["leg"]),
        "phase": _words([p.name for p in scenario.phases], columns["phase"]),
        **_reasons(columns, available),
    }
    if scenario.filter is None:
        columns = {name: values for name, values in columns.items() if name not in ("n_gated", "hpl_m", "vpl_m", *_WATCHED)}
    else:
        words |= _judged(columns, available)
    numbers = {name: values for name, values in columns.items() if name not in _CODES}
    table = pl.DataFrame({"track": words.pop("track"), "time_ns": numbers.pop("time_ns"), **numbers, **words})
    # A value that does not exist is null in a table.
    return table.with_columns(pl.col(pl.Float64).fill_nan(None)).with_columns(pl.col("^n_(sv|gated)$").cast(pl.Int64))


def _reasons(columns: dict[str, Any], available: NDArray[np.bool_]) -> dict[str, pl.Series]:
    """Status, id and sentence of every epoch: why there is no estimate."""
    ids, refusals = (np.full(available.shape, None, dtype=object) for _ in range(2))
    ids[~available], refusals[~available] = columns["reason_id"], columns["reason"]
    epochs = status.with_reason(pl.DataFrame({"status": np.full(available.shape, "ok")}), pl.Series(ids.tolist(), dtype=pl.String))
    sentences = pl.Series("reason", refusals.tolist(), dtype=pl.String)
    return {**epochs.select("status", "reason_id").to_dict(), "reason": sentences}


def _judged(columns: dict[str, Any], available: NDArray[np.bool_]) -> dict[str, pl.Series]:
    """What the core decided of every epoch: the status is its own, from nothing else; the reason is the leading one of its set."""
    statuses, sources, ids = _core.Sensors.judgement()
    absent = _reasons(columns, available)
    leading = columns["leading"]
    led = pl.Series(leading >= 0)
    leading_id = _words(ids, np.maximum(leading, 0))
    reason_id = leading_id.zip_with(led, absent["reason_id"])
    bits = columns["reasons"].astype(np.uint32)
    kinds, place = np.unique(bits, return_inverse=True)
    sets = [" ".join(name for k, name in enumerate(ids) if kind >> k & 1) or None for kind in kinds.tolist()]
    return {
        "nav_mode": _words([*_core.Sensors.modes(), "stopped"], columns["nav_mode"]),
        "nav_source": _words(sources, columns["source"]),
        "nav_reasons": _words(sets, place),
        "status": _words(statuses, columns["decided"]),
        "reason_id": reason_id,
        "reason": pl.select(pl.coalesce(absent["reason"], status.words(pl.lit(reason_id))))[:, 0],
    }


def filter_verdict(verdicts: list[dict[str, Any]]) -> dict[str, Any]:
    """What the filters of all flights say of themselves: innovations by kind of measurement, and the inertial samples.

    ``mean_square`` is the mean squared normalised innovation (NIS), ``lag_one`` the correlation with the one before it of the same source,
    both over all flights.
    """
    tally: dict[str, Any] = {}
    for kind in (key for key in verdicts[0] if key not in _COUNTS):
        used, gated, refused, square, lag, pairs = np.array([v[kind] for v in verdicts], dtype=float).T
        if used.sum() + gated.sum() + refused.sum() > 0:
            tally[kind] = {
                "n_used": int(used.sum()),
                "n_gated": int(gated.sum()),
                "n_refused": int(refused.sum()),
                "mean_square": _weighted(square, used),
                "lag_one": _weighted(lag, pairs),
            }
    samples = np.sum([v["samples"] for v in verdicts], axis=0).tolist()
    words = ("done", "bridged", "adrift", "late", "refused", "stopped")
    jumps = sum(v["clock_jumps"] for v in verdicts)
    return tally | {"samples": dict(zip(words, samples, strict=True)), "clock_jumps": jumps, "snapshot_tests": _tests(verdicts)}


def _tests(verdicts: list[dict[str, Any]]) -> dict[str, Any]:
    """Filter against snapshot over all flights: the mean square of each test per degree of freedom, and the largest square."""
    n = sum(v["snapshot_tests"][0] for v in verdicts)
    sums = np.sum([v["snapshot_tests"][2] for v in verdicts], axis=0)
    most = np.max([v["snapshot_tests"][3] for v in verdicts], axis=0)
    tally: dict[str, Any] = {"n": n, "n_raised": sum(v["snapshot_tests"][1] for v in verdicts)}
    for name, freedom, total, largest in zip(_TESTS, (2, 2, 1, 1), sums, most, strict=True):
        tally[name] = {"mean_square": float(total / n / freedom) if n else None, "largest": float(largest)}
    return tally


def _weighted(values: np.ndarray[Any, Any], weights: np.ndarray[Any, Any]) -> float | None:
    known = weights > 0
    return float(np.average(values[known], weights=weights[known])) if known.any() else None


def _words(words: Sequence[str | None], codes: np.ndarray[Any, Any]) -> pl.Series:
    return pl.Series(words, dtype=pl.String).gather(pl.Series(codes.astype(np.uint32)))


def _assumptions(scenario: Scenario) -> list[str]:
    sentences = list(scenario.assumptions)
    if scenario.filter is not None:
        sentences.append(
            "The position comes from simulated sensors through a navigation filter that has their statistics; guidance follows the "
            "filter's error, worked out on a first flight of the same number."
        )
        if scenario.filter.mode == "white":
            sentences.append("The filter takes correlated errors as new each time: its covariance is overconfident on purpose.")
    if scenario.sensors is not None and scenario.sensors.faults:
        sentences.append(f"Sensors fail: {', '.join(f'{f.kind} from {f.start_s:g} s' for f in scenario.sensors.faults)}.")
    scale = scenario.navigation.claimed_sigma_scale
    if scale != 1.0:
        sentences.append(f"The covariance claims {scale:g} times the true standard deviation: it is mismodelled on purpose.")
    if scenario.faults:
        sentences.append(
            f"Faults are injected: {', '.join(f'{f.kind} from {f.start_s:g} s for {f.duration_s:g} s' for f in scenario.faults)}."
        )
    return sentences
