// The four indicators of every level: what is required, what was reached. One column a level.

import type { AxisResult, Level, LevelResult, Performance, Spread } from "../records.gen.ts";
import { utcOf } from "../data/events.ts";
import type { Payload } from "../data/records.ts";
import { el, valueOf } from "../show/dom.ts";
import { clock, count, date, duration, metres, NONE, plain, risk, share, wholeMetres } from "../show/format.ts";
import { sortable, type Column } from "./sortable.ts";

interface Row {
    head: string;
    /** A group's first row carries its name. */
    group?: string;
    cell: (r: LevelResult) => { key: string; value: number | string | boolean | null; text: string; more?: string; tone?: "warning" | "caution" };
}

/** How a requirement is held; printed ones need no word. */
function provenance(level: Level, field: string): string {
    const word = level.provenance[field];
    return word === undefined || word === "printed" ? "" : ` (${word})`;
}

function required(value: number | null, level: Level, field: string, show: (v: number) => string): string {
    return value === null ? "nothing required" : `required: ≤ ${show(value)}${provenance(level, field)}`;
}

function limitsProvenance(level: Level): string {
    const words = [level.provenance["hal_m"], ...(level.val_m === null ? [] : [level.provenance["val_m"]])];
    return [...new Set(words.map((w) => w ?? "unmarked"))].join(" / ");
}

function accuracyRow(axis: "h" | "v", performance: Performance): Row {
    const error = performance.axes.find((a) => a.axis === axis)?.error_m?.p95 ?? null;
    return {
        head: axis === "h" ? "Horizontal error, 95 %" : "Vertical error, 95 %", ...(axis === "h" ? { group: "Accuracy" } : {}),
        cell: ({ level }) => {
            const limit = axis === "h" ? level.accuracy_h_m : level.accuracy_v_m;
            const worse = error !== null && limit !== null && error > limit;
            return { key: `accuracy_${axis}_m`, value: error, text: metres(error), more: required(limit, level, `accuracy_${axis}_m`, wholeMetres), ...(worse ? { tone: "caution" as const } : {}) };
        },
    };
}

/** A share of what was counted: none is none. */
export function counted(value: number | null): string {
    return value === 0 ? "0" : risk(value);
}

/** Events for each 100 000 epochs, to three digits. */
function rate(value: number | null): string {
    if (value === null || value === 0) return value === null ? NONE : "0";
    return plain(value, Math.max(0, 2 - Math.floor(Math.log10(value))));
}

function rows(performance: Performance): Row[] {
    const limit = (value: number | null): string => (value === null ? "none" : wholeMetres(value));
    const window = performance.levels[0]?.window_s ?? NaN;
    const list: Row[] = [
        { head: "Alert limits, HAL / VAL", cell: ({ level }) => ({ key: "hal_m", value: level.hal_m, text: `${limit(level.hal_m)} / ${limit(level.val_m)}`, more: limitsProvenance(level) }) },
        accuracyRow("h", performance), accuracyRow("v", performance),
        { head: "Of the expected epochs", group: "Availability", cell: (r) => ({ key: "availability_expected", value: r.availability_expected, text: share(r.availability_expected), more: `95 %: ${share(r.availability_low)} to ${share(r.availability_high)}, as from ${count(Math.round(r.n_effective))} independent epochs` }) },
        { head: "Of the epochs with a solution", cell: (r) => ({ key: "availability_solution", value: r.availability_solution, text: share(r.availability_solution), more: `${count(r.n_available)} of ${count(r.n_solution)}` }) },
        {
            head: `Risk of a loss within ${duration(window)}`, group: "Continuity",
            cell: (r) => ({
                key: "continuity_risk", value: r.continuity_risk, text: r.window_meaningful ? counted(r.continuity_risk) : "not meaningful",
                more: r.window_meaningful ? required(r.level.continuity_risk, r.level, "continuity_risk", (v) => `${risk(v)} per ${r.level.continuity_per ?? "window"}`) : `epochs are further apart than ${duration(r.window_s)}`,
            }),
        },
        { head: "Losses", cell: (r) => ({ key: "n_continuity_events", value: r.n_continuity_events, text: count(r.n_continuity_events), more: r.events_per_1e5 === null ? "" : `in 100 000 epochs: ${rate(r.events_per_1e5)}, 95 %: ${rate(r.events_per_1e5_low)} to ${rate(r.events_per_1e5_high)}` }) },
        { head: "Losses to expect in 900 s (maritime)", cell: (r) => ({ key: "continuity_risk_maritime", value: r.continuity_risk_maritime, text: counted(r.continuity_risk_maritime) }) },
    ];
    return performance.truth_known ? [...list, ...integrityRows()] : [...list, { head: "Hazardous or misleading epochs", group: "Integrity", cell: () => ({ key: "integrity", value: null, text: "unknown", more: "no truth" }) }];
}

