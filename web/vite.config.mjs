import { defineConfig } from "vite";

// What is built, by mode: the report (the default), the live display, the workbench, and the worker that keeps its time. Each is one script and at most one
// style sheet with fixed names: pages take them as they are, and CI compares them byte for byte. The report's notices hold those of all.
const BUNDLES = {
    production: { entry: "src/report.ts", name: "report", license: { fileName: "third-party.md" } },
    live: { entry: "src/live/main.ts", name: "live" },
    fleet: { entry: "src/fleet/main.ts", name: "fleet" },
    workbench: { entry: "src/workbench/main.ts", name: "workbench" },
    clock: { entry: "src/live/clock.ts", name: "clock" },
};

export default defineConfig(({ mode }) => {
    const { entry, name, license } = BUNDLES[mode];
    return {
        build: {
            outDir: "../python/navbound/_web",
            emptyOutDir: false,
            target: "es2022",
            cssCodeSplit: false,
            reportCompressedSize: false,
            ...(license ? { license } : {}),
            lib: { entry, formats: ["iife"], name: name === "report" ? "navbound" : name, fileName: () => `${name}.js`, cssFileName: name },
        },
    };
});
