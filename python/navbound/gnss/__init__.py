"""Satellite navigation: receivers' files and positions; nominal constellations, where their satellites stand, and what covariance follows.

Orbits follow IS-GPS-200 without its harmonic corrections (standard); the covariance is (H' W H)^-1 with one clock for each constellation
(Fu, Zhang, Li 2014 for equal sigmas; printed).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.gnss.constellations import CONSTELLATIONS, Orbits, constellation, nominal
from navbound.gnss.dilution_map import DopMap, dop_map
from navbound.gnss.files import Navigation, Observations, Refused, read_navigation, read_observations
from navbound.gnss.precise import PreciseOrbits, read_orbits
from navbound.gnss.receivers import FATES, MASK_RAD, SYSTEMS, UNUSED, Positions, geodetic, solve
from navbound.status import availability, reasons_of
from navbound.table.arguments import checked
from navbound.table.arrays import flatten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "CONSTELLATIONS",
    "FATES",
    "MASK_RAD",
    "SYSTEMS",
    "UNUSED",
    "Dilution",
    "DopMap",
    "Navigation",
    "Observations",
    "Orbits",
    "PositionCovariance",
    "Positions",
    "PreciseOrbits",
    "Refused",
    "Sky",
    "constellation",
    "covariance",
    "directions",
    "dop",
    "dop_map",
    "geodetic",
    "geometry",
    "nominal",
    "places",
    "read_navigation",
    "read_observations",
    "read_orbits",
    "responses",
    "solve",
]


@dataclass(frozen=True)
class Sky:
    """Satellites above a mask; arrays have the shape of the receivers with one more axis, the satellites.

    Attributes
    ----------
    az_rad, el_rad : ndarray
        Azimuth, clockwise from true north, and elevation; NaN below the mask. [rad]
    visible : ndarray of bool
        Which are above the mask.
    n_sv : ndarray of int
        How many are; without the satellite axis. [1]
    """

    az_rad: NDArray[np.float64]
    el_rad: NDArray[np.float64]
    visible: NDArray[np.bool_]
    n_sv: NDArray[np.int64]


@dataclass(frozen=True)
class PositionCovariance:
    """Covariance of a position from satellite geometry; NaN exactly where ``status`` is not ``ok``.

    Attributes
    ----------
    enu_m2 : ndarray, shape (..., 3, 3)
        Covariance, east-north-up. [m²]
    sigma_major_m, sigma_minor_m : ndarray
        Standard deviations along the axes of the horizontal ellipse. [m]
    n_sv : ndarray of int
        Satellites used. [1]
    status : ndarray of str
        ``ok`` or ``not_available``.
    reason : ndarray of str
        Why it is not available, for people.
    reason_id : ndarray of str
        The same as an id of ``navbound.status.REASONS``; empty where it is available.
    """

    enu_m2: NDArray[np.float64]
    sigma_major_m: NDArray[np.float64]
    sigma_minor_m: NDArray[np.float64]
    n_sv: NDArray[np.int64]
    status: NDArray[np.str_]
    reason: NDArray[np.str_]
    reason_id: NDArray[np.str_]

    @property
    def cov_ee_m2(self) -> NDArray[np.float64]:
        """Variance east [m²]."""
        return self.enu_m2[..., 0, 0]

    @property
    def cov_en_m2(self) -> NDArray[np.float64]:
        """Covariance of east and north [m²]."""
        return self.enu_m2[..., 0, 1]

    @property
    def cov_nn_m2(self) -> NDArray[np.float64]:
        """Variance north [m²]."""
        return self.enu_m2[..., 1, 1]

    @property
    def cov_uu_m2(self) -> NDArray[np.float64]:
        """Variance up [m²]."""
        return self.enu_m2[..., 2, 2]


@dataclass(frozen=True)
class Dilution:
    """Dilutions of precision, ranges of equal weight; NaN exactly where ``status`` is not ``ok``.

    Attributes
    ----------
    edop, ndop, hdop, vdop, pdop : ndarray
        East, north, horizontal, vertical, position. [1]
    n_sv : ndarray of int
        Satellites used. [1]
    status : ndarray of str
        ``ok`` or ``not_available``.
    reason : ndarray of str
        Why it is not available, for people.
    reason_id : ndarray of str
        The same as an id of ``navbound.status.REASONS``; empty where it is available.
    """

    edop: NDArray[np.float64]
    ndop: NDArray[np.float64]
    hdop: NDArray[np.float64]
    vdop: NDArray[np.float64]
    pdop: NDArray[np.float64]
    n_sv: NDArray[np.int64]
    status: NDArray[np.str_]
    reason: NDArray[np.str_]
    reason_id: NDArray[np.str_]


@checked
def directions(
    orbits: Orbits, lat_rad: ArrayLike, lon_rad: ArrayLike, h_m: ArrayLike, time_s: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where every satellite stands, above the horizon or below.

    Parameters
    ----------
    orbits : Orbits
        The satellites.
    lat_rad, lon_rad, h_m : array_like
        Receivers, WGS-84. [rad, rad, m]
    time_s : array_like
        Time since the reference instant of the orbits. [s]

    Returns
    -------
    az_rad, el_rad : ndarray, shape (..., n)
        Azimuth in [0, 2 pi), clockwise from true north, and elevation. [rad]

    Raises
    ------
    InputError
        Elements that are no orbit, a receiver that is not on the Earth, a time that is not finite.
    """
    shape, (lat, lon, h, time) = flatten(lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()), h_m=(h_m, ()), time_s=(time_s, ()))
    angles = _core.satellite_directions(orbits.elements(), lat, lon, h, time)
    wide = (*shape, len(orbits.satellite))
    return angles["az_rad"].reshape(wide), angles["el_rad"].reshape(wide)


