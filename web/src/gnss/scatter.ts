// Horizontal errors as points, east and north, with the ellipse that the covariance claims at the cursor.

import type { Scene } from "../data/scene.ts";
import { el, valueOf } from "../show/dom.ts";
import { level, metres, signedMetres, wholeMetres } from "../show/format.ts";
import { colour } from "../show/theme.ts";
import { ellipse, roundDown } from "../map/geometry.ts";

const FONT = '11px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';
/** Share of the errors that the picture is made for; those beyond stand at its edge. */
const SHOWN = 0.995;
/** Share of the ellipses that fit it. */
const MOST_ELLIPSES = 0.9;

export function scatter(host: HTMLElement, scene: Scene): () => void {
    const { table, payload } = scene;
    const [east, north] = [table.column("nse_e_m"), table.column("nse_n_m")];
    if (east === undefined || north === undefined) return () => undefined;
    const risk = payload.record.risk_accuracy;
    const canvas = el("canvas", { "aria-hidden": "true" });
    const words = el("p", { class: "note" });
    const figure = el("figure", { class: "chart scatter", id: "scatter" }, el("div", { class: "chart-head" }, el("h3", {}, "Horizontal error")),
        el("figcaption", {}, `True minus estimated position at every epoch, east and north. The ellipse is what the covariance claims for ${level(risk)} at the cursor.`), canvas, words);
    host.append(figure);
    const sizes = Float64Array.from(east, (e, i) => Math.max(Math.abs(e), Math.abs(north[i]!))).filter(Number.isFinite).sort();
    const claimed = (i: number): ReturnType<typeof ellipse> => ellipse(table.value("cov_ee_m2", i), table.value("cov_en_m2", i), table.value("cov_nn_m2", i), risk);
    const majors = Float64Array.from(east, (_, i) => claimed(i).major_m).filter(Number.isFinite).sort();
    const reach = 1.15 * Math.max(sizes[Math.floor(SHOWN * (sizes.length - 1))] ?? 1, majors[Math.floor(MOST_ELLIPSES * (majors.length - 1))] ?? 0, 1e-3);

    const paint = (): void => {
        const side = canvas.clientWidth;
        const pen = canvas.getContext("2d");
        if (pen === null || side === 0) return;
        canvas.width = canvas.height = Math.round(side * devicePixelRatio);
        pen.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
        const at = (e: number, n: number): [number, number] => [side / 2 + (Math.max(-reach, Math.min(reach, e)) * side) / 2 / reach, side / 2 - (Math.max(-reach, Math.min(reach, n)) * side) / 2 / reach];
        grid(pen, side, reach, at);
        pen.fillStyle = colour("ink");
        pen.globalAlpha = east.length > 3000 ? 0.25 : 0.5;
        for (let i = 0; i < east.length; i++) {
            if (!Number.isFinite(east[i]!)) continue;
            const [x, y] = at(east[i]!, north[i]!);
            pen.fillRect(x - 1, y - 1, 2, 2);
        }
        pen.globalAlpha = 1;
        const i = scene.cursor.get();
        const e = claimed(i);
        if (Number.isFinite(e.major_m)) {
            pen.strokeStyle = colour("m1");
            pen.lineWidth = 1.75;
            pen.beginPath();
            pen.ellipse(side / 2, side / 2, (e.major_m * side) / 2 / reach, (e.minor_m * side) / 2 / reach, -e.angle_rad, 0, 2 * Math.PI);
            pen.stroke();
        }
        if (Number.isFinite(east[i]!)) {
            const [x, y] = at(east[i]!, north[i]!);
            pen.fillStyle = colour("path");
            pen.beginPath();
            pen.arc(x, y, 4.5, 0, 2 * Math.PI);
            pen.fill();
        }
        words.replaceChildren("At the cursor: ", valueOf("nse_e_m", east[i]!, signedMetres(east[i])), " east, ", valueOf("nse_n_m", north[i]!, signedMetres(north[i])), ` north; ellipse ${metres(e.major_m)} by ${metres(e.minor_m)}.`);
    };
    const resize = new ResizeObserver(paint);
    resize.observe(canvas);
    const ends = [scene.cursor.watch(paint), scene.theme.watch(paint)];
    return () => {
        ends.forEach((end) => end());
        resize.disconnect();
        figure.remove();
    };
}

function grid(pen: CanvasRenderingContext2D, side: number, reach: number, at: (e: number, n: number) => [number, number]): void {
    const step = roundDown(reach / 1.5);
    pen.font = FONT;
    pen.fillStyle = colour("muted");
    pen.textBaseline = "top";
    for (let v = -Math.floor(reach / step) * step; v <= reach; v += step) {
        const [x, y] = at(v, v);
        pen.strokeStyle = colour(Math.abs(v) < step / 2 ? "muted" : "rule");
        pen.lineWidth = 1;
        pen.beginPath();
        pen.moveTo(x, 0);
        pen.lineTo(x, side);
        pen.moveTo(0, y);
        pen.lineTo(side, y);
        pen.stroke();
        if (Math.abs(v) > step / 2) {
            pen.fillText(wholeMetres(v), x + 3, side / 2 + 3);
            pen.fillText(wholeMetres(v), side / 2 + 4, y + 2);
        }
    }
    pen.fillText("north", side / 2 + 4, 2);
    pen.fillText("east", side - 28, side / 2 - 14);
}
