import assert from "node:assert/strict";
import { test } from "node:test";
import { traceFlown, type View } from "../src/map/paint.ts";

const VIEW: View = { x: 50, y: 50, k: 1, width: 100, height: 100 };

/** What a pen drew: every segment by its ends, rounded to pixels. */
function drawn(line: number[], breaks: number[], from?: number, to?: number): string[] {
    const segments: string[] = [];
    let at = "";
    const point = (x: number, y: number): string => `${Math.round(x)},${Math.round(y)}`;
    const pen = { moveTo: (x: number, y: number) => { at = point(x, y); }, lineTo: (x: number, y: number) => { segments.push(`${at} ${point(x, y)}`); at = point(x, y); } };
    traceFlown(pen as unknown as CanvasRenderingContext2D, VIEW, { line: Float64Array.from(line), breaks: new Set(breaks) }, from, to);
    return segments;
}

const LINE = [0, 0, 10, 0, 20, 0, 80, 0, 90, 0];

test("no line goes from the last position before a gap to the first behind it", () => {
    assert.deepEqual(drawn(LINE, []), ["0,0 10,0", "10,0 20,0", "20,0 80,0", "80,0 90,0"]);
    assert.deepEqual(drawn(LINE, [2]), ["0,0 10,0", "10,0 20,0", "80,0 90,0"]);
});

test("a position alone between two gaps is a point, at the ends of the track too", () => {
    assert.deepEqual(drawn(LINE, [1, 2]), ["0,0 10,0", "20,0 20,0", "80,0 90,0"]);
    assert.deepEqual(drawn(LINE, [0, 3]), ["0,0 0,0", "10,0 20,0", "20,0 80,0", "90,0 90,0"]);
});

test("a part of the track is cut alike", () => {
    assert.deepEqual(drawn(LINE, [2], 2, 4), ["80,0 90,0"]);
    assert.deepEqual(drawn(LINE, [2], 2, 3), ["80,0 80,0"]);
});
