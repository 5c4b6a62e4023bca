// Risk that the lateral total system error exceeds its limits, on a logarithmic scale.

import type { Scene } from "../data/scene.ts";
import { powerOfTen, risk } from "../show/format.ts";
import { missing } from "./missing.ts";
import { strip, type Line } from "./strip.ts";

const FLOOR = 1e-12;

/** Powers of ten, few enough to be read. */
function decades(min: number, max: number): number[] {
    const [low, high] = [Math.ceil(Math.log10(min) - 1e-9), Math.floor(Math.log10(max) + 1e-9)];
    const step = Math.max(1, Math.ceil((high - low) / 6));
    return Array.from({ length: Math.floor((high - low) / step) + 1 }, (_, i) => 10 ** (low + i * step));
}

export function exceedance(host: HTMLElement, scene: Scene): () => void {
    const twice = scene.table.column("p_exceed_2rnp");
    const once = scene.table.column("p_exceed_rnp");
    if (twice === undefined) return missing(host, "Risk of leaving 2 RNP", "The risk was not computed: it needs a path and a covariance.");
    const required = scene.payload.record.risk_integrity;
    const lines: Line[] = [{ key: "p_exceed_2rnp", label: "beyond 2 RNP", values: twice, colour: "m1", width: 1.4, about: "Risk that |TSE| exceeds 2 RNP" }];
    if (once !== undefined) lines.push({ key: "p_exceed_rnp", label: "beyond RNP", values: once, colour: "m2", dash: [6, 3], about: "Risk that |TSE| exceeds RNP", hidden: true });
    lines.push({ key: "risk_integrity", label: `limit ${risk(required)}`, values: new Float64Array(scene.table.n).fill(required), colour: "limit", width: 1.5, limit: true, about: "Risk allowed for containment" });
    const note = `Risk per epoch that the lateral total system error exceeds the limit, logarithmic; values below ${powerOfTen(-12)} are drawn at ${powerOfTen(-12)}.`;
    return strip(host, scene, { id: "risk", title: "Risk of leaving 2 RNP", note, unit: "", lines, scales: ["log"], floor: FLOOR, show: (v) => risk(v), ySplits: decades, yTick: (v) => powerOfTen(Math.round(Math.log10(v))) });
}
