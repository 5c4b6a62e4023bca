// The ionospheric grid of an augmentation service on a map: the GIVE of each point as it stood at the cursor.

import type { Cursor } from "../data/link.ts";
import type { Payload } from "../data/records.ts";
import type { GridPoint, ServiceLog } from "../records.gen.ts";
import { el, svg, valueOf } from "../show/dom.ts";
import { clock, count, degrees, duration } from "../show/format.ts";
import { coast, frame, graticule, labels, NARROW, placed, WIDE, type Margins } from "../world/draw.ts";
import type { MapGrid } from "../world/records.ts";
import { binAt, CLASSES, DO_NOT_USE, indicatorOf, NOT_MONITORED, stateWords, tally, UNKNOWN } from "./gridstates.ts";

const RAD = Math.PI / 180;
const STEP_DEG = 5;
/** Below this width of the page the numbers in the points could not be read. */
const NARROW_PX = 700;

export function gridMap(log: ServiceLog, payload: Payload, at: Cursor): HTMLElement | null {
    const map = payload.service_map;
    if (map == null || log.grid.length === 0) return null;
    const [south, west, north, east] = map.region_deg;
    const region: MapGrid = {
        step_rad: STEP_DEG * RAD, south_rad: south * RAD, west_rad: west * RAD, north_rad: north * RAD, east_rad: east * RAD,
        n_lat: Math.round((north - south) / STEP_DEG), n_lon: Math.round((east - west) / STEP_DEG),
    };
    const surface = el("div", { class: "grid-surface" });
    const when = el("p", { class: "note" });
    const legend = el("p", { class: "map-legend note" });
    const rows = el("tbody");
    const numbers = el("details", { class: "numbers" }, el("summary", {}, "Numbers"), el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Points of the grid at the cursor" },
        el("table", {}, el("caption", { class: "sr" }, "Points of the grid at the cursor"), el("thead", {}, el("tr", {}, el("th", { scope: "col" }, "Point"), el("th", { scope: "col", class: "words" }, "State"))), rows)));
    let bin: number | null | undefined;
    let narrow: boolean | undefined;
    const draw = (): void => {
        const utc_s = at.table.utc_s(at.cursor.get()) + at.width_s / 2;
        const [next, small] = [binAt(log, (utc_s - payload.gps_epoch_unix_s + payload.utc_offset_s) * 1e9), innerWidth < NARROW_PX];
        if (next === bin && small === narrow) return;
        [bin, narrow] = [next, small];
        const states = log.grid.map((point) => (next === null ? UNKNOWN : point.states[next] ?? UNKNOWN));
        const parts = tally(states).filter(({ n }) => n > 0);
        const spoken = parts.map(({ words, n }) => `${words}: ${count(n)}`).join("; ");
        surface.replaceChildren(picture(log.grid, states, region, map.coastline, small ? NARROW : WIDE, small, spoken));
        const end_s = (log.first_ns + ((next ?? 0) + 1) * log.bin_ns) / 1e9 + payload.gps_epoch_unix_s - payload.utc_offset_s;
        const time = next === null ? "No message of the log is of the time under the cursor." : `At ${clock(end_s)} UTC, the end of the ${duration(log.bin_ns / 1e9)} under the cursor.`;
        when.replaceChildren(time);
        legend.replaceChildren(...parts.map(({ key, words, n }) => el("span", { class: "key" }, svg("svg", { width: 16, height: 16, viewBox: "-8 -8 16 16", "aria-hidden": "true" }, ...mark(signOf(key), 6.5)), words, " ", valueOf(`grid_${key}`, n, count(n)))));
        fill();
    };
    const fill = (): void => {
        if (!numbers.open) return;
        rows.replaceChildren(...log.grid.map((point) => el("tr", {}, el("th", { scope: "row" }, nameOf(point)), el("td", { class: "words" }, stateWords(bin == null ? UNKNOWN : point.states[bin] ?? UNKNOWN)))));
    };
    numbers.addEventListener("toggle", fill);
    matchMedia(`(width < ${NARROW_PX}px)`).addEventListener("change", draw);
    at.cursor.watch(draw);
    return el("figure", { class: "chart", id: "grid-map" }, el("div", { class: "chart-head" }, el("h3", {}, "The grid on a map")),
        el("figcaption", {}, "GIVE of each point of the grid: 99.9 % of the error of the vertical delay on L1, by its indicator, which stands in the point where there is room (RTCA DO-229, standard)."), when, surface, legend, numbers);
}

