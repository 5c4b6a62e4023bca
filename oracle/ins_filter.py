"""The navigation filter transcribed in Earth-fixed axes: dense matrices, matrix exponentials, no feedback; slow, for vectors only.

A flight along a parallel at constant speed: inertial unit and attitude against north, east, down never change, and their increments have a
closed form. Errors are carried in Earth-fixed axes (the psi-angle of the Earth-fixed mechanization, gravity differentiated numerically) and
turned into the local errors of the product only at the start and at the end: nothing of its north-east-down dynamics is here.

``python oracle/ins_filter.py`` writes vectors/ins-fuse.toml.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import block_diag, expm

import ins_truth as truth

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

LAT, LON, HEIGHT, SPEED = 0.7, 1.9, 9000.0, 240.0
ATTITUDE = (0.1, 0.05, 1.2)
POSITION_SIGMA, VELOCITY_SIGMA, ATTITUDE_SIGMA = (10.0, 12.0, 15.0), 0.2, (2e-4, 3e-4, 1e-3)
GYRO, ACCELEROMETER = (1e-5, 2e-6, 900.0), (1e-3, 5e-3, 600.0)
"""White, bias, its time."""
BARO = (5.0, 30.0, 3600.0)
CLOCK = (1e4, 100.0, 0.009, 0.0355)
"""Bias, drift, density of the frequency, of its walk."""
STEP, DURATION = 0.25, 40.0
RATE = float(truth.RATE)


def doubles(values: Any) -> Floats:
    return np.asarray(values, dtype=np.float64)


def place(t: float) -> Floats:
    """Latitude, longitude, height."""
    _, ring = radii()
    return np.array([LAT, LON + SPEED * t / ring, HEIGHT])


def radii() -> tuple[float, float]:
    """Meridian radius and distance from the axis."""
    a, e2 = float(truth.A), float(truth.E2)
    w = 1 - e2 * np.sin(LAT) ** 2
    return a * (1 - e2) / w**1.5 + HEIGHT, (a / np.sqrt(w) + HEIGHT) * np.cos(LAT)


def ned_axes(t: float) -> Floats:
    """Columns north, east, down, Earth-fixed."""
    return doubles(truth.ecef_from_ned(place(t)))


def body() -> Floats:
    """Turns body axes into north, east, down."""
    return doubles(truth.ned_from_body(np.array(ATTITUDE)))


def felt() -> tuple[Floats, Floats]:
    """Angular rate and specific force, body axes: the aircraft circles the Earth's axis with the Earth and its own speed."""
    _, ring = radii()
    turn = RATE + SPEED / ring
    outwards = np.array([-np.sin(LAT), 0.0, -np.cos(LAT)])
    g = float(truth.gravity(place(0.0)))
    force = -(turn**2 - RATE**2) * ring * outwards - np.array([0.0, 0.0, g])
    return body().T @ (turn * np.array([np.cos(LAT), 0.0, -np.sin(LAT)])), body().T @ force


def gravity_at(x: Floats) -> Floats:
    """Gravity vector at an Earth-fixed place, by Newton's steps to its latitude and height."""
    lat, lon, h = np.arctan2(x[2], np.hypot(x[0], x[1])), np.arctan2(x[1], x[0]), 0.0
    for _ in range(20):
        n = float(truth.A) / np.sqrt(1 - float(truth.E2) * np.sin(lat) ** 2)
        h = np.hypot(x[0], x[1]) / np.cos(lat) - n
        lat = np.arctan2(x[2], np.hypot(x[0], x[1]) * (1 - float(truth.E2) * n / (n + h)))
    p = np.array([lat, lon, h])
    return doubles(truth.ecef_from_ned(p))[:, 2] * float(truth.gravity(p))


def cross(v: Floats) -> Floats:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def dynamics(t: float, n: int) -> Floats:
    """The errors' matrix F in Earth-fixed axes; clock and drift are the states 15 and 16 where there are more than 16."""
    f = np.zeros((n, n))
    axes = ned_axes(t)
    _, force = felt()
    from_body = axes @ body()
    x, h = doubles(truth.ecef(place(t))), 500.0
    spin = cross(np.array([0.0, 0.0, RATE]))
    f[0:3, 3:6] = np.eye(3)
    f[3:6, 0:3] = np.stack([(gravity_at(x + h * e) - gravity_at(x - h * e)) / (2 * h) for e in np.eye(3)], 1)
    f[3:6, 3:6] = -2 * spin
    f[3:6, 6:9] = cross(from_body @ force)
    f[3:6, 12:15] = from_body
    f[6:9, 6:9] = -spin
    f[6:9, 9:12] = -from_body
    f[9:12, 9:12] = -np.eye(3) / GYRO[2]
    f[12:15, 12:15] = -np.eye(3) / ACCELEROMETER[2]
    return f


