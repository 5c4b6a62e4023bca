// A worker that only counts: a browser slows the timers of a page that is not seen, and not those of a worker.

const PERIOD_MS = 200;

setInterval(() => postMessage(0), PERIOD_MS);
