"""The answers of a flight against a procedure: recorded positions, bounds of the total error, what the data can decide, and heights."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import tse, vertical
from navbound.errors import NavboundError
from navbound.methods import column_of
from navbound.records.procedure import HeightResult, LegFlown, ProcedureFlown
from navbound.table.columns import COVARIANCE
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.procedures import Flight, Procedure
    from navbound.procedures.strays import Stretch
    from navbound.records.procedure import SettingResult
    from navbound.run.directory import Run

BOUND = "tse_exact_m"
"""Bound of the total error at the accuracy risk: what the second answer counts."""
METRES_PER_HPA = 8.3
"""Of an altimeter near the sea, for words alone. [m/hPa]"""


def flown_record(track: str, time_ns: int, flight: Flight, procedure: Procedure, along: Stretch) -> ProcedureFlown:
    """What the recorded positions of one flight say; the rest is added when the epochs are judged.

    Parameters
    ----------
    track : str
        Its name.
    time_ns : int
        GPS time at which its seconds begin. [ns]
    flight : Flight
        Results of :func:`navbound.procedures.flight.results`.
    procedure : Procedure
        What was followed.
    along : Stretch
        How the flight ends.
    """

    def at_ns(time_s: float) -> int:
        return time_ns + round(time_s * 1e9)

    legs = []
    for result in flight.legs:
        leg = procedure.legs[result.leg]
        legs.append(
            LegFlown(
                sequence=leg.sequence,
                fix=result.fix,
                terminator=result.terminator,
                state=leg.state,
                rnp_m=_known(result.rnp_m),
                rnp_origin=result.rnp_origin,
                length_m=_known(result.length_m),
                n=result.n,
                n_transition=result.n_transition,
                duration_s=result.duration_s,
                mean_m=_known(result.mean_m),
                rms_m=_known(result.rms_m),
                p95_m=_known(result.p95_m),
                max_abs_m=_known(result.max_abs_m),
                n_inside=result.n_inside,
                n_inside_twice=result.n_inside_twice,
                worst_time_ns=at_ns(result.worst_time_s) if result.n else None,
                worst_along_m=_known(result.worst_along_m),
            )
        )
    return ProcedureFlown(
        track=track,
        procedure=procedure.name,
        line=procedure.line,
        first_ns=at_ns(flight.first_time_s),
        n_status=flight.n_status,
        n=flight.n,
        n_inside=flight.n_inside,
        n_inside_twice=flight.n_inside_twice,
        n_without_rnp=flight.n_without_rnp,
        end=along.end,
        short_m=None if along.end == "reached" else _known(along.short_m),
        begin_m=_known(along.begin_m),
        n_effective=flight.n_effective,
        most_exceeding=_known(flight.most_exceeding),
        legs=legs,
        answers=flight.words,
    )


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def with_answers(run: Run) -> Run:
    """The answers that need the bounds: epochs whose bound of the total error is inside the RNP of their leg, or the vertical limit."""
    parts = {str(track): rows for (track,), rows in run.epochs.group_by("track", maintain_order=True)}
    level = 1.0 - (run.record.risk_accuracy or math.nan)
    flights = [_answered(flight, parts[flight.track], level) if flight.track in parts else flight for flight in run.summary.procedures]
    return replace(run, summary=run.summary.model_copy(update={"procedures": flights}))


def _answered(flight: ProcedureFlown, epochs: pl.DataFrame, level: float) -> ProcedureFlown:
    known, inside, twice = _bounds(epochs)
    fixes = epochs["leg"].to_numpy()
    legs = []
    for leg in flight.legs:
        here = fixes == (leg.fix or leg.terminator)
        counts = {"n_bound": known & here, "n_bound_inside": inside & here, "n_bound_inside_twice": twice & here}
        legs.append(leg.model_copy(update={name: int(rows.sum()) for name, rows in counts.items()}))
    counts = {"n_bound": int(known.sum()), "n_bound_inside": int(inside.sum()), "n_bound_inside_twice": int(twice.sum())}
    heights = [_with_bound(result, epochs, 1.0 - level) for result in flight.heights]
    first, *decided = flight.answers
    second = _second(counts, epochs.height, legs, level)
    answers = [first, second, *decided, *(_height_words(result, level) for result in heights)]
    if flight.setting is not None:
        answers.append(_setting_words(flight.setting))
    return flight.model_copy(update=counts | {"legs": legs, "heights": heights, "answers": answers})


def _bounds(epochs: pl.DataFrame) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
    bound, rnp = (column_of(epochs, name) if name in epochs.columns else np.full(epochs.height, np.nan) for name in (BOUND, "rnp_m"))
    known = np.isfinite(bound) & np.isfinite(rnp)
    return known, known & (bound <= rnp), known & (bound <= 2 * rnp)


def _second(counts: dict[str, int], n: int, legs: list[LegFlown], level: float) -> str:
    if not counts["n_bound"]:
        return f"Bound of the total error: no epoch has one (no covariance), so the second answer is not shown for {counted(n, 'epoch')}."
    by_leg = ", ".join(f"{leg.fix or leg.terminator} {leg.n_bound_inside} of {leg.n_bound}" for leg in legs if leg.n_bound)
    words = (
        f"Bound of the total error ({100 * level:.4g} %): inside RNP at {counts['n_bound_inside']} of {counts['n_bound']}, "
        f"inside twice RNP at {counts['n_bound_inside_twice']} of {counts['n_bound']}; by leg: {by_leg}."
    )
    return words if counts["n_bound"] == n else f"{words} {counted(n - counts['n_bound'], 'epoch has', 'epochs have')} no bound."


def _with_bound(result: HeightResult, epochs: pl.DataFrame, risk: float) -> HeightResult:
    """The vertical total error: the geometric deviation with the covariance of the position; an altimeter's errors are not in a file."""
    needed = ["fte_v_m", "path_angle_rad", "course_rad", *COVARIANCE]
    if result.by != "geometry" or not set(needed) <= set(epochs.columns):
        return result
    rows = np.column_stack([column_of(epochs, name) for name in needed])
    rows = rows[np.isfinite(rows).all(axis=1)]
    if not len(rows):
        return result
    up, angle, course, ee, en, nn, eu, nu, uu = rows.T
    covariance = np.stack([np.stack([ee, en, eu], -1), np.stack([en, nn, nu], -1), np.stack([eu, nu, uu], -1)], -2)
    offset = np.column_stack([np.zeros((len(up), 2)), up])
    try:
        bound = tse.vertical(offset, covariance, course, angle, risk)
    except NavboundError:
        # A covariance that is none is an epoch's own reason, which the judge counts.
        return result
    below = vertical.risk_below(up, bound.sigma_v_m, result.limit_m)
    n_inside = int((bound.tse_v_m <= result.limit_m).sum())
    return result.model_copy(update={"n_bound": len(rows), "n_bound_inside": n_inside, "risk_below_max": float(below.max())})


