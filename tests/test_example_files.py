"""The example files are what the command makes, say what they say, and the commands of the documents that name them run."""

from __future__ import annotations

import math
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Literal

import numpy as np
import polars as pl
import pytest

from navbound import InputError, examples, gnss, raim, write
from navbound.examples.files import STATION

ROOT = Path(__file__).parents[1]
DATA = ROOT / "examples" / "data"
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), DATA / "README.md"]
FILES = [file for example in examples.EXAMPLES.values() for file in example.files]
NS = 1_000_000_000


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    assert [file.name for file in examples.make([], folder)] == FILES
    return folder


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_what_the_command_makes(made: Path, name: str) -> None:
    assert (DATA / name).read_bytes() == (made / name).read_bytes(), "run navbound example --out examples/data"


def test_the_folder_holds_these_files_and_is_small() -> None:
    present = {path.name for path in DATA.iterdir()}
    assert present == {*FILES, "README.md"}
    assert sum(path.stat().st_size for path in DATA.iterdir()) < 3e6
    page = (DATA / "README.md").read_text(encoding="utf-8")
    assert all(f"`{name}`" in page for name in FILES)


def test_the_antenna_stands_where_the_truth_says() -> None:
    # WGS-84, closed form, written down here.
    a, e2 = 6378137.0, (2 - 1 / 298.257223563) / 298.257223563
    normal = a / math.sqrt(1 - e2 * math.sin(STATION.lat_rad) ** 2)
    across = (normal + STATION.h_m) * math.cos(STATION.lat_rad)
    along_axis = (normal * (1 - e2) + STATION.h_m) * math.sin(STATION.lat_rad)
    place = (across * math.cos(STATION.lon_rad), across * math.sin(STATION.lon_rad), along_axis)
    # Four decimals are written.
    assert np.abs(np.array(place) - examples.PLACE_ECEF_M).max() <= 0.51e-4


def _positions(observations: str, navigation: str, signals: Literal["single", "dual"]) -> pl.DataFrame:
    read = gnss.read_observations(DATA / observations), gnss.read_navigation(DATA / navigation)
    return gnss.solve(*read, truth_ecef_m=examples.PLACE_ECEF_M, signals=signals).epochs


def _largest(epochs: pl.DataFrame) -> list[float]:
    return [float(np.abs(epochs[f"nse_{axis}_m"].to_numpy()).max()) for axis in "enu"]


def test_positions_of_one_frequency_are_as_good_as_they_say() -> None:
    epochs = _positions("station.rnx", "broadcast.rnx", signals="single")
    assert epochs.height == 230
    for axis in "enu":
        error, variance = epochs[f"nse_{axis}_m"].to_numpy(), epochs[f"cov_{axis}{axis}_m2"].to_numpy()
        # Chance of a Gaussian error beyond: 6e-5 an axis and epoch. A wrong sign of clock, rotation or delay is tens of metres.
        assert (np.abs(error) / np.sqrt(variance)).max() < 4.0, axis
        assert np.abs(error).mean() > 0.01, axis


@pytest.mark.parametrize(("observations", "navigation"), [("station.rnx", "broadcast.rnx"), ("receiver.ubx", "receiver-broadcast.rnx")])
def test_positions_of_two_frequencies_are_as_good_as_what_was_added(observations: str, navigation: str) -> None:
    epochs = _positions(observations, navigation, signals="dual")
    assert epochs.height in {230, 180}
    east, north, up = _largest(epochs)
    # At 5 degrees noise of 0.25 m and multipath of 0.45 m, times 2.98 of the pair L1-L2, with 0.6 m of orbits and 0.6 m of troposphere:
    # 1.8 m. Five times that, with dilutions of 1.2 and 2.5, which this sky stays below.
    assert max(east, north) < 5 * 1.8 * 1.2
    assert up < 5 * 1.8 * 2.5


