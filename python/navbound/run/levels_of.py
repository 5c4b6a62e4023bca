"""One part of a campaign: a table, or a receiver's observations with the navigation data and the messages of its time."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import polars as pl

from navbound import gnss, sbas
from navbound.errors import FormatError, InputError
from navbound.read.epochs import read
from navbound.read.source import Source, load
from navbound.read.truth import join, with_error

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from navbound.read.epochs import Reading

COVARIANCE = ("cov_ee_m2", "cov_en_m2", "cov_nn_m2", "cov_eu_m2", "cov_nu_m2", "cov_uu_m2")

SCHEMA = pl.Schema(
    {
        "track": pl.String,
        "time_ns": pl.Int64,
        **dict.fromkeys(("est_lat_rad", "est_lon_rad", "est_h_m"), pl.Float64),
        **dict.fromkeys(("nse_e_m", "nse_n_m", "nse_u_m", "hpe_m", "vpe_m", "hpl_m", "vpl_m"), pl.Float64),
        **dict.fromkeys(COVARIANCE, pl.Float64),
        "n_sv": pl.Int64,
        **dict.fromkeys(("hdop", "vdop"), pl.Float64),
        **dict.fromkeys(("mode", "status", "reason"), pl.String),
    }
)
"""Columns of a performance run's epochs."""

BEFORE_NS = 3_600_000_000_000
"""Messages of the hour before the first epoch still count: nothing that a service broadcasts is valid longer."""

MIXED = (
    "Errors are those of the uncorrected broadcast positions, protection levels those of the SBAS service at the same epochs: safety index "
    "and misleading information compare two different positions and are not the service's."
)
"""Stands beside every number of a run on observations and SBAS messages."""


OWN = (
    "No service monitors these satellites: the protection levels are 6.0 and 5.33 standard deviations (the multipliers of SBAS) of the "
    "position's own covariance, a bound of errors that are as the weights say and of no fault. Experimental, not integrity."
)
"""Stands beside every number of a run on observations alone."""


@dataclass(frozen=True)
class Truth:
    """Where the receiver really was: a fixed point, or a recording.

    Attributes
    ----------
    given : str or None
        As it was given.
    ecef_m : ndarray, shape (3,), or None
        A fixed point, Earth-fixed. [m]
    tolerance_s : float
        How far apart in time an estimate and its recorded truth may lie. [s]
    """

    given: str | None
    ecef_m: NDArray[np.float64] | None
    tolerance_s: float


def truth_of(given: str | Path | None, tolerance_s: float) -> Truth:
    """Read ``X,Y,Z`` (Earth-fixed, metres), or take a file's name.

    Raises
    ------
    InputError
        Three numbers that are no place near the Earth's surface.
    """
    if given is None:
        return Truth(None, None, tolerance_s)
    text = str(given)
    number = r"\s*[-+]?\d+(?:\.\d*)?\s*"
    if re.fullmatch(f"{number},{number},{number}", text) is None:
        return Truth(text, None, tolerance_s)
    point = np.array([float(part) for part in text.split(",")])
    if not 6.3e6 < float(np.linalg.norm(point)) < 6.5e6:
        raise InputError("truth", text, "m", "X,Y,Z of a point within 100 km of the Earth's surface, or a file")
    return Truth(text, point, tolerance_s)


@dataclass(frozen=True)
class Files:
    """Files by what they hold."""

    tables: list[Source] = field(default_factory=list)
    observations: list[Source] = field(default_factory=list)
    navigation: list[Source] = field(default_factory=list)
    messages: list[Source] = field(default_factory=list)


def sort_out(paths: Sequence[str | Path]) -> Files:
    """Tell observations, navigation data, message logs and tables apart by their content.

    Only digests and kinds are kept; contents are read again when they are needed.

    Raises
    ------
    FormatError
        A file that cannot be read.
    InputError
        Observations without navigation data, or navigation data and messages without observations.
    """
    files = Files()
    for path in paths:
        source = load(path)
        kind = getattr(files, _kind(source))
        kind.append(Source(source.path, b"", source.sha256, source.n_bytes))
    if files.observations and not files.navigation:
        raise InputError("files", f"{files.observations[0].path}", domain="observations together with a RINEX navigation file")
    if not files.observations and (files.navigation or files.messages):
        raise InputError("files", f"{(files.navigation + files.messages)[0].path}", domain="them together with RINEX observations")
    return files


def _kind(source: Source) -> str:
    first = source.content[:200].split(b"\n", 1)[0]
    if b"CRINEX VERS" in first:
        return "observations"
    if b"RINEX VERSION / TYPE" in first:
        if first[20:21] == b"O":
            return "observations"
        return "messages" if first[20:21] in {b"B", b"H"} and b"NAV" not in first[20:40] else "navigation"
    name = source.path.name.lower().removesuffix(".gz")
    return "messages" if name.endswith((".ems", ".sbs")) else "tables"


