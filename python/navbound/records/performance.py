"""The records of a performance evaluation: what the ICAO indicators of a series of errors and protection levels are.

Presentation reads these; it computes nothing. What each number means, and over which epochs, stands in docs/methods/kpi.md.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from navbound.records.base import Record

Axis = Literal["h", "v"]
Provenance = Literal["printed", "re-derived", "standard", "ours", "inferred"]


class Level(Record):
    """What an operation asks of the navigation system."""

    id: str
    """`APV-I`, `LPV-200`, ..."""
    title: str
    hal_m: float
    val_m: float | None
    """None: the operation asks nothing of the vertical."""
    accuracy_h_m: float | None
    """95 %."""
    accuracy_v_m: float | None
    tta_s: float
    """Time to alert: the longest a hazard may last without one."""
    integrity_risk: float | None
    integrity_per: Literal["approach", "hour"] | None
    continuity_risk: float | None
    """The largest that the operation allows."""
    continuity_per: Literal["15 s", "hour"] | None
    source: str
    provenance: dict[str, Provenance]
    """Field to how it is held; `standard`: at least two public texts that the source names agree."""


class Spread(Record):
    """How a quantity is spread over the epochs counted; percentiles by nearest rank. In the unit of the field that holds it."""

    n: int
    mean: float
    rms: float
    p50: float
    p95: float
    p99: float
    p999: float
    max: float
    max_time_ns: int


class AxisResult(Record):
    """Errors, levels and their ratio in one axis, over the same epochs."""

    axis: Axis
    error_m: Spread | None
    """None where truth is not known."""
    level_m: Spread | None
    safety_index: Spread | None
    """Error over protection level."""
    n_potential_mi: int
    """Epochs with 0.75 < safety index <= 1."""
    n_mi: int
    """Epochs with safety index > 1: misleading information."""


class StanfordCounts(Record):
    """Every epoch with a solution and a true error, in exactly one region of the diagram of one axis and one level."""

    axis: Axis
    alert_limit_m: float
    n: int
    n_nominal: int
    """Level below limit, error within level."""
    n_mi: int
    """Level below limit, level < error <= limit."""
    n_hmi: int
    """Level below limit, error beyond limit: hazardous."""
    n_unavailable: int
    """Level at or above limit, error within level."""
    n_unavailable_mi: int
    """Level at or above limit, error beyond level."""


class LevelResult(Record):
    """The four indicators of one level."""

    level: Level
    accuracy_met: bool | None
    """95 % errors within the level's accuracy in every axis it names; None without truth or without a demand."""

    n_expected: int
    n_solution: int
    n_available: int
    availability_expected: float
    """The headline: share of the expected grid."""
    availability_low: float
    availability_high: float
    """Wilson 95 % interval on the effective sample size."""
    n_effective: float
    availability_solution: float | None
    """Share of epochs with a solution."""

    n_continuity_events: int
    """Times the service was available and then was not."""
    window_s: float
    n_window_epochs: int
    window_meaningful: bool
    """False where the sampling period is longer than the window."""
    n_at_risk: int
    """Available epochs with an epoch that is not available within the window after them."""
    continuity_risk: float | None
    """`n_at_risk` over `n_available`; None where nothing was available."""
    events_per_1e5: float | None
    """Continuity events for each 100 000 available epochs."""
    events_per_1e5_low: float | None
    events_per_1e5_high: float | None
    """Exact Poisson 95 % interval."""
    continuity_risk_maritime: float | None
    """900 s times the continuity events over the time expected."""

    truth_known: bool
    """Without truth the integrity figures below are zeros of an empty count, and presentation says so."""
    n_hazard_epochs: int
    n_hazard_events: int
    n_hazard_over_tta: int
    """Those that lasted longer than the time to alert: integrity failures."""
    longest_hazard_s: float
    n_mi_epochs: int
    n_mi_events: int
    n_mi_over_tta: int
    longest_mi_s: float
    stanford: list[StanfordCounts]
    """Horizontal first; vertical where the level has a vertical limit."""
    available: list[AxisResult]
    """The same as the summary's `axes`, over available epochs alone."""


class StanfordBins(Record):
    """Histogram of (error, protection level) of one axis, non-empty bins only. The regions of a level are drawn by its limits."""

    axis: Axis
    variant: Literal["stanford", "stanford-esa"]
    """`stanford-esa`: one point for every subset of satellites instead of one for every epoch."""
    bin_m: float
    limit_m: float
    """Both axes run from 0 to here."""
    n: int
    error_bin: list[int]
    """Bin k is [k bin_m, (k + 1) bin_m); the bin `limit_m / bin_m` collects everything beyond."""
    level_bin: list[int]
    count: list[int]


class ListedSubset(Record):
    """One subset of an epoch's satellites whose safety index is high."""

    time_ns: int
    satellites: list[str]
    """Used."""
    left_out: list[str]
    hpe_m: float
    hpl_m: float
    vpe_m: float
    vpl_m: float | None
    """None where the levels' use has no vertical one."""
    safety_index: float
    """The larger of both axes."""


