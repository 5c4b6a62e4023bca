"""One epoch, one step: a table at once, in pieces and epoch by epoch gives the same bits in every column and every event."""

from __future__ import annotations

import math
import random
from collections import defaultdict
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl
import pytest

from navbound import InputError, rnp, scenario
from navbound.judge import Judge, Judged, Judges, Settings, with_levels
from navbound.methods import methods
from navbound.run import fly
from navbound.run.judge import judge
from navbound.status import STATUSES

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

JUDGING = ("tse-exact", "anp-circle", "tse-vertical", "anp-cross")
"""One that bounds the error across the path, and others of each kind."""
EVERY = [m.id for m in methods().values()]


def settings(method: str = "tse-exact", *, raise_delay_s: float = 3.0, beside: Sequence[str] = ("tse-ltem", "anp-circle")) -> Settings:
    monitor = rnp.Monitor(time_to_alert_s=math.inf, raise_delay_s=raise_delay_s)
    return Settings(monitor, method=method, beside=beside, states=rnp.StateClassifier((0.05, 0.3, 1.0, 2.0)))


@pytest.mark.parametrize("course_rad", [270.0, -6.3, math.inf])
def test_a_course_beyond_one_turn_is_refused(course_rad: float) -> None:
    epoch = {"time_ns": 10**18, "fte_m": 20.0, "rnp_m": 555.6, "cov_ee_m2": 1.0, "cov_en_m2": 0.0, "cov_nn_m2": 5e5}
    with pytest.raises(InputError, match=r"course_rad.*2 pi.*degrees\?"):
        Judge(settings()).step({**epoch, "course_rad": course_rad})
    assert Judge(settings()).step({**epoch, "course_rad": math.tau}).status == "ok"


def test_a_covariance_of_zero_is_degraded_and_says_why() -> None:
    epoch = {"time_ns": 10**18, "fte_m": 20.0, "course_rad": 0.0, "rnp_m": 555.6, "cov_ee_m2": 0.0, "cov_en_m2": 0.0, "cov_nn_m2": 0.0}
    judged = Judge(settings()).step(epoch)
    assert (judged.status, judged.reason_id) == ("degraded", "zero_covariance")
    assert Judge(settings()).step({**epoch, "status": "not_available"}).reason_id is None


def damaged(seed: int, n: int = 3000) -> pl.DataFrame:
    """Three tracks mixed in time, whose errors and deviations come and go over minutes; lost values, variances below zero, repeats, steps
    back and gaps, levels in two of the tracks."""
    generator = np.random.default_rng(seed)
    k = np.arange(n)
    sigma = np.exp(3.0 + 2.0 * np.sin(k / 150.0 + seed))
    share = generator.uniform(-0.9, 0.9, n)
    track = k % 3
    step_s = generator.choice([1.0 / 3.0, 0.0, 0.1, 9.0, -0.6, -30.0], n, p=[0.97, 0.01, 0.01, 0.004, 0.004, 0.002])

    def seldom(probability: float) -> Any:
        return generator.uniform(size=n) < probability

    columns: dict[str, Any] = {
        "track": np.array(["b", "a", "c"])[track],
        "time_ns": (1e18 + np.cumsum(step_s) * 1e9).astype(np.int64),
        "status": np.where(seldom(0.01), generator.choice(list(STATUSES), n), "ok"),
        "course_rad": generator.uniform(-4.0, 6.2, n),
        "path_angle_rad": generator.uniform(-0.1, 0.1, n),
        "fte_m": generator.normal(0.0, 10.0, n) + 400.0 * np.sin(k / 210.0) ** 5,
        "fte_v_m": generator.normal(0.0, 5.0, n) + 400.0 * np.sin(k / 310.0) ** 5,
        "rnp_m": np.where(seldom(0.003), generator.choice([0.0, -1.0, np.inf], n), np.where(k % 900 < 450, 185.2, 555.6)),
        "cov_ee_m2": sigma**2,
        "cov_en_m2": share * sigma * 20.0,
        "cov_nn_m2": np.full(n, 400.0),
        "cov_eu_m2": np.zeros(n),
        "cov_nu_m2": np.zeros(n),
        "cov_uu_m2": np.full(n, 900.0),
        **{f"nse_{axis}_m": generator.normal(0.0, 60.0, n) for axis in "enu"},
        "hpl_m": np.where((track > 0) & ~seldom(0.01), generator.uniform(1.0, 200.0, n), np.nan),
    }
    for name, values in list(columns.items()):
        if name.startswith(("course", "path", "fte", "rnp", "cov", "nse")):
            columns[name] = np.where(seldom(0.002), np.nan, values)
    columns["cov_ee_m2"] = np.where(seldom(0.005), -4.0, columns["cov_ee_m2"])
    return pl.DataFrame(columns).with_columns(pl.col(pl.Float64).fill_nan(None))


