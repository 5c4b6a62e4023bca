"""Raw measurements, subframes and SBAS messages of receivers' logs against RTKLIB's conversion of the same logs; skipped aloud without."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from typer.testing import CliRunner

import navbound
from navbound import FormatError, InputError, gnss, sbas
from navbound.cli.main import app
from navbound.methods import bounds
from navbound.read import read

EXAMPLES = Path(__file__).parents[1] / "examples" / "data"
NS = 1_000_000_000
WEEK_NS = 604_800 * NS
MM = 0.501e-3
"""Half of the last of three decimals, and what a double of 1e8 leaves."""


@pytest.fixture(scope="module")
def u_blox(shared_data: Path) -> Path:
    return shared_data / "rxlogs" / "ubx_16dB" / "16dBatt_no_interference_coldstart.ubx.gz"


def converted(kind: str, log: Path, folder: Path) -> Path:
    """The log as RTKLIB converts it: an independent reader of the makers' formats."""
    convbin = shutil.which("convbin")
    if convbin is None:
        pytest.skip("SKIPPED ALOUD: convbin (package rtklib) is not installed")
    names = [f"-{option}{value}" for option, value in (("o", "d"), ("o", "s"))]
    files = ["-o", str(folder / "o.obs"), "-n", str(folder / "o.nav"), "-s", str(folder / "o.sbs")]
    subprocess.run([convbin, "-r", kind, *names, "-v", "3.04", *files, str(log)], check=True, capture_output=True)
    return folder


def joined(ours: gnss.Observations, theirs: gnss.Observations, system: str, code: str, their_code: str | None = None) -> pl.DataFrame:
    right = theirs.column(system, their_code or code)
    return ours.column(system, code).join(right, on=["time_ns", "satellite"], how="full", suffix="_theirs")


def largest(table: pl.DataFrame) -> float:
    return float(table.select((pl.col("value") - pl.col("value_theirs")).abs().max()).item())


@pytest.mark.parametrize(
    ("kind", "name", "n_epochs"),
    [("ubx", "rxlogs/gpsd/ublox-zed-f9p_hpg1.11.log", 654), ("sbf", "rxlogs/pysbf2/pygpsdata_x5_measurements.log", 1)],
)
def test_measurements_are_those_of_an_independent_converter(shared_data: Path, tmp_path: Path, kind: str, name: str, n_epochs: int) -> None:
    ours = gnss.read_observations(shared_data / name)
    theirs = gnss.read_observations(converted(kind, shared_data / name, tmp_path) / "o.obs")
    assert (ours.n_epochs, ours.n_refused) == (n_epochs, 0)
    assert ours.time_ns.tolist() == theirs.time_ns.tolist()
    compared = 0
    for system, codes in theirs.codes.items():
        # The converter lists codes in an order of its own.
        assert set(codes) == set(ours.codes[system])
        for code in codes:
            if code[0] == "S" and kind == "sbf":
                continue  # It writes the strengths of SBF a thousand times too small.
            table = joined(ours, theirs, system, code)
            # It drops BeiDou and Galileo satellites that its build does not know, and phases less sure than 0.02 cycles; adds none.
            extra = table.filter(pl.col("value").is_null())
            assert extra.height <= (1 if kind == "sbf" and code[0] == "L" else 0), (system, code)
            # Doppler of a second signal: it rounds the ratio of carriers, 1e-7 of some kHz.
            assert largest(table) <= (0.6e-3 if code[0] == "D" else MM), (system, code)
            compared += table.drop_nulls().height
    assert set(theirs.codes) >= set("GREC")
    assert compared > (50_000 if kind == "ubx" else 200)


def test_strengths_of_septentrio_are_as_another_decoder_of_the_block_reads_them(shared_data: Path) -> None:
    pysbf2 = pytest.importorskip("pysbf2")
    path = shared_data / "rxlogs/pysbf2/pygpsdata_x5_measurements.log"
    with path.open("rb") as stream:
        block: Any = next(parsed for _, parsed in pysbf2.SBFReader(stream) if parsed.identity == "MeasEpoch")
    ours = gnss.read_observations(path).column("G", "S1C")
    # Signal 0 is L1 C/A; the decoder gives a quarter of a dB a unit, without the 10 dB-Hz that the guide adds.
    fields = [[getattr(block, f"{name}_{k:02d}") for name in ("SVID", "SigIdxLo", "CN0")] for k in range(1, block.N1 + 1)]
    plain = {f"G{number:02d}": cn0 + 10.0 for number, signal, cn0 in fields if number <= 37 and signal == 0}
    result = dict(zip(ours["satellite"], ours["value"], strict=True))
    assert len(result) >= 9
    assert result == plain


