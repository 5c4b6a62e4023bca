"""Heights of a recorded track against the vertical path of an approach, by the altimeter and by geometry, and the altimeter's setting.

Pressure altitude is what a transponder sends, whatever the crew has set: without a setting nothing is said by the altimeter. A geometric
height needs the undulation. Neither is guessed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import polars as pl

from navbound import vertical
from navbound.evaluation import sizes
from navbound.procedures.vertical import LIMIT_M
from navbound.records.procedure import HeightResult, SettingResult

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.procedures import VerticalPath
    from navbound.procedures.legs import Followed
    from navbound.run.procedure.flown import Flown, Loaded

    Floats = NDArray[np.float64]

BY = {"geometry": "fte_v_m", "altimeter": "baro_off_m"}
"""Columns of the deviations, by what the height comes from."""
POSSIBLE_HPA = (800.0, 1100.0)
"""A broadcast setting outside is none: no pressure at sea level was ever outside 870 to 1085 hPa. [hPa]"""
SIGMA_M, FALSE_ALARM = 10.0, 1e-3
"""Of the intercept where nothing is wrong: three approaches of one airliner; and the risk of an alarm. Provenance: inferred. [m], [1]"""
BELOW_M, SPAN_M, LEAST = 1500.0, 300.0, 10
"""The setting is tested on heights so far above the threshold, over such a span and with so many positions. Provenance: inferred. [m]"""
DESCENT_S, LANDING_S = 900.0, 60.0
"""So long before and after the last judged position heights are used: the lowest ones decide. Provenance: inferred. [s]"""


@dataclass(frozen=True)
class Heights:
    """Heights of one track.

    Attributes
    ----------
    columns : DataFrame
        ``path_h_m``, ``path_angle_rad``, ``fte_v_m``, ``baro_off_m``, ``limit_v_m``, a row a position; null where there is none.
    altitude_m, indicated_m, above_sea_m, setting_hpa : ndarray
        Altitude of the path, indicated altitude, geometric height less the undulation, and the setting; NaN where unknown. [m], [hPa]
    origin : {"given", "broadcast"}
        Of the setting.
    words : str
        What was compared, and what could not be.
    """

    columns: pl.DataFrame
    altitude_m: Floats
    indicated_m: Floats
    above_sea_m: Floats
    setting_hpa: Floats
    origin: Literal["given", "broadcast"]
    words: str


def heights(group: pl.DataFrame, followed: Followed, loaded: Loaded, flown: Flown) -> Heights:
    """Heights of one track against the vertical path of its procedure.

    Parameters
    ----------
    group : DataFrame
        Epochs of the track, with ``est_h_m``, ``altitude_m`` and ``setting_hpa`` where it has them.
    followed : Followed
        Its feet on the procedure.
    loaded : Loaded
        The procedure with its vertical path.
    flown : Flown
        What the caller states of setting and undulation.
    """
    n = group.height
    none = np.full(n, np.nan)
    path = loaded.path
    undulation = math.nan if path is None else path.undulation_m
    undulation = undulation if flown.undulation_m is None else flown.undulation_m
    setting, origin, n_impossible = _setting(group, flown)
    pressure = _numbers(group, "altitude_m")
    indicated = none.copy()
    known = np.isfinite(setting) & np.isfinite(pressure)
    indicated[known] = pressure[known] + vertical.setting_offset(setting[known])
    above_sea = _numbers(group, "est_h_m") - undulation
    altitude, angle = none.copy(), none.copy()
    if path is not None:
        altitude = path.altitude_m(path.before_m(followed.leg, followed.along_leg_m))
        angle[np.isfinite(altitude)] = -path.angle_rad
    limit = np.where(np.isfinite(altitude), LIMIT_M, np.nan)
    named = {
        "path_h_m": altitude + undulation,
        "path_angle_rad": angle,
        "fte_v_m": above_sea - altitude,
        "baro_off_m": indicated - altitude,
        "limit_v_m": limit,
    }
    geometric = _geometry(bool(np.isfinite(above_sea).any()), undulation)
    of_altimeter = _altimeter(bool(np.isfinite(pressure).any()), bool(np.isfinite(indicated).any()), origin)
    compared = "" if path is None else f"Heights: {geometric}; {of_altimeter}.{_impossible(n_impossible)}"
    columns = pl.DataFrame({name: pl.Series(values, nan_to_null=True) for name, values in named.items()})
    return Heights(columns, altitude, indicated, above_sea, setting, origin, compared)


def _numbers(group: pl.DataFrame, name: str) -> Floats:
    if name not in group.columns:
        return np.full(group.height, np.nan)
    return group[name].cast(pl.Float64).fill_null(float("nan")).to_numpy().copy()


def _setting(group: pl.DataFrame, flown: Flown) -> tuple[Floats, Literal["given", "broadcast"], int]:
    """Setting at every position, where it is from, and how many broadcast ones are impossible: one stays until the next is sent."""
    if flown.setting_hpa is not None:
        return np.full(group.height, flown.setting_hpa), "given", 0
    sent = _numbers(group, "setting_hpa")
    possible = (sent >= POSSIBLE_HPA[0]) & (sent <= POSSIBLE_HPA[1])
    n_impossible = int((np.isfinite(sent) & ~possible).sum())
    sent[~possible] = np.nan
    return pl.Series(sent, nan_to_null=True).forward_fill().fill_null(float("nan")).to_numpy(), "broadcast", n_impossible


def _geometry(compared: bool, undulation_m: float) -> str:
    if compared:
        return f"by geometry with an undulation of {undulation_m:+.1f} m, where the deviation holds the temperature of the air"
    if not math.isfinite(undulation_m):
        return "not by geometry: the undulation is unknown (the file lacks a height of the runway; --undulation-m states it)"
    return "not by geometry: the recording has no height above the ellipsoid"


def _altimeter(pressure: bool, compared: bool, origin: Literal["given", "broadcast"]) -> str:
    if compared:
        return f"by the altimeter with the setting {'that was stated' if origin == 'given' else 'that the aircraft broadcasts'}"
    if not pressure:
        unused = ", so the setting that was stated is not used" if origin == "given" else ""
        return f"not by the altimeter: the recording has no pressure altitude{unused}"
    return "not by the altimeter: pressure altitude holds no setting, and none is broadcast (--setting-hpa states it)"


def _impossible(n: int) -> str:
    return f" {n} broadcast settings are outside 800 to 1100 hPa and are not used." if n else ""


def height_results(part: pl.DataFrame, path: VerticalPath, altitude_m: Floats) -> list[HeightResult]:
    """Deviations of the judged epochs of one flight from its vertical path.

    Parameters
    ----------
    part : DataFrame
        Its judged epochs, with the columns of :func:`heights`.
    path : VerticalPath
        What they are compared with.
    altitude_m : ndarray
        Its altitude at them; NaN where it is not defined. [m]
    """
    rnp = _numbers(part, "rnp_m")
    results = []
    for by, name in BY.items():
        values = _numbers(part, name)
        known = np.isfinite(values) & np.isfinite(rnp)
        if not known.any():
            continue
        values = values[known]
        required = vertical.requirement(rnp[known], path.angle_rad, altitude_m[known])
        results.append(
            HeightResult(
                by=by,
                path=path.shape,
                n=values.size,
                mean_m=float(values.mean()),
                rms_m=sizes.root_mean_square(values),
                p95_m=float(np.quantile(np.abs(values), 0.95, method="higher")),
                least_m=float(values.min()),
                most_m=float(values.max()),
                limit_m=LIMIT_M,
                n_inside=int((np.abs(values) <= LIMIT_M).sum()),
                required_m=float(required.min()),
                n_inside_required=int((np.abs(values) <= required).sum()),
            )
        )
    return results


def setting_result(time_s: Floats, last_s: float, height: Heights, loaded: Loaded) -> SettingResult | None:
    """The test of the altimeter setting on one descent, or None where its heights cannot decide.

    Parameters
    ----------
    time_s : ndarray
        Times of the track. [s]
    last_s : float
        The last judged position. [s]
    height : Heights
        Of the track.
    loaded : Loaded
        The procedure, whose runway is the aerodrome.
    """
    if loaded.path is None or not math.isfinite(loaded.path.threshold_m):
        return None
    above = height.indicated_m - loaded.path.threshold_m
    used = (
        (time_s >= last_s - DESCENT_S)
        & (time_s <= last_s + LANDING_S)
        & (above < BELOW_M)
        & np.isfinite(above)
        & np.isfinite(height.above_sea_m)
    )
    # One setting at a time: a change on the way would be taken for the temperature.
    if used.any():
        used &= height.setting_hpa == height.setting_hpa[np.flatnonzero(used)[-1]]
    if used.sum() < LEAST or float(np.ptp(above[used])) < SPAN_M:
        return None
    line = vertical.setting_line(above[used], (height.above_sea_m - height.indicated_m)[used])
    test = vertical.setting_test(SIGMA_M, FALSE_ALARM, 0.0)
    threshold = float(test.threshold_m)
    return SettingResult(
        setting_hpa=float(height.setting_hpa[np.flatnonzero(used)[-1]]),
        origin=height.origin,
        n=line.n,
        intercept_m=line.intercept_m,
        slope=line.slope,
        residual_sigma_m=line.residual_sigma_m,
        threshold_m=threshold,
        detectable_m=float(test.detectable_m),
        alarm=abs(line.intercept_m) > threshold,
    )
