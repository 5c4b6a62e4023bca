"""The users of a map: centres of the cells of a grid of latitudes and longitudes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_POINTS = 4_000_000
"""A quarter of a degree of the whole world is a million. [1]"""


@dataclass(frozen=True)
class Grid:
    """Cells between two parallels and two meridians; the last row or column is cut off where the step does not fit.

    Attributes
    ----------
    step_rad : float
        Side of a cell in latitude and longitude. [rad]
    south_rad, north_rad : float
        Parallels. [rad]
    west_rad, east_rad : float
        Meridians; ``east_rad`` up to a turn beyond ``west_rad``, so that a region may lie across the antimeridian. [rad]
    """

    step_rad: float = math.radians(5.0)
    south_rad: float = -math.pi / 2
    north_rad: float = math.pi / 2
    west_rad: float = -math.pi
    east_rad: float = math.pi

    def __post_init__(self) -> None:
        if not 0 < self.step_rad <= math.pi / 2:
            raise InputError("step_rad", self.step_rad, "rad", "(0, pi/2]")
        if not -math.pi / 2 <= self.south_rad < self.north_rad <= math.pi / 2:
            raise InputError(
                "south_rad, north_rad", f"{self.south_rad}, {self.north_rad}", "rad", "south below north, both in [-pi/2, pi/2]"
            )
        # A turn written in degrees may miss 2 pi by a rounding.
        if not (abs(self.west_rad) <= 2 * math.pi and 0 < self.east_rad - self.west_rad <= 2 * math.pi * (1 + 1e-12)):
            raise InputError("west_rad, east_rad", f"{self.west_rad}, {self.east_rad}", "rad", "east up to one turn beyond west")
        if min(self.n_lat, self.n_lon) < 1:
            raise InputError("step_rad", self.step_rad, "rad", "a step no wider than the region, which holds no cell")
        if len(self) > MOST_POINTS:
            raise InputError("step_rad", self.step_rad, "rad", f"a step that gives at most {MOST_POINTS} points, not {len(self)}")

    @classmethod
    def degrees(cls, step_deg: float, region_deg: tuple[float, float, float, float] = (-90.0, 90.0, -180.0, 180.0)) -> Grid:
        """From degrees: the step, and south, north, west, east."""
        south, north, west, east = (math.radians(value) for value in region_deg)
        return cls(math.radians(step_deg), south, north, west, east)

    @property
    def n_lat(self) -> int:
        """Rows. [1]."""
        return _cells(self.north_rad - self.south_rad, self.step_rad)

    @property
    def n_lon(self) -> int:
        """Columns. [1]."""
        return _cells(self.east_rad - self.west_rad, self.step_rad)

    def __len__(self) -> int:
        return self.n_lat * self.n_lon

    @property
    def lat_rad(self) -> NDArray[np.float64]:
        """Latitudes of the rows, from the south. [rad]."""
        rows = np.arange(self.n_lat, dtype=np.float64)
        return np.asarray(self.south_rad + (rows + 0.5) * self.step_rad, dtype=np.float64)

    @property
    def lon_rad(self) -> NDArray[np.float64]:
        """Longitudes of the columns, from the west, in [-pi, pi). [rad]."""
        lon = self.west_rad + (np.arange(self.n_lon) + 0.5) * self.step_rad
        return np.asarray(np.mod(lon + math.pi, 2 * math.pi) - math.pi, dtype=np.float64)

    def points(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Latitude and longitude of every point, row after row. [rad]."""
        lat, lon = np.meshgrid(self.lat_rad, self.lon_rad, indexing="ij")
        return lat.ravel(), lon.ravel()

    def weights(self) -> NDArray[np.float64]:
        """Share of each point in the area, row after row: the cosine of its latitude over the sum of all. [1]."""
        weight = np.repeat(np.cos(self.lat_rad), self.n_lon)
        return np.asarray(weight / weight.sum(), dtype=np.float64)


def _cells(span: float, step: float) -> int:
    # A step that fits but for its rounding is not cut off.
    return math.floor(span / step + 1e-9)
