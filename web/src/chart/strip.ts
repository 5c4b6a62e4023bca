// A series chart over time or along-track distance, linked with the others through the scene.
// uPlot draws long series as the smallest and largest value of each pixel column, so a spike of one epoch stays visible.

import uPlot from "uplot";
import { axisValues, mod, type Scene } from "../data/scene.ts";
import type { WordName } from "../data/table.ts";
import { choice, el, freshId } from "../show/dom.ts";
import { clock, date, NONE, plain } from "../show/format.ts";
import { colour, type Colour } from "../show/theme.ts";
import { constant, folded } from "./constant.ts";
import { drawEvents, drawHatch, drawLabels, drawUnits } from "./decorate.ts";
import { numbers, readout, type Word } from "./readout.ts";
import { asinhTicks, bare, clockTicks, extent, isolated, type Extent } from "./ticks.ts";

export interface Line {
    /** Column name; also the key of the value shown at the cursor. */
    key: string;
    label: string;
    values: Float64Array;
    colour: Colour;
    dash?: number[];
    width?: number;
    /** Drawn on both sides of zero: a bound or a limit of a signed error. */
    mirror?: boolean;
    /** A requirement: may lie far from the data. */
    limit?: boolean;
    /** Source, provenance and assumptions, one hover away. */
    about?: string;
    hidden?: boolean;
    /** Drawn above lines with less: the errors stand before their bounds. */
    front?: number;
    /** Key of another line: what lies between the two is tinted. */
    downTo?: string;
    /** Name at the line's end, where the whole one is too long. */
    endLabel?: string;
    /** Has no value beside the chart; its numbers are in the table. */
    quiet?: boolean;
}

export type Scale = "data" | "limits" | "compressed" | "log";

export interface StripOptions {
    id: string;
    title: string;
    /** Which methods at which risk, and anything a reader must know. */
    note: string;
    unit: string;
    lines: Line[];
    /** Offered scales, the first is taken. */
    scales: Scale[];
    /** Text of one value. */
    show: (value: number, line: Line) => string;
    height?: number;
    /** Lowest value drawn on a logarithmic scale. */
    floor?: number;
    draw?: (u: uPlot, scene: Scene) => void;
    /** Fixed vertical range. */
    range?: Extent;
    yTick?: (value: number) => string;
    /** The lines are drawn by `draw`, not as lines. */
    noPaths?: boolean;
    /** Columns of words shown with the values at the cursor. */
    words?: { key: WordName; label: string; text?: (word: string | null) => string }[];
    /** The axis need not hold zero: no value is near it. */
    free?: boolean;
    /** No names at the lines' ends: there are more than fit. */
    noLabels?: boolean;
    /** Is drawn also where its lines stay where they are: what it shows is more than they. */
    varies?: boolean;
    /** A sentence on the epoch under the cursor. */
    says?: (i: number) => string;
    /** Heights of the horizontal grid lines; uPlot's choice without it. */
    ySplits?: (min: number, max: number) => number[];
}

const SCALE_NAMES: Record<Scale, string> = { data: "Data", limits: "To limits", compressed: "Both, compressed", log: "Log" };
/** The same in every chart, so that their axes stand under one another. */
const LABEL_ROOM_PX = 168;
const FONT = '11px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';

export function strip(host: HTMLElement, scene: Scene, options: StripOptions): () => void {
    const throughout = constant(scene, options);
    if (throughout !== null) return folded(host, options, throughout);
    const state = { scale: options.scales[0]!, visible: new Set(options.lines.filter((l) => l.hidden !== true).map((l) => l.key)) };
    const title = freshId("title");
    const plot = el("div", { class: "plot", "aria-hidden": "true" });
    const values = readout(options.lines.filter((l) => l.quiet !== true), state.visible, options.show, () => rebuild(), wordsAt(scene, options.words));
    const scales = options.scales.length > 1 ? choice(`Scale of ${options.title}`, options.scales.map((s) => [s, SCALE_NAMES[s]]), state.scale, (s) => { state.scale = s; rebuild(); }) : null;
    const table = numbers(options.lines, options.show, options.title);
    const sentence = options.says === undefined ? null : el("p", { class: "note" });
    const figure = el("figure", { class: "chart", id: options.id, role: "group", "aria-labelledby": title },
        el("div", { class: "chart-head" }, el("h3", { id: title }, options.title), scales), el("figcaption", {}, options.note), values.element, sentence, plot, table.element);
    host.append(figure);

    let u: uPlot | null = null;
    let quiet = false;
    const follow = (): void => {
        const i = scene.cursor.get();
        values.update(i);
        if (sentence !== null) sentence.textContent = options.says!(i);
        table.update(i);
        if (u === null) return;
        quiet = true;
        const x = u.data[0]![i];
        const left = x === undefined ? -10 : u.valToPos(x, "x");
        // The width from the plot's own box: asking the page for it would lay the page out again for every chart.
        u.setCursor({ left: left >= 0 && left <= u.bbox.width / devicePixelRatio ? left : -10, top: 0 }, false);
        quiet = false;
    };
    const showWindow = (): void => {
        if (u === null) return;
        const x = u.data[0]!;
        const w = scene.window.get();
        u.setScale("x", { min: x[w?.from ?? 0]!, max: x[w?.to ?? x.length - 1]! });
        follow();
    };
    function rebuild(): void {
        u?.destroy();
        const width = Math.max(240, plot.clientWidth);
        u = new uPlot(build(scene, options, state, width, () => quiet, follow), dataOf(scene, options), plot);
        u.over.addEventListener("dblclick", () => scene.window.set(null));
        showWindow();
    }
    rebuild();
    const resize = new ResizeObserver(() => {
        if (u !== null && Math.abs(u.width - plot.clientWidth) > 1 && plot.clientWidth > 0) rebuild();
    });
    resize.observe(plot);
    let first = true;
    const again = (): void => { if (!first) rebuild(); };
    const ends = [scene.cursor.watch(follow), scene.window.watch(showWindow), scene.theme.watch(again), scene.axis.watch(again)];
    first = false;
    return () => {
        ends.forEach((end) => end());
        resize.disconnect();
        u?.destroy();
        figure.remove();
    };
}

