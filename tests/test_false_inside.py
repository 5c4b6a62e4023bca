"""Recordings that must not be called inside: what is missing, doubted or contradicted counts against the verdict."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, cast

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import FormatError, InputError, gnss, ins, rnp, status
from navbound.read import read
from navbound.read.source import load
from navbound.rnp import usual
from navbound.run import analyze
from navbound.run.directory import Run
from navbound.run.inputs import solved
from navbound.run.inputs.solving import Solving
from navbound.run.judge import judge
from navbound.run.summary.missing import Gaps

N = 600
START_S = 1_600_000_000.0
RNP_M = 0.3 * 1852.0


def columns(**changed: object) -> dict[str, Any]:
    """70 m/s along the meridian of 2 degrees east, with a stated standard deviation of 5 m."""
    k = np.arange(N)
    flown: dict[str, Any] = {
        "time": START_S + k,
        "lat": 48.0 + 70.0 / 111_200.0 * k,
        "lon": np.full(N, 2.0),
        "sde": np.full(N, 5.0),
        "sdn": np.full(N, 5.0),
    }
    return flown | changed


def run(folder: Path, **changed: object) -> Run:
    table, route = folder / "track.csv", folder / "route.csv"
    pl.DataFrame(columns(**changed)).write_csv(table)
    route.write_text("name,lat_deg,lon_deg\nA,47.9,2.0\nB,49.0,2.0\n")
    return judge(analyze.material(table, requirement="RNP 0.3", rnp_m=RNP_M, path=route))


def test_the_track_itself_is_inside(tmp_path: Path) -> None:
    verdict = run(tmp_path).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_judged) == ("inside", N, N)


@pytest.mark.parametrize("name", ["lat", "time"])
def test_rows_without_a_position_or_a_time_are_expected_and_not_judged(tmp_path: Path, name: str) -> None:
    values = [float(v) if k < 60 else None for k, v in enumerate(columns()[name])]
    verdict = run(tmp_path, **{name: values}).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_judged, verdict.n_missing) == ("not_shown", N, 60, N - 60)


def test_a_row_without_a_position_inside_a_gap_counts_once(tmp_path: Path) -> None:
    lat = [None if 100 <= k < 200 else float(v) for k, v in enumerate(columns()["lat"])]
    verdict = run(tmp_path, lat=lat).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_missing) == ("not_shown", N, 100)


def test_two_positions_at_one_time_contradict_each_other(tmp_path: Path) -> None:
    # Every time twice, 7.5 km apart.
    result = run(tmp_path, time=np.repeat(START_S + np.arange(N // 2), 2), lon=np.where(np.arange(N) % 2, 2.1, 2.0))
    verdict = result.summary.verdict
    assert (verdict.inside, verdict.n_judged, verdict.n_epochs, verdict.n_implausible) == (None, 0, N, N // 2)
    assert result.epochs["status"].unique().to_list() == ["invalid_input"]
    assert result.epochs["reason_id"].unique().to_list() == ["position_jump"]
    words = f"{N // 2} position jumps that cannot be flown ({N // 2} of them another position of the same time"
    assert any(words in each for each in result.summary.assumptions)


def test_identical_repeats_are_left_out_and_do_no_harm(tmp_path: Path) -> None:
    twice = {name: np.repeat(values, 2) for name, values in columns().items()}
    result = run(tmp_path, **twice)
    assert (result.summary.verdict.id, result.summary.verdict.n_epochs) == ("inside", N)
    assert [(r.reason, r.count) for r in result.summary.rejected] == [("time repeated within a track", N)]


@pytest.mark.parametrize(
    ("name", "first", "second"),
    [("sigma_e_m", 1.0, 400.0), ("sigma_e_m", 400.0, 1.0), ("hpl_m", 20.0, 3000.0), ("vpl_m", 20.0, 30.0), ("h_m", 1000.0, 1200.0)],
)
def test_two_bounds_of_one_position_contradict_each_other(tmp_path: Path, name: str, first: float, second: float) -> None:
    """Each time twice at the same place, with a bound that is harmless and one that is not: the order of the rows decides nothing."""
    twice: dict[str, object] = {key: np.repeat(values, 2) for key, values in columns().items()}
    result = run(tmp_path, **twice | {name: np.tile([first, second], N)})
    verdict = result.summary.verdict
    assert (verdict.inside, verdict.n_judged, verdict.n_implausible) == (None, 0, N)
    assert set(result.epochs["reason_id"]) == {"position_jump" if name == "h_m" else "invalid_number"}
    reason = "time repeated within a track with another position, bound or status"
    assert [(r.reason, r.count) for r in result.summary.rejected] == [(reason, N)]


def test_the_same_bound_in_other_digits_is_the_same(tmp_path: Path) -> None:
    twice: dict[str, object] = {key: np.repeat(values, 2) for key, values in columns().items()}
    result = run(tmp_path, **twice | {"sigma_e_m": np.tile([1.0, 1.004], N)})
    assert result.summary.verdict.id == "inside"
    assert [(r.reason, r.count) for r in result.summary.rejected] == [("time repeated within a track", N)]


@pytest.mark.parametrize("order", [("ok", "degraded"), ("degraded", "ok")])
def test_of_two_statuses_the_graver_counts(tmp_path: Path, order: tuple[str, str]) -> None:
    twice: dict[str, object] = {key: np.repeat(values, 2) for key, values in columns().items()}
    result = run(tmp_path, **twice | {"status": list(order) * N})
    assert set(result.epochs["status"]) == {"degraded"}
    assert (result.summary.verdict.id, result.summary.verdict.n_degraded) == ("nothing_judged", N)


def test_a_clock_that_stands_still_is_not_shown_to_be_inside(tmp_path: Path) -> None:
    time = START_S + np.minimum(np.arange(N), 99)
    verdict = run(tmp_path, time=time).summary.verdict
    assert (verdict.id, verdict.n_epochs, verdict.n_judged, verdict.n_missing) == ("not_shown", N, 99, N - 100)


@pytest.mark.parametrize(
    ("written", "becomes", "reason_id"),
    [
        ("degraded", "degraded", "reported"),
        ("not_available", "not_available", "reported"),
        (" Invalid_Input", "invalid_input", "reported"),
        ("bad", "not_available", "reported"),
        ("", "not_available", "reported"),
    ],
)
def test_a_recorded_status_is_not_ignored(tmp_path: Path, written: str, becomes: str, reason_id: str) -> None:
    result = run(tmp_path, status=np.where(np.arange(N) < 60, "ok", written))
    assert result.summary.verdict.id == "not_shown"
    assert result.summary.verdict.n_judged == 60
    later = result.epochs[60:]
    assert set(later["status"]) == {becomes}
    assert set(later["reason_id"]) == {reason_id}


@pytest.mark.parametrize(
    ("written", "becomes"), [("position_stale", "not_available"), ("kept_by_dme", "degraded"), ("no such", "not_available")]
)
def test_a_recorded_reason_outweighs_a_better_status(tmp_path: Path, written: str, becomes: str) -> None:
    result = run(tmp_path, status=["ok"] * N, reason_id=[None if k < 60 else written for k in range(N)])
    assert result.summary.verdict.id == "not_shown"
    assert set(result.epochs[60:]["status"]) == {becomes}
    assert set(result.epochs[60:]["reason_id"]) == {written if written in status.REASONS else "reported"}


def test_the_graver_of_the_recorded_status_and_ours_stands(tmp_path: Path) -> None:
    # Held for a second at 70 m/s: degraded by our rule, not available by the file's.
    lat = np.array(columns()["lat"])
    lat[301] = lat[300]
    declared = ["not_available" if k == 301 else "ok" for k in range(N)]
    result = run(tmp_path, lat=lat, speed_mps=np.full(N, 70.0), status=declared)
    assert result.epochs["status"][301] == "not_available"
    without = run(tmp_path, lat=lat, speed_mps=np.full(N, 70.0))
    assert without.epochs["status"][301] == "degraded"


@pytest.mark.parametrize("name", ["hpl", "hpl_m"])
def test_a_recorded_protection_level_is_compared_with_twice_rnp(tmp_path: Path, name: str) -> None:
    verdict = run(tmp_path, **{name: np.full(N, 3000.0)}).summary.verdict
    assert (verdict.id, verdict.n_outside, verdict.share_contained) == ("outside", N, 0.0)
    small = run(tmp_path, **{name: np.full(N, 100.0)})
    assert small.summary.verdict.id == "inside"
    assert small.epochs["integrity_compared_m"].min() >= 100.0  # type: ignore[operator]


def test_columns_that_nobody_reads_are_named(tmp_path: Path) -> None:
    result = run(tmp_path, wind_mps=np.zeros(N))
    assert any("columns not used: wind_mps" in words for words in result.summary.assumptions)


def test_a_flight_in_hardly_any_time_is_not_shown_to_be_inside(tmp_path: Path) -> None:
    # 42 km in 0.6 s, 70 m each millisecond.
    verdict = run(tmp_path, time=START_S + 1e-3 * np.arange(N)).summary.verdict
    assert verdict.inside is None
    assert verdict.n_implausible > 0.8 * N


RINEX = """     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE
G    1 C1C                                                  SYS / # / OBS TYPES
                                                            END OF HEADER
