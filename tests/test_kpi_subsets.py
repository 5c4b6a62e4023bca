"""The Stanford-ESA diagram against a slow transcription: every subset solved by itself with NumPy."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from numpy.typing import NDArray

import navbound
from navbound import InputError, gnss, kpi

Floats = NDArray[np.float64]
LEVELS = [kpi.level("APV-I"), kpi.level("NPA")]
ESBC_TRUTH = (3582104.9212, 532590.1856, 5232755.3599)


def ranges(n_epochs: int, n_sv: int, seed: int = 5, shared: bool = True) -> pl.DataFrame:
    """Satellites anywhere above 8 degrees; the last satellite's is wrong by 60 m in every third epoch."""
    rng = np.random.default_rng(seed)
    n = n_epochs * n_sv
    error = rng.normal(0.0, 1.5, n) + np.repeat(rng.normal(0.0, 50.0, n_epochs), n_sv)
    error.reshape(n_epochs, n_sv)[::3, -1] += 60.0
    columns: dict[str, Any] = {
        "time_ns": np.repeat(np.arange(n_epochs) * 10**9, n_sv),
        "sv": [f"G{k + 1:02d}" for _ in range(n_epochs) for k in range(n_sv)],
        "az_rad": rng.uniform(0.0, 2 * np.pi, n),
        "el_rad": rng.uniform(np.radians(8.0), np.radians(88.0), n),
        "sigma_m": rng.uniform(0.8, 4.0, n),
        "range_error_m": error,
    }
    if shared:
        columns |= {f"shared_{k}_m": rng.normal(0.0, 1.0, n) for k in (1, 2, 3, 4)}
    return pl.DataFrame(columns)


