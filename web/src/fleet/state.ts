// What the page of a fleet knows and how far it may be believed: one record, without a browser.

import { severity, type Row, type Transition } from "../live/state.ts";

/** A lane, as its worker and the server see it. */
export interface Lane {
    lane: number;
    silent_s: number;
    worked: boolean;
    n_tracks: number | null;
    lag_s: number | null;
}

export interface Status {
    feed: "live" | "lost" | "ended";
    now_utc_s: number | null;
    lanes: Lane[];
    n_tracks: number;
    counts: Record<string, number>;
    n_hidden: number;
    trouble: string | null;
}

export interface Session {
    run: string;
    fields: string[];
    origin: { kind: "live" | "recording" | "replay"; source: string };
    rnp_m: number;
    rnp_table: string | null;
    /** Age from which the data of a track are stale. */
    stale_s: number;
    reasons: Record<string, string>;
}

export interface Snapshot {
    client: number;
    session: Session;
    rows: Row[];
    feed_alerts: Transition[];
    events: Transition[];
    n_transitions: number;
    status: Status;
}

/** A track of the fleet; a number that nobody stated is NaN. */
export interface Track {
    name: string;
    utc_s: number;
    /** Letters of the alerts in force, the gravest first. */
    alerts: string;
    status: string;
    reason: string | null;
    lat_rad: number;
    lon_rad: number;
    accuracy_m: number;
    integrity_m: number;
    rnp_m: number;
    fte_m: number;
    nic: number;
    nac_p: number;
    sil: number;
}

const LINK_S = 2;
const ASLEEP_S = 2;
const MOST_EVENTS = 300;
const ORDER = "WCU";

export type Freshness = "connecting" | "fresh" | "feed lost" | "ended" | "link lost" | "asleep";

export class Fleet {
    snapshot: Snapshot | null = null;
    status: Status | null = null;
    readonly tracks = new Map<string, Track>();
    readonly feedAlerts = new Map<string, Transition>();
    /** Of the contract of a link; nothing is acknowledged on this page. */
    readonly acknowledged = new Set<string>();
    events: Transition[] = [];
    nTransitions = 0;
    heard_s = -Infinity;
    frames = 0;
    private ticked_s: number | null = null;
    private slept = false;

    take(snapshot: Snapshot, now_s: number): void {
        this.snapshot = snapshot;
        this.tracks.clear();
        this.feedAlerts.clear();
        for (const row of snapshot.rows) this.put(row);
        for (const each of snapshot.feed_alerts) this.feedAlerts.set(each.alert, each);
        this.events = snapshot.events;
        this.nTransitions = snapshot.n_transitions;
        this.status = snapshot.status;
        this.slept = false;
        this.ticked_s = now_s;
        this.hear(now_s);
    }

    add(state: { rows: Row[]; status: Status }, now_s: number): void {
        if (this.snapshot === null) return;
        for (const row of state.rows) this.put(row);
        this.status = state.status;
        this.hear(now_s);
    }

    alert(transition: Transition, now_s: number): void {
        if (transition.track === null) {
            if (transition.transition === "raised") this.feedAlerts.set(transition.alert, transition);
            else this.feedAlerts.delete(transition.alert);
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

    tick(now_s: number): boolean {
        const asleep = this.ticked_s !== null && now_s - this.ticked_s > ASLEEP_S;
        this.ticked_s = now_s;
        if (asleep) this.slept = true;
        return asleep;
    }

    freshness(now_s: number): Freshness {
        if (this.snapshot === null || this.status === null) return "connecting";
        if (this.slept) return "asleep";
        if (!(now_s - this.heard_s <= LINK_S)) return "link lost";
        if (this.status.feed === "lost") return "feed lost";
        return this.status.feed === "ended" ? "ended" : "fresh";
    }

    /** Age of a track's newest position now, by the server's word and the page's own clock since then. */
    age_s(track: Track, now_s: number): number {
        const now = this.status?.now_utc_s;
        return now == null ? NaN : now - track.utc_s + (this.status?.feed === "ended" ? 0 : Math.max(0, now_s - this.heard_s));
    }

    /** Whether the numbers of a track may be read as those of now. */
    believed(track: Track, now_s: number): boolean {
        const usable = track.status === "ok" || track.status === "degraded";
        return this.freshness(now_s) === "fresh" && usable && !track.alerts.includes("U") && this.age_s(track, now_s) <= (this.snapshot?.session.stale_s ?? 0);
    }

    /** Tracks by severity, then by the least margin, then by name. */
    ordered(filter: string): Track[] {
        const requested = filter.trim().toLowerCase();
        const matching = [...this.tracks.values()].filter((track) => requested === "" || track.name.includes(requested) || words(track).toLowerCase().includes(requested));
        return matching.sort((a, b) => rank(a) - rank(b) || share(b) - share(a) || (a.name < b.name ? -1 : 1));
    }

    /** Lanes on which nobody works. */
    idle(): Lane[] {
        return this.status?.lanes.filter((lane) => !lane.worked) ?? [];
    }

    private put(row: Row): void {
        const name = String(row[0]);
        if (row.length === 1) {
            this.tracks.delete(name);
            return;
        }
        const number = (at: number): number => (typeof row[at] === "number" ? row[at] : NaN);
        const word = (at: number): string | null => (typeof row[at] === "string" ? row[at] : null);
        this.tracks.set(name, {
            name, utc_s: number(1), alerts: word(2) ?? "", status: word(3) ?? "not_available", reason: word(4), lat_rad: number(5), lon_rad: number(6),
            accuracy_m: number(7), integrity_m: number(8), rnp_m: number(9), fte_m: number(10), nic: number(11), nac_p: number(12), sil: number(13),
        });
    }
}

const WORDS: Record<string, string> = { W: "WARNING", C: "CAUTION", U: "UNAVAIL" };

/** The alerts in force of a track in words, all of them. */
export function words(track: Track): string {
    return track.alerts === "" ? "NORMAL" : [...track.alerts].map((letter) => WORDS[letter] ?? letter).join(" ");
}

/** What its gravest alert is drawn in: red for integrity, amber for all others. */
export function tone(track: Track): "warning" | "caution" | "normal" {
    if (track.alerts === "") return "normal";
    return severity(track.alerts.startsWith("W") ? "warning" : "caution") === 0 ? "warning" : "caution";
}

function rank(track: Track): number {
    const at = ORDER.indexOf(track.alerts.charAt(0));
    return track.alerts === "" ? ORDER.length : at;
}

/** Largest share of a limit that a bound takes up: 1 at the limit; nothing where there is no number. */
export function share(track: Track): number {
    const shares = [track.accuracy_m / track.rnp_m, track.integrity_m / (2 * track.rnp_m)].filter(Number.isFinite);
    return shares.length === 0 ? -1 : Math.max(...shares);
}
