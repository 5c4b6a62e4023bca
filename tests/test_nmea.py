"""Sentences of NMEA 0183 of which a file and a stream make the same: the datum, RMC alone, what a receiver says against its position."""

from __future__ import annotations

from functools import reduce
from operator import xor
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import navbound
from navbound import live
from navbound.errors import FormatError
from test_live_receivers import lived

if TYPE_CHECKING:
    from collections.abc import Callable

    import polars as pl

    from conftest import Ended
    from navbound.run.directory import Run

RNP_M, N = 0.3 * 1852.0, 60


def sentence(body: str) -> str:
    return f"${body}*{reduce(xor, body.encode()):02X}\r\n"


def second(k: int, sentences: str = "RMC GGA GST", *, quality: int = 1, n_sv: int = 8, status: str = "A", mode: str = "A") -> str:
    """Sentences of one second of a way along the meridian at 62 m/s."""
    time, place = f"12{k // 60:02d}{k % 60:02d}.00", f"48{k / 30 + 10:08.5f},N,00230.0000,E"
    bodies = {
        "RMC": f"GPRMC,{time},{status},{place},120.0,0.0,010624,,,{mode}",
        "GGA": f"GPGGA,{time},{place},{quality},{n_sv:02d},1.0,100.0,M,45.0,M,,",
        "GST": f"GPGST,{time},1.0,5.0,5.0,0.0,5.0,5.0,5.0",
    }
    return "".join(sentence(bodies[name]) for name in sentences.split())


def watched(text: str, tmp_path: Path, sigma_m: float | None = None) -> pl.DataFrame:
    (tmp_path / "log.nmea").write_text(text)
    return lived(tmp_path / "log.nmea", tmp_path / "live", live.Settings(format="nmea", rnp_m=RNP_M, sigma_m=sigma_m), chunk=97)


def analyzed(text: str, tmp_path: Path, sigma_m: float | None = None) -> Run:
    (tmp_path / "log.nmea").write_text(text)
    return navbound.analyze(tmp_path / "log.nmea", spec="RNP 0.3", sigma_m=sigma_m)


OTHER_DATUM = sentence("GPDTM,NAD27,,0.0,N,0.0,E,0.0,W84")


def test_a_datum_that_is_stated_once_holds_for_all(tmp_path: Path) -> None:
    text = "".join(second(k) for k in range(N))
    with pytest.raises(FormatError, match=r"60 rows left out, position that another statement .*DTM datum NAD27"):
        analyzed(OTHER_DATUM + text, tmp_path)
    epochs = watched(OTHER_DATUM + text, tmp_path)
    assert set(epochs["status"]) == {"not_available"}
    # Stated at the end alone it is that of the file all the same.
    with pytest.raises(FormatError, match=r"60 rows left out, position that another statement .*DTM datum NAD27"):
        analyzed(text + OTHER_DATUM, tmp_path)


def test_rmc_alone_needs_a_typed_accuracy(tmp_path: Path) -> None:
    text = "".join(second(k, "RMC") for k in range(N))
    without, typed = analyzed(text, tmp_path), analyzed(text, tmp_path, sigma_m=5.0)
    assert (without.summary.verdict.id, typed.summary.verdict.id) == ("nothing_judged", "inside")
    assert any("no GGA comes, so positions are those of RMC" in words for words in typed.summary.assumptions)
    both = watched(text, tmp_path, sigma_m=5.0).join(typed.epochs, on="time_ns")
    assert both.height == N
    assert set(both["status"]) == {"ok"}
    assert (both["accuracy_bound_m"] == both["anp_circle_m"]).all()


def test_rmc_alone_without_a_fix_is_a_missing_epoch(tmp_path: Path) -> None:
    bad = {20: second(20, "RMC", status="V", mode="N"), 21: second(21, "RMC", mode="E"), 22: second(22, "RMC", mode="S")}
    text = "".join(bad.get(k) or second(k, "RMC") for k in range(N))
    run = analyzed(text, tmp_path, sigma_m=5.0)
    assert (run.summary.n_status["ok"], run.summary.rejected[0].count) == (57, 3)
    epochs = watched(text, tmp_path, sigma_m=5.0)
    assert epochs["status"].to_list()[20:23] == ["not_available"] * 3
    assert set(epochs["status"].to_list()[:20]) == {"ok"}


@pytest.mark.parametrize("order", ["RMC GGA", "GGA RMC"])
def test_live_rmc_beside_gga_is_no_second_position(tmp_path: Path, order: str) -> None:
    text = "".join(second(k, order, quality=0 if k in {0, 30} else 1) for k in range(N))
    epochs = watched(text, tmp_path, sigma_m=5.0)
    assert epochs["time_ns"].n_unique() == epochs.height == N
    assert [epochs["status"][k] for k in (0, 30)] == ["not_available"] * 2


