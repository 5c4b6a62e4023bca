// Where on a track an event lies.

import type { EventSummary, Payload } from "./records.ts";
import type { Scene, Window } from "./scene.ts";

/** Epochs beside an event that is short. */
const LEAST_BESIDE = 30;

export function utcOf(time_ns: number, payload: Payload): number {
    return time_ns / 1e9 + payload.gps_epoch_unix_s - payload.utc_offset_s;
}

export function indexAt(time_ns: number, scene: Scene): number {
    return scene.table.nearest(utcOf(time_ns, scene.payload) - scene.table.start_utc_s);
}

export function eventIndex(event: EventSummary, scene: Scene): number {
    return indexAt(event.onset_ns, scene);
}

/** Of the track shown what happened, widened by a fifth on both sides; null where nothing did, or all of the time. */
export function eventWindow(scene: Scene): Window {
    const { events, faults } = scene.payload.summary;
    const { track, n } = scene.table;
    const times = [
        ...faults.filter((f) => f.track === track).flatMap((f) => f.moments.map((m) => m.time_ns)),
        ...events.filter((e) => e.track === track).flatMap((e) => [e.onset_ns, e.clear_ns ?? e.onset_ns]),
    ];
    if (times.length === 0) return null;
    const [first, last] = [Math.min(...times), Math.max(...times)].map((t) => indexAt(t, scene)) as [number, number];
    const beside = Math.max(LEAST_BESIDE, Math.round((last - first) / 5));
    const [from, to] = [Math.max(0, first - beside), Math.min(n - 1, last + beside)];
    return to - from < n / 2 ? { from, to } : null;
}

/** Cautions and warnings of the track shown; warnings come last, so that no other mark is drawn over one. */
export function alertsOf(scene: Scene): (EventSummary & { kind: "caution" | "warning" })[] {
    const is = (event: EventSummary): event is EventSummary & { kind: "caution" | "warning" } => event.kind === "caution" || event.kind === "warning";
    return scene.payload.summary.events.filter(is).filter((e) => e.track === scene.table.track).sort((a, b) => Number(a.kind === "warning") - Number(b.kind === "warning"));
}
