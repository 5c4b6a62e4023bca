// Posterior of each navigation specification, stacked, with the decided state beneath.

import type uPlot from "uplot";
import type { Scene } from "../data/scene.ts";
import { runsOf } from "../data/runs.ts";
import { plain } from "../show/format.ts";
import { colour, type Colour } from "../show/theme.ts";
import { hatch } from "./decorate.ts";
import { missing } from "./missing.ts";
import { strip, type Line } from "./strip.ts";

const HUES: Colour[] = ["s1", "s2", "s3", "s4", "s5"];
const BAND = 0.13;

/** Even steps of one hue from the strictest state; the last one, outside every specification, is hatched. */
function hue(i: number, n: number): Colour {
    return HUES[n <= 1 ? 0 : Math.round((i * (HUES.length - 1)) / (n - 1))]!;
}

export function states(host: HTMLElement, scene: Scene): () => void {
    const names = scene.payload.summary.states;
    const columns = names.map((_, i) => scene.table.column(`p_state_${i + 1}`));
    if (names.length === 0 || columns.some((c) => c === undefined)) return missing(host, "Navigation state", "The state classifier was not run.");
    const lines: Line[] = names.map((name, i) => ({ key: `p_state_${i + 1}`, label: name, values: columns[i]!, colour: hue(i, names.length), width: 5, about: `Posterior probability of ${name}` }));
    const draw = (u: uPlot): void => {
        stack(u, lines);
        band(u, scene, names);
    };
    return strip(host, scene, {
        id: "states", title: "Navigation state", unit: "", scales: ["data"], range: [-BAND - 0.05, 1], height: 190, draw,
        note: "Posterior probability of each navigation specification, stacked; beneath, the decided state. Where epochs are denser than pixels, their mean.",
        lines, show: (v) => (Number.isFinite(v) ? plain(v, 3) : "n/a"), ySplits: () => [0, 0.5, 1], yTick: (v) => plain(v, 1), noPaths: true,
    });
}

function stack(u: uPlot, lines: Line[]): void {
    const { ctx, bbox } = u;
    const x = u.data[0]!;
    const [first, last] = u.series[0]!.idxs ?? [0, x.length - 1];
    const left = (i: number): number => Math.round(u.valToPos(x[i]!, "x", true));
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (let i = first!; i <= last!; ) {
        const at = left(i);
        let end = i + 1;
        while (end <= last! && left(end) <= at) end++;
        const width = Math.max(1, (end <= last! ? left(end) : at + 1) - at);
        let below = 0;
        for (const line of lines) {
            let sum = 0;
            for (let k = i; k < end; k++) sum += line.values[k]!;
            const share = sum / (end - i);
            if (!Number.isFinite(share)) break;
            const [bottom, top] = [u.valToPos(below, "y", true), u.valToPos(below + share, "y", true)];
            ctx.fillStyle = colour(line.colour);
            ctx.fillRect(at, top, width, bottom - top);
            below += share;
        }
        i = end;
    }
    ctx.restore();
}

function band(u: uPlot, scene: Scene, names: string[]): void {
    const decided = scene.table.wordColumn("state");
    if (decided === undefined) return;
    const { ctx, bbox } = u;
    const x = u.data[0]!;
    const [top, bottom] = [u.valToPos(-0.05, "y", true), u.valToPos(-0.05 - BAND, "y", true)];
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (const run of runsOf(decided)) {
        if (run.label === null) continue;
        const i = names.indexOf(run.label);
        const left = u.valToPos(x[run.from]!, "x", true);
        const width = Math.max(devicePixelRatio, u.valToPos(x[Math.min(run.to + 1, x.length - 1)]!, "x", true) - left);
        ctx.fillStyle = i < 0 ? colour("muted") : colour(hue(i, names.length));
        ctx.fillRect(left, top, width, bottom - top);
        if (i < 0 || i === names.length - 1) {
            ctx.fillStyle = hatch(ctx);
            ctx.fillRect(left, top, width, bottom - top);
        }
    }
    ctx.restore();
}
