"""Measurements that aid an inertial navigator, as tables; public as `navbound.ins`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound.errors import InputError
from navbound.table.arguments import checked_fields
from navbound.table.arrays import numbers, whole_numbers
from navbound.table.columns import COVARIANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    import polars as pl
    from numpy.typing import ArrayLike, NDArray


def rows(name: str, value: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Give a contiguous float64 array of exactly this shape, numbers broadcast along the first axis."""
    try:
        array = np.asarray(numbers(name, value), dtype=np.float64)
        return np.ascontiguousarray(np.broadcast_to(array, shape))
    except (TypeError, ValueError) as e:
        raise InputError(name, f"shape {np.shape(value)}", domain=f"numbers of shape {shape}") from e


def _times(time_ns: ArrayLike) -> NDArray[np.int64]:
    time = whole_numbers("time_ns", time_ns, "whole nanoseconds")
    if time.ndim != 1:
        raise InputError("time_ns", f"shape {time.shape}", domain="shape (n,)")
    return time


def _joined(n: int, *columns: tuple[str, ArrayLike, int]) -> NDArray[np.float64]:
    """Join columns of given widths to one table of n rows."""
    return np.ascontiguousarray(np.concatenate([rows(name, _flat(name, value, width), (n, width)) for name, value, width in columns], 1))


def _flat(name: str, value: ArrayLike, width: int) -> NDArray[np.generic]:
    """Rows of a width, one for each item: a matrix of three by three is a row of nine."""
    array = numbers(name, value)
    if array.size % width or (array.ndim == 0 and width > 1):
        raise InputError(name, f"shape {array.shape}", domain=f"{width} numbers a row")
    return array.reshape(-1, width)


@checked_fields
@dataclass(frozen=True)
class SatelliteRanges:
    """Ranges to satellites, corrected for everything that is known of them.

    Attributes
    ----------
    time_ns : array_like of int, shape (n,)
        [ns]
    satellite : sequence of str, length n
        ``"G01"``.
    position_ecef_m, velocity_ecef_mps : array_like, shape (n, 3)
        At transmission, in the Earth-fixed axes of reception. [m, m/s]
    range_m : array_like, shape (n,)
        Geometric range + clock + inter-system bias + error; NaN where only the rate is known, as from carrier phase. [m]
    sigma_white_m, sigma_correlated_m, correlation_time_s : array_like, shape (n,) or ()
        Deviation of what is new each time; deviation and correlation time of what stays. [m, m, s]
    rate_mps, sigma_rate_mps : array_like, shape (n,) or ()
        Range rate; NaN where there is none. [m/s]
    sigma_first_m : array_like, shape (n,) or (), optional
        Deviation of what stays when the satellite is first seen; without it ``sigma_correlated_m``, a stationary process. [m]
    """

    time_ns: ArrayLike
    satellite: Sequence[str]
    position_ecef_m: ArrayLike
    velocity_ecef_mps: ArrayLike
    range_m: ArrayLike
    sigma_white_m: ArrayLike
    sigma_correlated_m: ArrayLike
    correlation_time_s: ArrayLike
    rate_mps: ArrayLike = np.nan
    sigma_rate_mps: ArrayLike = np.nan
    sigma_first_m: ArrayLike | None = None

    def table(self) -> tuple[NDArray[np.int64], list[tuple[str, int]], NDArray[np.float64]]:
        """Give times, satellites and numbers."""
        time = _times(self.time_ns)
        if len(self.satellite) != time.size:
            raise InputError("satellite", f"length {len(self.satellite)}", domain=f"length {time.size}")
        table = _joined(
            time.size,
            ("position_ecef_m", self.position_ecef_m, 3),
            ("velocity_ecef_mps", self.velocity_ecef_mps, 3),
            ("range_m", self.range_m, 1),
            ("sigma_white_m", self.sigma_white_m, 1),
            ("sigma_correlated_m", self.sigma_correlated_m, 1),
            ("sigma_first_m", self.sigma_correlated_m if self.sigma_first_m is None else self.sigma_first_m, 1),
            ("correlation_time_s", self.correlation_time_s, 1),
            ("rate_mps", self.rate_mps, 1),
            ("sigma_rate_mps", self.sigma_rate_mps, 1),
        )
        names = {name: _satellite(name) for name in set(self.satellite)}
        return time, [names[name] for name in self.satellite], table


