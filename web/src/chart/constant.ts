// A chart of lines that stay where they are is a sentence.

import type { Scene } from "../data/scene.ts";
import { el, valueOf } from "../show/dom.ts";
import type { StripOptions } from "./strip.ts";

/** Each line's one value as people read it; null where a line, a word or the availability changes. */
export function constant(scene: Scene, options: Pick<StripOptions, "lines" | "show" | "words" | "varies">): { key: string; label: string; value: number; text: string }[] | null {
    if (options.varies === true || scene.table.unavailable.length > 0 || scene.table.n < 3) return null;
    if ((options.words ?? []).some(({ key }) => new Set(scene.table.wordColumn(key) ?? []).size > 1)) return null;
    const throughout = options.lines.filter((line) => line.hidden !== true && line.values.some(Number.isFinite)).map((line) => {
        const [low, high] = line.values.reduce<[number, number]>(([least, most], v) => [Math.min(least, v), Math.max(most, v)], [Infinity, -Infinity]);
        return { key: line.key, label: line.mirror === true ? `±${line.label}` : line.label, value: high, text: options.show(high, line), same: options.show(low, line) === options.show(high, line) && line.values.every(Number.isFinite) };
    });
    return throughout.length > 0 && throughout.every((one) => one.same) ? throughout : null;
}

export function folded(host: HTMLElement, options: StripOptions, throughout: NonNullable<ReturnType<typeof constant>>): () => void {
    const parts = throughout.flatMap((one, i) => [i === 0 ? " " : ", ", `${one.label} `, valueOf(one.key, one.value, one.text)]);
    const line = el("p", { class: "constant", id: options.id }, el("strong", {}, `${options.title}, throughout: `), ...parts, ".");
    host.append(line);
    return () => line.remove();
}
