import assert from "node:assert/strict";
import { test } from "node:test";
import type { PackedTrack } from "../src/data/records.ts";
import { Table } from "../src/data/table.ts";

test("a chart that asks for a column which no report carries does not pass the type check", () => {
    const head: PackedTrack = { track: "a", n: 1, start_ns: "0", breaks: [], columns: [], words: {}, block: 0 };
    const table = new Table(head, new Map([["fte_m", new Float64Array([1])], ["separation_m", new Float64Array([2])]]), 0);
    assert.deepEqual([...table.column("fte_m")!], [1]);
    assert.deepEqual([...table.column("separation_m")!], [2]);
    // @ts-expect-error The list of columns does not show it in a report.
    assert.equal(table.column("altitude_m"), undefined);
    // @ts-expect-error It holds words, not numbers.
    assert.equal(table.column("nav_mode"), undefined);
});