def _satellite(name: str) -> tuple[str, int]:
    if not (name[:1].isalpha() and name[1:].isdecimal() and 0 < int(name[1:]) < 256):
        raise InputError("satellite", name, domain="a letter and a number, as G01")
    return name[0], int(name[1:])


@checked_fields
@dataclass(frozen=True)
class DmeRanges:
    """Slant ranges to DME stations.

    Attributes
    ----------
    time_ns, station : array_like of int, shape (n,)
        Station: its place in the table of the flight. [ns, 1]
    position_ecef_m : array_like, shape (n, 3)
        Of its antenna. [m]
    slant_m, sigma_white_m, sigma_bias_m : array_like, shape (n,) or ()
        Range; deviation of its white part and of the station's bias, constant over the flight. [m]
    """

    time_ns: ArrayLike
    station: ArrayLike
    position_ecef_m: ArrayLike
    slant_m: ArrayLike
    sigma_white_m: ArrayLike
    sigma_bias_m: ArrayLike

    def table(self) -> tuple[NDArray[np.int64], list[int], NDArray[np.float64]]:
        """Give times, stations and numbers."""
        time = _times(self.time_ns)
        columns = (("slant_m", self.slant_m, 1), ("sigma_white_m", self.sigma_white_m, 1), ("sigma_bias_m", self.sigma_bias_m, 1))
        return time, _stations(self.station, time.size), _joined(time.size, ("position_ecef_m", self.position_ecef_m, 3), *columns)


def _stations(station: ArrayLike, n: int) -> list[int]:
    array = whole_numbers("station", station)
    if array.shape != (n,) or (n and not (array.min() >= 0 and array.max() <= 65535)):
        raise InputError("station", f"shape {array.shape}", domain=f"{n} numbers from 0 to 65535")
    return [int(k) for k in array]


@checked_fields
@dataclass(frozen=True)
class VorBearings:
    """Bearings of the aircraft from VOR stations.

    Attributes
    ----------
    time_ns, station : array_like of int, shape (n,)
        [ns, 1]
    position : array_like, shape (n, 3)
        Latitude, longitude, height of the station. [rad, rad, m]
    bearing_rad, sigma_white_rad, sigma_bias_rad : array_like, shape (n,) or ()
        Clockwise from true north at the station; deviation of its white part and of the station's bias. [rad]
    """

    time_ns: ArrayLike
    station: ArrayLike
    position: ArrayLike
    bearing_rad: ArrayLike
    sigma_white_rad: ArrayLike
    sigma_bias_rad: ArrayLike

    def table(self) -> tuple[NDArray[np.int64], list[int], NDArray[np.float64]]:
        """Give times, stations and numbers."""
        time = _times(self.time_ns)
        deviations = (("sigma_white_rad", self.sigma_white_rad, 1), ("sigma_bias_rad", self.sigma_bias_rad, 1))
        table = _joined(time.size, ("position", self.position, 3), ("bearing_rad", self.bearing_rad, 1), *deviations)
        return time, _stations(self.station, time.size), table


