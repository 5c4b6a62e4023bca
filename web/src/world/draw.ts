// The map as vectors: cells of one class as one path, coast, graticule. Degrees are its units, so that it scales.

import { svg } from "../show/dom.ts";
import { classOf, type Class } from "./classes.ts";
import type { Layer, MapGrid } from "./records.ts";

const DEG = 180 / Math.PI;

/** Room for the labels and their size, in thousandths of the picture's width: a narrow picture has larger ones. */
export interface Margins {
    left: number;
    bottom: number;
    font: number;
    /** Height that the cells may take. */
    most: number;
}

export const WIDE: Margins = { left: 46, bottom: 24, font: 11, most: 560 };
export const NARROW: Margins = { left: 88, bottom: 42, font: 24, most: 1100 };
const TOP = 6;
const RIGHT = 8;

export interface Frame {
    west: number;
    north: number;
    width: number;
    height: number;
    /** What a degree of longitude measures in degrees of latitude at the middle of the region. */
    squeeze: number;
}

export function frame(grid: MapGrid): Frame {
    const [south, north, west] = [grid.south_rad * DEG, grid.north_rad * DEG, grid.west_rad * DEG];
    const width = (grid.east_rad - grid.west_rad) * DEG;
    const middle = Math.cos((grid.south_rad + grid.north_rad) / 2);
    return { west, north, width, height: north - south, squeeze: width > 180 ? 1 : Math.max(0.3, middle) };
}

/** Cells by class, runs of a row joined; one path a class, and one for what does not exist. */
export function cells(layer: Layer, all: Class[], grid: MapGrid): string[] {
    const f = frame(grid);
    const step = grid.step_rad * DEG;
    const paths: string[][] = Array.from({ length: all.length + 1 }, () => []);
    for (let row = 0; row < grid.n_lat; row++) {
        const y = f.height - (row + 1) * step;
        let begin = 0;
        let of = NaN;
        for (let column = 0; column <= grid.n_lon; column++) {
            const next = column < grid.n_lon ? classOf(layer.values[row * grid.n_lon + column]!, all, layer.unit === "%") : NaN;
            if (next === of) continue;
            if (column > begin) paths[of < 0 ? all.length : of]!.push(`M${n(begin * step)} ${n(y)}h${n((column - begin) * step)}v${n(step)}h${n(-(column - begin) * step)}z`);
            begin = column;
            of = next;
        }
    }
    return paths.map((p) => p.join(""));
}

function n(value: number): string {
    return String(Number(value.toFixed(4)));
}

/** Polylines of longitude and latitude in thousandths of a degree, differenced, as one path. */
export function coast(lines: number[][], grid: MapGrid): string {
    const f = frame(grid);
    let path = "";
    for (const line of lines) {
        let [lon, lat] = [0, 0];
        for (let i = 0; i < line.length; i += 2) {
            lon += line[i]!;
            lat += line[i + 1]!;
            path += `${i === 0 ? "M" : "L"}${n(lon / 1000 - f.west)} ${n(f.north - lat / 1000)}`;
        }
    }
    return path;
}

export function graticule(grid: MapGrid, most: number): { path: string; labels: { x: number; y: number; text: string; across: boolean }[] } {
    const f = frame(grid);
    const step = [0.5, 1, 2, 5, 10, 15, 30].find((s) => f.width / s <= most) ?? 60;
    const labels: { x: number; y: number; text: string; across: boolean }[] = [];
    let path = "";
    for (let lon = Math.ceil(f.west / step) * step; lon <= f.west + f.width + 1e-9; lon += step) {
        path += `M${n(lon - f.west)} 0V${n(f.height)}`;
        labels.push({ x: lon - f.west, y: f.height, text: angle(((lon + 540) % 360) - 180, "E", "W"), across: true });
    }
    for (let lat = Math.ceil((f.north - f.height) / step) * step; lat <= f.north + 1e-9; lat += step) {
        path += `M0 ${n(f.north - lat)}H${n(f.width)}`;
        labels.push({ x: 0, y: f.north - lat, text: angle(lat, "N", "S"), across: false });
    }
    return { path, labels };
}

