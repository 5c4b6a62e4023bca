// The page: verdict, pictures, tables, small print.

import "uplot/dist/uPlot.min.css";
import "./show/page.css";
import { anp } from "./chart/anp.ts";
import { lateral, vertical } from "./chart/deviation.ts";
import { honesty } from "./chart/honesty.ts";
import { approaches } from "./approaches/page.ts";
import { filter } from "./filter/page.ts";
import { gnss, gnssOfLevels } from "./gnss/page.ts";
import { alertLimit } from "./chart/alertlimit.ts";
import { exceedance } from "./chart/risk.ts";
import { performance } from "./chart/scales.ts";
import { states } from "./chart/states.ts";
import { linkByTime, type Cursor } from "./data/link.ts";
import { heardOf } from "./data/heard.ts";
import { blockOf, groundTracks, type Ground } from "./data/others.ts";
import type { Payload } from "./data/records.ts";
import { eventWindow, indexAt } from "./data/events.ts";
import { scene, type AxisName, type Component, type Scene } from "./data/scene.ts";
import { Store } from "./data/store.ts";
import { Table, type NumberName } from "./data/table.ts";
import { map } from "./map/map.ts";
import { cursorBar } from "./panel/cursorbar.ts";
import { indicatorsOf } from "./panel/kpi-verdict.ts";
import { procedures } from "./panel/procedure.ts";
import { performance as performanceReport } from "./panel/performance.ts";
import { spanShown } from "./panel/shown.ts";
import { smallPrint } from "./panel/smallprint.ts";
import { alertLimits, crossTrack, events, faults, methods, phases, rejections, tracks } from "./panel/tables.ts";
import { verdict } from "./panel/verdict.ts";
import { choice, el } from "./show/dom.ts";
import { showWorld } from "./world/page.ts";
import type { World } from "./world/records.ts";
import { choose, themeStore, type Choice } from "./show/theme.ts";

/** The parts of the page that show one track, in order, and the columns of which one is needed to say anything. */
const PARTS: { component: Component; host: "upper" | "charts"; needs: NumberName[]; aloft?: true }[] = [
    { component: map, host: "upper", needs: ["est_lat_rad"] },
    { component: performance, host: "upper", needs: ["rnp_m", "fte_m", "fte_v_m"] },
    { component: lateral, host: "charts", needs: ["fte_m"] },
    { component: vertical, host: "charts", needs: ["fte_v_m", "baro_off_m"], aloft: true },
    { component: anp, host: "charts", needs: ["anp_circle_m", "anp_sphere_m"] },
    { component: alertLimit, host: "charts", needs: ["hal_m"] },
    { component: exceedance, host: "charts", needs: ["p_exceed_2rnp"] },
    { component: states, host: "charts", needs: ["p_state_1"], aloft: true },
];

class Page {
    private readonly theme = themeStore();
    private readonly axis = new Store<AxisName>("time");
    private readonly measured = el("div");
    private readonly upper = el("div", { class: "upper" });
    private readonly charts = el("div", { class: "charts" });
    private readonly bar = el("div");
    private readonly selector = el("select", { id: "track", "aria-label": "Track shown" });
    private readonly trackTable: ReturnType<typeof tracks>;
    private series: Cursor | null = null;
    private current: Scene | null = null;
    private ends: (() => void)[] = [];

    private readonly payload: Payload;
    private readonly grounds: Store<Ground[]>;

    constructor(payload: Payload) {
        this.payload = payload;
        this.grounds = groundTracks(payload);
        this.trackTable = tracks(payload, () => this.current?.table.track ?? "", (t) => void this.select(t));
    }

