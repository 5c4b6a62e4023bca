// Drawing the map: the still part, and what moves with the cursor.

import type { Scene } from "../data/scene.ts";
import { alertsOf, eventIndex } from "../data/events.ts";
import { runsOf } from "../data/runs.ts";
import { colour } from "../show/theme.ts";
import { clipSegment, ellipse, offset } from "./geometry.ts";
import type { Line, Shapes } from "./shapes.ts";

export interface View {
    /** Centre on the map's plane. */
    x: number;
    y: number;
    /** Pixels per unit of the plane. */
    k: number;
    width: number;
    height: number;
}

const FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';
const ROOM = 60;
/** A smaller error ellipse is drawn enlarged, and the map says so. */
const SMALLEST_PX = 14;

export function toScreen(view: View, x: number, y: number): [number, number] {
    return [(x - view.x) * view.k + view.width / 2, (y - view.y) * view.k + view.height / 2];
}

/** A line of positions, point by point; nothing is drawn from a break to the point after it. */
export interface Flown {
    line: Line;
    breaks: Set<number>;
}

/** The line in pieces, each without a break; a point that is a piece of its own is drawn as a dot by the round ends of the pen. */
export function traceFlown(pen: CanvasRenderingContext2D, view: View, { line, breaks }: Flown, from = 0, to = line.length / 2 - 1): void {
    let begin = from;
    for (let i = from; i <= to; i++) {
        if (i < to && !breaks.has(i)) continue;
        if (i > begin) trace(pen, view, line, begin, i);
        else if ((i === 0 || breaks.has(i - 1)) && (breaks.has(i) || i === to)) dot(pen, view, line, i);
        begin = i + 1;
    }
}

function dot(pen: CanvasRenderingContext2D, view: View, line: Line, i: number): void {
    const [x, y] = toScreen(view, line[2 * i]!, line[2 * i + 1]!);
    if (!Number.isFinite(x)) return;
    pen.moveTo(x, y);
    // A line without a length is not drawn.
    pen.lineTo(x + 0.1, y);
}

export function trace(pen: CanvasRenderingContext2D, view: View, line: Line, from = 0, to = line.length / 2 - 1): void {
    let drawn: [number, number] | null = null;
    let pen_at: [number, number] | null = null;
    for (let i = from; i <= to; i++) {
        const at = toScreen(view, line[2 * i]!, line[2 * i + 1]!);
        if (!Number.isFinite(at[0])) {
            drawn = null;
            continue;
        }
        if (drawn !== null) {
            // Points closer than half a pixel add nothing; the last of a run is always drawn.
            if (i < to && Math.abs(at[0] - drawn[0]) + Math.abs(at[1] - drawn[1]) < 0.5) continue;
            const part = clipSegment(drawn[0], drawn[1], at[0], at[1], view.width, view.height, ROOM);
            if (part !== null) {
                if (pen_at === null || pen_at[0] !== part[0] || pen_at[1] !== part[1]) pen.moveTo(part[0], part[1]);
                pen.lineTo(part[2], part[3]);
                pen_at = [part[2], part[3]];
            }
        }
        drawn = at;
    }
}

export function stroke(pen: CanvasRenderingContext2D, style: { colour: string; width: number; dash?: number[]; alpha?: number }, draw: () => void): void {
    pen.save();
    pen.strokeStyle = style.colour;
    pen.lineWidth = style.width;
    pen.globalAlpha = style.alpha ?? 1;
    pen.setLineDash(style.dash ?? []);
    pen.lineJoin = pen.lineCap = "round";
    pen.beginPath();
    draw();
    pen.stroke();
    pen.restore();
}

export function paintStill(pen: CanvasRenderingContext2D, view: View, shapes: Shapes, others: Flown[], scene: Scene): void {
    fillLand(pen, view, shapes.land);
    stroke(pen, { colour: colour("rule"), width: 1 }, () => shapes.graticule.forEach((line) => trace(pen, view, line)));
    stroke(pen, { colour: colour("coast"), width: 1 }, () => shapes.coast.forEach((line) => trace(pen, view, line)));
    if (shapes.tunnel !== null) {
        const { one, two } = shapes.tunnel;
        stroke(pen, { colour: colour("limit"), width: 1, dash: [4, 4], alpha: 0.55 }, () => two.forEach((edge) => trace(pen, view, edge)));
        stroke(pen, { colour: colour("limit"), width: 1.25 }, () => one.forEach((edge) => trace(pen, view, edge)));
    }
    if (shapes.path !== null) stroke(pen, { colour: colour("path"), width: 3, alpha: 0.55 }, () => trace(pen, view, shapes.path!));
    stroke(pen, { colour: colour("muted"), width: 1, alpha: 0.45 }, () => others.forEach((flown) => traceFlown(pen, view, flown)));
    paintTrack(pen, view, shapes, scene);
    paintEvents(pen, view, shapes, scene);
    paintNames(pen, view, shapes);
}

