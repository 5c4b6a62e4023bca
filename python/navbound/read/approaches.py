"""Landings in recorded tracks: which runway, which epochs, how far from the centreline."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.runways import Runway, cells, near_cells
from navbound.records.run import CrossTrack
from navbound.storage.tables import has_values, pieces
from navbound.units import METRES_PER_FT, METRES_PER_NM
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from navbound.storage.tables import Table


@dataclass(frozen=True)
class Gates:
    """When a point belongs to an approach, and when a series of points is one. Provenance: ours.

    Attributes
    ----------
    before_min_m, before_max_m : float
        Distance before the landing threshold, along the centreline.
    cross_max_m : float
        Distance from the centreline.
    track_max_rad : float
        Between the direction of travel and the centreline.
    altitude_max_m : float
        Reported altitude; `above_runway_m` above a runway that lies so high that this is more.
    above_runway_m : float
        See above.
    descending : bool
        The vertical rate must be below zero.
    lasts_min_s : float
        Time in view inside the gates: points times their median interval, so that a recording at 10 s has the approaches of one at 1 s.
    n_min : int
        Points in an approach: below this its statistics say nothing.
    span_min_m : float
        Between its first and its last point, along the centreline.
    lands_within_m : float
        How near before the threshold the last point must lie.
    gap_max_s : float
        A longer pause between points begins another approach.
    """

    before_min_m: float = 0.5 * METRES_PER_NM
    before_max_m: float = 6.0 * METRES_PER_NM
    cross_max_m: float = 150.0
    track_max_rad: float = math.radians(6.0)
    altitude_max_m: float = 3500 * METRES_PER_FT
    above_runway_m: float = 2500 * METRES_PER_FT
    descending: bool = True
    lasts_min_s: float = 60.0
    n_min: int = 4
    span_min_m: float = 2.5 * METRES_PER_NM
    lands_within_m: float = 1.5 * METRES_PER_NM
    gap_max_s: float = 120.0


@dataclass(frozen=True)
class Approaches:
    """Landings found.

    Attributes
    ----------
    epochs : DataFrame
        Every epoch between the first point of an approach and its end, ``track`` naming the approach, with the flight technical error. It
        ends with its last point inside the gates; where the aircraft leaves the centreline after that, where it has passed
        ``before_min_m`` or comes no nearer to the threshold.
    cross_track : list of CrossTrack
        Statistics of the points inside the gates, runway by runway; then once more without held positions where there were any.
    runways : list of Runway
        The runways landed on.
    tracks : dict
        Name of the approach to the track it is part of.
    notes : list of str
        Rules that could not be applied, and passes along a centreline that are no approach, each with the rule that it fails.
    """

    epochs: pl.DataFrame
    cross_track: list[CrossTrack]
    runways: list[Runway]
    tracks: dict[str, str]
    notes: list[str]


def find(epochs: pl.DataFrame, runways: Sequence[Runway] | None = None, gates: Gates | None = None) -> Approaches:
    """Find the landings on some runways, or on any.

    Parameters
    ----------
    epochs : DataFrame
        Epoch table, sorted by track and time, with ``status``.
    runways : sequence of Runway, optional
        Where to look; every runway near the low parts of the tracks when not given.
    gates : Gates, optional
        When a point belongs to an approach.
    """
    landings = seek(epochs, runways, gates)
    return Approaches(landings.between(epochs), landings.cross_track, landings.runways, landings.tracks, landings.notes)


@dataclass(frozen=True)
class Landings:
    """Landings of a table at once or in pieces, without its epochs.

    Attributes
    ----------
    approaches : DataFrame
        ``track``, ``approach``, ``runway_name``, ``start`` and ``end`` (GPS ns) of each.
    cross_track, runways, tracks, notes
        As of :class:`Approaches`.
    n_unjudged : int
        Passes along a centreline that are no approach, and that no approach of their track covers.
    n_elsewhere : int
        Tracks without an approach.
    due : dict
        Name of the approach to when it would have passed ``before_min_m`` at its own mean speed (GPS ns).
    """

    approaches: pl.DataFrame
    cross_track: list[CrossTrack]
    runways: list[Runway]
    tracks: dict[str, str]
    notes: list[str]
    n_unjudged: int = 0
    n_elsewhere: int = 0
    due: dict[str, int] = field(default_factory=dict)

    def between(self, epochs: pl.DataFrame) -> pl.DataFrame:
        """Every epoch of a piece that lies on an approach, in the order of approach and time."""
        if self.approaches.is_empty():
            return epochs.clear()
        return _between(epochs, self.approaches, {r.name: r for r in self.runways})


def seek(epochs: Table, runways: Sequence[Runway] | None = None, gates: Gates | None = None) -> Landings:
    """Find the landings of a table that may be in pieces; parameters as of :func:`find`."""
    gates = gates or Gates()
    notes = _missing_rules(epochs, gates)
    ruled = _Ruled.of(epochs)
    if runways is None:
        runways = near_cells([_low_cells(piece, gates, ruled) for piece in pieces(epochs, _POINTS)])
    names = [r.name for r in runways]
    near = [_near(piece, runways, gates, ruled) for piece in pieces(epochs, [*_POINTS, "track", "time_ns", "status"])]
    points = pl.concat(near) if runways and near else pl.DataFrame()
    none = pl.DataFrame(), pl.DataFrame()
    segments, lost = _segments(points.filter("gated").drop("gated"), gates) if runways and near else none
    notes += _lost_words(lost, names)
    if segments.is_empty():
        return Landings(pl.DataFrame(), [], [], {}, notes, lost.height)
    segments = segments.with_columns(pl.col("runway").replace_strict(dict(enumerate(names)), return_dtype=pl.String).alias("runway_name"))
    named = _named(segments)
    approaches = _with_ends(named, points.filter(~pl.col("gated")), gates)
    used = [r for r in runways if r.name in set(approaches["runway_name"])]
    tracks = dict(approaches.select("approach", "track").iter_rows())
    every = {track: None for piece in pieces(epochs, ["track"]) for track in piece["track"].unique(maintain_order=True)}
    landed = set(tracks.values())
    elsewhere = [str(track) for track in every if track not in landed]
    notes += _elsewhere_words(elsewhere, len(every))
    return Landings(approaches, _statistics(segments), used, tracks, notes, lost.height, len(elsewhere), _due(named, gates))


_POINTS = ("est_lat_rad", "est_lon_rad", "altitude_m", "est_h_m", "ground_track_rad", "vertical_rate_mps")


@dataclass(frozen=True)
class _Ruled:
    """What the whole table holds anywhere: a rule for it then applies to every point, and a missing value fails it."""

    altitude: bool
    ground_track: bool
    vertical_rate: bool

    @staticmethod
    def of(epochs: Table) -> _Ruled:
        altitude = any(has_values(epochs, name) for name in ("altitude_m", "est_h_m"))
        return _Ruled(altitude, has_values(epochs, "ground_track_rad"), has_values(epochs, "vertical_rate_mps"))


def _low_cells(epochs: pl.DataFrame, gates: Gates, ruled: _Ruled) -> pl.DataFrame:
    """Where the low parts of the tracks are."""
    points = _Points.of(epochs)
    low = points.altitude_m < gates.altitude_max_m if ruled.altitude else np.ones(len(points.lat_rad), dtype=bool)
    return cells(points.lat_rad[low], points.lon_rad[low])


def _near(epochs: pl.DataFrame, runways: Sequence[Runway], gates: Gates, ruled: _Ruled) -> pl.DataFrame:
    """Points inside the gates of any runway, and those beside its last mile, with their track, time and status."""
    points = _Points.of(epochs)
    gated = [_gate(points, runway, index, gates, ruled) for index, runway in enumerate(runways)]
    rows = epochs.select("track", "time_ns", "status").with_row_index("row")
    return pl.concat(gated).join(rows, on="row").drop("row") if gated else rows.clear()


@dataclass(frozen=True)
class _Points:
    """What the gates look at; NaN where the file does not say."""

    lat_rad: NDArray[np.float64]
    lon_rad: NDArray[np.float64]
    altitude_m: NDArray[np.float64]
    ground_track_rad: NDArray[np.float64]
    vertical_rate_mps: NDArray[np.float64]

    @staticmethod
    def of(epochs: pl.DataFrame) -> _Points:
        def array(*names: str) -> NDArray[np.float64]:
            present = [pl.col(n) for n in names if n in epochs.columns]
            # A literal alone would be one row: an absent column is unknown at every epoch.
            unknown = pl.repeat(math.nan, epochs.height, dtype=pl.Float64)
            return epochs.select(pl.coalesce(*present, unknown).alias("v")).to_series().to_numpy()

        return _Points(
            array("est_lat_rad"),
            array("est_lon_rad"),
            array("altitude_m", "est_h_m"),
            array("ground_track_rad"),
            array("vertical_rate_mps"),
        )


def _missing_rules(epochs: Table, gates: Gates) -> list[str]:
    rules = {"ground_track_rad": "the direction of travel", "altitude_m": "the altitude"}
    if gates.descending:
        rules["vertical_rate_mps"] = "the descent"
    absent = [
        words for name, words in rules.items() if name not in epochs.columns and not (name == "altitude_m" and "est_h_m" in epochs.columns)
    ]
    return [f"Approaches were found without a rule for {words}: no column of the file is read as it." for words in absent]


def _gate(points: _Points, runway: Runway, index: int, gates: Gates, ruled: _Ruled) -> pl.DataFrame:
    """Points inside the gates of one runway and beside its last mile: row of the epoch table, distances before the threshold and across."""
    selected = _roughly(points, runway, gates)
    feet = runway.centreline.project(points.lat_rad[selected], points.lon_rad[selected])
    before = -feet.along_m
    turn = np.abs((points.ground_track_rad[selected] - feet.course_rad + np.pi) % (2 * np.pi) - np.pi)
    ceiling = max(gates.altitude_max_m, runway.elevation_m + gates.above_runway_m)
    inside = (before > gates.before_min_m) & (before < gates.before_max_m) & (np.abs(feet.cross_m) < gates.cross_max_m)
    if ruled.ground_track:
        inside &= turn < gates.track_max_rad
    if ruled.altitude:
        inside &= points.altitude_m[selected] < ceiling
    if gates.descending and ruled.vertical_rate:
        inside &= points.vertical_rate_mps[selected] < 0
    beside = ~inside & (before > gates.before_min_m) & (before <= gates.lands_within_m) & (np.abs(feet.cross_m) < _STRAYS_M)
    kept = inside | beside
    return pl.DataFrame(
        {
            "row": pl.Series(selected[kept], dtype=pl.UInt32),
            "runway": pl.Series([index] * int(kept.sum()), dtype=pl.Int64),
            "before_m": before[kept],
            "cross_m": feet.cross_m[kept],
            "gated": inside[kept],
        }
    )


_STRAYS_M = 3.0 * METRES_PER_NM
"""How far from the centreline an aircraft is followed that leaves it in the last mile; 2 RNP of 1 NM is less. Provenance: ours."""


def _roughly(points: _Points, runway: Runway, gates: Gates) -> NDArray[np.int64]:
    """Rows that may lie inside the gates or beside the last mile: a flat map, off by 10 m at six miles, with 300 m and 3 % to spare."""
    course, r = runway.course_rad, 6.371e6
    north = (points.lat_rad - runway.lat_rad) * r
    east = ((points.lon_rad - runway.lon_rad + np.pi) % (2 * np.pi) - np.pi) * r * math.cos(runway.lat_rad)
    before = -(north * math.cos(course) + east * math.sin(course))
    cross = east * math.cos(course) - north * math.sin(course)
    spare = 300.0 + 0.03 * gates.before_max_m
    wide = np.where(before < gates.lands_within_m + spare, max(_STRAYS_M, gates.cross_max_m), gates.cross_max_m)
    close = (before > gates.before_min_m - spare) & (before < gates.before_max_m + spare) & (np.abs(cross) < wide + spare)
    return np.flatnonzero(close)


def _segments(gated: pl.DataFrame, gates: Gates) -> tuple[pl.DataFrame, pl.DataFrame]:
    """Gated points of accepted approaches, with ``segment``; of two runways at one time the one flown closer to. And who is left out."""
    points = gated.sort("runway", "track", "time_ns")
    new = (
        (pl.col("time_ns").diff() > int(gates.gap_max_s * 1e9))
        | (pl.col("track") != pl.col("track").shift())
        | (pl.col("runway") != pl.col("runway").shift())
    )
    points = points.with_columns(new.fill_null(value=True).cum_sum().alias("segment"))
    span = pl.col("before_m").max() - pl.col("before_m").min()
    segments = points.group_by("segment").agg(
        n=pl.len(), span=span, nearest=pl.col("before_m").min(), off=pl.col("cross_m").abs().mean(), start=pl.col("time_ns").min(),
        end=pl.col("time_ns").max(), track=pl.col("track").first(), runway=pl.col("runway").first(),
        period_s=pl.col("time_ns").diff().median() * 1e-9,
    ).with_columns(lasts_s=pl.col("n") * pl.col("period_s"))  # fmt: skip
    rules = {
        f"fewer than {gates.n_min} points": pl.col("n") >= gates.n_min,
        f"inside the gates for less than {gates.lasts_min_s:g} s": pl.col("lasts_s") >= gates.lasts_min_s,
        f"shorter than {gates.span_min_m / METRES_PER_NM:g} NM": pl.col("span") >= gates.span_min_m,
        f"ends more than {gates.lands_within_m / METRES_PER_NM:g} NM before the threshold": pl.col("nearest") <= gates.lands_within_m,
    }
    failed = pl.coalesce(pl.when(~holds.fill_null(value=False)).then(pl.lit(words)) for words, holds in rules.items())
    segments = segments.with_columns(failed=failed)
    accepted = segments.filter(pl.col("failed").is_null())
    lost = _lost(segments.filter(pl.col("failed").is_not_null(), pl.col("span") >= _PASS_M), accepted)
    rival = accepted.join(accepted, on="track", suffix="_b").filter(
        pl.col("segment") != pl.col("segment_b"),
        pl.col("start") <= pl.col("end_b"),
        pl.col("start_b") <= pl.col("end"),
        pl.col("off") > pl.col("off_b"),
    )
    accepted = accepted.join(rival, on="segment", how="anti")
    return points.join(accepted.select("segment"), on="segment", how="semi"), lost


_PASS_M = 1.0 * METRES_PER_NM
"""Along a centreline for this far is a pass that a reader of the result may miss among the approaches. Provenance: ours."""
_PASSES_NAMED = 8


def _lost(failed: pl.DataFrame, accepted: pl.DataFrame) -> pl.DataFrame:
    """Passes that no accepted approach covers, with the rule that each fails; of several at one time, to parallel runways, the first."""
    covered = failed.join(accepted.select("track", "start", "end"), on="track", suffix="_of").filter(
        pl.col("start") <= pl.col("end_of"), pl.col("start_of") <= pl.col("end")
    )
    lost = failed.join(covered, on="segment", how="anti").sort("track", "start", "off")
    return lost.filter((pl.col("start") > pl.col("end").cum_max().shift().over("track")).fill_null(value=True))


def _lost_words(lost: pl.DataFrame, names: list[str]) -> list[str]:
    if lost.is_empty():
        return []
    shown = [
        f"{row['track']} to {names[row['runway']]} ({row['failed']}: {counted(row['n'], 'point')}, {row['span'] / METRES_PER_NM:.1f} NM)"
        for row in lost.head(_PASSES_NAMED).iter_rows(named=True)
    ]
    more = f"; and {lost.height - _PASSES_NAMED} more" if lost.height > _PASSES_NAMED else ""
    return [
        f"{counted(lost.height, 'pass', 'passes')} along a runway's centreline {agreeing(lost.height, 'is', 'are')} not judged as "
        f"approaches: {'; '.join(shown)}{more}."
    ]


def _elsewhere_words(elsewhere: list[str], n_tracks: int) -> list[str]:
    """Tracks that are not judged at all: a departure, or one that left the centreline before an approach could be seen."""
    if not elsewhere:
        return []
    more = f" and {len(elsewhere) - _PASSES_NAMED} more" if len(elsewhere) > _PASSES_NAMED else ""
    return [
        f"{len(elsewhere)} of {counted(n_tracks, 'track')} {agreeing(len(elsewhere), 'has', 'have')} no approach to these runways and "
        f"{agreeing(len(elsewhere), 'is', 'are')} not judged: "
        f"{', '.join(elsewhere[:_PASSES_NAMED])}{more}. Where they flew is no part of the verdict."
    ]


def _named(segments: pl.DataFrame) -> pl.DataFrame:
    """One row an approach: ``3944ed LFPG/08R``, with a count when a track lands there again."""
    approaches = segments.group_by("segment").agg(
        pl.col("track", "runway", "runway_name").first(),
        start=pl.col("time_ns").min(),
        end=pl.col("time_ns").max(),
        nearest_m=pl.col("before_m").min(),
        furthest_m=pl.col("before_m").max(),
    )
    approaches = approaches.sort("track", "start").with_columns(again=pl.int_range(1, pl.len() + 1).over("track", "runway_name"))
    name = pl.concat_str("track", pl.lit(" "), "runway_name")
    return approaches.with_columns(
        approach=pl.when(pl.col("again") > 1).then(pl.concat_str(name, pl.lit(" "), pl.col("again").cast(pl.String))).otherwise(name)
    )


def _due(approaches: pl.DataFrame, gates: Gates) -> dict[str, int]:
    """When each would have passed the last gate at its own mean speed: rows without a position until then belong to it. [GPS ns]."""
    passed = (pl.col("end") - pl.col("start")) * (pl.col("nearest_m") - gates.before_min_m) / (pl.col("furthest_m") - pl.col("nearest_m"))
    return dict(approaches.select("approach", due=pl.col("end") + passed.round().cast(pl.Int64)).iter_rows())


def _with_ends(approaches: pl.DataFrame, beside: pl.DataFrame, gates: Gates) -> pl.DataFrame:
    """Approaches to their ends: who leaves the centreline in the last mile is judged while it comes nearer to the threshold."""
    of = {key: rows.sort("time_ns") for key, rows in beside.group_by("track", "runway")}
    last = approaches.select("track", "runway", "end", "nearest_m").iter_rows()
    ends = [_end(of.get((track, runway), beside.clear()), at_ns, nearest_m, gates) for track, runway, at_ns, nearest_m in last]
    return approaches.with_columns(pl.Series("end", ends, dtype=pl.Int64)).drop("runway", "nearest_m", "furthest_m")


def _end(beside: pl.DataFrame, last_ns: int, nearest_m: float, gates: Gates) -> int:
    """The last time of one approach [GPS ns]."""
    for time_ns, before_m in beside.filter(pl.col("time_ns") > last_ns).select("time_ns", "before_m").iter_rows():
        if time_ns - last_ns > gates.gap_max_s * 1e9 or before_m > nearest_m:
            break
        last_ns, nearest_m = time_ns, before_m
    return last_ns


def _between(epochs: pl.DataFrame, approaches: pl.DataFrame, runways: dict[str, Runway]) -> pl.DataFrame:
    """Every epoch from the first point of an approach to its end, inside the gates or not: a gate must not hide a deviation."""
    judged = epochs.join(approaches.select("track", "approach", "runway_name", "start", "end"), on="track")
    judged = judged.filter(pl.col("time_ns").is_between(pl.col("start"), pl.col("end"))).sort("approach", "time_ns")
    parts = list[pl.DataFrame]()
    for (name,), group in judged.group_by("runway_name", maintain_order=True):
        feet = runways[str(name)].centreline.project(group["est_lat_rad"].to_numpy(), group["est_lon_rad"].to_numpy())
        parts.append(
            group.with_columns(
                pl.Series("path_lat_rad", feet.lat_rad),
                pl.Series("path_lon_rad", feet.lon_rad),
                pl.Series("course_rad", feet.course_rad),
                pl.Series("along_m", feet.along_m),
                pl.Series("fte_m", feet.cross_m),
                leg=pl.col("runway_name"),
                phase=pl.lit("final approach"),
                track=pl.col("approach"),
            )
        )
    if not parts:
        return epochs.clear()
    return pl.concat(parts).drop("approach", "runway_name", "start", "end").sort("track", "time_ns")


def _statistics(segments: pl.DataFrame) -> list[CrossTrack]:
    every = [statistics(str(name), group) for (name,), group in segments.sort("runway_name").group_by("runway_name", maintain_order=True)]
    fresh = segments.filter(pl.col("status") == "ok")
    if fresh.height == segments.height:
        return every
    rest = fresh.sort("runway_name").group_by("runway_name", maintain_order=True)
    return every + [statistics(f"{name}, held and implausible positions left out", group) for (name,), group in rest]


def statistics(name: str, points: pl.DataFrame) -> CrossTrack:
    """Cross-track statistics of points with ``cross_m`` and ``segment``.

    Mean; standard deviation of the population; 95 % point of the absolute value by nearest rank; standard deviation of the means of the
    tracks (n - 1), which says how much tracks differ from each other.
    """
    # In the order of the points: a sum in the order of the threads would differ in its last bit from run to run.
    means = points.group_by("segment", maintain_order=True).agg(pl.col("cross_m").mean())["cross_m"]
    return cross_track_of(name, points["cross_m"].to_numpy(), means)


def cross_track_of(name: str, cross_m: NDArray[np.float64], means_m: pl.Series) -> CrossTrack:
    """The same of the distances and their means by track. [m]."""
    between = means_m.std(ddof=1) if len(means_m) > 1 else None
    rank = math.ceil(0.95 * len(cross_m))
    mean_m, std_m = float(cross_m.mean()), float(cross_m.std())
    # In place: a column of a large table is there twice at most.
    sizes = np.abs(cross_m)
    sizes.sort()
    return CrossTrack(
        path=name,
        n_tracks=len(means_m),
        n_points=len(cross_m),
        mean_m=mean_m,
        std_m=std_m,
        abs95_m=float(sizes[rank - 1]),
        between_tracks_std_m=float(between) if isinstance(between, float) else None,
    )
