// Horizontal protection levels and the alert limit in force, the error itself where truth is known.

import type { Scene } from "../data/scene.ts";
import { metres } from "../show/format.ts";
import { strip, type Line } from "./strip.ts";

/** Nothing where no alert limit is in force: a flight has none to miss. */
export function alertLimit(host: HTMLElement, scene: Scene): () => void {
    const { table, payload } = scene;
    const [hpl, hal] = [table.column("hpl_m"), table.column("hal_m")];
    if (hpl === undefined || hal === undefined) return () => undefined;
    const provenance = [...new Set(payload.summary.protection.map((p) => p.hal_held))].join(", ");
    const lines: Line[] = [];
    const [error, multi] = [table.column("nse_h_m"), table.column("hpl_multi_m")];
    if (error !== undefined) lines.push({ key: "nse_h_m", label: "HPE (truth)", values: error, colour: "ink", width: 1, front: 2, about: "Length of the horizontal navigation system error" });
    lines.push({ key: "hpl_m", label: "HPL, one fault", endLabel: "HPL", values: hpl, colour: "m2", width: 1.5, front: 1, about: "Protection level without a fault, with a faulty reference receiver and, while coasting, with one faulty satellite" });
    if (multi !== undefined) lines.push({ key: "hpl_multi_m", label: "HPL, all faults together", endLabel: "HPL, all faults", values: multi, colour: "m3", dash: [5, 3], front: 1, about: "Protection level against all faults while coasting" });
    lines.push({ key: "hal_m", label: `HAL (${provenance})`, values: hal, colour: "limit", width: 1.5, limit: true, about: `Horizontal alert limit of the sub-phase (${provenance})` });
    const note = `Protection levels against the alert limit of each sub-phase (${provenance}).${error === undefined ? " No truth: the error is unknown." : ""}`;
    return strip(host, scene, { id: "alert-limit", title: "Protection level and alert limit", note, unit: "m", lines, scales: ["limits", "data"], words: [{ key: "phase", label: "Sub-phase" }], show: (v) => metres(v), height: 250 });
}
