import assert from "node:assert/strict";
import { test } from "node:test";
import { Model, plainName, present, severity, type Snapshot, type Transition } from "../src/live/state.ts";

const FIELDS = ["utc_s", "status", "alert", "rnp_m", "hal_m"];

function snapshot(over: Partial<Snapshot> = {}): Snapshot {
    return {
        client: 1, track: "F1", tracks: ["F1"], rows: [[1000, "ok", "normal", 555.6, null]], open: [], events: [], n_transitions: 0, acknowledged: [],
        status: { feed: "live", ages_s: { F1: 0.1 }, silent_s: 0, trouble: null, n_hidden: 0 },
        session: {
            run: "r", fields: FIELDS, origin: { kind: "live", source: "tcp://a:1", speed: null, points: [], limits: null }, rnp_m: 555.6, assumed: "", path: null, method: "tse-exact", risk_accuracy: 0.05, risk_integrity: 1e-5,
            sample_period_s: 1, stale_s: 2, monitor_stale_s: 2, time_to_alert_s: 10, chain: {}, reasons: {},
        },
        ...over,
    };
}

function alert(over: Partial<Transition> = {}): Transition {
    return {
        key: "F1/0/warning/5/raised", alert: "F1/0/warning/5", track: "F1", kind: "warning", transition: "raised", annunciation_utc_s: 5, onset_utc_s: 5, clear_utc_s: null, event_utc_s: 5,
        peak_m: null, limit_m: null, min_margin_m: null, latency_s: null, within_time_to_alert: null, ...over,
    };
}

test("a page that hears nothing says so within two seconds, or within the stale time where that is shorter", () => {
    for (const [stale_s, lost_s] of [[2, 2], [30, 2], [0.5, 0.5]] as const) {
        const model = new Model();
        assert.equal(model.freshness(0), "connecting");
        const base = snapshot();
        model.take({ ...base, session: { ...base.session, stale_s }, status: { ...base.status, ages_s: { F1: 0 } } }, 10);
        assert.ok(present(model.freshness(10 + 0.9 * Math.min(lost_s, stale_s))));
        assert.equal(model.freshness(10 + lost_s + 0.01), "link lost");
        assert.equal(model.believed(10 + lost_s + 0.01), false);
    }
});

test("data grow old by the page's own clock between two messages", () => {
    const model = new Model();
    model.take(snapshot(), 10);
    assert.equal(model.freshness(10), "fresh");
    assert.equal(model.freshness(11.5), "ageing");
    // The server said that they were 0.1 s old at 10 s.
    assert.ok(Math.abs(model.age_s(11.5) - 1.6) < 1e-9);
    model.add({ rows: [], n_skipped: 0, status: { ...snapshot().status, ages_s: { F1: 1.7 } } }, 11.6);
    assert.equal(model.freshness(11.7), "ageing");
    assert.equal(model.freshness(11.95), "stale");
    assert.equal(model.believed(11.95), false);
});

test("a clock that jumps has slept, and nothing is believed until everything was told anew", () => {
    const model = new Model();
    model.take(snapshot(), 10);
    assert.equal(model.tick(10.2), false);
    assert.equal(model.tick(40), true);
    model.add({ rows: [[1030, "ok", "normal", 555.6, null]], n_skipped: 0, status: snapshot().status }, 40.1);
    assert.equal(model.freshness(40.1), "asleep");
    model.take(snapshot(), 40.2);
    assert.equal(model.freshness(40.2), "fresh");
});

test("feed lost and ended stand before stale", () => {
    const model = new Model();
    for (const [feed, expected] of [["lost", "feed lost"], ["ended", "ended"]] as const) {
        model.take(snapshot({ status: { ...snapshot().status, feed, ages_s: { F1: 100 } } }), 10);
        assert.equal(model.freshness(10), expected);
    }
    model.take(snapshot({ rows: [] }), 10);
    assert.equal(model.freshness(10), "waiting");
});

