// What became of the satellites, by colour and by word.

import type { Payload } from "../data/records.ts";
import type { Colour } from "../show/theme.ts";

export const USED = "used";
export const EXCLUDED = "excluded";

/** Green is a satellite in the position, amber one that a test left out; the others take no part. */
export function hueOf(fate: string | null): Colour {
    return fate === USED ? "normal" : fate === EXCLUDED ? "caution" : "muted";
}

export function wordsOf(payload: Payload, fate: string | null): string {
    return fate === null ? "not heard" : payload.fates[fate] ?? fate;
}

/** Whether only the satellites of solutions are listed: a service's corrections say of the others why in words alone. */
export function ofSolutions(payload: Payload): boolean {
    return (payload.summary.performance?.service ?? null) !== null;
}

const SYSTEMS: Record<string, { name: string; hue: Colour; dash?: number[] }> = {
    G: { name: "GPS", hue: "m1" }, E: { name: "Galileo", hue: "m2", dash: [6, 2] }, C: { name: "BeiDou", hue: "m3", dash: [2, 2] },
};

export function systemOf(sv: string): { name: string; hue: Colour; dash?: number[] } {
    return SYSTEMS[sv[0] ?? ""] ?? { name: sv[0] ?? "", hue: "m4" };
}
