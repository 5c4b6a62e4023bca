"""Performance runs: files joined by themselves, killed and gone on with, from tables and from a receiver's files."""

from __future__ import annotations

import json
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import FormatError, InputError, gnss, kpi
from navbound.errors import UnpairedError
from navbound.exit_status import NO_VERDICT
from navbound.run import directory
from navbound.run.evaluate.performance import CSV, PARTS
from test_kpi import comparable, series

LEVELS = "NPA,APV-I,LPV-200"
DAY = 4_000


def days(folder: Path, n: int = 6) -> list[Path]:
    whole = series(n * DAY)
    start = int(whole["time_ns"][0])
    paths = []
    for k in range(n):
        path = folder / f"day{k}.csv"
        whole.filter((pl.col("time_ns") - start) // (DAY * 10**9) == k).write_csv(path)
        paths.append(path)
    return paths


def command(files: list[Path], out: Path) -> list[str]:
    return [sys.executable, "-m", "navbound", "evaluate", *map(str, files), "--levels", LEVELS, "--period-s", "1", "--out", str(out)]


def left(out: Path) -> dict[str, Any]:
    """What a run leaves, but for the time of day and the folder."""
    record = json.loads((out / directory.RECORD).read_text())
    for name in ("created_utc", "command"):
        record.pop(name)
    return {
        "record": record,
        "summary": json.loads((out / directory.SUMMARY).read_text()),
        "csv": (out / CSV).read_bytes(),
        "epochs": pl.read_parquet(out / directory.EPOCHS).to_dict(as_series=False),
        "events": pl.read_parquet(out / directory.EVENTS).to_dict(as_series=False),
    }


def test_killed_in_the_middle_and_started_again_it_gives_the_same(tmp_path: Path) -> None:
    files = days(tmp_path)
    # The days hold misleading information: the run is complete, and its verdict is none.
    assert subprocess.run(command(files, tmp_path / "whole"), check=False, capture_output=True).returncode == NO_VERDICT
    out = tmp_path / "killed"
    process = subprocess.Popen(command(files, out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 60
    while len(list((out / PARTS).glob("*.json"))) < 2 and time.monotonic() < deadline and process.poll() is None:
        time.sleep(0.001)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL, "the run was over before it could be killed"
    kept = {p.name: p.stat().st_mtime_ns for p in (out / PARTS).glob("*.json")}
    assert len(kept) >= 2
    assert not (out / directory.SUMMARY).exists()
    assert subprocess.run(command(files, out), check=False, capture_output=True).returncode == NO_VERDICT
    for name, written in kept.items():
        assert (out / PARTS / name).stat().st_mtime_ns == written, "a finished part was computed again"
    assert left(out) == left(tmp_path / "whole")


def test_files_in_any_order_give_what_one_table_gives(tmp_path: Path) -> None:
    files = days(tmp_path)
    run = navbound.evaluate([files[k] for k in (4, 0, 5, 2, 1, 3)], levels=LEVELS, period_s=1.0)
    expected = comparable(kpi.evaluate(series(6 * DAY), LEVELS, period_s=1.0))
    result = comparable(run.summary.performance)  # type: ignore[arg-type]
    for name in ("title", "notes"):
        expected.pop(name), result.pop(name)
    assert result == expected
    assert run.events.height == sum(expected["n_events"].values())
    assert run.epochs.height == series(6 * DAY).height


def test_the_run_directory_holds_the_fields_columns(tmp_path: Path) -> None:
    files = days(tmp_path, 1)
    out = tmp_path / "run"
    run = navbound.evaluate(files, levels="APV-I", out=out)
    assert run.report.is_file()
    again = directory.load(out)
    assert again.summary == run.summary
    table = pl.read_csv(out / CSV, infer_schema_length=None)
    assert {"YEAR", "DOY", "SOD", "WEEK", "TOW", "MODE", "NERR", "EERR", "UERR", "HPE", "HPL", "VPE", "VPL", "NUSED"} <= set(table.columns)
    # 10^15 ns after 1980-01-06 00:00: 11 days, 13 h 46 min 40 s.
    row = table.row(0, named=True)
    assert (row["YEAR"], row["WEEK"]) == (1980, 1)
    first = series(DAY)["time_ns"][0]
    assert row["TOW"] == (first - 604_800 * 10**9) / 1e9
    assert row["DOY"] == 6 + 11
    assert row["SOD"] == (first - 11 * 86_400 * 10**9) / 1e9
    assert row["NERR"] == pytest.approx(-series(DAY)["nse_n_m"][0], rel=1e-15)


def test_positions_with_levels_and_a_fixed_truth(tmp_path: Path) -> None:
    """A day of a service as a receiver's table has it: positions and levels; the truth is a point."""
    truth = np.array([4_000_000.0, 1_000_000.0, 4_850_000.0])
    lat, lon, h = gnss.geodetic(truth)
    n = 600
    rows = pl.DataFrame(
        {
            "time_ns": np.arange(n) * 10**9,
            "est_lat_rad": np.full(n, lat) + 2.0 / 6.37e6,
            "est_lon_rad": np.full(n, lon),
            "est_h_m": np.full(n, h) + 3.0,
            "HPL (m)": np.full(n, 20.0),
            "vpl": np.full(n, 30.0),
        }
    )
    rows.write_parquet(tmp_path / "positions.parquet")
    run = navbound.evaluate(tmp_path / "positions.parquet", levels="LPV-200", truth=",".join(map(str, truth)))
    result = run.summary.performance
    assert result is not None
    h_error, v_error = result.axes[0].error_m, result.axes[1].error_m
    assert h_error is not None
    assert v_error is not None
    # 2 m on a sphere of 6370 km; the meridian's radius is within 1 % of it.
    assert h_error.p95 == pytest.approx(2.0, rel=0.01)
    assert v_error.p95 == pytest.approx(3.0, abs=1e-6)
    assert result.levels[0].availability_expected == 1.0


def test_observations_navigation_and_messages_from_the_command_line(shared_data: Path, tmp_path: Path) -> None:
    sbas = shared_data / "sbas"
    names = ("virtual_user_2025046_17h.25O.gz", "gps_2025046_17h_rinex3.nav", "msas137_2025046_17h.ems")
    arguments = ["--truth=-3962108.2258,3381309.0271,3668678.5241", "--levels", "APV-I", "--json", "--out", str(tmp_path / "run")]
    done = subprocess.run(
        [sys.executable, "-m", "navbound", "analyze", *(str(sbas / name) for name in names), *arguments], capture_output=True, check=True
    )
    data = json.loads(done.stdout)["performance"]
    # The specification: the messages allow precision approach 143 s after the first, and nothing after it is lost.
    assert (data["n_expected"], data["n_no_solution"]) == (3600, 143)
    level = data["levels"][0]
    assert (level["n_available"], level["n_continuity_events"]) == (3600 - 143, 0)
    assert data["events"][0]["cause"] == "no solution"
    # The oracle's levels over its own 3239 epochs, of which ours are a superset: HPL 11.8 to 15.2 m, VPL 20.6 to 34.0 m.
    oracle = pl.read_csv(sbas / "msas2025046_pl_1hz.csv", comment_prefix="#")
    ours = pl.read_parquet(tmp_path / "run" / directory.EPOCHS)["hpl_m"].drop_nulls()
    assert oracle.height == 3239
    assert ours.tail(3239).median() == pytest.approx(13.0, abs=0.05)
    assert any("belong to the same solutions" in note for note in data["notes"])
    # Positions are the service's: the covariance of each is that of its level, and none stands where the service gives none.
    epochs = pl.read_parquet(tmp_path / "run" / directory.EPOCHS)
    assert epochs.filter(pl.col("hpl_m").is_null())["est_lat_rad"].is_null().all()
    assert epochs.filter(pl.col("hpl_m").is_not_null())["nse_e_m"].is_not_null().all()
    # The satellites of each solution, where the solution without the service sees them.
    satellites = pl.read_parquet(tmp_path / "run" / directory.SATELLITES)
    assert satellites.group_by("time_ns").len().sort("time_ns")["len"].to_list() == epochs.filter(pl.col("n_sv") > 0)["n_sv"].to_list()
    observations, navigation = gnss.read_observations(sbas / names[0]), gnss.read_navigation(sbas / names[1])
    own = gnss.solve(observations, navigation, systems="G", keep_ranges=True).heard
    assert own is not None
    both = satellites.join(own, on=["time_ns", "sv"]).drop_nulls(["az_rad", "az_rad_right"])
    assert both.height == satellites.height
    # Two positions some metres apart, and satellites 20 000 km away.
    apart = both.select(az=(pl.col("az_rad") - pl.col("az_rad_right")).cos(), el=(pl.col("el_rad") - pl.col("el_rad_right")).abs())
    assert apart["az"].to_numpy().min() > 1.0 - 1e-10
    assert apart["el"].to_numpy().max() < 1e-5


@pytest.mark.parametrize(
    ("content", "options", "words"),
    [
        ("time_ns,vpl_m\n0,1\n1000000000,1\n", {}, "hpl_m"),
        ("hpl_m\n1\n2\n", {}, "time"),
        ("time_ns,hpl_m\n0,1\n1000000000,1\n", {"truth": "1000,2,3"}, "within 100 km"),
        ("time_ns,hpl_m\n0,1\n1000000000,1\n", {"truth": "4000000,1000000,4850000"}, "holds no positions"),
        ("time_ns,hpl_m\n0,1\n1000000000,1\n", {"truth": "absent.csv"}, "absent.csv"),
        ("icao24,time_ns,hpl_m\na,0,1\nb,1000000000,1\n", {}, "one receiver"),
        ("time_ns,hpl_m\n0,1\n", {}, "period_s"),
    ],
)
def test_what_cannot_be_evaluated_is_refused(tmp_path: Path, content: str, options: dict[str, Any], words: str) -> None:
    path = tmp_path / "table.csv"
    path.write_text(content)
    with pytest.raises((InputError, FormatError), match=words):
        navbound.evaluate(path, levels="NPA", **options)


def test_levels_of_error_extraction_say_everywhere_what_they_are(tmp_path: Path) -> None:
    path, out = tmp_path / "table.csv", tmp_path / "run"
    path.write_text("time_ns,ee_bound_h_m,ee_bound_v_m\n0,5,6\n1000000000,5,6\n2000000000,5,6\n")
    run = navbound.evaluate(path, levels="APV-I", columns={"hpl_m": "ee_bound_h_m", "vpl_m": "ee_bound_v_m"}, out=out)
    label = "experimental, not integrity"
    assert run.summary.performance is not None
    assert run.summary.performance.experimental == label
    assert run.summary.verdict.experimental
    assert label in run.summary.verdict.words
    header = (out / CSV).read_text().splitlines()[0]
    assert all(f"{name} [{label}]" in header for name in ("HPL", "HSI", "VPL", "VSI"))
    # Words of the caller's own stand in the same places; a table without any has none.
    path.write_text("time_ns,hpl_m\n0,5\n1000000000,5\n")
    assert navbound.evaluate(path, levels="NPA", experimental="a trial").summary.performance.experimental == "a trial"  # type: ignore[union-attr]
    assert navbound.evaluate(path, levels="NPA").summary.performance.experimental == ""  # type: ignore[union-attr]


def test_other_files_in_the_directory_are_not_overwritten(tmp_path: Path) -> None:
    out = tmp_path / "home"
    out.mkdir()
    (out / "thesis.txt").write_text("mine")
    with pytest.raises(FormatError, match="thesis"):
        navbound.evaluate(days(tmp_path, 1), levels="NPA", out=out)


def test_a_damaged_part_is_named(tmp_path: Path) -> None:
    files, out = days(tmp_path, 1), tmp_path / "run"
    navbound.evaluate(files, levels="NPA", out=out)
    (record,) = (out / PARTS).glob("*.json")
    record.write_text("{")
    with pytest.raises(FormatError, match="delete it"):
        navbound.evaluate(files, levels="NPA", out=out)


@pytest.mark.parametrize("harm", ["level", "count", "digests"])
def test_a_part_whose_content_was_changed_is_not_taken(tmp_path: Path, harm: str) -> None:
    (file,) = days(tmp_path, 1)
    navbound.evaluate(file, levels="NPA", period_s=1.0, out=tmp_path / "run")
    (table,) = (tmp_path / "run" / PARTS).glob("*.parquet")
    (record,) = (tmp_path / "run" / PARTS).glob("*.json")
    kept = json.loads(record.read_text())
    if harm == "level":
        pl.read_parquet(table).with_columns(hpl_m=pl.col("hpl_m") * 0.5).write_parquet(table)
    elif harm == "count":
        kept["facts"]["n_epochs"] += 1
    else:
        del kept["facts"]["digests"]
    record.write_text(json.dumps(kept))
    with pytest.raises(FormatError, match=r"is not what was kept.*to compute this part again"):
        navbound.evaluate(file, levels="NPA", period_s=1.0, out=tmp_path / "run")


def test_observations_alone_are_refused(shared_data: Path) -> None:
    file = shared_data / "sbas" / "virtual_user_2025046_17h.25O.gz"
    with pytest.raises(UnpairedError) as refused:
        navbound.evaluate(file, levels="NPA")
    assert str(refused.value).startswith(
        f"{file} holds observations and no orbits: name a RINEX navigation file of the same time beside it"
    )
    assert "is not accepted" not in str(refused.value)
    again = pickle.loads(pickle.dumps(refused.value))
    assert (str(again), again.argument, again.value) == (str(refused.value), "files", file)


def errors_and_levels(path: Path, *names: str) -> Path:
    columns = {"hpe_m": [0.4, 61.0, 0.5], "vpe_m": [0.7, 0.9, -0.8], "hpl_m": [9.5, 9.5, 9.5], "vpl_m": [14.5, 14.5, 14.5]}
    pl.DataFrame({"unix_time": [1633608773, 1633608774, 1633608775], **{n: columns[n] for n in names}}).write_csv(path)
    return path


def test_errors_by_size_alone_are_errors(tmp_path: Path) -> None:
    path = errors_and_levels(tmp_path / "levels.csv", "hpe_m", "vpe_m", "hpl_m", "vpl_m")
    run = navbound.evaluate(path, levels="APV-I")
    assert run.summary.performance is not None
    assert run.summary.performance.truth_known
    (level,) = run.summary.performance.levels
    assert [counts.n_hmi for counts in level.stanford] == [1, 0]


@pytest.mark.parametrize(("levels", "absent"), [("APV-I", "vpl_m"), ("NPA,APV-I", "vpl_m"), ("NPA", "hpl_m")])
def test_a_level_that_is_judged_and_absent_refuses_the_file(tmp_path: Path, levels: str, absent: str) -> None:
    columns = [name for name in ("hpe_m", "vpe_m", "hpl_m", "vpl_m") if name != absent]
    path = errors_and_levels(tmp_path / "levels.csv", *columns)
    with pytest.raises(FormatError, match=f"{absent}: no column holds it"):
        navbound.evaluate(path, levels=levels)


def test_a_vertical_level_is_not_needed_where_no_level_has_a_vertical_limit(tmp_path: Path) -> None:
    path = errors_and_levels(tmp_path / "levels.csv", "hpe_m", "hpl_m")
    assert navbound.evaluate(path, levels="NPA").summary.performance is not None


def test_the_old_spelling_works_for_one_release_and_says_so(tmp_path: Path) -> None:
    (file,) = days(tmp_path, 1)
    with pytest.warns(DeprecationWarning, match=r"analyze\(levels=\.\.\.\) is evaluate\(levels=\.\.\.\)"):
        old = navbound.analyze(file, levels="NPA", period_s=1.0).summary.performance
    assert old == navbound.evaluate(file, levels="NPA", period_s=1.0).summary.performance
    words = [sys.executable, "-m", "navbound", "analyze", str(file), "--levels", "NPA", "--out", str(tmp_path / "run")]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode in {0, 4}
    assert "analyze --levels is navbound evaluate --levels" in done.stderr
    help_text = subprocess.run([*words[:4], "--help"], capture_output=True, text=True, check=True).stdout
    assert "--protection" not in help_text, "what it has no use for is not offered"


def test_an_option_of_levels_without_levels_names_the_command_that_has_it(tmp_path: Path) -> None:
    (file,) = days(tmp_path, 1)
    words = [sys.executable, "-m", "navbound", "analyze", str(file), "--protection", "raim"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, "--protection needs --levels" in done.stderr, "navbound evaluate" in done.stderr) == (2, True, True)
