// The performance report: what happened in words, the indicators of each level, diagrams, series, events, days.

import { causes, causeWords, protection } from "../chart/protection.ts";
import { stanford } from "../chart/stanford.ts";
import { bucketTable, payloadOf } from "../data/buckets.ts";
import type { Cursor } from "../data/link.ts";
import { utcOf } from "../data/events.ts";
import type { Ground } from "../data/others.ts";
import type { DayResult, KpiEvent, LevelResult, Performance, StanfordBins } from "../records.gen.ts";
import type { Payload } from "../data/records.ts";
import { scene, type AxisName, type Scene, type Window } from "../data/scene.ts";
import { Store } from "../data/store.ts";
import type { Table } from "../data/table.ts";
import { button, choice, el, setValue, valueOf } from "../show/dom.ts";
import { clock, count, date, duration, metres, NONE, share } from "../show/format.ts";
import { headline } from "./kpi-headline.ts";
import { indicatorsOf } from "./kpi-verdict.ts";
import { levelTable, spreadTable } from "./levels.ts";
import { serviceLog } from "./service.ts";
import { liveTable, sortable, type Column } from "./sortable.ts";
import { spanShown } from "./shown.ts";
import { subsetTable } from "./subsets.ts";

/** Returns its cursor, for others to follow; null where the run has no performance record. */
export function performance(host: HTMLElement, payload: Payload, theme: Store<number>): Cursor | null {
    const record = payload.summary.performance;
    if (record === null || record === undefined || record.levels.length === 0) return null;
    return new Section(host, payload, record, theme).at;
}

class Section {
    private readonly payload: Payload;
    private readonly record: Performance;
    private readonly theme: Store<number>;
    private readonly table: Table;
    private readonly buttons = el("span");
    private readonly charts = el("div", { class: "charts" });
    private readonly window = new Store<Window>(null);
    private readonly axis = new Store<AxisName>("time");
    readonly at: Cursor;
    private chosen: LevelResult;
    private variant: StanfordBins["variant"];
    private ends: (() => void)[] = [];

    constructor(host: HTMLElement, payload: Payload, record: Performance, theme: Store<number>) {
        this.payload = payload;
        this.record = record;
        this.theme = theme;
        this.table = bucketTable(record, payload);
        // A bucket of one epoch is an instant.
        this.at = { table: this.table, cursor: new Store(0), width_s: Math.max(0, record.series.width_ns / 1e9 - record.period_s) };
        this.chosen = worstLevel(record);
        this.variant = record.stanford[0]?.variant ?? "stanford";
        const events = eventTable(record, payload, (e) => this.goTo(e));
        // Where nothing else was asked, the verdict above has said what this section would begin with.
        const alone = indicatorsOf(payload) !== null;
        host.append(el("section", { id: "performance" }, el("h2", {}, alone ? "Indicators" : `Performance: ${record.title}`), !alone && record.experimental !== "" ? el("p", {}, el("span", { class: "tag" }, record.experimental)) : null, alone ? null : headline(record), scope(record, payload), levelTable(record),
            spreadTable("spread", "Errors and protection levels over the epochs with a solution", record.axes, payload, record.experimental), this.choices(), this.timeline(), this.charts, subsetTable(record, payload), serviceLog(record, payload, this.at), events, days(record, payload), ...(alone ? [] : record.notes.map((n) => el("p", { class: "note" }, n)))));
        this.at.cursor.set(Math.floor(this.table.n / 2));
        this.draw();
    }

    private choices(): HTMLElement {
        this.listLevels();
        const variants = [...new Set(this.record.stanford.map((s) => s.variant))];
        const kind = variants.length < 2 ? null : choice("Points of the Stanford diagram", [["stanford", "Epochs"], ["stanford-esa", "Satellite subsets (ESA)"]], this.variant, (v: StanfordBins["variant"]) => {
            this.variant = v;
            this.draw();
        });
        return el("div", { class: "choices" }, el("span", { class: "note" }, "Level drawn"), this.buttons, kind);
    }

    /** One button a level; one with a hazard says so before it is pressed. */
    private listLevels(): void {
        const { levels } = this.record;
        const group = choice("Level drawn", levels.map((r): [string, string] => [r.level.id, r.n_hazard_epochs > 0 ? `■ ${r.level.id}` : r.level.id]), this.chosen.level.id, (id) => {
            this.chosen = levels.find((r) => r.level.id === id)!;
            this.draw();
        });
        [...group.children].forEach((b, i) => { if (levels[i]!.n_hazard_epochs > 0) (b as HTMLElement).dataset.tone = "warning"; });
        this.buttons.replaceChildren(group);
    }