    async show(root: HTMLElement): Promise<void> {
        const { payload } = this;
        const { summary } = payload;
        const beside = el("div");
        root.replaceChildren(this.header(), this.measured, beside, this.upper, this.charts);
        verdict(root.querySelector("#verdict-place")!, payload);
        this.series = performanceReport(this.measured, payload, this.theme);
        approaches(beside, payload, this.theme, (track) => void this.select(track).then(() => this.upper.scrollIntoView({ behavior: "smooth" })));
        honesty(root, summary);
        // A run that judged no track has no tracks and no methods to list.
        const alone = indicatorsOf(payload) !== null;
        const heading = alone ? "The input" : summary.tracks.length === 1 ? "The flight in numbers" : "The tracks in numbers";
        const tables = el("section", { id: "tables" }, el("h2", {}, heading), alone ? null : this.trackTable.element);
        if (summary.phases.length > 0) tables.append(phases(payload));
        for (const part of [alertLimits(payload), faults(payload), crossTrack(payload), events(payload, () => this.current, (t) => this.select(t)), rejections(payload)]) if (part !== null) tables.append(part);
        const flown = procedures(payload);
        if (flown !== null) this.upper.before(flown);
        root.append(tables, ...(alone ? [] : [methods(payload)]), smallPrint(payload), this.bar);
        this.listTracks();
        const first = payload.tracks[0];
        if (first === undefined && this.series !== null) {
            this.charts.replaceChildren();
            await gnssOfLevels(this.charts, payload, this.theme, this.series);
        }
        else if (first === undefined) this.charts.append(el("p", { class: "note" }, "No epochs to draw."));
        else await this.select(summary.verdict.worst_accuracy?.track ?? first.track);
        root.dataset.ready = "true";
    }

    /** Draws the charts of another track; the worst one when that is not embedded. */
    async select(track: string): Promise<void> {
        const { payload } = this;
        const head = payload.tracks.find((t) => t.track === track) ?? payload.tracks[0]!;
        const table = await Table.open(payload, head, blockOf(head));
        this.ends.forEach((end) => end());
        const now = scene(payload, table, this.theme, this.axis, this.grounds, await heardOf(payload, table));
        this.current = now;
        this.selector.value = head.track;
        // A performance report is not asked for a path; without one its page does not list what a path would give.
        // That a roll has no vertical path and no specification of flight needs no words.
        const rolls = payload.summary.operation === "ground";
        const explained = (part: (typeof PARTS)[number]): boolean => this.series === null && !(rolls && part.aloft);
        const drawn = PARTS.filter((part) => explained(part) || part.needs.some((name) => table.has(name)));
        const happened = eventWindow(now);
        this.ends = [spanShown(this.charts, now, happened), ...drawn.map(({ component, host }) => component(this[host], now)), filter(this.charts, now), gnss(this.charts, now), cursorBar(this.bar, now)];
        const worst = payload.summary.verdict.worst_accuracy;
        now.cursor.set(worst !== null && worst.track === head.track ? indexAt(worst.time_ns, now) : Math.floor(table.n / 2));
        // What happened is shown first; the whole is one key away.
        now.window.set(happened);
        if (this.series !== null) this.ends.push(linkByTime({ table, cursor: now.cursor, width_s: 0 }, this.series));
        this.trackTable.refresh();
    }

    private header(): HTMLElement {
        const { summary } = this.payload;
        const theme = choice<Choice>("Theme", [["auto", "Auto"], ["light", "Light"], ["dark", "Dark"]], "auto", choose);
        return el("header", {}, el("div", { class: "title" }, el("p", { class: "brand" }, "navbound"), el("h1", {}, summary.title)), el("div", { class: "head-tools" }, this.selectorBox(), theme), el("div", { id: "verdict-place" }));
    }

    private selectorBox(): HTMLElement | null {
        if (this.payload.tracks.length < 2) return null;
        this.selector.addEventListener("change", () => void this.select(this.selector.value));
        return el("label", { class: "selector" }, "Track ", this.selector);
    }

    private listTracks(): void {
        const labels = new Map(this.payload.summary.tracks.map((t) => [t.track, t.label]));
        this.selector.append(...this.payload.tracks.map((t) => el("option", { value: t.track }, labels.get(t.track) ?? t.track)));
    }
}

const root = document.getElementById("report")!;
const payload = JSON.parse(document.getElementById("navbound-data")!.textContent) as Payload | World;
const shown = payload.schema_id === "navbound-world-1" ? showWorld(root, payload) : new Page(payload).show(root);
shown.catch((error: unknown) => {
    root.prepend(el("p", { role: "alert", class: "failed" }, `This page could not be drawn: ${error instanceof Error ? error.message : String(error)}. The records are in summary.json and epochs.parquet beside it.`));
    throw error;
});
