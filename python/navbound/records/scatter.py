"""How far recorded positions scatter along their way."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Scatter:
    """Of the track that scatters most.

    Attributes
    ----------
    track : str
        Which.
    along_m : float
        The way from one position to the next less that of the track's own speeds: what 95 % of the steps leave beside turns, rounding
        and the covariances, divided by the root of two, as both ends scatter. [m]
    n : int
        Steps that were compared.
    """

    track: str
    along_m: float
    n: int
