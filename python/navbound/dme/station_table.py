"""Tables of DME stations; public as `navbound.dme.Stations`, `stations` and `read_stations`."""

from __future__ import annotations

import csv
import functools
import gzip
import importlib.resources
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navbound.errors import FormatError, InputError
from navbound.storage import packed
from navbound.table.arguments import checked, checked_fields
from navbound.table.arrays import flatten, shown, whole_numbers
from navbound.units import EARTH_RADIUS_M, METRES_PER_FT, METRES_PER_NM

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

SERVICE_NM = {"LOW": 25.0, "MEDIUM": 40.0, "HIGH": 130.0}
"""Range that a word of power stands for; *inferred*: the source states power, not a service volume. Other words count as MEDIUM. [NM]"""

BEARING_KINDS = ("VOR-DME", "VORTAC")
"""Kinds with a VOR beside the DME."""
KINDS = (*BEARING_KINDS, "DME", "TACAN", "NDB-DME")

_NEEDED = ("ident", "kind", "lat_deg", "lon_deg", "elevation_ft")
_KNOWN = (*_NEEDED, "country", "frequency_khz", "power", "service_nm")


@checked_fields
@dataclass(frozen=True)
class Stations:
    """A network of DME stations.

    Attributes
    ----------
    ident, kind, country : tuple of str
        Identifier, kind (``VOR-DME``, ``VORTAC``, ``DME``, ``TACAN``, ``NDB-DME``), country; the last may be empty.
    lat_rad, lon_rad : ndarray, shape (n,)
        WGS-84. [rad]
    h_m : ndarray, shape (n,)
        Height of the antenna; a published elevation is taken as a height above the ellipsoid. [m]
    service_m : ndarray, shape (n,)
        Largest slant range of the published service volume; infinite where none is stated. [m]
    frequency_khz : ndarray, shape (n,)
        Frequency, of a DME that of the paired VHF channel; NaN where none is stated. [kHz]
    """

    ident: tuple[str, ...]
    kind: tuple[str, ...]
    country: tuple[str, ...]
    lat_rad: NDArray[np.float64]
    lon_rad: NDArray[np.float64]
    h_m: NDArray[np.float64]
    service_m: NDArray[np.float64]
    frequency_khz: NDArray[np.float64]

    @classmethod
    def of(cls, places: Mapping[str, ArrayLike]) -> Stations:
        """DMEs of given places, ``ident: (lat_rad, lon_rad, h_m)``, in lexicographic order, without a stated service volume.

        Raises
        ------
        InputError
            A place that is not three numbers.
        """
        names = sorted(places)
        rows = []
        for name in names:
            row = np.asarray(places[name], dtype=np.float64)
            if row.shape != (3,):
                raise InputError(f"stations[{name}]", f"shape {row.shape}", domain="shape (3,): lat_rad, lon_rad, h_m")
            rows.append(row)
        table = np.array(rows).reshape(-1, 3)
        n = len(names)
        lat, lon, h = (np.ascontiguousarray(table[:, k]) for k in range(3))
        return cls(tuple(names), ("DME",) * n, ("",) * n, lat, lon, h, np.full(n, np.inf), np.full(n, np.nan))

    def __len__(self) -> int:
        """How many."""
        return len(self.ident)

    @property
    def bearing(self) -> NDArray[np.bool_]:
        """Whether a VOR stands beside the DME, shape (n,)."""
        return np.array([kind in BEARING_KINDS for kind in self.kind], dtype=np.bool_)

    @checked
    def take(self, places: Sequence[int]) -> Stations:
        """The stations at these places of the table, in that order.

        Raises
        ------
        InputError
            Places that are no whole numbers, or beyond the table.
        """
        k = whole_numbers("places", places).ravel()
        if k.size and not (k.min() >= 0 and k.max() < len(self.ident)):
            raise InputError("places", shown(places), domain=f"places in [0, {len(self.ident) - 1}]")
        ident, kind, country = (tuple(column[i] for i in k) for column in (self.ident, self.kind, self.country))
        return Stations(ident, kind, country, self.lat_rad[k], self.lon_rad[k], self.h_m[k], self.service_m[k], self.frequency_khz[k])

    @checked
    def without(self, *idents: str) -> Stations:
        """All but these: facilities that are out of service or excluded.

        Raises
        ------
        InputError
            An identifier that is not in the table.
        """
        self._known(idents)
        return self.take([k for k, ident in enumerate(self.ident) if ident not in idents])

    @checked
    def only(self, *idents: str) -> Stations:
        """Only these.

        Raises
        ------
        InputError
            An identifier that is not in the table.
        """
        self._known(idents)
        return self.take([k for k, ident in enumerate(self.ident) if ident in idents])

    @checked
    def near(self, lat_rad: ArrayLike, lon_rad: ArrayLike, distance_m: float) -> Stations:
        """The stations within a distance of any of some points, on a sphere.

        Parameters
        ----------
        lat_rad, lon_rad : array_like
            Points. [rad]
        distance_m : float
            [m]

        Raises
        ------
        InputError
            Points that are not finite, or a distance that is not positive.
        """
        if not distance_m > 0:
            raise InputError("distance_m", distance_m, "m", "(0, inf)")
        _, (lat, lon) = flatten(lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()))
        if not (np.isfinite(lat).all() and np.isfinite(lon).all()):
            raise InputError("lat_rad, lon_rad", "a value that is not finite", domain="finite points")
        least = math.cos(min(distance_m / EARTH_RADIUS_M, math.pi))
        cosine = _unit(self.lat_rad, self.lon_rad) @ _unit(lat, lon).T
        return self.take(np.flatnonzero((cosine >= least).any(axis=1)).tolist())

    def _known(self, idents: Iterable[str]) -> None:
        for ident in idents:
            if ident not in self.ident:
                raise InputError("ident", repr(ident), domain="identifiers of the table")


