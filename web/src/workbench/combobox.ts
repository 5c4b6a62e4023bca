// A text field with suggestions: by keyboard (arrows, Enter, Escape) and by pointer.

import { el, freshId } from "../show/dom.ts";

export type Suggest = (words: string) => Promise<[string, string][]>;

const WAIT_MS = 120;

export function combobox(input: HTMLInputElement, suggest: Suggest): HTMLElement {
    const id = freshId("list");
    const list = el("ul", { class: "wb-suggestions", role: "listbox", id, hidden: true, "aria-label": "Suggestions" });
    const box = el("div", { class: "wb-combobox" }, input, list);
    let items: [string, string][] = [];
    let current = -1;
    let requested = 0;
    let timer: ReturnType<typeof setTimeout> | undefined;
    for (const [name, value] of [["role", "combobox"], ["aria-autocomplete", "list"], ["aria-controls", id], ["aria-expanded", "false"], ["autocomplete", "off"]] as const) input.setAttribute(name, value);

    const close = (): void => {
        requested += 1;
        clearTimeout(timer);
        list.hidden = true;
        current = -1;
        input.setAttribute("aria-expanded", "false");
        input.removeAttribute("aria-activedescendant");
    };
    const take = (value: string): void => {
        input.value = value;
        close();
        input.dispatchEvent(new Event("change", { bubbles: true }));
    };
    const mark = (to: number): void => {
        current = to;
        [...list.children].forEach((child, i) => {
            child.setAttribute("aria-selected", String(i === to));
            if (i === to) child.scrollIntoView({ block: "nearest" });
        });
        if (to >= 0) input.setAttribute("aria-activedescendant", `${id}-${to}`);
    };
    const open = async (): Promise<void> => {
        const turn = ++requested;
        const suggested = await suggest(input.value.trim()).catch((): [string, string][] => []);
        if (turn !== requested || document.activeElement !== input) return;
        items = suggested;
        list.replaceChildren(...items.map(([value, words], i) => {
            const item = el("li", { role: "option", id: `${id}-${i}`, "aria-selected": "false" }, el("b", {}, value), words === "" ? null : el("span", {}, ` ${words}`));
            // Before the field loses the focus.
            item.addEventListener("pointerdown", (event) => { event.preventDefault(); take(value); });
            return item;
        }));
        list.hidden = items.length === 0;
        current = -1;
        input.setAttribute("aria-expanded", String(!list.hidden));
    };
    input.addEventListener("input", () => { clearTimeout(timer); timer = setTimeout(() => void open(), WAIT_MS); });
    input.addEventListener("focus", () => void open());
    input.addEventListener("blur", close);
    input.addEventListener("keydown", (event) => {
        if (event.key === "ArrowDown" || event.key === "ArrowUp") {
            event.preventDefault();
            if (list.hidden) void open();
            else mark((current + (event.key === "ArrowDown" ? 1 : items.length - 1 + Number(current < 0))) % items.length);
        } else if (event.key === "Enter" && !list.hidden) {
            event.preventDefault();
            const one = items[Math.max(current, 0)];
            if (current >= 0 && one !== undefined) take(one[0]);
            else close();
        } else if (event.key === "Escape" && !list.hidden) {
            event.stopPropagation();
            close();
        }
    });
    return box;
}