def step(p: Floats, x: Floats, f: Floats, q: Floats, dt: float) -> tuple[Floats, Floats]:
    """Van Loan's integral of noise and transition."""
    n = len(x)
    big = expm(np.block([[-f, q], [np.zeros((n, n)), f.T]]) * dt)
    phi = big[n:, n:].T
    return phi @ p @ phi.T + phi @ big[:n, n:], phi @ x


def local(t: float) -> Floats:
    """From Earth-fixed errors to those of north, east, down: the axes at a wrong place are turned."""
    meridian, ring = radii()
    c = ned_axes(t).T
    across = ring / np.cos(LAT)
    turned = np.array([[0.0, 1 / across, 0.0], [-1 / meridian, 0.0, 0.0], [0.0, -np.tan(LAT) / across, 0.0]]) @ c
    m = np.eye(15)
    m[0:3, 0:3] = m[3:6, 3:6] = m[6:9, 6:9] = c
    m[3:6, 0:3] = cross(np.array([0.0, SPEED, 0.0])) @ turned
    m[6:9, 0:3] = turned
    return m


def update(p: Floats, x: Floats, row: Floats, innovation: float, r: float) -> tuple[Floats, Floats]:
    """A scalar, by the textbook."""
    s = row @ p @ row + r
    k = p @ row / s
    return p - np.outer(k, row @ p), x + k * (innovation - row @ x)


def start(more: list[float]) -> Floats:
    sigma = [*POSITION_SIGMA, *[VELOCITY_SIGMA] * 3, *ATTITUDE_SIGMA, *[GYRO[1]] * 3, *[ACCELEROMETER[1]] * 3]
    to_local = np.linalg.inv(local(0.0))
    return doubles(block_diag(to_local @ np.diag(np.square(sigma)) @ to_local.T, np.diag(np.square(more))))


def noise(n: int) -> Floats:
    q = np.zeros((n, n))
    q[3:6, 3:6] = np.eye(3) * ACCELEROMETER[0] ** 2
    q[6:9, 6:9] = np.eye(3) * GYRO[0] ** 2
    q[9:12, 9:12] = np.eye(3) * 2 * GYRO[1] ** 2 / GYRO[2]
    q[12:15, 12:15] = np.eye(3) * 2 * ACCELEROMETER[1] ** 2 / ACCELEROMETER[2]
    return q


def result(p: Floats, x: Floats) -> dict[str, Any]:
    """What the product says at the end."""
    to_local = local(DURATION)
    p, x = to_local @ p[:15, :15] @ to_local.T, to_local @ x[:15]
    meridian, ring = radii()
    enu = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    at = place(DURATION) - np.array([x[0] / meridian, x[1] / ring, -x[2]])
    return {
        "spread": {
            "covariance_enu_m2": [(enu @ p[:3, :3] @ enu.T).tolist()],
            "velocity_sigma_mps": [np.sqrt(np.diag(p)[3:6]).tolist()],
            "attitude_sigma_rad": [np.sqrt(np.diag(p)[6:9]).tolist()],
        },
        "estimate": {"position": [at.tolist()]},
    }


FIX_TIMES = (10.0, 20.0, 30.0, 40.0)
FIX_OFFSETS_ENU = ((4.0, -3.0, 6.0), (2.0, 5.0, -7.0), (-6.0, 1.0, 3.0), (5.0, 4.0, -2.0))
FIX_COVARIANCE = ((16.0, 4.0, -3.0), (4.0, 25.0, 6.0), (-3.0, 6.0, 49.0))
BARO_OFFSETS = (12.0, 9.0, 15.0, 20.0)


def moved(t: float, enu: tuple[float, float, float]) -> list[float]:
    """A place beside the path, to the third order of some metres over the Earth's radius."""
    meridian, ring = radii()
    return [float(v) for v in place(t) + np.array([enu[1] / meridian, enu[0] / ring, enu[2]])]


