// Written by ./dev generate from python/navbound/records and python/navbound/rnp/alerts.py. Numbers that do not exist are null.

export type AlertKind = "caution" | "warning" | "unavailable" | "quiet" | "clock" | "garbled" | "fleet_full" | "source_lost";

export const ALERT_WORDS = {
    caution: "accuracy bound not within RNP",
    warning: "integrity bound not within twice RNP",
    unavailable: "no usable epoch: loss of monitoring",
    quiet: "the source sends nothing",
    clock: "the times of the source do not agree with their arrival",
    garbled: "a tenth of the frames of the source is damaged",
    fleet_full: "more tracks than are watched",
    source_lost: "the connection to the source is lost",
} as const;

export type VerdictId = "inside" | "outside" | "not_shown" | "not_believable" | "nothing_judged";

export type BeliefState = "unchecked" | "supported" | "partial" | "few" | "small" | "copied" | "short" | "contradicted" | "refuted";

export type Outcome = "no alert needed" | "before" | "within the time to alert" | "late" | "missed";

/** What happened at an instant of a fault. */
export interface Moment {
    time_ns: number;
    words: string;
}

/** One fault on one flight. Times count from its begin, in seconds; None where it never came to that. */
export interface FaultSummary {
    track: string;
    kind: string;
    start_ns: number;
    /** None for one that stays. */
    end_ns: number | null;
    /** Measurements thrown away by the filter's gate, several seconds on end. */
    gate_after_s: number | null;
    /** The innovations of the ranges remembered more than white ones do at the risk of the separation. */
    memory_after_s: number | null;
    /** The filters with and without satellites were said to disagree. */
    disagree_after_s: number | null;
    mode_after_s: number | null;
    /** What the navigation fell back to first. */
    mode: string | null;
    alert_after_s: number | null;
    /** The first alert of the monitor that was not there before: caution, warning, unavailable. */
    alert: string | null;
    /** The true cross-track error left RNP. */
    outside_after_s: number | null;
    /** It left twice RNP. */
    outside_twice_after_s: number | null;
    /** Largest true horizontal error while the fault lasted and in the ten minutes after. */
    nse_h_max_m: number | null;
    nse_u_max_m: number | null;
    /** Of the alert against the error leaving RNP. */
    outcome: Outcome;
    outcome_words: string;
    /** The same in the order of time. */
    moments: Moment[];
    words: string;
}

/** One satellite over the positions that were solved. */
export interface SatelliteSummary {
    track: string;
    sv: string;
    /** Epochs at which a measurement of it was received. */
    n_heard: number;
    n_used: number;
    /** Epochs at which it was not used, by the id of what became of it (`navbound.gnss.FATES`), the most frequent first. */
    n_fate: Record<string, number>;
    el_max_rad: number | null;
    residual_rms_m: number | null;
    /** The residual of the largest size, signed. */
    residual_most_m: number | null;
    cn0_mean_dbhz: number | null;
    cn0_min_dbhz: number | null;
}

/** Deviation of all approaches of a group. */
export interface DeviationGroup {
    by: "runway" | "operator";
    name: string;
    n_tracks: number;
    n_epochs: number;
    mean_m: number;
    std_m: number;
    /** 95 % of the sizes are no larger. */
    abs95_m: number;
    /** The deviation of the largest size, signed. */
    most_m: number;
    /** Whose it is. */
    most_track: string;
    /** Of epochs with status ok. */
    share_inside: number | null;
    /** Largest accuracy bound over RNP. */
    worst_ratio: number | null;
}

/** Where the approaches to one runway lay, by distance to its threshold. */
export interface DeviationBand {
    runway: string;
    /** What is compared: deviation across or above the path, or the height where no vertical path is known. */
    column: "fte_m" | "fte_v_m" | "est_h_m";
    n_tracks: number;
    /** Middles of the bins, before the threshold. */
    before_m: number[];
    /** Epochs in each bin. */
    n: number[];
    least_m: (number | null)[];
    /** 2.5 % lie below; none where fewer than 40 epochs lie in the bin. */
    low_m: (number | null)[];
    median_m: (number | null)[];
    /** 2.5 % lie above. */
    high_m: (number | null)[];
    most_m: (number | null)[];
    /** Of the histogram; empty for heights. */
    edges_m: number[];
    /** Epochs between two edges; those beyond the first and the last are in the outer bins. */
    counts: number[];
}

export type Axis = "h" | "v";

export type Provenance = "printed" | "re-derived" | "standard" | "ours" | "inferred";