    /** The time under the cursor of the series, moved by the keyboard too. */
    private timeline(): HTMLElement {
        const slider = el("input", { type: "range", min: 0, max: this.table.n - 1, step: 1, id: "bucket", "aria-label": "Time under the cursor of the series" });
        const now = valueOf("bucket_utc_s", null, "");
        slider.addEventListener("input", () => this.at.cursor.set(Number(slider.value)));
        this.at.cursor.watch((i) => {
            const utc = this.table.utc_s(i);
            const words = `${date(utc)} ${clock(utc)} UTC`;
            slider.value = String(i);
            slider.setAttribute("aria-valuetext", words);
            setValue(now, utc, words);
        });
        const all = button("All of the time", {}, () => this.window.set(null));
        this.window.watch((w) => { all.disabled = w === null; });
        return el("div", { class: "choices timeline" }, now, slider, all);
    }

    private draw(): void {
        this.ends.forEach((end) => end());
        this.charts.replaceChildren();
        const { record, chosen } = this;
        const now: Scene = { ...scene(payloadOf(this.payload, record, chosen), this.table, this.theme, this.axis, new Store<Ground[]>([])), cursor: this.at.cursor, window: this.window };
        const pair = el("div", { class: "stanford-pair" });
        const diagrams = el("section", { id: "stanford" }, el("h3", {}, `Stanford diagrams, ${chosen.level.id}`), pair);
        const bins = record.stanford.filter((s) => s.variant === this.variant && (s.axis === "h" || chosen.level.val_m !== null));
        if (bins.length > 0) this.charts.append(diagrams);
        else this.charts.append(el("p", { class: "note" }, "No truth: no Stanford diagram."));
        this.ends = [
            ...bins.map((b) => stanford(pair, {
                bins: b, level: chosen.level, limit_m: b.axis === "h" ? chosen.level.hal_m : chosen.level.val_m!, experimental: record.experimental, theme: this.theme,
                counts: (b.variant === "stanford" ? chosen.stanford : record.subsets?.stanford[chosen.level.id])?.find((c) => c.axis === b.axis) ?? null,
            })),
            spanShown(this.charts, now), protection(this.charts, now, record, chosen, "h"), protection(this.charts, now, record, chosen, "v"), causes(this.charts, now, record),
        ];
        const available = spreadTable("spread-available", `Errors and protection levels while ${chosen.level.id} was available`, chosen.available, this.payload, record.experimental);
        if (available !== null) this.charts.append(available);
    }

    /** Moves the cursor to an event and zooms so that it can be seen. */
    private goTo(event: KpiEvent): void {
        const result = this.record.levels.find((r) => r.level.id === event.level);
        if (result !== undefined && result !== this.chosen) {
            this.chosen = result;
            this.listLevels();
            this.draw();
        }
        const at = (ns: number): number => this.table.nearest(utcOf(ns, this.payload) - this.table.start_utc_s);
        const i = at(event.onset_ns);
        const room = Math.max(20, 2 * (at(event.clear_ns ?? this.record.last_ns) - i));
        const [from, to] = [Math.max(0, i - room), Math.min(this.table.n - 1, i + 2 * room)];
        this.window.set(to > from ? { from, to } : null);
        this.at.cursor.set(i);
        this.charts.querySelector("#protection-h")?.scrollIntoView({ block: "start" });
    }
}

/** The level whose diagram must not be missed: most hazards, then most misleading epochs, then the narrowest limits. */
function worstLevel(record: Performance): LevelResult {
    const area = (r: LevelResult): number => r.level.hal_m * (r.level.val_m ?? 1e4);
    return [...record.levels].sort((a, b) => b.n_hazard_epochs - a.n_hazard_epochs || b.n_mi_epochs - a.n_mi_epochs || area(a) - area(b))[0]!;
}

function scope(record: Performance, payload: Payload): HTMLElement {
    const when = (ns: number): string => `${date(utcOf(ns, payload))} ${clock(utcOf(ns, payload))}`;
    const part = (key: "n_expected" | "n_solution" | "n_missing" | "n_no_solution" | "n_repeated", words: string): (HTMLElement | string)[] => [valueOf(key, record[key], count(record[key])), words];
    return el("p", { class: "note" }, `${when(record.first_ns)} to ${when(record.last_ns)} UTC, an epoch every ${duration(record.period_s)}. `, ...part("n_expected", " epochs expected, "), ...part("n_solution", " with a solution, "),
        ...part("n_no_solution", " without, "), ...part("n_missing", record.exclude_missing ? " missing and left out of the grid" : " missing and counted as not available"), ...(record.n_repeated > 0 ? [", ", ...part("n_repeated", " of the same epoch as another; the worst of each counts")] : []), ".");
}