def with_fixes() -> dict[str, Any]:
    """Solved positions and an altimeter: 16 states."""
    n = 16
    p, x, q = start([BARO[1]]), np.zeros(n), noise(n)
    q[15, 15] = 2 * BARO[1] ** 2 / BARO[2]
    for k in range(round(DURATION / STEP)):
        f = dynamics((k + 0.5) * STEP, n)
        f[15, 15] = -1 / BARO[2]
        if k * STEP < FIX_TIMES[0] and (k + 1) * STEP <= FIX_TIMES[0]:
            # The altimeter's state begins with its first height.
            f[15, 15] = q[15, 15] = 0.0
        else:
            q[15, 15] = 2 * BARO[1] ** 2 / BARO[2]
        p, x = step(p, x, f, q, STEP)
        t = (k + 1) * STEP
        if t not in FIX_TIMES:
            continue
        index = FIX_TIMES.index(t)
        axes = ned_axes(t)
        enu = np.stack([axes[:, 1], axes[:, 0], -axes[:, 2]])
        root = np.linalg.cholesky(np.array(FIX_COVARIANCE))
        # Three independent scalars: the fix seen through the inverse of the root of its covariance.
        rows, seen = np.linalg.solve(root, -enu), np.linalg.solve(root, np.array(FIX_OFFSETS_ENU[index]))
        for row, innovation in zip(rows, seen, strict=True):
            p, x = update(p, x, np.concatenate([row, np.zeros(n - 3)]), innovation, 1.0)
        height = np.concatenate([axes[:, 2], np.zeros(12), [1.0]])
        p, x = update(p, x, height, BARO_OFFSETS[index], BARO[0] ** 2)
    return result(p, x)


SATELLITES_RAD = ((0.3, 0.4), (1.7, 0.9), (2.9, 0.3), (4.1, 1.2), (5.4, 0.6))
"""Azimuth, elevation at the middle of the flight."""
RANGE_ERRORS = (3.0, -2.0, 4.0, -1.0, 2.0)
WHITE, SLOW, SLOW_TIME = 3.0, 8.0, 500.0


def satellites() -> list[Floats]:
    axes = ned_axes(DURATION / 2)
    own = doubles(truth.ecef(place(DURATION / 2)))
    units = [np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), -np.sin(e)]) for a, e in SATELLITES_RAD]
    return [own + 2.3e7 * axes @ u for u in units]


def ranges(t: float, index: int) -> list[float]:
    """Measured at a time: distance from the path, errors that change their order with time, clock of 40 m and 2 m/s."""
    own = doubles(truth.ecef(place(t)))
    errors = np.roll(RANGE_ERRORS, index)
    return [float(np.linalg.norm(s - own) + 40.0 + 2.0 * t + e) for s, e in zip(satellites(), errors, strict=True)]


def with_ranges() -> dict[str, Any]:
    """Five satellites with a slow error each, clock and drift: 22 states."""
    n = 22
    p, x, q = start([CLOCK[0], CLOCK[1], *[SLOW] * 5]), np.zeros(n), noise(n)
    for k in range(round(DURATION / STEP)):
        f = dynamics((k + 0.5) * STEP, n)
        if (k + 1) * STEP > FIX_TIMES[0]:
            # Clock, drift and satellites begin with the first ranges.
            f[15, 16] = 1.0
            f[17:, 17:] = -np.eye(5) / SLOW_TIME
            q[15, 15], q[16, 16] = CLOCK[2], CLOCK[3]
            q[17:, 17:] = np.eye(5) * 2 * SLOW**2 / SLOW_TIME
        p, x = step(p, x, f, q, STEP)
        t = (k + 1) * STEP
        if t not in FIX_TIMES:
            continue
        own, measured = doubles(truth.ecef(place(t))), ranges(t, FIX_TIMES.index(t))
        for i, (satellite, value) in enumerate(zip(satellites(), measured, strict=True)):
            line = satellite - own
            distance = float(np.linalg.norm(line))
            if t == FIX_TIMES[0] and i == 0:
                # The first range sets the clock.
                x[15] = value - distance
            row = np.zeros(n)
            row[0:3], row[15], row[17 + i] = line / distance, 1.0, 1.0
            p, x = update(p, x, row, value - distance, WHITE**2)
    return result(p, x)


def nanoseconds(times: Any) -> str:
    return "[" + ", ".join(str(round(float(t) * 1e9)) for t in times) + "]"


def table(**values: Any) -> str:
    def text(v: Any) -> str:
        if isinstance(v, str):
            return v
        if isinstance(v, (list, tuple)):
            return f"[{', '.join(text(u) for u in v)}]"
        return repr(v) if isinstance(v, int) else repr(float(v))

    return "{ " + ", ".join(f"{key} = {text(value)}" for key, value in values.items()) + " }"


