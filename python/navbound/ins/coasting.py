"""How long an inertial unit keeps the position without aids: one channel of it, and drift rates as regulations state them.

```text
dr' = dv        dv' = -g phi + b + w_a        phi' = dv / R + eps + w_g        b, eps constant
```

Two equal channels without correlation have a 95 % circle of 2.4477 sigma. The tilt that an alignment leaves is ``b / g``: tilt and bias are
correlated by nearly +1, and cancel in ``dv'``. docs/methods/prediction.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from navbound.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

GRAVITY_MPS2 = 9.80665
RADIUS_M = 6_371_000.0
CIRCLE_95 = math.sqrt(-2.0 * math.log(0.05))
"""95 % radius of two equal, independent channels over the deviation of one."""
CROSS_95 = 1.959963984540054
"""The same across a line."""
Rule = Literal["epu", "rss", "exact"]
STEP_S = 60.0
"""Step of the series; the covariance is exact at its ends. [s]"""
_HALVINGS = 8
_TERMS = 14


@dataclass(frozen=True)
class Channel:
    """One horizontal channel when its aids are lost, and the noise of its sensors.

    Attributes
    ----------
    sigma_r_m, sigma_v_mps, sigma_tilt_rad : float
        Standard deviations of position, velocity and tilt. [m, m/s, rad]
    sigma_accel_bias_mps2, sigma_gyro_radps : float
        Of the biases. [m/s², rad/s]
    correlation_tilt_bias : float
        Correlation of tilt and accelerometer bias. [1]
    accel_noise_mpsprts, gyro_noise_radprts : float
        White noise. [m/s/√s, rad/√s]
    """

    sigma_r_m: float
    sigma_v_mps: float
    sigma_tilt_rad: float
    sigma_accel_bias_mps2: float
    sigma_gyro_radps: float
    correlation_tilt_bias: float
    accel_noise_mpsprts: float
    gyro_noise_radprts: float

    def __post_init__(self) -> None:
        """Refuse a negative or infinite deviation, and a correlation outside [-1, 1]."""
        for name in self.__dataclass_fields__:
            value = getattr(self, name)
            low, high = (-1.0, 1.0) if name == "correlation_tilt_bias" else (0.0, math.inf)
            if not (low <= value <= high and math.isfinite(value)):
                raise InputError(name, value, domain="[-1, 1]" if high == 1.0 else "[0, inf)")

    def covariance(self) -> Floats:
        """Covariance of position, velocity, tilt, accelerometer bias and gyro drift at the loss, shape (5, 5)."""
        sigma = [self.sigma_r_m, self.sigma_v_mps, self.sigma_tilt_rad, self.sigma_accel_bias_mps2, self.sigma_gyro_radps]
        covariance = np.diag(np.square(sigma))
        covariance[2, 3] = covariance[3, 2] = self.correlation_tilt_bias * self.sigma_tilt_rad * self.sigma_accel_bias_mps2
        return np.asarray(covariance, dtype=np.float64)


def system() -> Floats:
    """The matrix of the differential equation, shape (5, 5)."""
    f = np.zeros((5, 5))
    f[0, 1] = 1.0
    f[1, 2], f[1, 3] = -GRAVITY_MPS2, 1.0
    f[2, 1], f[2, 4] = 1.0 / RADIUS_M, 1.0
    return f


def sigmas(channel: Channel, time_s: Sequence[float] | Floats) -> tuple[Floats, Floats]:
    """Standard deviations of position and velocity at times after the loss.

    Parameters
    ----------
    channel : Channel
        What it begins with.
    time_s : sequence of float, shape (n,)
        Times, rising, zero or more. [s]

    Returns
    -------
    sigma_m, sigma_v_mps : ndarray, shape (n,)
        Of one channel. [m, m/s]

    Raises
    ------
    InputError
        Times that fall, are negative or not finite.
    """
    times = np.asarray(time_s, dtype=np.float64)
    if not (np.isfinite(times).all() and (times >= 0).all() and (np.diff(times) >= 0).all()):
        raise InputError("time_s", str(time_s), "s", "rising times of [0, inf)")
    covariance, now = channel.covariance(), 0.0
    positions, velocities = [], []
    for until in times:
        while now < until:
            step = min(STEP_S, until - now)
            phi, noise = _step(channel, step)
            covariance = phi @ covariance @ phi.T + noise
            now += step
        positions.append(math.sqrt(covariance[0, 0]))
        velocities.append(math.sqrt(covariance[1, 1]))
    return np.array(positions), np.array(velocities)


def circles(channel: Channel, time_s: Sequence[float] | Floats) -> Floats:
    """95 % circle of two such channels. [m]."""
    return np.asarray(CIRCLE_95 * sigmas(channel, time_s)[0], dtype=np.float64)


def _step(channel: Channel, step_s: float) -> tuple[Floats, Floats]:
    """Transition and noise over a step: a Taylor series of a small part of it, doubled."""
    f, h = system(), step_s / 2**_HALVINGS
    density = np.diag([0.0, channel.accel_noise_mpsprts**2, channel.gyro_noise_radprts**2, 0.0, 0.0])
    phi, term = np.eye(5), np.eye(5)
    noise, rate = density * h, density
    for k in range(1, _TERMS):
        term = term @ f * (h / k)
        phi = phi + term
        # d^k/dt^k of the noise: the Lyapunov operator again and again.
        rate = (f @ rate + rate @ f.T) * (h / (k + 1))
        noise = noise + rate * h
    for _ in range(_HALVINGS):
        noise = phi @ noise @ phi.T + noise
        phi = phi @ phi
    return phi, noise


def allowed_m(rnp_m: float, fte95_m: float, rule: Rule) -> float:
    """Largest 95 % circle of the navigation error that a rule allows.

    ``epu``: the RNP itself. ``rss``: ``sqrt(RNP² - FTE²)``. ``exact``: 1.24887 times that, since the RNP is 95 % across the path, where a
    normal error has 1.9600 sigma and the circle 2.4477.

    Raises
    ------
    InputError
        An RNP that is not positive, a flight technical error outside [0, RNP) where the rule takes it.
    """
    if not (rnp_m > 0 and math.isfinite(rnp_m)):
        raise InputError("rnp_m", rnp_m, "m", "(0, inf)")
    if rule == "epu":
        return rnp_m
    if not 0 <= fte95_m < rnp_m:
        raise InputError("fte95_m", fte95_m, "m", "[0, rnp_m)")
    return math.sqrt(rnp_m**2 - fte95_m**2) * (CIRCLE_95 / CROSS_95 if rule == "exact" else 1.0)


def drift_hold_s(rnp_m: float, fte95_m: float, epu0_m: float, drift_mps: float, rule: Rule) -> float:
    """Time that a 95 % circle of ``sqrt(EPU0² + (drift t)²)`` stays within what a rule allows; 0 where it never is. [s].

    Raises
    ------
    InputError
        As :func:`allowed_m`; a drift that is not positive, a negative start.
    """
    if not (drift_mps > 0 and math.isfinite(drift_mps)):
        raise InputError("drift_mps", drift_mps, "m/s", "(0, inf)")
    if not 0 <= epu0_m < math.inf:
        raise InputError("epu0_m", epu0_m, "m", "[0, inf)")
    left = allowed_m(rnp_m, fte95_m, rule) ** 2 - epu0_m**2
    return math.sqrt(left) / drift_mps if left > 0 else 0.0


def coasting_hold_s(channel: Channel, limit_m: float, longest_s: float, step_s: float = STEP_S) -> float | None:
    """First time at which the 95 % circle exceeds a limit, to the step; None where it does not within the longest. [s].

    Raises
    ------
    InputError
        A limit, a step or a longest time that is not positive.
    """
    for name, value, unit in (("limit_m", limit_m, "m"), ("step_s", step_s, "s"), ("longest_s", longest_s, "s")):
        if not (value > 0 and math.isfinite(value)):
            raise InputError(name, value, unit, "(0, inf)")
    times = np.arange(0.0, longest_s + step_s / 2, step_s)
    beyond = np.flatnonzero(circles(channel, times) > limit_m)
    return float(times[beyond[0]]) if len(beyond) else None


MICRO_G = 1e-6 * GRAVITY_MPS2
DEG_PER_HOUR = math.radians(1.0) / 3600.0

AIDED = Channel(3.0, 0.02, 22e-6, 20 * MICRO_G, 0.005 * DEG_PER_HOUR, 0.95, 20 * MICRO_G, math.radians(0.001) / 60)
"""Navigation grade, aided by satellites until the loss. Provenance: inferred."""
SPECIFICATION = Channel(10.0, 0.1, 50e-6, 50 * MICRO_G, 0.01 * DEG_PER_HOUR, 0.98, 50 * MICRO_G, math.radians(0.002) / 60)
"""Navigation grade by its specification. Provenance: inferred."""
