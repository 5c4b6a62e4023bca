// A chart that cannot be drawn says why.

import { el } from "../show/dom.ts";

export function missing(host: HTMLElement, title: string, why: string): () => void {
    const note = el("section", { class: "chart missing" }, el("div", { class: "chart-head" }, el("h3", {}, title)), el("p", {}, why));
    host.append(note);
    return () => note.remove();
}
