"""Speed of navbound.gnss: a real station day, 30 s, every system, from files to positions; one thread.

The plain text is made from the compact file of the shared data by hatanaka where that is installed; rnx2rtkp (Debian package rtklib)
gives the ratio where it is.
"""

from __future__ import annotations

import gzip
import importlib
import resource
import shutil
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from clock import Row, seconds, show
from navbound import gnss

if TYPE_CHECKING:
    pass

FOLDER = Path(__file__).parents[1].parent / "shared" / "data" / "gnss" / "ESBC_2020_177"
COMPACT = FOLDER / "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz"
BROADCAST = FOLDER / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz"
EPOCHS = 2880
PEER_OPTIONS = """pos1-posmode=single
pos1-frequency=l1
pos1-elmask=10
pos1-ionoopt=brdc
pos1-tropopt=saas
pos1-sateph=brdc
pos1-navsys=41
out-solformat=xyz
"""


def plain_text(folder: Path) -> Path | None:
    """The day as plain text, 32.9 MB; None without the decompressor."""
    try:
        hatanaka = importlib.import_module("hatanaka")
    except ImportError:
        print("SKIPPED: hatanaka is not installed, so no plain text and no peer row", file=sys.stderr)
        return None
    path = folder / "day.rnx"
    path.write_bytes(hatanaka.decompress(COMPACT.read_bytes()))
    return path


def peer(observations: Path, folder: Path) -> float | None:
    """CPU seconds of rnx2rtkp on the same day, GPS, Galileo and BeiDou; None where it is not installed."""
    program = shutil.which("rnx2rtkp")
    if program is None:
        print("SKIPPED: rnx2rtkp (package rtklib) is not installed, so no peer row", file=sys.stderr)
        return None
    (folder / "peer.conf").write_text(PEER_OPTIONS)
    (folder / "day.nav").write_bytes(gzip.decompress(BROADCAST.read_bytes()))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [program, "-k", str(folder / "peer.conf"), "-o", str(folder / "peer.pos"), str(observations), str(folder / "day.nav")]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measure() -> list[Row]:
    """One row a measurement. Nothing where the day is absent."""
    if not FOLDER.is_dir():
        return []
    rows: list[Row] = []

    def row(name: str, total: float, note: str, goal_s: float | None = None) -> None:
        goal = None if goal_s is None else goal_s / EPOCHS
        rows.append(Row(name, total / EPOCHS, EPOCHS, f"{note}; the day {1e3 * total:.0f} ms", goal))

    def whole(path: Path) -> gnss.Positions:
        return gnss.solve(gnss.read_observations(path), gnss.read_navigation(BROADCAST))

    observations, navigation = gnss.read_observations(COMPACT), gnss.read_navigation(BROADCAST)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = plain_text(folder)
        if text is not None:
            row(
                "gnss day, plain text to positions",
                seconds(lambda: whole(text), 7),
                "an epoch; GPS, Galileo and BeiDou, with covariance and DOP",
                goal_s=0.1,
            )
            row("gnss read plain text", seconds(lambda: gnss.read_observations(text), 7), "an epoch; 32.9 MB in all", goal_s=0.04)
        row("gnss day, compact gzip to positions", seconds(lambda: whole(COMPACT)), "an epoch")
        row("gnss read compact gzip", seconds(lambda: gnss.read_observations(COMPACT)), "an epoch; 4.0 MB in all")
        row("gnss read navigation", seconds(lambda: gnss.read_navigation(BROADCAST)), "an epoch")
        for systems in ("G", "GE", "GEC"):
            solve = partial(gnss.solve, observations, navigation, systems=systems)
            row(f"gnss solve {systems}", seconds(solve), "an epoch")
        spent = peer(text, folder) if text is not None else None
        if spent is not None:
            row("rnx2rtkp, plain text to positions", spent, "an epoch; GPS, Galileo and BeiDou, single point")
    return rows


if __name__ == "__main__":
    show(measure())
