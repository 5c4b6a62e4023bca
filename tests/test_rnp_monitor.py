"""The RNP monitor: what may feed it, time that goes wrong, loss of monitoring, protection levels."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from navbound import InputError, methods, rnp
from navbound.records.material import Material
from navbound.records.run import CovarianceOrigin
from navbound.run import analyze
from navbound.run import judge as judging
from navbound.run.settings import Settings
from test_rnp import PERIOD_NS, table

RNP_M = 500.0
STALE_S, RAISE_S = 2, 3


def alerts(bounds: list[float], **columns: object) -> list[str]:
    """Alert of each row, the integrity bound inside unless it is given."""
    return rnp.Monitor().run(table(tse_exact_m=bounds, **({"tse_exact_integrity_m": [300.0] * len(bounds)} | columns))).alert.to_list()


def test_ten_unusable_epochs_end_in_the_alert_that_the_next_one_deserves() -> None:
    status = ["ok"] * 3 + ["not_available"] * 10 + ["ok"] * 3
    assert alerts([100.0] * 3 + [math.nan] * 10 + [980.0] * 3, status=status)[12:] == ["unavailable"] + ["caution"] * 3
    assert alerts([100.0] * 3 + [math.nan] * 10 + [490.0] * 3, status=status)[12:] == ["unavailable"] + ["normal"] * 3


def test_a_warning_ends_in_caution_while_the_accuracy_bound_is_outside() -> None:
    shown = alerts([100.0] * 11 + [600.0] * 9, tse_exact_integrity_m=[1300.0] + [100.0] * 19)
    assert shown == ["warning"] * 11 + ["caution"] * 9


def test_three_epochs_of_four_outside_alert_after_four_seconds() -> None:
    shown = alerts([100.0] + [600.0, 600.0, 600.0, 100.0] * 100)
    assert shown[:5] == ["normal"] * 5
    assert set(shown[5:]) == {"caution"}


@pytest.mark.parametrize("rnp_m", [math.inf, 0.0, -1.0, math.nan])
def test_what_is_no_rnp_value_never_gives_normal(rnp_m: float) -> None:
    for bound in (0.0, 100.0, math.inf):
        run = rnp.Monitor().run(table(tse_exact_m=[bound] * 5, tse_exact_integrity_m=[bound] * 5, rnp_m=[rnp_m] * 5))
        assert "normal" not in run.alert.to_list()
        assert run.counters.n_nan == 5


@pytest.mark.parametrize(
    "seconds",
    [[5000] * 3600, range(4999, 4000, -1), [10] * 1000, [10, 11] * 500],
    ids=["stuck", "backwards", "set back and stuck", "to and fro"],
)
def test_time_that_does_not_advance_is_silence(seconds: list[int]) -> None:
    n = len(seconds)
    run = rnp.Monitor().run(
        table(
            time_ns=[5000 * PERIOD_NS, *(s * PERIOD_NS for s in seconds)],
            tse_exact_m=[100.0] + [5000.0] * n,
            tse_exact_integrity_m=[100.0] + [5000.0] * n,
        )
    )
    # What is outside and no older than the stale time (2 s) contradicts the first record at once.
    stuck = 5000 - seconds[0] <= 2
    assert run.alert.to_list() == ["normal", *(["warning" if stuck else "normal"] * 2), *["unavailable"] * (n - 2)]
    events = [(kind, 5000 * PERIOD_NS, None) for kind in (["warning"] if stuck else []) + ["unavailable"]]
    assert run.events.select("kind", "onset_ns", "clear_ns").rows() == events


def test_a_stamp_far_ahead_does_not_hide_the_silence_after_it() -> None:
    monitor = rnp.Monitor()
    monitor.step({"time_ns": 1000 * PERIOD_NS, "rnp_m": RNP_M, "tse_exact_m": 1.0, "tse_exact_integrity_m": 1.0})
    shown = [monitor.tick(second * PERIOD_NS) for second in range(1, 1100)]
    assert shown == ["normal"] * 3 + ["unavailable"] * 1096


def test_a_step_reports_what_began_also_where_it_ended() -> None:
    monitor = rnp.Monitor()
    record = {"rnp_m": RNP_M, "tse_exact_m": 1.0, "tse_exact_integrity_m": 1.0}
    assert monitor.tick(0) == "unavailable"
    assert monitor.step(record | {"time_ns": 0}).began == []
    step = monitor.step(record | {"time_ns": 60 * PERIOD_NS, "tse_exact_integrity_m": 1200.0})
    assert [(e.kind, e.onset_ns, e.annunciation_ns) for e in step.began] == [
        ("warning", 0, 60 * PERIOD_NS),
        ("unavailable", 0, STALE_S * PERIOD_NS),
    ]
    assert [e.kind for e in step.ended] == ["unavailable"]


def random_records(rng: np.random.Generator, n: int) -> list[dict[str, Any]]:
    """Runs of one kind of epoch, mostly a period apart: inside, in the band, outside, NaN, unusable; RNP at times halved."""
    kinds = [(400.0, 200.0), (490.0, 980.0), (600.0, 200.0), (200.0, 1100.0), (math.nan, math.nan)]
    records: list[dict[str, Any]] = []
    second, kind, restless, strange = 0, 0, rng.uniform(0.05, 0.6), rng.uniform(0.01, 0.3)
    for _ in range(n):
        if rng.random() < restless:
            kind = int(rng.integers(len(kinds)))
        second += int(rng.choice([0, 1, 5, -4])) if rng.random() < strange else 1
        accuracy, integrity = kinds[kind]
        records.append(
            {
                "time_ns": second * PERIOD_NS,
                "tse_exact_m": accuracy,
                "tse_exact_integrity_m": integrity,
                "rnp_m": RNP_M / 2 if rng.random() < 0.1 else RNP_M,
                "status": "not_available" if rng.random() < 0.1 else "ok",
            }
        )
    return records


def forbids_normal(records: list[dict[str, Any]], shown: list[str], judged: list[bool]) -> set[str]:
    """The rules that `normal` at the last record would break, from the whole history; not the state machine."""

    def inside(record: dict[str, Any], share: float = 1.0) -> bool:
        limit = share * record["rnp_m"]
        return bool(record["status"] == "ok" and record["tse_exact_m"] <= limit and record["tse_exact_integrity_m"] <= 2 * limit)

    counted = [r for r, j in zip(records, judged, strict=True) if j]
    newest = counted[-1]
    dropped = len(records) - 1 - max(k for k, j in enumerate(judged) if j)
    before = shown[-1] if shown else "unavailable"
    latest = counted[-RAISE_S - 1 :]
    steady = all(b["time_ns"] - a["time_ns"] == PERIOD_NS for a, b in itertools.pairwise(latest))
    # A dropped record decides nothing but by its number.
    here = dropped == 0
    rules = {
        "the last epoch is not usable": newest["status"] != "ok",
        "all records since are dropped": dropped > STALE_S,
        "integrity is outside": here and not newest["tse_exact_integrity_m"] <= 2 * newest["rnp_m"],
        "accuracy was outside for the wait": here and len(latest) > RAISE_S and steady and not any(inside(r) for r in latest),
        "only an epoch inside ends in normal": here and before != "normal" and not inside(newest),
        "an alert ends only calm": here and before in ("caution", "warning") and not inside(newest, 0.95),
    }
    return {rule for rule, broken in rules.items() if broken}


def test_random_sequences_are_never_normal_against_the_rules() -> None:
    rng = np.random.default_rng(20260101)
    met: set[str] = set()
    n_normal = 0
    for _ in range(200):
        records = random_records(rng, 150)
        monitor = rnp.Monitor()
        shown: list[str] = []
        judged: list[bool] = []
        for k, record in enumerate(records):
            step = monitor.step(record)
            judged.append(step.acceptance == "accepted")
            broken = forbids_normal(records[: k + 1], shown, judged)
            assert not broken or step.alert != "normal", f"{broken}: {records[: k + 1]}"
            met |= broken
            n_normal += step.alert == "normal"
            shown.append(step.alert)
        assert rnp.Monitor().run(pl.DataFrame(records)).alert.to_list() == shown
    assert len(met) == 6, "every rule was put to the test"
    assert n_normal > 500, "nor do they forbid everything"


# ---------------------------------------------------------------------------------------------------------------- what may feed it


@pytest.mark.parametrize("argument", ["accuracy", "integrity"])
@pytest.mark.parametrize("name", ["tse-ltem-as-printed", "tse_ltem_as_printed_m", "renamed", "ee_bound_h_m", "tse_exact_m"])
def test_what_may_not_alert_is_refused_by_whatever_name(name: str, argument: str) -> None:
    columns = {"renamed": [1.0, 1.0], "ee_bound_h_m": [1.0, 1.0]}
    columns |= {"tse_ltem_as_printed_m": [1.0, 1.0], "tse_ltem_as_printed_integrity_m": [1.0, 1.0]}
    frame = table(tse_exact_m=[1.0, 1.0], tse_exact_integrity_m=[1.0, 1.0], **columns)
    monitor = rnp.Monitor()
    with pytest.raises(InputError, match=f"{argument} = {name}.*may feed an alert, of tse-exact"):
        monitor.run(frame, **{argument: name})
    with pytest.raises(InputError, match=f"{argument} = {name}.*may feed an alert, of tse-exact"):
        monitor.step(frame.row(0, named=True), **{argument: name})
    assert monitor.counters.n_accepted == 0


def test_an_experimental_column_reaches_no_alert_as_a_deviation(tmp_path: Path) -> None:
    """Nor may it under a name of the epoch table, from which bounds are worked out."""
    rows = pl.DataFrame(
        {"time_ns": [k * PERIOD_NS for k in range(5)], "lat_deg": [50.0] * 5, "lon_deg": [8.0] * 5, "ee_noise_h_m": [0.1] * 5}
    )
    rows.write_csv(tmp_path / "track.csv")
    columns = {"sigma_e_m": "ee_noise_h_m", "sigma_n_m": "ee_noise_h_m"}
    with pytest.raises(InputError, match=r"sigma_e_m from ee_noise_h_m.*may feed an alert.*experimental, not integrity"):
        analyze.material(tmp_path / "track.csv", requirement="RNP 0.3", rnp_m=555.6, columns=columns)


def test_every_method_that_may_alert_feeds_the_monitor_and_no_other() -> None:
    accepted = set()
    for m in methods.methods().values():
        record = {"time_ns": 0, "rnp_m": RNP_M, m.column: 1.0, m.integrity_column: 1.0}
        try:
            accepted.add((m.id, rnp.Monitor().step(record, accuracy=m.id).alert))
        except InputError:
            assert not m.may_alert
    assert accepted == {(m.id, "normal") for m in methods.methods().values() if m.may_alert}


# ---------------------------------------------------------------------------------------------------------------- protection levels


def test_integrity_compares_the_larger_of_the_bound_and_deviation_with_level() -> None:
    run = rnp.Monitor().run(
        table(
            tse_exact_m=[100.0] * 4,
            tse_exact_integrity_m=[300.0, 300.0, 300.0, 990.0],
            fte_m=[-200.0, -200.0, 0.0, 0.0],
            hpl_m=[700.0, 900.0, 100.0, 100.0],
        )
    )
    assert run.integrity_compared_m.to_list() == [900.0, 1100.0, 300.0, 990.0]
    assert run.alert.to_list() == ["normal"] + ["warning"] * 3


def test_a_missing_level_never_makes_the_comparison_better() -> None:
    levels = [None, 200.0, None, 200.0]
    columns = {"tse_exact_m": [100.0] * 4, "tse_exact_integrity_m": [300.0] * 4, "fte_m": [0.0] * 4}
    run = rnp.Monitor().run(table(**columns, hpl_m=levels))
    # The track has a source of levels, so each of its epochs should have one.
    assert run.integrity_compared_m.to_list() == [None, 300.0, None, 300.0]
    assert run.alert.to_list() == ["warning"] * 4
    # So it is epoch by epoch: a record with the key declares levels.
    monitor = rnp.Monitor()
    shown = [monitor.step(row).alert for row in table(**columns, hpl_m=levels).to_dicts()]
    assert shown == ["warning"] * 4
    # A track without any level is judged by the bound alone where it is named so, beside one that has them; else its levels are missing.
    beside = table(**columns, track=["a", "b", "a", "b"], hpl_m=[None, 200.0, None, 200.0])
    assert rnp.Monitor().run(beside).alert.to_list() == ["warning", "normal"] * 2
    assert rnp.Monitor().tracks({"a": False, "b": True}).judge(beside)[0].to_list() == ["normal"] * 4


@pytest.mark.parametrize("level", [None, math.nan])
def test_a_level_that_is_missing_from_the_first_epoch_on_alerts(level: float | None) -> None:
    record = {"time_ns": 0, "rnp_m": RNP_M, "tse_exact_m": 10.0, "tse_exact_integrity_m": 20.0, "fte_m": 0.0}
    assert rnp.Monitor().step(record).alert == "normal", "a source whose records never have a level"
    assert rnp.Monitor().step(record | {"hpl_m": level}).alert == "warning"
    # Nothing vouches for a degraded epoch: none is due, and its bound is what there is.
    assert rnp.Monitor().step(record | {"hpl_m": level, "status": "degraded"}).alert == "normal"
    monitor = rnp.Monitor()
    assert monitor.step(record | {"hpl_m": 30.0}).alert == "normal"
    assert monitor.step(record | {"time_ns": PERIOD_NS}).alert == "warning", "the key went missing"
    assert (
        rnp.Monitor()
        .run(table(**{name: [value] * 3 for name, value in record.items() if name not in {"time_ns", "rnp_m"}}, hpl_m=[level] * 3))
        .alert.to_list()
        == ["warning"] * 3
    )


def test_a_judged_run_hands_the_larger_one_to_the_monitor() -> None:
    n = 40
    epochs = pl.DataFrame(
        {
            "track": ["a"] * n,
            "time_ns": [k * PERIOD_NS for k in range(n)],
            "est_lat_rad": [0.8] * n,
            "est_lon_rad": [0.1] * n,
            "course_rad": [0.0] * n,
            "fte_m": [100.0] * n,
            "rnp_m": [RNP_M] * n,
            "cov_ee_m2": [25.0] * n,
            "cov_en_m2": [0.0] * n,
            "cov_nn_m2": [25.0] * n,
            "status": ["ok"] * n,
            "reason": pl.Series([None] * n, dtype=pl.String),
            "hpl_m": [40.0] * 20 + [950.0] * 20,
        }
    )
    origin = CovarianceOrigin(id="file")
    material = Material(epochs, "analyze", "levels", "RNP", 1.0, [], origin)
    run = judging.judge(material, Settings(methods=()))
    assert run.epochs["alert"].to_list() == ["normal"] * 20 + ["warning"] * 20
    assert run.epochs["integrity_compared_m"].to_list()[20:] == [1050.0] * 20
    assert run.epochs["tse_exact_integrity_m"].max() < 200.0  # type: ignore[operator]
    verdict = run.summary.verdict
    assert verdict.inside is False
    assert verdict.share_contained == 0.5
    without = judging.judge(Material(epochs.drop("hpl_m"), "analyze", "levels", "RNP", 1.0, [], origin), Settings(methods=()))
    assert set(without.epochs["alert"]) == {"normal"}
    assert "integrity_compared_m" not in without.epochs.columns
    lost = judging.judge(
        Material(epochs.with_columns(hpl_m=pl.Series([40.0] * 39 + [None])), "analyze", "levels", "RNP", 1.0, [], origin),
        Settings(methods=()),
    )
    assert lost.summary.verdict.inside is False, "an epoch whose level is missing is not contained"


@pytest.mark.parametrize(("repeat_m", "ends_s"), [(None, 16), (475.0, 16), (480.0, 16), (500.0, 16), (501.0, 23)])
def test_only_a_repeat_outside_its_limit_begins_the_wait_to_clear_again(repeat_m: float | None, ends_s: int) -> None:
    # Calm from second 6 on ends ten seconds later; after a repeat outside at second 12 the first calm epoch is that of second 13.
    monitor, shown = rnp.Monitor(), list[str]()

    def step(second: int, bound_m: float) -> str:
        bounds = {"tse_exact_m": bound_m, "tse_exact_integrity_m": bound_m}
        return monitor.step({"time_ns": second * PERIOD_NS, "status": "ok", "rnp_m": RNP_M} | bounds).alert

    for second in range(30):
        shown.append(step(second, 600.0 if second < 6 else 450.0))
        if second == 12 and repeat_m is not None:
            step(second, repeat_m)
    assert shown[6] == "caution"
    assert shown.index("normal", 6) == ends_s
