"""Live against the batch: the same positions, bounds and alerts from the same recordings, and what differs is named."""

from __future__ import annotations

import gzip
import json
from contextlib import closing
from datetime import UTC, datetime, timedelta
from functools import reduce
from operator import xor
from pathlib import Path

import polars as pl
import pytest

import navbound
from navbound import live
from navbound.live.sinks import tables
from navbound.live.source import File
from navbound.run.directory import Run
from navbound.time import gps_ns

RNP_M = 0.3 * 1852.0
COVARIANCE = ("cov_ee_m2", "cov_en_m2", "cov_nn_m2", "cov_eu_m2", "cov_nu_m2", "cov_uu_m2")


def lived(log: Path, out: Path, settings: live.Settings, chunk: int = 1000) -> pl.DataFrame:
    session = live.Session(out, settings)
    with closing(File(log, chunk)) as source:
        session.run(source)
    return tables.epochs(out)


def differing(epochs: pl.DataFrame, batch: pl.DataFrame, pairs: dict[str, str]) -> dict[str, int]:
    """How many values differ in any bit, over epochs that both have."""
    both = epochs.join(batch, on=["track", "time_ns"], suffix="_batch")
    assert both.height > 25
    return {a: both.filter(pl.col(a).ne_missing(pl.col(b if b not in epochs.columns else f"{b}_batch"))).height for a, b in pairs.items()}


@pytest.fixture
def ubx(shared_data: Path, tmp_path: Path) -> Path:
    log = tmp_path / "log.ubx"
    log.write_bytes(gzip.decompress((shared_data / "rxlogs/ubx_16dB/16dBatt_no_interference_coldstart.ubx.gz").read_bytes()))
    return log


def test_a_ubx_log_has_the_bounds_and_alerts_of_the_batch_in_every_bit(ubx: Path, tmp_path: Path) -> None:
    epochs = lived(ubx, tmp_path / "out", live.Settings(format="ubx", rnp_m=RNP_M))
    batch = navbound.analyze([ubx], spec="RNP 0.3").epochs.with_columns(track=pl.lit("receiver"))
    pairs = {
        "accuracy_bound_m": "anp_circle_m",
        "integrity_bound_m": "anp_circle_integrity_m",
        "est_lat_rad": "est_lat_rad",
        "est_lon_rad": "est_lon_rad",
        "est_h_m": "est_h_m",
        "alert": "alert",
        "status": "status",
    }
    assert differing(epochs, batch, pairs) == dict.fromkeys(pairs, 0)
    # Positions that the receiver declares unusable are epochs here and left-out rows there.
    beyond = epochs.join(batch, on="time_ns", how="anti")
    assert batch.join(epochs, on="time_ns", how="anti").height == 0
    assert set(beyond["status"]) == {"not_available"}
    assert set(beyond["alert"]) == {"unavailable"}


def test_an_nmea_log_has_the_positions_and_bounds_of_the_batch_in_every_bit(shared_data: Path, tmp_path: Path) -> None:
    log = shared_data / "rxlogs/gpsd/ublox-zed-f9p-nmea.log"
    epochs = lived(log, tmp_path / "out", live.Settings(format="nmea", rnp_m=RNP_M))
    batch = navbound.analyze([log], spec="RNP 0.3").epochs.with_columns(track=pl.lit("receiver"))
    bounds = {"accuracy_bound_m": "anp_circle_m", "integrity_bound_m": "anp_circle_integrity_m"}
    pairs = bounds | {name: name for name in ("est_lat_rad", "est_lon_rad", "est_h_m", "alert", "status")}
    assert differing(epochs, batch, pairs) == dict.fromkeys(pairs, 0)


@pytest.mark.parametrize(("name", "form"), [("pysbf2/sbfdata.log", "sbf"), ("novatel/oemv_200911218.gps", "novatel")])
def test_septentrio_and_novatel_logs_have_the_positions_and_bounds_of_the_batch(
    shared_data: Path, tmp_path: Path, name: str, form: str
) -> None:
    log = shared_data / "rxlogs" / name
    epochs = lived(log, tmp_path / "out", live.Settings(format=form, rnp_m=RNP_M), chunk=333)
    batch = navbound.analyze([log], spec="RNP 0.3").epochs.with_columns(track=pl.lit("receiver"))
    bounds = {"accuracy_bound_m": "anp_circle_m", "integrity_bound_m": "anp_circle_integrity_m"}
    places = ("est_lat_rad", "est_lon_rad", "est_h_m")
    assert differing(epochs, batch, bounds | dict(zip(places, places, strict=True))) == dict.fromkeys([*bounds, *places], 0)
    assert batch.join(epochs, on="time_ns", how="anti").height == 0


