// The epoch table of one track.

import type { ColumnName, WordColumn } from "../columns.gen.ts";
import type { SeriesColumn, SeriesWord } from "./buckets.ts";
import type { HeardColumn, HeardWord } from "./heard.ts";
import { inflate, unpack } from "./packing.ts";
import type { PackedTrack, Payload } from "./records.ts";
import { expand, runsOf, type Run } from "./runs.ts";

/** What a chart may ask for. A name that the list of columns does not show in a report is an error of type, not an empty chart. */
export type NumberName = ColumnName | SeriesColumn | HeardColumn;
export type WordName = WordColumn | SeriesWord | HeardWord;

function expanded(head: PackedTrack): Map<string, (string | null)[]> {
    return new Map(Object.entries(head.words).map(([name, packed]) => [name, expand(packed.words, packed.runs)]));
}

export class Table {
    readonly n: number;
    readonly track: string;
    /** Seconds since the first epoch. */
    readonly elapsed_s: Float64Array;
    /** Unix time of the first epoch, UTC. */
    readonly start_utc_s: number;
    /** Spans without a usable position or bound, with the reason given. */
    readonly unavailable: Run[];
    /** Epochs after which so much time passes without one that no line may cross it. */
    readonly breaks: number[];
    private readonly numbers: Map<string, Float64Array>;
    private readonly words: Map<string, (string | null)[]>;

    constructor(head: PackedTrack, numbers: Map<string, Float64Array>, start_utc_s: number, words = expanded(head)) {
        this.n = head.n;
        this.track = head.track;
        this.numbers = numbers;
        this.elapsed_s = numbers.get("elapsed_s") ?? new Float64Array(head.n);
        this.start_utc_s = start_utc_s;
        this.words = words;
        this.unavailable = this.findUnavailable();
        this.breaks = head.breaks;
    }

    static async open(payload: Payload, head: PackedTrack, base64: string): Promise<Table> {
        const numbers = unpack(await inflate(base64), head.columns, head.n);
        // Whole seconds and nanoseconds apart: together they do not fit a number exactly.
        const ns = BigInt(head.start_ns);
        const start = Number(ns / 1_000_000_000n) + Number(ns % 1_000_000_000n) * 1e-9;
        return new Table(head, numbers, start + payload.gps_epoch_unix_s - payload.utc_offset_s);
    }

    has(name: NumberName): boolean {
        return this.numbers.has(name);
    }

    column(name: NumberName): Float64Array | undefined {
        return this.numbers.get(name);
    }

    /** NaN when the column or the value is absent. */
    value(name: NumberName, i: number): number {
        return this.numbers.get(name)?.[i] ?? NaN;
    }

    word(name: WordName, i: number): string | null {
        return this.words.get(name)?.[i] ?? null;
    }

    wordColumn(name: WordName): (string | null)[] | undefined {
        return this.words.get(name);
    }

    utc_s(i: number): number {
        return this.start_utc_s + (this.elapsed_s[i] ?? NaN);
    }

    /** Index of the epoch nearest to a time since the start. */
    nearest(elapsed_s: number): number {
        let low = 0;
        let high = this.n - 1;
        while (high - low > 1) {
            const middle = (low + high) >> 1;
            if (this.elapsed_s[middle]! <= elapsed_s) low = middle;
            else high = middle;
        }
        return Math.abs(this.elapsed_s[high]! - elapsed_s) < Math.abs(this.elapsed_s[low]! - elapsed_s) ? high : low;
    }

    /** Distance along the path never runs backwards, so that it can be an axis. */
    get alongIsAxis(): boolean {
        const along = this.numbers.get("along_m");
        if (along === undefined || this.n < 2) return false;
        for (let i = 1; i < this.n; i++) if (!(along[i]! >= along[i - 1]!)) return false;
        return along[this.n - 1]! > along[0]!;
    }

    private findUnavailable(): Run[] {
        const status = this.words.get("status");
        const alert = this.words.get("alert");
        const reason = this.words.get("reason");
        if (status === undefined && alert === undefined) return [];
        const labels = Array.from({ length: this.n }, (_, i) => {
            const s = status?.[i] ?? "ok";
            if (s !== "not_available" && s !== "invalid_input" && alert?.[i] !== "unavailable") return null;
            return reason?.[i] ?? (s === "ok" ? "unavailable" : s.replace("_", " "));
        });
        return runsOf(labels).filter((run) => run.label !== null);
    }
}
