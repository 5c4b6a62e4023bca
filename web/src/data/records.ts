// What the page receives: the records of a run as Python declares them, and the columns of its tracks.

import type { NumberColumn } from "../columns.gen.ts";
import type { RunRecord as AnyRunRecord, Summary, Waypoint } from "../records.gen.ts";
import type { PackedColumn } from "./packing.ts";

export type * from "../records.gen.ts";

/** Risks are null in a report of errors against protection levels; its page shows neither. */
export type RunRecord = Omit<AnyRunRecord, "risk_accuracy" | "risk_integrity"> & { risk_accuracy: number; risk_integrity: number };

/** A chart that is drawn from the declarations of its columns alone. */
export interface DeclaredChart {
    title: string;
    unit: string;
    lines: { column: NumberColumn; label: string; about: string; limit: boolean }[];
}

/** The name under which people read of a track: its label. */
export function nameOf(summary: Summary, track: string): string {
    return summary.tracks.find((t) => t.track === track)?.label ?? track;
}

export interface PackedTrack {
    track: string;
    n: number;
    start_ns: string;
    /** Epochs after which so much time passes without one that no line may cross it. */
    breaks: number[];
    columns: PackedColumn[];
    words: Record<string, { words: string[]; runs: [number, number][] }>;
    block: number;
}

export interface Payload {
    schema_id: "navbound-report-1";
    summary: Summary;
    record: RunRecord;
    waypoints: Waypoint[];
    charts: DeclaredChart[];
    utc_offset_s: number;
    gps_epoch_unix_s: number;
    /** Polylines of longitude, latitude in thousandths of a degree, differenced. */
    coastline: number[][];
    /** Rings of land and of the lakes in it, likewise. */
    land: number[][];
    /** South, west, north and east of the grid of an augmentation service, and its coastline; null where a run was corrected by none. */
    service_map: { region_deg: [number, number, number, number]; coastline: number[][] } | null;
    /** Airports at the ends of tracks. */
    airports: Waypoint[];
    tracks: PackedTrack[];
    /** Satellites heard by each receiver, where positions were solved. */
    heard: PackedTrack[];
    /** What may become of a satellite: words by id. */
    fates: Record<string, string>;
}
