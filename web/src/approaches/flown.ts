// The columns of all embedded approaches that are laid over one another, read after the first picture stands.

import type { DeviationBand } from "../records.gen.ts";
import { blockOf } from "../data/others.ts";
import { inflate, unpack } from "../data/packing.ts";
import type { PackedTrack, Payload } from "../data/records.ts";
import { expand } from "../data/runs.ts";

export interface Flown {
    track: string;
    label: string;
    runway: string | null;
    along_m: Float64Array;
    values: Partial<Record<DeviationBand["column"], Float64Array>>;
}

export async function flownOf(payload: Payload): Promise<Flown[]> {
    const labels = new Map(payload.summary.tracks.map((t) => [t.track, t.label]));
    return (await Promise.all(payload.tracks.map((head) => one(head, labels.get(head.track) ?? head.track)))).filter((f) => f !== null);
}

async function one(head: PackedTrack, label: string): Promise<Flown | null> {
    const columns = unpack(await inflate(blockOf(head)), head.columns, head.n, ["along_m", "fte_m", "fte_v_m", "est_h_m"]);
    const along_m = columns.get("along_m");
    const legs = head.words["leg"];
    if (along_m === undefined || legs === undefined) return null;
    const values: Flown["values"] = {};
    for (const name of ["fte_m", "fte_v_m", "est_h_m"] as const) if (columns.has(name)) values[name] = columns.get(name)!;
    return { track: head.track, label, runway: expand(legs.words, legs.runs).find((leg) => leg !== null) ?? null, along_m, values };
}
