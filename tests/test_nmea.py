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
    import polars as pl

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


def analyzed(text: str, tmp_path: Path, sigma_m: float | None = None) -> navbound.Run:
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
