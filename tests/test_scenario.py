"""Scenario files: those that ship, and every way to get one wrong."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from navbound import FormatError, InputError, scenario

SHIPPED = Path(scenario.__file__).parent / "shipped" / "beijing-shanghai-drawn.toml"


def changed(tmp_path: Path, old: str, new: str) -> Path:
    text = SHIPPED.read_text(encoding="utf-8")
    assert old in text, "the shipped scenario has changed: this test would prove nothing"
    file = tmp_path / "mine.toml"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    return file


@pytest.mark.parametrize("name", scenario.shipped())
def test_every_shipped_scenario_can_be_read(name: str) -> None:
    assert scenario.read(name).title


def test_the_operation_comes_with_the_kind_and_can_be_stated(tmp_path: Path) -> None:
    assert scenario.read("beijing-shanghai").operation == "en-route"
    assert scenario.read("barcelona-taxi").operation == "ground"
    file = tmp_path / "mine.toml"
    file.write_text('base = "beijing-shanghai-drawn"\noperation = "approach"\n', encoding="utf-8")
    assert scenario.read(file).operation == "approach"
    # A flight does not roll, and what rolls does not fly.
    for base, other in (("beijing-shanghai-drawn", "ground"), ("barcelona-taxi", "en-route")):
        file.write_text(f'base = "{base}"\noperation = "{other}"\n', encoding="utf-8")
        with pytest.raises(FormatError, match="operation"):
            scenario.read(file)


def test_a_reader_of_flights_refuses_another_kind(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="'taxi' is not a flight"):
        scenario.load("barcelona-taxi")
    file = tmp_path / "mine.toml"
    for kind in ('"boat"', "3", "[]"):
        file.write_text(f'base = "beijing-shanghai-drawn"\nkind = {kind}\n', encoding="utf-8")
        with pytest.raises(FormatError, match="flight, taxi"):
            scenario.read(file)


def test_a_scenario_is_the_same_from_its_record() -> None:
    for name in ("beijing-shanghai", "barcelona-taxi-ground-fault"):
        loaded = scenario.read(name)
        assert scenario.of_record(loaded.model_dump(mode="json")) == loaded


def test_units_become_si() -> None:
    loaded = scenario.load("beijing-shanghai")
    assert loaded.phases[3].rnp_m == 0.3 * 1852
    assert loaded.navigation.mask_rad == math.radians(7)
    assert loaded.gusts.length_m == pytest.approx(533.4, rel=1e-15)  # 1750 ft of 0.3048 m
    assert loaded.turns.rate_max_radps == math.radians(3)


def test_one_quantity_may_be_written_in_another_unit(tmp_path: Path) -> None:
    file = changed(tmp_path, "cruise_height_m = 8900.0", "cruise_height_ft = 29200")
    assert scenario.load(file).profile.cruise_height_m == pytest.approx(29200 * 0.3048, rel=1e-15)
    file = changed(tmp_path, "landing_speed_mps = 70.0", "landing_speed_kt = 136")
    assert scenario.load(file).profile.landing_speed_mps == pytest.approx(136 * 1852 / 3600, rel=1e-15)


def test_start_is_gps_time() -> None:
    # 2022-08-01 is a Monday: GPS week 2221 began the day before; no leap seconds in GPS time.
    assert scenario.load("beijing-shanghai").start_ns == (2221 * 7 + 1) * 86_400 * 10**9


def test_a_file_may_say_only_what_differs(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('base = "beijing-shanghai-drawn"\ntitle = "Mine"\n[navigation]\nclaimed_sigma_scale = 0.5\n', encoding="utf-8")
    mine, base = scenario.load(file), scenario.load("beijing-shanghai-drawn")
    assert mine.title == "Mine"
    assert mine.navigation == base.navigation.model_copy(update={"claimed_sigma_scale": 0.5})
    assert mine.waypoints == base.waypoints


@pytest.mark.parametrize(
    ("old", "new", "field", "message"),
    [
        ("mask_deg = 7.0", "mask_deg = 95.0", "navigation.mask_deg", "95.0 is outside [0, pi/2] [rad]"),
        ("mask_deg = 7.0", 'mask_deg = "7"', "navigation.mask_deg", "valid number"),
        ("mask_deg = 7.0", "mask_deg = true", "navigation.mask_deg", "valid number"),
        ("mask_deg = 7.0", "mask_deg = nan", "navigation.mask_deg", "finite"),
        ("mask_deg = 7.0", "mask = 7.0", "navigation.mask_rad", "missing"),
        ("mask_deg = 7.0", "mask_deg = 7.0\nmask_limit = 2", "navigation.mask_limit", "not a key"),
        ("mask_deg = 7.0", "mask_deg = 7.0\nmask_rad = 0.1", "navigation.mask_rad", "one unit"),
        ("rnp_nm = 0.3", "rnp_nm = -0.3", "phases[3].rnp_nm", "(0, 37040], 20 NM [m]"),
        ('["gps", "beidou"]', '["gps", "loran"]', "navigation.constellations[1]", "'galileo' or 'beidou'"),
        ("duration_s = 7081.0", "duration_min = 30", "duration_min", "cruise speed"),
        ("duration_s = 7081.0", "duration_s = 7081.0\nspeed_kt = 300", "speed_kt", "not a key"),
        ('until_waypoint = "ELKUR"', 'until_waypoint = "NOWHERE"', "phases[0].until_waypoint", "names of waypoints"),
        ("lat_deg = 38.63972222", "lat_deg = 98.6", "waypoints[1].lat_deg", "[-pi/2, pi/2]"),
        ("start_gps = 2022-08-01T00:00:00", "start_gps = 2022-08-01T00:00:00Z", "start_gps", "no zone"),
        ("seed = 20220801", "seed = -1", "seed", "greater than or equal to 0"),
        ("[turns]", "[turns", None, "not TOML"),
        ('title = "Beijing to Shanghai, errors drawn"', 'base = "nowhere"', "base", "shipped scenarios"),
        ("landing_speed_mps = 70.0", "landing_speed_mps = 70.0\n[[faults]]\nkind = 'meteor'", "faults[0]", "'lateral-ramp'"),
        (
            "landing_speed_mps = 70.0",
            "landing_speed_mps = 70.0\n[[faults]]\nkind = 'lateral-ramp'\nstart_s = 1\nduration_min = 1\nrate_kt = 'x'",
            "faults[0].rate_kt",
            "valid number",
        ),
    ],
)
def test_a_wrong_file_is_explained(tmp_path: Path, old: str, new: str, field: str | None, message: str) -> None:
    file = changed(tmp_path, old, new)
    with pytest.raises(FormatError) as caught:
        scenario.load(file)
    assert caught.value.path == file
    assert caught.value.field == field
    assert message in str(caught.value)
    assert str(file) in str(caught.value)


def test_a_scenario_that_is_not_there_lists_those_that_are() -> None:
    with pytest.raises(InputError, match="beijing-shanghai"):
        scenario.load("nowhere")


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FormatError, match="not TOML"):
        scenario.load(file)
