// Actual navigation performance: bounds of the navigation error, the error itself where truth is known, and RNP.

import type { Scene } from "../data/scene.ts";
import { metres } from "../show/format.ts";
import { methodLines } from "./methods.ts";
import { missing } from "./missing.ts";
import { strip, type Line } from "./strip.ts";

const ERRORS = ["nse_h_m", "nse_3d_m", "nse_along_m", "nse_cross_m", "nse_u_m", "nse_e_m", "nse_n_m"];
/** Shown before the reader chooses; the other bounds are one press away. */
const FIRST = ["anp_circle_m", "anp_sphere_m", "anp_cross_m"];

export function anp(host: HTMLElement, scene: Scene): () => void {
    const bounds = methodLines(scene, ERRORS, false).map((line) => ({ ...line, hidden: !FIRST.includes(line.key) }));
    if (bounds.length === 0) return missing(host, "Actual navigation performance", "No bound of the navigation error was computed.");
    const nse = scene.table.column("nse_h_m");
    const rnp = scene.table.column("rnp_m");
    const lines: Line[] = [];
    if (nse !== undefined) lines.push({ key: "nse_h_m", label: "NSE horizontal (truth)", values: nse, colour: "ink", width: 1, front: 1, about: "Length of the horizontal navigation system error" });
    lines.push(...bounds);
    const hpl = scene.table.column("hpl_m");
    if (hpl !== undefined) lines.push({ key: "hpl_m", label: "HPL", values: hpl, colour: "m2", width: 1.2, dash: [5, 3], about: "Horizontal protection level that the epochs carry" });
    if (rnp !== undefined) lines.push({ key: "rnp_m", label: "RNP", values: rnp, colour: "limit", width: 1.5, limit: true, about: "Required navigation performance by phase" });
    const note = `Bounds of the navigation system error. ${nse === undefined ? "No truth: the error itself is unknown." : "The error is seen because truth is known."}`;
    return strip(host, scene, { id: "anp", title: "Actual navigation performance", note, unit: "m", lines, scales: rnp === undefined ? ["data"] : ["data", "compressed", "limits"], show: (v) => metres(v), height: 250 });
}
