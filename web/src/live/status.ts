// The bar at the top: whose data, how old, from where, and in one word whether they may be believed.

import { MODES } from "../chart/modes.ts";
import { el, setValue, valueOf } from "../show/dom.ts";
import { clock, date, plain, rnpName } from "../show/format.ts";
import { DASHES, say, span, type Part } from "./parts.ts";
import { plainName, present, type Freshness, type Model } from "./state.ts";

const WORDS: Record<Freshness, string> = {
    connecting: "CONNECTING", waiting: "NO DATA YET", fresh: "LIVE DATA", ageing: "AGEING", stale: "STALE", "feed lost": "FEED LOST", ended: "DATA ENDED",
    "link lost": "LINK LOST", asleep: "PAGE ASLEEP",
};

const MEANINGS: Record<Freshness, string> = {
    connecting: "this page has not been told anything yet: not monitored on this screen",
    waiting: "nothing has been judged yet",
    fresh: "", ageing: "",
    stale: "no new position: the numbers are removed",
    "feed lost": "the reader of the source is silent: nothing is judged",
    ended: "the source has ended: nothing is judged any more",
    "link lost": "not monitored on this screen",
    asleep: "this page was asleep: not monitored on this screen until it is told everything anew",
};

export function statusBar(choose: (track: string) => void): Part {
    const word = el("strong", { class: "fresh-word", role: "status" });
    const square = el("i", { class: "beat", "aria-hidden": "true" });
    const cells: [string, HTMLElement][] = [
        ["Data of, UTC", valueOf("utc_s", null, DASHES)], ["Age", valueOf("age_s", null, DASHES)], ["Mode", valueOf("nav_mode", null, DASHES)],
        ["Satellites", valueOf("n_sv", null, DASHES)], ["Required", valueOf("required", null, DASHES)], ["Method", valueOf("method", null, DASHES)], ["Source", valueOf("source", null, DASHES)],
    ];
    const at = Object.fromEntries(cells) as Record<string, HTMLElement>;
    const tracks = el("select", { "aria-label": "Aircraft shown" });
    const single = el("span", { class: "track-name" });
    const hidden = el("span", { class: "note" });
    tracks.addEventListener("change", () => choose(tracks.value));
    const element = el("header", { class: "status-bar" }, el("div", { class: "who" }, el("span", { class: "beat-box", title: "turns with each message" }, square), word, single, tracks, hidden),
        el("dl", { class: "status-cells" }, ...cells.map(([name, cell]) => el("div", {}, el("dt", {}, name), el("dd", {}, cell)))));
    let listed = "";
    const show = (model: Model, now_s: number): void => {
        const fresh = model.freshness(now_s);
        const kind = model.snapshot?.session.origin.kind;
        say(word, fresh === "fresh" && kind !== undefined && kind !== "live" ? "NOT LIVE" : WORDS[fresh]);
        element.dataset.kind = kind;
        element.dataset.fresh = fresh;
        square.dataset.turn = String(model.frames % 4);
        const { snapshot } = model;
        if (snapshot === null) return;
        const { session } = snapshot;
        if (listed !== snapshot.tracks.join("\n")) {
            listed = snapshot.tracks.join("\n");
            tracks.replaceChildren(...snapshot.tracks.map((name) => el("option", { value: name }, plainName(name))));
            tracks.hidden = snapshot.tracks.length < 2;
            single.hidden = !tracks.hidden;
        }
        // Alerts of all stand in the list, whether or not their epochs are kept.
        const n = model.status?.n_hidden ?? 0;
        say(hidden, n > 0 ? `more aircraft than are shown: ${n} epochs left out` : "");
        if (snapshot.track !== null) {
            tracks.value = snapshot.track;
            say(single, plainName(snapshot.track));
        }
        const utc = model.number("utc_s");
        const age = model.age_s(now_s);
        const believed = present(fresh);
        setValue(at["Data of, UTC"]!, utc, Number.isFinite(utc) ? `${date(utc)} ${clock(utc, session.sample_period_s < 1)}` : DASHES);
        setValue(at.Age!, age, Number.isFinite(age) ? (age < 60 ? `${plain(age, 1)} s` : span(age)) : DASHES);
        const mode = believed ? model.word("nav_mode") : null;
        setValue(at.Mode!, mode, believed ? (mode === null ? "not stated" : MODES[mode]?.words ?? plainName(mode)) : DASHES);
        const used = believed ? model.number("n_sv") : NaN;
        setValue(at.Satellites!, used, Number.isFinite(used) ? plain(used, 0) : DASHES);
        const rnp = model.number("rnp_m");
        const required = believed && Number.isFinite(rnp) ? rnp : NaN;
        setValue(at.Required!, required, Number.isFinite(required) ? rnpName(required) : DASHES);
        setValue(at.Method!, session.method, session.method);
        setValue(at.Source!, session.origin.source, session.origin.source || session.run);
    };
    return { element, show };
}

/** Bands that no one can miss: not live, and not to be believed. */
export function bands(): Part {
    const replay = el("p", { class: "band replay", hidden: true });
    const trouble = el("p", { class: "band trouble", role: "alert", hidden: true });
    const element = el("div", { class: "bands" }, replay, trouble);
    const show = (model: Model, now_s: number): void => {
        const fresh = model.freshness(now_s);
        const origin = model.snapshot?.session.origin;
        replay.hidden = origin === undefined || origin.kind === "live";
        if (origin !== undefined && origin.kind !== "live") {
            const speed = origin.speed === null ? "" : origin.speed === 0 ? " as fast as it goes" : ` × ${plain(origin.speed, origin.speed % 1 === 0 ? 0 : 1)}`;
            say(replay, `${origin.kind === "replay" ? "REPLAY" : "RECORDING"}${speed}: not the present`);
        }
        trouble.hidden = present(fresh);
        if (present(fresh)) return;
        const since = fresh === "link lost" ? ` ${span(now_s - model.heard_s)}` : fresh === "stale" ? ` ${span(model.age_s(now_s))}` : fresh === "feed lost" ? ` ${span((model.status?.silent_s ?? 0) + now_s - model.heard_s)}` : "";
        say(trouble, `${WORDS[fresh]}${since}: ${MEANINGS[fresh]}${model.status?.trouble ? ` (${model.status.trouble})` : ""}`);
    };
    return { element, show };
}

export function title(model: Model, now_s: number): string {
    const fresh = model.freshness(now_s);
    const [first] = model.inForce();
    const name = model.snapshot?.track == null ? "navbound live" : `${plainName(model.snapshot.track)} · navbound live`;
    if (!present(fresh)) return `${fresh === "link lost" ? "✖ " : ""}${WORDS[fresh]} · ${name}`;
    return first === undefined ? name : `${first.kind.toUpperCase()} · ${name}`;
}
