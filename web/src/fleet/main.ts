// The page of a fleet: what stands where, the keyboard, and who is told of what.

import "../show/page.css";
import "../live/live.css";
import "./fleet.css";
import { Link, now_s } from "../live/link.ts";
import { say, span } from "../live/parts.ts";
import { plainName, severity, type Transition } from "../live/state.ts";
import { button, el } from "../show/dom.ts";
import { clock, rnpName } from "../show/format.ts";
import { fleetMap } from "./map.ts";
import { Fleet, type Freshness } from "./state.ts";
import { table } from "./table.ts";

const WORDS: Record<Freshness, string> = { connecting: "CONNECTING", fresh: "LIVE DATA", "feed lost": "FEED LOST", ended: "NOT LIVE", "link lost": "LINK LOST", asleep: "PAGE ASLEEP" };
const MEANINGS: Record<Freshness, string> = {
    connecting: "this page has not been told anything yet: not monitored on this screen", fresh: "", ended: "",
    "feed lost": "nothing comes from the feeder, or nobody works on its lanes: no aircraft is monitored",
    "link lost": "not monitored on this screen", asleep: "this page was asleep: not monitored on this screen until it is told everything anew",
};
const KEYS: [string, string][] = [["/", "filter the aircraft"], ["m", "to the map; arrows move it, + and − zoom, c shows all"], ["t", "to the table"], ["?", "this list"], ["Esc", "back"]];
const TABLE_MS = 1000;
const MAP_MS = 200;
const SPOKEN_MS = 1000;
const MOST_EVENTS = 100;

const fleet = new Fleet();
const host = document.querySelector<HTMLElement>("#display")!;
const link = new Link(fleet, { changed, ticked, alert: speak, stranger });
const square = el("i", { class: "beat", "aria-hidden": "true" });
const word = el("strong", { class: "fresh-word", role: "status" });
const facts = el("dl", { class: "status-cells" });
const bar = el("header", { class: "status-bar" }, el("div", { class: "who" }, el("span", { class: "beat-box", title: "turns with each message" }, square), word), facts);
const trouble = el("p", { class: "band trouble", role: "alert", hidden: true });
const recorded = el("p", { class: "band replay", hidden: true });
const map = fleetMap();
const list = table((name) => map.choose(name));
const happened = el("ol", { class: "fleet-events" });
const events = el("section", { class: "panel events" }, el("h2", {}, "Newest transitions"), happened);
const overlay = el("div", { class: "lost", hidden: true, "aria-hidden": "true" }, el("p", {}));
const warned = el("p", { class: "sr", "aria-live": "assertive" });
const announced = el("p", { class: "sr", "aria-live": "polite" });
const help = el("dialog", { class: "keys", "aria-label": "Keys" }, el("h2", {}, "Keys"), el("dl", {}, ...KEYS.flatMap(([key, what]) => [el("dt", {}, el("kbd", {}, key)), el("dd", {}, what)])), button("Close", {}, () => help.close()));
host.append(el("h1", { class: "sr" }, "navbound live fleet"), bar, el("div", { class: "bands" }, recorded, trouble), el("div", { class: "fleet-grid" }, map.element, list.element), events,
    el("footer", {}, el("p", { class: "note" }, "For information. Not certified for anything; not a substitute for certified equipment."), button("Keys ?", { "aria-haspopup": "dialog" }, () => help.showModal())), overlay, warned, announced, help);

/** What must be true whether or not anything is painted. */
function watch(): void {
    const now = now_s();
    const fresh = fleet.freshness(now);
    const lost = fresh === "link lost" || fresh === "asleep" || fresh === "connecting";
    document.documentElement.dataset.fresh = fresh;
    document.documentElement.classList.toggle("is-lost", lost);
    overlay.hidden = !lost || fresh === "connecting";
    if (!overlay.hidden) say(overlay.firstElementChild as HTMLElement, WORDS[fresh]);
    say(word, WORDS[fresh]);
    bar.dataset.fresh = fresh;
    bar.dataset.kind = fleet.snapshot?.session.origin.kind ?? "";
    square.dataset.turn = String(fleet.frames % 4);
    const idle = fleet.idle();
    const feed = [...fleet.feedAlerts.values()];
    const reasons = [
        MEANINGS[fresh] === "" ? "" : `${WORDS[fresh]}${fresh === "link lost" ? ` ${span(now - fleet.heard_s)}` : ""}: ${MEANINGS[fresh]}`,
        fresh === "fresh" && idle.length > 0 ? `NO WORKER on ${idle.length === 1 ? "lane" : "lanes"} ${idle.map((lane) => lane.lane).join(", ")}: their aircraft are not monitored` : "",
        ...new Set(feed.map((alert) => `${alert.kind.replaceAll("_", " ").toUpperCase()} since ${clock(alert.annunciation_utc_s, false)} UTC`)), fleet.status?.trouble ?? "",
    ].filter((text) => text !== "");
    trouble.hidden = reasons.length === 0;
    say(trouble, reasons.join(" · "));
    const kind = fleet.snapshot?.session.origin.kind;
    recorded.hidden = kind === undefined || kind === "live";
    say(recorded, "RECORDING: not live");
    const title = fresh === "fresh" ? `${fleet.status!.counts.W ?? 0} W · ${(fleet.status!.counts.C ?? 0) + (fleet.status!.counts.U ?? 0)} C · navbound fleet` : `${WORDS[fresh]} · navbound fleet`;
    if (document.title !== title) document.title = title;
}

