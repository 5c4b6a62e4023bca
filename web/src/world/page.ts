// The page of a map: what was found, the map, its numbers, what it rests on.

import { inflate } from "../data/packing.ts";
import { button, choice, el, setValue, valueOf } from "../show/dom.ts";
import { count, plain, share } from "../show/format.ts";
import { choose, colour, themeStore, type Choice } from "../show/theme.ts";
import { areas, classes, NONE_WORDS } from "./classes.ts";
import { cellAt, centre, NARROW, picture, WIDE } from "./draw.ts";
import { drawIsolines, HALO, isolines, sample } from "./isolines.ts";
import { figure, leave, type Key } from "./leave.ts";
import { layers, type Layer, type MapSummary, type World } from "./records.ts";

/** Below this the labels of the picture could not be read. */
const NARROW_PX = 700;

export async function showWorld(root: HTMLElement, world: World): Promise<void> {
    const { summary } = world;
    const all = layers(world, await inflate(document.getElementById("navbound-track-0")!.textContent!));
    const theme = choice<Choice>("Theme", [["auto", "Auto"], ["light", "Light"], ["dark", "Dark"]], "auto", choose);
    root.replaceChildren(
        el("header", {}, el("div", { class: "title" }, el("p", { class: "brand" }, "navbound"), el("h1", {}, summary.title)), el("div", { class: "head-tools" }, theme), findings(summary)),
        mapPart(world, all), numbers(summary), basis(world));
    root.dataset.ready = "true";
}

function findings(summary: MapSummary): HTMLElement {
    const fact = (at: number, value: number): HTMLElement => el("div", { class: "fact" }, el("dt", {}, `Area with at least ${100 * at} % of the time`), el("dd", {}, valueOf(`coverage_${at}`, value, share(value))));
    const facts = summary.n_epochs === 1
        ? [el("div", { class: "fact" }, el("dt", {}, "Area within the limit"), el("dd", {}, valueOf("coverage", summary.available_mean, share(summary.available_mean))))]
        : summary.coverage.map((c) => fact(c.available, c.share));
    return el("div", { id: "verdict-place" }, el("section", { class: "verdict" }, el("p", { class: "words" }, summary.words), el("dl", { class: "facts" }, ...facts)));
}

