// Lateral and vertical deviation with the bounds that belong to them.

import type { Scene } from "../data/scene.ts";
import { metres, nauticalMiles, SHORT_M, signedMetres } from "../show/format.ts";
import { methodLines } from "./methods.ts";
import { strip, type Line, type Scale } from "./strip.ts";
import { extent } from "./ticks.ts";
import { missing } from "./missing.ts";

export function lateral(host: HTMLElement, scene: Scene): () => void {
    const { table } = scene;
    const fte = table.column("fte_m");
    const bounds = methodLines(scene, ["tse_m"], true);
    if (fte === undefined && bounds.length === 0) return missing(host, "Lateral deviation", "No path was given, so the flight technical error is unknown.");
    const lines: Line[] = [];
    if (fte !== undefined) lines.push({ key: "fte_m", label: "FTE", values: fte, colour: "ink", width: 1.2, front: 2, about: "Flight technical error: estimated position minus defined path, positive right" });
    const tse = table.column("tse_m");
    if (tse !== undefined) lines.push({ key: "tse_m", label: "TSE (truth)", values: tse, colour: "m5", width: 1, front: 1, about: "Total system error: true position minus desired path, positive right" });
    lines.push(...bounds);
    const compared = table.column("integrity_compared_m");
    if (compared !== undefined) lines.push({ key: "integrity_compared_m", label: "Compared with 2 RNP", endLabel: "compared", values: compared, colour: "warning", width: 1.2, dash: [2, 2], mirror: true, front: 1, about: "What the monitor compares with twice RNP: the larger of the integrity bound and |FTE| + HPL" });
    const rnp = table.column("rnp_m");
    if (rnp !== undefined) {
        lines.push({ key: "rnp_m", label: "RNP", values: rnp, colour: "limit", width: 1.5, mirror: true, limit: true, about: "Required navigation performance, the 95 % limit" });
        lines.push({ key: "rnp2", label: "2 RNP", values: rnp.map((v) => 2 * v), colour: "limit", dash: [5, 4], mirror: true, limit: true, about: "Containment limit, twice RNP" });
    }
    const note = `Positive right of the path. ${tse === undefined ? "No truth: total system error is bounded, not seen." : "Total system error from truth."}`;
    return strip(host, scene, { id: "lateral", title: "Lateral deviation", note, unit: "m", lines, scales: scalesFor(lines), show: lengthText, height: 300 });
}

export function vertical(host: HTMLElement, scene: Scene): () => void {
    const { table } = scene;
    const [fte, indicated] = [table.column("fte_v_m"), table.column("baro_off_m")];
    const bounds = methodLines(scene, ["tse_v_m"], true);
    if (fte === undefined && indicated === undefined) return missing(host, "Vertical deviation", "No vertical path was given, so the vertical deviation is unknown.");
    const lines: Line[] = [];
    if (fte !== undefined) lines.push({ key: "fte_v_m", label: indicated === undefined ? "FTE vertical" : "By geometry", values: fte, colour: "ink", width: 1.2, front: 2, about: "Flight technical error above the path, of the geometric height" });
    if (indicated !== undefined) lines.push({ key: "baro_off_m", label: "By altimeter", values: indicated, colour: "m2", width: 1.2, front: 2, about: "Indicated altitude, with the altimeter setting, above the path" });
    const tse = table.column("tse_v_m");
    if (tse !== undefined) lines.push({ key: "tse_v_m", label: "TSE (truth)", values: tse, colour: "m5", width: 1, front: 1, about: "Total system error above the path" });
    lines.push(...bounds);
    const limit = table.column("limit_v_m");
    if (limit !== undefined) lines.push({ key: "limit_v_m", label: "75 ft", values: limit, colour: "limit", width: 1.5, mirror: true, limit: true, about: "Largest vertical deviation that the specification of the procedure allows (standard)" });
    const without = bounds.length === 0 ? "No bound of the vertical error was computed." : limit === undefined ? "No vertical limit is required by RNP." : "";
    return strip(host, scene, { id: "vertical", title: "Vertical deviation", note: `Positive above the path. ${without}`.trim(), unit: "m", lines, scales: limit === undefined ? ["data"] : ["limits", "data"], show: lengthText });
}

/** Where the limits dwarf the data a linear scale shows only one of them. */
function scalesFor(lines: Line[]): Scale[] {
    const limits = lines.filter((l) => l.limit);
    if (limits.length === 0) return ["data"];
    const [, far] = extent(limits, 0, Infinity, null);
    const [low, high] = extent(lines.filter((l) => !l.limit), 0, Infinity, null);
    return far > 6 * Math.max(-low, high) ? ["compressed", "data", "limits"] : ["limits", "data", "compressed"];
}

function lengthText(v: number, line: Line): string {
    const text = line.mirror ? metres(v) : signedMetres(v);
    return line.limit && Math.abs(v) >= SHORT_M ? `${text} (${nauticalMiles(v)})` : text;
}
