// Two cursors that stand at the same time, though their tables have different epochs.

import type { Store } from "./store.ts";
import type { Table } from "./table.ts";

export interface Cursor {
    table: Table;
    cursor: Store<number>;
    /** Length of an epoch that stands for many; zero for one that is an instant. */
    width_s: number;
}

/** Each follows the other where it has an epoch at that time; returns what ends that. */
export function linkByTime(a: Cursor, b: Cursor): () => void {
    let moving = false;
    const follow = (from: Cursor, to: Cursor) => (i: number): void => {
        if (moving || from.table.n === 0 || to.table.n === 0) return;
        const middle_s = from.table.utc_s(i) + from.width_s / 2;
        const k = to.table.nearest(middle_s - to.width_s / 2 - to.table.start_utc_s);
        if (Math.abs(to.table.utc_s(k) + to.width_s / 2 - middle_s) > Math.max(from.width_s, to.width_s)) return;
        moving = true;
        to.cursor.set(k);
        moving = false;
    };
    const ends = [a.cursor.watch(follow(a, b)), b.cursor.watch(follow(b, a))];
    return () => ends.forEach((end) => end());
}
