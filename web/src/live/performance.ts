// Performance now: the two scales, the bounds against RNP and twice RNP, the protection levels against their alert limits.

import { drawGauge, type Gauge } from "../chart/scales.ts";
import { el, setValue, svg, valueOf } from "../show/dom.ts";
import { level, limitName, metres, nauticalMiles, rnpName, SHORT_M } from "../show/format.ts";
import { DASHES, length, say, signed, type Part } from "./parts.ts";
import type { Model } from "./state.ts";

const LATERAL: Gauge<string> = {
    title: "Lateral", vertical: false, required: true, deviation: "fte_m", pointed: true, limit: (read) => read("rnp_m"), limitWords: (v) => (Number.isFinite(v) ? rnpName(v) : DASHES), anp: "anp_m",
    rows: [["rnp_m", "RNP", (v) => (Number.isFinite(v) ? (v < SHORT_M ? limitName(v) : `${nauticalMiles(v)} · ${metres(v)}`) : DASHES)], ["anp_m", "ANP 95 %", length], ["fte_m", "Deviation", signed]],
};

/** RNP sets no vertical limit: a stated alert limit ends the scale, or round lengths do, which say that they are none. */
function verticalEnd(deviation: number, anp: number): number {
    const largest = Math.max(10, Math.abs(deviation) || 0, anp || 0);
    const step = 10 ** Math.floor(Math.log10(largest));
    return [1, 2, 5, 10].map((f) => f * step).find((v) => v >= largest)!;
}

/** Whether the ends of the vertical scale are an alert limit. */
let limited = false;

const VERTICAL: Gauge<string> = {
    title: "Vertical", vertical: true, required: false, deviation: "fte_v_m", pointed: true,
    limit: (read) => (Number.isFinite(read("val_m")) ? read("val_m") : verticalEnd(read("fte_v_m"), read("anp_vertical_m"))),
    limitWords: (v) => (Number.isFinite(v) ? `${metres(v)}${limited ? " (VAL)" : ", scale only"}` : ""), anp: "anp_vertical_m",
    rows: [["anp_vertical_m", "ANP 95 %", length], ["fte_v_m", "Deviation", signed]],
};

export function scales(): Part {
    const built = [LATERAL, VERTICAL].map((gauge) => drawGauge(gauge));
    const cross = el("p", { class: "crossed", "aria-hidden": "true" });
    const element = el("section", { class: "scales panel", "aria-label": "Navigation performance" }, el("h2", {}, "Navigation performance"), el("div", { class: "gauges" }, ...built.map((b) => b.element)), cross);
    const show = (model: Model, now_s: number): void => {
        const believed = model.believed(now_s);
        const fresh = model.freshness(now_s);
        element.classList.toggle("gone", !believed);
        say(cross, believed ? "" : fresh === "fresh" || fresh === "ageing" ? (model.word("status") === "ok" || model.word("status") === "degraded" || model.word("status") === null ? "NOT MONITORED" : "NO POSITION") : fresh.toUpperCase());
        const read = (name: string): number => {
            if (!believed) return NaN;
            if (name === "val_m") return model.limit(name);
            if (name !== "anp_m") return model.number(name);
            const across = model.number("anp_cross_m");
            return Number.isFinite(across) ? across : model.number("anp_circle_m");
        };
        limited = Number.isFinite(read("val_m"));
        for (const { update } of built) update(read);
        // Of what is not known nothing is drawn, the scale of the ends included.
        if (!believed) for (const ends of element.querySelectorAll(".gauge-ends")) say(ends as HTMLElement, "");
    };
    return { element, show };
}

interface Bar {
    key: string;
    name: string;
    limitName: string;
    of: (model: Model) => number;
    limit: (model: Model) => number;
    /** The alert of which the bar is the cause. */
    kind: string | null;
}

const SCALE = 0.78;