function angle(value: number, positive: string, negative: string): string {
    const shown = Number(Math.abs(value).toFixed(3));
    return shown === 0 || shown === 180 ? `${shown}°` : `${shown}° ${value < 0 ? negative : positive}`;
}

/** Labels that a width has room for: six letters and as much again between them, no more than a dozen. */
export function labels(width: number, font: number): number {
    return Math.max(1, Math.min(12, Math.floor(width / (6.5 * font))));
}

/** The middle of a cell as people write it. */
export function centre(lat_rad: number, lon_rad: number): string {
    return `${angle(lat_rad * DEG, "N", "S")}, ${angle(((((lon_rad * DEG + 540) % 360) + 360) % 360) - 180, "E", "W")}`;
}

/** Units a degree and a cell, and where the cells begin and end: a region higher than wide stands in the middle. */
export function placed(grid: MapGrid, margins: Margins): { k: number; left: number; bottom: number; cellWidth: number; cellHeight: number } {
    const f = frame(grid);
    const room = 1000 - margins.left - RIGHT;
    const k = Math.min(room / (f.width * f.squeeze), margins.most / f.height);
    const step = grid.step_rad * DEG;
    return { k, left: margins.left + (room - f.width * f.squeeze * k) / 2, bottom: TOP + f.height * k, cellWidth: step * f.squeeze * k, cellHeight: step * k };
}

/** The whole picture, 1000 units wide, with colours written into it, so that it can leave the page. */
export function picture(layer: Layer, all: Class[], grid: MapGrid, coastline: number[][], colours: { ink: string; muted: string; ground: string; none: string }, margins: Margins): SVGSVGElement {
    const f = frame(grid);
    const { bottom, font } = margins;
    const { k, left } = placed(grid, margins);
    const height = f.height * k + bottom + TOP;
    const place = `translate(${left} ${TOP}) scale(${k * f.squeeze} ${k})`;
    const thin = { fill: "none", "vector-effect": "non-scaling-stroke", transform: place };
    const net = graticule(grid, labels(f.width * f.squeeze * k, font));
    const fills = [...all.map((c) => c.fill), colours.none];
    const text = net.labels.map((l) => svg("text", {
        x: left + l.x * k * f.squeeze - (l.across ? 0 : 5), y: TOP + l.y * k + font * (l.across ? 1.4 : 0.36), fill: colours.muted, "font-size": font,
        "text-anchor": !l.across || l.x > 0.97 * f.width ? "end" : "middle",
    }, l.text));
    return svg("svg", { viewBox: `0 0 1000 ${height.toFixed(1)}`, xmlns: "http://www.w3.org/2000/svg", "font-family": "system-ui, sans-serif", role: "img" },
        svg("rect", { width: 1000, height, fill: colours.ground }),
        ...cells(layer, all, grid).map((d, i) => svg("path", { d, fill: fills[i]!, transform: place, "shape-rendering": "crispEdges" })),
        svg("path", { d: net.path, stroke: colours.muted, "stroke-opacity": 0.25, "stroke-width": 0.6, ...thin }),
        // Lines of the coast that begin beside the region end at its edge.
        svg("clipPath", { id: "world-region" }, svg("rect", { x: left, y: TOP, width: f.width * f.squeeze * k, height: f.height * k })),
        svg("g", { "clip-path": "url(#world-region)" },
            svg("path", { d: coast(coastline, grid), stroke: colours.ground, "stroke-opacity": 0.7, "stroke-width": 1.6, ...thin }),
            svg("path", { d: coast(coastline, grid), stroke: colours.ink, "stroke-width": 0.6, ...thin })),
        ...text);
}

/** The row and column under a point of the picture, as shares of its width and height; null outside. */
export function cellAt(x: number, y: number, grid: MapGrid, margins: Margins): { row: number; column: number } | null {
    const f = frame(grid);
    const { k, left } = placed(grid, margins);
    const height = f.height * k + margins.bottom + TOP;
    const [lon, lat] = [(x * 1000 - left) / (k * f.squeeze), f.height - (y * height - TOP) / k];
    const [row, column] = [Math.floor(lat / (grid.step_rad * DEG)), Math.floor(lon / (grid.step_rad * DEG))];
    return row >= 0 && row < grid.n_lat && column >= 0 && column < grid.n_lon ? { row, column } : null;
}
