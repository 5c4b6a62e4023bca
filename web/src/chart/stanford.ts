// Stanford diagram: protection level against error, log-count pixels, the regions shaded and named with counts and fractions.

import type { Axis, Level, StanfordBins, StanfordCounts } from "../records.gen.ts";
import type { Store } from "../data/store.ts";
import { el, freshId, svg, valueOf } from "../show/dom.ts";
import { count, NONE, plain, share, wholeMetres } from "../show/format.ts";
import { colour, type Colour } from "../show/theme.ts";
import { depth, EDGE as SHARE_OF_EDGE, frameOf, join, nameAt, outline, regionOf, REGIONS, type Frame, type Pixel, type Place, type Region } from "./regions.ts";

const WIDTH = 480;
const LEFT = 46;
const TOP = 12;
/** Side of the square that shows 0 to the end of the axes. */
const SIDE = 412;
/** Everything beyond the end is collected in this band. */
const EDGE = SHARE_OF_EDGE * SIDE;
const HEIGHT = TOP + EDGE + SIDE + 42;
const LINE = 15.5;
/** A pixel smaller than this is not seen. */
const SMALLEST_PX = 1.5;
const MI_PX = 2.5;
const HMI_PX = 6;

const AXES: Record<Axis, { name: string; error: string; level: string; limit: string }> = {
    h: { name: "Horizontal", error: "HPE", level: "HPL", limit: "HAL" },
    v: { name: "Vertical", error: "VPE", level: "VPL", limit: "VAL" },
};

export interface StanfordOptions {
    bins: StanfordBins;
    level: Level;
    limit_m: number;
    /** Points in the regions of the level; absent where the record does not count them. */
    counts: StanfordCounts | null;
    /** Words that must stand on every axis of an experimental level; empty for integrity levels. */
    experimental: string;
    theme: Store<number>;
}

export function stanford(host: HTMLElement, options: StanfordOptions): () => void {
    const { bins, counts, level } = options;
    const axis = AXES[bins.axis];
    const frame = frameOf(bins, options.limit_m);
    const title = freshId("stanford");
    const canvas = el("canvas", { "aria-hidden": "true" });
    const esa = bins.variant === "stanford-esa";
    const note = el("figcaption", {}, esa ? `${count(bins.n)} satellite subsets. One point for every subset, not for every epoch: a good geometry hides nothing.` : `${count(bins.n)} epochs with a solution and a true error.`);
    const figure = el("figure", { class: "chart stanford", id: `stanford-${bins.axis}${esa ? "-esa" : ""}`, role: "group", "aria-labelledby": title },
        el("h4", { id: title }, `${axis.name}, ${level.id}${esa ? ", satellite subsets" : ""}`, options.experimental === "" ? null : el("span", { class: "tag" }, options.experimental)), note,
        el("div", { class: "stanford-box" }, canvas, overlay(options, frame)), ramp(bins, frame), edgeWords(frame, axis.limit, counts), counts === null ? null : regionTable(counts, axis.name, esa ? "Subsets" : "Epochs"));
    host.append(figure);
    const draw = (): void => paint(canvas, bins, frame);
    const resize = new ResizeObserver(draw);
    resize.observe(canvas);
    const end = options.theme.watch(draw);
    return () => {
        end();
        resize.disconnect();
        figure.remove();
    };
}

/** How many bins a side make a pixel that can be seen. */
function joined(bins: StanfordBins, frame: Frame, side_px = SIDE): number {
    return Math.max(1, Math.ceil((SMALLEST_PX * frame.shown_m) / (side_px * bins.bin_m) - 1e-9));
}

