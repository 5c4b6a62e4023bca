// Lines of equal value between the middles of cells, by marching squares, and places for their names. Pure functions.

import type { MapGrid } from "./records.ts";

/** Points in cells from the south-west corner of the region: column, row. A closed line ends where it begins. */
export type Line = [column: number, row: number][];

const TURN = 2 * Math.PI;

/** The region goes around the Earth: its last column lies beside its first. */
export function around(grid: MapGrid): boolean {
    return Math.abs(grid.n_lon * grid.step_rad - TURN) < 1e-6;
}

/**
 * Where a field of cells reaches a level, linearly between the middles of four neighbours. What has a corner without a value has no line.
 * Around the Earth the squares between the last column and the first are drawn at both edges, so that lines run on to them.
 */
export function contours(values: Float64Array, grid: MapGrid, level: number): Line[] {
    const wraps = around(grid);
    const at = (column: number, row: number): number => values[row * grid.n_lon + ((column + grid.n_lon) % grid.n_lon)]!;
    const points = new Map<string, [number, number]>();
    const beside = new Map<string, string[]>();
    const meet = (from: Crossing, to: Crossing): void => {
        for (const [one, other] of [[from, to], [to, from]] as const) {
            points.set(one.key, one.point);
            beside.set(one.key, [...(beside.get(one.key) ?? []), other.key]);
        }
    };
    for (let row = 0; row < grid.n_lat - 1; row++) {
        for (let column = wraps ? -1 : 0; column < grid.n_lon - (wraps ? 0 : 1); column++) {
            const corners = [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)] as const;
            // Most squares lie on one side, and a fine map has a million of them.
            if (corners.every((v) => v >= level) || !corners.some((v) => v >= level)) continue;
            for (const [from, to] of square(column, row, corners, level)) meet(from, to);
        }
    }
    return joined(points, beside);
}

interface Crossing {
    /** Names the side of the square, so that neighbours meet there. */
    key: string;
    point: [number, number];
}

/** Pieces of a line in the square of four middles, which stand from the south-west one against the clock. */
function square(column: number, row: number, [sw, se, ne, nw]: readonly [number, number, number, number], level: number): [Crossing, Crossing][] {
    if (![sw, se, ne, nw].every(Number.isFinite)) return [];
    const between = (key: string, x: number, y: number, from: number, to: number, east: boolean): Crossing | null => {
        if (from >= level === to >= level) return null;
        const t = (level - from) / (to - from);
        return { key, point: [x + 0.5 + (east ? t : 0), y + 0.5 + (east ? 0 : t)] };
    };
    const south = between(`e${column},${row}`, column, row, sw, se, true);
    const east = between(`n${column + 1},${row}`, column + 1, row, se, ne, false);
    const north = between(`e${column},${row + 1}`, column, row + 1, nw, ne, true);
    const west = between(`n${column},${row}`, column, row, sw, nw, false);
    const crossed = [south, east, north, west].filter((c) => c !== null);
    if (crossed.length < 4) return crossed.length === 2 ? [[crossed[0]!, crossed[1]!]] : [];
    // Two opposite corners reach the level: whether they hang together the middle of the square says.
    const connected = (sw + se + ne + nw) / 4 >= level;
    return sw >= level === connected ? [[south!, east!], [north!, west!]] : [[south!, west!], [north!, east!]];
}

/** Pieces that share a point as lines: first those with ends, then what is closed. */
function joined(points: Map<string, [number, number]>, beside: Map<string, string[]>): Line[] {
    const lines: Line[] = [];
    const seen = new Set<string>();
    const follow = (begin: string): void => {
        const line: Line = [];
        let [now, closed] = [begin as string | undefined, false];
        while (now !== undefined) {
            seen.add(now);
            line.push(points.get(now)!);
            const next: string[] = beside.get(now)!;
            closed = line.length > 2 && next.includes(begin);
            now = next.find((key) => !seen.has(key));
        }
        lines.push(closed ? [...line, line[0]!] : line);
    };
    for (const [key, next] of beside) if (next.length === 1 && !seen.has(key)) follow(key);
    for (const key of beside.keys()) if (!seen.has(key)) follow(key);
    return lines;
}

/** Those of the levels that the values tell apart: a line has cells on both sides, and one between it and the next higher line. */
export function worthDrawing(values: Float64Array, levels: readonly number[]): number[] {
    const some = (from: number, to: number): boolean => values.some((v) => v >= from && v < to);
    return levels.filter((level, i) => some(-Infinity, level) && some(level, levels[i + 1] ?? Infinity));
}

export interface Place {
    x: number;
    y: number;
    /** Clockwise, upright [deg]. */
    turn_deg: number;
}

/** Where along lines of the picture a name of some width fits: on the longest first, away from the edges and from what is taken. */
export function places(lines: Line[], room: { left: number; top: number; right: number; bottom: number }, width: number, most: number, taken: Place[]): Place[] {
    const selected: Place[] = [];
    const free = (p: Place): boolean => p.x > room.left + width && p.x < room.right - width && p.y > room.top + width / 2 && p.y < room.bottom - width / 2
        && [...taken, ...selected].every((other) => Math.hypot(other.x - p.x, other.y - p.y) > 1.6 * width);
    const measured = lines.map((line) => ({ line, sums: lengths(line) })).sort((a, b) => b.sums.at(-1)! - a.sums.at(-1)!);
    for (const { line, sums } of measured) {
        const whole = sums.at(-1)!;
        if (selected.length >= most || whole < 4 * width) break;
        for (const share of [0.5, 0.3, 0.7, 0.15, 0.85]) {
            const [from, to] = [along(line, sums, share * whole - width / 2), along(line, sums, share * whole + width / 2)];
            // A bend would lie under the name.
            if (Math.hypot(to[0] - from[0], to[1] - from[1]) < 0.85 * width) continue;
            const [x, y] = along(line, sums, share * whole);
            const place = { x, y, turn_deg: upright((180 / Math.PI) * Math.atan2(to[1] - from[1], to[0] - from[0])) };
            if (!free(place)) continue;
            selected.push(place);
            break;
        }
    }
    return selected;
}

function upright(turn_deg: number): number {
    return turn_deg > 90 ? turn_deg - 180 : turn_deg < -90 ? turn_deg + 180 : turn_deg;
}

/** Lengths from the beginning of a line to its points. */
function lengths(line: Line): number[] {
    let sum = 0;
    return line.map(([x, y], i) => (sum += i === 0 ? 0 : Math.hypot(x - line[i - 1]![0], y - line[i - 1]![1])));
}

function along(line: Line, sums: number[], length: number): [number, number] {
    const i = Math.max(1, Math.min(line.length - 1, sums.findIndex((s) => s >= length)));
    const [[x0, y0], [x1, y1]] = [line[i - 1]!, line[i]!];
    const piece = sums[i]! - sums[i - 1]!;
    const t = piece > 0 ? Math.max(0, Math.min(1, (length - sums[i - 1]!) / piece)) : 0;
    return [x0 + t * (x1 - x0), y0 + t * (y1 - y0)];
}
