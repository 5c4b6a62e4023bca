import assert from "node:assert/strict";
import { test } from "node:test";
import { around, contours, places, worthDrawing, type Line } from "../src/world/contours.ts";
import type { MapGrid } from "../src/world/records.ts";

const DEG = Math.PI / 180;
const region = (n: number): MapGrid => ({ step_rad: DEG, south_rad: 0, north_rad: n * DEG, west_rad: 0, east_rad: n * DEG, n_lat: n, n_lon: n });
const WORLD: MapGrid = { step_rad: 30 * DEG, south_rad: -90 * DEG, north_rad: 90 * DEG, west_rad: -180 * DEG, east_rad: 180 * DEG, n_lat: 6, n_lon: 12 };
/** A field at the middles of cells, which stand half a cell from the edges. */
const field = (grid: MapGrid, of: (column: number, row: number) => number): Float64Array =>
    Float64Array.from({ length: grid.n_lat * grid.n_lon }, (_, i) => of((i % grid.n_lon) + 0.5, Math.floor(i / grid.n_lon) + 0.5));

test("the contour of a plane is a straight line, exactly where the plane has the level", () => {
    const grid = region(8);
    const lines = contours(field(grid, (x, y) => 2 * x + y), grid, 11.3);
    assert.equal(lines.length, 1);
    // Linear between neighbours, so that nothing but rounding is left.
    for (const [x, y] of lines[0]!) assert.ok(Math.abs(2 * x + y - 11.3) < 1e-12);
    // From the southernmost middles to the northernmost: x = (11.3 - y) / 2 at y = 0.5 and 7.5.
    const ends = [lines[0]![0]!, lines[0]!.at(-1)!].sort((a, b) => a[1] - b[1]);
    assert.ok(Math.abs(ends[0]![0] - 5.4) < 1e-12 && ends[0]![1] === 0.5);
    assert.ok(Math.abs(ends[1]![0] - 1.9) < 1e-12 && ends[1]![1] === 7.5);
});

test("the contour of a cone is one closed circle around its tip", () => {
    const grid = region(21);
    const lines = contours(field(grid, (x, y) => 10 - Math.hypot(x - 10.2, y - 10.7)), grid, 4);
    assert.equal(lines.length, 1);
    assert.deepEqual(lines[0]![0], lines[0]!.at(-1));
    // A chord between neighbours lies at most step^2 / (8 radius) inside the cone: 0.02 of a cell at a radius of 6.
    for (const [x, y] of lines[0]!) assert.ok(Math.abs(Math.hypot(x - 10.2, y - 10.7) - 6) < 1 / (8 * 6) + 1e-12);
    // Around the tip once: the turning angles add up to one turn.
    const angles = lines[0]!.map(([x, y]) => Math.atan2(y - 10.7, x - 10.2));
    const turned = angles.slice(1).reduce((sum, a, i) => sum + Math.atan2(Math.sin(a - angles[i]!), Math.cos(a - angles[i]!)), 0);
    assert.ok(Math.abs(Math.abs(turned) - 2 * Math.PI) < 1e-9);
});

test("around the Earth a line runs on to both edges, at the same latitude, and no piece crosses the picture", () => {
    assert.ok(around(WORLD) && !around(region(8)));
    // Falls away from the antimeridian and the equator: column 0 and 12 are the same meridian.
    const found = contours(field(WORLD, (x, y) => 10 - Math.hypot(Math.min(x, 12 - x), y - 3)), WORLD, 8);
    for (const line of found) for (const [i, [x, y]] of line.slice(1).entries()) assert.ok(Math.hypot(x - line[i]![0], y - line[i]![1]) < 1.5);
    const at = (edge: number): number[] => found.flatMap((line) => line.slice(1).flatMap(([x, y], i) => {
        const [x0, y0] = line[i]!;
        return (x0 - edge) * (x - edge) < 0 ? [y0 + ((edge - x0) / (x - x0)) * (y - y0)] : [];
    })).sort();
    assert.equal(at(0).length, 2);
    at(0).forEach((y, i) => assert.ok(Math.abs(y - at(12)[i]!) < 1e-12));
    // Symmetric about the equator, and inside the circle of radius 2 by no more than its chord.
    assert.ok(Math.abs(at(0)[0]! + at(0)[1]! - 6) < 1e-12);
});