/** What an operation asks of the navigation system. */
export interface Level {
    /** `APV-I`, `LPV-200`, ... */
    id: string;
    title: string;
    hal_m: number;
    /** None: the operation asks nothing of the vertical. */
    val_m: number | null;
    /** 95 %. */
    accuracy_h_m: number | null;
    accuracy_v_m: number | null;
    /** Time to alert: the longest a hazard may last without one. */
    tta_s: number;
    integrity_risk: number | null;
    integrity_per: "approach" | "hour" | null;
    /** The largest that the operation allows. */
    continuity_risk: number | null;
    continuity_per: "15 s" | "hour" | null;
    source: string;
    /** Field to how it is held; `standard`: at least two public texts that the source names agree. */
    provenance: Record<string, Provenance>;
}

/** How a quantity is spread over the epochs counted; percentiles by nearest rank. In the unit of the field that holds it. */
export interface Spread {
    n: number;
    mean: number;
    rms: number;
    p50: number;
    p95: number;
    p99: number;
    p999: number;
    max: number;
    max_time_ns: number;
}

/** Errors, levels and their ratio in one axis, over the same epochs. */
export interface AxisResult {
    axis: Axis;
    /** None where truth is not known. */
    error_m: Spread | null;
    level_m: Spread | null;
    /** Error over protection level. */
    safety_index: Spread | null;
    /** Epochs with 0.75 < safety index <= 1. */
    n_potential_mi: number;
    /** Epochs with safety index > 1: misleading information. */
    n_mi: number;
}

/** Every epoch with a solution and a true error, in exactly one region of the diagram of one axis and one level. */
export interface StanfordCounts {
    axis: Axis;
    alert_limit_m: number;
    n: number;
    /** Level below limit, error within level. */
    n_nominal: number;
    /** Level below limit, level < error <= limit. */
    n_mi: number;
    /** Level below limit, error beyond limit: hazardous. */
    n_hmi: number;
    /** Level at or above limit, error within level. */
    n_unavailable: number;
    /** Level at or above limit, error beyond level. */
    n_unavailable_mi: number;
}

/** The four indicators of one level. */
export interface LevelResult {
    level: Level;
    /** 95 % errors within the level's accuracy in every axis it names; None without truth or without a demand. */
    accuracy_met: boolean | null;
    n_expected: number;
    n_solution: number;
    n_available: number;
    /** The headline: share of the expected grid. */
    availability_expected: number;
    availability_low: number;
    /** Wilson 95 % interval on the effective sample size. */
    availability_high: number;
    n_effective: number;
    /** Share of epochs with a solution. */
    availability_solution: number | null;
    /** Times the service was available and then was not. */
    n_continuity_events: number;
    window_s: number;
    n_window_epochs: number;
    /** False where the sampling period is longer than the window. */
    window_meaningful: boolean;
    /** Available epochs with an epoch that is not available within the window after them. */
    n_at_risk: number;
    /** `n_at_risk` over `n_available`; None where nothing was available. */
    continuity_risk: number | null;
    /** Continuity events for each 100 000 available epochs. */
    events_per_1e5: number | null;
    events_per_1e5_low: number | null;
    /** Exact Poisson 95 % interval. */
    events_per_1e5_high: number | null;
    /** 900 s times the continuity events over the time expected. */
    continuity_risk_maritime: number | null;
    /** Without truth the integrity figures below are zeros of an empty count, and presentation says so. */
    truth_known: boolean;
    n_hazard_epochs: number;
    n_hazard_events: number;
    /** Those that lasted longer than the time to alert: integrity failures. */
    n_hazard_over_tta: number;
    longest_hazard_s: number;
    n_mi_epochs: number;
    n_mi_events: number;
    n_mi_over_tta: number;
    longest_mi_s: number;
    /** Horizontal first; vertical where the level has a vertical limit. */
    stanford: StanfordCounts[];
    /** The same as the summary's `axes`, over available epochs alone. */
    available: AxisResult[];
}

/** Histogram of (error, protection level) of one axis, non-empty bins only. The regions of a level are drawn by its limits. */
export interface StanfordBins {
    axis: Axis;
    /** `stanford-esa`: one point for every subset of satellites instead of one for every epoch. */
    variant: "stanford" | "stanford-esa";
    bin_m: number;
    /** Both axes run from 0 to here. */
    limit_m: number;
    n: number;
    /** Bin k is [k bin_m, (k + 1) bin_m); the bin `limit_m / bin_m` collects everything beyond. */
    error_bin: number[];
    level_bin: number[];
    count: number[];
}

