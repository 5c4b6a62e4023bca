import assert from "node:assert/strict";
import { test } from "node:test";
import { areas, classes, classOf, steps } from "../src/world/classes.ts";
import { cellAt, cells, centre, labels, WIDE } from "../src/world/draw.ts";
import { flow } from "../src/world/leave.ts";
import { percentileName, type Layer, type MapGrid } from "../src/world/records.ts";

const DEG = Math.PI / 180;
const GRID: MapGrid = { step_rad: 30 * DEG, south_rad: -60 * DEG, north_rad: 60 * DEG, west_rad: -60 * DEG, east_rad: 60 * DEG, n_lat: 4, n_lon: 4 };
const layer = (values: number[], unit: Layer["unit"], limit: number | null): Layer => ({ id: "x", title: "x", unit, limit, values: Float64Array.from(values) });

test("percentiles are named as the table names them", () => {
    assert.equal(percentileName("hpl_m", 99.5), "hpl_p995_m");
    assert.equal(percentileName("pdop", 50), "pdop_p50");
});

test("the limit parts two classes, and what is beyond it is coloured apart", () => {
    const all = classes(layer([5, 8, 12, 20, 39, 41, 90, NaN], "m", 40));
    const edge = all.findIndex((c) => c.to === 40);
    assert.ok(edge > 0);
    assert.equal(all[edge + 1]!.from, 40);
    assert.ok(!all.slice(0, edge + 1).some((c) => c.fill === all[edge + 1]!.fill));
    assert.equal(classOf(40, all, false), edge);
    assert.equal(classOf(NaN, all, false), -1);
});

test("an availability of exactly 99.5 % has reached 99.5 %", () => {
    const all = classes(layer([99.5], "%", null));
    assert.equal(all[classOf(99.5, all, true)]!.from, 99.5);
    assert.equal(all[classOf(99.49, all, true)]!.to, 99.5);
});

test("steps are round and inside", () => {
    assert.deepEqual(steps(1.2, 6), [2, 3, 4, 5]);
    assert.deepEqual(steps(3, 3), []);
});

test("areas weigh by the cosine of the latitude", () => {
    const values = Array.from({ length: 16 }, (_, i) => (i < 8 ? 10 : i < 12 ? 30 : NaN));
    const found = layer(values, "m", 20);
    const all = classes(found);
    const parts = areas(found, all, GRID);
    // Rows centred at 45 S, 15 S, 15 N, 45 N: half of the area south, then cos 15 and cos 45 of the rest.
    const half = Math.cos(15 * DEG) / (Math.cos(15 * DEG) + Math.cos(45 * DEG)) / 2;
    assert.ok(Math.abs(parts[classOf(10, all, false)]! - 0.5) < 1e-12);
    assert.ok(Math.abs(parts[classOf(30, all, false)]! - half) < 1e-12);
    assert.ok(Math.abs(parts.at(-1)! - (0.5 - half)) < 1e-12);
});

test("neighbours of one class are one shape, from the south-west up", () => {
    const found = layer([10, 10, 30, 30, ...Array.from({ length: 12 }, () => NaN)], "m", 20);
    const all = classes(found);
    const paths = cells(found, all, GRID);
    assert.equal(paths[classOf(10, all, false)], "M0 90h60v30h-60z");
    assert.equal(paths[classOf(30, all, false)], "M60 90h60v30h-60z");
});

test("a point of the picture is in the cell drawn there", () => {
    // The square region stands in the middle: half of its width of 560 left of the middle of what the labels leave.
    const left = (WIDE.left + 992) / 2 - 280;
    assert.deepEqual(cellAt((left + 1) / 1000, 0.02, GRID, WIDE), { row: 3, column: 0 });
    assert.equal(cellAt((left - 1) / 1000, 0.02, GRID, WIDE), null);
    assert.equal(cellAt(0.001, 0.5, GRID, WIDE), null);
});

test("labels leave room between each other, on a small picture too", () => {
    for (const [width, font] of [[946, 11], [904, 24], [550, 11], [40, 24]] as const) {
        // Seven letters of 0.6 of the font, "180° W" and a blank.
        assert.ok(labels(width, font) * 7 * 0.6 * font <= Math.max(width, 7 * 0.6 * font), `${width} ${font}`);
    }
    assert.equal(labels(5000, 11), 12);
});

test("the middle of a cell is written as people do, on both sides of the antimeridian", () => {
    assert.equal(centre(-2.5 * DEG, 182.5 * DEG), "2.5° S, 177.5° W");
    assert.equal(centre(0, -180 * DEG), "0°, 180°");
});

test("entries of a legend follow each other and begin a line before they leave the picture", () => {
    const found = flow(["x".repeat(40), "x".repeat(40), "x".repeat(40), "x"]);
    assert.deepEqual(found.map((f) => f.line), [0, 0, 1, 1]);
    assert.equal(found[0]!.x, found[2]!.x);
    assert.ok(found[1]!.x > found[0]!.x + 40 * 12 * 0.6);
});
