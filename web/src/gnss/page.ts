// What a person who knows satellite navigation looks at first: the sky, who was used, residuals, strength, errors.

import type { Payload } from "../data/records.ts";
import type { SatelliteSummary } from "../records.gen.ts";
import type { Scene } from "../data/scene.ts";
import { el } from "../show/dom.ts";
import { count, metres, NONE, plain, share, signedMetres } from "../show/format.ts";
import { sortable } from "../panel/sortable.ts";
import { scatter } from "./scatter.ts";
import { residuals, strength, use } from "./series.ts";
import { sky } from "./sky.ts";
import { wordsOf } from "./fates.ts";

const DEG = 180 / Math.PI;

/** The charts of the track shown; nothing where its positions were not solved here. */
export function gnss(host: HTMLElement, scene: Scene): () => void {
    const { heard } = scene;
    if (heard.length === 0) return () => undefined;
    const upper = el("div", { class: "sky-pair" });
    const section = el("section", { id: "gnss" }, el("h2", {}, "Satellites"), upper);
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
    const number = (head: string, key: keyof SatelliteSummary & string, show: (v: number | null) => string) => ({ head, key, of: (s: SatelliteSummary) => s[key] as number | null, show: (s: SatelliteSummary) => show(s[key] as number | null) });
    return sortable<SatelliteSummary>({
        id: "satellites", caption: "Satellites", rows: own, sortable: true,
        columns: [
            { head: "Satellite", key: "sv", words: true, of: (s) => s.sv, show: (s) => s.sv },
            number("Epochs heard", "n_heard", count), number("used", "n_used", count),
            { head: "Used, of heard", key: "share_used", of: (s) => s.n_used / s.n_heard, show: (s) => share(s.n_used / s.n_heard) },
            number("Highest", "el_max_rad", text((v) => `${plain(v * DEG, 0)}°`)), number("Residual, root mean square", "residual_rms_m", metres), number("Largest", "residual_most_m", signedMetres),
            number("C/N0, mean", "cn0_mean_dbhz", text((v) => `${plain(v, 1)} dB-Hz`)), number("lowest", "cn0_min_dbhz", text((v) => `${plain(v, 1)} dB-Hz`)),
            { head: "Not used because", key: "why", words: true, of: why, show: (s) => why(s) || "always used" },
        ],
    });
}
