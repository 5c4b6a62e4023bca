// The records of a performance evaluation; names and meanings are those of python/navbound/records/performance.py.

export type AxisId = "h" | "v";

export interface Level {
    id: string;
    title: string;
    hal_m: number;
    val_m: number | null;
    accuracy_h_m: number | null;
    accuracy_v_m: number | null;
    tta_s: number;
    integrity_risk: number | null;
    integrity_per: "approach" | "hour" | null;
    continuity_risk: number | null;
    continuity_per: "15 s" | "hour" | null;
    source: string;
    provenance: Record<string, string>;
}

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

export interface AxisResult {
    axis: AxisId;
    error_m: Spread | null;
    level_m: Spread | null;
    safety_index: Spread | null;
    n_potential_mi: number;
    n_mi: number;
}

export interface StanfordCounts {
    axis: AxisId;
    alert_limit_m: number;
    n: number;
    n_nominal: number;
    n_mi: number;
    n_hmi: number;
    n_unavailable: number;
    n_unavailable_mi: number;
}

export interface LevelResult {
    level: Level;
    accuracy_met: boolean | null;
    n_expected: number;
    n_solution: number;
    n_available: number;
    availability_expected: number;
    availability_low: number;
    availability_high: number;
    n_effective: number;
    availability_solution: number | null;
    n_continuity_events: number;
    window_s: number;
    n_window_epochs: number;
    window_meaningful: boolean;
    n_at_risk: number;
    continuity_risk: number | null;
    events_per_1e5: number | null;
    events_per_1e5_low: number | null;
    events_per_1e5_high: number | null;
    continuity_risk_maritime: number | null;
    truth_known: boolean;
    n_hazard_epochs: number;
    n_hazard_events: number;
    n_hazard_over_tta: number;
    longest_hazard_s: number;
    n_mi_epochs: number;
    n_mi_events: number;
    n_mi_over_tta: number;
    longest_mi_s: number;
    stanford: StanfordCounts[];
    available: AxisResult[];
}

export interface StanfordBins {
    axis: AxisId;
    variant: "stanford" | "stanford-esa";
    bin_m: number;
    limit_m: number;
    n: number;
    error_bin: number[];
    level_bin: number[];
    count: number[];
}

export interface SubsetFound {
    time_ns: number;
    satellites: string[];
    left_out: string[];
    hpe_m: number;
    hpl_m: number;
    vpe_m: number;
    vpl_m: number | null;
    safety_index: number;
}

export interface Subsets {
    n_epochs: number;
    n_unsolved: number;
    n_cut: number;
    n_subsets: number;
    n_singular: number;
    n_mi: number;
    min_satellites: number;
    max_satellites: number;
    safety_index_h_max: number;
    safety_index_v_max: number;
    listed_from: number;
    n_listed: number;
    listed: SubsetFound[];
    stanford: Record<string, StanfordCounts[]>;
}

export interface KpiSeries {
    width_ns: number;
    start_ns: number[];
    n_expected: number[];
    n_solution: number[];
    hpe_max_m: (number | null)[];
    vpe_max_m: (number | null)[];
    hpl_min_m: (number | null)[];
    hpl_max_m: (number | null)[];
    vpl_min_m: (number | null)[];
    vpl_max_m: (number | null)[];
    n_available: Record<string, number[]>;
    cause: Record<string, string[]>;
}

export interface KpiEvent {
    level: string;
    kind: "loss" | "hazard" | "mi";
    onset_ns: number;
    clear_ns: number | null;
    n_epochs: number;
    duration_s: number;
    over_tta: boolean | null;
    cause: string;
    reason: string;
    hpe_max_m: number | null;
    vpe_max_m: number | null;
    hpl_max_m: number | null;
    vpl_max_m: number | null;
    n_sv_before: number | null;
    n_sv_onset: number | null;
    mode_before: string | null;
    mode_onset: string | null;
}

export interface DayResult {
    start_ns: number;
    n_expected: number;
    n_solution: number;
    n_available: Record<string, number>;
}

export interface Performance {
    title: string;
    truth_known: boolean;
    period_s: number;
    first_ns: number;
    last_ns: number;
    exclude_missing: boolean;
    n_expected: number;
    n_missing: number;
    n_no_solution: number;
    n_solution: number;
    n_repeated: number;
    n_mi_epochs: number;
    axes: AxisResult[];
    levels: LevelResult[];
    stanford: StanfordBins[];
    series: KpiSeries;
    n_events: Record<string, number>;
    events: KpiEvent[];
    days: DayResult[];
    subsets: Subsets | null;
    experimental: string;
    notes: string[];
}
