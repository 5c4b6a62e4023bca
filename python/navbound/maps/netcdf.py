"""A map as a NetCDF classic file (CDF-2): latitude and longitude in degrees as every viewer of maps expects, one variable a column.

Source: NetCDF Classic and 64-bit Offset File Formats (standard): big-endian, lists of dimensions, attributes and variables, then the data.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import NDArray

    from navbound.records.maps import MapSummary

_DIMENSION, _VARIABLE, _ATTRIBUTE = 10, 11, 12
_CHAR, _DOUBLE = 2, 6


def of_map(summary: MapSummary, points: pl.DataFrame) -> bytes:
    """The points of a map: coordinates ``lat`` and ``lon``, and every column with its unit and title."""
    g = summary.grid
    titles = {column.name: (column.title, column.unit) for column in summary.columns}
    titles |= {outcome.name: (f"{outcome.title}, share of the time", "1") for outcome in summary.outcomes}
    lat = np.degrees(points["lat_rad"].to_numpy().reshape(g.n_lat, g.n_lon)[:, 0])
    lon = np.degrees(points["lon_rad"].to_numpy()[: g.n_lon])
    # A region across the antimeridian keeps its order: longitudes go on beyond 180.
    lon = np.rad2deg(np.unwrap(np.deg2rad(lon)))
    variables: list[tuple[str, list[int], dict[str, str], NDArray[np.float64]]] = [
        ("lat", [0], {"units": "degrees_north", "standard_name": "latitude"}, lat),
        ("lon", [1], {"units": "degrees_east", "standard_name": "longitude"}, lon),
    ]
    for name in points.columns[2:]:
        stem = next((c for c in titles if name.startswith(c.removesuffix("_m"))), None)
        title, unit = titles[stem] if stem else (name, "1")
        grid = points[name].cast(float).to_numpy().reshape(g.n_lat, g.n_lon)
        variables.append((name, [0, 1], {"units": unit, "long_name": title}, grid))
    heads = {"Conventions": "CF-1.8", "title": summary.title, "comment": summary.words, "source": f"navbound: {summary.source}"}
    return classic([("lat", g.n_lat), ("lon", g.n_lon)], heads, variables)


def classic(
    dimensions: list[tuple[str, int]],
    attributes: dict[str, str],
    variables: list[tuple[str, list[int], dict[str, str], NDArray[np.float64]]],
) -> bytes:
    """A file of doubles: dimensions by name and length; variables with the places of their dimensions, attributes and values."""
    data = [np.ascontiguousarray(values, dtype=">f8").tobytes() for *_, values in variables]
    dims = struct.pack(">ii", _DIMENSION, len(dimensions)) + b"".join(_name(name) + struct.pack(">i", n) for name, n in dimensions)
    prologue = b"CDF\x02" + struct.pack(">i", 0) + dims + _attributes(attributes) + struct.pack(">ii", _VARIABLE, len(variables))
    heads = [_head(name, places, words, len(block)) for (name, places, words, _), block in zip(variables, data, strict=True)]
    # Each head is followed by the eight bytes of its offset.
    begin = len(prologue) + sum(len(head) + 8 for head in heads)
    parts = [prologue]
    for head, block in zip(heads, data, strict=True):
        parts.append(head + struct.pack(">q", begin))
        begin += len(block)
    return b"".join([*parts, *data])


def _head(name: str, places: list[int], attributes: dict[str, str], size: int) -> bytes:
    dims = struct.pack(f">i{len(places)}i", len(places), *places)
    return _name(name) + dims + _attributes(attributes) + struct.pack(">ii", _DOUBLE, size)


def _name(text: str) -> bytes:
    raw = text.encode("utf-8")
    return struct.pack(">i", len(raw)) + raw + bytes(-len(raw) % 4)


def _attributes(attributes: dict[str, str]) -> bytes:
    listed = (_name(name) + struct.pack(">i", _CHAR) + _name(text) for name, text in attributes.items())
    return struct.pack(">ii", _ATTRIBUTE, len(attributes)) + b"".join(listed)
