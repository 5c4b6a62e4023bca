// The gravest satellite subsets of the Stanford-ESA diagram.

import { utcOf } from "../data/events.ts";
import type { Performance, ListedSubset } from "../records.gen.ts";
import type { Payload } from "../data/records.ts";
import { el } from "../show/dom.ts";
import { clock, count, date, metres, plain } from "../show/format.ts";
import { sortable, type Column } from "./sortable.ts";

export function subsetTable(record: Performance, payload: Payload): HTMLElement | null {
    const found = record.subsets;
    if (found === null) return null;
    const cut = found.n_cut === 0 ? "" : ` At ${count(found.n_cut)} epochs with many satellites only subsets that leave out a few, at most ${count(2 ** found.max_satellites)} an epoch.`;
    const words = `${count(found.n_subsets)} subsets of ${count(found.min_satellites)} satellites or more over ${count(found.n_epochs)} epochs${found.n_unsolved === 0 ? "" : `, ${count(found.n_unsolved)} more without a position`}; ${count(found.n_singular)} determine no position.${cut} `
        + `${found.n_mi === 0 ? "None is" : found.n_mi === 1 ? "One is" : `${count(found.n_mi)} are`} misleading (error beyond the level in either axis); the largest safety index is ${plain(found.safety_index_h_max, 3)} horizontally, ${plain(found.safety_index_v_max, 3)} vertically.`;
    const said = el("p", { class: "note" }, words);
    const heading = el("h3", {}, "Satellite subsets (Stanford-ESA)", record.experimental === "" ? null : el("span", { class: "tag" }, record.experimental));
    if (found.listed.length === 0) return el("section", { id: "subsets-section" }, heading, said, el("p", { class: "note" }, `No subset reaches a safety index of ${plain(found.listed_from, 2)}.`));
    const mark = record.experimental === "" ? "" : ", experimental";
    const when = (ns: number): string => `${date(utcOf(ns, payload))} ${clock(utcOf(ns, payload), true)}`;
    const length = (head: string, key: "hpe_m" | "hpl_m" | "vpe_m" | "vpl_m"): Column<ListedSubset> => ({ head, key, of: (s) => s[key], show: (s) => metres(s[key]) });
    const names = (head: string, key: "satellites" | "left_out"): Column<ListedSubset> => ({ head, key, words: true, of: (s) => s[key].join(" "), show: (s) => (s[key].length === 0 ? "none" : s[key].join(" ")) });
    const columns: Column<ListedSubset>[] = [
        { head: "Epoch, UTC", key: "time_ns", of: (s) => s.time_ns, show: (s) => when(s.time_ns) }, { head: `Safety index${mark}`, key: "safety_index", of: (s) => s.safety_index, show: (s) => plain(s.safety_index, 3) },
        names("Satellites used", "satellites"), names("Left out", "left_out"), length("HPE", "hpe_m"), length(`HPL${mark}`, "hpl_m"), length("VPE", "vpe_m"), length(`VPL${mark}`, "vpl_m"),
    ];
    const shown = found.listed.length < found.n_listed ? `; the gravest ${count(found.listed.length)} of ${count(found.n_listed)}` : "";
    const caption = `Satellite subsets with a safety index of ${plain(found.listed_from, 2)} or above${shown}`;
    return el("section", { id: "subsets-section" }, heading, said, sortable({ id: "subsets", caption, columns, rows: found.listed, sortable: true, page: 10 }));
}
