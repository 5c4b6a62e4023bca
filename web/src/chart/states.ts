// Probability of each navigation specification, stacked, with the decided state beneath.

import type uPlot from "uplot";
import type { Scene } from "../data/scene.ts";
import { runsOf } from "../data/runs.ts";
import { level, plain, risk } from "../show/format.ts";
import { colour, type Colour } from "../show/theme.ts";
import { hatch } from "./decorate.ts";
import { missing } from "./missing.ts";
import { strip, type Line } from "./strip.ts";

const HUES: Colour[] = ["s1", "s2", "s3", "s4", "s5"];
const BAND = 0.13;
/** A thinner part of the stack has no room for its name. */
const LEAST_NAMED = 0.12;

/** Even steps of one hue from the strictest state; the last one, outside every specification, is hatched. */
function hue(i: number, n: number): Colour {
    return HUES[n <= 1 ? 0 : Math.round((i * (HUES.length - 1)) / (n - 1))]!;
}

export function states(host: HTMLElement, scene: Scene): () => void {
    const names = scene.payload.summary.states;
    const columns = names.map((_, i) => scene.table.column(`p_state_${i + 1}`));
    if (names.length === 0 || columns.some((c) => c === undefined)) return missing(host, "Navigation state", "The state classifier was not run.");
    const lines: Line[] = names.map((name, i) => ({ key: `p_state_${i + 1}`, label: name, values: columns[i]!, colour: hue(i, names.length), width: 5, about: `Probability of ${name}` }));
    const draw = (u: uPlot): void => {
        stack(u, lines);
        band(u, scene, names);
        endNames(u, lines);
    };
    return strip(host, scene, {
        id: "states", title: "Navigation state", unit: "", scales: ["data"], range: [-BAND - 0.05, 1], height: 190, draw,
        note: `Probability that the lateral total system error is of each specification, stacked; where epochs are denser than pixels, their mean. Beneath, the state: the strictest specification held at ${level(scene.payload.record.risk_accuracy)}, which need not be the most probable one.`,
        lines, show: (v) => (Number.isFinite(v) && (v >= 1e-3 || v === 0) ? plain(v, v === 0 ? 0 : 3) : risk(v)), words: [{ key: "state", label: "State" }], ySplits: () => [0, 0.5, 1], yTick: (v) => plain(v, 1), noPaths: true,
    });
}

function stack(u: uPlot, lines: Line[]): void {
    const { ctx, bbox } = u;
    const x = u.data[0]!;
    const [first, last] = u.series[0]!.idxs ?? [0, x.length - 1];
    const left = (i: number): number => Math.round(u.valToPos(x[i]!, "x", true));
    // Asked once: a colour by its name costs a look at the style sheet.
    const fills = lines.map((line) => colour(line.colour));
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
        for (const [k, line] of lines.entries()) {
            let sum = 0;
            for (let e = i; e < end; e++) sum += line.values[e]!;
            const share = sum / (end - i);
            if (!Number.isFinite(share)) break;
            const [bottom, top] = [u.valToPos(below, "y", true), u.valToPos(below + share, "y", true)];
            ctx.fillStyle = fills[k]!;
            ctx.fillRect(at, top, width, bottom - top);
            below += share;
        }
        i = end;
    }
    ctx.restore();
}

/** What the two parts are, beside their ends; the states of the last epoch shown that have room for a name. */
function endNames(u: uPlot, lines: Line[]): void {
    const { ctx, bbox } = u;
    const [, last] = u.series[0]!.idxs ?? [0, u.data[0]!.length - 1];
    const x = bbox.left + bbox.width + 12 * devicePixelRatio;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif`;
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    ctx.fillStyle = colour("muted");
    ctx.fillText("state", x, u.valToPos(-0.05 - BAND / 2, "y", true));
    let below = 0;
    for (const line of lines) {
        const share = line.values[last ?? 0] ?? NaN;
        if (!Number.isFinite(share)) break;
        if (share > LEAST_NAMED) ctx.fillText(line.label, x, u.valToPos(below + share / 2, "y", true));
        below += share;
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
