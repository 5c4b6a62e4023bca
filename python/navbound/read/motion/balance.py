"""Whether the way that speeds say is travelled at last: what holds and slow lags take away from it is within every limit of its own."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from navbound import _core

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from navbound.read.motion.ways import Minutes

_FAST_MPS, _STRAIGHT, _LACK_M, _LACK_SHARE = _core.LIVE_BALANCE
"""From which speed a way counts, how straight it must be, what it may lack in all, and the share of the way by the speeds that it may lack
more: the rule of live feeds, whose crate has the reasons. [m/s, 1, m, 1]"""


@dataclass
class Balance:
    """The way of the positions, and that by the speeds, track by track, over windows in which the aircraft is fast. [m]."""

    ways: dict[str, tuple[float, float]] = field(default_factory=dict)

    def count(self, windows: Minutes, apart_m: NDArray[np.float64], way_m: NDArray[np.float64], by_speed_m: NDArray[np.float64]) -> None:
        """The next windows."""
        fast = (by_speed_m >= _FAST_MPS * windows.length_s) & (apart_m >= _STRAIGHT * way_m)
        for track, is_fast, way, by_speed in zip(windows.tracks, fast.tolist(), way_m.tolist(), by_speed_m.tolist(), strict=True):
            if is_fast:
                before = self.ways.get(track, (0.0, 0.0))
                self.ways[track] = (before[0] + way, before[1] + by_speed)

    def words(self) -> str | None:
        """A doubt, where the positions of a track are behind the way by its speeds in all; of the track that lacks most."""
        lacking = {name: by_speed - way for name, (way, by_speed) in self.ways.items() if by_speed - way > _LACK_M + _LACK_SHARE * by_speed}
        if not lacking:
            return None
        name = max(lacking, key=lambda each: lacking[each])
        return (
            f"The positions fall behind the recording's own speeds by {lacking[name]:.0f} m in all, on a way of {self.ways[name][1]:.0f} m "
            f"(track {name}, {len(lacking)} of {len(self.ways)} tracks): positions are held or late and never catch up, or the speeds are "
            "not over the ground"
        )
