// Which part of the time the charts show, while it is not all of it: a zoomed chart is no whole flight, and says so.

import { METRES_PER_NM, type Scene, type Window } from "../data/scene.ts";
import { button, el } from "../show/dom.ts";
import { clock, date, plain } from "../show/format.ts";

/** The part and the whole, in the unit of the axis; `happened` is the part in which something did. */
export function spanWords(scene: Pick<Scene, "table" | "axis">, shown: NonNullable<Window>, happened: Window): string {
    const { table } = scene;
    const along = scene.axis.get() === "along" ? table.column("along_m") : undefined;
    const last = table.n - 1;
    // Where there are several days, each time is of the day named last.
    const dated = date(table.utc_s(0)) !== date(table.utc_s(last));
    let day = "";
    const time = (i: number): string => {
        const [before, utc] = [day, table.utc_s(i)];
        day = date(utc);
        return dated && day !== before ? `${day} ${clock(utc)}` : clock(utc);
    };
    const place = (i: number): string => (along === undefined ? time(i) : plain(along[i]! / METRES_PER_NM, 2));
    const event = happened !== null && happened.from === shown.from && happened.to === shown.to;
    return `The charts show ${event ? "what happened, " : ""}${place(shown.from)} to ${place(shown.to)}${event ? "," : ""} of ${place(0)} to ${place(last)} ${along === undefined ? "UTC" : "NM"}.`;
}

/** Stays in sight while the charts are, and is gone when all is shown. */
export function spanShown(host: HTMLElement, scene: Scene, happened: Window = null): () => void {
    const words = el("span", { role: "status" });
    const whole = button("Show all", {}, () => {
        scene.window.set(null);
        // The button is gone: who pressed it by a key goes on beside the charts.
        first?.focus({ preventScroll: true });
    });
    const line = el("p", { class: "shown-span" }, words, " ", whole);
    host.append(line);
    let first: HTMLElement | null = null;
    const update = (): void => {
        const shown = scene.window.get();
        line.hidden = shown === null;
        words.textContent = shown === null ? "" : spanWords(scene, shown, happened);
        first = line.nextElementSibling?.querySelector<HTMLElement>("button, summary") ?? null;
    };
    const ends = [scene.window.watch(update), scene.axis.watch(update)];
    return () => {
        ends.forEach((end) => end());
        line.remove();
    };
}
