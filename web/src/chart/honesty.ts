// May the covariance be believed? The histogram of the probability integral transform with its band, and the sentences.

import type { CovarianceConsistency, Summary } from "../data/records.ts";
import { el, svg, valueOf } from "../show/dom.ts";
import { count, plain } from "../show/format.ts";

const WIDTH = 420;
const HEIGHT = 150;
const LEFT = 50;
const BOTTOM = 24;

export function honesty(host: HTMLElement, summary: Summary): void {
    // A table of errors and protection levels claims no covariance.
    if (summary.honesty === null && summary.accuracy.length === 0 && summary.performance?.truth_known === true) return;
    const section = el("section", { class: "honesty", id: "honesty" }, el("h2", {}, "May the covariance be believed?"));
    host.append(section);
    if (summary.honesty === null) {
        const why = summary.verdict.truth_known ? "The epochs whose truth is known have no covariance, or no complete one" : "No truth";
        section.append(el("p", {}, `${why}: the consistency of the covariance could not be checked. Every bound on this page assumes that it is right.`));
    } else {
        section.append(el("div", { class: "two" }, histogram(summary.honesty), words(summary.honesty)));
    }
    section.append(el("p", { class: "note" }, summary.coverage_kind));
}

function words(h: CovarianceConsistency): HTMLElement {
    const figures = el("p", { class: "sentence" }, h.words);
    figures.dataset.key = "nees_mean";
    figures.dataset.value = String(h.nees_mean);
    return el("div", {}, figures, el("p", { class: "note" }, "Checked with ", valueOf("n", h.n, count(h.n)), " epochs."));
}

function histogram(h: CovarianceConsistency): HTMLElement {
    const n = h.pit_counts.length;
    const top = Math.max(h.pit_high, ...h.pit_counts) * 1.1 || 1;
    const x = (i: number): number => LEFT + ((WIDTH - LEFT - 6) * i) / n;
    const y = (v: number): number => 6 + (HEIGHT - BOTTOM - 6) * (1 - v / top);
    const bars = h.pit_counts.map((c, i) => {
        const outside = c < h.pit_low || c > h.pit_high;
        return svg("rect", { class: outside ? "pit-bar outside" : "pit-bar", x: x(i) + 1, width: x(i + 1) - x(i) - 2, y: y(c), height: y(0) - y(c) }, svg("title", {}, `${(i / n).toFixed(2)} to ${((i + 1) / n).toFixed(2)}: ${c}${outside ? ", outside the band" : ""}`));
    });
    const outside = h.pit_counts.filter((c) => c < h.pit_low || c > h.pit_high).length;
    const label = `Histogram of the probability integral transform: ${n} bins with ${h.pit_counts.join(", ")} epochs; ${outside} outside the 95 % band ${plain(h.pit_low, 0)} to ${plain(h.pit_high, 0)}`;
    const text = (px: number, py: number, words: string, anchor: string): SVGElement => svg("text", { x: px, y: py, "text-anchor": anchor }, words);
    return el("figure", { class: "pit" },
        svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": label },
            svg("rect", { class: "pit-band", x: LEFT, width: WIDTH - LEFT - 6, y: y(h.pit_high), height: y(h.pit_low) - y(h.pit_high) }), ...bars,
            svg("line", { class: "pit-axis", x1: LEFT, x2: WIDTH - 6, y1: y(0), y2: y(0) }),
            text(LEFT - 5, y(h.pit_high) + 4, plain(h.pit_high, 0), "end"), text(LEFT - 5, y(h.pit_low) + 4, plain(h.pit_low, 0), "end"), text(LEFT - 5, y(0) + 4, "0", "end"),
            text(LEFT, HEIGHT - 7, "0", "middle"), text(WIDTH - 6, HEIGHT - 7, "1", "end"), text((LEFT + WIDTH) / 2, HEIGHT - 7, "probability integral transform", "middle")),
        el("figcaption", {}, `Flat for an honest covariance. Band: 95 % for one bin. ${outside} of ${n} bins outside${outside > 0 ? " (hatched edge)" : ""}.`));
}