class Subsets(Record):
    """Every subset of each epoch's satellites, solved: the counts of the Stanford-ESA diagram and its gravest points."""

    n_epochs: int
    """Epochs whose satellites together give a position."""
    n_unsolved: int
    """Epochs whose satellites do not."""
    n_cut: int
    """Epochs with so many satellites that only subsets that leave out a few were looked at."""
    n_subsets: int
    n_singular: int
    """Subsets that determine no position: no points."""
    n_mi: int
    """Subsets whose error is beyond their level in either axis."""
    min_satellites: int
    """Fewest satellites of a subset."""
    max_satellites: int
    """An epoch has at most as many subsets as this many satellites have: 2 to this power."""
    safety_index_h_max: float
    safety_index_v_max: float
    listed_from: float
    """Safety index from which a subset is listed."""
    n_listed: int
    """How many reach it."""
    listed: list[ListedSubset]
    """The gravest of them, at most 500."""
    stanford: dict[str, list[StanfordCounts]]
    """By level id: subsets in the regions; horizontal first, vertical where the level has a vertical limit."""


class KpiSeries(Record):
    """Errors and levels against time: the largest of each bucket of equal duration. NaN never appears: None is "no epoch"."""

    width_ns: int
    start_ns: list[int]
    """Begin of each bucket; buckets without a single expected epoch are not listed."""
    n_expected: list[int]
    n_solution: list[int]
    hpe_max_m: list[float | None]
    vpe_max_m: list[float | None]
    hpl_min_m: list[float | None]
    hpl_max_m: list[float | None]
    vpl_min_m: list[float | None]
    vpl_max_m: list[float | None]
    n_available: dict[str, list[int]]
    """By level id."""
    cause: dict[str, list[str]]
    """By level id: the most frequent cause of unavailable epochs in the bucket, empty where all were available."""


class KpiEvent(Record):
    """A loss of availability, a hazard, or misleading information, from its first epoch to its last."""

    level: str
    kind: Literal["loss", "hazard", "mi"]
    onset_ns: int
    """First epoch of the condition."""
    clear_ns: int | None
    """First epoch without it; None where the data end first."""
    n_epochs: int
    duration_s: float
    over_tta: bool | None
    """Longer than the time to alert; None for a loss."""
    cause: str
    """Of a loss: `no epoch`, `no solution`, `no vertical level`, `hpl`, `vpl`, `hpl and vpl`; empty otherwise."""
    reason: str
    """What the table's `reason`, `mode` and `n_sv` say about the onset, in words; empty where they say nothing."""
    hpe_max_m: float | None
    vpe_max_m: float | None
    hpl_max_m: float | None
    vpl_max_m: float | None
    """Extremes while it lasted."""
    n_sv_before: int | None
    n_sv_onset: int | None
    mode_before: str | None
    mode_onset: str | None


class DayResult(Record):
    """One GPS day."""

    start_ns: int
    n_expected: int
    n_solution: int
    n_available: dict[str, int]
    """By level id."""


class MessageCount(Record):
    """Messages of one type."""

    type: int
    what: str
    n: int
    longest_gap_s: float | None
    """Between two of them; None where there is one."""
    time_out_s: int | None
    """How long its data may be used on a precision approach; None where no time-out is declared."""
    n_time_outs: int
    """Gaps between two of them that are longer."""


class UdreHistory(Record):
    """The UDRE indicators of a satellite."""

    sv: str
    worst: list[int | None]
    """The largest of each bin: 14 is not monitored, 15 is not to be used; None where none was sent."""


class GridPoint(Record):
    """The GIVE of a point of the ionospheric grid over time."""

    lat_rad: float
    lon_rad: float
    states: str
    """One sign a bin, at its end: `0` to `9` and `A` to `E` the GIVE indicator 0 to 14, `F` not monitored (15), `X` not to be used, `.`
    not sent or older than its time-out."""


class ServiceLog(Record):
    """The messages of one geostationary satellite over the epochs of a run."""

    prn: int
    first_ns: int
    last_ns: int
    n_messages: int
    n_missing: int
    """Whole seconds between the first and the last message in which none ended: one a second is sent."""
    longest_silence_s: float
    types: list[MessageCount]
    bin_ns: int
    """Width of the bins, which begin at `first_ns`."""
    udre: list[UdreHistory]
    """Of satellites of the mask that were monitored at some time."""
    give: list[list[int]]
    """Of each bin how many points of the grid mask had each GIVE indicator, 0 to 15, at its end; those not to be used count with 15, those
    that were too old as none."""
    n_points: int
    """Points of the grid masks at the end."""
    grid: list[GridPoint] = Field(default=[])
    """Points that were in a mask at the end of a bin. Empty in a record that was written before there was one."""
    words: list[str]


class Performance(Record):
    """What the ICAO indicators of one receiver's series are."""

    title: str
    truth_known: bool
    period_s: float
    first_ns: int
    last_ns: int
    exclude_missing: bool
    """The grid holds only the epochs that are there."""
    n_expected: int
    n_missing: int
    n_no_solution: int
    n_solution: int
    n_repeated: int
    """Rows that share an epoch of the grid with another; of each epoch the worst row counts."""
    n_mi_epochs: int
    """Epochs with a solution and misleading information in either axis."""
    axes: list[AxisResult]
    """Horizontal, vertical; over epochs with a solution."""
    levels: list[LevelResult]
    stanford: list[StanfordBins]
    series: KpiSeries
    n_events: dict[str, int]
    """By kind, over all levels."""
    events: list[KpiEvent]
    """Hazards and misleading information first, then losses, longest first; at most 500 of all in events.parquet."""
    days: list[DayResult]
    subsets: Subsets | None
    """Where the Stanford-ESA diagram was requested."""
    experimental: str
    """Words that must stand beside every number of an experimental level; empty for integrity levels."""
    notes: list[str]
    service: ServiceLog | None = None
    """Where SBAS messages corrected the positions: what they were."""