/** One subset of an epoch's satellites whose safety index is high. */
export interface ListedSubset {
    time_ns: number;
    /** Used. */
    satellites: string[];
    left_out: string[];
    hpe_m: number;
    hpl_m: number;
    vpe_m: number;
    /** None where the levels' use has no vertical one. */
    vpl_m: number | null;
    /** The larger of both axes. */
    safety_index: number;
}

/** Every subset of each epoch's satellites, solved: the counts of the Stanford-ESA diagram and its gravest points. */
export interface Subsets {
    /** Epochs whose satellites together give a position. */
    n_epochs: number;
    /** Epochs whose satellites do not. */
    n_unsolved: number;
    /** Epochs with so many satellites that only subsets that leave out a few were looked at. */
    n_cut: number;
    n_subsets: number;
    /** Subsets that determine no position: no points. */
    n_singular: number;
    /** Subsets whose error is beyond their level in either axis. */
    n_mi: number;
    /** Fewest satellites of a subset. */
    min_satellites: number;
    /** An epoch has at most as many subsets as this many satellites have: 2 to this power. */
    max_satellites: number;
    safety_index_h_max: number;
    safety_index_v_max: number;
    /** Safety index from which a subset is listed. */
    listed_from: number;
    /** How many reach it. */
    n_listed: number;
    /** The gravest of them, at most 500. */
    listed: ListedSubset[];
    /** By level id: subsets in the regions; horizontal first, vertical where the level has a vertical limit. */
    stanford: Record<string, StanfordCounts[]>;
}

/** Errors and levels against time: the largest of each bucket of equal duration. NaN never appears: None is "no epoch". */
export interface KpiSeries {
    width_ns: number;
    /** Begin of each bucket; buckets without a single expected epoch are not listed. */
    start_ns: number[];
    n_expected: number[];
    n_solution: number[];
    hpe_max_m: (number | null)[];
    vpe_max_m: (number | null)[];
    hpl_min_m: (number | null)[];
    hpl_max_m: (number | null)[];
    vpl_min_m: (number | null)[];
    vpl_max_m: (number | null)[];
    /** By level id. */
    n_available: Record<string, number[]>;
    /** By level id: the most frequent cause of unavailable epochs in the bucket, empty where all were available. */
    cause: Record<string, string[]>;
}

/** A loss of availability, a hazard, or misleading information, from its first epoch to its last. */
export interface KpiEvent {
    level: string;
    kind: "loss" | "hazard" | "mi";
    /** First epoch of the condition. */
    onset_ns: number;
    /** First epoch without it; None where the data end first. */
    clear_ns: number | null;
    n_epochs: number;
    duration_s: number;
    /** Longer than the time to alert; None for a loss. */
    over_tta: boolean | null;
    /** Of a loss: `no epoch`, `no solution`, `no vertical level`, `hpl`, `vpl`, `hpl and vpl`; empty otherwise. */
    cause: string;
    /** What the table's `reason`, `mode` and `n_sv` say about the onset, in words; empty where they say nothing. */
    reason: string;
    hpe_max_m: number | null;
    vpe_max_m: number | null;
    hpl_max_m: number | null;
    /** Extremes while it lasted. */
    vpl_max_m: number | null;
    n_sv_before: number | null;
    n_sv_onset: number | null;
    mode_before: string | null;
    mode_onset: string | null;
}

/** One GPS day. */
export interface DayResult {
    start_ns: number;
    n_expected: number;
    n_solution: number;
    /** By level id. */
    n_available: Record<string, number>;
}

/** Messages of one type. */
export interface MessageCount {
    type: number;
    what: string;
    n: number;
    /** Between two of them; None where there is one. */
    longest_gap_s: number | null;
    /** How long its data may be used on a precision approach; None where no time-out is declared. */
    time_out_s: number | null;
    /** Gaps between two of them that are longer. */
    n_time_outs: number;
}

/** The UDRE indicators of a satellite. */
export interface UdreHistory {
    sv: string;
    /** The largest of each bin: 14 is not monitored, 15 is not to be used; None where none was sent. */
    worst: (number | null)[];
}

/** The GIVE of a point of the ionospheric grid over time. */
export interface GridPoint {
    lat_rad: number;
    lon_rad: number;
    /** One sign a bin, at its end: `0` to `9` and `A` to `E` the GIVE indicator 0 to 14, `F` not monitored (15), `X` not to be used, `.` not sent or older than its time-out. */
    states: string;
}

