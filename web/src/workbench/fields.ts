// Controls of one field each, made from what the command line declares of it.

import { button, el, freshId } from "../show/dom.ts";
import { combobox } from "./combobox.ts";
import { get } from "./link.ts";
import { type Field, type FileRow, helpOf, label, moment, type Run, type Value } from "./model.ts";

export interface Control {
    field: Field;
    element: HTMLElement;
    value: () => Value;
    set: (value: Value | undefined) => void;
    /** The list of files has changed. */
    files: (rows: FileRow[]) => void;
    /** The list of finished runs that can be compared has changed. */
    runs?: (rows: Run[]) => void;
}

/** What other fields say: the database in which procedures are searched. */
export type Others = (name: string) => string;

const MOST_SUGGESTED = 60;

export function control(declared: Field, fields: Field[], others: Others): Control {
    const field = { ...declared, help: helpOf(declared, fields) };
    if (field.kind === "flag" || field.kind === "parts") return flag(field);
    if (field.kind === "run") return run(field);
    if (field.several === "commas") return ticks(field);
    return field.several === "repeated" ? repeated(field, others) : single(field, others);
}

function frame(field: Field, of: string, ...inside: (Node | null)[]): HTMLElement {
    const named = el("label", { for: of, title: field.flag === "" ? undefined : field.flag }, label(field), field.required ? el("span", { class: "wb-required" }, " required") : null);
    return el("div", { class: "wb-field", "data-field": field.name }, named, ...inside, field.help === "" ? null : el("p", { class: "note", id: `${of}-help` }, field.help));
}

function flag(field: Field): Control {
    const id = freshId("field");
    const box = el("input", { type: "checkbox", id, "aria-describedby": `${id}-help` });
    const words = field.kind === "parts" ? "Keep finished parts" : label(field);
    const element = el("div", { class: "wb-field wb-flag", "data-field": field.name }, box, el("label", { for: id }, words), el("p", { class: "note", id: `${id}-help` }, field.kind === "parts" ? "When this job is stopped, starting it again goes on from there." : field.help));
    return { field, element, value: () => box.checked, set: (value) => { box.checked = value === true; }, files: () => undefined };
}

/** One value: selected from a closed list, from the files, or typed with suggestions. */
function one(field: Field, id: string, others: Others): { element: HTMLElement; input: HTMLInputElement | HTMLSelectElement; files: (rows: FileRow[]) => void } {
    const attributes = { id, "aria-describedby": `${id}-help`, "data-input": field.name };
    if (field.kind === "file") {
        const select = el("select", attributes);
        const files = (rows: FileRow[]): void => fill(select, [["", field.required ? "choose a file" : "none"], ...rows.filter((row) => !row.refused).map((row): [string, string] => [row.name, row.name])]);
        files([]);
        return { element: select, input: select, files };
    }
    if (field.choices.length > 0 && !field.typed && !field.files && field.search === "") {
        const select = el("select", attributes);
        fill(select, [["", field.default === "" ? (field.required ? "choose" : "default") : `default: ${field.default}`], ...field.choices.map(([value, words]): [string, string] => [value, words === "" ? value : `${value} (${words})`])]);
        return { element: select, input: select, files: () => undefined };
    }
    const numeric = field.kind === "integer" || field.kind === "number";
    const input = el("input", { ...attributes, type: "text", placeholder: field.default === "" ? undefined : field.default, inputmode: numeric ? "decimal" : undefined, spellcheck: "false", autocomplete: "off" });
    if (field.choices.length === 0 && !field.files && field.search === "") return { element: input, input, files: () => undefined };
    let names: [string, string][] = [];
    const suggest = async (words: string): Promise<[string, string][]> => {
        const requested = words.toLowerCase();
        const near = [...field.choices, ...names].filter(([value]) => value.toLowerCase().includes(requested));
        const query = new URLSearchParams({ list: field.search, words, file: others("database") });
        if (field.search === "runways" && words.length < 2) return near.slice(0, MOST_SUGGESTED);
        const matches = field.search === "" || (field.search === "procedures" && others("database") === "") ? [] : (await get<{ matches: { value: string; words: string }[] }>(`/search?${query}`)).matches;
        return [...near, ...matches.map(({ value, words: more }): [string, string] => [value, more])].slice(0, MOST_SUGGESTED);
    };
    const files = (rows: FileRow[]): void => { names = field.files ? rows.filter((row) => !row.refused).map((row) => [row.name, row.words]) : []; };
    return { element: combobox(input, suggest), input, files };
}

