"""Receivers' files and broadcast messages, as they are read."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.gnss.constellations import CONSTELLATIONS, Orbits
from navbound.storage import packed
from navbound.table.arguments import checked
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


@dataclass(frozen=True)
class Refused:
    """What a reader could not use: file, line from 1, field, why, and the text found."""

    path: Path
    line: int
    field: str
    reason: str
    text: str


class Observations:
    """What a receiver recorded, read by :func:`read_observations`.

    Attributes
    ----------
    path : Path
        The file.
    version : float
        Version of the format.
    marker, receiver, antenna : str
        Names of the header.
    approximate_ecef_m : ndarray, shape (3,), or None
        Position of the header, Earth-fixed; of unknown datum and age: not truth. [m]
    antenna_delta_m : ndarray, shape (3,)
        Antenna reference point from the marker: up, east, north. [m]
    interval_s : float or None
        Nominal time between epochs, where the header says. [s]
    codes : dict of str to list of str
        Codes of each constellation, by letter; version 2 names translated.
    n_epochs : int
        Number of epochs. [1]
    time_ns : ndarray of int, shape (n_epochs,)
        GPS time of each epoch. [ns]
    skipped : dict of str to int
        Satellites of systems that are not read, and event records, counted.
    n_refused : int
        Things that could not be read. [1]
    n_lost_epochs : int
        Whole epochs among them. [1]
    refused : list of Refused
        The first 1000 of them.
    """

    def __init__(self, core: _core.Observations, path: Path) -> None:
        self._core = core
        self.path = path
        self.version = core.version
        self.marker = core.marker
        self.receiver = core.receiver
        self.antenna = core.antenna
        self.approximate_ecef_m = None if core.approximate_m is None else np.array(core.approximate_m)
        self.antenna_delta_m = np.array(core.antenna_delta_m)
        self.interval_s = core.interval_s
        self.codes = core.codes
        self.n_epochs = core.n_epochs
        self.time_ns: NDArray[np.int64] = core.time_ns
        self.skipped = core.skipped
        self.n_refused = core.n_refused
        self.n_lost_epochs = core.n_lost_epochs
        self.refused = [Refused(path, *r) for r in core.refused]

    def require_epochs(self) -> None:
        """Refuse a file without an epoch of measurements.

        Raises
        ------
        InputError
            It has none.
        """
        if not self.n_epochs:
            refused = f", {counted(self.n_refused, 'record')} refused" if self.n_refused else ""
            raise InputError("observations", f"{self.path.name}: no epoch{refused}", domain="measurements of at least one epoch")

    @checked
    def column(self, system: str, code: str) -> pl.DataFrame:
        """Every value of one code.

        Parameters
        ----------
        system : str
            Letter of the constellation.
        code : str
            One of ``codes[system]``, for instance ``C1C``.

        Returns
        -------
        DataFrame
            ``time_ns``, ``satellite``, ``value`` (pseudorange [m], phase [cycles], Doppler [Hz], or strength as the file has it),
            ``loss_of_lock``, ``strength`` (the two indicators).

        Raises
        ------
        InputError
            A system or code that the file lacks.
        """
        if code not in self.codes.get(system, []):
            raise InputError("code", f"{system} {code}", domain=f"codes of {self.path.name}: {self.codes}")
        return pl.DataFrame(self._core.column(system, code))


class Navigation:
    """Broadcast messages, read by :func:`read_navigation`.

    Attributes
    ----------
    paths : list of Path
        The files.
    n_ephemerides : int
        Keplerian records of GPS, Galileo and BeiDou, repetitions once. [1]
    n_geostationary : int
        Records of augmentation satellites. [1]
    leap_seconds : int or None
        GPS time minus UTC, where a file says. [s]
    skipped : dict of str to int
        Records of kinds that are not used, counted.
    refused : list of Refused
        Records that could not be read.
    """

    def __init__(self, core: _core.Navigation, paths: list[Path]) -> None:
        self._core = core
        self.paths = paths
        self.n_ephemerides = core.n_ephemerides
        self.n_geostationary = core.n_geostationary
        self.leap_seconds = core.leap_seconds
        self.skipped = core.skipped
        self.refused = [Refused(Path(r[0]), *r[1:]) for r in core.refused]

    @property
    def has_ionosphere(self) -> bool:
        """Whether the broadcast ionosphere of GPS is there."""
        return self._core.klobuchar("G") is not None

    def records(self) -> pl.DataFrame:
        """Keplerian records, one a row.

        ``satellite``, ``message``, ``orbit_time_ns``, ``clock_time_ns``, ``issue``, ``health``, ``is_healthy`` (on L1), ``is_promised`` (on
        every signal that the record speaks of, with a predicted accuracy), ``accuracy_m``, ``clock_s`` with drift [s/s] and its rate [1/s],
        elements [sqrt(m), rad, rad/s, m], ``group_delay_first_s``, ``group_delay_second_s``, ``fit_interval_s``.
        """
        return pl.DataFrame(self._core.records())

    @checked
    def without(self, satellites: Sequence[str]) -> Navigation:
        """The same without the Keplerian records of some satellites, as ``G05``; names that are not there change nothing."""
        return Navigation(self._core.without(list(satellites)), self.paths)

    @checked
    def orbits(self, system: str, time_ns: int) -> Orbits:
        """Kepler orbits of a constellation from each satellite's nearest record, without harmonics: for the geometry of a day.

        A satellite whose nearest record says that it is unhealthy, or predicts no accuracy, is left out.

        Parameters
        ----------
        system : str
            One of ``gnss.CONSTELLATIONS``.
        time_ns : int
            GPS time that the records should be near; the reference instant of the orbits. [ns]

        Raises
        ------
        InputError
            An unknown system.
        """
        names, rows, _ = self._core.orbits(_system_index(system), time_ns, unpromised=False)
        a, e, i, node, perigee, anomaly, rate = (np.ascontiguousarray(rows[:, k]) for k in range(7))
        index = np.full(len(names), _system_index(system), dtype=np.int64)
        return Orbits(tuple(names), index, a, e, i, node, perigee, anomaly, rate, time_ns)

    @checked
    def nearest_age_s(self, system: str, time_ns: int) -> float:
        """How far the nearest record of a healthy satellite of a constellation is from a GPS time [s]; infinite without one."""
        _, _, ages = self._core.orbits(_system_index(system), time_ns, unpromised=False)
        return min((abs(age) for age in ages), default=np.inf)


def _system_index(system: str) -> int:
    if system not in CONSTELLATIONS:
        raise InputError("system", system, domain=f"one of {', '.join(CONSTELLATIONS)}")
    return CONSTELLATIONS.index(system)


def file_content(path: str | Path) -> tuple[Path, bytes]:
    """Path and plain bytes of a file, or a refusal."""
    return Path(path), packed.read(path)


@checked
def read_observations(path: str | Path) -> Observations:
    """Read a RINEX observation file, or the raw measurements in a receiver's log.

    Parameters
    ----------
    path : str or Path
        RINEX 2.10 to 4.0x, plain or compact (Hatanaka); u-blox RXM-RAWX or RXM-RAW; Septentrio MeasEpoch. Plain, or packed by gzip,
        compress or zip.

    Returns
    -------
    Observations
        Epochs in GPS time whatever scale the file counts in.

    Raises
    ------
    FormatError
        Not such a file, with line and field. Damage that leaves the rest readable is listed in ``refused``; the line of a log is the
        number of its frame.
    """
    return observations_of(*file_content(path))


@checked
def observations_of(path: Path, content: bytes) -> Observations:
    """The same of a file whose plain bytes are there already.

    Raises
    ------
    FormatError
        As :func:`read_observations`.
    """
    return Observations(_core.Observations(content, str(path)), path)


@checked
def read_navigation(paths: str | Path | Sequence[str | Path]) -> Navigation:
    """Read RINEX navigation files, or the subframes in receivers' logs.

    Parameters
    ----------
    paths : str, Path, or sequence of them
        RINEX 2.10 to 4.0x; logs of u-blox (RXM-SFRBX, RXM-SFRB) or Septentrio (GPSRawCA, GALRawINAV) receivers, of which GPS LNAV and
        Galileo I/NAV are taken. Plain, or packed by gzip, compress or zip; several files are merged.

    Returns
    -------
    Navigation
        GPS (LNAV), Galileo (I/NAV, F/NAV), BeiDou (D1, D2) and augmentation satellites; other records are counted.

    Raises
    ------
    FormatError
        Not such a file, with line and field. Records that cannot be read are listed in ``refused``.
    """
    several = [paths] if isinstance(paths, str | Path) else list(paths)
    if not several:
        raise InputError("paths", "nothing", domain="at least one file")
    return navigation_of([file_content(p) for p in several])


@checked
def navigation_of(files: Sequence[tuple[Path, bytes]]) -> Navigation:
    """The same of files whose plain bytes are there already.

    Raises
    ------
    FormatError
        As :func:`read_navigation`.
    """
    return Navigation(_core.Navigation([(content, str(place)) for place, content in files]), [place for place, _ in files])
