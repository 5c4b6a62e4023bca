// The states of grid points as the record writes them, one sign each: what they mean, and their classes. Pure functions.

import type { ServiceLog } from "../records.gen.ts";
import { BRIGHT } from "../world/classes.ts";

/** GIVE by indicator 0 to 14: 99.9 % of the error of the vertical delay [m]. Source: RTCA DO-229, table of GIVE indicators; standard. */
export const GIVE_M = [0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.1, 2.4, 2.7, 3.0, 3.6, 4.5, 6.0, 15.0, 45.0];
export const NOT_MONITORED = "F";
export const DO_NOT_USE = "X";
export const UNKNOWN = ".";

/** Classes of the GIVE, from the smallest; bright to dark as on a map of errors. */
export const CLASSES: readonly { upTo: number; fill: string; ink: string; words: string }[] = [
    { upTo: 3, fill: BRIGHT[7]!, ink: "#12171c", words: "up to 1.2 m" },
    { upTo: 6, fill: BRIGHT[5]!, ink: "#12171c", words: "1.5 to 2.1 m" },
    { upTo: 9, fill: BRIGHT[3]!, ink: "#ffffff", words: "2.4 to 3 m" },
    { upTo: 12, fill: BRIGHT[2]!, ink: "#ffffff", words: "3.6 to 6 m" },
    { upTo: 14, fill: BRIGHT[0]!, ink: "#ffffff", words: "15 and 45 m" },
];

/** The indicator of a state; null of one that is none. */
export function indicatorOf(state: string): number | null {
    return /^[0-9A-E]$/.test(state) ? parseInt(state, 16) : null;
}

export function stateWords(state: string): string {
    const indicator = indicatorOf(state);
    if (indicator !== null) return `GIVE ${GIVE_M[indicator]} m (indicator ${indicator})`;
    return state === NOT_MONITORED ? "not monitored" : state === DO_NOT_USE ? "not to be used" : "nothing in force";
}

/** Which bin of the log a time lies in [ns of GPS time]; null beyond its messages. */
export function binAt(log: Pick<ServiceLog, "first_ns" | "last_ns" | "bin_ns">, time_ns: number): number | null {
    if (!(time_ns >= log.first_ns && time_ns <= log.last_ns)) return null;
    return Math.floor((time_ns - log.first_ns) / log.bin_ns);
}

/** How many points are in each class, not monitored, not to be used and without anything in force. */
export function tally(states: string[]): { words: string; key: string; n: number }[] {
    const of = (key: string, words: string, is: (state: string) => boolean) => ({ key, words, n: states.filter(is).length });
    const within = (k: number) => (state: string): boolean => {
        const indicator = indicatorOf(state);
        return indicator !== null && indicator <= CLASSES[k]!.upTo && indicator > (CLASSES[k - 1]?.upTo ?? -1);
    };
    return [
        ...CLASSES.map((each, k) => of(String(k), each.words, within(k))),
        of(NOT_MONITORED, "not monitored", (s) => s === NOT_MONITORED), of(DO_NOT_USE, "not to be used", (s) => s === DO_NOT_USE), of(UNKNOWN, "nothing in force", (s) => s === UNKNOWN),
    ];
}