> 2024 06 24 08 17 60.9900000  0  1
G01  22000000.000
"""


def test_measurements_without_an_epoch_are_refused_by_the_name_of_their_file(tmp_path: Path) -> None:
    file = tmp_path / "no_epoch.obs"
    file.write_text(RINEX)
    assert gnss.read_observations(file).n_epochs == 0
    with pytest.raises(FormatError, match=r"no_epoch\.obs.*no epoch") as refusal:
        # No navigation is needed to see it.
        solved._reading(load(file), cast("gnss.Navigation", None), Solving())
    assert "60.99" in str(refusal.value)


RECORD = {"time_ns": 0, "rnp_m": 100.0, "tse_exact_m": 10.0, "tse_exact_integrity_m": 10.0}


@pytest.mark.parametrize(
    "changed",
    [{"time_ns": 10**30}, {"time_ns": math.inf}, {"tse_exact_m": 10**400}, {"rnp_m": [1.0]}, {"status": ["ok"]}, {"time_ns": None}],
)
def test_the_monitor_refuses_what_is_no_record(changed: dict[str, object]) -> None:
    with pytest.raises(InputError):
        rnp.Monitor().step(RECORD | changed)


@pytest.mark.parametrize("time_ns", [10**30, 1.5, None, "1"])
def test_the_monitor_refuses_a_tick_that_is_no_time(time_ns: object) -> None:
    with pytest.raises(InputError, match="time_ns"):
        rnp.Monitor().tick(time_ns)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "changed",
    [
        {"rnp_m": [1.0]},
        {"tse_exact_m": ["ten"] * 3},
        {"tse_exact_m": [[10.0]] * 3},
        {"time_ns": np.full(3, 2**64 - 1, dtype=np.uint64)},
        {"time_ns": ["a", "b", "c"]},
        {"time_ns": [0.0, math.nan, 2e9]},
    ],
)
def test_the_monitor_refuses_what_is_no_table(changed: dict[str, object]) -> None:
    table: dict[str, object] = {"time_ns": [0, 10**9, 2 * 10**9], "rnp_m": [100.0] * 3} | {
        name: [10.0] * 3 for name in ("tse_exact_m", "tse_exact_integrity_m")
    }
    with pytest.raises(InputError):
        rnp.Monitor().run(table | changed)


@pytest.mark.parametrize(
    ("name", "level_m"), [("hpl_m", 0.0), ("hpl_m", 1e-9), ("hpl_m", -1.0), ("hpl_m", 2.9), ("vpl_m", 0.0), ("vpl_m", 4.9)]
)
def test_a_level_below_the_deviation_of_its_own_fix_is_none(name: str, level_m: float) -> None:
    levels = {"hpl_m": np.full(3, 30.0), "vpl_m": np.full(3, 50.0)}
    levels[name][1] = level_m
    fixes = ins.Fixes(
        time_ns=np.arange(3), position=np.zeros((3, 3)), covariance_enu_m2=np.tile(np.diag([4.0, 9.0, 25.0]), (3, 1, 1)), **levels
    )
    with pytest.raises(InputError, match=rf"{name}.*index 1|{name}\[1\]"):
        fixes.table()


# What follows needs neither status nor truth to be wrong: a receiver that repeats itself, and columns that speak against the position.


@pytest.mark.parametrize("frozen_from", [0, 100])
def test_a_receiver_that_repeats_its_last_fix_is_stale(tmp_path: Path, frozen_from: int) -> None:
    k = np.minimum(np.arange(2 * N), frozen_from)
    table = {"time": START_S + np.arange(2 * N), "lat": 48.0 + 70.0 / 111_200.0 * k, "lon": 2.0, "sde": 5.0, "sdn": 5.0}
    file = tmp_path / "frozen.csv"
    pl.DataFrame(table).write_csv(file)
    result = judge(analyze.material(file, requirement="RNP 0.3", rnp_m=RNP_M))
    # Stale after 2 s: two repeats are not yet.
    first = frozen_from + 3
    assert result.summary.verdict.id == "not_shown"
    assert result.summary.verdict.n_judged == first
    assert set(result.epochs[first:]["reason_id"]) == {"position_stale"}
    assert f"{2 * N - first} epochs with a position held for more than 2 s" in " ".join(result.summary.assumptions)


def test_a_receiver_at_a_fixed_truth_may_repeat_its_position(tmp_path: Path) -> None:
    # 48 degrees north, 2 degrees east, 100 m.
    place = "4273180.024,149222.735,4716950.645"
    file = tmp_path / "standing.csv"
    pl.DataFrame({"time": START_S + np.arange(N), "lat": [48.0] * N, "lon": 2.0, "h_m": 100.0, "sde": 5.0, "sdn": 5.0}).write_csv(file)
    material = analyze.material(file, requirement="RNP 0.3", rnp_m=RNP_M, truth=place)
    assert material.epochs["reason_id"].null_count() == N


VELOCITY = [
    ("vel_n_mps", "vel_e_mps", 1.0),
    ("vn_mps", "ve_mps", 1.0),
    ("velocity_north", "velocity_east", 1.0),
    ("vel_n_m_s", "vel_e_m_s", 1.0),
    ("vn (kt)", "ve (kt)", 1852.0 / 3600.0),
]


@pytest.mark.parametrize(("north", "east", "unit_mps"), VELOCITY)
def test_velocities_are_the_speed_of_a_track_that_has_no_other(tmp_path: Path, north: str, east: str, unit_mps: float) -> None:
    # A stop of five minutes in which the velocities are those of flight: held, as by a speed over the ground.
    k = np.arange(N)
    lat = 48.0 + 70.0 / 111_200.0 * np.where(k < 300, k, 300)
    velocity = {north: np.full(N, 56.0 / unit_mps), east: np.full(N, -42.0 / unit_mps)}
    result = run(tmp_path, lat=lat, **velocity)
    assert np.allclose(result.epochs["ground_speed_mps"].to_numpy(), 70.0)
    assert result.epochs["reason_id"][301] == "position_held"
    assert result.epochs["reason_id"][303] == "position_stale"


def test_one_wild_speed_lets_no_step_pass(tmp_path: Path) -> None:
    # 2 km aside within a second, at the epoch that reports 200 m/s.
    k = np.arange(N)
    lon = 2.0 + np.where(k < 300, 0.0, 2000.0 / 74_500.0)
    speed = np.full(N, 70.0)
    route = "name,lat_deg,lon_deg\nA,47.9,2.0\nB,49.0,2.0\n"
    (tmp_path / "route.csv").write_text(route)
    for wild in (70.0, 200.0):
        speed[300] = wild
        result = run(tmp_path, lon=lon, speed_mps=speed)
        assert result.epochs["reason_id"][300] == "position_jump"
        assert ("1 reported speed is beyond" in " ".join(result.summary.assumptions)) == (wild == 200.0)


@pytest.mark.parametrize("name", ["nse_e_m", "east_error_m", "nse_h_m", "hpe", "tse_m", "tse", "fte_m", "fte"])
def test_an_error_that_the_table_states_itself_is_weighed(tmp_path: Path, name: str) -> None:
    """5 km at one epoch: beyond RNP, whatever the covariance says."""
    stated = np.where(np.arange(N) == 7, 5000.0, 10.0)
    result = run(tmp_path, **{name: stated})
    verdict = result.summary.verdict
    assert (verdict.id, verdict.inside, verdict.n_stated_beyond) == ("not_shown", None, 1)
    assert "The recording itself states an error beyond RNP at 1 epoch." in verdict.words
    assert result.epochs["stated_error_m"].max() == 5000.0
    assert run(tmp_path, **{name: np.full(N, 10.0)}).summary.verdict.id == "inside"


@pytest.mark.parametrize(
    ("written", "is_alert"), [("warning", True), ("Caution", True), ("1", True), ("normal", False), ("0", False), ("", False)]
)
def test_an_alert_that_the_table_states_itself_is_weighed(tmp_path: Path, written: str, is_alert: bool) -> None:
    verdict = run(tmp_path, alert=np.where(np.arange(N) < 3, written, "normal")).summary.verdict
    assert (verdict.id, verdict.n_stated_alert) == (("not_shown", 3) if is_alert else ("inside", 0))
    assert ("states an alert at 3 epochs" in verdict.words) == is_alert


def test_the_alert_of_a_transponder_is_no_alert_of_navigation(tmp_path: Path) -> None:
    verdict = run(tmp_path, alert=["true"] * N, spi=["false"] * N).summary.verdict
    assert (verdict.id, verdict.n_stated_alert) == ("inside", 0)


@pytest.mark.parametrize("empty", [math.nan, None])
def test_a_column_of_levels_that_holds_none_is_no_level(tmp_path: Path, empty: float | None) -> None:
    verdict = run(tmp_path, hpl_m=[empty] * N).summary.verdict
    assert (verdict.id, verdict.n_without_level) == ("not_shown", N)
    assert "A column of horizontal protection levels holds none" in verdict.words


def test_epochs_that_are_an_hour_apart_say_so(tmp_path: Path) -> None:
    hours = np.datetime_as_string(np.datetime64("2024-06-24T00:00:00") + np.arange(N) * np.timedelta64(1, "h"))
    verdict = run(tmp_path, time=hours).summary.verdict
    assert (verdict.n_long_steps, verdict.longest_step_s) == (N - 1, 3600.0)
    assert f"{N - 1} steps are longer than a position takes to become stale, the longest 3600 s." in verdict.words
    beside = run(tmp_path).summary.verdict
    assert (beside.n_long_steps, beside.longest_step_s) == (0, 1.0)
    assert "Between epochs" not in beside.words


def with_truth(**changed: object) -> dict[str, object]:
    """The track with a truth 1 to 1.3 m to the east."""
    flown = columns()
    east_m = 1.15 + 0.15 * np.sin(np.linspace(0.0, 3.0, N))
    return {"truth_lat_deg": flown["lat"], "truth_lon_deg": flown["lon"] + east_m / 74_500.0} | changed


def test_truth_at_few_epochs_supports_these_alone(tmp_path: Path) -> None:
    for n, state in ((N, "few"), (570, "few"), (569, "partial"), (96, "partial")):
        known: dict[str, object] = {
            key: [float(v) if k < n else None for k, v in enumerate(cast("Any", values))] for key, values in with_truth().items()
        }
        verdict = run(tmp_path, **known).summary.verdict
        assert verdict.belief is not None
        assert (verdict.id, verdict.n_truth, verdict.belief.state) == ("inside", n, state)
    assert (
        "Truth is known at 96 of 600 checked epochs (16.0 %), and the bounds of the others could not be checked, which are too many"
        in verdict.words
    )


def test_a_truth_that_jumps_is_none(tmp_path: Path) -> None:
    """50 km aside for a second: the two steps, and what has not settled after them."""
    truth = with_truth()
    lon = np.array(truth["truth_lon_deg"])
    lon[300] += 0.7
    result = run(tmp_path, **truth | {"truth_lon_deg": lon})
    # 30 s after the jump back, which comes a second after the jump.
    assert result.summary.verdict.n_truth == N - 32
    assert result.epochs["nse_h_m"][300:332].null_count() == 32
    assert "Truth is not believable at 32 epochs" in " ".join(result.summary.assumptions)
    assert result.epochs["nse_h_m"].max() < 2.0  # type: ignore[operator]


def test_a_track_of_letters_is_who_flies(tmp_path: Path) -> None:
    """`track` is the direction in degrees where it holds numbers, and the flight's name where it holds words."""
    named = run(tmp_path, track=["DLH4AB"] * N)
    assert set(named.epochs["track"]) == {"DLH4AB"}
    assert not named.summary.rejected
    directed = run(tmp_path, track=np.zeros(N))
    assert set(directed.epochs["track"]) == {"track"}
    # One word among numbers is a bad number, not a name.
    mixed = run(tmp_path, track=["0.0"] * (N - 1) + ["north"])
    assert [(r.reason, r.count) for r in mixed.summary.rejected] == [("track: not a number; row used without it", 1)]


