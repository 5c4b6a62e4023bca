// The messages of the augmentation service: counts and time-outs by type, UDRE by satellite and GIVE by grid point over time.

import "./service.css";
import { utcOf } from "../data/events.ts";
import type { Cursor } from "../data/link.ts";
import type { MessageCount, Performance, ServiceLog } from "../records.gen.ts";
import type { Payload } from "../data/records.ts";
import { el, svg } from "../show/dom.ts";
import { clock, count, date, duration, NONE } from "../show/format.ts";
import { gridMap } from "./gridmap.ts";
import { sortable, type Column } from "./sortable.ts";

const WIDTH = 960;
const LEFT = 46;
const ROW = 15;
const TOP = 4;
const FOOT = 22;
const NOT_MONITORED = 14;
const DO_NOT_USE = 15;
/** From this UDRE indicator on a satellite serves no precision approach: `UDREI_TOO_POOR` in crates/core/src/bound/sbas/service.rs. */
const EN_ROUTE = 12;
const HOURS = 6;

export function serviceLog(record: Performance, payload: Payload, cursor: Cursor): HTMLElement | null {
    const log = record.service;
    if (log === null || log === undefined) return null;
    const at = (ns: number): string => `${date(utcOf(ns, payload))} ${clock(utcOf(ns, payload))}`;
    const silence = log.n_missing === 0 ? "in no second one is missing" : `in ${count(log.n_missing)} ${log.n_missing === 1 ? "second" : "seconds"} none was received, the longest silence is ${duration(log.longest_silence_s)}`;
    const out = log.types.reduce((n, each) => n + each.n_time_outs, 0);
    const tests = log.types.find(({ type }) => type === 0)?.n ?? 0;
    const stop = tests === 0 ? "" : ` Message 0, by which nothing of the service is to be used, was received ${tests === 1 ? "once" : `${count(tests)} times`}.`;
    const words = `PRN ${log.prn}, ${at(log.first_ns)} to ${at(log.last_ns)} UTC: ${count(log.n_messages)} messages, ${silence}. ${out === 0 ? "No type was older than its time-out." : `At ${count(out)} ${out === 1 ? "time" : "times"} data of a type were older than the time-out of a precision approach.`}${stop}`;
    return el("section", { id: "service" }, el("h3", {}, "Messages of the service"), el("p", {}, words), types(log), udre(log, payload), give(log, payload), gridMap(log, payload, cursor));
}

function types(log: ServiceLog): HTMLElement {
    const seconds = (v: number | null): string => (v === null ? NONE : `${duration(v)}`);
    const columns: Column<MessageCount>[] = [
        { head: "Type", key: "type", of: (t) => t.type, show: (t) => String(t.type) }, { head: "Content", key: "what", words: true, of: (t) => t.what, show: (t) => t.what },
        { head: "Received", key: "n", of: (t) => t.n, show: (t) => count(t.n) }, { head: "Longest gap", key: "longest_gap_s", of: (t) => t.longest_gap_s, show: (t) => seconds(t.longest_gap_s) },
        { head: "Time-out", key: "time_out_s", of: (t) => t.time_out_s, show: (t) => seconds(t.time_out_s) }, { head: "Timed out", key: "n_time_outs", of: (t) => t.n_time_outs, show: (t) => (t.time_out_s === null ? NONE : count(t.n_time_outs)) },
    ];
    return el("div", {}, sortable({ id: "message-types", caption: "Messages by type", columns, rows: log.types, sortable: true }),
        el("p", { class: "note" }, "Time-outs are those of a precision approach; of messages 2 to 5 that of the UDRE, which messages 6 and 24 state too. Where several messages of a type share its content (satellites of 25 and 28, blocks of 26), the type is counted as a whole."));
}

