"""Live: an accuracy that the user states for a receiver that states none."""

from __future__ import annotations

import json
from pathlib import Path

import polars as pl
import pytest
from typer.testing import CliRunner

import navbound
from navbound import _core, live
from navbound.cli.main import app
from navbound.errors import ConflictError, InputError
from navbound.live import journal
from navbound.live.sinks import tables
from test_live_receivers import lived, sentence

SIGMA_M, N = 5.0, 60


def log(tmp_path: Path, stated_m: dict[int, float] | None = None) -> Path:
    """A minute along the meridian at 62 m/s; GST, with the same deviation in every direction, at some seconds."""
    text = ""
    for k in range(N):
        time = f"1200{k:02d}.00"
        text += sentence(f"GPGGA,{time},48{k / 30 + 10:08.5f},N,00230.0000,E,1,08,1.0,100.0,M,45.0,M,,")
        if stated_m is not None and k in stated_m:
            deviation = f"{stated_m[k]:.1f}"
            text += sentence(f"GPGST,{time},1.0,{deviation},{deviation},0.0,{deviation},{deviation},{deviation}")
        text += sentence(f"GPZDA,{time},01,06,2024,00,00")
    (tmp_path / "log.nmea").write_text(text)
    return tmp_path / "log.nmea"


def watched(tmp_path: Path, stated_m: dict[int, float] | None = None, sigma_m: float | None = SIGMA_M) -> pl.DataFrame:
    return lived(log(tmp_path, stated_m), tmp_path / "out", live.Settings(format="nmea", rnp_m=0.3 * 1852.0, sigma_m=sigma_m))


def test_without_it_nothing_is_bounded(tmp_path: Path) -> None:
    assert set(watched(tmp_path, sigma_m=None)["reason_id"]) == {"no_covariance"}


def test_with_it_the_bounds_are_those_of_analyze(tmp_path: Path) -> None:
    epochs = watched(tmp_path)
    batch = navbound.analyze(tmp_path / "log.nmea", spec="RNP 0.3", sigma_m=SIGMA_M).epochs
    both = epochs.join(batch, on="time_ns")
    assert both.height == N
    assert set(both["status"]) == {"ok"}
    assert (both["accuracy_bound_m"] == both["anp_circle_m"]).all()
    assert (both["integrity_bound_m"] == both["anp_circle_integrity_m"]).all()


def test_of_two_accuracies_the_larger_counts(tmp_path: Path) -> None:
    epochs = watched(tmp_path, {k: 1.0 if k < 30 else 50.0 for k in range(N)})
    expected = [SIGMA_M] * 30 + [50.0] * 30
    assert epochs["cov_nn_m2"].sqrt().to_list() == pytest.approx(expected)


def test_a_receiver_that_falls_silent_is_no_better_than_its_last_statement(tmp_path: Path) -> None:
    epochs = watched(tmp_path, {29: 400.0})
    assert epochs["cov_nn_m2"].sqrt().to_list() == pytest.approx([SIGMA_M] * 29 + [400.0] * 31)
    assert set(epochs["alert"][40:]) == {"warning"}


@pytest.mark.parametrize("every", [2, 5])
def test_an_accuracy_that_comes_at_some_epochs_alone_is_not_lost(tmp_path: Path, every: int) -> None:
    """Behind a position that was complete by habit: the first one is counted, and the source has no habit from then on."""
    text = ""
    for k in range(N):
        time = f"1200{k:02d}.00"
        text += sentence(f"GPRMC,{time},A,48{k / 30 + 10:08.5f},N,00230.0000,E,120.0,0.0,010624,,,A")
        text += sentence(f"GPGGA,{time},48{k / 30 + 10:08.5f},N,00230.0000,E,1,08,1.0,100.0,M,45.0,M,,")
        text += sentence(f"GPGST,{time},1.0,900.0,900.0,0.0,900.0,900.0,900.0") if k % every == 1 else ""
    (tmp_path / "log.nmea").write_text(text)
    epochs = lived(tmp_path / "log.nmea", tmp_path / "out", live.Settings(format="nmea", rnp_m=0.3 * 1852.0, sigma_m=SIGMA_M))
    assert epochs["cov_nn_m2"].sqrt().to_list()[every + 1 :] == pytest.approx([900.0] * (N - every - 1))


