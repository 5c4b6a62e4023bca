"""What a simulator or a reader hands to the judging stage: the epoch table up to path and error, and its context.

The judging stage (judge.py) does not ask whether the epochs were flown or recorded.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import polars as pl

from navbound.records.truth import TruthDoubts

if TYPE_CHECKING:
    from navbound.records.procedure import BesideProcedure, ProcedureFlown
    from navbound.records.run import CovarianceOrigin, CrossTrack, EventSummary, InputFile, Rejection, Waypoint
    from navbound.storage.frames import Frames

LEFT_OUT = {"track": pl.String, "time_ns": pl.Int64}
"""Rows of a recording that cannot be judged, and ends of procedures that were due: which track, and when (null where nobody knows)."""

Operation = Literal["en-route", "approach", "ground"]
"""What kind of operation is flown: nobody works it out from the size of a requirement. ``ground``: landing roll and taxiing, where
requirements are metres and what is about flight says nothing."""


@dataclass(frozen=True)
class Scatter:
    """How far recorded positions scatter along their way, on the track that does so most.

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


@dataclass(frozen=True)
class Material:
    """Epochs and their context.

    Attributes
    ----------
    epochs : DataFrame
        Columns of docs/notation.md: at least ``track``, ``time_ns``, ``est_lat_rad``, ``est_lon_rad``, ``course_rad``, ``fte_m``,
        ``rnp_m``, ``cov_ee_m2``, ``cov_en_m2``, ``cov_nn_m2``, ``status``; with truth also ``nse_e_m``, ``nse_n_m``, ``nse_u_m``.
    kind : {"fly", "analyze"}
        Which command made it.
    title : str
        Heading of the report.
    requirement : str
        The navigation specification, in words ("RNP 0.3", "RNP by phase of flight").
    sample_period_s : float
        Nominal time between epochs of one track.
    assumptions : list of str
        Sentences for the verdict: where the covariance came from, what was not modelled.
    operation : {"en-route", "approach", "ground"}
        What is flown, as the scenario or the caller states it.
    labels : dict
        Track to a label a person recognises.
    events : list of EventSummary
        Points of the flight besides the monitor's alerts.
    covariance : CovarianceOrigin
        Where the covariance comes from.
    left_out : DataFrame
        ``track`` and ``time_ns`` of recorded rows that cannot be judged and are no epochs: they are expected all the same.
    n_approaches, n_unjudged_approaches : int
        Approaches to runways, and passes along a runway's centreline that are none and are not judged.
    n_tracks_elsewhere : int
        Tracks without an approach to these runways.
    beside : BesideProcedure, optional
        What a procedure does not judge of the recording.
    frames : Frames, optional
        The epochs of a table that is too large for memory, in pieces on the disk; `epochs` is then without rows.
    with_levels : set of str
        Tracks with a protection level anywhere, where the epochs are in pieces.
    unread : list of str
        Columns, or words of columns, that speak of integrity by their name and are not understood.
    set_aside : list of str
        Quantities that the user declares no column to be read as.
    position_doubts : list of str
        Why the positions may not be what they are read as (their unit, their motion), so that nothing can be shown.
    scatter : Scatter, optional
        How far the positions scatter along their way by their own speeds, which no covariance of a table holds.
    truth_doubts : TruthDoubts
        What speaks against the truth.
    satellites : DataFrame, optional
        What became of every satellite heard, epoch by epoch (columns `navbound.table.columns.HEARD`), where positions were solved.
    limits_held : dict
        Phase to how its alert limit is held ("inferred", ...), where epochs have ``hpl_m`` and ``hal_m``.
    """

    epochs: pl.DataFrame
    kind: Literal["fly", "analyze"]
    title: str
    requirement: str
    sample_period_s: float
    assumptions: list[str]
    covariance: CovarianceOrigin
    operation: Operation = "en-route"
    labels: dict[str, str] = field(default_factory=dict)
    waypoints: list[Waypoint] = field(default_factory=list)
    inputs: list[InputFile] = field(default_factory=list)
    rejected: list[Rejection] = field(default_factory=list)
    cross_track: list[CrossTrack] = field(default_factory=list)
    procedures: list[ProcedureFlown] = field(default_factory=list)
    scenario: dict[str, object] | None = None
    seed: int | None = None
    settings: dict[str, object] = field(default_factory=dict)
    events: list[EventSummary] = field(default_factory=list)
    limits_held: dict[str, str] = field(default_factory=dict)
    left_out: pl.DataFrame = field(default_factory=lambda: pl.DataFrame(schema=LEFT_OUT))
    n_approaches: int = 0
    n_unjudged_approaches: int = 0
    n_tracks_elsewhere: int = 0
    beside: BesideProcedure | None = None
    frames: Frames | None = None
    with_levels: frozenset[str] = frozenset()
    unread: list[str] = field(default_factory=list)
    set_aside: list[str] = field(default_factory=list)
    position_doubts: list[str] = field(default_factory=list)
    scatter: Scatter | None = None
    truth_doubts: TruthDoubts = field(default_factory=TruthDoubts)
    satellites: pl.DataFrame | None = None
