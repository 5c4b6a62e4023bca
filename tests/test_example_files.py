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

from navbound import InputError, examples, gnss, procedures, raim, scenario, write
from navbound.algorithms import Place, entries
from navbound.cli.main import app
from navbound.examples.files import STATION
from navbound.maps.kinds import kinds
from navbound.studies.registry import STUDIES

ROOT = Path(__file__).parents[1]
DATA = ROOT / "examples" / "data"
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), DATA / "README.md"]
FILES = [file for example in examples.EXAMPLES.values() for file in example.files]
NS = 1_000_000_000
MAKE = "navbound example --out examples/data"


def run(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", *words], capture_output=True, text=True, cwd=folder, check=False)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """By the command of the documents, in a process of its own."""
    folder = tmp_path_factory.mktemp("made")
    done = run([str(folder) if word == "examples/data" else word for word in MAKE.split()], folder)
    assert done.returncode == 0, done.stdout + done.stderr
    assert [Path(line).name for line in done.stdout.splitlines()[:-1]] == FILES
    assert {path.name for path in folder.iterdir()} == set(FILES)
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


def test_the_database_has_the_one_contradiction_that_its_page_states() -> None:
    database = procedures.read(DATA / "procedure.txt")
    assert database.refused == []
    # The coded radius is 3.3 NM, the fixes lie on a circle of 3 NM: 0.3 NM apart.
    (finding,) = database.contradictions()
    assert (finding.kind, finding.line) == ("radius", 17)
    assert "coded radius 3.300 NM, the fixes give 3.000 NM: 555." in finding.words
    north = database.procedure("XNAV", "H27", "NORTH", line="RNP 0.3")
    assert [leg.terminator for leg in north.legs] == ["IF", "TF", "RF", "TF", "TF"]
    # 5 + 3 pi / 2 + 1 + 5.18 NM; places are written to 0.3 m, which five legs have ten of.
    assert north.length_m == pytest.approx((11.18 + 1.5 * math.pi) * 1852.0, abs=3.0)


def test_the_almanac_has_the_slots_of_the_performance_standard() -> None:
    read = gnss.constellation(DATA / "almanac.al3", near_ns=STATION.begin_ns)
    # Sunday 2026-03-01 00:00:00 of GPS time.
    assert read.reference_ns == 2408 * 604_800 * NS
    assert np.degrees(read.inclination_rad).round(9).tolist() == [55.0] * 27
    # Fourteen digits are written: of a root of 5154 m^0.5 to 5e-10, of the axis to 5e-6 m; angles come back but for whole turns.
    nominal = gnss.constellation("gps-expanded")
    assert read.satellite == nominal.satellite
    assert np.abs(read.semi_major_m - nominal.semi_major_m).max() < 1e-3
    apart = (read.elements() - nominal.elements())[:, 2:6]
    assert np.abs(np.sin(0.5 * apart)).max() < 1e-12


def test_an_example_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="one of rinex, sbas, ubx") as refusal:
        examples.make(["glonass"], tmp_path)
    assert refusal.value.argument == "names"
    assert not list(tmp_path.iterdir())


OWN = "your own"
"""What the remark of a command says whose files a reader brings."""
COMMANDS = {*(command.name for command in app.registered_commands), *(group.name for group in app.registered_groups)}


def lines(pages: list[Path]) -> list[tuple[str, str]]:
    """Commands of the documents, each with its remark."""
    whole = [line for page in pages for line in page.read_text(encoding="utf-8").splitlines()]
    return [
        (command.strip(), remark)
        for command, _, remark in (line.partition("#") for line in whole)
        if command.split()[:1] == ["navbound"] and command.split()[1] in COMMANDS
    ]


def commands() -> list[str]:
    """Commands of the documents that name the example files, and nothing that a reader brings."""
    return sorted({command for command, remark in lines(PAGES) if "examples/data" in command and OWN not in remark})


def test_there_are_commands() -> None:
    assert len(commands()) >= 10


FILE = re.compile(r"\.(csv|gz|json|al3|alm|toml|rnx|nav|ubx|ems|txt|pos|parquet)$|^FAACIFP18$")
MADE = ("examples/data/", "tests/procedures/", "out/")
"""Folders of the repository, and what an earlier command has made."""


@pytest.mark.parametrize(("command", "remark"), lines(PAGES))
def test_a_file_of_a_command_is_there_or_is_marked_as_your_own(command: str, remark: str) -> None:
    words = shlex.split(command)
    written = {words.index(option) + 1 for option in ("--out",) if option in words}
    absent = [word for k, word in enumerate(words) if k not in written and FILE.search(word) and not word.startswith(MADE)]
    assert not absent or OWN in remark, absent
    assert all((ROOT / word).is_file() for word in words if word.startswith(MADE[:2]))


def known() -> set[str]:
    """Words that commands of the README take which are no files: their names, and those of what ships with navbound."""
    registered = [scenario.shipped(), STUDIES, kinds(), entries(Place)]
    return {name for names in registered for name in names} | {"flight", "replay", "fleet", "check", "simulated:5000"}


def test_what_a_command_of_the_readme_takes_is_a_file_that_is_there_or_a_name_that_ships() -> None:
    sh = re.search(r"## In your hands\n\n```sh\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S)
    assert sh
    taken = []
    for line in sh.group(1).splitlines():
        command, _, remark = line.partition("#")
        words = shlex.split(command)[2:]
        first = next((k for k, word in enumerate(words) if word.startswith("--")), len(words))
        taken += [word for word in words[:first] if OWN not in remark]
    strange = [word for word in taken if not word.startswith(MADE) and word not in known() | {"flight.kml"}]
    assert not strange
    assert len(taken) > 20


@pytest.mark.parametrize("command", commands())
def test_a_command_that_names_the_examples_runs(command: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    if command == MAKE:
        request.getfixturevalue("made")
        return
    words = [str(ROOT / word) if word.startswith(MADE[:2]) else word for word in shlex.split(command)]
    done = run(words, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
