"""Satellite geometry: reference cases, the published set-up of a coverage study, and an independent least squares."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pytest

from navbound import InputError, gnss, verify

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

DEG = np.pi / 180


@pytest.mark.parametrize("name", ["gnss-geometry", "gnss-dop"])
def test_reference_cases(name: str) -> None:
    outcome = verify.run(verify.load(verify.VECTORS / f"{name}.toml"))
    assert outcome.checked == 3
    assert not outcome.failures


def test_the_coverage_study_sees_the_published_geometry() -> None:
    # Our specification 8.1, made with another program: 6 to 11 satellites (mean 7.6), s mean 8.51 m in [5.73, 11.26], sigma_max mean
    # 10.30 m, ratio mean 1.215 up to 2.255. Means are printed to three digits and come from a slightly different sampling of the day:
    # 0.2 %. Its largest s fell between our samples' satellites rising, so only the smallest is compared.
    t = np.arange(0.0, 86_164.0, 60.0)
    sky = gnss.geometry(gnss.constellation("gps"), 30.43 * DEG, 103.45 * DEG, 800.0, t, mask_rad=5 * DEG)
    assert (sky.n_sv.min(), sky.n_sv.max()) == (6, 11)
    assert abs(sky.n_sv.mean() - 7.6) < 0.05
    solution = gnss.covariance(sky.az_rad, sky.el_rad, 12.5)
    assert set(solution.status.tolist()) == {"ok"}
    course = 13.369 * DEG
    right = np.array([np.cos(course), -np.sin(course)])
    s = np.sqrt(np.einsum("i,tij,j->t", right, solution.enu_m2[:, :2, :2], right))
    assert abs(s.mean() / 8.51 - 1) < 0.002
    assert abs(s.min() / 5.73 - 1) < 0.002
    assert abs(solution.sigma_major_m.mean() / 10.30 - 1) < 0.002
    assert abs((solution.sigma_major_m / s).mean() / 1.215 - 1) < 0.002
    assert abs((solution.sigma_major_m / s).max() / 2.255 - 1) < 0.002


def test_covariance_agrees_with_an_independent_least_squares() -> None:
    # NumPy's pseudo-inverse of the whole weighted design matrix; both lose about the condition of H'WH, below 1e4 here.
    rng = np.random.default_rng(20261121)
    for _ in range(50):
        n = 14
        az, el = rng.uniform(0, 2 * np.pi, n), rng.uniform(5 * DEG, 90 * DEG, n)
        sigma = rng.uniform(0.5, 8.0, n)
        system = np.array([0] * 7 + [3] * 7)
        h = np.stack([-np.cos(el) * np.sin(az), -np.cos(el) * np.cos(az), -np.sin(el), system == 0, system == 3], axis=-1)
        pinv = np.linalg.pinv(h / sigma[:, None])
        expected = (pinv @ pinv.T)[:3, :3]
        solution = gnss.covariance(az, el, sigma, system)
        np.testing.assert_allclose(solution.enu_m2, expected, rtol=1e-8, atol=1e-10 * np.abs(expected).max())
        unweighted = np.linalg.pinv(h)
        q = np.diag(unweighted @ unweighted.T)
        dop = gnss.dop(az, el, system)
        np.testing.assert_allclose([dop.edop**2, dop.ndop**2, dop.vdop**2], q[:3], rtol=1e-8)
        np.testing.assert_allclose(dop.pdop**2, q[:3].sum(), rtol=1e-8)


def test_turning_the_sky_turns_the_covariance() -> None:
    az, el = np.array([10, 60, 120, 200, 250, 310.0]) * DEG, np.array([65, 20, 35, 15, 50, 28.0]) * DEG
    turn = 37 * DEG
    a, b = gnss.covariance(az, el, 5.0).enu_m2, gnss.covariance(az + turn, el, 5.0).enu_m2
    # Azimuths grow clockwise, from north to east.
    r = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    np.testing.assert_allclose(b, r @ a @ r.T, atol=1e-12 * a.max())


def test_route_geometry_is_near_the_published_averages() -> None:
    # Our specification 6.3: 19.6 satellites above 7 deg, 7.3 of them GPS, mean DOP north, east, down 0.480, 0.451, 0.962. Theirs is one
    # flight of two hours, ours a day along the route; phases of BeiDou differ: 10 %.
    both = gnss.constellation("gps") + gnss.constellation("beidou")
    t = np.arange(0.0, 86_164.0, 60.0)
    share = np.linspace(0, 1, t.size)
    sky = gnss.geometry(both, (40.07 - 8.87 * share) * DEG, (116.6 + 4.74 * share) * DEG, 8_900.0, t, mask_rad=7 * DEG)
    dop = gnss.dop(sky.az_rad, sky.el_rad, both.constellation)
    n_gps = sky.visible[:, both.constellation == 0].sum(axis=1)
    result = [sky.n_sv.mean(), n_gps.mean(), dop.ndop.mean(), dop.edop.mean(), dop.vdop.mean()]
    np.testing.assert_allclose(result, [19.6, 7.3, 0.480, 0.451, 0.962], rtol=0.1)


def test_too_few_and_singular_are_statuses_with_reasons() -> None:
    az = np.array([[0, 60, 120, 180, 240], [0, 60, 120, np.nan, np.nan], [0, 60, 120, 180, 250]]) * DEG
    el = np.array([[30.0] * 5, [30, 40, 50, np.nan, np.nan], [30, 40, 50, 60, 20]]) * DEG
    solution = gnss.covariance(az, el, 1.0)
    assert solution.status.tolist() == ["not_available", "not_available", "ok"]
    assert "singular" in solution.reason[0]
    assert solution.reason[1] == "4 satellites are needed, 3 are usable"
    assert np.isnan(solution.enu_m2[:2]).all()
    assert np.isfinite(solution.enu_m2[2]).all()
    assert solution.n_sv.tolist() == [5, 3, 5]


def test_own_elements_give_the_shipped_constellation_back() -> None:
    gps = gnss.constellation("gps")
    own = gnss.nominal(gps.semi_major_m, gps.inclination_rad, gps.node_rad, gps.mean_anomaly_rad)
    t = np.array([0.0, 5_000.0])
    for a, b in zip(gnss.directions(gps, 0.5, 1.8, 0.0, t), gnss.directions(own, 0.5, 1.8, 0.0, t), strict=True):
        np.testing.assert_array_equal(a, b)
    assert own.satellite == gps.satellite


def test_four_slots_a_plane_and_six_planes() -> None:
    gps = gnss.constellation("gps")
    nodes, counts = np.unique(gps.node_rad, return_counts=True)
    assert counts.tolist() == [4] * 6
    np.testing.assert_allclose(np.diff(nodes), 60 * DEG, atol=1e-12)


def test_the_satellites_of_a_year_stand_in_the_expanded_slots(shared_data: Path) -> None:
    """The almanac of January 2020, turned as a whole: nodes and arguments of latitude drift together."""
    path = shared_data.parent / "reference" / "almanacs.json"
    if not path.is_file():
        pytest.skip(f"{path} is not here: the expanded slots are not compared with satellites")
    year = json.loads(path.read_text(encoding="utf-8"))["almanacs"]["gps31_operational_2020"]
    m, e, perigee, node = (np.array([s[name] for s in year]) for name in ("M0", "e", "omega", "Omega0"))
    latitude = np.degrees(m + 2 * e * np.sin(m) + perigee)
    slots = gnss.constellation("gps-expanded")

    def turned(angle: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray((angle + 180.0) % 360.0 - 180.0)

    def away(along: float, nodes: float) -> NDArray[np.float64]:
        # A satellite of another plane is none of this slot.
        off = turned(np.degrees(node)[:, None] - np.degrees(slots.node_rad) - nodes)
        result = np.abs(turned(latitude[:, None] - np.degrees(slots.mean_anomaly_rad) - along))
        return np.asarray(np.where(np.abs(off) < 25.0, result, 180.0).min(axis=0))

    best = min((away(a, n) for a in range(0, 360, 2) for n in range(0, 360, 8)), key=lambda d: float(np.minimum(d, 20.0).sum()))
    split = [slots.satellite.index(name) for name in ("G05", "G06", "G15", "G16", "G24", "G25")]
    # A satellite drifts by some degrees from its slot before it is brought back; one slot of that year was held 10 degrees off.
    assert best[split].max() < 6.0
    assert np.sort(best)[-2] < 6.0
    # 31 satellites over six planes: by chance a slot would have one within 6 degrees in 17 of 100 cases.
    assert (best < 6.0).sum() >= 26


def test_responses_are_the_rows_of_least_squares() -> None:
    rng = np.random.default_rng(8)
    az, el, sigma = rng.uniform(0, 2 * np.pi, (4, 12)), rng.uniform(0.2, 1.4, (4, 12)), rng.uniform(0.3, 2.0, (4, 12))
    az[1, 4] = el[1, 4] = np.nan
    az[3, 3:] = el[3, 3:] = np.nan
    systems = np.array([0] * 6 + [2] * 6)
    responses = gnss.responses(az, el, sigma, systems)
    for k in range(3):
        used = ~np.isnan(az[k])
        line = np.stack([np.cos(el[k]) * np.sin(az[k]), np.cos(el[k]) * np.cos(az[k]), np.sin(el[k])], axis=-1)[used]
        h = np.concatenate([-line, (systems[used, None] == [0, 2]).astype(float)], axis=1) / sigma[k, used, None]
        expected = np.zeros((3, 12))
        expected[:, used] = np.linalg.pinv(h)[:3] / sigma[k, used]
        # Rounding of a five by five system of condition some hundreds.
        np.testing.assert_allclose(responses[k], expected, atol=1e-11)
    assert np.isnan(responses[3]).all()


def test_places_along_sights_are_seen_where_they_were_put() -> None:
    az, el = np.array([[0.3, 2.0, 4.0], [1.0, np.nan, 5.0]]), np.array([[0.2, 0.9, 1.5], [0.4, np.nan, 0.1]])
    here, there = (gnss.places([0.7, -0.2], [0.1, 2.0], [10.0, 500.0], az, el, d) for d in (0.0, 2e7))
    np.testing.assert_allclose(gnss.geodetic(here[0, 0]), [0.7, 0.1, 10.0], atol=1e-9)
    up = np.array([np.cos(0.7) * np.cos(0.1), np.cos(0.7) * np.sin(0.1), np.sin(0.7)])
    # The sine of the elevation is the part along the ellipsoid's normal, which is what latitude counts from.
    np.testing.assert_allclose((there - here)[0] @ up / 2e7, np.sin(el[0]), atol=1e-12)
    east = np.array([-np.sin(0.1), np.cos(0.1), 0.0])
    np.testing.assert_allclose((there - here)[0] @ east / 2e7, np.cos(el[0]) * np.sin(az[0]), atol=1e-12)
    assert np.isnan(there[1, 1]).all()
    with pytest.raises(InputError, match="az_rad"):
        gnss.places([0.7], [0.1], [0.0], az, el, 1.0)


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: gnss.constellation("glonass"), "name"),
        (lambda: gnss.nominal(2.6e7, 1, 0, 0, system="x"), "system"),
        (lambda: gnss.directions(gnss.nominal(1.0, 1, 0, 0), 0, 0, 0, 0), "semi_major_m"),
        (lambda: gnss.directions(gnss.nominal(2.6e7, 1, 0, 0, eccentricity=1.0), 0, 0, 0, 0), "eccentricity"),
        (lambda: gnss.directions(gnss.constellation("gps"), 2.0, 0, 0, 0), "lat_rad"),
        (lambda: gnss.directions(gnss.constellation("gps"), 0, 0, np.nan, 0), "h_m"),
        (lambda: gnss.directions(gnss.constellation("gps"), 0, 0, 0, np.inf), "time_s"),
        (lambda: gnss.geometry(gnss.constellation("gps"), 0, 0, 0, 0, mask_rad=2.0), "mask_rad"),
        (lambda: gnss.geometry(gnss.constellation("gps"), 0, 0, 0, 0, mask_rad=np.nan), "mask_rad"),
        (lambda: gnss.covariance([0.1] * 5, [0.2] * 5, 0.0), "sigma_m"),
        (lambda: gnss.covariance([0.1] * 5, [0.2] * 5, np.nan), "sigma_m"),
        (lambda: gnss.covariance([0.1] * 5, [1.6] * 5, 1.0), "el_rad"),
        (lambda: gnss.covariance([np.inf] * 5, [0.2] * 5, 1.0), "az_rad"),
        (lambda: gnss.covariance(0.1, 0.2, 1.0), "az_rad"),
        (lambda: gnss.covariance([0.1] * 5, [0.2] * 5, 1.0, [0, 0]), "constellation"),
        (lambda: gnss.covariance([0.1] * 5, [0.2] * 5, 1.0, [0, 0, 0, 0, 9]), "constellation"),
    ],
)
def test_what_is_wrong_is_named(call, argument) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert caught.value.argument == argument