def sentence(body: str) -> str:
    return f"${body}*{_xor(body):02X}"


def _xor(body: str) -> int:
    value = 0
    for byte in body.encode():
        value ^= byte
    return value


def nmea() -> list[str]:
    """A minute along the meridian: GGA and RMC of each second."""
    lines = []
    for k in range(60):
        place = f"48{0.04 * k:07.4f},N,00200.0000,E"
        lines += [
            sentence(f"GPRMC,1200{k:02d}.00,A,{place},136.1,0.0,240624,,,A"),
            sentence(f"GPGGA,1200{k:02d}.00,{place},1,08,1.0,100.0,M,47.0,M,,"),
        ]
    return lines


def test_the_sentences_of_a_telephone_are_a_log(tmp_path: Path) -> None:
    plain, logged = tmp_path / "plain.nmea", tmp_path / "logged.nmea"
    plain.write_text("".join(f"{line}\r\n" for line in nmea()))
    logged.write_text("".join(f"NMEA,{line},{1_719_230_400_000 + k}\n" for k, line in enumerate(nmea())))
    assert load(logged).kind == "nmea"
    readings = [read(file) for file in (plain, logged)]
    assert [r.epochs.height for r in readings] == [60, 60]
    assert readings[1].epochs.drop("track").equals(readings[0].epochs.drop("track"))
    assert not readings[1].rejected


