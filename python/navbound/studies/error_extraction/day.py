"""A day of SBAS positions with their levels: read, against a known place, with its geometry; and the numbers that are counted over it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core, gnss, kpi, read, sbas
from navbound.errors import FormatError, InputError
from navbound.studies.error_extraction.records import Availability, BiasReading, Correlation, Stage

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

DAY = "uslo2006361_waas135_30s_pos_pl.txt"
"""The recorded day: WAAS, station USLO, 2006-12-27, one solution in 30 s."""
RAW = ("Uslo3610.06O.gz", "Uslo3610.06N.gz")
"""Its observations and navigation messages, for the geometry and the place of the station."""
FOLDERS = (Path("../shared/data/sbas"), Path(__file__).parents[4].parent / "shared" / "data" / "sbas")
MASK_RAD = float(np.radians(15.0))
"""Of the recorded solution."""

LEVELS = {"apv_i": "APV-I", "lpv_200": "LPV-200", "apv_ii": "APV-II", "cat_i_12": "CAT-I-12"}
"""Levels by field; the last is CAT-I with the paper's limit."""

MSAS = ("msas137_2025046_17h.ems", "gps_2025046_17h_rinex3.nav")
MSAS_USER_ECEF_M = (-3962108.2258, 3381309.0271, 3668678.5241)


@dataclass(frozen=True)
class Day:
    """Epochs of one station; arrays have shape (n,) or (n, 3), east, north, up."""

    path: Path
    time_ns: NDArray[np.int64]
    error_m: Floats
    """Position minus the known place."""
    hpl_m: Floats
    vpl_m: Floats
    n_sv: NDArray[np.int64]
    """Satellites in the recorded solution."""
    hdop: Floats
    vdop: Floats
    """Of all satellites above the mask."""
    n_seen: NDArray[np.int64]

    def after(self, first: int) -> Day:
        """The epochs from one on."""
        values = {f.name: getattr(self, f.name)[first:] for f in fields(self) if f.name != "path"}
        return Day(path=self.path, **values)


def find(files: Sequence[str | Path]) -> tuple[Path, Path, Path]:
    """Positions, observations and navigation: all three given, or the last two beside the first, or all where the data are.

    Raises
    ------
    InputError
        Neither none, one nor three files.
    FormatError
        A file that is not there.
    """
    paths = [Path(f) for f in files]
    if len(paths) not in {0, 1, 3}:
        raise InputError("files", f"{len(paths)} files", domain="positions, or positions, observations and navigation")
    positions = paths[0] if paths else next((f / DAY for f in FOLDERS if (f / DAY).exists()), FOLDERS[0] / DAY)
    observations, navigation = paths[1:] or [positions.parent / name for name in RAW]
    for path in (positions, observations, navigation):
        if not path.exists():
            message = "not there; give the files as arguments: positions with protection levels (.pos), observations, navigation"
            raise FormatError(path, message)
    return positions, observations, navigation


def load(positions: Path, observations: Path, navigation: Path) -> Day:
    """Read the day.

    Raises
    ------
    FormatError
        A file that cannot be read, one without protection levels, or a day whose epochs have no geometry.
    """
    table = read.read(positions).epochs
    if "hpl_m" not in table.columns:
        raise FormatError(positions, "no protection levels: the columns 'hpl (m)' and 'vpl (m)' are needed")
    recorded = gnss.read_observations(observations)
    if recorded.approximate_ecef_m is None:
        raise FormatError(observations, "no position of the station", field="APPROX POSITION XYZ")
    solved = gnss.solve(recorded, gnss.read_navigation(navigation), systems="G", ionosphere="none", mask_rad=MASK_RAD)
    geometry = solved.epochs.select("time_ns", "hdop", "vdop", n_seen="n_sv").drop_nulls()
    joined = table.join(geometry, on="time_ns", how="inner").sort("time_ns")
    if joined.height < 2 * WINDOW:
        raise FormatError(observations, f"{joined.height} of {table.height} epochs of {positions.name} have a geometry here")
    place = gnss.geodetic(recorded.approximate_ecef_m)
    estimate = joined.select("est_lat_rad", "est_lon_rad", "est_h_m").to_numpy()
    nse = _core.navigation_error(np.ascontiguousarray(estimate), np.ascontiguousarray(np.broadcast_to(place, estimate.shape)))
    column = {c: joined[c].to_numpy() for c in ("time_ns", "hpl_m", "vpl_m", "n_sv", "hdop", "vdop", "n_seen")}
    return Day(path=positions, error_m=-nse, **column)