function integrityRows(): Row[] {
    const events = (n: number, over: number, longest_s: number, tta_s: number): string => (n === 0 ? "none" : `${count(n)} ${n === 1 ? "run" : "runs"}, ${count(over)} over ${duration(tta_s)}, longest ${duration(longest_s)}`);
    return [
        {
            head: "Hazardously misleading, epochs", group: "Integrity",
            cell: (r) => ({ key: "n_hazard_epochs", value: r.n_hazard_epochs, text: `${r.n_hazard_epochs > 0 ? "■ " : ""}${count(r.n_hazard_epochs)}`, more: events(r.n_hazard_events, r.n_hazard_over_tta, r.longest_hazard_s, r.level.tta_s), ...(r.n_hazard_epochs > 0 ? { tone: "warning" as const } : {}) }),
        },
        {
            head: "Misleading, epochs",
            cell: (r) => ({ key: "n_mi_epochs", value: r.n_mi_epochs, text: `${r.n_mi_epochs > 0 ? "▲ " : ""}${count(r.n_mi_epochs)}`, more: events(r.n_mi_events, r.n_mi_over_tta, r.longest_mi_s, r.level.tta_s), ...(r.n_mi_epochs > 0 ? { tone: "caution" as const } : {}) }),
        },
        { head: "Time to alert", cell: ({ level }) => ({ key: "tta_s", value: level.tta_s, text: `${duration(level.tta_s)}${provenance(level, "tta_s")}` }) },
        { head: "Integrity risk required", cell: ({ level }) => ({ key: "integrity_risk", value: level.integrity_risk, text: level.integrity_risk === null ? NONE : `${risk(level.integrity_risk)} per ${level.integrity_per ?? "exposure"}${provenance(level, "integrity_risk")}`, more: "too small to be measured by counting" }) },
    ];
}

export function levelTable(performance: Performance): HTMLElement {
    const { levels } = performance;
    const mark = performance.experimental === "" ? "" : `, ${performance.experimental}`;
    const caption = `Levels of service${mark}`;
    const heads = levels.map(({ level }) => el("th", { scope: "col", title: `${level.title}. ${level.source}` }, level.id, mark === "" ? null : el("span", { class: "more" }, performance.experimental)));
    const body = rows(performance).flatMap((row) => {
        const cells = levels.map((r) => {
            const { key, value, text, more, tone } = row.cell(r);
            const cell = el("td", { "data-level": r.level.id, "data-tone": tone }, valueOf(key, typeof value === "boolean" ? String(value) : value, text));
            if (more !== undefined && more !== "") cell.append(el("span", { class: "more" }, more));
            return cell;
        });
        const group = row.group === undefined ? [] : [el("tr", { class: "group" }, el("th", { scope: "rowgroup", colspan: levels.length + 1 }, row.group))];
        return [...group, el("tr", {}, el("th", { scope: "row" }, row.head), ...cells)];
    });
    return el("div", { class: "table-box" }, el("p", { class: "table-title", "aria-hidden": "true" }, caption),
        el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": caption }, el("table", { id: "levels", class: "levels" }, el("caption", { class: "sr" }, caption), el("thead", {}, el("tr", {}, el("th", { scope: "col" }, "Indicator"), ...heads)), el("tbody", {}, ...body))));
}

interface SpreadRow {
    key: string;
    what: string;
    spread: Spread;
    show: (v: number) => string;
}

/** How errors, levels and their ratio are spread over some epochs. */
export function spreadTable(id: string, caption: string, axes: AxisResult[], payload: Payload, experimental: string): HTMLElement | null {
    const mark = experimental === "" ? "" : ", experimental";
    const ratio = (v: number): string => plain(v, 3);
    const rowsOf = (a: AxisResult): SpreadRow[] => {
        const one = a.axis.toUpperCase();
        const entry = (key: string, what: string, spread: Spread | null, show: (v: number) => string): SpreadRow[] => (spread === null ? [] : [{ key, what, spread, show }]);
        return [...entry("error", `${one}PE`, a.error_m, metres), ...entry("level", `${one}PL${mark}`, a.level_m, metres), ...entry("safety_index", `${one}PE / ${one}PL${mark}`, a.safety_index, ratio)];
    };
    const all = axes.flatMap(rowsOf);
    if (all.length === 0) return null;
    const number = (head: string, field: "mean" | "rms" | "p50" | "p95" | "p99" | "p999" | "max"): Column<SpreadRow> => ({ head, key: field, of: (r) => r.spread[field], show: (r) => r.show(r.spread[field]) });
    const when = (ns: number): string => `${date(utcOf(ns, payload))} ${clock(utcOf(ns, payload), true)}`;
    return sortable<SpreadRow>({
        id, caption: experimental === "" ? caption : `${caption}; ${experimental}`, rows: all,
        columns: [{ head: "Quantity", key: "quantity", words: true, of: (r) => r.what, show: (r) => r.what }, { head: "Epochs", key: "n", of: (r) => r.spread.n, show: (r) => count(r.spread.n) },
            number("Mean", "mean"), number("RMS", "rms"), number("50 %", "p50"), number("95 %", "p95"), number("99 %", "p99"), number("99.9 %", "p999"), number("Largest", "max"),
            { head: "Largest at, UTC", key: "max_time_ns", of: (r) => r.spread.max_time_ns, show: (r) => when(r.spread.max_time_ns) }],
    });
}
