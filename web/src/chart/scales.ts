// Navigation performance scales: the ends are the limit, bars grow inward by the actual navigation performance,
// what is left between them is the room for flight technical error, the pointer is the deviation.

import type { Scene } from "../data/scene.ts";
import type { NumberName } from "../data/table.ts";
import { el, setValue, svg, valueOf } from "../show/dom.ts";
import { level, limitName, metres, nauticalMiles, rnpName, SHORT_M, signedMetres } from "../show/format.ts";
import { columnOf } from "./methods.ts";

/** Values of one epoch; NaN where there is none. */
export type Read<K extends string> = (name: K) => number;

export interface Gauge<K extends string = NumberName> {
    title: string;
    vertical: boolean;
    /** The ends are a required limit, not only the ends of the scale. */
    required: boolean;
    deviation: K;
    /** Whether there can be a deviation. */
    pointed: boolean;
    limit: (read: Read<K>) => number;
    limitWords: (limit_m: number) => string;
    /** Column of the 95 % navigation error bound along this direction. */
    anp: K | null;
    rows: [key: K, label: string, show: (v: number) => string][];
}

const LENGTH = 280;
const HALF = 120;

export function performance(host: HTMLElement, scene: Scene): () => void {
    const section = el("section", { class: "scales", "aria-label": "Navigation performance scales at the cursor" }, el("h3", {}, "Navigation performance at the cursor"));
    const gauges = [lateralGauge(scene), verticalGauge(scene)].filter((g): g is Gauge => g !== null);
    const updates = gauges.map((gauge) => {
        const built = drawGauge(gauge);
        section.append(built.element);
        return (i: number) => built.update((name) => scene.table.value(name, i));
    });
    if (gauges.length === 0) section.append(el("p", { class: "note" }, "Neither a path nor a limit was given: there is no scale to show."));
    host.append(section);
    const end = scene.cursor.watch((i) => updates.forEach((update) => update(i)));
    return () => {
        end();
        section.remove();
    };
}

function lateralGauge(scene: Scene): Gauge | null {
    const { table, payload } = scene;
    if (!table.has("rnp_m")) return null;
    const anp = (["anp_cross_m", "anp_circle_m"] as const).find((c) => table.has(c)) ?? null;
    const bound = payload.summary.accuracy.find((m) => m.id === payload.summary.verdict.method);
    const rows: Gauge["rows"] = [["rnp_m", "RNP", (v) => (v < SHORT_M ? limitName(v) : `${nauticalMiles(v)} · ${metres(v)}`)]];
    if (anp !== null) rows.push([anp, `ANP 95 %, ${anp === "anp_cross_m" ? "across track" : "circle"}`, metres]);
    if (table.has("fte_m")) rows.push(["fte_m", "FTE", signedMetres]);
    if (bound !== undefined && bound.error_column === "tse_m" && table.has(columnOf(bound, false))) rows.push([columnOf(bound, false), `TSE bound ${level(bound.risk)}, ${bound.id}`, metres]);
    return { title: "Lateral", vertical: false, required: true, deviation: "fte_m", pointed: table.has("fte_m"), limit: (read) => read("rnp_m"), limitWords: rnpName, anp, rows };
}

function verticalGauge(scene: Scene): Gauge | null {
    const { table, payload } = scene;
    if (!table.has("fte_v_m")) return null;
    const anp = table.has("anp_vertical_m") ? "anp_vertical_m" : null;
    const bound = payload.summary.accuracy.find((m) => m.error_column === "tse_v_m" && table.has(columnOf(m, false)));
    const rows: Gauge["rows"] = [];
    if (anp !== null) rows.push([anp, "ANP 95 %, vertical", metres]);
    rows.push(["fte_v_m", "FTE vertical", signedMetres]);
    if (table.has("baro_off_m")) rows.push(["baro_off_m", "By altimeter", signedMetres]);
    if (bound !== undefined) rows.push([columnOf(bound, false), `TSE bound ${level(bound.risk)}, ${bound.id}`, metres]);
    if (table.has("limit_v_m")) return { title: "Vertical", vertical: true, required: true, deviation: "fte_v_m", pointed: true, limit: (read) => read("limit_v_m"), limitWords: (v) => (Number.isFinite(v) ? `${metres(v)} (75 ft)` : "no vertical path here"), anp, rows };
    // RNP sets no vertical limit: the ends are round lengths that hold the whole flight, and say so.
    const largest = Math.max(1, ...Array.from(table.column("fte_v_m")!, (v) => (Number.isFinite(v) ? Math.abs(v) : 0)));
    const step = 10 ** Math.floor(Math.log10(largest));
    const end = [1, 2, 5, 10].map((f) => f * step).find((v) => v >= largest) ?? 10 * step;
    return { title: "Vertical", vertical: true, required: false, deviation: "fte_v_m", pointed: true, limit: () => end, limitWords: (v) => `${metres(v)}, scale only: no vertical limit`, anp, rows };
}

