// Questions to the server of the workbench, and its news.

import { begin, post } from "../show/session.ts";
import type { Answer, State } from "./model.ts";

const ALIVE_MS = 5000;
const AGAIN_MS = 1000;
const SILENT_MS = 4000;

export interface Heard {
    state: (state: State) => void;
    /** Whether the server answers. */
    linked: (linked: boolean) => void;
    stranger: () => void;
}

export class Link {
    private stream: EventSource | null = null;
    private client: number | null = null;
    private heard_ms = performance.now();
    private readonly heard: Heard;

    constructor(heard: Heard) {
        this.heard = heard;
    }

    async begin(): Promise<boolean> {
        await begin();
        const answer = await fetch("/session", { cache: "no-store" });
        if (answer.status === 401) {
            this.heard.stranger();
            return false;
        }
        this.connect();
        setInterval(() => {
            if (this.client !== null) void post("/alive", { client: this.client }).catch(() => undefined);
        }, ALIVE_MS);
        setInterval(() => this.heard.linked(performance.now() - this.heard_ms < SILENT_MS), AGAIN_MS);
        return true;
    }

    private connect(): void {
        const stream = new EventSource("/events");
        this.stream = stream;
        const take = (event: Event): void => {
            if (stream !== this.stream) return;
            const data = JSON.parse((event as MessageEvent<string>).data) as State & { client?: number; status?: State };
            if (data.client !== undefined) this.client = data.client;
            this.heard_ms = performance.now();
            this.heard.linked(true);
            this.heard.state(data.status ?? data);
        };
        stream.addEventListener("snapshot", take);
        stream.addEventListener("state", take);
        stream.addEventListener("error", () => {
            if (stream !== this.stream) return;
            stream.close();
            setTimeout(() => void this.again(), AGAIN_MS);
        });
    }

    private async again(): Promise<void> {
        try {
            if ((await fetch("/session", { cache: "no-store" })).status === 401) {
                this.heard.stranger();
                return;
            }
        } catch {
            // Nobody answers: the page says so.
        }
        this.connect();
    }
}

export async function get<T>(path: string): Promise<T> {
    const answer = await fetch(path, { cache: "no-store" });
    if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
    return (await answer.json()) as T;
}

export async function ask(path: string, body: object): Promise<Answer> {
    try {
        const answer = await post(path, body);
        if (answer.status === 204) return {};
        return answer.ok ? ((await answer.json()) as Answer) : { refused: `the workbench refuses this (${answer.status})` };
    } catch {
        return { refused: "the workbench does not answer: is `navbound open` still running?" };
    }
}

/** Send a file as it is; `reported` takes the share that has gone. */
export function drop(file: File, reported: (share: number) => void): { done: Promise<Answer>; stop: () => void } {
    const request = new XMLHttpRequest();
    const done = new Promise<Answer>((resolve) => {
        request.upload.addEventListener("progress", (event) => reported(event.total === 0 ? 1 : event.loaded / event.total));
        request.addEventListener("load", () => resolve(request.status === 200 ? (JSON.parse(request.responseText) as Answer) : { refused: `${file.name}: refused (${request.status})` }));
        request.addEventListener("error", () => resolve({ refused: `${file.name}: the connection was lost; nothing of it was kept` }));
        request.addEventListener("abort", () => resolve({ refused: `${file.name}: given up; nothing of it was kept` }));
        request.open("POST", "/drop");
        request.setRequestHeader("X-Name", encodeURIComponent(file.name));
        request.send(file);
    });
    return { done, stop: () => request.abort() };
}