function mapPart(world: World, all: Layer[]): HTMLElement {
    const { grid } = world.summary;
    const select = el("select", { id: "layer", "aria-label": "What the map shows" }, ...all.map((l) => el("option", { value: l.id }, l.title)));
    const surface = el("div", { class: "world-surface", tabindex: 0, role: "group", "aria-label": "Map; the arrow keys move from cell to cell" });
    const legend = el("div", { class: "world-legend" });
    const lined = el("input", { type: "checkbox", id: "isolines", checked: true });
    const linedLabel = el("label", { class: "selector" }, lined, " Lines");
    const meaning = el("p", { class: "world-meaning" });
    const readout = el("p", { class: "world-readout", "aria-live": "polite" });
    const value = valueOf("cell", null, "");
    const where = el("span", {});
    readout.append(where, " ", value);
    let cell = { row: Math.floor(grid.n_lat / 2), column: Math.floor(grid.n_lon / 2) };
    const margins = (): typeof WIDE => (innerWidth < NARROW_PX ? NARROW : WIDE);
    const current = (): Layer => all.find((l) => l.id === select.value) ?? all[0]!;

    const read = (): void => {
        const at = current().values[cell.row * grid.n_lon + cell.column]!;
        where.textContent = `${centre(grid.south_rad + (cell.row + 0.5) * grid.step_rad, grid.west_rad + (cell.column + 0.5) * grid.step_rad)}:`;
        setValue(value, at, shown(current(), at));
    };
    const colours = (): { ink: string; muted: string; ground: string; none: string } => ({ ink: colour("ink"), muted: colour("muted"), ground: colour("ground"), none: colour("s5") });
    const drawn = (layer: Layer, room: typeof WIDE): { drawing: SVGSVGElement; keys: Key[] } => {
        const sorted = classes(layer);
        const parts = areas(layer, sorted, grid);
        const all = [...sorted.map((c) => ({ fill: c.fill, words: c.words })), { fill: colours().none, words: NONE_WORDS }];
        const keys: Key[] = all.map((c, i) => ({ ...c, share: parts[i]! })).filter((c) => c.share > 0).map(({ fill, words, share: part }) => ({ fill, words, part: share(part) }));
        const drawing = picture(layer, sorted, grid, world.coastline, colours(), room);
        const lines = lined.checked ? isolines(layer, grid) : [];
        drawing.append(...drawIsolines(lines, grid, room));
        return { drawing, keys: [...keys, ...lines.map(({ words, dashes }) => ({ fill: HALO, words: `line of ${words}`, part: "", dashes }))] };
    };
    const draw = (): void => {
        const layer = current();
        const { drawing, keys } = drawn(layer, margins());
        drawing.setAttribute("aria-label", `${layer.title}. ${keys.map((k) => (k.dashes === undefined ? `${k.words}: ${k.part} of the area` : k.words)).join("; ")}`);
        surface.replaceChildren(drawing);
        linedLabel.hidden = isolines(layer, grid).length === 0;
        const between = keys.some((k) => k.dashes !== undefined) ? "; lines between the middles of the cells, linear" : "";
        meaning.textContent = `${headed(layer)}; beside each colour its share of the area${between}`;
        legend.replaceChildren(...keys.map((k) => (k.dashes === undefined
            ? el("span", { class: "world-key" }, el("i", { style: `background:${k.fill}` }), k.words, el("span", { class: "also" }, k.part))
            : el("span", { class: "world-key world-line" }, sample(k.dashes), k.words))));
        read();
    };
    const point = (event: PointerEvent): void => {
        const box = surface.firstElementChild!.getBoundingClientRect();
        const hit = cellAt((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height, grid, margins());
        if (hit !== null) { cell = hit; read(); }
    };
    surface.addEventListener("pointermove", point);
    surface.addEventListener("pointerdown", point);
    surface.addEventListener("keydown", (event) => {
        const move = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
        if (move === undefined) return;
        event.preventDefault();
        cell = { row: Math.min(grid.n_lat - 1, Math.max(0, cell.row + move[0]!)), column: (cell.column + move[1]! + grid.n_lon) % grid.n_lon };
        read();
    });
    select.addEventListener("change", draw);
    lined.addEventListener("change", draw);
    matchMedia(`(width < ${NARROW_PX}px)`).addEventListener("change", draw);
    // A file is read on a desk: it has the wide margins, whatever screen it was saved on.
    const save = (kind: "svg" | "png"): void => {
        const { drawing, keys } = drawn(current(), WIDE);
        void leave(figure(drawing, keys, { title: world.summary.title, layer: headed(current()), colours: colours() }), `${world.summary.kind}-${current().id}`, kind);
    };
    themeStore().watch(draw);
    return el("section", { id: "world", class: "chart" },
        el("div", { class: "chart-head" }, el("h2", {}, "Map"), el("div", { class: "map-controls" }, el("label", { class: "selector" }, "Shown ", select), linedLabel, button("Save PNG", {}, () => save("png")), button("Save SVG", {}, () => save("svg")))),
        surface, meaning, legend, readout);
}

/** What a layer shows, in which unit. */
function headed(layer: Layer): string {
    return layer.unit === "%" ? `${layer.title} [% of the time]` : layer.unit === "m" ? `${layer.title} [m]` : layer.title;
}

function shown(layer: Layer, value: number): string {
    if (!Number.isFinite(value)) return NONE_WORDS;
    if (layer.unit === "%") return share(value / 100);
    return layer.unit === "m" ? `${plain(value, value < 100 ? 1 : 0)} m` : plain(value, 2);
}

function numbers(summary: MapSummary): HTMLElement {
    const unit = (u: string): string => (u === "1" ? "" : ` ${u}`);
    const heads = summary.n_epochs === 1 ? ["value"] : summary.percentiles.map((p) => `${p} % of the time`);
    const keys = summary.n_epochs === 1 ? [""] : summary.percentiles.map(String);
    const rows = summary.columns.map((c) => el("tr", {}, el("th", { scope: "row" }, c.title),
        ...keys.map((key) => valueOf(`${c.name}_${key}`, c.typical[key] ?? null, c.typical[key] == null ? NONE_WORDS : `${plain(c.typical[key]!, 2)}${unit(c.unit)}`, "td"))));
    const caption = "Half of the area is within";
    const table = el("table", {}, el("caption", { class: "sr" }, caption), el("thead", {}, el("tr", {}, el("th", {}, "quantity"), ...heads.map((h) => el("th", { scope: "col" }, h)))), el("tbody", {}, ...rows));
    const outcomes = summary.outcomes.filter((o) => o.share > 0).map((o) => el("tr", {}, el("th", { scope: "row" }, o.title), valueOf(`outcome_${o.name}`, o.share, share(o.share), "td")));
    const what = summary.n_epochs === 1 ? "Share of the area" : "Share of time and area";
    const limits = summary.limits.map((l) => el("li", {}, `${summary.columns.find((c) => c.name === l.column)?.title ?? l.column}: at most ${plain(l.limit, l.limit % 1 === 0 ? 0 : 2)}${unit(summary.columns.find((c) => c.name === l.column)?.unit ?? "1")} · ${l.source} · `, el("strong", {}, l.provenance)));
    return el("section", { id: "numbers" }, el("h2", {}, "Numbers"), el("div", { class: "table-box" }, el("p", { class: "table-title", "aria-hidden": "true" }, caption), el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": caption }, table)),
        el("div", { class: "table-box" }, el("p", { class: "table-title", "aria-hidden": "true" }, what), el("table", {}, el("caption", { class: "sr" }, what), el("tbody", {}, ...outcomes))), el("h3", {}, "Limits"), el("ul", {}, ...limits));
}

function basis(world: World): HTMLElement {
    const { summary, record } = world;
    const entry = (name: string, text: string): HTMLElement[] => [el("dt", {}, name), el("dd", {}, text)];
    const options = Object.entries(record.options).map(([name, value]) => `${name} = ${value}`).join(", ");
    const inputs = Object.entries(record.inputs).map(([path, sha]) => el("li", {}, `${path} · SHA-256 `, el("code", {}, sha)));
    return el("section", { class: "small-print", id: "run" }, el("h2", {}, "What it rests on"),
        el("ul", {}, ...summary.assumptions.map((a) => el("li", {}, a))),
        el("dl", {}, ...entry("navbound", record.navbound_version), ...entry("Command", record.command || "none: made from Python"), ...entry("Created", record.created_utc), ...entry("Source", summary.source),
            ...entry("Grid", `${count(summary.grid.n_lat)} × ${count(summary.grid.n_lon)} cells; area by the cosine of the latitude`), ...entry("Options", options), ...entry("Tiles", `${count(record.n_tiles)}, ${record.backend}`),
            ...(world.left_out.length === 0 ? [] : entry("Not on this page", `${world.left_out.join(", ")}: in map.parquet beside it`)), ...entry("Platform", record.platform), ...entry("Coastline", "Natural Earth 1:50m, public domain; not for navigation")),
        inputs.length > 0 ? el("ul", {}, ...inputs) : null);
}
