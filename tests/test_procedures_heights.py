"""Heights of a flight against the vertical path of its procedure, the altimeter's setting, and the surface below the path."""

from __future__ import annotations

import gzip
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import navbound
from navbound import InputError, procedures, vertical
from navbound.cli.main import app
from navbound.run.directory import Run
from navbound.run.procedure import Flown
from navbound.units import METRES_PER_FT as FT
from navbound.units import METRES_PER_NM as NM

SAMPLE = Path(__file__).parent / "procedures" / "KDEN_H26-Z.txt"
TRACE = Path("aircraft") / "other" / "trace_full_ac671b.json.gz"
KDEN = Flown(SAMPLE, "KDEN/H26-Z:FUZZZ", "RNP 0.3")


@pytest.fixture(scope="module")
def flown(shared_data: Path) -> Run:
    return navbound.analyze(shared_data / TRACE, procedure=KDEN)


def changed(shared_data: Path, folder: Path, name: str, change: object) -> Path:
    """The recording with another broadcast setting (`setting`: hPa added) or without its geometric heights (`without`)."""
    trace = json.loads(gzip.decompress((shared_data / TRACE).read_bytes()))
    for row in trace["trace"]:
        if name == "setting" and isinstance(row[8], dict) and "nav_qnh" in row[8]:
            row[8]["nav_qnh"] += change
        if name == "without":
            row[10] = None
    file = folder / "trace_full_ac671b.json"
    file.write_text(json.dumps(trace), encoding="utf-8")
    return file


def test_the_final_approach_is_off_its_path_as_the_specification_measured(flown: Run) -> None:
    """C.8: by altimeter -16.1 m (-21.8 to -10.8), by geometry +1.2 m (-8.2 to +10.2), each within 0.5 m; 72 of 75 ft used."""
    (flight,) = flown.summary.procedures
    by = {result.by: result for result in flight.heights}
    geometry, altimeter = by["geometry"], by["altimeter"]
    # The specification compares with a flat line; the path over the curved Earth is up to 0.15 m above it, 9 km before its end.
    assert [altimeter.mean_m, altimeter.least_m, altimeter.most_m] == pytest.approx([-16.1, -21.8, -10.8], abs=0.5)
    assert [geometry.mean_m, geometry.least_m, geometry.most_m] == pytest.approx([1.2, -8.2, 10.2], abs=0.5)
    assert (altimeter.n, altimeter.n_inside, geometry.n_inside) == (16, 16, 16)
    assert -altimeter.least_m / FT == pytest.approx(72.0, abs=1.0)
    assert altimeter.limit_m == pytest.approx(22.86)
    # AC 90-101A at RNP 0.3, 3 degrees and the crossing altitude of 5350 ft, in feet as the specification writes it.
    slope, high = math.tan(math.radians(3.0)), 5350.0
    terms = 6076.115 * 1.225 * 0.3 * slope, 60 * slope, 75.0, -8.8e-8 * high**2 + 6.5e-3 * high + 50
    least = math.sqrt(sum(t * t for t in terms)) * FT
    assert least <= altimeter.required_m < least + 1.0
    assert altimeter.n_inside_required == 16
    final = flown.epochs.filter(leg="RW26")
    assert final["fte_v_m"].null_count() == 0
    assert flown.epochs.filter(flown.epochs["leg"] != "RW26")["fte_v_m"].null_count() == 16


def test_the_setting_of_the_descent_is_tested_and_one_ten_hectopascals_off_alarms(flown: Run, shared_data: Path, tmp_path: Path) -> None:
    """C.7: intercept +14.2 m at 1005.6 hPa on this descent; 10 hPa too high is 84 m."""
    (flight,) = flown.summary.procedures
    assert flight.setting is not None
    assert (flight.setting.setting_hpa, flight.setting.origin) == (1005.6, "broadcast")
    # Another window of the same descent: the intercept's own deviation is some metres.
    assert flight.setting.intercept_m == pytest.approx(14.2, abs=4.0)
    assert flight.setting.slope == pytest.approx(0.031, abs=0.01)
    assert not flight.setting.alarm
    wrong = navbound.analyze(changed(shared_data, tmp_path, "setting", 10.0), procedure=KDEN)
    (test,) = [flight.setting for flight in wrong.summary.procedures]
    assert test is not None
    assert test.alarm
    error = float(vertical.setting_error(1005.6, 1015.6))
    # The line is read at the aerodrome by the altimeter, which is now 84 m away: 3 m at this slope.
    assert test.intercept_m == pytest.approx(flight.setting.intercept_m - error, abs=4.0)
    assert any("ALARM, altimeter setting or GNSS height" in words for words in wrong.summary.procedures[0].answers)