def at_once(rules: Settings, table: pl.DataFrame) -> tuple[pl.DataFrame, pl.DataFrame, rnp.Counters]:
    return in_pieces(rules, table, ())


def in_pieces(rules: Settings, table: pl.DataFrame, cuts: Iterable[int]) -> tuple[pl.DataFrame, pl.DataFrame, rnp.Counters]:
    judges = Judges(rules, with_levels(table))
    judged = pl.concat([judges.judge(table[begin:end]) for begin, end in pairwise([0, *cuts, table.height])])
    events, counters, _ = judges.decided()
    return judged, events, counters


def by_steps(
    rules: Settings, table: pl.DataFrame, *, restarts: random.Random | None = None
) -> tuple[list[Judged], dict[str, list[rnp.Event]]]:
    """Every row by the judge of its track, which is written and read again now and then."""
    levels = with_levels(table)
    judges = {track: Judge(rules, with_levels=has) for track, has in levels.items()}
    judged: list[Judged] = []
    events: dict[str, list[rnp.Event]] = defaultdict(list)
    for row in table.iter_rows(named=True):
        track = row["track"]
        if restarts is not None and restarts.random() < 0.05:
            judges[track] = Judge.from_bytes(judges[track].to_bytes(), rules, with_levels=levels[track])
        judged.append(judges[track].step(row))
        events[track] += judged[-1].ended
    for track, one in judges.items():
        events[track] += one.open_events
    return judged, events


def bits(column: pl.Series) -> Any:
    """Values whose equality is that of every bit, null beside NaN and the sign of a zero included."""
    if column.dtype == pl.Float64:
        return [None if x is None else np.float64(x).tobytes() for x in column.to_list()]
    return column.to_list()


def assert_same_bits(one: pl.DataFrame, other: pl.DataFrame) -> None:
    assert one.schema == other.schema
    for name in one.columns:
        assert bits(one[name]) == bits(other[name]), name


def assert_same_steps(table: pl.DataFrame, steps: list[Judged]) -> None:
    numbers = [name for name in steps[0].numbers if name in table.columns]
    assert len(numbers) > 10, "the table has hardly a number of the steps: this would prove nothing"
    for name in numbers:
        assert bits(table[name]) == bits(pl.Series([step.numbers[name] for step in steps], dtype=pl.Float64)), name
    for name in ("status", "alert", "state"):
        if name in table.columns:
            assert table[name].to_list() == [getattr(step, name) for step in steps], name
    new = [(row, step) for row, step in zip(table.select("reason_id", "reason").rows(), steps, strict=True) if step.reason_id]
    assert all(row == (step.reason_id, step.reason) for row, step in new)


def assert_same_events(events: pl.DataFrame, by_track: dict[str, list[rnp.Event]]) -> None:
    for track, value in by_track.items():
        rows = events.filter(pl.col("track") == track).drop("track").rows()
        # Text, in which every bit of a number is seen; the table has a null for a NaN.
        stated = [tuple(None if isinstance(x, float) and math.isnan(x) else x for x in event) for event in value]
        assert sorted(map(repr, rows)) == sorted(map(repr, stated))


