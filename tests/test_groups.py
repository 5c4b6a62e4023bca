"""Approaches beside each other and satellites one by one: numbers that can be counted by hand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from navbound import gnss
from navbound.report import sky
from navbound.run.summary.approaches import deviation_bands, deviation_groups
from navbound.run.summary.satellites import satellites_of

NM = 1852.0
DATA = Path(__file__).parents[1] / "examples" / "data"
STATION_ECEF_M = (4189135.1896, 188029.6189, 4789919.6247)


def approaches(n: int = 50) -> pl.DataFrame:
    """Tracks 0 to n-1, each at +k metres right of the path all the way; two epochs a half mile, from 3 NM to the threshold."""
    before = np.arange(12) * 0.25 * NM + 0.1 * NM
    return pl.concat(
        [
            pl.DataFrame(
                {
                    "track": [f"t{k}"] * 12,
                    "leg": ["LFPG/08R" if k % 2 == 0 else "LFPG/09L"] * 12,
                    "along_m": -before,
                    "fte_m": np.full(12, float(k)),
                    "est_h_m": 100.0 + before * math.tan(math.radians(3.0)),
                    "_inside": np.full(12, fill_value=True),
                    "_ratio": np.full(12, k / 100.0),
                }
            )
            for k in range(n)
        ]
    )


def test_the_band_of_a_runway_holds_the_middle_95_percent_and_its_envelope_all() -> None:
    bands = deviation_bands(approaches())
    assert [(b.runway, b.column) for b in bands] == [(r, c) for r in ("LFPG/08R", "LFPG/09L") for c in ("fte_m", "est_h_m")]
    lateral = bands[0]
    # Even numbers from 0 to 48, each twice in a bin of half a mile.
    assert lateral.n == [50] * 6
    assert lateral.before_m == pytest.approx([(k + 0.5) * NM / 2 for k in range(6)])
    assert (set(lateral.least_m), set(lateral.most_m), set(lateral.median_m)) == ({0.0}, {48.0}, {24.0})
    # Of 50 values the second from either end, which the nearest rank to 2.5 % of 49 steps is.
    assert (set(lateral.low_m), set(lateral.high_m)) == ({0.0}, {48.0})
    assert sum(lateral.counts) == 300
    assert len(lateral.edges_m) == len(lateral.counts) + 1
    assert bands[1].counts == []


def test_few_epochs_have_an_envelope_and_no_band() -> None:
    (lateral, _), *_ = [deviation_bands(approaches(2).filter(pl.col("leg") == "LFPG/08R"))]
    assert lateral.n == [2] * 6
    assert set(lateral.low_m) == set(lateral.high_m) == {None}
    assert set(lateral.least_m) == {0.0}


def test_groups_are_runways_and_operators_and_name_who_deviates_most() -> None:
    labels = {f"t{k}": ("AFR" if k < 10 else "DLH") + f"{k} X" for k in range(20)} | {"t3": "F-GABC X"}
    groups = {(g.by, g.name): g for g in deviation_groups(approaches(20), labels)}
    assert set(groups) == {("runway", "LFPG/08R"), ("runway", "LFPG/09L"), ("operator", "AFR"), ("operator", "DLH")}
    # A registration is no operator's flight number.
    assert groups["operator", "AFR"].n_tracks == 9
    assert (groups["operator", "DLH"].most_m, groups["operator", "DLH"].most_track) == (19.0, "t19")
    assert groups["runway", "LFPG/08R"].mean_m == pytest.approx(9.0)
    assert groups["runway", "LFPG/09L"].worst_ratio == pytest.approx(0.19)


def test_what_is_no_approach_has_neither_bands_nor_groups() -> None:
    en_route = approaches(3).with_columns(along_m=-pl.col("along_m"))
    assert deviation_bands(en_route) == []
    assert deviation_groups(en_route, {}) == []
    assert deviation_bands(en_route.drop("leg")) == []


@pytest.fixture(scope="module")
def heard() -> pl.DataFrame:
    """The station of the example files: G10 is wrong for a quarter of an hour."""
    observations, navigation = gnss.read_observations(DATA / "station.rnx"), gnss.read_navigation(DATA / "broadcast.rnx")
    solution = gnss.solve(
        observations, navigation, signals="dual", truth_ecef_m=STATION_ECEF_M, mask_rad=math.radians(10.0), keep_ranges=True
    )
    assert solution.heard is not None
    return solution.heard


def test_every_satellite_has_a_fate_and_the_wrong_one_is_excluded_while_it_is_wrong(heard: pl.DataFrame) -> None:
    assert set(heard["fate"]) <= set(gnss.FATES)
    excluded = heard.filter(fate="excluded")
    # From 4500 s to 5400 s after the first epoch, every 30 s; the file begins with the first.
    start = heard["time_ns"].min()
    assert isinstance(start, int)
    assert set(excluded["sv"]) == {"G10"}
    seconds = ((excluded["time_ns"] - start) // 1_000_000_000).to_list()
    assert 28 <= len(seconds) <= 31
    assert 4500 <= min(seconds) < max(seconds) <= 5400
    low = heard.filter(fate="below_mask")
    assert low.height > 0
    assert float(low["el_rad"].max()) < math.radians(10.0) < float(heard.filter(fate="used")["el_rad"].min())  # type: ignore[arg-type]


def test_residuals_of_a_constellation_have_no_clock_left_in_them(heard: pl.DataFrame) -> None:
    used = heard.filter(fate="used")
    weighted = used.with_columns(w=pl.col("sigma_m") ** -2, system=pl.col("sv").str.slice(0, 1))
    mean = weighted.group_by("time_ns", "system").agg(m=(pl.col("residual_m") * pl.col("w")).sum() / pl.col("w").sum())
    assert float(mean["m"].abs().max()) < 1e-9  # type: ignore[arg-type]
    # The receiver's clock was off by 3 km and more.
    assert float(used["residual_m"].abs().max()) < 20.0  # type: ignore[arg-type]
    assert heard.filter(pl.col("fate") != "used")["residual_m"].null_count() == heard.filter(pl.col("fate") != "used").height


def test_satellites_are_counted_by_fate(heard: pl.DataFrame) -> None:
    by = {s.sv: s for s in satellites_of(heard)}
    g10 = by["G10"]
    assert g10.n_used + sum(g10.n_fate.values()) == g10.n_heard == heard.filter(sv="G10").height
    assert g10.n_fate["excluded"] == heard.filter(fate="excluded").height
    assert satellites_of(None) == []


def test_a_long_day_of_satellites_is_thinned_by_whole_epochs(heard: pl.DataFrame, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = sky.pack(heard)
    assert (whole.heads[0]["n"], whole.words) == (heard.height, [])
    monkeypatch.setattr(sky, "MOST_ROWS", heard.height // 2)
    thinned = sky.pack(heard)
    kept = heard.filter((pl.col("time_ns").rank("dense").cast(pl.Int64) - 1) % 2 == 0).height
    assert thinned.heads[0]["n"] == kept
    assert thinned.words == ["The charts of satellites show one epoch in 2; their table counts all."]