def test_an_unknown_height_has_a_sentence_and_no_number(shared_data: Path, tmp_path: Path) -> None:
    run = navbound.analyze(changed(shared_data, tmp_path, "without", None), procedure=KDEN)
    (flight,) = run.summary.procedures
    assert [result.by for result in flight.heights] == ["altimeter"]
    assert flight.setting is None
    assert any("not by geometry: the recording has no height above the ellipsoid" in words for words in run.summary.assumptions)


def test_a_setting_that_is_stated_overrules_the_broadcast_one(shared_data: Path) -> None:
    run = navbound.analyze(shared_data / TRACE, procedure=replace(KDEN, setting_hpa=1010.6))
    (flight,) = run.summary.procedures
    by = {result.by: result.mean_m for result in flight.heights}
    assert by["altimeter"] == pytest.approx(-16.1 + float(vertical.setting_error(1005.6, 1010.6)), abs=0.5)
    with pytest.raises(InputError, match="setting_hpa"):
        replace(KDEN, setting_hpa=29.92)
    with pytest.raises(InputError, match="undulation_m"):
        replace(KDEN, undulation_m=5000.0)


def test_the_command_prints_legs_and_answers(shared_data: Path, tmp_path: Path) -> None:
    arguments = ["analyze", str(shared_data / TRACE), "--procedure", "KDEN/H26-Z:FUZZZ", "--database", str(SAMPLE), "--line", "RNP 0.3"]
    printed = " ".join(CliRunner().invoke(app, [*arguments, "--out", str(tmp_path / "run")]).output.split())
    for words in (
        "1. Recorded positions: inside RNP at 32 of 32",
        "2. Bound of the total error (95 %): inside RNP at 32 of 32",
        "3. What the data can decide: 32 positions are worth",
        "One flight cannot show 1e-5",
        "4. By geometry",
        "5. By the altimeter",
        "inside ±22.86 m (75 ft, standard) at 16 of 16",
        "6. Altimeter setting 1005.6 hPa (broadcast)",
        "INFERRED",
    ):
        assert words in printed
    assert "By the altimeter" in (tmp_path / "run" / "summary.json").read_text(encoding="utf-8")


def test_the_vertical_path_is_of_the_coded_crossing_and_angle() -> None:
    base = procedures.read(SAMPLE)
    procedure = base.procedure("KDEN", "H26-Z", "FUZZZ", line="RNP 0.3")
    path, words = procedures.vertical_path(base, procedure)
    assert path is not None
    assert "INFERRED" in words
    # Record of RW26: 5350 ft and -3.00 degrees; undulation -18.2 m (reference), in its record by whole feet.
    assert path.crossing_m == pytest.approx(5350 * FT)
    assert path.angle_rad == pytest.approx(math.radians(3.0))
    assert path.undulation_m == pytest.approx(-18.2, abs=0.16)
    assert float(path.altitude_m([0.0])[0]) == pytest.approx(path.crossing_m)
    assert math.isnan(path.altitude_m([-1.0])[0])
    assert path.before_m(np.array([0, 3]), np.array([0.0, 100.0])).tolist() == pytest.approx(
        [math.nan, 5.18 * NM - 100.0], abs=10.0, nan_ok=True
    )
    straight, _ = procedures.vertical_path(base, procedure, "straight")
    assert straight is not None
    # s^2 / 2 r: 22 ft at 5 NM (specification, C.3).
    apart = straight.altitude_m([5 * NM]) - path.altitude_m([5 * NM])
    assert float(apart[0]) / FT == pytest.approx(22.0, abs=0.5)
    with pytest.raises(InputError, match="barometric or straight"):
        procedures.vertical_path(base, procedure, "curved")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("columns", "text", "reason"),
    [
        ((102, 106), "    ", "has no angle of a descent"),
        ((84, 89), "     ", "has no coded altitude"),
        ((82, 83), "+", "has no coded altitude"),
    ],
)
def test_a_leg_that_codes_no_vertical_path_has_none(columns: tuple[int, int], text: str, reason: str, tmp_path: Path) -> None:
    lines = SAMPLE.read_text(encoding="ascii").splitlines()
    first, last = columns
    k = next(k for k, line in enumerate(lines) if "H26-Z H      030RW26" in line)
    lines[k] = lines[k][:first] + text + lines[k][last:]
    file = tmp_path / "cut.txt"
    file.write_text("\n".join(lines) + "\n", encoding="ascii")
    base = procedures.read(file)
    path, words = procedures.vertical_path(base, base.procedure("KDEN", "H26-Z", "FUZZZ"))
    assert path is None
    assert reason in words