@pytest.mark.parametrize("method", JUDGING)
def test_at_once_in_pieces_and_epoch_by_epoch_are_the_same_bits(method: str) -> None:
    table, rules = damaged(5, 900), settings(method)
    whole, events, counters = at_once(rules, table)
    # At every seventh row, and before every row of the middle third.
    middle = range(300, 600)
    assert {"normal", "unavailable"} < set(whole["alert"][300:600]), "rows in which hardly anything happens prove nothing"
    for cuts in (range(7, 900, 7), middle):
        judged, its_events, its_counters = in_pieces(rules, table, cuts)
        assert_same_bits(whole, judged)
        assert_same_bits(events, its_events)
        assert its_counters == counters
    for restarts in (None, random.Random(7)):
        steps, by_track = by_steps(rules, table, restarts=restarts)
        assert_same_steps(whole, steps)
        assert_same_events(events, by_track)


def test_every_method_of_the_list_gives_an_epoch_the_bits_of_the_table() -> None:
    table, rules = damaged(2, 90), settings(beside=EVERY)
    whole, _, _ = at_once(rules, table)
    assert len(rules.columns) > 2 * len(EVERY)
    assert_same_steps(whole, by_steps(rules, table)[0])


@pytest.mark.parametrize("seed", range(3))
def test_many_epochs_are_the_same_bits_with_restarts_anywhere(seed: int) -> None:
    table, rules = damaged(seed, 2000), settings(raise_delay_s=float(seed))
    whole, events, _ = at_once(rules, table)
    steps, by_track = by_steps(rules, table, restarts=random.Random(seed))
    assert set(whole["alert"]) == {"normal", "caution", "warning", "unavailable"}
    assert set(whole["reason_id"].drop_nulls()) == {"missing_field", "invalid_number"}
    assert whole["state"].n_unique() > 3
    assert_same_steps(whole, steps)
    assert_same_events(events, by_track)


def test_a_flight_is_its_epochs_one_after_the_other() -> None:
    material = fly.material(scenario.load("beijing-shanghai-jammed"), seed=1, flights=1)
    run = judge(material)
    monitor = rnp.Monitor(sample_period_s=material.sample_period_s, time_to_alert_s=math.inf)
    rules = Settings(monitor, beside=["tse-ltem"], states=rnp.StateClassifier((0.3, 1.0, 2.0, 5.0)))
    steps, by_track = by_steps(rules, material.epochs, restarts=random.Random(3))
    assert_same_steps(run.epochs, steps)
    alerts = run.events.filter(pl.col("kind").is_in(["caution", "warning", "unavailable"])).drop("words")
    assert_same_events(alerts, by_track)


def test_a_step_says_what_began_and_what_ended() -> None:
    one = Judge(settings(raise_delay_s=0.0), with_levels=False)
    row = next(damaged(1).filter(pl.all_horizontal(pl.all().exclude("hpl_m").is_not_null())).iter_rows(named=True))
    inside = {**row, "status": "ok", "hpl_m": None, "fte_m": 0.0, "cov_ee_m2": 4.0, "cov_nn_m2": 4.0, "cov_en_m2": 0.0, "rnp_m": 185.2}
    times = {"time_ns": 10**18}
    assert one.step(inside | times).began == []
    times["time_ns"] += 10**9
    outside = one.step(inside | times | {"fte_m": 300.0})
    # 300 m is beyond RNP 185.2 m and within its double less the bound of 2 m deviations.
    assert (outside.alert, [(e.kind, e.onset_ns, e.clear_ns) for e in outside.began]) == ("caution", [("caution", times["time_ns"], None)])
    times["time_ns"] += 20 * 10**9
    after = one.step(inside | times | {"fte_m": 300.0})
    assert [e.kind for e in after.began] == ["unavailable"] == [e.kind for e in after.ended], "a silence that this epoch ends"
    times["time_ns"] += 10**9
    lost = one.step(inside | times | {"course_rad": None})
    assert (lost.status, lost.reason_id, [e.kind for e in lost.began]) == ("not_available", "missing_field", ["unavailable"])
    assert one.tick(times["time_ns"] + 10**9) == ("unavailable", None)