@dataclass(frozen=True)
class Part:
    """What one file gave.

    Attributes
    ----------
    epochs : DataFrame
        Columns of `SCHEMA`.
    n_rows : int
        Rows or epochs in the file.
    rejected : list of dict
        Fields of `Rejection`.
    notes : list of str
        What a person should know.
    experimental : str
        Words that must stand beside levels that no integrity rests on; empty for others.
    ranges : DataFrame, optional
        Ranges with their errors, for the Stanford-ESA diagram; columns of :func:`navbound.kpi.stanford_esa`.
    """

    epochs: pl.DataFrame
    n_rows: int
    rejected: list[dict[str, Any]]
    notes: list[str]
    experimental: str = ""
    ranges: pl.DataFrame | None = None


def from_table(path: Path, truth: Truth, columns: Mapping[str, str] | None) -> Part:
    """Read a table of errors and protection levels, or of positions and protection levels with a truth.

    Raises
    ------
    FormatError
        Not a table, or no time or protection level in it.
    InputError
        Several tracks in one file, or a truth without positions.
    """
    reading = read(path, columns=columns, levels=True)
    if "hpl_m" not in reading.epochs.columns:
        raise FormatError(path, "no column holds a protection level", field="hpl_m")
    tracks = reading.epochs["track"].unique().sort().to_list()
    if len(tracks) > 1:
        raise InputError("files", f"{path}: tracks {', '.join(map(str, tracks[:4]))}", domain="the series of one receiver in each file")
    epochs, notes = reading.epochs, list(reading.notes)
    if truth.given is not None:
        epochs, words = _with_truth(epochs, reading, truth)
        notes.append(words)
    elif {"truth_lat_rad", "truth_lon_rad", "est_lat_rad", "est_lon_rad"} <= set(epochs.columns) and "nse_e_m" not in epochs.columns:
        epochs = with_error(epochs)
    rejected = [r.model_dump() for r in reading.rejected]
    # Columns of Error Extraction say in their own name what they are.
    of_extraction = any(reading.columns.get(name, "").startswith("ee_") for name in ("hpl_m", "vpl_m"))
    return Part(uniform(epochs), reading.source.n_rows or 0, rejected, notes, sbas.EXTRACTION_LABEL if of_extraction else "")


def _with_truth(epochs: pl.DataFrame, reading: Reading, truth: Truth) -> tuple[pl.DataFrame, str]:
    if not {"est_lat_rad", "est_lon_rad"} <= set(epochs.columns):
        raise InputError("truth", truth.given, domain=f"no truth: {reading.source.path} holds no positions to compare with it")
    if truth.ecef_m is None:
        return join(epochs, read(str(truth.given)), truth.tolerance_s)
    place = gnss.geodetic(truth.ecef_m)
    names = ("truth_lat_rad", "truth_lon_rad", "truth_h_m")
    fixed = epochs.with_columns(pl.lit(float(value)).alias(name) for name, value in zip(names, place, strict=True))
    return with_error(fixed), f"Truth: the fixed point {truth.given} m, Earth-fixed."


def from_observations(
    path: Path, navigation: Sequence[Path], logs: Sequence[Path], truth: Truth, *, prn: int | None = None, keep_ranges: bool = False
) -> Part:
    """Solve a receiver's positions; their protection levels are those of the SBAS service there, or without messages their own.

    Raises
    ------
    FormatError
        A file that cannot be read.
    InputError
        Messages of several satellites and none chosen, no message of the time, or ranges wanted without truth or with messages.
    """
    observations, records = gnss.read_observations(path), gnss.read_navigation(list(navigation))
    ionosphere: Literal["broadcast", "none"] = "broadcast" if records.has_ionosphere else "none"
    positions = gnss.solve(
        observations, records, systems="G", ionosphere=ionosphere, truth_ecef_m=truth.ecef_m, keep_ranges=keep_ranges and not logs
    )
    epochs, notes = positions.epochs, [f"{name}: {words}" for name, words in positions.models.items()]
    if truth.given is not None and truth.ecef_m is None:
        recorded = read(truth.given)
        epochs, words = join(epochs, recorded, truth.tolerance_s)
        notes.append(words)
    ranges = _range_errors(positions.ranges, epochs) if positions.ranges is not None else None
    if logs:
        epochs = _of_service(epochs, navigation, _messages(logs, epochs["time_ns"], prn), truth)
        return Part(uniform(epochs), observations.n_epochs, [], [MIXED, *notes] if truth.given is not None else notes)
    return Part(uniform(_of_own(epochs)), observations.n_epochs, [], [OWN, *notes], sbas.EXTRACTION_LABEL, ranges)


