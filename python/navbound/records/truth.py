"""What speaks against a truth that a recording is compared with."""

from __future__ import annotations

from dataclasses import dataclass

from navbound.time import utc_text
from navbound.words.plurals import counted

_NAMED = 3
"""Jumps whose times are named. [1]"""


@dataclass(frozen=True)
class TruthDoubts:
    """What speaks against a truth.

    Attributes
    ----------
    n_jumping : int
        Epochs whose truth is not used since it contradicts its own motion.
    jumps_ns : tuple of int
        GPS times at which it jumps. [ns]
    n_standing : int
        Epochs whose truth is not used since it stands while the positions travel.
    travelled_m : float
        The longest way between two such positions. [m]
    n_invalid : int
        Epochs whose truth is not used since its own recording says that it is not valid.
    n_imprecise : int
        Epochs whose truth is not used since its own standard deviation is no smaller than that of the position.
    """

    n_jumping: int = 0
    jumps_ns: tuple[int, ...] = ()
    n_standing: int = 0
    travelled_m: float = 0.0
    n_invalid: int = 0
    n_imprecise: int = 0

    def __add__(self, other: TruthDoubts) -> TruthDoubts:
        """Of two parts of the same epochs."""
        jumps = tuple(sorted({*self.jumps_ns, *other.jumps_ns}))
        standing, travelled_m = self.n_standing + other.n_standing, max(self.travelled_m, other.travelled_m)
        stated = (self.n_invalid + other.n_invalid, self.n_imprecise + other.n_imprecise)
        return TruthDoubts(self.n_jumping + other.n_jumping, jumps, standing, travelled_m, *stated)

    @property
    def n(self) -> int:
        """Epochs whose truth is not used."""
        return self.n_jumping + self.n_standing + self.n_invalid + self.n_imprecise

    @property
    def words(self) -> str:
        """The same in sentences; empty where nothing does."""
        sentences = []
        if self.n_jumping:
            times = ", ".join(f"{utc_text(time_ns)} UTC" for time_ns in self.jumps_ns[:_NAMED])
            more = f" and {counted(len(self.jumps_ns) - _NAMED, 'more time')}" if len(self.jumps_ns) > _NAMED else ""
            sentences.append(
                f"Truth is not believable at {counted(self.n_jumping, 'epoch')} and is not used there: it jumps at {times}{more}, to "
                "places "
                "that cannot have been reached from those before. Only a part that agrees with itself over three quarters of a track is "
                "a reference."
            )
        if self.n_standing:
            sentences.append(
                f"Truth is not believable at {counted(self.n_standing, 'epoch')} and is not used there: it stands still while the "
                "positions travel "
                f"up to {self.travelled_m:.0f} m on a steady course, by more than their bounds allow. It is the truth of another receiver, "
                "the positions are wrong, or its columns are in other units: what is declared of a column holds in both files unless "
                "it is declared of the truth alone (truth_lat_rad, truth_lon_rad)."
            )
        if self.n_invalid:
            sentences.append(
                f"Truth is not used at {counted(self.n_invalid, 'epoch')}, at which its own recording states that it is not valid."
            )
        if self.n_imprecise:
            sentences.append(
                f"Truth is not used at {counted(self.n_imprecise, 'epoch')}, at which its own standard deviation is no smaller than "
                "that of the "
                "position."
            )
        return " ".join(sentences)
