// Tables of the records.

import type { EventSummary, FaultSummary, MethodResult, Payload, ProtectionSummary, TrackSummary } from "../data/records.ts";
import { indexAt, utcOf } from "../data/events.ts";
import type { Scene } from "../data/scene.ts";
import { el } from "../show/dom.ts";
import { clock, count, date, duration, level, limitName, metres, NONE, plain, risk, rnpName, share, signedMetres } from "../show/format.ts";
import { liveTable, sortable, type Column } from "./sortable.ts";

const number = <T>(head: string, key: keyof T & string, show: (v: number | null) => string): Column<T> => ({ head, key, of: (row) => row[key] as number | null, show: (row) => show(row[key] as number | null) });
const text = <T>(head: string, key: keyof T & string): Column<T> => ({ head, key, words: true, of: (row) => row[key] as string | null, show: (row) => (row[key] as string | null) ?? NONE });
const mean = (v: number | null): string => (v === null ? NONE : plain(v, 1));

export function tracks(payload: Payload, current: () => string, choose: (track: string) => void): { element: HTMLElement; refresh: () => void } {
    const { summary } = payload;
    const embedded = new Set(payload.tracks.map((t) => t.track));
    const columns: Column<TrackSummary>[] = [
        { head: "Track", key: "label", words: true, of: (t) => t.label, show: (t) => t.label, title: (t) => t.track },
        { head: "Start, UTC", key: "start_ns", of: (t) => t.start_ns, show: (t) => `${date(utcOf(t.start_ns, payload))} ${clock(utcOf(t.start_ns, payload))}` },
        number("Duration", "duration_s", duration), number("Epochs", "n_epochs", count),
        number("FTE mean", "fte_mean_m", signedMetres), number("FTE std", "fte_std_m", metres), number("|FTE| 95 %", "fte_abs95_m", metres),
        number("Within RNP", "share_inside", share), number("Bound / RNP, worst", "worst_ratio", (v) => (v === null ? NONE : plain(v, 3))), number("Worst margin", "worst_margin_m", signedMetres),
        number("Cautions", "n_cautions", count), number("Warnings", "n_warnings", count), number("Unavailable", "n_unavailable", count),
    ];
    if (embedded.size < summary.tracks.length) columns.push({ head: "Charts", key: "embedded", words: true, of: (t) => (embedded.has(t.track) ? "yes" : "no"), show: (t) => (embedded.has(t.track) ? "yes" : "not embedded") });
    const caption = summary.tracks.length === embedded.size ? "Tracks" : `Tracks; charts are embedded for ${embedded.size} of ${summary.tracks.length}, worst first`;
    return liveTable({ id: "tracks", caption, columns, rows: summary.tracks, sortable: true, press: (t) => choose(t.track), pressable: (t) => embedded.has(t.track), current: (t) => t.track === current() });
}

function results(payload: Payload): HTMLElement[] {
    const { summary, record } = payload;
    const columns: Column<MethodResult>[] = [
        { head: "Method", key: "id", words: true, of: (m) => m.id, show: (m) => `${m.id}${m.provenance === "inferred" ? " (inferred)" : ""}${m.may_alert ? "" : " (never alerts)"}`, title: (m) => m.title },
        { head: "Bounds", key: "error_column", words: true, of: (m) => m.error_column, show: (m) => m.error_column.replace(/_m$/, "") },
        number("Epochs", "n", count), number("Independent", "n_effective", mean),
        { head: "Coverage", key: "coverage", of: (m) => m.coverage, show: (m) => share(m.coverage) },
        { head: "95 % interval", key: "coverage_low", of: (m) => m.coverage_low, show: (m) => (m.coverage_low === null ? NONE : `${share(m.coverage_low)} to ${share(m.coverage_high)}`) },
        number("Mean bound", "mean_m", metres), number("Largest", "max_m", metres), number("Winkler score", "winkler_m", metres), number("Pinball loss", "pinball_m", metres),
    ];
    const one = (rows: MethodResult[], id: string, name: string, at: number): HTMLElement[] => (rows.length === 0 ? [] : [sortable({ id, caption: `${name}: bounds at ${level(rows[0]?.risk ?? at)}`, columns, rows })]);
    return [...one(summary.accuracy, "accuracy", "Accuracy", record.risk_accuracy), ...one(summary.integrity, "integrity", "Integrity", record.risk_integrity)];
}

