// Errors, protection levels and alert limits against time, and beneath them why a level was not available.

import type uPlot from "uplot";
import { causeOf, unavailableOf } from "../data/buckets.ts";
import type { Axis, LevelResult, Performance } from "../records.gen.ts";
import type { Scene } from "../data/scene.ts";
import { el, svg } from "../show/dom.ts";
import { duration, metres, NONE, share, wholeMetres } from "../show/format.ts";
import { colour, type Colour } from "../show/theme.ts";
import { hatch } from "./decorate.ts";
import { strip, type Line, type Scale } from "./strip.ts";

const FLOOR_M = 0.01;
const NAMES: Record<Axis, { name: string; error: string; level: string; limit: string }> = {
    h: { name: "Horizontal", error: "HPE", level: "HPL", limit: "HAL" },
    v: { name: "Vertical", error: "VPE", level: "VPL", limit: "VAL" },
};

/** Error, protection level and alert limit of one axis. */
export function protection(host: HTMLElement, scene: Scene, performance: Performance, drawn: LevelResult, axis: Axis): () => void {
    const { table } = scene;
    const { name, error, level, limit } = NAMES[axis];
    const [high, low, errors] = [table.column(`${axis}pl_max_m`)!, table.column(`${axis}pl_min_m`)!, table.column(`${axis}pe_max_m`)!];
    const mark = performance.experimental === "" ? "" : `, ${performance.experimental}`;
    // The full words stand at the title and in the line of values; the end of a line has room for one.
    const short = mark === "" ? "" : " experimental";
    const [most, least] = mark === "" ? [`${level}, largest`, `${level}, smallest`] : [`${level} max,`, `${level} min,`];
    const one = performance.series.width_ns <= 1.5e9 * performance.period_s;
    const lines: Line[] = [];
    if (performance.truth_known) lines.push({ key: `${axis}pe_max_m`, label: one ? error : `${error}, largest`, values: errors, colour: "ink", width: 1, front: 2, about: `${name} position error against truth` });
    lines.push({ key: `${axis}pl_max_m`, label: `${one ? level : `${level}, largest`}${mark}`, endLabel: `${one ? level : most}${short}`, values: high, colour: "m1", width: 1.3, front: 1, about: `${name} protection level${mark}`, ...(one ? {} : { downTo: `${axis}pl_min_m` }) });
    if (!one) lines.push({ key: `${axis}pl_min_m`, label: `${level}, smallest${mark}`, endLabel: `${least}${short}`, values: low, colour: "m1", width: 0.8, dash: [3, 3], front: 1, about: `${name} protection level${mark}` });
    const limits = new Map<number, string[]>();
    for (const { level: l } of performance.levels) {
        const value = axis === "h" ? l.hal_m : l.val_m;
        if (value !== null) limits.set(value, [...(limits.get(value) ?? []), l.id]);
    }
    const mine = axis === "h" ? drawn.level.hal_m : drawn.level.val_m;
    for (const [value, ids] of limits) lines.push({ key: `${axis}al_${value}`, label: `${limit} of ${ids.join(", ")}`, endLabel: `${limit} ${wholeMetres(value)}`, values: new Float64Array(table.n).fill(value), colour: "limit", width: 1.5, limit: true, hidden: value !== mine, about: `${name} alert limit of ${ids.join(", ")}` });
    const width = duration(performance.series.width_ns / 1e9);
    const note = `${one ? "Every epoch." : `${performance.truth_known ? "The largest error and the" : "The"} span of the protection level in each ${width}: no epoch is lost.`}${performance.truth_known ? "" : " No truth: the error is unknown."}${mine === null ? ` ${drawn.level.id} asks nothing of the vertical.` : ""}`;
    return strip(host, scene, { id: `protection-${axis}`, title: `${name} error and protection level${mark}`, note, unit: "m", lines, scales: scalesFor(high, mine), floor: FLOOR_M, show: (v) => metres(v), height: 250 });
}

/** Linear to the limit where that leaves the levels visible, logarithmic where it does not. */
function scalesFor(levels: Float64Array, limit: number | null): Scale[] {
    if (limit === null) return ["data", "log"];
    const largest = levels.reduce((most, v) => (v > most ? v : most), 0);
    return limit > 12 * largest ? ["log", "data", "limits"] : ["limits", "data", "log"];
}

/** Hue and words of each cause; a cause that is not listed is drawn like the last. */
const CAUSES: Record<string, { hue: Colour; words: string }> = {
    hpl: { hue: "m1", words: "HPL at or beyond HAL" },
    vpl: { hue: "m2", words: "VPL at or beyond VAL" },
    "hpl and vpl": { hue: "m3", words: "both at or beyond their limits" },
    "no vertical level": { hue: "m5", words: "no vertical level" },
    "no solution": { hue: "m4", words: "no solution" },
    "no epoch": { hue: "muted", words: "no epoch" },
};
/** A cause as said; one that is not listed is said as it is written. */
export function causeWords(cause: string): string {
    return CAUSES[cause]?.words ?? cause;
}

