"""The vertical of an approach: heights by pressure, the error budget of RNP AR, the error off the path, and the altimeter's setting.

Pressure altitude is what a transponder sends, whatever setting the crew has selected; an indicated altitude adds the offset of the setting;
a geometric height is above the ellipsoid; an orthometric one above the sea is less by the undulation. Errors are true minus estimated,
heights are positive up, and the angle of a path is positive for a descent. Sources and marks: docs/methods/vertical.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from navbound import _core
from navbound.errors import NotFoundError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "CONSTANTS",
    "Budget",
    "Constants",
    "SettingLine",
    "SettingTest",
    "barometric_altitude",
    "barometric_distance",
    "budget",
    "cold_correction",
    "cold_correction_doc8168",
    "indicated_height",
    "isa_deviation",
    "off_path_sigma",
    "requirement",
    "risk_below",
    "setting_error",
    "setting_line",
    "setting_offset",
    "setting_test",
    "straight_altitude",
    "true_height",
    "turn_geometry",
]


class Constants(NamedTuple):
    """A text's constants of the vertical error budget.

    Attributes
    ----------
    source, provenance : str
        Where they come from, and how they are known.
    body_geometry_m : float
        Body geometry in straight flight. [m]
    """

    source: str
    provenance: str
    body_geometry_m: float


CONSTANTS: dict[str, Constants] = {
    name: Constants(source, provenance, body_m) for name, source, provenance, body_m in _core.vertical_constants()
}
"""Sets of constants by what a caller chooses; feet and metres are not the same surface."""


def _named(constants: str) -> str:
    if constants not in CONSTANTS:
        raise NotFoundError("constants", constants, "constants", CONSTANTS)
    return constants


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


class Budget(NamedTuple):
    """Vertical error budget, term by term, in metres, shape (...) each.

    Attributes
    ----------
    anpe_m, wpr_m, fte_m, ase_m, vae_m, atis_m : ndarray
        Position along track, waypoint precision, flight technical error, altimetry system error, vertical angle, transmitted setting.
    root_sum_square_m : ndarray
        Root of the sum of their squares: three standard deviations.
    veb_m : ndarray
        ``body_geometry_m - isad_m + 4/3 root_sum_square_m``.
    body_geometry_m, isad_m : ndarray
        As they were used.
    """

    anpe_m: Floats
    wpr_m: Floats
    fte_m: Floats
    ase_m: Floats
    vae_m: Floats
    atis_m: Floats
    root_sum_square_m: Floats
    veb_m: Floats
    body_geometry_m: Floats
    isad_m: Floats

    @property
    def sigma_m(self) -> Floats:
        """The equivalent standard deviation [m]."""
        return self.root_sum_square_m / 3.0


@checked
def budget(
    rnp_m: ArrayLike,
    angle_rad: ArrayLike,
    altitude_m: ArrayLike,
    threshold_m: ArrayLike,
    *,
    isad_m: ArrayLike,
    body_geometry_m: ArrayLike | None = None,
    constants: str = "feet",
) -> Budget:
    """Vertical error budget of RNP AR, ``bg - isad + 4/3 sqrt(anpe² + wpr² + fte² + ase² + vae² + atis²)``.

    Parameters
    ----------
    rnp_m : array_like, shape (...)
        RNP of the leg. [m]
    angle_rad : array_like, shape (...)
        Vertical path angle, positive for a descent. [rad]
    altitude_m, threshold_m : array_like, shape (...)
        Altitude above the sea, and elevation of the landing threshold. [m]
    isad_m : array_like, shape (...)
        Effect of temperature, negative in cold air: ``true_height(X, threshold_m, deviation_k) - X`` for the height X above the threshold.
        [m]
    body_geometry_m : array_like, shape (...), optional
        Body geometry, in a turn by `turn_geometry`; by default that of straight flight. [m]
    constants : {"feet", "metres"}
        Of FAA Order 8260.52 (printed), or of ICAO Doc 9905 (inferred): `CONSTANTS`.

    Raises
    ------
    InputError
        A negative RNP, an angle outside (0.01 degrees, pi/2), an altitude below the threshold or above 11000 m.
    NotFoundError
        Constants of another name.
    """
    straight_m = CONSTANTS[_named(constants)].body_geometry_m
    body = straight_m if body_geometry_m is None else body_geometry_m
    shape, flat = flatten(
        rnp_m=(rnp_m, ()),
        angle_rad=(angle_rad, ()),
        altitude_m=(altitude_m, ()),
        threshold_m=(threshold_m, ()),
        body_geometry_m=(body, ()),
        isad_m=(isad_m, ()),
    )
    terms = _core.vertical_budget(constants, list(flat))
    return Budget(*(unflatten(np.ascontiguousarray(column), shape) for column in [*terms.T, *flat[4:]]))


@checked
def turn_geometry(semispan_m: ArrayLike, bank_rad: ArrayLike) -> Floats:
    """Body geometry in a turn: the semispan times the sine of the bank.

    Parameters
    ----------
    semispan_m : array_like, shape (...)
        [m]
    bank_rad : array_like, shape (...)
        [rad]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        A negative semispan, a bank outside [0, pi/2).
    """
    shape, flat = flatten(semispan_m=(semispan_m, ()), bank_rad=(bank_rad, ()))
    return unflatten(_core.vertical_turn_geometry(*flat), shape)


@checked
def requirement(rnp_m: ArrayLike, angle_rad: ArrayLike, altitude_m: ArrayLike, *, constants: str = "feet") -> Floats:
    """What 99.7 % of an aircraft's vertical errors have to be below in standard air (FAA AC 90-101A, standard, not read).

    Parameters
    ----------
    rnp_m : array_like, shape (...)
        [m]
    angle_rad : array_like, shape (...)
        Vertical path angle, zero for level flight. [rad]
    altitude_m : array_like, shape (...)
        [m]
    constants : {"feet", "metres"}
        As in `budget`.

    Returns
    -------
    ndarray, shape (...)
        ``sqrt(anpe² + wpr² + fte² + ase²)``. [m]

    Raises
    ------
    InputError
        A negative RNP, an angle outside [0, pi/2), an altitude outside [-2000, 11000] m.
    """
    shape, flat = flatten(rnp_m=(rnp_m, ()), angle_rad=(angle_rad, ()), altitude_m=(altitude_m, ()))
    return unflatten(_core.vertical_requirement(_named(constants), *flat), shape)


@checked
def off_path_sigma(sigma_along_m: ArrayLike, sigma_up_m: ArrayLike, correlation: ArrayLike, angle_rad: ArrayLike) -> Floats:
    """Standard deviation of the height off a path at the true place: ``sqrt(su² + tan²a sa² + 2 rho su sa tan a)``.

    With it `tse.exact` bounds the vertical total system error, and `risk_below` says how likely the aircraft is below. In a climb (a
    negative angle) the last term changes its sign.

    Parameters
    ----------
    sigma_along_m, sigma_up_m : array_like, shape (...)
        Standard deviations along the track and up. [m]
    correlation : array_like, shape (...)
        Of both, errors positive forwards and up. [1]
    angle_rad : array_like, shape (...)
        Positive for a descent. [rad]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        A negative deviation, a correlation outside [-1, 1], an angle outside (-pi/2, pi/2).
    """
    names: dict[str, Any] = {"sigma_along_m": sigma_along_m, "sigma_up_m": sigma_up_m, "correlation": correlation, "angle_rad": angle_rad}
    shape, flat = flatten(**{name: (value, ()) for name, value in names.items()})
    return unflatten(_core.vertical_off_path_sigma(*flat), shape)


@checked
def risk_below(fte_m: ArrayLike, sigma_m: ArrayLike, limit_m: ArrayLike) -> Floats:
    """Probability that an aircraft is more than a limit below its path: ``Q((limit + fte)/sigma)``.

    Parameters
    ----------
    fte_m : array_like, shape (...)
        Flight technical error, positive above the path. [m]
    sigma_m, limit_m : array_like, shape (...)
        Standard deviation, and distance below the path. [m]

    Returns
    -------
    ndarray, shape (...)
        [1]

    Raises
    ------
    InputError
        A negative deviation or limit.
    """
    shape, flat = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), limit_m=(limit_m, ()))
    return unflatten(_core.vertical_risk_below(*flat), shape)


class SettingLine(NamedTuple):
    """The line through geometric less indicated height.

    Attributes
    ----------
    n : int
        Points. [1]
    intercept_m : float
        Difference at the ground, negative where the setting is too high. [m]
    slope : float
        Its growth with height: the deviation of the temperature by the temperature. [1]
    residual_sigma_m : float
        Standard deviation of the residuals, of n - 2 degrees of freedom. [m]
    """

    n: int
    intercept_m: float
    slope: float
    residual_sigma_m: float


@checked
def setting_line(height_m: ArrayLike, difference_m: ArrayLike) -> SettingLine:
    """Difference of heights at the ground, with the temperature taken out: the line of least squares.

    A wrong altimeter setting moves all indicated heights by the same; a wrong geometric height or undulation does, too. The barometric
    altitude of a transponder holds no setting: indicated heights need the one that is broadcast, or the aerodrome's.

    Parameters
    ----------
    height_m, difference_m : array_like, shape (n,)
        Indicated height above the aerodrome, and geometric less indicated height above the sea. [m]

    Raises
    ------
    InputError
        Numbers that are not finite, fewer than three points, the same height at all of them.
    """
    shape, flat = flatten(height_m=(height_m, ()), difference_m=(difference_m, ()))
    del shape
    return SettingLine(*_core.vertical_setting_line(*flat))


class SettingTest(NamedTuple):
    """What a test of the altimeter setting can find, shape (...) each.

    Attributes
    ----------
    threshold_m : ndarray
        A larger difference at the ground is an alarm. [m]
    power : ndarray
        Probability of an alarm at the error. [1]
    detectable_m : ndarray
        Error that is an alarm with the requested probability. [m]
    """

    threshold_m: Floats
    power: Floats
    detectable_m: Floats


@checked
def setting_test(sigma_m: ArrayLike, false_alarm: ArrayLike, error_m: ArrayLike, *, probability: ArrayLike = 0.9) -> SettingTest:
    """Threshold and power of the test of a difference at the ground: alarm above ``K sigma``, ``Q(K - d/s) + Q(K + d/s)``.

    Parameters
    ----------
    sigma_m : array_like, shape (...)
        Standard deviation of the difference where nothing is wrong; three approaches of one airliner suggest 10 m (inferred). [m]
    false_alarm : array_like, shape (...)
        Risk of an alarm where nothing is wrong. [1]
    error_m : array_like, shape (...)
        Error of the setting, as a height. [m]
    probability : array_like, shape (...)
        For which `detectable_m` is given. [1]

    Raises
    ------
    InputError
        A deviation that is not positive, a risk outside its domain, a probability outside [0.5, 1).
    """
    shape, flat = flatten(sigma_m=(sigma_m, ()), false_alarm=(false_alarm, ()), error_m=(error_m, ()), probability=(probability, ()))
    values = _core.vertical_setting_test(*flat)
    return SettingTest(*(unflatten(np.ascontiguousarray(column), shape) for column in values.T))