export function methods(payload: Payload): HTMLElement {
    const { summary } = payload;
    const unique = [...new Map([...summary.accuracy, ...summary.integrity].map((m) => [m.id, m])).values()];
    const sources = sortable<MethodResult>({
        id: "methods", caption: "Where the methods come from", rows: unique,
        columns: [text("Method", "id"), text("What it is", "title"), text("Source", "source"), text("Provenance", "provenance"), text("Assumes", "assumes")],
    });
    return el("section", { id: "methods-section" }, el("h2", {}, "Methods"), ...results(payload), el("p", { class: "note" }, `${summary.coverage_kind} A bound is better when its coverage reaches the stated level and its mean is small; Winkler score and pinball loss weigh both, smaller is better.`), sources);
}

export function phases(payload: Payload): HTMLElement {
    const rows = payload.summary.phases;
    return sortable({
        id: "phases", caption: "Phases of the flight", rows,
        columns: [
            text("Phase", "phase"), { head: "RNP", key: "rnp_m", of: (p) => p.rnp_m, show: (p) => rnpName(p.rnp_m) }, number("Epochs", "n_epochs", count), number("Duration", "duration_s", duration),
            number("Within RNP", "share_inside", share), number("Bound / RNP, worst", "worst_ratio", (v) => (v === null ? NONE : plain(v, 3))), number("Risk beyond 2 RNP, largest", "p_exceed_2rnp_max", risk),
            number("Risk, mean", "p_exceed_2rnp_mean", risk), number("Coverage", "coverage", share), number("Cautions", "n_cautions", count), number("Warnings", "n_warnings", count),
        ],
    });
}

export function faults(payload: Payload): HTMLElement | null {
    const rows = payload.summary.faults;
    if (rows.length === 0) return null;
    const labels = new Map(payload.summary.tracks.map((t) => [t.track, t.label]));
    const after = (v: number | null): string => (v === null ? NONE : `${plain(v, 0)} s`);
    const table = sortable<FaultSummary>({
        id: "faults", caption: "Faults of the sensors: when the monitors spoke, in seconds after the fault began", rows, sortable: rows.length > 1,
        columns: [
            { head: "Track", key: "track", words: true, of: (f) => f.track, show: (f) => labels.get(f.track) ?? f.track }, text("Fault", "kind"),
            { head: "Begin, UTC", key: "start_ns", of: (f) => f.start_ns, show: (f) => clock(utcOf(f.start_ns, payload)) },
            number("Gate", "gate_after_s", after), number("Memory", "memory_after_s", after), number("Filters disagree", "disagree_after_s", after),
            number("Mode fell", "mode_after_s", after), text("To", "mode"), number("First alert", "alert_after_s", after), text("Alert", "alert"),
            number("Truth outside RNP", "outside_after_s", after), number("Outside 2 RNP", "outside_twice_after_s", after),
            number("Horizontal error, largest", "nse_h_max_m", metres), number("Vertical, largest", "nse_u_max_m", metres), text("Outcome", "outcome"),
        ],
    });
    return el("div", {}, el("p", { class: "note" }, ...rows.slice(0, 1).map((f) => `${f.kind}: ${f.words}`)), table);
}

