"""The epoch table of a planned flight, second by second, and the levels of its satellites at the instants that are shown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core, anp, dme, tse
from navbound.algorithms import Place, entry
from navbound.ins.coasting import CROSS_95
from navbound.table.columns import COVARIANCE, HORIZONTAL, VARIANCES
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.records.prediction import Outage
    from navbound.run.expected.service import Service
    from navbound.run.expected.setup import Setup

    Floats = NDArray[np.float64]

RISK_ACCURACY, RISK_INTEGRITY = 0.05, 1e-5
ALTITUDE_SIGMA_M = 50.0
"""Of an altitude where the scenario has no altimeter. Provenance: inferred. [m]"""


def seconds(setup: Setup) -> pl.DataFrame:
    """Every second of the flight without errors: place, mode, covariance, bounds."""
    columns = setup.sensors().error_free()
    scenario = setup.scenario
    modes = [*_core.Sensors.modes(), "stopped"]
    statuses, _, ids = _core.Sensors.judgement()
    columns["rnp_m"] = np.where(np.isin(columns["phase"], list(setup.without_rnp)), np.nan, columns["rnp_m"])
    available = columns["available"] == 1
    bounds = _bounds(setup, columns, available)
    n = len(columns["time_ns"])
    return pl.DataFrame(
        {
            "time_ns": columns["time_ns"],
            "time_s": np.arange(n, dtype=np.float64),
            "along_m": columns["along_m"],
            "lat_rad": columns["path_lat_rad"],
            "lon_rad": columns["path_lon_rad"],
            "h_m": columns["path_h_m"],
            "course_rad": columns["course_rad"],
            "leg": _words(setup.legs, columns["leg"]),
            "phase": _words([p.name for p in scenario.phases], columns["phase"]),
            "rnp_m": columns["rnp_m"],
            "mode": _words(modes, columns["nav_mode"]),
            "n_sv": columns["n_sv"].astype(np.int64),
            **{name: columns[name] for name in COVARIANCE},
            **bounds,
            "status": _words(statuses, columns["decided"]),
            "reason": [ids[int(k)] if k >= 0 else None for k in columns["leading"]],
        }
    )


def _words(words: list[str], codes: Any) -> list[str]:
    return [words[int(code)] for code in codes]


def _bounds(setup: Setup, columns: dict[str, Any], available: NDArray[np.bool_]) -> dict[str, Floats]:
    """Bounds and risks where there is a covariance; NaN elsewhere."""
    n = len(available)
    ee, en, nn = (np.asarray(columns[name])[available] for name in HORIZONTAL)
    covariance = np.stack([np.stack([ee, en], -1), np.stack([en, nn], -1)], -2)
    rnp = np.asarray(columns["rnp_m"])[available]
    cross = tse.project(np.zeros((len(ee), 2)), covariance, np.asarray(columns["course_rad"])[available]).sigma_m
    sigma_fte = (_fte_95(setup, columns) / CROSS_95)[available]
    accuracy = tse.random_fte(0.0, sigma_fte, cross, RISK_ACCURACY)
    integrity = tse.random_fte(0.0, sigma_fte, cross, RISK_INTEGRITY)
    up = np.asarray(columns[VARIANCES[2]])[available]
    values = {
        "anp_circle_m": anp.circle(covariance, RISK_ACCURACY),
        "sigma_cross_m": cross,
        "anp_cross_m": CROSS_95 * cross,
        "sigma_u_m": up**0.5,
        "tse_accuracy_m": accuracy.tse_m,
        "tse_integrity_m": integrity.tse_m,
        "p_exceed_rnp": _exceedance(accuracy.sigma_m, rnp),
        "p_exceed_2rnp": _exceedance(accuracy.sigma_m, 2 * rnp),
    }
    whole = {}
    for name, part in values.items():
        column = np.full(n, np.nan)
        column[available] = part
        whole[name] = column
    return whole


def _exceedance(sigma_m: Floats, limit_m: Floats) -> Floats:
    """Risk of the total error to be beyond a limit; NaN where there is none."""
    stated = np.isfinite(limit_m)
    risk = np.full(len(limit_m), np.nan)
    risk[stated] = tse.exceedance_risk(0.0, sigma_m[stated], limit_m[stated])
    return risk


def _fte_95(setup: Setup, columns: dict[str, Any]) -> Floats:
    """95 % flight technical error at every second. [m]."""
    along = np.asarray(columns["along_m"])
    en_route, approach = setup.fte_95_m
    return np.where(along > along[-1] - setup.plan.approach_m, approach, en_route)


def instants(setup: Setup, table: pl.DataFrame) -> NDArray[np.int64]:
    """Rows that are shown: every step, finer on the approach, the first of each leg, and the last."""
    n, along = table.height, table["along_m"].to_numpy()
    on_approach = along > along[-1] - setup.plan.approach_m
    every = np.where(on_approach, round(setup.plan.approach_step_s), round(setup.plan.step_s))
    rows = np.arange(n)
    begins = [begin for begin, _ in parts(table)]
    return np.unique(np.concatenate([rows[rows % every == 0], begins, [n - 1]]))


def parts(table: pl.DataFrame) -> list[tuple[int, int]]:
    """First and one past the last row of every leg under one RNP."""
    keys = list(zip(table["leg"], table["phase"], table["rnp_m"].fill_nan(None), strict=True))
    begins = [k for k in range(len(keys)) if k == 0 or keys[k] != keys[k - 1]]
    return list(zip(begins, [*begins[1:], len(keys)], strict=True))


def levels(setup: Setup, shown: pl.DataFrame, shift_s: float = 0.0, without: frozenset[str] = frozenset()) -> pl.DataFrame:
    """Levels of the satellites in view and in service at the rows, without some more: ``hpl_m``, ``n_sv_monitor``, ``jammed``, ``served``.

    The level is NaN where there is none. ``served`` is false where an augmentation service offers no satellite.
    """
    if setup.sbas is not None:
        return _sent(setup, setup.sbas, shown, shift_s, without)
    called = entry(Place, "equipment.monitor", setup.plan.equipment.monitor)
    others = [s for s in setup.orbits.satellite if s[0] not in setup.systems()]
    in_view = setup.orbits.without(others)
    sensors = setup.scenario.sensors
    mask_rad = sensors.gnss.mask_rad if sensors is not None and sensors.gnss is not None else 0.0
    on_board = sensors is not None and sensors.gnss is not None
    hpl, n_sv, jammed = (np.full(shown.height, fill) for fill in (np.nan, 0, False))
    places = shown.select("time_s", "lat_rad", "lon_rad", "h_m").rows()
    for k, (time_s, lat, lon, h) in enumerate(places):
        out = _out(setup, time_s, shift_s)
        jammed[k] = any(w.what == "jamming" for w in out)
        if jammed[k] or not on_board:
            continue
        gone = {name for w in out if w.what == "satellites" for name in w.names} | without
        orbits = in_view.without([s for s in in_view.satellite if s in gone]) if gone else in_view
        if not orbits.satellite:
            continue
        at = called(orbits, [lat], [lon], [h], [setup.since_s + time_s + shift_s], mask_rad=mask_rad, model=setup.plan.equipment.model)
        hpl[k], n_sv[k] = float(np.ravel(at.hpl_m)[0]), int(np.ravel(at.n_sv)[0])
    return pl.DataFrame({"hpl_m": hpl, "n_sv_monitor": n_sv, "jammed": jammed, "served": np.full(shown.height, fill_value=True)})


def _sent(setup: Setup, sbas: Service, shown: pl.DataFrame, shift_s: float, without: frozenset[str]) -> pl.DataFrame:
    """The same of messages that a service sent; rows with the same satellites out are worked out together."""
    sensors = setup.scenario.sensors
    gnss = sensors.gnss if sensors is not None else None
    outs = [_out(setup, time_s, shift_s) for time_s in shown["time_s"]]
    jammed = np.array([any(w.what == "jamming" for w in out) for out in outs])
    gone = [frozenset(name for w in out if w.what == "satellites" for name in w.names) | without for out in outs]
    hpl, n_sv, served = np.full(shown.height, np.nan), np.zeros(shown.height, dtype=np.int64), np.full(shown.height, fill_value=True)
    for names in set(gone):
        rows = np.flatnonzero(np.array([each == names for each in gone]) & ~jammed)
        if gnss is None or not len(rows):
            continue
        hpl[rows], n_sv[rows] = sbas.levels(shown[rows.tolist()], setup.scenario.start_ns, shift_s, gnss.mask_rad, names)
        served[rows] = n_sv[rows] > 0
    return pl.DataFrame({"hpl_m": hpl, "n_sv_monitor": n_sv, "jammed": jammed, "served": served})


def pairs(setup: Setup, shown: pl.DataFrame) -> pl.DataFrame:
    """DME of the rows, by the rules of :func:`navbound.dme.select`.

    ``n_dme`` in view and in service; ``dme_pair`` the best pair, and ``dme_circle_m``, the 95 % circle of a position by that pair alone;
    null and NaN where no pair is admissible.
    """
    sensors = setup.scenario.sensors
    n, pair, circle = np.zeros(shown.height, dtype=np.int64), np.full(shown.height, None, dtype=object), np.full(shown.height, np.nan)
    on_board = sensors is not None and sensors.dme is not None
    network = {s.name: (s.lat_rad, s.lon_rad, s.height_m) for s in sensors.stations if s.kind != "vor"} if sensors and on_board else {}
    altitude = sensors.baro.bias_sigma_m if sensors is not None and sensors.baro is not None else ALTITUDE_SIGMA_M
    absent = [_stations_out(setup, time_s) for time_s in shown["time_s"]]
    for out in set(absent):
        rows = np.array([k for k, each in enumerate(absent) if each == out])
        left = {name: place for name, place in network.items() if name not in out}
        if not left:
            continue
        part = shown[rows.tolist()]
        lat, lon, h = (part[name].to_numpy() for name in ("lat_rad", "lon_rad", "h_m"))
        seen = dme.coverage(lat, lon, h, left, rnp_m=METRES_PER_NM, fte_m=0.0, sigma_altitude_m=altitude, risk=RISK_ACCURACY)
        names = dme.Stations.of(left).ident
        n[rows], circle[rows] = seen.n_stations, seen.nse_best_m
        pair[rows] = ["-".join(names[int(k)] for k in best) if best[0] >= 0 else None for best in seen.best]
    return pl.DataFrame({"n_dme": n, "dme_pair": pl.Series(pair.tolist(), dtype=pl.String), "dme_circle_m": circle})


def _stations_out(setup: Setup, time_s: float) -> frozenset[str]:
    return frozenset(name for w in _out(setup, time_s, 0.0) if w.what == "stations" for name in w.names)


def _out(setup: Setup, time_s: float, shift_s: float) -> list[Outage]:
    """What is not there at a time; outages by the clock stay where they are when the departure moves."""
    by_clock = shift_s if setup.dated else 0.0
    return [w for w in setup.windows if w.start_s <= time_s + by_clock < w.end_s]
