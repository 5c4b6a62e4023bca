// The map: coast, route, tunnel to scale, the track by alert state, and the aircraft with its error at the cursor.

import { METRES_PER_NM, type Scene } from "../data/scene.ts";
import type { Ground } from "../data/others.ts";
import { missing } from "../chart/missing.ts";
import { button, el, freshId } from "../show/dom.ts";
import { level, nauticalMiles, place, wholeMetres } from "../show/format.ts";
import { metresPerRadian, roundDown } from "./geometry.ts";
import { paintCursor, paintStill, pixelsPerMetre, toScreen, type Flown, type View } from "./paint.ts";
import { shapes as shapesOf, type Shapes } from "./shapes.ts";
import { gestures } from "./gestures.ts";

const CLOSEST_PX_PER_M = 40;

export function map(host: HTMLElement, scene: Scene): () => void {
    const shapes = shapesOf(scene);
    if (shapes === null) return missing(host, "Map", "No position could be drawn.");
    const title = freshId("map");
    const still = el("canvas");
    const moving = el("canvas");
    const surface = el("div", { class: "map-surface", tabindex: 0, role: "application", "aria-roledescription": "map", "aria-labelledby": title, "aria-describedby": `${title}-help` }, still, moving);
    const otherKey = el("span", { class: "key" }, el("i", { class: "key-others" }), "other tracks");
    const bar = el("div", { class: "map-scale", "aria-hidden": "true" });
    const words = el("p", { class: "map-words" });
    surface.append(bar);
    const view: View = { x: 0, y: 0, k: 1, width: 0, height: 0 };
    let fitted = 1;
    let others: Flown[] = [];

    const paint = (): void => {
        const pen = begun(still, view);
        if (pen === null) return;
        paintStill(pen, view, shapes, others, scene);
        scaleBar(bar, view, shapes);
        move();
    };
    const move = (): void => {
        const pen = begun(moving, view);
        if (pen === null) return;
        words.textContent = sentence(scene, paintCursor(pen, view, shapes, scene));
        surface.dataset.k = String(view.k);
    };
    const whole = (): void => {
        const { x0, y0, x1, y1 } = shapes.bounds;
        [view.x, view.y] = [(x0 + x1) / 2, (y0 + y1) / 2];
        view.k = fitted = Math.min((view.width - 90) / Math.max(x1 - x0, 1e-9), (view.height - 60) / Math.max(y1 - y0, 1e-9), 5e8);
        paint();
    };
    const zoom = (factor: number, px = view.width / 2, py = view.height / 2): void => {
        const most = (CLOSEST_PX_PER_M * view.k) / pixelsPerMetre(view, shapes, scene.cursor.get(), scene);
        const k = Math.min(Math.max(view.k * factor, fitted / 8), Number.isFinite(most) ? most : view.k);
        const [dx, dy] = [px - view.width / 2, py - view.height / 2];
        view.x += dx / view.k - dx / k;
        view.y += dy / view.k - dy / k;
        view.k = k;
        paint();
    };
    const pan = (dx: number, dy: number): void => {
        view.x -= dx / view.k;
        view.y -= dy / view.k;
        paint();
    };
    const toCursor = (span_m: number): void => {
        const i = scene.cursor.get();
        if (!Number.isFinite(shapes.track[2 * i]!)) return;
        [view.x, view.y] = [shapes.track[2 * i]!, shapes.track[2 * i + 1]!];
        view.k *= view.height / (span_m * pixelsPerMetre(view, shapes, i, scene));
        paint();
    };
    // Twice RNP on both sides, with a little room.
    const toTunnel = (): void => toCursor(5 * (scene.table.value("rnp_m", scene.cursor.get()) || 2000));
    const pick = (px: number, py: number): void => {
        const i = nearest(shapes, view, px, py);
        if (i !== null) scene.cursor.set(i);
    };
    const controls = el("div", { class: "map-controls", role: "group", "aria-label": "Map view" },
        button("+", { "aria-label": "Zoom in" }, () => zoom(2)), button("−", { "aria-label": "Zoom out" }, () => zoom(0.5)),
        button("Whole route", {}, whole), shapes.tunnel === null ? null : button("Tunnel at cursor", {}, toTunnel), button("Error at cursor", {}, () => toCursor(5 * errorSize(scene))));
    const figure = el("figure", { class: "chart map", id: "map" }, el("div", { class: "chart-head" }, el("h3", { id: title }, "Map"), controls), surface, words, legend(scene, shapes, otherKey),
        el("p", { class: "sr", id: `${title}-help` }, "Arrow keys move the map, plus and minus zoom, 0 shows the whole route, c goes to the cursor. The position at the cursor is given as text below the map."));
    host.append(figure);

    const resize = (anew = false): void => {
        const [width, height] = [surface.clientWidth, surface.clientHeight];
        if (width === 0 || (!anew && width === view.width && height === view.height)) return;
        const first = view.width === 0 || view.k === fitted;
        [view.width, view.height] = [width, height];
        for (const canvas of [still, moving]) [canvas.width, canvas.height] = [Math.round(width * devicePixelRatio), Math.round(height * devicePixelRatio)];
        if (first) whole();
        else paint();
    };
    const showOthers = (grounds: Ground[]): void => {
        others = grounds.filter((g) => g.track !== scene.table.track).map((g) => ({ line: shapes.put(g.lat_rad, g.lon_rad), breaks: new Set(g.breaks) }));
        surface.dataset.others = String(others.length);
        otherKey.hidden = others.length === 0;
        if (others.length > 0) paint();
    };
    const observer = new ResizeObserver(() => resize());
    observer.observe(surface);
    resize();
    const ends = [gestures(surface, { zoom, pan, pick, whole, toCursor: toTunnel }), scene.cursor.watch(move), scene.theme.watch(() => { resize(true); }), scene.grounds.watch(showOthers)];
    return () => {
        ends.forEach((end) => end());
        observer.disconnect();
        figure.remove();
    };
}

