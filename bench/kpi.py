"""Performance indicators: one epoch with four levels, and a month at 1 Hz from daily files, with the memory it takes.

Memory is measured in a process of its own, for 10 and for 30 days: what it does not depend on shows itself as equal figures.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import polars as pl

from clock import Row, seconds

LEVELS = "NPA,APV-I,LPV-200,APV-II"
DAY = 86_400


def day(k: int) -> pl.DataFrame:
    """A day of a service whose vertical level crosses two limits now and then."""
    rng = np.random.default_rng(k)
    t = np.arange(DAY)
    return pl.DataFrame(
        {
            "time_ns": (t + k * DAY) * 10**9,
            "nse_e_m": 0.4 * rng.normal(size=DAY),
            "nse_n_m": 0.5 * rng.normal(size=DAY),
            "nse_u_m": 0.9 * rng.normal(size=DAY),
            "hpl_m": 12 + 3 * np.sin(t / 900) + 0.2 * np.abs(rng.normal(size=DAY)),
            "vpl_m": 24 + 12 * np.sin(t / 4000 + k) + 0.2 * np.abs(rng.normal(size=DAY)),
        }
    )


def ranges(n_epochs: int, n_sv: int) -> pl.DataFrame:
    """Satellites anywhere above 8 degrees, with errors as their sigmas say."""
    rng = np.random.default_rng(1)
    n = n_epochs * n_sv
    return pl.DataFrame(
        {
            "time_ns": np.repeat(np.arange(n_epochs) * 10**9, n_sv),
            "sv": [f"G{k + 1:02d}" for _ in range(n_epochs) for k in range(n_sv)],
            "az_rad": rng.uniform(0, 2 * np.pi, n),
            "el_rad": rng.uniform(0.14, 1.5, n),
            "sigma_m": rng.uniform(1, 4, n),
            "range_error_m": rng.normal(0, 1.5, n),
        }
    )


def measure() -> list[Row]:
    """Seconds per epoch."""
    from navbound import kpi  # noqa: PLC0415

    table = day(0)
    best = seconds(lambda: kpi.evaluate(table, LEVELS, period_s=1.0), 3)
    rows = [Row("kpi.evaluate, a day, four levels", best / DAY, DAY, f"in memory; {best:.2f} s")]
    sky, required = ranges(2880, 10), [kpi.level(name) for name in LEVELS.split(",")]
    n = kpi.stanford_esa(sky, required).subsets.n_subsets
    took = seconds(lambda: kpi.stanford_esa(sky, required), 1)
    rows.append(Row("kpi.stanford_esa, a subset, four levels", took / n, n, f"2880 epochs of ten satellites; {took:.2f} s"))
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for k in range(30):
            path = Path(folder) / f"day{k:02}.parquet"
            day(k).write_parquet(path)
            files.append(str(path))
        rows += [_campaign(files[:n], f"{folder}/run{n}") for n in (1, 10, 30)]
    return rows


def _campaign(files: list[str], out: str) -> Row:
    done = subprocess.run([sys.executable, __file__, out, *files], check=True, capture_output=True, text=True)
    measured = json.loads(done.stdout.splitlines()[-1])
    n = DAY * len(files)
    note = f"files to report; {measured['wall_s']:.1f} s, {measured['cpu_s']:.1f} s CPU, {measured['peak_mb']:.0f} MB at most"
    return Row(f"campaign of {len(files)} daily files", measured["wall_s"] / n, n, note)


def main() -> None:
    """One campaign in this process; prints what it took."""
    import navbound  # noqa: PLC0415

    out, *files = sys.argv[1:]
    start = time.perf_counter()
    navbound.evaluate(files, levels=LEVELS, period_s=1.0, out=out)
    usage = resource.getrusage(resource.RUSAGE_SELF)
    figures = {"wall_s": time.perf_counter() - start, "cpu_s": usage.ru_utime + usage.ru_stime, "peak_mb": usage.ru_maxrss / 1024}
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