def solved(epoch: pl.DataFrame, used: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Position error and covariance of some rows, by the normal equation of the textbook."""
    part = epoch[list(used)]
    az, el = part["az_rad"].to_numpy(), part["el_rad"].to_numpy()
    h = np.column_stack([np.sin(az) * np.cos(el), np.cos(az) * np.cos(el), np.sin(el), np.ones(len(used))])
    w = np.diag(part["sigma_m"].to_numpy() ** -2.0)
    gain = np.linalg.solve(h.T @ w @ h, h.T @ w)
    covariance = np.linalg.inv(h.T @ w @ h)[:3, :3]
    for name in ("shared_1_m", "shared_2_m", "shared_3_m", "shared_4_m"):
        if name in part.columns:
            moved = (gain @ part[name].to_numpy())[:3]
            covariance = covariance + np.outer(moved, moved)
    return (gain @ part["range_error_m"].to_numpy())[:3], covariance


def point(nse: Floats, covariance: Floats) -> tuple[float, float, float, float]:
    """HPE, HPL, VPE, VPL."""
    largest = float(np.linalg.eigvalsh(covariance[:2, :2])[-1])
    return float(np.hypot(nse[0], nse[1])), 6.0 * largest**0.5, float(abs(nse[2])), 5.33 * float(covariance[2, 2]) ** 0.5


@pytest.mark.parametrize("shared", [True, False])
def test_every_subset_is_that_of_the_textbook(shared: bool) -> None:
    table = ranges(12, 8, shared=shared)
    diagram = kpi.stanford_esa(table, LEVELS).subsets
    points: list[tuple[int, tuple[int, ...], tuple[float, float, float, float]]] = []
    for epoch in table.partition_by("time_ns", maintain_order=True):
        for size in range(4, 9):
            points += [(epoch["time_ns"][0], c, point(*solved(epoch, c))) for c in itertools.combinations(range(8), size)]
    assert (diagram.n_epochs, diagram.n_subsets, diagram.n_singular) == (12, len(points), 0)
    values = np.array([p[2] for p in points])
    hpe, hpl, vpe, vpl = values.T
    regions = diagram.stanford["APV-I"]
    for counts, error, level, limit in ((regions[0], hpe, hpl, 40.0), (regions[1], vpe, vpl, 50.0)):
        below, within = level < limit, error <= level
        assert counts.n_nominal == int((below & within).sum())
        assert counts.n_mi == int((below & ~within & (error <= limit)).sum())
        assert counts.n_hmi == int((below & ~within & (error > limit)).sum())
        assert counts.n_unavailable == int((~below & within).sum())
        assert counts.n_unavailable_mi == int((~below & ~within).sum())
    assert [c.axis for c in diagram.stanford["NPA"]] == ["h"]
    index = np.maximum(hpe / hpl, vpe / vpl)
    assert diagram.n_listed == int((index >= 0.7).sum()) > 20
    assert diagram.n_mi == int((index > 1.0).sum()) > 0
    # Worst subsets, their satellites and epoch; sixteen digits less the condition of subsets whose levels are below kilometres.
    for k, row in enumerate(diagram.listed[:20]):
        at = np.argsort(-index)[k]
        assert row.time_ns == points[at][0]
        assert row.satellites == [f"G{i + 1:02d}" for i in points[at][1]]
        assert sorted(row.satellites + row.left_out) == [f"G{i + 1:02d}" for i in range(8)]
        assert (row.hpe_m, row.hpl_m, row.vpe_m, row.vpl_m) == pytest.approx(tuple(values[at]), rel=1e-8)
        assert row.safety_index == pytest.approx(index[at], rel=1e-8)
    assert diagram.safety_index_h_max == pytest.approx((hpe / hpl).max(), rel=1e-8)


def test_a_good_geometry_hides_what_a_subset_shows() -> None:
    """Ten ranges all around, one wrong by 5 m: the whole set looks well within its level, subsets that lean on the wrong one do not."""
    spread = {"az_rad": np.radians(137.5 * np.arange(10) % 360.0), "el_rad": np.radians(12.0 + 7.5 * np.arange(10))}
    table = ranges(1, 10, shared=False).with_columns(
        **{name: pl.Series(values) for name, values in spread.items()},
        range_error_m=pl.when(pl.col("sv") == "G03").then(5.0).otherwise(0.0),
        sigma_m=pl.lit(1.0),
    )
    whole = point(*solved(table, tuple(range(10))))
    assert whole[0] / whole[1] < 0.7
    assert whole[2] / whole[3] < 0.7
    diagram = kpi.stanford_esa(table, LEVELS).subsets
    assert diagram.n_listed > 0
    assert max(diagram.safety_index_h_max, diagram.safety_index_v_max) > 1.3 * max(whole[0] / whole[1], whole[2] / whole[3])
    assert all("G03" in row.satellites for row in diagram.listed)


def test_limits_of_the_subsets_are_kept_and_reported() -> None:
    table = ranges(3, 12)
    # Of twelve: 495 + 792 + 924 + 792 + 495 + 220 + 66 + 12 + 1.
    assert kpi.stanford_esa(table, LEVELS).subsets.n_subsets == 3 * 3797
    five = kpi.stanford_esa(table, LEVELS, kpi.SubsetOptions(min_satellites=5)).subsets
    assert five.n_subsets == 3 * (3797 - 495)
    # 2^8 = 256 holds 1 + 12 + 66 subsets, not 220 more.
    cut = kpi.stanford_esa(table, LEVELS, kpi.SubsetOptions(max_satellites=8)).subsets
    assert (cut.n_subsets, cut.n_cut) == (3 * 79, 3)
    assert all(len(row.left_out) <= 2 for row in cut.listed)
    times = table["time_ns"].unique(maintain_order=True)
    in_two = kpi.stanford_esa([table.filter(pl.col("time_ns") == t) for t in times], LEVELS)
    assert in_two == kpi.stanford_esa(table, LEVELS)


def test_the_indicators_carry_the_subsets_beside_them() -> None:
    epochs = {"time_ns": np.arange(4) * 3 * 10**8, "hpl_m": np.full(4, 9.0), "vpl_m": np.full(4, 9.0), "nse_e_m": np.zeros(4)}
    table = epochs | {"nse_n_m": np.zeros(4), "nse_u_m": np.zeros(4)}
    words = "experimental, not integrity"
    result = kpi.evaluate(table, "APV-I", ranges=ranges(4, 7), subsets=kpi.SubsetOptions(max_satellites=4), experimental=words)
    assert [bins.variant for bins in result.stanford] == ["stanford", "stanford", "stanford-esa", "stanford-esa"]
    assert result.subsets is not None
    assert result.subsets.n_subsets == sum(bins.n for bins in result.stanford[2:3]) == 4 * 8
    assert any("2^4" in note for note in result.notes)
    assert result.experimental == words
    # 0.3 s as a step of whole nanoseconds is the double 0.3.
    assert result.period_s == 0.3


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"sv": ["G01"] * 4 + ["E05"] * 3}, "one constellation"),
        ({"sigma_m": [1.0] * 6 + [0.0]}, "sigma_m"),
        ({"range_error_m": [1.0] * 6 + [None]}, "range_error_m"),
        ({"el_rad": [0.5] * 6 + [2.0]}, "el_rad"),
        ({"time_ns": [1, 0, 0, 0, 0, 0, 0]}, "order of time"),
        ({"az_rad": None}, "az_rad"),
    ],
)
def test_ranges_that_are_none_are_refused(change: dict[str, Any], words: str) -> None:
    columns = ranges(1, 7).to_dict(as_series=False)
    for name, values in change.items():
        columns.pop(name)
        if values is not None:
            columns[name] = values
    with pytest.raises(InputError, match=words):
        kpi.stanford_esa(columns, LEVELS)


@pytest.mark.parametrize("options", [{"min_satellites": 3}, {"max_satellites": 25}, {"listed_from": 0.0}])
def test_options_outside_their_domain_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(options))):
        kpi.SubsetOptions(**options)


def test_the_whole_set_of_a_real_day_is_the_position_itself(shared_data: Path) -> None:
    """The ranges of a receiver's day, set against truth, give back each position's error and covariance."""
    folder = shared_data / "gnss" / "ESBC_2020_177"
    observations = gnss.read_observations(folder / "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz")
    navigation = gnss.read_navigation(folder / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz")
    positions = gnss.solve(observations, navigation, systems="G", truth_ecef_m=ESBC_TRUTH, keep_ranges=True)
    assert positions.ranges is not None
    from navbound.run.evaluate.levels import _range_errors  # noqa: PLC0415 - the step under test

    table = _range_errors(positions.ranges, positions.epochs)
    assert table.group_by("time_ns").len().join(positions.epochs, on="time_ns").select((pl.col("len") == pl.col("n_sv")).all()).item()
    for k in (0, 700, 1500, 2879):
        epoch = positions.epochs.row(k, named=True)
        nse, covariance = solved(table.filter(pl.col("time_ns") == epoch["time_ns"]), tuple(range(epoch["n_sv"])))
        # Ranges are straight to 3e-8 m over some metres; delays that are held over a metre move 1.5 mm.
        assert nse == pytest.approx([epoch[f"nse_{axis}_m"] for axis in "enu"], abs=2e-3)
        named = {
            "cov_ee_m2": (0, 0),
            "cov_en_m2": (0, 1),
            "cov_nn_m2": (1, 1),
            "cov_eu_m2": (0, 2),
            "cov_nu_m2": (1, 2),
            "cov_uu_m2": (2, 2),
        }
        for name, place in named.items():
            assert covariance[place] == pytest.approx(epoch[name], abs=1e-9 * float(np.abs(covariance).max()))


def test_the_stanford_esa_diagram_of_a_real_day_from_the_command_line(shared_data: Path, tmp_path: Path) -> None:
    folder = shared_data / "gnss" / "ESBC_2020_177"
    files = [str(folder / name) for name in ("ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz", "ESBC00DNK_R_20201770000_01D_MN.rnx.gz")]
    arguments = [
        "--levels",
        "APV-I,NPA",
        "--truth",
        ",".join(map(str, ESBC_TRUTH)),
        "--stanford-esa",
        "--json",
        "--out",
        str(tmp_path / "run"),
    ]
    done = subprocess.run([sys.executable, "-m", "navbound", "analyze", *files, *arguments], capture_output=True, check=True)
    summary = json.loads(done.stdout)
    result = summary["performance"]
    n_sv = pl.read_parquet(tmp_path / "run" / "epochs.parquet")["n_sv"].to_numpy()
    choices = sum(int(np.prod(np.arange(n - k + 1, n + 1)) // np.prod(np.arange(1, k + 1))) for n in n_sv.tolist() for k in range(4, n + 1))
    assert result["subsets"]["n_subsets"] == choices
    assert result["subsets"]["n_cut"] == 0
    # Started again it finds the part, its ranges too, and says the same.
    (part,) = (tmp_path / "run" / "parts").glob("*.ranges.parquet")
    written = part.stat().st_mtime_ns
    again = navbound.evaluate(
        files, levels="APV-I,NPA", truth=",".join(map(str, ESBC_TRUTH)), stanford_esa=kpi.SubsetOptions(), out=tmp_path / "run"
    )
    assert part.stat().st_mtime_ns == written
    assert again.summary.performance is not None
    assert again.summary.performance.model_dump(mode="json") == result
    # Nobody monitors these levels: every place says so.
    assert result["experimental"] == "experimental, not integrity"
    assert summary["verdict"]["experimental"] is True
    header = (tmp_path / "run" / "epochs.csv").read_text().splitlines()[0]
    assert all(f"{name} [experimental, not integrity]" in header for name in ("HPL", "HSI", "VPL", "VSI"))
    # The covariance may be believed: the acceptance of the positions themselves, mean NEES from 1 to 4.
    assert 1.0 < summary["honesty"]["nees_mean"] < 4.0


def test_a_table_holds_no_ranges(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("time_ns,hpl_m\n0,1\n1000000000,1\n")
    with pytest.raises(InputError, match="a table holds no ranges"):
        navbound.evaluate(path, levels="NPA", stanford_esa=kpi.SubsetOptions())