function fill(select: HTMLSelectElement, options: [string, string][]): void {
    const before = select.value;
    select.replaceChildren(...options.map(([value, words]) => el("option", { value }, words)));
    select.value = options.some(([value]) => value === before) ? before : "";
}

/** A finished run, the newest first. */
function run(field: Field): Control {
    const id = freshId("field");
    const select = el("select", { id, "aria-describedby": `${id}-help`, "data-input": field.name });
    const runs = (rows: Run[]): void => fill(select, [["", rows.length === 0 ? "no run in this folder can be compared yet" : "choose a run"], ...rows.map((row): [string, string] => [row.name, `${row.name}: ${row.title}, ${moment(row.ended_s)}`])]);
    runs([]);
    return { field, element: frame(field, id, select), value: () => select.value, set: (value) => { select.value = typeof value === "string" ? value : ""; }, files: () => undefined, runs };
}

function single(field: Field, others: Others): Control {
    const id = freshId("field");
    const made = one(field, id, others);
    return {
        field, element: frame(field, id, made.element), files: made.files,
        value: () => made.input.value.trim(),
        set: (value) => { made.input.value = typeof value === "string" ? value : ""; },
    };
}

function repeated(field: Field, others: Others): Control {
    const id = freshId("field");
    const rows = el("div", { class: "wb-rows" });
    let known: FileRow[] = [];
    let all: { row: HTMLElement; made: ReturnType<typeof one> }[] = [];
    const add = (value = "", focus = false): void => {
        const made = one(field, all.length === 0 ? id : freshId("field"), others);
        made.files(known);
        made.input.value = value;
        if (all.length > 0) made.input.setAttribute("aria-label", `${label(field)}, another`);
        const remove = button("Remove", { "aria-label": `Remove this ${label(field).toLowerCase()}` }, () => {
            all = all.filter((each) => each.made !== made);
            row.remove();
            rows.dispatchEvent(new Event("change", { bubbles: true }));
            more.focus();
        });
        const row = el("div", { class: "wb-row" }, made.element, all.length === 0 ? null : remove);
        all.push({ row, made });
        rows.append(row);
        if (focus) made.input.focus();
    };
    const more = button("Add another", { class: "wb-add" }, () => add("", true));
    add();
    return {
        field, element: frame(field, id, rows, more),
        files: (list) => { known = list; for (const { made } of all) made.files(list); },
        value: () => all.map(({ made }) => made.input.value.trim()).filter((text) => text !== ""),
        set: (value) => {
            rows.replaceChildren();
            all = [];
            const texts = Array.isArray(value) ? value : typeof value === "string" && value !== "" ? [value] : [];
            for (const text of texts.length === 0 ? [""] : texts) add(text);
        },
    };
}

/** Several of a list, each with its box. */
function ticks(field: Field): Control {
    const usual = field.default === "" ? [] : field.default.split(",");
    const boxes = field.choices.map(([value, words]) => {
        const id = freshId("tick");
        const box = el("input", { type: "checkbox", id, value });
        box.checked = usual.includes(value);
        return { box, line: el("div", { class: "wb-tick" }, box, el("label", { for: id }, el("b", {}, value), words === "" ? null : ` ${words}`)) };
    });
    const element = el("fieldset", { class: "wb-field wb-ticks", "data-field": field.name }, el("legend", {}, label(field), field.required ? el("span", { class: "wb-required" }, " required") : null), el("div", { class: "wb-tick-list", tabindex: 0, role: "group", "aria-label": label(field) }, ...boxes.map(({ line }) => line)), el("p", { class: "note" }, field.help));
    const selected = (): string[] => boxes.filter(({ box }) => box.checked).map(({ box }) => box.value);
    return {
        field, element, files: () => undefined,
        value: () => (selected().join(",") === usual.join(",") ? [] : selected()),
        set: (value) => {
            const requested = Array.isArray(value) && value.length > 0 ? value : usual;
            for (const { box } of boxes) box.checked = requested.includes(box.value);
        },
    };
}
