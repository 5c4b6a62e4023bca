// Charts that are drawn from the declarations of their columns alone: nothing here knows a column.

import type { DeclaredChart } from "../data/records.ts";
import type { Scene } from "../data/scene.ts";
import { metres, plain } from "../show/format.ts";
import type { Colour } from "../show/theme.ts";
import { strip, type Line } from "./strip.ts";

const HUES: Colour[] = ["m1", "m2", "m3", "m4", "m5"];

/** Every declared chart of which the track has a column. */
export function declared(host: HTMLElement, scene: Scene): () => void {
    const ends = scene.payload.charts.flatMap((chart, i) => {
        const lines = linesOf(chart, scene);
        return lines.length === 0 ? [] : [strip(host, scene, optionsOf(chart, lines, i))];
    });
    return () => ends.forEach((end) => end());
}

function linesOf(chart: DeclaredChart, scene: Scene): Line[] {
    let data = 0;
    return chart.lines.flatMap(({ column, label, about, limit }) => {
        const values = scene.table.column(column);
        if (values === undefined) return [];
        return [limit ? { key: column, label, values, colour: "limit", width: 1.5, limit, about } : { key: column, label, values, colour: HUES[data++ % HUES.length]!, width: 1.2, front: 1, about }];
    });
}

function optionsOf(chart: DeclaredChart, lines: Line[], i: number): Parameters<typeof strip>[2] {
    const note = `${lines.map((l) => `${l.label}: ${l.about}`).join(". ")}.`;
    const show = chart.unit === "m" ? metres : (v: number) => plain(v, 3);
    return { id: `declared-${i}`, title: chart.title, note, unit: chart.unit === "1" ? "" : chart.unit, lines, scales: ["data", "limits"], show: (v) => show(v) };
}
