// What the page knows and how far it may be believed: pure functions and one record, without a browser.

import type { AlertKind } from "../records.gen.ts";

export type Row = (number | string | boolean | null)[];

/** A transition as the server sends it. */
export interface Transition {
    key: string;
    /** What raise and clear of one alert have in common. */
    alert: string;
    /** Null for an alert of the source itself. */
    track: string | null;
    kind: AlertKind;
    transition: "raised" | "cleared" | "expired";
    annunciation_utc_s: number;
    onset_utc_s: number;
    clear_utc_s: number | null;
    event_utc_s: number;
    peak_m: number | null;
    limit_m: number | null;
    min_margin_m: number | null;
    latency_s: number | null;
    within_time_to_alert: boolean | null;
}

export interface Status {
    feed: "live" | "lost" | "ended";
    ages_s: Record<string, number>;
    /** Since anything came in, a sign of life of the reader included. */
    silent_s: number;
    trouble: string | null;
    n_hidden: number;
    tracks?: string[];
    track?: string | null;
}

export interface Session {
    run: string;
    fields: string[];
    origin: { kind: "live" | "recording" | "replay"; source: string; speed: number | null; points: [number, number, number, number][]; limits: { name: string; hal_m: number; val_m: number | null } | null };
    rnp_m: number;
    /** What the user states of the accuracy; empty where nothing is. */
    assumed: string;
    path: string | null;
    method: string;
    risk_accuracy: number;
    risk_integrity: number;
    sample_period_s: number;
    /** Age from which data are stale on the page. */
    stale_s: number;
    monitor_stale_s: number;
    time_to_alert_s: number;
    chain: Record<string, number>;
    reasons: Record<string, string>;
}

export interface Snapshot {
    client: number;
    session: Session;
    track: string | null;
    tracks: string[];
    rows: Row[];
    open: Transition[];
    events: Transition[];
    n_transitions: number;
    acknowledged: string[];
    status: Status;
}

export interface State {
    rows: Row[];
    n_skipped: number;
    status: Status;
}

/** Silence of the server after which its link is lost, unless data are stale sooner. */
const LINK_S = 2;
/** A clock that jumps by more has slept. */
const ASLEEP_S = 2;
const HISTORY_S = 600;
const MOST_EVENTS = 500;
const SEVERITY = ["warning", "caution", "unavailable"];

export type Freshness = "connecting" | "waiting" | "fresh" | "ageing" | "stale" | "feed lost" | "ended" | "link lost" | "asleep";

/** Values may stand in the colours of the present. */
export function present(of: Freshness): boolean {
    return of === "fresh" || of === "ageing";
}

export class Model {
    snapshot: Snapshot | null = null;
    status: Status | null = null;
    rows: Row[] = [];
    readonly open = new Map<string, Transition>();
    readonly acknowledged = new Set<string>();
    events: Transition[] = [];
    /** Spans of UTC in which epochs were not received. */
    holes: [number, number][] = [];
    nTransitions = 0;
    /** Time of the page's own clock at the last message. */
    heard_s = -Infinity;
    frames = 0;
    private place = new Map<string, number>();
    private nSkipped = 0;
    private ticked_s: number | null = null;
    private slept = false;

    take(snapshot: Snapshot, now_s: number): void {
        this.snapshot = snapshot;
        this.status = snapshot.status;
        this.place = new Map(snapshot.session.fields.map((name, i) => [name, i]));
        this.rows = snapshot.rows;
        this.holes = [];
        this.nSkipped = 0;
        this.open.clear();
        this.acknowledged.clear();
        for (const each of snapshot.open) this.open.set(each.alert, each);
        for (const each of snapshot.acknowledged) this.acknowledged.add(each);
        this.events = snapshot.events;
        this.nTransitions = snapshot.n_transitions;
        this.slept = false;
        this.ticked_s = now_s;
        this.hear(now_s);
    }

    add(state: State, now_s: number): void {
        if (this.snapshot === null) return;
        const first = state.rows[0];
        const before = this.rows.at(-1);
        if (first !== undefined && state.n_skipped > this.nSkipped && before !== undefined) this.holes.push([before[0] as number, first[0] as number]);
        this.nSkipped = state.n_skipped;
        for (const row of state.rows) {
            // A clock that was set back begins a new history: time on an axis only grows.
            if (this.rows.length > 0 && (row[0] as number) <= (this.rows.at(-1)![0] as number)) [this.rows, this.holes] = [[], []];
            this.rows.push(row);
        }
        const begin = ((this.rows.at(-1)?.[0] as number | undefined) ?? 0) - HISTORY_S;
        const old = this.rows.findIndex((row) => (row[0] as number) >= begin);
        if (old > 0) this.rows.splice(0, old);
        this.status = state.status;
        if (state.status.tracks !== undefined) this.snapshot.tracks = state.status.tracks;
        if (this.snapshot.track === null) this.snapshot.track = state.status.track ?? null;
        this.hear(now_s);
    }

