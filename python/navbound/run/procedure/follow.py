"""Every track along a procedure: which epochs are judged, by which leg, and what their positions and heights say."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.errors import InputError
from navbound.procedures.flight import results, rnp_words
from navbound.procedures.legs import Followed
from navbound.procedures.names import as_sentence
from navbound.procedures.strays import ASTRAY, JUDGED, follow
from navbound.read.approaches import statistics
from navbound.read.checks.repeats import left_out
from navbound.records.material import LEFT_OUT
from navbound.records.procedure import BesideProcedure
from navbound.records.run import Waypoint
from navbound.rnp.exposure import LONGEST_STEP_S
from navbound.rnp.usual import period_s, stale_after_s
from navbound.run.procedure.answers import flown_record
from navbound.run.procedure.heights import height_results, heights, setting_result
from navbound.time import utc_text
from navbound.units import METRES_PER_NM
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.procedures import Flight, Procedure
    from navbound.procedures.strays import Stretch
    from navbound.records.material import Operation
    from navbound.records.procedure import ProcedureFlown
    from navbound.records.run import CrossTrack, InputFile
    from navbound.run.procedure.flown import Flown


LATE_M = METRES_PER_NM
"""A flight that is judged from more than this after the begin of its procedure on is judged on a part of it (ours). [m]"""
SHORT_M = 0.1 * METRES_PER_NM
"""A flight whose last position is so far before the end of its procedure ends before it (ours). [m]"""


@dataclass(frozen=True)
class OnProcedure:
    """Epochs on the legs of a procedure, and what the report says about them."""

    epochs: pl.DataFrame
    left_out: pl.DataFrame
    words: list[str]
    heading: str
    waypoints: list[Waypoint]
    inputs: list[InputFile]
    cross_track: list[CrossTrack]
    flights: list[ProcedureFlown]
    tracks: dict[str, str] = field(default_factory=dict)
    due: dict[str, int] = field(default_factory=dict)
    n_approaches: int = 0
    n_unjudged: int = 0
    n_elsewhere: int = 0
    operation: Operation = "approach"
    beside: BesideProcedure | None = None


def on_procedure(epochs: pl.DataFrame, flown: Flown) -> OnProcedure:
    """Follow every track along a procedure.

    Every epoch from where a flight is established to the end of the procedure is expected. Those off the path in between have their
    distance from it as deviation. Those before and after, in fly-by turns and beside a hold are no part of the verdict and are counted.
    Epochs on a leg without an RNP or a path are expected and cannot be judged.

    Raises
    ------
    InputError
        No track follows the procedure.
    """
    loaded = flown.load()
    procedure = loaded.procedure
    judged, unknown, words, tracks, due = list[pl.DataFrame](), list[pl.DataFrame](), list[str](), dict[str, str](), dict[str, int]()
    flights: list[ProcedureFlown] = []
    n_beside = Counter[str]()
    for group in epochs.partition_by("track", maintain_order=True):
        time_s = (group["time_ns"] - group["time_ns"][0]).to_numpy() * 1e-9
        lat, lon = (group[name].cast(pl.Float64).fill_null(float("nan")).to_numpy() for name in ("est_lat_rad", "est_lon_rad"))
        followed, along = follow(procedure, time_s, (lat, lon))
        height = heights(group, _on_legs(followed), loaded, flown)
        rows = _columns(group, procedure, followed).with_columns(height.columns)
        expected = _expected(followed, along)
        n_beside.update(followed.status[~expected].tolist())
        words += [_status_words(str(group["track"][0]), followed), *([height.words] if height.words else [])]
        for number, each in enumerate(along, 1):
            inside = slice(each.first, each.last + 1)
            flight = results(procedure, _part(followed, inside), time_s[inside], expected[inside])
            track = f"{group['track'][0]} {procedure.name}" + (f" {number}" if number > 1 else "")
            part = rows[inside].with_columns(pl.lit(track).alias("track"))
            known = np.isin(followed.status[inside], JUDGED) & np.isfinite(part["rnp_m"].to_numpy())
            unknown.append(left_out(part.filter(pl.Series(expected[inside] & ~known))))
            words.append(_words(track, group["time_ns"][0], flight))
            if known.any():
                judged.append(part.filter(pl.Series(known)))
                tracks[track] = str(group["track"][0])
                due[track] = int(part["time_ns"][-1]) + round(each.due_s * 1e9)
                unknown.append(_not_flown(track, due[track], each, np.diff(part["time_ns"].to_numpy())))
                record = flown_record(track, group["time_ns"][0], flight, procedure, each)
                of_heights = [] if loaded.path is None else height_results(judged[-1], loaded.path, height.altitude_m[inside][known])
                tested = setting_result(time_s, float(time_s[each.last]), height, loaded)
                flights.append(record.model_copy(update={"heights": of_heights, "setting": tested}))
    if not judged:
        domain = f"procedures that a track follows: no epoch is established on a leg of {procedure.name} with an RNP"
        raise InputError("procedure", flown.name, domain=domain)
    table = pl.concat(judged)
    marks = [(x.fix, x.lat_rad, x.lon_rad) for x in procedure.legs if x.lat_rad is not None and x.lon_rad is not None]
    return OnProcedure(
        epochs=table,
        left_out=pl.concat(unknown),
        words=[
            _path_words(procedure),
            as_sentence(loaded.words),
            *procedure.notes,
            *words,
        ],
        heading=f"Procedure {procedure.name}" + (f", {procedure.line}" if procedure.line else ""),
        waypoints=[Waypoint(name=n, lat_rad=a, lon_rad=o, kind="runway" if n.startswith("RW") else "waypoint") for n, a, o in marks],
        inputs=[flown.source()],
        cross_track=[
            statistics(f"{procedure.name} {leg}", points.select(cross_m="fte_m", segment="track"))
            for (leg,), points in table.group_by("leg", maintain_order=True)
        ],
        flights=flights,
        tracks=tracks,
        due=due,
        operation="approach" if procedure.kind == "approach" else "en-route",
        beside=_beside(epochs.height, n_beside, flights, procedure),
    )


def _beside(n_recorded: int, n_status: Counter[str], flights: list[ProcedureFlown], procedure: Procedure) -> BesideProcedure:
    """What is not judged, and the earliest end of a flight before that of the procedure."""
    short = [each for each in flights if each.end != "reached" and not (each.short_m is not None and each.short_m < SHORT_M)]
    earliest = max(short, key=lambda each: math.inf if each.short_m is None else each.short_m, default=None)
    return BesideProcedure(
        n_recorded=n_recorded,
        n_status=dict(n_status.most_common()),
        n_short=len(short),
        short=None if earliest is None or earliest.end == "reached" else earliest.end,
        short_m=None if earliest is None else earliest.short_m,
        begin_m=max((each.begin_m for each in flights if each.begin_m is not None and each.begin_m > LATE_M), default=None),
        doubts=list(procedure.doubts),
    )


def _expected(followed: Followed, along: list[Stretch]) -> NDArray[np.bool_]:
    """Positions that a verdict has to judge: those of a flight along the procedure, but for its turns and holds."""
    expected = np.zeros(followed.status.size, dtype=np.bool_)
    for each in along:
        expected[each.first : each.last + 1] = True
    return expected & np.isin(followed.status, (*JUDGED, *ASTRAY, "missing"))


def _on_legs(followed: Followed) -> Followed:
    """The same without feet of what strays: it has no height to keep."""
    return replace(followed, leg=np.where(followed.status == "strayed", -1, followed.leg))


def _not_flown(track: str, end_ns: int, each: Stretch, steps_ns: NDArray[np.int64]) -> pl.DataFrame:
    """The end of the procedure as an epoch that is expected, where it was due later than a gap may last that is none."""
    # Of a single epoch nobody knows the period.
    stale_s = stale_after_s(period_s(steps_ns) if steps_ns.size else LONGEST_STEP_S)
    return pl.DataFrame([{"track": track, "time_ns": end_ns}] if each.due_s > stale_s else [], schema=LEFT_OUT)


def _part(followed: Followed, rows: slice) -> Followed:
    return Followed(**{f.name: getattr(followed, f.name)[rows] for f in fields(Followed)})


def _columns(group: pl.DataFrame, procedure: Procedure, feet: Followed) -> pl.DataFrame:
    rnp = np.array([x.rnp_m for x in procedure.legs])
    names = pl.Series([x.fix or x.terminator for x in procedure.legs])
    phases = pl.Series([x.part for x in procedure.legs])
    index = pl.Series(np.maximum(feet.leg, 0))
    return group.with_columns(
        pl.Series("path_lat_rad", feet.foot_lat_rad),
        pl.Series("path_lon_rad", feet.foot_lon_rad),
        pl.Series("course_rad", feet.course_rad),
        pl.Series("along_m", feet.along_m, nan_to_null=True),
        pl.Series("fte_m", feet.cross_m),
        pl.Series("rnp_m", rnp[np.maximum(feet.leg, 0)]),
        names.gather(index).alias("leg"),
        phases.gather(index).alias("phase"),
    )


def _path_words(procedure: Procedure) -> str:
    legs = "; ".join(
        f"{x.fix or '-'} {x.terminator} {rnp_words(x.rnp_m)} ({x.rnp_origin.replace('_', ' ')})" for x in procedure.legs if x.has_path
    )
    return (
        f"Path: procedure {procedure.name} of {procedure.file}: {legs}. Established is within the RNP and 30° of the course for 10 s; "
        "turns are flown by with 18° of bank (INFERRED)."
    )


def _status_words(track: str, followed: Followed) -> str:
    names, counts = np.unique(followed.status, return_counts=True)
    shown = ", ".join(f"{n} {name.replace('_', ' ')}" for name, n in zip(names.tolist(), counts.tolist(), strict=True))
    return f"Positions of {track}: {shown}. Only those that are ok or strayed are judged."


def _words(track: str, time_ns: int, flight: Flight) -> str:
    when = utc_text(time_ns + round(flight.first_time_s * 1e9))
    return (
        f"{track}: judged from {when} UTC on; {counted(flight.n_without_rnp, 'position')} on legs without an RNP "
        f"{agreeing(flight.n_without_rnp, 'is', 'are')} not."
    )