def test_nothing_stands_in_for_an_accuracy_that_no_position_took(tmp_path: Path) -> None:
    """GST with a time of its own leaves the positions behind it without a bound; one of an ellipse alone is counted."""
    text = ""
    for k in range(N):
        text += sentence(f"GPRMC,1200{k:02d}.00,A,48{k / 30 + 10:08.5f},N,00230.0000,E,120.0,0.0,010624,,,A")
        text += sentence(f"GPGGA,1200{k:02d}.00,48{k / 30 + 10:08.5f},N,00230.0000,E,1,08,1.0,100.0,M,45.0,M,,")
        text += sentence(f"GPGST,1200{k:02d}.20,1.0,900.0,900.0,0.0,900.0,900.0,900.0")
    (tmp_path / "log.nmea").write_text(text)
    settings = live.Settings(format="nmea", rnp_m=0.3 * 1852.0, sigma_m=SIGMA_M)
    assert set(lived(tmp_path / "log.nmea", tmp_path / "out", settings)["reason_id"][3:]) == {"no_covariance"}
    lane = _core.LiveLane(settings.core())
    lane.push(_core.live_input("chunk", None, sentence("GPGST,120000.00,9.0,900.0,900.0,0.0,,,").encode()), 0, 0)
    assert lane.counters()["refused_short_message"] == 1


def test_a_session_that_was_stopped_goes_on_with_what_was_stated(tmp_path: Path) -> None:
    whole = watched(tmp_path, {10: 400.0})
    settings, data = live.Settings(format="nmea", rnp_m=0.3 * 1852.0, sigma_m=SIGMA_M), (tmp_path / "log.nmea").read_bytes()
    lane, frames = _core.LiveLane(settings.core()), [_core.live_input("chunk", None, part) for part in (data[:3000], data[3000:])]
    lane.push(frames[0], 0, 0)
    again, _, _ = _core.LiveLane.restore(settings.core(), lane.snapshot(len(frames[0]), 0))
    _, written, _, n, _ = again.push(frames[1], len(frames[0]), 0)
    assert n > 20
    assert set(_core.live_epochs(written)["cov_nn_m2"]) == {whole["cov_nn_m2"].max()}


def test_it_stands_in_the_record_in_every_output_and_on_the_terminal(tmp_path: Path) -> None:
    result = CliRunner().invoke(
        app, ["live", str(log(tmp_path)), "--format", "nmea", "--sigma-m", "5", "--spec", "RNP 0.3", "--out", str(tmp_path / "out")]
    )
    assert result.exit_code == 0
    words = "assuming a sigma of 5 m in each axis, typed by the user, where the source states no larger accuracy"
    assert result.output.replace("\n", " ").count(words) == 2
    assert json.loads((tmp_path / "out" / journal.SETTINGS).read_text())["settings"]["sigma_m"] == SIGMA_M
    assert set(pl.read_parquet(tmp_path / "out" / "epochs.parquet")["sigma_m"]) == {SIGMA_M}
    assert "navbound_assumed_sigma_metres 5.0" in CliRunner().invoke(app, ["live", "counts", str(tmp_path / "out")]).output


def test_transitions_carry_it(tmp_path: Path) -> None:
    watched(tmp_path, {29: 400.0})
    assert set(tables.transitions(tmp_path / "out")["sigma_m"]) == {SIGMA_M}
    lines = [json.loads(line) for line in (tmp_path / "out" / "events.jsonl").read_text().splitlines()]
    assert {line["sigma_m"] for line in lines} == {SIGMA_M}


@pytest.mark.parametrize("form", ["readsb", "beast", "avr"])
def test_what_aircraft_do_not_claim_is_not_completed(form: str) -> None:
    with pytest.raises(ConflictError, match="sigma_m cannot be used here: aircraft state their own accuracy"):
        live.Settings(format=form, rnp_m=1.0, sigma_m=1.0)


@pytest.mark.parametrize("sigma_m", [0.0, -1.0, float("inf"), float("nan")])
def test_a_deviation_is_a_length(sigma_m: float) -> None:
    with pytest.raises(InputError, match="sigma_m"):
        live.Settings(format="nmea", rnp_m=1.0, sigma_m=sigma_m)
