// The navigation filter: what keeps the position, innovations and gates, biases, the filters with and without satellites.

import { declared } from "../chart/declared.ts";
import { modes } from "../chart/modes.ts";
import type { Scene } from "../data/scene.ts";
import { el } from "../show/dom.ts";
import { biases, innovations, totals } from "./inside.ts";

/** The charts of the track shown; without a filter only what columns declare, beside the other charts. */
export function filter(host: HTMLElement, scene: Scene): () => void {
    if (!scene.table.has("n_gated")) return declared(host, scene);
    const charts = el("div", { class: "charts" });
    const section = el("section", { id: "filter" }, el("h2", {}, "Navigation filter"), charts, totals(scene));
    host.append(section);
    const ends = [modes(charts, scene), innovations(charts, scene), declared(charts, scene), biases(charts, scene)];
    return () => {
        ends.forEach((end) => end());
        section.remove();
    };
}