def test_a_cold_start_has_the_rinex_values_that_came_with_it(u_blox: Path) -> None:
    ours = gnss.read_observations(u_blox)
    theirs = gnss.read_observations(u_blox.with_name(u_blox.name.replace(".ubx", ".obs")))
    # 582 epochs, of which the receiver does not know the time of twenty; the file beside it goes on where the log is cut.
    assert (ours.n_epochs, {r.reason for r in ours.refused}) == (
        562,
        {"not a time: the receiver does not know it yet", "the log ends within a UBX frame"},
    )
    for system, code, other in [("G", "C1C", "C1C"), ("G", "L1C", "L1C"), ("G", "D1C", "D1C"), ("E", "C1C", "C1X"), ("E", "L1C", "L1X")]:
        table = joined(ours, theirs, system, code, other).filter(pl.col("time_ns") <= int(ours.time_ns[-1]))
        assert largest(table) <= MM
        assert table.drop_nulls().height > 5000
        # Fifteen phases that the other converter thought too unsure are the most that differ in presence.
        assert table.height - table.drop_nulls("value").height <= 2


def test_orbits_from_subframes_are_those_of_the_navigation_file(u_blox: Path) -> None:
    ours = gnss.read_navigation(u_blox).records()
    theirs = gnss.read_navigation(u_blox.with_name(u_blox.name.replace(".ubx", ".nav"))).records()
    table = ours.join(theirs, on=["satellite", "message", "orbit_time_ns", "issue"], suffix="_theirs")
    counted = dict(ours.group_by("message").len().iter_rows())
    assert counted == {"INAV": 19, "LNAV": 9}
    # Records of the log that the file lacks were superseded before the file was closed.
    assert table.height >= 20
    numbers = [c for c, kind in ours.schema.items() if kind == pl.Float64 and c != "fit_interval_s"]
    for column in [*numbers, "clock_time_ns", "health"]:
        a, b = table[column].to_numpy(), table[f"{column}_theirs"].to_numpy()
        # Twelve decimals are printed: half a unit of the last of the largest, and pi of ten digits in the file's making.
        assert np.abs(a - b).max() <= 6e-12 * max(np.abs(b).max(), 1e-30), column


def test_positions_solved_from_a_log_agree_with_the_receiver_s_own(u_blox: Path, tmp_path: Path) -> None:
    run = navbound.analyze(u_blox, solve=True, out=tmp_path / "run")
    verdict = run.summary.verdict
    assert (verdict.n_epochs, verdict.n_judged + verdict.n_degraded, verdict.n_unjudged) == (562, 562, 0)
    # Epochs whose residuals contradict the weights show nothing inside, however narrow their bound.
    assert verdict.n_judged == run.epochs.filter(pl.col("status") == "ok").height
    assert (verdict.id == "inside") == (verdict.n_judged >= verdict.least_share * verdict.n_epochs)
    own = read(u_blox).epochs
    table = run.epochs.with_columns(pl.col("time_ns").cast(pl.Int64)).sort("time_ns")
    table = table.join_asof(own.sort("time_ns"), on="time_ns", suffix="_own", strategy="nearest", tolerance=100_000_000)
    table = table.drop_nulls(["est_lat_rad", "est_lat_rad_own"])
    north = (table["est_lat_rad"] - table["est_lat_rad_own"]).to_numpy() * 6.37e6
    east = (table["est_lon_rad"] - table["est_lon_rad_own"]).to_numpy() * 6.387e6 * np.cos(0.82)
    assert table.height > 540
    # Two single-point solutions at low signal strengths; the receiver states 1.7 m (median hAcc) for its own, filtered one.
    assert float(np.median(np.hypot(north, east))) < 5.0


# No message of the ionosphere is read from this log, and its antenna stands still: the median of the receiver's own positions, which
# it states to 1.7 m, stands for the truth.
def test_positions_without_a_message_of_the_ionosphere_are_degraded_and_cover_their_errors(u_blox: Path) -> None:
    positions = gnss.solve(gnss.read_observations(u_blox), gnss.read_navigation(u_blox), signals="auto")
    table = positions.epochs.drop_nulls("est_lat_rad")
    assert table.height > 500
    assert set(table["status"]) == {"degraded"}
    assert "climatology, no message" in positions.models["ionosphere"]
    own = read(u_blox).epochs.select(pl.col("est_lat_rad", "est_lon_rad", "est_h_m").median()).row(0)
    north = (table["est_lat_rad"].to_numpy() - own[0]) * 6.37e6
    east = (table["est_lon_rad"].to_numpy() - own[1]) * 6.387e6 * np.cos(own[0])
    up = table["est_h_m"].to_numpy() - own[2]
    circle = bounds(table, "anp-circle", 0.05).bound_m
    assert float((np.hypot(north, east) <= circle).mean()) >= 0.93
    assert float((np.abs(up) <= 1.96 * np.sqrt(table["cov_uu_m2"].to_numpy())).mean()) >= 0.93