/** Rows of cells over time, equal neighbours joined. */
function picture(log: ServiceLog, payload: Payload, id: string, rows: { name: string; cells: (string | null)[]; faint?: number[] }[], spoken: string): SVGElement {
    const span_ns = log.last_ns - log.first_ns;
    const height = TOP + rows.length * ROW + FOOT;
    const x = (k: number): number => LEFT + ((WIDTH - LEFT) * Math.min(k * log.bin_ns, span_ns)) / Math.max(1, span_ns);
    const drawn = svg("svg", { viewBox: `0 0 ${WIDTH} ${height}`, role: "img", "aria-label": spoken, class: "service-picture", id });
    rows.forEach((row, r) => {
        const y = TOP + r * ROW;
        drawn.append(svg("text", { x: LEFT - 6, y: y + ROW - 4, "text-anchor": "end", class: "service-name" }, row.name));
        for (let k = 0; k < row.cells.length;) {
            let end = k + 1;
            while (end < row.cells.length && row.cells[end] === row.cells[k] && row.faint?.[end] === row.faint?.[k]) end++;
            const kind = row.cells[k];
            if (kind !== null) drawn.append(svg("rect", { x: x(k).toFixed(1), y, width: Math.max(0.5, x(end) - x(k)).toFixed(1), height: ROW - 2, class: `service-${kind}`, "fill-opacity": row.faint === undefined ? undefined : row.faint[k]!.toFixed(2) }));
            k = end;
        }
    });
    for (let tick = 0; tick <= HOURS; tick++) {
        const ns = log.first_ns + (span_ns * tick) / HOURS;
        const place = LEFT + ((WIDTH - LEFT) * tick) / HOURS;
        drawn.append(svg("text", { x: place, y: height - 6, "text-anchor": tick === 0 ? "start" : tick === HOURS ? "end" : "middle", class: "service-name" }, clock(utcOf(ns, payload)).slice(0, 5)));
    }
    return drawn;
}

const kindOf = (indicator: number): string => (indicator === DO_NOT_USE ? "stop" : indicator === NOT_MONITORED ? "idle" : indicator >= EN_ROUTE ? "route" : indicator >= 9 ? "wide" : "close");

function udre(log: ServiceLog, payload: Payload): HTMLElement | null {
    if (log.udre.length === 0) return null;
    const rows = log.udre.map(({ sv, worst }) => ({ name: sv, cells: worst.map((each) => (each === null ? null : kindOf(each))) }));
    const lost = log.udre.filter(({ worst }) => worst.some((each) => each !== null && each >= NOT_MONITORED)).map(({ sv }) => sv);
    const spoken = `${count(log.udre.length)} satellites were monitored; ${lost.length === 0 ? "none of them was given up" : `not monitored or not to be used at times: ${lost.join(", ")}`}.`;
    return el("figure", { class: "chart" }, el("div", { class: "chart-head" }, el("h3", {}, "UDRE by satellite")),
        el("figcaption", {}, `The largest indicator in each ${duration(log.bin_ns / 1e9)}. ${spoken}`), legend([["close", "0 to 8"], ["wide", "9 to 11"], ["route", "12 and 13: no precision approach"], ["idle", "14: not monitored"], ["stop", "15: do not use"]]),
        el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "UDRE by satellite" }, picture(log, payload, "udre", rows, spoken)));
}

function give(log: ServiceLog, payload: Payload): HTMLElement | null {
    if (log.n_points === 0) return null;
    const most = Math.max(1, ...log.give.flat());
    const shown = Array.from({ length: 16 }, (_, k) => 15 - k).filter((k) => log.give.some((bin) => bin[k]! > 0));
    if (shown.length === 0) return null;
    const rows = shown.map((k) => ({ name: String(k), cells: log.give.map((bin) => (bin[k]! === 0 ? null : k === 15 ? "idle" : "close")), faint: log.give.map((bin) => (k === 15 ? 1 : 0.15 + (0.85 * bin[k]!) / most)) }));
    const last = log.give.at(-1)!;
    const known = last.reduce((a, b) => a + b, 0);
    const spoken = `At the end ${count(known - last[15]!)} of ${count(log.n_points)} points of the grid are monitored.`;
    return el("figure", { class: "chart" }, el("div", { class: "chart-head" }, el("h3", {}, "GIVE of the grid")),
        el("figcaption", {}, `Points of the grid by their indicator, 0 to 14, at the end of each ${duration(log.bin_ns / 1e9)}: the stronger, the more of up to ${count(most)}. 15 is not monitored or not to be used. ${spoken}`),
        el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "GIVE of the grid" }, picture(log, payload, "give", rows, spoken)));
}

function legend(entries: [string, string][]): HTMLElement {
    return el("p", { class: "note service-legend" }, ...entries.map(([kind, words]) => el("span", {}, el("i", { class: `service-${kind}` }), words)));
}
