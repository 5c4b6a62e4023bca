// Files: dropped, or of the folder; what each is; which of them a job takes.

import { button, el } from "../show/dom.ts";
import { drop, get } from "./link.ts";
import { type FileRow, size, type Workbench } from "./model.ts";

const FILTERED = 12;

export interface Files {
    element: HTMLElement;
    rows: () => FileRow[];
    /** Names of the files that are ticked, in their order. */
    ticked: () => string[];
    tick: (names: string[]) => void;
    look: () => Promise<void>;
}

export function files(bench: Workbench, changed: () => void): Files {
    let rows: FileRow[] = [];
    const requested = new Set<string>();
    const body = el("tbody");
    const none = el("p", { class: "wb-none", hidden: true }, "There is no file yet: drop one here, or put one into the folder.");
    const more = el("p", { class: "note", hidden: true });
    const filter = el("input", { type: "search", placeholder: "Filter", "aria-label": "Filter the files", hidden: true });
    const coming = el("div", { class: "wb-coming", "aria-live": "polite" });
    const picker = el("input", { type: "file", multiple: true, class: "sr", tabindex: -1, "aria-hidden": "true" });
    const limits = `Up to ${size(bench.limits.most_file_bytes)} each; the disk keeps ${size(bench.limits.left_bytes)} free. They stay on this machine, in ${bench.folder}/dropped, which only you can read.`;
    const zone = el("div", { class: "wb-drop" }, el("p", {}, el("b", {}, "Drop files here"), " or ", button("Choose files", { class: "wb-choose" }, () => picker.click())), el("p", { class: "note" }, limits));

    const line = (row: FileRow): HTMLElement => {
        const box = el("input", { type: "checkbox", "aria-label": `Use ${row.name}`, disabled: row.refused });
        box.checked = requested.has(row.name);
        box.addEventListener("change", () => { if (box.checked) requested.add(row.name); else requested.delete(row.name); changed(); });
        return el("tr", { "data-file": row.name, "data-refused": row.refused ? "true" : undefined }, el("td", {}, box), el("td", { class: "words wb-name" }, row.name), el("td", {}, size(row.n_bytes)), el("td", { class: "words wb-what" }, row.refused ? el("b", {}, "Not usable: ") : null, row.words));
    };
    const show = (): void => {
        const words = filter.value.toLowerCase();
        body.replaceChildren(...rows.filter((row) => row.name.toLowerCase().includes(words)).map(line));
        filter.hidden = rows.length <= FILTERED;
        none.hidden = rows.length > 0;
        table.hidden = rows.length === 0;
    };
    filter.addEventListener("input", show);
    const look = async (): Promise<void> => {
        const seen = await get<{ files: FileRow[]; n_left_out: number }>("/files");
        rows = seen.files;
        const known = new Set(rows.filter((row) => !row.refused).map((row) => row.name));
        for (const name of requested) if (!known.has(name)) requested.delete(name);
        more.hidden = seen.n_left_out === 0;
        more.textContent = `${seen.n_left_out} more files of the folder are not listed.`;
        show();
        changed();
    };
    const send = async (file: File): Promise<void> => {
        const bar = el("progress", { max: 1, value: 0, "aria-label": file.name });
        const words = el("span", {}, `${file.name}, ${size(file.size)}`);
        const sent = drop(file, (share) => { bar.value = share; });
        const stop = button("Stop", { "aria-label": `Stop ${file.name}` }, sent.stop);
        const box = el("p", {}, words, " ", bar, " ", stop);
        coming.append(box);
        const answer = await sent.done;
        if (answer.name !== undefined) {
            requested.add(answer.name);
            box.remove();
            return;
        }
        words.textContent = `Not kept: ${answer.refused ?? file.name}`;
        words.className = "wb-refused";
        bar.remove();
        stop.replaceWith(button("Close", { "aria-label": "Close this message" }, () => box.remove()));
    };
    const sendAll = async (list: FileList | null): Promise<void> => {
        // One after the other: they share one disk.
        for (const file of list ?? []) await send(file);
        await look();
    };
    picker.addEventListener("change", () => { void sendAll(picker.files).then(() => { picker.value = ""; }); });
    for (const name of ["dragenter", "dragover"]) addEventListener(name, (event) => { event.preventDefault(); zone.dataset.over = "true"; });
    for (const name of ["dragleave", "drop"]) addEventListener(name, (event) => { event.preventDefault(); delete zone.dataset.over; });
    addEventListener("drop", (event) => void sendAll(event.dataTransfer?.files ?? null));
    const table = el("div", { class: "scroll wb-files", tabindex: 0, role: "region", "aria-label": "Files" }, el("table", {}, el("caption", { class: "sr" }, "Files: tick those that the job takes"), el("thead", {}, el("tr", {}, el("th", { scope: "col" }, el("span", { class: "sr" }, "use")), el("th", { scope: "col", class: "words" }, "file"), el("th", { scope: "col" }, "size"), el("th", { scope: "col", class: "words" }, "what it is"))), body));
    const head = el("div", { class: "wb-head" }, el("h2", {}, "1. Files"), filter, button("Look again", { title: "See what has changed in the folder" }, () => void look()));
    return {
        element: el("section", { "aria-label": "Files" }, head, zone, picker, coming, table, none, more), look,
        rows: () => rows,
        ticked: () => rows.filter((row) => requested.has(row.name)).map((row) => row.name),
        tick: (names) => { requested.clear(); for (const name of names) requested.add(name); show(); changed(); },
    };
}