@pytest.mark.parametrize("instead", ["+", "", " "])
def test_a_sentence_that_lost_the_mark_of_its_checksum_is_counted(tmp_path: Path, instead: str) -> None:
    lines = nmea()
    lines[41] = lines[41].replace("*", instead)
    file = tmp_path / "damaged.nmea"
    file.write_text("".join(f"{line}\r\n" for line in lines))
    reading = read(file)
    assert reading.epochs.height == 59
    assert [(r.reason, r.count) for r in reading.rejected] == [("damaged message", 1)]


@pytest.mark.parametrize("apart_ms", [2, 6, 9])
def test_a_truth_that_is_in_two_places_at_nearly_one_time_is_none(tmp_path: Path, apart_ms: int) -> None:
    """A recording of truth alternates between the estimate and a place 3 km away, some milliseconds later."""
    rows, truth = [HEAD_OF_TWO], ["time,lat,lon,h_m"]
    for k in range(300):
        lat = 49 + k * 7e-4
        rows.append(f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}.000Z,{lat:.7f},2.5,100.0,64.0,0.0,64.0")
        truth.append(f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}.001Z,{lat:.7f},2.5,100.0")
        truth.append(f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}.{1 + apart_ms:03d}Z,{lat + 0.03:.7f},2.5,100.0")
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "t.csv").write_text("\n".join(truth) + "\n")
    verdict = navbound.analyze(tmp_path / "a.csv", truth=tmp_path / "t.csv").summary.verdict
    assert (verdict.n_truth, verdict.id) == (0, "not_shown")


