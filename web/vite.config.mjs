import { defineConfig } from "vite";

// One script and one style sheet with fixed names: the report puts both into the page, and CI compares them byte for byte.
export default defineConfig({
    build: {
        outDir: "../python/navbound/_web",
        emptyOutDir: false,
        target: "es2022",
        cssCodeSplit: false,
        reportCompressedSize: false,
        license: { fileName: "third-party.md" },
        lib: { entry: "src/report.ts", formats: ["iife"], name: "navbound", fileName: () => "report.js", cssFileName: "report" },
    },
});