def test_older_messages_carry_sbas_and_gps_dated_to_the_second(shared_data: Path, tmp_path: Path) -> None:
    log = shared_data / "sbas" / "ubx_20080526.ubx"
    messages = sbas.read(log)
    assert (messages.format, len(messages.time_ns), sorted(set(messages.prn.tolist()))) == ("receiver log", 482, [129, 137])
    # A message each second and satellite. GPS subframes, whose end they state themselves, arrive at the same place of the log.
    ends = messages.of(137).time_ns
    assert set(np.diff(ends).tolist()) == {NS}
    assert ends[0] == 1481 * WEEK_NS + 107_965 * NS
    theirs = sbas.read(converted("ubx", log, tmp_path) / "o.sbs")
    # The converter misses the first five epochs and gives the first two messages that it keeps a stale time.
    assert len(_keys(messages) & _keys(theirs)) == len(theirs.time_ns) - 2
    with pytest.raises(FormatError, match="dated by their end"):
        sbas.read(log, tag="start")


def _keys(m: sbas.Messages) -> set[tuple[int, int, bytes]]:
    return {(int(t), int(p), bytes(d)) for t, p, d in zip(m.time_ns, m.prn, m.data, strict=True)}


def test_levels_follow_from_a_log_alone(shared_data: Path, tmp_path: Path) -> None:
    log = shared_data / "sbas" / "ubx_20080526.ubx"
    run = navbound.evaluate(log, levels="APV-I", solve=True, prn=137, out=tmp_path / "run")
    # Four minutes: masks, fast and slow corrections of both kinds are whole for the last seconds alone.
    assert run.summary.n_status["solution"] == 10
    assert run.epochs["hpl_m"].drop_nulls().is_between(5.0, 60.0).all()


def test_a_log_without_orbits_says_what_is_lacking(shared_data: Path, tmp_path: Path) -> None:
    log = shared_data / "rxlogs" / "gpsd" / "ublox-zed-f9p_hpg1.11.log"
    with pytest.raises(InputError, match="holds observations and no orbits: name a RINEX navigation file"):
        navbound.analyze(log, solve=True)
    with pytest.raises(InputError, match="raw measurements"):
        navbound.analyze(shared_data / "rxlogs" / "gpsd" / "ublox-zed-f9p-nmea.log", solve=True)
    with pytest.raises(FormatError, match="without measurements"):
        gnss.read_observations(shared_data / "rxlogs" / "gpsd" / "ublox-x20p.log")
    shown = CliRunner().invoke(app, ["analyze", str(log), "--solve", "--out", str(tmp_path / "run")])
    assert isinstance(shown.exception, InputError)


def test_a_log_of_raw_measurements_alone_says_what_is_lacking(tmp_path: Path) -> None:
    log, orbits = EXAMPLES / "receiver.ubx", EXAMPLES / "receiver-broadcast.rnx"
    # The log has an epoch a second for three minutes, and no subframes.
    with pytest.raises(FormatError, match=r"raw measurements of 180 epochs: with --solve \(and a RINEX navigation file"):
        navbound.analyze(log)
    with pytest.raises(InputError, match="--solve takes the raw measurements"):
        navbound.analyze([log, orbits])
    empty = tmp_path / "empty.ubx"
    # An acknowledgement of a receiver: neither positions nor measurements (class 5, id 1, two bytes; Fletcher sum by hand).
    empty.write_bytes(bytes([0xB5, 0x62, 0x05, 0x01, 0x02, 0x00, 0x06, 0x01, 0x0F, 0x38]))
    with pytest.raises(FormatError) as refused:
        navbound.analyze(empty)
    assert "--solve" not in str(refused.value)


def test_rinex_observations_are_judged_as_a_track(shared_data: Path, tmp_path: Path) -> None:
    folder = shared_data / "gnss" / "ARLM_2015_200"
    run = navbound.analyze([folder / "arlm200x.15o", folder / "arlm2000.15n"], out=tmp_path / "run")
    # Two epochs have an exclusion that the few ranges left cannot confirm.
    assert (run.summary.verdict.n_judged, run.summary.verdict.n_degraded, run.summary.verdict.inside) == (118, 2, True)
    assert {Path(source.path).name for source in run.record.inputs} == {"arlm200x.15o", "arlm2000.15n"}
    with pytest.raises(InputError, match="holds no observations and no positions: name a RINEX observation file"):
        navbound.analyze(folder / "arlm2000.15n")