test("a region that ends at the antimeridian has no line beyond its own middles", () => {
    const grid: MapGrid = { ...WORLD, west_rad: 90 * DEG, n_lon: 3 };
    const found = contours(field(grid, (x) => x), grid, 2);
    assert.equal(found.length, 1);
    assert.ok(found[0]!.every(([x]) => x === 2));
});

test("where a neighbour has no value there is no line", () => {
    const grid = region(4);
    const values = field(grid, (x) => x);
    values[1 * 4 + 1] = NaN;
    // The cell of column 1, row 1 takes the squares beside it: of the line at x = 2 between columns 1 and 2 the uppermost piece is left.
    const found = contours(values, grid, 2);
    assert.deepEqual(found.map((line) => line.map(([, y]) => y).sort()), [[2.5, 3.5]]);
});

test("at a saddle two corners hang together where the middle reaches the level", () => {
    const grid = region(2);
    const separated = (line: Line): boolean => line.every(([x, y]) => x + y < 2) || line.every(([x, y]) => x + y > 2);
    // South-west and north-east reach 1. The middle is 1.05 of 1 there, 0.2 here.
    const high = contours(Float64Array.from([2, 0.1, 0.1, 2]), grid, 1);
    const low = contours(Float64Array.from([1, -0.6, -0.6, 1]), grid, 1);
    assert.equal(high.length, 2);
    assert.ok(!high.some(separated) && low.every(separated));
});

test("what has reached the level exactly is inside, and a flat field has no line", () => {
    const grid = region(3);
    const lines = contours(Float64Array.from([90, 99, 99, 90, 99, 99, 90, 99, 99]), grid, 99);
    assert.deepEqual(lines.map((line) => line.map(([x]) => x)), [[1.5, 1.5, 1.5]]);
    assert.deepEqual(contours(new Float64Array(9).fill(99), grid, 99), []);
});

test("a line is drawn where the values tell it from the next one", () => {
    assert.deepEqual(worthDrawing(Float64Array.from([50, 99.2, 100]), [95, 99, 99.9]), [99, 99.9]);
    // In 24 instants one is 4 %: nothing lies between 99 and 99.9 %, and two lines in one place would claim that something does.
    assert.deepEqual(worthDrawing(Float64Array.from([50, 2300 / 24, 100]), [95, 99, 99.9]), [95, 99.9]);
    assert.deepEqual(worthDrawing(Float64Array.from([100, NaN]), [95, 99, 99.9]), []);
    assert.deepEqual(worthDrawing(Float64Array.from([98.9, 99.5]), [95, 99, 99.9]), [99]);
});

test("names stand on their lines, upright, apart from each other and inside the picture", () => {
    const room = { left: 0, top: 0, right: 400, bottom: 200 };
    const falling: Line = Array.from({ length: 41 }, (_, i) => [400 - 10 * i, 5 * i]);
    const close: Line = falling.map(([x, y]) => [x, y + 3]);
    const found = places([falling], room, 30, 3, []);
    assert.equal(found.length, 1);
    for (const { x, y, turn_deg } of found) {
        assert.ok(Math.abs(400 - x - 2 * y) < 1e-9);
        assert.ok(Math.abs(turn_deg - Math.atan2(-5, 10) / DEG) < 1e-9);
    }
    for (const other of places([close], room, 30, 3, found)) assert.ok(Math.hypot(other.x - found[0]!.x, other.y - found[0]!.y) > 30);
    assert.deepEqual(places([[[10, 10], [40, 10]]], room, 30, 3, []), []);
    assert.deepEqual(places([[[0, 2], [400, 2]]], room, 30, 3, []), []);
});
