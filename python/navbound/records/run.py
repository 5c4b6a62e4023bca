"""The records a run leaves behind: what summary.json and run.json hold, and what the report shows.

Presentation reads these and the epoch table; it computes nothing. Field names follow docs/notation.md.
"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from navbound.records.base import Record
from navbound.records.faults import FaultSummary
from navbound.records.groups import DeviationBand, DeviationGroup, SatelliteSummary
from navbound.records.material import Operation
from navbound.records.performance import Performance
from navbound.records.procedure import BesideProcedure, ProcedureFlown
from navbound.records.verdict import LEAST_SHARE, BeliefState, VerdictId


class Worst(Record):
    """The epoch with the smallest margin between bound and limit."""

    track: str
    time_ns: int
    margin_m: float
    """Limit minus bound; negative means outside."""
    bound_m: float
    limit_m: float
    phase: str | None
    along_m: float | None
    lat_rad: float
    lon_rad: float


class BoundCheck(Record):
    """One bound against truth, over epochs with status ok."""

    method: str
    risk: float
    n: int
    n_outside: int
    n_effective: float
    """Independent epochs that they are worth: of the navigation error about zero."""
    coverage: float
    coverage_low: float
    coverage_high: float
    """Exact binomial 95 % limits for the effective number."""
    refuted: bool = False
    """Below its claim, and the errors beyond the bounds of its method are too improbable for true ones."""


class LevelCheck(Record):
    """A protection level against truth, over epochs with status ok or degraded."""

    level: Literal["hpl_m", "vpl_m"]
    n: int
    n_above: int
    """Epochs whose error is above the level: misleading information."""
    largest_ratio: float
    """Largest error over its level."""


class Belief(Record):
    """Whether truth supports the bounds that a run states."""

    state: BeliefState
    """`partial`: truth supports the bounds at less than the least share of the epochs. `few`: fewer than 10 independent epochs, which
    contradict nothing and support nothing. `small`: the errors are so much smaller than the covariance states that the truth may not be
    independent of the estimate. `copied`: the truth is the estimate itself; the verdict is not shown. `refuted` withdraws
    the verdict; `contradicted` (a bound beside the lateral ones is false) and `short` leave it not shown."""
    n_epochs: int = 0
    """Epochs that are checked where truth is known: those with status ok, or the degraded ones where none is ok."""
    n_truth: int = 0
    """Of those, epochs with a true horizontal error."""
    n_effective: float
    square_mean: float | None
    """Mean of e' V^-1 e of the horizontal error, each at most 23.03; 2 for a true covariance."""
    p_value: float
    """Largest probability of these data under true bounds, over all tests of `bounds`."""
    bounds: list[BoundCheck]
    """Those that the lateral verdict rests on."""
    beside: list[BoundCheck] = Field(default_factory=list)
    """Every other bound that the run states: vertical, spatial, along the axes of the path."""
    levels: list[LevelCheck] = Field(default_factory=list)
    """Protection levels that the epochs carry."""


class CovarianceOrigin(Record):
    """Where the covariance that the bounds rest on comes from."""

    id: Literal["simulated", "filter", "solved", "file", "file_axes", "epu", "nac_p", "nuc_p", "containment_radius", "typed", "none"]
    sigma_m: float | None = None
    """What the user typed."""
    own_low_m: float | None = None
    own_high_m: float | None = None
    """Least and largest sigma of one axis by the file's own accuracies, where the typed one overrules them."""


