"""DME/DME and VOR/DME positions transcribed with mpmath in geodetic coordinates, without axes or increments; slow, for vectors only.

``python oracle/dme_mpmath.py`` writes vectors/dme-solve.toml and vectors/dme-solve-vor.toml.
"""

from __future__ import annotations

from typing import Any

from mpmath import atan2, cos, diff, findroot, matrix, mp, mpf, pi, sin, sqrt

mp.dps = 40
A, F = mpf(6378137), 1 / mpf("298.257223563")
E2 = F * (2 - F)
NM = mpf(1852)

STATIONS_DEG = {
    "BRP": ("50.28569444", "30.90097222", "129"),
    "KSN": ("50.94597222", "30.97780556", "146"),
    "STB": ("49.40519444", "31.07677778", "146"),
    "YHT": ("50.26511111", "31.79452778", "137"),
}


def radians(text: str) -> Any:
    return mpf(float(mpf(text) * pi / 180))


def stations(names: list[str]) -> list[tuple[Any, Any, Any]]:
    """The doubles that the vectors give, exactly."""
    return [(radians(lat), radians(lon), mpf(h)) for lat, lon, h in (STATIONS_DEG[n] for n in names)]


def normal(lat: Any) -> Any:
    return A / sqrt(1 - E2 * sin(lat) ** 2)


def meridian(lat: Any) -> Any:
    return A * (1 - E2) / (1 - E2 * sin(lat) ** 2) ** mpf("1.5")


def cartesian(lat: Any, lon: Any, h: Any) -> list[Any]:
    n = normal(lat)
    return [(n + h) * cos(lat) * cos(lon), (n + h) * cos(lat) * sin(lon), (n * (1 - E2) + h) * sin(lat)]


def slant(lat: Any, lon: Any, h: Any, station: tuple[Any, Any, Any]) -> Any:
    return sqrt(sum((a - b) ** 2 for a, b in zip(cartesian(lat, lon, h), cartesian(*station), strict=True)))


def sigma_of(measured: Any) -> Any:
    return sqrt(max(mpf("0.085") * NM, mpf("0.00125") * measured) ** 2 + (mpf("0.05") * NM) ** 2)


def model(place: tuple[Any, Any, Any], network: list[Any], measured: list[Any], sigma_h: Any) -> tuple[Any, Any, Any, Any]:
    """H in metres east and north, w, R and the residuals; derivatives of the slant range taken numerically."""
    lat, lon, h = place
    east, north = (normal(lat) + h) * cos(lat), meridian(lat) + h
    n = len(network)
    rows, w, z = matrix(n, 2), matrix(n, 1), matrix(n, 1)
    for i, s in enumerate(network):
        rows[i, 0] = diff(lambda x, s=s: slant(lat, x, h, s), lon) / east
        rows[i, 1] = diff(lambda x, s=s: slant(x, lon, h, s), lat) / north
        w[i] = diff(lambda x, s=s: slant(lat, lon, x, s), h)
        z[i] = measured[i] - slant(lat, lon, h, s)
    r = mpf(sigma_h) ** 2 * w * w.T
    for i in range(n):
        r[i, i] += sigma_of(measured[i]) ** 2
    return rows, w, r, z


def solve(names: list[str], measured: list[Any], h: Any, sigma_h: Any, start: tuple[Any, Any]) -> dict[str, Any]:
    """Root of H' R^-1 z with the full R."""
    network, h = stations(names), mpf(h)
    measured = [mpf(m) for m in measured]

    def gradient(lat: Any, lon: Any) -> list[Any]:
        rows, _, r, z = model((lat, lon, h), network, measured, sigma_h)
        g = rows.T * (r**-1) * z
        return [g[0], g[1]]

    lat, lon = findroot(gradient, start, tol=1e-40, maxsteps=50)
    rows, w, r, z = model((lat, lon, h), network, measured, sigma_h)
    c = (rows.T * (r**-1) * rows) ** -1
    # Gain K: nse = -K (e - w dh), nse_up = -dh.
    gain = c * rows.T * (r**-1)
    up = -(mpf(sigma_h) ** 2) * (gain * w)
    covariance = [[c[0, 0], c[0, 1], up[0]], [c[1, 0], c[1, 1], up[1]], [up[0], up[1], mpf(sigma_h) ** 2]]
    chi_square = (z.T * (r**-1) * z)[0]
    dof = len(names) - 2
    fix = {"lat_rad": lat, "lon_rad": lon, "covariance_enu_m2": covariance, "drms_m": sqrt(c[0, 0] + c[1, 1])}
    if dof:
        fix["p_residual"] = mp.gammainc(mpf(dof) / 2, chi_square / 2, mp.inf, regularized=True)
    return fix


