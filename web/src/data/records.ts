// The records of a run as the page receives them; names and meanings are those of python/navbound/records/run.py.

import type { PackedColumn } from "./packing.ts";
import type { Performance } from "./performance.ts";

export interface Worst {
    track: string;
    time_ns: number;
    margin_m: number;
    bound_m: number;
    limit_m: number;
    phase: string | null;
    along_m: number | null;
    lat_rad: number;
    lon_rad: number;
}

export type VerdictId = "inside" | "outside" | "not_shown" | "not_believable" | "nothing_judged";

/** One bound against truth, over epochs with status ok. */
export interface BoundCheck {
    method: string;
    risk: number;
    n: number;
    n_outside: number;
    n_effective: number;
    coverage: number;
    coverage_low: number;
    coverage_high: number;
    /** Below its claim, and the errors beyond the bounds of its method are too improbable for true ones. */
    refuted: boolean;
}

/** A protection level against truth, over epochs with status ok or degraded. */
export interface LevelCheck {
    level: "hpl_m" | "vpl_m";
    n: number;
    n_above: number;
    largest_ratio: number;
}

export interface Belief {
    state: "unchecked" | "supported" | "partial" | "few" | "copied" | "short" | "contradicted" | "refuted";
    /** Epochs checked where truth is known, and those of them with a true horizontal error. */
    n_epochs: number;
    n_truth: number;
    n_effective: number;
    square_mean: number | null;
    p_value: number;
    /** Those that the lateral verdict rests on, and every other that the run states. */
    bounds: BoundCheck[];
    beside: BoundCheck[];
    levels: LevelCheck[];
}

export interface Verdict {
    id: VerdictId;
    inside: boolean | null;
    words: string;
    requirement: string;
    method: string;
    share_inside: number | null;
    share_contained: number | null;
    n_epochs: number;
    n_judged: number;
    n_degraded: number;
    n_unjudged: number;
    n_missing: number;
    n_outside: number;
    n_known_beyond: number;
    n_stated_beyond: number;
    n_stated_alert: number;
    n_stated_worse: number;
    n_without_level: number;
    n_long_steps: number;
    longest_step_s: number | null;
    least_share: number;
    assumed: ("sigma_typed" | "sigma_coded" | "no_path")[];
    belief: Belief | null;
    n_truth: number;
    n_implausible: number;
    worst_accuracy: Worst | null;
    worst_integrity: Worst | null;
    truth_known: boolean;
    experimental: boolean;
}

export interface PhaseSummary {
    phase: string;
    rnp_m: number;
    n_epochs: number;
    duration_s: number;
    share_inside: number | null;
    worst_ratio: number | null;
    p_exceed_2rnp_max: number | null;
    p_exceed_2rnp_mean: number | null;
    coverage: number | null;
    n_cautions: number;
    n_warnings: number;
}

export interface ProtectionSummary {
    phase: string;
    hal_m: number;
    hal_held: string;
    n_epochs: number;
    hpl_max_m: number | null;
    hpl_multi_max_m: number | null;
    hpe_max_m: number | null;
    accuracy_max_m: number | null;
    accuracy_limit_m: number | null;
    share_available: number;
    n_misleading: number;
}

export interface TrackSummary {
    track: string;
    label: string;
    n_epochs: number;
    start_ns: number;
    duration_s: number;
    fte_mean_m: number | null;
    fte_std_m: number | null;
    fte_abs95_m: number | null;
    share_inside: number | null;
    worst_ratio: number | null;
    worst_margin_m: number | null;
    n_cautions: number;
    n_warnings: number;
    n_unavailable: number;
}

export interface MethodResult {
    id: string;
    title: string;
    source: string;
    provenance: string;
    assumes: string;
    error_column: string;
    may_alert: boolean;
    risk: number;
    n: number;
    mean_m: number | null;
    max_m: number | null;
    coverage: number | null;
    coverage_low: number | null;
    coverage_high: number | null;
    n_effective: number | null;
    winkler_m: number | null;
    pinball_m: number | null;
}

export interface Held {
    region: "circle" | "sphere";
    share: number;
    low: number;
    high: number;
}

export interface Honesty {
    n: number;
    n_effective: number;
    dimension: number;
    nees_mean: number;
    nees_low: number;
    nees_high: number;
    pit_counts: number[];
    pit_low: number;
    pit_high: number;
    regions: Held[];
    words: string;
}

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

/** Times count from the begin of the fault, in seconds. */
export interface FaultSummary {
    track: string;
    kind: string;
    start_ns: number;
    end_ns: number | null;
    gate_after_s: number | null;
    memory_after_s: number | null;
    disagree_after_s: number | null;
    mode_after_s: number | null;
    mode: string | null;
    alert_after_s: number | null;
    alert: string | null;
    outside_after_s: number | null;
    outside_twice_after_s: number | null;
    nse_h_max_m: number | null;
    nse_u_max_m: number | null;
    outcome: string;
    words: string;
}

export interface Summary {
    kind: string;
    title: string;
    verdict: Verdict;
    coverage_kind: string;
    assumptions: string[];
    covariance: { id: string; sigma_m: number | null };
    phases: PhaseSummary[];
    tracks: TrackSummary[];
    accuracy: MethodResult[];
    integrity: MethodResult[];
    honesty: Honesty | null;
    states: string[];
    events: EventSummary[];
    cross_track: { path: string; n_tracks: number; n_points: number; mean_m: number; std_m: number; abs95_m: number; between_tracks_std_m: number | null }[];
    rejected: { file: string; reason: string; count: number; first_line: number | null; example: string }[];
    n_status: Record<string, number>;
    /** By phase, where epochs carry protection levels and alert limits. */
    protection: ProtectionSummary[];
    /** The ICAO indicators, where errors and protection levels are known. */
    performance: Performance | null;
    /** Of the sensors of a simulated flight: what they did, and when the monitors spoke. */
    faults: FaultSummary[];
}

export interface RunRecord {
    navbound_version: string;
    command: string;
    created_utc: string;
    kind: string;
    scenario: Record<string, unknown> | null;
    seed: number | null;
    inputs: { path: string; sha256: string; n_bytes: number; n_rows: number | null }[];
    methods: string[];
    /** Null, as the next, in a report of errors against protection levels: its page shows neither. */
    risk_accuracy: number;
    risk_integrity: number;
    settings: Record<string, unknown>;
    platform: string;
}

export interface Waypoint {
    name: string;
    lat_rad: number;
    lon_rad: number;
    kind: "waypoint" | "runway" | "station";
}

export interface PackedTrack {
    track: string;
    n: number;
    start_ns: string;
    columns: PackedColumn[];
    words: Record<string, { words: string[]; runs: [number, number][] }>;
    block: number;
}

export interface Payload {
    schema_id: "navbound-report-1";
    summary: Summary;
    record: RunRecord;
    waypoints: Waypoint[];
    utc_offset_s: number;
    gps_epoch_unix_s: number;
    /** Polylines of longitude, latitude in thousandths of a degree, differenced. */
    coastline: number[][];
    tracks: PackedTrack[];
}
