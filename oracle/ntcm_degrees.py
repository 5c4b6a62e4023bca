"""NTCM-G once more, from the equations of its description in degrees and hours, with nothing shared with the core.

``python oracle/ntcm_degrees.py`` prints the vertical delay over a few places.
"""

from __future__ import annotations

import math

GALILEO_L1_HZ = 1575.42e6
K = (0.92519, 0.16951, 0.00443, 0.06626, 0.00899, 0.21289, -0.15414, -0.38439, 1.14023, 1.20556, 1.41808, 0.13985)


def dcos(deg: float) -> float:
    """Cosine of degrees."""
    return math.cos(math.radians(deg))


def dsin(deg: float) -> float:
    """Sine of degrees."""
    return math.sin(math.radians(deg))


def vertical_tecu(az_sfu: float, lat: float, lon: float, hours: float, day: int) -> float:
    """Vertical electron content over a place in degrees, at an hour of universal time on a day of the year (equations 3 to 31)."""
    local = hours + lon / 15
    sun = 23.44 * dsin(0.9856 * (day - 80.7))
    chi3 = dcos(lat - sun) + 0.4
    chi2 = dcos(lat - sun) - 2 / math.pi * math.radians(lat) * dsin(sun)
    daily, half, third = 15 * (local - 14), 30 * local, 45 * local
    f1 = chi3 + chi2 * (K[0] * dcos(daily) + K[1] * dcos(half) + K[2] * dsin(half) + K[3] * dcos(third) + K[4] * dsin(third))
    f2 = 1 + K[5] * dcos(360 * (day - 18) / 365.25) + K[6] * dcos(720 * (day - 6) / 365.25)
    magnetic = math.degrees(math.asin(dsin(lat) * dsin(79.74) + dcos(lat) * dcos(79.74) * dcos(lon + 71.78)))
    f3 = 1 + K[7] * dcos(magnetic)
    f4 = 1 + K[8] * math.exp(-((magnetic - 16) ** 2) / (2 * 12**2)) + K[9] * math.exp(-((magnetic + 10) ** 2) / (2 * 13**2))
    return f1 * f2 * f3 * f4 * (K[10] + K[11] * az_sfu)


def delay_m(az_sfu: float, place: tuple[float, float], sight: tuple[float, float], hours: float, day: int) -> float:
    """Delay on L1 towards an azimuth and an elevation, all angles in degrees (equations 1, 24 to 26, 32 to 34)."""
    (lat, lon), (azimuth, elevation) = place, sight
    ratio = 6371 / (6371 + 450)
    psi = 90 - elevation - math.degrees(math.asin(ratio * dcos(elevation)))
    pierced = math.degrees(math.asin(dsin(lat) * dcos(psi) + dcos(lat) * dsin(psi) * dcos(azimuth)))
    east = lon + math.degrees(math.asin(dsin(psi) * dsin(azimuth) / dcos(pierced)))
    mapping = 1 / math.sqrt(1 - (ratio * dsin(0.9782 * (90 - elevation))) ** 2)
    return 40.3e16 / GALILEO_L1_HZ**2 * mapping * vertical_tecu(az_sfu, pierced, east, hours, day)


def main() -> None:
    """A few places at noon of the fifteenth of April."""
    for lat in (0, 20, 45, 80):
        print(f"latitude {lat:3d}: {delay_m(130.0, (lat, 10.0), (0.0, 90.0), 12.0, 105):6.3f} m")


if __name__ == "__main__":
    main()