/** A state of the class, for the legend. */
function signOf(key: string): string {
    const k = Number(key);
    return key === "" || Number.isNaN(k) ? key : CLASSES[k]!.upTo.toString(16).toUpperCase();
}

function nameOf(point: GridPoint): string {
    const short = (text: string): string => text.replace(/\.0+°/, "°");
    return `${short(degrees(point.lat_rad, "N", "S"))}, ${short(degrees(point.lon_rad, "E", "W"))}`;
}

/** What stands at a point, around the origin: red is kept for what must not be used. */
function mark(state: string, r: number): SVGElement[] {
    const indicator = indicatorOf(state);
    if (indicator !== null) return [svg("circle", { r, fill: CLASSES.find((each) => indicator <= each.upTo)!.fill, class: "grid-point" })];
    if (state === NOT_MONITORED) return [svg("circle", { r: 0.7 * r, class: "grid-idle" })];
    if (state === DO_NOT_USE) return [svg("path", { d: `M${-0.7 * r} ${-0.7 * r}L${0.7 * r} ${0.7 * r}M${-0.7 * r} ${0.7 * r}L${0.7 * r} ${-0.7 * r}`, class: "grid-stop" })];
    return [svg("circle", { r: 0.25 * r, class: "grid-unknown" })];
}

function picture(points: GridPoint[], states: string[], region: MapGrid, coastline: number[][], margins: Margins, small: boolean, spoken: string): SVGSVGElement {
    const f = frame(region);
    const p = placed(region, margins);
    const [width, height] = [f.width * f.squeeze * p.k, f.height * p.k];
    const top = p.bottom - height;
    const place = { transform: `translate(${p.left} ${top}) scale(${p.k * f.squeeze} ${p.k})`, "vector-effect": "non-scaling-stroke", fill: "none" };
    const net = graticule(region, labels(width, margins.font));
    const r = Math.min(0.4 * Math.min(p.cellWidth, p.cellHeight), 18);
    const drawn = points.map((point, i) => {
        // The region may begin west of the antimeridian.
        const lon = f.west + ((((point.lon_rad / RAD - f.west) % 360) + 360) % 360);
        const [x, y] = [p.left + (lon - f.west) * f.squeeze * p.k, top + (f.north - point.lat_rad / RAD) * p.k];
        const indicator = indicatorOf(states[i]!);
        const number = indicator === null || small || r < 9 ? [] : [svg("text", { y: 0.33 * margins.font, "text-anchor": "middle", "font-size": margins.font, "font-weight": 600, fill: CLASSES.find((each) => indicator <= each.upTo)!.ink }, String(indicator))];
        return svg("g", { transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})`, "data-state": states[i]! }, svg("title", {}, `${nameOf(point)}: ${stateWords(states[i]!)}`), ...mark(states[i]!, r), ...number);
    });
    const text = net.labels.map((l) => svg("text", {
        x: p.left + l.x * p.k * f.squeeze - (l.across ? 0 : 5), y: top + l.y * p.k + margins.font * (l.across ? 1.4 : 0.36), class: "grid-degrees", "font-size": margins.font,
        "text-anchor": !l.across || l.x > 0.97 * f.width ? "end" : "middle",
    }, l.text));
    return svg("svg", { viewBox: `0 0 1000 ${(p.bottom + margins.bottom).toFixed(1)}`, role: "img", "aria-label": `Points of the grid. ${spoken}` },
        svg("clipPath", { id: "grid-region" }, svg("rect", { x: p.left, y: top, width, height })),
        svg("path", { d: net.path, class: "grid-net", ...place }),
        svg("g", { "clip-path": "url(#grid-region)" }, svg("path", { d: coast(coastline, region), class: "grid-coast", ...place })),
        svg("rect", { x: p.left, y: top, width, height, class: "grid-frame" }), ...drawn, ...text);
}
