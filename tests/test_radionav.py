"""DME/DME and VOR/DME over many epochs: statistics of drawn errors, statuses, selection, coverage, and real flights."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy import stats

from navbound import InputError, anp, dme
from navbound.read.tables import epochs
from navbound.studies.ukraine_rnav.flight import network

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

NM = 1852.0
LAT, LON, H = float(np.radians(49.9)), float(np.radians(31.5)), 9000.0
NEAR = ("BRP", "KSN", "STB", "YHT")
SIGMA_H = 40.0


def drawn(n: int, seed: int) -> tuple[dme.Stations, NDArray[np.float64], NDArray[np.float64]]:
    """Ranges from one place with errors of the stated deviations, and heights with theirs."""
    stations = network().only(*NEAR)
    generator = np.random.Generator(np.random.Philox(seed))
    slant = dme.sights(LAT, LON, H, stations).slant_m
    ranges = slant + dme.range_sigma(slant) * generator.standard_normal((n, len(NEAR)))
    return stations, ranges, H + SIGMA_H * generator.standard_normal(n)


def error_en(positions: dme.Positions) -> NDArray[np.float64]:
    """Truth minus estimate: the radii of 6 383 km at this latitude are exact to 1e-3 of an error of some hundred metres."""
    north = (LAT - positions.lat_rad) * 6_373_000.0
    east = (LON - positions.lon_rad) * 6_399_700.0 * np.cos(LAT)
    return np.column_stack((east, north))


@pytest.mark.parametrize("n_ranges", [2, 4])
def test_the_covariance_is_that_of_the_errors(n_ranges: int) -> None:
    n = 20_000
    stations, ranges, h = drawn(n, seed=4)
    ranges[:, n_ranges:] = np.nan
    solution = dme.solve(ranges, stations, h, sigma_altitude_m=SIGMA_H, prior_lat_rad=LAT, prior_lon_rad=LON)
    usable = solution.status != "not_available"
    assert usable.all()
    nse = np.column_stack((error_en(solution), H - h))
    nees = np.einsum("ni,nij,nj->n", nse, np.linalg.inv(solution.covariance_enu_m2), nse)
    # A mean of n chi-square numbers with 3 degrees: 3 +- 4 sqrt(6 / n); the radii and the bend of the ranges add 1 %.
    assert nees.mean() == pytest.approx(3.0, abs=4 * np.sqrt(6 / n) + 0.03)
    assert (solution.n_ranges == n_ranges).all()
    if n_ranges == 2:
        assert np.isnan(solution.p_residual).all()
        return
    # Residual risks of ranges without a fault are level on [0, 1].
    assert stats.kstest(solution.p_residual, "uniform").pvalue > 1e-4
    degraded = np.count_nonzero(solution.status == "degraded")
    assert stats.binomtest(degraded, n, 1e-3).pvalue > 1e-4


def test_all_in_view_is_better_than_the_pair_and_a_wrong_range_is_seen() -> None:
    stations, ranges, h = drawn(200, seed=5)
    every = dme.solve(ranges, stations, h, sigma_altitude_m=SIGMA_H)
    pair = np.where(np.arange(4) < 2, ranges, np.nan)
    two = dme.solve(pair, stations, h, sigma_altitude_m=SIGMA_H, prior_lat_rad=LAT, prior_lon_rad=LON)
    assert (every.drms_m < two.drms_m).all()
    assert (every.excluded == -1).all()
    # Three do not tell which of them is wrong.
    ranges[:, 2] += 20 * 182.6
    prior = {"prior_lat_rad": LAT, "prior_lon_rad": LON}
    wrong = dme.solve(ranges[:, :3], stations.take(range(3)), h, sigma_altitude_m=SIGMA_H, **prior)
    assert (wrong.status == "degraded").mean() > 0.95
    assert "three do not tell" in str(wrong.reason[wrong.status == "degraded"][0])
    assert (wrong.excluded == -1).all()


@pytest.mark.parametrize(("column", "deviations", "least"), [(0, 15, 0.0), (1, 30, 0.75), (2, 15, 0.85), (3, 15, 0.85)])
def test_one_wrong_range_of_four_is_left_out_or_reported_unidentified(column: int, deviations: int, least: float) -> None:
    """The first two stations lie in nearly the same direction: which of them is wrong shows at larger errors only, and is not guessed."""
    n = 2000
    stations, ranges, h = drawn(n, seed=20 + column)
    ranges[:, column] += deviations * 182.6
    prior = {"prior_lat_rad": LAT, "prior_lon_rad": LON}
    solution = dme.solve(ranges, stations, h, sigma_altitude_m=SIGMA_H, **prior)
    out = solution.excluded == column
    assert out.mean() >= least
    # Another is blamed at the most as often as the odds of a thousand allow, with room for the draw.
    wrong = np.count_nonzero((solution.excluded >= 0) & ~out)
    assert stats.binomtest(wrong, n, 1e-3, alternative="greater").pvalue > 1e-4
    # Nearly none goes unseen, and what is not found is said.
    assert (solution.status[~out] == "degraded").mean() > 0.95
    assert set(solution.status[out].tolist()) <= {"ok"}
    assert (solution.n_ranges[out] == 3).all()
    others = np.where(np.arange(4) == column, np.nan, ranges)
    alone = dme.solve(others, stations, h, sigma_altitude_m=SIGMA_H, **prior)
    # The same sums in another order, to the end of the iteration at a micrometre.
    np.testing.assert_allclose(solution.lat_rad[out], alone.lat_rad[out], rtol=0, atol=1e-12)
    np.testing.assert_allclose(solution.covariance_enu_m2[out], alone.covariance_enu_m2[out], rtol=1e-9)


def bearing_error(distance_nm: float, n: int) -> tuple[NDArray[np.float64], dme.Positions]:
    """Errors east and north of VOR/DME positions drawn with the stated deviations, at a distance to the north-east of a station."""
    station = network().only("BRP")
    generator = np.random.Generator(np.random.Philox(int(distance_nm)))
    angle = distance_nm * NM / 6_380_000.0
    lat = station.lat_rad[0] + angle * np.cos(0.8)
    lon = station.lon_rad[0] + angle * np.sin(0.8) / np.cos(lat)
    seen = dme.sights(lat, lon, H, station)
    slant, bearing = seen.slant_m[0], seen.bearing_rad[0]
    h = H + SIGMA_H * generator.standard_normal(n)
    solution = dme.solve_vor(
        slant + dme.range_sigma(slant) * generator.standard_normal(n),
        bearing + dme.VOR_SIGMA_RAD * generator.standard_normal(n),
        [station.lat_rad[0], station.lon_rad[0], station.h_m[0]],
        h,
        sigma_altitude_m=SIGMA_H,
    )
    assert set(solution.status.tolist()) == {"ok"}
    # Differences of Cartesian places in the axes at the truth: an error of 10 km turns the axes by 1.6e-3.
    east = (lon - solution.lon_rad) * 6_399_700.0 * np.cos(lat)
    return np.column_stack((east, (lat - solution.lat_rad) * 6_373_000.0)), solution


@pytest.mark.parametrize("distance_nm", [10.0, 30.0, 60.0, 120.0])
def test_a_position_by_a_bearing_is_as_good_as_it_says_at_any_distance(distance_nm: float) -> None:
    n = 20_000
    error, solution = bearing_error(distance_nm, n)
    level = solution.covariance_enu_m2[:, :2, :2]
    nees = np.einsum("ni,nij,nj->n", error, np.linalg.inv(level), error)
    # Four standard errors of the mean; radii and turned axes bring 1 % at the most.
    assert nees.mean() == pytest.approx(2.0, abs=4 * nees.std() / np.sqrt(n) + 0.02)
    # Its own 95 % circle: the arc's error is no normal one, so the share may differ by some tenths of a per cent.
    inside = (np.hypot(error[:, 0], error[:, 1]) <= anp.circle(level, 0.05)).mean()
    assert inside == pytest.approx(0.95, abs=0.012)


def test_the_bend_of_the_arc_is_what_a_straight_line_leaves_out() -> None:
    """At 60 NM, against the first order of `dme.vor_dme`, which is the printed one."""
    error, solution = bearing_error(60.0, 20_000)
    level = solution.covariance_enu_m2[:, :2, :2]
    first = dme.vor_dme(60 * NM, np.hypot(60 * NM, H), dme.VOR_SIGMA_RAD, dme.range_sigma(60 * NM))
    # The same directions, which are those of the largest and the smallest deviation.
    _, axes = np.linalg.eigh(level)
    outwards = np.sign(axes[:, :, 0] @ [np.sin(0.8), np.cos(0.8)])
    along, across = outwards * np.einsum("ni,ni->n", error, axes[:, :, 0]), np.einsum("ni,ni->n", error, axes[:, :, 1])
    nees = np.mean((along / first.radial_m) ** 2 + (across / first.cross_m) ** 2)
    # 2 + 3/4 sigma⁴ ground² / radial², with 0.0396 rad, 111.1 km and 182.6 m: 2.68; five per cent for the draw.
    assert nees == pytest.approx(2.68, rel=0.05)
    # On average the aircraft is nearer to the station than its position, by ground · sigma² / 2 = 87 m; four standard errors are 7 m.
    assert along.mean() == pytest.approx(-87.0, abs=7.0)


def test_what_cannot_be_solved_is_a_status() -> None:
    stations, ranges, h = drawn(3, seed=6)
    ranges[0, 2:] = np.nan
    ranges[1, 1:] = np.nan
    solution = dme.solve(ranges, stations, h, sigma_altitude_m=SIGMA_H)
    assert solution.status.tolist() == ["not_available", "not_available", "ok"]
    assert "mirror" in solution.reason[0]
    assert "two ranges" in solution.reason[1]
    assert np.isnan(solution.lat_rad[:2]).all()
    assert np.isnan(solution.covariance_enu_m2[:2]).all()
    far = dme.solve(ranges[2], stations, h[2], sigma_altitude_m=SIGMA_H, prior_lat_rad=LAT + 0.02, prior_lon_rad=LON, prior_within_m=1e4)
    assert (str(far.status), int(far.n_ranges)) == ("not_available", 0)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"slant_m": [-1.0, 6e4, 5e4, 4e4]}, "slant_m"),
        ({"slant_m": [np.inf, 6e4, 5e4, 4e4]}, "slant_m"),
        ({"slant_m": [6e4, 5e4, 4e4]}, "slant_m"),
        ({"h_m": np.nan}, "h_m"),
        ({"sigma_altitude_m": -1.0}, "sigma_altitude_m"),
        ({"sigma_m": [1.0, 0.0, 1.0, 1.0]}, "sigma_m"),
        ({"prior_lat_rad": 0.87}, "prior_lon_rad"),
        ({"prior_lat_rad": 1.7, "prior_lon_rad": 0.5}, "lat_rad"),
        ({"prior_within_m": 0.0}, "prior_within_m"),
        ({"residual_risk": np.nan}, "residual_risk"),
        ({"stations": {"A": [0.8, 0.5]}}, "stations"),
        ({"stations": {name: [2.0, 0.5, 0.0] for name in NEAR}}, "lat_rad"),
    ],
)
def test_wrong_arguments_are_refused_by_name(change: dict[str, object], named: str) -> None:
    arguments: dict[str, object] = {"slant_m": [6e4, 1.2e5, 6e4, 4e4], "stations": network().only(*NEAR), "h_m": H, "sigma_altitude_m": 0.0}
    with pytest.raises(InputError, match=named):
        dme.solve(**(arguments | change))  # type: ignore[arg-type]


def test_a_network_of_nothing_gives_nothing() -> None:
    nothing = dme.Stations.of({})
    with pytest.raises(InputError, match="at least one station"):
        dme.solve(np.empty((2, 0)), nothing, H, sigma_altitude_m=0.0)
    coverage = dme.coverage([LAT], [LON], H, nothing, rnp_m=NM, fte_m=0.0, sigma_altitude_m=0.0)
    assert (coverage.n_stations.tolist(), coverage.supports_all.tolist()) == ([0], [False])
    assert dme.sights([LAT], [LON], [H], nothing).slant_m.shape == (1, 0)
    with pytest.raises(InputError, match="lat_rad"):
        dme.coverage([np.nan], [LON], H, nothing, rnp_m=NM, fte_m=0.0, sigma_altitude_m=0.0)


def track(n: int = 400) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    lon = np.radians(np.linspace(31.0, 36.0, n))
    return np.arange(n) * 5_000_000_000, np.full(n, LAT), lon, np.full(n, 10_000.0)


def test_the_best_pair_is_that_of_the_flat_search() -> None:
    """Against `best_pair`, on the station's places as the aircraft's own axes show them: another route to the same figures."""
    stations = network().only(*NEAR, "KVR", "KVH")
    time, lat, lon, h = track(40)
    selection = dme.select(time, lat, lon, h, stations, sigma_altitude_m=SIGMA_H)
    seen = dme.sights(lat, lon, h, stations)
    compared = 0
    for k in range(40):
        usable = np.flatnonzero(seen.usable[k])
        if len(usable) < 2:
            continue
        # Bearings at the station turn by up to two degrees on the way; taken as level directions they give the pair, and drms to 10 %.
        level = seen.slant_m[k] * np.cos(seen.elevation_rad[k])
        places = {
            stations.ident[i]: (-level[i] * np.sin(seen.bearing_rad[k, i]), -level[i] * np.cos(seen.bearing_rad[k, i]), -h[k])
            for i in usable
        }
        best = dme.best_pair((0.0, 0.0, 0.0), places, sigma_altitude_m=SIGMA_H)
        if best is None or best.drms_m is None or selection.best[k, 0] < 0:
            continue
        compared += 1
        assert np.sqrt(np.trace(selection.best_en_m2[k])) == pytest.approx(best.drms_m, rel=0.1)
    assert compared > 30


def test_a_pair_waits_before_it_changes_and_is_never_much_worse() -> None:
    stations = network()
    time, lat, lon, h = track()
    waiting = dme.select(time, lat, lon, h, stations, sigma_altitude_m=SIGMA_H)
    at_once = dme.select(time, lat, lon, h, stations, sigma_altitude_m=SIGMA_H, switching=(0.0, 0.0))
    known = at_once.best[:, 0] >= 0
    assert known.mean() > 0.9
    assert (at_once.used[known] == at_once.best[known]).all()
    changes = [int(np.count_nonzero((np.diff(s.used, axis=0) != 0).any(axis=1))) for s in (waiting, at_once)]
    assert 0 < changes[0] < changes[1]
    drms = [np.sqrt(np.trace(m[known], axis1=1, axis2=2)) for m in (waiting.used_en_m2, waiting.best_en_m2, waiting.all_en_m2)]
    assert (drms[0] >= drms[1]).all()
    # 5 % is the share to wait for; ten seconds of flight change a figure by some per cent more.
    assert (drms[0] <= 1.15 * drms[1]).all()
    # Where only two stations are in view both are the same, but for rounding.
    assert (drms[2] <= drms[1] * (1 + 1e-9)).all()
    assert (drms[2] < 0.9 * drms[1]).mean() > 0.5


def test_across_the_leg_another_pair_may_be_best_and_an_excluded_facility_is_not_used() -> None:
    stations = network()
    time, lat, lon, h = track()
    course = np.full(len(lat), np.radians(91.0))
    across = np.array([np.cos(course[0]), -np.sin(course[0])])

    def sigma(selection: dme.Selection) -> NDArray[np.float64]:
        deviation: NDArray[np.float64] = np.sqrt(np.einsum("i,nij,j->n", across, selection.best_en_m2, across))
        return deviation

    by_drms = dme.select(time, lat, lon, h, stations, sigma_altitude_m=SIGMA_H)
    by_leg = dme.select(time, lat, lon, h, stations, sigma_altitude_m=SIGMA_H, course_rad=course)
    known = by_drms.best[:, 0] >= 0
    assert (sigma(by_leg)[known] <= sigma(by_drms)[known]).all()
    assert (sigma(by_leg)[known] < 0.99 * sigma(by_drms)[known]).any()
    without = dme.select(time, lat, lon, h, stations.without("YHT"), sigma_altitude_m=SIGMA_H)
    used = {stations.ident[k] for k in np.unique(by_drms.best) if k >= 0}
    assert "YHT" in used
    assert (without.n_stations <= by_drms.n_stations).all()
    drms = [np.trace(s.best_en_m2, axis1=1, axis2=2) for s in (without, by_drms)]
    both = (without.best[:, 0] >= 0) & known
    assert (drms[0][both] >= drms[1][both]).all()


def test_selection_refuses_what_does_not_fit() -> None:
    time, lat, lon, h = track(10)
    with pytest.raises(InputError, match="time_ns"):
        dme.select(time[:5], lat, lon, h, network(), sigma_altitude_m=0.0)
    with pytest.raises(InputError, match="time_ns"):
        dme.select(time * 1e-9, lat, lon, h, network(), sigma_altitude_m=0.0)
    with pytest.raises(InputError, match="course_rad"):
        dme.select(time, lat, lon, h, network(), sigma_altitude_m=0.0, course_rad=np.nan)
    with pytest.raises(InputError, match="switching_share"):
        dme.select(time, lat, lon, h, network(), sigma_altitude_m=0.0, switching=(1.0, 10.0))
    with pytest.raises(InputError, match="sigma_altitude_m"):
        dme.select(time, lat, lon, h, network(), sigma_altitude_m=np.nan)


def test_a_map_is_its_tiles_and_says_what_the_selection_says() -> None:
    stations = network()
    lat, lon = np.meshgrid(np.radians(np.linspace(48.0, 51.5, 15)), np.radians(np.linspace(29.0, 37.0, 17)), indexing="ij")
    requested = {"rnp_m": NM, "fte_m": 0.5 * NM, "sigma_altitude_m": SIGMA_H}
    whole = dme.coverage(lat, lon, 9000.0, stations, **requested)
    tiles = [dme.coverage(lat[rows], lon[rows], 9000.0, stations, **requested) for rows in (slice(0, 6), slice(6, None))]
    for name in ("n_stations", "best", "nse_best_m", "nse_all_m", "nse_vor_m", "supports_best", "supports_vor"):
        np.testing.assert_array_equal(np.concatenate([getattr(t, name) for t in tiles]), getattr(whole, name))
    assert whole.nse_limit_m == pytest.approx(np.sqrt(0.75) * NM, rel=1e-12)
    flat = dme.select(
        np.zeros(lat.size, dtype=np.int64), lat.ravel(), lon.ravel(), np.full(lat.size, 9000.0), stations, sigma_altitude_m=SIGMA_H
    )
    np.testing.assert_array_equal(flat.best, whole.best.reshape(-1, 2))
    known = flat.best[:, 0] >= 0
    np.testing.assert_allclose(anp.circle(flat.best_en_m2[known], 0.05), whole.nse_best_m.ravel()[known], rtol=1e-12)
    assert np.isnan(whole.nse_best_m.ravel()[~known]).all()
    assert not whole.supports_best.ravel()[~known].any()
    # More stations never hurt; a map has both kinds of places.
    both = np.isfinite(whole.nse_best_m)
    assert (whole.nse_all_m[both] <= whole.nse_best_m[both] * (1 + 1e-9)).all()
    assert 0.3 < whole.supports_best.mean() < 1.0


def test_coverage_grows_with_height_and_shrinks_with_the_demand() -> None:
    lat, lon = np.meshgrid(np.radians(np.linspace(48.0, 51.5, 15)), np.radians(np.linspace(29.0, 37.0, 17)), indexing="ij")
    shares = [
        dme.coverage(lat, lon, h, network(), rnp_m=rnp * NM, fte_m=0.5 * rnp * NM, sigma_altitude_m=SIGMA_H).supports_best.mean()
        for h, rnp in ((1500.0, 1.0), (5000.0, 1.0), (10_000.0, 1.0), (10_000.0, 0.3), (10_000.0, 0.27))
    ]
    assert shares[0] < shares[1] < shares[2] > shares[3] > shares[4]
    # The best pair has a circle of 2.4477 * 182.6 = 447 m; RNP 0.27 leaves 433.
    assert shares[4] == 0.0
    with pytest.raises(InputError, match=r"tse|fte|rnp"):
        dme.coverage(lat, lon, 9000.0, network(), rnp_m=NM, fte_m=2 * NM, sigma_altitude_m=0.0)
    with pytest.raises(InputError, match="risk"):
        dme.coverage(lat, lon, 9000.0, network(), rnp_m=NM, fte_m=0.0, sigma_altitude_m=0.0, risk=0.0)


def test_pairs_of_equal_figures_are_taken_in_order() -> None:
    """Two stations on one mast: the pair with the first of them, at every epoch."""
    double = dme.Stations.of({"AAA": [LAT, LON, 100.0], "BBB": [LAT, LON, 100.0], "CCC": [LAT + 0.01, LON + 0.014, 100.0]})
    selection = dme.select(np.zeros(1, dtype=np.int64), [LAT + 0.012], [LON - 0.002], [6000.0], double, sigma_altitude_m=0.0)
    assert selection.best.tolist() == [[0, 2]]


def test_one_station_gives_a_position_by_bearing_and_a_pair_none() -> None:
    alone = network().only("BRP")
    selection = dme.select(np.zeros(1, dtype=np.int64), [LAT], [LON], [6000.0], alone, sigma_altitude_m=0.0)
    assert selection.best.tolist() == [[-1, -1]]
    assert np.isnan(selection.all_en_m2).all()
    assert selection.vor.tolist() == [0]
    overhead = dme.solve_vor(5000.0, 0.3, [LAT, LON, 0.0], 4500.0, sigma_altitude_m=0.0)
    assert (str(overhead.status), str(overhead.reason)) == ("not_available", "the aircraft is in the cone above the VOR")
    short = dme.solve_vor(4000.0, 0.3, [LAT, LON, 0.0], 4500.0, sigma_altitude_m=0.0)
    assert short.status == "not_available"
    with pytest.raises(InputError, match="bearing_rad"):
        dme.solve_vor(50_000.0, np.nan, [LAT, LON, 0.0], 4500.0, sigma_altitude_m=0.0)


def inspected(folder: Path, name: str) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Time, position and altitude of a real flight that inspects navaids; its pressure altitude stands for a height."""
    columns = ("time_ns", "est_lat_rad", "est_lon_rad", "altitude_m")
    read = epochs.read(folder / "aircraft" / "calibration" / f"{name}.json.gz").epochs.drop_nulls(columns)
    time, lat, lon, h = (read[c].to_numpy() for c in columns)
    return time, lat, lon, h


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        # Dense airspace: above 300 m there is nearly always a pair, although hills and houses are not considered.
        ("brussels_ils", 0.97, 1.0),
        ("london_gatwick", 0.97, 1.0),
        ("munich", 0.97, 1.0),
        # Three stations on an island group, and the far north: often not.
        ("funchal", 0.2, 0.7),
        ("kiruna", 0.2, 0.7),
    ],
)
def test_real_flights_have_pairs_where_the_network_is_dense(shared_data: Path, name: str, least: float, most: float) -> None:
    time, lat, lon, h = inspected(shared_data, name)
    stations = dme.stations().near(lat[::50], lon[::50], 350e3)
    selection = dme.select(time, lat, lon, h, stations, sigma_altitude_m=30.0)
    known = selection.used[:, 0] >= 0
    assert least <= known[h > 300.0].mean() <= most
    drms = np.sqrt(np.trace(selection.used_en_m2[known], axis1=1, axis2=2))
    every = np.sqrt(np.trace(selection.all_en_m2[known], axis1=1, axis2=2))
    # Two ranges of at best 182.6 m at right angles; the worst admitted, 315 m at 130 NM meeting at 30 degrees.
    assert drms.min() >= 258.0
    assert drms.max() <= np.sqrt(2) * 315.0 / np.sin(np.radians(30.0)) * 1.02
    assert (every <= drms * (1 + 1e-9)).all()


