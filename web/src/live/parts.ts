// What the parts of the display have in common.

import { metres, NONE, signedMetres } from "../show/format.ts";
import type { Model } from "./state.ts";

/** A part of the page: built once, shown again with every change. */
export interface Part {
    element: HTMLElement;
    show: (model: Model, now_s: number) => void;
}

/** No number: never 0, never the last one. */
export const DASHES = "---";

export function dashed(text: string): string {
    return text === NONE ? DASHES : text;
}

export const length = (v: number): string => dashed(metres(v));
export const signed = (v: number): string => dashed(signedMetres(v));

/** Sets a text only where it changes, so that what is read aloud is read once. */
export function say(element: HTMLElement, text: string): void {
    if (element.textContent !== text) element.textContent = text;
}

/** Minutes and seconds. */
export function span(seconds: number): string {
    const whole = Math.max(0, Math.floor(seconds));
    return `${String(Math.floor(whole / 60)).padStart(2, "0")}:${String(whole % 60).padStart(2, "0")}`;
}
