"""Measurements and broadcast records to files of receivers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from navbound import _core
from navbound.gnss import Navigation, Observations
from navbound.table.arguments import checked

_PROGRAM = f"navbound {_core.__version__}"


@dataclass(frozen=True)
class WrittenLog:
    """A receiver's log that was written.

    Attributes
    ----------
    path : Path
        Where.
    n_epochs : int
        Epochs in it. [1]
    n_left_out : int
        Signals that the format has no name for, counted at every epoch. [1]
    """

    path: Path
    n_epochs: int
    n_left_out: int


@checked
def observations(measured: Observations, path: str | Path) -> Path:
    """Write observations as RINEX 3.05, whatever they were read from: version 2, compact RINEX, a receiver's log.

    Parameters
    ----------
    measured : Observations
        From `gnss.read_observations` or `gnss.simulate_station`.
    path : str or Path
        The file.

    Returns
    -------
    Path
        The file. Values are rounded to 0.001 m, cycle or Hz, times cut to 0.1 µs.

    Raises
    ------
    InputError
        Not one epoch, or a value that fourteen columns do not hold.
    """
    place = Path(path)
    place.write_text(_core.write_observations(measured._core, _PROGRAM), encoding="ascii")
    return place


@checked
def navigation(broadcast: Navigation, path: str | Path) -> Path:
    """Write broadcast records of GPS (LNAV) and Galileo (I/NAV, F/NAV) as RINEX 3.05.

    Parameters
    ----------
    broadcast : Navigation
        From `gnss.read_navigation` or `gnss.simulate_station`.
    path : str or Path
        The file.

    Returns
    -------
    Path
        The file. Numbers keep thirteen digits, the ionosphere's five.

    Raises
    ------
    InputError
        Not one record, or one of BeiDou.
    """
    place = Path(path)
    place.write_text(_core.write_navigation(broadcast._core, _PROGRAM), encoding="ascii")
    return place


@checked
def ubx(measured: Observations, path: str | Path) -> WrittenLog:
    """Write observations as a u-blox log of RXM-RAWX frames.

    Parameters
    ----------
    measured : Observations
        From `gnss.read_observations` or `gnss.simulate_station`.
    path : str or Path
        The file.

    Returns
    -------
    WrittenLog
        Ranges and phases are kept to the bit, Doppler in single precision, strengths in whole dB-Hz.

    Raises
    ------
    InputError
        Not one epoch, or more than 255 signals in one.
    """
    log, left_out = _core.write_rawx(measured._core)
    place = Path(path)
    place.write_bytes(log)
    return WrittenLog(place, measured.n_epochs, left_out)
