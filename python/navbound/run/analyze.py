"""Recorded tracks to material: read, check, join the truth, find the path."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, cast, get_args

import polars as pl

from navbound.errors import ConflictError, InputError
from navbound.methods import EXTRACTION_LABEL, EXTRACTION_MARK
from navbound.read.approaches import Gates
from navbound.read.checks.limits import Limits
from navbound.read.checks.plausible import check
from navbound.read.checks.repeats import left_out, separate
from navbound.read.covariance import Claimed, claim, words_beside
from navbound.read.motion.axes import axes_of
from navbound.read.motion.speeds import speeds_of
from navbound.read.pieces import PIECE_ROWS
from navbound.read.tables.epochs import Reading, read
from navbound.read.truth import TOLERANCE_S, truth_of, with_error, with_truth
from navbound.records.material import Material, Operation
from navbound.records.run import CovarianceOrigin, Rejection
from navbound.records.truth import TruthDoubts
from navbound.rnp.usual import period_s
from navbound.run.inputs.doubts import of_motion
from navbound.run.inputs.files import sort_out
from navbound.run.inputs.solving import Solving
from navbound.run.paths import follow_path, path_of, way_of
from navbound.run.pieces import (
    AUXILIARY,
    Flights,
    PiecedTruth,
    Request,
    covariance_status,
    in_pieces,
    is_large,
)
from navbound.table.arguments import checked
from navbound.table.columns import HEARD
from navbound.table.declare import schema

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from navbound.read.pieces import PiecedReading
    from navbound.read.truth import Truth
    from navbound.run.inputs.files import Files
    from navbound.run.paths import OnPath
    from navbound.run.procedure import Flown, OnProcedure


@checked
def material(
    files: str | Path | Sequence[str | Path],
    *,
    requirement: str,
    rnp_m: float,
    path: str | Path | None = None,
    procedure: Flown | None = None,
    truth: str | Path | None = None,
    truth_tolerance_s: float = TOLERANCE_S,
    sigma_m: float | None = None,
    columns: Mapping[str, str] | None = None,
    gates: Gates | None = None,
    limits: Limits | None = None,
    solve: bool = False,
    signals: str | None = None,
    systems: str | None = None,
    ionosphere: str | None = None,
    mask_rad: float | None = None,
    operation: Operation | None = None,
    piece_rows: int | None = None,
) -> Material:
    """Make recorded tracks ready to be judged.

    Parameters
    ----------
    files : path or sequence of paths
        Tables (CSV, JSON, Parquet), RTKLIB solution files, or logs of receivers; all also gzipped. Or measurements with navigation files,
        from which positions are solved.
    requirement : str
        The navigation specification in words.
    rnp_m : float
        Its lateral accuracy. [m]
    path : str or path, optional
        ``LFPG/08R``, or several separated by commas: approaches to these runways. ``auto``: every landing, on the runway it lands
        on. A TOML or CSV file: a route. Without it there is no flight technical error, and only the navigation system is judged.
    procedure : Flown, optional
        Instead of `path`: a published procedure, whose legs have their own RNP; `requirement` and `rnp_m` then have no part in it.
    truth : str or path, optional
        Recording of the true positions, in a form as `files`; or of a receiver that does not move
        ``LAT,LON,H`` (degrees, metres above the WGS-84 ellipsoid) or ``X,Y,Z`` (Earth-fixed, metres).
    truth_tolerance_s : float
        How far apart in time an estimate and its truth may lie. [s]
    sigma_m : float, optional
        Standard deviation of each horizontal axis of the navigation error, as a claim of the caller's. [m]
    columns : mapping, optional
        What a column is, where its name does not say; see :func:`navbound.read.read`.
    gates, limits : optional
        What counts as an approach; what an aircraft can do.
    solve : bool
        Solve positions from the raw measurements of receivers' logs, with the orbits in their subframes and in navigation files, instead
        of taking the receivers' own.
    signals, systems, ionosphere : str, optional
        How measurements are solved, see :func:`navbound.gnss.solve`; ``auto``, ``GEC`` and ``auto`` where they are not named.
    mask_rad : float, optional
        Lowest elevation of the satellites that positions are solved from; :data:`navbound.gnss.MASK_RAD` where it is not named. [rad]
    operation : {"en-route", "approach", "ground"}, optional
        What was flown. Without it a recording on the path to a runway or on an approach procedure is an approach, any other is en route.
    piece_rows : int, optional
        Read the one text table or Parquet file in pieces of about so many rows, whatever its size. Without it a table of 64 MiB or more,
        or of half a million rows of Parquet, is read so, but for a procedure; and so is its recorded truth. Results are the same.

    Raises
    ------
    FormatError
        A file that cannot be read.
    InputError
        A value outside its domain, an unknown runway, no approach found, or no truth at the time of the recording.
    """
    if not 0 < rnp_m < float("inf"):
        raise InputError("rnp_m", rnp_m, "m", "(0, inf)")
    if procedure is not None and path is not None:
        raise ConflictError("path", excludes=("procedure",))
    gates, limits = gates or Gates(), limits or Limits()
    names = [files] if isinstance(files, str) or not hasattr(files, "__iter__") else list(files)
    if not names:
        raise InputError("files", "nothing", domain="one file or more")
    solving = Solving(signals, systems, ionosphere, mask_rad)
    settings: dict[str, object] = {
        "path": None if path is None else str(path),
        **({} if procedure is None else {"procedure": procedure.settings}),
        "rnp_m": rnp_m if procedure is None else None,
        "truth": None if truth is None else str(truth),
        "truth_tolerance_s": truth_tolerance_s,
        "sigma_m": sigma_m,
    }
    context = _Context(requirement, settings, _stated(operation), sigma_m, gates, limits, solve, solving)
    alone = len(names) == 1 and procedure is None and not solve
    if piece_rows is not None and not alone:
        raise ConflictError("piece_rows", excludes=("procedure", "solve"), because="only one table alone is read in pieces")
    named = truth_of(truth, truth_tolerance_s, columns)
    if alone and is_large(Path(names[0]), piece_rows):
        solving.refuse(_TO_SOLVE)
        return _in_pieces(Path(names[0]), path, named, context, piece_rows)
    sorted_inputs = sort_out(names, solve=solve)
    sorted_inputs.require_navigation()
    if not sorted_inputs.observations:
        solving.refuse(_TO_SOLVE)
    readings = [read(source.path, columns=named.columns_of_estimates) for source in sorted_inputs.tables] + (
        _solved(sorted_inputs, solving) if sorted_inputs.observations else []
    )
    _refuse_experimental(readings)
    inputs = [r.source for r in readings] + [
        source.record(None) for source in sorted_inputs.navigation if source not in sorted_inputs.observations
    ]
    rejected, notes = (
        [x for r in readings for x in r.rejected],
        [
            *sorted_inputs.unused_words(),
            *sorted_inputs.cut_words(),
            *(note for r in readings for note in r.notes),
        ],
    )
    epochs, lost = _together(readings, rejected)
    labels = _labels(epochs)
    claimed = claim(epochs, sigma_m)
    # A fixed truth says that the receiver stands: its position may repeat.
    epochs, plausibility = check(claimed.epochs, limits if named.ecef_m is None else replace(limits, moving_mps=math.inf))
    origin = _origin(claimed, sigma_m, solved_alone=bool(sorted_inputs.observations) and not sorted_inputs.tables)
    of_covariance = (
        "Covariance: solved with the positions, from the measurements."
        if origin.id == "solved"
        else words_beside(claimed, _unread(readings))
    )
    speeds = speeds_of(epochs)
    position_doubts = [*_doubts(readings, decided=truth is not None), *of_motion(plausibility, speeds, axes_of(epochs))]
    truth_doubts, assumptions = TruthDoubts(), [of_covariance, plausibility.words]
    if truth is not None:
        epochs, words, other, truth_doubts = with_truth(epochs, named)
        assumptions.append(words)
        if other is not None:
            inputs, rejected, position_doubts = [*inputs, other.source], rejected + other.rejected, position_doubts + other.position_doubts
    elif {"truth_lat_rad", "truth_lon_rad"} <= set(epochs.columns):
        epochs, truth_doubts = with_error(epochs)
        assumptions.append(f"Truth: from the file itself. {truth_doubts.words}".rstrip())
    route = follow_path(path, epochs, gates, rejected) if procedure is None else _on_procedure(epochs, procedure)
    # A path has ends of its own.
    flights = Flights(dividing=path is None and procedure is None)
    epochs = flights.divide(covariance_status(cast("pl.DataFrame", route.epochs)))
    if procedure is None:
        epochs = epochs.with_columns(pl.lit(float(rnp_m)).alias("rnp_m"))
    else:
        requirement = f"RNP by leg of {procedure.name}"
    return Material(
        epochs=epochs.drop(AUXILIARY, strict=False),
        kind="analyze",
        title=route.heading if (path or procedure) is not None else f"{route.heading}: {', '.join(Path(str(n)).name for n in names)}",
        requirement=requirement,
        sample_period_s=_period(epochs),
        assumptions=[*assumptions, *flights.words(), *route.words, *notes],
        covariance=origin,
        operation=operation or route.operation,
        labels=_labels_of(route.tracks, labels, _labels(epochs)),
        waypoints=route.waypoints,
        inputs=inputs + route.inputs,
        rejected=rejected,
        n_approaches=route.n_approaches,
        n_unjudged_approaches=route.n_unjudged,
        n_tracks_elsewhere=route.n_elsewhere,
        beside=route.beside,
        left_out=pl.concat([_on_path(flights.divide_left_out(lost), _ends(epochs), route), route.left_out]),
        cross_track=route.cross_track,
        procedures=route.flights,
        settings=context.settings_with(readings),
        unread=_unread(readings),
        set_aside=named.set_aside,
        position_doubts=position_doubts,
        scatter=speeds.scatter(),
        truth_doubts=truth_doubts,
        satellites=pl.concat([r.satellites for r in readings if r.satellites is not None] or [pl.DataFrame(schema=schema(HEARD))]),
    )


def _labels_of(tracks: Mapping[str, str], before: dict[str, str], judged: dict[str, str]) -> dict[str, str]:
    """Labels of the tracks that are judged: of an approach that of its track with the runway."""
    if tracks:
        return {track: f"{before[of]} {track.partition(' ')[2]}".strip() for track, of in tracks.items()}
    return before | judged


def _unread(readings: Sequence[Reading]) -> list[str]:
    return list(dict.fromkeys(each for r in readings for each in r.unread))


def _doubts(readings: Sequence[Reading], *, decided: bool) -> list[str]:
    """What speaks against the positions; a truth decides where they are."""
    return [each for r in readings for each in (*r.position_doubts, *(() if decided else r.place_doubts))]


@dataclass(frozen=True)
class _Context:
    """What the caller says of a recording beside its files."""

    requirement: str
    settings: dict[str, object]
    stated: Operation | None
    sigma_m: float | None
    gates: Gates
    limits: Limits
    solve: bool
    solving: Solving

    def settings_with(self, readings: Sequence[Reading | PiecedReading]) -> dict[str, object]:
        return self.settings | {
            "columns": {r.source.path: r.columns for r in readings},
            "columns_not_used": {r.source.path: r.unused for r in readings},
            "gates": asdict(self.gates),
            "limits": asdict(self.limits),
            "solve": self.solve,
            "solving": self.solving.named,
        }


def _stated(operation: Operation | None) -> Operation | None:
    if operation is not None and operation not in get_args(Operation):
        raise InputError("operation", operation, domain=" or ".join(get_args(Operation)))
    return operation


_TO_SOLVE = "there are no measurements to solve (RINEX observations, or a receiver's log with solve)"


def _in_pieces(file: Path, path: str | Path | None, truth: Truth, context: _Context, piece_rows: int | None) -> Material:
    """The same of a table that is in pieces on the disk."""
    n, rnp_m = piece_rows or PIECE_ROWS, context.settings["rnp_m"]
    way, compared = way_of(path, context.gates, n), PiecedTruth(truth, is_large=lambda of: is_large(of, piece_rows), piece_rows=n)
    request = Request(truth.columns_of_estimates, context.sigma_m, context.limits, cast("float", rnp_m), n, truth=compared, way=way)
    recorded = in_pieces(file, request)
    reading, other = recorded.reading, compared.recording
    _refuse_experimental([reading])
    rejected = [*reading.rejected, *([] if other is None else other.rejected)]
    of_truth = compared.words()
    route = path_of(way, recorded.epochs, context.gates, rejected)
    return Material(
        epochs=pl.DataFrame(schema=recorded.epochs.schema),
        frames=recorded.epochs,
        kind="analyze",
        title=route.heading if path is not None else f"{route.heading}: {file.name}",
        requirement=context.requirement,
        sample_period_s=recorded.period_s,
        assumptions=[
            words_beside(recorded.claimed, reading.unread),
            recorded.plausibility.words,
            *of_truth,
            *recorded.flights,
            *route.words,
            *reading.notes,
        ],
        covariance=_origin(recorded.claimed, context.sigma_m, solved_alone=False),
        operation=context.stated or route.operation,
        labels=_labels_of(route.tracks, recorded.labels_before, recorded.labels),
        waypoints=route.waypoints,
        inputs=[reading.source, *([] if other is None else [other.source]), *route.inputs],
        rejected=rejected,
        n_approaches=route.n_approaches,
        n_unjudged_approaches=route.n_unjudged,
        n_tracks_elsewhere=route.n_elsewhere,
        left_out=_on_path(recorded.left_out, recorded.ends, route),
        cross_track=route.cross_track,
        settings=context.settings_with([reading]),
        with_levels=recorded.with_levels,
        unread=reading.unread,
        set_aside=truth.set_aside,
        position_doubts=[*reading.position_doubts, *recorded.position_doubts, *([] if other is None else other.position_doubts)],
        scatter=recorded.scatter,
        truth_doubts=compared.doubts,
    )


def _origin(claimed: Claimed, sigma_m: float | None, *, solved_alone: bool) -> CovarianceOrigin:
    solved_covariance = solved_alone and claimed.origin == "file"
    low, high = claimed.own_sigma_m or (None, None)
    return CovarianceOrigin(id="solved" if solved_covariance else claimed.origin, sigma_m=sigma_m, own_low_m=low, own_high_m=high)


def _refuse_experimental(readings: Sequence[Reading | PiecedReading]) -> None:
    """Everything read here may reach an alert; columns of Error Extraction say in their own name that they may not."""
    for reading in readings:
        for name, column in reading.columns.items():
            if column.startswith(EXTRACTION_MARK):
                raise InputError(
                    "columns", f"{name} from {column}", domain=f"columns that may feed an alert; {column} is {EXTRACTION_LABEL}"
                )


def _solved(files: Files, solving: Solving) -> list[Reading]:
    from navbound.run.inputs.solved import solved  # noqa: PLC0415  (receivers are loaded where there are measurements)

    return solved(files, solving)


def _on_procedure(epochs: pl.DataFrame, procedure: Flown) -> OnProcedure:
    from navbound.run.procedure import on_procedure  # noqa: PLC0415  (databases of procedures are loaded where one is named)

    return on_procedure(epochs, procedure)


def _together(readings: Sequence[Reading], rejected: list[Rejection]) -> tuple[pl.DataFrame, pl.DataFrame]:
    """All files as one table, an epoch that two files hold counts once; and the rows of all that cannot be judged."""
    epochs = pl.concat([r.epochs for r in readings], how="diagonal_relaxed").sort("track", "time_ns", maintain_order=True)
    if "status" in epochs.columns:
        # A file that says nothing of its epochs has nothing against them.
        epochs = epochs.with_columns(pl.col("status").fill_null("ok"))
    separated = separate(epochs)
    reason = "time repeated within a track of several files"
    for words, repeated in separated.kinds.items():
        path = readings[-1].source.path
        rejected.append(Rejection(file=path, reason=f"{reason}{words}", count=repeated.height, first_line=None, example=""))
    return separated.epochs, pl.concat([*(r.left_out for r in readings), left_out(separated.unjudged)])


def _ends(epochs: pl.DataFrame) -> pl.DataFrame:
    """First and last epoch of every track. [GPS ns]."""
    return epochs.group_by("track").agg(start=pl.col("time_ns").min(), end=pl.col("time_ns").max())


def _on_path(lost: pl.DataFrame, ends: pl.DataFrame, route: OnPath | OnProcedure) -> pl.DataFrame:
    """The rows that cannot be judged and belong to what is judged: all, or those of an approach of their track until it was due."""
    if not route.tracks or lost.is_empty():
        return lost
    ends = ends.with_columns(
        pl.col("track").replace_strict(dict(route.tracks), default=None, return_dtype=pl.String).alias("of"),
        pl.max_horizontal("end", pl.col("track").replace_strict(route.due, default=None, return_dtype=pl.Int64)),
    )
    timed = lost.join(ends.rename({"track": "approach"}), left_on="track", right_on="of", how="inner")
    # Without a time nobody knows where a row belongs, and it may belong here.
    timed = timed.filter(pl.col("time_ns").is_between("start", "end"))
    untimed = lost.filter(pl.col("time_ns").is_null())
    return pl.concat([left_out(timed.with_columns(pl.col("approach").alias("track"))), untimed])


def _labels(epochs: pl.DataFrame) -> dict[str, str]:
    """Track to the callsign it mostly has, or to its own name."""
    if "callsign" not in epochs.columns:
        return {track: track for track in epochs["track"].unique(maintain_order=True)}
    usual = epochs.group_by("track", maintain_order=True).agg(pl.col("callsign").drop_nulls().mode().sort().first())
    return {track: str(callsign or track) for track, callsign in usual.iter_rows()}


def _period(epochs: pl.DataFrame) -> float:
    """Time between epochs of a track. [s]."""
    return period_s(epochs.select(pl.col("time_ns").diff().over("track"))["time_ns"].drop_nulls().to_numpy(writable=True))
