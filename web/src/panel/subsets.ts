// The gravest satellite subsets of the Stanford-ESA diagram.

import { utcOf } from "../data/events.ts";
import type { Performance, ListedSubset } from "../records.gen.ts";
import type { Payload } from "../data/records.ts";
import { el } from "../show/dom.ts";
import { clock, count, date, metres, plain } from "../show/format.ts";
import { sortable, type Column } from "./sortable.ts";

export function subsetTable(record: Performance, payload: Payload): HTMLElement | null {
    const subsets = record.subsets;
    if (subsets === null) return null;
    const cut = subsets.n_cut === 0 ? "" : ` At ${count(subsets.n_cut)} epochs with many satellites only subsets that leave out a few, at most ${count(2 ** subsets.max_satellites)} an epoch.`;
    const words = `${count(subsets.n_subsets)} subsets of ${count(subsets.min_satellites)} satellites or more over ${count(subsets.n_epochs)} epochs${subsets.n_unsolved === 0 ? "" : `, ${count(subsets.n_unsolved)} more without a position`}; ${count(subsets.n_singular)} determine no position.${cut} `
        + `${subsets.n_mi === 0 ? "None is" : subsets.n_mi === 1 ? "One is" : `${count(subsets.n_mi)} are`} misleading (error beyond the level in either axis); the largest safety index is ${plain(subsets.safety_index_h_max, 3)} horizontally, ${plain(subsets.safety_index_v_max, 3)} vertically.`;
    const note = el("p", { class: "note" }, words);
    const heading = el("h3", {}, "Satellite subsets (Stanford-ESA)", record.experimental === "" ? null : el("span", { class: "tag" }, record.experimental));
    if (subsets.listed.length === 0) return el("section", { id: "subsets-section" }, heading, note, el("p", { class: "note" }, `No subset reaches a safety index of ${plain(subsets.listed_from, 2)}.`));
    const mark = record.experimental === "" ? "" : ", experimental";
    const when = (ns: number): string => `${date(utcOf(ns, payload))} ${clock(utcOf(ns, payload), true)}`;
    const length = (head: string, key: "hpe_m" | "hpl_m" | "vpe_m" | "vpl_m"): Column<ListedSubset> => ({ head, key, of: (s) => s[key], show: (s) => metres(s[key]) });
    const names = (head: string, key: "satellites" | "left_out"): Column<ListedSubset> => ({ head, key, words: true, of: (s) => s[key].join(" "), show: (s) => (s[key].length === 0 ? "none" : s[key].join(" ")) });
    const columns: Column<ListedSubset>[] = [
        { head: "Epoch, UTC", key: "time_ns", of: (s) => s.time_ns, show: (s) => when(s.time_ns) }, { head: `Safety index${mark}`, key: "safety_index", of: (s) => s.safety_index, show: (s) => plain(s.safety_index, 3) },
        names("Satellites used", "satellites"), names("Left out", "left_out"), length("HPE", "hpe_m"), length(`HPL${mark}`, "hpl_m"), length("VPE", "vpe_m"), length(`VPL${mark}`, "vpl_m"),
    ];
    const shown = subsets.listed.length < subsets.n_listed ? `; the gravest ${count(subsets.listed.length)} of ${count(subsets.n_listed)}` : "";
    const caption = `Satellite subsets with a safety index of ${plain(subsets.listed_from, 2)} or above${shown}`;
    return el("section", { id: "subsets-section" }, heading, note, sortable({ id: "subsets", caption, columns, rows: subsets.listed, sortable: true, page: 10 }));
}
