// What the page of a map receives: its records as Python declares them, and its columns.

import { unpack, type PackedColumn } from "../data/packing.ts";
import type { MapRecord, MapSummary } from "../records.gen.ts";

export type { MapGrid, MapSummary } from "../records.gen.ts";

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
    const layers: Layer[] = [];
    const share = values.get(AVAILABLE);
    if (share !== undefined && summary.n_epochs > 1) layers.push({ id: AVAILABLE, title: "Availability", unit: "%", limit: null, values: share.map((v) => wholeEpochs(v, summary.n_epochs)) });
    for (const column of summary.columns) {
        const limit = summary.limits.find((one) => one.column === column.name)?.limit ?? null;
        const of = (id: string, title: string): void => {
            const numbers = values.get(id);
            if (numbers !== undefined) layers.push({ id, title, unit: column.unit, limit, values: numbers });
        };
        if (summary.n_epochs === 1) of(column.name, column.title);
        for (const percentile of summary.percentiles) of(percentileName(column.name, percentile), `${column.title}, ${percentile} % of the time`);
    }
    return layers;
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
