// The map, north up and true to scale: corridor at RNP and twice RNP, path, trail by alert, the aircraft where it was last, its 95 % ellipse.

import { scaleBar } from "../map/map.ts";
import { ellipse, offset, plane, type Plane, type Point } from "../map/geometry.ts";
import { enlarge, paintAircraft, stroke, toScreen, trace, type View } from "../map/paint.ts";
import { runsOf } from "../data/runs.ts";
import { button, el } from "../show/dom.ts";
import { level, place } from "../show/format.ts";
import { colour } from "../show/theme.ts";
import { hatch } from "../chart/decorate.ts";
import { plain } from "../show/format.ts";
import { DASHES, say, type Part } from "./parts.ts";
import { plainName, present, severity, type Model, type Row } from "./state.ts";

/** Distance of the aircraft from the centre of the plane after which a new one is taken. */
const FAR_RAD = 0.02;
/** Height of the map in RNP values. */
const CORRIDORS = 7;
const STEP_PX = 60;

interface Lines {
    track: Float64Array;
    path: Float64Array;
    /** Left and right at RNP, left and right at twice RNP. */
    edges: Float64Array[];
}

interface Placed {
    track: Point;
    path: Point;
    edges: [Point, Point, Point, Point];
}

export function map(): Part & { zoom: (factor: number) => void; focus: () => void } {
    const canvas = el("canvas", { "aria-hidden": "true" });
    const bar = el("div", { class: "map-scale", "aria-hidden": "true" });
    const surface = el("div", { class: "map-surface", tabindex: 0, role: "application", "aria-roledescription": "map", "aria-label": "Map, north up: plus and minus zoom, arrows move, c centres the aircraft" }, canvas, bar);
    const words = el("p", { class: "map-words" });
    const controls = el("div", { class: "map-controls", role: "group", "aria-label": "Map view" }, button("+", { "aria-label": "Zoom in" }, () => zoom(2)), button("−", { "aria-label": "Zoom out" }, () => zoom(0.5)), button("Centre", {}, () => centre()));
    const key = el("p", { class: "strip-key" }, ...[["key-path", "path"], ["key-one", "±RNP"], ["key-two", "±2 RNP"], ["key-ellipse", "95 % ellipse"]].map(([css, name]) => el("span", { class: "key" }, el("i", { class: css! }), name!)));
    const element = el("section", { class: "live-map panel" }, el("div", { class: "events-head" }, el("h2", {}, "Map, north up"), controls), surface, key, words);
    let on: Plane | null = null;
    let placed = new WeakMap<Row, Placed>();
    let [middle_lat, middle_lon] = [NaN, NaN];
    const view: View = { x: 0, y: 0, k: 1, width: 0, height: 0 };
    let magnified = 1;
    let moved: [number, number] = [0, 0];
    let model: Model | null = null;
    let now = 0;
    let ahead: { on: Plane; lines: Lines } | null = null;

    const zoom = (factor: number): void => {
        magnified = Math.min(256, Math.max(1 / 256, magnified * factor));
        moved = [moved[0] * factor, moved[1] * factor];
        if (model !== null) show(model, now);
    };
    const centre = (): void => {
        [magnified, moved] = [1, [0, 0]];
        if (model !== null) show(model, now);
    };
    const pan = (dx: number, dy: number): void => {
        moved = [moved[0] + dx, moved[1] + dy];
        if (model !== null) show(model, now);
    };
    surface.addEventListener("keydown", (e) => {
        const act: Record<string, () => void> = { ArrowLeft: () => pan(STEP_PX, 0), ArrowRight: () => pan(-STEP_PX, 0), ArrowUp: () => pan(0, STEP_PX), ArrowDown: () => pan(0, -STEP_PX), c: centre };
        const move = act[e.key];
        if (move === undefined || e.ctrlKey || e.metaKey || e.altKey) return;
        e.preventDefault();
        move();
    });

    const put = (row: Row, of: Model): Placed => {
        const known = placed.get(row);
        if (known !== undefined) return known;
        const [lat, lon, course, fte, rnp] = ["est_lat_rad", "est_lon_rad", "course_rad", "fte_m", "rnp_m"].map((name) => of.number(name, row)) as [number, number, number, number, number];
        const right = (metres: number): Point => {
            const p = offset(lat, lon, metres * Math.cos(course), -metres * Math.sin(course));
            return Number.isFinite(p.lat_rad) && Number.isFinite(p.lon_rad) ? on!.put(p.lat_rad, p.lon_rad) : [NaN, NaN];
        };
        const made: Placed = {
            track: Number.isFinite(lat) && Number.isFinite(lon) ? on!.put(lat, lon) : [NaN, NaN], path: right(-fte),
            edges: [right(-fte - rnp), right(-fte + rnp), right(-fte - 2 * rnp), right(-fte + 2 * rnp)],
        };
        placed.set(row, made);
        return made;
    };

    /** The whole path with its corridor, where it is known ahead of the aircraft. */
    const courseOf = (of: Model): Lines | null => {
        const { points } = of.snapshot!.session.origin;
        if (points.length < 2) return null;
        if (ahead !== null && ahead.on === on) return ahead.lines;
        const across = (m: number) => (p: [number, number, number, number]): Point => {
            const at = offset(p[0], p[1], m * p[3] * Math.cos(p[2]), -m * p[3] * Math.sin(p[2]));
            return on!.put(at.lat_rad, at.lon_rad);
        };
        const line = (m: number): Float64Array => Float64Array.from(points.map(across(m)).flat());
        ahead = { on: on!, lines: { track: new Float64Array(0), path: line(0), edges: [-1, 1, -2, 2].map(line) } };
        return ahead.lines;
    };

    const show = (of: Model, now_s: number): void => {
        [model, now] = [of, now_s];
        const [width, height] = [surface.clientWidth, surface.clientHeight];
        const pen = canvas.getContext("2d");
        if (pen === null || width === 0) return;
        if (canvas.width !== Math.round(width * devicePixelRatio) || canvas.height !== Math.round(height * devicePixelRatio)) [canvas.width, canvas.height] = [Math.round(width * devicePixelRatio), Math.round(height * devicePixelRatio)];
        pen.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
        pen.clearRect(0, 0, width, height);
        [view.width, view.height] = [width, height];
        const last = of.rows.findLast((row) => Number.isFinite(of.number("est_lat_rad", row)) && Number.isFinite(of.number("est_lon_rad", row)));
        if (last === undefined) {
            say(words, "No position is known.");
            return;
        }
        const [lat, lon] = [of.number("est_lat_rad", last), of.number("est_lon_rad", last)];
        if (on === null || !(Math.hypot(lat - middle_lat, (lon - middle_lon) * Math.cos(lat)) < FAR_RAD)) {
            [on, placed, middle_lat, middle_lon] = [plane(lat, lon), new WeakMap(), lat, lon];
        }
        const far = offset(lat, lon, 0, 1000);
        const unit = Math.hypot(...(on.put(far.lat_rad, far.lon_rad).map((v, i) => v - on!.put(lat, lon)[i]!) as Point)) / 1000;
        const rnp = of.number("rnp_m", last) || of.snapshot!.session.rnp_m;
        view.k = (magnified * height) / (CORRIDORS * rnp * unit);
        const at = put(last, of).track;
        [view.x, view.y] = [at[0] - moved[0] / view.k, at[1] - moved[1] / view.k];
        const known = courseOf(of);
        const lines = linesOf(of, put, known === null);
        const course = known ?? lines;
        stroke(pen, { colour: colour("limit"), width: 1, dash: [4, 4], alpha: 0.7 }, () => course.edges.slice(2).forEach((line) => trace(pen, view, line)));
        stroke(pen, { colour: colour("limit"), width: 1.5 }, () => course.edges.slice(0, 2).forEach((line) => trace(pen, view, line)));
        stroke(pen, { colour: colour("path"), width: 3, alpha: 0.7 }, () => trace(pen, view, course.path));
        stroke(pen, { colour: colour("ink"), width: 1.25 }, () => trace(pen, view, lines.track));
        for (const run of runsOf(of.words("alert"))) {
            if (run.label === null || run.label === "normal") continue;
            const style = run.label === "unavailable" ? { colour: colour("muted"), width: 2.5, dash: [2, 5] } : { colour: colour(severity(run.label) === 0 ? "warning" : "caution"), width: 3.5 };
            stroke(pen, style, () => trace(pen, view, lines.track, Math.max(0, run.from - 1), run.to));
        }
        const believed = of.believed(now_s) && last === of.rows.at(-1);
        const screen = toScreen(view, ...at);
        paintAircraft(pen, screen, Number.isFinite(of.number("course_rad", last)) ? of.number("course_rad", last) : 0, !believed);
        const scale = believed ? error(pen, of, last, screen, unit * view.k) : NaN;
        if (!believed) {
            pen.save();
            pen.globalAlpha = 0.5;
            pen.fillStyle = hatch(pen);
            pen.fillRect(0, 0, width, height);
            pen.restore();
        }
        label(pen, screen, of, last, now_s);
        scaleBar(bar, view, { plane: on });
        const where = present(of.freshness(now_s)) && believed ? place(lat, lon) : `Last position ${place(lat, lon)}`;
        const size = Number.isNaN(scale) ? "No error ellipse" : `${level(of.snapshot!.session.risk_accuracy)} error ellipse ${scale === 1 ? "to scale" : `magnified ${scale.toLocaleString("en")} times`}`;
        say(words, `${where}. ${size}.`);
        surface.dataset.scale = String(scale);
        surface.dataset.pxPerM = String(unit * view.k);
    };
    return { element, show, zoom, focus: () => surface.focus() };
}

