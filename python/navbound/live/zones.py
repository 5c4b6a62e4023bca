"""RNP by area and by track: a TOML file that a person writes.

```toml
[[area]]
name = "Paris"                                   # for people
rnp_nm = 1.0
corners_deg = [[48.0, 1.5], [48.0, 3.5], [49.5, 2.5]]   # latitude and longitude, three corners at least

[[track]]
track = "4ca123"
path = "LFPG/08R"                                # a runway or a route file; one of the two keys at least
rnp_nm = 0.3
```
"""

from __future__ import annotations

import hashlib
import math
import tomllib
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from navbound.errors import FormatError
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from navbound.path import Path

MOST_CORNERS, MOST_ROWS = 1000, 100_000


@dataclass(frozen=True)
class Area:
    """An area in which an RNP is in force.

    Attributes
    ----------
    name : str
        For people.
    rnp_m : float
        RNP value. [m]
    corners_rad : tuple of (float, float)
        Latitude and longitude. [rad]
    """

    name: str
    rnp_m: float
    corners_rad: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Assigned:
    """What is assigned to a track: a path, an RNP [m], or both."""

    track: str
    path: Path | None
    rnp_m: float | None


@dataclass(frozen=True)
class Zones:
    """The table of a file."""

    areas: tuple[Area, ...] = ()
    tracks: tuple[Assigned, ...] = ()

    def core(self) -> tuple[list[Any], list[Any]]:
        """As the lane takes it."""
        areas = [(area.rnp_m, list(area.corners_rad)) for area in self.areas]
        return areas, [(each.track, None if each.path is None else each.path._core, each.rnp_m) for each in self.tracks]


def load(file: str) -> Zones:
    """Read the table of a file.

    Raises
    ------
    FormatError
        It cannot be read, and at which entry.
    """
    path = FilePath(file)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as e:
        raise FormatError(path, f"not a table of RNP values: {e}") from e
    if strange := sorted(set(content) - {"area", "track"}):
        raise FormatError(path, f"has entries that are neither [[area]] nor [[track]]: {', '.join(strange)}")
    areas, tracks = content.get("area", []), content.get("track", [])
    for name, rows in (("area", areas), ("track", tracks)):
        if not isinstance(rows, list) or len(rows) > MOST_ROWS or not all(isinstance(row, dict) for row in rows):
            raise FormatError(path, f"{name} is no list of at most {MOST_ROWS} entries: each begins with [[{name}]]")
    read = Zones(
        tuple(_area(path, k, row) for k, row in enumerate(areas, 1)), tuple(_track(path, k, row) for k, row in enumerate(tracks, 1))
    )
    names = [each.track for each in read.tracks]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise FormatError(path, f"track {twice[0]} stands twice")
    return read


def digest(file: str) -> str:
    """Of the bytes of a file: settings belong to one content."""
    try:
        return hashlib.sha256(FilePath(file).read_bytes()).hexdigest()
    except OSError as e:
        raise FormatError(FilePath(file), f"not a table of RNP values: {e.strerror}") from e


def _area(file: FilePath, place: int, row: dict[str, Any]) -> Area:
    where = f"area {place}"
    _only(file, where, row, {"name", "rnp_nm", "corners_deg"})
    corners = row.get("corners_deg")
    if not isinstance(corners, list) or not 3 <= len(corners) <= MOST_CORNERS:
        raise FormatError(file, f"{where}: corners_deg is no list of 3 to {MOST_CORNERS} pairs of latitude and longitude")
    read = tuple(_corner(file, where, corner) for corner in corners)
    longitudes = [lon for _, lon in read]
    if max(longitudes) - min(longitudes) > math.pi:
        raise FormatError(
            file, f"{where}: the corners are more than 180 degrees apart; part an area that crosses the meridian of 180 degrees"
        )
    rnp_m = _rnp_m(file, where, row)
    if rnp_m is None:
        raise FormatError(file, f"{where}: rnp_nm is missing")
    return Area(str(row.get("name", where)), rnp_m, read)


def _corner(file: FilePath, where: str, corner: Any) -> tuple[float, float]:
    numbers = corner if isinstance(corner, list) else []
    if len(numbers) != 2 or not all(isinstance(x, int | float) and not isinstance(x, bool) for x in numbers):
        raise FormatError(file, f"{where}: {corner} is no latitude and longitude [deg]")
    lat_deg, lon_deg = map(float, numbers)
    if not (-90.0 <= lat_deg <= 90.0 and -180.0 <= lon_deg <= 180.0):
        raise FormatError(file, f"{where}: [{lat_deg}, {lon_deg}] deg is outside latitude [-90, 90] and longitude [-180, 180]")
    return math.radians(lat_deg), math.radians(lon_deg)


def _track(file: FilePath, place: int, row: dict[str, Any]) -> Assigned:
    where = f"track {place}"
    _only(file, where, row, {"track", "path", "rnp_nm"})
    name, path, rnp_m = row.get("track"), row.get("path"), _rnp_m(file, where, row)
    if not isinstance(name, str) or not (1 <= len(name) <= 32 and name.isascii() and name.isprintable() and not set(name) & set(" /")):
        raise FormatError(file, f"{where}: track = {name!r} is no name of 1 to 32 printable ASCII characters without blanks and '/'")
    if path is None and rnp_m is None:
        raise FormatError(file, f"{where}: neither path nor rnp_nm is stated")
    if path is not None and not isinstance(path, str):
        raise FormatError(file, f"{where}: path = {path!r} is neither a runway nor a route file")
    return Assigned(name, None if path is None else path_of(path), rnp_m)


def _rnp_m(file: FilePath, where: str, row: dict[str, Any]) -> float | None:
    rnp_nm = row.get("rnp_nm")
    if rnp_nm is None:
        return None
    if isinstance(rnp_nm, bool) or not isinstance(rnp_nm, int | float) or not 0 < rnp_nm <= 20:
        raise FormatError(file, f"{where}: rnp_nm = {rnp_nm!r} [NM] is outside (0, 20]")
    return float(rnp_nm) * METRES_PER_NM


def _only(file: FilePath, where: str, row: dict[str, Any], known: set[str]) -> None:
    if strange := sorted(set(row) - known):
        raise FormatError(file, f"{where}: {', '.join(strange)} is none of {', '.join(sorted(known))}")


def path_of(name: str) -> Path:
    """The path of a runway's name or a route file."""
    from navbound.read.routes import load_route  # noqa: PLC0415  (workers without a path need no tables)
    from navbound.read.runways import runway  # noqa: PLC0415

    if FilePath(name).suffix.lower() in {".toml", ".csv"}:
        return load_route(name).path
    return runway(name).centreline