HEAD_OF_TWO = "time,lat,lon,h_m,cov_ee_m2,cov_en_m2,cov_nn_m2"


@pytest.mark.parametrize(
    ("eu", "nu", "expected"),
    [("60.0", "60.0", "inside"), ("70.0", "0.0", "nothing_judged"), ("60.0", "-60.0", "nothing_judged"), ("", "", "inside")],
)
def test_a_vertical_that_cannot_belong_to_the_horizontal_makes_no_covariance(tmp_path: Path, eu: str, nu: str, expected: str) -> None:
    """Variances of 64 m2 and a horizontal correlation of 0.9: the vertical cannot be with east and against north."""
    rows = ["time,lat,lon,h_m,cov_ee_m2,cov_en_m2,cov_nn_m2,cov_eu_m2,cov_nu_m2,cov_uu_m2"]
    rows += [f"2026-11-22T12:00:{k:02d}Z,{49 + k * 7e-4:.7f},2.5,100.0,64.0,57.6,64.0,{eu},{nu},64.0" for k in range(40)]
    path = tmp_path / "a.csv"
    path.write_text("\n".join(rows) + "\n")
    assert navbound.analyze(path).summary.verdict.id == expected


@pytest.mark.parametrize(
    ("columns", "how", "expected"),
    [
        (("lat", "lon"), {}, "not_shown"),
        (("lat_deg", "lon_deg"), {}, "inside"),
        (("lat", "lon"), {"est_lat_rad": "lat:deg", "est_lon_rad": "lon:deg"}, "inside"),
    ],
)
def test_positions_that_may_be_radians_show_nothing_until_the_unit_is_stated(
    tmp_path: Path, columns: tuple[str, str], how: dict[str, str], expected: str
) -> None:
    """In radians the flight is at 49 N; read as degrees it creeps near 0 N 0 E, and so does a truth in radians."""
    head = ",".join(("time", *columns, "h_m", "cov_ee_m2", "cov_en_m2", "cov_nn_m2"))
    for name, shift, m2 in (("a", 0.0, 64.0), ("t", 1e-7, 1e-4)):
        rows = [f"2026-11-22T12:00:{k:02d}Z,{0.855 + k * 1.2e-5 + shift:.9f},0.04,100.0,{m2},0.0,{m2}" for k in range(60)]
        (tmp_path / f"{name}.csv").write_text("\n".join([head, *rows]) + "\n")
    verdict = navbound.analyze(tmp_path / "a.csv", truth=tmp_path / "t.csv", columns=how or None).summary.verdict
    assert verdict.id == expected
    assert bool(verdict.position_doubts) == (expected == "not_shown")
    assert ("nothing is shown until the unit is stated" in verdict.words) == (expected == "not_shown")