/** Protection levels against the alert limits of the phases; a limit stands beside how it is held. */
export function alertLimits(payload: Payload): HTMLElement | null {
    const rows = payload.summary.protection;
    if (rows.length === 0) return null;
    const limit = (p: ProtectionSummary, value: number | null): string => (value === null ? NONE : `${metres(value)} (${p.hal_held})`);
    return sortable<ProtectionSummary>({
        id: "alert-limits", caption: "Protection levels against alert limits", rows,
        columns: [
            text("Phase", "phase"), { head: "HAL", key: "hal_m", of: (p) => p.hal_m, show: (p) => limit(p, p.hal_m) }, number("HPL, largest", "hpl_max_m", metres), number("for all faults together", "hpl_multi_max_m", metres),
            number("Within HAL", "share_available", share), number("HPE, largest", "hpe_max_m", metres), number("Epochs with HPE above HPL", "n_misleading", count),
            number("Accuracy 95 %, largest", "accuracy_max_m", metres), { head: "Accuracy required", key: "accuracy_limit_m", of: (p) => p.accuracy_limit_m, show: (p) => limit(p, p.accuracy_limit_m) }, number("Epochs", "n_epochs", count),
        ],
    });
}

export function crossTrack(payload: Payload): HTMLElement | null {
    const rows = payload.summary.cross_track;
    if (rows.length === 0) return null;
    return sortable({
        id: "cross-track", caption: "Cross-track deviation of recorded tracks, positive right", rows, sortable: rows.length > 1,
        columns: [text("Path", "path"), number("Tracks", "n_tracks", count), number("Points", "n_points", count), number("Mean", "mean_m", signedMetres), number("Std", "std_m", metres), number("|deviation| 95 %", "abs95_m", metres), number("Std between tracks", "between_tracks_std_m", metres)],
    });
}

/** Events of the flight; pressing one of the track shown moves the cursor to it. */
export function events(payload: Payload, scene: () => Scene | null, choose: (track: string) => Promise<void>): HTMLElement | null {
    const rows = payload.summary.events;
    if (rows.length === 0) return null;
    const embedded = new Set(payload.tracks.map((t) => t.track));
    const label = new Map(payload.summary.tracks.map((t) => [t.track, t.label]));
    const at = (ns: number | null): string => (ns === null ? NONE : clock(utcOf(ns, payload), true));
    const go = async (event: EventSummary): Promise<void> => {
        if (scene()?.table.track !== event.track) await choose(event.track);
        const now = scene();
        if (now === null) return;
        now.window.set(null);
        now.cursor.set(indexAt(event.onset_ns, now));
    };
    const columns: Column<EventSummary>[] = [
        { head: "Onset, UTC", key: "onset_ns", of: (e) => e.onset_ns, show: (e) => at(e.onset_ns) },
        { head: "Kind", key: "kind", words: true, of: (e) => e.kind, show: (e) => `${{ warning: "■ ", caution: "▲ " }[e.kind] ?? ""}${e.kind}` },
        number("Annunciated", "annunciation_ns", at), number("Cleared", "clear_ns", at), number("Peak bound", "peak_m", metres), number("Limit", "limit_m", limitName), number("Smallest margin", "min_margin_m", signedMetres), text("What happened", "words"),
    ];
    if (payload.summary.tracks.length > 1) columns.splice(1, 0, { head: "Track", key: "track", words: true, of: (e) => e.track, show: (e) => label.get(e.track) ?? e.track });
    return sortable({ id: "events", caption: "Events; press one to move the cursor there", columns, rows, sortable: true, press: (e) => void go(e), pressable: (e) => embedded.has(e.track) });
}

export function rejections(payload: Payload): HTMLElement {
    const { rejected, n_status } = payload.summary;
    const status = sortable({
        id: "status", caption: "Epochs by status", rows: Object.entries(n_status).map(([status, n]) => ({ status, n })), columns: [text("Status", "status"), number("Epochs", "n", count)],
    });
    if (rejected.length === 0) return el("div", {}, status, el("p", { class: "note" }, "No input was rejected."));
    const table = sortable({ id: "rejected", caption: "Input that was not used", rows: rejected, columns: [text("File", "file"), text("Reason", "reason"), number("Rows", "count", count), number("First line", "first_line", count), text("Example", "example")] });
    return el("div", {}, status, table);
}