@checked
def places(  # noqa: PLR0917 - receivers, then lines of sight
    lat_rad: ArrayLike, lon_rad: ArrayLike, h_m: ArrayLike, az_rad: ArrayLike, el_rad: ArrayLike, distance_m: float
) -> NDArray[np.float64]:
    """Places at a distance from receivers along lines of sight.

    Parameters
    ----------
    lat_rad, lon_rad, h_m : array_like, shape (m,)
        Receivers, WGS-84. [rad, rad, m]
    az_rad, el_rad : array_like, shape (m, n)
        Lines of sight, azimuth clockwise from true north. [rad]
    distance_m : float
        [m]

    Returns
    -------
    ndarray, shape (m, n, 3)
        Earth-centred, Earth-fixed; NaN where an angle is. [m]

    Raises
    ------
    InputError
        A receiver that is not on the Earth, shapes that do not fit.
    """
    shape, (lat, lon, h) = flatten(lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()), h_m=(h_m, ()))
    wide, (az, el) = flatten(az_rad=(az_rad, ()), el_rad=(el_rad, ()))
    if len(shape) != 1 or len(wide) != 2 or wide[0] != shape[0]:
        raise InputError("az_rad", f"shape {wide}", domain="shape (m, n) for m receivers")
    return _core.places_along((lat, lon, h), az, el, distance_m).reshape(*wide, 3)


@checked
def geometry(orbits: Orbits, lat_rad: ArrayLike, lon_rad: ArrayLike, h_m: ArrayLike, time_s: ArrayLike, *, mask_rad: float = 0.0) -> Sky:
    """Satellites above an elevation mask.

    Parameters
    ----------
    orbits : Orbits
        The satellites.
    lat_rad, lon_rad, h_m : array_like
        Receivers, WGS-84. [rad, rad, m]
    time_s : array_like
        Time since the reference instant of the orbits. [s]
    mask_rad : float, optional
        Lowest elevation that is used. [rad]

    Raises
    ------
    InputError
        As :func:`directions`, and for a mask outside [-pi/2, pi/2].
    """
    if not -np.pi / 2 <= mask_rad <= np.pi / 2:
        raise InputError("mask_rad", mask_rad, "rad", "[-pi/2, pi/2]")
    az, el = directions(orbits, lat_rad, lon_rad, h_m, time_s)
    visible = el >= mask_rad
    return Sky(np.where(visible, az, np.nan), np.where(visible, el, np.nan), visible, visible.sum(axis=-1))


