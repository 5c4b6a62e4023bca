// Alerts in force with acknowledge, the wait to the next caution, and the list of everything that was raised and cleared.

import { ALERT_WORDS } from "../records.gen.ts";
import { button, el, svg } from "../show/dom.ts";
import { clock, duration, metres } from "../show/format.ts";
import { say, span, type Part } from "./parts.ts";
import { plainName, present, severity, type Model, type Transition } from "./state.ts";

const BLINK_S = 10;
const MOST_SHOWN = 200;

function symbol(kind: string): SVGElement {
    const shape = severity(kind) === 0 ? "M8 1 L15 15 L1 15 Z" : "M8 1 L15 8 L8 15 L1 8 Z";
    return svg("svg", { viewBox: "0 0 16 16", class: "alert-symbol", "aria-hidden": "true" }, svg("path", { d: shape }));
}

function word(kind: string): string {
    return kind === "unavailable" ? "UNAVAIL" : kind.replaceAll("_", " ").toUpperCase();
}

function details(t: Transition): string {
    const parts = [
        t.peak_m === null ? null : `largest bound ${metres(t.peak_m)}`, t.limit_m === null ? null : `limit ${metres(t.limit_m)}`, t.min_margin_m === null ? null : `margin ${metres(t.min_margin_m)}`,
        t.latency_s === null ? null : `reported after ${duration(t.latency_s)}${t.within_time_to_alert === false ? ", LATER THAN THE TIME TO ALERT" : ""}`,
    ];
    return parts.filter((p) => p !== null).join(", ");
}

export function alerts(acknowledge: (alert: string) => void): Part & { newest: () => void; all: () => void; step: (by: number) => void } {
    const list = el("ol", { class: "alert-list" });
    const none = el("p", { class: "alert-none" });
    const wait = countdown();
    const element = el("section", { class: "alerts panel", "aria-label": "Alerts in force" }, el("h2", {}, "Alerts in force"), wait.element, list, none);
    let last: Model | null = null;
    let listed = "";
    const raised = new Map<string, number>();
    const show = (model: Model, now_s: number): void => {
        last = model;
        const inForce = model.inForce();
        for (const each of inForce) if (!raised.has(each.alert)) raised.set(each.alert, now_s);
        const fresh = model.freshness(now_s);
        const state = inForce.map((t) => `${t.alert} ${model.acknowledged.has(t.alert)}`).join("\n");
        if (state !== listed) {
            listed = state;
            const focused = (document.activeElement as HTMLElement | null)?.closest<HTMLElement>("[data-alert]")?.dataset.alert;
            list.replaceChildren(...inForce.map((t) => row(t, model, acknowledge)));
            if (focused !== undefined) list.querySelector<HTMLElement>(`[data-alert="${CSS.escape(focused)}"] button`)?.focus();
        }
        const utc = model.number("utc_s");
        for (const item of list.children as HTMLCollectionOf<HTMLElement>) {
            const t = model.open.get(item.dataset.alert!);
            if (t === undefined) continue;
            const isNew = !model.acknowledged.has(t.alert) && now_s - raised.get(t.alert)! < BLINK_S;
            item.classList.toggle("new", isNew);
            say(item.querySelector<HTMLElement>(".alert-for")!, present(fresh) && Number.isFinite(utc) ? `(${span(utc - t.annunciation_utc_s)})` : "");
        }
        none.hidden = inForce.length > 0;
        const normal = present(fresh) && model.believed(now_s) && model.word("alert") === "normal";
        none.dataset.state = normal ? "normal" : "";
        say(none, normal ? "NORMAL" : present(fresh) ? "No alert in force" : "Not known");
        wait.show(model, now_s);
    };
    const buttons = (): HTMLButtonElement[] => [...list.querySelectorAll("button")];
    return {
        element, show,
        newest: () => {
            const [first] = (last?.inForce() ?? []).filter((t) => !last!.acknowledged.has(t.alert)).sort((a, b) => b.annunciation_utc_s - a.annunciation_utc_s);
            if (first !== undefined) acknowledge(first.alert);
        },
        all: () => (last?.inForce() ?? []).filter((t) => !last!.acknowledged.has(t.alert)).forEach((t) => acknowledge(t.alert)),
        step: (by) => {
            const all = buttons();
            const at = all.indexOf(document.activeElement as HTMLButtonElement);
            all[at < 0 ? 0 : (at + by + all.length) % all.length]?.focus();
        },
    };
}

