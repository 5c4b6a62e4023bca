"""The covariance of ranges with an inertial system against a plain filter: the exact matrix exponential and whole matrices."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from scipy.linalg import block_diag, expm

from navbound import gbas

AZ = np.radians([10.0, 60.0, 120.0, 180.0, 230.0, 290.0, 330.0])
EL = np.radians([70.0, 25.0, 40.0, 15.0, 55.0, 20.0, 35.0])
EARTH_RADPS, GRAVITY, EARTH_M, LIGHT = 7.292115e-5, 9.80665, 6_371_000.0, 299_792_458.0
MULTIPATH_S = {"D": (26.0, 2315.0), "F": (54.0, 2894.0)}


def skew(x: float, y: float, z: float) -> np.ndarray:
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def dynamics(lat: float) -> np.ndarray:
    """Equation 3: position, velocity, attitude, accelerometer and gyro bias, clock, its rate, the second clock's offset."""
    one, none = np.eye(3), np.zeros((3, 3))
    turn = skew(0.0, EARTH_RADPS * np.cos(lat), EARTH_RADPS * np.sin(lat))
    gradient = GRAVITY / EARTH_M * np.diag([-1.0, -1.0, 2.0])
    unit = np.block(
        [
            [none, one, none, none, none],
            [gradient, -2.0 * turn, -skew(0.0, 0.0, GRAVITY), -one, none],
            [none, none, -turn, none, -one],
            [np.zeros((6, 15))],
        ]
    )
    return np.asarray(block_diag(unit, np.array([[0.0, 1.0], [0.0, 0.0]]), np.zeros((1, 1))))


def plain(
    az: np.ndarray, el: np.ndarray, second: np.ndarray, *, lat: float, service: Literal["D", "F"], noise: str, seconds: int
) -> np.ndarray:
    n, sigma, unit = len(az), gbas.range_sigma(el, service), gbas.inertial()
    shortest, longest = MULTIPATH_S[service]
    multipath = sigma.ground_m**2 + sigma.air_m**2
    drive, begin = (1.0, 1.0) if noise == "paper" else (longest / shortest, 2.0 / (1.0 + shortest / longest))
    kept = np.exp(-1.0 / longest)
    transition = block_diag(expm(dynamics(lat)), kept * np.eye(n))
    power = np.concatenate(
        [np.zeros(3), np.full(3, unit.accelerometer_walk_mpsprts**2), np.full(3, unit.gyro_walk_radprts**2), np.zeros(6),
         [LIGHT**2 * unit.clock_h0_s / 2.0, LIGHT**2 * 2.0 * np.pi**2 * unit.clock_h_minus_2_per_s], np.zeros(1 + n)]
    )  # fmt: skip
    added = 0.5 * (np.diag(power) + transition @ np.diag(power) @ transition.T)
    added += block_diag(np.zeros((18, 18)), np.diag(drive * multipath * (1.0 - kept**2)))
    start = np.repeat([100.0, 10.0, 0.02, unit.accelerometer_bias_mps2, unit.gyro_bias_radps], 3)
    other = 1e4 if second.any() else 0.0
    p = np.diag(np.concatenate([np.concatenate([start, [1e4, 10.0, other]]) ** 2, begin * multipath]))
    sight = -np.column_stack([np.cos(el) * np.sin(az), np.cos(el) * np.cos(az), np.sin(el)])
    ranges = np.hstack([sight, np.zeros((n, 12)), np.ones((n, 1)), np.zeros((n, 1)), second[:, None].astype(float), np.eye(n)])
    rates = np.hstack([np.zeros((n, 3)), sight, np.zeros((n, 10)), np.ones((n, 1)), np.zeros((n, 1 + n))])
    h = np.vstack([ranges, rates])
    white = sigma.troposphere_m**2 + sigma.ionosphere_m**2 + unit.receiver_noise_m**2
    r = np.diag(np.concatenate([white, np.full(n, unit.doppler_mps**2)]))
    for k in range(seconds + 1):
        if k > 0:
            p = transition @ p @ transition.T + added
        gain = np.linalg.solve(h @ p @ h.T + r, h @ p).T
        rest = np.eye(len(p)) - gain @ h
        p = rest @ p @ rest.T + gain @ r @ gain.T
    return np.asarray(p[:3, :3])


@pytest.mark.parametrize("noise", ["paper", "bound"])
@pytest.mark.parametrize("service", ["D", "F"])
@pytest.mark.parametrize("second", [[0] * 7, [0, 1, 0, 1, 0, 1, 0]])
def test_the_filter_is_the_plain_one(second: list[int], service: Literal["D", "F"], noise: Literal["paper", "bound"]) -> None:
    for seconds in (0, 1, 60):
        solution = gbas.aided_covariance(AZ, EL, second, lat_rad=0.72, service=service, noise=noise, seconds=seconds)
        expected = plain(AZ, EL, np.array(second) > 0, lat=0.72, service=service, noise=noise, seconds=seconds)
        # The updates cancel 1e8 m² of clock variance down to 0.1 m², which leaves 1e-7; the exponential's fourth order is smaller.
        assert np.abs(solution - expected).max() < 3e-7 * np.abs(expected).max(), seconds


def test_the_inertial_system_alone_drifts_as_the_plain_one() -> None:
    """Two ranges cannot hold the position: what gravity, the Earth's turning and the gyros do to it shows."""
    az, el = AZ[:2], EL[:2]
    solution = gbas.aided_covariance(az, el, lat_rad=-0.9, noise="bound", seconds=600)
    expected = plain(az, el, np.zeros(2), lat=-0.9, service="D", noise="bound", seconds=600)
    # Without the bounds of other ranges the clock's 1e8 m² of variance stays in every element.
    assert np.abs(solution / expected - 1.0).max() < 1e-4
