"""One sample use of every public class that a caller makes or whose methods take numbers, for contracts over all of them."""

from __future__ import annotations

import functools
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import araim, dme, gnss, ins, kpi, path, raim, rnp, tse, write
from public_calls import ORBITS, SIGMA, SYSTEM, TWO, UNIT, Call

if TYPE_CHECKING:
    from collections.abc import Callable

N = 12
IMU_TIME_NS = 10_000_000 * np.arange(1, N + 1)
IMU: dict[str, Any] = {
    "time_ns": IMU_TIME_NS,
    "angle_rad": np.zeros((N, 3)),
    "velocity_mps": np.tile([0.0, 0.0, -0.0981], (N, 1)),
    "interval_s": np.full(N, 0.01),
}
START: dict[str, Any] = {"time_ns": 0, "position": (0.7, 0.3, 100.0), "velocity_ned_mps": (0.1, 0.0, 0.0), "attitude_rad": (0.0, 0.0, 0.5)}
FIXES: dict[str, Any] = {
    "time_ns": IMU_TIME_NS[3::4],
    "position": np.tile([0.7, 0.3, 100.0], (3, 1)),
    "covariance_enu_m2": np.tile(np.eye(3), (3, 1, 1)),
}
BARO: dict[str, Any] = {
    "time_ns": IMU_TIME_NS[3::4],
    "height_m": np.full(3, 100.0),
    "sigma_white_m": 2.0,
    "sigma_bias_m": 5.0,
    "correlation_time_s": 600.0,
}
SATELLITES: dict[str, Any] = {
    "time_ns": np.repeat(IMU_TIME_NS[3::4], 2),
    "position_ecef_m": np.tile([[2.0e7, 1.0e7, 1.5e7], [1.0e7, 2.0e7, 1.5e7]], (3, 1)),
    "velocity_ecef_mps": np.zeros((6, 3)),
    "range_m": np.full(6, 2.2e7),
    "sigma_white_m": np.full(6, 1.0),
    "sigma_correlated_m": np.full(6, 1.0),
    "correlation_time_s": np.full(6, 300.0),
}
DMES: dict[str, Any] = {
    "time_ns": IMU_TIME_NS[3::4],
    "station": [1, 1, 1],
    "position_ecef_m": np.tile([4.6e6, 1.4e6, 4.1e6], (3, 1)),
    "slant_m": np.full(3, 3.0e4),
    "sigma_white_m": 50.0,
    "sigma_bias_m": 90.0,
}
VORS: dict[str, Any] = {
    "time_ns": IMU_TIME_NS[3::4],
    "station": [1, 1, 1],
    "position": np.tile([0.71, 0.31, 100.0], (3, 1)),
    "bearing_rad": np.full(3, 1.0),
    "sigma_white_rad": 0.01,
    "sigma_bias_rad": 0.02,
}
RAIM: dict[str, Any] = {"unit_enu": UNIT, "constellation": SYSTEM, "sigma_m": SIGMA}
ARAIM: dict[str, Any] = {"unit_enu": UNIT, "constellation": SYSTEM, "sigma_int_m": SIGMA, "sigma_acc_m": SIGMA}
LINE = path.line(0.7, 0.3, 0.71, 0.31)
PREDICTED: dict[str, Any] = {"lat_rad": 0.7, "lon_rad": 0.3, "h_m": 0.0, "time_s": np.array([0.0, 600.0])}
LEVELS: dict[str, Any] = {
    "time_ns": 1_000_000_000 * np.arange(N),
    "hpl_m": np.full(N, 10.0),
    "vpl_m": np.full(N, 12.0),
    "nse_e_m": np.full(N, 1.0),
    "nse_n_m": np.full(N, -1.0),
    "nse_u_m": np.full(N, 2.0),
}
STEP: dict[str, Any] = {
    "time_ns": 1_000_000_000,
    "rnp_m": 555.6,
    "tse_exact_m": 100.0,
    "tse_exact_integrity_m": 200.0,
    "fte_m": 10.0,
    "hpl_m": 50.0,
}


def fused(**parts: Any) -> ins.Fused:
    """A tenth of a second of flight with the parts named."""
    aiding: dict[str, Any] = {"fixes": ins.Fixes(**FIXES)} | {
        name: part for name, part in parts.items() if name in ins.Aiding.__dataclass_fields__
    }
    rest: dict[str, Any] = {name: part for name, part in parts.items() if name not in ins.Aiding.__dataclass_fields__}
    arguments: dict[str, Any] = {
        "imu": ins.Imu(**IMU),
        "aiding": ins.Aiding(**aiding),
        "start": ins.Start(**START),
        "output_period_s": 0.0,
    } | rest
    return ins.fuse(**arguments)


def of_class(cls: Callable[..., Any], use: Callable[[Any], Any], **numbers: Any) -> Call:
    """Make an object from numbers and use it: the numbers are checked at the latest then."""
    return Call(lambda **arguments: use(cls(**arguments)), numbers, made_of=cls)


def part(cls: Callable[..., Any], name: str, **numbers: Any) -> Call:
    """A part of a fused flight."""
    return of_class(cls, lambda made: fused(**{name: made}), **numbers)


NOISE: dict[str, Any] = {"white": 1e-5, "bias": 1e-4, "bias_time_s": 3600.0}

SENT: dict[str, Any] = {"begin_s": 3, "kind": 63, "fields": [(1, 2), (-1, 3)]}


def sent(**parts: Any) -> Any:
    """A message of an SBAS service, written."""
    return write.ems([write.Sent(**parts)], 120, os.devnull)