@checked_fields
@dataclass(frozen=True)
class BaroHeights:
    """Heights from a barometric altimeter.

    Attributes
    ----------
    time_ns : array_like of int, shape (n,)
        [ns]
    height_m, sigma_white_m, sigma_bias_m, correlation_time_s : array_like, shape (n,) or ()
        Height above the ellipsoid as pressure and setting say it; white deviation; deviation and correlation time of the slow bias,
        which also holds geoid and pressure setting. [m, m, m, s]
    """

    time_ns: ArrayLike
    height_m: ArrayLike
    sigma_white_m: ArrayLike
    sigma_bias_m: ArrayLike
    correlation_time_s: ArrayLike

    def table(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Give times and numbers."""
        time = _times(self.time_ns)
        slow = (("sigma_bias_m", self.sigma_bias_m, 1), ("correlation_time_s", self.correlation_time_s, 1))
        return time, _joined(time.size, ("height_m", self.height_m, 1), ("sigma_white_m", self.sigma_white_m, 1), *slow)


@checked_fields
@dataclass(frozen=True)
class Fixes:
    """Positions, and perhaps velocities, that another receiver has solved.

    Attributes
    ----------
    time_ns : array_like of int, shape (n,)
        [ns]
    position : array_like, shape (n, 3)
        Latitude, longitude, height of the antenna. [rad, rad, m]
    covariance_enu_m2 : array_like, shape (n, 3, 3)
        It allows for its own correlation in time: the filter takes each for new. [m²]
    velocity_ned_mps : array_like, shape (n, 3), optional
        NaN where there is none. [m/s]
    velocity_covariance_ned_m2ps2 : array_like, shape (n, 3, 3), optional
        [m²/s²]
    hpl_m, vpl_m : array_like, shape (n,) or (), optional
        Protection levels of the receiver, where it has an integrity function; NaN where there is none. Without them no fused position is
        ``ok``: a covariance bounds no fault. One that is not positive, or below a standard deviation of its own fix, is refused. [m]
    """

    time_ns: ArrayLike
    position: ArrayLike
    covariance_enu_m2: ArrayLike
    velocity_ned_mps: ArrayLike | None = None
    velocity_covariance_ned_m2ps2: ArrayLike | None = None
    hpl_m: ArrayLike = np.nan
    vpl_m: ArrayLike = np.nan

    @classmethod
    def of_table(cls, table: pl.DataFrame, *, correlation_time_s: float = 0.0) -> Fixes:
        """Take a table with ``time_ns``, ``lat_rad``, ``lon_rad``, ``h_m`` and the six columns of the covariance (``cov_ee_m2`` ...).

        Parameters
        ----------
        table : polars.DataFrame
            Rows by time; ``hpl_m`` and ``vpl_m`` are taken where it has them.
        correlation_time_s : float, optional
            Of errors that stay from fix to fix. Of fixes dt apart with this time tau, 2 tau / dt say as much as one that is independent:
            their covariance is multiplied by it, and never made smaller. [s]
        """
        six = table.select(COVARIANCE).to_numpy()
        time_ns = table["time_ns"].to_numpy()
        apart_s = float(np.median(np.diff(time_ns))) * 1e-9 if time_ns.size > 1 else np.inf
        levels = {name: table[name].to_numpy() for name in ("hpl_m", "vpl_m") if name in table.columns}
        covariance = max(1.0, 2.0 * correlation_time_s / apart_s) * six[:, [0, 1, 3, 1, 2, 4, 3, 4, 5]].reshape(-1, 3, 3)
        return cls(time_ns, table.select("lat_rad", "lon_rad", "h_m").to_numpy(), covariance, **levels)

    def table(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Give times and numbers."""
        time = _times(self.time_ns)
        n = time.size
        absent = np.full((n, 3), np.nan) if self.velocity_ned_mps is None else self.velocity_ned_mps
        variance = np.full((n, 9), np.nan) if self.velocity_covariance_ned_m2ps2 is None else self.velocity_covariance_ned_m2ps2
        self._require_levels(n)
        return time, _joined(
            n,
            ("position", self.position, 3),
            ("covariance_enu_m2", self.covariance_enu_m2, 9),
            ("velocity_ned_mps", absent, 3),
            ("velocity_covariance_ned_m2ps2", variance, 9),
            ("hpl_m", self.hpl_m, 1),
            ("vpl_m", self.vpl_m, 1),
        )

    def _require_levels(self, n: int) -> None:
        """A level bounds what one standard deviation does not: a smaller one is none, and would call any position safe."""
        try:
            covariance = np.broadcast_to(np.asarray(self.covariance_enu_m2, dtype=float), (n, 3, 3))
            levels = {name: np.broadcast_to(np.asarray(getattr(self, name), dtype=float), (n,)) for name in ("hpl_m", "vpl_m")}
        except (TypeError, ValueError):
            # Shapes are refused by name where the columns are joined.
            return
        variance = {"hpl_m": np.maximum(covariance[:, 0, 0], covariance[:, 1, 1]), "vpl_m": covariance[:, 2, 2]}
        for name, level in levels.items():
            sigma = np.sqrt(np.fmax(variance[name], 0.0))
            bad = (level <= 0.0) | (level < sigma)
            if bad.any():
                index = int(bad.argmax())
                raise InputError(
                    f"fixes.{name}",
                    float(level[index]),
                    "m",
                    f"(0, inf), and at least the standard deviation, {sigma[index]:g} m",
                    index=index,
                )


@checked_fields
@dataclass(frozen=True)
class Aiding:
    """All measurements of a flight, one table a kind; an absent table is a sensor that is not there."""

    satellites: SatelliteRanges | None = None
    fixes: Fixes | None = None
    dme: DmeRanges | None = None
    vor: VorBearings | None = None
    baro: BaroHeights | None = None

    @classmethod
    def of_tables(
        cls,
        *,
        satellites: pl.DataFrame | None = None,
        dme: pl.DataFrame | None = None,
        vor: pl.DataFrame | None = None,
        baro: pl.DataFrame | None = None,
    ) -> Aiding:
        """Take tables with the columns of `navbound.ins.Sensed`; an empty table is a sensor that is not there."""
        return cls(
            satellites=None if satellites is None or satellites.is_empty() else _satellites_of(satellites),
            dme=None if dme is None or dme.is_empty() else _dme_of(dme),
            vor=None if vor is None or vor.is_empty() else _vor_of(vor),
            baro=None if baro is None or baro.is_empty() else _baro_of(baro),
        )

    def tables(self) -> dict[str, object]:
        """Give the tables as the core takes them."""
        no_time = np.empty(0, dtype=np.int64)
        return {
            "satellites": (no_time, [], np.empty((0, 13))) if self.satellites is None else self.satellites.table(),
            "fixes": (no_time, np.empty((0, 26))) if self.fixes is None else self.fixes.table(),
            "dme": (no_time, [], np.empty((0, 6))) if self.dme is None else self.dme.table(),
            "vor": (no_time, [], np.empty((0, 6))) if self.vor is None else self.vor.table(),
            "baro": (no_time, np.empty((0, 4))) if self.baro is None else self.baro.table(),
        }


def _numbers(table: pl.DataFrame, *names: str) -> NDArray[np.float64]:
    """Columns side by side, one column flat."""
    missing = [name for name in ("time_ns", *names) if name not in table.columns]
    if missing:
        raise InputError("table", ", ".join(table.columns), domain=f"a table with the columns {', '.join(missing)}")
    joined = np.column_stack([table[name].cast(float).to_numpy() for name in names])
    return joined[:, 0] if len(names) == 1 else joined


def _places(table: pl.DataFrame) -> NDArray[np.int64]:
    """Stations by number, in the order of their names."""
    return np.unique(table["station"].to_numpy(), return_inverse=True)[1].astype(np.int64)


def _satellites_of(table: pl.DataFrame) -> SatelliteRanges:
    return SatelliteRanges(
        time_ns=table["time_ns"].to_numpy(),
        satellite=table["satellite"].to_list(),
        position_ecef_m=_numbers(table, "sv_x_m", "sv_y_m", "sv_z_m"),
        velocity_ecef_mps=_numbers(table, "sv_vx_mps", "sv_vy_mps", "sv_vz_mps"),
        range_m=_numbers(table, "range_m"),
        sigma_white_m=_numbers(table, "sigma_white_m"),
        sigma_correlated_m=_numbers(table, "sigma_correlated_m"),
        correlation_time_s=_numbers(table, "correlation_time_s"),
        rate_mps=_numbers(table, "range_rate_mps"),
        sigma_rate_mps=_numbers(table, "sigma_rate_mps"),
    )


def _dme_of(table: pl.DataFrame) -> DmeRanges:
    return DmeRanges(
        time_ns=table["time_ns"].to_numpy(),
        station=_places(table),
        position_ecef_m=_numbers(table, "station_x_m", "station_y_m", "station_z_m"),
        slant_m=_numbers(table, "slant_m"),
        sigma_white_m=_numbers(table, "sigma_white_m"),
        sigma_bias_m=_numbers(table, "sigma_bias_m"),
    )


def _vor_of(table: pl.DataFrame) -> VorBearings:
    return VorBearings(
        time_ns=table["time_ns"].to_numpy(),
        station=_places(table),
        position=_numbers(table, "station_lat_rad", "station_lon_rad", "station_h_m"),
        bearing_rad=_numbers(table, "bearing_rad"),
        sigma_white_rad=_numbers(table, "sigma_white_rad"),
        sigma_bias_rad=_numbers(table, "sigma_bias_rad"),
    )


def _baro_of(table: pl.DataFrame) -> BaroHeights:
    return BaroHeights(
        time_ns=table["time_ns"].to_numpy(),
        height_m=_numbers(table, "baro_h_m"),
        sigma_white_m=_numbers(table, "sigma_white_m"),
        sigma_bias_m=_numbers(table, "sigma_bias_m"),
        correlation_time_s=_numbers(table, "correlation_time_s"),
    )
