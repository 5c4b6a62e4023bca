// The records of a map as the page receives them; names and meanings are those of python/navbound/records/maps.py.

import { unpack, type PackedColumn } from "../data/packing.ts";

export interface MapColumn {
    name: string;
    title: string;
    unit: "1" | "m";
    typical: Record<string, number | null>;
}

export interface MapLimit {
    column: string;
    limit: number;
    source: string;
    provenance: string;
}

export interface MapGrid {
    step_rad: number;
    south_rad: number;
    north_rad: number;
    west_rad: number;
    east_rad: number;
    n_lat: number;
    n_lon: number;
}

export interface MapSummary {
    kind: string;
    title: string;
    words: string;
    source: string;
    grid: MapGrid;
    n_epochs: number;
    percentiles: number[];
    columns: MapColumn[];
    limits: MapLimit[];
    coverage: { available: number; share: number }[];
    available_mean: number;
    outcomes: { name: string; title: string; share: number }[];
    worst: { lat_rad: number; lon_rad: number; available: number; share: number };
    assumptions: string[];
}

export interface MapRecord {
    navbound_version: string;
    command: string;
    created_utc: string;
    options: Record<string, string>;
    inputs: Record<string, string>;
    backend: string;
    n_tiles: number;
    platform: string;
}

export interface World {
    schema_id: "navbound-world-1";
    summary: MapSummary;
    record: MapRecord;
    columns: PackedColumn[];
    /** Columns that this page has no room for. */
    left_out: string[];
    coastline: number[][];
}

/** One thing that the map can show. */
export interface Layer {
    id: string;
    title: string;
    unit: "%" | "1" | "m";
    limit: number | null;
    values: Float64Array;
}

export const AVAILABLE = "share_available";

/** Availability, then every column at every percentile, in the order of the summary. */
export function layers(world: World, bytes: Uint8Array): Layer[] {
    const { summary } = world;
    const values = unpack(bytes, world.columns, summary.grid.n_lat * summary.grid.n_lon);
    const found: Layer[] = [];
    const share = values.get(AVAILABLE);
    if (share !== undefined && summary.n_epochs > 1) found.push({ id: AVAILABLE, title: "Availability", unit: "%", limit: null, values: share.map((v) => wholeEpochs(v, summary.n_epochs)) });
    for (const column of summary.columns) {
        const limit = summary.limits.find((one) => one.column === column.name)?.limit ?? null;
        const of = (id: string, title: string): void => {
            const numbers = values.get(id);
            if (numbers !== undefined) found.push({ id, title, unit: column.unit, limit, values: numbers });
        };
        if (summary.n_epochs === 1) of(column.name, column.title);
        for (const percentile of summary.percentiles) of(percentileName(column.name, percentile), `${column.title}, ${percentile} % of the time`);
    }
    return found;
}

/** A share of whole epochs in per cent: what the packing rounded is undone, so that all epochs are 100 %. */
function wholeEpochs(share: number, n: number): number {
    return (100 * Math.round(share * n)) / n;
}

/** As python/navbound/maps/statistics.py names it. */
export function percentileName(column: string, percentile: number): string {
    const digits = `p${String(percentile).replace(".", "")}`;
    return column.endsWith("_m") ? `${column.slice(0, -2)}_${digits}_m` : `${column}_${digits}`;
}
