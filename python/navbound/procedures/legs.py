"""Legs of a procedure, and where positions lie along and beside them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound.table.arrays import flatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from navbound.procedures.flight import Limits

_STATUS = np.array(_core.procedure_words()[1])
"""Statuses of positions by their number in the core."""

STATES = {
    "full": "defined by its fixes",
    "inferred_start": "begin INFERRED",
    "open_end": "no defined end",
    "holding": "inbound leg of a hold",
    "point": "a point, no path",
    "no_path": "a heading or a procedure turn: the wind decides",
    "no_start": "the leg before has no defined end",
    "no_fix": "its fix is not in the file",
    "no_centre": "its centre is not in the file",
    "no_navaid": "its navaid is not in the file",
    "ambiguous_fix": "its fix, centre or navaid has two positions in the file",
    "no_variation": "a magnetic course, and neither navaid nor airport has a variation",
    "not_coded": "a course, distance or turn direction is not coded",
    "impossible": "its fixes define no such geometry, or lie too far from the airport",
}
"""What the deviation from a leg is worth, by the state's id."""

ORIGINS = {
    "coded": "coded",
    "selected": "line selected",
    "default": "default (standard)",
    "not_coded": "not coded: not judged",
    "contradicted": "not a published line, or above 5 NM: not judged",
}
"""Where the RNP of a leg comes from, by the origin's id."""


@dataclass(frozen=True)
class LevelOfService:
    """A line of minima.

    Attributes
    ----------
    line : int
        Line in the file.
    rnp_m : float
        Its RNP. [m]
    """

    line: int
    rnp_m: float


@dataclass(frozen=True)
class Leg:
    """One leg as coded, and its geometry.

    Numbers that the file leaves blank are None. ``rnp_m`` is what the leg is judged by, NaN where it is unknown, with its origin
    (:data:`ORIGINS`); ``state`` is what its geometry is worth (:data:`STATES`). ``begin_m`` is NaN behind a leg with an open end.
    """

    line: int
    sequence: int
    route_type: str
    transition: str
    part: str
    fix: str
    fix_region: str
    fix_section: str
    lat_rad: float | None
    lon_rad: float | None
    description: str
    fly_over: bool
    role: str
    turn: str
    terminator: str
    rnp_coded_m: float | None
    rnp_m: float
    rnp_origin: str
    rnp_differs: bool
    navaid: str
    radius_coded_m: float | None
    theta_rad: float | None
    rho_m: float | None
    course_field: str
    distance_field: str
    altitude_description: str
    altitude_fields: tuple[str, str]
    altitude_m: tuple[float | None, float | None]
    transition_altitude: str
    speed_kt: float | None
    speed_description: str
    vertical_angle_rad: float | None
    centre_fix: str
    state: str
    begin_m: float
    length_m: float
    turn_rad: float
    radius_m: float | None
    start_to_centre_m: float | None
    end_to_centre_m: float | None
    centre_moved_m: float | None
    course_begin_rad: float | None
    course_end_rad: float | None

    @property
    def has_path(self) -> bool:
        """Whether a position has a deviation from it."""
        return bool(np.isfinite(self.length_m)) or self.state == "open_end"


def leg(row: dict[str, Any]) -> Leg:
    """A leg from the core's row."""
    names = {f.name for f in fields(Leg)}
    plain: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in row.items() if name in names}
    return Leg(**plain)


@dataclass(frozen=True)
class LegFeet:
    """Feet of positions on the legs; all arrays have the shape of the positions.

    Attributes
    ----------
    leg : ndarray of int
        Index in ``Procedure.legs``; -1 where there is none.
    along_m, along_leg_m : ndarray
        Distance along the procedure and along the leg. [m]
    cross_m : ndarray
        Distance beside the leg, positive right. [m]
    course_rad : ndarray
        Course of the leg at the foot, in [0, 2 pi). [rad]
    foot_lat_rad, foot_lon_rad : ndarray
        The foot. [rad]
    """

    leg: NDArray[np.int64]
    along_m: NDArray[np.float64]
    along_leg_m: NDArray[np.float64]
    cross_m: NDArray[np.float64]
    course_rad: NDArray[np.float64]
    foot_lat_rad: NDArray[np.float64]
    foot_lon_rad: NDArray[np.float64]


