"""Witnesses beside the satellites: what stations, altimeter and a missing snapshot take from a fused position."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest

import navbound
from navbound.run import fly
from navbound.run.judge import judge
from navbound.run.settings import Settings
from navbound.scenario import load
from navbound.studies.fault_campaign import study as fault_campaign
from navbound.studies.fault_campaign.kinds import KINDS

SCENARIO = """
base = "beijing-shanghai"
title = "Beijing to Tianjin"
duration_s = {duration_s}
[[waypoints]]
name = "ZBAA"
kind = "runway"
lat_deg = 40.07333333
lon_deg = 116.59833333
[[waypoints]]
name = "F1"
lat_deg = 39.70
lon_deg = 116.62
[[waypoints]]
name = "F2"
lat_deg = 39.42
lon_deg = 116.95
[[waypoints]]
name = "ZBTJ"
kind = "runway"
lat_deg = 39.12
lon_deg = 117.34
[profile]
cruise_height_m = 2400.0
acceleration_height_m = 1500.0
climb_step_heights_m = [900.0, 1800.0]
[sensors]
rate_hz = 10
[filter]
samples_per_step = 1
[[phases]]
name = "departure"
rnp_nm = 1.0
until_waypoint = "F1"
[[phases]]
name = "arrival"
rnp_nm = 1.0
until_before_end_nm = 12.0
[[phases]]
name = "approach"
rnp_nm = 0.3
"""
STATIONS = [("PEK", 40.05, 116.6), ("VYK", 39.1917, 116.572), ("TAJ", 39.1067, 117.358), ("HUR", 40.33, 116.748), ("LUX", 39.7383, 118.728)]
SILENT = 'kind = "imu-trouble"\nwhat = "silent"\nstart_s = 200.0\nduration_s = 600.0'
FROZEN = 'kind = "imu-trouble"\nwhat = "frozen"\nstart_s = 300.0\nduration_s = 500.0'
LATE_CLOCK = 'kind = "imu-clock"\nstart_s = 300.0\nduration_s = 500.0\noffset_s = 0.0\ndrift = 0.001'


def spoofing(start_s: float, right_mps: float, up_mps: float = 0.0) -> str:
    return f'kind = "spoofing"\nstart_s = {start_s}\nduration_s = {900.0 - start_s}\nright_mps = {right_mps}\nup_mps = {up_mps}'


def interference(start_s: float, duration_s: float) -> str:
    return f'kind = "interference"\nstart_s = {start_s}\nduration_s = {duration_s}'


def acceleration(kind: str, start_s: float, each_mps2: float, duration_s: float | None = None) -> str:
    lasts = "" if duration_s is None else f"\nduration_s = {duration_s}"
    return f'kind = "{kind}"\nstart_s = {start_s}\ngyro_radps = [0.0, 0.0, 0.0]\naccelerometer_mps2 = {[each_mps2] * 3}{lasts}'


def flown(tmp_path: Path, *faults: str, duration_s: float = 900.0) -> pl.DataFrame:
    stations = "".join(
        f'[[sensors.stations]]\nname = "{name}"\nkind = "vor-dme"\nlat_deg = {lat}\nlon_deg = {lon}\nheight_ft = 100\n'
        for name, lat, lon in STATIONS
    )
    text = SCENARIO.format(duration_s=duration_s) + stations + "".join(f"[[sensors.faults]]\n{fault}\n" for fault in faults)
    path = tmp_path / "flight.toml"
    path.write_text(text)
    epochs = navbound.fly(path, flights=1).epochs
    return epochs.with_columns(second=(pl.col("time_ns") - pl.col("time_ns").min()) / 1e9)


def outside(epochs: pl.DataFrame) -> pl.Series:
    return ((epochs["nse_h_m"] > epochs["hpl_m"]) | (epochs["nse_u_m"].abs() > epochs["vpl_m"])).fill_null(value=False)


@pytest.mark.parametrize(
    "faults",
    [
        pytest.param((SILENT, spoofing(230.0, 10.0)), id="unit silent"),
        pytest.param((FROZEN, spoofing(400.0, 20.0)), id="unit frozen"),
        pytest.param((spoofing(200.0, 5.0), LATE_CLOCK), id="spoofed before the clock of the unit fails"),
    ],
)
def test_satellites_that_the_stations_contradict_are_no_navigation_whatever_the_unit_does(tmp_path: Path, faults: tuple[str, ...]) -> None:
    epochs = flown(tmp_path, *faults)
    # Five stations of 93 m each rule out some 600 m; their mean over ten seconds is 200 m behind at 20 m/s. Nearer nobody on board sees it.
    far = epochs.filter(pl.col("nse_h_m") > 800.0)
    assert far.height > 100
    assert far["status"].unique().to_list() == ["not_available"]
    assert far["hpl_m"].null_count() == far.height
    assert far["vpl_m"].null_count() == far.height
    assert "normal" not in far["alert"].to_list()


def test_the_unit_silent_and_the_satellites_right_is_ok_by_the_snapshot(tmp_path: Path) -> None:
    epochs = flown(tmp_path, SILENT)
    alone = epochs.filter(pl.col("second") >= 215, pl.col("second") < 780)
    assert alone["status"].unique().to_list() == ["ok"]
    assert not outside(alone).any()


@pytest.mark.parametrize("right_mps", [1.0, 3.0, 30.0])
def test_satellites_alone_that_move_without_their_rates_are_inside_their_level_until_they_are_contradicted(
    tmp_path: Path, right_mps: float
) -> None:
    epochs = flown(tmp_path, SILENT, spoofing(250.0, right_mps) + "\nrates = false", duration_s=900.0)
    alone = epochs.filter(pl.col("second") >= 215)
    assert not outside(alone.filter(pl.col("status") == "ok")).any()
    # 6.5 deviations of two positions of some 2 m, and a second.
    assert "ok" not in alone.filter(pl.col("nse_h_m") > 25.0 + right_mps)["status"].to_list()


@pytest.mark.parametrize("up_mps", [-1.0, 2.0])
def test_a_height_that_the_satellites_were_led_off_is_never_ok_again(tmp_path: Path, up_mps: float) -> None:
    epochs = flown(tmp_path, spoofing(200.0, 0.0, up_mps))
    assert epochs["nse_u_m"].abs().max() > 500.0  # type: ignore[operator]
    # The filter contradicts within seconds; no time makes that good.
    assert "ok" not in epochs.filter(pl.col("second") > 230)["status"].to_list()
    # The altimeter states 57 m at 2400 m (30 m and 2 % of the height) for 3.6 h: in ten minutes it changes by 18 m.
    far = epochs.filter(pl.col("nse_u_m").abs() > 200.0)
    assert far["vpl_m"].null_count() == far.height
    assert far["nav_reasons"].str.contains("altimeter_contradicts").all()


@pytest.mark.parametrize(
    "faults",
    [
        pytest.param((interference(300.0, 9.0), acceleration("imu-pulse", 300.0, 3.0, 9.0)), id="short loss"),
        pytest.param((interference(300.0, 300.0), acceleration("imu-bias-jump", 300.0, 0.05)), id="long loss"),
    ],
)
def test_without_a_snapshot_nothing_is_ok_and_no_level_is_published(tmp_path: Path, faults: tuple[str, ...]) -> None:
    epochs = flown(tmp_path, *faults, duration_s=700.0)
    lost = epochs.filter(pl.col("second") >= 302, pl.col("second") < 308)
    assert "ok" not in lost["status"].to_list()
    assert lost["hpl_m"].null_count() == lost.height
    assert not outside(epochs).any()


def test_a_filter_that_stations_contradicted_is_not_believed_when_they_fall_silent() -> None:
    """Satellites out, an accelerometer wrong by 0.1 m/s²: the stations contradict the filter, and then the aircraft leaves their range."""
    kind = next(kind for kind in KINDS if kind.id == "outage-and-accelerometer")
    scenario, _ = fault_campaign.faulty(load(fault_campaign.SCENARIO), fault_campaign.Tile(kind.id, kind.sizes.index(0.1), 3, 3))
    epochs = judge(fly.material(scenario, flights=3, seed=None), Settings(methods=())).epochs
    astray = epochs.filter(pl.col("nse_h_m") > 2.0 * pl.col("rnp_m"))
    # The case is one: it was contradicted, and far off.
    assert astray.filter(pl.col("nav_reasons").str.contains("stations_contradict")).height > 100
    assert "normal" not in astray["alert"].to_list()
    assert set(astray["status"]) == {"not_available"}