def _height_words(result: HeightResult, level: float) -> str:
    by = {
        "altimeter": "By the altimeter (its setting, not its static error, is known)",
        "geometry": "By geometry (the temperature of the air is in it)",
    }[result.by]
    words = (
        f"{by}: {result.n} positions on the final approach are {result.mean_m:+.1f} m off the {result.path} path in the mean "
        f"(positive above it), {result.least_m:+.1f} to {result.most_m:+.1f} m, RMS {result.rms_m:.1f} m; "
        f"inside ±{result.limit_m:.2f} m (75 ft, standard) at "
        f"{result.n_inside} of {result.n}, inside what 99.7 % of vertical errors have to be below (AC 90-101A, standard; from "
        f"{result.required_m:.1f} m) at {result.n_inside_required} of {result.n}."
    )
    if not result.n_bound:
        return words if result.by == "altimeter" else f"{words} No epoch has a covariance of its height, so its total error has no bound."
    risk = "" if result.risk_below_max is None else f"; largest risk of being below the path by more than that: {result.risk_below_max:.2g}"
    return (
        f"{words} Bound of the vertical total error ({100 * level:.4g} %) inside ±{result.limit_m:.2f} m at {result.n_bound_inside} of "
        f"{result.n_bound}{risk}."
    )


def _setting_words(test: SettingResult) -> str:
    outcome = (
        f"ALARM, altimeter setting or GNSS height: {abs(test.intercept_m) / METRES_PER_HPA:.0f} hPa if it is the setting"
        if test.alarm
        else "no alarm"
    )
    return (
        f"Altimeter setting {test.setting_hpa:.1f} hPa ({test.origin}): at the aerodrome geometric less indicated height is "
        f"{test.intercept_m:+.1f} m by {test.n} positions, slope {test.slope:+.3f} (temperature); {outcome}. The alarm stands at "
        f"{test.threshold_m:.0f} m ({test.threshold_m / METRES_PER_HPA:.0f} hPa), {test.detectable_m:.0f} m are found with 90 % (INFERRED: "
        "10 m of deviation, by three approaches of one airliner)."
    )