/** An empty canvas. What is cleared while paper is laid out is cleared through to the sheet: there a canvas is drawn once, when it is new. */
function begun(canvas: HTMLCanvasElement, view: View): CanvasRenderingContext2D | null {
    const pen = canvas.getContext("2d");
    if (pen === null || view.width === 0) return null;
    pen.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    if (!document.documentElement.classList.contains("printing")) pen.clearRect(0, 0, view.width, view.height);
    return pen;
}

function errorSize(scene: Scene): number {
    const i = scene.cursor.get();
    const sigma = Math.sqrt(scene.table.value("cov_ee_m2", i) + scene.table.value("cov_nn_m2", i));
    if (!Number.isFinite(sigma)) return 50;
    // Both circles fit the view: their diameter is less than twice the room.
    const circles = (["hal_m", "hpl_m"] as const).map((name) => 0.6 * scene.table.value(name, i)).filter(Number.isFinite);
    return Math.max(2.5 * sigma, 0.5, ...circles);
}

function nearest(shapes: Shapes, view: View, px: number, py: number): number | null {
    let best: number | null = null;
    let least = 26 ** 2;
    for (let i = 0; i < shapes.track.length / 2; i++) {
        const [x, y] = toScreen(view, shapes.track[2 * i]!, shapes.track[2 * i + 1]!);
        const d = (x - px) ** 2 + (y - py) ** 2;
        if (d < least) [best, least] = [i, d];
    }
    return best;
}

export function scaleBar(bar: HTMLElement, view: View, shapes: Pick<Shapes, "plane">): void {
    const a = shapes.plane.back(view.x - 50 / view.k, view.y);
    const b = shapes.plane.back(view.x + 50 / view.k, view.y);
    const middle = shapes.plane.back(view.x, view.y);
    const per = metresPerRadian(middle.lat_rad);
    const turn = b.lon_rad - a.lon_rad - 2 * Math.PI * Math.round((b.lon_rad - a.lon_rad) / (2 * Math.PI));
    const metresPerPixel = Math.hypot(turn * per.east, (b.lat_rad - a.lat_rad) * per.north) / 100;
    if (!(metresPerPixel > 0)) return;
    // Up to one mile in metres, beyond in nautical miles.
    const unit = metresPerPixel * 120 > METRES_PER_NM ? METRES_PER_NM : 1;
    const length = roundDown((120 * metresPerPixel) / unit) * unit;
    bar.style.width = `${length / metresPerPixel}px`;
    bar.textContent = unit === 1 ? wholeMetres(length) : nauticalMiles(length, length < METRES_PER_NM ? 1 : 0);
}

function sentence(scene: Scene, exaggeration: number): string {
    const i = scene.cursor.get();
    const where = place(scene.table.value("est_lat_rad", i), scene.table.value("est_lon_rad", i));
    if (!Number.isFinite(exaggeration)) return `${where}. No error ellipse at this epoch.`;
    const size = exaggeration === 1 ? "to scale" : `drawn ${exaggeration.toLocaleString("en")} times its size`;
    return `${where}. ${level(scene.payload.record.risk_accuracy)} error ellipse ${size}.`;
}

function legend(scene: Scene, shapes: Shapes, otherKey: HTMLElement): HTMLElement {
    const alerts = new Set(scene.table.wordColumn("alert") ?? []);
    const keys: [string, string][] = [["track", alerts.size > 0 ? "track, normal" : "track"]];
    if (alerts.has("caution")) keys.push(["caution", "caution ▲"]);
    if (alerts.has("warning")) keys.push(["warning", "warning ■"]);
    if (alerts.has("unavailable")) keys.push(["unavailable", "unavailable"]);
    if (shapes.path !== null) keys.push(["path", "active path"]);
    if (shapes.tunnel !== null) keys.push(["one", "±RNP, to scale"], ["two", "±2 RNP"]);
    if (scene.table.has("cov_ee_m2")) keys.push(["ellipse", "error ellipse"]);
    if (scene.table.has("anp_circle_m")) keys.push(["circle", "ANP circle"]);
    if (scene.table.has("hal_m")) keys.push(["hpl", "protection level"], ["hal", `alert limit (${[...new Set(scene.payload.summary.protection.map((p) => p.hal_held))].join(", ")})`]);
    if (scene.table.has("nse_e_m")) keys.push(["truth", "true position ×"]);
    const why = shapes.tunnel === null ? el("span", { class: "note" }, "No path: no tunnel.") : null;
    return el("figcaption", { class: "map-legend" }, ...keys.map(([kind, name]) => el("span", { class: "key" }, el("i", { class: `key-${kind}` }), name)), otherKey, why);
}
