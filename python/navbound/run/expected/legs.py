"""Legs and holes of a planned flight."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import dme, rnp
from navbound.errors import InputError
from navbound.records.prediction import ExpectedLeg, LevelHole
from navbound.risks import at_least_once
from navbound.run.expected.table import parts

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import NDArray

    from navbound.run.expected.setup import Setup

    Floats = NDArray[np.float64]


def legs(setup: Setup, table: pl.DataFrame, shown: pl.DataFrame) -> tuple[list[ExpectedLeg], list[LevelHole]]:
    """Every leg, from the seconds, and its levels, from the rows that are shown."""
    lines: list[ExpectedLeg] = []
    holes: list[LevelHole] = []
    for begin, end in parts(table):
        part = table[begin:end]
        start_s, end_s = float(part["time_s"][0]), float(part["time_s"][-1]) + 1.0
        rows = shown.filter((shown["time_s"] >= start_s) & (shown["time_s"] < end_s))
        own = _holes(rows, end_s) if math.isfinite(part["rnp_m"][0]) else []
        holes += own
        lines.append(_leg(setup, part, rows, own, (start_s, end_s)))
    return lines, holes


def _leg(setup: Setup, part: pl.DataFrame, rows: pl.DataFrame, holes: list[LevelHole], times: tuple[float, float]) -> ExpectedLeg:
    rnp_m = float(part["rnp_m"][0])
    stated = math.isfinite(rnp_m)
    circle, total, risk = (part[name].to_numpy() for name in ("anp_circle_m", "tse_accuracy_m", "p_exceed_2rnp"))
    # A bound that is NaN is not within anything.
    within = total <= rnp_m
    without = np.flatnonzero(~within)
    level = rows["hpl_m"].to_numpy() <= rnp_m
    known = np.isfinite(circle)
    status = "no_rnp" if not stated else "kept" if within.all() else "not_kept"
    if status == "not_kept" and _no_stations(setup, part[int(without[0]) : int(without[-1]) + 1]):
        status = "no_stations_known"
    shares = part["mode"].value_counts(sort=True)
    finite = rows["hpl_m"].to_numpy()[np.isfinite(rows["hpl_m"].to_numpy())]
    return ExpectedLeg.model_validate(
        {
            "leg": part["leg"][0],
            "phase": part["phase"][0],
            "rnp_m": rnp_m if stated else None,
            "start_s": times[0],
            "end_s": times[1],
            "modes": {mode: count / part.height for mode, count in shares.rows()},
            "status": status,
            "anp_max_m": float(np.nanmax(circle)) if known.any() else None,
            "anp_max_s": times[0] + float(np.nanargmax(circle)) if known.any() else None,
            "p_anp_within": float((circle <= rnp_m).mean()) if stated else None,
            "tse_max_m": float(np.nanmax(total)) if known.any() else None,
            "p_tse_within": float(within.mean()) if stated else None,
            "first_without_s": times[0] + float(without[0]) if stated and len(without) else None,
            "longest_without_s": float(_longest(~within)) if stated else None,
            "hal_m": rnp_m if stated else None,
            "hpl_max_m": float(finite.max()) if len(finite) else None,
            "p_level": float(level.mean()) if stated else None,
            "n_holes": len(holes) if stated else None,
            "longest_hole_s": max((h.end_s - h.start_s for h in holes), default=0.0) if stated else None,
            "p_without_hole": None,
            "n_dme_least": int(rows["n_dme"].min()),  # type: ignore[arg-type]
            "p_dme_pair": float(rows["dme_pair"].is_not_null().mean()),  # type: ignore[arg-type]
            "dme_circle_max_m": float(rows["dme_circle_m"].max()) if rows["dme_pair"].null_count() == 0 else None,  # type: ignore[arg-type]
            "risk_2rnp": _exposed(setup, risk) if stated and known.all() else None,
        }
    )


def _exposed(setup: Setup, risk: Floats) -> float:
    """Bound of the risk to be beyond at least once: at some second, and by the crossing rate of the worst second all the leg long."""
    worst = float(risk.max())
    if worst <= 0.0:
        return 0.0
    try:
        hour = rnp.per_hour_risk(worst, setup.plan.equipment.fte_correlation_s, 1.0)
    except InputError:
        # Below one sigma the crossing rate says nothing.
        return 1.0
    if hour >= 1.0:
        return 1.0
    return min(1.0, worst + at_least_once(hour, len(risk) / 3600.0))


def _no_stations(setup: Setup, part: pl.DataFrame) -> bool:
    """Whether no station of the list can be reached anywhere on the part, the satellites aside."""
    sensors = setup.scenario.sensors
    if sensors is None or sensors.dme is None or not sensors.stations:
        return True
    network = {s.name: (s.lat_rad, s.lon_rad, s.height_m) for s in sensors.stations}
    slant = dme.sights(part["lat_rad"].to_numpy(), part["lon_rad"].to_numpy(), part["h_m"].to_numpy(), network).slant_m
    return bool((slant > sensors.dme.coverage.range_most_m).all())


def _longest(bad: NDArray[np.bool_]) -> int:
    longest = now = 0
    for each in bad.tolist():
        now = now + 1 if each else 0
        longest = max(longest, now)
    return longest


def _holes(rows: pl.DataFrame, end_s: float) -> list[LevelHole]:
    """Runs of rows without a level inside the RNP; a hole lasts to the next row with one, or to the end of the leg."""
    holes: list[LevelHole] = []
    times = [*rows["time_s"].to_list(), end_s]
    run: list[int] = []
    good = (rows["hpl_m"].to_numpy() <= rows["rnp_m"].to_numpy()).tolist()
    for k, fine in enumerate([*good, True]):
        if not fine:
            run.append(k)
        elif run:
            holes.append(_hole(rows[run[0] : run[-1] + 1], times[run[0]], times[k]))
            run = []
    return holes


def _hole(rows: pl.DataFrame, start_s: float, end_s: float) -> LevelHole:
    level: Any = rows["hpl_m"].to_numpy()
    finite = level[np.isfinite(level)]
    return LevelHole(
        leg=rows["leg"][0],
        start_s=start_s,
        end_s=end_s,
        reason="jamming" if bool(rows["jammed"].any()) else "satellites" if bool(rows["served"].all()) else "service",
        n_sv_least=int(rows["n_sv_monitor"].min()),  # type: ignore[arg-type]
        hpl_max_m=float(finite.max()) if len(finite) == len(level) else None,
    )