test("numbers are believed only of a usable epoch that is monitored", () => {
    const rows: [string, string, boolean][] = [["ok", "normal", true], ["degraded", "caution", true], ["not_available", "normal", false], ["invalid_input", "normal", false], ["ok", "unavailable", false]];
    for (const [status, word, believed] of rows) {
        const model = new Model();
        model.take(snapshot({ rows: [[1000, status, word, 555.6, null]] }), 10);
        assert.equal(model.believed(10), believed, `${status} ${word}`);
    }
    const model = new Model();
    // A silence that the monitor has noticed, before any epoch says so; of another aircraft it says nothing.
    model.take(snapshot({ open: [alert({ kind: "unavailable", track: "F2" })] }), 10);
    assert.equal(model.believed(10), true);
    model.alert(alert({ kind: "unavailable", alert: "u", key: "u/raised" }), 10);
    assert.equal(model.believed(10), false);
});

test("a null is no number, and a limit of the record stands before that of the level", () => {
    const model = new Model();
    const base = snapshot();
    model.take({ ...base, session: { ...base.session, origin: { ...base.session.origin, limits: { name: "LPV-200", hal_m: 40, val_m: 35 } } } }, 10);
    assert.ok(Number.isNaN(model.number("hal_m")));
    assert.equal(model.limit("hal_m"), 40);
    model.add({ rows: [[1001, "ok", "normal", 555.6, 50]], n_skipped: 0, status: base.status }, 11);
    assert.equal(model.limit("hal_m"), 50);
    assert.ok(Number.isNaN(model.number("no such name")));
});

test("epochs that were not told leave a hole, and a clock that was set back begins a new history", () => {
    const model = new Model();
    model.take(snapshot(), 10);
    const { status } = snapshot();
    model.add({ rows: [[1001, "ok", "normal", 555.6, null]], n_skipped: 0, status }, 11);
    assert.deepEqual(model.holes, []);
    model.add({ rows: [[1050, "ok", "normal", 555.6, null]], n_skipped: 48, status }, 12);
    assert.deepEqual(model.holes, [[1001, 1050]]);
    model.add({ rows: [[1700, "ok", "normal", 555.6, null]], n_skipped: 48, status }, 13);
    assert.deepEqual(model.rows.map((row) => row[0]), [1700]);
    model.add({ rows: [[900, "ok", "normal", 555.6, null]], n_skipped: 48, status }, 14);
    assert.deepEqual([model.rows.map((row) => row[0]), model.holes], [[900], []]);
});

test("alerts in force: the most severe first, then the newest; a clear ends one and its acknowledgement", () => {
    const model = new Model();
    model.take(snapshot(), 10);
    const caution = alert({ kind: "caution", alert: "c", key: "c/raised", annunciation_utc_s: 9 });
    for (const each of [caution, alert(), alert({ alert: "w2", key: "w2/raised", annunciation_utc_s: 6 }), alert({ kind: "quiet", track: null, alert: "q", key: "q/raised", annunciation_utc_s: 99 })]) model.alert(each, 10);
    assert.deepEqual(model.inForce().map((t) => t.alert), ["w2", "F1/0/warning/5", "c", "q"]);
    assert.deepEqual([...model.kinds()].sort(), ["caution", "warning"]);
    model.acknowledged.add("c");
    model.alert({ ...caution, key: "c/cleared", transition: "cleared" }, 11);
    assert.equal(model.open.has("c"), false);
    assert.equal(model.acknowledged.has("c"), false);
    assert.equal(model.events.length, 5);
    // Amber is for everything that is no warning, what this page does not know included.
    assert.ok(severity("warning") < severity("caution") && severity("something new") > severity("caution"));
});

test("text from the air is of a small alphabet", () => {
    assert.equal(plainName("AFR123"), "AFR123");
    assert.equal(plainName("<img onerror=x>"), "?img?onerror?x?");
    assert.equal(plainName("A".repeat(99)).length, 32);
});