def test_protection_levels_of_the_station_hold() -> None:
    observations, navigation = gnss.read_observations(DATA / "station.rnx"), gnss.read_navigation(DATA / "broadcast.rnx")
    watched = raim.watch(observations, navigation, truth_ecef_m=examples.PLACE_ECEF_M).epochs
    hpe = np.hypot(watched["nse_e_m"].to_numpy(), watched["nse_n_m"].to_numpy())
    hpl = watched["hpl_m"].to_numpy()
    assert np.isfinite(hpl).all()
    assert (hpe < hpl).all()
    # Nothing beyond a hundred metres bounds anything here.
    assert hpl.max() < 100.0


def test_the_station_is_silent_during_its_outage_and_its_faulty_satellite_is_excluded() -> None:
    observations, navigation = gnss.read_observations(DATA / "station.rnx"), gnss.read_navigation(DATA / "broadcast.rnx")
    since_s = (observations.time_ns - STATION.begin_ns) / NS
    (silent,) = STATION.outages_s
    expected = [s for s in 30.0 * np.arange(240) if not silent[0] <= s < silent[1]]
    assert since_s.tolist() == expected
    ((satellite, during_s, _, _),) = STATION.wrong
    watched = raim.watch(observations, navigation, truth_ecef_m=examples.PLACE_ECEF_M).epochs
    excluded = watched.filter(pl.col("excluded_sv").is_not_null())
    assert set(excluded["excluded_sv"]) == {satellite}
    fault_s = (excluded["time_ns"].to_numpy() - STATION.begin_ns) / NS
    assert fault_s.tolist() == [s for s in expected if during_s[0] <= s < during_s[1]]


def test_a_log_becomes_an_observation_file(tmp_path: Path) -> None:
    log = gnss.read_observations(DATA / "receiver.ubx")
    back = gnss.read_observations(write.observations(log, tmp_path / "log.rnx"))
    assert (back.n_refused, back.codes, back.time_ns.tolist()) == (0, log.codes, log.time_ns.tolist())
    for system, codes in log.codes.items():
        for code in codes:
            one, other = log.column(system, code), back.column(system, code)
            assert one.drop("value").equals(other.drop("value"))
            # Three decimals are written.
            assert np.abs(one["value"].to_numpy() - other["value"].to_numpy()).max() <= 0.000501


def test_records_come_back(tmp_path: Path) -> None:
    navigation = gnss.read_navigation(DATA / "broadcast.rnx")
    back = gnss.read_navigation(write.navigation(navigation, tmp_path / "again.rnx"))
    assert (back.refused, back.leap_seconds, back.has_ionosphere) == ([], 18, True)
    # What was read once has thirteen digits and is written with all of them.
    assert back.records().equals(navigation.records())


def test_a_log_keeps_what_it_can_and_counts_what_it_cannot(tmp_path: Path) -> None:
    station = gnss.read_observations(DATA / "station.rnx")
    written = write.ubx(station, tmp_path / "station.ubx")
    assert (written.n_epochs, written.n_left_out) == (230, 0)
    back = gnss.read_observations(written.path)
    assert back.column("E", "C5Q")["value"].equals(station.column("E", "C5Q")["value"])


def test_an_example_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="one of rinex, ubx") as refusal:
        examples.make(["sbas"], tmp_path)
    assert refusal.value.argument == "names"
    assert not list(tmp_path.iterdir())


def commands() -> list[str]:
    """Commands of the documents that name the example files."""
    lines = [line.split("#")[0].strip() for page in PAGES for line in page.read_text(encoding="utf-8").splitlines()]
    return sorted({line for line in lines if re.match(r"navbound .*examples/data", line)})


def test_there_are_commands() -> None:
    assert len(commands()) >= 6


@pytest.mark.parametrize("command", commands())
def test_a_command_that_names_the_examples_runs(command: str, tmp_path: Path) -> None:
    words = shlex.split(command)[1:]
    if words[0] == "example":
        words = [str(tmp_path) if word == "examples/data" else word for word in words]
    else:
        words = [str(ROOT / word) if word.startswith("examples/data") else word for word in words] + ["--out", str(tmp_path / "run")]
    done = subprocess.run([sys.executable, "-m", "navbound", *words], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
