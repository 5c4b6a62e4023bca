"""DME/DME and VOR/DME: how good a range is, what two of them determine, which pair is best, positions, selection along a flight, coverage.

Constants are values of standards whose texts were not read (inferred).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound.dme.radionav import (
    SWITCHING,
    VOR_SIGMA_RAD,
    Coverage,
    Positions,
    Selection,
    Sights,
    coverage,
    select,
    sights,
    solve,
    solve_vor,
)
from navbound.dme.station_table import SERVICE_NM, Stations, read_stations, stations
from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "SERVICE_NM",
    "SWITCHING",
    "VOR_SIGMA_RAD",
    "Coverage",
    "Pair",
    "Positions",
    "Selection",
    "Sights",
    "Stations",
    "VorDme",
    "best_pair",
    "coverage",
    "icao_two_sigma",
    "pair",
    "pairs",
    "range_sigma",
    "read_stations",
    "select",
    "sights",
    "solve",
    "solve_vor",
    "stations",
    "vor_dme",
]


@checked
def range_sigma(slant_m: ArrayLike) -> NDArray[np.float64]:
    """Give the standard deviation of a DME range: the larger of 0.085 NM and 0.125 % in the air, with 0.05 NM of the signal.

    Parameters
    ----------
    slant_m : array_like, shape (...)
        Slant range. [m]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        A range that is negative or not finite.
    """
    shape, (slant,) = flatten(slant_m=(slant_m, ()))
    return unflatten(_core.dme_range_sigma(slant), shape)


@checked
def icao_two_sigma(slant_1_m: ArrayLike, slant_2_m: ArrayLike, inclusion_rad: ArrayLike) -> NDArray[np.float64]:
    """``2 sqrt(sigma_1² + sigma_2²) / sin(inclusion)``, the figure printed for a pair.

    It is two drms of level ranges, covering between 95.4 % and 98.2 %, not a cross-track 95 % value; for the total system error
    use the covariance of `pairs`.

    Parameters
    ----------
    slant_1_m, slant_2_m : array_like, shape (...)
        Slant ranges. [m]
    inclusion_rad : array_like, shape (...)
        Angle at the aircraft between the horizontal directions to the stations. [rad]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        A range outside its domain, or stations in one line with the aircraft.
    """
    shape, flat = flatten(slant_1_m=(slant_1_m, ()), slant_2_m=(slant_2_m, ()), inclusion_rad=(inclusion_rad, ()))
    return unflatten(_core.dme_icao_two_sigma(*flat), shape)


@dataclass(frozen=True)
class Pair:
    """What two stations determine.

    Attributes
    ----------
    stations : tuple of str
        Their identifiers, in lexicographic order.
    inclusion_rad : float
        Angle at the aircraft between the horizontal directions to both. [rad]
    slant_m, sigma_m, elevation_rad : tuple of float
        Slant ranges, their standard deviations, and elevations of the aircraft seen from the stations. [m, m, rad]
    covariance_en_m2 : ndarray, shape (2, 2), or None
        Covariance of the position; None when stations and aircraft lie in one line. [m²]
    drms_m, icao_two_sigma_m, lateral_sigma_m : float or None
        Root of its trace; the printed figure; the deviation across the course, where one was given. [m]
    admissible : bool
        30 to 150 degrees, 3 to 160 NM, at most 40 degrees of elevation.
    """

    stations: tuple[str, str]
    inclusion_rad: float
    slant_m: tuple[float, float]
    sigma_m: tuple[float, float]
    elevation_rad: tuple[float, float]
    covariance_en_m2: NDArray[np.float64] | None
    drms_m: float | None
    icao_two_sigma_m: float | None
    lateral_sigma_m: float | None
    admissible: bool


@checked
def pairs(
    aircraft_enu_m: ArrayLike,
    stations_enu_m: Mapping[str, ArrayLike],
    *,
    sigma_altitude_m: float = 0.0,
    course_rad: float | None = None,
) -> list[Pair]:
    """Every pair of stations, seen from the aircraft, in lexicographic order.

    Parameters
    ----------
    aircraft_enu_m : array_like, shape (3,)
        East, north, up in a flat frame shared with the stations. [m]
    stations_enu_m : mapping of identifier to array_like, shape (3,)
        [m]
    sigma_altitude_m : float
        Standard deviation of the altitude used for the slant correction; both ranges share its error. [m]
    course_rad : float, optional
        Course of the active leg, for `lateral_sigma_m`. [rad]

    Raises
    ------
    InputError
        Coordinates that are not finite, or a station straight below the aircraft.
    """
    names = sorted(stations_enu_m)
    aircraft = _one_place("aircraft_enu_m", aircraft_enu_m)
    places = [_one_place(f"stations_enu_m[{name}]", stations_enu_m[name]) for name in names]
    pairs = []
    for row in _core.dme_pairs(aircraft, places, sigma_altitude_m, course_rad):
        first, second = row.pop("stations")
        covariance = row.pop("covariance_en_m2")
        for key in ("slant_m", "sigma_m", "elevation_rad"):
            row[key] = tuple(row[key])
        matrix = None if covariance is None else np.asarray(covariance, dtype=np.float64)
        pairs.append(Pair(stations=(names[first], names[second]), covariance_en_m2=matrix, **row))
    return pairs


@checked
def pair(
    aircraft_enu_m: ArrayLike,
    first_enu_m: ArrayLike,
    second_enu_m: ArrayLike,
    *,
    sigma_altitude_m: float = 0.0,
    course_rad: float | None = None,
) -> Pair:
    """Two stations seen from the aircraft; arguments and refusals are those of `pairs`, and the stations are called 1 and 2."""
    both = {"1": first_enu_m, "2": second_enu_m}
    return pairs(aircraft_enu_m, both, sigma_altitude_m=sigma_altitude_m, course_rad=course_rad)[0]


@checked
def best_pair(
    aircraft_enu_m: ArrayLike,
    stations_enu_m: Mapping[str, ArrayLike],
    *,
    sigma_altitude_m: float = 0.0,
    course_rad: float | None = None,
) -> Pair | None:
    """Choose the admissible pair with the smallest drms, or with the smallest lateral deviation where a course is given.

    Ties go to the lexicographically first. None when no pair is admissible: the least bad pair is not an answer.
    Arguments and refusals are those of `pairs`.
    """
    admissible = [
        p for p in pairs(aircraft_enu_m, stations_enu_m, sigma_altitude_m=sigma_altitude_m, course_rad=course_rad) if p.admissible
    ]
    # An admissible pair has both; min keeps the first of equals, and pairs come in lexicographic order.
    figures = [p.drms_m if course_rad is None else p.lateral_sigma_m for p in admissible]
    ranked = [(figure, place) for place, figure in enumerate(figures) if figure is not None]
    return admissible[min(ranked)[1]] if ranked else None


class VorDme(NamedTuple):
    """Standard deviations of a VOR/DME position, NaN where `available` is not.

    ``radial_m`` along and ``cross_m`` across the radial, ``drms_m`` the root of the sum of their squares. [m]
    """

    radial_m: NDArray[np.float64]
    cross_m: NDArray[np.float64]
    drms_m: NDArray[np.float64]
    available: NDArray[np.bool_]


def _one_place(name: str, place: ArrayLike) -> list[float]:
    _, (places,) = flatten(**{name: (place, (3,))})
    if len(places) != 1:
        raise InputError(name, f"shape {np.shape(place)}", domain="shape (3,)")
    return [float(x) for x in places[0]]


@checked
def vor_dme(ground_m: ArrayLike, slant_m: ArrayLike, sigma_vor_rad: ArrayLike, sigma_dme_m: ArrayLike) -> VorDme:
    """Give the standard deviations of a VOR/DME position: ``sigma_dme slant/ground`` along and ``ground sigma_vor`` across the radial.

    Parameters
    ----------
    ground_m, slant_m : array_like, shape (...)
        Distances from the station over the ground and straight. [m]
    sigma_vor_rad : array_like, shape (...)
        Standard deviation of the bearing; 2.27 degrees is half the usual 95 % budget. [rad]
    sigma_dme_m : array_like, shape (...)
        Standard deviation of the range. [m]

    Returns
    -------
    VorDme
        Not available overhead, below 3 NM over the ground or above 40 degrees.

    Raises
    ------
    InputError
        A ground distance that is not positive or exceeds the slant, or a deviation that is negative.
    """
    shape, flat = flatten(ground_m=(ground_m, ()), slant_m=(slant_m, ()), sigma_vor_rad=(sigma_vor_rad, ()), sigma_dme_m=(sigma_dme_m, ()))
    radial, cross, drms = (unflatten(part, shape) for part in _core.vor_dme(*flat))
    return VorDme(radial, cross, drms, ~np.isnan(drms))
