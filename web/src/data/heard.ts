// The satellites that were heard, one by one, at the epochs of the track that is shown.

import { blockOf } from "./others.ts";
import type { PackedTrack, Payload } from "./records.ts";
import { runsOf } from "./runs.ts";
import { Table } from "./table.ts";

export interface Satellite {
    sv: string;
    /** Index of the track's epoch for each of its own; a satellite is not heard at all of them. */
    at: number[];
    az_rad: Float64Array;
    el_rad: Float64Array;
    residual_m: Float64Array;
    cn0_dbhz: Float64Array;
    fate: (string | null)[];
}

/** Those of the track's receiver; none where the run solved no positions. A track that is a part of a recording begins with its name. */
export async function heardOf(payload: Payload, table: Table): Promise<Satellite[]> {
    const head = payload.heard.find((h) => h.track === table.track || table.track.startsWith(`${h.track} `));
    if (head === undefined) return [];
    return satellitesOf(await Table.open(payload, head, blockOf(head)), table);
}

/** The epochs at which any satellite is stated, as the table of a track that has no other. */
export function epochsOf(head: PackedTrack, rows: Table): Table {
    const elapsed_s = Float64Array.from(new Set(rows.elapsed_s)).sort();
    return new Table({ ...head, n: elapsed_s.length, columns: [], words: {} }, new Map([["elapsed_s", elapsed_s]]), rows.start_utc_s);
}

/** Each satellite at the epochs of a table. */
export function satellitesOf(rows: Table, table: Table): Satellite[] {
    return runsOf(rows.wordColumn("sv") ?? []).flatMap(({ label, from, to }) => {
        // An epoch without a position is not in the track.
        const here = Array.from({ length: to - from + 1 }, (_, k) => from + k).map((i) => ({ i, at: epochOf(rows, i, table) })).filter(({ at }) => at >= 0);
        const column = (name: "az_rad" | "el_rad" | "residual_m" | "cn0_dbhz"): Float64Array => Float64Array.from(here, ({ i }) => rows.value(name, i));
        return label === null || here.length === 0 ? [] : [{
            sv: label, at: here.map(({ at }) => at), fate: here.map(({ i }) => rows.word("fate", i)),
            az_rad: column("az_rad"), el_rad: column("el_rad"), residual_m: column("residual_m"), cn0_dbhz: column("cn0_dbhz"),
        }];
    });
}

function epochOf(rows: Table, i: number, table: Table): number {
    const elapsed_s = rows.utc_s(i) - table.start_utc_s;
    const k = table.nearest(elapsed_s);
    return Math.abs(table.elapsed_s[k]! - elapsed_s) < 1e-3 ? k : -1;
}

/** Values of a satellite at the track's epochs, NaN where it has none. */
export function atEpochs(of: Satellite, values: Float64Array, n: number): Float64Array {
    const out = new Float64Array(n).fill(NaN);
    of.at.forEach((epoch, k) => { out[epoch] = values[k]!; });
    return out;
}

/** Index of a satellite's row at an epoch; -1 where it is not heard. */
export function rowAt(of: Satellite, epoch: number): number {
    let [low, high] = [0, of.at.length - 1];
    while (low < high) {
        const middle = (low + high) >> 1;
        if (of.at[middle]! < epoch) low = middle + 1;
        else high = middle;
    }
    return of.at[low] === epoch ? low : -1;
}

/** The columns and words of satellites, which no epoch has. */
export type HeardColumn = "az_rad" | "el_rad" | "residual_m" | "cn0_dbhz";
export type HeardWord = "sv" | "fate";
