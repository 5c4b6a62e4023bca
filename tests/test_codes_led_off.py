"""The codes of all satellites are led off toward one place, their carrier phases are not: no position and no level of it is ok."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import araim, gnss, raim

if TYPE_CHECKING:
    from collections.abc import Callable

EXAMPLES = Path(__file__).parents[1] / "examples" / "data"
OBSERVATIONS, NAVIGATION = EXAMPLES / "station.rnx", EXAMPLES / "broadcast.rnx"
FROM, UNTIL, GAP = 20, 60, 80
"""Epochs: led off from, until; the file has a gap of 5.5 minutes, and the receiver flags each phase as lost, before the last. [1]"""
STEP_S = 30.0
ORBIT_M = 2.2e7
"""About the distance of a satellite: the way to one from a place 1 km off is longer by 2 cm than its tangent plane says. [m]"""


def step(epoch: int) -> float:
    return 100.0 if FROM <= epoch < UNTIL else 0.0


def ramp(epoch: int) -> float:
    return 0.3 * STEP_S * max(0, epoch - FROM)


def led_off(folder: Path, east_m: Callable[[int], float], phase_share: float = 0.0) -> Path:
    """The example's station with all codes as they would be east of it, and this share of it in the phases, too."""
    observations = gnss.read_observations(OBSERVATIONS)
    ranges = gnss.solve(observations, gnss.read_navigation([NAVIGATION]), systems="GE", keep_ranges=True, mask_rad=0.0).ranges
    assert ranges is not None
    sights = {(t, sv): (az, el) for t, sv, az, el in ranges.select("time_ns", "sv", "az_rad", "el_rad").iter_rows()}
    lines, epoch, body = [], -1, False
    for line in OBSERVATIONS.read_text(encoding="ascii").splitlines():
        changed = line
        if body and line.startswith(">"):
            epoch += 1
        elif body:
            azimuth, elevation = sights.get((int(observations.time_ns[epoch]), line[:3]), (math.nan, math.nan))
            way_m = east_m(epoch)
            along_m = way_m * math.sin(azimuth) * math.cos(elevation)
            changed = moved(line, -along_m + (way_m**2 - along_m**2) / (2.0 * ORBIT_M), phase_share)
        body |= "END OF HEADER" in line
        lines.append(changed)
    path = folder / "station.rnx"
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def moved(line: str, by_m: float, phase_share: float) -> str:
    """Both codes of a satellite's line longer, and its phases by a share of it; nothing where its direction is not known."""
    if math.isnan(by_m):
        return line
    fields = [line[at : at + 16] for at in range(3, len(line), 16)]
    # Of each of two bands: code [m], phase [cycles], Doppler, strength. L1 and E1; L2 of GPS, E5a of Galileo.
    second_hz = 1227.6e6 if line[0] == "G" else 1176.45e6
    factors = [1.0, phase_share * 1575.42e6 / 299792458.0, 0.0, 0.0, 1.0, phase_share * second_hz / 299792458.0, 0.0, 0.0]
    return line[:3] + "".join(
        f"{float(f[:14]) + by_m * k:14.3f}{f[14:]}" if f[:14].strip() else f for f, k in zip(fields, factors, strict=True)
    )


def solved(path: Path, signals: str = "single") -> pl.DataFrame:
    read = gnss.read_observations(path), gnss.read_navigation([NAVIGATION])
    return gnss.solve(*read, systems="GE", signals=signals).epochs  # type: ignore[arg-type]


@pytest.mark.parametrize("signals", ["single", "dual"])
def test_a_step_is_named_to_its_end_and_the_rest_stays_as_it_was(tmp_path: Path, signals: str) -> None:
    before, after = solved(OBSERVATIONS, signals), solved(led_off(tmp_path, step), signals)
    led = (after["reason_id"] == "codes_led_off").fill_null(value=False).to_numpy()
    assert led[FROM:UNTIL].all()
    assert not led[:FROM].any()
    assert not led[UNTIL:].any()
    assert (after["status"].to_numpy()[FROM:UNTIL] == "degraded").all()
    assert (before["status"].to_numpy()[:FROM] == after["status"].to_numpy()[:FROM]).all()
    # The covariance reaches the place without the lead: 95 % of a Gaussian of one axis are within two deviations.
    east = after["cov_ee_m2"].to_numpy()[FROM:UNTIL]
    assert (2.0 * np.sqrt(east) > 100.0).all()


def test_a_ramp_is_named_before_its_error_reaches_sixty_metres(tmp_path: Path) -> None:
    reasons = solved(led_off(tmp_path, ramp))["reason_id"]
    led = (reasons == "codes_led_off").fill_null(value=False).to_numpy()
    first = int(np.argmax(led))
    assert FROM < first <= FROM + 60.0 / (0.3 * STEP_S)
    assert led[first:GAP].all()
    # It begins anew, as at the begin of a file.
    again = GAP + int(np.argmax(led[GAP:]))
    assert GAP < again <= GAP + 60.0 / (0.3 * STEP_S)
    assert led[again:].all()


def test_a_station_that_is_carried_off_moves_its_phases_too(tmp_path: Path) -> None:
    reasons = solved(led_off(tmp_path, ramp, phase_share=1.0))["reason_id"]
    assert "codes_led_off" not in set(reasons)


def test_no_level_covers_it(tmp_path: Path) -> None:
    read = gnss.read_observations(led_off(tmp_path, step)), gnss.read_navigation([NAVIGATION])
    for epochs in (raim.watch(*read, systems="GE").epochs, araim.watch(*read, systems="GE").epochs):
        part = epochs[FROM:UNTIL]
        assert (part["reason_id"] == "codes_led_off").all()
        assert part["hpl_m"].null_count() == part.height
        assert epochs[:FROM]["hpl_m"].null_count() < FROM


def test_the_run_names_it(tmp_path: Path) -> None:
    epochs = navbound.analyze([led_off(tmp_path, step), NAVIGATION]).epochs
    led = epochs.filter(epochs["reason_id"] == "codes_led_off")
    assert led.height == UNTIL - FROM
    assert set(led["status"]) == {"degraded"}