/** The messages of one geostationary satellite over the epochs of a run. */
export interface ServiceLog {
    prn: number;
    first_ns: number;
    last_ns: number;
    n_messages: number;
    /** Whole seconds between the first and the last message in which none ended: one a second is sent. */
    n_missing: number;
    longest_silence_s: number;
    types: MessageCount[];
    /** Width of the bins, which begin at `first_ns`. */
    bin_ns: number;
    /** Of satellites of the mask that were monitored at some time. */
    udre: UdreHistory[];
    /** Of each bin how many points of the grid mask had each GIVE indicator, 0 to 15, at its end; those not to be used count with 15, those that were too old as none. */
    give: number[][];
    /** Points of the grid masks at the end. */
    n_points: number;
    /** Points that were in a mask at the end of a bin. Empty in a record that was written before there was one. */
    grid: GridPoint[];
    words: string[];
}

/** What the ICAO indicators of one receiver's series are. */
export interface Performance {
    title: string;
    truth_known: boolean;
    period_s: number;
    first_ns: number;
    last_ns: number;
    /** The grid holds only the epochs that are there. */
    exclude_missing: boolean;
    n_expected: number;
    n_missing: number;
    n_no_solution: number;
    n_solution: number;
    /** Rows that share an epoch of the grid with another; of each epoch the worst row counts. */
    n_repeated: number;
    /** Epochs with a solution and misleading information in either axis. */
    n_mi_epochs: number;
    /** Horizontal, vertical; over epochs with a solution. */
    axes: AxisResult[];
    levels: LevelResult[];
    stanford: StanfordBins[];
    series: KpiSeries;
    /** By kind, over all levels. */
    n_events: Record<string, number>;
    /** Hazards and misleading information first, then losses, longest first; at most 500 of all in events.parquet. */
    events: KpiEvent[];
    days: DayResult[];
    /** Where the Stanford-ESA diagram was requested. */
    subsets: Subsets | null;
    /** Words that must stand beside every number of an experimental level; empty for integrity levels. */
    experimental: string;
    notes: string[];
    /** Where SBAS messages corrected the positions: what they were. */
    service: ServiceLog | null;
}

/** Deviations of one kind of height from the vertical path of the final approach. */
export interface HeightResult {
    /** The altimeter: pressure altitude with a setting. Geometry: height above the ellipsoid less the undulation. */
    by: "altimeter" | "geometry";
    path: "barometric" | "straight";
    n: number;
    mean_m: number;
    rms_m: number;
    /** 95 % of the sizes. */
    p95_m: number;
    least_m: number;
    most_m: number;
    limit_m: number;
    n_inside: number;
    /** Least of what 99.7 % of the aircraft's vertical errors have to be below (FAA AC 90-101A, standard), over the positions. */
    required_m: number;
    n_inside_required: number;
    /** Epochs with a bound of the vertical total error. */
    n_bound: number;
    /** Epochs whose bound is inside the limit. */
    n_bound_inside: number;
    /** Largest risk of an epoch that the aircraft is below the path by more than the limit. */
    risk_below_max: number | null;
}

/** What the heights of a descent say of the altimeter setting. It cannot tell a wrong setting from a wrong geometric height. */
export interface SettingResult {
    setting_hpa: number;
    origin: "given" | "broadcast";
    n: number;
    /** Geometric less indicated height at the aerodrome; negative where the setting is too high. */
    intercept_m: number;
    /** Growth of the difference with height: the temperature. */
    slope: number;
    residual_sigma_m: number;
    /** A larger intercept is an alarm. */
    threshold_m: number;
    /** Found with 90 %. */
    detectable_m: number;
    alarm: boolean;
}

/** A flight on one leg. */
export interface LegFlown {
    sequence: number;
    fix: string;
    terminator: string;
    state: string;
    rnp_m: number | null;
    rnp_origin: string;
    length_m: number | null;
    n: number;
    n_transition: number;
    duration_s: number;
    mean_m: number | null;
    rms_m: number | null;
    p95_m: number | null;
    max_abs_m: number | null;
    n_inside: number;
    n_inside_twice: number;
    /** Epochs with a bound of the total error. */
    n_bound: number;
    n_bound_inside: number;
    n_bound_inside_twice: number;
    worst_time_ns: number | null;
    worst_along_m: number | null;
}