function paint(canvas: HTMLCanvasElement, bins: StanfordBins, frame: Frame): void {
    const pen = canvas.getContext("2d");
    const width = canvas.clientWidth;
    if (pen === null || width === 0) return;
    canvas.width = canvas.height = Math.round(width * devicePixelRatio);
    const unit = (width * devicePixelRatio) / (SIDE + EDGE);
    const perBin = (unit * SIDE * bins.bin_m) / frame.shown_m;
    const end = Math.round(frame.shown_m / bins.bin_m);
    const across = (k: number): number => (k >= end ? SIDE * unit : k * perBin);
    const square = (p: Pixel, least: number): void => {
        const size = (k: number): number => Math.max(k >= end ? EDGE * unit : p.size * perBin, least * unit);
        // On whole pixels, so that neighbours leave no seam; a pixel grown to be seen keeps its lower left corner and never crosses the limit it lies beyond.
        const [left, bottom] = [Math.round(across(p.x)), canvas.height - Math.round(across(p.y))];
        const [right, top] = [Math.round(across(p.x) + size(p.x)), canvas.height - Math.round(across(p.y) + size(p.y))];
        pen.fillRect(left, top, Math.max(1, right - left), Math.max(1, bottom - top));
    };
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.fillStyle = colour("rule");
    for (const t of ticksOf(frame)) {
        const at = Math.round((t / frame.shown_m) * SIDE * unit);
        pen.fillRect(at, 0, devicePixelRatio, canvas.height);
        pen.fillRect(0, canvas.height - at, canvas.width, devicePixelRatio);
    }
    const pixels = join(bins, joined(bins, frame));
    const largest = pixels.at(-1)?.count ?? 1;
    const paintAll = (list: Pixel[], hue: Colour, least: number, alpha: (p: Pixel) => number): void => {
        pen.fillStyle = colour(hue);
        for (const p of list) {
            pen.globalAlpha = alpha(p);
            square(p, least);
        }
        pen.globalAlpha = 1;
    };
    paintAll(pixels, "m1", SMALLEST_PX, (p) => depth(p.count, largest));
    // What misleads is drawn bin by bin over all others, at a size that no scale can hide.
    const single = join(bins, 1);
    const of = (p: Pixel): string => regionOf(p.x, p.y, bins.bin_m, frame);
    paintAll(single.filter((p) => of(p) === "mi" || of(p) === "unavailable_mi"), "caution", MI_PX, () => 1);
    const hazards = single.filter((p) => of(p) === "hmi");
    paintAll(hazards, "ground", HMI_PX + 2, () => 1);
    paintAll(hazards, "warning", HMI_PX, () => 1);
}

function overlay(options: StanfordOptions, frame: Frame): SVGElement {
    const { bins, counts, limit_m } = options;
    const axis = AXES[bins.axis];
    const x = (s: number): number => LEFT + s * SIDE;
    const y = (s: number): number => TOP + EDGE + (1 - s) * SIDE;
    const line = (kind: string, x1: number, y1: number, x2: number, y2: number): SVGElement => svg("line", { class: kind, x1, y1, x2, y2 });
    const drawn = REGIONS.filter((r) => frame.limitShown || r.id === "nominal" || r.id === "mi");
    const named = REGIONS.map((region) => ({ region, place: nameAt(region.id, frame, bins) })).filter((n): n is { region: Region; place: Place } => n.place !== null);
    const shades = drawn.map((region) => svg("polygon", {
        class: `region region-${region.id}`, "data-some": counts !== null && region.count(counts) > 0, points: outline(region.id, frame).map(([px, py]) => `${x(px)},${y(py)}`).join(" "),
    }, svg("title", {}, region.words)));
    const ticks = ticksOf(frame).flatMap((t) => {
        const s = t / frame.shown_m;
        return [text(x(s), y(0) + 16, plain(t, 0), "middle", "tick"), text(x(0) - 6, y(s) + 4, plain(t, 0), "end", "tick")];
    });
    const a = limit_m / frame.shown_m;
    const limits = !frame.limitShown ? [] : [
        line("stanford-limit", x(a), y(0), x(a), y(1) - EDGE), line("stanford-limit", x(0), y(a), x(1) + EDGE, y(a)),
        text(x(a) - 7, y(a) + (frame.roomBeyond ? -6 : 15), `${axis.limit} ${wholeMetres(limit_m)}`, "end", "limit-name"),
    ];
    const mark = options.experimental === "" ? "" : ` · ${options.experimental}`;
    const middle = TOP + EDGE + SIDE / 2;
    const label = `Stanford diagram of ${options.level.id}, ${axis.name.toLowerCase()}: ${counts === null ? `${count(bins.n)} satellite subsets` : REGIONS.map((r) => `${r.words.split(":")[0]!.toLowerCase()} ${count(r.count(counts))} (${share(r.count(counts) / counts.n)})`).join(", ")}`;
    return svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": label },
        ...shades, ...ticks, svg("rect", { class: "stanford-frame", x: LEFT, y: TOP, width: SIDE + EDGE, height: SIDE + EDGE }),
        line("stanford-edge", x(1), TOP, x(1), y(0)), line("stanford-edge", x(0), y(1), x(1) + EDGE, y(1)),
        line("stanford-diagonal", x(0), y(0), x(1), y(1)), ...limits, ...named.flatMap(({ region, place }) => regionName(region, place, counts, x(place.x), y(place.y))),
        text(x(1) + EDGE, y(0) + 34, `${axis.error} (true error), m${mark}`, "end", "axis-name"),
        svg("text", { class: "axis-name", transform: `translate(11 ${middle}) rotate(-90)`, "text-anchor": "middle" }, `${axis.level} (protection level), m${mark}`));
}

