// What stands in a chart beside its lines: hatched spans, event marks, names at the lines' ends.

import type uPlot from "uplot";
import type { Scene } from "../data/scene.ts";
import { alertsOf, eventIndex } from "../data/events.ts";
import { colour } from "../show/theme.ts";
import type { Line } from "./strip.ts";
import { spread } from "./ticks.ts";

const LABEL_PX = 13;

/** A pattern of diagonal lines; spans without a value are hatched, never bridged. */
export function hatch(context: CanvasRenderingContext2D): CanvasPattern | string {
    const size = 6 * devicePixelRatio;
    const tile = document.createElement("canvas");
    tile.width = tile.height = size;
    const pen = tile.getContext("2d");
    if (pen === null) return colour("rule");
    pen.strokeStyle = colour("muted");
    pen.globalAlpha = 0.45;
    pen.lineWidth = devicePixelRatio;
    pen.beginPath();
    for (const shift of [-size, 0, size]) {
        pen.moveTo(shift, size);
        pen.lineTo(shift + size, 0);
    }
    pen.stroke();
    return context.createPattern(tile, "repeat") ?? colour("rule");
}

export function drawHatch(u: uPlot, scene: Scene): void {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.fillStyle = hatch(ctx);
    const breaks = scene.table.breaks.map((i) => ({ from: i, to: i + 1 }));
    for (const run of [...scene.table.unavailable, ...breaks]) {
        const left = u.valToPos(u.data[0]![run.from]!, "x", true);
        const right = u.valToPos(u.data[0]![run.to]!, "x", true);
        ctx.fillRect(left, bbox.top, Math.max(right - left, devicePixelRatio), bbox.height);
    }
    ctx.restore();
}

/** A square for a warning, a triangle for a caution, at the top edge. */
export function drawEvents(u: uPlot, scene: Scene): void {
    const { ctx, bbox } = u;
    const size = 4.5 * devicePixelRatio;
    const marks = alertsOf(scene).map((event) => ({ kind: event.kind, at: u.valToPos(u.data[0]![eventIndex(event, scene)]!, "x", true) }));
    const warnings = marks.filter((m) => m.kind === "warning").map((m) => m.at);
    for (const { kind, at } of marks) {
        // A caution that grows into a warning stands before it, not under it.
        const x = kind === "caution" && warnings.some((w) => Math.abs(w - at) < 2 * size) ? at - 2.3 * size : at;
        if (x < bbox.left || x > bbox.left + bbox.width) continue;
        const y = bbox.top - size - devicePixelRatio;
        ctx.save();
        ctx.fillStyle = colour(kind);
        ctx.strokeStyle = colour("ground");
        ctx.lineWidth = devicePixelRatio;
        ctx.beginPath();
        if (kind === "warning") ctx.rect(x - size, y - size, 2 * size, 2 * size);
        else {
            ctx.moveTo(x, y - size);
            ctx.lineTo(x + size, y + size);
            ctx.lineTo(x - size, y + size);
            ctx.closePath();
        }
        ctx.stroke();
        ctx.fill();
        ctx.restore();
    }
}

/** Units at the ends of the axes. */
export function drawUnits(u: uPlot, vertical: string, horizontal: string, font: string): void {
    const { ctx, bbox } = u;
    const ratio = devicePixelRatio;
    ctx.save();
    ctx.font = scaled(font);
    ctx.fillStyle = colour("muted");
    ctx.textAlign = "right";
    ctx.textBaseline = "alphabetic";
    ctx.fillText(vertical, bbox.left - 5 * ratio, bbox.top - 8 * ratio);
    ctx.textAlign = "left";
    ctx.textBaseline = "top";
    ctx.fillText(horizontal, 0, bbox.top + bbox.height + 5 * ratio);
    ctx.restore();
}

function scaled(font: string): string {
    return font.replace("11px", `${11 * devicePixelRatio}px`);
}

export function drawLabels(u: uPlot, lines: Line[], visible: Set<string>, font: string, floor = -Infinity): void {
    const { ctx, bbox } = u;
    const ratio = devicePixelRatio;
    const [, last] = u.series[0]!.idxs ?? [0, u.data[0]!.length - 1];
    const shown = lines.filter((line) => visible.has(line.key)).flatMap((line) => {
        let i = last ?? line.values.length - 1;
        while (i >= 0 && !Number.isFinite(line.values[i]!)) i--;
        const value = line.values[i];
        if (value === undefined) return [];
        const y = u.valToPos(Math.max(value, floor), "y", true);
        const off = y < bbox.top ? " ↑" : y > bbox.top + bbox.height ? " ↓" : "";
        return [{ line, y: Math.min(bbox.top + bbox.height, Math.max(bbox.top, y)), text: (line.mirror ? `±${line.label}` : line.endLabel ?? line.label) + off }];
    });
    const placed = spread(shown.map((s) => s.y), LABEL_PX * ratio, bbox.top + 4 * ratio, bbox.top + bbox.height - 4 * ratio);
    ctx.save();
    ctx.font = scaled(font);
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    shown.forEach((label, i) => {
        const x = bbox.left + bbox.width;
        ctx.strokeStyle = ctx.fillStyle = colour(label.line.colour);
        ctx.lineWidth = ratio * 0.75;
        ctx.beginPath();
        ctx.moveTo(x + 2 * ratio, label.y);
        ctx.lineTo(x + 9 * ratio, placed[i]!);
        ctx.stroke();
        ctx.fillText(label.text, x + 12 * ratio, placed[i]!);
    });
    ctx.restore();
}
