// Where on a track an event lies.

import type { EventSummary, Payload } from "./records.ts";
import type { Scene } from "./scene.ts";

export function utcOf(time_ns: number, payload: Payload): number {
    return time_ns / 1e9 + payload.gps_epoch_unix_s - payload.utc_offset_s;
}

export function indexAt(time_ns: number, scene: Scene): number {
    return scene.table.nearest(utcOf(time_ns, scene.payload) - scene.table.start_utc_s);
}

export function eventIndex(event: EventSummary, scene: Scene): number {
    return indexAt(event.onset_ns, scene);
}

/** Cautions and warnings of the track shown; warnings come last, so that no other mark is drawn over one. */
export function alertsOf(scene: Scene): (EventSummary & { kind: "caution" | "warning" })[] {
    const is = (event: EventSummary): event is EventSummary & { kind: "caution" | "warning" } => event.kind === "caution" || event.kind === "warning";
    return scene.payload.summary.events.filter(is).filter((e) => e.track === scene.table.track).sort((a, b) => Number(a.kind === "warning") - Number(b.kind === "warning"));
}