@pytest.mark.parametrize("last", ["RMC", "GLL", "GNS"])
@pytest.mark.parametrize("where", ["end", "begin", "between"])
def test_an_epoch_that_other_sentences_state_without_a_fix_is_missing_where_no_gga_comes(tmp_path: Path, where: str, last: str) -> None:
    """Of 60 s, 20 have no GGA: the receiver says that it has no fix."""
    without = {"end": range(40, 60), "begin": range(20), "between": range(1, 41, 2)}[where]

    def none(k: int) -> str:
        time = f"1200{k:02d}.00"
        bodies = {"RMC": f"GPRMC,{time},V,,,,,,,010624,,,N", "GLL": f"GPGLL,,,,,{time},V,N", "GNS": f"GNGNS,{time},,,,,NN,00,,,,,"}
        return sentence(bodies[last])

    text = "".join(none(k) if k in without else second(k) for k in range(60))
    verdict = analyzed(text, tmp_path).summary.verdict
    assert (verdict.id, verdict.n_judged, verdict.n_missing) == ("not_shown", 40, 20)
    # Live nothing before the first date has a time.
    if where != "begin":
        assert watched(text, tmp_path)["status"].to_list().count("not_available") == 20


@pytest.mark.parametrize("where", ["end", "begin"])
def test_positions_of_rmc_that_go_on_without_gga_are_expected(tmp_path: Path, where: str) -> None:
    alone = range(20, 60) if where == "end" else range(40)
    verdict = analyzed("".join(second(k, "RMC" if k in alone else "RMC GGA GST") for k in range(60)), tmp_path).summary.verdict
    assert (verdict.id, verdict.n_judged) == ("not_shown", 20)
    assert verdict.n_missing + verdict.n_absent >= 1


def test_positions_of_rmc_between_those_of_gga_are_no_epochs(tmp_path: Path) -> None:
    """A receiver writes RMC each second and GGA at every fifth."""
    verdict = analyzed("".join(second(k, "RMC GGA GST" if k % 5 == 0 else "RMC") for k in range(300)), tmp_path).summary.verdict
    assert (verdict.id, verdict.n_judged, verdict.n_missing) == ("inside", 60, 0)


def test_another_talker_takes_no_datum_back(tmp_path: Path) -> None:
    text = "".join(second(k) for k in range(2, N))
    with pytest.raises(FormatError, match="DTM datum NAD27"):
        analyzed(OTHER_DATUM + second(0) + sentence("GLDTM,W84,,0.0,N,0.0,E,0.0,W84") + second(1) + text, tmp_path)
    epochs = watched(OTHER_DATUM + second(0) + sentence("GLDTM,W84,,0.0,N,0.0,E,0.0,W84") + second(1) + text, tmp_path)
    assert set(epochs["status"]) == {"not_available"}


def test_a_speed_that_vtg_estimates_speaks_of_positions_that_stand(tmp_path: Path) -> None:
    def standing(k: int) -> str:
        time, place = f"12{k // 60:02d}{k % 60:02d}.00", f"48{10 + 0.001 * (k % 3):08.5f},N,00230.0000,E"
        bodies = (
            f"GPRMC,{time},A,{place},,,010624,,,A",
            f"GPGGA,{time},{place},1,08,1.0,100.0,M,45.0,M,,",
            "GPVTG,0.0,T,,M,136.0,N,251.9,K,E",
            f"GPGST,{time},1.0,5.0,5.0,0.0,5.0,5.0,5.0",
        )
        return "".join(map(sentence, bodies))

    assert analyzed("".join(standing(k) for k in range(120)), tmp_path).summary.verdict.id == "not_shown"


def test_the_terminal_says_what_was_stated_against_a_position(tmp_path: Path, navbound: Callable[..., Ended]) -> None:
    text = "".join(second(k) + sentence(f"GPGSA,A,{2 if k >= N - 3 else 3},01,02,03,04,,,,,,,,,2.0,1.0,1.7") for k in range(N))
    (tmp_path / "log.nmea").write_text(text)
    ended = navbound("analyze", tmp_path / "log.nmea", "--spec", "RNP 0.3", "--out", tmp_path / "run")
    (words,) = (line.strip() for line in ended.stdout.splitlines() if "speaks against" in line)
    # Four sentences a second.
    assert (
        words == f"3 x position that another statement of its epoch speaks against (log.nmea, first: record {4 * (N - 3) + 2}: GSA fix 2)"
    )