/** The trail, and where no path is known ahead, the path and the corridor that were flown along. */
function linesOf(model: Model, put: (row: Row, of: Model) => Placed, corridor: boolean): Lines {
    const n = model.rows.length;
    const make = (): Float64Array => new Float64Array(2 * n);
    const [track, path, edges] = [make(), make(), [make(), make(), make(), make()]];
    model.rows.forEach((row, i) => {
        const at = put(row, model);
        [track[2 * i], track[2 * i + 1]] = at.track;
        if (!corridor) return;
        [path[2 * i], path[2 * i + 1]] = at.path;
        at.edges.forEach((edge, k) => { [edges[k]![2 * i], edges[k]![2 * i + 1]] = edge; });
    });
    return { track, path, edges };
}

/** The ellipse around the aircraft; returns by how much it is magnified, NaN without one. */
function error(pen: CanvasRenderingContext2D, model: Model, row: Row, at: [number, number], px_per_m: number): number {
    const e = ellipse(model.number("cov_ee_m2", row), model.number("cov_en_m2", row), model.number("cov_nn_m2", row), model.snapshot!.session.risk_accuracy);
    if (!(e.major_m > 0) || !Number.isFinite(e.minor_m)) return NaN;
    const scale = enlarge(e.major_m * px_per_m);
    const px = px_per_m * scale;
    stroke(pen, { colour: colour("m1"), width: 1.75 }, () => pen.ellipse(at[0], at[1], e.major_m * px, e.minor_m * px, -e.angle_rad, 0, 2 * Math.PI));
    return scale;
}

/** The name, and from two seconds on how old the position is. */
function label(pen: CanvasRenderingContext2D, at: [number, number], model: Model, row: Row, now_s: number): void {
    const age = row === model.rows.at(-1) ? model.age_s(now_s) : NaN;
    const name = model.snapshot!.track === null ? DASHES : plainName(model.snapshot!.track);
    const text = age < 2 ? name : `${name}  ${Number.isFinite(age) ? `${plain(age, 0)} s old` : "old position"}`;
    pen.save();
    pen.font = '600 12px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';
    pen.lineWidth = 4;
    pen.strokeStyle = colour("ground");
    pen.fillStyle = colour("ink");
    pen.textBaseline = "middle";
    pen.strokeText(text, at[0] + 16, at[1] - 14);
    pen.fillText(text, at[0] + 16, at[1] - 14);
    pen.restore();
}