function wordsAt(scene: Scene, words: StripOptions["words"]): Word[] {
    return (words ?? []).map((word) => ({ text: (w) => w ?? NONE, ...word, of: (i) => scene.table.word(word.key, i) }));
}

function dataOf(scene: Scene, options: StripOptions): uPlot.AlignedData {
    const nullable = (values: Float64Array, sign: number): (number | null)[] => Array.from(values, (v) => {
        if (!Number.isFinite(v)) return null;
        return options.floor === undefined ? sign * v : Math.max(v, options.floor);
    });
    const columns = drawn(options).flatMap((line) => (line.mirror ? [nullable(line.values, 1), nullable(line.values, -1)] : [nullable(line.values, 1)]));
    return [Array.from(axisValues(scene)), ...columns] as uPlot.AlignedData;
}

/** Lines in the order they are drawn, from the back. */
function drawn(options: StripOptions): Line[] {
    return [...options.lines].sort((a, b) => (a.front ?? 0) - (b.front ?? 0));
}

function seriesOf(options: StripOptions, visible: Set<string>, breaks: number[]): uPlot.Series[] {
    return drawn(options).flatMap((line) => {
        const one: uPlot.Series = {
            label: line.key, show: visible.has(line.key), stroke: colour(line.colour), width: line.width ?? (line.mirror && !line.limit ? 0.9 : 1.25), dash: line.dash,
            points: lonely(line.values, colour(line.colour)), spanGaps: false, scale: "y", gaps: (u, _s, from, to, gaps) => [...gaps, ...breaks.filter((i) => i >= from && i < to).map((i): [number, number] => [u.valToPos(u.data[0]![i]!, "x", true), u.valToPos(u.data[0]![i + 1]!, "x", true)])].sort((a, b) => a[0] - b[0]), ...(options.noPaths ? { paths: () => null } : {}),
        };
        return line.mirror ? [one, { ...one }] : [one];
    });
}

/** An epoch between two gaps has no line to be on: it is drawn as a point. */
function lonely(values: Float64Array, fill: string): uPlot.Series.Points {
    const alone = isolated(values);
    return { show: alone.length > 0, filter: () => alone, size: 5, width: 0, fill };
}

/** What lies within a bound on both sides is tinted, and what lies between two lines that belong together. */
function bandsOf(options: StripOptions): uPlot.Band[] {
    const bands: uPlot.Band[] = [];
    const at = new Map<string, number>();
    let series = 1;
    for (const line of drawn(options)) {
        // Two hexadecimal digits of opacity after the colour.
        if (line.mirror && !line.limit) bands.push({ series: [series, series + 1], fill: `${colour(line.colour)}1f` });
        at.set(line.key, series);
        series += line.mirror ? 2 : 1;
    }
    for (const line of options.lines) {
        const lower = line.downTo === undefined ? undefined : at.get(line.downTo);
        if (lower !== undefined) bands.push({ series: [at.get(line.key)!, lower], fill: `${colour(line.colour)}1f` });
    }
    return bands;
}

