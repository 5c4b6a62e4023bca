// Numbers as people read them. The full value stays in a data attribute beside the text.

import { METRES_PER_NM } from "../data/scene.ts";

export const NONE = "n/a";
const MINUS = "\u2212";
const THIN = "\u202f";

/** Decimals chosen so that three to five digits are shown. */
function decimals(magnitude: number): number {
    if (magnitude >= 1000) return 0;
    if (magnitude >= 100) return 1;
    return magnitude >= 1 ? 2 : 3;
}

export function plain(value: number, digits: number): string {
    if (!Number.isFinite(value)) return NONE;
    const text = Math.abs(value).toFixed(digits);
    const [whole, fraction] = text.split(".") as [string, string | undefined];
    const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, THIN) : whole;
    const sign = value < 0 && Number(text) !== 0 ? MINUS : "";
    return `${sign}${grouped}${fraction === undefined ? "" : `.${fraction}`}`;
}

export function metres(value: number | null | undefined): string {
    if (value == null || !Number.isFinite(value)) return NONE;
    return `${plain(value, decimals(Math.abs(value)))} m`;
}

/** Limits are round: "40 m", not "40.00 m". */
export function wholeMetres(value: number): string {
    return metres(value).replace(/\.0+ m$/, " m");
}

export function signedMetres(value: number | null | undefined): string {
    if (value == null || !Number.isFinite(value)) return NONE;
    return value > 0 ? `+${metres(value)}` : metres(value);
}

export function nauticalMiles(value_m: number | null | undefined, digits?: number): string {
    if (value_m == null || !Number.isFinite(value_m)) return NONE;
    const nm = value_m / METRES_PER_NM;
    return `${plain(nm, digits ?? (Math.abs(nm) >= 100 ? 1 : Math.abs(nm) >= 1 ? 2 : 3))} NM`;
}

/** Limits below it are spoken of in metres. */
export const SHORT_M = 50;

/** A limit in the unit that it is spoken of in. */
export function limitName(value_m: number | null | undefined): string {
    return value_m != null && value_m < SHORT_M ? wholeMetres(value_m) : nauticalMiles(value_m);
}

/** RNP values are names as much as numbers: "RNP 0.3". */
export function rnpName(value_m: number): string {
    // A requirement of some metres is not said in miles.
    if (value_m < SHORT_M) return `RNP ${wholeMetres(value_m)}`;
    return Number.isFinite(value_m) ? `RNP ${Number((value_m / METRES_PER_NM).toFixed(3))}` : NONE;
}

const SUPERSCRIPT: Record<string, string> = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

export function powerOfTen(exponent: number): string {
    return `10${[...String(exponent)].map((c) => SUPERSCRIPT[c]).join("")}`;
}

export function risk(value: number | null | undefined): string {
    if (value == null || !Number.isFinite(value)) return NONE;
    // Smaller ones say nothing more: no model of errors is known so far.
    if (value < 1e-12) return `< ${powerOfTen(-12)}`;
    if (value >= 1e-3) return String(Number(value.toPrecision(3)));
    let exponent = Math.floor(Math.log10(value));
    let mantissa = (value / 10 ** exponent).toFixed(1);
    if (mantissa === "10.0") {
        mantissa = "1.0";
        exponent += 1;
    }
    return mantissa === "1.0" ? powerOfTen(exponent) : `${mantissa} × ${powerOfTen(exponent)}`;
}

/** "95 %" for a risk of 0.05, "risk 10⁻⁵" where a percentage would be all nines. */
export function level(value: number): string {
    return value >= 1e-3 ? `${Number((100 * (1 - value)).toFixed(3))} %` : `risk ${risk(value)}`;
}

/** A share is never rounded up to 100 % nor down to 0 %. */
export function share(value: number | null | undefined): string {
    if (value == null || !Number.isFinite(value)) return NONE;
    const percent = 100 * value;
    if (percent === 0 || percent === 100) return `${percent} %`;
    for (let digits = 2; digits < 7; digits++) {
        const text = percent.toFixed(digits);
        // What is missing to 0 or 100 % is what matters: it is shown to a twentieth of itself.
        if (Math.abs(Number(text) - percent) <= Math.min(percent, 100 - percent) / 20) return `${text} %`;
    }
    return percent > 50 ? "> 99.999999 %" : "< 0.000001 %";
}

export function clock(utc_s: number, fraction = false): string {
    if (!Number.isFinite(utc_s)) return NONE;
    const text = new Date(Math.round(utc_s * 1000)).toISOString();
    return fraction && text.slice(20, 23) !== "000" ? text.slice(11, 23) : text.slice(11, 19);
}

export function date(utc_s: number): string {
    return Number.isFinite(utc_s) ? new Date(utc_s * 1000).toISOString().slice(0, 10) : NONE;
}

export function duration(seconds: number | null | undefined): string {
    if (seconds == null || !Number.isFinite(seconds)) return NONE;
    const whole = Math.round(seconds);
    // Periods found by division miss the whole second by a rounding.
    if (seconds < 120) return `${plain(seconds, Math.abs(seconds - whole) < 1e-6 ? 0 : 1)} s`;
    const h = Math.floor(whole / 3600);
    const m = Math.floor((whole % 3600) / 60);
    return h > 0 ? `${h} h ${String(m).padStart(2, "0")} min` : `${m} min ${String(whole % 60).padStart(2, "0")} s`;
}

export function degrees(rad: number, positive: string, negative: string): string {
    if (!Number.isFinite(rad)) return NONE;
    return `${Math.abs((rad * 180) / Math.PI).toFixed(5)}° ${rad < 0 ? negative : positive}`;
}

export function place(lat_rad: number, lon_rad: number): string {
    return `${degrees(lat_rad, "N", "S")}, ${degrees(lon_rad, "E", "W")}`;
}

export function count(value: number | null | undefined): string {
    return value == null ? NONE : plain(value, Number.isInteger(value) ? 0 : 1);
}
