"""Satellites and their orbits: nominal constellations, almanacs, elements of a caller's own."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound.errors import FormatError, InputError, NotFoundError
from navbound.storage import packed
from navbound.table.arguments import checked, checked_fields
from navbound.table.arrays import flatten
from navbound.time import utc_text
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

CONSTELLATIONS = ("gps", "glonass", "galileo", "beidou", "sbas")
"""The systems in the order of their index; a solution has one clock for each that it uses."""

_LETTERS = "GRECS"
BROADCAST_AGE_S = 86_400.0
"""A broadcast record serves geometry this far from its reference time: by then a satellite stands some 1e-3 rad off. [s]"""


@checked_fields
@dataclass(frozen=True)
class Orbits:
    """Satellites and their Kepler elements at a reference instant; all arrays have shape (n,).

    Attributes
    ----------
    satellite : tuple of str
        Names, ``G01``.
    constellation : ndarray of int
        Index in :data:`CONSTELLATIONS`.
    semi_major_m : ndarray
        Semi-major axis. [m]
    eccentricity : ndarray
        0 for a circle. [1]
    inclination_rad : ndarray
        Inclination to the equator. [rad]
    node_rad : ndarray
        Longitude of the ascending node at the reference instant: right ascension counted from Greenwich. [rad]
    perigee_rad : ndarray
        Argument of perigee. [rad]
    mean_anomaly_rad : ndarray
        Mean anomaly at the reference instant; with ``perigee_rad`` 0 and a circle the argument of latitude. [rad]
    node_rate_radps : ndarray
        Rate of right ascension of the node; 0 where nothing is known of it. [rad/s]
    reference_ns : int or None
        GPS time of the reference instant; None for nominal orbits, and for an almanac whose week may have rolled over. [ns]
    notes : tuple of str
        What an almanac lacks of GPS, and what of it is not used.
    """

    satellite: tuple[str, ...]
    constellation: NDArray[np.int64]
    semi_major_m: NDArray[np.float64]
    eccentricity: NDArray[np.float64]
    inclination_rad: NDArray[np.float64]
    node_rad: NDArray[np.float64]
    perigee_rad: NDArray[np.float64]
    mean_anomaly_rad: NDArray[np.float64]
    node_rate_radps: NDArray[np.float64]
    reference_ns: int | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse columns of different lengths."""
        for name in self.__dataclass_fields__:
            shape = np.shape(getattr(self, name))
            if name not in {"reference_ns", "notes"} and shape != (len(self.satellite),):
                raise InputError(name, f"shape {shape}", domain=f"one value a satellite, shape ({len(self.satellite)},)")

    def __add__(self, other: Orbits) -> Orbits:
        """Both sets of satellites; of two reference instants neither is kept unless they agree."""
        names = [n for n in self.__dataclass_fields__ if n not in {"satellite", "reference_ns", "notes"}]
        joined = {n: np.concatenate([getattr(self, n), getattr(other, n)]) for n in names}
        reference = self.reference_ns if self.reference_ns == other.reference_ns else None
        return Orbits(satellite=self.satellite + other.satellite, reference_ns=reference, notes=self.notes + other.notes, **joined)

    def without(self, satellites: Sequence[str]) -> Orbits:
        """The same without some satellites, as for those that a notice takes out of service.

        Raises
        ------
        InputError
            One that is not among them.
        """
        absent = sorted(set(satellites) - set(self.satellite))
        if absent:
            raise InputError("without", ", ".join(absent), domain=f"satellites of these orbits: {', '.join(self.satellite)}")
        kept = np.array([name not in satellites for name in self.satellite], dtype=bool)
        columns = [n for n in self.__dataclass_fields__ if n not in {"satellite", "reference_ns", "notes"}]
        names = tuple(name for name, keep in zip(self.satellite, kept, strict=True) if keep)
        return Orbits(satellite=names, reference_ns=self.reference_ns, notes=self.notes, **{n: getattr(self, n)[kept] for n in columns})

    def elements(self) -> NDArray[np.float64]:
        """Seven elements a row: axis, eccentricity, inclination, node, perigee, mean anomaly, rate of the node; shape (n, 7)."""
        columns = (
            self.semi_major_m,
            self.eccentricity,
            self.inclination_rad,
            self.node_rad,
            self.perigee_rad,
            self.mean_anomaly_rad,
            self.node_rate_radps,
        )
        return np.ascontiguousarray(np.stack(columns, axis=-1), dtype=np.float64)