CLASSES: dict[str, Call] = {
    "write.Sent": Call(sent, {name: SENT[name] for name in ("begin_s", "kind")}, {"fields": SENT["fields"]}, made_of=write.Sent),
    "write.ems": Call(lambda messages, prn: write.ems(messages, prn, os.devnull), {"prn": 120}, {"messages": [write.Sent(**SENT)]}),
    "tse.Exact": of_class(tse.Exact, lambda exact: exact(30.0, 8.0), risk=1e-5),
    "tse.Exact.__call__": Call(tse.Exact(1e-5), {"fte_m": 30.0 * TWO, "sigma_m": 8.0 * TWO}),
    "rnp.PerHour": of_class(rnp.PerHour, lambda basis: basis.per_epoch(1e-5, 1.0), tau_s=60.0),
    "rnp.PerEpoch": of_class(rnp.PerEpoch, lambda basis: basis.per_epoch(1e-5, 1.0), tau_s=60.0),
    "rnp.Monitor": of_class(
        rnp.Monitor,
        lambda monitor: monitor.step(STEP),
        sample_period_s=1.0,
        time_to_alert_s=10.0,
        raise_delay_s=3.0,
        clear_delay_s=10.0,
        clear_ratio=0.95,
    ),
    "rnp.Monitor.step": Call(lambda **record: rnp.Monitor().step(record), STEP),
    "rnp.Monitor.tick": Call(lambda **tick: rnp.Monitor().tick(**tick), {"time_ns": 1_000_000_000}),
    "rnp.StateClassifier": of_class(rnp.StateClassifier, lambda c: c.posterior(100.0), levels_nm=np.array([0.3, 1.0]), fte_nm=0.1),
    "raim.ErrorModel": of_class(raim.ErrorModel, lambda model: raim.predict(ORBITS, **PREDICTED, model=model), noise=(0.2, 0.5, 0.2)),
    "raim.Requirement": of_class(
        raim.Requirement, lambda r: raim.protection_levels(**RAIM, requirement=r), false_alarm=1e-5, missed_detection=1e-3, fault_free=1e-7
    ),
    "araim.Service": of_class(
        araim.Service,
        lambda s: araim.protection_levels(**ARAIM, service=s),
        integrity_v=9.8e-8,
        integrity_h=2e-9,
        false_alarm_v=3.9e-6,
        false_alarm_h=9e-8,
        unmonitored=8e-8,
        effective_monitor=1e-5,
        consolidation=0.01,
    ),
    "araim.Support": of_class(
        araim.Support,
        lambda s: araim.predict(ORBITS, **PREDICTED, support=s),
        **{
            name: getattr(araim.SUPPORT, name) for name in ("sigma_ura_m", "sigma_ure_m", "bias_m", "bias_continuity_m", "p_sat", "p_const")
        },
    ),
    "kpi.Campaign": of_class(
        functools.partial(kpi.Campaign, "APV-I", first=LEVELS),
        lambda campaign: (campaign.add(LEVELS), campaign.finish(lambda: [LEVELS])),
        period_s=1.0,
        bin_m=0.1,
        limit_m=50.0,
    ),
    "kpi.SubsetOptions": of_class(
        kpi.SubsetOptions,
        lambda options: options,
        min_satellites=4,
        max_satellites=14,
        listed_from=0.7,
    ),
    "path.Path.project": Call(LINE.project, {"lat_rad": 0.7 * TWO, "lon_rad": 0.3 * TWO}),
    "path.Path.at": Call(LINE.at, {"along_m": 1000.0 * TWO}),
    "dme.Stations.near": Call(dme.stations().near, {"lat_rad": 0.85, "lon_rad": 0.04, "distance_m": 1e5}),
    "dme.Stations.take": Call(dme.stations().take, {"places": [0, 1]}),
    "gnss.Orbits": of_class(
        lambda **columns: gnss.Orbits(satellite=ORBITS.satellite, constellation=ORBITS.constellation, **columns),
        lambda orbits: gnss.directions(orbits, 0.7, 0.3, 0.0, 0.0),
        **{
            name: getattr(ORBITS, name)
            for name in (
                "semi_major_m",
                "eccentricity",
                "inclination_rad",
                "node_rad",
                "perigee_rad",
                "mean_anomaly_rad",
                "node_rate_radps",
            )
        },
    ),
    "ins.Imu": part(ins.Imu, "imu", **IMU),
    "ins.Start": part(
        ins.Start, "start", **START, position_sigma_m=(10.0, 10.0, 15.0), velocity_sigma_mps=0.2, attitude_sigma_rad=(5e-5, 5e-5, 5e-4)
    ),
    "ins.Fixes": part(ins.Fixes, "fixes", **FIXES),
    "ins.BaroHeights": part(ins.BaroHeights, "baro", **BARO),
    "ins.SatelliteRanges": part(functools.partial(ins.SatelliteRanges, satellite=["G01", "G02"] * 3), "satellites", **SATELLITES),
    "ins.DmeRanges": part(ins.DmeRanges, "dme", **DMES),
    "ins.VorBearings": part(ins.VorBearings, "vor", **VORS),
    "ins.SensorNoise": of_class(ins.SensorNoise, lambda noise: fused(imu_model=ins.ImuModel(gyroscope=noise)), **NOISE),
    "ins.Wheels": part(ins.Wheels, "wheels", arm_m=(0.0, 0.0, 0.0), sigma_mps=0.1, mount_rad=0.05, period_s=0.1),
    "ins.Clock": of_class(
        ins.Clock,
        lambda clock: fused(settings=ins.FilterSettings(clock=clock)),
        **{name: getattr(ins.Clock(), name) for name in ins.Clock.__dataclass_fields__},
    ),
    "ins.FilterSettings": of_class(
        ins.FilterSettings,
        lambda settings: fused(settings=settings),
        **{k: v for k, v in vars(ins.FilterSettings()).items() if isinstance(v, float)},
    ),
}
