"""The fault campaign: its kinds are flown, its counts are what they say, and its parts fit together."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from navbound import _core, scenario
from navbound.errors import InputError
from navbound.run import fly
from navbound.scenario import faults
from navbound.studies.fault_campaign import healthy, measures, records
from navbound.studies.fault_campaign import study as fault_campaign
from navbound.studies.fault_campaign.kinds import KINDS, ONSETS_S, Kind
from navbound.studies.fault_campaign.table import markdown
from navbound.studies.registry import STUDIES

PAGE = Path(__file__).parents[1] / "docs" / "methods" / "sensors.md"


def test_the_campaign_is_as_large_as_promised() -> None:
    assert len(KINDS) >= 40
    assert all(len(kind.sizes) == 6 for kind in KINDS)
    assert len(ONSETS_S) == 5
    assert fault_campaign.FLIGHTS == 5
    assert "fault-campaign" in STUDIES


def test_every_kind_of_sensor_fault_is_in_the_documentation_and_in_the_campaign() -> None:
    documented = PAGE.read_text(encoding="utf-8")
    flown = {f["kind"] for kind in KINDS for f in kind.change(kind.sizes[0], 100.0).get("faults", [])}
    for kind in faults.kinds():
        assert f"`{kind}`" in documented
        assert kind in flown


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.id)
def test_every_kind_can_be_flown_in_every_size(kind: Kind) -> None:
    """The core takes the scenario: names, units, limits."""
    base = scenario.load(fault_campaign.SCENARIO)
    for size in range(len(kind.sizes)):
        changed, onset_s = fault_campaign.faulty(base, fault_campaign.Tile(kind.id, size, 2, 1))
        _core.Sensors(changed.core_json(), None)
        assert onset_s in (*ONSETS_S, 0.0, ONSETS_S[2] - 120.0)


def test_counts_of_a_flight_are_what_they_say() -> None:
    """Forty seconds by hand: the fault at 35 s, wrong and ok for three seconds, then not ok; alerts at 33 s (false) and 39 s."""
    n = 40
    since = np.arange(n)
    error = np.where(since >= 36, 100.0, 1.0)
    status = np.where(since >= 39, "degraded", "ok")
    alert = np.where((since == 33) | (since >= 39), "caution", "normal")
    frame = pl.DataFrame(
        {
            "time_ns": since * 1_000_000_000,
            "status": status,
            "alert": alert,
            "reason": np.where(since >= 39, "satellites_inconsistent", ""),
            "nse_h_m": error,
            "nse_u_m": 0.0 * error,
            "tse_m": 0.0 * error,
            "rnp_m": np.full(n, 10.0),
            "hpl_m": np.full(n, 50.0),
            "vpl_m": np.full(n, 50.0),
            **{f"cov_{axis}_m2": np.full(n, value) for axis, value in (("ee", 1.0), ("en", 0.0), ("nn", 1.0), ("uu", 1.0))},
        }
    )
    counts = measures.measures(frame, 35.0)
    assert counts == {
        "n_epochs": 5.0,
        "n_ok": 4.0,
        "n_ok_wrong": 3.0,
        "n_normal": 4.0,
        "n_normal_wrong": 3.0,
        "n_late": 0.0,
        "healthy_s": 5.0,
        "n_false_alerts": 1.0,
        "healthy_not_ok_s": 0.0,
        "delay_s": 4.0,
        "error_most_m": 100.0,
        "reasons": "satellites_inconsistent",
    }
    # Without levels the covariance bounds it: 1 m at 1e-5 is less than 5 m. An error that nobody knows is not inside.
    alone = measures.measures(frame.drop("hpl_m", "vpl_m").with_columns(nse_h_m=pl.lit(float("nan"))), 35.0)
    assert alone["n_ok_wrong"] == 4.0
    outside = frame.with_columns(tse_m=pl.when(pl.col("time_ns") >= 20e9).then(99.0).otherwise(0.0), alert=pl.lit("normal"))
    # Outside from 20 s on: late from the eleventh second on, 31 s, so all five epochs after the fault.
    assert measures.measures(outside, 35.0)["n_late"] == 5.0


def test_the_interval_of_a_share_is_the_score_interval() -> None:
    # Wilson 1927 as tabulated by Newcombe (1998), table I: 81 of 263, and none of 20.
    assert records.wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert records.wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=5e-5)


def test_a_part_of_the_campaign_is_the_same_whoever_flies_it_and_goes_on_where_it_stopped(tmp_path: Path) -> None:
    part: dict[str, Any] = {"kinds": ["imu-nan", "satellite-step"], "sizes": [3], "onsets": [2], "flights": 1}
    serial = fault_campaign.run(**part, checkpoint=tmp_path)
    done: list[tuple[int, int]] = []
    again = fault_campaign.run(**part, checkpoint=tmp_path, progress=lambda i, n: done.append((i, n)))
    processes = fault_campaign.run(**part, backend="processes")
    assert done == [(3, 3)]
    assert serial == again == processes
    assert [row.kind for row in serial.rows] == ["imu-nan", "satellite-step"]
    assert "satellite-step" in markdown(serial)


def test_a_single_fault_of_each_family_is_never_ok_and_wrong() -> None:
    """A small part, flown in full; the whole is in docs/methods/fused-integrity.md."""
    part = fault_campaign.run(
        kinds=["imu-nan", "accelerometer-x-step", "receiver-one-name", "satellite-step"], sizes=[4], onsets=[2], flights=1
    )
    assert part.single.epochs == 0.0
    assert part.healthy.false_alerts == 0


def test_a_diverged_flight_is_a_result_with_every_second() -> None:
    """Accelerometers wrong by 20 g, without satellites and stations: the estimate is 5000 km from the path after four minutes."""
    changed, _ = fault_campaign.faulty(scenario.load(fault_campaign.SCENARIO), fault_campaign.Tile("outage-and-accelerometer", 5, 1, 1))
    data = changed.model_dump()
    data["sensors"]["stations"] = []
    data["sensors"]["faults"][1]["accelerometer_mps2"] = [100.0, 0.0, 0.0]
    data["sensors"]["faults"].append(data["sensors"]["faults"][1] | {"start_s": 100.0})
    material = fly.material(scenario.Scenario.model_validate(data), flights=2)
    for _, frame in material.epochs.group_by("track", maintain_order=True):
        assert frame.height == 900
        lost = frame.filter(pl.col("est_lat_rad").is_null())
        assert lost.height > 0
        assert set(lost["status"]) == {"not_available"}
        assert lost["reason"].null_count() == 0
    assert material.epochs.height == 1800


def test_unknown_parts_are_refused_by_name() -> None:
    with pytest.raises(InputError, match="kinds"):
        fault_campaign.run(kinds=["nothing"])
    with pytest.raises(InputError, match="onsets"):
        fault_campaign.run(kinds=["imu-nan"], onsets=[9])


def test_healthy_flights_are_counted_whole_and_are_the_same_whoever_flies_them(tmp_path: Path) -> None:
    """Five flights of 900 s, of which 870 s count."""
    first = healthy.run(hours=1.25, seed=5, checkpoint=tmp_path)
    assert first == healthy.run(hours=1.25, seed=5, backend="processes")
    assert first.flights == 5
    assert first.healthy.hours == pytest.approx(5 * 870 / 3600)
    assert first.n_ok + round(first.healthy.not_ok_share * 5 * 870) >= 5 * 870
    assert first.n_ok_wrong == first.healthy.false_alerts == 0


@pytest.mark.parametrize("hours", [0.0, float("nan"), 2e5])
def test_hours_without_a_meaning_are_refused(hours: float) -> None:
    with pytest.raises(InputError, match="hours"):
        healthy.run(hours=hours)
