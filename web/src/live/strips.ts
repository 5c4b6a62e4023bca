// The last ten minutes: deviation and bounds, protection levels, and what keeps the position beneath. Drawn by the report's chart library;
// what was not received or not usable is hatched, and where nothing comes any more the hatch grows.

import uPlot from "uplot";
import { hatch } from "../chart/decorate.ts";
import { MODES } from "../chart/modes.ts";
import { asinhTicks, clockTicks } from "../chart/ticks.ts";
import { mod } from "../data/scene.ts";
import { runsOf } from "../data/runs.ts";
import { el } from "../show/dom.ts";
import { clock, plain } from "../show/format.ts";
import { colour, type Colour } from "../show/theme.ts";
import type { Part } from "./parts.ts";
import { present, severity, type Model } from "./state.ts";

interface Line {
    name: string;
    label: string;
    of: (model: Model) => Float64Array;
    hue: Colour;
    width?: number;
    dash?: number[];
    mirror?: boolean;
}

interface Chart {
    id: string;
    title: string;
    lines: Line[];
    height: number;
    hidden?: (model: Model) => boolean;
    ribbon?: boolean;
}

const DEVIATION: Chart = {
    id: "deviation", title: "Lateral deviation in metres, last ten minutes", height: 250, ribbon: true,
    lines: [
        { name: "fte_m", label: "deviation", of: (m) => m.column("fte_m"), hue: "ink", width: 1.5 },
        { name: "accuracy_bound_m", label: "accuracy bound", of: (m) => m.column("accuracy_bound_m"), hue: "m1", mirror: true },
        { name: "integrity_compared_m", label: "integrity bound", of: (m) => m.column("integrity_compared_m"), hue: "m2", dash: [2, 2], mirror: true },
        { name: "rnp_m", label: "RNP", of: (m) => m.column("rnp_m"), hue: "limit", width: 1.5, mirror: true },
        { name: "rnp2_m", label: "2 RNP", of: (m) => m.column("rnp_m").map((v) => 2 * v), hue: "limit", dash: [5, 4], mirror: true },
    ],
};

const LEVELS: Chart = {
    id: "levels", title: "Protection levels in metres, last ten minutes", height: 180,
    lines: [
        { name: "hpl_m", label: "HPL", of: (m) => m.column("hpl_m"), hue: "m2", width: 1.5 },
        { name: "vpl_m", label: "VPL", of: (m) => m.column("vpl_m"), hue: "m3", width: 1.5, dash: [6, 2] },
        { name: "hal_m", label: "HAL", of: (m) => Float64Array.from(m.rows, (row) => m.limit("hal_m", row)), hue: "limit", dash: [5, 4] },
        { name: "val_m", label: "VAL", of: (m) => Float64Array.from(m.rows, (row) => m.limit("val_m", row)), hue: "limit", dash: [2, 3] },
    ],
    hidden: (model) => !model.known("hpl_m") && !model.known("vpl_m"),
};

const FONT = '11px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';
const WINDOW_S = 600;
/** Height of the band of modes. */
const RIBBON_PX = 16;
const LABELS_PX = 104;

export function strips(): Part {
    const charts = [DEVIATION, LEVELS].map(strip);
    const element = el("section", { class: "strips panel" }, ...charts.map((c) => c.element));
    return { element, show: (model, now_s) => charts.forEach((c) => c.show(model, now_s)) };
}

function strip(chart: Chart): Part {
    const plot = el("div", { class: "live-plot", "aria-hidden": "true" });
    const words = el("p", { class: "sr" });
    const key = el("p", { class: "strip-key" }, ...chart.lines.map((line) => el("span", {}, el("i", { class: `hue-${line.hue}${line.dash === undefined ? "" : " dashed"}` }), `${line.mirror ? "±" : ""}${line.label}`)));
    const element = el("figure", { class: "strip", id: chart.id }, el("h2", {}, chart.title), key, plot, words);
    let u: uPlot | null = null;
    let threshold = 1;
    let hues = "";
    let current: Model | null = null;
    let end = 0;
    let drawn = "";
    const show = (model: Model, now_s: number): void => {
        current = model;
        element.hidden = chart.hidden?.(model) ?? false;
        if (element.hidden || model.rows.length === 0) return;
        const { speed } = model.snapshot!.session.origin;
        const fresh = model.freshness(now_s);
        // What came last stays to be read: the hatch takes at most a third, and what has ended is a record.
        const since = Math.min(model.age_s(now_s) * (speed || 1), WINDOW_S / 3);
        end = (model.rows.at(-1)![0] as number) + (present(fresh) || fresh === "ended" ? 0 : since);
        const width = Math.max(240, plot.clientWidth);
        // A pixel is about half a second: between two of them there is nothing new to see.
        const picture = `${Math.floor((end * width) / WINDOW_S)} ${fresh} ${model.word("alert")} ${model.holes.length} ${model.snapshot!.client} ${colour("ink")} ${width}`;
        if (picture === drawn) return;
        drawn = picture;
        const data = dataOf(chart, model);
        const usual = usualSize(chart, model);
        const hue = `${colour("ink")} ${width} ${usual}`;
        if (u === null || hue !== hues) {
            hues = hue;
            threshold = usual;
            u?.destroy();
            u = new uPlot(options(chart, width, threshold, () => end, (v) => { if (current !== null) decorate(v, chart, current, end); }), data, plot);
        } else u.setData(data);
        element.dataset.rows = String(model.rows.length);
        element.dataset.holes = String(model.holes.length);
        const text = `Ten minutes up to ${clock(model.number("utc_s"))} UTC: ${chart.lines.map((line) => line.label).join(", ")}. The numbers of now stand in the panels above, those of events in the table below.`;
        if (words.textContent !== text) words.textContent = text;
    };
    return { element, show };
}

