import assert from "node:assert/strict";
import { test } from "node:test";
import { Fleet, share, tone, words, type Snapshot, type Status } from "../src/fleet/state.ts";

const STATUS: Status = { feed: "live", now_utc_s: 1000, lanes: [{ lane: 0, silent_s: 0, worked: true, n_tracks: 3, lag_s: 0 }], n_tracks: 3, counts: {}, n_hidden: 0, trouble: null };
const row = (name: string, alerts: string, accuracy: number, utc = 999): (string | number | null)[] => [name, utc, alerts, "ok", null, 0.8, 0.1, accuracy, 100, 555.6, null, 8, 9, 3];
const snapshot = (rows: (string | number | null)[][]): Snapshot => ({
    client: 1, session: { run: "r", fields: [], origin: { kind: "live", source: "s" }, rnp_m: 555.6, rnp_table: null, stale_s: 3, reasons: {} }, rows, feed_alerts: [], events: [], n_transitions: 0, status: STATUS,
});

test("the gravest alert stands first, then the bound that takes up most of its limit", () => {
    const fleet = new Fleet();
    fleet.take(snapshot([row("a", "", 100), row("b", "U", 100), row("c", "WC", 600), row("d", "C", 560), row("e", "", 300)]), 0);
    assert.deepEqual(fleet.ordered("").map((track) => track.name), ["c", "d", "b", "e", "a"]);
    assert.deepEqual(fleet.ordered("caution").map((track) => track.name), ["c", "d"]);
    const first = fleet.ordered("")[0]!;
    assert.deepEqual([words(first), tone(first), share(first) > 1], ["WARNING CAUTION", "warning", true]);
});

test("no number is that of now once it is stale, the feed is lost or the link is", () => {
    const fleet = new Fleet();
    fleet.take(snapshot([row("a", "", 100), row("old", "", 100, 990), row("u", "U", 100)]), 0);
    const believed = (now: number): boolean[] => ["a", "old", "u"].map((name) => fleet.believed(fleet.tracks.get(name)!, now));
    assert.deepEqual(believed(0.5), [true, false, false]);
    assert.deepEqual(believed(2.5), [false, false, false]);
    assert.equal(fleet.freshness(2.5), "link lost");
    fleet.add({ rows: [["u"]], status: { ...STATUS, feed: "lost" } }, 3);
    assert.deepEqual([fleet.freshness(3), fleet.tracks.has("u")], ["feed lost", false]);
});
