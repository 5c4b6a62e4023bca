"""The same ARAIM problem for sidereon (group `oracle`): lines of sight, sigmas and priors of ours in its words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import araim

if TYPE_CHECKING:
    from numpy.typing import NDArray

GPS, GALILEO = 0, 2
BIAS_M, P_SAT, P_CONST = 0.75, 1e-5, {GPS: 1e-4, GALILEO: 1e-4}
URA_M, URE_M = 1.0, 0.66


def arguments(
    sidereon: Any,
    unit_enu: NDArray[np.float64],
    systems: NDArray[np.int64],
    sigma_int_m: NDArray[np.float64],
    sigma_acc_m: NDArray[np.float64],
) -> tuple[Any, Any, Any]:
    """Geometry, integrity support and allocation of LPV-200 for one epoch, every satellite with its own sigmas."""
    named = {GPS: (sidereon.GnssSystem.GPS, "G"), GALILEO: (sidereon.GnssSystem.GALILEO, "E")}
    ids = [f"{named[int(s)][1]}{k + 1:02d}" for k, s in enumerate(systems)]
    # On the equator at Greenwich east, north, up are y, z, x of the Earth's axes.
    lines = unit_enu[:, [2, 0, 1]]
    up = np.arcsin(unit_enu[:, 2])
    rows = [sidereon.AraimRow(ids[k], lines[k], float(up[k]), named[int(s)][0]) for k, s in enumerate(systems)]
    present = [s for s in named if s in systems]
    geometry = sidereon.AraimGeometry(rows, sidereon.Wgs84Geodetic(0.0, 0.0, 0.0), [named[s][0] for s in present])
    default = sidereon.SatelliteIsmModel(URA_M, URE_M, BIAS_M, P_SAT)
    constellations = [sidereon.ConstellationIsm(named[s][0], P_CONST[s], default) for s in present]
    satellites = [
        sidereon.SatelliteIsm(ids[k], URA_M, URE_M, BIAS_M, P_SAT, float(sigma_int_m[k]), float(sigma_acc_m[k])) for k in range(len(ids))
    ]
    return geometry, sidereon.Ism(constellations, satellites), sidereon.IntegrityAllocation.lpv_200()


def ours(
    unit_enu: NDArray[np.float64],
    systems: NDArray[np.int64],
    sigma_int_m: NDArray[np.float64],
    sigma_acc_m: NDArray[np.float64],
    service: araim.Service | str = "lpv-200",
) -> araim.Levels:
    """Our levels of the same problem, of one epoch or of many."""
    p_const = [P_CONST.get(k, 1e-4) for k in range(5)]
    return araim.protection_levels(
        unit_enu, systems, sigma_int_m, sigma_acc_m, bias_m=BIAS_M, bias_continuity_m=0.0, p_sat=P_SAT, p_const=p_const, service=service
    )