def test_recorded_approaches_have_the_bounds_alerts_and_events_of_the_batch(shared_data: Path, tmp_path: Path) -> None:
    tracks = shared_data / "aircraft/paris_tma_20211007/tracks.csv.gz"
    run = navbound.analyze([tracks], path="LFPG/08R", spec="RNP 0.3", sigma_m=30.0)
    batch = run.epochs.with_columns(pl.col("track").str.replace_all("[ /]", "_"))
    period_s = 1.0
    rows = batch.sort("time_ns", "track")
    log = tmp_path / "paris.jsonl"
    with log.open("w") as file:
        for row in rows.iter_rows(named=True):
            record = {"v": 1} | {name: row[name] for name in ("track", "time_ns", "status", "est_lat_rad", "est_lon_rad", *COVARIANCE)}
            file.write(json.dumps(record) + "\n")
    settings = live.Settings(format="json", rnp_m=RNP_M, path="LFPG/08R", sample_period_s=period_s, time_to_alert_s=1000.0)
    epochs = lived(log, tmp_path / "out", settings)
    assert epochs.height == batch.height > 1000
    pairs = {
        "accuracy_bound_m": "tse_exact_m",
        "integrity_bound_m": "tse_exact_integrity_m",
        "fte_m": "fte_m",
        "sigma_cross_m": "sigma_cross_m",
        "alert": "alert",
    }
    assert differing(epochs, batch, pairs) == dict.fromkeys(pairs, 0)
    reported = tables.transitions(tmp_path / "out")
    raised = reported.filter(pl.col("transition") == "raised")
    events = run.events.with_columns(pl.col("track").str.replace_all("[ /]", "_"))
    expected = set(events.select("track", "kind", "annunciation_ns").rows())
    got = set(raised.select("track", "kind", "annunciation_ns").rows())
    assert expected <= got
    # An approach that is over falls silent: a recording ends there, a live feed does not know that.
    assert {kind for _, kind, _ in got - expected} <= {"unavailable"}


def test_the_shipped_flight_has_the_bounds_and_alerts_of_its_own_run(flown: Run, tmp_path: Path) -> None:
    assert flown.path is not None
    session = live.Session(tmp_path / "out", live.Settings(format="json", rnp_m=RNP_M, method="tse-exact"))
    session.run(live.open_source(str(flown.path)))
    epochs = tables.epochs(tmp_path / "out")
    batch = flown.epochs.with_columns(pl.col("track").str.replace_all("[ /]", "_"))
    assert epochs.height == batch.height > 5000
    pairs = {"accuracy_bound_m": "tse_exact_m", "integrity_bound_m": "tse_exact_integrity_m", "alert": "alert", "status": "status"}
    assert differing(epochs, batch, pairs) == dict.fromkeys(pairs, 0)


def test_a_run_is_skipped_to_the_byte_where_a_session_stopped(flown: Run) -> None:
    whole = live.open_source(str(flown.path), chunk=1 << 30).read(0.0)
    assert whole is not None
    for begin in (0, 1, 777, 512 * 40, len(whole) - 1):
        source = live.open_source(str(flown.path), chunk=512)
        source.skip(begin)
        assert source.read(0.0) == whole[begin : begin + 512], begin


def sentence(body: str) -> str:
    return f"${body}*{reduce(xor, body.encode(), 0):02X}\r\n"


def nmea(start: datetime, seconds: list[str], date_of: list[datetime]) -> str:
    """GGA and ZDA of one epoch after the other; times of day are written as the receiver writes them."""
    del start
    text = ""
    for of_day, day in zip(seconds, date_of, strict=True):
        text += sentence(f"GPZDA,{of_day},{day:%d,%m,%Y},00,00")
        text += sentence(f"GPGGA,{of_day},4900.0000,N,00230.0000,E,1,08,1.0,100.0,M,45.0,M,,")
        text += sentence(f"GPGST,{of_day},1.0,2.0,1.0,0.0,1.0,2.0,3.0")
    return text


@pytest.mark.parametrize(
    ("day", "times", "n_leap"),
    [
        (datetime(2016, 12, 31, tzinfo=UTC), ["235958.00", "235959.00", "235960.00", "000000.00", "000001.00"], 1),
        (datetime(2019, 4, 6, tzinfo=UTC), ["235940.00", "235941.00", "235942.00", "235943.00"], 0),
        (datetime(2021, 10, 7, tzinfo=UTC), ["235958.00", "235959.00", "000000.00", "000001.00"], 0),
    ],
)
def test_midnight_a_leap_second_and_a_rollover_of_the_week_are_successive_seconds(
    tmp_path: Path, day: datetime, times: list[str], n_leap: int
) -> None:
    dates = [day + timedelta(days=int(text.startswith("00"))) for text in times]
    log = tmp_path / "log.nmea"
    log.write_text(nmea(day, times, dates))
    epochs = lived(log, tmp_path / "out", live.Settings(format="nmea", rnp_m=RNP_M, standing=True), chunk=7)
    first = day.replace(hour=int(times[0][:2]), minute=int(times[0][2:4]), second=int(times[0][4:6]))
    assert epochs["time_ns"].to_list() == [gps_ns(first) + k * 1_000_000_000 for k in range(len(times))]
    assert set(epochs["alert"]) == {"normal"}
    assert n_leap == sum("60.00" in text for text in times)


def test_positions_without_a_date_are_counted_and_not_dated_by_the_host(tmp_path: Path) -> None:
    log = tmp_path / "log.nmea"
    log.write_text("".join(sentence(f"GPGGA,1200{k:02d}.00,4900.0,N,00230.0,E,1,08,1.0,100.0,M,45.0,M,,") for k in range(10)))
    session = live.Session(tmp_path / "out", live.Settings(format="nmea", rnp_m=RNP_M))
    with closing(File(log)) as source:
        session.run(source)
    assert (session.n_epochs, session.counters()["refused_undated"]) == (0, 10)
