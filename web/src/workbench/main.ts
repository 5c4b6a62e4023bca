// The workbench: files, what to do, jobs and reports, on one page of this machine.

import "../show/page.css";
import "./workbench.css";
import { button, choice, el } from "../show/dom.ts";
import { choose } from "../show/theme.ts";
import { files as filesPart } from "./files.ts";
import { ask, get, Link } from "./link.ts";
import type { Job, Run, State, Workbench } from "./model.ts";
import { runs as runsPart } from "./runs.ts";
import { task as taskPart } from "./task.ts";

const host = document.querySelector<HTMLElement>("#workbench")!;
const lost = el("p", { class: "wb-lost", role: "alert", hidden: true }, "The workbench does not answer. Is `navbound open` still running? Jobs end with it.");
const spoken = el("p", { class: "sr", "aria-live": "polite" });
const viewer = el("section", { class: "wb-viewer", "aria-label": "Report", hidden: true, tabindex: -1 });

function stranger(): void {
    host.replaceChildren(el("h1", {}, "navbound workbench"), el("p", { class: "wb-stranger", role: "alert" }, "This page needs the address that `navbound open` printed, with what stands behind its #. Open that one again."));
    host.dataset.painted = "stranger";
}

let take: (state: State) => void = () => undefined;
const link = new Link({ state: (state) => take(state), linked: (linked) => { lost.hidden = linked; }, stranger });

/** A report, or what a job printed, in place of the work; the way back is its first button. */
function view(title: string, inside: HTMLElement, ...tools: Node[]): void {
    const before = document.activeElement;
    const back = button("Back", { class: "wb-back" }, () => {
        viewer.hidden = true;
        viewer.replaceChildren();
        work.hidden = false;
        scrollTo({ top: place });
        if (before instanceof HTMLElement && before.isConnected) before.focus();
    });
    const place = scrollY;
    viewer.replaceChildren(el("div", { class: "wb-viewer-head" }, back, el("h2", {}, title), ...tools), inside);
    viewer.hidden = false;
    work.hidden = true;
    scrollTo({ top: 0 });
    back.focus();
}

function openRun(run: Run): void {
    const address = `/report/${run.id}`;
    view(run.title, el("iframe", { src: address, title: `Report: ${run.title}`, sandbox: "allow-scripts allow-modals allow-downloads" }), el("a", { href: address, target: "_blank", rel: "noopener" }, "in a tab of its own"));
}

async function openOutput(job: Job): Promise<void> {
    const { stdout, stderr } = await get<{ stdout: string; stderr: string }>(`/output?job=${job.id}`);
    const text = [stdout.trimEnd(), stderr.trimEnd()].filter((each) => each !== "").join("\n\n");
    view(`What ${job.command} printed`, el("pre", { class: "wb-output", tabindex: 0 }, text === "" ? "Nothing." : text));
}

const work = el("div", { class: "wb-work" });

async function main(): Promise<void> {
    if (!(await link.begin())) return;
    const bench = await get<Workbench>("/workbench");
    const mine = new Set<number>();
    const files = filesPart(bench, () => task?.filesChanged());
    const started = (job: Job): void => {
        mine.add(job.id);
        spoken.textContent = `Job ${job.id} has started.`;
        runs.element.scrollIntoView({ block: "start", behavior: "smooth" });
    };
    let task: ReturnType<typeof taskPart> | undefined;
    const runs = runsPart({
        open: openRun,
        stop: (job) => void ask("/stop", { job: job.id }),
        again: (job) => { task?.show(job.command, job.values); task?.element.scrollIntoView(); },
        resume: (job) => void ask("/start", { command: job.command, values: job.values, name: job.out === "" ? undefined : job.out.split("/").at(-1) }).then((answer) => {
            if (answer.job !== undefined) started(answer.job);
            else spoken.textContent = answer.refused ?? "";
        }),
        output: (job) => void openOutput(job),
        compare: (run) => { task?.element.scrollIntoView(); task?.compare(run); },
    });
    task = taskPart(bench, files, started);
    let changes = -1;
    let was = new Map<number, Job["state"]>();
    take = (state) => {
        const ended = state.jobs.filter((job) => job.ended_s !== null && mine.has(job.id) && was.has(job.id) && was.get(job.id) !== job.state && ["running", "stopping"].includes(was.get(job.id)!));
        was = new Map(state.jobs.map((job) => [job.id, job.state]));
        const show = (): void => runs.jobs(state.jobs, state.now_s);
        show();
        if (state.changes === changes) return;
        changes = state.changes;
        void Promise.all([files.look(), runs.look()]).then(() => {
            show();
            task?.runsChanged(runs.comparable());
            for (const job of ended) {
                mine.delete(job.id);
                spoken.textContent = `Job ${job.id} has ended: ${job.words === "" ? job.state : job.words}.`;
                // What was waited for is shown at once, unless something else is looked at.
                if (!viewer.hidden || !["done", "no_verdict"].includes(job.state)) continue;
                const run = job.out === "" ? undefined : runs.byName(job.out);
                if (run !== undefined && run.page !== "") openRun(run);
                else if (job.out === "") void openOutput(job);
            }
            host.dataset.painted = "";
        });
    };
    document.title = `navbound workbench: ${bench.folder.split("/").at(-1)}`;
    const theme = choice("Colours", [["auto", "Auto"], ["light", "Light"], ["dark", "Dark"]], "auto", choose);
    host.replaceChildren(
        el("header", {}, el("div", {}, el("p", { class: "brand" }, `navbound ${bench.version}`), el("h1", {}, "Workbench"), el("p", { class: "note wb-folder" }, bench.folder)), el("div", { class: "head-tools" }, theme)),
        lost, spoken, viewer, work,
    );
    work.replaceChildren(files.element, task.element, runs.element);
}

void main();
