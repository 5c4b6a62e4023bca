"""Recorded tracks judged against a procedure from the command line on: RNP of each leg in table, monitor and words."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import navbound
from navbound import InputError
from navbound.cli.main import app
from navbound.procedures.names import parts
from navbound.run.directory import Run
from navbound.run.procedure import Flown

NM = 1852.0
SAMPLE = Path(__file__).parent / "procedures" / "KDEN_H26-Z.txt"
TRACE = Path("aircraft") / "other" / "trace_full_ac671b.json.gz"


def kden(line: str | None = "RNP 0.3") -> Flown:
    return Flown(SAMPLE, "KDEN/H26-Z:FUZZZ", line)


@pytest.fixture(scope="module")
def flown(shared_data: Path) -> Run:
    return navbound.analyze(shared_data / TRACE, procedure=kden())


def shifted(shared_data: Path, folder: Path, north_deg: float) -> Path:
    trace = json.loads(gzip.decompress((shared_data / TRACE).read_bytes()))
    for row in trace["trace"]:
        row[1] += north_deg
    file = folder / "trace_full_ac671b.json"
    file.write_text(json.dumps(trace), encoding="utf-8")
    return file


def test_every_epoch_has_the_rnp_of_its_leg(flown: Run) -> None:
    epochs = flown.epochs
    assert epochs.height == 32
    rnp = dict(epochs.select("leg", "rnp_m").unique().iter_rows())
    assert rnp == pytest.approx({"JPBAG": 1.0 * NM, "GRASP": 1.0 * NM, "RW26": 0.3 * NM})
    assert set(epochs["phase"]) == {"approach", "final"}
    # 25.45 m and 11.08 m: reference, largest deviation on the first and on the last leg.
    assert epochs["fte_m"].abs().max() == pytest.approx(25.447, abs=0.01)
    assert epochs.filter(leg="RW26")["fte_m"].abs().max() == pytest.approx(11.078, abs=0.01)


def test_the_verdict_and_the_three_answers(flown: Run) -> None:
    assert flown.summary.verdict.id == "inside"
    (flight,) = flown.summary.procedures
    words = "\n".join([*flight.answers, *flown.summary.assumptions])
    assert "inside RNP at 32 of 32, inside twice RNP at 32 of 32" in words
    assert "Bound of the total error (95 %): inside RNP at 32 of 32" in words
    assert "cannot show 1e-5" in words
    assert "INFERRED" in words


def test_the_database_is_an_input_of_the_record(flown: Run) -> None:
    assert any(x.path == str(SAMPLE) and x.n_bytes == SAMPLE.stat().st_size for x in flown.record.inputs)
    assert flown.record.settings["procedure"]["line"] == "RNP 0.3"  # type: ignore[index]


def test_a_track_700_m_beside_is_not_inside(shared_data: Path, tmp_path: Path) -> None:
    # 700 m of a meridian at 39.8 degrees (M = 6,361 km; derived).
    run = navbound.analyze(shifted(shared_data, tmp_path, 700.0 / 6_361_000.0 * 57.29577951308232), procedure=kden())
    last = run.epochs.filter(leg="RW26")
    assert last.height == 16
    assert (last["fte_m"].abs() > 0.3 * NM).all()
    assert (last["fte_m"].abs() < 0.6 * NM).all()
    assert run.summary.verdict.id == "outside"
    assert any("not within RNP; within twice RNP" in words for words in run.summary.procedures[0].answers)


def test_a_leg_without_rnp_is_expected_and_not_shown(shared_data: Path, tmp_path: Path) -> None:
    text = SAMPLE.read_text(encoding="ascii")
    file = tmp_path / "blank.txt"
    # The last leg without its RNP: half of the approach cannot be judged.
    file.write_text(text.replace("GY M 031TF", "GY M    TF"), encoding="ascii")
    run = navbound.analyze(shared_data / TRACE, procedure=Flown(file, "KDEN/H26-Z:FUZZZ"))
    assert run.epochs.height == 16
    assert run.summary.verdict.id != "inside"
    assert any("16 positions on legs without an RNP" in words for words in run.summary.assumptions)
    assert navbound.analyze(shared_data / TRACE, procedure=Flown(file, "KDEN/H26-Z:FUZZZ", "RNP 0.3")).epochs.height == 32


def test_a_track_elsewhere_is_refused(shared_data: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no epoch is established"):
        navbound.analyze(shifted(shared_data, tmp_path, -2.0), procedure=kden())


def test_both_approaches_of_a_day_are_flights_of_their_own(shared_data: Path) -> None:
    run = navbound.analyze(shared_data / TRACE, procedure=Flown(shared_data / "procedures" / "KMSP.txt", "KMSP/H12RY:PAETN"))
    assert [t.track for t in run.summary.tracks] == ["ac671b KMSP/H12RY:PAETN", "ac671b KMSP/H12RY:PAETN 2"]
    first = run.epochs.filter(track="ac671b KMSP/H12RY:PAETN")
    # 34 positions after the join, RMS 5.48 m and largest 11.02 m on the last leg: reference.
    last = first.filter(leg="RW12R")["fte_m"].to_numpy()
    assert (first.height, last.size) == (34, 25)
    assert float(np.sqrt(np.mean(last**2))) == pytest.approx(5.476, abs=0.01)
    assert float(np.abs(last).max()) == pytest.approx(11.022, abs=0.01)


@pytest.mark.parametrize("name", ["KDEN", "KDEN/", "KDEN/H26-Z:", "KDEN:H26-Z", "KDEN/H26-Z/FUZZZ"])
def test_a_name_of_another_form_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="AIRPORT/PROCEDURE"):
        parts(name)


def test_options_that_would_do_nothing_are_refused() -> None:
    for arguments in (["--line", "RNP 0.3"], ["--procedure", "KDEN/H26-Z"], ["--database", str(SAMPLE)]):
        result = CliRunner().invoke(app, ["analyze", "track.csv", *arguments])
        assert isinstance(result.exception, InputError)


def test_the_commands_print_list_legs_and_contradictions(shared_data: Path, tmp_path: Path) -> None:
    run = CliRunner().invoke
    listed = json.loads(run(app, ["procedures", "list", str(SAMPLE), "--json"]).stdout)
    assert [(p["airport"], p["ident"], len(p["routes"])) for p in listed["procedures"]] == [("KDEN", "H26-Z", 3)]
    page = tmp_path / "page.html"
    shown = run(app, ["procedures", "show", str(SAMPLE), "KDEN/H26-Z:CAPTJ", "--missed", "--line", "RNP 0.15", "--out", str(page)])
    assert shown.exit_code == 0, shown.output
    html = page.read_text(encoding="utf-8")
    # CAPTJ-BCALN, BCALN-JPBAG, JPBAG-GRASP, GRASP-RW26, the climb and the hold in plan; coded altitudes, vertical path and the
    # surface below it in the profile.
    assert html.count("<polyline") == 9
    assert "line selected" in html
    assert "(field 0.3)" in html
    kaus = str(shared_data / "procedures" / "KAUS.txt")
    checked = json.loads(run(app, ["procedures", "check", kaus, "--json"]).stdout)
    assert [f["where"] for f in checked["findings"] if not f["remark"]] == ["KAUS/H18RZ/SMRFF/60", "KAUS/H18RZ/XWING/50", "KAUS/H18RZ//30"]
    table = run(app, ["procedures", "check", kaus]).output
    assert "102.6° apart" in table
    assert "a factor of 10" in table