class Verdict(Record):
    """Inside or not, in one look."""

    id: VerdictId
    """Decided in run/verdict/rule.py alone."""
    inside: bool | None
    """What the id says of the requirement; None: nothing."""
    words: str
    """The verdict as sentences: what, how much, worst where and when, what was assumed, whether truth was known."""
    sentences: list[str] = Field(default_factory=list)
    """The same one by one: first what, then why, the gravest first; in runs that are older than this field all in one."""
    lead: list[str] = Field(default_factory=list)
    """Those without what a page states beside it: the worst margins, the method that judged, the lateral bounds against truth."""
    requirement: str
    method: str
    """Id of the method that judged, see `methods`."""
    share_inside: float | None
    """Share of judged epochs whose accuracy bound is within RNP."""
    share_contained: float | None
    """Share of judged epochs whose integrity bound is within 2 RNP."""
    n_epochs: int
    """Expected: epochs of the table and those missing in gaps."""
    n_judged: int
    """Epochs with status ok and a bound."""
    n_degraded: int = 0
    """Epochs with status degraded: they may show outside, never inside."""
    n_unjudged: int = 0
    """Epochs of any other kind: without position, covariance or bound, or missing."""
    n_missing: int = 0
    """Of those, epochs that a gap of the table should have held, and recorded rows without a usable time and position."""
    n_absent: int = 0
    """Epochs that the usual step leaves room for in gaps too short to count; expected by nobody."""
    n_approaches: int = 0
    """Approaches to runways that were judged."""
    n_unjudged_approaches: int = 0
    """Passes along a runway's centreline that stray, or end, before they are an approach; none of their epochs is judged."""
    n_tracks_elsewhere: int = 0
    """Tracks of the recording without an approach to the runways; none of their epochs is judged."""
    beside: BesideProcedure | None = None
    """What a procedure does not judge of the recording; None where none was followed."""
    largest_height_error_m: float | None = None
    """Where no vertical bound judges: the largest known error of the heights with status ok; None where one does, or none is known. [m]"""
    n_outside: int = 0
    """Epochs with status ok or degraded whose bound is beyond its limit."""
    n_known_beyond: int = 0
    """Epochs with status ok, a bound within its limit and a known error beyond twice RNP."""
    n_stated_beyond: int = 0
    """Epochs with status ok or degraded where the recording itself states an error beyond RNP."""
    n_stated_alert: int = 0
    """The same where it states an alert."""
    stated_alerts: list[str] = Field(default_factory=list)
    """What it states there, and in which column: the first few."""
    n_stated_worse: int = 0
    """The same where it states a 95 % radius that is larger than its covariance allows."""
    n_stated_uncontained: int = 0
    """The same where it states a containment radius (Rc, NIC) beyond twice RNP, or none."""
    n_reason: dict[str, int] = Field(default_factory=dict)
    """Epochs that are not ok by the id of their reason, the most frequent first."""
    unread: list[str] = Field(default_factory=list)
    """Columns, or words of columns, that speak of integrity by their name and are not understood."""
    position_doubts: list[str] = Field(default_factory=list)
    """Why the positions may not be what they are read as (their unit, their motion); the verdict cannot be "inside" beside one."""
    n_apart: int = 0
    """Positions further from the line between their neighbours than their covariances and any manoeuvre explain."""
    largest_apart_m: float | None = None
    """The largest of these distances."""
    n_without_level: int = 0
    """Judged epochs of tracks with a column of horizontal protection levels that holds none."""
    n_long_steps: int = 0
    """Steps between successive epochs of a track that are longer than a position takes to become stale."""
    longest_step_s: float | None = None
    """The longest of all steps between successive epochs; None where no track has two."""
    least_share: float = LEAST_SHARE
    """Least share of judged epochs for "inside"."""
    assumed: list[Literal["sigma_typed", "sigma_coded", "no_path"]] = Field(default_factory=list)
    """What stands in the first sentence because no data says it."""
    set_aside: list[str] = Field(default_factory=list)
    """Quantities of which the user declares that no column is to be read as them: what they say against the positions is not heard."""
    belief: Belief | None = None
    """None where no epoch has both a bound or level and a true error."""
    n_truth: int = 0
    """Epochs of any status whose true position is known."""
    n_truth_doubted: int = 0
    """Epochs whose truth contradicts itself and is not used."""
    truth_doubts: str = ""
    """What speaks against the truth, with times; empty where nothing does."""
    n_implausible: int
    """Epochs whose input cannot be true (a jump that cannot be flown, a negative variance)."""
    worst_accuracy: Worst | None
    worst_integrity: Worst | None
    truth_known: bool
    experimental: bool = False

    @model_validator(mode="before")
    @classmethod
    def _in_sentences(cls, fields: Any) -> Any:
        """Runs that are older than the lists keep one text of each."""
        if not isinstance(fields, dict):
            return fields
        of_lead = fields.get("lead")
        lists = {"lead": [of_lead] if of_lead else []} if isinstance(of_lead, str) else {}
        return {"sentences": [fields["words"]] if fields.get("words") else [], **fields, **lists}

    def stating(self, sentences: list[str], lead: list[str]) -> Verdict:
        """The same verdict in these sentences."""
        return self.model_copy(update={"words": " ".join(sentences), "sentences": sentences, "lead": lead})


class PhaseSummary(Record):
    """One phase or leg of the flight with one RNP value."""

    phase: str
    rnp_m: float
    n_epochs: int
    duration_s: float
    share_inside: float | None
    """Of epochs with status ok."""
    worst_ratio: float | None
    """Largest accuracy bound over RNP."""
    p_exceed_2rnp_max: float | None
    p_exceed_2rnp_mean: float | None
    """Time average of the risk to leave 2 RNP."""
    coverage: float | None
    """Share of epochs whose |tse| is within the accuracy bound, where truth is known."""
    n_cautions: int
    n_warnings: int


class ProtectionSummary(Record):
    """Protection levels against the alert limit in one phase."""

    phase: str
    hal_m: float
    hal_held: str
    """How the limit is held: printed, re-derived, standard, ours, inferred, given."""
    n_epochs: int
    hpl_max_m: float | None
    hpl_multi_max_m: float | None
    hpe_max_m: float | None
    accuracy_max_m: float | None
    """Largest accuracy (95 %)."""
    accuracy_limit_m: float | None
    share_available: float
    """Share of epochs with a protection level within the limit."""
    n_misleading: int
    """Epochs whose horizontal error is above the protection level, where truth is known."""


class TrackSummary(Record):
    """One flight, approach or aircraft."""

    track: str
    label: str
    n_epochs: int
    start_ns: int
    duration_s: float
    fte_mean_m: float | None
    fte_std_m: float | None
    fte_abs95_m: float | None
    share_inside: float | None
    """Of epochs with status ok."""
    worst_ratio: float | None
    worst_margin_m: float | None
    n_cautions: int
    n_warnings: int
    n_unavailable: int


