// The cursor as text, always in view: where it is, what the values are, and a slider that the keyboard moves.

import { eventWindow } from "../data/events.ts";
import type { Scene } from "../data/scene.ts";
import type { NumberName } from "../data/table.ts";
import { button, choice, el, setValue, valueOf } from "../show/dom.ts";
import { clock, metres, nauticalMiles, rnpName, signedMetres } from "../show/format.ts";
import { columnOf } from "../chart/methods.ts";
import { earnsGreen } from "./verdict.ts";

const QUIET_MS = 350;

export function cursorBar(host: HTMLElement, scene: Scene): () => void {
    const { table, payload } = scene;
    const slider = el("input", { type: "range", min: 0, max: table.n - 1, step: 1, "aria-label": "Epoch under the cursor", id: "epoch" });
    const fields = fieldsOf(scene).map((f) => ({ ...f, cell: valueOf(f.key, null, "") }));
    const green = earnsGreen(payload.summary.verdict);
    const state = el("span", { class: "alert-word", "data-key": "alert", "data-green": green ? "" : undefined, title: green ? undefined : "By bounds of which the verdict shows nothing" });
    const live = el("p", { class: "sr", "aria-live": "polite", id: "cursor-words" });
    const whole = button("All", { class: "reset", "aria-label": "Show all epochs" }, () => scene.window.set(null));
    const happened = eventWindow(scene);
    const event = happened === null ? null : button("Event (e)", { class: "reset", "aria-label": "Show the event, or all epochs" }, () => turn());
    const turn = (): void => scene.window.set(scene.window.get() === null ? happened : null);
    const onKey = (e: KeyboardEvent): void => {
        const typing = e.target instanceof HTMLInputElement && e.target.type !== "range" || e.target instanceof HTMLSelectElement || e.target instanceof HTMLTextAreaElement;
        if (e.key === "e" && !typing && !e.ctrlKey && !e.metaKey && !e.altKey) turn();
    };
    if (event !== null) document.addEventListener("keydown", onKey);
    const axis = table.alongIsAxis ? choice("Horizontal axis", [["time", "Time"], ["along", "Distance"]], scene.axis.get(), (a) => scene.axis.set(a)) : el("span", { class: "note", title: "The distance along the path is unknown or runs backwards" }, "time axis");
    const bar = el("div", { class: "cursor-bar", role: "region", "aria-label": "Values at the cursor" },
        el("div", { class: "cursor-fields" }, state, ...fields.map((f) => el("span", { class: "field" }, el("span", { class: "field-name" }, f.label), f.cell))),
        el("div", { class: "cursor-tools" }, slider, axis, event, whole), live);
    host.append(bar);
    slider.addEventListener("input", () => scene.cursor.set(Number(slider.value)));
    slider.addEventListener("keydown", (e) => {
        // Page keys move by a hundredth of the track; arrows, Home and End are the slider's own.
        const page = Math.max(1, Math.round(table.n / 100));
        const step = e.key === "PageUp" ? page : e.key === "PageDown" ? -page : 0;
        if (step === 0) return;
        e.preventDefault();
        scene.cursor.set(Math.min(table.n - 1, Math.max(0, scene.cursor.get() + step)));
    });
    let timer = 0;
    const update = (i: number): void => {
        slider.value = String(i);
        for (const f of fields) {
            const v = f.of(i);
            setValue(f.cell, v, f.show(v));
        }
        const alert = table.word("alert", i) ?? table.word("status", i) ?? "not judged";
        const reason = table.word("reason", i);
        state.textContent = reason === null ? alert : `${alert}: ${reason}`;
        state.dataset.state = alert;
        state.dataset.value = alert;
        const words = [`epoch ${i + 1} of ${table.n}`, ...fields.map((f) => `${f.label} ${f.cell.textContent}`), state.textContent].join(", ");
        slider.setAttribute("aria-valuetext", words);
        // Spoken when the cursor rests, not at every pixel on its way.
        clearTimeout(timer);
        timer = window.setTimeout(() => { live.textContent = words; }, QUIET_MS);
    };
    const ends = [scene.cursor.watch(update), scene.window.watch((w) => { whole.disabled = w === null; })];
    return () => {
        clearTimeout(timer);
        document.removeEventListener("keydown", onKey);
        ends.forEach((end) => end());
        bar.remove();
    };
}

interface Field {
    key: string;
    label: string;
    of: (i: number) => number;
    show: (v: number) => string;
}

function fieldsOf(scene: Scene): Field[] {
    const { table, payload } = scene;
    const column = (key: NumberName, label: string, show: (v: number) => string): Field[] => (table.has(key) ? [{ key, label, of: (i) => table.value(key, i), show }] : []);
    const judge = payload.summary.accuracy.find((m) => m.id === payload.summary.verdict.method);
    const bound = judge === undefined ? null : columnOf(judge, false);
    return [
        { key: "utc_s", label: "UTC", of: (i) => table.utc_s(i), show: (v) => clock(v, true) },
        ...column("along_m", "Along", (v) => nauticalMiles(v, 2)),
        ...column("rnp_m", "", rnpName),
        ...column("fte_m", "FTE", signedMetres),
        ...column("tse_m", "TSE", signedMetres),
        ...column("nse_h_m", "NSE", metres),
        ...column("anp_circle_m", "ANP", metres),
        ...(bound !== null && table.has(bound) && table.has("rnp_m") ? [{ key: "margin_m", label: "Margin", of: (i: number) => table.value("rnp_m", i) - table.value(bound, i), show: signedMetres }] : []),
    ];
}
