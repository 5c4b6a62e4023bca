// Reverses python/navbound/report/packing.py: base64, deflate, byte planes, differences, quantisation.

export interface PackedColumn {
    name: string;
    kind: "linear" | "log10";
    resolution: number;
    offset: number;
    order: number;
}

const NULL = -(2 ** 31);
const ZERO = NULL + 1;

export async function inflate(base64: string): Promise<Uint8Array> {
    const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Columns of one track, all or some of them; a value that does not exist is NaN. */
export function unpack(bytes: Uint8Array, columns: PackedColumn[], n: number, names?: string[]): Map<string, Float64Array> {
    if (bytes.length !== columns.length * n * 4) {
        throw new RangeError(`${bytes.length} bytes do not hold ${columns.length} columns of ${n} values`);
    }
    const take = columns.map((column, i) => ({ column, i })).filter(({ column }) => names?.includes(column.name) ?? true);
    return new Map(take.map(({ column, i }) => [column.name, unpackColumn(bytes.subarray(i * n * 4, (i + 1) * n * 4), column, n)]));
}

function unpackColumn(planes: Uint8Array, column: PackedColumn, n: number): Float64Array {
    const q = new Int32Array(n);
    for (let i = 0; i < n; i++) {
        const word = (planes[i]! | (planes[n + i]! << 8) | (planes[2 * n + i]! << 16) | (planes[3 * n + i]! << 24)) >>> 0;
        q[i] = (word >>> 1) ^ -(word & 1);
    }
    // Sums wrap modulo 2^32 as the differences did: an Int32Array does that by itself.
    for (let pass = 0; pass < column.order; pass++) {
        for (let i = 1; i < n; i++) q[i] = q[i]! + q[i - 1]!;
    }
    return Float64Array.from(q, (value) => {
        if (value === NULL) return NaN;
        if (value === ZERO) return 0;
        const linear = column.offset + value * column.resolution;
        return column.kind === "log10" ? 10 ** linear : linear;
    });
}