class MethodResult(Record):
    """One method at one risk: what it is, and how it did."""

    id: str
    title: str
    source: str
    provenance: Literal["printed", "re-derived", "standard", "ours", "inferred"]
    assumes: str
    error_column: str
    may_alert: bool
    risk: float
    n: int
    """Epochs with a bound."""
    mean_m: float | None
    """Sharpness: the mean bound."""
    max_m: float | None
    coverage: float | None
    """Share of epochs whose error is within the bound, where truth is known."""
    coverage_low: float | None
    coverage_high: float | None
    """Exact binomial 95 % interval on the effective sample size."""
    n_effective: float | None
    winkler_m: float | None
    pinball_m: float | None


class RegionCoverage(Record):
    """Share of epochs within a region that claims 95 %, over many tracks."""

    region: Literal["circle", "sphere"]
    share: float
    low: float
    high: float
    """95 % limits from drawing whole tracks again."""


class CovarianceConsistency(Record):
    """May the covariance be believed? Only where truth is known."""

    n: int
    n_effective: float
    dimension: int
    nees_mean: float
    """Mean of e' V^-1 e; `dimension` for a consistent covariance."""
    nees_low: float
    nees_high: float
    """Chi-square limits (95 %) for the effective sample size."""
    pit_counts: list[int]
    """Histogram of the probability integral transform in equal bins; flat for a consistent covariance."""
    pit_low: float
    pit_high: float
    """Band (95 %) of one bin."""
    regions: list[RegionCoverage] = Field(default_factory=list)
    """Circle and sphere, where there are at least ten tracks."""
    words: str


class EventSummary(Record):
    """One alert from onset to clear, or a point of the flight."""

    track: str
    kind: str
    onset_ns: int
    annunciation_ns: int | None
    clear_ns: int | None
    peak_m: float | None
    limit_m: float | None
    min_margin_m: float | None
    words: str


class Rejection(Record):
    """Input that was not used, and why. Nothing is lost silently."""

    file: str
    reason: str
    count: int
    first_line: int | None
    example: str


class CrossTrack(Record):
    """Cross-track statistics of recorded tracks against one path."""

    path: str
    n_tracks: int
    n_points: int
    mean_m: float
    std_m: float
    abs95_m: float
    between_tracks_std_m: float | None


class InputFile(Record):
    """A file that went in."""

    path: str
    sha256: str
    n_bytes: int
    n_rows: int | None


class Waypoint(Record):
    """A point to draw and name on the map."""

    name: str
    lat_rad: float
    lon_rad: float
    kind: Literal["waypoint", "runway", "station"]


class Summary(Record):
    """summary.json."""

    schema_id: Literal["navbound-summary-1"] = "navbound-summary-1"
    kind: Literal["fly", "analyze"]
    operation: Operation | None = None
    """As the scenario, the caller or the kind of path states it; none where levels are evaluated."""
    title: str
    verdict: Verdict
    coverage_kind: str
    """Which of the two kinds of coverage every `coverage` here is (docs/methods/coverage.md)."""
    assumptions: list[str]
    covariance: CovarianceOrigin = CovarianceOrigin(id="none")
    """Provenance of every sigma."""
    phases: list[PhaseSummary]
    tracks: list[TrackSummary]
    accuracy: list[MethodResult]
    integrity: list[MethodResult]
    honesty: CovarianceConsistency | None
    states: list[str]
    """Names of the states behind `p_state_1`, `p_state_2`, ..."""
    events: list[EventSummary]
    cross_track: list[CrossTrack]
    procedures: list[ProcedureFlown] = Field(default_factory=list)
    """Flights against a published procedure."""
    rejected: list[Rejection]
    n_status: dict[str, int]
    """Epochs by status."""
    protection: list[ProtectionSummary] = Field(default_factory=list)
    """By phase, where epochs carry protection levels and alert limits."""
    performance: Performance | None = None
    """The ICAO indicators, where errors and protection levels are known."""
    faults: list[FaultSummary] = Field(default=[])
    """Of the sensors of a simulated flight: what they did, and when the monitors spoke."""
    groups: list[DeviationGroup] = Field(default=[])
    """Approaches by runway and by operator."""
    bands: list[DeviationBand] = Field(default=[])
    """Approaches by distance to the threshold."""
    satellites: list[SatelliteSummary] = Field(default=[])
    """Where positions were solved: every satellite heard."""

    def name_of(self, track: str) -> str:
        """The name under which people read of a track: its label."""
        return next((each.label for each in self.tracks if each.track == track), track)


class RunRecord(Record):
    """run.json: what it takes to do it again."""

    navbound_version: str
    command: str
    created_utc: str
    kind: Literal["fly", "analyze"]
    scenario: dict[str, object] | None
    seed: int | None
    inputs: list[InputFile]
    methods: list[str]
    risk_accuracy: float | None
    risk_integrity: float | None
    """Risks of the bounds; none in a run that forms no bound."""
    settings: dict[str, object]
    platform: str