def test_a_state_of_another_place_is_refused() -> None:
    rules = settings()
    state = Judge(rules).to_bytes()
    assert Judge.from_bytes(state, rules).to_bytes() == state
    for at in (0, 1, len(state) // 2, len(state) - 1):
        changed = bytearray(state)
        changed[at] ^= 16
        with pytest.raises(InputError, match="checksum"):
            Judge.from_bytes(bytes(changed), rules)
    with pytest.raises(InputError, match="number of bytes"):
        Judge.from_bytes(state[:-1], rules)
    others = [settings("anp-circle"), settings(raise_delay_s=1.0), Settings(rnp.Monitor(time_to_alert_s=math.inf), risk_accuracy=0.01)]
    for other, field in zip(others, ("method", "monitor", "risk_accuracy"), strict=True):
        with pytest.raises(InputError, match=field):
            Judge.from_bytes(state, other)


@pytest.mark.parametrize(
    ("change", "argument"),
    [({"time_ns": None}, "time_ns"), ({"time_ns": 2**63}, "time_ns"), ({"status": "fine"}, "status"), ({"fte_m": "far"}, "fte_m")],
)
def test_an_epoch_that_is_none_is_refused_by_name(change: dict[str, Any], argument: str) -> None:
    row = next(damaged(1).iter_rows(named=True))
    with pytest.raises(InputError) as refusal:
        Judge(settings()).step(row | change)
    assert refusal.value.argument == argument


def test_a_bound_that_may_not_alert_judges_nothing() -> None:
    exhibit = next(m.id for m in methods().values() if not m.may_alert)
    with pytest.raises(InputError, match="may feed an alert"):
        Settings(rnp.Monitor(), method=exhibit)


def test_a_table_with_an_unknown_status_or_track_is_refused() -> None:
    table = damaged(1, 30)
    judges = Judges(settings(), {"b": True, "a": True})
    with pytest.raises(InputError, match="named before"):
        judges.judge(table)
    with pytest.raises(InputError, match="fine"):
        judges.judge(table.with_columns(pl.lit("fine").alias("status")))
    with pytest.raises(InputError, match="tables with time_ns"):
        judges.judge(table.drop("time_ns"))


def test_a_level_that_is_missing_from_the_first_epoch_on_warns() -> None:
    epoch = {"time_ns": 0, "rnp_m": 555.6, "course_rad": 0.0, "fte_m": 1.0, "cov_ee_m2": 4.0, "cov_en_m2": 0.0, "cov_nn_m2": 4.0}
    assert Judge(settings()).step(epoch).alert == "normal"
    assert Judge(settings()).step(epoch | {"hpl_m": 40.0}).alert == "normal"
    assert [Judge(settings()).step(epoch | {"hpl_m": level}).alert for level in (None, math.nan)] == ["warning", "warning"]
    assert Judge(settings(), with_levels=True).step(epoch).alert == "warning"
    assert Judge(settings(), with_levels=False).step(epoch | {"hpl_m": None}).alert == "normal"


@pytest.mark.parametrize(
    ("key", "words"),
    [("fte", "fte_m"), ("cov_ee", "cov_ee_m2"), ("HPL_M", "epoch table"), ("alert_flag", "epoch table"), (7, "epoch table")],
)
def test_a_key_that_nothing_knows_is_refused_by_its_name(key: Any, words: str) -> None:
    epoch = {"time_ns": 10**18, "course_rad": 0.0, "fte_m": 0.0, "rnp_m": 185.2, "cov_ee_m2": 9.0, "cov_en_m2": 0.0, "cov_nn_m2": 9.0}
    assert Judge(settings()).step(epoch).status == "ok"
    # A row of the epoch table has columns that are not judged.
    assert Judge(settings()).step(epoch | {"track": "a", "est_lat_rad": 0.8}).status == "ok"
    with pytest.raises(InputError, match=str(key)) as refusal:
        Judge(settings()).step(epoch | {key: 900.0})
    assert words in str(refusal.value)
    assert "hpl_m" in str(refusal.value)
