"""Orbits and clocks of analysis centres."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.gnss.files import Refused, file_content
from navbound.table.arguments import checked

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


class PreciseOrbits:
    """Tabulated orbits and clocks, read by :func:`read_orbits`.

    Attributes
    ----------
    paths : list of Path
        The files.
    satellites : list of str
        Satellites with positions.
    n_positions, n_clocks : int
        Positions, and the clock records in use. [1]
    clock_source : {"clock file", "orbit file"}
        Where the clocks in use come from; with a clock file those of the orbit files are not used.
    clock_step_s : float or None
        Usual time between clock records. [s]
    frames, agencies : set of str
        Reference frames and analysis centres as the files name them.
    skipped : dict of str to int
        Lines of kinds that are not used, counted.
    refused : list of Refused
        Lines that could not be read.
    """

    def __init__(self, core: _core.PreciseOrbits, paths: list[Path]) -> None:
        self._core = core
        self.paths = paths
        self.satellites = core.satellites
        self.n_positions = core.n_positions
        self.n_clocks = core.n_clocks
        self.clock_source = "clock file" if core.dense_clocks else "orbit file"
        self.clock_step_s = core.clock_step_s
        self.frames = core.frames
        self.agencies = core.agencies
        self.skipped = core.skipped
        self.refused = [Refused(Path(r[0]), *r[1:]) for r in core.refused]

    @checked
    def states(self, satellite: str, time_ns: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Mass centre, velocity and clock of a satellite.

        Parameters
        ----------
        satellite : str
            One of ``satellites``.
        time_ns : array_like of int, shape (...)
            GPS times. [ns]

        Returns
        -------
        ecef_m, velocity_mps : ndarray, shape (..., 3)
            Earth-fixed, in the files' frame: interpolated by a polynomial of order 10. [m, m/s]
        clock_s : ndarray, shape (...)
            Satellite clock with the periodic relativity of its orbit, linear between records. [s]
            All are NaN where the tables do not reach: nothing is extrapolated, no hole bridged.

        Raises
        ------
        InputError
            A satellite without positions, or times that are not integers.
        """
        times = np.asarray(time_ns)
        if not np.issubdtype(times.dtype, np.integer):
            raise InputError("time_ns", f"dtype {times.dtype}", domain="integers")
        states = self._core.states(satellite, np.ascontiguousarray(times, dtype=np.int64).reshape(-1))
        if states is None:
            raise InputError("satellite", satellite, domain=f"one of {', '.join(self.satellites)}")
        wide = (*times.shape, 3)
        return states["ecef_m"].reshape(wide), states["velocity_mps"].reshape(wide), states["clock_s"].reshape(times.shape)


@checked
def read_orbits(paths: str | Path | Sequence[str | Path]) -> PreciseOrbits:
    """Read orbits and clocks of an analysis centre.

    Parameters
    ----------
    paths : str, Path, or sequence of them
        SP3 (versions a to d) and RINEX clock files, packed by gzip or not; several are merged. Days that follow each other should all
        be given: the polynomial is best in the middle of a table and nothing is extrapolated beyond its end.

    Returns
    -------
    PreciseOrbits
        GPS, GLONASS, Galileo, BeiDou and augmentation satellites; other lines are counted.

    Raises
    ------
    FormatError
        Not such a file, with line and field. Lines that cannot be read are listed in ``refused``.
    InputError
        No file at all, or no file with orbits.
    """
    several = [paths] if isinstance(paths, str | Path) else list(paths)
    if not several:
        raise InputError("paths", "nothing", domain="at least one file")
    files = [file_content(p) for p in several]
    core = _core.PreciseOrbits([(content, str(place)) for place, content in files])
    if not core.n_positions:
        raise InputError("paths", ", ".join(str(p) for p in several), domain="files of which one at least holds orbits (SP3)")
    return PreciseOrbits(core, [place for place, _ in files])
