// Ranges and tick positions: pure functions.

export type Extent = [number, number];

/** Smallest and largest value of some series between two indices; mirrored series count on both sides. */
export function extent(lines: { values: Float64Array; mirror?: boolean }[], from: number, to: number, floor: number | null): Extent {
    let low = Infinity;
    let high = -Infinity;
    for (const line of lines) {
        const last = Math.min(to, line.values.length - 1);
        for (let i = from; i <= last; i++) {
            let v = line.values[i]!;
            if (!Number.isFinite(v)) continue;
            if (floor !== null && v < floor) v = floor;
            if (v < low) low = v;
            if (v > high) high = v;
            if (line.mirror && -v < low) low = -v;
        }
    }
    if (low > high) return floor === null ? [0, 1] : [floor, 1];
    // Lengths start at zero; a chart that does not shows differences larger than they are.
    return floor === null ? [Math.min(0, low), Math.max(0, high)] : [low, high];
}

/** Smallest and largest value, without a zero that no value is near. */
export function bare(lines: { values: Float64Array }[], from: number, to: number): Extent {
    let [low, high] = [Infinity, -Infinity];
    for (const { values } of lines) {
        for (const v of values.subarray(from, to + 1)) {
            if (!Number.isFinite(v)) continue;
            low = Math.min(low, v);
            high = Math.max(high, v);
        }
    }
    return low > high ? [0, 1] : [low, high];
}

const CLOCK_STEPS_S = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400];

/** Times at round clock values, at least `space` pixels apart. */
export function clockTicks(min: number, max: number, space: number, width: number): number[] {
    const least = ((max - min) * Math.max(space, 70)) / Math.max(width, 1);
    const step = CLOCK_STEPS_S.find((s) => s >= least) ?? 86400 * Math.ceil(least / 86400);
    const ticks: number[] = [];
    for (let t = Math.ceil(min / step) * step; t <= max; t += step) ticks.push(t);
    return ticks;
}

/** Zero and the powers of ten from the threshold up, on both sides. */
export function asinhTicks(min: number, max: number, threshold: number): number[] {
    const positive: number[] = [];
    const largest = Math.max(-min, max);
    for (let t = threshold; t <= largest; t *= 10) positive.push(t);
    return [...positive.filter((t) => -t >= min).map((t) => -t).reverse(), 0, ...positive.filter((t) => t <= max)];
}

/** Moves labels apart vertically, keeping their order, within limits. */
export function spread(requested: number[], least: number, top: number, bottom: number): number[] {
    const order = requested.map((_, i) => i).sort((a, b) => requested[a]! - requested[b]!);
    const placed = requested.slice();
    let previous = top - least;
    for (const i of order) {
        placed[i] = Math.max(requested[i]!, previous + least);
        previous = placed[i]!;
    }
    let next = bottom + least;
    for (const i of order.reverse()) {
        placed[i] = Math.min(placed[i]!, next - least);
        next = placed[i]!;
    }
    return placed;
}

/** Indices of values with no value on either side. */
export function isolated(values: Float64Array): number[] {
    const single: number[] = [];
    for (let i = 0; i < values.length; i++) {
        if (Number.isFinite(values[i]!) && !Number.isFinite(values[i - 1] ?? NaN) && !Number.isFinite(values[i + 1] ?? NaN)) single.push(i);
    }
    return single;
}
