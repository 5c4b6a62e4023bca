"""A flight in closed form and what an inertial unit feels on it: Earth-centred, by differences of 64-bit mantissas.

Nothing of the mechanization's equations is here: position and attitude are functions of time, their derivatives are taken numerically in
Earth-fixed axes, and the Earth's turn enters as a vector there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

L = np.longdouble
A, F = L(6378137), 1 / L("298.257223563")
E2 = F * (2 - F)
RATE = L("7.292115e-5")
G_EQUATOR, K, M = L("9.7803253359"), L("0.00193185265241"), L("0.00344978650684")
# Seven-point differences of step h: truncation (h w)^6 / 140 of the derivative, rounding 1e-12 m / h^2 of an acceleration.
STEP = L("0.1")
FIRST = np.array([-1, 9, -45, 0, 45, -9, 1], dtype=L) / 60
SECOND = np.array([2, -27, 270, -490, 270, -27, 2], dtype=L) / 180
# Gauss-Legendre of four points.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class Flight:
    """Increments and truth at the samples."""

    time_s: NDArray[np.float64]
    angle_rad: NDArray[np.float64]
    velocity_mps: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity_ned_mps: NDArray[np.float64]
    attitude_rad: NDArray[np.float64]


def winding(t: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """An aircraft that weaves, climbs and banks: latitude, longitude, height; roll, pitch, heading."""
    lat = L("0.72") + t * L("2.5e-5") + L("2e-5") * np.sin(t / 40)
    lon = L("1.9") + t * L("1.5e-5") + L("4e-5") * np.cos(t / 55)
    height = 3000 + 4 * t + 150 * np.sin(t / 70)
    roll = L("0.4") * np.sin(t / 13)
    pitch = L("0.05") + L("0.1") * np.sin(t / 17 + 1)
    heading = L("0.6") + L("0.9") * np.sin(t / 31)
    return np.stack([lat, lon, height], -1), np.stack([roll, pitch, heading], -1)


def standing(t: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """At rest on the ground."""
    zero = np.zeros_like(t)
    return np.stack([zero + L("0.72"), zero + L("1.9"), zero + 100], -1), np.stack([zero + L("0.02"), zero - L("0.03"), zero + 1], -1)


def ecef(p: NDArray[Any]) -> NDArray[Any]:
    """Earth-centred position."""
    lat, lon, h = p[..., 0], p[..., 1], p[..., 2]
    n = A / np.sqrt(1 - E2 * np.sin(lat) ** 2)
    return np.stack([(n + h) * np.cos(lat) * np.cos(lon), (n + h) * np.cos(lat) * np.sin(lon), (n * (1 - E2) + h) * np.sin(lat)], -1)


def ecef_from_ned(p: NDArray[Any]) -> NDArray[Any]:
    """Columns north, east, down."""
    lat, lon = p[..., 0], p[..., 1]
    zero = np.zeros_like(lat)
    north = np.stack([-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)], -1)
    east = np.stack([-np.sin(lon), np.cos(lon), zero], -1)
    down = np.stack([-np.cos(lat) * np.cos(lon), -np.cos(lat) * np.sin(lon), -np.sin(lat)], -1)
    return np.stack([north, east, down], -1)


def ned_from_body(a: NDArray[Any]) -> NDArray[Any]:
    """Heading, then pitch, then roll."""
    (cr, cp, ch), (sr, sp, sh) = np.moveaxis(np.cos(a), -1, 0), np.moveaxis(np.sin(a), -1, 0)
    rows = [
        [cp * ch, sr * sp * ch - cr * sh, cr * sp * ch + sr * sh],
        [cp * sh, sr * sp * sh + cr * ch, cr * sp * sh - sr * ch],
        [-sp, sr * cp, cr * cp],
    ]
    return np.stack([np.stack(row, -1) for row in rows], -2)


def gravity(p: NDArray[Any]) -> NDArray[Any]:
    """Downwards, centrifugal part included: Somigliana and second order in height."""
    s2, h = np.sin(p[..., 0]) ** 2, p[..., 2] / A
    return np.asarray(G_EQUATOR * (1 + K * s2) / np.sqrt(1 - E2 * s2) * (1 - 2 * (1 + F + M - 2 * F * s2) * h + 3 * h * h))


def felt(motion: Callable[[NDArray[Any]], tuple[NDArray[Any], NDArray[Any]]], t: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Angular rate against inertial space and specific force, body axes, at instants."""
    around = t[..., None] + STEP * np.arange(-3, 4)
    position, attitude = motion(around)
    x, c = ecef(position), ecef_from_ned(position) @ ned_from_body(attitude)
    velocity = np.einsum("...kj,k->...j", x, FIRST) / STEP
    acceleration = np.einsum("...kj,k->...j", x, SECOND) / STEP**2
    turning = np.einsum("...kij,k->...ij", c, FIRST) / STEP
    here, at = c[..., 3, :, :], position[..., 3, :]
    spin = np.einsum("...ki,...kj->...ij", here, turning)
    earth = np.array([0, 0, RATE], dtype=L)
    rate = np.stack([spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]], -1) + np.einsum("...ki,k->...i", here, earth)
    pull = ecef_from_ned(at)[..., 2] * gravity(at)[..., None]
    force = acceleration + 2 * np.cross(earth, velocity) - pull
    return rate, np.einsum("...ki,...k->...i", here, force)


def fly(motion: Callable[[NDArray[Any]], tuple[NDArray[Any], NDArray[Any]]], duration_s: float, rate_hz: int) -> Flight:
    """Increments over every sample, and the truth at its end; the first row is the start, without increments."""
    n = round(duration_s * rate_hz)
    end = np.arange(n + 1, dtype=L) / rate_hz
    half = L(1) / (2 * rate_hz)
    nodes = (end[1:] - half)[:, None] + half * NODES
    rate, force = felt(motion, nodes)
    weights = half * WEIGHTS
    zero = np.zeros((1, 3))
    angle, velocity = (np.concatenate([zero, np.einsum("nkj,k->nj", v, weights)]) for v in (rate, force))
    position, attitude = motion(end)
    around, _ = motion(end[:, None] + STEP * np.arange(-3, 4))
    ned = np.einsum("nij,ni->nj", ecef_from_ned(position), np.einsum("nkj,k->nj", ecef(around), FIRST) / STEP)
    return Flight(*(np.asarray(v, dtype=np.float64) for v in (end, angle, velocity, position, ned, attitude)))
