"""How many minutes of a track contradict, and whether they are enough to doubt it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from navbound.read.motion.ways import WINDOW_S
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.read.motion.ways import Minutes

_LEAST, _LEAST_SHARE = 3, 0.2
"""Minutes of a track, and share of them, that must contradict. Provenance: ours."""
_OF_SHORT = 0.6
"""Share of a recording of fewer minutes that must: a part of a minute shows less than it. Provenance: ours. [1]"""
_WHOLE_S = 45.0
"""A window from this length on is a minute. Provenance: ours. [s]"""
_RUN = 5
"""Minutes on end that must contradict where the share is smaller. Provenance: ours."""
_MOST_EXCESS_M, _EXCESS_M = 20_000.0, 100.0
"""What the displacements of a track may go beyond their margins in all, and for each window more: the largest of tracks that are right are
11 km in 14 windows (repeated speeds, Paris) and 3.5 km in 66 (Switzerland). Provenance: ours. [m]"""


@dataclass
class Compared:
    """Minutes of one track that were compared, that contradict, as many of these on end as there are, gross ones, and by how much."""

    minutes: float = 0.0
    false: float = 0.0
    run: float = 0.0
    longest: float = 0.0
    gross: float = 0.0
    excess_m: float = 0.0
    worst: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def count(self, minutes: float, *, false: bool, gross: bool, excess_m: float, worst: tuple[float, float, float]) -> None:
        """The next window; of a false one how far it is off, and its lengths."""
        self.minutes += minutes
        self.false += minutes * false
        self.run = self.run + minutes if false else 0.0
        self.longest = max(self.longest, self.run)
        self.gross += minutes * gross
        self.excess_m += max(0.0, excess_m)
        if false and worst[0] > self.worst[0]:
            self.worst = worst

    def contradict(self) -> bool:
        """Whether they are enough to doubt the track."""
        often = self.false >= _LEAST and (self.false >= _LEAST_SHARE * self.minutes or self.longest >= _RUN)
        return often or self.gross >= _LEAST or self.excess_m > _MOST_EXCESS_M + _EXCESS_M * self.minutes


@dataclass
class Comparison:
    """One comparison, track by track: many that agree hide none that does not. Of the second length the first is such a share."""

    expected: float = 1.0
    tracks: dict[str, Compared] = field(default_factory=dict)

    @property
    def worst(self) -> tuple[float, float]:
        """The lengths that are furthest off."""
        return max((each.worst for each in self.tracks.values()), default=(0.0, 0.0, 0.0))[1:]

    def count(
        self,
        windows: Minutes,
        false: NDArray[np.bool_],
        lengths_m: NDArray[np.float64],
        *,
        gross: NDArray[np.bool_] | None = None,
        beyond_m: NDArray[np.float64] | None = None,
    ) -> None:
        """The next windows."""
        none = np.zeros(len(windows.tracks))
        further = (each.tolist() for each in (false, none > 0 if gross is None else gross, none if beyond_m is None else beyond_m))
        minutes = np.where(windows.length_s >= _WHOLE_S, 1.0, windows.length_s / WINDOW_S).tolist()
        off_m = np.abs(lengths_m[:, 0] - self.expected * lengths_m[:, 1])
        worst = zip(off_m.tolist(), *lengths_m.T.tolist(), strict=True)
        for track, length, is_false, is_gross, excess_m, lengths in zip(windows.tracks, minutes, *further, worst, strict=True):
            self.tracks.setdefault(track, Compared()).count(length, false=is_false, gross=is_gross, excess_m=excess_m, worst=lengths)

    def of(self) -> str | None:
        """How many minutes contradict, in words; None where they are too few."""
        minutes, of_these = (sum(getattr(each, name) for each in self.tracks.values()) for name in ("minutes", "false"))
        false = [name for name, each in self.tracks.items() if each.contradict()]
        short = of_these > 0.5 and of_these >= _OF_SHORT * minutes and minutes < _LEAST
        if not false and not (short or (of_these >= _LEAST and of_these >= _LEAST_SHARE * minutes)):
            return None
        which = f" ({len(false)} of {len(self.tracks)} tracks, {false[0]} the first of them)" if false and len(self.tracks) > 1 else ""
        return f"in {of_these:.0f} of {counted(round(minutes), 'minute')}{which}"


def best_of(comparisons: list[Comparison]) -> Comparison:
    """Of several readings of the same windows the one that contradicts each track least."""
    best = Comparison(comparisons[0].expected)
    for name in comparisons[0].tracks:
        best.tracks[name] = min(
            (each.tracks[name] for each in comparisons), key=lambda each: (each.contradict(), each.false, each.excess_m)
        )
    return best
