// The regions of a Stanford diagram: where they lie, and which of them a bin of the histogram is in. Pure functions.

import type { StanfordBins, StanfordCounts } from "../records.gen.ts";

export type RegionId = "nominal" | "mi" | "hmi" | "unavailable" | "unavailable_mi";

export interface Region {
    id: RegionId;
    /** As written into the diagram. */
    name: string;
    /** As said. */
    words: string;
    count: (c: StanfordCounts) => number;
}

export const REGIONS: Region[] = [
    { id: "nominal", name: "Nominal", words: "Nominal: available, error within level", count: (c) => c.n_nominal },
    { id: "mi", name: "MI", words: "Misleading information: available, error beyond level, within limit", count: (c) => c.n_mi },
    { id: "hmi", name: "HMI", words: "Hazardously misleading information: available, error beyond limit", count: (c) => c.n_hmi },
    { id: "unavailable", name: "Unavailable", words: "Unavailable: level at or beyond limit, error within level", count: (c) => c.n_unavailable },
    { id: "unavailable_mi", name: "Unavail., MI", words: "Unavailable and misleading: level at or beyond limit, error beyond level", count: (c) => c.n_unavailable_mi },
];

/** What a diagram shows of both axes: from zero to `shown_m`, and all beyond it in a band at the edge. */
export interface Frame {
    limit_m: number;
    shown_m: number;
    /** The alert limit is on the axes, so that all five regions are drawn. */
    limitShown: boolean;
    /** They have room for their names too. */
    roomBeyond: boolean;
}

const STEPS_M = [5, 10, 15, 20, 25, 30, 40, 50, 60, 80, 100, 150, 200, 300, 400, 500, 600, 800, 1000];
/** How far beyond the limit the axes go, so that what lies there has room. */
const BEYOND = 1.3;
/** A limit nearer to the end leaves no room for names beyond it. */
const LEAST_ROOM = 0.84;

export function frameOf(bins: StanfordBins, limit_m: number): Frame {
    // A limit at the very end of the histogram parts the band at the edge from the rest.
    if (limit_m >= bins.limit_m) return { limit_m, shown_m: bins.limit_m, limitShown: limit_m === bins.limit_m, roomBeyond: false };
    let largest = 0;
    const beyond = Math.round(bins.limit_m / bins.bin_m);
    for (const list of [bins.error_bin, bins.level_bin]) for (const k of list) if (k < beyond && k + 1 > largest) largest = k + 1;
    const required = Math.max(BEYOND * limit_m, largest * bins.bin_m);
    const step = STEPS_M.find((s) => s >= required) ?? bins.limit_m;
    const shown_m = Math.min(bins.limit_m, step);
    return { limit_m, shown_m, limitShown: true, roomBeyond: limit_m <= LEAST_ROOM * shown_m };
}

/** Region of a bin by its indices. On the diagonal a bin may hold both sides: it is taken for the better one, the counts are exact. */
export function regionOf(error_bin: number, level_bin: number, bin_m: number, frame: Frame): RegionId {
    const misleading = error_bin > level_bin;
    // A limit beyond the axis cannot be told from the band at the edge.
    const limit = frame.limitShown ? Math.round(frame.limit_m / bin_m) : Infinity;
    if (level_bin >= limit) return misleading ? "unavailable_mi" : "unavailable";
    if (error_bin >= limit) return "hmi";
    return misleading ? "mi" : "nominal";
}

/** The band at the edge as a share of the shown square. */
export const EDGE = 0.03;

/** Corners of a region in shares of the shown square, error to the right, level upwards; the band at the edge belongs to it. */
export function outline(id: RegionId, frame: Frame): [number, number][] {
    const a = frame.limitShown ? frame.limit_m / frame.shown_m : 1;
    const e = 1 + EDGE;
    const corners: Record<RegionId, [number, number][]> = {
        nominal: [[0, 0], [a, a], [0, a]],
        mi: [[0, 0], [a, 0], [a, a]],
        hmi: [[a, 0], [e, 0], [e, a], [a, a]],
        unavailable: [[0, a], [a, a], [e, e], [0, e]],
        unavailable_mi: [[a, a], [e, a], [e, e]],
    };
    return corners[id];
}

export interface Place {
    x: number;
    y: number;
    anchor: "start" | "middle" | "end";
}

/** Room that a name with its two numbers takes, to each side and above and below, in shares of the square. */
const HALF_NAME = { x: 0.1, y: 0.06 };

/** Where a region's name stands: of the places that it may take, the one that covers the fewest bins. Null where the region is not shown. */
export function nameAt(id: RegionId, frame: Frame, bins: StanfordBins): Place | null {
    if (!frame.roomBeyond && id !== "nominal" && id !== "mi") return null;
    const a = frame.limitShown ? frame.limit_m / frame.shown_m : 1;
    const middle = (x: number, y: number): Place => ({ x, y, anchor: "middle" });
    const places: Record<RegionId, Place[]> = {
        nominal: [middle(0.42 * a, 0.8 * a), middle(0.6 * a, 0.86 * a), middle(0.3 * a, 0.6 * a)],
        mi: [middle(0.68 * a, 0.26 * a), middle(0.86 * a, 0.12 * a), middle(0.8 * a, 0.5 * a), middle(0.45 * a, 0.12 * a)],
        hmi: [0.55, 0.15, 0.88, 0.35, 0.72].map((f) => middle((1 + a) / 2, f * a)),
        unavailable: [0.42, 0.65, 0.2].map((f) => middle(f * a, (1 + a) / 2)),
        unavailable_mi: [{ x: 0.985, y: a + 0.27 * (1 - a), anchor: "end" }],
    };
    const covered = (p: Place): number => {
        let n = 0;
        for (let i = 0; i < bins.count.length; i++) {
            const [x, y] = [(bins.error_bin[i]! * bins.bin_m) / frame.shown_m, (bins.level_bin[i]! * bins.bin_m) / frame.shown_m];
            if (Math.abs(x - p.x) < HALF_NAME.x && Math.abs(y - p.y) < HALF_NAME.y) n += 1;
        }
        return n;
    };
    return places[id].map((place) => ({ place, n: covered(place) })).sort((p, q) => p.n - q.n)[0]!.place;
}

export interface Pixel {
    /** Lower left corner and size, in bins. */
    x: number;
    y: number;
    size: number;
    count: number;
}

/** Bins joined `size` by `size`, their counts added; the fullest last. */
export function join(bins: StanfordBins, size: number): Pixel[] {
    const sums = new Map<number, Pixel>();
    bins.count.forEach((count, i) => {
        const [x, y] = [Math.floor(bins.error_bin[i]! / size), Math.floor(bins.level_bin[i]! / size)];
        const key = x * 65536 + y;
        const pixel = sums.get(key);
        if (pixel === undefined) sums.set(key, { x: x * size, y: y * size, size, count });
        else pixel.count += count;
    });
    return [...sums.values()].sort((a, b) => a.count - b.count);
}

/** Depth of colour of a count: its logarithm between one and the largest, never nothing. */
export function depth(count: number, largest: number): number {
    return 0.3 + 0.7 * (largest > 1 ? Math.log(count) / Math.log(largest) : 1);
}
