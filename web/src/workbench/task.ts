// What to do: the command, its fields, the start, and the same for a terminal and for Python.

import { button, choice, el } from "../show/dom.ts";
import { type Control, control } from "./fields.ts";
import type { Files } from "./files.ts";
import { ask } from "./link.ts";
import { type Answer, type Form, isMain, type Job, type Run, type Values, type Workbench } from "./model.ts";

const WAIT_MS = 250;

export interface Task {
    element: HTMLElement;
    /** Show what a job was requested, to ask it again. */
    show: (command: string, values: Values) => void;
    filesChanged: () => void;
    /** The finished runs that can be compared have changed. */
    runsChanged: (rows: Run[]) => void;
    /** Choose a run as the first of two, and ask for the other. */
    compare: (run: Run) => void;
}

export function task(bench: Workbench, files: Files, started: (job: Job) => void): Task {
    let form = bench.forms[0]!;
    let controls: Control[] = [];
    let timer: ReturnType<typeof setTimeout> | undefined;
    let requested = 0;
    let comparable: Run[] = [];
    let busy = false;
    const place = el("div", { class: "wb-form" });
    const summary = el("p", { class: "wb-summary" });
    const refusal = el("p", { class: "wb-refused", role: "alert" });
    const taken = el("p", { class: "wb-taken" });
    const line = el("pre", { tabindex: 0, "aria-label": "Command line", "data-lines": "terminal" });
    const python = el("pre", { tabindex: 0, "aria-label": "Lines of Python", "data-lines": "python" });
    const start = button("Start", { class: "wb-start" }, () => void begin());

    const values = (): Values => {
        const out: Values = {};
        for (const each of controls) out[each.field.name] = each.value();
        for (const field of form.fields) if (isTicked(field)) out[field.name] = files.ticked();
        return out;
    };
    const isTicked = (field: Form["fields"][number]): boolean => field.kind === "file" && field.flag === "";
    const refuse = (answer: Answer): void => {
        refusal.textContent = answer.refused ?? "";
        for (const each of controls) each.element.toggleAttribute("data-wrong", answer.refused !== undefined && each.field.name === answer.field);
    };
    const preview = async (): Promise<void> => {
        const turn = ++requested;
        const answer = await ask("/line", { command: form.command, values: values() });
        if (turn !== requested) return;
        line.textContent = answer.line === undefined ? "" : `cd ${quoted(bench.folder)}\n${answer.line}`;
        line.dataset.why = answer.refused ?? "";
        if (answer.refused !== undefined) line.textContent = `not yet: ${answer.refused}`;
        if (lines.open) await translate(turn);
    };
    const translate = async (turn: number): Promise<void> => {
        if (python.textContent === "") python.textContent = "...";
        const answer = await ask("/python", { command: form.command, values: values() });
        if (turn !== requested) return;
        python.textContent = answer.python === undefined ? `not yet: ${answer.refused}` : `# in ${bench.folder}\n${answer.python}`;
    };
    const changed = (): void => {
        refuse({});
        python.textContent = "";
        clearTimeout(timer);
        timer = setTimeout(() => void preview(), WAIT_MS);
        sayTaken();
    };
    const sayTaken = (): void => {
        const field = form.fields.find(isTicked);
        const names = files.ticked();
        taken.hidden = field === undefined;
        taken.textContent = names.length === 0 ? (field?.required ? "No file is ticked: tick those that the job takes, above." : "No file is ticked; this works without one.") : `Takes ${names.join(", ")}.`;
        taken.toggleAttribute("data-lacking", names.length === 0 && field?.required === true);
    };
    const begin = async (): Promise<void> => {
        // A button that is disabled loses the focus.
        if (busy) return;
        busy = true;
        const answer = await ask("/start", { command: form.command, values: values() });
        busy = false;
        refuse(answer);
        if (answer.job !== undefined) started(answer.job);
        else if (answer.field !== undefined) place.querySelector<HTMLElement>(`[data-field="${answer.field}"] :is(input, select)`)?.focus();
    };
    const build = (to: Form, filled: Values = {}): void => {
        form = to;
        summary.textContent = form.summary;
        const others = (name: string): string => {
            const value = controls.find((each) => each.field.name === name)?.value();
            return typeof value === "string" ? value : "";
        };
        controls = form.fields.filter((field) => field.kind !== "out" && !isTicked(field)).map((field) => control(field, form.fields, others));
        for (const each of controls) {
            each.files(files.rows());
            each.runs?.(comparable);
            if (each.field.name in filled) each.set(filled[each.field.name]);
        }
        const [main, rest] = [controls.filter(({ field }) => isMain(field)), controls.filter(({ field }) => !isMain(field))];
        const more = el("details", { class: "wb-more", hidden: rest.length === 0 }, el("summary", {}, `More options (${rest.length})`), el("div", { class: "wb-fields" }, ...rest.map(({ element }) => element)));
        place.replaceChildren(el("div", { class: "wb-fields" }, ...main.map(({ element }) => element)), more);
        changed();
    };
    place.addEventListener("input", changed);
    place.addEventListener("change", changed);
    const buttons = choice("What to do", bench.forms.map(({ command }): [string, string] => [command, command.charAt(0).toUpperCase() + command.slice(1)]), form.command, (command) => build(bench.forms.find((each) => each.command === command)!));
    const lines = el("details", { class: "wb-lines" }, el("summary", {}, "The same from a terminal or from Python"),
        el("div", { class: "wb-copy" }, el("h3", {}, "Terminal"), copy(line, "Copy the command line")), line,
        el("div", { class: "wb-copy" }, el("h3", {}, "Python"), copy(python, "Copy the lines of Python")), python);
    lines.addEventListener("toggle", () => { if (lines.open) void preview(); });
    build(form);
    const show = (command: string, filled: Values): void => {
        const to = bench.forms.find((each) => each.command === command);
        if (to === undefined) return;
        for (const one of buttons.querySelectorAll("button")) one.setAttribute("aria-pressed", String(one.dataset.choice === command));
        const ticked = to.fields.find(isTicked);
        const names = ticked === undefined ? undefined : filled[ticked.name];
        if (Array.isArray(names)) files.tick(names);
        build(to, filled);
        buttons.querySelector<HTMLElement>(`[data-choice="${command}"]`)?.focus();
    };
    return {
        element: el("section", { "aria-label": "What to do" }, el("div", { class: "wb-head" }, el("h2", {}, "2. What to do"), buttons), summary, taken, place, refusal, el("p", { class: "wb-act" }, start), lines),
        filesChanged: () => { for (const each of controls) each.files(files.rows()); changed(); },
        runsChanged: (rows) => {
            comparable = rows;
            for (const each of controls) each.runs?.(rows);
        },
        show,
        compare: (run) => {
            show("compare", { a: run.name });
            place.querySelector<HTMLElement>('[data-input="b"]')?.focus();
        },
    };
}

function quoted(path: string): string {
    return /^[\w./+-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`;
}

function copy(from: HTMLElement, name: string): HTMLElement {
    const one = button("Copy", { "aria-label": name }, () => {
        void navigator.clipboard.writeText(from.textContent ?? "").then(() => { one.textContent = "Copied"; }, () => {
            // Without leave to write, the lines are marked: the keys for copying do the rest.
            getSelection()?.selectAllChildren(from);
            one.textContent = "Marked";
        });
        setTimeout(() => { one.textContent = "Copy"; }, 2000);
    });
    return one;
}
