// The verdict: state and words first, then the few numbers behind it.

import { nameOf, type Belief, type BoundCheck, type Payload, type Verdict, type VerdictId, type Worst } from "../data/records.ts";
import { utcOf } from "../data/events.ts";
import { about } from "../chart/methods.ts";
import { el, svg, valueOf } from "../show/dom.ts";
import { indicatorsOf, kpiVerdict } from "./kpi-verdict.ts";
import { clock, count, date, level, limitName, nauticalMiles, place, plain, share, SHORT_M, signedMetres } from "../show/format.ts";

/** Faults and moments on the first screen; the table below lists every fault. */
const SHOWN_FAULTS = 4;
const SHOWN_MOMENTS = 16;

type Tone = "inside" | "caution" | "warning" | "unknown";

const STATES: Record<VerdictId, { word: string; mark: string }> = {
    inside: { word: "Inside", mark: "M5 13 L10 18 L19 7" },
    outside: { word: "Outside", mark: "M6 6 L18 18 M18 6 L6 18" },
    not_shown: { word: "Not shown", mark: "M12 4 L21 20 L3 20 Z M12 10 L12 14 M12 16.8 L12 17" },
    not_believable: { word: "Not believable", mark: "M6 6 L18 18 M18 6 L6 18" },
    nothing_judged: { word: "Nothing judged", mark: "M8.5 9 A3.6 3.6 0 1 1 12 13 L12 15 M12 18.4 L12 18.6" },
};

export function verdict(host: HTMLElement, payload: Payload): void {
    const { summary } = payload;
    const record = indicatorsOf(payload);
    if (record !== null) {
        kpiVerdict(host, payload, record);
        return;
    }
    const v = summary.verdict;
    const state = STATES[v.id];
    const method = summary.accuracy.find((m) => m.id === v.method);
    const mark = svg("svg", { viewBox: "0 0 24 24", width: 26, height: 26, "aria-hidden": "true" }, svg("path", { d: state.mark }));
    const section = el("section", { class: "verdict", id: "verdict", "data-tone": toneOf(v), "aria-label": "Verdict" },
        el("p", { class: "state" }, mark, valueOf("id", v.id, state.word), el("span", { class: "requirement" }, v.requirement), v.experimental ? el("span", { class: "tag" }, "experimental") : null,
            v.n_implausible > 0 ? el("span", { class: "tag" }, valueOf("n_implausible", v.n_implausible, count(v.n_implausible)), ` of ${count(v.n_epochs)} epochs cannot be true`) : null,
            v.n_judged < v.least_share * v.n_epochs ? el("span", { class: "tag" }, `${share((v.n_epochs - v.n_judged) / v.n_epochs)} of the epochs not ok or not judged`) : null),
        lead(v),
        contradictions(v.belief),
        story(payload),
        facts(payload, method?.risk),
        el("div", { class: "basis" },
            el("div", {}, el("p", {}, el("strong", {}, "Judged by "), method === undefined ? v.method : `${method.id}: ${about(method)}.`),
                el("p", {}, el("strong", {}, "Truth "), truth(v))),
            summary.assumptions.length > 0 ? el("div", { class: "assumed" }, el("strong", {}, "Assumed"), el("ul", {}, ...summary.assumptions.map((a) => el("li", {}, a)))) : null));
    host.append(section);
}

/** Red is for integrity alone: an accuracy limit passed is a caution. A sigma that no data states earns no green. */
export function toneOf(v: Pick<Verdict, "id" | "assumed" | "share_contained" | "worst_integrity">): Tone {
    if (v.id === "not_believable") return "warning";
    if (v.id === "nothing_judged") return "unknown";
    if (v.id === "not_shown") return "caution";
    if (v.id === "outside") return (v.worst_integrity?.margin_m ?? 0) < 0 || (v.share_contained ?? 1) < 1 ? "warning" : "caution";
    return isAssumed(v) ? "unknown" : "inside";
}

function isAssumed(v: Pick<Verdict, "assumed">): boolean {
    return v.assumed.some((a) => a !== "no_path");
}

/** Whether the state of an epoch may be green: one that rests on bounds that are not shown, or on a sigma that no data states, may not. */
export function earnsGreen(v: Pick<Verdict, "id" | "assumed">): boolean {
    return (v.id === "inside" || v.id === "outside") && !isAssumed(v);
}

/** What the numbers beside it do not say; a machine finds the shares in it. */
function lead(v: Verdict): HTMLElement {
    const [first, ...beside] = v.lead.length > 0 ? v.lead : v.sentences;
    const words = valueOf("share_inside", v.share_inside, first!);
    words.classList.replace("value", "lead");
    return el("div", { class: "words" },
        el("p", { "data-key": "share_contained", "data-value": v.share_contained ?? undefined }, words),
        beside.length > 0 ? el("ul", {}, ...beside.map((sentence) => el("li", {}, sentence))) : null);
}

