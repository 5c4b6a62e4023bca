// Elements in one line.

type Child = Node | string | null | undefined;

type Attributes = Record<string, string | number | boolean | undefined>;

function fill<E extends Element>(element: E, attributes: Attributes, children: Child[]): E {
    for (const [name, value] of Object.entries(attributes)) {
        if (value === undefined || value === false) continue;
        element.setAttribute(name, value === true ? "" : String(value));
    }
    element.append(...children.filter((c): c is Node | string => c != null));
    return element;
}

export function el<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
    return fill(document.createElement(tag), attributes, children);
}

export function svg<K extends keyof SVGElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): SVGElementTagNameMap[K] {
    return fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

/** A shown value: text for people, name and full precision for machines. */
export function valueOf(key: string, value: number | string | null, text: string, tag: "span" | "td" = "span"): HTMLElement {
    const element = el(tag, { class: "value", "data-key": key });
    setValue(element, value, text);
    return element;
}

export function setValue(element: HTMLElement, value: number | string | null, text: string): void {
    element.dataset.value = value == null || Number.isNaN(value) ? "" : String(value);
    element.textContent = text;
}

let used = 0;

/** An id for aria references, unique in the page. */
export function freshId(prefix: string): string {
    used += 1;
    return `${prefix}-${used}`;
}

export function button(label: string, attributes: Attributes, press: () => void): HTMLButtonElement {
    const element = el("button", { type: "button", ...attributes }, label);
    element.addEventListener("click", press);
    return element;
}

/** Buttons of which one is chosen. */
export function choice<T extends string>(name: string, options: [T, string][], selected: T, choose: (value: T) => void): HTMLElement {
    const group = el("div", { class: "choice", role: "group", "aria-label": name });
    for (const [value, label] of options) {
        const one = button(label, { "data-choice": value, "aria-pressed": value === selected ? "true" : "false" }, () => {
            for (const other of group.querySelectorAll("button")) other.setAttribute("aria-pressed", String(other === one));
            choose(value);
        });
        group.append(one);
    }
    return group;
}