/** Two neighbours that are further apart than the monitor may be silent, or between which epochs were not received, have no line between them. */
function dataOf(chart: Chart, model: Model): uPlot.AlignedData {
    const x = model.column("utc_s");
    const breaks = new Set(holes(model).map(([from]) => from));
    const columns = chart.lines.map((line) => line.of(model));
    const times: number[] = [];
    const series: (number | null)[][] = chart.lines.flatMap((line) => (line.mirror ? [[], []] : [[]]));
    for (let i = 0; i < x.length; i++) {
        times.push(x[i]!);
        let s = 0;
        chart.lines.forEach((line, k) => {
            const v = columns[k]![i]!;
            series[s++]!.push(Number.isFinite(v) ? v : null);
            if (line.mirror) series[s++]!.push(Number.isFinite(v) ? -v : null);
        });
        if (breaks.has(x[i]!)) {
            times.push(x[i]! + 1e-3);
            series.forEach((column) => column.push(null));
        }
    }
    return [times, ...series];
}

/** Spans without epochs: not received by this page, or longer than the monitor takes for silence. */
function holes(model: Model): [number, number][] {
    const stale = model.snapshot!.session.monitor_stale_s;
    const x = model.column("utc_s");
    const silent: [number, number][] = [];
    for (let i = 1; i < x.length; i++) if (x[i]! - x[i - 1]! > stale) silent.push([x[i - 1]!, x[i]!]);
    return [...model.holes, ...silent];
}

/** Linear up to about the size of the data, logarithmic beyond, so that data and limits are seen at once. */
function usualSize(chart: Chart, model: Model): number {
    const magnitudes = chart.lines.filter((line) => line.hue !== "limit").flatMap((line) => Array.from(line.of(model), Math.abs)).filter(Number.isFinite).sort((a, b) => a - b);
    return 10 ** Math.floor(Math.log10(Math.max(1, magnitudes[Math.floor(0.9 * magnitudes.length)] ?? 1)));
}

function options(chart: Chart, width: number, threshold: number, end: () => number, draw: (u: uPlot) => void): uPlot.Options {
    const axis = { font: FONT, stroke: colour("muted"), grid: { stroke: colour("rule"), width: 1 }, ticks: { show: false } };
    const range: uPlot.Range.MinMax = [0, 0];
    const day = (s: number): number => s - mod(s, 86_400);
    return {
        width, height: chart.height, padding: [8, width >= 700 ? LABELS_PX : 12, chart.ribbon ? RIBBON_PX + 4 : 0, 0], legend: { show: false }, cursor: { show: false },
        scales: {
            x: { time: false, range: () => { range[0] = end() - WINDOW_S; range[1] = end(); return range; } },
            y: { distr: 4, asinh: threshold, range: (_u, low, high) => { const most = 1.3 * Math.max(Math.abs(low ?? 1), Math.abs(high ?? 1)); return [(low ?? 0) < 0 ? -most : 0, most]; } },
        },
        axes: [
            { ...axis, size: 26, space: 70, splits: (_u, _i, min, max, _incr, space) => clockTicks(min - day(max), max - day(max), space ?? 70, width).map((t) => t + day(max)), values: (_u, splits) => splits.map((s) => clock(s).slice(0, 5)) },
            { ...axis, size: 52, space: 24, filter: (_u, splits) => splits, splits: (_u, _i, min, max) => thinned(asinhTicks(min, max, threshold)), values: (_u, splits) => splits.map((s) => plain(s ?? NaN, Math.abs(s ?? 0) < 1 && s !== 0 ? 1 : 0)) },
        ],
        series: [{}, ...chart.lines.flatMap((line): uPlot.Series[] => {
            const one: uPlot.Series = { stroke: colour(line.hue), width: line.width ?? 1, dash: line.dash, points: { show: false }, spanGaps: false };
            return line.mirror ? [one, { ...one }] : [one];
        })],
        hooks: { drawClear: [draw], draw: [(u) => names(u, chart)] },
    };
}

