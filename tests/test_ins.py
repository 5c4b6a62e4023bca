"""Mechanization and navigation filter against closed forms, dense matrices and their own promises."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import ins_fixture as body
import ins_truth as oracle
from navbound import anp, ins
from navbound.errors import InputError

SECOND = 1_000_000_000


def weave(rate_hz: int) -> tuple[ins.Track, oracle.Flight]:
    flight = oracle.fly(oracle.winding, 60.0, rate_hz)
    start = ins.Start(0, tuple(flight.position[0]), tuple(flight.velocity_ned_mps[0]), tuple(flight.attitude_rad[0]))
    time_ns = np.round(flight.time_s[1:] * 1e9).astype(np.int64)
    return ins.mechanize(ins.Imu(time_ns, flight.angle_rad[1:], flight.velocity_mps[1:], 1 / rate_hz), start), flight


def wrongness(track: ins.Track, flight: oracle.Flight) -> tuple[float, float, float]:
    metres = np.array([6.37e6, 6.37e6 * np.cos(0.72), 1.0])
    position = np.abs((track.position - flight.position[1:]) * metres).max()
    velocity = np.abs(track.velocity_ned_mps - flight.velocity_ned_mps[1:]).max()
    return float(position), float(velocity), float(np.abs(track.attitude_rad - flight.attitude_rad[1:]).max())


def test_the_mechanization_comes_back_to_a_flight_in_closed_form() -> None:
    coarse, fine = wrongness(*weave(25)), wrongness(*weave(50))
    # Two samples follow rates that are linear over both: what is left falls with the square of the interval at least. At 50 Hz the third
    # derivative of this path over a minute makes 5 mm; the oracle's own differences stay below 1e-8 m/s².
    assert fine[0] < 5e-3
    assert fine[1] < 2e-4
    assert fine[2] < 1e-8
    assert coarse[0] / fine[0] > 3.5


def test_a_unit_at_rest_feels_the_earth_turn_and_gravity() -> None:
    flight = oracle.fly(oracle.standing, 0.1, 50)
    # Rate and gravity of WGS-84 at 0.72 rad, 100 m: what the oracle's differences say without any equation of motion.
    assert np.linalg.norm(flight.angle_rad[1] * 50) == pytest.approx(7.292115e-5, rel=1e-6)
    assert np.linalg.norm(flight.velocity_mps[1] * 50) == pytest.approx(9.80239, abs=2e-4)


def test_the_covariance_grows_as_the_dense_exponential_says() -> None:
    """A unit at rest: F is constant, so P(t) = e^Ft P e^F't + integral, by Van Loan's block exponential in SciPy."""
    still = body.standing(1, 300.0, 20)
    # Without aiding the biases stay at their estimate of zero.
    free = ins.fuse(still.imu, ins.Aiding(), replace(still.start, position=body.PLACE, attitude_rad=body.ATTITUDE), output_period_s=300.0)
    lat = body.PLACE[0]
    c = np.asarray(oracle.ned_from_body(np.array([body.ATTITUDE])), dtype=np.float64)[0]
    w = 7.292115e-5 * np.array([np.cos(lat), 0.0, -np.sin(lat)])
    g = float(oracle.gravity(np.array([body.PLACE]))[0])
    e2, a = float(oracle.E2), float(oracle.A)
    m = a * (1 - e2) / (1 - e2 * np.sin(lat) ** 2) ** 1.5 + 100
    n = a / np.sqrt(1 - e2 * np.sin(lat) ** 2) + 100

    def cross(v: np.ndarray) -> np.ndarray:
        return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])

    f = np.zeros((15, 15))
    f[0:3, 3:6] = np.eye(3)
    f[3:6, 3:6] = -2 * cross(w)
    f[3:6, 6:9] = cross(np.array([0, 0, -g]))
    f[3:6, 12:15] = c
    # Specification 6.2 with R the meridian's; at rest the axes do not turn over the Earth, but their Earth rate depends on latitude.
    f[5, 2] = 2 * g / m
    f[6:9, 3:6] = [[0, 1 / n, 0], [-1 / m, 0, 0], [0, -np.tan(lat) / n, 0]]
    f[6, 0], f[8, 0] = -7.292115e-5 * np.sin(lat) / m, -7.292115e-5 * np.cos(lat) / m
    f[6:9, 6:9] = -cross(w)
    f[6:9, 9:12] = -c
    f[9:15, 9:15] = -np.eye(6) / 3600.0
    model = ins.ImuModel()
    q = np.diag(np.repeat([0, model.accelerometer.white**2, model.gyroscope.white**2, 2 / 3600 * model.gyroscope.bias**2], 3))
    q = np.pad(q, ((0, 3), (0, 3))) + np.diag(np.repeat([0, 2 / 3600 * model.accelerometer.bias**2], [12, 3]))
    start = still.start
    p = np.diag(
        np.concatenate(
            [
                np.square(start.position_sigma_m),
                np.full(3, start.velocity_sigma_mps**2),
                np.square(start.attitude_sigma_rad),
                np.full(3, model.gyroscope.bias**2),
                np.full(3, model.accelerometer.bias**2),
            ]
        )
    )
    blocks = expm(np.block([[-f, q], [np.zeros_like(f), f.T]]) * 300.0)
    phi = blocks[15:, 15:].T
    p = phi @ p @ phi.T + phi @ blocks[:15, 15:]
    covariance = free.covariance_enu_m2[-1]
    expected = p[:3, :3][np.ix_([1, 0, 2], [1, 0, 2])] * np.outer([1, 1, -1], [1, 1, -1])
    # The unit does not quite rest: its wrong start velocity turns the axes, its noise tilts them by 1e-5. An element may miss 1e-4 of
    # itself, and one that is a difference of large ones 1e-5 of those.
    np.testing.assert_allclose(covariance, expected, rtol=1e-4, atol=1e-5 * expected.max())
    np.testing.assert_allclose(free.velocity_sigma_mps[-1], np.sqrt(np.diag(p)[3:6]), rtol=1e-4)
    np.testing.assert_allclose(free.attitude_sigma_rad[-1], np.sqrt(np.diag(p)[6:9]), rtol=1e-4)


def flights(errors: str, n: int) -> tuple[float, float, float, float]:
    """Mean NEES / 3, shares inside the 95 % circle and sphere, and mean square of the innovations, of n seeded flights."""
    nees, circle, sphere, squares = [], [], [], []
    for seed in range(n):
        still = body.standing(seed, 400.0)
        aiding = ins.Aiding(satellites=body.satellites(seed, still.time_ns[9::10], white_m=1.0, slow_m=5.0, tau_s=60.0))
        fused = ins.fuse(still.imu, aiding, still.start, settings=ins.FilterSettings(errors="white" if errors == "white" else "correlated"))
        error, p = body.error_enu(fused)[60:], fused.covariance_enu_m2[60:]
        nees.append(np.einsum("ni,nij,nj->n", error, np.linalg.inv(p), error).mean() / 3)
        circle.append((np.hypot(error[:, 0], error[:, 1]) <= anp.circle(p[:, :2, :2], 0.05)).mean())
        sphere.append((np.linalg.norm(error, axis=1) <= anp.sphere(p, 0.05)).mean())
        squares.append(fused.innovations["range"].mean_square)
    return float(np.mean(nees)), float(np.mean(circle)), float(np.mean(sphere)), float(np.mean(squares))


def test_the_filter_is_as_good_as_it_says_where_errors_stay() -> None:
    nees, circle, sphere, square = flights("correlated", 40)
    # 40 flights of some four independent errors: NEES / 3 of 160 samples of three degrees has a deviation of sqrt(2 / 480) = 0.065, a
    # share of 0.95 one of 0.017; three of them either way.
    assert 0.8 < nees < 1.2
    assert 0.90 < circle < 0.99
    assert 0.90 < sphere < 0.99
    assert 0.9 < square < 1.1


def test_a_filter_that_takes_slow_errors_for_white_is_shown_to_fail() -> None:
    nees, circle, sphere, square = flights("white", 10)
    # It says 5 m / sqrt(many) where 5 m stay: far outside any limit, while its innovations look healthy.
    assert nees > 5.0
    assert max(circle, sphere) < 0.6
    assert square < 1.2


def test_whiteness_speaks_where_the_mean_square_does_not() -> None:
    still = body.standing(3, 400.0)
    aiding = ins.Aiding(satellites=body.satellites(3, still.time_ns[9::10], white_m=1.0, slow_m=5.0, tau_s=60.0))
    white = ins.fuse(still.imu, aiding, still.start, settings=ins.FilterSettings(errors="white")).innovations["range"]
    healthy = ins.fuse(still.imu, aiding, still.start).innovations["range"]
    assert white.lag_one > 0.5
    # Within three deviations of none.
    assert abs(healthy.lag_one) < 3 / np.sqrt(healthy.n_pairs)


def radio(time_ns: np.ndarray) -> tuple[ins.DmeRanges, ins.VorBearings]:
    """Two DME and a VOR around the body, without errors."""
    offsets = np.array([[40_000.0, 10_000.0, 0.0], [-5_000.0, 50_000.0, 0.0]])
    where = body.place_ecef(offsets)
    slant = np.linalg.norm(offsets, axis=1)
    n = time_ns.size
    dme = ins.DmeRanges(np.repeat(time_ns, 2), np.tile([0, 1], n), np.tile(where, (n, 1)), np.tile(slant, n), 150.0, 90.0)
    # Straight south of the body by an angle of latitude: the bearing is north.
    vor = ins.VorBearings(time_ns, np.zeros(n, int), np.tile([body.PLACE[0] - 0.005, body.PLACE[1], 0.0], (n, 1)), 0.0, 0.01, 0.01)
    return dme, vor


def test_the_mode_falls_back_and_returns_with_patience() -> None:
    still = body.standing(5, 120.0)
    second = still.time_ns[9::10]
    t = second // SECOND
    sky = body.satellites(5, second, white_m=1.0, slow_m=0.0, tau_s=60.0)
    seen = np.repeat((t <= 20) | (t > 90), 9)
    kept = body.some(sky, seen)
    dme, vor = radio(second)
    two = np.repeat(t <= 40, 2) | (np.arange(2 * t.size) % 2 == 0) & np.repeat(t <= 60, 2)
    dme = ins.DmeRanges(
        np.asarray(dme.time_ns)[two],
        np.asarray(dme.station)[two],
        np.asarray(dme.position_ecef_m)[two],
        np.asarray(dme.slant_m)[two],
        150.0,
        90.0,
    )
    fused = ins.fuse(still.imu, ins.Aiding(satellites=kept, dme=dme, vor=vor), still.start)
    mode = dict(zip((fused.time_ns / 1e9).round().astype(int).tolist(), fused.mode, strict=True))
    # Five seconds of patience, and a second and a half in which a measurement counts as present.
    assert [mode[s] for s in (10, 22, 35, 43, 55, 63, 75)] == ["gnss", "gnss", "dme_dme", "dme_dme", "vor_dme", "vor_dme", "coasting"]
    # Back from 91 s on, but trusted only after ten seconds.
    assert (mode[95], mode[105]) == ("coasting", "gnss")
    sigma = np.sqrt(fused.covariance_enu_m2[:, 0, 0])
    assert sigma[105] < sigma[89]
    assert np.all(np.diff(sigma[62:90]) > 0)


def test_rates_alone_hold_what_ranges_have_estimated() -> None:
    """Ranges for half a minute, then carrier phase: the position stays, and what the filter says of it grows as slowly."""
    still = body.standing(6, 120.0)
    second = still.time_ns[9::10]
    sky = body.satellites(6, second, white_m=0.3, slow_m=0.0, tau_s=60.0)
    ranged = np.repeat(second // SECOND <= 30, 9)
    geometry = (np.asarray(sky.position_ecef_m), np.asarray(sky.velocity_ecef_mps))
    # The sky of the fixture stands still, as the body does: a rate is the clock's 0.5 m/s and noise.
    rates = 0.5 + 0.005 * np.random.default_rng(61).normal(size=ranged.size)
    mixed = ins.SatelliteRanges(sky.time_ns, sky.satellite, *geometry, np.where(ranged, sky.range_m, np.nan), 0.3, 0.0, 60.0, rates, 0.005)
    fused = ins.fuse(still.imu, ins.Aiding(satellites=mixed), still.start)
    sigma = np.sqrt(fused.covariance_enu_m2[:, 0, 0])
    alone = ins.fuse(still.imu, ins.Aiding(satellites=body.some(mixed, ranged)), still.start)
    free = np.sqrt(alone.covariance_enu_m2[:, 0, 0])
    # From where nothing checks the position any more: what the tests had left unseen is stated from then on. Ninety seconds of white rates
    # of 5 mm/s add less than a decimetre; without them the unit's own errors add metres.
    assert sigma[119] - sigma[33] < 0.1
    assert free[119] - free[33] > 1.0
    # The mode knows positions only: rates hold none.
    assert fused.mode[119] == "coasting"
    assert fused.innovations["range_rate"].n_used > fused.innovations["range"].n_used
    none = ins.SatelliteRanges(sky.time_ns, sky.satellite, *geometry, np.nan, 0.3, 0.0, 60.0)
    assert ins.fuse(still.imu, ins.Aiding(satellites=none), still.start).innovations["range_rate"].n_refused == len(sky.satellite)


def test_samples_that_are_none_late_or_missing_are_counted_and_bridged() -> None:
    still = body.standing(7, 60.0)
    time_ns, angle = np.asarray(still.imu.time_ns), np.array(still.imu.angle_rad)
    angle[100, 1] = np.nan
    swapped = time_ns.copy()
    swapped[[200, 201]] = time_ns[[201, 200]]
    keep = np.ones(time_ns.size, bool)
    keep[300:305] = False
    imu = ins.Imu(swapped[keep], angle[keep], np.asarray(still.imu.velocity_mps)[keep], 0.1)
    fused = ins.fuse(imu, ins.Aiding(), still.start)
    assert fused.samples == {"done": 593, "bridged": 3, "adrift": 0, "late": 1, "refused": 1, "stopped": 0}
    assert fused.refused is not None
    assert fused.refused[0] == time_ns[100]
    assert "angle_rad" in fused.refused[1]
    whole = ins.fuse(still.imu, ins.Aiding(), still.start)
    # The hole of half a second hides 1 m/s²: the velocity is less certain for it, by a quarter of that squared.
    assert fused.velocity_sigma_mps[-1, 0] > whole.velocity_sigma_mps[-1, 0] + 0.2
    assert np.isfinite(fused.position).all()


def silent(still: body.Standing, first: int, after: int) -> ins.Imu:
    """Samples of the unit but for some."""
    keep = np.ones(np.asarray(still.imu.time_ns).size, bool)
    keep[first:after] = False
    time_ns, angle, velocity = (np.asarray(x)[keep] for x in (still.imu.time_ns, still.imu.angle_rad, still.imu.velocity_mps))
    return ins.Imu(time_ns, angle, velocity, 0.1)


def test_after_a_hole_nothing_is_reported_without_a_measurement_and_the_time_is_reported() -> None:
    still = body.standing(8, 60.0)
    fused = ins.fuse(silent(still, 300, 330), ins.Aiding(), still.start)
    ((time_ns, since_s),) = fused.holes
    assert time_ns == 33_100_000_000
    assert since_s == pytest.approx(3.1, abs=1e-9)
    assert fused.stopped is None
    assert fused.mode[-1] == "stopped"
    assert np.isnan(fused.position[-1]).all()
    assert fused.samples == {"done": 300, "bridged": 0, "adrift": 270, "late": 0, "refused": 0, "stopped": 0}


def test_after_a_hole_the_satellites_give_a_position_and_a_body_without_a_course_stays_unaligned() -> None:
    nees = []
    for seed in range(20):
        still = body.standing(seed, 60.0)
        aiding = ins.Aiding(satellites=body.satellites(seed, still.time_ns[9::10], white_m=1.0, slow_m=5.0, tau_s=60.0))
        fused = ins.fuse(silent(still, 300, 350), aiding, still.start)
        second = (fused.time_ns / 1e9).round().astype(int)
        after = second >= 36
        # The first measurement after the hole ends it; a body at rest has no course, so nothing says where it heads.
        assert {m for m, later in zip(fused.mode, after, strict=True) if later} == {"aligning"}
        assert (fused.attitude_sigma_rad[after, 2] > 1.0).all()
        error, p = body.error_enu(fused)[after], fused.covariance_enu_m2[after]
        nees.append(np.einsum("ni,nij,nj->n", error, np.linalg.inv(p), error).mean() / 3)
    # Errors that stay over the 25 s: 20 samples of three degrees, sqrt(2 / 60) = 0.18; below by as much as 3 m/s² are too many for rest.
    assert 0.4 < np.mean(nees) < 1 + 3 * 0.18


def test_a_receiver_whose_clock_jumps_is_followed_after_a_second_and_counted() -> None:
    still = body.standing(21, 120.0)
    sky = body.satellites(21, still.time_ns[9::10], white_m=1.0, slow_m=5.0, tau_s=60.0)
    # A millisecond, as receivers jump.
    jumped = np.asarray(sky.range_m) + np.where(np.asarray(sky.time_ns) >= 60 * SECOND, 299_792.458, 0.0)
    whole, after = (ins.fuse(still.imu, ins.Aiding(satellites=s), still.start) for s in (sky, replace(sky, range_m=jumped)))
    assert (whole.clock_jumps, after.clock_jumps) == (0, 1)
    # The nine ranges of one second are lost.
    assert after.innovations["range"].n_gated - whole.innovations["range"].n_gated == 9
    assert after.further["clock_m"] - whole.further["clock_m"] == pytest.approx(299_792.458, abs=5.0)
    error, sigma = body.error_enu(after)[60:], np.sqrt(np.diagonal(after.covariance_enu_m2[60:], axis1=1, axis2=2))
    assert (np.abs(error) < 4 * sigma).all()


def ring(time_ns: np.ndarray, n: int, slant_m: float, errors: np.ndarray) -> ins.DmeRanges:
    """Ranges to stations all around the body at its height, with given errors, shape (time, n)."""
    angle = 2 * np.pi * np.arange(n) / n
    where = body.place_ecef(slant_m * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)]))
    m = time_ns.size
    return ins.DmeRanges(
        np.repeat(time_ns, n), np.tile(np.arange(n), m), np.tile(where, (m, 1)), slant_m + np.asarray(errors).ravel(), 150.0, 90.0
    )


def test_a_station_whose_ranges_go_wrong_is_left_out_and_comes_back() -> None:
    reach = []
    for seed in range(8):
        still = body.standing(seed, 400.0)
        second = still.time_ns[9::10]
        draw = np.random.default_rng(seed)
        errors = 90.0 * draw.normal(size=5) + 150.0 * draw.normal(size=(second.size, 5))
        wrong = (second >= 100 * SECOND) & (second < 250 * SECOND)
        errors[wrong, 2] += 0.5 * 1852.0
        fused = ins.fuse(still.imu, ins.Aiding(dme=ring(second, 5, 60_000.0, errors)), still.start)
        error = np.hypot(*body.error_enu(fused)[:, :2].T)
        sigma = np.sqrt(fused.covariance_enu_m2[:, 0, 0] + fused.covariance_enu_m2[:, 1, 1])
        reach.append((error / sigma)[100:].max())
        # Some of its 150 wrong ranges pass before the sum speaks; all of the others are gated, and 30 more until it is believed again.
        assert 140 <= fused.innovations["dme"].n_gated <= 240
        # One good measurement in ten thousand is gated and takes its station out for half a minute, perhaps another one now.
        assert "dme_2_m" not in fused.left_out
    # drms of a horizontal error: three of them at the most in eight flights; before, the wrong station took the filter along for 300 m.
    assert max(reach) < 3.0


def test_a_position_by_a_bearing_and_a_range_knows_that_the_range_bends() -> None:
    """One station at 110 km, five kilometres across at the start: what the arc adds along the radial stays as long as the error across."""
    nees = []
    for seed in range(60):
        draw = np.random.default_rng(1000 + seed)
        still = body.standing(seed, 60.0)
        second = still.time_ns[9::10]
        across = 4_500.0 * draw.normal()
        lat, lon, h = body.PLACE
        position = (lat, lon + across / (6.3875e6 * np.cos(lat)), h)
        start = replace(still.start, position=position, position_sigma_m=(2000.0, 4500.0, 15.0))
        start = replace(start, position=(lat + 2000.0 * draw.normal() / 6.3625e6, position[1], h))
        where = body.place_ecef(np.array([[-110_000.0, 0.0, 0.0]]))
        n = second.size
        slant = 110_000.0 + 90.0 * draw.normal() + 150.0 * draw.normal(size=n)
        dme = ins.DmeRanges(second, np.zeros(n, int), np.tile(where, (n, 1)), slant, 150.0, 90.0)
        fused = ins.fuse(still.imu, ins.Aiding(dme=dme), start)
        error, p = body.error_enu(fused)[-1, :2], fused.covariance_enu_m2[-1, :2, :2]
        nees.append(float(error @ np.linalg.solve(p, error)))
    # 60 samples of two degrees: 2 within 3 * sqrt(4 / 60).
    assert abs(np.mean(nees) - 2.0) < 3 * np.sqrt(4 / 60)


def test_a_wild_measurement_is_gated_and_a_meaningless_one_refused() -> None:
    still = body.standing(9, 30.0)
    second = still.time_ns[9::10]
    height = np.full(second.size, body.PLACE[2])
    height[10], height[20] = 5_000.0, np.nan
    fused = ins.fuse(still.imu, ins.Aiding(baro=ins.BaroHeights(second, height, 5.0, 30.0, 3600.0)), still.start)
    baro = fused.innovations["baro"]
    assert (baro.n_used, baro.n_gated, baro.n_refused) == (28, 1, 1)


def test_the_update_rate_and_shared_steps_are_options() -> None:
    still = body.standing(10, 60.0)
    second = still.time_ns[9::10]
    aiding = ins.Aiding(baro=ins.BaroHeights(second, body.PLACE[2], 5.0, 30.0, 3600.0))
    every = ins.fuse(still.imu, aiding, still.start)
    assert ins.fuse(still.imu, aiding, still.start, update_period_s=5.0).innovations["baro"].n_used == 12
    shared = ins.fuse(still.imu, aiding, still.start, settings=ins.FilterSettings(samples_per_step=5))
    # Half a second a step instead of a tenth: F² dt²/2 is kept where it matters, so sigmas agree to some 1e-3.
    np.testing.assert_allclose(shared.covariance_enu_m2[-1].diagonal(), every.covariance_enu_m2[-1].diagonal(), rtol=2e-3)


@pytest.mark.parametrize(
    ("change", "argument"),
    [
        ({"gate_risk": 0.0}, "gate_risk"),
        ({"samples_per_step": 0}, "samples_per_step"),
        ({"gap_most_s": -1.0}, "gap_most_s"),
        ({"lever_arm_m": (np.nan, 0.0, 0.0)}, "lever_arm_m"),
    ],
)
def test_settings_outside_their_domain_are_refused(change: dict[str, float], argument: str) -> None:
    still = body.standing(11, 1.0)
    with pytest.raises(InputError) as refusal:
        ins.fuse(still.imu, ins.Aiding(), still.start, settings=replace(ins.FilterSettings(), **change))  # type: ignore[arg-type]
    assert refusal.value.argument == argument


def test_wrong_tables_and_starts_are_refused_by_name() -> None:
    still = body.standing(12, 1.0)
    with pytest.raises(InputError, match="lat_rad"):
        ins.mechanize(still.imu, replace(still.start, position=(1.5705, 0.0, 0.0)))
    with pytest.raises(InputError, match="angle_rad"):
        ins.mechanize(ins.Imu(still.time_ns, np.full((10, 3), np.nan), np.zeros((10, 3)), 0.1), still.start)
    with pytest.raises(InputError, match="time_ns"):
        ins.mechanize(ins.Imu(still.time_ns[::-1], np.zeros((10, 3)), np.zeros((10, 3)), 0.1), still.start)
    with pytest.raises(InputError, match="velocity_mps"):
        ins.Imu(still.time_ns, np.zeros((10, 3)), np.zeros((9, 3))).columns()
    with pytest.raises(InputError, match="satellite"):
        ins.SatelliteRanges(still.time_ns[:1], ["X?"], np.zeros(3), np.zeros(3), 1.0, 1.0, 1.0, 1.0).table()


def test_a_body_at_rest_is_levelled_and_takes_its_heading_from_its_course() -> None:
    c = np.asarray(oracle.ned_from_body(np.array([[0.1, -0.2, 0.7]])), dtype=np.float64)[0]
    roll, pitch, heading = ins.coarse_attitude(c.T @ [0.0, 0.0, -9.8], [3.0 * np.cos(0.7), 3.0 * np.sin(0.7), 0.0])
    assert (roll, pitch, heading) == pytest.approx((0.1, -0.2, 0.7), abs=1e-12)