/** Land is a little darker than the sea; points closer than a pixel add nothing. */
function fillLand(pen: CanvasRenderingContext2D, view: View, land: Line[]): void {
    pen.save();
    pen.fillStyle = colour("land");
    pen.beginPath();
    for (const ring of land) {
        let [lastX, lastY] = [NaN, NaN];
        for (let i = 0; i < ring.length; i += 2) {
            const [x, y] = toScreen(view, ring[i]!, ring[i + 1]!);
            if (!Number.isFinite(x) || Math.abs(x - lastX) + Math.abs(y - lastY) < 1) continue;
            if (Number.isNaN(lastX)) pen.moveTo(x, y);
            else pen.lineTo(x, y);
            [lastX, lastY] = [x, y];
        }
        pen.closePath();
    }
    pen.fill("evenodd");
    pen.restore();
}

function paintTrack(pen: CanvasRenderingContext2D, view: View, shapes: Shapes, scene: Scene): void {
    const flown: Flown = { line: shapes.track, breaks: new Set(scene.table.breaks) };
    stroke(pen, { colour: colour("ink"), width: 1.25 }, () => traceFlown(pen, view, flown));
    const alert = scene.table.wordColumn("alert");
    if (alert === undefined) return;
    for (const run of runsOf(alert)) {
        // One epoch further, so that a single epoch has a length.
        const [from, to] = [Math.max(0, run.from - 1), run.to];
        const over = (style: Parameters<typeof stroke>[1]): void => stroke(pen, style, () => traceFlown(pen, view, flown, from, to));
        if (run.label === "caution") over({ colour: colour("caution"), width: 3.5 });
        if (run.label === "warning") over({ colour: colour("warning"), width: 5 });
        if (run.label === "unavailable") {
            over({ colour: colour("ground"), width: 3.5 });
            over({ colour: colour("muted"), width: 2.5, dash: [2, 5] });
        }
    }
}

function paintEvents(pen: CanvasRenderingContext2D, view: View, shapes: Shapes, scene: Scene): void {
    for (const event of alertsOf(scene)) {
        const i = eventIndex(event, scene);
        const [x, y] = toScreen(view, shapes.track[2 * i]!, shapes.track[2 * i + 1]!);
        const size = 5.5;
        pen.save();
        pen.fillStyle = colour(event.kind);
        pen.strokeStyle = colour("ground");
        pen.lineWidth = 1.5;
        pen.beginPath();
        if (event.kind === "warning") pen.rect(x - size, y - size, 2 * size, 2 * size);
        else {
            pen.moveTo(x, y - size);
            pen.lineTo(x + size, y + size);
            pen.lineTo(x - size, y + size);
            pen.closePath();
        }
        pen.fill();
        pen.stroke();
        pen.restore();
    }
}

/** Names never cover one another: what does not fit at this zoom waits for the next. */
function paintNames(pen: CanvasRenderingContext2D, view: View, shapes: Shapes): void {
    const taken: [number, number, number, number][] = [];
    pen.save();
    pen.font = `11px ${FONT}`;
    pen.textBaseline = "middle";
    pen.lineWidth = 3;
    const order = [...shapes.waypoints].sort((a, b) => Number(b.waypoint.kind === "runway") - Number(a.waypoint.kind === "runway"));
    for (const { point, waypoint } of order) {
        const [x, y] = toScreen(view, ...point);
        if (!(x > -50 && x < view.width + 50 && y > -20 && y < view.height + 20)) continue;
        pen.strokeStyle = colour("ground");
        pen.fillStyle = colour(waypoint.kind === "station" ? "muted" : "path");
        pen.beginPath();
        if (waypoint.kind === "runway") pen.rect(x - 3.5, y - 3.5, 7, 7);
        else if (waypoint.kind === "station") pen.arc(x, y, 3, 0, 2 * Math.PI);
        else {
            pen.moveTo(x, y - 4.5);
            pen.lineTo(x + 4, y + 3);
            pen.lineTo(x - 4, y + 3);
            pen.closePath();
        }
        pen.stroke();
        pen.fill();
        const width = pen.measureText(waypoint.name).width;
        const box: [number, number, number, number] = [x + 8, y - 7, x + 8 + width, y + 7];
        if (taken.some((t) => box[0] < t[2] + 4 && box[2] > t[0] - 4 && box[1] < t[3] && box[3] > t[1])) continue;
        taken.push(box);
        pen.fillStyle = colour("ink");
        pen.strokeText(waypoint.name, x + 8, y);
        pen.fillText(waypoint.name, x + 8, y);
    }
    pen.restore();
}