@checked
def constellation(name: str | Path, *, near_ns: int | None = None, unhealthy: bool = False) -> Orbits:
    """Nominal constellation as data that ships with navbound, or an almanac of GPS.

    Parameters
    ----------
    name : {"gps", "gps-expanded", "galileo", "beidou"}, str or Path
        GPS: 24 slots of the standard positioning service's performance standard; expanded: the 27 with its slots B1, D2 and F2 split in
        two. Galileo: 24 in medium orbits (Walker 24/3/1).
        BeiDou-3: 24 likewise, three inclined geosynchronous, three geostationary. Join them with ``+``. Anything else is the path of an
        almanac, YUMA or SEM, or of a RINEX navigation file: the satellites with a record within a day, all of which call every signal
        that they speak of healthy and predict an accuracy.
    near_ns : int, optional
        A GPS time within ten years of the almanac. Its week has ten bits and may have rolled over: without a time near it
        ``reference_ns`` is None unless the file holds a full week. [ns]
    unhealthy : bool, optional
        Keep satellites that the almanac, or a record, calls unhealthy.

    Returns
    -------
    Orbits
        Times count from its reference instant: the almanac's time of applicability.

    Raises
    ------
    InputError
        Neither a shipped name nor a file.
    FormatError
        Not an almanac, with line and field.
    """
    shipped, notes = _core.nominal_constellations(), list[str]()
    if str(name) in shipped:
        orbits = dict(shipped[str(name)])
        orbits["node_rate_radps"] = np.zeros(len(orbits["satellite"]))
        kept = np.ones(len(orbits["satellite"]), dtype=bool)
    else:
        path = Path(name)
        if not path.exists():
            raise NotFoundError("name", str(name), "file and no built-in constellation", shipped, "or the path of an almanac")
        content = packed.read(path)
        if _is_navigation(content):
            return _broadcast(content, path, near_ns, unhealthy=unhealthy)
        orbits = _core.read_almanac(content, str(path), near_ns)
        healthy, other_time = np.asarray(orbits.pop("health")) == 0, orbits.pop("of_other_time")
        kept = healthy | unhealthy
        left_out = [] if unhealthy else [name for name, good in zip(orbits["satellite"], healthy, strict=True) if not good]
        notes = _almanac_notes(path.name, orbits["satellite"], left_out, other_time)
    reference = orbits.pop("reference_ns", None)
    satellites = tuple(s for s, keep in zip(orbits.pop("satellite"), kept, strict=True) if keep)
    indices = np.asarray(orbits.pop("constellation"), dtype=np.int64)[kept]
    columns = {column: values[kept] for column, values in orbits.items()}
    return Orbits(satellite=satellites, constellation=indices, reference_ns=reference, notes=tuple(notes), **columns)


_GPS_NUMBERS = 32
"""Satellites of GPS have the numbers from 1 to this one. Provenance: standard (IS-GPS-200)."""
_GPS_SLOTS = 24
"""Slots of the baseline constellation. Provenance: standard (GPS SPS performance standard)."""


def _almanac_notes(name: str, satellites: Sequence[str], unhealthy: Sequence[str], other_time: Sequence[str]) -> list[str]:
    """What an almanac lacks: text that is cut between two satellites is whole by its form."""
    n = len(satellites) + len(other_time)
    absent = sorted({f"G{number:02d}" for number in range(1, _GPS_NUMBERS + 1)} - {*satellites, *other_time})
    lacks = f" without {', '.join(absent)}" if absent else ""
    few = f"; fewer than the {_GPS_SLOTS} slots of GPS, so the file is cut or is not a whole almanac" if n < _GPS_SLOTS else ""
    notes = [f"{name}: {counted(n, 'satellite')}{lacks}{few}."]
    if unhealthy:
        notes.append(f"{name}: {', '.join(unhealthy)} {agreeing(len(unhealthy), 'is', 'are')} unhealthy and left out.")
    if other_time:
        reason = "of another week or time than most, by more than half a week"
        notes.append(
            f"{name}: {counted(len(other_time), 'satellite is', 'satellites are')} {reason}, and left out: {', '.join(other_time)}."
        )
    return notes


def _is_navigation(content: bytes) -> bool:
    """Whether a file begins like a RINEX one."""
    return b"RINEX VERSION" in content[:4096].split(b"\n", 1)[0]


def _broadcast(content: bytes, path: Path, near_ns: int | None, *, unhealthy: bool) -> Orbits:
    """Orbits of a RINEX navigation file at an instant, by default the middle of its records.

    A satellite that was unhealthy for a part of the day is left out for all of it: a prediction counts on none that may fail it.
    """
    navigation = _core.Navigation([(content, str(path))])
    records = navigation.records()
    times = records["orbit_time_ns"]
    if len(times) == 0:
        raise FormatError(path, "holds no orbit of GPS, Galileo or BeiDou")
    first, last = int(times.min()), int(times.max())
    reference = (first + last) // 2 if near_ns is None else near_ns
    # Geostationary satellites of BeiDou count from a tilted frame, which plain elements do not know.
    tilted = {s for s, m in zip(records["satellite"], records["message"], strict=True) if m == "D2"}
    called = _unpromised(records, reference)
    far: list[str] = []
    names: list[str] = []
    indices: list[int] = []
    rows: list[NDArray[np.float64]] = []
    for index in range(len(CONSTELLATIONS)):
        for name, row, age in zip(*navigation.orbits(index, reference, unpromised=True), strict=True):
            if name in tilted or (name in called and not unhealthy):
                continue
            if abs(age) > BROADCAST_AGE_S:
                far.append(name)
            else:
                names.append(name)
                indices.append(index)
                rows.append(row)
    if not names:
        near = f"a record within a day that promises a satellite; there are records from {utc_text(first)} to {utc_text(last)} UTC"
        if near_ns is None:
            raise FormatError(path, f"the middle of its records, {utc_text(reference)} UTC, has not {near}: state another time")
        raise InputError("near_ns", reference, "ns", f"a time with {near}")
    axis, eccentricity, inclination, node, perigee, anomaly, node_rate = np.ascontiguousarray(np.stack(rows).T)
    of = np.array(indices, dtype=np.int64)
    notes = []
    if called and not unhealthy:
        reason = "records within a day call a signal of theirs unhealthy or predict no accuracy"
        notes.append(f"{path.name}: left out, as {reason}: {_listed(called)}.")
    if far:
        notes.append(f"{path.name}: left out, as all their records are more than a day from {utc_text(reference)} UTC: {', '.join(far)}.")
    notes += _refused_words(path.name, content, navigation.refused, {*names, *called, *far})
    return Orbits(tuple(names), of, axis, eccentricity, inclination, node, perigee, anomaly, node_rate, reference, tuple(notes))


