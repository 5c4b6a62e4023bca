// Jobs of this workbench, and the runs that lie in the folder.

import { button, el } from "../show/dom.ts";
import { get } from "./link.ts";
import { elapsed, type Job, left, moment, type Run, stateWords } from "./model.ts";

export interface Runs {
    element: HTMLElement;
    jobs: (jobs: Job[], now_s: number) => void;
    look: () => Promise<void>;
    byName: (name: string) => Run | undefined;
    comparable: () => Run[];
}

export interface Wishes {
    open: (run: Run) => void;
    stop: (job: Job) => void;
    again: (job: Job) => void;
    resume: (job: Job) => void;
    output: (job: Job) => void;
    compare: (run: Run) => void;
}

interface Card {
    element: HTMLElement;
    update: (job: Job, now_s: number) => void;
}

function card(job: Job, wishes: Wishes, run: () => Run | undefined): Card {
    const head = el("p", { class: "wb-job-head" });
    const bar = el("progress", { max: 1, "aria-label": `Progress of job ${job.id}` });
    const far = el("span", { class: "note" });
    const tools = el("p", { class: "wb-job-tools" });
    const words = el("p", { class: "wb-job-words" });
    const element = el("li", { class: "wb-job", "data-job": job.id }, head, el("code", {}, job.line), el("p", { class: "wb-job-bar" }, bar, " ", far), words, tools);
    let shown = "";
    return {
        element,
        update: (now, now_s) => {
            const took = elapsed((now.ended_s ?? now_s) - now.began_s);
            head.textContent = `${now.command}, ${stateWords(now)}${now.ended_s === null ? "" : ` after ${took}`}`;
            const runs = now.ended_s === null;
            bar.hidden = !runs;
            if (now.progress === null) bar.removeAttribute("value");
            else bar.value = now.progress.done / Math.max(1, now.progress.total);
            const rest = left(now, now_s);
            far.textContent = !runs ? "" : `${took}${now.progress === null ? "" : `, ${now.progress.done} of ${now.progress.total} ${now.progress.what}`}${rest === null ? "" : `, about ${elapsed(rest)} left`}`;
            words.textContent = now.words;
            element.dataset.state = now.state;
            const report = now.out === "" ? undefined : run();
            const key = `${now.state} ${report?.id} ${report?.page}`;
            if (key === shown) return;
            shown = key;
            const focused = tools.contains(document.activeElement);
            tools.replaceChildren(...(runs ? [button(now.state === "stopping" ? "Stopping" : "Stop", { disabled: now.state === "stopping" }, () => wishes.stop(now))] : [
                ...(report !== undefined && report.page !== "" && now.state !== "failed" && now.state !== "stopped" ? [button("Open the report", {}, () => wishes.open(report))] : []),
                ...(now.state === "stopped" || now.state === "failed" ? [button(now.line.includes(" --checkpoint ") || now.command === "evaluate" ? "Go on" : "Start again", {}, () => wishes.resume(now))] : []),
                button("What it printed", {}, () => wishes.output(now)),
                button("Change and start", {}, () => wishes.again(now)),
            ]));
            if (focused) tools.querySelector("button")?.focus();
        },
    };
}

const VERDICTS: Record<string, [string, string]> = {
    inside: ["inside", "inside"], outside: ["outside", "warning"], not_shown: ["not shown", ""], not_believable: ["not believable", "caution"], nothing_judged: ["nothing judged", "caution"],
};

export function runs(wishes: Wishes): Runs {
    const cards = new Map<number, Card>();
    const list = el("ul", { class: "wb-jobs" });
    const body = el("tbody");
    const none = el("p", { class: "wb-none" }, "No run lies in this folder yet.");
    let known: Run[] = [];
    const line = (run: Run): HTMLElement => {
        const [words, tone] = VERDICTS[run.verdict] ?? [run.verdict.replaceAll("_", " "), ""];
        const name = run.page === "" ? el("span", {}, run.title) : button(run.title, { class: "row" }, () => wishes.open(run));
        const what = run.trouble === "" ? [words === "" ? null : el("b", { "data-tone": tone }, words.charAt(0).toUpperCase() + words.slice(1)), words === "" ? null : ". ", run.words] : [el("b", {}, "Not whole: "), run.trouble];
        return el("tr", { "data-run": run.name, "data-broken": run.trouble === "" ? undefined : "true" }, el("td", { class: "words" }, run.trouble === "" ? name : run.name, el("br"), el("span", { class: "note" }, `${run.name}, ${moment(run.ended_s)}`), run.comparable && known.filter((each) => each.comparable).length > 1 ? el("p", { class: "wb-job-tools" }, button("Compare with another", { "aria-label": `Compare ${run.name} with another run` }, () => wishes.compare(run))) : null), el("td", { class: "words wb-what" }, el("div", { class: "wb-clamp" }, ...what)));
    };
    const table = el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Runs in this folder" }, el("table", { class: "wb-runs" }, el("caption", { class: "sr" }, "Runs in this folder, the newest first"), el("thead", {}, el("tr", {}, el("th", { scope: "col", class: "words" }, "run"), el("th", { scope: "col", class: "words" }, "what it says"))), body));
    const byName = (name: string): Run | undefined => known.find((run) => run.name === name && run.trouble === "");
    return {
        element: el("section", { "aria-label": "Runs" }, el("h2", {}, "3. Jobs and reports"), list, table, none), byName,
        comparable: () => known.filter((run) => run.comparable),
        jobs: (jobs, now_s) => {
            for (const job of jobs) {
                if (!cards.has(job.id)) {
                    const made = card(job, wishes, () => byName(job.out));
                    cards.set(job.id, made);
                    list.prepend(made.element);
                }
                cards.get(job.id)!.update(job, now_s);
            }
        },
        look: async () => {
            known = (await get<{ runs: Run[] }>("/runs")).runs;
            body.replaceChildren(...known.map(line));
            table.hidden = known.length === 0;
            none.hidden = known.length > 0;
        },
    };
}
