"""DME/DME and VOR/DME over many epochs; public in `navbound.dme`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from navbound import _core
from navbound.dme.station_table import Stations
from navbound.errors import ConflictError, InputError
from navbound.status import sentences, statuses
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

VOR_SIGMA_RAD = math.radians(math.sqrt(3.5**2 + 1.0**2 + 2.7**2) / 2)
"""Standard deviation of a VOR bearing: half of 3.5, 1.0 and 2.7 degrees (ground, air, pilotage; 95 %) together.
Inferred: the text was not read. [rad]"""

SWITCHING = (0.05, 10.0)
"""A pair replaces the one in use when it has been better by this share for this time. Ours. [1, s]"""


class Positions(NamedTuple):
    """DME positions; numbers are NaN where ``status`` is ``not_available``.

    ``lat_rad``, ``lon_rad`` at the altitude given [rad], ``covariance_enu_m2`` of the navigation error, shape (..., 3, 3) [m²], its
    horizontal ``drms_m`` [m], ``n_ranges`` used, ``p_residual`` the risk of residuals as large if the errors are as the weights say (NaN
    without redundancy), ``status`` ``ok``, ``degraded`` (the residuals contradict the weights) or ``not_available``, ``reason`` for
    people, ``reason_id`` of ``navbound.status.REASONS`` (empty for none), and ``excluded``, the station whose range is left out by its
    place in the table (-1: none); the position is then that of the others.
    """

    lat_rad: Floats
    lon_rad: Floats
    covariance_enu_m2: Floats
    drms_m: Floats
    n_ranges: NDArray[np.int64]
    p_residual: Floats
    status: NDArray[np.str_]
    reason: NDArray[np.str_]
    excluded: NDArray[np.int64]
    reason_id: NDArray[np.str_]


@checked
def solve(
    slant_m: ArrayLike,
    stations: Stations | Mapping[str, ArrayLike],
    h_m: ArrayLike,
    *,
    sigma_altitude_m: float,
    sigma_m: ArrayLike | None = None,
    prior_lat_rad: ArrayLike | None = None,
    prior_lon_rad: ArrayLike | None = None,
    prior_within_m: float = 20_000.0,
    residual_risk: float = 1e-3,
) -> Positions:
    """Positions from slant ranges at a known altitude: all ranges, weighted, by Gauss-Newton over the Earth.

    Two ranges have two solutions, one on either side of the line of the stations: the prior chooses, and without one there is no position.
    From three ranges on the residuals choose as well, and are tested. From four on one that contradicts the others is left out, where
    what is left passes the test and leaving out any other is a thousand times less likely; else the position is ``degraded``.

    Parameters
    ----------
    slant_m : array_like, shape (..., m)
        Slant ranges of the m stations, NaN where none was received. [m]
    stations : Stations, or mapping of identifier to (lat_rad, lon_rad, h_m)
        In the order of the ranges; a mapping in lexicographic order.
    h_m : array_like, shape (...)
        Height of the aircraft above the ellipsoid. [m]
    sigma_altitude_m : float
        Standard deviation of that; all ranges share its error. [m]
    sigma_m : array_like, shape (..., m), optional
        Standard deviations of the ranges; without them `range_sigma`. [m]
    prior_lat_rad, prior_lon_rad : array_like, shape (...), optional
        About where the aircraft is, NaN where not known; it adds nothing to the solution. [rad]
    prior_within_m : float
        The aircraft is certainly not farther from the prior than this. [m]
    residual_risk : float
        Residuals that are less likely than this contradict the deviations. [1]

    Returns
    -------
    Positions
        ``C = (H' R^-1 H)^-1``, ``R = diag(sigma²) + sigma_altitude² w w'`` with the up components w of the lines of sight.

    Raises
    ------
    InputError
        Shapes that do not fit, a range, height or deviation outside its domain, one prior coordinate without the other.
    """
    network = _network(stations)
    m = len(network)
    if m == 0:
        raise InputError("stations", 0, "1", "at least one station")
    if (prior_lat_rad is None) != (prior_lon_rad is None):
        stated, lacking = ("prior_lat_rad", "prior_lon_rad") if prior_lon_rad is None else ("prior_lon_rad", "prior_lat_rad")
        raise ConflictError(stated, needs=(lacking,))
    arguments: dict[str, tuple[ArrayLike, tuple[int, ...]]] = {"slant_m": (slant_m, (m,)), "h_m": (h_m, ())}
    if sigma_m is not None:
        arguments["sigma_m"] = (sigma_m, (m,))
    if prior_lat_rad is not None and prior_lon_rad is not None:
        arguments |= {"prior_lat_rad": (prior_lat_rad, ()), "prior_lon_rad": (prior_lon_rad, ())}
    shape, arrays = flatten(**arguments)
    flat = dict(zip(arguments, arrays, strict=True))
    prior = (flat["prior_lat_rad"], flat["prior_lon_rad"]) if "prior_lat_rad" in flat else None
    inputs = (flat["slant_m"], flat.get("sigma_m"), _points(network), flat["h_m"])
    solution = _core.dme_solve(*inputs, sigma_altitude_m, prior, prior_within_m, residual_risk)
    return _positions(solution, shape)


@checked
def solve_vor(
    slant_m: ArrayLike,
    bearing_rad: ArrayLike,
    station_rad_m: ArrayLike,
    h_m: ArrayLike,
    *,
    sigma_altitude_m: float,
    sigma_bearing_rad: float = VOR_SIGMA_RAD,
) -> Positions:
    """Positions from the bearing and the slant range of a VOR/DME at a known altitude.

    Parameters
    ----------
    slant_m : array_like, shape (...)
        Slant range; its deviation is `range_sigma`. [m]
    bearing_rad : array_like, shape (...)
        Bearing of the aircraft from the station, clockwise from true north. [rad]
    station_rad_m : array_like, shape (..., 3)
        ``lat_rad, lon_rad, h_m`` of the station. [rad, rad, m]
    h_m : array_like, shape (...)
        Height of the aircraft above the ellipsoid. [m]
    sigma_altitude_m, sigma_bearing_rad : float
        Standard deviations. [m, rad]

    Returns
    -------
    Positions
        Not available overhead (below 3 NM or above 40 degrees), or where the range does not reach the altitude. The covariance holds the
        bend of the bearing's arc: second moments about the position, exact for a normal error of the bearing.

    Raises
    ------
    InputError
        A number outside its domain.
    """
    shape, (slant, bearing, station, h) = flatten(
        slant_m=(slant_m, ()), bearing_rad=(bearing_rad, ()), station_rad_m=(station_rad_m, (3,)), h_m=(h_m, ())
    )
    lat, lon, height = (np.ascontiguousarray(station[:, k]) for k in range(3))
    solution = _core.dme_solve_vor(slant, bearing, (lat, lon, height), h, sigma_bearing_rad, sigma_altitude_m)
    n = len(h)
    return _positions(solution | {"excluded": np.full(n, -1)}, shape)


class Sights(NamedTuple):
    """Every station from every point; arrays of shape (..., m).

    ``slant_m`` [m], ``elevation_rad`` of the aircraft seen from the station and its ``bearing_rad`` from there, clockwise from true north
    [rad], ``usable`` whether the rules of `select` admit the station.
    """

    slant_m: Floats
    elevation_rad: Floats
    bearing_rad: Floats
    usable: NDArray[np.bool_]


@checked
def sights(lat_rad: ArrayLike, lon_rad: ArrayLike, h_m: ArrayLike, stations: Stations | Mapping[str, ArrayLike]) -> Sights:
    """Slant ranges, elevations and bearings from every station, and which of them may be used.

    Parameters
    ----------
    lat_rad, lon_rad, h_m : array_like, shape (...)
        Where the aircraft is, WGS-84. [rad, rad, m]
    stations : Stations, or mapping of identifier to (lat_rad, lon_rad, h_m)
        The network of m stations.

    Raises
    ------
    InputError
        A point that is not on the Earth.
    """
    network = _network(stations)
    shape, (lat, lon, h) = flatten(lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()), h_m=(h_m, ()))
    geometry = _core.dme_sights((lat, lon, h), _core_network(network)).reshape(*shape, len(network), 4)
    slant, elevation, bearing, usable = (np.ascontiguousarray(geometry[..., k]) for k in range(4))
    return Sights(slant, elevation, bearing, usable == 1.0)


class Selection(NamedTuple):
    """What a flight has at each epoch; stations by their place in the table, -1 for none; covariances (n, 2, 2) east-north, NaN without.

    ``used``, shape (n, 2), is the pair in use with its switching rule, ``best`` the optimal pair of the instant, ``vor`` the best VOR/DME,
    ``n_stations`` how many may be used; ``used_en_m2``, ``best_en_m2``, ``all_en_m2`` (all stations together: three or more, or an
    admissible pair) and ``vor_en_m2`` their covariances. [m²]
    """

    n_stations: NDArray[np.int64]
    used: NDArray[np.int64]
    used_en_m2: Floats
    best: NDArray[np.int64]
    best_en_m2: Floats
    all_en_m2: Floats
    vor: NDArray[np.int64]
    vor_en_m2: Floats


@checked
def select(
    time_ns: ArrayLike,
    lat_rad: ArrayLike,
    lon_rad: ArrayLike,
    h_m: ArrayLike,
    stations: Stations | Mapping[str, ArrayLike],
    *,
    sigma_altitude_m: float,
    course_rad: ArrayLike | None = None,
    sigma_bearing_rad: float = VOR_SIGMA_RAD,
    switching: tuple[float, float] = SWITCHING,
) -> Selection:
    """Pair in use, optimal pair, all in view and VOR/DME along one flight, and how good a position each would give.

    A station may be used from 3 to 160 NM, up to 40 degrees of elevation, within its service volume and above the horizon (four thirds
    Earth, no terrain); a pair from 30 to 150 degrees. A pair is left at once when it may no longer be used; a better one waits.

    Parameters
    ----------
    time_ns : array_like of int, shape (n,)
        GPS time. [ns]
    lat_rad, lon_rad, h_m : array_like, shape (n,)
        Where the aircraft is, WGS-84. [rad, rad, m]
    stations : Stations, or mapping of identifier to (lat_rad, lon_rad, h_m)
        The network; of equals the pair that stands first is chosen.
    sigma_altitude_m : float
        Standard deviation of the altitude. [m]
    course_rad : array_like, shape (n,), optional
        Course of the active leg: the pair is then chosen by its deviation across it, else by drms. [rad]
    sigma_bearing_rad : float
        Standard deviation of a VOR bearing. [rad]
    switching : (float, float)
        Share and time by which a pair must be better. [1, s]

    Raises
    ------
    InputError
        Arrays of different length, or a number outside its domain.
    """
    network = _network(stations)
    shape, (lat, lon, h, course) = flatten(
        lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()), h_m=(h_m, ()), course_rad=(math.nan if course_rad is None else course_rad, ())
    )
    time = np.ascontiguousarray(time_ns)
    if len(shape) != 1 or time.shape != shape or time.dtype.kind != "i":
        raise InputError("time_ns", f"shape {time.shape} of {time.dtype}", domain=f"integers of shape (n,), as lat_rad {shape}")
    if course_rad is not None and not np.isfinite(course).all():
        raise InputError("course_rad", "a value that is not finite", domain="finite courses")
    sigmas = (sigma_bearing_rad, sigma_altitude_m)
    selection = _core.dme_along(
        (lat, lon, h), time.astype(np.int64), course, _core_network(network), sigmas, (float(switching[0]), float(switching[1]))
    )
    return Selection(**selection)


class Coverage(NamedTuple):
    """What a network gives at the points of a map; arrays have their shape, numbers are NaN where there is no position.

    ``n_stations`` that may be used, ``best``, shape (..., 2), the optimal pair by the places of its stations (-1: none), ``nse_best_m``,
    ``nse_all_m`` and ``nse_vor_m`` the radius that holds the horizontal navigation error with the optimal pair, all stations together,
    and the best VOR/DME [m]; ``supports_best``, ``supports_all`` and ``supports_vor`` whether that leaves room for the flight technical
    error; ``nse_limit_m`` what is left for it [m].
    """

    n_stations: NDArray[np.int64]
    best: NDArray[np.int64]
    nse_best_m: Floats
    nse_all_m: Floats
    nse_vor_m: Floats
    supports_best: NDArray[np.bool_]
    supports_all: NDArray[np.bool_]
    supports_vor: NDArray[np.bool_]
    nse_limit_m: float


@checked
def coverage(
    lat_rad: ArrayLike,
    lon_rad: ArrayLike,
    h_m: ArrayLike,
    stations: Stations | Mapping[str, ArrayLike],
    *,
    rnp_m: float,
    fte_m: float,
    sigma_altitude_m: float,
    sigma_bearing_rad: float = VOR_SIGMA_RAD,
    risk: float = 0.05,
) -> Coverage:
    """Where a network supports a navigation specification at a height. Each point stands for itself, so a map may be cut into tiles.

    Parameters
    ----------
    lat_rad, lon_rad, h_m : array_like, shape (...)
        Points of the map and their height above the ellipsoid; they broadcast. [rad, rad, m]
    stations : Stations, or mapping of identifier to (lat_rad, lon_rad, h_m)
        The network.
    rnp_m, fte_m : float
        Lateral accuracy required and flight technical error, both 95 %: ``sqrt(rnp² - fte²)`` is left for navigation. [m]
    sigma_altitude_m, sigma_bearing_rad : float
        Standard deviations of altitude and VOR bearing. [m, rad]
    risk : float
        Risk that the horizontal error leaves its circle. [1]

    Returns
    -------
    Coverage
        The circle is the exact one of `navbound.anp.circle`. The rules of use are those of `select`; terrain is not considered.

    Raises
    ------
    InputError
        A point that is not on the Earth, a flight technical error above the accuracy, or another number outside its domain.
    """
    network = _network(stations)
    limit_m = float(_core.nse_boundary(np.array([rnp_m], dtype=np.float64), np.array([fte_m], dtype=np.float64))[0])
    shape, (lat, lon, h) = flatten(lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()), h_m=(h_m, ()))
    least = _core.dme_coverage((lat, lon, h), _core_network(network), (sigma_bearing_rad, sigma_altitude_m), risk)
    best, all_in_view, vor = (least[name].reshape(shape) for name in ("nse_best_m", "nse_all_m", "nse_vor_m"))
    return Coverage(
        least["n_stations"].reshape(shape),
        least["best"].reshape(*shape, 2),
        best,
        all_in_view,
        vor,
        # A number that does not exist supports nothing.
        best <= limit_m,
        all_in_view <= limit_m,
        vor <= limit_m,
        limit_m,
    )


def _network(stations: Stations | Mapping[str, ArrayLike]) -> Stations:
    return stations if isinstance(stations, Stations) else Stations.of(stations)


def _points(network: Stations) -> tuple[Floats, Floats, Floats]:
    lat, lon, h = (np.ascontiguousarray(column, dtype=np.float64) for column in (network.lat_rad, network.lon_rad, network.h_m))
    return lat, lon, h


def _core_network(network: Stations) -> tuple[tuple[Floats, Floats, Floats], Floats, list[bool]]:
    return _points(network), np.ascontiguousarray(network.service_m, dtype=np.float64), network.bearing.tolist()


def _positions(solution: dict[str, Any], shape: tuple[int, ...]) -> Positions:
    reason_id = np.array(solution.pop("reason_id"), dtype=np.str_).reshape(shape)
    numbers: dict[str, Any] = {name: unflatten(values, shape) for name, values in solution.items()}
    status, reason = statuses(reason_id), sentences(reason_id)
    return Positions(**numbers, status=status, reason=reason, reason_id=reason_id)