/** Smallest and largest visible value in the window, with a little room. */
function rangeOf(u: uPlot, scene: Scene, options: StripOptions, state: { scale: Scale; visible: Set<string> }): Extent {
    const w = scene.window.get();
    const [from, to] = [w?.from ?? 0, w?.to ?? u.data[0]!.length - 1];
    const shown = options.lines.filter((line) => state.visible.has(line.key) && (state.scale !== "data" || line.limit !== true));
    const [low, high] = options.free === true ? bare(shown, from, to) : extent(shown, from, to, state.scale === "log" ? options.floor ?? 1e-12 : null);
    // Whole decades, with a free one above and below what is drawn.
    if (state.scale === "log") return [10 ** (Math.floor(Math.log10(low)) - 1), 10 ** (Math.ceil(Math.log10(high)) + 1)];
    const room = 0.06 * (high - low || Math.abs(high) || 1);
    return [low < 0 || options.free === true ? low - room : low, high + room];
}

function build(scene: Scene, options: StripOptions, state: { scale: Scale; visible: Set<string> }, width: number, isQuiet: () => boolean, follow: () => void): uPlot.Options {
    const along = scene.axis.get() === "along";
    const wide = width >= 700;
    const axis = { font: FONT, stroke: colour("muted"), grid: { stroke: colour("rule"), width: 1 }, ticks: { show: false } };
    const compressed = state.scale === "compressed";
    const threshold = compressed ? compressionThreshold(options) : 1;
    return {
        width,
        height: options.height ?? (wide ? 230 : 200),
        padding: [20, wide ? LABEL_ROOM_PX : 20, 0, 0],
        legend: { show: false },
        cursor: { y: false, drag: { x: true, y: false, setScale: false }, points: { show: options.noPaths !== true, size: 5, width: 1 } },
        scales: {
            x: { time: false },
            y: {
                distr: state.scale === "log" ? 3 : compressed ? 4 : 1,
                asinh: threshold,
                range: (u) => options.range ?? rangeOf(u, scene, options, state),
            },
        },
        axes: [
            { ...axis, size: 30, space: 70, ...(along ? milesAxis() : clockAxis(width, scene.table.start_utc_s - mod(scene.table.start_utc_s, 86400))) },
            {
                ...axis, size: 58, space: 28, filter: (_u, splits) => splits,
                ...(compressed ? { splits: (_u: uPlot, _i: number, min: number, max: number) => asinhTicks(min, max, threshold) } : {}),
                ...(options.ySplits ? { splits: (_u: uPlot, _i: number, min: number, max: number) => options.ySplits!(min, max) } : {}),
                values: (_u, splits) => splits.map((s) => (s == null ? "" : options.yTick ? options.yTick(s) : plain(s, s !== 0 && Math.abs(s) < 1 ? 2 : Math.abs(s) < 10 && s % 1 !== 0 ? 1 : 0))),
            },
        ],
        series: [{}, ...seriesOf(options, state.visible, scene.table.breaks)],
        bands: bandsOf(options),
        hooks: {
            drawClear: [(u) => drawHatch(u, scene)],
            draw: [
                (u) => options.draw?.(u, scene),
                (u) => drawEvents(u, scene),
                (u) => drawUnits(u, options.unit, along ? "NM" : "UTC", FONT),
                (u) => { if (wide && !options.noPaths && !options.noLabels) drawLabels(u, options.lines, state.visible, FONT, options.floor); },
            ],
            setCursor: [
                (u) => {
                    if (isQuiet()) return;
                    // Leaving the chart keeps the last epoch under the cursor.
                    if (u.cursor.idx != null && (u.cursor.left ?? -1) >= 0) scene.cursor.set(u.cursor.idx);
                    else follow();
                },
            ],
            setSelect: [
                (u) => {
                    if (u.select.width < 4) return;
                    const [from, to] = [u.posToIdx(u.select.left), u.posToIdx(u.select.left + u.select.width)];
                    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
                    if (to > from) scene.window.set({ from, to });
                },
            ],
        },
    };
}

/** Linear up to about the size of the data, logarithmic beyond, so that data and limits are seen at once. */
function compressionThreshold(options: StripOptions): number {
    const magnitudes = options.lines.filter((l) => l.limit !== true).flatMap((l) => Array.from(l.values, Math.abs)).filter(Number.isFinite).sort((a, b) => a - b);
    const usual = magnitudes[Math.floor(0.9 * magnitudes.length)] ?? 1;
    return 10 ** Math.floor(Math.log10(Math.max(0.1, usual)));
}

function milesAxis(): Partial<uPlot.Axis> {
    return { values: (_u, splits) => splits.map((s) => plain(s, Number.isInteger(s) ? 0 : 2)) };
}

/** Clock times; midnight has its date instead. */
function clockAxis(width: number, day_utc_s: number): Partial<uPlot.Axis> {
    const name = (s: number, whole: boolean): string => (s % 86400 === 0 && s > 0 ? date(day_utc_s + s).slice(5) : whole ? clock(s).slice(0, 5) : clock(s));
    return {
        splits: (_u, _i, min, max, _incr, space) => clockTicks(min, max, space, width),
        values: (_u, splits) => splits.map((s) => name(s, splits.every((t) => t % 60 === 0))),
    };
}