/** What a procedure does not judge of a recording, and what it lacks itself. */
export interface BesideProcedure {
    /** Positions of the recording. */
    n_recorded: number;
    /** Of these, the positions that are no part of a flight along the procedure (before and after it, in turns, beside holds), by what they are. */
    n_status: Record<string, number>;
    /** Flights that end, or leave the path, before the end of the procedure. */
    n_short: number;
    /** What the earliest of them does. */
    short: "ends" | "leaves" | null;
    /** How far before the end of the procedure it does so; None where that is not defined. */
    short_m: number | null;
    /** How far after the begin of the procedure the latest of the flights is first judged, where it is more than a nautical mile. */
    begin_m: number | null;
    /** Why the legs may not be the whole procedure; the verdict cannot be "inside" beside one. */
    doubts: string[];
}

/** One flight against a procedure. */
export interface ProcedureFlown {
    track: string;
    procedure: string;
    line: string | null;
    /** From when on it was judged. */
    first_ns: number;
    /** Positions by what they are worth, from the first that was judged to the last. */
    n_status: Record<string, number>;
    /** Positions judged, on legs with an RNP; those that stray from the path are among them. */
    n: number;
    n_inside: number;
    n_inside_twice: number;
    n_without_rnp: number;
    /** Whether a position beyond the end of the procedure follows, the track ends before it, or the aircraft has left the path. */
    end: "reached" | "ends" | "leaves";
    /** How far before the end of the procedure the last position near the path is; None beyond it, or where that is not defined. */
    short_m: number | null;
    /** How far after the begin of the procedure the first position judged is; None where that is not defined. */
    begin_m: number | null;
    n_bound: number;
    n_bound_inside: number;
    n_bound_inside_twice: number;
    n_effective: number;
    /** Share outside RNP that no exceedance in so many independent positions leaves open at 95 % confidence; None where there was one. */
    most_exceeding: number | null;
    legs: LegFlown[];
    heights: HeightResult[];
    setting: SettingResult | null;
    /** Whether it was inside: recorded positions, bounds of the total error, what the data can decide; then the heights. */
    answers: string[];
}

export type Operation = "en-route" | "approach" | "ground";

/** The epoch with the smallest margin between bound and limit. */
export interface Worst {
    track: string;
    time_ns: number;
    /** Limit minus bound; negative means outside. */
    margin_m: number;
    bound_m: number;
    limit_m: number;
    phase: string | null;
    along_m: number | null;
    lat_rad: number;
    lon_rad: number;
}

/** One bound against truth, over epochs with status ok. */
export interface BoundCheck {
    method: string;
    risk: number;
    n: number;
    n_outside: number;
    /** Independent epochs that they are worth: of the navigation error about zero. */
    n_effective: number;
    coverage: number;
    coverage_low: number;
    /** Exact binomial 95 % limits for the effective number. */
    coverage_high: number;
    /** Below its claim, and the errors beyond the bounds of its method are too improbable for true ones. */
    refuted: boolean;
}

/** A protection level against truth, over epochs with status ok or degraded. */
export interface LevelCheck {
    level: "hpl_m" | "vpl_m";
    n: number;
    /** Epochs whose error is above the level: misleading information. */
    n_above: number;
    /** Largest error over its level. */
    largest_ratio: number;
}

/** Whether truth supports the bounds that a run states. */
export interface Belief {
    /** `partial`: truth supports the bounds at less than the least share of the epochs. `few`: fewer than 10 independent epochs, which contradict nothing and support nothing. `small`: the errors are so much smaller than the covariance states that the truth may not be independent of the estimate. `copied`: the truth is the estimate itself; the verdict is not shown. `refuted` withdraws the verdict; `contradicted` (a bound beside the lateral ones is false) and `short` leave it not shown. */
    state: BeliefState;
    /** Epochs that are checked where truth is known: those with status ok, or the degraded ones where none is ok. */
    n_epochs: number;
    /** Of those, epochs with a true horizontal error. */
    n_truth: number;
    n_effective: number;
    /** Mean of e' V^-1 e of the horizontal error, each at most 23.03; 2 for a true covariance. */
    square_mean: number | null;
    /** Largest probability of these data under true bounds, over all tests of `bounds`. */
    p_value: number;
    /** Those that the lateral verdict rests on. */
    bounds: BoundCheck[];
    /** Every other bound that the run states: vertical, spatial, along the axes of the path. */
    beside: BoundCheck[];
    /** Protection levels that the epochs carry. */
    levels: LevelCheck[];
}