def vor(name: str, distance: Any, bearing: Any, h: Any, start: tuple[Any, Any]) -> tuple[Any, Any]:
    """The place whose slant range and whose direction in the station's level are those measured."""
    station = stations([name])[0]
    lat0, lon0, _ = station

    def miss(lat: Any, lon: Any) -> list[Any]:
        d = [a - b for a, b in zip(cartesian(lat, lon, mpf(h)), cartesian(*station), strict=True)]
        e = -sin(lon0) * d[0] + cos(lon0) * d[1]
        n = -sin(lat0) * cos(lon0) * d[0] - sin(lat0) * sin(lon0) * d[1] + cos(lat0) * d[2]
        return [sqrt(sum(x * x for x in d)) - distance, sin(atan2(e, n) - bearing) * distance]

    return tuple(findroot(miss, start, tol=1e-40, maxsteps=50))


def vor_covariance(name: str, distance: Any, place: tuple[Any, Any, Any], sigma_h: Any, sigma_bearing: Any) -> list[list[Any]]:
    """Second moments about the position, those of the bearing's arc by quadrature over its normal error."""
    lat, lon, h = place
    station = stations([name])[0]
    d = [a - b for a, b in zip(cartesian(lat, lon, h), cartesian(*station), strict=True)]
    e = -sin(lon) * d[0] + cos(lon) * d[1]
    n = -sin(lat) * cos(lon) * d[0] - sin(lat) * sin(lon) * d[1] + cos(lat) * d[2]
    u = cos(lat) * cos(lon) * d[0] + cos(lat) * sin(lon) * d[1] + sin(lat) * d[2]
    ground = sqrt(e * e + n * n)

    def mean(f: Any) -> Any:
        # Twelve deviations: what is beyond is below 1e-31.
        limits = [k * 3 * sigma_bearing for k in range(-4, 5)]
        return mp.quad(lambda b: f(b) * mp.npdf(b, 0, sigma_bearing), limits)

    radial = (sigma_of(mpf(distance)) * distance / ground) ** 2
    along2 = radial + ground**2 * mean(lambda b: (1 - cos(b)) ** 2)
    across2 = ground**2 * mean(lambda b: sin(b) ** 2)
    along, across = matrix([e / ground, n / ground, 0]), matrix([n / ground, -e / ground, 0])
    leaning = matrix([-e * u / ground**2, -n * u / ground**2, 1])
    m = along2 * along * along.T + across2 * across * across.T + mpf(sigma_h) ** 2 * leaning * leaning.T
    return [[m[i, j] for j in range(3)] for i in range(3)]


def text(x: Any) -> str:
    if isinstance(x, list):
        return "[" + ", ".join(text(v) for v in x) + "]"
    return f'"{mp.nstr(x, 20)}"'


