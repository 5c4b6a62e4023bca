"""The vertical error budget of RNP AR, the requirement on the aircraft, and the error off the path."""

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