def test_the_obstacle_clearance_surface_is_the_budget_below_the_path_at_both_heights() -> None:
    """The property that the damaged denominator must restore: two points, and a plane through both."""
    rnp, angle, fix, threshold, crossing = 0.14 * NM, math.radians(3.0), 4500 * FT, 1200 * FT, 55 * FT
    cold = vertical.obstacle_surface(rnp, angle, fix, threshold, crossing_height_m=crossing, temperature_k=258.15)
    for height, clearance in ((250 * FT, cold.roc_low_m), (fix - threshold, cold.roc_fix_m)):
        distance = (height - crossing) / math.tan(angle)
        assert cold.altitude_m(distance) == pytest.approx(threshold + height - clearance, abs=1e-6)
    deviation = float(vertical.isa_deviation(threshold, 258.15))
    isad = float(vertical.true_height(250 * FT, threshold, deviation)) - 250 * FT
    budget = vertical.budget(rnp, angle, threshold + 250 * FT, threshold, isad_m=isad)
    assert cold.roc_low_m == pytest.approx(float(budget.veb_m), rel=1e-12)
    warm = vertical.obstacle_surface(rnp, angle, fix, threshold, crossing_height_m=crossing)
    # In cold air the aircraft is lower the higher it is: the surface is flatter, and lower at the fix.
    assert cold.slope_ratio > warm.slope_ratio > 1 / math.tan(angle)
    assert cold.roc_fix_m > warm.roc_fix_m
    assert warm.altitude_m(0.0) == threshold
    with pytest.raises(InputError, match="fix_altitude_m"):
        vertical.obstacle_surface(rnp, angle, threshold + 50.0, threshold, crossing_height_m=crossing)


def test_the_page_of_a_procedure_draws_path_and_surface(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    arguments = ["procedures", "show", str(SAMPLE), "KDEN/H26-Z:FUZZZ", "--line", "RNP 0.3", "--lowest-c", "-20", "--out", str(page)]
    shown = CliRunner().invoke(app, arguments)
    assert shown.exit_code == 0, shown.output
    html = page.read_text(encoding="utf-8")
    assert 'class="slope"' in html
    assert 'class="surface"' in html
    assert "-20 °C at the threshold" in html
    assert "INFERRED" in html


def test_the_others_around_take_a_shared_error_out_of_a_setting() -> None:
    others = [20.0, 24.0, 22.0, 400.0]
    far, near, now = 60 * NM, 5 * NM, 0.0
    area = vertical.area_setting(25.0, others, [near, near, near, far], [now] * 4)
    assert area == vertical.AreaSetting(3, 22.0, 3.0)
    # A wrong one among the others does not move the median much; two others decide nothing.
    assert vertical.area_setting(105.0, [20.0, 24.0, 22.0, 107.0], [near] * 4, [now] * 4).difference_m == pytest.approx(82.0)
    assert math.isnan(vertical.area_setting(25.0, others[:2], [near] * 2, [now] * 2).difference_m)
    assert vertical.area_setting(25.0, others, [near] * 4, [7200.0] * 4).n == 0
    with pytest.raises(InputError, match="others_m"):
        vertical.area_setting(25.0, [np.nan], [near], [now])