/** Where the covariance that the bounds rest on comes from. */
export interface CovarianceOrigin {
    id: "simulated" | "filter" | "solved" | "file" | "file_axes" | "epu" | "nac_p" | "nuc_p" | "containment_radius" | "typed" | "none";
    /** What the user typed. */
    sigma_m: number | null;
    own_low_m: number | null;
    /** Least and largest sigma of one axis by the file's own accuracies, where the typed one overrules them. */
    own_high_m: number | null;
}

/** Inside or not, in one look. */
export interface Verdict {
    /** Decided in run/verdict/rule.py alone. */
    id: VerdictId;
    /** What the id says of the requirement; None: nothing. */
    inside: boolean | null;
    /** The verdict as sentences: what, how much, worst where and when, what was assumed, whether truth was known. */
    words: string;
    /** The same one by one: first what, then why, the gravest first; in runs that are older than this field all in one. */
    sentences: string[];
    /** Those without what a page states beside it: the worst margins, the method that judged, the lateral bounds against truth. */
    lead: string[];
    requirement: string;
    /** Id of the method that judged, see `methods`. */
    method: string;
    /** Share of judged epochs whose accuracy bound is within RNP. */
    share_inside: number | null;
    /** Share of judged epochs whose integrity bound is within 2 RNP. */
    share_contained: number | null;
    /** Expected: epochs of the table and those missing in gaps. */
    n_epochs: number;
    /** Epochs with status ok and a bound. */
    n_judged: number;
    /** Epochs with status degraded: they may show outside, never inside. */
    n_degraded: number;
    /** Epochs of any other kind: without position, covariance or bound, or missing. */
    n_unjudged: number;
    /** Of those, epochs that a gap of the table should have held, and recorded rows without a usable time and position. */
    n_missing: number;
    /** Epochs that the usual step leaves room for in gaps too short to count; expected by nobody. */
    n_absent: number;
    /** Approaches to runways that were judged. */
    n_approaches: number;
    /** Passes along a runway's centreline that stray, or end, before they are an approach; none of their epochs is judged. */
    n_unjudged_approaches: number;
    /** Tracks of the recording without an approach to the runways; none of their epochs is judged. */
    n_tracks_elsewhere: number;
    /** What a procedure does not judge of the recording; None where none was followed. */
    beside: BesideProcedure | null;
    /** Where no vertical bound judges: the largest known error of the heights with status ok; None where one does, or none is known. [m] */
    largest_height_error_m: number | null;
    /** Epochs with status ok or degraded whose bound is beyond its limit. */
    n_outside: number;
    /** Epochs with status ok, a bound within its limit and a known error beyond twice RNP. */
    n_known_beyond: number;
    /** Epochs with status ok or degraded where the recording itself states an error beyond RNP. */
    n_stated_beyond: number;
    /** The same where it states an alert. */
    n_stated_alert: number;
    /** What it states there, and in which column: the first few. */
    stated_alerts: string[];
    /** The same where it states a 95 % radius that is larger than its covariance allows. */
    n_stated_worse: number;
    /** The same where it states a containment radius (Rc, NIC) beyond twice RNP, or none. */
    n_stated_uncontained: number;
    /** Epochs that are not ok by the id of their reason, the most frequent first. */
    n_reason: Record<string, number>;
    /** Columns, or words of columns, that speak of integrity by their name and are not understood. */
    unread: string[];
    /** Why the positions may not be what they are read as (their unit, their motion); the verdict cannot be "inside" beside one. */
    position_doubts: string[];
    /** Positions further from the line between their neighbours than their covariances and any manoeuvre explain. */
    n_apart: number;
    /** The largest of these distances. */
    largest_apart_m: number | null;
    /** Judged epochs of tracks with a column of horizontal protection levels that holds none. */
    n_without_level: number;
    /** Steps between successive epochs of a track that are longer than a position takes to become stale. */
    n_long_steps: number;
    /** The longest of all steps between successive epochs; None where no track has two. */
    longest_step_s: number | null;
    /** Least share of judged epochs for "inside". */
    least_share: number;
    /** What stands in the first sentence because no data says it. */
    assumed: ("sigma_typed" | "sigma_coded" | "no_path")[];
    /** Quantities of which the user declares that no column is to be read as them: what they say against the positions is not heard. */
    set_aside: string[];
    /** None where no epoch has both a bound or level and a true error. */
    belief: Belief | null;
    /** Epochs of any status whose true position is known. */
    n_truth: number;
    /** Epochs whose truth contradicts itself and is not used. */
    n_truth_doubted: number;
    /** What speaks against the truth, with times; empty where nothing does. */
    truth_doubts: string;
    /** Epochs whose input cannot be true (a jump that cannot be flown, a negative variance). */
    n_implausible: number;
    worst_accuracy: Worst | null;
    worst_integrity: Worst | null;
    truth_known: boolean;
    experimental: boolean;
}

