// The bound columns of the methods that bound one of some errors, as lines.

import type { MethodColumn } from "../columns.gen.ts";
import type { MethodResult } from "../data/records.ts";
import type { Scene } from "../data/scene.ts";
import { level } from "../show/format.ts";
import type { Colour } from "../show/theme.ts";
import type { Line } from "./strip.ts";

const HUES: Colour[] = ["m1", "m2", "m3", "m4", "m5"];
const DASHES = [undefined, [7, 3], [2, 3], [9, 3, 2, 3], [4, 4], [12, 3], [1, 2]];

export function columnOf(method: MethodResult, integrity: boolean): MethodColumn {
    return `${method.id.replaceAll("-", "_")}${integrity ? "_integrity_m" : "_m"}` as MethodColumn;
}

export function about(method: MethodResult): string {
    return `${method.title}, ${level(method.risk)}. Source: ${method.source} (${method.provenance}). Assumes: ${method.assumes}${method.may_alert ? "" : ". Shown for comparison, never feeds an alert"}`;
}

/** Names are the method ids, as in the tables; a word says what is not to be trusted as it stands. */
function name(method: MethodResult): string {
    const mark = method.provenance === "inferred" ? ", inferred" : method.may_alert || method.error_column !== "tse_m" ? "" : ", comparison";
    return `${method.id} ${level(method.risk)}${mark}`;
}

export function methodLines(scene: Scene, errors: string[], mirror: boolean): Line[] {
    const { accuracy, integrity, verdict } = scene.payload.summary;
    const lines: Line[] = [];
    const add = (method: MethodResult, isIntegrity: boolean, rank: number): void => {
        const values = scene.table.column(columnOf(method, isIntegrity));
        if (values === undefined || !errors.includes(method.error_column)) return;
        const main = method.id === verdict.method || (method.error_column !== "tse_m" && !isIntegrity);
        lines.push({
            key: columnOf(method, isIntegrity), label: name(method), values, colour: HUES[rank % HUES.length]!, dash: DASHES[(rank + (isIntegrity ? 1 : 0)) % DASHES.length],
            mirror, about: about(method), hidden: !main,
        });
    };
    const ranked = (list: MethodResult[]): MethodResult[] => [...list].filter((m) => errors.includes(m.error_column)).sort((a, b) => Number(b.id === verdict.method) - Number(a.id === verdict.method));
    ranked(accuracy).forEach((m, i) => add(m, false, i));
    ranked(integrity).forEach((m, i) => add(m, true, i));
    return lines;
}
