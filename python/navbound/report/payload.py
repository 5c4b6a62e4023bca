"""What the page is given: the records, the columns of as many tracks as fit, and the coastline around them."""

from __future__ import annotations

import json
import math
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound.gnss.receivers import FATES
from navbound.report import packing, sky
from navbound.report.coast import airports, clip_coastline, clip_land, grid_region
from navbound.rnp.usual import breaks
from navbound.storage.tables import pieces
from navbound.table import lookup
from navbound.time import GPS_EPOCH_UNIX_NS, utc_offset_s
from navbound.units import shortening
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.records.run import RunRecord, Summary, TrackSummary, Waypoint, Worst
    from navbound.storage.tables import Table

BUDGET_BYTES = 1_720_000
"""Records and embedded tracks as text; with the page's own parts (about 0.25 MB) the file stays below 2 MB."""


@dataclass(frozen=True)
class Page:
    """JSON for the page, and one text block for each embedded track."""

    data: dict[str, Any]
    tracks: list[str]


def build(  # noqa: PLR0917 - as render
    summary: Summary,
    record: RunRecord,
    epochs: Table,
    events: pl.DataFrame,
    waypoints: list[Waypoint],
    budget_bytes: int = BUDGET_BYTES,
    *,
    satellites: pl.DataFrame | None = None,
) -> Page:
    """Select and pack what the page shows.

    Parameters
    ----------
    summary, record : Summary, RunRecord
        Records of the run.
    epochs : DataFrame or Frames
        The epoch table; columns that are absent are not shown.
    events : DataFrame
        Columns of docs/notation.md; when it has no rows, the events of ``summary``.
    waypoints : list of Waypoint
        Points named on the map.
    budget_bytes : int
        The worst tracks first get their detail columns embedded until this is used up; the worst track always. [B]
    satellites : DataFrame, optional
        What became of every satellite heard.

    Returns
    -------
    Page
        Records as JSON, columns as text blocks.
    """
    data = _records(summary, record, epochs, events, waypoints)
    listed = _shortened(data["summary"])
    try:
        text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    except ValueError:
        # Only records that hold such a number are walked through, value by value.
        data, listed = _finite(data), _finite(listed)
        text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    seen = sky.pack(satellites)
    of_satellites = len(json.dumps(seen.heads, separators=(",", ":"))) + sum(map(len, seen.blocks))
    room = budget_bytes - len(text) - of_satellites
    heads, blocks, words = _worst_tracks(summary, epochs, room, _beyond(listed))
    words += _list_all_of({str(head["track"]) for head in heads}, data["summary"], listed)
    data["summary"]["assumptions"] += words + seen.words
    heard = [head | {"block": len(blocks) + k} for k, head in enumerate(seen.heads)]
    return Page(data=data | {"tracks": heads, "heard": heard, "fates": FATES if heard else {}}, tracks=blocks + seen.blocks)


MOST_LISTED = {"events": 500, "faults": 200}
"""Rows of a list of the page; those of tracks whose columns are embedded are all there. [1] Provenance: ours."""


