import assert from "node:assert/strict";
import { deflateSync } from "node:zlib";
import { test } from "node:test";
import { asinhTicks, clockTicks, extent, isolated, spread } from "../src/chart/ticks.ts";
import { inflate, unpack, type PackedColumn } from "../src/data/packing.ts";
import { expand, runsOf } from "../src/data/runs.ts";
import { Store } from "../src/data/store.ts";
import { clipSegment, ellipse, metresPerRadian, offset, plane, roundDown } from "../src/map/geometry.ts";
import { sort } from "../src/panel/sortable.ts";
import { clock, duration, level, metres, nauticalMiles, risk, share, signedMetres } from "../src/show/format.ts";
import { earnsGreen } from "../src/panel/verdict.ts";

const column = (over: Partial<PackedColumn>): PackedColumn => ({ name: "x_m", kind: "linear", resolution: 0.001, offset: 0, order: 0, ...over });

/** Byte planes of folded words, written by hand. */
function planes(words: number[]): Uint8Array {
    return Uint8Array.from([0, 8, 16, 24].flatMap((shift) => words.map((w) => (w >>> shift) & 255)));
}

test("columns come back from their byte planes, signs and differences included", async () => {
    // Folded words 2, 3, 600 are the values 1, -2, 300; summed once 1, -1, 299.
    const bytes = await inflate(deflateSync(planes([2, 3, 600])).toString("base64"));
    assert.deepEqual([...unpack(bytes, [column({ offset: 5 })], 3).get("x_m")!], [5.001, 4.998, 5.3]);
    const summed = [...unpack(bytes, [column({ order: 1, resolution: 1 })], 3).get("x_m")!];
    assert.deepEqual(summed, [1, -1, 299]);
});

test("a value that does not exist is NaN, and zero risk is zero", () => {
    const values = [...unpack(planes([0xffffffff, 0xfffffffd, 4]), [column({ kind: "log10", resolution: 1, offset: -9 })], 3).get("x_m")!];
    assert.ok(Number.isNaN(values[0]));
    assert.equal(values[1], 0);
    assert.ok(Math.abs(values[2]! / 1e-7 - 1) < 1e-12);
});

test("columns of the wrong length are refused", () => {
    assert.throws(() => unpack(new Uint8Array(7), [column({})], 2), /7 bytes do not hold 1 columns of 2 values/);
});

test("runs expand to what they were made of", () => {
    const labels = ["a", "a", null, "b"];
    assert.deepEqual(expand(["a", "b"], [[0, 2], [-1, 1], [1, 1]]), labels);
    assert.deepEqual(runsOf(labels), [{ label: "a", from: 0, to: 1 }, { label: null, from: 2, to: 2 }, { label: "b", from: 3, to: 3 }]);
});

test("a share is never rounded to all or nothing", () => {
    assert.equal(share(1), "100 %");
    assert.equal(share(0.99999), "99.999 %");
    assert.equal(share(0.999999999999), "> 99.999999 %");
    assert.equal(share(0), "0 %");
    assert.equal(share(1e-12), "< 0.000001 %");
    assert.equal(share(null), "n/a");
});

test("lengths, risks and times read as people write them", () => {
    assert.equal(metres(12345.6), "12\u202f346 m");
    assert.equal(metres(-0.0004), "0.000 m");
    assert.equal(signedMetres(1.5), "+1.50 m");
    assert.equal(signedMetres(-1.5), "\u22121.50 m");
    assert.equal(metres(NaN), "n/a");
    assert.equal(nauticalMiles(555.6), "0.300 NM");
    assert.equal(risk(1e-5), "10⁻⁵");
    assert.equal(risk(9.99e-6), "10⁻⁵");
    assert.equal(risk(2.34e-8), "2.3 × 10⁻⁸");
    assert.equal(risk(0.05), "0.05");
    assert.equal(risk(0), "< 10⁻¹²");
    assert.equal(level(0.05), "95 %");
    assert.equal(level(1e-5), "risk 10⁻⁵");
    assert.equal(clock(86399.9996, true), "00:00:00");
    assert.equal(clock(1.25, true), "00:00:01.250");
    assert.equal(duration(7080), "1 h 58 min");
});

test("an extent takes in zero, both sides of a bound, and no gap", () => {
    const values = Float64Array.from([NaN, 3, 5]);
    assert.deepEqual(extent([{ values }], 0, 2, null), [0, 5]);
    assert.deepEqual(extent([{ values, mirror: true }], 0, 1, null), [-3, 3]);
    assert.deepEqual(extent([{ values: Float64Array.from([NaN]) }], 0, 0, null), [0, 1]);
    assert.deepEqual(extent([{ values: Float64Array.from([1e-30, 1e-6]) }], 0, 1, 1e-12), [1e-12, 1e-6]);
});

