import assert from "node:assert/strict";
import { test } from "node:test";
import { frameOf, join, nameAt, outline, regionOf, REGIONS, type Frame } from "../src/chart/regions.ts";
import { AVAILABLE, bucketTable, BUCKETS, causeOf, payloadOf, rowsOf, unavailableOf } from "../src/data/buckets.ts";
import { linkByTime } from "../src/data/link.ts";
import type { KpiEvent, KpiSeries, LevelResult, Performance, StanfordBins } from "../src/records.gen.ts";
import type { Payload } from "../src/data/records.ts";
import { Store } from "../src/data/store.ts";
import { share } from "../src/show/format.ts";

const bins = (error_bin: number[], level_bin: number[], count: number[], limit_m = 50): StanfordBins => ({ axis: "v", variant: "stanford", bin_m: 0.1, limit_m, n: count.reduce((a, b) => a + b, 0), error_bin, level_bin, count });

test("every bin off the diagonal is in the region that its error and level say", () => {
    const frame: Frame = { limit_m: 35, shown_m: 50, limitShown: true, roomBeyond: true };
    // The definition, from the middle of the bin.
    const definition = (e: number, p: number): string => (p < 35 ? (e > 35 ? "hmi" : e > p ? "mi" : "nominal") : e > p ? "unavailable_mi" : "unavailable");
    const found = new Set<string>();
    for (let e = 0; e <= 500; e += 3) {
        for (let p = 1; p <= 500; p += 3) {
            if (e === p) continue;
            const region = regionOf(e, p, 0.1, frame);
            assert.equal(region, definition((e + 0.5) / 10, (p + 0.5) / 10), `${e} ${p}`);
            found.add(region);
        }
    }
    assert.equal(found.size, REGIONS.length);
    assert.equal(regionOf(349, 100, 0.1, frame), "mi");
    assert.equal(regionOf(350, 100, 0.1, frame), "hmi");
    assert.equal(regionOf(100, 349, 0.1, frame), "nominal");
    assert.equal(regionOf(100, 350, 0.1, frame), "unavailable");
});

test("what lies beyond the axis is not called hazardous when the limit is further out", () => {
    const frame = frameOf(bins([500], [120], [3]), 556);
    assert.deepEqual(frame, { limit_m: 556, shown_m: 50, limitShown: false, roomBeyond: false });
    assert.equal(regionOf(500, 120, 0.1, frame), "mi");
    assert.equal(nameAt("hmi", frame, bins([], [], [])), null);
});

test("a limit at the end of the histogram still parts hazards from the rest", () => {
    const frame = frameOf(bins([500], [120], [3]), 50);
    assert.deepEqual([frame.limitShown, frame.roomBeyond], [true, false]);
    assert.equal(regionOf(500, 120, 0.1, frame), "hmi");
    assert.equal(regionOf(120, 500, 0.1, frame), "unavailable");
    assert.equal(regionOf(499, 120, 0.1, frame), "mi");
});

test("the axes leave room beyond the limit and show all bins that there are", () => {
    assert.equal(frameOf(bins([3], [90], [1]), 12).shown_m, 20);
    assert.equal(frameOf(bins([3], [330], [1]), 12).shown_m, 40);
    assert.equal(frameOf(bins([3], [500], [1]), 12).shown_m, 20);
    assert.equal(frameOf(bins([3], [90], [1]), 40).shown_m, 50);
});

test("the five regions tile the square with its band", () => {
    const frame: Frame = { limit_m: 35, shown_m: 50, limitShown: true, roomBeyond: true };
    const area = (points: [number, number][]): number => Math.abs(points.reduce((sum, [x, y], i) => {
        const [nx, ny] = points[(i + 1) % points.length]!;
        return sum + x * ny - nx * y;
    }, 0)) / 2;
    const total = REGIONS.reduce((sum, r) => sum + area(outline(r.id, frame)), 0);
    // 1.03 squared; the rest is the rounding of doubles.
    assert.ok(Math.abs(total - 1.0609) < 1e-12, String(total));
});

test("the name of the hazards goes where it covers none of them", () => {
    const frame: Frame = { limit_m: 40, shown_m: 50, limitShown: true, roomBeyond: true };
    const free = nameAt("hmi", frame, bins([], [], []))!;
    const there = bins([Math.round(free.x * 500)], [Math.round(free.y * 500)], [1]);
    const moved = nameAt("hmi", frame, there)!;
    assert.ok(Math.abs(moved.y - free.y) > 0.1);
});

