"""Who is refused reads what was typed, what it should be and what to do: stones that newcomers stumbled over."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import navbound
from navbound import FormatError, InputError, kpi
from navbound.cli import main, parts
from navbound.read.truth import truth_of
from navbound.run.evaluate.monitored import monitor_of
from navbound.run.procedure import heights
from test_verdict import table


def _refused(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> str:
    monkeypatch.setattr(sys, "argv", ["navbound", *arguments])
    with pytest.raises(Exception) as refused:  # noqa: PT011 - the parser's own class, which it does not publish
        main.app(list(arguments), standalone_mode=False)
    assert hasattr(refused.value, "format_message")
    return main._of_parser(refused.value)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("evaluate", "a.csv"), "Missing option '--levels': Service levels, separated by commas"),
        (("predict", "flight"), "of a flight the PLAN.toml"),
        (("analyze",), "Missing argument 'files': Tables (CSV, Parquet, JSON)"),
        (("analyze", "a.csv", "--sigma-m", "2.5m"), "--sigma-m = 2.5m is not accepted"),
        (("analyze", "a.csv", "--sigma-m=2.5m"), "Stated standard deviation of the position per axis"),
    ],
)
def test_the_parser_says_what_was_typed_and_what_it_is(monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str) -> None:
    assert words in _refused(monkeypatch, *arguments)


def test_a_misspelt_command_stays_as_the_parser_words_it(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _refused(monkeypatch, "demos") == "No such command 'demos'. Did you mean 'demo'?"


@pytest.mark.parametrize("point", ["48.99,182.57,120", "4189135,188029", "4189.1,188.0,4789.9"])
def test_a_truth_that_is_no_earth_fixed_point_is_refused_with_what_is_allowed(point: str) -> None:
    with pytest.raises(
        InputError, match=r"truth = .* is not accepted; expected LAT,LON,H in degrees and metres .*, X,Y,Z in metres, Earth-fixed, "
    ):
        truth_of(point, 0.01)


def test_a_file_whose_name_is_numbers_is_still_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("1,2").write_text("", encoding="utf-8")
    assert truth_of("1,2", 0.01).ecef_m is None


def test_a_folder_among_the_files_is_named_as_one(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="is a folder; name the files in it"):
        parts.run_folder([tmp_path], None)


def test_levels_of_a_file_do_not_stand_in_the_way_of_its_positions(tmp_path: Path) -> None:
    file = tmp_path / "station.rnx"
    file.touch()
    judged, evaluated = parts.run_folder([file], None), parts.run_folder([file], None, "evaluate-")
    assert (judged, evaluated) == (Path("out/station"), Path("out/evaluate-station"))


def test_who_asks_for_sbas_reads_how_its_levels_come() -> None:
    with pytest.raises(InputError, match=r"given takes .* SBAS service from its messages among the files"):
        monitor_of("sbas")


def test_a_file_without_accuracies_says_how_to_state_one(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    full = table(path, 5).read_text(encoding="utf-8").splitlines()
    kept = [k for k, name in enumerate(full[0].split(",")) if not name.startswith(("cov_", "sigma", "hpl", "epu"))]
    path.write_text("\n".join(",".join(line.split(",")[k] for k in kept) for line in full) + "\n", encoding="utf-8")
    words = " ".join(navbound.analyze(path).summary.assumptions)
    assert "state a sigma (--sigma-m; in Python sigma_m)" in words
    assert "(--map; in Python columns)" in words


def test_a_stated_setting_without_pressure_altitude_is_not_requested_again() -> None:
    stated = heights._altimeter(pressure=False, compared=False, origin="given")
    assert stated == "not by the altimeter: the recording has no pressure altitude, so the setting that was stated is not used"
    assert "--setting-hpa" in heights._altimeter(pressure=True, compared=False, origin="broadcast")
    assert "--setting-hpa" not in heights._altimeter(pressure=False, compared=False, origin="broadcast")


def test_a_stanford_diagram_takes_a_level_for_every_error() -> None:
    with pytest.raises(InputError, match=r"level_m = shape \(1,\) is not accepted; expected the shape of error_m, \(2,\)"):
        kpi.stanford([1.0, 2.0], [1.5], 50.0)