const ROW_PX = 22;
/** A bucket with one unavailable epoch of thousands is still seen. */
const LEAST = 0.3;

/** One row a level: what was not available, and why. */
export function causes(host: HTMLElement, scene: Scene, performance: Performance): () => void {
    const ids = performance.levels.map((l) => l.level.id);
    if (Object.values(performance.series.cause).every((causes) => causes.every((c) => c === ""))) {
        const note = el("p", { class: "note", id: "causes" }, "Every level was available at every expected epoch.");
        host.append(note);
        return () => note.remove();
    }
    const lines: Line[] = ids.map((id) => ({ key: unavailableOf(id), label: id, values: scene.table.column(unavailableOf(id))!, colour: "caution", quiet: true, about: `Share of the expected epochs at which ${id} was not available` }));
    const draw = (u: uPlot): void => ribbons(u, scene, ids);
    const one = performance.series.width_ns <= 1.5e9 * performance.period_s;
    const note = `Coloured where a level was not available, by its most frequent cause${one ? "" : `; height by the share of the ${duration(performance.series.width_ns / 1e9)} that was lost`}.`;
    const end = strip(host, scene, {
        id: "causes", title: "Loss of availability and its cause", note, unit: "", scales: ["data"], range: [0, ids.length], height: 56 + ROW_PX * ids.length, draw, lines, noPaths: true,
        show: (v) => (v === 0 ? "available" : Number.isFinite(v) ? `${share(v)} lost` : NONE), words: ids.map((id) => ({ key: causeOf(id), label: id, text: (cause) => (cause === null ? NONE : causeWords(cause)) })), ySplits: () => [], yTick: () => "",
    });
    host.lastElementChild!.insertBefore(legend(performance), host.lastElementChild!.lastElementChild);
    return end;
}

function legend(performance: Performance): HTMLElement {
    const present = new Set(Object.values(performance.series.cause).flat().filter((c) => c !== ""));
    const entry = (cause: string): HTMLElement => el("span", { class: "key" }, svg("svg", { width: 14, height: 10, "aria-hidden": "true" }, svg("rect", { width: 14, height: 10, fill: `var(--${(CAUSES[cause] ?? CAUSES["no epoch"]!).hue})` })), causeWords(cause));
    return el("p", { class: "map-legend note", id: "cause-legend" }, ...[...present].sort().map(entry));
}

function ribbons(u: uPlot, scene: Scene, ids: string[]): void {
    const { ctx, bbox } = u;
    const { table } = scene;
    const x = u.data[0]!;
    const hues = new Map(Object.entries(CAUSES).map(([cause, { hue }]) => [cause, colour(hue)]));
    const names: (() => void)[] = [];
    ctx.save();
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    ctx.font = `${11 * devicePixelRatio}px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif`;
    ids.forEach((id, row) => {
        const bottom = u.valToPos(ids.length - 1 - row, "y", true) - 2 * devicePixelRatio;
        const room = u.valToPos(ids.length - 1 - row, "y", true) - u.valToPos(ids.length - row, "y", true) - 5 * devicePixelRatio;
        const lost = table.column(unavailableOf(id))!;
        ctx.fillStyle = colour("rule");
        ctx.fillRect(bbox.left, bottom, bbox.width, devicePixelRatio);
        // Beside the row where there is room, else in it, on a ground of its own.
        const wide = u.width - (bbox.left + bbox.width) / devicePixelRatio > 100;
        names.push(() => {
            const [left, middle] = [wide ? bbox.left + bbox.width + 12 * devicePixelRatio : bbox.left + 3 * devicePixelRatio, bottom - room / 2];
            if (!wide) {
                ctx.fillStyle = colour("ground");
                ctx.fillRect(bbox.left, bottom - room, ctx.measureText(id).width + 6 * devicePixelRatio, room);
            }
            ctx.fillStyle = colour("muted");
            ctx.fillText(id, left, middle);
        });
        for (let i = 0; i < table.n; i++) {
            if (!(lost[i]! > 0)) continue;
            const left = u.valToPos(x[i]!, "x", true);
            const right = i + 1 < x.length ? u.valToPos(x[i + 1]!, "x", true) : left;
            // On whole pixels, so that neighbours leave no seam.
            const [from, to] = [Math.round(Math.max(left, bbox.left)), Math.round(Math.min(Math.max(right, left + 1.5 * devicePixelRatio), bbox.left + bbox.width))];
            if (to <= from) continue;
            const height = Math.max(LEAST, lost[i]!) * room;
            const cause = table.word(causeOf(id), i) ?? "";
            ctx.fillStyle = hues.get(cause) ?? colour("muted");
            ctx.fillRect(from, bottom - height, to - from, height);
            if (cause === "no epoch") {
                ctx.fillStyle = hatch(ctx);
                ctx.fillRect(from, bottom - height, to - from, height);
            }
        }
    });
    names.forEach((name) => name());
    ctx.restore();
}