WINDOW = 50
"""Samples of the paper's window."""


def stage(name: str, cause: str, day: Day, error_m: Floats, bounds: tuple[Floats, Floats]) -> Stage:
    """Availability of two bounds over the solution epochs of the day, and how the errors stand to them."""
    table = {"time_ns": day.time_ns, "hpl_m": bounds[0], "vpl_m": bounds[1]} | {
        f"nse_{axis}_m": error_m[:, k] for k, axis in enumerate("enu")
    }
    indicators = kpi.evaluate(table, list(LEVELS.values()), exclude_missing=True)
    horizontal, vertical = indicators.axes
    if horizontal.error_m is None or vertical.error_m is None or horizontal.safety_index is None or vertical.safety_index is None:
        raise FormatError(day.path, f"{name}: not one epoch has both bounds")
    shares = {field: level.n_available / day.time_ns.size for field, level in zip(LEVELS, indicators.levels, strict=True)}
    return Stage(
        name=name,
        cause=cause,
        origin="computed",
        availability=Availability(**shares),
        hpe95_m=horizontal.error_m.p95,
        vpe95_m=vertical.error_m.p95,
        vpe_max_m=vertical.error_m.max,
        safety_h_max=horizontal.safety_index.max,
        safety_v_max=vertical.safety_index.max,
        n_misleading=indicators.n_mi_epochs,
    )


def correlations(day: Day, step_s: float) -> list[Correlation]:
    """Autocorrelation of each axis on the grid of the day, missing epochs left out, and beta from it."""
    place = np.round((day.time_ns - day.time_ns[0]) * 1e-9 / step_s).astype(np.int64)
    rows = []
    for k, axis in enumerate("enu"):
        grid = np.zeros(int(place[-1]) + 1)
        grid[place] = day.error_m[:, k] - day.error_m[:, k].mean()
        # The biased estimate, a sum over the whole day at every lag, is an autocorrelation whatever is missing.
        spectrum = np.abs(np.fft.rfft(grid, 2 * grid.size)) ** 2
        lags = np.fft.irfft(spectrum)[: grid.size]
        r = {lag: float(lags[round(lag / step_s)] / lags[0]) for lag in (60, 300, 600)}
        tau_s = -300.0 / float(np.log(r[300]))
        rows.append(
            Correlation.model_validate(
                {
                    "axis": axis,
                    "r_60_s": r[60],
                    "r_300_s": r[300],
                    "r_600_s": r[600],
                    "tau_s": tau_s,
                    "beta_1_hz": float(sbas.extraction_beta(tau_s).beta),
                    "beta_measured": sbas.extraction_beta_from_autocorrelation(lags),
                }
            )
        )
    return rows


def recorded_bias(folder: Path) -> BiasReading | None:
    """Both readings of the vertical bias bound on the recorded MSAS hour; None where it is not there."""
    log, navigation = (folder / name for name in MSAS)
    if not (log.exists() and navigation.exists()):
        return None
    messages = sbas.read(log)
    lat, lon, h = gnss.geodetic(MSAS_USER_ECEF_M)
    seen = sbas.satellites(messages, navigation, messages.time_ns, lat_rad=lat, lon_rad=lon, h_m=h, mode="pa")
    if seen.epoch.size == 0:
        return None
    width = int(np.unique(seen.epoch, return_counts=True)[1].max())
    rows = pl.DataFrame({"epoch": seen.epoch}).with_columns(place=pl.int_range(pl.len()).over("epoch"))["place"].to_numpy()
    index = np.unique(seen.epoch, return_inverse=True)[1]
    az, el, sigma = (np.full((int(index.max()) + 1, width), fill) for fill in (np.nan, np.nan, 1.0))
    az[index, rows], el[index, rows], sigma[index, rows] = seen.az_rad, seen.el_rad, seen.sigma_m
    bias = sbas.extraction_bias(az, el, sigma)
    bare = sbas.extraction_bias(az, el, sigma, alpha=1.0)
    return BiasReading(
        from_dop_m_median=float(np.nanmedian(bias.from_dop_v_m)),
        from_dop_m_max=float(np.nanmax(bias.from_dop_v_m)),
        exact_m_median=float(np.nanmedian(bias.exact_v_m)),
        exact_m_max=float(np.nanmax(bias.exact_v_m)),
        worst_ratio=float(np.nanmax(bare.exact_v_m / bare.from_dop_v_m)),
    )
