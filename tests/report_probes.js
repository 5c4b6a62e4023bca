// What the browser tests measure on the page.
({
    /** For each pixel column of a chart, how many pixels are not background. */
    ink(chart) {
        const canvas = document.querySelector(`${chart} canvas`);
        const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
        return Array.from({ length: canvas.width }, (_, x) => {
            let n = 0;
            for (let y = 0; y < canvas.height; y++) n += pixels[4 * (y * canvas.width + x) + 3] > 120 ? 1 : 0;
            return n;
        });
    },

    /** How many pixels of a chart between two columns are the blue of the first method. */
    blue(chart, from, to) {
        const canvas = document.querySelector(`${chart} canvas`);
        const p = canvas.getContext("2d").getImageData(from, 0, to - from, canvas.height).data;
        let n = 0;
        for (let i = 0; i < p.length; i += 4) if (p[i + 3] > 150 && p[i + 2] > p[i] + 100) n += 1;
        return n;
    },

    /** How many pixels of a chart are black. */
    black(chart) {
        const canvas = document.querySelector(`${chart} canvas`);
        const p = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
        let n = 0;
        for (let i = 0; i < p.length; i += 4) if (p[i + 3] > 200 && p[i] + p[i + 1] + p[i + 2] < 60) n += 1;
        return n;
    },

    /** Marks everything that can be pressed, and counts it. */
    markReachable() {
        const all = [...document.querySelectorAll("button, input, select, summary, .map-surface")].filter((e) => !e.disabled && e.checkVisibility());
        all.forEach((e, i) => (e.dataset.reach = i));
        document.activeElement.blur();
        return all.length;
    },

    /** Contrast of a colour with a ground, WCAG 2; both as [r, g, b]. */
    ratio(a, b) {
        const light = (c) => c.slice(0, 3).map((v) => v / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)).reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
        const [x, y] = [light(a), light(b)];
        return (Math.max(x, y) + 0.05) / (Math.min(x, y) + 0.05);
    },

    parse: (colour) => (colour.match(/[\d.]+/g) ?? []).map(Number),

    /** Every visible text and its contrast where that is below 4.5. */
    texts() {
        const ground = (e) => {
            for (; e !== null; e = e.parentElement) {
                const c = this.parse(getComputedStyle(e).backgroundColor);
                if (c.length === 3 || c[3] > 0) return c;
            }
            return [255, 255, 255];
        };
        const found = { n: 0, bad: [] };
        const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
        while (walk.nextNode()) {
            const e = walk.currentNode.parentElement;
            const text = walk.currentNode.data.trim();
            if (text === "" || !e.checkVisibility() || e.closest("script, style, :disabled") !== null) continue;
            const style = getComputedStyle(e);
            const ratio = this.ratio(this.parse(e.closest("svg") !== null ? style.fill : style.color), ground(e));
            found.n += 1;
            if (ratio < 4.5) found.bad.push([text.slice(0, 40), ratio]);
        }
        return found;
    },

    /** Contrast of the colours that lines are drawn in. */
    lines() {
        const probe = document.body.appendChild(document.createElement("i"));
        const rgb = (name) => {
            probe.style.color = `var(--${name})`;
            return this.parse(getComputedStyle(probe).color);
        };
        const names = ["ink", "muted", "normal", "caution", "warning", "path", "limit", "m1", "m2", "m3", "m4", "m5"];
        const found = Object.fromEntries(names.map((name) => [name, this.ratio(rgb(name), rgb("ground"))]));
        probe.remove();
        return found;
    },
})
