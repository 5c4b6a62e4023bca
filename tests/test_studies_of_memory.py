"""How long errors and monitors remember: the appendix studies, from drawn series and from files."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from scipy.optimize import brentq

from navbound import FormatError, InputError, gnss, study
from navbound.studies.decorrelation_time import study as decorrelation
from navbound.studies.multipath_time_constants import study as multipath
from navbound.studies.series_memory import INVERSE_E, autocorrelation, first_crossing


def exact_crossing(tau: float, ts: float) -> float:
    """Where (tau e^-t/tau - ts e^-t/ts) / (tau - ts), the autocorrelation of smoothed multipath, is 1/e."""
    return float(brentq(lambda t: (tau * math.exp(-t / tau) - ts * math.exp(-t / ts)) / (tau - ts) - INVERSE_E, 1e-3, 1e5))


def test_the_autocorrelation_is_the_plain_sum() -> None:
    x = np.random.default_rng(1).normal(2.0, 1.0, 40)
    for remove in (True, False):
        y = x - x.mean() if remove else x
        direct = np.array([np.dot(y[: 40 - k], y[k:]) for k in range(40)]) / np.dot(y, y)
        # A transform of 80 points.
        assert np.abs(autocorrelation(x, remove_mean=remove) - direct).max() < 1e-13


def test_a_crossing_lies_on_the_line_between_two_samples() -> None:
    rows = np.array([[1.0, 0.6, 0.2, -0.2], [1.0, 0.9, 0.8, 0.7], [0.1, 0.0, 0.0, 0.0]])
    result = first_crossing(rows, 0.4)
    assert result[0] == pytest.approx(1.5, rel=1e-15)
    assert np.isnan(result[1])
    assert result[2] == 0.0


@pytest.mark.parametrize(("tau", "ts"), [(5.0, 30.0), (5.0, 100.0), (14.0, 100.0), (60.0, 30.0)])
def test_smoothed_multipath_remembers_as_long_as_its_law_says(tau: float, ts: float) -> None:
    generator = np.random.Generator(np.random.Philox(5))
    lags = [
        first_crossing(
            autocorrelation(multipath.smooth(multipath.markov(generator, np.full(50, tau)), ts)[:, 600:], remove_mean=False).mean(axis=0)[
                None
            ],
            INVERSE_E,
        )[0]
        for _ in range(2)
    ]
    # The biased autocorrelation of two hours crosses 3 % early, and fifty of them scatter by 3 % (fourteen seeds); this is the mean of two.
    assert abs(np.mean(lags) / exact_crossing(tau, ts) - 1.0 + 0.03) < 0.07


def test_the_law_of_time_constants_meets_its_percentiles() -> None:
    result = multipath.time_constants(np.random.Generator(np.random.Philox(7)), 200_000)
    # The 5 % and 50 % points of 2e5 draws scatter by 1 % and less; the 95 % one stands where a steep part begins.
    for share, expected, tolerance in ((5, 7.0, 0.02), (50, 14.0, 0.02), (95, 170.0, 0.05)):
        assert abs(np.percentile(result, share) / expected - 1.0) < tolerance
    assert result.min() == 5.0
    assert result.max() <= 900.0


def test_the_study_of_multipath_agrees_with_the_law_and_the_published_least() -> None:
    result = multipath.run(draws=400)
    generator = np.random.Generator(np.random.Philox(673))
    tau = multipath.time_constants(generator, 400)
    for row in result.smoothed:
        exact = np.median([exact_crossing(t, row.smoothing_s) for t in tau])
        # A time constant from two hours scatters by a tenth, the median of 400 by a twentieth of the law's width; steps last a second.
        assert abs(row.median_s / exact - 1.0) < 0.08
        # With the paper's draws the least is 26 and 54 s; fewer cannot be below by more than a tenth.
        assert row.published_least_s * 0.9 < row.least_s < row.median_s
        assert row.published_most_s / 4 < row.most_s
        for simulated, law in zip(row.variance_ratio, row.variance_ratio_exact, strict=True):
            # A hundred series of 7200 s; of 170 s each holds but twenty independent stretches, whose own mean is removed.
            assert abs(simulated / law - 1.0) < 0.15


def test_the_zero_of_a_divergence_monitor_is_the_specifications() -> None:
    for tau, expected in decorrelation.CHECKED_S.items():
        # Whole seconds, the first at or below zero.
        assert math.ceil(decorrelation.spectral_zero(tau)) == expected


def test_drawn_monitors_agree_with_their_spectrum() -> None:
    result = decorrelation.run()
    for row in result.divergence:
        # Sixteen series of four hours; filters in steps of a second.
        assert abs(row.simulated_s / row.zero_s - 1.0) < 0.08
    assert result.effective_s == 100.0


def table(path: Path, columns: dict[str, np.ndarray]) -> Path:
    names = list(columns)
    lines = [",".join(names)] + [",".join(f"{v:.9g}" for v in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_a_series_of_ones_own_is_read(tmp_path: Path) -> None:
    x = multipath.markov(np.random.Generator(np.random.Philox(2)), np.full(3, 40.0))
    path = table(tmp_path / "series.csv", {"time_s": np.arange(x.shape[1]) * 2.0, "G01": x[0], "G02": x[1], "G03": x[2]})
    result = study("multipath-time-constants", [path])
    constants = [s.time_constant_s for s in result.series]  # type: ignore[attr-defined]
    # Samples 2 s apart of a memory of 40 samples; a time constant from 195 of them scatters by a fifth.
    assert all(c is not None and 40.0 < c < 130.0 for c in constants)
    memory = study("decorrelation-time", [path]).measured  # type: ignore[attr-defined]
    assert memory.n_series == 3
    assert memory.step_s == 2.0
    assert 40.0 < memory.inverse_e_s < 130.0
    assert memory.zero_s > memory.inverse_e_s


@pytest.mark.parametrize(
    ("columns", "says"),
    [
        ({"t": np.arange(20.0), "a": np.ones(20)}, "time_s"),
        ({"time_s": np.arange(4.0), "a": np.ones(4)}, "16 rows"),
        ({"time_s": np.arange(20.0) ** 2, "a": np.ones(20)}, "equal steps"),
        ({"time_s": np.arange(20.0), "a": np.where(np.arange(20) == 3, np.nan, 1.0)}, "a gap"),
        ({"time_s": np.zeros(20), "a": np.ones(20)}, "equal steps"),
    ],
)
def test_a_table_that_is_none_is_refused(tmp_path: Path, columns: dict[str, np.ndarray], says: str) -> None:
    path = table(tmp_path / "bad.csv", columns)
    for name in ("multipath-time-constants", "decorrelation-time"):
        with pytest.raises(FormatError, match=says):
            study(name, [path])


def test_files_that_are_none_or_too_many_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError):
        study("decorrelation-time", [tmp_path / "nowhere.csv"])
    (tmp_path / "text.csv").write_text("time_s,a\n" + "x,y\n" * 20, encoding="utf-8")
    with pytest.raises(FormatError, match="not numbers"):
        study("decorrelation-time", [tmp_path / "text.csv"])
    with pytest.raises(InputError, match="files"):
        study("decorrelation-time", ["a.csv", "b.csv"])
    with pytest.raises(InputError, match="draws"):
        multipath.run(draws=3)


def test_the_multipath_of_a_real_satellite_is_remembered_as_the_law_says(shared_data: Path, tmp_path: Path) -> None:
    file = shared_data / "gnss" / "UPC3_2008_351_smoothing" / "UPC33510.08O_trunc"
    if not file.is_file():
        pytest.skip(f"{file} is not here: no real series is read")
    observed = gnss.read_observations(file)
    columns = [observed.column("G", name).select("time_ns", pl.col("value").alias(name)) for name in ("C1C", "L1C", "L2W")]
    table = columns[0].join(columns[1], on="time_ns").join(columns[2], on="time_ns").drop_nulls().sort("time_ns")
    l1, l2 = (table[name].to_numpy() * 299_792_458.0 / f for name, f in (("L1C", 1575.42e6), ("L2W", 1227.60e6)))
    ratio = 2.0 / ((1575.42 / 1227.60) ** 2 - 1.0)
    # Code less phase; both phases take the ionosphere out, once from the code and once from the first phase.
    multipath_m = table["C1C"].to_numpy() - (1.0 + ratio) * l1 + ratio * l2
    second = (table["time_ns"].to_numpy() - table["time_ns"][0]) // 1_000_000_000
    whole = int(np.argmax(np.diff(second) > 1)) + 1
    assert whole > 20_000
    path = tmp_path / "multipath.csv"
    pl.DataFrame({"time_s": second[:whole], "G03": multipath_m[:whole] - multipath_m[:whole].mean()}).write_csv(path)
    result, again = study("multipath-time-constants", [path]), study("decorrelation-time", [path])
    assert isinstance(result, multipath.Study)
    assert isinstance(again, decorrelation.Study)
    constant = result.series[0].time_constant_s
    assert constant is not None
    # The published percentiles of raw multipath, 5 and 95 %.
    assert 7.0 < constant < 170.0
    assert again.measured is not None
    assert again.measured.inverse_e_s == pytest.approx(constant, abs=0.5)  # its mean is all but nothing
    assert again.measured.zero_s is not None
    assert again.measured.zero_s > constant
