"""One of two constellations is consistent with a false place: nothing says which of both is right, and no position is ok."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import navbound
from navbound import gnss

EXAMPLES = Path(__file__).parents[1] / "examples" / "data"
OBSERVATIONS, NAVIGATION = EXAMPLES / "station.rnx", EXAMPLES / "broadcast.rnx"
SECOND_NS = 1_000_000_000
ORBIT_M = 2.2e7
"""About the distance of a satellite: the way to one from a place 5 km off is longer by 0.6 m than its tangent plane says. [m]"""


def led_off(folder: Path, letter: str, east_m: float, *, from_epoch: int = 0, until_epoch: int = 10**9) -> Path:
    """The example's station with every range of a constellation as it would be `east_m` east."""
    observations = gnss.read_observations(OBSERVATIONS)
    ranges = gnss.solve(observations, gnss.read_navigation([NAVIGATION]), systems="GE", keep_ranges=True, mask_rad=0.0).ranges
    assert ranges is not None
    sights = {(t, sv): (az, el) for t, sv, az, el in ranges.select("time_ns", "sv", "az_rad", "el_rad").iter_rows()}
    lines, epoch, body = [], -1, False
    for line in OBSERVATIONS.read_text(encoding="ascii").splitlines():
        changed = line
        if body and line.startswith(">"):
            epoch += 1
        elif body and line.startswith(letter) and from_epoch <= epoch < until_epoch:
            azimuth, elevation = sights.get((int(observations.time_ns[epoch]), line[:3]), (math.nan, math.nan))
            along_m = east_m * math.sin(azimuth) * math.cos(elevation)
            changed = moved(line, -along_m + (east_m**2 - along_m**2) / (2.0 * ORBIT_M))
        body |= "END OF HEADER" in line
        lines.append(changed)
    path = folder / "station.rnx"
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def moved(line: str, by_m: float) -> str:
    """Every pseudorange of a satellite's line, longer; nothing where its direction is not known."""
    if math.isnan(by_m):
        return line
    fields = [line[at : at + 16] for at in range(3, len(line), 16)]
    is_range = [bool(f[:14].strip()) and 1.5e7 < float(f[:14]) < 4.5e7 for f in fields]
    return line[:3] + "".join(f"{float(f[:14]) + by_m:14.3f}{f[14:]}" if r else f for f, r in zip(fields, is_range, strict=True))


@pytest.mark.parametrize("letter", ["G", "E"])
@pytest.mark.parametrize("east_m", [300.0, 5000.0])
@pytest.mark.parametrize("signals", ["single", "dual"])
def test_no_position_is_ok_while_one_of_two_constellations_is_led_off(tmp_path: Path, letter: str, east_m: float, signals: str) -> None:
    observations = gnss.read_observations(led_off(tmp_path, letter, east_m))
    solved = gnss.solve(observations, gnss.read_navigation([NAVIGATION]), systems="GE", signals=signals)  # type: ignore[arg-type]
    assert solved.epochs.filter(solved.epochs["status"] == "ok").height == 0
    assert "constellations_contradict" in set(solved.epochs["reason_id"])


def test_the_verdict_names_both(tmp_path: Path) -> None:
    verdict = navbound.analyze([led_off(tmp_path, "E", 5000.0), NAVIGATION]).summary.verdict
    assert verdict.id == "nothing_judged"
    assert verdict.n_judged == 0
    assert any("Galileo and GPS contradict each other" in each for each in verdict.position_doubts)


def test_constellations_that_agree_again_settle_it(tmp_path: Path) -> None:
    """Led off for ten minutes: 20 epochs of 30 s."""
    observations = gnss.read_observations(led_off(tmp_path, "G", 1000.0, from_epoch=60, until_epoch=80))
    healthy = gnss.solve(gnss.read_observations(OBSERVATIONS), gnss.read_navigation([NAVIGATION]), systems="GE")
    solved = gnss.solve(observations, gnss.read_navigation([NAVIGATION]), systems="GE")
    ok, before = ((each.epochs["status"] == "ok").to_numpy() for each in (solved, healthy))
    assert not ok[60:80].any()
    assert ok[:60].sum() == before[:60].sum()
    # Exclusions of the last minute count for a minute more.
    assert np.array_equal(ok[83:], before[83:])
