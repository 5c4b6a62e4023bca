"""Heights by pressure: what a setting and the temperature do to an altimeter, and the paths that follow from it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


@checked
def setting_offset(setting_hpa: ArrayLike) -> Floats:
    """What an altimeter of a setting adds to the pressure altitude: ``(T0/L) ((Q/p0)^0.190263 - 1)``.

    Parameters
    ----------
    setting_hpa : array_like, shape (...)
        [hPa]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        A setting outside [500, 1200] hPa; inches of mercury are.
    """
    shape, (setting,) = flatten(setting_hpa=(setting_hpa, ()))
    return unflatten(_core.vertical_setting_offset(setting), shape)


@checked
def setting_error(qnh_hpa: ArrayLike, setting_hpa: ArrayLike) -> Floats:
    """How much too high an altimeter reads whose setting is another than the true one; the aircraft is that much lower.

    Parameters
    ----------
    qnh_hpa, setting_hpa : array_like, shape (...)
        True setting, and the one that is selected. [hPa]

    Returns
    -------
    ndarray, shape (...)
        The same at every height. [m]

    Raises
    ------
    InputError
        A setting outside [500, 1200] hPa.
    """
    shape, (qnh, setting) = flatten(qnh_hpa=(qnh_hpa, ()), setting_hpa=(setting_hpa, ()))
    return unflatten(_core.vertical_setting_offset(setting) - _core.vertical_setting_offset(qnh), shape)


@checked
def isa_deviation(station_m: ArrayLike, temperature_k: ArrayLike) -> Floats:
    """Deviation of a station's temperature from the standard atmosphere.

    Parameters
    ----------
    station_m : array_like, shape (...)
        Its elevation, taken as its pressure altitude. [m]
    temperature_k : array_like, shape (...)
        [K]

    Returns
    -------
    ndarray, shape (...)
        [K]

    Raises
    ------
    InputError
        A station outside [-2000, 11000] m, or a temperature more than 100 K below or 60 K above the standard one: degrees Celsius are.
    """
    shape, flat = flatten(station_m=(station_m, ()), temperature_k=(temperature_k, ()))
    return unflatten(_core.vertical_deviation(*flat), shape)


@checked
def true_height(indicated_m: ArrayLike, station_m: ArrayLike, deviation_k: ArrayLike) -> Floats:
    """The true height above a station of an aircraft that indicates this height above it, in air as much colder or warmer everywhere.

    ``X + (dT/L) ln[(T0 - L Hs)/(T0 - L (Hs + X))]``, the hypsometric equation. Inversions and humidity are not in it.

    Parameters
    ----------
    indicated_m, station_m : array_like, shape (...)
        Indicated height above the station, and its elevation. [m]
    deviation_k : array_like, shape (...)
        Deviation from the standard atmosphere. [K]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        Heights outside [-2000, 11000] m, a deviation outside [-100, 60] K.
    """
    shape, flat = flatten(indicated_m=(indicated_m, ()), station_m=(station_m, ()), deviation_k=(deviation_k, ()))
    return unflatten(_core.vertical_height(0, *flat), shape)


@checked
def indicated_height(true_m: ArrayLike, station_m: ArrayLike, deviation_k: ArrayLike) -> Floats:
    """The height above a station that an aircraft of this true height indicates: the inverse of `true_height`, with its refusals.

    Parameters
    ----------
    true_m, station_m : array_like, shape (...)
        True height above the station, and its elevation. [m]
    deviation_k : array_like, shape (...)
        Deviation from the standard atmosphere. [K]

    Returns
    -------
    ndarray, shape (...)
        [m]
    """
    shape, flat = flatten(true_m=(true_m, ()), station_m=(station_m, ()), deviation_k=(deviation_k, ()))
    return unflatten(_core.vertical_height(1, *flat), shape)


@checked
def cold_correction(true_m: ArrayLike, station_m: ArrayLike, deviation_k: ArrayLike) -> Floats:
    """What is added to a height above a station so that the aircraft is truly there: exact, by `indicated_height`.

    Parameters
    ----------
    true_m, station_m : array_like, shape (...)
        Height that is needed above the station, and its elevation. [m]
    deviation_k : array_like, shape (...)
        Deviation from the standard atmosphere. [K]

    Returns
    -------
    ndarray, shape (...)
        Positive in cold air. [m]
    """
    return indicated_height(true_m, station_m, deviation_k) - np.asarray(true_m, dtype=np.float64)


@checked
def cold_correction_doc8168(height_m: ArrayLike, station_m: ArrayLike, deviation_k: ArrayLike) -> Floats:
    """The same by the formula of ICAO Doc 8168, ``h (15 - t0)/(273 + t0 - 0.5 L (h + Hs))``, of which its published table is made.

    Parameters
    ----------
    height_m, station_m : array_like, shape (...)
        Height above the station, and its elevation. [m]
    deviation_k : array_like, shape (...)
        Deviation from the standard atmosphere. [K]

    Returns
    -------
    ndarray, shape (...)
        Within 4 % of `cold_correction` up to stations at 2800 m. [m]

    Raises
    ------
    InputError
        As `true_height`.
    """
    shape, flat = flatten(height_m=(height_m, ()), station_m=(station_m, ()), deviation_k=(deviation_k, ()))
    return unflatten(_core.vertical_height(2, *flat), shape)


@checked
def barometric_altitude(distance_m: ArrayLike, crossing_m: ArrayLike, angle_rad: ArrayLike) -> Floats:
    """Altitude of a barometric path before its end: a constant slope over the curved Earth, ``(r + H0) exp(s tan a / r) - r``.

    Parameters
    ----------
    distance_m, crossing_m : array_like, shape (...)
        Distance along the ground before the end, and the altitude there. [m]
    angle_rad : array_like, shape (...)
        Positive for a descent. [rad]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        An angle outside (0, pi/2), a number that is not finite.
    """
    shape, flat = flatten(distance_m=(distance_m, ()), crossing_m=(crossing_m, ()), angle_rad=(angle_rad, ()))
    return unflatten(_core.vertical_path(0, *flat), shape)


@checked
def straight_altitude(distance_m: ArrayLike, crossing_m: ArrayLike, angle_rad: ArrayLike) -> Floats:
    """Altitude of a straight ray (ILS, LPV, GLS) at the same distance: above `barometric_altitude` by about ``s²/2r``.

    Parameters
    ----------
    distance_m, crossing_m : array_like, shape (...)
        Distance along the ground before the end, and the altitude there. [m]
    angle_rad : array_like, shape (...)
        Positive for a descent. [rad]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        As `barometric_altitude`; a distance at which the ray has left the Earth.
    """
    shape, flat = flatten(distance_m=(distance_m, ()), crossing_m=(crossing_m, ()), angle_rad=(angle_rad, ()))
    return unflatten(_core.vertical_path(1, *flat), shape)


@checked
def barometric_distance(altitude_m: ArrayLike, crossing_m: ArrayLike, angle_rad: ArrayLike) -> Floats:
    """Distance before its end at which a barometric path has an altitude: ``(r / tan a) ln((r + H)/(r + H0))``.

    Parameters
    ----------
    altitude_m, crossing_m : array_like, shape (...)
        Altitude, and that of the end. [m]
    angle_rad : array_like, shape (...)
        Positive for a descent. [rad]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        As `barometric_altitude`.
    """
    shape, flat = flatten(altitude_m=(altitude_m, ()), crossing_m=(crossing_m, ()), angle_rad=(angle_rad, ()))
    return unflatten(_core.vertical_path(2, *flat), shape)