def _shortened(records: dict[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Cut the lists that grow with the number of tracks; each that was cut, whole."""
    whole = {name: records[name] for name, most in MOST_LISTED.items() if len(records[name]) > most}
    for name in whole:
        records[name] = records[name][: MOST_LISTED[name]]
    return whole


def _beyond(listed: dict[str, list[dict[str, Any]]]) -> dict[str, int]:
    """Bytes that a track adds to the lists that were cut. [B]."""
    added: Counter[str] = Counter()
    for name, rows in listed.items():
        for row in rows[MOST_LISTED[name] :]:
            added[row["track"]] += len(json.dumps(row, separators=(",", ":"))) + 1
    return added


def _list_all_of(embedded: set[str], records: dict[str, Any], listed: dict[str, list[dict[str, Any]]]) -> list[str]:
    """Put the rows of the embedded tracks into the lists that were cut; words on what is not listed."""
    words = []
    for name, rows in listed.items():
        records[name] = [row for k, row in enumerate(rows) if k < MOST_LISTED[name] or row["track"] in embedded]
        where = "summary.json" if name == "faults" else "events.parquet"
        words.append(f"The page lists {len(records[name])} of {len(rows)} {name}; all of them are in {where}.")
    return words


def _records(summary: Summary, record: RunRecord, epochs: Table, events: pl.DataFrame, waypoints: list[Waypoint]) -> dict[str, Any]:
    """Everything but the columns of the tracks."""
    region = _region(epochs, waypoints)
    records = summary.model_dump(mode="json")
    if events.height:
        records["events"] = events.to_dicts()
    return {
        "schema_id": "navbound-report-1",
        "summary": records,
        "record": record.model_dump(mode="json"),
        "waypoints": [w.model_dump(mode="json") for w in waypoints],
        "utc_offset_s": utc_offset_s(_first_time_ns(summary, epochs)),
        "gps_epoch_unix_s": GPS_EPOCH_UNIX_NS // 1_000_000_000,
        "charts": lookup.drawn(epochs.columns),
        "coastline": clip_coastline(*region),
        "land": clip_land(*region),
        "service_map": _service_map(summary),
        "airports": [w.model_dump(mode="json") for w in airports(_ends(epochs, summary), waypoints)],
    }


def _service_map(summary: Summary) -> dict[str, Any] | None:
    """Region and coast of the ionospheric grid of a service, which reaches far beyond the track."""
    service = summary.performance.service if summary.performance is not None else None
    region = grid_region(service.grid) if service is not None else None
    return None if region is None else {"region_deg": region, "coastline": clip_coastline(*region)}


MOST_ROWS = 200_000
"""Epochs of one track that are embedded: two days at one a second. [1]"""


def _worst_tracks(
    summary: Summary, epochs: Table, room_bytes: int, listed_bytes: dict[str, int]
) -> tuple[list[dict[str, object]], list[str], list[str]]:
    """Heads and blocks of the worst track and of those after it that fit, and words on what they do not show."""
    heads: list[dict[str, object]] = []
    blocks: list[str] = []
    words: list[str] = []
    columns = _columns(summary, epochs)
    drawn = ["time_ns", *columns, *(name for name in lookup.in_report("text") if name in epochs.columns)]
    for track in _worst_first(summary.tracks):
        frame, more = _track(epochs, track, summary.verdict.worst_accuracy, drawn)
        if frame.height == 0:
            continue
        head, block = _pack_track(track.track, frame, columns)
        room_bytes -= len(block) + len(json.dumps(head, separators=(",", ":"))) + listed_bytes.get(track.track, 0)
        if blocks and room_bytes < 0:
            break
        heads.append(head | {"block": len(blocks)})
        blocks.append(block)
        words += more
    return heads, blocks, words


def _track(epochs: Table, track: TrackSummary, worst: Worst | None, columns: list[str]) -> tuple[pl.DataFrame, list[str]]:
    """The epochs of one track, of one that is too long those around the worst; and words on that."""
    # One track at a time: the table of a campaign is not copied whole.
    parts = [epochs.filter(pl.col("track") == track.track)] if isinstance(epochs, pl.DataFrame) else epochs.track(track.track, columns)
    if track.n_epochs <= MOST_ROWS:
        return pl.concat(parts, rechunk=False), []
    at = worst.time_ns if worst is not None and worst.track == track.track else track.start_ns
    kept = None
    for part in parts:
        kept = part if kept is None else pl.concat([kept, part])
        # The first half of the room is for what lies before the worst epoch.
        n_before = int((kept["time_ns"] < at).sum())
        kept = kept.slice(max(0, min(n_before, kept.height) - MOST_ROWS // 2), MOST_ROWS)
    assert kept is not None
    words = f"The charts show {kept.height} of the {counted(track.n_epochs, 'epoch')} of track {track.label}, those around its worst."
    return kept, [words]


def _finite(value: Any) -> Any:
    """Replace by null where a number does not exist: JSON has no NaN."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _worst_first(tracks: list[TrackSummary]) -> list[TrackSummary]:
    """Warnings before cautions before the largest bound over limit; unknown last."""
    return sorted(tracks, key=lambda t: (-t.n_warnings, -t.n_cautions, -(t.worst_ratio if t.worst_ratio is not None else -math.inf)))


def _columns(summary: Summary, epochs: Table) -> list[str]:
    """Numeric columns to embed: those that the list of columns shows, each method's bound, each state's probability."""
    methods = dict.fromkeys(m.id for m in (*summary.accuracy, *summary.integrity))
    return [name for name in lookup.in_report("number", methods, len(summary.states)) if name in epochs.columns]


def _pack_track(track: str, frame: pl.DataFrame, columns: list[str]) -> tuple[dict[str, object], str]:
    # Charts need their axis in order, whatever the order of the table.
    frame = frame.sort("time_ns", maintain_order=True)
    start_ns = int(frame["time_ns"][0])
    elapsed_s = (frame["time_ns"] - start_ns).cast(pl.Float64).to_numpy() * 1e-9
    packed = [packing.pack("elapsed_s", elapsed_s)]
    for name in columns:
        values = frame[name].cast(pl.Float64).fill_null(math.nan).to_numpy()
        if np.isfinite(values).any():
            packed.append(packing.pack(name, values))
    words = {name: packing.run_lengths(frame[name].cast(pl.String)) for name in lookup.in_report("text") if name in frame.columns}
    head: dict[str, object] = {
        "track": track,
        "n": frame.height,
        # As text: nanoseconds since 1980 do not fit a number of the page exactly.
        "start_ns": str(start_ns),
        "breaks": breaks(frame["time_ns"].to_numpy()).tolist(),
        "columns": [p.head() for p in packed],
        "words": words,
    }
    return head, packing.deflate(packed)


def _first_time_ns(summary: Summary, epochs: Table) -> int:
    if epochs.height:
        return int(epochs["time_ns"][0] if isinstance(epochs, pl.DataFrame) else epochs.first("time_ns"))
    return summary.tracks[0].start_ns if summary.tracks else 0


def _region(epochs: Table, waypoints: list[Waypoint]) -> tuple[float, float, float, float]:
    """South, west, north, east of everything drawn with room around it, in degrees; longitudes around the first point."""
    # In place: a column of a large table is there once.
    lat_deg = _places(epochs, "est_lat_rad", [w.lat_rad for w in waypoints])
    if not len(lat_deg):
        return (-90.0, -180.0, 90.0, 180.0)
    np.degrees(lat_deg, out=lat_deg)
    south, north, middle = float(lat_deg.min()), float(lat_deg.max()), float(lat_deg.mean())
    del lat_deg
    lon_deg = _places(epochs, "est_lon_rad", [w.lon_rad for w in waypoints])
    if not len(lon_deg):
        return (-90.0, -180.0, 90.0, 180.0)
    np.degrees(lon_deg, out=lon_deg)
    centre = float(lon_deg[0])
    lon_deg -= centre
    lon_deg += 180.0
    lon_deg %= 360.0
    lon_deg += centre
    lon_deg -= 180.0
    west, east = float(lon_deg.min()), float(lon_deg.max())
    room = max(2.0, 0.6 * max(north - south, east - west))
    # The map is wider than it is high.
    wide = max(room, north - south) / max(0.2, shortening(math.radians(middle)))
    return (south - room, west - wide, north + room, east + wide)


def _ends(epochs: Table, summary: Summary) -> NDArray[np.float64]:
    """Where every track begins and ends: latitude and longitude. [rad]."""
    if not {"est_lat_rad", "est_lon_rad"} <= set(epochs.columns) or len(summary.tracks) > MOST_ENDS:
        return np.empty((0, 2))
    first, last = dict[str, tuple[float, ...]](), dict[str, tuple[float, ...]]()
    for piece in pieces(epochs, ["track", "est_lat_rad", "est_lon_rad"]):
        known = piece.drop_nulls().filter(pl.all_horizontal(pl.selectors.float().is_finite()))
        ends = known.group_by("track", maintain_order=True)
        last |= {track: tuple(place) for track, *place in ends.last().iter_rows()}
        first = {track: tuple(place) for track, *place in ends.first().iter_rows()} | first
    return np.array([*first.values(), *last.values()]).reshape(-1, 2)


MOST_ENDS = 1000
"""Tracks whose airports are looked for. [1]"""


def _places(epochs: Table, name: str, first: list[float]) -> NDArray[np.float64]:
    """One coordinate of everything drawn, in an array of its own. [rad]."""
    if not epochs.height or not {"est_lat_rad", "est_lon_rad"} <= set(epochs.columns):
        return np.array(first, dtype=np.float64)
    if isinstance(epochs, pl.DataFrame):
        return np.concatenate([first, epochs[name].drop_nulls().drop_nans().to_numpy()])
    return np.concatenate([first, epochs.numbers(name)]) if first else epochs.numbers(name)