test("joined pixels keep every count, the fullest last", () => {
    const pixels = join(bins([0, 1, 2, 7], [0, 1, 0, 9], [5, 6, 1, 2]), 2);
    assert.deepEqual(pixels.map((p) => [p.x, p.y, p.count]), [[2, 0, 1], [6, 8, 2], [0, 0, 11]]);
});

test("a share keeps what is missing to nothing and to all", () => {
    assert.equal(share(0.00014), "0.014 %");
    assert.equal(share(0.9999649), "99.9965 %");
    assert.equal(share(0.969), "96.90 %");
});

const SECOND = 1_000_000_000;
const START = 1_316_000_000 * SECOND;

function performance(starts: number[]): Performance {
    const n = starts.length;
    const series: KpiSeries = {
        width_ns: 10 * SECOND, start_ns: starts.map((s) => START + s * SECOND), n_expected: starts.map(() => 10), n_solution: starts.map((_, i) => (i === 1 ? 0 : 10)),
        hpe_max_m: starts.map((_, i) => i), vpe_max_m: starts.map(() => null), hpl_min_m: starts.map(() => 9), hpl_max_m: starts.map(() => 11), vpl_min_m: starts.map(() => 9), vpl_max_m: starts.map(() => 11),
        n_available: { A: starts.map((_, i) => (i === 2 ? 4 : 10)) }, cause: { A: starts.map((_, i) => (i === 2 ? "vpl" : "")) },
    };
    const event = (level: string, kind: KpiEvent["kind"]): KpiEvent => ({ level, kind, onset_ns: START, clear_ns: null, n_epochs: 1, duration_s: 1, over_tta: null, cause: "", reason: "r", hpe_max_m: null, vpe_max_m: null, hpl_max_m: null, vpl_max_m: null, n_sv_before: null, n_sv_onset: null, mode_before: null, mode_onset: null });
    const levels = [{ level: { id: "A" } } as LevelResult];
    return { series, levels, first_ns: START, last_ns: START + n * 10 * SECOND, period_s: 1, events: [event("A", "hazard"), event("B", "hazard"), event("A", "loss"), event("A", "mi")] } as Performance;
}

const payload = { gps_epoch_unix_s: 315_964_800, utc_offset_s: 18, summary: {} } as Payload;

test("no line crosses the time between two buckets that are apart", () => {
    const record = performance([0, 10, 40, 50]);
    assert.deepEqual(rowsOf(record.series), [0, 1, null, 2, 3]);
    const table = bucketTable(record, payload);
    assert.deepEqual([...table.elapsed_s], [0, 10, 20, 40, 50]);
    assert.deepEqual([...table.column("hpe_max_m")!], [0, 1, NaN, 2, 3]);
    assert.deepEqual([...table.column(unavailableOf("A"))!], [0, 0, NaN, 0.6, 0]);
    assert.deepEqual(table.wordColumn(causeOf("A")), [AVAILABLE, AVAILABLE, null, "vpl", AVAILABLE]);
    assert.deepEqual(table.unavailable, [{ label: "no solution", from: 1, to: 1 }]);
    assert.equal(table.start_utc_s, 1_316_000_000 + 315_964_800 - 18);
});

test("hazards and misleading information of the level drawn are marked, those of others and losses are not", () => {
    const record = performance([0]);
    assert.deepEqual(payloadOf(payload, record, record.levels[0]!).summary.events.map((e) => [e.track, e.kind]), [[BUCKETS, "warning"], [BUCKETS, "caution"]]);
});

test("two cursors stand at the same time and leave each other alone where one has none", () => {
    const buckets = { table: bucketTable(performance([0, 10, 20, 30]), payload), cursor: new Store(0), width_s: 9 };
    const fine = { ...performance([5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19]) };
    const epochs = { table: bucketTable({ ...fine, series: { ...fine.series, width_ns: SECOND } }, payload), cursor: new Store(0), width_s: 0 };
    const end = linkByTime(epochs, buckets);
    epochs.cursor.set(12);
    // 17 s is in the bucket from 10 to 19 s; the epoch itself stays where it was put.
    assert.deepEqual([epochs.cursor.get(), buckets.cursor.get()], [12, 1]);
    buckets.cursor.set(0);
    assert.equal(epochs.cursor.get(), 0);
    buckets.cursor.set(3);
    assert.equal(epochs.cursor.get(), 0);
    end();
    epochs.cursor.set(3);
    assert.equal(buckets.cursor.get(), 3);
});
