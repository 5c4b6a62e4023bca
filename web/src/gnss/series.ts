// Satellites over time: which were used, their residuals, how strong they were.

import type uPlot from "uplot";
import { atEpochs, rowAt, type Satellite } from "../data/heard.ts";
import type { Scene } from "../data/scene.ts";
import { plain, signedMetres } from "../show/format.ts";
import { colour } from "../show/theme.ts";
import { hatch } from "../chart/decorate.ts";
import { strip, type Line } from "../chart/strip.ts";
import { EXCLUDED, hueOf, systemOf, USED } from "./fates.ts";

const ROW_PX = 15;

/** A row a satellite: green in the position, amber excluded, hatched not used. */
export function use(host: HTMLElement, scene: Scene, satellites: Satellite[]): () => void {
    const n = satellites.length;
    const counts = new Float64Array(scene.table.n);
    for (const of of satellites) of.at.forEach((epoch, k) => { if (of.fate[k] === USED) counts[epoch]! += 1; });
    const excluded = (i: number): string => satellites.filter((of) => of.fate[rowAt(of, i)] === EXCLUDED).map((of) => of.sv).join(", ");
    return strip(host, scene, {
        id: "satellites-used", title: "Satellites used and excluded", unit: "", scales: ["data"], range: [-0.5, n - 0.5], height: n * ROW_PX + 54, noPaths: true, varies: true,
        note: "Green: in the position. Amber: excluded by the residual test. Hatched: heard and not used; why stands beside the sky and in the table.",
        lines: [{ key: "n_used", label: "Satellites in the position", values: counts, colour: "normal", width: 4 }], show: (v) => plain(v, 0),
        // The first satellite stands at the top.
        ySplits: () => satellites.map((_, k) => k), yTick: (v) => satellites[n - 1 - v]?.sv ?? "", draw: (u) => bars(u, satellites, new Set(scene.table.breaks)),
        says: (i) => (excluded(i) === "" ? "" : `Excluded: ${excluded(i)}`),
    });
}

function bars(u: uPlot, satellites: Satellite[], breaks: Set<number>): void {
    const { ctx, bbox } = u;
    const x = u.data[0]!;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    satellites.forEach((of, row) => {
        const middle = u.valToPos(satellites.length - 1 - row, "y", true);
        const half = 0.36 * Math.abs(u.valToPos(1, "y", true) - u.valToPos(0, "y", true));
        for (let k = 0; k < of.at.length; ) {
            let end = k;
            while (end + 1 < of.at.length && of.fate[end + 1] === of.fate[k] && of.at[end + 1]! - of.at[end]! <= 20 && !breaks.has(of.at[end]!)) end++;
            const left = u.valToPos(x[of.at[k]!]!, "x", true);
            const right = u.valToPos(x[Math.min(of.at[end]! + (breaks.has(of.at[end]!) ? 0 : 1), x.length - 1)]!, "x", true);
            const idle = of.fate[k] !== USED && of.fate[k] !== EXCLUDED;
            ctx.fillStyle = idle ? hatch(ctx) : colour(hueOf(of.fate[k]!));
            ctx.globalAlpha = idle ? 1 : 0.8;
            ctx.fillRect(left, middle - half, Math.max(devicePixelRatio, right - left), 2 * half);
            k = end + 1;
        }
    });
    ctx.restore();
}

function linesOf(scene: Scene, satellites: Satellite[], of: (s: Satellite) => Float64Array): Line[] {
    return satellites.filter((s) => of(s).some(Number.isFinite)).map((s) => {
        const { hue, dash } = systemOf(s.sv);
        return { key: `${s.sv}`, label: s.sv, values: atEpochs(s, of(s), scene.table.n), colour: hue, width: 1, quiet: true, ...(dash ? { dash } : {}) };
    });
}

/** The line that is furthest from zero, or lowest, at an epoch. */
function extreme(lines: Line[], i: number, size: (v: number) => number): Line | null {
    return lines.reduce<Line | null>((best, line) => (Number.isFinite(line.values[i]!) && (best === null || size(line.values[i]!) > size(best.values[i]!)) ? line : best), null);
}

export function residuals(host: HTMLElement, scene: Scene, satellites: Satellite[]): () => void {
    const lines = linesOf(scene, satellites, (s) => s.residual_m);
    if (lines.length === 0) return () => undefined;
    return strip(host, scene, {
        id: "residuals", title: "Residuals by satellite", unit: "m", scales: ["data"], lines, show: (v) => signedMetres(v), height: 230, noLabels: true,
        note: `Measured less computed range at the position, of satellites that were used or that a monitor excluded. ${systems(satellites)}`,
        says: (i) => { const most = extreme(lines, i, Math.abs); return most === null ? "No residual at the cursor" : `Largest at the cursor: ${most.label} ${signedMetres(most.values[i])}`; },
    });
}

export function strength(host: HTMLElement, scene: Scene, satellites: Satellite[]): () => void {
    const lines = linesOf(scene, satellites, (s) => s.cn0_dbhz);
    if (lines.length === 0) return () => undefined;
    return strip(host, scene, {
        id: "strength", title: "C/N0 by satellite", unit: "dB-Hz", scales: ["data"], lines, show: (v) => `${plain(v, 1)} dB-Hz`, height: 200, noLabels: true, free: true,
        note: `Carrier to noise density as the receiver states it, of all satellites with a range. ${systems(satellites)}`,
        says: (i) => { const least = extreme(lines, i, (v) => -v); return least === null ? "Not stated at the cursor" : `Weakest at the cursor: ${least.label} ${plain(least.values[i]!, 1)} dB-Hz`; },
    });
}

function systems(satellites: Satellite[]): string {
    const names = [...new Set(satellites.map((s) => systemOf(s.sv)))].map(({ name, dash }) => `${name} ${dash === undefined ? "solid" : dash[0]! > 3 ? "dashed" : "dotted"}`);
    return `${names.join(", ")}.`;
}

