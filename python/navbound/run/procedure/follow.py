"""Every track along a procedure: which epochs are judged, by which leg, and what their positions and heights say."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.errors import InputError
from navbound.procedures.flight import results, rnp_words
from navbound.procedures.legs import Followed
from navbound.procedures.names import as_sentence
from navbound.read.approaches import statistics
from navbound.read.checks.repeats import left_out
from navbound.records.run import Waypoint
from navbound.run.procedure.answers import flown_record
from navbound.run.procedure.heights import height_results, heights, setting_result
from navbound.time import utc_text

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.procedures import Flight, Procedure
    from navbound.records.material import Operation
    from navbound.records.procedure import ProcedureFlown
    from navbound.records.run import CrossTrack, InputFile
    from navbound.run.procedure.flown import Flown

NEXT_FLIGHT_S = 600.0
"""After so long without a judged position another flight begins (ours). [s]"""


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
    operation: Operation = "approach"


def on_procedure(epochs: pl.DataFrame, flown: Flown) -> OnProcedure:
    """Follow every track along a procedure.

    Epochs before it is established, off the path, in fly-by turns and beside a hold are no part of the verdict and are counted. Epochs on a
    leg without an RNP are expected and cannot be judged.

    Raises
    ------
    InputError
        No track follows the procedure.
    """
    loaded = flown.load()
    procedure = loaded.procedure
    rnp = np.array([x.rnp_m for x in procedure.legs])
    judged, unknown, words, tracks = list[pl.DataFrame](), list[pl.DataFrame](), list[str](), dict[str, str]()
    flights: list[ProcedureFlown] = []
    for group in epochs.partition_by("track", maintain_order=True):
        time_s = (group["time_ns"] - group["time_ns"][0]).to_numpy() * 1e-9
        lat, lon = (group[name].cast(pl.Float64).fill_null(float("nan")).to_numpy() for name in ("est_lat_rad", "est_lon_rad"))
        followed = procedure.follow(time_s, lat, lon)
        height = heights(group, followed, loaded, flown)
        rows = _columns(group, procedure, followed, rnp).with_columns(height.columns)
        words += [_status_words(str(group["track"][0]), followed), *([height.words] if height.words else [])]
        for number, (first, last) in enumerate(_flights(followed, time_s), 1):
            inside = slice(first, last + 1)
            flight = results(procedure, _part(followed, inside), time_s[inside])
            track = f"{group['track'][0]} {procedure.name}" + (f" {number}" if number > 1 else "")
            part = rows[inside].with_columns(pl.lit(track).alias("track"))
            ok = followed.status[inside] == "ok"
            known = ok & np.isfinite(part["rnp_m"].to_numpy())
            unknown.append(left_out(part.filter(pl.Series(ok & ~known))))
            words.append(_words(track, group["time_ns"][0], flight))
            if known.any():
                judged.append(part.filter(pl.Series(known)))
                tracks[track] = str(group["track"][0])
                record = flown_record(track, group["time_ns"][0], flight, procedure)
                of_heights = [] if loaded.path is None else height_results(judged[-1], loaded.path, height.altitude_m[inside][known])
                tested = setting_result(time_s, float(time_s[last]), height, loaded)
                flights.append(record.model_copy(update={"heights": of_heights, "setting": tested}))
    if not judged:
        domain = f"procedures that a track follows: no epoch is established on a leg of {procedure.name} with an RNP"
        raise InputError("procedure", flown.name, domain=domain)
    table = pl.concat(judged)
    marks = [(x.fix, x.lat_rad, x.lon_rad) for x in procedure.legs if x.lat_rad is not None and x.lon_rad is not None]
    return OnProcedure(
        epochs=table,
        left_out=pl.concat([x for x in unknown if x["track"].is_in(list(tracks)).all()]),
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
        operation="approach" if procedure.kind == "approach" else "en-route",
    )


def _flights(followed: Followed, time_s: NDArray[np.float64]) -> list[tuple[int, int]]:
    """First and last judged position of each flight: one ends where the aircraft leaves the path, or after a long gap."""
    ok = np.flatnonzero(followed.status == "ok")
    if not ok.size:
        return []
    n_off = np.cumsum(followed.status == "off_path")
    begins = np.flatnonzero((np.diff(n_off[ok]) > 0) | (np.diff(time_s[ok]) > NEXT_FLIGHT_S)) + 1
    return [(int(piece[0]), int(piece[-1])) for piece in np.split(ok, begins)]


def _part(followed: Followed, rows: slice) -> Followed:
    return Followed(**{f.name: getattr(followed, f.name)[rows] for f in fields(Followed)})


def _columns(group: pl.DataFrame, procedure: Procedure, feet: Followed, rnp: NDArray[np.float64]) -> pl.DataFrame:
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
    return f"Positions of {track}: {shown}. Only those that are ok are judged."


def _words(track: str, time_ns: int, flight: Flight) -> str:
    when = utc_text(time_ns + round(flight.first_time_s * 1e9))
    return f"{track}: judged from {when} UTC on; {flight.n_without_rnp} positions on legs without an RNP are not."
