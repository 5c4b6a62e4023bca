// A chart that cannot be drawn says why.

import { el } from "../show/dom.ts";

export function missing(host: HTMLElement, title: string, why: string): () => void {
    const note = el("p", { class: "constant" }, el("strong", {}, `${title}: `), why);
    host.append(note);
    return () => note.remove();
}