def common() -> dict[str, str]:
    rate, force = felt()
    n = round(DURATION / STEP)
    velocity = [0.0, SPEED, 0.0]
    return {
        "imu": table(
            **{"class": '"ins.Imu"'},
            time_ns=nanoseconds((np.arange(n) + 1) * STEP),
            angle_rad=(rate * STEP).tolist(),
            velocity_mps=(force * STEP).tolist(),
            interval_s=STEP,
        ),
        "start": table(
            **{"class": '"ins.Start"'},
            time_ns=0,
            position=place(0.0).tolist(),
            velocity_ned_mps=velocity,
            attitude_rad=ATTITUDE,
            position_sigma_m=POSITION_SIGMA,
            velocity_sigma_mps=VELOCITY_SIGMA,
            attitude_sigma_rad=ATTITUDE_SIGMA,
        ),
        "imu_model": table(
            **{"class": '"ins.ImuModel"'},
            gyroscope=table(**{"class": '"ins.SensorNoise"'}, white=GYRO[0], bias=GYRO[1], bias_time_s=GYRO[2]),
            accelerometer=table(
                **{"class": '"ins.SensorNoise"'}, white=ACCELEROMETER[0], bias=ACCELEROMETER[1], bias_time_s=ACCELEROMETER[2]
            ),
        ),
        "output_period_s": repr(DURATION),
    }


def fixes_input() -> str:
    places = [moved(t, o) for t, o in zip(FIX_TIMES, FIX_OFFSETS_ENU, strict=True)]
    fixes = table(
        **{"class": '"ins.Fixes"'},
        time_ns=nanoseconds(FIX_TIMES),
        position=places,
        covariance_enu_m2=[[list(row) for row in FIX_COVARIANCE]] * len(FIX_TIMES),
    )
    baro = table(
        **{"class": '"ins.BaroHeights"'},
        time_ns=nanoseconds(FIX_TIMES),
        height_m=[HEIGHT + o for o in BARO_OFFSETS],
        sigma_white_m=BARO[0],
        sigma_bias_m=BARO[1],
        correlation_time_s=BARO[2],
    )
    return table(**{"class": '"ins.Aiding"'}, fixes=fixes, baro=baro)


def ranges_input() -> str:
    times = [t for t in FIX_TIMES for _ in SATELLITES_RAD]
    satellites = table(
        **{"class": '"ins.SatelliteRanges"'},
        time_ns=nanoseconds(times),
        satellite="[" + ", ".join(f'"G{k % 5 + 1:02d}"' for k in range(len(times))) + "]",
        position_ecef_m=[s.tolist() for _ in FIX_TIMES for s in satellites()],
        velocity_ecef_mps=[0.0, 0.0, 0.0],
        range_m=[r for k, t in enumerate(FIX_TIMES) for r in ranges(t, k)],
        sigma_white_m=WHITE,
        sigma_correlated_m=SLOW,
        correlation_time_s=SLOW_TIME,
    )
    return table(**{"class": '"ins.Aiding"'}, satellites=satellites)


SPREAD_BECAUSE = "the step of 0.25 s in 40 s: (1/160)² of what the biases make, twice in a variance, 8e-5"
ESTIMATE_BECAUSE = "50 micrometres of a height of 9000 m: what the step of 0.25 s leaves of corrections of some metres"


def vectors() -> str:
    lines = [
        'call = "ins.fuse"',
        'source = "dense filter in Earth-fixed axes on a parallel flown at constant speed, matrix exponentials: oracle/ins_filter.py"',
        'provenance = "ours"',
    ]
    for name, inputs, results in (
        ("solved positions and altimeter", fixes_input(), with_fixes()),
        ("ranges to five satellites", ranges_input(), with_ranges()),
    ):
        words = ", ".join(f"{key} = {value}" for key, value in {**common(), "aiding": inputs}.items())
        for part, tolerance in (
            ("spread", f'{{ rel = {SPREAD_SHARE}, because = "{SPREAD_BECAUSE}" }}'),
            ("estimate", f'{{ rel = {ESTIMATE_SHARE}, because = "{ESTIMATE_BECAUSE}" }}'),
        ):
            expect = table(**results[part])
            lines += ["", "[[case]]", f'id = "{name}: {part}"', f"input = {{ {words} }}", f"expect = {expect}", f"tolerance = {tolerance}"]
    return "\n".join(lines) + "\n"


SPREAD_SHARE, ESTIMATE_SHARE = "1e-4", "1e-8"

if __name__ == "__main__":
    from pathlib import Path

    (Path(__file__).parents[1] / "vectors" / "ins-fuse.toml").write_text(vectors(), encoding="utf-8")
