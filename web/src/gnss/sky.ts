// Where the satellites stood: their ways over the sky, and each at the cursor by what became of it.

import { rowAt, type Satellite } from "../data/heard.ts";
import type { Scene } from "../data/scene.ts";
import { el, svg, valueOf } from "../show/dom.ts";
import { clock, plain } from "../show/format.ts";
import { EXCLUDED, ofSolutions, systemOf, USED, wordsOf } from "./fates.ts";

const R = 200;
const ROOM = 26;
const DEG = 180 / Math.PI;

/** On a disc with the zenith in its middle and the horizon at its edge; east is right, as on a map. */
export function onDisc(az_rad: number, el_rad: number, radius: number): [number, number] {
    const r = radius * (1 - el_rad / (Math.PI / 2));
    return [r * Math.sin(az_rad), -r * Math.cos(az_rad)];
}

export function sky(host: HTMLElement, scene: Scene, satellites: Satellite[]): () => void {
    const moving = svg("g");
    const picture = svg("svg", { viewBox: `${-R - ROOM} ${-R - ROOM} ${2 * (R + ROOM)} ${2 * (R + ROOM)}`, "aria-hidden": "true" }, ...rings(), ...satellites.map(way), moving);
    const when = el("p", { class: "note" });
    const list = el("ul", { class: "sky-list" });
    const figure = el("figure", { class: "chart sky", id: "sky" }, el("div", { class: "chart-head" }, el("h3", {}, "Sky")),
        el("div", { class: "two" }, picture, el("div", {}, when, key(), list)));
    host.append(figure);
    const update = (epoch: number): void => {
        const heard = satellites.flatMap((of) => { const k = rowAt(of, epoch); return k < 0 ? [] : [{ of, k }]; });
        moving.replaceChildren(...heard.flatMap(({ of, k }) => (of.el_rad[k]! > 0 ? [mark(of, k)] : [])));
        const used = heard.filter(({ of, k }) => of.fate[k] === USED);
        const others = heard.filter(({ of, k }) => of.fate[k] !== USED);
        const of = ofSolutions(scene.payload) ? "" : ` of ${heard.length}`;
        when.replaceChildren(`${clock(scene.table.utc_s(epoch))} UTC: `, valueOf("n_used", used.length, String(used.length)), `${of} satellites${of === "" ? "" : " heard"} are in the position.`);
        list.replaceChildren(...others.map(({ of, k }) => el("li", {}, el("strong", {}, of.sv), `: ${wordsOf(scene.payload, of.fate[k]!)}${height(of.el_rad[k]!)}`)));
    };
    const end = scene.cursor.watch(update);
    return () => {
        end();
        figure.remove();
    };
}

function height(el_rad: number): string {
    return Number.isFinite(el_rad) ? `, elevation ${plain(el_rad * DEG, 0)}°` : "";
}

function rings(): SVGElement[] {
    const circles = [0, 30, 60].flatMap((deg) => [
        svg("circle", { r: R * (1 - deg / 90), class: "sky-ring" }),
        svg("text", { x: 4, y: -R * (1 - deg / 90) + 12, class: "sky-degrees" }, `${deg}°`),
    ]);
    const names = [["N", 0, -R - 8], ["E", R + 12, 4], ["S", 0, R + 18], ["W", -R - 12, 4]].map(([name, x, y]) => svg("text", { x: x as number, y: y as number, class: "sky-name" }, String(name)));
    return [svg("path", { d: `M0 ${-R} V${R} M${-R} 0 H${R}`, class: "sky-ring" }), ...circles, ...names];
}

/** The way of a satellite above the horizon; it breaks where it was not heard. */
function way(of: Satellite): SVGElement {
    let d = "";
    let last = -2;
    of.at.forEach((epoch, k) => {
        if (!(of.el_rad[k]! > 0)) return;
        const [x, y] = onDisc(of.az_rad[k]!, of.el_rad[k]!, R);
        d += `${d === "" || epoch - last > 20 ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`;
        last = epoch;
    });
    const { hue, dash } = systemOf(of.sv);
    return svg("path", { d, fill: "none", stroke: `var(--${hue})`, "stroke-width": 1, "stroke-dasharray": dash?.join(" "), opacity: 0.55 });
}

function mark(of: Satellite, k: number): SVGElement {
    const [x, y] = onDisc(of.az_rad[k]!, of.el_rad[k]!, R);
    const fate = of.fate[k];
    const shape = fate === USED ? svg("circle", { cx: x, cy: y, r: 5.5, fill: "var(--normal)" })
        : fate === EXCLUDED ? svg("path", { d: `M${x} ${y - 7} l7 12 h-14 z`, fill: "var(--caution)" })
        : svg("circle", { cx: x, cy: y, r: 5, fill: "var(--ground)", stroke: "var(--muted)", "stroke-width": 1.5 });
    return svg("g", {}, shape, svg("text", { x: x + 8, y: y + 4, class: "sky-sv" }, of.sv));
}

function key(): HTMLElement {
    const one = (shape: SVGElement, words: string): HTMLElement => el("span", { class: "key" }, svg("svg", { width: 14, height: 14, viewBox: "-7 -7 14 14", "aria-hidden": "true" }, shape), words);
    return el("p", { class: "map-legend note" },
        one(svg("circle", { r: 5, fill: "var(--normal)" }), "used"), one(svg("path", { d: "M0 -6 l6 11 h-12 z", fill: "var(--caution)" }), "excluded"),
        one(svg("circle", { r: 4.5, fill: "none", stroke: "var(--muted)", "stroke-width": 1.5 }), "not used"));
}
