// What the server of the workbench says, as it says it.

export interface Field {
    name: string;
    flag: string;
    help: string;
    kind: "text" | "integer" | "number" | "flag" | "file" | "run" | "out" | "parts";
    several: "" | "repeated" | "commas";
    required: boolean;
    default: string;
    choices: [string, string][];
    search: "" | "runways" | "procedures";
    free: string;
    typed: boolean;
    first: boolean;
    files: boolean;
    when: [string, string[]] | null;
}

export interface Form {
    command: string;
    summary: string;
    fields: Field[];
}

export interface Workbench {
    folder: string;
    version: string;
    forms: Form[];
    limits: { most_file_bytes: number; left_bytes: number };
}

export interface FileRow {
    name: string;
    n_bytes: number;
    changed_ns: number;
    words: string;
    refused: boolean;
}

export interface Run {
    id: string;
    name: string;
    ended_s: number;
    title: string;
    words: string;
    verdict: string;
    command: string;
    trouble: string;
    page: string;
    comparable: boolean;
}

export type Value = string | boolean | string[];
export type Values = Record<string, Value>;

export interface Job {
    id: number;
    command: string;
    values: Values;
    line: string;
    out: string;
    state: "running" | "stopping" | "done" | "no_verdict" | "failed" | "stopped";
    words: string;
    began_s: number;
    ended_s: number | null;
    progress: { what: string; done: number; total: number } | null;
}

export interface State {
    jobs: Job[];
    changes: number;
    now_s: number;
}

export interface Answer {
    refused?: string;
    field?: string;
    line?: string;
    python?: string;
    job?: Job;
    name?: string;
}

const UNITS: Record<string, string> = { s: "s", m: "m", deg: "°", nm: "NM" };

/** The name of a field for a person: `rnp_nm` is `RNP, NM`. */
export function label(field: Field): string {
    const words = (field.flag === "" ? field.name : field.flag.replace(/^--/, "")).replaceAll("-", "_").split("_");
    const unit = words.length > 1 ? UNITS[words.at(-1)!] : undefined;
    const shown = (unit === undefined ? words : words.slice(0, -1)).map((word) => (/^(rnp|fte|prn|esa)$/.test(word) ? word.toUpperCase() : word)).join(" ");
    return shown.charAt(0).toUpperCase() + shown.slice(1) + (unit === undefined ? "" : `, ${unit}`);
}

/** The help of a field with other options under the names that the page has for them. */
export function helpOf(field: Field, fields: Field[]): string {
    return field.help.replace(/--[a-z][a-z-]*/g, (flag) => {
        const other = fields.find((each) => each.flag === flag);
        return other === undefined ? flag : `“${label(other)}”`;
    });
}

/** What is requested first; the rest stands under "More options". */
export function isMain(field: Field): boolean {
    if (field.kind === "out" || field.kind === "parts") return false;
    if (field.first || field.required || field.search !== "" || field.files || field.kind === "file") return true;
    return field.choices.some(([, words]) => words !== "") && !(field.several === "commas" && field.default !== "");
}

export function size(n_bytes: number): string {
    if (n_bytes < 1e3) return `${n_bytes} B`;
    const [value, unit] = n_bytes < 1e6 ? [n_bytes / 1e3, "kB"] : n_bytes < 1e9 ? [n_bytes / 1e6, "MB"] : [n_bytes / 1e9, "GB"];
    return `${value.toFixed(value < 10 ? 1 : 0)} ${unit}`;
}

export function moment(utc_s: number): string {
    return `${new Date(utc_s * 1000).toISOString().slice(0, 16).replace("T", " ")} UTC`;
}

export function elapsed(seconds: number): string {
    const whole = Math.max(0, Math.round(seconds));
    if (whole < 60) return `${whole} s`;
    if (whole < 3600) return `${Math.floor(whole / 60)} min ${whole % 60} s`;
    return `${Math.floor(whole / 3600)} h ${Math.floor((whole % 3600) / 60)} min`;
}

/** Seconds that are left, where the work says how far it is and has done enough to tell. */
export function left(job: Job, now_s: number): number | null {
    const reported = job.progress;
    if (reported === null || reported.total < 5 || reported.done < 2 || reported.done >= reported.total) return null;
    return ((now_s - job.began_s) * (reported.total - reported.done)) / reported.done;
}

const STATES: Record<Job["state"], string> = {
    running: "running", stopping: "stopping", done: "done", no_verdict: "done, without a verdict", failed: "refused", stopped: "stopped",
};

export function stateWords(job: Job): string {
    return STATES[job.state];
}