/** Draws the aircraft and its 95 % error at the cursor; returns how much the error is exaggerated, NaN without one. */
export function paintCursor(pen: CanvasRenderingContext2D, view: View, shapes: Shapes, scene: Scene): number {
    const i = scene.cursor.get();
    const { table } = scene;
    const [px, py] = [shapes.track[2 * i]!, shapes.track[2 * i + 1]!];
    if (!Number.isFinite(px)) return NaN;
    const at = toScreen(view, px, py);
    paintAircraft(pen, at, heading(shapes.path ?? shapes.track, i) ?? table.value("course_rad", i));
    // The true position may lie under the aircraft: it is drawn after it.
    return paintError(pen, view, shapes, scene, at, i);
}

function paintError(pen: CanvasRenderingContext2D, view: View, shapes: Shapes, scene: Scene, at: [number, number], i: number): number {
    const { table } = scene;
    const risk = scene.payload.record.risk_accuracy;
    const e = ellipse(table.value("cov_ee_m2", i), table.value("cov_en_m2", i), table.value("cov_nn_m2", i), risk);
    if (!Number.isFinite(e.major_m)) return NaN;
    const perMetre = pixelsPerMetre(view, shapes, i, scene);
    const scale = enlarge(e.major_m * perMetre);
    const px = perMetre * scale;
    stroke(pen, { colour: colour("m1"), width: 1.5 }, () => pen.ellipse(at[0], at[1], e.major_m * px, e.minor_m * px, -e.angle_rad, 0, 2 * Math.PI));
    const circle = table.value("anp_circle_m", i);
    if (Number.isFinite(circle)) stroke(pen, { colour: colour("m1"), width: 1, dash: [4, 3] }, () => pen.arc(at[0], at[1], circle * px, 0, 2 * Math.PI));
    for (const [column, hue, dash] of [["hpl_m", "m2", []], ["hal_m", "limit", [6, 4]]] as const) {
        const radius = table.value(column, i);
        if (Number.isFinite(radius)) stroke(pen, { colour: colour(hue), width: 2, dash: [...dash] }, () => pen.arc(at[0], at[1], radius * px, 0, 2 * Math.PI));
    }
    const [east, north] = [table.value("nse_e_m", i), table.value("nse_n_m", i)];
    if (Number.isFinite(east) && Number.isFinite(north)) {
        const [x, y] = [at[0] + east * px, at[1] - north * px];
        stroke(pen, { colour: colour("m5"), width: 1.75 }, () => {
            pen.moveTo(x - 4, y - 4);
            pen.lineTo(x + 4, y + 4);
            pen.moveTo(x + 4, y - 4);
            pen.lineTo(x - 4, y + 4);
        });
    }
    return scale;
}

/** 1, 2 or 5 times a power of ten that makes a length in pixels visible. */
export function enlarge(px: number): number {
    for (let decade = 1; decade < 1e9; decade *= 10) {
        const factor = [1, 2, 5].find((f) => px * f * decade >= SMALLEST_PX);
        if (factor !== undefined) return factor * decade;
    }
    return 1;
}

export function pixelsPerMetre(view: View, shapes: Shapes, i: number, scene: Scene): number {
    const [lat, lon] = [scene.table.value("est_lat_rad", i), scene.table.value("est_lon_rad", i)];
    const far = offset(lat, lon, 0, 1000);
    const [a, b] = [shapes.plane.put(lat, lon), shapes.plane.put(far.lat_rad, far.lon_rad)];
    return (Math.hypot(b[0] - a[0], b[1] - a[1]) * view.k) / 1000;
}

/** Clockwise from up, from the neighbouring positions. */
function heading(track: Line, i: number): number | null {
    const [a, b] = [Math.max(0, i - 5), Math.min(track.length / 2 - 1, i + 5)];
    const [dx, dy] = [track[2 * b]! - track[2 * a]!, track[2 * b + 1]! - track[2 * a + 1]!];
    return Number.isFinite(dx + dy) && dx * dx + dy * dy > 0 ? Math.atan2(dx, -dy) : null;
}

/** Filled where it is; hollow where it was. */
export function paintAircraft(pen: CanvasRenderingContext2D, at: [number, number], heading_rad: number, hollow = false): void {
    pen.save();
    pen.translate(...at);
    pen.rotate(Number.isFinite(heading_rad) ? heading_rad : 0);
    pen.fillStyle = colour("ink");
    pen.strokeStyle = colour("ground");
    pen.lineWidth = 3;
    const half: [number, number][] = [[0, -10], [1.4, -7], [1.4, -2.5], [9, 2.5], [9, 4.5], [1.4, 2.2], [1.1, 7], [3.6, 9], [3.6, 10.4], [0, 9.5]];
    const outline = [...half, ...half.slice(1, -1).reverse().map(([x, y]): [number, number] => [-x, y])];
    pen.beginPath();
    outline.forEach(([x, y], n) => (n === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
    pen.closePath();
    pen.stroke();
    if (hollow) {
        pen.fillStyle = colour("ground");
        pen.fill();
        pen.strokeStyle = colour("ink");
        pen.lineWidth = 1;
        pen.stroke();
    } else pen.fill();
    pen.restore();
}