def _unit(lat_rad: NDArray[np.float64], lon_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.column_stack((np.cos(lat_rad) * np.cos(lon_rad), np.cos(lat_rad) * np.sin(lon_rad), np.sin(lat_rad)))


@functools.cache
def stations() -> Stations:
    """Every DME of the world that the shipped table has, sorted by identifier, country and kind (OurAirports, public domain).

    Identifiers repeat over the world: choose a region with :meth:`Stations.near` first. Positions are good to some hundred metres,
    service volumes are inferred (`SERVICE_NM`): for coverage, not for navigation.
    """
    name = "data/stations.csv.gz"
    text = gzip.decompress(importlib.resources.files("navbound").joinpath(name).read_bytes()).decode("utf-8")
    return _parse(name, text, unique=False)


@checked
def read_stations(file: str | Path) -> Stations:
    """Read a table of stations: CSV, plain or gzip, with a heading; lines that begin with ``#`` are comments.

    Parameters
    ----------
    file : str or Path
        Columns ``ident``, ``kind``, ``lat_deg``, ``lon_deg``, ``elevation_ft``; optional ``country``, ``frequency_khz``, and one of
        ``service_nm`` and ``power`` (HIGH, MEDIUM, LOW).

    Raises
    ------
    FormatError
        A file that cannot be read, a missing or unknown column, a field that is missing or no number, a latitude or longitude off the
        Earth, an unknown kind, an identifier twice; with file, line, field and the text found.
    """
    path = Path(file)
    try:
        text = packed.read(path).decode("utf-8-sig")
    except UnicodeDecodeError as e:
        raise FormatError(path, f"is no text: {e}") from e
    return _parse(path, text, unique=True)


def _parse(path: str | Path, text: str, *, unique: bool) -> Stations:
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    if not lines:
        raise FormatError(path, "holds no heading")
    heading = [name.strip() for name in next(csv.reader([lines[0][1]]))]
    for name in _NEEDED:
        if name not in heading:
            raise FormatError(path, f"no such column; found {', '.join(heading)}", lines[0][0], name)
    for name in heading:
        if name not in _KNOWN or heading.count(name) > 1:
            raise FormatError(path, f"unknown or twice; known are {', '.join(_KNOWN)}", lines[0][0], name)
    rows, seen = [], dict[str, int]()
    for number, line in lines[1:]:
        row = _Row(path, number, dict(zip(heading, _fields(path, number, line, len(heading)), strict=True)))
        rows.append(row.values())
        ident = rows[-1][0]
        if unique and ident in seen:
            raise FormatError(path, f"{ident!r} stands in line {seen[ident]} already", number, "ident")
        seen[ident] = number
    if not rows:
        raise FormatError(path, "holds no station")
    idents, kinds, countries = (tuple(str(row[k]) for row in rows) for k in range(3))
    lat, lon, h, service, frequency = np.array([row[3:] for row in rows], dtype=np.float64).T.copy()
    return Stations(idents, kinds, countries, lat, lon, h, service, frequency)


def _fields(path: str | Path, number: int, line: str, n: int) -> list[str]:
    fields = [field.strip() for field in next(csv.reader([line]))]
    if len(fields) != n:
        raise FormatError(path, f"{len(fields)} fields where the heading has {n}: {line[:60]!r}", number)
    return fields


@dataclass(frozen=True)
class _Row:
    """One line on its way to a station."""

    path: str | Path
    line: int
    field: dict[str, str]

    def values(self) -> tuple[str, str, str, float, float, float, float, float]:
        ident, kind = self.word("ident"), self.word("kind")
        if kind not in KINDS:
            raise FormatError(self.path, f"{kind!r} is none of {', '.join(KINDS)}", self.line, "kind")
        lat, lon = self.number("lat_deg", -90.0, 90.0), self.number("lon_deg", -180.0, 180.0)
        # Lowest and highest dry land, with room.
        h_m = self.number("elevation_ft", -2000.0, 30_000.0) * METRES_PER_FT
        frequency = self.number("frequency_khz", 0.0, math.inf) if self.field.get("frequency_khz") else math.nan
        return ident, kind, self.field.get("country", ""), math.radians(lat), math.radians(lon), h_m, self.service_m(), frequency

    def service_m(self) -> float:
        if self.field.get("service_nm"):
            return self.number("service_nm", 0.0, math.inf) * METRES_PER_NM
        if "power" in self.field:
            return SERVICE_NM.get(self.field["power"], SERVICE_NM["MEDIUM"]) * METRES_PER_NM
        return math.inf

    def word(self, name: str) -> str:
        word = self.field[name]
        if not word:
            raise FormatError(self.path, "is missing", self.line, name)
        return word

    def number(self, name: str, least: float, most: float) -> float:
        text = self.word(name)
        try:
            value = float(text)
        except ValueError:
            raise FormatError(self.path, f"{text!r} is no number", self.line, name) from None
        if not least <= value <= most:
            raise FormatError(self.path, f"{text!r} is outside [{least:g}, {most:g}]", self.line, name)
        return value
