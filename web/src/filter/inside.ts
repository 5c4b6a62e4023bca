// What a navigation filter says of its measurements and of its inertial unit.

import type { NumberColumn } from "../columns.gen.ts";
import type { Scene } from "../data/scene.ts";
import { el } from "../show/dom.ts";
import { count, NONE, plain } from "../show/format.ts";
import type { Colour } from "../show/theme.ts";
import { sortable } from "../panel/sortable.ts";
import { strip, type Line } from "../chart/strip.ts";

const INNOVATIONS: [NumberColumn, string, Colour, number[] | undefined][] = [
    ["innovation_range", "ranges", "m1", undefined], ["innovation_station", "stations", "m3", [6, 3]], ["innovation_baro", "altimeter", "m2", [2, 2]],
];

/** Largest innovation of each second against the gate, which is 1. */
export function innovations(host: HTMLElement, scene: Scene): () => void {
    const lines: Line[] = INNOVATIONS.flatMap(([key, label, colour, dash]) => {
        const values = scene.table.column(key);
        return values === undefined ? [] : [{ key, label, values, colour, width: 1, ...(dash ? { dash } : {}), about: "Largest innovation of the last second over its gate" }];
    });
    if (lines.length === 0) return () => undefined;
    lines.push({ key: "gate", label: "gate", values: new Float64Array(scene.table.n).fill(1), colour: "limit", width: 1.5, limit: true, quiet: true, about: "Above it a measurement is thrown away" });
    return strip(host, scene, {
        id: "innovations", title: "Innovations and gates", unit: "gates", lines, scales: ["data", "log"], floor: 0.01, show: (v) => plain(v, 2), height: 220,
        note: "Measured less predicted, over the gate: the largest of each second. Above 1 the measurement was thrown away.",
    });
}

const DEG_PER_HOUR = (180 / Math.PI) * 3600;
const SENSORS = [
    { id: "gyro-biases", title: "Gyroscope biases", unit: "°/h", scale: DEG_PER_HOUR, stem: "gyro", ending: "radps", digits: 4 },
    { id: "accelerometer-biases", title: "Accelerometer biases", unit: "mm/s²", scale: 1000, stem: "accel", ending: "mps2", digits: 3 },
] as const;
const AXES: ["x" | "y" | "z", string, Colour][] = [["x", "forward", "m1"], ["y", "right", "m3"], ["z", "down", "m2"]];

/** Estimated biases within plus and minus one standard deviation, as the filter states both. */
export function biases(host: HTMLElement, scene: Scene): () => void {
    const ends = SENSORS.flatMap((sensor) => {
        const column = (name: string): Float64Array | undefined => scene.table.column(name as NumberColumn)?.map((v) => v * sensor.scale);
        const lines: Line[] = AXES.flatMap(([axis, label, colour]) => {
            const values = column(`bias_${sensor.stem}_${axis}_${sensor.ending}`);
            const sigma = column(`sigma_bias_${sensor.stem}_${axis}_${sensor.ending}`);
            if (values === undefined) return [];
            const one: Line = { key: `${sensor.stem}_${axis}`, label, values, colour, width: 1.3, front: 1, about: `Bias of the axis ${label}` };
            const spread: Line[] = sigma === undefined ? [] : [{ key: `sigma_${sensor.stem}_${axis}`, label: `sigma, ${label}`, values: sigma, colour, width: 0.8, dash: [3, 3], mirror: true, limit: true, about: "One standard deviation, on both sides of zero" }];
            return [one, ...spread];
        });
        if (lines.length === 0) return [];
        return [strip(host, scene, {
            id: sensor.id, title: sensor.title, unit: sensor.unit, lines, scales: ["limits", "data"], show: (v) => `${plain(v, sensor.digits)} ${sensor.unit}`, yTick: (v) => String(Number(v.toPrecision(3))).replace("-", "−"),
            note: "As the filter estimates them, axes of the body; dashed, one standard deviation that it states, about zero.",
        })];
    });
    return () => ends.forEach((end) => end());
}

interface Kind {
    kind: string;
    n_used: number;
    n_gated: number;
    n_refused: number;
    mean_square: number | null;
    lag_one: number | null;
}

const KINDS: Record<string, string> = { range: "ranges to satellites", range_rate: "range rates", dme: "ranges to DMEs", vor: "bearings from VORs", baro: "altimeter", fix_position: "solved positions", fix_velocity: "solved velocities", wheels: "wheels" };

/** Totals by kind of measurement, over all flights of the run. */
export function totals(scene: Scene): HTMLElement | null {
    const stated = scene.payload.record.settings["filter"];
    if (typeof stated !== "object" || stated === null) return null;
    const rows = Object.entries(stated as Record<string, Omit<Kind, "kind">>).filter(([kind]) => kind in KINDS).map(([kind, of]) => ({ kind, ...of }));
    if (rows.length === 0) return null;
    const ratio = (v: number | null): string => (v === null ? NONE : plain(v, 3));
    const table = sortable<Kind>({
        id: "innovation-totals", caption: "Innovations by kind of measurement, all flights", rows,
        columns: [
            { head: "Measurement", key: "kind", words: true, of: (k) => k.kind, show: (k) => KINDS[k.kind]! },
            { head: "Used", key: "n_used", of: (k) => k.n_used, show: (k) => count(k.n_used) }, { head: "Thrown away by the gate", key: "n_gated", of: (k) => k.n_gated, show: (k) => count(k.n_gated) },
            { head: "Refused before it", key: "n_refused", of: (k) => k.n_refused, show: (k) => count(k.n_refused) },
            { head: "Mean square, normalised", key: "mean_square", of: (k) => k.mean_square, show: (k) => ratio(k.mean_square) }, { head: "Correlation with the one before", key: "lag_one", of: (k) => k.lag_one, show: (k) => ratio(k.lag_one) },
        ],
    });
    return el("div", {}, table, el("p", { class: "note" }, "A filter that is right about itself has a mean square of 1 and no correlation."));
}
