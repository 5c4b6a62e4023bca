"""Recorded tracks to material: read, check, join the truth, find the path."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl

from navbound import status
from navbound._extraction_gains import EXTRACTION_LABEL, EXTRACTION_MARK
from navbound.errors import InputError
from navbound.read.approaches import Approaches, Gates, find, statistics
from navbound.read.columns import POSITION_TIME
from navbound.read.covariance import COLUMNS, Claimed, claim
from navbound.read.epochs import Reading, read
from navbound.read.plausible import Limits, check
from navbound.read.repeats import LEFT_OUT, left_out, separate
from navbound.read.routes import Route, follow, load_route
from navbound.read.runways import runway
from navbound.read.truth import TOLERANCE_S, join, truth_of, with_error, with_truth
from navbound.run.files import sort_out
from navbound.run.material import Material
from navbound.run.procedure import Flown, on_procedure
from navbound.run.records import CovarianceOrigin, Rejection, Waypoint
from navbound.run.solved import solved
from navbound.run.solving import Solving

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from navbound.run.records import CrossTrack, InputFile

_AUXILIARY = ("callsign", "nac_p", "nic", "rc_m", "epu_m", "sigma_e_m", "sigma_n_m", "sigma_u_m", POSITION_TIME)


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
        Recording of the true positions, in a form as `files`; or ``X,Y,Z`` of a receiver that does not move (Earth-fixed, metres).
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
        raise InputError("path", str(path), domain="none beside a procedure")
    gates, limits = gates or Gates(), limits or Limits()
    names = [files] if isinstance(files, str) or not hasattr(files, "__iter__") else list(files)
    if not names:
        raise InputError("files", "nothing", domain="one file or more")
    found = sort_out(names, solve=solve)
    found.require_navigation()
    solving = Solving(signals, systems, ionosphere, mask_rad)
    if not found.observations:
        solving.refuse("it together with measurements to solve: RINEX observations, or --solve with a receiver's log")
    readings = [read(source.path, columns=columns) for source in found.tables] + (solved(found, solving) if found.observations else [])
    _refuse_experimental(readings)
    inputs = [r.source for r in readings] + [source.record(None) for source in found.navigation if source not in found.observations]
    rejected = [x for r in readings for x in r.rejected]
    notes = found.cut_words() + [note for r in readings for note in r.notes]
    epochs, lost = _together(readings, rejected)
    labels = _labels(epochs)
    claimed = claim(epochs, sigma_m)
    epochs, plausibility = check(claimed.epochs, limits)
    origin = _origin(claimed, sigma_m, solved_alone=bool(found.observations) and not found.tables)
    of_covariance = "Covariance: solved with the positions, from the measurements." if origin.id == "solved" else claimed.words
    assumptions = [of_covariance, plausibility.words]
    named = truth_of(truth, truth_tolerance_s)
    if named.ecef_m is not None:
        epochs, words, _ = with_truth(epochs, named)
        assumptions.append(words)
    elif truth is not None:
        other = read(truth)
        inputs.append(other.source)
        rejected += other.rejected
        epochs, words = join(epochs, other, truth_tolerance_s)
        assumptions.append(words)
    elif {"truth_lat_rad", "truth_lon_rad"} <= set(epochs.columns):
        epochs = with_error(epochs)
        assumptions.append("Truth: from the file itself.")
    route = _follow(path, epochs, gates, rejected) if procedure is None else on_procedure(epochs, procedure)
    epochs = _covariance_status(route.epochs)
    if procedure is None:
        epochs = epochs.with_columns(pl.lit(float(rnp_m)).alias("rnp_m"))
    else:
        requirement = f"RNP by leg of {procedure.name}"
    return Material(
        epochs=epochs.drop(_AUXILIARY, strict=False),
        kind="analyze",
        title=route.heading if (path or procedure) is not None else f"{route.heading}: {', '.join(Path(str(n)).name for n in names)}",
        requirement=requirement,
        sample_period_s=_period(epochs),
        assumptions=[*assumptions, *route.words, *notes],
        covariance=origin,
        labels={track: f"{labels[of]} {track.partition(' ')[2]}".strip() for track, of in route.tracks.items()} if route.tracks else labels,
        waypoints=route.waypoints,
        inputs=inputs + route.inputs,
        rejected=rejected,
        left_out=pl.concat([_on_path(lost, epochs, route.tracks), route.left_out]),
        cross_track=route.cross_track,
        settings={
            "path": None if path is None else str(path),
            **({} if procedure is None else {"procedure": procedure.settings}),
            "rnp_m": rnp_m if procedure is None else None,
            "truth": None if truth is None else str(truth),
            "truth_tolerance_s": truth_tolerance_s,
            "sigma_m": sigma_m,
            "columns": {r.source.path: r.columns for r in readings},
            "columns_not_used": {r.source.path: r.unused for r in readings},
            "gates": asdict(gates),
            "limits": asdict(limits),
            "solve": solve,
            "solving": solving.named,
        },
    )


def _origin(claimed: Claimed, sigma_m: float | None, *, solved_alone: bool) -> CovarianceOrigin:
    solved_covariance = solved_alone and claimed.origin == "file"
    return CovarianceOrigin(id="solved" if solved_covariance else claimed.origin, sigma_m=sigma_m)


def _refuse_experimental(readings: list[Reading]) -> None:
    """Everything read here may reach an alert; columns of Error Extraction say in their own name that they may not."""
    for reading in readings:
        for name, column in reading.columns.items():
            if column.startswith(EXTRACTION_MARK):
                raise InputError(
                    "columns", f"{name} from {column}", domain=f"columns that may feed an alert; {column} is {EXTRACTION_LABEL}"
                )


@dataclass(frozen=True)
class _Path:
    """Epochs with the path they should have followed, and what the report says about it."""

    epochs: pl.DataFrame
    words: list[str]
    heading: str
    waypoints: list[Waypoint] = field(default_factory=list)
    inputs: list[InputFile] = field(default_factory=list)
    cross_track: list[CrossTrack] = field(default_factory=list)
    tracks: dict[str, str] = field(default_factory=dict)
    left_out: pl.DataFrame = field(default_factory=lambda: pl.DataFrame(schema=LEFT_OUT))


def _follow(path: str | Path | None, epochs: pl.DataFrame, gates: Gates, rejected: list[Rejection]) -> _Path:
    if path is None:
        words = "Path: none given, so there is no flight technical error; only the navigation system is judged."
        return _Path(_without_path(epochs), [words], "Recorded tracks")
    if Path(path).suffix.lower() in {".toml", ".csv"}:
        return _on_route(load_route(path), epochs, rejected)
    names = None if str(path) == "auto" else [name.strip() for name in str(path).split(",")]
    found = find(epochs, None if names is None else [runway(name) for name in names], gates)
    if found.epochs.is_empty():
        where = "any runway of the table" if names is None else ", ".join(names)
        passes = " ".join(["", *found.notes])
        raise InputError("path", str(path), domain=f"paths that a track follows: no approach to {where} was found with {gates}.{passes}")
    return _on_approach(found, gates, epochs.height)


def _without_path(epochs: pl.DataFrame) -> pl.DataFrame:
    absent = (pl.lit(None, pl.Float64).alias(c) for c in ("course_rad", "fte_m"))
    return epochs.with_columns(*absent, pl.lit("recorded track").alias("phase"))


def _on_route(route: Route, epochs: pl.DataFrame, rejected: list[Rejection]) -> _Path:
    followed, n_beyond = follow(epochs, route)
    if followed.is_empty():
        raise InputError(
            "path", route.source.path, domain="routes that a track follows: every epoch lies before its start or beyond its end"
        )
    if n_beyond:
        reason = "before the start or beyond the end of the route"
        rejected.append(Rejection(file=route.source.path, reason=reason, count=n_beyond, first_line=None, example=f"{n_beyond} epochs"))
    points = followed.select(cross_m="fte_m", segment="track")
    words = f"Path: route {route.source.path}, {len(route.waypoints)} waypoints, {route.path.length_m / 1852:.2f} NM."
    return _Path(followed, [words], f"Route {route.name}", route.waypoints, [route.source], [statistics(route.name, points)])


def _on_approach(found: Approaches, gates: Gates, n_recorded: int) -> _Path:
    n, runways = len(found.tracks), ", ".join(r.name for r in found.runways)
    words = [
        f"Path: the centreline through the runway ends of the shipped table (OurAirports), {gates.before_max_m / 1852:g} to "
        f"{gates.before_min_m / 1852:g} NM before the landing threshold; {n} approaches.",
        f"Judged are all epochs from the first to the last point of an approach, {found.epochs.height} of {n_recorded} recorded; what came "
        "before the first point is not. The path is the extended centreline, not a coded procedure: its own error counts as flight "
        "technical error.",
    ]
    waypoints = [Waypoint(name=r.name, lat_rad=r.lat_rad, lon_rad=r.lon_rad, kind="runway") for r in found.runways]
    heading = f"{n} recorded approaches to {runways if len(found.runways) <= 4 else f'{len(found.runways)} runways'}"
    words += [r.doubt for r in found.runways if r.doubt is not None]
    return _Path(found.epochs, words + found.notes, heading, waypoints, cross_track=found.cross_track, tracks=found.tracks)


def _together(readings: Sequence[Reading], rejected: list[Rejection]) -> tuple[pl.DataFrame, pl.DataFrame]:
    """All files as one table, an epoch that two files hold counts once; and the rows of all that cannot be judged."""
    epochs = pl.concat([r.epochs for r in readings], how="diagonal_relaxed").sort("track", "time_ns", maintain_order=True)
    if "status" in epochs.columns:
        # A file that says nothing of its epochs has nothing against them.
        epochs = epochs.with_columns(pl.col("status").fill_null("ok"))
    found = separate(epochs)
    reason = "time repeated within a track of several files"
    for words, repeated in ((reason, found.identical), (f"{reason} with another position, bound or status", found.contradicting)):
        if not repeated.is_empty():
            example = f"{repeated.height} epochs"
            rejected.append(Rejection(file=readings[-1].source.path, reason=words, count=repeated.height, first_line=None, example=example))
    return found.epochs, pl.concat([*(r.left_out for r in readings), left_out(found.contradicting)])


def _on_path(lost: pl.DataFrame, epochs: pl.DataFrame, tracks: Mapping[str, str]) -> pl.DataFrame:
    """The rows that cannot be judged and belong to what is judged: all, or those between the ends of an approach of their track."""
    if not tracks or lost.is_empty():
        return lost
    ends = epochs.group_by("track").agg(start=pl.col("time_ns").min(), end=pl.col("time_ns").max())
    ends = ends.with_columns(pl.col("track").replace_strict(dict(tracks), default=None, return_dtype=pl.String).alias("of"))
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


def _covariance_status(epochs: pl.DataFrame) -> pl.DataFrame:
    """Status of epochs whose position may be believed, but not the covariance. Written so that a NaN is on the bad side."""
    ee, nn, en = pl.col("cov_ee_m2"), pl.col("cov_nn_m2"), pl.col("cov_en_m2")
    # 1e-9 of the squared largest variance: the sixteen digits of a double less those the determinant loses.
    determinant = ee * nn - en**2 >= -1e-9 * pl.max_horizontal(ee, nn) ** 2
    positive = pl.all_horizontal(ee.is_finite(), nn.is_finite(), en.is_finite(), ee >= 0, nn >= 0, determinant).fill_null(value=False)
    believed = pl.col("status").is_in(status.USABLE)
    fault = (
        pl.when(~believed).then(pl.lit(None, pl.String))
        .when(pl.any_horizontal(c.is_null() for c in (ee, nn, en))).then(pl.lit("no_covariance"))
        .when(~positive).then(pl.lit("not_a_covariance"))
        .when(ee + nn == 0).then(pl.lit("zero_covariance"))
    )  # fmt: skip
    epochs = status.overridden(epochs, epochs.select(fault.alias("reason_id"))["reason_id"])
    return epochs.with_columns(pl.when(pl.col("status").is_in(status.USABLE)).then(pl.col(c)).alias(c) for c in COLUMNS)


def _period(epochs: pl.DataFrame) -> float:
    """Usual time between epochs of a track; 1 s where no track has two. [s]."""
    step = epochs.select(pl.col("time_ns").diff().over("track").median() * 1e-9).item()
    return float(step) if step is not None and step > 0 else 1.0