def test_the_rest_of_a_truth_that_contradicts_itself_shows_nothing(tmp_path: Path) -> None:
    """One row in four is true, 3 km from a false one that agrees with the estimate: an epoch or two keep a truth."""
    rows, truth = [HEAD_OF_TWO], ["time,lat,lon,h_m"]
    for k in range(300):
        lat, stamp = 49 + k * 7e-4, f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}"
        rows.append(f"{stamp}.000Z,{lat:.7f},2.5,100.0,64.0,0.0,64.0")
        truth.append(f"{stamp}.001Z,{lat:.7f},2.5,100.0")
        if k % 3 == 0:
            truth.append(f"{stamp}.500Z,{lat + 0.03:.7f},2.5,100.0")
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "t.csv").write_text("\n".join(truth) + "\n")
    verdict = navbound.analyze(tmp_path / "a.csv", truth=tmp_path / "t.csv").summary.verdict
    assert verdict.n_truth < 10
    assert verdict.id == "not_shown"


@pytest.mark.parametrize(("every", "named"), [(3, True), (200, False)])
def test_epochs_that_are_absent_in_short_gaps_are_named(tmp_path: Path, every: int, named: bool) -> None:
    kept = np.arange(N) % every != 1
    verdict = run(tmp_path, **{name: values[kept] for name, values in columns().items()}).summary.verdict
    assert (verdict.n_absent, verdict.n_epochs) == (N - kept.sum(), kept.sum())
    words = f"{verdict.n_absent} epochs that the usual step leaves room for are absent, in gaps too short to count"
    assert (words in verdict.words, words in verdict.lead[0]) == (named, named)