export function drawGauge<K extends string>(gauge: Gauge<K>): { element: HTMLElement; update: (read: Read<K>) => void } {
    const middle = LENGTH / 2;
    const bars = [svg("rect", { class: "anp-bar", y: 9, height: 18 }), svg("rect", { class: "anp-bar", y: 9, height: 18 })];
    const pointer = svg("path", { class: "pointer", d: "M0 6 L7 18 L0 30 L-7 18 Z" });
    const ticks = [-1, -0.5, 0.5, 1].map((t) => svg("line", { class: Math.abs(t) === 1 ? "gauge-end" : "gauge-tick", x1: middle + t * HALF, x2: middle + t * HALF, y1: Math.abs(t) === 1 ? 4 : 13, y2: Math.abs(t) === 1 ? 32 : 23 }));
    const picture = svg("svg", { viewBox: `0 0 ${LENGTH} 36`, class: gauge.required ? "gauge" : "gauge no-limit", role: "img" },
        svg("line", { class: "gauge-line", x1: middle - HALF, x2: middle + HALF, y1: 18, y2: 18 }), ...bars, ...ticks,
        svg("line", { class: "gauge-centre", x1: middle, x2: middle, y1: 6, y2: 30 }), pointer);
    const ends = el("p", { class: "gauge-ends" });
    const cells = gauge.rows.map(([key, label, show]) => ({ key, show, cell: valueOf(key, null, ""), label }));
    const list = el("dl", { class: "digits" }, ...cells.flatMap(({ label, cell }) => [el("dt", {}, label), el("dd", {}, cell)]));
    const sides = gauge.vertical ? ["below", "above"] : ["left", "right"];
    const none = gauge.pointed ? null : el("p", { class: "note" }, "No path was given: there is no deviation to point at.");
    const element = el("div", { class: "gauge-box" }, el("div", { class: "gauge-head" }, el("h4", {}, gauge.title), ends), picture,
        el("div", { class: "gauge-sides", "aria-hidden": "true" }, el("span", {}, sides[0]!), el("span", {}, sides[1]!)), none, list);
    const update = (read: Read<K>): void => {
        const limit = gauge.limit(read);
        const deviation = read(gauge.deviation);
        const anp = gauge.anp === null ? NaN : read(gauge.anp);
        const share = Math.min(1, anp / limit);
        const width = Number.isFinite(share) ? Math.max(share * HALF, 3) : 0;
        bars[0]!.setAttribute("x", String(middle - HALF));
        bars[1]!.setAttribute("x", String(middle + HALF - width));
        bars.forEach((bar) => bar.setAttribute("width", String(width)));
        const off = Math.max(-1.12, Math.min(1.12, deviation / limit));
        pointer.setAttribute("transform", `translate(${Number.isFinite(off) ? middle + off * HALF : middle} 0)`);
        // Beyond the scale the pointer stands at its end and is hollow: its number says how far.
        pointer.classList.toggle("parked", Math.abs(deviation / limit) > 1);
        pointer.setAttribute("visibility", Number.isFinite(off) ? "visible" : "hidden");
        ends.textContent = `ends ±${gauge.limitWords(limit)}`;
        for (const { key, show, cell } of cells) {
            const v = read(key);
            setValue(cell, v, show(v));
        }
        const words = `${gauge.title} deviation ${Number.isFinite(deviation) ? signedMetres(deviation) : "unknown"} of a limit of ${metres(limit)}; actual navigation performance ${metres(anp)}`;
        picture.setAttribute("aria-label", words);
    };
    return { element, update };
}
