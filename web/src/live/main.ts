// The live flight display: what stands where, the keyboard, and who is told of what.

import "uplot/dist/uPlot.min.css";
import "../show/page.css";
import "./live.css";
import { button, choice, el } from "../show/dom.ts";
import { choose } from "../show/theme.ts";
import { alerts, events } from "./alerts.ts";
import { Link, now_s } from "./link.ts";
import { map } from "./map.ts";
import { say } from "./parts.ts";
import { levelBars, scales, tseBars } from "./performance.ts";
import { Model, plainName, present, severity, type Transition } from "./state.ts";
import { bands, statusBar, title } from "./status.ts";
import { strips } from "./strips.ts";

const KEYS: [string, string][] = [
    ["a", "acknowledge the newest alert"], ["A", "acknowledge all"], ["j, k", "next and previous alert"], ["/", "filter the events"], ["m", "to the map; arrows move it, + and − zoom, c centres"],
    ["space", "pause the view; alerts still come"], ["t", "light, dark or as the system"], ["?", "this list"], ["Esc", "back"],
];
const SPOKEN_MS = 1000;

const model = new Model();
const host = document.querySelector<HTMLElement>("#display")!;
const link = new Link(model, { changed, ticked, alert: speak, stranger });
const top = statusBar((track) => link.connect(track));
const band = bands();
const force = alerts((alert) => link.acknowledge(alert));
const chart = map();
const list = events();
const parts = [top, band, chart, scales(), tseBars(), force, levelBars(), strips(), list];
const [, , , gauges, tse, , levels, history] = parts;
const overlay = el("div", { class: "lost", hidden: true, "aria-hidden": "true" }, el("p", {}));
const paused = el("p", { class: "band paused", role: "status", hidden: true }, "PAUSED: the view stands still; alerts and the link are watched. Space goes on.");
const warned = el("p", { class: "sr", "aria-live": "assertive" });
const announced = el("p", { class: "sr", "aria-live": "polite" });
const help = el("dialog", { class: "keys", "aria-label": "Keys" }, el("h2", {}, "Keys"), el("dl", {}, ...KEYS.flatMap(([key, what]) => [el("dt", {}, el("kbd", {}, key)), el("dd", {}, what)])), button("Close", {}, () => help.close()));
let frozen = false;
let due = false;
let theme: "auto" | "light" | "dark" = "auto";

const tools = el("div", { class: "head-tools" },
    choice("Theme", [["auto", "Auto"], ["light", "Light"], ["dark", "Dark"]], theme, (to) => pick(to)), button("Keys ?", { "aria-haspopup": "dialog" }, () => help.showModal()));
host.append(el("h1", { class: "sr" }, "navbound live flight display"), top.element, band.element, paused,
    el("div", { class: "live-grid" }, chart.element, el("div", { class: "right" }, force.element, gauges!.element, tse!.element, levels!.element)), history!.element, list.element,
    el("footer", {}, el("p", { class: "note" }, "For information. Not certified for anything; not a substitute for certified equipment."), tools), overlay, warned, announced, help);

function pick(to: typeof theme): void {
    theme = to;
    choose(theme);
    for (const one of tools.querySelectorAll<HTMLElement>("[data-choice]")) one.setAttribute("aria-pressed", String(one.dataset.choice === theme));
    changed();
}

/** What must be true whether or not anything is painted: the link, the age, alerts, the title. */
function watch(): void {
    const now = now_s();
    const fresh = model.freshness(now);
    const lost = fresh === "link lost" || fresh === "asleep" || fresh === "connecting";
    document.documentElement.dataset.fresh = fresh;
    document.documentElement.classList.toggle("is-lost", lost);
    overlay.hidden = !lost || fresh === "connecting";
    if (!overlay.hidden) say(overlay.firstElementChild as HTMLElement, fresh === "asleep" ? "PAGE ASLEEP" : "LINK LOST");
    const text = title(model, now);
    if (document.title !== text) document.title = text;
    for (const part of [top, band, force]) part.show(model, now);
}

function paint(): void {
    due = false;
    watch();
    const now = now_s();
    // A paused view is a picture of the past: it is never taken for the present, and ends when there is no present to hide.
    if (frozen && present(model.freshness(now))) return;
    for (const part of parts) part.show(model, now);
    host.dataset.painted = String(model.frames);
}

function changed(): void {
    if (due) return;
    due = true;
    requestAnimationFrame(paint);
}

let before = "";
function ticked(): void {
    watch();
    // What was fresh may not be any more, though nothing came.
    const now = now_s();
    const state = `${model.freshness(now)} ${model.believed(now)}`;
    if (state !== before || !present(model.freshness(now))) for (const part of parts) part.show(model, now);
    before = state;
}

let spoken_ms = -Infinity;
function speak(transition: Transition): void {
    if (transition.transition !== "raised" || performance.now() - spoken_ms < SPOKEN_MS) return;
    spoken_ms = performance.now();
    say(severity(transition.kind) === 0 ? warned : announced, `${transition.kind.replaceAll("_", " ")} of ${transition.track === null ? "the source" : plainName(transition.track)}`);
}

function stranger(): void {
    say(band.element.querySelector<HTMLElement>(".trouble")!, "");
    host.dataset.stranger = "true";
    if (host.querySelector(".stranger") === null) band.element.before(el("p", { class: "band stranger", role: "alert" }, "This browser has no session: open the whole address that the command printed, with what stands behind the #."));
}

addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const typing = e.target instanceof HTMLInputElement || e.target instanceof HTMLSelectElement;
    if (e.key === "Escape" && typing) (e.target as HTMLElement).blur();
    if (typing || help.open) return;
    const act: Record<string, () => void> = {
        a: force.newest, A: force.all, j: () => force.step(1), k: () => force.step(-1), "/": () => list.element.querySelector("input")!.focus(), m: chart.focus, "+": () => chart.zoom(2), "=": () => chart.zoom(2), "-": () => chart.zoom(0.5),
        "?": () => help.showModal(), t: () => pick(theme === "auto" ? "light" : theme === "light" ? "dark" : "auto"),
        ...(e.target instanceof HTMLButtonElement ? {} : { " ": () => { frozen = !frozen; paused.hidden = !frozen; host.classList.toggle("is-paused", frozen); changed(); } }),
    };
    const run = act[e.key];
    if (run === undefined) return;
    e.preventDefault();
    run();
});
addEventListener("resize", changed);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
watch();
void link.begin();
