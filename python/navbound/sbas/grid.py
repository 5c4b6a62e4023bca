"""Where the points of the ionospheric grid are (RTCA DO-229, table of bands; standard)."""

from __future__ import annotations

Points = list[tuple[int, int]]
"""Latitude and longitude. [deg]"""

_POLAR: dict[int, tuple[tuple[int, int, int, int], ...]] = {
    9: ((60, -180, 5, 72), (65, -180, 10, 36), (70, -180, 10, 36), (75, -180, 10, 36), (85, -180, 30, 12)),
    10: ((-60, -180, 5, 72), (-65, -180, 10, 36), (-70, -180, 10, 36), (-75, -180, 10, 36), (-85, -170, 30, 12)),
}
"""Rows of the polar bands: latitude, first longitude, step, points."""


def points(band: int) -> Points:
    """Points of a band in the order of its mask.

    Written once more than in the reader (``crates/core/src/signal/sbas/grid.rs``): tests compare both with the table of the standard.

    Parameters
    ----------
    band : int
        0 to 10.

    Returns
    -------
    list of tuple
        Latitude, longitude; the first is number 1 of the mask. [deg]
    """
    if band in _POLAR:
        return [(lat, first + step * k) for lat, first, step, n in _POLAR[band] for k in range(n)]
    placed: Points = []
    for lon in range(-180 + 40 * band, min(-140 + 40 * band, 180), 5):
        lats = list(range(-55, 60, 5))
        if lon % 10 == 0:
            lats = [-75, -65, *lats, 65, 75]
        lats = [*([-85] if (lon + 140) % 90 == 0 else []), *lats, *([85] if (lon + 180) % 90 == 0 else [])]
        placed += [(lat, lon) for lat in lats]
    return placed
