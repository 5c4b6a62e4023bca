"""Whether positions drift aside of the way that tracks lead, slowly enough to be within the limits of each minute."""

from __future__ import annotations

import itertools
from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.read.columns.column import NO_COLUMN
from navbound.read.columns.naming import declare
from navbound.read.motion.ways import OFFSET_M
from navbound.words.plurals import counted

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import NDArray

    from navbound.read.motion.ways import Minutes


class Sideways:
    """How far positions drift aside of the reported track, track by track, over straight minutes that are within the limit of each.

    By the rule and the numbers of live feeds (`core::monitor::drift`): a cumulative sum that begins anew where nothing is left, so that a
    drift shows however long the flight before it was right.
    """

    def __init__(self) -> None:
        self._tracks = defaultdict[str, _core.TrackDrift](_core.TrackDrift)

    def see(self, rows: pl.DataFrame) -> None:
        """Which grids the courses of the next rows are on."""
        for group in rows.partition_by("track", maintain_order=True):
            self._tracks[group["track"][0]].see_courses(group["_whither"].to_numpy())

    def count(self, minutes: Minutes, whither_m: NDArray[np.float64], by_speed_m: NDArray[np.float64], within: NDArray[np.bool_]) -> None:
        """The next minutes, where they lead by speed and track, and which of them are within the limits of their own."""
        lead_m = np.hypot(*whither_m.T)
        with np.errstate(invalid="ignore", divide="ignore"):
            east, north = (whither_m / lead_m[:, None]).T
        aside_m = minutes.apart_en_m[:, 0] * north - minutes.apart_en_m[:, 1] * east
        judged = within & (lead_m >= _core.DRIFT_STRAIGHT * by_speed_m) & (lead_m > 0.0) & np.isfinite(aside_m)
        noise_m = minutes.margin_m - OFFSET_M
        tracks = [track for track, is_judged in zip(minutes.tracks, judged.tolist(), strict=True) if is_judged]
        columns = [each[judged] for each in (aside_m, by_speed_m, minutes.length_s, noise_m)]
        end = 0
        for track, own in itertools.groupby(tracks):
            begin, end = end, end + len(list(own))
            self._tracks[track].see_minutes(*(each[begin:end] for each in columns))

    def words(self) -> str | None:
        """A doubt, where the positions of a track drift aside; of the track that does so most."""
        drifts = {name: worst for name, each in self._tracks.items() if (worst := each.drifted()) is not None}
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