_RECORD = re.compile(r"([A-Z][ \d]\d)\s|\s?(\d{1,2})\s+\d")
"""The first line of a record: its satellite, which versions before 3 write without a letter."""


def _refused_words(name: str, content: bytes, refused: Sequence[tuple[str, int, str, str, str]], known: set[str]) -> list[str]:
    """How many records cannot be read, and the satellites that have no other."""
    if not refused:
        return []
    damaged, of, begun = {line for _, line, *_ in refused}, set[str](), ""
    # One pass: a file may be damaged at every line.
    for line, text in enumerate(content.decode("latin-1").splitlines(), 1):
        if (begin := _RECORD.match(text)) is not None:
            begun = begin[1].replace(" ", "0") if begin[1] else f"G{int(begin[2]):02d}"
        if line in damaged and begun:
            of.add(begun)
    without = ", ".join(sorted(of - known))
    alone = f"; {without} left out, without any other" if without else ""
    n = counted(len(refused), "record")
    return [f"{name}: {n} cannot be read (the first in line {refused[0][1]}: {refused[0][3]}){alone}."]


def _unpromised(records: dict[str, Any], time_ns: int) -> dict[str, tuple[int, int]]:
    """Satellites that a record within a day of a time does not promise: how many do not, of how many."""
    near = np.abs(records["orbit_time_ns"] - time_ns) <= BROADCAST_AGE_S * 1e9
    counts: dict[str, tuple[int, int]] = {}
    for name, promised in zip(np.asarray(records["satellite"])[near].tolist(), records["is_promised"][near].tolist(), strict=True):
        n_without, n = counts.get(name, (0, 0))
        counts[name] = (n_without + (not promised), n + 1)
    return {name: count for name, count in sorted(counts.items()) if count[0]}


def _listed(called: dict[str, tuple[int, int]]) -> str:
    return ", ".join(name if n_unhealthy == n else f"{name} ({n_unhealthy} of {n} records)" for name, (n_unhealthy, n) in called.items())


@checked
def nominal(
    semi_major_m: ArrayLike,
    inclination_rad: ArrayLike,
    node_rad: ArrayLike,
    latitude_argument_rad: ArrayLike,
    *,
    eccentricity: ArrayLike = 0.0,
    perigee_rad: ArrayLike = 0.0,
    system: str = "gps",
) -> Orbits:
    """Orbits from elements of your own.

    Parameters
    ----------
    semi_major_m : array_like
        Semi-major axis. [m]
    inclination_rad, node_rad : array_like
        Inclination, and longitude of the ascending node at the reference instant. [rad]
    latitude_argument_rad : array_like
        Argument of latitude at the reference instant; for an ellipse the mean anomaly plus ``perigee_rad``. [rad]
    eccentricity : array_like, optional
        0 for a circle. [1]
    perigee_rad : array_like, optional
        Argument of perigee. [rad]
    system : str, optional
        One of :data:`CONSTELLATIONS`.

    Raises
    ------
    InputError
        Shapes that do not broadcast, or a system that is not there. Elements are checked where they are used.
    """
    if system not in CONSTELLATIONS:
        raise InputError("system", system, domain=f"one of {', '.join(CONSTELLATIONS)}")
    _, (a, i, node, latitude, e, perigee) = flatten(
        semi_major_m=(semi_major_m, ()),
        inclination_rad=(inclination_rad, ()),
        node_rad=(node_rad, ()),
        latitude_argument_rad=(latitude_argument_rad, ()),
        eccentricity=(eccentricity, ()),
        perigee_rad=(perigee_rad, ()),
    )
    index = CONSTELLATIONS.index(system)
    names = tuple(f"{_LETTERS[index]}{k + 1:02d}" for k in range(a.size))
    return Orbits(names, np.full(a.size, index, dtype=np.int64), a, e, i, node, perigee, latitude - perigee, np.zeros(a.size))