/** Where decades crowd, every other one, zero always. */
function thinned(ticks: number[]): number[] {
    return ticks.length <= 9 ? ticks : ticks.filter((_, i) => (i - (ticks.length - 1) / 2) % 2 === 0);
}

function decorate(u: uPlot, chart: Chart, model: Model, end: number): void {
    const { ctx, bbox } = u;
    const at = (utc: number): number => Math.min(bbox.left + bbox.width, Math.max(bbox.left, u.valToPos(utc, "x", true)));
    const last = model.rows.at(-1)![0] as number;
    ctx.save();
    ctx.fillStyle = hatch(ctx);
    const gone = runsOf(model.words("alert")).filter((run) => run.label === "unavailable").map((run): [number, number] => [model.rows[run.from]![0] as number, model.rows[Math.min(run.to + 1, model.rows.length - 1)]![0] as number]);
    for (const [from, to] of [...holes(model), ...gone, ...(end > last ? [[last, end] as [number, number]] : [])]) ctx.fillRect(at(from), bbox.top, Math.max(devicePixelRatio, at(to) - at(from)), bbox.height);
    // An alert is a bar at the upper edge for as long as it lasted.
    for (const run of runsOf(model.words("alert"))) {
        if (run.label === null || run.label === "normal") continue;
        ctx.fillStyle = colour(severity(run.label) === 0 ? "warning" : "caution");
        const from = at(model.rows[run.from]![0] as number);
        ctx.fillRect(from, bbox.top, Math.max(2 * devicePixelRatio, at(model.rows[Math.min(run.to + 1, model.rows.length - 1)]![0] as number) - from), 3 * devicePixelRatio);
    }
    if (chart.ribbon) ribbon(u, model, at);
    ctx.restore();
}

/** What keeps the position. Red and amber mean alerts on this page, so a mode is green, blue or grey. */
function ribbon(u: uPlot, model: Model, at: (utc: number) => number): void {
    const { ctx, bbox } = u;
    const ratio = devicePixelRatio;
    const top = u.ctx.canvas.height - RIBBON_PX * ratio;
    ctx.font = FONT.replace("11px", `${11 * ratio}px`);
    ctx.textBaseline = "middle";
    for (const run of runsOf(model.words("nav_mode"))) {
        const [from, to] = [at(model.rows[run.from]![0] as number), at(model.rows[Math.min(run.to + 1, model.rows.length - 1)]![0] as number)];
        const mode = run.label === null ? undefined : MODES[run.label];
        const hue = mode === undefined || mode.hue === "caution" || mode.hue === "warning" ? "muted" : mode.hue;
        ctx.globalAlpha = run.label === null ? 0.12 : 0.4;
        ctx.fillStyle = colour(hue);
        ctx.fillRect(from, top, Math.max(ratio, to - from), RIBBON_PX * ratio);
        ctx.globalAlpha = 1;
        const text = run.label === null ? "mode not stated" : mode?.words ?? run.label;
        if (ctx.measureText(text).width + 8 * ratio > Math.min(to, bbox.left + bbox.width) - from) continue;
        ctx.fillStyle = colour("ink");
        ctx.textAlign = "left";
        ctx.fillText(text, from + 4 * ratio, top + (RIBBON_PX * ratio) / 2);
    }
}

/** Names of the lines at their ends, where there is room beside the chart. */
function names(u: uPlot, chart: Chart): void {
    const { ctx, bbox } = u;
    if (u.width < 700) return;
    const ratio = devicePixelRatio;
    ctx.save();
    ctx.font = FONT.replace("11px", `${11 * ratio}px`);
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    let series = 1;
    const placed: number[] = [];
    for (const line of chart.lines) {
        const v = Array.from(u.data[series] ?? []).findLast((each) => each != null);
        series += line.mirror ? 2 : 1;
        if (v == null) continue;
        let y = u.valToPos(v, "y", true);
        while (placed.some((other) => Math.abs(other - y) < 12 * ratio)) y -= 3 * ratio;
        placed.push(y);
        ctx.fillStyle = colour(line.hue);
        ctx.fillText(`${line.mirror ? "±" : ""}${line.label}`, bbox.left + bbox.width + 8 * ratio, y);
    }
    ctx.restore();
}
