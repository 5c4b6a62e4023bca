// All approaches to a runway over one another, by distance to the threshold: each track, the envelope, the band that holds 95 %.

import type { DeviationBand } from "../records.gen.ts";
import { METRES_PER_NM } from "../data/scene.ts";
import type { Store } from "../data/store.ts";
import { el } from "../show/dom.ts";
import { metres, nauticalMiles, signedMetres, wholeMetres } from "../show/format.ts";
import { colour } from "../show/theme.ts";
import { roundDown } from "../map/geometry.ts";
import type { Flown } from "./flown.ts";

const FONT = '11px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';
const LEFT = 58;
const RIGHT = 16;
const TOP = 18;
const BOTTOM = 26;
const NEAR_PX = 14;

const TITLES: Record<DeviationBand["column"], { title: string; note: string }> = {
    fte_m: { title: "Lateral deviation of all approaches", note: "Positive right of the path." },
    fte_v_m: { title: "Vertical deviation of all approaches", note: "Positive above the path." },
    est_h_m: { title: "Height of all approaches", note: "No vertical path is known: the height as it was recorded." },
};

interface Frame {
    x: (before_m: number) => number;
    y: (value: number) => number;
    low: number;
    high: number;
    far: number;
    width: number;
    height: number;
}

/** Tracks of one runway; pressing one chooses it. */
export function overlay(host: HTMLElement, band: DeviationBand, flown: Flown[], limit_m: number | null, theme: Store<number>, choose: (track: string) => void): () => void {
    const { title, note } = TITLES[band.column];
    const canvas = el("canvas", { "aria-hidden": "true" });
    const words = el("p", { class: "note" });
    const shown = flown.length < band.n_tracks ? ` ${flown.length} of ${band.n_tracks} tracks are embedded and drawn; envelope and band are of all.` : "";
    const figure = el("figure", { class: "chart overlay", "data-column": band.column }, el("div", { class: "chart-head" }, el("h3", {}, title)),
        el("figcaption", {}, `${note} Thin: every approach. Blue: the band that holds 95 %, and the median. Dashed: the outermost.${shown} Press a track to see that approach alone.`), canvas, words, numbers(band));
    host.append(figure);
    let over: Flown | null = null;
    let frame: Frame | null = null;
    const say = (): void => { words.textContent = over === null ? `${band.n_tracks} approaches to ${band.runway}.` : `${over.label}: press to see this approach.`; };
    const paint = (): void => {
        const [width, height] = [canvas.clientWidth, canvas.clientHeight];
        const pen = canvas.getContext("2d");
        if (pen === null || width === 0) return;
        [canvas.width, canvas.height] = [Math.round(width * devicePixelRatio), Math.round(height * devicePixelRatio)];
        pen.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
        frame = frameOf(band, width, height);
        grid(pen, frame);
        paintBand(pen, frame, band);
        for (const one of flown) line(pen, frame, one, band.column, one === over ? { colour: colour("ink"), width: 2, alpha: 1 } : { colour: colour("muted"), width: 1, alpha: flown.length > 60 ? 0.25 : 0.5 });
        if (limit_m !== null && band.column === "fte_m") limits(pen, frame, limit_m);
        say();
    };
    const nearest = (event: MouseEvent): Flown | null => {
        if (frame === null) return null;
        const box = canvas.getBoundingClientRect();
        return nearestTo(event.clientX - box.left, event.clientY - box.top, frame, flown, band.column);
    };
    canvas.addEventListener("mousemove", (e) => {
        const now = nearest(e);
        canvas.style.cursor = now === null ? "default" : "pointer";
        if (now !== over) { over = now; paint(); }
    });
    canvas.addEventListener("mouseleave", () => { over = null; paint(); });
    canvas.addEventListener("click", (e) => { const hit = nearest(e); if (hit !== null) choose(hit.track); });
    const resize = new ResizeObserver(paint);
    resize.observe(canvas);
    const end = theme.watch(paint);
    return () => {
        end();
        resize.disconnect();
        figure.remove();
    };
}

function frameOf(band: DeviationBand, width: number, height: number): Frame {
    const known = (values: (number | null)[]): number[] => values.filter((v): v is number => v !== null);
    const [least, most] = [Math.min(...known(band.least_m)), Math.max(...known(band.most_m))];
    const room = 0.06 * (most - least || 1);
    const [low, high] = [least - room, most + room];
    const far = Math.max(...band.before_m) + 0.25 * METRES_PER_NM;
    return {
        low, high, far, width, height,
        // The aircraft flies from left to right, to the threshold.
        x: (before) => LEFT + (1 - before / far) * (width - LEFT - RIGHT),
        y: (value) => TOP + ((high - value) / (high - low)) * (height - TOP - BOTTOM),
    };
}