function regionName(region: Region, place: Place, counts: StanfordCounts | null, x: number, y: number): SVGElement[] {
    const n = counts === null ? null : region.count(counts);
    const kind = `region-name name-${region.id}${n !== null && n > 0 ? " some" : ""}`;
    const name = region.id === "hmi" && n !== null && n > 0 ? `■ ${region.name}` : region.name;
    if (n === null || counts === null) return [text(x, y, name, place.anchor, kind)];
    // The small corner has room for two lines only.
    const lines = region.id === "unavailable_mi" ? [name, `${count(n)} · ${share(n / counts.n)}`] : [name, count(n), share(n / counts.n)];
    return lines.map((words, i) => {
        const line = text(x, y + 4 + (i - (lines.length - 1) / 2) * LINE, words, place.anchor, kind);
        if (i === 1) Object.assign(line.dataset, { key: `n_${region.id}`, value: String(n) });
        return line;
    });
}

function text(x: number, y: number, words: string, anchor: string, kind: string): SVGTextElement {
    return svg("text", { x, y, "text-anchor": anchor, class: kind }, words);
}

function ticksOf(frame: Frame): number[] {
    const step = [1, 2, 5, 10, 20, 50, 100, 200].find((s) => frame.shown_m / s <= 6) ?? frame.shown_m / 5;
    return Array.from({ length: Math.floor(frame.shown_m / step + 1e-9) + 1 }, (_, i) => i * step);
}

/** What the band at the edge holds; regions without room for a name are named here instead. */
function edgeWords(frame: Frame, limit: string, counts: StanfordCounts | null): HTMLElement {
    const words = el("p", { class: "note" }, `The band at the edge holds what lies beyond ${plain(frame.shown_m, 0)} m.`);
    if (frame.roomBeyond) return words;
    words.append(frame.limitShown ? " There too: " : ` ${limit} ${wholeMetres(frame.limit_m)} lies beyond the axes: `);
    if (counts === null) return words;
    for (const region of REGIONS.filter((r) => r.id !== "nominal" && r.id !== "mi")) {
        const n = region.count(counts);
        const hazard = region.id === "hmi" && n > 0;
        words.append(el("span", { class: hazard ? "hazard" : "aside" }, `${hazard ? "■ " : ""}${region.name} `, valueOf(`n_${region.id}`, n, count(n)), ` (${share(n / counts.n)})`), " ");
    }
    return words;
}

/** What the depth of colour says. */
function ramp(bins: StanfordBins, frame: Frame): HTMLElement {
    const size = joined(bins, frame);
    const largest = join(bins, size).at(-1)?.count ?? 0;
    const unit = bins.variant === "stanford-esa" ? "subsets" : "epochs";
    const steps = Array.from({ length: 12 }, (_, i) => svg("rect", { class: "ramp", x: i * 10, y: 0, width: 10, height: 8, opacity: depth(largest ** (i / 11), largest) }));
    return el("p", { class: "note ramp-words" }, `1 `, svg("svg", { viewBox: "0 0 120 8", width: 120, height: 8, "aria-hidden": "true" }, ...steps), ` ${count(largest)} ${unit} in a pixel of ${plain(size * bins.bin_m, 1)} m, logarithmic. `,
        el("span", { class: "key" }, el("i", { class: "key-mi" }), "misleading"), " ", el("span", { class: "key" }, el("i", { class: "key-hmi" }), "hazardous, never smaller than this"));
}

function regionTable(c: StanfordCounts, name: string, unit: string): HTMLElement {
    const rows = REGIONS.map((r) => el("tr", {}, el("th", { scope: "row" }, r.words), valueOf(`n_${r.id}`, r.count(c), count(r.count(c)), "td"), el("td", {}, c.n > 0 ? share(r.count(c) / c.n) : NONE)));
    return el("details", { class: "numbers" }, el("summary", {}, "Numbers", el("span", { class: "sr" }, ` of the Stanford diagram, ${name.toLowerCase()}`)),
        el("div", { class: "scroll" }, el("table", {}, el("caption", { class: "sr" }, `Regions of the Stanford diagram, ${name.toLowerCase()}`), el("thead", {}, el("tr", {}, ...["Region", unit, "Share"].map((h) => el("th", { scope: "col" }, h)))), el("tbody", {}, ...rows))));
}