/** One phase or leg of the flight with one RNP value. */
export interface PhaseSummary {
    phase: string;
    rnp_m: number;
    n_epochs: number;
    duration_s: number;
    /** Of epochs with status ok. */
    share_inside: number | null;
    /** Largest accuracy bound over RNP. */
    worst_ratio: number | null;
    p_exceed_2rnp_max: number | null;
    /** Time average of the risk to leave 2 RNP. */
    p_exceed_2rnp_mean: number | null;
    /** Share of epochs whose |tse| is within the accuracy bound, where truth is known. */
    coverage: number | null;
    n_cautions: number;
    n_warnings: number;
}

/** Protection levels against the alert limit in one phase. */
export interface ProtectionSummary {
    phase: string;
    hal_m: number;
    /** How the limit is held: printed, re-derived, standard, ours, inferred, given. */
    hal_held: string;
    n_epochs: number;
    hpl_max_m: number | null;
    hpl_multi_max_m: number | null;
    hpe_max_m: number | null;
    /** Largest accuracy (95 %). */
    accuracy_max_m: number | null;
    accuracy_limit_m: number | null;
    /** Share of epochs with a protection level within the limit. */
    share_available: number;
    /** Epochs whose horizontal error is above the protection level, where truth is known. */
    n_misleading: number;
}

/** One flight, approach or aircraft. */
export interface TrackSummary {
    track: string;
    label: string;
    n_epochs: number;
    start_ns: number;
    duration_s: number;
    fte_mean_m: number | null;
    fte_std_m: number | null;
    fte_abs95_m: number | null;
    /** Of epochs with status ok. */
    share_inside: number | null;
    worst_ratio: number | null;
    worst_margin_m: number | null;
    n_cautions: number;
    n_warnings: number;
    n_unavailable: number;
}

/** One method at one risk: what it is, and how it did. */
export interface MethodResult {
    id: string;
    title: string;
    source: string;
    provenance: Provenance;
    assumes: string;
    error_column: string;
    may_alert: boolean;
    risk: number;
    /** Epochs with a bound. */
    n: number;
    /** Sharpness: the mean bound. */
    mean_m: number | null;
    max_m: number | null;
    /** Share of epochs whose error is within the bound, where truth is known. */
    coverage: number | null;
    coverage_low: number | null;
    /** Exact binomial 95 % interval on the effective sample size. */
    coverage_high: number | null;
    n_effective: number | null;
    winkler_m: number | null;
    pinball_m: number | null;
}

/** Share of epochs within a region that claims 95 %, over many tracks. */
export interface RegionCoverage {
    region: "circle" | "sphere";
    share: number;
    low: number;
    /** 95 % limits from drawing whole tracks again. */
    high: number;
}

/** May the covariance be believed? Only where truth is known. */
export interface CovarianceConsistency {
    n: number;
    n_effective: number;
    dimension: number;
    /** Mean of e' V^-1 e; `dimension` for a consistent covariance. */
    nees_mean: number;
    nees_low: number;
    /** Chi-square limits (95 %) for the effective sample size. */
    nees_high: number;
    /** Histogram of the probability integral transform in equal bins; flat for a consistent covariance. */
    pit_counts: number[];
    pit_low: number;
    /** Band (95 %) of one bin. */
    pit_high: number;
    /** Circle and sphere, where there are at least ten tracks. */
    regions: RegionCoverage[];
    words: string;
}

/** One alert from onset to clear, or a point of the flight. */
export interface EventSummary {
    track: string;
    kind: string;
    onset_ns: number;
    annunciation_ns: number | null;
    clear_ns: number | null;
    peak_m: number | null;
    limit_m: number | null;
    min_margin_m: number | null;
    words: string;
}

/** Input that was not used, and why. Nothing is lost silently. */
export interface Rejection {
    file: string;
    reason: string;
    count: number;
    first_line: number | null;
    example: string;
}

/** Cross-track statistics of recorded tracks against one path. */
export interface CrossTrack {
    path: string;
    n_tracks: number;
    n_points: number;
    mean_m: number;
    std_m: number;
    abs95_m: number;
    between_tracks_std_m: number | null;
}

/** A file that went in. */
export interface InputFile {
    path: string;
    sha256: string;
    n_bytes: number;
    n_rows: number | null;
}

