"""A route from a file: waypoints in TOML or CSV."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import path
from navbound.errors import FormatError, InputError
from navbound.read.source import load
from navbound.read.tables.load import table
from navbound.records.run import Waypoint

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.records.run import InputFile


@dataclass(frozen=True)
class Route:
    """Waypoints, and the path through them."""

    name: str
    waypoints: list[Waypoint]
    path: path.Path
    source: InputFile


def load_route(file: str | Path) -> Route:
    """Read a route.

    A TOML file holds ``[[waypoint]]`` tables with ``name``, ``lat_deg``, ``lon_deg`` and, for a fly-by turn, ``radius_m``; a CSV file has
    columns of these names.

    Raises
    ------
    FormatError
        Not such a file, or a value outside its domain, named.
    """
    source = load(file)
    rows = _toml(source.path, source.text()) if source.path.suffix == ".toml" else table(source).frame.to_dicts()
    values = {key: np.array([_number(source.path, i, row, key) for i, row in enumerate(rows)]) for key in _DOMAIN}
    names = [str(row.get("name") or f"WP{i + 1}") for i, row in enumerate(rows)]
    lat, lon = np.radians(values["lat_deg"]), np.radians(values["lon_deg"])
    try:
        line = path.route(lat, lon, values["radius_m"])
    except InputError as e:
        raise FormatError(source.path, f"no route: {e}") from e
    waypoints = [Waypoint(name=n, lat_rad=a, lon_rad=o, kind="waypoint") for n, a, o in zip(names, lat.tolist(), lon.tolist(), strict=True)]
    return Route(source.stem, waypoints, line, source.record(len(rows)))


_DOMAIN = {"lat_deg": (-90.0, 90.0), "lon_deg": (-360.0, 360.0), "radius_m": (0.0, 1e6)}


def _toml(file: Path, text: str) -> list[dict[str, Any]]:
    try:
        rows = tomllib.loads(text).get("waypoint")
    except tomllib.TOMLDecodeError as e:
        raise FormatError(file, f"not TOML: {e}") from e
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise FormatError(file, "a route needs [[waypoint]] tables with name, lat_deg and lon_deg")
    return rows


def _number(file: Path, index: int, row: dict[str, Any], key: str) -> float:
    low, high = _DOMAIN[key]
    text = row.get(key)
    if text is None and key == "radius_m":
        return 0.0
    try:
        value = float(str(text))
    except ValueError:
        value = float("nan")
    if not low <= value <= high:
        raise FormatError(file, f"waypoint {index + 1}: found “{text}”, allowed [{low:g}, {high:g}]", field=key)
    return value


def follow(epochs: pl.DataFrame, route: Route) -> tuple[pl.DataFrame, int]:
    """Project every track on the route; epochs before its first or beyond its last waypoint are left out.

    Returns
    -------
    epochs : DataFrame
        With path, course, distance along and flight technical error.
    n_beyond : int
        Epochs left out.
    """
    parts = list[pl.DataFrame]()
    for group in epochs.partition_by("track", maintain_order=True):
        feet = route.path.project(group["est_lat_rad"].to_numpy(), group["est_lon_rad"].to_numpy())
        names = pl.Series([f"{a.name}-{b.name}" for a, b in zip(route.waypoints, route.waypoints[1:], strict=False)])
        parts.append(
            group.with_columns(
                pl.Series("path_lat_rad", feet.lat_rad),
                pl.Series("path_lon_rad", feet.lon_rad),
                pl.Series("course_rad", feet.course_rad),
                pl.Series("along_m", feet.along_m),
                pl.Series("fte_m", feet.cross_m),
                names.gather(feet.leg).alias("leg"),
                pl.lit("route").alias("phase"),
            )
        )
    followed = pl.concat(parts)
    within = followed.filter(pl.col("along_m").is_between(0.0, route.path.length_m))
    return within, followed.height - within.height
