"""The ICAO indicators against the independent reference, and the same result whatever the cut into tables."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import polars as pl
import pytest

from conftest import SHARED
from navbound import InputError, kpi
from navbound.records.performance import Performance

REFERENCE = SHARED / "reference" / "ref-sbas-kpi.json"
PRINTED = 5e-10
"""The reference prints ten digits; relative."""


@pytest.fixture(scope="module")
def reference() -> dict[str, Any]:
    if not REFERENCE.is_file():
        pytest.skip(f"SKIPPED ALOUD: no reference at {REFERENCE}")
    data: dict[str, Any] = json.loads(REFERENCE.read_text())
    return data


def normals(seed: int) -> Iterator[float]:
    """SplitMix64 and Box-Muller as section 5 of the specification states them."""
    mask, state = (1 << 64) - 1, seed

    def uniform() -> float:
        nonlocal state
        state = (state + 0x9E3779B97F4A7C15) & mask
        x = state
        x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & mask
        x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & mask
        x ^= x >> 31
        return ((x >> 11) + 0.5) * 2.0**-53

    while True:
        radius, angle = math.sqrt(-2.0 * math.log(uniform())), 2.0 * math.pi * uniform()
        yield radius * math.cos(angle)
        yield radius * math.sin(angle)


def generated(params: dict[str, Any]) -> pl.DataFrame:
    draw = normals(params["seed"])
    rows = []
    for i in range(params["n"]):
        z = [next(draw) for _ in range(5)]
        rows.append(
            [
                0.4 * z[0],
                0.5 * z[1],
                0.9 * z[2] + 0.8 * math.sin(2 * math.pi * i / 3000),
                12 + 3 * math.sin(2 * math.pi * i / 1800) + 1.5 * abs(z[3]),
                params["vpl0"] + 8 * math.sin(2 * math.pi * i / 2400) + 3 * abs(z[4]),
            ]
        )
    table = np.array(rows)
    for column, faults in ((2, params["u_faults"]), (0, params["e_faults"]), (4, params["vpl_bumps"])):
        for first, end, size in faults:
            table[first:end, column] += size
    for first, end in params["no_solution"]:
        table[first:end] = np.nan
    names = ("nse_e_m", "nse_n_m", "nse_u_m", "hpl_m", "vpl_m")
    frame = pl.DataFrame(table, schema=list(names), orient="row").with_columns(time_ns=pl.int_range(params["n"], dtype=pl.Int64) * 10**9)
    absent = {i for first, end in params["missing"] for i in range(first, end)}
    return frame.filter(~pl.int_range(pl.len()).is_in(absent))


def test_the_generator_is_the_specification_s(reference: dict[str, Any]) -> None:
    assert reference["kpi"]
    draw = normals(1)
    assert math.isclose(next(draw), -0.0282497460959, rel_tol=1e-11)
    assert math.isclose(next(draw), -1.06561764841, rel_tol=1e-11)


def close(actual: float | None, expected: float) -> bool:
    return actual is not None and math.isclose(actual, expected, rel_tol=PRINTED)


def runs(result: Performance, level: str, kind: str) -> list[list[int]]:
    outcome = [e for e in result.events if e.level == level and e.kind == kind]
    return sorted([[e.onset_ns // 10**9, e.n_epochs] for e in outcome])


def test_every_count_of_the_reference_is_exact(reference: dict[str, Any]) -> None:
    for case in reference["kpi"]:
        names = list(case["levels"])
        result = kpi.evaluate(generated(case["params"]), names)
        for name in ("n_expected", "n_missing", "n_no_solution", "n_solution"):
            assert getattr(result, name) == case[name], name
        assert result.n_mi_epochs == case["n_epochs_MI"]
        for axis, letter in zip(result.axes, "HV", strict=True):
            assert axis.error_m is not None
            assert axis.level_m is not None
            assert axis.safety_index is not None
            assert close(axis.error_m.p95, case[f"{letter}PE95"])
            assert close(axis.error_m.p99, case[f"{letter}PE99"])
            assert close(axis.error_m.rms, case[f"{letter}PE_rms"])
            assert close(axis.level_m.p99, case[f"{letter}PL99"])
            assert close(axis.safety_index.max, case[f"{letter}SI_max"])
            assert axis.safety_index.max_time_ns == case[f"{letter}SI_max_at"] * 10**9
            assert axis.n_potential_mi == case[f"n_{letter}_potential_MI"]
            assert axis.n_mi == case[f"n_{letter}_MI"]
        for level in result.levels:
            _check_level(result, level, case["levels"][level.level.id])


def _check_level(result: Performance, actual: Any, expected: dict[str, Any]) -> None:
    assert (actual.level.hal_m, actual.level.val_m, actual.level.tta_s) == (expected["HAL"], expected["VAL"], expected["TTA_s"])
    assert actual.n_available == expected["n_available"]
    assert close(actual.availability_expected, expected["availability_expected"])
    assert close(actual.availability_solution, expected["availability_solution"])
    assert (actual.n_continuity_events, actual.n_at_risk) == (expected["continuity_events"], expected["n_at_risk"])
    risk = expected["continuity_risk"]
    assert actual.continuity_risk is None if risk is None else close(actual.continuity_risk, risk)
    for axis, counts in zip("HV", actual.stanford, strict=False):
        counts_expected = expected[f"stanford_{axis}"]
        assert [counts.n_nominal, counts.n_mi, counts.n_hmi, counts.n_unavailable, counts.n_unavailable_mi] == list(
            counts_expected.values()
        )
    assert len(actual.stanford) == (1 if expected["stanford_V"] is None else 2)
    assert runs(result, actual.level.id, "hazard") == expected["hazard_runs_start_len"]
    assert actual.n_hazard_events == len(expected["hazard_runs_start_len"])
    assert actual.n_hazard_over_tta == expected["hazard_runs_over_TTA"]
    assert (actual.n_mi_events, actual.n_mi_over_tta) == (expected["mi_runs"], expected["mi_runs_over_TTA"])


def test_the_continuity_pattern(reference: dict[str, Any]) -> None:
    case = reference["continuity_pattern"]
    result = kpi.continuity([c == "X" for c in case["pattern_X_available"]], case["window_epochs"])
    assert (result.n_at_risk, result.n_available) == (case["n_at_risk"], case["n_available"])


def series(n: int, seed: int = 3) -> pl.DataFrame:
    """A fluctuating receiver with everything a table can say."""
    rng = np.random.default_rng(seed)
    slow = np.repeat(rng.normal(size=n // 20 + 1), 20)[:n]
    frame = pl.DataFrame(
        {
            "time_ns": np.arange(n) * 10**9 + 10**15,
            "nse_e_m": rng.normal(size=n),
            "nse_n_m": rng.normal(size=n),
            "nse_u_m": 3 * rng.normal(size=n),
            "hpl_m": np.exp(2.5 + slow + 0.1 * rng.normal(size=n)),
            "vpl_m": np.exp(2.8 + slow + 0.2 * rng.normal(size=n)),
            "n_sv": rng.integers(4, 12, size=n),
            "mode": rng.choice(["pa", "npa"], size=n),
        }
    )
    frame = frame.with_columns(pl.when(pl.col("mode") == "pa").then("vpl_m").alias("vpl_m"))
    frame = frame.with_columns(pl.when(pl.int_range(pl.len()) % 97 > 2).then("hpl_m").alias("hpl_m"))
    return frame.filter(pl.Series(rng.random(n) > 0.02))


def comparable(result: Performance) -> dict[str, Any]:
    """Everything of a record; sums to the digits that their order of addition leaves (1e4 terms, 2^-53 each: 1e-12)."""

    def rounded(value: Any) -> Any:
        if isinstance(value, float):
            return float(f"{value:.11e}")
        if isinstance(value, dict):
            return {k: rounded(v) for k, v in value.items()}
        return [rounded(v) for v in value] if isinstance(value, list) else value

    by_name: dict[str, Any] = rounded(result.model_dump())
    return by_name


def test_any_cut_into_tables_gives_the_same_record() -> None:
    whole = series(40_000)
    expected = comparable(kpi.evaluate(whole, "NPA,APV-I,LPV-200", period_s=1.0))
    assert expected["n_events"]["loss"] > 100
    rng = np.random.default_rng(8)
    for n_cuts in (1, 7, 100):
        cuts = [0, *sorted(rng.choice(np.arange(1, whole.height), n_cuts, replace=False).tolist()), whole.height]
        parts = [whole[a:b] for a, b in pairwise(cuts)]
        assert comparable(kpi.evaluate(parts, "NPA,APV-I,LPV-200", period_s=1.0)) == expected


def test_percentiles_are_the_nearest_rank_of_the_sorted_values() -> None:
    table = series(5_000)
    result = kpi.evaluate(table, "APV-I")
    solved = table.filter(pl.col("hpl_m").is_not_null())
    usable = solved.filter((pl.col("hpl_m") < 40) & (pl.col("vpl_m") < 50))
    for rows, axes in ((solved, result.axes), (usable, result.levels[0].available)):
        error = np.sort(np.hypot(rows["nse_e_m"], rows["nse_n_m"]))
        spread = axes[0].error_m
        assert spread is not None
        assert spread.n == len(error)
        for share, value in ((0.5, spread.p50), (0.95, spread.p95), (0.99, spread.p99), (0.999, spread.p999)):
            # hypot and the root of the sum of squares differ in the last digit.
            assert math.isclose(value, error[math.ceil(share * len(error)) - 1], rel_tol=1e-15)
        ratio = np.sort((rows["nse_u_m"].abs() / rows["vpl_m"]).drop_nulls().to_numpy())
        index = axes[1].safety_index
        assert index is not None
        assert index.p95 == ratio[math.ceil(0.95 * len(ratio)) - 1]


def test_availability_is_monotone_in_the_limit_and_hazards_are_misleading() -> None:
    result = kpi.evaluate(series(5_000), ["NPA", "APV-I", "LPV-200", "APV-II", "CAT-I-12", "CAT-I"])
    shares = [level.availability_expected for level in result.levels]
    assert shares == sorted(shares, reverse=True)
    assert shares[0] > shares[-1]
    for level in result.levels:
        assert level.n_hazard_epochs <= level.n_mi_epochs
        assert level.availability_low <= level.availability_expected <= level.availability_high
        assert level.n_at_risk >= level.n_continuity_events
        # Days add up.
        assert sum(day.n_available[level.level.id] for day in result.days) == level.n_available
    assert sum(day.n_expected for day in result.days) == result.n_expected
    assert sum(result.series.n_expected) == result.n_expected


def test_losses_say_why() -> None:
    n = 40
    table = pl.DataFrame({"time_ns": np.arange(n) * 10**9, "hpl_m": [10.0] * n, "vpl_m": [20.0] * n, "n_sv": [9] * n, "mode": ["pa"] * n})
    at = pl.int_range(pl.len())
    table = table.with_columns(
        pl.when(at.is_between(5, 6)).then(80.0).otherwise("hpl_m").alias("hpl_m"),
        pl.when(at.is_between(10, 10)).then(50.0).when(at.is_between(15, 17)).then(None).otherwise("vpl_m").alias("vpl_m"),
        pl.when(at.is_between(10, 10)).then(7).otherwise("n_sv").alias("n_sv"),
        pl.when(at.is_between(15, 17)).then(pl.lit("npa")).otherwise("mode").alias("mode"),
        pl.when(at.is_between(20, 21)).then(pl.lit("not_available")).otherwise(pl.lit("ok")).alias("status"),
        pl.when(at.is_between(20, 21)).then(pl.lit("message 10 has timed out")).alias("reason"),
    ).filter(~at.is_between(30, 33))
    result = kpi.evaluate(table, "APV-I")
    outcome = sorted((e.onset_ns // 10**9, e.n_epochs, e.cause, e.reason) for e in result.events)
    assert outcome == [
        (5, 2, "hpl", ""),
        (10, 1, "vpl", "satellites 9 to 7"),
        (15, 3, "no vertical level", "mode pa to npa"),
        (20, 2, "no solution", "message 10 has timed out"),
        (30, 4, "no epoch", ""),
    ]
    assert not result.truth_known
    assert result.axes[0].error_m is None
    assert result.levels[0].accuracy_met is None
    excluded = kpi.evaluate(table, "APV-I", exclude_missing=True)
    assert (excluded.n_expected, excluded.n_missing, excluded.levels[0].n_continuity_events) == (n - 4, 0, 4)


def test_a_level_equal_to_its_limit_is_not_available() -> None:
    table = {"time_ns": np.arange(3) * 10**9, "hpl_m": [40.0, np.nextafter(40.0, 0), 1.0], "vpl_m": [1.0, 1.0, 50.0]}
    assert kpi.evaluate(table, "APV-I").levels[0].n_available == 1


def test_full_availability_leaves_a_lower_limit_below_one() -> None:
    rng = np.random.default_rng(1)
    n = 20_000
    table = {"time_ns": np.arange(n) * 10**9, "hpl_m": 10 + rng.random(n), "vpl_m": 20 + rng.random(n)}
    result = kpi.evaluate(table, "APV-I").levels[0]
    assert (result.availability_expected, result.availability_high) == (1.0, 1.0)
    # White levels: all epochs count; Wilson's lower limit is then n / (n + z²), z = 1.96. The size is estimated to some 10 %.
    assert n / 1.5 < result.n_effective <= n
    assert math.isclose(1 - result.availability_low, 1.96**2 / (result.n_effective + 1.96**2), rel_tol=1e-3)


def test_stanford_counts_hmi_apart() -> None:
    error = [1.0, 6.0, 60.0, -1.0, 80.0, float("nan"), 5.0]
    bound = [5.0, 5.0, 5.0, 55.0, 55.0, 5.0, 5.0]
    diagram = kpi.stanford(error, bound, 50.0)
    counts = diagram.counts
    assert [counts.n, counts.n_nominal, counts.n_mi, counts.n_hmi, counts.n_unavailable, counts.n_unavailable_mi] == [6, 2, 1, 1, 1, 1]
    bins = set(zip(diagram.bins.error_bin, diagram.bins.level_bin, diagram.bins.count, strict=True))
    assert bins == {(10, 50, 1), (60, 50, 1), (500, 50, 1), (10, 500, 1), (500, 500, 1), (50, 50, 1)}


def test_levels_carry_their_provenance() -> None:
    table = kpi.levels()
    assert table["APV-I"].provenance["hal_m"] == "standard"
    assert table["CAT-I-12"].provenance["val_m"] == "printed"
    assert all("Doc 9849" in value.source for value in table.values() if value.provenance["hal_m"] == "standard")
    assert table["APV-I"].provenance["tta_s"] == "inferred"
    own = kpi.rnp(0.3, tta_s=10.0)
    assert (own.hal_m, own.provenance["hal_m"]) == (0.3 * 1852.0, "inferred")
    assert kpi.evaluate(series(100), own).levels[0].level.id == "RNP 0.3"


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"time_ns": [0, 10**9]}, "a table with a column hpl_m"),
        ({"hpl_m": [1.0]}, "a table with a column time_ns"),
        ({"time_ns": [10**9, 0, 10**9], "hpl_m": [1.0, 1.0, 1.0]}, "time_ns[1]"),
        ({"time_ns": [0.5, 1.5], "hpl_m": [1.0, 1.0]}, "whole nanoseconds"),
        ({"time_ns": [0], "hpl_m": [1.0]}, "period_s"),
        ({"time_ns": [0, 10**9], "hpl_m": [1.0, 1.0], "nse_e_m": [0.0, np.inf]}, "nse_e_m[1]"),
        ({"time_ns": [0, 10**9], "hpl_m": ["a", "b"]}, "numbers"),
        ({"time_ns": [0, 10**9], "hpl_m": [1.0]}, "equal length"),
    ],
)
def test_a_table_that_is_none_is_refused(table: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words.replace("[", r"\[").replace("]", r"\]")):
        kpi.evaluate(table, "APV-I")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"levels": "APV-9"}, "APV-9"),
        ({"levels": ""}, "one level or more"),
        ({"levels": "NPA,NPA"}, "levels named once"),
        ({"period_s": float("nan")}, "period_s"),
        ({"bin_m": 0.0}, "bin_m"),
        ({"limit_m": float("inf")}, "limit_m"),
    ],
)
def test_arguments_outside_their_domain_are_refused(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        kpi.evaluate(series(100), **{"levels": "APV-I"} | arguments)


def test_a_level_that_cannot_be_one_counts_as_no_solution_and_is_noted() -> None:
    table = {"time_ns": np.arange(4) * 10**9, "hpl_m": [10.0, 0.0, np.inf, 10.0], "vpl_m": [10.0] * 4}
    result = kpi.evaluate(table, "APV-I")
    assert (result.n_no_solution, result.levels[0].n_available) == (2, 2)
    assert any("2 rows" in note for note in result.notes)


def test_other_tables_than_were_added_are_refused() -> None:
    table = series(1000)
    campaign = kpi.Campaign("APV-I", first=table, period_s=1.0)
    campaign.add(table)
    with pytest.raises(InputError, match="tallied"):
        campaign.finish(lambda: [table[:10]])