test("an epoch between gaps is found, so that it is drawn", () => {
    assert.deepEqual(isolated(Float64Array.from([1, NaN, 2, 3, NaN, 4, NaN, NaN, 5])), [0, 5, 8]);
    assert.deepEqual(isolated(Float64Array.from([1, 2])), []);
});

test("clock ticks are round and apart", () => {
    assert.deepEqual(clockTicks(35_950, 39_700, 70, 500), [36_000, 36_600, 37_200, 37_800, 38_400, 39_000, 39_600]);
    assert.deepEqual(asinhTicks(-50, 2000, 10), [-10, 0, 10, 100, 1000]);
});

test("labels are moved apart within their limits, keeping their order", () => {
    assert.deepEqual(spread([10, 11, 50], 13, 0, 100), [10, 23, 50]);
    const low = spread([98, 99, 100], 13, 0, 100);
    assert.deepEqual(low, [74, 87, 100]);
});

test("segments are cut at the edge, also when both ends are outside", () => {
    assert.deepEqual(clipSegment(-118, 5, 138, 5, 10, 10, 0), [0, 5, 10, 5]);
    assert.equal(clipSegment(-100, 50, 100, 50, 10, 10, 0), null);
    assert.equal(clipSegment(20, 0, 20, 10, 10, 10, 0), null);
});

test("the ellipse of a turned covariance has its axes", () => {
    // Standard deviations 3 and 1, major axis 30 degrees from east.
    const [c, s] = [Math.cos(Math.PI / 6), Math.sin(Math.PI / 6)];
    const e = ellipse(9 * c * c + s * s, (9 - 1) * c * s, 9 * s * s + c * c, 0.05);
    const k = 2.447746830680816; // sqrt(chi-square quantile 0.95, 2 degrees of freedom), tabulated
    assert.ok(Math.abs(e.major_m - 3 * k) < 1e-9);
    assert.ok(Math.abs(e.minor_m - k) < 1e-9);
    assert.ok(Math.abs(e.angle_rad - Math.PI / 6) < 1e-12);
});

test("the map plane comes back and the ellipsoid is WGS-84", () => {
    const on = plane(0.6, 2);
    const { lat_rad, lon_rad } = on.back(...on.put(0.61, 2.02));
    assert.ok(Math.abs(lat_rad - 0.61) < 1e-12 && Math.abs(lon_rad - 2.02) < 1e-12);
    const degree = Math.PI / 180;
    // Lengths of one degree at 45 degrees, textbook values: 111 131.745 m of latitude, 78 846.81 m of longitude.
    assert.ok(Math.abs(metresPerRadian(45 * degree).north * degree - 111_131.745) < 0.1);
    assert.ok(Math.abs(metresPerRadian(45 * degree).east * degree - 78_846.81) < 0.1);
    const moved = offset(0, 0, 0, 1000);
    assert.equal(moved.lon_rad, 0);
    assert.ok(moved.lat_rad > 0);
    // North is up on the screen, where y grows downwards.
    assert.ok(on.put(0.61, 2)[1] < on.put(0.6, 2)[1]);
});

test("scale lengths are 1, 2 or 5 times a power of ten", () => {
    assert.deepEqual([999, 1000, 4999, 0.07].map(roundDown), [500, 1000, 2000, 0.05]);
});

test("rows without a value come last, whichever way they are sorted", () => {
    const rows = [{ v: 2 as number | null }, { v: null }, { v: 10 }];
    const by = { head: "v", key: "v", of: (r: { v: number | null }) => r.v, show: () => "" };
    assert.deepEqual(sort(rows, by, false).map((r) => r.v), [2, 10, null]);
    assert.deepEqual(sort(rows, by, true).map((r) => r.v), [10, 2, null]);
});

test("a store tells its watchers what changed, until they leave", () => {
    const store = new Store(1);
    const heard: number[] = [];
    const leave = store.watch((v) => heard.push(v));
    store.set(1);
    store.set(2);
    leave();
    store.set(3);
    assert.deepEqual(heard, [1, 2]);
});

test("a state that rests on what is not shown, or on an assumed sigma, is not green", () => {
    assert.ok(earnsGreen({ id: "inside", assumed: ["no_path"] }));
    assert.ok(earnsGreen({ id: "outside", assumed: [] }));
    for (const id of ["not_shown", "not_believable", "nothing_judged"] as const) assert.ok(!earnsGreen({ id, assumed: [] }), id);
    assert.ok(!earnsGreen({ id: "inside", assumed: ["no_path", "sigma_typed"] }));
});
