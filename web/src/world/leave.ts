// The map as a file of its own: a figure with a heading, the colours and what they mean, as SVG or PNG.

import { el, svg } from "../show/dom.ts";
import { INK } from "./isolines.ts";

export interface Key {
    fill: string;
    /** Of a line instead of a class: its dashes. */
    dashes?: string;
    words: string;
    /** Share of the area, as text; a line has none. */
    part: string;
}

export interface Caption {
    title: string;
    layer: string;
    colours: { ink: string; muted: string; ground: string };
}

const EXPORT_WIDTH = 2000;
const WIDTH = 1000;
const MARGIN = 46;
const HEAD = 52;
const LINE = 22;
const FONT = 12;
/** Width of a letter of the usual fonts, a little on the safe side, over the size of the font. */
const LETTER = 0.6;
const BOX = 18;

/** The drawing between a heading and its colours, 1000 units wide. */
export function figure(drawing: SVGSVGElement, keys: Key[], caption: Caption): SVGSVGElement {
    const { ink, muted, ground } = caption.colours;
    const body = drawing.viewBox.baseVal.height;
    const places = flow(keys.map((k) => `${k.words} ${k.part}`));
    const height = HEAD + body + LINE * (1 + Math.max(0, ...places.map((p) => p.line))) + 30;
    const map = svg("g", { transform: `translate(0 ${HEAD})` }, ...[...drawing.cloneNode(true).childNodes].map((n) => n as Element));
    const legend = keys.map((key, i) => {
        const { x, line } = places[i]!;
        const y = HEAD + body + 12 + line * LINE;
        return svg("g", {},
            svg("rect", { x, y, width: BOX, height: FONT, fill: key.fill, stroke: muted, "stroke-width": 0.5 }),
            ...(key.dashes === undefined ? [] : [svg("path", { d: `M${x} ${y + FONT / 2}h${BOX}`, stroke: INK, "stroke-width": 1.4, "stroke-dasharray": key.dashes })]),
            svg("text", { x: x + BOX + 6, y: y + FONT - 1.5, "font-size": FONT, fill: ink }, key.words, svg("tspan", { fill: muted, dx: 5 }, key.part)));
    });
    const note = svg("text", { x: WIDTH - 8, y: height - 6, "font-size": 10, fill: muted, "text-anchor": "end" }, "beside each colour its share of the area · navbound · coastline: Natural Earth; not for navigation");
    return svg("svg", { viewBox: `0 0 ${WIDTH} ${height.toFixed(1)}`, xmlns: "http://www.w3.org/2000/svg", "font-family": "system-ui, sans-serif" },
        svg("rect", { width: WIDTH, height, fill: ground }),
        svg("text", { x: MARGIN, y: 20, "font-size": 16, "font-weight": 600, fill: ink }, caption.layer),
        svg("text", { x: MARGIN, y: 40, "font-size": FONT, fill: muted }, caption.title),
        map, ...legend, note);
}

/** Where each entry of a legend begins, line after line. */
export function flow(texts: string[]): { x: number; line: number }[] {
    let [x, line] = [MARGIN, 0];
    return texts.map((text) => {
        const width = BOX + 6 + text.length * FONT * LETTER + 22;
        if (x > MARGIN && x + width > WIDTH) [x, line] = [MARGIN, line + 1];
        const at = { x, line };
        x += width;
        return at;
    });
}

/** Hands a figure to the browser as a file. */
export async function leave(drawing: SVGSVGElement, name: string, kind: "svg" | "png"): Promise<void> {
    const text = new XMLSerializer().serializeToString(drawing);
    const blob = kind === "svg" ? new Blob([text], { type: "image/svg+xml" }) : await raster(text, drawing.viewBox.baseVal);
    const link = el("a", { href: URL.createObjectURL(blob), download: `${name}.${kind}` });
    link.click();
    URL.revokeObjectURL(link.href);
}

async function raster(text: string, box: { width: number; height: number }): Promise<Blob> {
    const image = new Image();
    const [width, height] = [EXPORT_WIDTH, Math.round((EXPORT_WIDTH * box.height) / box.width)];
    // Without a size of its own an image of vectors has none on a canvas.
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text.replace("<svg ", `<svg width="${width}" height="${height}" `))}`;
    await image.decode();
    const canvas = el("canvas", { width, height });
    canvas.getContext("2d")!.drawImage(image, 0, 0, width, height);
    return new Promise((done, failed) => canvas.toBlob((blob) => (blob === null ? failed(new Error("no image")) : done(blob)), "image/png"));
}
