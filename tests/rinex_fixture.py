"""Observation files for tests: columns of a file that was read, changed, written plainly as RINEX 3."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import gnss

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

GPS_EPOCH = np.datetime64("1980-01-06T00:00:00", "ns")


def write(
    observations: gnss.Observations,
    path: Path,
    codes: Mapping[str, Sequence[str]],
    *,
    until_s: float = 86400.0,
    change: Callable[[pl.DataFrame, str], pl.DataFrame] | None = None,
) -> gnss.Observations:
    """The codes of some constellations until some seconds after the first epoch; ``change`` gets each column and its code."""
    head = [f"{'     3.05           OBSERVATION DATA    M':<60}RINEX VERSION / TYPE"]
    for system, names in codes.items():
        for first in range(0, len(names), 13):
            lead = f"{system}  {len(names):3d}" if first == 0 else " " * 6
            head.append(f"{lead + ''.join(f' {c}' for c in names[first : first + 13]):<60}SYS / # / OBS TYPES")
    start = GPS_EPOCH + np.timedelta64(int(observations.time_ns[0]), "ns")
    head.append(f"{_calendar(start, '  ', 6) + '     GPS':<60}TIME OF FIRST OBS")
    head.append(f"{'':<60}END OF HEADER")
    last_ns = int(observations.time_ns[0] + until_s * 1e9)
    cells: dict[int, dict[str, list[str]]] = {int(t): {} for t in observations.time_ns if t < last_ns}
    for system, names in codes.items():
        for place, code in enumerate(names):
            column = observations.column(system, code).filter(pl.col("time_ns") < last_ns)
            if change is not None:
                column = change(column, code)
            for time_ns, sv, value, lost, strength in column.iter_rows():
                row = cells[time_ns].setdefault(sv, [" " * 16] * len(names))
                row[place] = f"{value:14.3f}{lost or ' '}{strength or ' '}"
    body = []
    for time_ns, rows in cells.items():
        body.append(f">{_calendar(GPS_EPOCH + np.timedelta64(time_ns, 'ns'), ' ', 2)}  0{len(rows):3d}")
        body.extend(sv + "".join(row) for sv, row in sorted(rows.items()))
    path.write_text("\n".join([*head, *body, ""]), encoding="utf-8")
    return gnss.read_observations(path)


def _calendar(instant: np.datetime64, lead: str, width: int) -> str:
    date, clock = str(instant.astype("datetime64[ns]")).split("T")
    year, month, day = (int(part) for part in date.split("-"))
    hour, minute, second = clock.split(":")
    if width == 6:
        return f"{year:6d}{month:6d}{day:6d}{int(hour):6d}{int(minute):6d}{float(second):13.7f}"
    return f"{lead}{year:4d} {month:02d} {day:02d} {int(hour):02d} {int(minute):02d}{float(second):11.7f}"
