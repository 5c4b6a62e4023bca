// Light, dark and print from the same CSS variables; canvases ask for a colour by its name.

import { Store } from "../data/store.ts";

export type Colour = "ink" | "muted" | "rule" | "ground" | "panel" | "normal" | "caution" | "warning" | "path" | "limit" | "m1" | "m2" | "m3" | "m4" | "m5" | "s1" | "s2" | "s3" | "s4" | "s5" | "coast" | "land";

export function colour(name: Colour): string {
    const value = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    // The style sheet may hold "#fff" for "#ffffff"; opacity is appended to the long form.
    return value.length === 4 ? `#${[...value.slice(1)].map((c) => c + c).join("")}` : value;
}

export type Choice = "auto" | "light" | "dark";

export function choose(theme: Choice): void {
    if (theme === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme;
}

/** Counts theme changes, printing included. */
export function themeStore(): Store<number> {
    const store = new Store(0);
    const changed = (): void => store.set(store.get() + 1);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
    // Before paper is laid out the page takes its width and colours, so that canvases are drawn again for it.
    const printing = (now: boolean): void => {
        if (document.documentElement.classList.contains("printing") === now) return;
        document.documentElement.classList.toggle("printing", now);
        changed();
    };
    matchMedia("print").addEventListener("change", (e) => printing(e.matches));
    addEventListener("beforeprint", () => printing(true));
    addEventListener("afterprint", () => printing(false));
    new MutationObserver(changed).observe(document.documentElement, { attributeFilter: ["data-theme"] });
    return store;
}
