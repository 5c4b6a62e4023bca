"""The obstacle clearance surface of RNP AR: the vertical error budget below the path at two heights, and a plane through both."""

from __future__ import annotations

import math
from typing import NamedTuple

from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.units import METRES_PER_FT
from navbound.vertical.budgets import budget
from navbound.vertical.heights import isa_deviation, true_height

LOW_M = {"feet": 250.0 * METRES_PER_FT, "metres": 75.0}
"""Height above the threshold of the lower of the two points: 250 ft (printed), 75 m (inferred). [m]"""


class Surface(NamedTuple):
    """A plane below the final approach that no obstacle may reach.

    Attributes
    ----------
    slope_ratio : float
        Distance along the ground for a unit of height. [1]
    origin_m : float
        Distance before the threshold at which it leaves the threshold's elevation. [m]
    low_m, roc_low_m : float
        Height of the path above the threshold at the lower point, and the obstacle clearance there: the budget. [m]
    roc_fix_m : float
        Obstacle clearance at the final approach fix. [m]
    threshold_m : float
        Elevation of the threshold. [m]
    """

    slope_ratio: float
    origin_m: float
    low_m: float
    roc_low_m: float
    roc_fix_m: float
    threshold_m: float

    def altitude_m(self, distance_m: float) -> float:
        """Altitude of the surface before the threshold; that of the threshold itself before it begins.

        Parameters
        ----------
        distance_m : float
            Distance before the threshold. [m]
        """
        return self.threshold_m + max(0.0, (distance_m - self.origin_m) / self.slope_ratio)


@checked
def obstacle_surface(
    rnp_m: float,
    angle_rad: float,
    fix_altitude_m: float,
    threshold_m: float,
    *,
    crossing_height_m: float,
    temperature_k: float | None = None,
    constants: str = "feet",
) -> Surface:
    """The obstacle clearance surface of an RNP AR approach (FAA Order 8260.52, appendix 1, printed; one denominator inferred).

    ``slope = ((Hf - LTP - 250)/tan a) / (Hf - LTP - 250 - (ROCf - ROC250))``, ``origin = (250 - TCH)/tan a - (250 - ROC250) slope``. The
    denominator is damaged in our copy. With this one the surface is the budget below the path at both heights, which no other form gives.

    Parameters
    ----------
    rnp_m : float
        RNP of the final approach. [m]
    angle_rad : float
        Vertical path angle, positive for a descent. [rad]
    fix_altitude_m, threshold_m : float
        Altitude at the final approach fix, and elevation of the threshold. [m]
    crossing_height_m : float
        Height of the path above the threshold. [m]
    temperature_k : float, optional
        Lowest temperature at the threshold; without it the standard one. [K]
    constants : {"feet", "metres"}
        As in :func:`navbound.vertical.budget`; the lower point is 250 ft (printed) or 75 m (inferred) above the threshold.

    Raises
    ------
    InputError
        As :func:`navbound.vertical.budget`; a fix not above the lower point; a budget that leaves no rising surface.
    """
    heights = [LOW_M.get(constants, LOW_M["feet"]), fix_altitude_m - threshold_m]
    deviation = 0.0 if temperature_k is None else float(isa_deviation(threshold_m, temperature_k))
    clearances = []
    for height in heights:
        isad = float(true_height(height, threshold_m, deviation)) - height
        whole = budget(rnp_m, angle_rad, threshold_m + height, threshold_m, isad_m=isad, constants=constants)
        clearances.append(float(whole.veb_m))
    (low, high), (roc_low, roc_fix) = heights, clearances
    if not high > low:
        raise InputError("fix_altitude_m", fix_altitude_m, "m", f"more than {low:g} m above the threshold")
    rise = high - low - (roc_fix - roc_low)
    if not rise > 0.0:
        raise InputError("fix_altitude_m", fix_altitude_m, "m", "heights whose clearance leaves a surface that rises")
    slope = (high - low) / math.tan(angle_rad) / rise
    origin = (low - crossing_height_m) / math.tan(angle_rad) - (low - roc_low) * slope
    return Surface(slope, origin, low, roc_low, roc_fix, threshold_m)
