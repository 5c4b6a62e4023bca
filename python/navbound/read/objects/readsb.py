"""Files of readsb, dump1090 and their web services: the trace of one aircraft to columns, the states of all at one time to records."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from navbound.errors import FormatError
from navbound.read.own_positions import CLAIMS, OfTrace, is_of_others

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.read.source import Source


def columns_of(source: Source, data: dict[str, Any]) -> dict[str, list[Any]]:
    """Take a trace apart.

    Rows are ``[seconds, lat, lon, pressure altitude ft or "ground", kt, deg, flags, ft/min, details, source, geometric altitude ft, ...]``;
    with the flag 8 the first altitude is geometric, too;
    quality indicators stand in the details, when they were received.

    Raises
    ------
    FormatError
        Rows or a start time that are those of no trace.
    """
    trace = data["trace"]
    if not all(isinstance(row, list) and len(row) >= 9 for row in trace) or not isinstance(data.get("timestamp"), (int, float)):
        raise FormatError(source.path, "not a readsb trace: a start time and rows of at least nine items are needed", field="trace")
    stated = [row[8] if isinstance(row[8], dict) else None for row in trace]
    details = [each or {} for each in stated]
    sources = OfTrace()
    start = data["timestamp"]
    seconds = [row[0] for row in trace]
    if not all(isinstance(s, (int, float)) for s in seconds):
        raise FormatError(source.path, "not a readsb trace: rows begin with seconds", field="trace")
    names = {"lat": 1, "lon": 2, "groundspeed": 4, "track": 5, "vertical_rate": 7}
    columns = {name: [row[i] for row in trace] for name, i in names.items()}
    return columns | {
        "unix_time_s": [start + s for s in seconds],
        "altitude": [None if row[3] == "ground" or _is_geometric(row) else row[3] for row in trace],
        "geoaltitude": [_geometric(row) for row in trace],
        "icao24": [str(data.get("icao", source.stem))] * len(trace),
        "callsign": [d.get("flight") for d in details],
        "position_source": [sources.of(row[9] if len(row) > 9 else None, each) for row, each in zip(trace, stated, strict=True)],
        "nav_qnh": [d.get("nav_qnh") for d in details],
        **{claim: [None if is_of_others(claim, d) else d.get(claim) for d in details] for claim in CLAIMS},
    }


_GEOMETRIC = 8
"""The flag of a row whose altitude is above the ellipsoid and no pressure altitude."""


def _is_geometric(row: list[Any]) -> bool:
    return isinstance(row[6], int) and bool(row[6] & _GEOMETRIC)


def _geometric(row: list[Any]) -> Any:
    stated = row[10] if len(row) > 10 else None
    return row[3] if stated is None and _is_geometric(row) and row[3] != "ground" else stated


_LISTS = ("aircraft", "ac")
"""Names of the list: `aircraft` in the files of the decoders, `ac` from web services of readsb. Provenance: inferred."""
_NOW, _NOW_MS, _LEAST_MS = "now", "timestamp_ms", 1e11
"""The time in seconds, the name of the column of one in milliseconds, and the least number that is one: seconds are of the year 5138."""


_USUAL_TYPE = "adsb_icao"
"""The source of a position that an aircraft with an address of its own sends."""


def is_snapshot(value: Any) -> bool:
    """Whether an object is one: a number that is the time, and the list."""
    if not isinstance(value, dict) or isinstance(value.get(_NOW), bool) or not isinstance(value.get(_NOW), (int, float)):
        return False
    return any(isinstance(value.get(name), list) for name in _LISTS)


def records_of(path: Path, snapshots: list[Any]) -> list[dict[str, Any]]:
    """An aircraft a record, with the time of its snapshot.

    Raises
    ------
    FormatError
        What is no snapshot among them, an aircraft that is no object or states a time of its own, or no aircraft at all.
    """
    records = list[dict[str, Any]]()
    for number, snapshot in enumerate(snapshots, 1):
        if not is_snapshot(snapshot):
            raise FormatError(path, f"the object {number} is no list of aircraft with a time, as the first is", field=_LISTS[0])
        name = next(name for name in _LISTS if isinstance(snapshot.get(name), list))
        time = _NOW if snapshot[_NOW] < _LEAST_MS else _NOW_MS
        for aircraft in snapshot[name]:
            if not isinstance(aircraft, dict) or _NOW in aircraft:
                raise FormatError(path, f"an aircraft of “{name}” in the object {number} is no object without “{_NOW}”", field=name)
            records.append({time: snapshot[_NOW]} | aircraft)
    if not records:
        raise FormatError(path, "a list of no aircraft", field=_LISTS[0])
    if (types := {each["type"] for each in records if isinstance(each.get("type"), str)}) and _USUAL_TYPE not in types:
        # dump1090 writes how a position came only where it is not the usual way; readsb writes it always.
        records = [{"type": _USUAL_TYPE} | each for each in records]
    return records