function facts(payload: Payload, risk: number | undefined): HTMLElement {
    const v = payload.summary.verdict;
    const rows: HTMLElement[] = [];
    if (v.worst_accuracy !== null) rows.push(worst("Worst margin to RNP", "worst_accuracy", v.worst_accuracy, payload));
    if (v.worst_integrity !== null) rows.push(worst("Worst margin to 2 RNP", "worst_integrity", v.worst_integrity, payload));
    for (const check of v.belief?.bounds.filter((b) => b.risk === risk) ?? []) rows.push(contained(check));
    return el("dl", { class: "facts" }, ...rows);
}

/** What the declared faults of the flights did, and when the monitor spoke: of the first flights, as many as are read. */
function story(payload: Payload): HTMLElement | null {
    const { faults, tracks } = payload.summary;
    if (faults.length === 0) return null;
    const several = tracks.length > 1;
    const outcomes = faults.slice(0, SHOWN_FAULTS).map((f) => `${several ? `${nameOf(payload.summary, f.track)}, ` : ""}${f.kind}: ${f.outcome_words}.`);
    const of = faults[0]!.track;
    const moments = faults.filter((f) => f.track === of).flatMap((f) => f.moments).sort((a, b) => a.time_ns - b.time_ns).slice(0, SHOWN_MOMENTS);
    return el("div", { class: "story" }, el("p", {}, el("strong", {}, several ? `What happened on ${of}` : "What happened")),
        el("ol", {}, ...moments.map((m) => el("li", {}, el("time", {}, `${clock(utcOf(m.time_ns, payload), true)} UTC`), ` ${m.words}`))),
        ...outcomes.map((words) => el("p", { class: "more" }, words)));
}

/** What truth contradicts, as tags that no reader of the first screen misses. */
function contradictions(belief: Belief | null): HTMLElement | null {
    const bounds = [...(belief?.bounds ?? []), ...(belief?.beside ?? [])].filter((c) => c.refuted);
    const levels = (belief?.levels ?? []).filter((c) => c.n_above > 0);
    if (bounds.length + levels.length === 0) return null;
    const tags = [
        ...bounds.map((c) => el("span", { class: "tag" }, `${c.method}, ${level(c.risk)}: contains `, valueOf(`refuted.${c.method}.${c.risk}`, c.coverage, share(c.coverage)))),
        ...levels.map((c) => el("span", { class: "tag" }, `error above ${c.level === "hpl_m" ? "HPL" : "VPL"} at `, valueOf(`above.${c.level}`, c.n_above, count(c.n_above)), ` of ${count(c.n)} epochs`)),
    ];
    return el("p", { class: "state contradicted" }, "Truth contradicts ", ...tags);
}

function truth(v: Verdict): string {
    if (!v.truth_known) return "unknown: bounds could not be checked against errors.";
    if (v.belief === null) return `known at ${count(v.n_truth)} epochs, none of which has a bound to check.`;
    return `known at ${count(v.belief.n_truth)} of ${count(v.belief.n_epochs)} checked epochs${v.belief.n_epochs > 0 ? ` (${share(v.belief.n_truth / v.belief.n_epochs)})` : ""}.`;
}

function contained(check: BoundCheck): HTMLElement {
    return el("div", { class: "fact" }, el("dt", {}, `Error within ${check.method}, claim ${level(check.risk)}`),
        el("dd", {}, valueOf(`belief.${check.method}`, check.coverage, share(check.coverage))),
        el("dd", { class: "more" }, `95 %: ${share(check.coverage_low)} to ${share(check.coverage_high)}, as from ${plain(check.n_effective, check.n_effective < 10 ? 1 : 0)} independent epochs`));
}

function worst(label: string, key: string, w: Worst, payload: Payload): HTMLElement {
    const when = utcOf(w.time_ns, payload);
    const along = w.along_m === null ? null : `${nauticalMiles(w.along_m, 1)} along the path`;
    const many = payload.summary.tracks.length > 1 ? nameOf(payload.summary, w.track) : null;
    const where = [`${clock(when, true)} UTC ${date(when)}`, many, w.phase, along, place(w.lat_rad, w.lon_rad)].filter((x) => x !== null).join(" · ");
    return el("div", { class: "fact" }, el("dt", {}, label),
        el("dd", {}, valueOf(`${key}.margin_m`, w.margin_m, signedMetres(w.margin_m)), w.limit_m < SHORT_M ? null : el("span", { class: "also" }, nauticalMiles(w.margin_m))),
        el("dd", { class: "more" }, `bound ${signedMetres(w.bound_m).replace("+", "")} of ${limitName(w.limit_m)} · ${where}`));
}
