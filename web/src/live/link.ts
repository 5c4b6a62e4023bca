// The connection to the server: token to session, one stream, signs of life, acknowledgements, and a clock of the page's own.

import { begin, post } from "../show/session.ts";
import type { Transition } from "./state.ts";

const ALIVE_MS = 5000;
const AGAIN_MS = 1000;

/** What the messages of a stream change. */
export interface Receiver<Snapshot extends { client: number }, State> {
    snapshot: Snapshot | null;
    readonly acknowledged: Set<string>;
    take: (snapshot: Snapshot, now_s: number) => void;
    add: (state: State, now_s: number) => void;
    alert: (transition: Transition, now_s: number) => void;
    hear: (now_s: number) => void;
    tick: (now_s: number) => boolean;
}

export interface Heard {
    /** Something changed. */
    changed: () => void;
    /** Time passed, whether or not anything came. */
    ticked: () => void;
    alert: (transition: Transition) => void;
    /** The server does not know this browser. */
    stranger: () => void;
}

export function now_s(): number {
    return performance.now() / 1000;
}

/** A worker needs an address that the page vouches for. */
function clockWorker(): Worker {
    const types = (globalThis as { trustedTypes?: { createPolicy: (name: string, rules: object) => { createScriptURL: (url: string) => string } } }).trustedTypes;
    const policy = types?.createPolicy("navbound-clock", { createScriptURL: (url: string) => (url === "/clock.js" ? url : "about:blank") });
    return new Worker(policy?.createScriptURL("/clock.js") ?? "/clock.js");
}

export class Link<Snapshot extends { client: number }, State> {
    private stream: EventSource | null = null;
    private again: ReturnType<typeof setTimeout> | null = null;
    private requested: string | null = null;
    private readonly model: Receiver<Snapshot, State>;
    private readonly heard: Heard;

    constructor(model: Receiver<Snapshot, State>, heard: Heard) {
        this.model = model;
        this.heard = heard;
        const tick = (): void => {
            if (this.model.tick(now_s())) this.connect();
            heard.ticked();
        };
        clockWorker().addEventListener("message", tick);
        document.addEventListener("visibilitychange", tick);
        addEventListener("pageshow", tick);
        setInterval(() => this.alive(), ALIVE_MS);
    }

    async begin(): Promise<void> {
        await begin();
        this.connect();
    }

    connect(track: string | null = this.requested): void {
        this.requested = track;
        this.stream?.close();
        if (this.again !== null) clearTimeout(this.again);
        const stream = new EventSource(track === null ? "/events" : `/events?track=${encodeURIComponent(track)}`);
        this.stream = stream;
        const on = <T>(name: string, take: (data: T) => void): void => stream.addEventListener(name, (event) => {
            if (stream !== this.stream) return;
            take(JSON.parse((event as MessageEvent<string>).data) as T);
            this.heard.changed();
        });
        on<Snapshot>("snapshot", (snapshot) => this.model.take(snapshot, now_s()));
        on<State>("state", (state) => this.model.add(state, now_s()));
        on<Transition>("alert", (transition) => {
            this.model.alert(transition, now_s());
            this.heard.alert(transition);
        });
        on<{ alert: string }>("acknowledged", ({ alert }) => {
            this.model.acknowledged.add(alert);
            this.model.hear(now_s());
        });
        // The stream comes again with a whole snapshot; a browser that gives up on it is made to try.
        stream.addEventListener("error", () => {
            if (stream !== this.stream) return;
            stream.close();
            this.again = setTimeout(() => void this.ask(), AGAIN_MS);
        });
    }

    private async ask(): Promise<void> {
        try {
            const answer = await fetch("/session", { cache: "no-store" });
            if (answer.status === 401) this.heard.stranger();
        } catch {
            // Nobody answers: the page says so already.
        }
        this.connect();
    }

    private alive(): void {
        const client = this.model.snapshot?.client;
        if (client !== undefined) void post("/alive", { client }).catch(() => undefined);
    }

    acknowledge(alert: string): void {
        void post("/acknowledge", { alert }).catch(() => undefined);
    }
}
