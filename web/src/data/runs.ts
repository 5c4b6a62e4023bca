// Runs of equal words.

export interface Run {
    label: string | null;
    from: number;
    /** Index of the last epoch of the run. */
    to: number;
}

export function expand(words: string[], runs: [number, number][]): (string | null)[] {
    return runs.flatMap(([word, count]) => new Array<string | null>(count).fill(word < 0 ? null : words[word]!));
}

export function runsOf(labels: (string | null)[]): Run[] {
    const runs: Run[] = [];
    labels.forEach((label, i) => {
        const last = runs.at(-1);
        if (last !== undefined && last.label === label) last.to = i;
        else runs.push({ label, from: i, to: i });
    });
    return runs;
}
