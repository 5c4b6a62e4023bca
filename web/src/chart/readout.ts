// The values of a chart's lines at the cursor, and all its numbers as a table for those who do not see the picture.

import { el, setValue, svg, valueOf } from "../show/dom.ts";
import type { Line } from "./strip.ts";

export function swatch(line: { colour: string; dash?: number[]; width?: number }): SVGElement {
    return svg("svg", { class: "swatch", width: 24, height: 8, viewBox: "0 0 24 8", "aria-hidden": "true" },
        svg("line", { x1: 0, y1: 4, x2: 24, y2: 4, stroke: `var(--${line.colour})`, "stroke-width": Math.max(1.5, line.width ?? 1.5), "stroke-dasharray": line.dash?.join(" ") }));
}

/** A word that goes with the values at the cursor. */
export interface Word {
    key: string;
    label: string;
    of: (i: number) => string | null;
    text: (word: string | null) => string;
}

/** One button a line: its name, its value at the cursor; pressing it hides or shows the line. Lines hidden at first are folded away. */
export function readout(lines: Line[], visible: Set<string>, show: (value: number, line: Line) => string, changed: () => void, words: Word[] = []): { element: HTMLElement; update: (i: number) => void } {
    const cells = new Map<string, HTMLElement>();
    const first = el("div", { class: "readout" });
    const rest = el("div", { class: "readout" });
    for (const line of lines) {
        const cell = valueOf(line.key, null, "");
        cells.set(line.key, cell);
        const chip = el("button", { type: "button", class: "chip", "aria-pressed": String(visible.has(line.key)), title: line.about ?? "" },
            swatch(line), el("span", { class: "chip-name" }, line.mirror ? `±${line.label}` : line.label), cell);
        chip.addEventListener("click", () => {
            if (visible.has(line.key)) visible.delete(line.key);
            else visible.add(line.key);
            chip.setAttribute("aria-pressed", String(visible.has(line.key)));
            changed();
        });
        (visible.has(line.key) ? first : rest).append(chip);
    }
    const chips = words.map((word) => ({ word, cell: valueOf(word.key, null, "") }));
    first.append(...chips.map(({ word, cell }) => el("span", { class: "chip" }, el("span", { class: "chip-name" }, word.label), cell)));
    const n = rest.childElementCount;
    const more = n === 0 ? null : el("details", { class: "more-lines" }, el("summary", {}, `${n} more ${n === 1 ? "line" : "lines"}`), rest);
    const element = el("div", {}, first, more);
    const update = (i: number): void => {
        for (const { word, cell } of chips) setValue(cell, word.of(i), word.text(word.of(i)));
        for (const line of lines) {
            const v = line.values[i] ?? NaN;
            setValue(cells.get(line.key)!, v, show(v, line));
        }
    };
    return { element, update };
}

interface Stated {
    n: number;
    low: number;
    mean: number;
    high: number;
}

function state(values: Float64Array): Stated {
    let [n, low, sum, high] = [0, Infinity, 0, -Infinity];
    for (const v of values) {
        if (!Number.isFinite(v)) continue;
        n += 1;
        sum += v;
        if (v < low) low = v;
        if (v > high) high = v;
    }
    return n === 0 ? { n, low: NaN, mean: NaN, high: NaN } : { n, low, mean: sum / n, high };
}

export function numbers(lines: Line[], show: (value: number, line: Line) => string, title: string): { element: HTMLElement; update: (i: number) => void } {
    const at = new Map<string, HTMLElement>();
    const rows = lines.map((line) => {
        const { n, low, mean, high } = state(line.values);
        const here = el("td");
        at.set(line.key, here);
        return el("tr", {}, el("th", { scope: "row" }, line.label), here, el("td", {}, show(low, line)), el("td", {}, show(mean, line)), el("td", {}, show(high, line)), el("td", {}, String(n)));
    });
    const element = el("details", { class: "numbers" }, el("summary", {}, "Numbers", el("span", { class: "sr" }, ` of ${title}`)),
        el("div", { class: "scroll" }, el("table", {}, el("caption", { class: "sr" }, `${title}, as numbers`),
            el("thead", {}, el("tr", {}, ...["Line", "At the cursor", "Smallest", "Mean", "Largest", "Epochs"].map((h) => el("th", { scope: "col" }, h)))),
            el("tbody", {}, ...rows))));
    let index = 0;
    const fill = (): void => {
        if (!element.open) return;
        for (const line of lines) at.get(line.key)!.textContent = show(line.values[index] ?? NaN, line);
    };
    element.addEventListener("toggle", fill);
    return { element, update: (i) => { index = i; fill(); } };
}