/** A point to draw and name on the map. */
export interface Waypoint {
    name: string;
    lat_rad: number;
    lon_rad: number;
    kind: "waypoint" | "runway" | "station";
}

/** summary.json. */
export interface Summary {
    schema_id: "navbound-summary-1";
    kind: "fly" | "analyze";
    /** As the scenario, the caller or the kind of path states it; none where levels are evaluated. */
    operation: Operation | null;
    title: string;
    verdict: Verdict;
    /** Which of the two kinds of coverage every `coverage` here is (docs/methods/coverage.md). */
    coverage_kind: string;
    assumptions: string[];
    /** Provenance of every sigma. */
    covariance: CovarianceOrigin;
    phases: PhaseSummary[];
    tracks: TrackSummary[];
    accuracy: MethodResult[];
    integrity: MethodResult[];
    honesty: CovarianceConsistency | null;
    /** Names of the states behind `p_state_1`, `p_state_2`, ... */
    states: string[];
    events: EventSummary[];
    cross_track: CrossTrack[];
    /** Flights against a published procedure. */
    procedures: ProcedureFlown[];
    rejected: Rejection[];
    /** Epochs by status. */
    n_status: Record<string, number>;
    /** By phase, where epochs carry protection levels and alert limits. */
    protection: ProtectionSummary[];
    /** The ICAO indicators, where errors and protection levels are known. */
    performance: Performance | null;
    /** Of the sensors of a simulated flight: what they did, and when the monitors spoke. */
    faults: FaultSummary[];
    /** Approaches by runway and by operator. */
    groups: DeviationGroup[];
    /** Approaches by distance to the threshold. */
    bands: DeviationBand[];
    /** Where positions were solved: every satellite heard. */
    satellites: SatelliteSummary[];
}

/** run.json: what it takes to do it again. */
export interface RunRecord {
    navbound_version: string;
    command: string;
    created_utc: string;
    kind: "fly" | "analyze";
    scenario: Record<string, unknown> | null;
    seed: number | null;
    inputs: InputFile[];
    methods: string[];
    risk_accuracy: number | null;
    /** Risks of the bounds; none in a run that forms no bound. */
    risk_integrity: number | null;
    settings: Record<string, unknown>;
    platform: string;
}

/** A column of the map. */
export interface MapColumn {
    name: string;
    title: string;
    unit: "1" | "m";
    /** By percentile of the day: the number that half of the area is within; None where there is none on half of it. */
    typical: Record<string, number | null>;
}

/** What was required of a column. */
export interface MapLimit {
    column: string;
    limit: number;
    source: string;
    provenance: string;
}

/** Share of the area where the limits are met for at least a share of the time. */
export interface MapCoverage {
    /** Share of the time required. */
    available: number;
    /** Share of the area, cells weighted by the cosine of their latitude. */
    share: number;
}

/** What became of users and instants: within the limits, beyond them, or without a number for one cause. */
export interface MapOutcome {
    /** The column that holds its share of the instants at each point; ``beyond`` is what the others leave. */
    name: string;
    title: string;
    /** Share of time and area; all outcomes make 1. */
    share: number;
}

/** Cells of the map; the columns of map.parquet go row after row from the south-west. */
export interface MapGrid {
    step_rad: number;
    south_rad: number;
    north_rad: number;
    west_rad: number;
    east_rad: number;
    n_lat: number;
    n_lon: number;
}

/** The first point with the smallest availability. */
export interface MapWorst {
    lat_rad: number;
    lon_rad: number;
    available: number;
    /** Share of the area that has no more. */
    share: number;
}

/** summary.json of a map. */
export interface MapSummary {
    schema_id: "navbound-map-1";
    kind: string;
    title: string;
    /** What was found, as sentences. */
    words: string;
    source: string;
    grid: MapGrid;
    n_epochs: number;
    percentiles: number[];
    columns: MapColumn[];
    limits: MapLimit[];
    coverage: MapCoverage[];
    /** Share of time and area within the limits. */
    available_mean: number;
    outcomes: MapOutcome[];
    worst: MapWorst;
    assumptions: string[];
}

/** run.json of a map: what it takes to do it again. */
export interface MapRecord {
    navbound_version: string;
    command: string;
    created_utc: string;
    kind: string;
    options: Record<string, string>;
    /** Files by digest (SHA-256). */
    inputs: Record<string, string>;
    backend: string;
    n_tiles: number;
    platform: string;
}
