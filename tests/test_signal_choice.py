"""Which signals and messages make a range, and why a satellite is not used: the same in positions and in the monitors."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import rinex_fixture
from navbound import araim, gnss, raim

DAY = "ESBC00DNK_R_20201770000_01D"
QUANTUM_M = 299792458.0 * 2.0**-32
"""Resolution of Galileo's broadcast group delays (OS SIS ICD 5.1.5)."""


@pytest.fixture(scope="module")
def folder(shared_data: Path) -> Path:
    return shared_data / "gnss" / "ESBC_2020_177"


@pytest.fixture(scope="module")
def truth(shared_data: Path) -> list[float]:
    return list(json.loads((shared_data / "baselines.json").read_text(encoding="utf-8"))["ESBC_2020_177"]["reference_ecef_m"])


@pytest.fixture(scope="module")
def observations(folder: Path) -> gnss.Observations:
    return gnss.read_observations(folder / f"{DAY}_30S_MO.crx.gz")


def records(folder: Path) -> tuple[list[str], list[list[str]]]:
    """Header lines, and the lines of each record."""
    lines = gzip.decompress((folder / f"{DAY}_MN.rnx.gz").read_bytes()).decode().splitlines(keepends=True)
    end = next(k for k, line in enumerate(lines) if "END OF HEADER" in line) + 1
    blocks: list[list[str]] = []
    for line in lines[end:]:
        if line[0] != " ":
            blocks.append([])
        blocks[-1].append(line)
    return lines[:end], blocks


def data_sources(block: list[str]) -> int:
    return int(float(block[5][23:42].replace("D", "e")))


def stripped(folder: Path, place: Path, keep: set[int]) -> gnss.Navigation:
    """The day's messages with the Galileo records of these data sources alone."""
    head, blocks = records(folder)
    kept = [block for block in blocks if block[0][0] != "E" or data_sources(block) in keep]
    assert 0 < len(kept) < len(blocks)
    path = place / "stripped.rnx"
    path.write_text("".join(head) + "".join(line for block in kept for line in block), encoding="utf-8")
    return gnss.read_navigation(path)


