// What every chart is given: one track, and the stores that link the charts.

import type { Satellite } from "./heard.ts";
import type { Ground } from "./others.ts";
import type { Payload } from "./records.ts";
import { Store } from "./store.ts";
import type { Table } from "./table.ts";

export type AxisName = "time" | "along";

/** Epochs shown, first and last index; null is all of them. */
export type Window = { from: number; to: number } | null;

export interface Scene {
    payload: Payload;
    table: Table;
    /** Index of the epoch under the cursor. */
    cursor: Store<number>;
    window: Store<Window>;
    axis: Store<AxisName>;
    /** Changes whenever colours do; charts on canvas redraw. */
    theme: Store<number>;
    /** Positions of all embedded tracks, as soon as they are read. */
    grounds: Store<Ground[]>;
    /** Satellites heard on this track. */
    heard: Satellite[];
}

/** A component: fills its host, returns what removes its listeners. */
export type Component = (host: HTMLElement, scene: Scene) => () => void;

export function scene(payload: Payload, table: Table, theme: Store<number>, axis: Store<AxisName>, grounds: Store<Ground[]>, heard: Satellite[] = []): Scene {
    if (!table.alongIsAxis) axis.set("time");
    return { payload, table, cursor: new Store(0), window: new Store<Window>(null), axis, theme, grounds, heard };
}

export const METRES_PER_NM = 1852;

/** Remainder that is never negative. */
export function mod(value: number, by: number): number {
    return ((value % by) + by) % by;
}

/** Values of the horizontal axis, strictly for drawing: UTC seconds of the first day, or nautical miles. */
export function axisValues(of: Scene): Float64Array {
    const { table } = of;
    if (of.axis.get() === "along") return table.column("along_m")!.map((m) => m / METRES_PER_NM);
    const day = mod(table.start_utc_s, 86400);
    return table.elapsed_s.map((s) => day + s);
}