@pytest.mark.parametrize(("steps_ms", "n_absent"), [((400, 500, 600), 0), ((400, 800, 400), 1), ((2, 3, 2), 0), ((1, 2, 2), 0)])
def test_steps_that_wander_leave_no_room_for_epochs(steps_ms: tuple[int, int, int], n_absent: int) -> None:
    gaps = Gaps(pl.DataFrame(schema={"track": pl.String, "time_ns": pl.Int64}), 0.5)
    times = np.cumsum(np.tile(steps_ms, 200)) * 1_000_000
    gaps.see(pl.DataFrame({"track": ["a"] * times.size, "time_ns": times}))
    # A step ends at each time but the first.
    assert gaps.n_absent() == 200 * n_absent


def test_heights_that_no_vertical_bound_judges_are_named(tmp_path: Path) -> None:
    heights = with_truth(h_m=np.full(N, 1000.0), truth_h_m=np.full(N, 1000.0) + np.where(np.arange(N) < 100, 6000.0, 1.0))
    verdict = run(tmp_path, **heights).summary.verdict
    assert verdict.largest_height_error_m == pytest.approx(6000.0, abs=1e-3)
    assert "Heights differ from the truth by up to 6000 m; no vertical bound judges them." in verdict.words
    beside = run(tmp_path, **with_truth()).summary.verdict
    assert beside.largest_height_error_m is None
    assert "no vertical bound" not in beside.words


