"""Pseudoranges that a service's corrections lead back to a chosen place: an independent transcription, slow and plain.

Orbits by IS-GPS-200 table 20-IV from the navigation file's text, troposphere by DO-229 A.4.2.4 in its own words. From the package come only
what the messages say: fast and clock corrections, the vertical ionosphere, and decoded long-term positions.
"""

from __future__ import annotations

import math
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from navbound import sbas

C = 299_792_458.0
OMEGA = 7.2921151467e-5
MU = 3.986005e14
EPOCH = datetime(1980, 1, 6, tzinfo=UTC)
Vector = np.ndarray[Any, np.dtype[np.float64]]


def records(path: Path) -> dict[tuple[int, int], list[float]]:
    """Numbers of every GPS record of a version 3 file by (PRN, IODE): the clock line, then the seven orbit lines."""
    lines = path.read_text().split("END OF HEADER")[1].splitlines()[1:]
    by_name = {}
    for k in range(0, len(lines) - 7, 8):
        block = [lines[k][23:], *(line[4:] for line in lines[k + 1 : k + 8])]
        numbers = [float(line[19 * i : 19 * i + 19].strip() or 0) for j, line in enumerate(block) for i in range(3 if j == 0 else 4)]
        by_name[int(lines[k][1:3]), round(numbers[3])] = numbers
    return by_name


def satellite(n: list[float], tow: float) -> tuple[Vector, float]:
    """Position in the axes of that instant, clock offset with relativity, without group delay."""
    af0, af1, af2, _, crs, dn, m0, cuc, e, cus, root_a, toe, cic, node, cis, i0, crc, perigee, node_rate, i_rate = n[:20]
    a, t = root_a**2, tow - toe
    m = m0 + (math.sqrt(MU / a**3) + dn) * t
    ecc = m
    for _ in range(30):
        ecc = m + e * math.sin(ecc)
    nu = math.atan2(math.sqrt(1 - e * e) * math.sin(ecc), math.cos(ecc) - e)
    u = nu + perigee
    s2, c2 = math.sin(2 * u), math.cos(2 * u)
    u += cus * s2 + cuc * c2
    r = a * (1 - e * math.cos(ecc)) + crs * s2 + crc * c2
    i = i0 + cis * s2 + cic * c2 + i_rate * t
    lon = node + (node_rate - OMEGA) * t - OMEGA * toe
    x, y = r * math.cos(u), r * math.sin(u)
    position = np.array(
        [x * math.cos(lon) - y * math.cos(i) * math.sin(lon), x * math.sin(lon) + y * math.cos(i) * math.cos(lon), y * math.sin(i)]
    )
    # The clock's reference time is that of the orbit in these records.
    return position, af0 + af1 * t + af2 * t * t - 4.442807633e-10 * e * root_a * math.sin(ecc)


def zenith(lat_deg: float, h: float, day: int) -> float:
    """Tropospheric delay overhead; northern latitudes between 30 and 45 degrees only, the rows of the table around them."""
    mean = [np.array(row) for row in ((1017.25, 294.15, 21.79, 6.05e-3, 3.15), (1015.75, 283.15, 11.66, 5.58e-3, 2.57))]
    year = [np.array(row) for row in ((-3.75, 7.0, 8.85, 0.25e-3, 0.33), (-2.25, 11.0, 7.24, 0.32e-3, 0.46))]
    s = (lat_deg - 30) / 15
    p, t, e, beta, lam = (1 - s) * mean[0] + s * mean[1] - ((1 - s) * year[0] + s * year[1]) * math.cos(2 * math.pi * (day - 28) / 365.25)
    k1, k2, rd, gm, g = 77.604, 382000.0, 287.054, 9.784, 9.80665
    dry = 1e-6 * k1 * rd * p / gm * (1 - beta * h / t) ** (g / rd / beta)
    return float(dry + 1e-6 * k2 * rd / (gm * (lam + 1) - beta * rd) * e / t * (1 - beta * h / t) ** ((lam + 1) * g / rd / beta - 1))


def long_term(log: sbas.Messages, prn: int, iode: int, now_ns: int) -> Vector:
    """Position part of the newest long-term correction of this issue that has been heard."""
    mask: list[int] = []
    delta = np.full(3, np.nan)
    for message in sbas.decode(log):
        if message.time_ns + 120_000_000 > now_ns:
            break
        mask = message.fields["prn"] if message.type == 1 else mask
        for entry in message.fields.get("long_term", []):
            if mask and mask[entry["position"] - 1] == prn and entry["iode"] == iode:
                assert "velocity_ecef_mps" not in entry, "this hour sends no rates"
                delta = np.array(entry["position_ecef_m"])
    return delta


def pseudoranges(  # noqa: PLR0917
    log: sbas.Messages,
    navigation: Path,
    time_ns: int,
    place: dict[str, Any],
    ecef: Vector,
    clock_m: float,
) -> dict[int, float]:
    """What a receiver at the place measures [m], its clock fast by ``clock_m``, if the service's corrections are perfect."""
    seen = sbas.satellites(log, navigation, np.array([time_ns]), **place, mode="pa")
    by_name, data = {}, records(navigation)
    tow = time_ns // 1_000_000_000 % 604_800 - clock_m / C
    day = (EPOCH + timedelta(seconds=time_ns // 1_000_000_000)).timetuple().tm_yday
    above = zenith(math.degrees(place["lat_rad"]), place["h_m"], day)
    for k, prn in enumerate(seen.prn.tolist()):
        numbers = data[prn, int(seen.iode[k])]
        delta = long_term(log, prn, int(seen.iode[k]), time_ns)
        way = 0.07 * C
        for _ in range(6):
            position, clock = satellite(numbers, tow - way / C)
            x, y, z = position + delta
            turn = OMEGA * way / C
            line = np.array([x * math.cos(turn) + y * math.sin(turn), y * math.cos(turn) - x * math.sin(turn), z]) - ecef
            way = float(np.linalg.norm(line))
        sin_el = math.sin(seen.el_rad[k])
        obliquity = 1 / math.sqrt(1 - (6378136.3 / (6378136.3 + 350000) * math.cos(seen.el_rad[k])) ** 2)
        delays = obliquity * seen.iono_vertical_m[k] + above * 1.001 / math.sqrt(0.002001 + sin_el**2)
        offset = clock + seen.clock_correction_s[k] - numbers[25]
        by_name[prn] = way + clock_m + delays - C * offset - float(seen.fast_correction_m[k])
    return by_name


def rinex(ranges: dict[int, dict[int, float]]) -> str:
    """An observation file of C/A pseudoranges by time [ns] and PRN."""
    head = [
        f"{'     3.03           OBSERVATION DATA    G: GPS':60}RINEX VERSION / TYPE",
        f"{'SYNTHETIC':60}MARKER NAME",
        f"{'G    1 C1C':60}SYS / # / OBS TYPES",
        f"{'':60}END OF HEADER",
    ]
    for time_ns, row in ranges.items():
        at = EPOCH + timedelta(seconds=time_ns // 1_000_000_000)
        head.append(f"> {at:%Y %m %d %H %M} {at.second:2d}.0000000  0{len(row):3d}")
        head.extend(f"G{prn:02d}{value:14.3f}" for prn, value in row.items())
    return "\n".join(head) + "\n"
