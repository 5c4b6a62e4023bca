"""A day of protection levels from the command line, counted exactly: a plain one, one over a week's end, one over a leap second."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

DAY = 86_400
HALF = DAY // 2
N_OUTAGE, N_ABOVE, N_HAZARD = 600, 900, 3
"""Epochs without a level, with a vertical level above the alert limit, and with an error beyond the limit that the level hides."""


def written_in_weeks(begin_s: int) -> Iterator[str]:
    """GPS weeks and times of week from a time of week 2300."""
    for k in range(DAY):
        week, tow = divmod(begin_s + k, 604_800)
        yield f"{2300 + week},{tow}"


def written_over_a_leap_second() -> Iterator[str]:
    """UTC from noon to noon around the last second of 2016, which was a sixty-first."""
    noon = datetime(2016, 12, 31, 12, tzinfo=UTC)
    for k in range(HALF):
        yield f"{noon + timedelta(seconds=k):%Y-%m-%dT%H:%M:%SZ}"
    yield "2016-12-31T23:59:60Z"
    for k in range(HALF, DAY):
        yield f"{noon + timedelta(seconds=k):%Y-%m-%dT%H:%M:%SZ}"


SERIES: dict[str, tuple[str, Callable[[], Iterator[str]]]] = {
    "plain": ("week,tow", lambda: written_in_weeks(100_000)),
    "over a week's end": ("week,tow", lambda: written_in_weeks(604_800 - HALF)),
    "over a leap second": ("time", written_over_a_leap_second),
}


def row(k: int) -> str:
    """Errors and levels of an epoch; the hazard stands in the middle of the day, over the seam."""
    level = "nan,nan" if 10_000 <= k < 10_000 + N_OUTAGE else "12,51" if 30_000 <= k < 30_000 + N_ABOVE else "12,20"
    return f"0.5,0.5,{60.0 if HALF - 1 <= k < HALF - 1 + N_HAZARD else 1.0},{level}"


@pytest.mark.parametrize("name", SERIES)
def test_every_second_of_a_day_counts_once(tmp_path: Path, name: str) -> None:
    head, times = SERIES[name]
    lines = [f"{time},{row(k)}" for k, time in enumerate(times())]
    n = len(lines)
    assert n == DAY + (name == "over a leap second")
    (tmp_path / "levels.csv").write_text("\n".join([f"{head},nse_e_m,nse_n_m,nse_u_m,hpl_m,vpl_m", *lines]) + "\n")
    command = [
        sys.executable,
        "-m",
        "navbound",
        "analyze",
        str(tmp_path / "levels.csv"),
        "--levels",
        "APV-I",
        "--out",
        str(tmp_path / "run"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode in {0, 4}, done.stderr
    data = json.loads((tmp_path / "run" / "summary.json").read_text())["performance"]
    counts = {key: data[key] for key in ("period_s", "n_expected", "n_missing", "n_no_solution", "n_solution", "n_repeated")}
    assert counts == {
        "period_s": 1.0, "n_expected": n, "n_missing": 0, "n_no_solution": N_OUTAGE, "n_solution": n - N_OUTAGE, "n_repeated": 0
    }  # fmt: skip
    assert data["last_ns"] - data["first_ns"] == (n - 1) * 1_000_000_000
    (level,) = data["levels"]
    assert level["n_available"] == n - N_OUTAGE - N_ABOVE
    # Twice a second with the service is followed by one without: 600 s without a level, 900 s with one that is too large.
    assert level["n_continuity_events"] == 2
    assert (level["n_hazard_epochs"], level["n_hazard_events"], level["longest_hazard_s"]) == (N_HAZARD, 1, float(N_HAZARD))
