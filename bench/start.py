"""The commands as a user starts them: processor time of the whole process, its start and its end, with the bytecode cached."""

from __future__ import annotations

import math
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

from clock import Row, show

DATA = Path(__file__).parents[1] / "examples" / "data"
DAY = Path(__file__).parents[2] / "shared" / "data" / "gnss" / "ESBC_2020_177"
DAY_FILES = ("ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz", "ESBC00DNK_R_20201770000_01D_MN.rnx.gz")
THREE = "time,lat,lon,sigma_e_m,sigma_n_m\n1700000000,48.0,2.0,3,3\n1700000001,48.0001,2.0,3,3\n1700000002,48.0002,2.0,3,3\n"
REPEATS = 5


def spent(arguments: list[str]) -> float:
    """Least processor time of a command over some repeats. [s]"""
    environment = {k: v for k, v in os.environ.items() if k not in ("RAYON_NUM_THREADS", "POLARS_MAX_THREADS", "PYTHONDONTWRITEBYTECODE")}
    least = math.inf
    for _ in range(REPEATS):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-m", "navbound", *arguments], check=False, capture_output=True, env=environment)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        least = min(least, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
    return least


def measure() -> list[Row]:
    """One row a command; ."""
    with tempfile.TemporaryDirectory() as folder:
        out, three = str(Path(folder) / "out"), Path(folder) / "three.csv"
        three.write_text(THREE, encoding="utf-8")
        cases = [
            ("start --help", ["--help"], 0.25),
            ("start missing file", ["analyze", str(Path(folder) / "none.csv"), "--out", out], 0.4),
            ("start analyze three lines", ["analyze", str(three), "--out", out], 0.5),
            ("start analyze station, two hours", ["analyze", str(DATA / "station.rnx"), str(DATA / "broadcast.rnx"), "--out", out], None),
        ]
        day = [str(DAY / name) for name in DAY_FILES]
        if DAY.exists():
            cases.append(("start analyze GNSS day with report", ["analyze", *day, "--out", out], 0.6))
        return [Row(name, spent(arguments), 1, "a command, report written", goal) for name, arguments, goal in cases]


if __name__ == "__main__":
    show(measure())
