// The map of a fleet on one canvas: aircraft without alerts small, those in alert last, larger and with their names.

import { el } from "../show/dom.ts";
import { colour } from "../show/theme.ts";
import { button } from "../show/dom.ts";
import { say } from "../live/parts.ts";
import { plainName } from "../live/state.ts";
import { tone, type Fleet, type Track } from "./state.ts";

const MOST_LABELS = 40;
const STEP_PX = 60;

export interface FleetMap {
    element: HTMLElement;
    show: (fleet: Fleet, now_s: number) => void;
    zoom: (factor: number) => void;
    focus: () => void;
    choose: (name: string) => void;
}

export function fleetMap(): FleetMap {
    const canvas = el("canvas", { "aria-hidden": "true" });
    const surface = el("div", { class: "map-surface", tabindex: 0, role: "application", "aria-roledescription": "map", "aria-label": "Map, north up: plus and minus zoom, arrows move, c shows all" }, canvas);
    const counts = el("p", { class: "map-words", role: "status" });
    const controls = el("div", { class: "map-controls", role: "group", "aria-label": "Map view" }, button("+", { "aria-label": "Zoom in" }, () => zoom(2)), button("−", { "aria-label": "Zoom out" }, () => zoom(0.5)), button("All", {}, () => all()));
    const element = el("section", { class: "live-map panel" }, el("div", { class: "events-head" }, el("h2", {}, "Map, north up"), controls), surface, counts);
    let box: [number, number, number, number] | null = null;
    let [magnified, moved] = [1, [0, 0] as [number, number]];
    let known: { fleet: Fleet; now_s: number } | null = null;
    let selected = "";

    const again = (): void => { if (known !== null) show(known.fleet, known.now_s); };
    const zoom = (factor: number): void => {
        magnified = Math.min(512, Math.max(1 / 8, magnified * factor));
        moved = [moved[0] * factor, moved[1] * factor];
        again();
    };
    const all = (): void => {
        [box, magnified, moved] = [null, 1, [0, 0]];
        again();
    };
    const pan = (dx: number, dy: number): void => {
        moved = [moved[0] + dx, moved[1] + dy];
        again();
    };
    surface.addEventListener("keydown", (e) => {
        const act: Record<string, () => void> = { ArrowLeft: () => pan(STEP_PX, 0), ArrowRight: () => pan(-STEP_PX, 0), ArrowUp: () => pan(0, STEP_PX), ArrowDown: () => pan(0, -STEP_PX), c: all };
        const move = act[e.key];
        if (move === undefined || e.ctrlKey || e.metaKey || e.altKey) return;
        e.preventDefault();
        move();
    });

    const show = (fleet: Fleet, now_s: number): void => {
        known = { fleet, now_s };
        const placed = [...fleet.tracks.values()].filter((track) => Number.isFinite(track.lat_rad) && Number.isFinite(track.lon_rad));
        box ??= placed.length > 0 ? bounds(placed) : null;
        const [width, height] = [surface.clientWidth, surface.clientHeight];
        const dense = devicePixelRatio || 1;
        [canvas.width, canvas.height] = [Math.round(width * dense), Math.round(height * dense)];
        const on = canvas.getContext("2d")!;
        on.scale(dense, dense);
        const n = { warning: 0, caution: 0, normal: 0 };
        for (const track of fleet.tracks.values()) n[tone(track)] += 1;
        say(counts, `${n.warning} in warning, ${n.caution} in caution or unavailable, ${n.normal} normal${placed.length < fleet.tracks.size ? `; ${fleet.tracks.size - placed.length} without a place` : ""}`);
        if (box === null || width === 0) return;
        const [south, north, west, east] = box;
        const shrunk = Math.cos((south + north) / 2);
        const k = magnified * 0.94 * Math.min(height / (north - south), width / ((east - west) * shrunk));
        const put = (track: Track): [number, number] => [width / 2 + moved[0] + (track.lon_rad - (west + east) / 2) * shrunk * k, height / 2 + moved[1] - (track.lat_rad - (south + north) / 2) * k];
        const draw = (of: "normal" | "caution" | "warning", size: number, css: string): void => {
            on.strokeStyle = on.fillStyle = css;
            let labels = 0;
            for (const track of placed) {
                if (tone(track) !== of) continue;
                const [x, y] = put(track);
                if (x < -9 || y < -9 || x > width + 9 || y > height + 9) continue;
                on.beginPath();
                if (of === "normal") on.rect(x - size, y - size, 2 * size, 2 * size);
                else if (of === "warning") { on.moveTo(x, y - size); on.lineTo(x + size, y + size); on.lineTo(x - size, y + size); on.closePath(); }
                else { on.moveTo(x, y - size); on.lineTo(x + size, y); on.lineTo(x, y + size); on.lineTo(x - size, y); on.closePath(); }
                // Hollow: where it was last, and not where it is.
                if (of === "normal" || fleet.believed(track, now_s)) on.fill();
                else on.stroke();
                if ((of !== "normal" && labels < MOST_LABELS) || track.name === selected) {
                    labels += 1;
                    on.fillText(plainName(track.name), x + size + 3, y + 4);
                }
            }
        };
        on.font = "11px system-ui, sans-serif";
        on.lineWidth = 1.5;
        draw("normal", 1.5, colour("muted"));
        draw("caution", 4.5, colour("caution"));
        draw("warning", 6, colour("warning"));
    };
    const choose = (name: string): void => {
        selected = name;
        again();
    };
    return { element, show, zoom, focus: () => surface.focus(), choose };
}

/** Latitudes and longitudes that hold all but the outermost hundredth on each side. */
function bounds(tracks: Track[]): [number, number, number, number] {
    const side = (values: number[]): [number, number] => {
        const sorted = values.sort((a, b) => a - b);
        const at = (share: number): number => sorted[Math.round(share * (sorted.length - 1))]!;
        const [least, most] = [at(0.01), at(0.99)];
        const middle = (least + most) / 2;
        const half = Math.max((most - least) / 2, 0.002);
        return [middle - half, middle + half];
    };
    return [...side(tracks.map((track) => track.lat_rad)), ...side(tracks.map((track) => track.lon_rad))];
}
