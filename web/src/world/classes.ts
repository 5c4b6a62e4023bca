// Classes of a layer: where they part, and their colours. Pure functions.

import type { Layer, MapGrid } from "./records.ts";

export interface Class {
    /** Above this, up to `to`; the class of what does not exist has neither. */
    from: number;
    to: number;
    fill: string;
    words: string;
}

/** Dark to bright, distinguishable without colour (viridis, CC0). */
export const BRIGHT = ["#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725"];
/** Beyond the limit: another family. */
const BEYOND = ["#c9a27c", "#8a5a33"];
const SHARES = [50, 90, 95, 99, 99.5, 99.9];

export const NONE_WORDS = "none";

export function classes(layer: Layer): Class[] {
    const breaks = layer.unit === "%" ? [-Infinity, ...SHARES, Infinity] : bounds(layer);
    const within = layer.limit === null ? breaks.length - 1 : breaks.slice(1).filter((to) => to <= layer.limit!).length;
    return breaks.slice(1).map((to, i) => {
        const from = breaks[i]!;
        // More is better for a share, less for an error.
        const place = layer.unit === "%" ? i / (breaks.length - 2) : 1 - i / Math.max(1, within - 1);
        const fill = i < within ? BRIGHT[Math.round(place * (BRIGHT.length - 1))]! : BEYOND[Math.min(i - within, 1)]!;
        return { from, to, fill, words: words(layer, from, to) };
    });
}

function words(layer: Layer, above: number, upTo: number): string {
    const [from, to] = [round(above), round(upTo)];
    const unit = layer.unit === "1" ? "" : ` ${layer.unit}`;
    // Availability counts what is reached, an error what is not exceeded.
    if (layer.unit === "%") return to === Infinity ? `at least ${from}${unit}` : from === -Infinity ? `below ${to}${unit}` : `${from} to ${to}${unit}`;
    return to === Infinity ? `above ${from}${unit}` : from === -Infinity ? `up to ${to}${unit}` : `${from} to ${to}${unit}`;
}

/** Round numbers over the spread of the values, up to the limit where there is one. */
function bounds(layer: Layer): number[] {
    const sorted = layer.values.filter(Number.isFinite).sort();
    if (sorted.length === 0) return [-Infinity, layer.limit ?? Infinity, ...(layer.limit === null ? [] : [Infinity])];
    const at = (share: number): number => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))]!;
    const low = at(0.01);
    const high = layer.limit === null ? at(0.99) : layer.limit;
    const edges = [-Infinity, ...steps(Math.min(low, high), high)];
    if (layer.limit !== null) {
        if (edges.at(-1) !== layer.limit) edges.push(layer.limit);
        if (at(1) > 1.5 * layer.limit) edges.push(round(1.5 * layer.limit));
    }
    return [...edges, Infinity];
}

/** Up to six multiples of a round step inside an interval. */
export function steps(low: number, high: number): number[] {
    const span = high - low;
    if (!(span > 0)) return [];
    const decade = 10 ** Math.floor(Math.log10(span / 6));
    const step = [1, 2, 2.5, 5, 10].map((f) => f * decade).find((s) => span / s <= 6)!;
    const multiples: number[] = [];
    for (let k = Math.floor(low / step) + 1; k * step < high - 1e-9 * step && multiples.length < 6; k++) multiples.push(round(k * step));
    return multiples;
}

function round(value: number): number {
    return Number(value.toPrecision(6));
}

/** Which class a value belongs to; -1 where there is none. */
export function classOf(value: number, all: Class[], share: boolean): number {
    if (!Number.isFinite(value)) return -1;
    return all.findIndex((c) => (share ? value >= c.from && value < c.to : value > c.from && value <= c.to));
}

/** Share of the area in every class, and last without a value; cells weigh by the cosine of their latitude. */
export function areas(layer: Layer, all: Class[], grid: MapGrid): number[] {
    const areas = new Array<number>(all.length + 1).fill(0);
    let whole = 0;
    for (let row = 0; row < grid.n_lat; row++) {
        const weight = Math.cos(grid.south_rad + (row + 0.5) * grid.step_rad);
        for (let column = 0; column < grid.n_lon; column++) {
            const of = classOf(layer.values[row * grid.n_lon + column]!, all, layer.unit === "%");
            areas[of < 0 ? all.length : of]! += weight;
            whole += weight;
        }
    }
    return areas.map((area) => area / whole);
}
