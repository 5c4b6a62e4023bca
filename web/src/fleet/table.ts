// The table of a fleet: only the rows that are seen are built, however many there are.

import { el } from "../show/dom.ts";
import { metres, plain } from "../show/format.ts";
import { dashed, say } from "../live/parts.ts";
import { plainName } from "../live/state.ts";
import { share, tone, words, type Fleet, type Track } from "./state.ts";

const ROW_PX = 24;
const SPARE = 6;
const COLUMNS: [string, string][] = [
    ["Aircraft", "words"], ["Alerts", "words"], ["Age", ""], ["95 %", ""], ["Integrity", ""], ["RNP", ""], ["Share", ""], ["NIC", ""], ["NACp", ""], ["SIL", ""], ["Why not", "words"],
];

export interface Table {
    element: HTMLElement;
    show: (fleet: Fleet, now_s: number) => void;
    filter: HTMLInputElement;
}

export function table(choose: (name: string) => void): Table {
    const filter = el("input", { type: "search", "aria-label": "Filter aircraft: address or alert", placeholder: "address or alert" });
    const caption = el("p", { class: "note", role: "status" });
    const body = el("tbody");
    const head = el("thead", {}, el("tr", {}, ...COLUMNS.map(([name, css]) => el("th", { scope: "col", class: css }, name))));
    const space = el("div", { class: "fleet-space" }, el("table", { class: "fleet-table", "aria-label": "Aircraft, gravest alert first" }, head, body));
    const scroll = el("div", { class: "fleet-scroll", tabindex: 0, role: "region", "aria-label": "Table of aircraft" }, space);
    const element = el("section", { class: "panel fleet-list" }, el("div", { class: "events-head" }, el("h2", {}, "Aircraft"), filter), caption, scroll);
    let known: { fleet: Fleet; now_s: number } | null = null;
    let rows: Track[] = [];
    const built: { row: HTMLTableRowElement; cells: HTMLTableCellElement[] }[] = [];

    const paint = (): void => {
        if (known === null) return;
        const { fleet, now_s } = known;
        const first = Math.max(0, Math.min(rows.length, Math.floor(scroll.scrollTop / ROW_PX) - SPARE));
        const n = Math.min(rows.length - first, Math.ceil(scroll.clientHeight / ROW_PX) + 2 * SPARE);
        space.style.height = `${(rows.length + 1) * ROW_PX}px`;
        (space.firstElementChild as HTMLElement).style.transform = `translateY(${first * ROW_PX}px)`;
        while (built.length < n) built.push(line(choose));
        while (built.length > n) built.pop();
        if (body.childElementCount !== n) body.replaceChildren(...built.map(({ row }) => row));
        built.forEach(({ row, cells }, k) => fill(row, cells, rows[first + k]!, fleet, now_s));
    };
    scroll.addEventListener("scroll", paint);
    const show = (fleet: Fleet, now_s: number): void => {
        known = { fleet, now_s };
        rows = fleet.ordered(filter.value);
        const hidden = fleet.status?.n_hidden ?? 0;
        say(caption, `${rows.length} of ${fleet.tracks.size} aircraft, gravest alert first, then by the share of the limit${hidden > 0 ? `; ${hidden} states of more aircraft than are shown were left out` : ""}`);
        paint();
    };
    filter.addEventListener("input", () => known !== null && show(known.fleet, known.now_s));
    return { element, show, filter };
}

function line(choose: (name: string) => void): { row: HTMLTableRowElement; cells: HTMLTableCellElement[] } {
    const cells = COLUMNS.map(([, css]) => el("td", { class: css }));
    const row = el("tr", {}, ...cells);
    row.addEventListener("click", () => choose(row.dataset.track ?? ""));
    return { row, cells };
}

function fill(row: HTMLTableRowElement, cells: HTMLTableCellElement[], track: Track, fleet: Fleet, now_s: number): void {
    row.dataset.track = track.name;
    row.dataset.tone = tone(track);
    const believed = fleet.believed(track, now_s);
    const age = fleet.age_s(track, now_s);
    const number = (value: number, digits: number): string => (Number.isFinite(value) ? plain(value, digits) : "---");
    const length = (value: number): string => (believed ? dashed(metres(value)) : "---");
    const taken = share(track);
    const why = track.reason === null ? "" : fleet.snapshot?.session.reasons[track.reason] ?? "";
    const texts = [
        plainName(track.name), words(track), `${number(age, 1)} s`, length(track.accuracy_m), length(track.integrity_m), length(track.rnp_m),
        believed && taken >= 0 ? `${plain(100 * taken, 0)} %` : "---", number(track.nic, 0), number(track.nac_p, 0), number(track.sil, 0), why,
    ];
    texts.forEach((text, k) => say(cells[k]!, text));
    cells[10]!.title = why;
}
