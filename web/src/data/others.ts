// Where the other embedded tracks went: read once, after the first picture stands.

import { inflate, unpack } from "./packing.ts";
import type { PackedTrack, Payload } from "./records.ts";
import { Store } from "./store.ts";

export interface Ground {
    track: string;
    lat_rad: Float64Array;
    lon_rad: Float64Array;
    /** Epochs after which no line goes on. */
    breaks: number[];
}

/** Text block of an embedded track. */
export function blockOf(head: PackedTrack): string {
    return document.getElementById(`navbound-track-${head.block}`)!.textContent;
}

/** Fills a store with the positions of all embedded tracks, where there are several. */
export function groundTracks(payload: Payload): Store<Ground[]> {
    const store = new Store<Ground[]>([]);
    if (payload.tracks.length > 1) void Promise.all(payload.tracks.map(ground)).then((grounds) => store.set(grounds.filter((g) => g !== null)));
    return store;
}

async function ground(head: PackedTrack): Promise<Ground | null> {
    const columns = unpack(await inflate(blockOf(head)), head.columns, head.n, ["est_lat_rad", "est_lon_rad"]);
    const [lat_rad, lon_rad] = [columns.get("est_lat_rad"), columns.get("est_lon_rad")];
    return lat_rad === undefined || lon_rad === undefined ? null : { track: head.track, lat_rad, lon_rad, breaks: head.breaks };
}
