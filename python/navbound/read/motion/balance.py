"""Whether the way that speeds say is travelled at last: what holds and slow lags take away from it is within every limit of its own."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from navbound import _core

if TYPE_CHECKING:
    import polars as pl


@dataclass
class Balance:
    """The way of the positions, and that by the speeds, track by track, by the rule of live feeds (`core::monitor::balance`)."""

    tracks: dict[str, _core.TrackBalance] = field(default_factory=dict)

    def see(self, rows: pl.DataFrame) -> None:
        """The next rows, in the order of track and time, with the speeds that they state themselves."""
        for group in rows.partition_by("track", maintain_order=True):
            balance = self.tracks.setdefault(group["track"][0], _core.TrackBalance())
            balance.see(*(group[name].to_numpy() for name in ("time_ns", "est_lat_rad", "est_lon_rad", "_speed")))

    def words(self) -> str | None:
        """A doubt, where the positions of a track are behind the way by its speeds in all; of the track that lacks most."""
        lacking = {name: behind for name, each in self.tracks.items() if (behind := each.behind_m()) is not None}
        if not lacking:
            return None
        name = max(lacking, key=lambda each: lacking[each][0])
        lack_m, way_m = lacking[name]
        return (
            f"The positions fall behind the recording's own speeds by {lack_m:.0f} m in all, on a way of {way_m:.0f} m "
            f"(track {name}, {len(lacking)} of {len(self.tracks)} tracks): positions are held or late and never catch up, or the speeds "
            "are not over the ground"
        )
