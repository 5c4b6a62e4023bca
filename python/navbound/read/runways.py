"""Runways: where an approach should lead. The table ships with navbound (OurAirports, public domain)."""

from __future__ import annotations

import difflib
import functools
import importlib.resources
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import path
from navbound.errors import InputError, NotFoundError
from navbound.units import METRES_PER_FT

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True)
class Runway:
    """A runway in its landing direction.

    Attributes
    ----------
    name : str
        ``LFPG/08R``.
    lat_rad, lon_rad : float
        The landing threshold: the runway's end, moved along the runway by the displacement. [rad]
    far_lat_rad, far_lon_rad : float
        The other end. [rad]
    elevation_m : float
        Of this end; 0 where the table has none. [m]
    displaced_m : float
        How far the threshold lies inside the end. [m]
    length_m : float
        As the table states it; 0 where it does not. [m]
    centreline : Path
        The geodesic from the threshold through the other end; distances before the threshold are negative.
    """

    name: str
    lat_rad: float
    lon_rad: float
    far_lat_rad: float
    far_lon_rad: float
    elevation_m: float
    displaced_m: float
    length_m: float
    centreline: path.Path

    @property
    def doubt(self) -> str | None:
        """What speaks against the coordinates: ends that lie further from each other, or nearer, than the runway is long."""
        apart = self.centreline.length_m + self.displaced_m
        if self.length_m == 0 or abs(apart - self.length_m) <= max(200.0, 0.1 * self.length_m):
            return None
        return f"Runway {self.name}: its ends lie {apart:.0f} m apart, but it is {self.length_m:.0f} m long; its centreline is doubtful."

    @property
    def course_rad(self) -> float:
        """Course of the centreline at the threshold, clockwise from true north [rad]."""
        return float(self.centreline.at(0.0).course_rad)


@functools.cache
def table() -> pl.DataFrame:
    """Every runway end, with the end opposite (``far_``): position before the displacement of the threshold, elevation, displacement."""
    packed = importlib.resources.files("navbound").joinpath("data/runways.csv.gz").read_bytes()
    both = pl.read_csv(io.BytesIO(packed), comment_prefix="#", infer_schema_length=None)

    def end(this: str, far: str) -> pl.DataFrame:
        rad = np.pi / 180.0
        return both.select(
            "airport",
            end=this,
            lat_rad=pl.col(f"{this}_lat_deg") * rad,
            lon_rad=pl.col(f"{this}_lon_deg") * rad,
            far_lat_rad=pl.col(f"{far}_lat_deg") * rad,
            far_lon_rad=pl.col(f"{far}_lon_deg") * rad,
            elevation_m=pl.col(f"{this}_elevation_ft").fill_null(0) * METRES_PER_FT,
            displaced_m=pl.col(f"{this}_displaced_ft").fill_null(0) * METRES_PER_FT,
            length_m=pl.col("length_ft").fill_null(0) * METRES_PER_FT,
        )

    return pl.concat([end("low", "high"), end("high", "low")])


def runway(name: str, argument: str = "path") -> Runway:
    """Look a runway up by airport and designator, ``LFPG/08R``, that an argument names.

    Raises
    ------
    InputError
        No such airport or runway; the message lists what there is.
    """
    airport, separator, designator = name.upper().partition("/")
    if not separator or not airport or not designator:
        raise InputError(argument, name, domain="airport/runway such as LFPG/08R, auto, or a route in a .toml or .csv file")
    ends = table().filter(pl.col("airport") == airport)
    if ends.is_empty():
        near = difflib.get_close_matches(airport, table()["airport"].unique().to_list(), 3, 0.6)
        raise NotFoundError(argument, name, "airport", more=f"nearest: {', '.join(near) or 'none'}")
    matching = ends.filter(pl.col("end") == designator)
    if matching.is_empty():
        raise NotFoundError(argument, name, f"runway of {airport}", sorted(ends["end"].to_list()))
    return _runway(matching.row(0, named=True))


def _runway(row: dict[str, object]) -> Runway:
    numbers = {k: float(str(v)) for k, v in row.items() if k not in {"airport", "end"}}
    lat, lon, far_lat, far_lon = (numbers[k] for k in ("lat_rad", "lon_rad", "far_lat_rad", "far_lon_rad"))
    displaced = numbers["displaced_m"]
    if displaced > 0:
        inside = path.line(lat, lon, far_lat, far_lon).at(displaced)
        lat, lon = float(inside.lat_rad), float(inside.lon_rad)
    return Runway(
        name=f"{row['airport']}/{row['end']}",
        lat_rad=lat,
        lon_rad=lon,
        far_lat_rad=far_lat,
        far_lon_rad=far_lon,
        elevation_m=numbers["elevation_m"],
        displaced_m=displaced,
        length_m=numbers["length_m"],
        centreline=path.line(lat, lon, far_lat, far_lon),
    )


_CELL_M = 15_000.0


def near(lat_rad: np.ndarray[tuple[int], np.dtype[np.float64]], lon_rad: np.ndarray[tuple[int], np.dtype[np.float64]]) -> list[Runway]:
    """Runways with their end within about 15 km of one of many positions (some further ones come along)."""
    return near_cells([cells(lat_rad, lon_rad)])


def near_cells(parts: Sequence[pl.DataFrame]) -> list[Runway]:
    """The same of positions in pieces, each as its :func:`cells`."""
    ends = table()
    around = pl.concat(parts).unique()
    steps = pl.DataFrame({"step": [-1, 0, 1]})
    for axis in "xyz":
        around = around.join(steps, how="cross").with_columns(pl.col(axis) + pl.col("step")).drop("step").unique()
    here = ends.hstack(_cells(ends["lat_rad"].to_numpy(), ends["lon_rad"].to_numpy()))
    near_here = here.join(around, on=["x", "y", "z"], how="semi").sort("airport", "end")
    return [_runway(row) for row in near_here.drop("x", "y", "z").iter_rows(named=True)]


def cells(lat_rad: np.ndarray[tuple[int], np.dtype[np.float64]], lon_rad: np.ndarray[tuple[int], np.dtype[np.float64]]) -> pl.DataFrame:
    """Cubes that positions fall into, each once: neither poles nor the date line trouble them, and a sphere is near enough for a search."""
    return _cells(lat_rad, lon_rad).unique()


def _cells(lat_rad: np.ndarray[tuple[int], np.dtype[np.float64]], lon_rad: np.ndarray[tuple[int], np.dtype[np.float64]]) -> pl.DataFrame:
    r = 6.371e6 / _CELL_M
    x, y, z = r * np.cos(lat_rad) * np.cos(lon_rad), r * np.cos(lat_rad) * np.sin(lon_rad), r * np.sin(lat_rad)
    return pl.DataFrame({k: np.floor(v).astype(np.int64) for k, v in (("x", x), ("y", y), ("z", z))})
