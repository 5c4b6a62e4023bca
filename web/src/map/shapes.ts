// Everything the map draws, put on its plane once.

import type { Scene } from "../data/scene.ts";
import type { Waypoint } from "../data/records.ts";
import { offset, plane, type Plane, type Point } from "./geometry.ts";

/** Coordinates x0, y0, x1, y1, ...; NaN where there is none. */
export type Line = Float64Array;

export interface Shapes {
    plane: Plane;
    coast: Line[];
    /** Rings; a point that an odd number of them surround is on land. */
    land: Line[];
    /** Meridians and parallels. */
    graticule: Line[];
    track: Line;
    /** Any other line of positions, on the same plane. */
    put: (lat_rad: Float64Array, lon_rad: Float64Array) => Line;
    path: Line | null;
    /** Edges of the tunnel: left and right at RNP, left and right at twice RNP. */
    tunnel: { one: [Line, Line]; two: [Line, Line] } | null;
    waypoints: { point: Point; waypoint: Waypoint }[];
    bounds: { x0: number; y0: number; x1: number; y1: number };
}

const MILLI_DEG = Math.PI / 180_000;

export function shapes(scene: Scene): Shapes | null {
    const { table, payload } = scene;
    const lat = table.column("est_lat_rad");
    const lon = table.column("est_lon_rad");
    if (lat === undefined || lon === undefined) return null;
    const middle = centre(lat, lon);
    if (middle === null) return null;
    const on = plane(middle.lat, middle.lon);
    const place = (la: number, lo: number): Point => (Number.isFinite(la) && Number.isFinite(lo) ? on.put(la, lo) : [NaN, NaN]);
    const line = (n: number, at: (i: number) => Point): Line => {
        const out = new Float64Array(2 * n);
        for (let i = 0; i < n; i++) [out[2 * i], out[2 * i + 1]] = at(i);
        return out;
    };
    const put: Shapes["put"] = (la, lo) => line(la.length, (i) => place(la[i]!, lo[i]!));
    const track = put(lat, lon);
    const pathLat = table.column("path_lat_rad");
    const pathLon = table.column("path_lon_rad");
    const path = pathLat && pathLon ? put(pathLat, pathLon) : null;
    const course = table.column("course_rad");
    const rnp = table.column("rnp_m");
    const edge = (side: number): Line => line(table.n, (i) => {
        const across = side * rnp![i]!;
        const p = offset(pathLat![i]!, pathLon![i]!, across * Math.cos(course![i]!), -across * Math.sin(course![i]!));
        return place(p.lat_rad, p.lon_rad);
    });
    const tunnel: Shapes["tunnel"] = path !== null && course && rnp ? { one: [edge(-1), edge(1)], two: [edge(-2), edge(2)] } : null;
    const waypoints = [...payload.waypoints, ...payload.airports].map((waypoint) => ({ point: place(waypoint.lat_rad, waypoint.lon_rad), waypoint }));
    const coast = payload.coastline.map((differences) => decode(differences, place));
    const land = payload.land.map((differences) => decode(differences, place));
    return { plane: on, coast, land, graticule: graticule(lat, lon, place), track, put, path, tunnel, waypoints, bounds: boundsOf([track, ...(path ? [path] : [])]) };
}

function centre(lat: Float64Array, lon: Float64Array): { lat: number; lon: number } | null {
    let [low, high, left, right, first] = [Infinity, -Infinity, Infinity, -Infinity, NaN];
    for (let i = 0; i < lat.length; i++) {
        if (!Number.isFinite(lat[i]!) || !Number.isFinite(lon[i]!)) continue;
        if (Number.isNaN(first)) first = lon[i]!;
        // Longitudes are taken around the first one, so that a track over the antimeridian has its centre on itself.
        const turned = lon[i]! - 2 * Math.PI * Math.round((lon[i]! - first) / (2 * Math.PI));
        [low, high, left, right] = [Math.min(low, lat[i]!), Math.max(high, lat[i]!), Math.min(left, turned), Math.max(right, turned)];
    }
    return low > high ? null : { lat: (low + high) / 2, lon: (left + right) / 2 };
}

function decode(differences: number[], place: (lat: number, lon: number) => Point): Line {
    const out = new Float64Array(differences.length);
    let [lon, lat] = [0, 0];
    for (let i = 0; i < differences.length; i += 2) {
        lon += differences[i]!;
        lat += differences[i + 1]!;
        [out[i], out[i + 1]] = place(lat * MILLI_DEG, lon * MILLI_DEG);
    }
    return out;
}

const DEG = Math.PI / 180;

/** Meridians and parallels around the track, about six across it. */
function graticule(lat: Float64Array, lon: Float64Array, place: (lat: number, lon: number) => Point): Line[] {
    const [south, north] = extentOf(lat);
    const [west, east] = extentOf(lon);
    const span = Math.max(north - south, (east - west) * Math.cos((north + south) / 2)) / DEG;
    // A track over the antimeridian has no span of longitudes to go by.
    if (!(span > 0) || east - west > Math.PI) return [];
    const step = [0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10, 15, 30].find((s) => span / s <= 6) ?? 30;
    const room = Math.max(span, 6 * step);
    const edges = (low: number, high: number, most: number, more: number): number[] => {
        const [from, to] = [Math.ceil(Math.max(-most, low / DEG - more) / step), Math.floor(Math.min(most, high / DEG + more) / step)];
        return Array.from({ length: Math.max(0, to - from + 1) }, (_, i) => (from + i) * step);
    };
    const lats = edges(south, north, 89, room);
    const lons = edges(west, east, 360, room / Math.max(0.2, Math.cos((north + south) / 2)));
    const trace = (points: [number, number][]): Line => Float64Array.from(points.flatMap(([la, lo]) => place(la * DEG, lo * DEG)));
    const between = (values: number[]): number[] => values.slice(0, -1).flatMap((v) => [0, 0.25, 0.5, 0.75].map((f) => v + f * step)).concat(values.slice(-1));
    return [...lats.map((la) => trace(between(lons).map((lo) => [la, lo]))), ...lons.map((lo) => trace(between(lats).map((la) => [la, lo])))];
}

function extentOf(values: Float64Array): [number, number] {
    let [low, high] = [Infinity, -Infinity];
    for (const v of values) {
        if (v < low) low = v;
        if (v > high) high = v;
    }
    return [low, high];
}

function boundsOf(lines: Line[]): Shapes["bounds"] {
    const b = { x0: Infinity, y0: Infinity, x1: -Infinity, y1: -Infinity };
    for (const line of lines) {
        for (let i = 0; i < line.length; i += 2) {
            if (!Number.isFinite(line[i]!)) continue;
            b.x0 = Math.min(b.x0, line[i]!);
            b.x1 = Math.max(b.x1, line[i]!);
            b.y0 = Math.min(b.y0, line[i + 1]!);
            b.y1 = Math.max(b.y1, line[i + 1]!);
        }
    }
    return b;
}
