"""Speed of navbound.ins: mechanization, and the filter with the covariance propagated at every sample, on one core.

The cost does not depend on the motion: a unit at rest serves, as in the peers' measurement (an hour at 200 Hz with 1 Hz fixes).
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import numpy as np

from clock import Row, seconds, show
from navbound import ins

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import ins_fixture as body


def fixes(time_ns: np.ndarray) -> ins.Fixes:
    """The place, to 1 m, once a second."""
    return ins.Fixes(time_ns, np.tile(body.PLACE, (time_ns.size, 1)), np.tile(np.eye(3), (time_ns.size, 1, 1)))


def stations(time_ns: np.ndarray) -> ins.DmeRanges:
    """Slant ranges to four places 60 km away, once a second."""
    places = body.place_ecef(6e4 * np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]))
    slant = np.full(4 * time_ns.size, 6e4)
    return ins.DmeRanges(np.repeat(time_ns, 4), np.tile(np.arange(4), time_ns.size), np.tile(places, (time_ns.size, 1)), slant, 157.0, 93.0)


def measure() -> list[Row]:
    """One row a measurement."""
    quarter = body.standing(1, 900.0, 200)
    n = quarter.time_ns.size
    second = quarter.time_ns[199::200]
    baro = ins.BaroHeights(second, body.PLACE[2], 5.0, 30.0, 3600.0)
    # Clock, drift, an inter-system bias, barometer and two satellites' biases: 21 states, and 9 more satellites without any.
    few = body.satellites(1, second, white_m=3.0, slow_m=0.0, tau_s=100.0, n=6)
    slow = np.where(np.arange(6 * second.size) % 6 < 2, 5.0, 0.0)
    six = ins.SatelliteRanges(few.time_ns, few.satellite, few.position_ecef_m, few.velocity_ecef_mps, few.range_m, 3.0, slow, 100.0)
    cases = [
        ("ins fuse, 15 states, 200 Hz", ins.Aiding(fixes=fixes(second)), 15, 1.5e-6),
        ("ins fuse, 21 states, 200 Hz", ins.Aiding(satellites=six, baro=baro), 21, 2e-6),
    ]
    mechanized = seconds(lambda: ins.mechanize(quarter.imu, quarter.start), 3) / n
    rows = [Row("ins mechanize, 200 Hz", mechanized, n, "a sample, results at every sample")]
    for name, aiding, states, goal_s in cases:
        fused = ins.fuse(quarter.imu, aiding, quarter.start)
        assert int(fused.n_states.max()) == states, fused.n_states.max()
        cost = seconds(partial(ins.fuse, quarter.imu, aiding, quarter.start), 3) / n
        rows.append(Row(name, cost, n, "a sample; covariance at every sample, updates at 1 Hz", goal_s))
    hours = body.standing(2, 7200.0, 100)
    second = hours.time_ns[99::100]
    sky = body.satellites(2, second, white_m=3.0, slow_m=10.0, tau_s=1800.0, n=26)
    baro = ins.BaroHeights(second, body.PLACE[2], 5.0, 30.0, 3600.0)
    whole = ins.Aiding(satellites=sky, baro=baro)
    with_stations = ins.Aiding(satellites=sky, baro=baro, dme=stations(second))
    n = hours.time_ns.size
    for name, aiding, how in (
        ("two hours at 100 Hz", whole, ins.FilterSettings()),
        ("the same and four DME", with_stations, ins.FilterSettings()),
        ("with the reversion filter beside", with_stations, ins.FilterSettings(reversion=True)),
        ("loose", with_stations, ins.FilterSettings(form="loose")),
        ("federated", with_stations, ins.FilterSettings(form="federated")),
    ):
        fused = ins.fuse(hours.imu, aiding, hours.start, settings=how)
        cost = seconds(partial(ins.fuse, hours.imu, aiding, hours.start, settings=how), repeats=1)
        note = f"a sample; {fused.n_states.max()} states, 26 satellites at 1 Hz; {cost:.2f} s the flight"
        rows.append(Row(f"ins fuse, {name}", cost / n, n, note, goal_s=10.0 / n))
    return rows


if __name__ == "__main__":
    show(measure())
