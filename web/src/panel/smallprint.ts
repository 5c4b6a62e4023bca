// What it takes to do the run again, and what this page keeps of its numbers.

import type { Payload } from "../data/records.ts";
import { el } from "../show/dom.ts";
import { count, risk } from "../show/format.ts";

const OPERATIONS: Record<NonNullable<Payload["summary"]["operation"]>, string> = { "en-route": "en route", approach: "approach", ground: "ground" };

export function smallPrint(payload: Payload): HTMLElement {
    const { record } = payload;
    const entry = (name: string, value: string): HTMLElement[] => [el("dt", {}, name), el("dd", {}, value)];
    const inputs = record.inputs.map((f) => el("li", {}, `${f.path} · ${count(f.n_bytes)} bytes${f.n_rows === null ? "" : ` · ${count(f.n_rows)} rows`} · SHA-256 `, el("code", {}, f.sha256)));
    const json = (name: string, value: unknown): HTMLElement => el("details", {}, el("summary", {}, name), el("pre", {}, JSON.stringify(value, null, 2)));
    return el("section", { class: "small-print", id: "run" }, el("h2", {}, "Run record"),
        el("dl", {},
            ...entry("navbound", record.navbound_version), ...entry("Command", record.command), ...entry("Created", record.created_utc), ...(payload.summary.operation === null ? [] : entry("Operation", OPERATIONS[payload.summary.operation])), ...entry("Seed", record.seed === null ? "none" : String(record.seed)),
            // Without a method no bound was made at any risk, and no map drawn.
            ...(record.methods.length === 0 ? [] : [...entry("Risks", `accuracy ${risk(record.risk_accuracy)}, integrity ${risk(record.risk_integrity)}`), ...entry("Methods", record.methods.join(", "))]), ...entry("Platform", record.platform),
            ...entry("Time", `UTC is GPS time minus ${payload.utc_offset_s} s`),
            ...entry("Resolution", resolution(payload)),
            ...(record.methods.length === 0 ? [] : entry("Coastline", "Natural Earth 1:50m, public domain; not for navigation"))),
        record.inputs.length > 0 ? el("div", {}, el("h3", {}, "Inputs"), el("ul", {}, ...inputs)) : null,
        json("Settings", record.settings), record.scenario === null ? null : json("Scenario", record.scenario));
}

function resolution(payload: Payload): string {
    const lengths = payload.tracks.flatMap((t) => t.columns.filter((c) => c.kind === "linear" && c.name.endsWith("_m")).map((c) => c.resolution));
    if (lengths.length === 0) return "no epochs are embedded";
    return `lengths of single epochs are kept to ${1000 * Math.max(...lengths)} mm, risks to 0.012 %; epochs.parquet holds them in full`;
}
