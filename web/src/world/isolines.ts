// Lines of availability on the map: which, how they look, and where their names stand.

import { svg } from "../show/dom.ts";
import { contours, places, worthDrawing, type Line, type Place } from "./contours.ts";
import { placed, type Margins } from "./draw.ts";
import type { Layer, MapGrid } from "./records.ts";

/** Availabilities that have a line, and its dashes: the rarer the loss, the more of the line is there. Edges of classes. */
const LEVELS: readonly [percent: number, dashes: string][] = [[95, "1 4"], [99, "7 4"], [99.9, "none"]];
/** The colours of the classes are the same in every theme, and so are those of the lines on them. */
export const INK = "#12171c";
export const HALO = "#ffffff";
/** Width of a letter over the size of the font, on the safe side. */
const LETTER = 0.6;
/** Names of a line in one picture. */
const MOST = 3;

export interface Isoline {
    words: string;
    dashes: string;
    lines: Line[];
}

const made = new WeakMap<Layer, Isoline[]>();

/** Lines of the levels that the values of an availability tell apart; none of another layer. They are worked out once. */
export function isolines(layer: Layer, grid: MapGrid): Isoline[] {
    if (layer.unit !== "%") return [];
    const known = made.get(layer);
    if (known !== undefined) return known;
    const drawn = worthDrawing(layer.values, LEVELS.map(([percent]) => percent));
    const lines = LEVELS.filter(([percent]) => drawn.includes(percent)).map(([percent, dashes]) => ({ words: `${percent} %`, dashes, lines: contours(layer.values, grid, percent) }));
    made.set(layer, lines);
    return lines;
}

/** The lines and their names for a picture of that grid. */
export function drawIsolines(all: Isoline[], grid: MapGrid, margins: Margins): SVGElement[] {
    const p = placed(grid, margins);
    const onPicture = (line: Line): Line => line.map(([column, row]) => [p.left + column * p.cellWidth, p.bottom - row * p.cellHeight]);
    const room = { left: p.left, right: p.left + grid.n_lon * p.cellWidth, top: p.bottom - grid.n_lat * p.cellHeight, bottom: p.bottom };
    const taken: Place[] = [];
    const [lines, names]: [SVGElement[], SVGElement[]] = [[], []];
    for (const { words, dashes, lines: own } of all) {
        const shown = own.map(onPicture);
        const d = shown.map((line) => line.map(([x, y], i) => `${i === 0 ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`).join("")).join("");
        const usual = { d, fill: "none", "vector-effect": "non-scaling-stroke", "stroke-linejoin": "round" };
        lines.push(
            svg("path", { ...usual, stroke: HALO, "stroke-opacity": 0.75, "stroke-width": 3.4 }),
            svg("path", { ...usual, class: "isoline", "data-level": words, stroke: INK, "stroke-width": 1.4, "stroke-dasharray": dashes }));
        for (const place of places(shown, room, words.length * LETTER * margins.font, MOST, taken)) {
            taken.push(place);
            names.push(svg("text", {
                x: place.x.toFixed(1), y: (place.y + 0.36 * margins.font).toFixed(1), transform: `rotate(${place.turn_deg.toFixed(1)} ${place.x.toFixed(1)} ${place.y.toFixed(1)})`,
                "text-anchor": "middle", "font-size": margins.font, "font-weight": 600, fill: INK, stroke: HALO, "stroke-width": 0.3 * margins.font, "stroke-linejoin": "round", "paint-order": "stroke",
            }, words));
        }
    }
    // Names lie over all lines, and no line leaves the region.
    return [svg("g", { "clip-path": "url(#world-region)" }, ...lines), ...names];
}

/** A piece of a line for a legend. */
export function sample(dashes: string): SVGSVGElement {
    return svg("svg", { viewBox: "0 0 26 12", width: 26, height: 12, "aria-hidden": "true" },
        svg("rect", { width: 26, height: 12, fill: HALO }), svg("path", { d: "M1 6H25", stroke: INK, "stroke-width": 1.4, "stroke-dasharray": dashes }));
}