const KINDS: Record<KpiEvent["kind"], string> = { hazard: "■ hazard", mi: "▲ misleading", loss: "loss" };

function eventTable(record: Performance, payload: Payload, go: (e: KpiEvent) => void): HTMLElement {
    const total = Object.values(record.n_events).reduce((a, b) => a + b, 0);
    if (record.events.length === 0) return el("p", { class: "note" }, "No loss of availability, no hazard, no misleading information.");
    const at = (ns: number): string => `${date(utcOf(ns, payload))} ${clock(utcOf(ns, payload), true)}`;
    const change = <V>(before: V | null, now: V | null): string => (before === null && now === null ? NONE : `${before ?? NONE} → ${now ?? NONE}`);
    const level = (name: string): string => (record.experimental === "" ? name : `${name}, experimental`);
    const length = (head: string, key: "hpe_max_m" | "hpl_max_m" | "vpe_max_m" | "vpl_max_m"): Column<KpiEvent> => ({ head, key, of: (e) => e[key], show: (e) => metres(e[key]) });
    const text = (head: string, key: "level" | "reason"): Column<KpiEvent> => ({ head, key, words: true, of: (e) => e[key], show: (e) => (e[key] === "" ? NONE : e[key]) });
    const columns: Column<KpiEvent>[] = [
        { head: "Onset, UTC", key: "onset_ns", of: (e) => e.onset_ns, show: (e) => at(e.onset_ns) }, text("Level", "level"), { head: "Kind", key: "kind", words: true, of: (e) => e.kind, show: (e) => KINDS[e.kind] },
        { head: "Duration", key: "duration_s", of: (e) => e.duration_s, show: (e) => `${duration(e.duration_s)}${e.clear_ns === null ? ", to the end" : ""}` }, { head: "Epochs", key: "n_epochs", of: (e) => e.n_epochs, show: (e) => count(e.n_epochs) },
        { head: "Over time to alert", key: "over_tta", words: true, of: (e) => (e.over_tta === null ? null : String(e.over_tta)), show: (e) => (e.over_tta === null ? NONE : e.over_tta ? "yes" : "no") },
        { head: "Cause", key: "cause", words: true, of: (e) => e.cause, show: (e) => (e.cause === "" ? NONE : causeWords(e.cause)) }, text("What the table says", "reason"), length("HPE", "hpe_max_m"), length(level("HPL"), "hpl_max_m"), length("VPE", "vpe_max_m"), length(level("VPL"), "vpl_max_m"),
        { head: "Satellites", key: "n_sv_onset", of: (e) => e.n_sv_onset, show: (e) => change(e.n_sv_before, e.n_sv_onset) }, { head: "Mode", key: "mode_onset", words: true, of: (e) => e.mode_onset, show: (e) => change(e.mode_before, e.mode_onset) },
    ];
    const caption = `Integrity and availability events${record.events.length < total ? `; ${count(record.events.length)} of ${count(total)} shown, events.parquet has all` : ""}; press one to see it`;
    return liveTable({ id: "performance-events", caption, columns, rows: record.events, sortable: true, press: go, page: 20 }).element;
}

function days(record: Performance, payload: Payload): HTMLElement | null {
    if (record.days.length < 2) return null;
    const columns: Column<DayResult>[] = [
        { head: "Day", key: "start_ns", of: (d) => d.start_ns, show: (d) => date(utcOf(d.start_ns, payload)) }, { head: "Expected", key: "n_expected", of: (d) => d.n_expected, show: (d) => count(d.n_expected) },
        { head: "With a solution", key: "n_solution", of: (d) => d.n_solution, show: (d) => count(d.n_solution) },
        ...record.levels.map(({ level }): Column<DayResult> => ({ head: `${level.id} available`, key: `n_available.${level.id}`, of: (d) => d.n_available[level.id] ?? null, show: (d) => share((d.n_available[level.id] ?? 0) / d.n_expected) })),
    ];
    return sortable({ id: "days", caption: "Days", columns, rows: record.days, sortable: true });
}
