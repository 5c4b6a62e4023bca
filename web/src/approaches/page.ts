// Approaches beside each other: runway by runway, and by operator.

import type { DeviationBand, DeviationGroup } from "../records.gen.ts";
import type { Payload } from "../data/records.ts";
import type { Store } from "../data/store.ts";
import { choice, el, svg } from "../show/dom.ts";
import { count, metres, NONE, plain, share, signedMetres, wholeMetres } from "../show/format.ts";
import { sortable } from "../panel/sortable.ts";
import { flownOf, type Flown } from "./flown.ts";
import { overlay } from "./overlay.ts";

/** Nothing where fewer than two approaches lead to a runway: there is nothing to lay over one another. */
export function approaches(host: HTMLElement, payload: Payload, theme: Store<number>, choose: (track: string) => void): void {
    const { bands, groups, phases } = payload.summary;
    const runways = [...new Set(bands.filter((b) => b.n_tracks > 1).map((b) => b.runway))];
    if (runways.length === 0) return;
    const pictures = el("div", { class: "overlays" });
    const several = runways.length > 1 && runways.length <= 8;
    const pick = several ? choice("Runway", runways.map((r) => [r, r] as [string, string]), runways[0]!, (r) => show(r)) : runways.length > 1 ? select(runways, (r) => show(r)) : null;
    const section = el("section", { id: "approaches" }, el("div", { class: "section-head" }, el("h2", {}, "Approaches"), pick), pictures,
        ...tables(payload, groups, choose));
    host.append(section);
    let ends: (() => void)[] = [];
    let flown: Flown[] = [];
    let runway = runways[0]!;
    const limits = new Set(phases.map((p) => p.rnp_m));
    const limit = limits.size === 1 ? [...limits][0]! : null;
    const show = (of: string): void => {
        runway = of;
        ends.forEach((end) => end());
        pictures.replaceChildren();
        const own = bands.filter((b) => b.runway === of);
        const tracks = flown.filter((f) => f.runway === of);
        ends = own.map((band) => overlay(pictures, band, tracks, limit, theme, choose));
        for (const band of own) if (band.counts.length > 0) pictures.append(histogram(band));
    };
    show(runway);
    void flownOf(payload).then((read) => { flown = read; show(runway); pictures.dataset.tracks = String(read.length); });
}

function select(runways: string[], choose: (runway: string) => void): HTMLElement {
    const box = el("select", { "aria-label": "Runway" }, ...runways.map((r) => el("option", { value: r }, r)));
    box.addEventListener("change", () => choose(box.value));
    return box;
}

/** Counts of the deviations; epochs beyond the edges stand in the outer bins. */
export function histogram(band: DeviationBand): HTMLElement {
    const [width, height, floor] = [480, 150, 128];
    const most = Math.max(...band.counts);
    const [from, to] = [band.edges_m[0]!, band.edges_m.at(-1)!];
    const x = (v: number): number => ((v - from) / (to - from)) * width;
    const bars = band.counts.map((n, i) => svg("rect", { x: x(band.edges_m[i]!) + 0.5, y: floor - (n / most) * (floor - 6), width: width / band.counts.length - 1, height: (n / most) * (floor - 6), class: "pit-bar" }));
    const ticks = [from, from / 2, 0, to / 2, to].map((v, i) => svg("text", { x: x(v), y: floor + 16, "text-anchor": i === 0 ? "start" : i === 4 ? "end" : "middle" }, wholeMetres(Number(v.toPrecision(3)))));
    const total = band.counts.reduce((a, b) => a + b, 0);
    const name = band.column === "fte_m" ? "lateral" : "vertical";
    const fullest = band.counts.indexOf(most);
    const words = `${count(total)} epochs; the fullest bin, ${signedMetres(band.edges_m[fullest]!)} to ${signedMetres(band.edges_m[fullest + 1]!)}, holds ${count(most)}.`;
    return el("figure", { class: "chart histogram pit" }, el("div", { class: "chart-head" }, el("h3", {}, `Distribution of the ${name} deviation`)),
        svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": words }, ...bars, svg("line", { x1: 0, x2: width, y1: floor, y2: floor, class: "pit-axis" }), svg("line", { x1: x(0), x2: x(0), y1: 0, y2: floor, class: "pit-axis", "stroke-dasharray": "3 3" }), ...ticks),
        el("figcaption", {}, words));
}

function tables(payload: Payload, groups: DeviationGroup[], choose: (track: string) => void): HTMLElement[] {
    const embedded = new Set(payload.tracks.map((t) => t.track));
    const labels = new Map(payload.summary.tracks.map((t) => [t.track, t.label]));
    const one = (by: DeviationGroup["by"], id: string, caption: string, head: string): HTMLElement[] => {
        const rows = groups.filter((g) => g.by === by);
        if (rows.length === 0) return [];
        return [sortable<DeviationGroup>({
            id, caption, rows, sortable: rows.length > 1, press: (g) => choose(g.most_track), pressable: (g) => embedded.has(g.most_track),
            columns: [
                { head, key: "name", words: true, of: (g) => g.name, show: (g) => g.name, title: (g) => `Shows the approach with the largest deviation, ${labels.get(g.most_track) ?? g.most_track}` },
                { head: "Approaches", key: "n_tracks", of: (g) => g.n_tracks, show: (g) => count(g.n_tracks) }, { head: "Epochs", key: "n_epochs", of: (g) => g.n_epochs, show: (g) => count(g.n_epochs) },
                { head: "Mean", key: "mean_m", of: (g) => g.mean_m, show: (g) => signedMetres(g.mean_m) }, { head: "Std", key: "std_m", of: (g) => g.std_m, show: (g) => metres(g.std_m) },
                { head: "|deviation| 95 %", key: "abs95_m", of: (g) => g.abs95_m, show: (g) => metres(g.abs95_m) },
                { head: "Largest", key: "most_m", of: (g) => Math.abs(g.most_m), show: (g) => signedMetres(g.most_m) }, { head: "of", key: "most_track", words: true, of: (g) => g.most_track, show: (g) => labels.get(g.most_track) ?? g.most_track },
                { head: "Within RNP", key: "share_inside", of: (g) => g.share_inside, show: (g) => share(g.share_inside) },
                { head: "Bound / RNP, worst", key: "worst_ratio", of: (g) => g.worst_ratio, show: (g) => (g.worst_ratio === null ? NONE : plain(g.worst_ratio, 3)) },
            ],
        })];
    };
    return [...one("runway", "by-runway", "By runway; press one to see the approach that deviates most", "Runway"), ...one("operator", "by-operator", "By operator, as the first three letters of the callsign name it", "Operator")];
}