def _of_own(epochs: pl.DataFrame) -> pl.DataFrame:
    """Levels of the positions' own covariances."""
    found = sbas.covariance_levels(np.column_stack([epochs[name].fill_null(np.nan).to_numpy() for name in COVARIANCE]))
    return epochs.with_columns(hpl_m=pl.Series(found[0], nan_to_null=True), vpl_m=pl.Series(found[1], nan_to_null=True))


def _range_errors(ranges: pl.DataFrame, epochs: pl.DataFrame) -> pl.DataFrame:
    """Residuals at the estimated position become errors at the true one: the true range is longer by -u . nse."""
    if "nse_e_m" not in epochs.columns:
        raise InputError("stanford_esa", "no truth", domain="it with --truth: a subset's error is that against the true position")
    joined = ranges.join(epochs.select("time_ns", "nse_e_m", "nse_n_m", "nse_u_m"), on="time_ns", maintain_order="left")
    east, north = pl.col("el_rad").cos() * pl.col("az_rad").sin(), pl.col("el_rad").cos() * pl.col("az_rad").cos()
    moved = east * pl.col("nse_e_m") + north * pl.col("nse_n_m") + pl.col("el_rad").sin() * pl.col("nse_u_m")
    return joined.with_columns(range_error_m=pl.col("residual_m") + moved).drop_nulls("range_error_m")


def _of_service(epochs: pl.DataFrame, navigation: Sequence[Path], messages: sbas.Messages, truth: Truth) -> pl.DataFrame:
    """Levels that the service gives at the receiver's place."""
    place = np.column_stack([epochs[name].fill_null(np.nan).to_numpy() for name in ("est_lat_rad", "est_lon_rad", "est_h_m")])
    if truth.ecef_m is not None:
        place = np.broadcast_to(gnss.geodetic(truth.ecef_m), place.shape)
    known = np.isfinite(place).all(axis=1)
    found = sbas.protection_levels(
        messages,
        list(navigation),
        epochs["time_ns"].to_numpy()[known],
        lat_rad=place[known, 0],
        lon_rad=place[known, 1],
        h_m=place[known, 2],
    )
    return _with_levels(epochs, found, known)


def _with_levels(epochs: pl.DataFrame, found: sbas.Levels, known: NDArray[np.bool_]) -> pl.DataFrame:
    why = np.array(["", *found.reasons], dtype=np.str_)[found.reason]
    levels = pl.DataFrame(
        {
            "row": np.flatnonzero(known),
            "hpl_m": found.hpl_m,
            "vpl_m": found.vpl_m,
            "n_sv": found.n_sv,
            "mode": found.mode.astype(str),
            "why": why.astype(str),
        }
    )
    joined = epochs.drop("n_sv").with_row_index("row").with_columns(pl.col("row").cast(pl.Int64))
    joined = joined.join(levels, on="row", how="left", maintain_order="left")
    solved = ~pl.col("status").is_in(["not_available", "invalid_input"])
    reason = pl.when(solved & (pl.col("why") != "")).then("why").otherwise("reason").alias("reason")
    return joined.with_columns(pl.selectors.by_name("hpl_m", "vpl_m").fill_nan(None), pl.col("mode").replace({"": None}), reason)


def _messages(logs: Sequence[Path], times: pl.Series, prn: int | None) -> sbas.Messages:
    """Those of the time of the epochs, of one satellite."""
    first, last = int(times[0]) - BEFORE_NS, int(times[-1])
    read_logs = [sbas.read(log) for log in logs]
    near = [m for m in read_logs if len(m.time_ns) and m.time_ns[0] <= last and m.time_ns[-1] >= first]
    if not near:
        raise InputError("files", ", ".join(str(log) for log in logs)[:200], domain="message logs of the time of the observations")
    time_ns, sender, data = (np.concatenate([getattr(m, name) for m in near]) for name in ("time_ns", "prn", "data"))
    order = np.argsort(time_ns, kind="stable")
    joined = sbas.Messages(time_ns[order], sender[order], data[order], near[0].format, near[0].tag, [r for m in near for r in m.refused])
    senders = np.unique(sender).tolist()
    if prn is None and len(senders) > 1:
        raise InputError("prn", "none", domain=f"one of the satellites of the logs: {', '.join(map(str, senders))}")
    if prn is not None and prn not in senders:
        raise InputError("prn", prn, domain=f"one of the satellites of the logs: {', '.join(map(str, senders))}")
    return joined if prn is None else joined.of(prn)


def uniform(epochs: pl.DataFrame) -> pl.DataFrame:
    """Every column of the schema, absent ones null, in the order of time."""
    return epochs.select(
        (pl.col(name) if name in epochs.columns else pl.lit(None)).cast(kind).alias(name) for name, kind in SCHEMA.items()
    ).sort("time_ns", maintain_order=True)
