// Prepares python/navbound/_web/coastline.txt from world-atlas (Natural Earth 1:50m, public domain; packaging ISC).
// One polyline a line: longitude latitude in thousandths of a degree, then differences.
import { readFileSync, writeFileSync } from "node:fs";
import { mesh } from "topojson-client";

const SCALE = 1000;
const read = (path) => readFileSync(new URL(path, import.meta.url), "utf8");
const version = JSON.parse(read("node_modules/world-atlas/package.json")).version;
const topology = JSON.parse(read("node_modules/world-atlas/land-50m.json"));

// The atlas closes polygons along the antimeridian and the south pole; those edges are no coast.
const artificial = ([lon, lat]) => Math.abs(lon) > 179.999 || lat < -89.9;

function* coasts(line) {
    let part = [];
    for (let i = 0; i < line.length; i++) {
        if (i > 0 && artificial(line[i]) && artificial(line[i - 1])) {
            if (part.length > 1) yield part;
            part = [];
        }
        part.push(line[i]);
    }
    if (part.length > 1) yield part;
}

function encode(line) {
    const numbers = [];
    let previous = [0, 0];
    for (const point of line) {
        const q = point.map((degrees) => Math.round(degrees * SCALE));
        if (numbers.length > 0 && q[0] === previous[0] && q[1] === previous[1]) continue;
        numbers.push(q[0] - previous[0], q[1] - previous[1]);
        previous = q;
    }
    return numbers.length > 2 ? numbers.join(" ") : null;
}

const lines = mesh(topology, topology.objects.land).coordinates.flatMap((line) => [...coasts(line)].map(encode)).filter((text) => text !== null);
const head = [`# Coastline: Natural Earth 1:50m land (public domain), from world-atlas ${version} (ISC, copyright Mike Bostock).`,
    "# One polyline a line: longitude latitude in thousandths of a degree, each point as the difference from the one before."];
writeFileSync(new URL("../python/navbound/_web/coastline.txt", import.meta.url), [...head, ...lines, ""].join("\n"));
