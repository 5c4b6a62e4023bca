// Integrity in one sentence, before everything else that a performance record says.

import type { Performance } from "../records.gen.ts";
import { el } from "../show/dom.ts";
import { count } from "../show/format.ts";

/** Red for a hazard, amber for misleading information, grey where truth is unknown. */
export function toneOf(record: Performance): "unknown" | "warning" | "caution" | "inside" {
    if (!record.truth_known) return "unknown";
    if (record.levels.some((r) => r.n_hazard_epochs > 0)) return "warning";
    return record.n_mi_epochs > 0 ? "caution" : "inside";
}

export function headline(record: Performance): HTMLElement {
    const tone = toneOf(record);
    const hazards = record.levels.filter((r) => r.n_hazard_epochs > 0);
    const list = hazards.map((r) => `${r.level.id}: ${count(r.n_hazard_epochs)} epochs, ${count(r.n_hazard_over_tta)} of ${count(r.n_hazard_events)} runs longer than the time to alert`).join("; ");
    const compared = `, of ${count(record.axes.find((a) => a.axis === "h")?.error_m?.n ?? 0)} epochs with a protection level and a true error`;
    const unjudged = record.levels.some((r) => r.level.val_m !== null) && record.axes.find((a) => a.axis === "v")?.error_m == null ? " The vertical was not judged: no vertical error is known." : "";
    const words = {
        unknown: "Integrity unknown: no truth to compare with.", warning: `■ Hazardously misleading information. ${list}.`,
        caution: `▲ No hazard, but ${record.n_mi_epochs === 1 ? "one epoch" : `${count(record.n_mi_epochs)} epochs`} of misleading information${compared}.`,
        inside: `No misleading information${compared}.`,
    }[tone] + (tone === "unknown" ? "" : unjudged);
    const sentence = el("p", { class: "performance-words", "data-tone": tone }, words);
    sentence.dataset.key = "n_mi_epochs";
    sentence.dataset.value = String(record.n_mi_epochs);
    return sentence;
}
