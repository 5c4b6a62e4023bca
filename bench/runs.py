"""Whole jobs, from the command's start to the written report, in processes of their own."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from clock import Row, show

SHARED = Path(__file__).resolve().parents[2] / "shared" / "data"
EPOCHS = 7081


def measure() -> list[Row]:
    """Seconds per epoch of `fly` (on sensors and filter, with drawn errors) and of `analyze` on a morning over Paris."""
    rows = [
        _job("fly beijing-shanghai, fused", ["fly", "beijing-shanghai"], EPOCHS, "whole command, 200 Hz, one process"),
        _job("fly beijing-shanghai-drawn", ["fly", "beijing-shanghai-drawn"], EPOCHS, "whole command, one process"),
        _job(
            "fly beijing-shanghai-drawn --flights 10",
            ["fly", "beijing-shanghai-drawn", "--flights", "10"],
            10 * EPOCHS,
            "whole command, all cores",
        ),
    ]
    paris = SHARED / "aircraft" / "paris_tma_20211007" / "tracks.csv.gz"
    if paris.exists():
        rows.append(
            _job(
                "analyze, 107 aircraft over Paris",
                ["analyze", str(paris), "--path", "auto", "--spec", "RNP 0.3"],
                147_644,
                "per row read; whole command",
            )
        )
    return rows


def _job(name: str, arguments: list[str], items: int, note: str) -> Row:
    environment = {k: v for k, v in os.environ.items() if k not in ("RAYON_NUM_THREADS", "POLARS_MAX_THREADS")}
    best = float("inf")
    for _ in range(3):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-m", "navbound", *arguments, "--out", f"{folder}/run", "--json"]
            start = time.perf_counter()
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
            best = min(best, time.perf_counter() - start)
    return Row(name, best / items, items, f"{note}; {best:.2f} s in all, wall clock")


if __name__ == "__main__":
    show(measure())