def test_the_stations_in_view_are_those_of_a_sphere(shared_data: Path) -> None:
    """Counted again on a sphere with the horizon in feet and miles; a station within 1 % of a limit may fall on either side."""
    _, lat, lon, h = inspected(shared_data, "munich")
    some = np.arange(0, len(lat), 100)
    stations = dme.stations().near(lat[some], lon[some], 350e3)
    usable = dme.sights(lat[some], lon[some], h[some], stations).usable
    for row, k in enumerate(some):
        half = np.sin((stations.lat_rad - lat[k]) / 2) ** 2
        half += np.cos(lat[k]) * np.cos(stations.lat_rad) * np.sin((stations.lon_rad - lon[k]) / 2) ** 2
        ground_nm = 2 * 6371.0 / 1.852 * np.arcsin(np.sqrt(half))
        above_ft = np.maximum(h[k] - stations.h_m, 0.0) / 0.3048
        slant_nm = np.hypot(ground_nm, above_ft / 6076.12)
        reach_nm = np.minimum(np.minimum(stations.service_m / NM, 160.0), 1.2287 * np.sqrt(above_ft))
        steep = above_ft / 6076.12 > np.tan(np.radians(40.0)) * ground_nm

        def admitted(slack: float, reach: NDArray[np.float64] = reach_nm, slant: NDArray[np.float64] = slant_nm) -> NDArray[np.bool_]:
            return (slant < reach * slack) & (slant > 3.0 / slack)

        assert not (usable[row] & ~admitted(1.01)).any()
        assert not (admitted(0.99) & ~steep & ~usable[row]).any()