function grid(pen: CanvasRenderingContext2D, f: Frame): void {
    pen.font = FONT;
    pen.fillStyle = colour("muted");
    pen.lineWidth = 1;
    const step = roundDown((f.high - f.low) / 3.5);
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (let v = Math.ceil(f.low / step) * step; v <= f.high; v += step) {
        pen.strokeStyle = colour(Math.abs(v) < step / 2 ? "muted" : "rule");
        stroke(pen, () => { pen.moveTo(LEFT, f.y(v)); pen.lineTo(f.width - RIGHT, f.y(v)); });
        pen.fillText(wholeMetres(v), LEFT - 6, f.y(v));
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    pen.strokeStyle = colour("rule");
    const miles = Math.floor(f.far / METRES_PER_NM);
    for (let nm = 0; nm <= miles; nm += miles > 12 ? 2 : 1) {
        const x = f.x(nm * METRES_PER_NM);
        stroke(pen, () => { pen.moveTo(x, TOP); pen.lineTo(x, f.height - BOTTOM); });
        pen.fillText(nm === 0 ? "THR" : `${nm} NM`, Math.min(x, f.width - 14), f.height - BOTTOM + 6);
    }
}

function stroke(pen: CanvasRenderingContext2D, draw: () => void): void {
    pen.beginPath();
    draw();
    pen.stroke();
}

function paintBand(pen: CanvasRenderingContext2D, f: Frame, band: DeviationBand): void {
    const at = band.before_m.map((_, i) => i);
    const full = at.filter((i) => band.low_m[i] !== null && band.high_m[i] !== null);
    pen.fillStyle = `${colour("m1")}30`;
    pen.beginPath();
    full.forEach((i, k) => (k === 0 ? pen.moveTo(f.x(band.before_m[i]!), f.y(band.high_m[i]!)) : pen.lineTo(f.x(band.before_m[i]!), f.y(band.high_m[i]!))));
    full.slice().reverse().forEach((i) => pen.lineTo(f.x(band.before_m[i]!), f.y(band.low_m[i]!)));
    pen.fill();
    pen.strokeStyle = colour("m1");
    const trace = (values: (number | null)[], dash: number[], width: number): void => {
        pen.setLineDash(dash);
        pen.lineWidth = width;
        stroke(pen, () => at.forEach((i) => { if (values[i] != null) pen.lineTo(f.x(band.before_m[i]!), f.y(values[i]!)); }));
        pen.setLineDash([]);
    };
    trace(band.median_m, [], 2);
    trace(band.least_m, [5, 4], 1.25);
    trace(band.most_m, [5, 4], 1.25);
}

function line(pen: CanvasRenderingContext2D, f: Frame, one: Flown, column: DeviationBand["column"], style: { colour: string; width: number; alpha: number }): void {
    const values = one.values[column];
    if (values === undefined) return;
    pen.save();
    pen.strokeStyle = style.colour;
    pen.lineWidth = style.width;
    pen.globalAlpha = style.alpha;
    let down = false;
    pen.beginPath();
    for (let i = 0; i < values.length; i++) {
        const before = -one.along_m[i]!;
        if (!Number.isFinite(values[i]!) || !(before >= 0)) { down = false; continue; }
        if (down) pen.lineTo(f.x(before), f.y(values[i]!));
        else pen.moveTo(f.x(before), f.y(values[i]!));
        down = true;
    }
    pen.stroke();
    pen.restore();
}

/** RNP on both sides, where it lies within the picture; else what it is stands at the edge. */
function limits(pen: CanvasRenderingContext2D, f: Frame, limit_m: number): void {
    pen.strokeStyle = pen.fillStyle = colour("limit");
    pen.lineWidth = 1.5;
    pen.textAlign = "left";
    pen.textBaseline = "top";
    for (const v of [limit_m, -limit_m]) if (v > f.low && v < f.high) stroke(pen, () => { pen.moveTo(LEFT, f.y(v)); pen.lineTo(f.width - RIGHT, f.y(v)); });
    if (limit_m >= f.high) pen.fillText(`↑ ±RNP ${nauticalMiles(limit_m)}, beyond the picture`, LEFT + 6, 2);
}

function nearestTo(px: number, py: number, f: Frame, flown: Flown[], column: DeviationBand["column"]): Flown | null {
    let best: Flown | null = null;
    let least = NEAR_PX ** 2;
    for (const one of flown) {
        const values = one.values[column];
        for (let i = 0; values !== undefined && i < values.length; i++) {
            const d = (f.x(-one.along_m[i]!) - px) ** 2 + (f.y(values[i]!) - py) ** 2;
            if (d < least) [best, least] = [one, d];
        }
    }
    return best;
}

function numbers(band: DeviationBand): HTMLElement {
    const show = (v: number | null): string => (band.column === "est_h_m" ? metres(v) : signedMetres(v));
    const rows = band.before_m.map((b, i) => el("tr", {}, el("th", { scope: "row" }, nauticalMiles(b, 2)), ...[band.least_m, band.low_m, band.median_m, band.high_m, band.most_m].map((values) => el("td", {}, show(values[i]!))), el("td", {}, String(band.n[i]))));
    return el("details", { class: "numbers" }, el("summary", {}, "Numbers", el("span", { class: "sr" }, ` of ${TITLES[band.column].title}`)),
        el("div", { class: "scroll" }, el("table", {}, el("caption", { class: "sr" }, `${TITLES[band.column].title}, as numbers`),
            el("thead", {}, el("tr", {}, ...["Before the threshold", "Least", "2.5 %", "Median", "97.5 %", "Most", "Epochs"].map((h) => el("th", { scope: "col" }, h)))), el("tbody", {}, ...rows))));
}
