// The series of a performance evaluation as a table, so that the charts of epochs draw it too.

import type { KpiSeries, LevelResult, Performance } from "../records.gen.ts";
import type { PackedTrack, Payload } from "./records.ts";
import { Table } from "./table.ts";

/** Name of the table's track: no flight has it. */
export const BUCKETS = "\u0000performance";

const NUMBERS = ["hpe_max_m", "vpe_max_m", "hpl_min_m", "hpl_max_m", "vpl_min_m", "vpl_max_m"] as const;

/** Columns of the series, which no epoch has. */
export type SeriesColumn = (typeof NUMBERS)[number] | ReturnType<typeof unavailableOf>;
export type SeriesWord = ReturnType<typeof causeOf>;

/** Buckets in order; an empty one stands where time passes without a bucket, so that no line crosses it. */
export function rowsOf(series: KpiSeries): (number | null)[] {
    return series.start_ns.flatMap((start, i) => {
        const before = series.start_ns[i - 1];
        // Half a bucket of slack: times beyond 2^53 ns are rounded.
        return before !== undefined && start - before > 1.5 * series.width_ns ? [null, i] : [i];
    });
}

export function bucketTable(performance: Performance, payload: Payload): Table {
    const { series } = performance;
    const rows = rowsOf(series);
    const column = (of: (i: number) => number | null): Float64Array => Float64Array.from(rows, (i) => (i === null ? NaN : of(i) ?? NaN));
    const first = series.start_ns[0] ?? performance.first_ns;
    const numbers = new Map<string, Float64Array>(NUMBERS.map((name) => [name, column((i) => series[name][i] ?? null)]));
    numbers.set("elapsed_s", Float64Array.from(rows, (i, k) => (i === null ? (series.start_ns[rows[k - 1]!]! - first + series.width_ns) / 1e9 : (series.start_ns[i]! - first) / 1e9)));
    for (const { level } of performance.levels) numbers.set(unavailableOf(level.id), column((i) => 1 - (series.n_available[level.id]?.[i] ?? 0) / series.n_expected[i]!));
    const head: PackedTrack = { track: BUCKETS, n: rows.length, start_ns: String(first), breaks: [], columns: [], words: {}, block: -1 };
    const words = new Map<string, (string | null)[]>(performance.levels.map(({ level }) => [causeOf(level.id), rows.map((i) => (i === null ? null : series.cause[level.id]?.[i] || AVAILABLE))]));
    words.set("status", rows.map((i) => (i !== null && series.n_solution[i] === 0 ? "not_available" : "ok")));
    words.set("reason", rows.map((i) => (i !== null && series.n_solution[i] === 0 ? "no solution" : null)));
    return new Table(head, numbers, first / 1e9 + payload.gps_epoch_unix_s - payload.utc_offset_s, words);
}

/** Word of a bucket at all of whose epochs the level was available. */
export const AVAILABLE = "available";

/** Share of the bucket's expected epochs at which the level was not available. */
export function unavailableOf(level: string): `unavailable ${string}` {
    return `unavailable ${level}`;
}

export function causeOf(level: string): `cause ${string}` {
    return `cause ${level}`;
}

/** A page that shows nothing but the buckets: hazards and misleading information of one level are its alerts. */
export function payloadOf(payload: Payload, performance: Performance, result: LevelResult): Payload {
    const kinds = { hazard: "warning", mi: "caution", loss: "loss" };
    const events = performance.events.filter((e) => e.level === result.level.id && e.kind !== "loss").map((e) => ({
        track: BUCKETS, kind: kinds[e.kind], onset_ns: e.onset_ns, annunciation_ns: null, clear_ns: e.clear_ns, peak_m: null, limit_m: null, min_margin_m: null, words: e.reason,
    }));
    return { ...payload, summary: { ...payload.summary, events } };
}
