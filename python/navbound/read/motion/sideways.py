"""Whether positions drift aside of the way that tracks lead, slowly enough to be within the limits of each minute."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from navbound.read.columns.column import NO_COLUMN
from navbound.read.columns.naming import declare
from navbound.read.motion.ways import OFFSET_M
from navbound.words.plurals import counted

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import NDArray

    from navbound.read.motion.ways import Minutes

_DRIFT_M = 2000.0
"""What the positions of a track may drift aside of its reported track beyond the shares below, over any minutes on end: 0.7 km at most in
949 shared tracks that are right. Provenance: ours. [m]"""
_SHARE = 0.02
"""Share of the way that they may drift aside: a track that is a degree off, and the sphere that ways lie on. Provenance: ours. [1]"""
_ROUNDED = 0.01
"""The same beside what the track is rounded to. Provenance: ours. [1]"""
_MPS = 0.3
"""Drift of a track that is computed of velocities in whole knots. Provenance: ours. [m/s]"""
_GRIDS_DEG = (0.0, 1.0, 360.0 / 256.0, 360.0 / 128.0)
"""What tracks are rounded to, or cut: nothing, whole degrees, a byte, and seven bits of it. [deg]"""
_ON_GRID_DEG = 0.06
"""Multiples of these have decimals of their own. Provenance: ours. [deg]"""
_STRAIGHT = 0.99
"""Share of the way of a minute by its speeds that lies between its ends where it is compared: in turns a lag of the positions is aside.
Provenance: ours. [1]"""


@dataclass
class _Drift:
    """Of minutes on end: by how much positions drifted aside beyond what they may, how far in all, on which way, and how noisy they are."""

    beyond_m: float = 0.0
    aside_m: float = 0.0
    way_m: float = 0.0
    n: int = 0
    noise_m: float = 0.0

    def see(self, aside_m: float, allowed_m: float, way_m: float, noise_m: float) -> None:
        """The next minute; what went the other way ends it."""
        beyond_m = self.beyond_m + aside_m - allowed_m
        if not beyond_m > 0.0:
            self.beyond_m, self.aside_m, self.way_m, self.n, self.noise_m = 0.0, 0.0, 0.0, 0, 0.0
            return
        self.beyond_m, self.aside_m, self.way_m, self.n = beyond_m, self.aside_m + aside_m, self.way_m + way_m, self.n + 1
        self.noise_m = max(self.noise_m, noise_m)

    def over_m(self) -> float:
        """By how much more than positions that are right drift."""
        return self.beyond_m - _DRIFT_M - self.noise_m * max(1.0, 0.5 * math.sqrt(self.n))


@dataclass
class _Track:
    """The drifts of a track to either side by each grid that its courses may have, and the worst of each: over, aside, way, minutes."""

    drifts: list[tuple[_Drift, _Drift]] = field(default_factory=lambda: [(_Drift(), _Drift()) for _ in _GRIDS_DEG])
    worst: list[tuple[float, float, float, int]] = field(default_factory=lambda: [(-math.inf, 0.0, 0.0, 0) for _ in _GRIDS_DEG])
    on_grid: list[bool] = field(default_factory=lambda: [True for _ in _GRIDS_DEG])
    whole_degrees: bool = True
    begun: bool = False

    def see_minute(self, aside_m: float, way_m: float, length_s: float, noise_m: float) -> None:
        """The next minute, the way by its speeds, and the noise of its ends."""
        least_m = _SHARE * way_m + _MPS * length_s
        if abs(aside_m) <= least_m and not self.begun:
            return
        self.begun = False
        for k, (grid_deg, sides) in enumerate(zip(_GRIDS_DEG, self.drifts, strict=True)):
            allowed_m = max(_SHARE, _ROUNDED + math.radians(grid_deg)) * way_m + _MPS * length_s
            for drift, sign in zip(sides, (1.0, -1.0), strict=True):
                drift.see(sign * aside_m, allowed_m, way_m, noise_m)
                self.begun |= drift.n > 0
                self.worst[k] = max(self.worst[k], (drift.over_m(), drift.aside_m, drift.way_m, drift.n))

    def of_all(self) -> tuple[float, float, float, int]:
        """The worst drift by the coarsest grid that all courses of the track are on."""
        # One course, or a few round ones, are on every grid.
        coarsest = 1 if self.whole_degrees else len(_GRIDS_DEG) - 1
        return self.worst[max(k for k in range(coarsest + 1) if self.on_grid[k])]


class Sideways:
    """How far positions drift aside of the reported track, track by track, over straight minutes that are within the limit of each.

    A cumulative sum that begins anew where nothing is left: a drift shows however long the flight before it was right.
    """

    def __init__(self) -> None:
        self._tracks = defaultdict[str, _Track](_Track)

    def see(self, rows: pl.DataFrame) -> None:
        """Which grids the courses of the next rows are on."""
        for group in rows.partition_by("track", maintain_order=True):
            track = self._tracks[group["track"][0]]
            course = np.degrees(group["_whither"].to_numpy())
            course = course[np.isfinite(course)]
            track.whole_degrees &= _all_on(course, 1.0)
            track.on_grid = [
                grid == 0.0 or (so_far and _all_on(course, grid)) for grid, so_far in zip(_GRIDS_DEG, track.on_grid, strict=True)
            ]

    def count(self, minutes: Minutes, whither_m: NDArray[np.float64], by_speed_m: NDArray[np.float64], within: NDArray[np.bool_]) -> None:
        """The next minutes, where they lead by speed and track, and which of them are within the limits of their own."""
        lead_m = np.hypot(*whither_m.T)
        with np.errstate(invalid="ignore", divide="ignore"):
            east, north = (whither_m / lead_m[:, None]).T
        aside_m = minutes.apart_en_m[:, 0] * north - minutes.apart_en_m[:, 1] * east
        judged = within & (lead_m >= _STRAIGHT * by_speed_m) & (lead_m > 0.0) & np.isfinite(aside_m)
        noise_m = minutes.margin_m - OFFSET_M
        columns = (each.tolist() for each in (judged, aside_m, by_speed_m, minutes.length_s, noise_m))
        for track, is_judged, *numbers in zip(minutes.tracks, *columns, strict=True):
            if is_judged:
                self._tracks[track].see_minute(*numbers)

    def words(self) -> str | None:
        """A doubt, where the positions of a track drift aside; of the track that does so most."""
        drifts = {name: worst for name, each in self._tracks.items() if (worst := each.of_all())[0] > 0.0}
        if not drifts:
            return None
        name = max(drifts, key=lambda each: drifts[each])
        _, aside_m, way_m, n = drifts[name]
        return (
            f"The positions drift aside of the recording's own tracks by {aside_m:.0f} m in {counted(n, 'minute')}, on a way of "
            f"{way_m:.0f} m (track {name}, {len(drifts)} of {counted(len(self._tracks), 'track')}): the positions are led off, or a "
            f"column, such as that of the track, is not what it is read as "
            f"({declare(f'ground_track_rad={NO_COLUMN}')}, to leave the track out)"
        )


def _all_on(course_deg: NDArray[np.float64], grid_deg: float) -> bool:
    """Whether all courses are multiples."""
    if grid_deg == 0.0:
        return True
    return bool((np.abs(course_deg - grid_deg * np.round(course_deg / grid_deg)) <= _ON_GRID_DEG).all())
