// A table whose columns sort; values stay readable by machines.

import { el, valueOf } from "../show/dom.ts";

export interface Column<T> {
    head: string;
    key: string;
    of: (row: T) => number | string | null;
    show: (row: T) => string;
    words?: boolean;
    title?: (row: T) => string;
}

export interface TableOptions<T> {
    id: string;
    caption: string;
    columns: Column<T>[];
    rows: T[];
    sortable?: boolean;
    /** Makes each row's first cell a button. */
    press?: (row: T) => void;
    pressable?: (row: T) => boolean;
    current?: (row: T) => boolean;
    /** Rows shown before all are asked for. */
    page?: number;
}

const PAGE = 60;

/** A table without changing rows. */
export function sortable<T>(options: TableOptions<T>): HTMLElement {
    return liveTable(options).element;
}

/** A table that can be told to read `current` again. */
export function liveTable<T>(options: TableOptions<T>): { element: HTMLElement; refresh: () => void } {
    let rows = [...options.rows];
    let sorted: { column: number; down: boolean } | null = null;
    let most = options.page ?? PAGE;
    const body = el("tbody");
    const heads = options.columns.map((column, i) => {
        const head = el("th", { scope: "col", class: column.words ? "words" : undefined });
        if (!options.sortable) head.append(column.head);
        else {
            const press = el("button", { type: "button", class: "sort" }, column.head);
            press.addEventListener("click", () => {
                sorted = { column: i, down: sorted?.column === i ? !sorted.down : !column.words };
                rows = sort(options.rows, column, sorted.down);
                heads.forEach((h, k) => h.setAttribute("aria-sort", k === i ? (sorted!.down ? "descending" : "ascending") : "none"));
                fill();
            });
            head.append(press);
            head.setAttribute("aria-sort", "none");
        }
        return head;
    });
    const more = el("button", { type: "button", class: "more-rows" });
    more.addEventListener("click", () => { most = rows.length; fill(); });
    const fill = (): void => {
        body.replaceChildren(...rows.slice(0, most).map((row) => rowOf(options, row)));
        more.hidden = rows.length <= most;
        more.textContent = `Show all ${rows.length} rows`;
    };
    fill();
    const element = el("div", { class: "table-box" }, el("p", { class: "table-title", "aria-hidden": "true" }, options.caption),
        el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": options.caption }, el("table", { id: options.id }, el("caption", { class: "sr" }, options.caption), el("thead", {}, el("tr", {}, ...heads)), body)), more);
    return { element, refresh: fill };
}

function rowOf<T>(options: TableOptions<T>, row: T): HTMLElement {
    const current = options.current?.(row) ?? false;
    return el("tr", { "aria-current": current ? "true" : undefined }, ...options.columns.map((column, i) => {
        const cell = valueOf(column.key, column.of(row), column.show(row), "td");
        if (column.words) cell.classList.add("words");
        if (column.words && column.show(row).length > 40) cell.classList.add("long");
        const title = column.title?.(row);
        if (title) cell.title = title;
        if (i === 0 && options.press && (options.pressable?.(row) ?? true)) {
            const press = el("button", { type: "button", class: "row" }, column.show(row));
            press.addEventListener("click", () => options.press!(row));
            cell.replaceChildren(press);
        }
        return cell;
    }));
}

/** Values that do not exist come last, whichever way the column is sorted. */
export function sort<T>(rows: T[], column: Column<T>, down: boolean): T[] {
    const absent = (v: number | string | null): boolean => v === null || (typeof v === "number" && Number.isNaN(v));
    return [...rows].sort((a, b) => {
        const [x, y] = [column.of(a), column.of(b)];
        if (absent(x) || absent(y)) return Number(absent(x)) - Number(absent(y));
        const order = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y), "en", { numeric: true });
        return down ? -order : order;
    });
}
