"""The example's station with ranges as they would be at another place."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from navbound import gnss

if TYPE_CHECKING:
    from collections.abc import Callable

EXAMPLES = Path(__file__).parents[1] / "examples" / "data"
OBSERVATIONS, NAVIGATION = EXAMPLES / "station.rnx", EXAMPLES / "broadcast.rnx"
ORBIT_M = 2.2e7
"""About the distance of a satellite: from a place 5 km off the way to one is 0.6 m longer than its tangent plane says. [m]"""


def led_off(folder: Path, east_m: Callable[[int, str], float], phase_share: float = 0.0) -> Path:
    """The station with its codes as they would be east of it by a way of the epoch and the constellation, its phases by a share of that."""
    observations = gnss.read_observations(OBSERVATIONS)
    ranges = gnss.solve(observations, gnss.read_navigation([NAVIGATION]), systems="GE", keep_ranges=True, mask_rad=0.0).ranges
    assert ranges is not None
    sights = {(t, sv): (az, el) for t, sv, az, el in ranges.select("time_ns", "sv", "az_rad", "el_rad").iter_rows()}
    lines, epoch, body = [], -1, False
    for line in OBSERVATIONS.read_text(encoding="ascii").splitlines():
        changed = line
        if body and line.startswith(">"):
            epoch += 1
        elif body:
            azimuth, elevation = sights.get((int(observations.time_ns[epoch]), line[:3]), (math.nan, math.nan))
            way_m = east_m(epoch, line[0])
            along_m = way_m * math.sin(azimuth) * math.cos(elevation)
            changed = _moved(line, -along_m + (way_m**2 - along_m**2) / (2.0 * ORBIT_M), phase_share)
        body |= "END OF HEADER" in line
        lines.append(changed)
    path = folder / "station.rnx"
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def _moved(line: str, by_m: float, phase_share: float) -> str:
    """Both codes of a satellite's line longer, and its phases by a share of it; nothing where its direction is not known."""
    if math.isnan(by_m):
        return line
    fields = [line[at : at + 16] for at in range(3, len(line), 16)]
    # Of each of two bands: code [m], phase [cycles], Doppler, strength. L1 and E1; L2 of GPS, E5a of Galileo.
    second_hz = 1227.6e6 if line[0] == "G" else 1176.45e6
    factors = [1.0, phase_share * 1575.42e6 / 299792458.0, 0.0, 0.0, 1.0, phase_share * second_hz / 299792458.0, 0.0, 0.0]
    return line[:3] + "".join(
        f"{float(f[:14]) + by_m * k:14.3f}{f[14:]}" if f[:14].strip() else f for f, k in zip(fields, factors, strict=True)
    )
