"""Where an approach ends: an aircraft that leaves the centreline in the last mile is judged, whichever gate it has left by then."""

from __future__ import annotations

import math

import polars as pl
import pytest

from navbound.read.approaches import find
from navbound.read.runways import runway

OF = runway("LSZH/14")
RADIUS_M = 6.371e6
START_NS = 1_600_000_000_000_000_000


def flown(places: list[tuple[float, float, float]]) -> pl.DataFrame:
    """Of second, distance before the threshold and to its right [m]: by a flat map, good to metres at this distance."""
    sine, cosine = math.sin(OF.course_rad), math.cos(OF.course_rad)
    north = [-before * cosine - right * sine for _, before, right in places]
    east = [-before * sine + right * cosine for _, before, right in places]
    return pl.DataFrame(
        {
            "track": ["a"] * len(places),
            "time_ns": [START_NS + round(second * 1e9) for second, _, _ in places],
            "est_lat_rad": [OF.lat_rad + n / RADIUS_M for n in north],
            "est_lon_rad": [OF.lon_rad + e / (RADIUS_M * math.cos(OF.lat_rad)) for e in east],
            "altitude_m": [OF.elevation_m + max(before, 0.0) * math.tan(math.radians(3.0)) for _, before, _ in places],
            "vertical_rate_mps": [-3.0] * len(places),
            "status": ["ok"] * len(places),
        }
    )


LANDS = [(float(k), 12_000.0 - 60.0 * k, 0.0) for k in range(201)]


def veering(from_before_m: float, right_mps: float) -> list[tuple[float, float, float]]:
    begin = (12_000.0 - from_before_m) / 60.0
    return [(second, before, right_mps * max(second - begin, 0.0)) for second, before, _ in LANDS]


def judged(places: list[tuple[float, float, float]]) -> pl.DataFrame:
    return find(flown(places), [OF]).epochs


def test_an_aircraft_that_stays_on_the_centreline_ends_at_the_last_point_inside_the_gates() -> None:
    epochs = judged(LANDS)
    # Half a mile before the threshold, 926 m: the last of every 60 m is at 960 m.
    assert epochs["along_m"].max() == pytest.approx(-960.0, abs=5.0)
    # The flat map is off by some metres at six miles.
    assert epochs["fte_m"].abs().max() < 10.0  # type: ignore[operator]


@pytest.mark.parametrize("right_mps", [30.0, 60.0, -60.0])
def test_who_leaves_it_in_the_last_mile_is_judged_to_the_same_place(right_mps: float) -> None:
    epochs = judged(veering(2400.0, right_mps))
    assert epochs.height == judged(LANDS).height
    # 24 s after 2400 m it is at 960 m.
    assert epochs["fte_m"].abs().max() == pytest.approx(abs(24.0 * right_mps), rel=0.01)


def test_who_turns_back_is_judged_until_it_comes_no_nearer() -> None:
    on = [place for place in LANDS if place[1] >= 2000.0]
    second, before, _ = on[-1]
    nearer = [(second + k, before - 60.0 * k, 40.0 * k) for k in range(1, 6)]
    away = [(second + 5.0 + k, before - 300.0 + 60.0 * k, 200.0 + 40.0 * k) for k in range(1, 60)]
    assert judged(on + nearer + away).height == judged(on).height + len(nearer)


def test_a_pause_ends_it() -> None:
    places = veering(2400.0, 60.0)
    late = [(second + (300.0 if before < 1500.0 else 0.0), before, right) for second, before, right in places]
    assert judged(late)["along_m"].max() == pytest.approx(-1500.0, abs=15.0)