/** Bars against a limit: the tick is the limit, and what is beyond the end of the bar has an arrow. */
function bars(title: string, note: string, list: Bar[], hidden: (model: Model) => boolean): Part {
    const rows = list.map((bar) => {
        const fill = svg("rect", { class: "bound-bar", x: 0, y: 3, height: 10, width: 0 });
        const tick = svg("line", { class: "bound-limit", x1: 100 * SCALE, x2: 100 * SCALE, y1: 0, y2: 16 });
        const beyond = svg("path", { class: "bound-beyond", d: "M97 3 L100 8 L97 13 Z", visibility: "hidden" });
        const picture = svg("svg", { viewBox: "0 0 100 16", preserveAspectRatio: "none", class: "bound", role: "img" }, svg("line", { class: "bound-base", x1: 0, x2: 100, y1: 8, y2: 8 }), fill, beyond, tick);
        const [value, limit, margin] = [valueOf(bar.key, null, DASHES), valueOf(`${bar.key}.limit`, null, DASHES), valueOf(`${bar.key}.margin`, null, DASHES)];
        const name = el("span", { class: "bound-name" }, bar.name);
        const row = el("div", { class: "bound-row" }, el("div", { class: "bound-head" }, name, value), picture, el("div", { class: "bound-foot" }, el("span", {}, `${bar.limitName} `, limit), el("span", {}, "margin ", margin)));
        const show = (model: Model, believed: boolean): void => {
            const [v, l] = believed ? [bar.of(model), bar.limit(model)] : [NaN, NaN];
            const share = Math.min(1, (SCALE * v) / l);
            fill.setAttribute("width", Number.isFinite(share) ? String(Math.max(100 * share, 0.8)) : "0");
            tick.setAttribute("visibility", Number.isFinite(l) ? "visible" : "hidden");
            beyond.setAttribute("visibility", share >= 1 ? "visible" : "hidden");
            row.dataset.tone = believed && bar.kind !== null && model.kinds().has(bar.kind) ? bar.kind : "";
            setValue(value, v, length(v));
            setValue(limit, l, length(l));
            setValue(margin, l - v, signed(l - v));
            picture.setAttribute("aria-label", `${name.textContent}: ${length(v)} of ${length(l)}`);
        };
        return { row, show };
    });
    const element = el("section", { class: "bounds panel" }, el("h2", {}, title), ...rows.map((r) => r.row), el("p", { class: "note" }, note));
    const show = (model: Model, now_s: number): void => {
        element.hidden = hidden(model);
        const believed = model.believed(now_s);
        element.classList.toggle("gone", !believed);
        for (const row of rows) row.show(model, believed);
    };
    return { element, show };
}

export function tseBars(): Part {
    const note = el("span");
    const part = bars("Total system error", "", [
        { key: "accuracy_bound_m", name: "Accuracy bound", limitName: "RNP", of: (m) => m.number("accuracy_bound_m"), limit: (m) => m.number("rnp_m"), kind: "caution" },
        { key: "integrity_compared_m", name: "Integrity bound", limitName: "2 RNP", of: (m) => m.number("integrity_compared_m"), limit: (m) => 2 * m.number("rnp_m"), kind: "warning" },
    ], () => false);
    part.element.querySelector(".note")!.append(note);
    const show = (model: Model, now_s: number): void => {
        part.show(model, now_s);
        const session = model.snapshot?.session;
        if (session !== undefined) say(note, `${session.method}: ${level(session.risk_accuracy)}, ${level(session.risk_integrity)}; the integrity bound is at least |deviation| + HPL${session.assumed === "" ? "" : `; ${session.assumed}`}.`);
    };
    return { element: part.element, show };
}

export function levelBars(): Part {
    return bars("Protection levels", "Against the alert limits of the record, else of the level named to the command; without one there is no margin.", [
        { key: "hpl_m", name: "HPL", limitName: "HAL", of: (m) => m.number("hpl_m"), limit: (m) => m.limit("hal_m"), kind: null },
        { key: "vpl_m", name: "VPL", limitName: "VAL", of: (m) => m.number("vpl_m"), limit: (m) => m.limit("val_m"), kind: null },
    ], (model) => !model.known("hpl_m") && !model.known("vpl_m"));
}
