// Flights against a published procedure: legs, heights and the answers.

import { clock, count, duration, metres, NONE, nauticalMiles, plain, rnpName, signedMetres } from "../show/format.ts";
import { el } from "../show/dom.ts";
import { utcOf } from "../data/events.ts";
import { nameOf, type HeightResult, type LegFlown, type Payload, type ProcedureFlown } from "../data/records.ts";
import { sortable, type Column } from "./sortable.ts";

/** One section a flight; null where no procedure was flown against. */
export function procedures(payload: Payload): HTMLElement | null {
    const flights = payload.summary.procedures;
    if (flights.length === 0) return null;
    const parts = flights.flatMap((flight, i) => [...(flights.length > 1 ? [el("h3", {}, nameOf(payload.summary, flight.track))] : []), ...one(flight, i, payload)]);
    return el("section", { id: "procedure" }, el("h2", {}, "Against the published procedure"), ...parts);
}

function one(flight: ProcedureFlown, i: number, payload: Payload): HTMLElement[] {
    const answers = el("ol", { class: "answers" }, ...flight.answers.map((words) => el("li", { class: words.includes("ALARM") ? "alarm" : undefined }, words)));
    const name = `${flight.procedure}${flight.line === null ? "" : `, ${flight.line}`}`;
    const legs = sortable<LegFlown>({ id: `procedure-${i}-legs`, caption: `Legs of ${name}; judged from ${clock(utcOf(flight.first_ns, payload))} UTC on`, rows: flight.legs, columns: legColumns(payload) });
    if (flight.heights.length === 0) return [answers, legs];
    return [answers, legs, sortable<HeightResult>({ id: `procedure-${i}-heights`, caption: "Height above the vertical path on the final approach", rows: flight.heights, columns: HEIGHTS })];
}

function legColumns(payload: Payload): Column<LegFlown>[] {
    const number = (head: string, key: keyof LegFlown & string, show: (v: number | null) => string): Column<LegFlown> => ({ head, key, of: (leg) => leg[key] as number | null, show: (leg) => show(leg[key] as number | null) });
    const judged = (leg: LegFlown, n: number, of: number): string => (leg.rnp_m === null || of === 0 ? NONE : `${n} of ${of}`);
    return [
        { head: "Leg", key: "fix", words: true, of: (leg) => leg.fix, show: (leg) => `${leg.fix || "-"} ${leg.terminator}`, title: (leg) => `${leg.sequence}, ${leg.state.replaceAll("_", " ")}` },
        { head: "RNP", key: "rnp_m", of: (leg) => leg.rnp_m, show: (leg) => (leg.rnp_m === null ? "unknown" : rnpName(leg.rnp_m)) },
        { head: "RNP from", key: "rnp_origin", words: true, of: (leg) => leg.rnp_origin, show: (leg) => leg.rnp_origin.replaceAll("_", " ") },
        number("Length", "length_m", (v) => nauticalMiles(v)),
        number("Positions", "n", count), number("In turns", "n_transition", count), number("Time", "duration_s", duration),
        number("Mean", "mean_m", signedMetres), number("RMS", "rms_m", metres), number("95 %", "p95_m", metres), number("Largest", "max_abs_m", metres),
        { head: "Largest / RNP", key: "ratio", of: (leg) => ratio(leg), show: (leg) => { const r = ratio(leg); return r === null ? NONE : plain(r, 3); } },
        { head: "Inside RNP", key: "n_inside", of: (leg) => leg.n_inside, show: (leg) => judged(leg, leg.n_inside, leg.n) },
        { head: "Inside 2 RNP", key: "n_inside_twice", of: (leg) => leg.n_inside_twice, show: (leg) => judged(leg, leg.n_inside_twice, leg.n) },
        { head: "Bound inside RNP", key: "n_bound_inside", of: (leg) => leg.n_bound_inside, show: (leg) => judged(leg, leg.n_bound_inside, leg.n_bound) },
        { head: "Worst, UTC", key: "worst_time_ns", of: (leg) => leg.worst_time_ns, show: (leg) => (leg.worst_time_ns === null ? NONE : clock(utcOf(leg.worst_time_ns, payload))) },
    ];
}

const ratio = (leg: LegFlown): number | null => (leg.rnp_m === null || leg.max_abs_m === null ? null : leg.max_abs_m / leg.rnp_m);

const height = (head: string, key: keyof HeightResult & string, show: (v: number | null) => string): Column<HeightResult> => ({ head, key, of: (row) => row[key] as number | null, show: (row) => show(row[key] as number | null) });

const HEIGHTS: Column<HeightResult>[] = [
    { head: "Height by", key: "by", words: true, of: (row) => row.by, show: (row) => (row.by === "altimeter" ? "altimeter, with its setting" : "geometry, with the temperature of the air") },
    { head: "Path", key: "path", words: true, of: (row) => row.path, show: (row) => row.path },
    height("Positions", "n", count), height("Mean", "mean_m", signedMetres), height("RMS", "rms_m", metres), height("95 %", "p95_m", metres), height("Lowest", "least_m", signedMetres), height("Highest", "most_m", signedMetres),
    height("Limit (75 ft, standard)", "limit_m", (v) => `±${metres(v)}`), { head: "Inside", key: "n_inside", of: (row) => row.n_inside, show: (row) => `${row.n_inside} of ${row.n}` },
    height("99.7 % required, least (standard)", "required_m", (v) => `±${metres(v)}`), { head: "Inside it", key: "n_inside_required", of: (row) => row.n_inside_required, show: (row) => `${row.n_inside_required} of ${row.n}` },
    { head: "Bound inside", key: "n_bound_inside", of: (row) => row.n_bound_inside, show: (row) => (row.n_bound === 0 ? NONE : `${row.n_bound_inside} of ${row.n_bound}`) },
];
