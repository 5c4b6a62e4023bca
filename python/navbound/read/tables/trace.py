"""The trace of one aircraft as readsb and its web services write it, to columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from navbound.errors import FormatError
from navbound.read.own_positions import OfTrace

if TYPE_CHECKING:
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
        "nac_p": [d.get("nac_p") for d in details],
        "nic": [d.get("nic") for d in details],
        "rc": [d.get("rc") for d in details],
    }


_GEOMETRIC = 8
"""The flag of a row whose altitude is above the ellipsoid and no pressure altitude."""


def _is_geometric(row: list[Any]) -> bool:
    return isinstance(row[6], int) and bool(row[6] & _GEOMETRIC)


def _geometric(row: list[Any]) -> Any:
    stated = row[10] if len(row) > 10 else None
    return row[3] if stated is None and _is_geometric(row) and row[3] != "ground" else stated