TRUTHS = {
    "pair": (["STB", "YHT"], ("49.6", "32.2"), 9000.0, 0.0, [120.0, -80.0]),
    "pair, altitude 60 m": (["STB", "YHT"], ("49.6", "32.2"), 9000.0, 60.0, [120.0, -80.0]),
    "three": (["BRP", "STB", "YHT"], ("49.9", "32.3"), 6000.0, 0.0, [150.0, 90.0, -210.0]),
    "four": (["BRP", "KSN", "STB", "YHT"], ("50.1", "31.5"), 10000.0, 0.0, [150.0, -60.0, 90.0, -210.0]),
    "four, altitude 150 m": (["BRP", "KSN", "STB", "YHT"], ("50.1", "31.5"), 10000.0, 150.0, [150.0, -60.0, 90.0, -210.0]),
    "four, far": (["BRP", "KSN", "STB", "YHT"], ("49.6", "33.9"), 10000.0, 50.0, [-300.0, 200.0, 100.0, 0.0]),
}


def solve_vectors() -> str:
    lines = [
        'call = "dme.solve"',
        'source = "root of H\' R^-1 z in geodetic coordinates, R in full, derivatives taken numerically, 40 digits: oracle/dme_mpmath.py"',
        'provenance = "ours"',
        'tolerance = { rel = 1e-9, because = "the iteration ends at a micrometre: 1e-13 rad, 1e-10 of residuals and lines of sight" }',
    ]
    for name, (names, place, h, sigma_h, errors) in TRUTHS.items():
        lat, lon = (radians(x) for x in place)
        measured = [float(slant(lat, lon, mpf(h), s)) + e for s, e in zip(stations(names), errors, strict=True)]
        fix = solve(names, measured, h, sigma_h, (lat, lon))
        table = ", ".join(f"{n} = [{', '.join(repr(float(v)) for v in s)}]" for n, s in zip(names, stations(names), strict=True))
        inputs = f"slant_m = {measured}, stations = {{ {table} }}, h_m = {h}, sigma_altitude_m = {sigma_h}"
        if len(names) == 2:
            inputs += f", prior_lat_rad = {float(lat)!r}, prior_lon_rad = {float(lon)!r}"
        expect = ", ".join(f"{key} = {text(value)}" for key, value in fix.items())
        lines += ["", "[[case]]", f'id = "{name}"', f"input = {{ {inputs} }}", f"expect = {{ {expect}, n_ranges = {len(names)} }}"]
    return "\n".join(lines) + "\n"


def vor_vectors() -> str:
    lines = [
        'call = "dme.solve_vor"',
        'source = "root of slant range and bearing in geodetic coordinates, moments of the arc by quadrature: oracle/dme_mpmath.py"',
        'provenance = "ours"',
        'tolerance = { rel = 1e-11, because = "the elevation ends at a micrometre: 1e-12 rad, slope one in six; covariance 1e-11" }',
    ]
    sigma_bearing = 0.0396
    for station, distance, bearing, h, sigma_h in [
        ("BRP", 80e3, 1.2, 9000.0, 0.0),
        ("YHT", 150e3, -2.5, 10058.4, 60.0),
        ("STB", 30e3, 3.0, 3000.0, 0.0),
    ]:
        lat0, lon0, h0 = stations([station])[0]
        start = (lat0 + distance * cos(mpf(bearing)) / A, lon0 + distance * sin(mpf(bearing)) / (A * cos(lat0)))
        lat, lon = vor(station, mpf(distance), mpf(bearing), h, start)
        place = [float(lat0), float(lon0), float(h0)]
        covariance = vor_covariance(station, distance, (lat, lon, mpf(h)), sigma_h, mpf(sigma_bearing))
        inputs = f"slant_m = {distance}, bearing_rad = {bearing}, station_rad_m = {place}, h_m = {h}, sigma_altitude_m = {sigma_h}"
        lines += [
            "",
            "[[case]]",
            f'id = "{station}"',
            f"input = {{ {inputs}, sigma_bearing_rad = {sigma_bearing} }}",
            f"expect = {{ lat_rad = {text(lat)}, lon_rad = {text(lon)}, covariance_enu_m2 = {text(covariance)} }}",
        ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    from pathlib import Path

    folder = Path(__file__).parents[1] / "vectors"
    (folder / "dme-solve.toml").write_text(solve_vectors(), encoding="utf-8")
    (folder / "dme-solve-vor.toml").write_text(vor_vectors(), encoding="utf-8")