    alert(transition: Transition, now_s: number): void {
        if (transition.transition === "raised") this.open.set(transition.alert, transition);
        else {
            this.open.delete(transition.alert);
            this.acknowledged.delete(transition.alert);
        }
        this.events.push(transition);
        if (this.events.length > MOST_EVENTS) this.events.shift();
        this.nTransitions += 1;
        this.hear(now_s);
    }

    hear(now_s: number): void {
        this.heard_s = now_s;
        this.frames += 1;
    }

    /** The page's own clock; true where it has slept and must begin anew. */
    tick(now_s: number): boolean {
        const asleep = this.ticked_s !== null && now_s - this.ticked_s > ASLEEP_S;
        this.ticked_s = now_s;
        if (asleep) this.slept = true;
        return asleep;
    }

    /** Age of the newest epoch now, by the server's word and the page's own clock since then. */
    age_s(now_s: number): number {
        const track = this.snapshot?.track;
        const age = track == null ? undefined : this.status?.ages_s[track];
        return age === undefined ? NaN : age + Math.max(0, now_s - this.heard_s);
    }

    freshness(now_s: number): Freshness {
        if (this.snapshot === null || this.status === null) return "connecting";
        const { stale_s, sample_period_s } = this.snapshot.session;
        if (this.slept) return "asleep";
        if (!(now_s - this.heard_s <= Math.min(LINK_S, stale_s))) return "link lost";
        if (this.status.feed === "lost") return "feed lost";
        if (this.status.feed === "ended") return "ended";
        const age = this.age_s(now_s);
        if (this.rows.length === 0 || Number.isNaN(age)) return "waiting";
        if (!(age <= stale_s)) return "stale";
        return age < Math.min(1.5 * Math.max(sample_period_s, 0.2), stale_s) ? "fresh" : "ageing";
    }

    /** The last epoch, whatever its age. */
    number(name: string, row: Row | undefined = this.rows.at(-1)): number {
        const value = row?.[this.place.get(name) ?? -1];
        return typeof value === "number" ? value : NaN;
    }

    /** Whether a number was ever stated in the epochs that are kept; the newest are looked at first. */
    known(name: string): boolean {
        return this.rows.findLast((row) => Number.isFinite(this.number(name, row))) !== undefined;
    }

    /** An alert limit: the record's own, else that of the level that the command names. */
    limit(name: "hal_m" | "val_m", row: Row | undefined = this.rows.at(-1)): number {
        const own = this.number(name, row);
        return Number.isFinite(own) ? own : this.snapshot?.session.origin.limits?.[name] ?? NaN;
    }

    word(name: string, row: Row | undefined = this.rows.at(-1)): string | null {
        const value = row?.[this.place.get(name) ?? -1];
        return typeof value === "string" ? value : null;
    }

    column(name: string): Float64Array {
        const at = this.place.get(name) ?? -1;
        return Float64Array.from(this.rows, (row) => (typeof row[at] === "number" ? row[at] : NaN));
    }

    words(name: string): (string | null)[] {
        const at = this.place.get(name) ?? -1;
        return this.rows.map((row) => (typeof row[at] === "string" ? row[at] : null));
    }

    /** Whether the numbers of the last epoch may be read as those of now: it is fresh, its position may be used, and it is monitored. */
    believed(now_s: number): boolean {
        const status = this.word("status");
        if (!present(this.freshness(now_s)) || (status !== "ok" && status !== "degraded") || this.word("alert") === "unavailable") return false;
        return ![...this.open.values()].some((each) => each.kind === "unavailable" && each.track === this.snapshot!.track);
    }

    /** Alerts in force: the most severe first, within a severity the newest. */
    inForce(): Transition[] {
        return [...this.open.values()].sort((a, b) => severity(a.kind) - severity(b.kind) || b.annunciation_utc_s - a.annunciation_utc_s);
    }

    /** Kinds in force of the aircraft that is shown. */
    kinds(): Set<string> {
        return new Set([...this.open.values()].filter((each) => each.track === this.snapshot?.track).map((each) => each.kind));
    }
}

/** Red for integrity, amber for everything else that is in force. */
export function severity(kind: string): number {
    const at = SEVERITY.indexOf(kind);
    return at < 0 ? SEVERITY.length - 1 : at;
}

/** Text from the air: a name of a track, at most 32 characters of a small alphabet; anything else is a question mark. */
export function plainName(name: string): string {
    return [...name.slice(0, 32)].map((c) => (/[A-Za-z0-9_.:+-]/.test(c) ? c : "?")).join("");
}