@pytest.fixture(scope="module")
def inav(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> gnss.Navigation:
    return stripped(folder, tmp_path_factory.mktemp("inav"), {517})


@pytest.fixture(scope="module")
def fnav(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> gnss.Navigation:
    return stripped(folder, tmp_path_factory.mktemp("fnav"), {258})


PAIRS = {"G": ["C1C", "C1W", "C2W", "L1C", "L2W"], "E": ["C1C", "C5Q", "C7Q", "L1C", "L5Q", "L7Q"]}


def without(observations: gnss.Observations, place: Path, *codes: str) -> gnss.Observations:
    """The day's first six hours as a receiver without some codes of Galileo would have written them."""
    kept = {"G": PAIRS["G"], "E": [c for c in PAIRS["E"] if c not in codes]}
    return rinex_fixture.write(observations, place / "observed.rnx", kept, until_s=6 * 3600.0)


@pytest.fixture(scope="module")
def without_e5b(observations: gnss.Observations, tmp_path_factory: pytest.TempPathFactory) -> gnss.Observations:
    return without(observations, tmp_path_factory.mktemp("observed"), "C7Q", "L7Q")


def kinds(used: pl.DataFrame, system: str = "E") -> set[tuple[str, str]]:
    return set(used.filter(pl.col("sv").str.starts_with(system)).select("signals", "message").iter_rows())


def test_inav_alone_is_used_with_the_signals_of_its_clock(observations: gnss.Observations, inav: gnss.Navigation) -> None:
    positions = gnss.solve(observations, inav, systems="GE", signals="dual")
    assert positions.used is not None
    assert kinds(positions.used) == {("E1-E5b", "INAV")}
    assert kinds(positions.used, "G") == {("L1-L2", "LNAV")}
    monitors = araim.watch(observations, inav), raim.watch(observations, inav, systems="GE", signals="dual")
    for watched in monitors:
        assert watched.used.equals(positions.used)
        assert watched.epochs["n_sv"].to_numpy().mean() > 15


def test_inav_alone_serves_e5a_where_e5b_is_not_observed(without_e5b: gnss.Observations, inav: gnss.Navigation) -> None:
    watched = araim.watch(without_e5b, inav)
    assert kinds(watched.used) == {("E1-E5a", "INAV")}
    assert "no_message" not in watched.unused
    assert "record_too_old" not in watched.unused


def test_positions_of_e5a_by_inav_are_those_by_fnav(
    without_e5b: gnss.Observations, inav: gnss.Navigation, fnav: gnss.Navigation, truth: list[float]
) -> None:
    """The same clock but for the quantisation of two group delays and of the two messages' own polynomials."""
    both = [gnss.solve(without_e5b, n, systems="E", signals="dual", most_excluded=0, truth_ecef_m=truth) for n in (inav, fnav)]
    by_inav, by_fnav = both
    assert by_inav.used is not None
    assert by_fnav.used is not None
    assert kinds(by_inav.used) == {("E1-E5a", "INAV")}
    assert kinds(by_fnav.used) == {("E1-E5a", "FNAV")}
    axes = ["nse_e_m", "nse_n_m", "nse_u_m"]
    joined = by_inav.epochs.join(by_fnav.epochs, on="time_ns", suffix="_f").filter(
        (pl.col("n_sv") == pl.col("n_sv_f")) & (pl.col("n_sv") >= 6) & (pl.col("vdop") < 3)
    )
    assert joined.height > 400
    difference = np.stack([(joined[a] - joined[f"{a}_f"]).to_numpy() for a in axes])
    # Each range differs by at most a quantum of each delay; a dilution below 3 times the root of the satellites is the worst case.
    assert np.abs(difference).max() < 3 * np.sqrt(12) * 2 * QUANTUM_M
    assert np.sqrt((difference**2).mean()) < 2 * QUANTUM_M
    # Without the group delays it would be another clock: their difference is up to a metre and a half.
    table = inav.records().filter(pl.col("satellite").str.starts_with("E"))
    bias_m = 299792458.0 * np.abs((table["group_delay_first_s"] - table["group_delay_second_s"]).to_numpy())
    assert bias_m.max() > 10 * QUANTUM_M


def test_fnav_alone_does_not_serve_e5b(observations: gnss.Observations, fnav: gnss.Navigation, tmp_path: Path) -> None:
    positions = gnss.solve(without(observations, tmp_path, "C5Q"), fnav, systems="GE", signals="dual")
    assert positions.used is not None
    assert kinds(positions.used) == set()
    assert positions.unused["no_message"] > 4000
    assert "record_too_old" not in positions.unused
    assert "without a clock for these signals" in gnss.UNUSED["no_message"]


def test_every_satellite_that_is_not_used_has_its_own_reason(folder: Path, observations: gnss.Observations, tmp_path: Path) -> None:
    head, blocks = records(folder)

    def changed(block: list[str]) -> list[str]:
        if block[0].startswith("E08"):
            return []
        if block[0].startswith("E03") and data_sources(block) == 517:
            # Unhealthy on E5b, which is of this file's pair.
            return [*block[:6], block[6][:23] + f"{0b111000000:19.12E}" + block[6][42:], *block[7:]]
        if block[0].startswith("E07") and block[0][4:17] > "2020 06 25 03":
            return []
        return block

    path = tmp_path / "changed.rnx"
    path.write_text("".join(head) + "".join(line for block in blocks for line in changed(block)), encoding="utf-8")
    positions = gnss.solve(observations, gnss.read_navigation(path), systems="GE", signals="dual")
    whole = gnss.solve(observations, gnss.read_navigation(folder / f"{DAY}_MN.rnx.gz"), systems="GE", signals="dual")
    assert positions.used is not None
    assert whole.used is not None
    count = {sv: n for sv, _, _, n in whole.used.iter_rows()}
    assert "no_record" not in whole.unused
    assert positions.unused["no_record"] == count["E08"]
    assert positions.unused["unhealthy"] - whole.unused.get("unhealthy", 0) == count["E03"]
    left = {sv: n for sv, _, _, n in positions.used.iter_rows()}
    assert positions.unused["record_too_old"] - whole.unused.get("record_too_old", 0) == count["E07"] - left.get("E07", 0)
    assert positions.unused["below_mask"] > 0
    assert set(positions.unused) <= set(gnss.UNUSED)


def test_a_constellation_without_second_frequency_is_counted(
    observations: gnss.Observations, inav: gnss.Navigation, tmp_path: Path
) -> None:
    positions = gnss.solve(without(observations, tmp_path, "C5Q", "C7Q"), inav, systems="GE", signals="dual")
    assert positions.used is not None
    assert kinds(positions.used) == set()
    assert positions.unused["no_second_range"] > 4000


def test_a_log_of_one_frequency_leaves_no_satellite_uncounted(shared_data: Path) -> None:
    log = shared_data / "rxlogs" / "ubx_16dB" / "16dBatt_no_interference_coldstart.ubx.gz"
    observations, navigation = gnss.read_observations(log), gnss.read_navigation(log)
    records = navigation.records().filter(pl.col("satellite").str.starts_with("E"))
    assert set(records["message"]) == {"INAV"}
    observed = sum(observations.column(system, "C1C").height for system in "GE")
    lost = gnss.solve(observations, navigation, systems="GE", signals="dual")
    assert lost.unused == {"no_second_range": observed}
    one = gnss.solve(observations, navigation, systems="GE", ionosphere="none")
    assert one.used is not None
    assert (
        one.used["n_ranges"].sum() + sum(n for why, n in one.unused.items() if why not in {"below_mask", "constellation_left_out"})
        == observed
    )


def test_records_of_version_4_are_of_the_message_that_heads_them(shared_data: Path) -> None:
    path = shared_data / "gnss" / "rinex4_2023_071" / "BRD400DLR_S_20230710000_01D_MN.rnx.gz"
    heads = [line.split()[2:4] for line in gzip.decompress(path.read_bytes()).decode().splitlines() if line.startswith("> EPH E")]
    named = {(sv, message) for sv, message in heads}
    table = gnss.read_navigation(path).records().filter(pl.col("satellite").str.starts_with("E"))
    assert set(table.select("satellite", "message").iter_rows()) == named
    assert {message for _, message in named} == {"INAV", "FNAV"}


def test_the_precise_code_of_the_clock_is_taken_for_pairs(observations: gnss.Observations, folder: Path) -> None:
    navigation = gnss.read_navigation(folder / f"{DAY}_MN.rnx.gz")
    assert gnss.solve(observations, navigation, systems="G", signals="dual").codes["G"][0] == "C1W"
    assert gnss.solve(observations, navigation, systems="G", signals="single").codes["G"][0] == "C1C"


@pytest.mark.parametrize(
    ("sources", "message"),
    # RINEX 3.05, table A8: bit 8 clock of E5a and E1, bit 9 of E5b and E1; bits 0 to 2 where the record was received.
    [
        (517, "INAV"),
        (513, "INAV"),
        (516, "INAV"),
        (258, "FNAV"),
        (519, "INAV"),
        (263, "FNAV"),
        (5, "INAV"),
        (2, "FNAV"),
        (0, None),
        (7, None),
    ],
)
def test_galileo_records_are_of_the_message_whose_clock_they_have(folder: Path, tmp_path: Path, sources: int, message: str | None) -> None:
    head, blocks = records(folder)
    block = next(b for b in blocks if b[0][0] == "E")
    line = block[5][:23] + f"{sources:19.12E}" + block[5][42:]
    path = tmp_path / "one.rnx"
    path.write_text("".join(head) + "".join([*block[:5], line, *block[6:]]), encoding="utf-8")
    navigation = gnss.read_navigation(path)
    table = navigation.records()
    assert table["message"].to_list() == ([message] if message else [])
    assert [r.field for r in navigation.refused] == ([] if message else ["data sources"])


def test_tabulated_clocks_need_no_fnav(observations: gnss.Observations, folder: Path, inav: gnss.Navigation) -> None:
    """The group delays against the clock of E1 and E5a are those of I/NAV as well."""
    whole = gnss.read_navigation(folder / f"{DAY}_MN.rnx.gz")
    orbits = gnss.read_orbits([*folder.glob("*SP3.gz"), *folder.glob("*CLK.gz")])
    one, other = (gnss.solve(observations, n, systems="E", signals="dual", orbits=orbits) for n in (inav, whole))
    assert one.used is not None
    assert kinds(one.used) <= {("E1-E5b", "INAV"), ("E1-E5a", "INAV")}
    assert one.used["n_ranges"].sum() > 20000
    assert one.epochs["est_lat_rad"].null_count() == other.epochs["est_lat_rad"].null_count()
