"""Where the aircraft should be: geodesic lines and routes of legs and fly-by turns, on the WGS-84 ellipsoid.

Distances are geodesic (Karney 2013), not those of a flat map: a plane in latitude and longitude is off by some 10 m six miles from a
threshold.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from navbound.procedures import Procedure

__all__ = ["Feet", "Path", "Places", "from_azimuth", "line", "procedure", "route"]

_NO_LEG = np.uint32(0xFFFFFFFF)


@dataclass(frozen=True)
class Feet:
    """The points of a path that positions belong to; all arrays have the shape of the positions.

    Attributes
    ----------
    along_m : ndarray
        Distance along the path from its first point. [m]
    cross_m : ndarray
        Distance of the position from the path, positive right. [m]
    course_rad : ndarray
        Course of the path at the foot, in [0, 2 pi). [rad]
    lat_rad, lon_rad : ndarray
        The foot. [rad]
    leg : ndarray of int
        Index of the leg; -1 for a missing position.
    """

    along_m: NDArray[np.float64]
    cross_m: NDArray[np.float64]
    course_rad: NDArray[np.float64]
    lat_rad: NDArray[np.float64]
    lon_rad: NDArray[np.float64]
    leg: NDArray[np.int64]


@dataclass(frozen=True)
class Places:
    """The path at distances along it; all arrays have the shape of the distances.

    Attributes
    ----------
    lat_rad, lon_rad : ndarray
        Where. [rad]
    course_rad : ndarray
        Course, in [0, 2 pi). [rad]
    curvature_per_m : ndarray
        Curvature, positive in a right turn. [1/m]
    leg : ndarray of int
        Index of the leg.
    """

    lat_rad: NDArray[np.float64]
    lon_rad: NDArray[np.float64]
    course_rad: NDArray[np.float64]
    curvature_per_m: NDArray[np.float64]
    leg: NDArray[np.int64]


class Path:
    """A line or a route; made by :func:`line`, :func:`from_azimuth` or :func:`route`."""

    def __init__(self, core: _core.Path) -> None:
        self._core = core

    @property
    def length_m(self) -> float:
        """Length from the first point to the last [m]; infinite for a line given by a direction."""
        return self._core.length_m

    @property
    def waypoints_along_m(self) -> NDArray[np.float64]:
        """Where the waypoints lie along the path [m]; one that is flown by counts at the middle of its turn."""
        return np.array(self._core.waypoints_along_m)

    @checked
    def project(self, lat_rad: ArrayLike, lon_rad: ArrayLike, *, near_along_m: float | None = None) -> Feet:
        """Feet of positions on the path.

        On a route the positions are taken in the order flown: each foot is sought from the one before it, so that a route which comes
        near itself is followed and not jumped across. A foot more than 10 km away is doubted and the whole route searched.

        Parameters
        ----------
        lat_rad, lon_rad : array_like
            Positions, WGS-84; both NaN for a missing one, whose foot is NaN. [rad]
        near_along_m : float, optional
            Where along a route to seek the first foot; without it the nearest of the whole route is taken. [m]

        Raises
        ------
        InputError
            A position that is not on the Earth, or is more than 5000 km away.
        """
        shape, (lat, lon) = flatten(lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()))
        projected = self._core.project(lat, lon, near_along_m)
        leg = projected.pop("leg")
        legs = np.where(leg == _NO_LEG, -1, leg.astype(np.int64)).reshape(shape)
        return Feet(leg=legs, **{name: values.reshape(shape) for name, values in projected.items()})

    def at(self, along_m: ArrayLike) -> Places:
        """Path at distances along it; beyond its ends the first and the last leg go on.

        Parameters
        ----------
        along_m : array_like
            Distances from the first point. [m]

        Raises
        ------
        InputError
            A distance that is not finite.
        """
        shape, (along,) = flatten(along_m=(along_m, ()))
        points = self._core.at(along)
        leg = points.pop("leg").astype(np.int64).reshape(shape)
        return Places(leg=leg, **{name: values.reshape(shape) for name, values in points.items()})


@checked
def line(lat0_rad: float, lon0_rad: float, lat1_rad: float, lon1_rad: float) -> Path:
    """Infinite geodesic through two points, from the first towards the second.

    Parameters
    ----------
    lat0_rad, lon0_rad, lat1_rad, lon1_rad : float
        The points, WGS-84. [rad]

    Raises
    ------
    InputError
        A point that is not on the Earth, or two points less than 1 mm apart.
    """
    return Path(_core.Path.line(lat0_rad, lon0_rad, lat1_rad, lon1_rad))


@checked
def from_azimuth(lat_rad: float, lon_rad: float, course_rad: float) -> Path:
    """Infinite geodesic from a point in a direction.

    Parameters
    ----------
    lat_rad, lon_rad : float
        The first point, WGS-84. [rad]
    course_rad : float
        Its direction there, clockwise from true north. [rad]

    Raises
    ------
    InputError
        A point that is not on the Earth, or a course that is not finite.
    """
    return Path(_core.Path.from_azimuth(lat_rad, lon_rad, course_rad))


@checked
def route(lat_rad: ArrayLike, lon_rad: ArrayLike, radius_m: ArrayLike = 0.0) -> Path:
    """Geodesic legs between waypoints with a fly-by turn at each waypoint between.

    A turn of radius R through the track change d begins about R tan(abs(d)/2) before its waypoint and is R abs(d) long.

    Parameters
    ----------
    lat_rad, lon_rad : array_like, shape (n,)
        Waypoints, WGS-84. [rad]
    radius_m : array_like, shape (n,) or ()
        Turn radius at each waypoint; 0 is a corner; the first and the last are not used. [m]

    Raises
    ------
    InputError
        Fewer than two waypoints, two in one place, a radius outside [0, 1e6], or turns that overlap on a leg (``index`` says which).
    """
    shape, (lat, lon, radius) = flatten(lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()), radius_m=(radius_m, ()))
    if len(shape) != 1:
        raise InputError("lat_rad", f"shape {shape}", domain="shape (n,)")
    return Path(_core.Path.route(lat, lon, radius))


@checked
def procedure(
    file: str | FilePath,
    airport: str,
    procedure: str,
    transition: str | None = None,
    *,
    missed: bool = False,
    line: str | None = None,
    defaults: bool = False,
) -> Procedure:
    """Legs of a published procedure with their geometry and the RNP of each (ARINC 424-18; standard).

    Geometry comes from the fixes. Every other published number is a check, except where a course defines the leg. A leg without a
    path keeps its place with a state that says why.

    Parameters
    ----------
    file : str or path
        Navigation database of ARINC 424, plain or packed by gzip.
    airport, procedure : str
        As the file names them: ``KDEN``, ``H26-Z``.
    transition : str, optional
        Transition flown; several of a departure or an arrival are joined by ``+``. Without it only the common or final part.
    missed : bool
        Whether the missed approach belongs to the path.
    line : str, optional
        Line of minima that is flown, such as ``RNP 0.3``: the RNP of the final approach. Without it the coded one counts, and a final
        approach whose coded RNP is no published line has none.
    defaults : bool
        Whether a leg without a coded RNP takes the default of its specification (1.0 NM, final approach 0.3 NM; standard). Without it
        such a leg has no RNP.

    Returns
    -------
    Procedure
        Legs in the order flown; :meth:`~navbound.procedures.Procedure.nearest` and :meth:`~navbound.procedures.Procedure.follow` give
        along and cross track distances. [m]

    Raises
    ------
    FormatError
        A file that is not of this kind, or a refused line in a route that is needed, with its number.
    InputError
        An airport, procedure, transition or line of minima that the file does not have; what it has is named.
    """
    from navbound import procedures  # noqa: PLC0415

    return procedures.read(file).procedure(airport, procedure, transition, missed=missed, line=line, defaults=defaults)
