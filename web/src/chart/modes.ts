// What keeps the position of a navigation filter: satellites in use and measurements thrown away, with the mode as a band beneath.

import type uPlot from "uplot";
import { runsOf } from "../data/runs.ts";
import type { Scene } from "../data/scene.ts";
import type { NumberName } from "../data/table.ts";
import { plain } from "../show/format.ts";
import { colour, type Colour } from "../show/theme.ts";
import { hatch } from "./decorate.ts";
import { strip, type Line } from "./strip.ts";

/** Green is a normal state, amber one to look at, red none at all. */
export const MODES: Record<string, { words: string; hue: Colour }> = {
    gnss: { words: "GNSS/INS", hue: "normal" },
    dme_dme: { words: "DME/DME/INS", hue: "s1" },
    vor_dme: { words: "VOR/DME/INS", hue: "s3" },
    coasting: { words: "INS coasting", hue: "caution" },
    aligning: { words: "INS aligning", hue: "caution" },
    stopped: { words: "no navigation", hue: "warning" },
};
/** Which position an epoch gives. */
const SOURCES: Record<string, string> = { filter: "the filter", snapshot: "the ranges of the instant alone", none: "none" };
const BAND = 0.2;

export function modes(host: HTMLElement, scene: Scene): () => void {
    const words = scene.table.wordColumn("nav_mode")!;
    const columns: [NumberName, string, Colour][] = [["n_sv", "Satellites in use", "s2"], ["n_gated", "Measurements gated in the second", "caution"]];
    const lines: Line[] = columns.flatMap(([key, label, hue]) => {
        const values = scene.table.column(key);
        return values === undefined ? [] : [{ key, label, values, colour: hue, endLabel: key === "n_sv" ? "satellites" : "gated" }];
    });
    const most = Math.max(4, ...lines.map((l) => l.values.reduce((a, b) => (b > a ? b : a), 0)));
    const present = [...new Set(words.filter((w): w is string => w !== null))].map((w) => MODES[w]?.words ?? w);
    return strip(host, scene, {
        id: "modes", title: "Navigation source", unit: "", scales: ["data"], range: [-BAND * most, 1.05 * most], height: 150, draw: (u) => band(u, words, most),
        note: `What keeps the position: ${present.join(", ")}. Beneath, the mode second by second; a mode is left 5 s after it was last possible and entered after 10 s without a break.`,
        lines, show: (v) => plain(v, 0), words: [
            { key: "nav_mode", label: "Mode", text: (w) => (w === null ? "none" : MODES[w]?.words ?? w) },
            ...(scene.table.wordColumn("nav_source") === undefined ? [] : [{ key: "nav_source" as const, label: "Position of", text: (w: string | null) => (w === null ? "none" : SOURCES[w] ?? w) }]),
            ...(scene.table.wordColumn("nav_reasons") === undefined ? [] : [{ key: "nav_reasons" as const, label: "Not ok because of", text: (w: string | null) => (w === null || w === "" ? "nothing" : w.replaceAll(" ", ", ")) }]),
        ],
    });
}

function band(u: uPlot, words: (string | null)[], most: number): void {
    const { ctx, bbox } = u;
    const x = u.data[0]!;
    const [top, bottom] = [u.valToPos(-0.05 * most, "y", true), u.valToPos(-BAND * most, "y", true)];
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.font = `${11 * devicePixelRatio}px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif`;
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    for (const run of runsOf(words)) {
        if (run.label === null) continue;
        const mode = MODES[run.label];
        const left = u.valToPos(x[run.from]!, "x", true);
        const width = Math.max(devicePixelRatio, u.valToPos(x[Math.min(run.to + 1, x.length - 1)]!, "x", true) - left);
        ctx.fillStyle = colour(mode?.hue ?? "muted");
        ctx.globalAlpha = 0.55;
        ctx.fillRect(left, top, width, bottom - top);
        ctx.globalAlpha = 1;
        if (run.label === "coasting" || run.label === "stopped") {
            ctx.fillStyle = hatch(ctx);
            ctx.fillRect(left, top, width, bottom - top);
        }
        const name = mode?.words ?? run.label;
        if (ctx.measureText(name).width + 8 * devicePixelRatio > width) continue;
        ctx.fillStyle = colour("ink");
        ctx.fillText(name, left + 4 * devicePixelRatio, (top + bottom) / 2);
    }
    ctx.restore();
}