function head(): void {
    const { snapshot, status } = fleet;
    if (snapshot === null || status === null) return;
    const lags = status.lanes.map((lane) => lane.lag_s).filter((lag) => lag !== null);
    const cells: [string, string][] = [
        ["Aircraft", String(status.n_tracks)], ["Warning", String(status.counts.W ?? 0)], ["Caution", String(status.counts.C ?? 0)], ["Unavailable", String(status.counts.U ?? 0)], ["Required", snapshot.session.rnp_table === null ? rnpName(snapshot.session.rnp_m) : `by table, else ${rnpName(snapshot.session.rnp_m)}`],
        ["Lanes worked on", `${status.lanes.length - fleet.idle().length} of ${status.lanes.length}`], ["Largest lag", lags.length > 0 ? `${Math.max(...lags).toFixed(2)} s` : "---"], ["Source", snapshot.session.origin.source || snapshot.session.run],
    ];
    if (facts.childElementCount !== cells.length) facts.replaceChildren(...cells.map(([name]) => el("div", {}, el("dt", {}, name), el("dd", { "data-key": name }))));
    cells.forEach(([, text], k) => say(facts.children[k]!.lastElementChild as HTMLElement, text));
}

let listed = -1;
function newest(): void {
    if (listed === fleet.nTransitions) return;
    listed = fleet.nTransitions;
    const lines = fleet.events.slice(-MOST_EVENTS).reverse();
    happened.replaceChildren(...lines.map((t) => el("li", { "data-tone": t.transition === "raised" ? (severity(t.kind) === 0 ? "warning" : "caution") : "" }, `${clock(t.event_utc_s, true)}  ${t.track === null ? "source" : plainName(t.track)}  `, el("span", { class: "kind" }, t.kind.replaceAll("_", " ")), ` ${t.transition}`)));
}

let [mapped_ms, tabled_ms, due] = [-Infinity, -Infinity, false];
function paint(): void {
    due = false;
    watch();
    const ms = performance.now();
    if (ms - mapped_ms >= MAP_MS) {
        mapped_ms = ms;
        map.show(fleet, now_s());
    }
    if (ms - tabled_ms >= TABLE_MS) {
        tabled_ms = ms;
        head();
        list.show(fleet, now_s());
        newest();
    }
    host.dataset.painted = String(fleet.frames);
}

function changed(): void {
    if (due) return;
    due = true;
    requestAnimationFrame(paint);
}

function ticked(): void {
    watch();
    changed();
}

let spoken_ms = -Infinity;
function speak(transition: Transition): void {
    if (transition.transition !== "raised" || performance.now() - spoken_ms < SPOKEN_MS) return;
    spoken_ms = performance.now();
    say(severity(transition.kind) === 0 ? warned : announced, `${transition.kind.replaceAll("_", " ")} of ${transition.track === null ? "the source" : plainName(transition.track)}`);
}

function stranger(): void {
    host.dataset.stranger = "true";
    if (host.querySelector(".stranger") === null) trouble.before(el("p", { class: "band stranger", role: "alert" }, "This browser has no session: open the whole address that the command printed, with what stands behind the #."));
}

addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const typing = e.target instanceof HTMLInputElement;
    if (e.key === "Escape" && typing) e.target.blur();
    if (typing || help.open) return;
    const act: Record<string, () => void> = { "/": () => list.filter.focus(), m: map.focus, t: () => list.element.querySelector<HTMLElement>(".fleet-scroll")!.focus(), "+": () => map.zoom(2), "=": () => map.zoom(2), "-": () => map.zoom(0.5), "?": () => help.showModal() };
    const run = act[e.key];
    if (run === undefined) return;
    e.preventDefault();
    run();
});
addEventListener("resize", changed);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
watch();
void link.begin();