@pytest.mark.parametrize(
    ("steps_ms", "period_s"),
    [
        # A receiver of 1 Hz that lost nearly half of its positions: the median is the step across a lost one.
        ((1000, 2000, 2000, 1000, 3000), 1.0),
        ((1000, 1000, 1000, 4000), 1.0),
        # Transponders, a source that speaks now and then, and one in bursts have no step that others are whole numbers of.
        ((400, 500, 600), 0.5),
        ((1000, 10_000, 10_000, 10_000, 10_000), 10.0),
        ((100, 1000, 1000), 1.0),
        ((1000,), 1.0),
        ((), 1.0),
    ],
)
def test_the_period_is_the_usual_step(steps_ms: tuple[int, ...], period_s: float) -> None:
    assert usual.period_s(np.tile(np.array(steps_ms, dtype=np.int64), 20) * 1_000_000) == period_s


def test_gaps_of_a_receiver_that_lost_half_of_its_positions_are_missing_epochs(tmp_path: Path) -> None:
    """Steps of 1, 2, 2 and 4 s: the monitor of a receiver of 1 Hz has nothing for 4 s."""
    kept = np.isin(np.arange(N) % 9, (0, 1, 3, 5))
    verdict = run(tmp_path, **{name: values[kept] for name, values in columns().items()}).summary.verdict
    assert verdict.id == "not_shown"
    assert verdict.n_missing == pytest.approx(3 * N / 9, abs=3)
