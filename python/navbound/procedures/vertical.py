"""The vertical path of an approach: the runway's crossing altitude and the angle of the leg to it, before the threshold (INFERRED)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from navbound import vertical
from navbound.errors import InputError
from navbound.units import METRES_PER_FT, METRES_PER_NM

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from navbound.procedures.database import Database
    from navbound.procedures.legs import Leg, Procedure

    Floats = NDArray[np.float64]

Shape = Literal["barometric", "straight"]
"""A constant slope over the curved Earth (baro-VNAV), or a straight ray (ILS, LPV, GLS)."""
LIMIT_M = 75.0 * METRES_PER_FT
"""Largest vertical deviation on the final approach of RNP AR and of LNAV/VNAV: 75 ft, also given as 22 m. Provenance: standard. [m]"""
CONSTRAINT_M = 10.0 * METRES_PER_FT
"""A path that is so much below the coded lowest altitude of a fix contradicts it. Provenance: inferred. [m]"""
CROSSING_M = (0.0, 100.0 * METRES_PER_FT)
"""Heights above the threshold at which a path crosses it without a remark. Provenance: inferred. [m]"""


@dataclass(frozen=True)
class VerticalPath:
    """The vertical path of the final approach.

    Attributes
    ----------
    runway : str
        Its runway, such as ``RW26``.
    shape : {"barometric", "straight"}
        What it is over the curved Earth.
    crossing_m : float
        Altitude above the sea at the threshold, as coded on the leg to the runway. [m]
    angle_rad : float
        Its angle there, positive for a descent. [rad]
    legs : tuple of int
        Indices of the legs of the final approach, on which it is defined.
    begins_m : tuple of float
        How far before the threshold each of them begins. [m]
    undulation_m : float
        Ellipsoid below the sea at the runway, by its own two heights; NaN where the file lacks one. [m]
    threshold_m : float
        Elevation of the threshold; NaN where the file has none. [m]
    words : tuple of str
        What a reader must know of it.
    """

    runway: str
    shape: Shape
    crossing_m: float
    angle_rad: float
    legs: tuple[int, ...]
    begins_m: tuple[float, ...]
    undulation_m: float
    threshold_m: float
    words: tuple[str, ...]

    def before_m(self, leg: NDArray[np.int64], along_leg_m: Floats) -> Floats:
        """Distance before the threshold; NaN on legs that are not of the final approach.

        Parameters
        ----------
        leg, along_leg_m : ndarray, shape (n,)
            Index of the leg, and the distance along it. [m]
        """
        before = np.full(along_leg_m.shape, np.nan)
        for index, begin in zip(self.legs, self.begins_m, strict=True):
            on = leg == index
            before[on] = begin - along_leg_m[on]
        return before

    def altitude_m(self, before_m: ArrayLike) -> Floats:
        """Altitude of the path above the sea; NaN beyond the threshold.

        Parameters
        ----------
        before_m : array_like, shape (n,)
            Distances before the threshold. [m]
        """
        before = np.asarray(before_m, dtype=np.float64)
        altitude = np.full(before.shape, np.nan)
        inside = before >= 0.0
        shape = vertical.barometric_altitude if self.shape == "barometric" else vertical.straight_altitude
        altitude[inside] = shape(before[inside], self.crossing_m, self.angle_rad)
        return altitude


def vertical_path(database: Database, procedure: Procedure, shape: Shape = "barometric") -> tuple[VerticalPath | None, str]:
    """The vertical path of an approach, or None; and the sentence that states it, or why there is none.

    Parameters
    ----------
    database : Database
        The file that the procedure is of, for the heights of the runway.
    procedure : Procedure
        From the same file.
    shape : {"barometric", "straight"}
        A constant slope over the curved Earth, or a straight ray.

    Raises
    ------
    InputError
        Another shape.
    """
    if shape not in get_args(Shape):
        raise InputError("shape", shape, domain=" or ".join(get_args(Shape)))
    final = [k for k, leg in enumerate(procedure.legs) if leg.part == "final" and leg.has_path]
    if not final:
        return None, "no vertical path: the procedure has no final approach with a path"
    last = procedure.legs[final[-1]]
    lengths = [procedure.legs[k].length_m for k in final]
    why = _lacks(last) or (None if math.isfinite(sum(lengths)) else "a leg of the final approach has no defined end")
    if why is not None:
        return None, f"no vertical path: {why}"
    angle, crossing = -(last.vertical_angle_rad or math.nan), last.altitude_m[0] or 0.0
    heights = database.threshold_heights_m(procedure.airport, last.fix)
    threshold, ellipsoid = (math.nan if h is None else h for h in heights)
    path = VerticalPath(
        runway=last.fix,
        shape=shape,
        crossing_m=crossing,
        angle_rad=angle,
        legs=tuple(final),
        begins_m=tuple(sum(lengths[k:]) for k in range(len(lengths))),
        undulation_m=ellipsoid - threshold,
        threshold_m=threshold,
        words=(),
    )
    words = _doubts(path, procedure)
    sentence = (
        f"Vertical path: {shape}, {math.degrees(angle):.2f}° through {crossing / METRES_PER_FT:.0f} ft at {last.fix}, as coded on the leg "
        "to it (INFERRED), on the final approach alone."
    )
    return VerticalPath(**{**path.__dict__, "words": tuple(words)}), " ".join([sentence, *words])


def surface_below(path: VerticalPath, procedure: Procedure, temperature_k: float | None = None) -> tuple[vertical.Surface | None, str]:
    """The obstacle clearance surface of an RNP AR approach, or None; and the sentence that states it, or why there is none.

    Parameters
    ----------
    path : VerticalPath
        From :func:`vertical_path`.
    procedure : Procedure
        The same procedure.
    temperature_k : float, optional
        Lowest temperature at the threshold; without it the standard one. [K]

    Raises
    ------
    InputError
        A temperature that is none at the threshold.
    """
    if not procedure.levels:
        return None, "No obstacle clearance surface: it is defined for RNP AR, and the procedure has no lines of minima of RNP AR."
    rnp_m = procedure.legs[path.legs[-1]].rnp_m
    if not math.isfinite(rnp_m) or not math.isfinite(path.threshold_m):
        return None, "No obstacle clearance surface: the RNP of the leg to the runway or the threshold's elevation is unknown."
    fix_m = float(path.altitude_m(path.begins_m[:1])[0])
    if not fix_m - path.threshold_m > vertical.LOW_M["feet"]:
        return None, "No obstacle clearance surface: the final approach begins less than 250 ft above the threshold."
    surface = vertical.obstacle_surface(
        rnp_m, path.angle_rad, fix_m, path.threshold_m, crossing_height_m=path.crossing_m - path.threshold_m, temperature_k=temperature_k
    )
    air = (
        "standard air (no lowest temperature was stated)" if temperature_k is None else f"{temperature_k - 273.15:.0f} °C at the threshold"
    )
    return surface, (
        f"Obstacle clearance surface (FAA Order 8260.52; one denominator INFERRED): {surface.slope_ratio:.2f} to 1 from "
        f"{surface.origin_m:.0f} m before the threshold, {surface.roc_fix_m:.0f} m below the path at the final approach fix and "
        f"{surface.roc_low_m:.0f} m at 250 ft, with RNP {rnp_m / METRES_PER_NM:.3g} and {air}."
    )


def _lacks(leg: Leg) -> str | None:
    """What the last leg lacks for a vertical path."""
    name = f"the leg to {leg.fix or leg.terminator}"
    if not leg.fix.startswith("RW"):
        return f"{name} does not end at a runway threshold"
    if leg.vertical_angle_rad is None or not leg.vertical_angle_rad < 0.0:
        return f"{name} has no angle of a descent"
    if leg.altitude_m[0] is None or leg.altitude_description:
        return f"{name} has no coded altitude at which it crosses the threshold"
    return None


def _doubts(path: VerticalPath, procedure: Procedure) -> list[str]:
    """What contradicts the path: its height at the threshold, other angles, lowest altitudes that it undercuts."""
    words = []
    if not math.isfinite(path.threshold_m):
        words.append(f"The file has no elevation of {path.runway}.")
    elif not CROSSING_M[0] <= path.crossing_m - path.threshold_m <= CROSSING_M[1]:
        above = (path.crossing_m - path.threshold_m) / METRES_PER_FT
        words.append(f"It crosses the threshold {above:.0f} ft above it, outside 0 to 100 ft (INFERRED).")
    for leg in (procedure.legs[k] for k in path.legs[:-1]):
        if leg.vertical_angle_rad is not None and abs(leg.vertical_angle_rad + path.angle_rad) > 1e-6:
            words.append(f"The leg to {leg.fix} has another angle, {-math.degrees(leg.vertical_angle_rad):.2f}°: it is not used.")
    # Each leg begins where the one before it ends, and the altitude of that fix stands there.
    for k, before in zip(path.legs, path.begins_m, strict=True):
        leg = procedure.legs[k - 1]
        lowest = _lowest_m(leg) if k > 0 else None
        short = math.nan if lowest is None else lowest - float(path.altitude_m([before])[0])
        if lowest is not None and short > CONSTRAINT_M:
            below, coded = (f"{value / METRES_PER_FT:.0f} ft" for value in (short, lowest))
            words.append(f"It passes {leg.fix} {below} below its lowest coded altitude, {coded}.")
    return words


def _lowest_m(leg: Leg) -> float | None:
    """Lowest altitude that is coded at the end of a leg. [m]."""
    match leg.altitude_description:
        case "+" | "":
            return leg.altitude_m[0]
        case "B":
            return leg.altitude_m[1]
        case _:
            return None
