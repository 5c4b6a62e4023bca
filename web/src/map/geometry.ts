// Places on the map plane and lines clipped to the screen: pure functions.

import { geoAzimuthalEquidistant } from "d3-geo";

const A_M = 6378137;
const E2 = 0.00669437999014133;

export type Point = [number, number];

/** Plane of the map: radians from a centre, y downwards. True in every direction from the centre. */
export interface Plane {
    put: (lat_rad: number, lon_rad: number) => Point;
    back: (x: number, y: number) => { lat_rad: number; lon_rad: number };
}

export function plane(lat_rad: number, lon_rad: number): Plane {
    const deg = 180 / Math.PI;
    const projection = geoAzimuthalEquidistant().rotate([-lon_rad * deg, -lat_rad * deg]).scale(1).translate([0, 0]).precision(0);
    return {
        put: (lat, lon) => projection([lon * deg, lat * deg]) ?? [NaN, NaN],
        back: (x, y) => {
            const [lon, lat] = projection.invert?.([x, y]) ?? [NaN, NaN];
            return { lat_rad: lat / deg, lon_rad: lon / deg };
        },
    };
}

/** Radii of curvature of the WGS-84 ellipsoid: metres per radian of latitude and of longitude. */
export function metresPerRadian(lat_rad: number): { north: number; east: number } {
    const w2 = 1 - E2 * Math.sin(lat_rad) ** 2;
    return { north: (A_M * (1 - E2)) / w2 ** 1.5, east: (A_M / Math.sqrt(w2)) * Math.cos(lat_rad) };
}

/** A point some metres east and north of another; for lengths far smaller than the Earth. */
export function offset(lat_rad: number, lon_rad: number, east_m: number, north_m: number): { lat_rad: number; lon_rad: number } {
    const per = metresPerRadian(lat_rad);
    return { lat_rad: lat_rad + north_m / per.north, lon_rad: lon_rad + east_m / per.east };
}

/** The part of a segment inside a rectangle (Liang and Barsky), or null. */
export function clipSegment(x0: number, y0: number, x1: number, y1: number, w: number, h: number, room: number): [number, number, number, number] | null {
    let [t0, t1] = [0, 1];
    const [dx, dy] = [x1 - x0, y1 - y0];
    for (const [p, q] of [[-dx, x0 + room], [dx, w + room - x0], [-dy, y0 + room], [dy, h + room - y0]] as Point[]) {
        if (p === 0) {
            if (q < 0) return null;
            continue;
        }
        const r = q / p;
        if (p < 0) t0 = Math.max(t0, r);
        else t1 = Math.min(t1, r);
        if (t0 > t1) return null;
    }
    return [x0 + t0 * dx, y0 + t0 * dy, x0 + t1 * dx, y0 + t1 * dy];
}

/** Semi-axes and direction of the ellipse that holds a share of a two-dimensional Gaussian; angle of the major axis from east. */
export function ellipse(ee: number, en: number, nn: number, risk: number): { major_m: number; minor_m: number; angle_rad: number } {
    const mean = (ee + nn) / 2;
    const half = Math.hypot((ee - nn) / 2, en);
    const k = Math.sqrt(-2 * Math.log(risk));
    return { major_m: k * Math.sqrt(mean + half), minor_m: k * Math.sqrt(Math.max(0, mean - half)), angle_rad: 0.5 * Math.atan2(2 * en, ee - nn) };
}

/** The largest of 1, 2, 5 times a power of ten that is not above a length. */
export function roundDown(length: number): number {
    const step = 10 ** Math.floor(Math.log10(length));
    return ([5, 2, 1].find((f) => f * step <= length) ?? 1) * step;
}
