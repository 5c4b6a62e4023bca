// What a person who knows satellite navigation looks at first: the sky, who was used, residuals, strength, errors.

import { epochsOf, satellitesOf } from "../data/heard.ts";
import { linkByTime, type Cursor } from "../data/link.ts";
import { blockOf, type Ground } from "../data/others.ts";
import type { Payload } from "../data/records.ts";
import type { SatelliteSummary } from "../records.gen.ts";
import { scene, type AxisName, type Scene } from "../data/scene.ts";
import { Store } from "../data/store.ts";
import { Table } from "../data/table.ts";
import { el } from "../show/dom.ts";
import { count, metres, NONE, plain, share, signedMetres } from "../show/format.ts";
import { sortable } from "../panel/sortable.ts";
import { scatter } from "./scatter.ts";
import { residuals, strength, use } from "./series.ts";
import { sky } from "./sky.ts";
import { ofSolutions, wordsOf } from "./fates.ts";

const DEG = 180 / Math.PI;

/** The charts of an evaluation's solutions, at the epochs that state a satellite; their cursor goes with that of the series. */
export async function gnssOfLevels(host: HTMLElement, payload: Payload, theme: Store<number>, series: Cursor): Promise<void> {
    const [head, ...others] = payload.heard;
    if (head === undefined) return;
    const rows = await Table.open(payload, head, blockOf(head));
    const table = epochsOf(head, rows);
    const now = scene(payload, table, theme, new Store<AxisName>("time"), new Store<Ground[]>([]), satellitesOf(rows, table));
    gnss(host, now);
    if (others.length > 0) host.querySelector("#gnss h2")!.after(el("p", { class: "note" }, `Of ${head.track}; those of ${others.map((o) => o.track).join(", ")} are in satellites.parquet.`));
    now.cursor.set(Math.floor(table.n / 2));
    linkByTime({ table, cursor: now.cursor, width_s: 0 }, series);
}

/** The charts of the track shown; nothing where its positions were not solved here. */
export function gnss(host: HTMLElement, scene: Scene): () => void {
    const { heard } = scene;
    if (heard.length === 0) return () => undefined;
    const upper = el("div", { class: "sky-pair" });
    const alone = ofSolutions(scene.payload) ? el("p", { class: "note" }, "Those of the solutions with the service's corrections. Why others that were heard are left out stands under the assumptions.") : null;
    const section = el("section", { id: "gnss" }, el("h2", {}, "Satellites"), alone, upper);
    host.append(section);
    const ends = [sky(upper, scene, heard), scatter(upper, scene), use(section, scene, heard), residuals(section, scene, heard), strength(section, scene, heard)];
    section.append(satellites(scene.payload, scene.table.track));
    return () => {
        ends.forEach((end) => end());
        section.remove();
    };
}

function satellites(payload: Payload, track: string): HTMLElement {
    const own = payload.summary.satellites.filter((s) => s.track === track || track.startsWith(`${s.track} `));
    const text = (show: (v: number) => string) => (v: number | null): string => (v === null ? NONE : show(v));
    const why = (s: SatelliteSummary): string => Object.entries(s.n_fate).map(([fate, n]) => `${wordsOf(payload, fate)} at ${count(n)}`).join("; ");
    const solutions = ofSolutions(payload);
    const number = (head: string, key: keyof SatelliteSummary & string, show: (v: number | null) => string) => ({ head, key, of: (s: SatelliteSummary) => s[key] as number | null, show: (s: SatelliteSummary) => show(s[key] as number | null) });
    return sortable<SatelliteSummary>({
        id: "satellites", caption: "Satellites", rows: own, sortable: true,
        columns: [
            { head: "Satellite", key: "sv", words: true, of: (s) => s.sv, show: (s) => s.sv },
            ...(solutions ? [number("Epochs used", "n_used", count)] : [
                number("Epochs heard", "n_heard", count), number("used", "n_used", count),
                { head: "Used, of heard", key: "share_used", of: (s: SatelliteSummary) => s.n_used / s.n_heard, show: (s: SatelliteSummary) => share(s.n_used / s.n_heard) },
            ]),
            number("Highest", "el_max_rad", text((v) => `${plain(v * DEG, 0)}°`)), number("Residual, root mean square", "residual_rms_m", metres), number("Largest", "residual_most_m", signedMetres),
            ...(own.every((s) => s.cn0_mean_dbhz === null) ? [] : [number("C/N0, mean", "cn0_mean_dbhz", text((v) => `${plain(v, 1)} dB-Hz`)), number("lowest", "cn0_min_dbhz", text((v) => `${plain(v, 1)} dB-Hz`))]),
            ...(solutions ? [] : [{ head: "Not used because", key: "why", words: true, of: why, show: (s: SatelliteSummary) => why(s) || "always used" }]),
        ],
    });
}