function row(t: Transition, model: Model, acknowledge: (alert: string) => void): HTMLElement {
    const done = model.acknowledged.has(t.alert);
    const who = t.track === null ? "source" : plainName(t.track);
    const press = button(done ? "Acknowledged" : "Acknowledge", { "aria-label": `${done ? "Acknowledged" : "Acknowledge"}: ${word(t.kind)} of ${who}`, disabled: done }, () => acknowledge(t.alert));
    return el("li", { class: "alert-row", "data-alert": t.alert, "data-tone": severity(t.kind) === 0 ? "warning" : "caution" },
        symbol(t.kind), el("strong", { class: "alert-kind" }, word(t.kind)), el("span", { class: "alert-what" }, `${t.track !== null && model.snapshot!.tracks.length < 2 ? "" : `${who}: `}${ALERT_WORDS[t.kind]}`),
        el("span", { class: "alert-since" }, `since ${clock(t.annunciation_utc_s, true)} `, el("span", { class: "alert-for" })), press, el("span", { class: "alert-details" }, details(t)));
}

/** While an exceedance waits: how long until the caution, and where that stands in the time to alert. */
function countdown(): Part {
    const words = el("p", { class: "wait-words", role: "status" });
    const bar = el("div", { class: "wait-bar", "aria-hidden": "true" });
    const element = el("div", { class: "wait", hidden: true }, words, bar);
    let built = "";
    const show = (model: Model, now_s: number): void => {
        const session = model.snapshot?.session;
        const left = model.believed(now_s) ? model.number("caution_in_s") : NaN;
        element.hidden = session === undefined || !Number.isFinite(left);
        if (session === undefined || element.hidden) return;
        const key = JSON.stringify(session.chain);
        if (key !== built) {
            built = key;
            const parts = Object.entries(session.chain).filter(([, s]) => s > 0);
            const total = Math.max(session.time_to_alert_s, parts.reduce((sum, [, s]) => sum + s, 0));
            bar.replaceChildren(...parts.map(([name, s]) => {
                const part = el("span", { class: "wait-part", "data-part": name, title: `${name} ${duration(s)}` }, el("i"));
                part.style.flexGrow = String(s / total);
                return part;
            }));
            const free = el("span", { class: "wait-part free" });
            free.style.flexGrow = String(1 - parts.reduce((sum, [, s]) => sum + s, 0) / total);
            bar.append(free);
        }
        const used = 1 - left / (session.chain.wait || 1);
        const inner = bar.querySelector<HTMLElement>('[data-part="wait"] i');
        if (inner !== null) inner.style.width = `${100 * Math.min(1, Math.max(0, used))}%`;
        element.dataset.left = String(left);
        say(words, `Accuracy bound above RNP: caution in ${duration(left)}${left === 0 ? ", with the next epoch outside" : ""} (of a time to alert of ${duration(session.time_to_alert_s)})`);
    };
    return { element, show };
}

export function events(): Part {
    const body = el("tbody");
    const caption = el("caption", { class: "table-title" });
    const filter = el("input", { type: "search", id: "filter", "aria-label": "Filter events", placeholder: "filter" });
    const table = el("table", {}, caption, el("thead", {}, el("tr", {}, ...["UTC", "Track", "Kind", "What", "Begin, UTC", "Largest bound", "Least margin"].map((name, i) => el("th", { scope: "col", class: i > 0 && i < 4 ? "words" : undefined }, name)))), body);
    const element = el("section", { class: "events panel" }, el("div", { class: "events-head" }, el("h2", {}, "Events of the session"), filter), el("div", { class: "scroll" }, table));
    let shown = "";
    const show = (model: Model): void => {
        const requested = filter.value.trim().toLowerCase();
        const state = `${model.nTransitions} ${model.snapshot?.client} ${requested}`;
        if (state === shown) return;
        shown = state;
        const matching = [...model.events].reverse().filter((t) => requested === "" || `${t.track ?? "source"} ${t.kind} ${t.transition}`.toLowerCase().includes(requested));
        body.replaceChildren(...matching.slice(0, MOST_SHOWN).map((t) => el("tr", { "data-event": t.key, "data-tone": t.transition === "raised" ? (severity(t.kind) === 0 ? "warning" : "caution") : "" },
            el("td", {}, clock(t.event_utc_s, true)), el("td", { class: "words" }, t.track === null ? "source" : plainName(t.track)), el("td", { class: "words kind" }, word(t.kind)),
            el("td", { class: "words" }, t.transition), el("td", {}, clock(t.onset_utc_s, true)), el("td", {}, metres(t.peak_m)), el("td", {}, metres(t.min_margin_m)))));
        const of = model.nTransitions === matching.length ? String(matching.length) : `${Math.min(matching.length, MOST_SHOWN)} of ${model.nTransitions}; events.jsonl has all`;
        say(caption, model.nTransitions === 0 ? "Nothing was raised or cleared" : `Newest first: ${of}`);
    };
    let model: Model | null = null;
    filter.addEventListener("input", () => model !== null && show(model));
    return { element, show: (of) => { model = of; show(of); } };
}
