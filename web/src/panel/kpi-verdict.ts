// The verdict of a performance run: the levels that were asked for, and their integrity, availability, continuity and accuracy.

import type { LevelResult, Performance } from "../records.gen.ts";
import type { Payload } from "../data/records.ts";
import { el, svg, valueOf } from "../show/dom.ts";
import { count, duration, metres, NONE, plain, share } from "../show/format.ts";
import { headline, toneOf } from "./kpi-headline.ts";
import { counted } from "./levels.ts";

const STATES = {
    inside: { word: "No hazard", mark: "M5 13 L10 18 L19 7" },
    warning: { word: "Hazardous", mark: "M6 6 L18 18 M18 6 L6 18" },
    caution: { word: "Misleading", mark: "M12 4 L21 20 L3 20 Z M12 10 L12 14 M12 16.8 L12 17" },
    unknown: { word: "Integrity not judged", mark: "M8.5 9 A3.6 3.6 0 1 1 12 13 L12 15 M12 18.4 L12 18.6" },
} as const;

/** What the page is about where nobody asked for RNP; null where there is another verdict, or no performance record. */
export function indicatorsOf(payload: Payload): Performance | null {
    const { summary } = payload;
    const record = summary.performance ?? null;
    return record !== null && record.levels.length > 0 && summary.accuracy.length === 0 ? record : null;
}

export function kpiVerdict(host: HTMLElement, payload: Payload, record: Performance): void {
    const { assumptions } = payload.summary;
    const tone = toneOf(record);
    const mark = svg("svg", { viewBox: "0 0 24 24", width: 26, height: 26, "aria-hidden": "true" }, svg("path", { d: STATES[tone].mark }));
    // A level that no integrity rests on, or of which too little was seen, earns no green.
    const { id } = payload.summary.verdict;
    const qualified = record.experimental !== "" || id === "not_shown" ? "unknown" : id === "outside" ? "caution" : tone;
    const shown = id === "not_believable" ? "warning" : tone === "inside" ? qualified : tone;
    const withdrawn = { not_believable: "Not believable", nothing_judged: "Nothing judged", not_shown: "Not shown", outside: "Not always available", inside: null }[id];
    // The panel itself has the colour.
    const words = headline(record);
    words.className = "words";
    host.append(el("section", { class: "verdict", id: "verdict", "data-tone": shown, "aria-label": "Verdict" },
        el("p", { class: "state" }, mark, STATES[tone].word, withdrawn === null ? null : el("span", { class: "tag" }, withdrawn), el("span", { class: "requirement" }, record.levels.map((r) => r.level.id).join(", ")), record.experimental === "" ? null : el("span", { class: "tag" }, record.experimental)),
        words, el("dl", { class: "facts" }, ...record.levels.map((r) => ofLevel(r)), accuracy(record), subsets(record)),
        el("div", { class: "basis" },
            el("div", {}, el("p", {}, el("strong", {}, "Truth "), record.truth_known ? knownAt(record) : "unknown: neither accuracy nor integrity could be judged.")),
            assumptions.length > 0 ? el("div", { class: "assumed" }, el("strong", {}, "Assumed"), el("ul", {}, ...assumptions.map((a) => el("li", {}, a)))) : null)));
}

function knownAt(record: Performance): string {
    const of = (axis: "h" | "v"): string => `${count(record.axes.find((a) => a.axis === axis)?.error_m?.n ?? 0)} ${axis === "h" ? "horizontal" : "vertical"}`;
    return `known: ${of("h")} and ${of("v")} errors at ${count(record.n_solution)} epochs with a protection level.`;
}

function fact(label: string, value: Node | string, ...more: (string | null)[]): HTMLElement {
    return el("div", { class: "fact" }, el("dt", {}, label), el("dd", {}, value), ...more.filter((m) => m !== null).map((m) => el("dd", { class: "more" }, m)));
}

function ofLevel(r: LevelResult): HTMLElement {
    const losses = `${count(r.n_continuity_events)} ${r.n_continuity_events === 1 ? "loss" : "losses"}`;
    const continuity = r.continuity_risk === null ? "never available: continuity has no value" : r.window_meaningful ? `${losses}, risk of one within ${duration(r.window_s)} ${counted(r.continuity_risk)}` : `${losses}; epochs too far apart for a risk within ${duration(r.window_s)}`;
    const hazards = r.truth_known ? `${count(r.n_hazard_epochs)} hazardous, ${count(r.n_mi_epochs)} misleading epochs` : null;
    return fact(`${r.level.id} available`, valueOf("verdict.availability_expected", r.availability_expected, share(r.availability_expected)),
        `95 %: ${share(r.availability_low)} to ${share(r.availability_high)}, as from ${count(Math.round(r.n_effective))} independent epochs`, continuity, hazards);
}

function accuracy(record: Performance): HTMLElement | null {
    const [h, v] = ["h", "v"].map((axis) => record.axes.find((a) => a.axis === axis)?.error_m ?? null);
    if (!h) return null;
    return fact("Error, 95 %", valueOf("verdict.p95", h.p95, `${metres(h.p95)} / ${v ? metres(v.p95) : NONE}`), "horizontal / vertical", `largest ${metres(h.max)} / ${v ? metres(v.max) : NONE}, over ${count(h.n)} epochs`);
}

function subsets(record: Performance): HTMLElement | null {
    const s = record.subsets;
    if (s === null) return null;
    const largest = Math.max(s.safety_index_h_max, s.safety_index_v_max);
    return fact("Largest safety index of a satellite subset", valueOf("verdict.subset_index", largest, plain(largest, 3)), `${s.n_mi === 0 ? "none" : count(s.n_mi)} of ${count(s.n_subsets)} subsets misleading`,
        s.n_listed === 0 ? null : `${count(s.n_listed)} at ${plain(s.listed_from, 2)} or above`);
}