@dataclass(frozen=True)
class Followed(LegFeet):
    """Feet on the active legs of a flight.

    Attributes
    ----------
    status : ndarray of str
        ``ok``, ``strayed``, ``transition``, ``holding``, ``outside``, ``not_established``, ``off_path`` or ``missing``.
    """

    status: NDArray[np.str_]


@dataclass(frozen=True)
class Procedure:
    """Legs in the order flown; made by :func:`navbound.path.procedure`.

    Attributes
    ----------
    airport, kind, ident, transition, file : str
        What it is, and the file it is from.
    missed : bool
        Whether the missed approach belongs to it.
    line : str or None
        Line of minima that was selected.
    legs : tuple of Leg
        Its legs.
    levels : tuple of LevelOfService
        Its published lines of minima.
    notes : tuple of str
        What of the file is not used.
    doubts : tuple of str
        Why the legs may not be the whole procedure; beside one no flight is "inside".
    """

    airport: str
    kind: str
    ident: str
    transition: str
    missed: bool
    line: str | None
    legs: tuple[Leg, ...]
    levels: tuple[LevelOfService, ...]
    file: str
    notes: tuple[str, ...]
    doubts: tuple[str, ...]
    core: _core.ProcedurePath

    @property
    def name(self) -> str:
        """Airport, procedure and transition: ``KDEN/H26-Z:FUZZZ``."""
        return f"{self.airport}/{self.ident}" + (f":{self.transition}" if self.transition else "")

    @property
    def length_m(self) -> float:
        """Length from its begin to its end [m]; infinite or NaN where that is not defined."""
        return self.core.length_m

    @property
    def n_without_rnp(self) -> int:
        """Legs with a path and without an RNP: they are not judged [1]."""
        return sum(1 for x in self.legs if x.has_path and not np.isfinite(x.rnp_m))

    def nearest(self, lat_rad: ArrayLike, lon_rad: ArrayLike) -> LegFeet:
        """Feet of positions, each on the leg nearest to it.

        Parameters
        ----------
        lat_rad, lon_rad : array_like
            Positions, WGS-84; both NaN for a missing one. [rad]

        Raises
        ------
        InputError
            A position that is not on the Earth, or a procedure without a path.
        """
        shape, (lat, lon) = flatten(lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()))
        return LegFeet(**{name: values.reshape(shape) for name, values in self.core.nearest(lat, lon).items()})

    def follow(self, time_s: ArrayLike, lat_rad: ArrayLike, lon_rad: ArrayLike, limits: Limits | None = None) -> Followed:
        """Feet of one flight on its active legs.

        The first leg is the nearest whose course agrees with the track; from there the legs are walked forwards. A flight is judged from
        where it is established to the end of the procedure; what leaves the path in between is ``strayed``, with its distance from the
        nearest leg. The numbers of `limits` are INFERRED.

        Parameters
        ----------
        time_s : array_like, shape (n,)
            Rising times. [s]
        lat_rad, lon_rad : array_like, shape (n,)
            Positions, WGS-84; both NaN for a missing one. [rad]
        limits : Limits, optional
            What following goes by.

        Raises
        ------
        InputError
            A time that does not rise, or a position that is not on the Earth.
        """
        from navbound.procedures.strays import follow  # noqa: PLC0415

        shape, (time, lat, lon) = flatten(time_s=(time_s, ()), lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()))
        followed, _ = follow(self, time, (lat, lon), limits)
        return Followed(**{f.name: getattr(followed, f.name).reshape(shape) for f in fields(Followed)})

    def followed(
        self, time_s: NDArray[np.float64], lat_rad: NDArray[np.float64], lon_rad: NDArray[np.float64], limits: Limits | None = None
    ) -> Followed:
        """The same without what strays: every position by itself, as the core follows it."""
        from navbound.procedures.flight import Limits  # noqa: PLC0415

        row = self.core.follow(time_s, lat_rad, lon_rad, [(x.rnp_m, x.fly_over) for x in self.legs], (limits or Limits()).values)
        return Followed(status=_STATUS[row.pop("status")], **row)
