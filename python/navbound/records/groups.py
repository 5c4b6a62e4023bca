"""What a run says of its groups: the satellites that were heard, the approaches to a runway, the flights of an operator."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from navbound.records.base import Record


class SatelliteSummary(Record):
    """One satellite over the positions that were solved."""

    track: str
    sv: str
    n_heard: int
    """Epochs at which a measurement of it was received."""
    n_used: int
    n_fate: dict[str, int] = Field(default_factory=dict)
    """Epochs at which it was not used, by the id of what became of it (`navbound.gnss.FATES`), the most frequent first."""
    el_max_rad: float | None
    residual_rms_m: float | None
    residual_most_m: float | None
    """The residual of the largest size, signed."""
    cn0_mean_dbhz: float | None
    cn0_min_dbhz: float | None


class DeviationGroup(Record):
    """Deviation of all approaches of a group."""

    by: Literal["runway", "operator"]
    name: str
    n_tracks: int
    n_epochs: int
    mean_m: float
    std_m: float
    abs95_m: float
    """95 % of the sizes are no larger."""
    most_m: float
    """The deviation of the largest size, signed."""
    most_track: str
    """Whose it is."""
    share_inside: float | None
    """Of epochs with status ok."""
    worst_ratio: float | None
    """Largest accuracy bound over RNP."""


class DeviationBand(Record):
    """Where the approaches to one runway lay, by distance to its threshold."""

    runway: str
    column: Literal["fte_m", "fte_v_m", "est_h_m"]
    """What is compared: deviation across or above the path, or the height where no vertical path is known."""
    n_tracks: int
    before_m: list[float]
    """Middles of the bins, before the threshold."""
    n: list[int]
    """Epochs in each bin."""
    least_m: list[float | None]
    low_m: list[float | None]
    """2.5 % lie below; none where fewer than 40 epochs lie in the bin."""
    median_m: list[float | None]
    high_m: list[float | None]
    """2.5 % lie above."""
    most_m: list[float | None]
    edges_m: list[float] = Field(default_factory=list)
    """Of the histogram; empty for heights."""
    counts: list[int] = Field(default_factory=list)
    """Epochs between two edges; those beyond the first and the last are in the outer bins."""