@checked
def covariance(
    az_rad: ArrayLike, el_rad: ArrayLike, sigma_m: ArrayLike, constellation: Sequence[int] | NDArray[np.int64] | None = None
) -> PositionCovariance:
    """Covariance of a weighted least-squares position, V = (H' W H)^-1 with W = diag(1 / sigma²).

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (..., n)
        Satellites, azimuth clockwise from true north; both NaN for one that is not used. [rad]
    sigma_m : array_like, shape (..., n) or ()
        Standard deviation of each range. [m]
    constellation : sequence of int, shape (n,), optional
        Index of each satellite's system in :data:`CONSTELLATIONS`; without it all share one clock.

    Returns
    -------
    PositionCovariance
        ``not_available`` where unknowns outnumber satellites or the condition number of H' W H is above 1e12.

    Raises
    ------
    InputError
        Angles outside their domain, a sigma that is not positive, shapes that do not fit.
    """
    shape, (az, el, sigma) = flatten(az_rad=(az_rad, ()), el_rad=(el_rad, ()), sigma_m=(sigma_m, ()))
    covariances = _core.position_covariances(az, el, sigma, _systems(shape, constellation))
    leading = shape[:-1]
    reason, reason_id = reasons_of(covariances, leading)
    return PositionCovariance(
        covariances["enu_m2"].reshape(*leading, 3, 3),
        covariances["sigma_major_m"].reshape(leading),
        covariances["sigma_minor_m"].reshape(leading),
        covariances["n_sv"].reshape(leading),
        availability(reason_id),
        reason,
        reason_id,
    )


@checked
def responses(
    az_rad: ArrayLike, el_rad: ArrayLike, sigma_m: ArrayLike, constellation: Sequence[int] | NDArray[np.int64] | None = None
) -> NDArray[np.float64]:
    """How far a weighted least-squares position moves for a metre in each range: the rows of (H' W H)^-1 H' W.

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (..., n)
        Satellites, azimuth clockwise from true north; both NaN for one that is not used. [rad]
    sigma_m : array_like, shape (..., n) or ()
        Standard deviation of each range. [m]
    constellation : sequence of int, shape (n,), optional
        Index of each satellite's system in :data:`CONSTELLATIONS`; without it all share one clock.

    Returns
    -------
    ndarray, shape (..., 3, n)
        East, north, up; 0 for a satellite that is not used, NaN everywhere where :func:`covariance` is ``not_available``. [1]

    Raises
    ------
    InputError
        As :func:`covariance`.
    """
    shape, (az, el, sigma) = flatten(az_rad=(az_rad, ()), el_rad=(el_rad, ()), sigma_m=(sigma_m, ()))
    responses = _core.position_responses(az, el, sigma, _systems(shape, constellation))
    rows = responses["response"].reshape(-1, shape[-1], 3)
    solved = availability(np.array(responses["reason_id"], dtype=np.str_)) == "ok"
    rows[solved[:, None] & np.isnan(az.reshape(-1, shape[-1]))] = 0.0
    return np.ascontiguousarray(np.swapaxes(rows, -1, -2)).reshape(*shape[:-1], 3, shape[-1])


@checked
def dop(az_rad: ArrayLike, el_rad: ArrayLike, constellation: Sequence[int] | NDArray[np.int64] | None = None) -> Dilution:
    """Dilutions of precision, one clock for each constellation.

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (..., n)
        Satellites, azimuth clockwise from true north; both NaN for one that is not used. [rad]
    constellation : sequence of int, shape (n,), optional
        Index of each satellite's system in :data:`CONSTELLATIONS`; without it all share one clock.

    Returns
    -------
    Dilution
        ``not_available`` as in :func:`covariance`.

    Raises
    ------
    InputError
        As :func:`covariance`.
    """
    shape, (az, el) = flatten(az_rad=(az_rad, ()), el_rad=(el_rad, ()))
    dilutions = _core.dilutions(az, el, _systems(shape, constellation))
    leading = shape[:-1]
    reason, reason_id = reasons_of(dilutions, leading)
    numbers = {name: values.reshape(leading) for name, values in dilutions.items()}
    return Dilution(status=availability(reason_id), reason=reason, reason_id=reason_id, **numbers)


def _systems(shape: tuple[int, ...], constellation: Sequence[int] | NDArray[np.int64] | None) -> list[int]:
    if not shape or shape[-1] == 0:
        raise InputError("az_rad", f"shape {shape}", domain="shape (..., n), n at least 1")
    systems = np.zeros(shape[-1], dtype=np.int64) if constellation is None else np.asarray(constellation)
    if systems.shape != shape[-1:] or not np.issubdtype(systems.dtype, np.integer) or systems.min() < 0:
        raise InputError("constellation", f"shape {systems.shape}", domain=f"{shape[-1]} indices of CONSTELLATIONS")
    return [int(c) for c in systems]
