import assert from "node:assert/strict";
import { test } from "node:test";
import { binAt, CLASSES, DO_NOT_USE, GIVE_M, indicatorOf, NOT_MONITORED, stateWords, tally, UNKNOWN } from "../src/panel/gridstates.ts";

test("signs of the record are indicators, or say why there is none", () => {
    assert.deepEqual(["0", "9", "A", "E"].map(indicatorOf), [0, 9, 10, 14]);
    assert.deepEqual([NOT_MONITORED, DO_NOT_USE, UNKNOWN, ""].map(indicatorOf), [null, null, null, null]);
    assert.equal(stateWords("E"), "GIVE 45 m (indicator 14)");
    assert.deepEqual([NOT_MONITORED, DO_NOT_USE, UNKNOWN].map(stateWords), ["not monitored", "not to be used", "nothing in force"]);
});

test("every state is counted once, in its class", () => {
    const counts = tally([..."0369AC", ..."DE", "F", "X", "X", "."]);
    assert.deepEqual(counts.map(({ n }) => n), [2, 1, 1, 2, 2, 1, 2, 1]);
    assert.equal(counts.reduce((sum, { n }) => sum + n, 0), 12);
});

test("the words of a class are the smallest and the largest GIVE in it", () => {
    CLASSES.forEach(({ upTo, words }, k) => {
        const [from, to] = [GIVE_M[(CLASSES[k - 1]?.upTo ?? -1) + 1]!, GIVE_M[upTo]!];
        assert.ok(words.includes(String(to)) && (k === 0 || words.startsWith(String(from))), words);
    });
});

test("a time is in the bin that holds it, and in none beyond the messages", () => {
    const log = { first_ns: 1000, last_ns: 1999, bin_ns: 250 };
    assert.deepEqual([999, 1000, 1249, 1250, 1999, 2000, NaN].map((t) => binAt(log, t)), [null, 0, 0, 1, 3, null, null]);
});
