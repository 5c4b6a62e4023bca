"""The numbers of the surface-movement study: levels before coasting, the grid of coasting, margins of the ground monitors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core, gbas, gnss, rraim
from navbound.errors import InputError
from navbound.gbas import Carrier, ErrorBudget, FaultRates, Levels, Mark, SubPhase
from navbound.gbas.modes import Mode

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.studies.surface_movement.scenario import SurfaceMovement
    from navbound.studies.surface_movement.sky import Sky

    Floats = NDArray[np.float64]

CASES: tuple[str, ...] = ("A", "B")
GPS_HALF = 9
"""Satellites of GPS among the 18 of both constellations (inferred)."""


@dataclass(frozen=True)
class Rules:
    """What the study takes as given, the user's numbers laid over the rebuilt ones."""

    phases: dict[str, SubPhase]
    budget: ErrorBudget
    accuracy_m: dict[str, float]
    carriers: dict[str, Carrier]
    curves: dict[str, gbas.MonitorCurve]
    rates: dict[str, FaultRates]
    allocation: gbas.Allocation


def rules(config: SurfaceMovement) -> Rules:
    """Gather the rules.

    Raises
    ------
    InputError
        A sub-phase that is not there, a budget that cannot be met.
    """
    given = config.given
    phases = gbas.sub_phases()
    if config.requirement:
        mark = (Mark("requirement", "given", "the configuration's own"),)
        phases = {r.id: SubPhase(**r.model_dump(), marks=mark) for r in config.requirement}
    for name in config.only:
        if name not in phases:
            raise InputError("only", name, domain=f"sub-phases: {', '.join(phases)}")
    kept = {name: phases[name] for name in (config.only or phases)}
    budget = _stated(gbas.error_budget(), sigma_fte_m=given.sigma_fte_m, sigma_pde_m=given.sigma_pde_m)
    curves = gbas.monitor_curves()
    curves["D"] = _stated(curves["D"], projection=given.gast_d_projection)
    curves["F"] = _stated(curves["F"], projection=given.gast_f_projection, stretch=given.gast_f_stretch)
    return Rules(
        phases=kept,
        budget=budget,
        accuracy_m={name: gbas.accuracy_limit(phase.containment_m, budget) for name, phase in kept.items()},
        carriers={name: _stated(c, clock_mps=given.clock_mps) for name, c in gbas.carriers().items()},
        curves=curves,
        rates=gbas.fault_rates(),
        allocation=gbas.allocation(),
    )


def _stated(record: Any, **numbers: float | None) -> Any:
    """The record with the user's numbers, each marked."""
    own = {name: value for name, value in numbers.items() if value is not None}
    marks = tuple(Mark(name, "given", "the configuration's own") for name in own)
    return replace(record, **own, marks=(*record.marks, *marks)) if own else record


def aided(config: SurfaceMovement, mode: Mode, sky: Sky) -> Floats | None:
    """Covariance of the fix with an inertial system, where the configuration wants one."""
    if config.method.covariance == "snapshot":
        return None
    lat_rad = float(np.radians(config.airport.lat_deg))
    return gbas.aided_covariance(sky.az_rad, sky.el_rad, sky.systems, lat_rad=lat_rad, service=mode.service, noise=config.method.covariance)


def before(config: SurfaceMovement, mode: Mode, sky: Sky, risk: float, covariance_m2: Floats | None) -> Levels:
    """Levels of every geometry without bias; they grow by the gain for each metre of it."""
    return gbas.protection_levels(
        sky.az_rad,
        sky.el_rad,
        sky.systems,
        service=mode.service,
        integrity_risk=risk,
        aided_covariance_m2=covariance_m2,
        ordering=config.method.ordering,
        form=config.method.form,
    )


def gain(config: SurfaceMovement, levels: Levels) -> Floats:
    """Gain of the bias in the configured ordering."""
    gains: Floats = getattr(levels, f"bias_gain_{config.method.ordering}")
    return gains


def fault_probability(mode: Mode, rates: FaultRates) -> float:
    """Probability of a fault that the ground monitors do not yet show."""
    groups = [(rates.satellites, rates.gps_per_hour)]
    if len(mode.systems) > 1:
        groups = [(GPS_HALF, rates.gps_per_hour), (rates.satellites - GPS_HALF, rates.galileo_per_hour)]
    return gbas.fault_probability([g[0] for g in groups], [g[1] for g in groups], rates.decorrelation_s)


def hazard(rules: Rules, mode: Mode, case: str, phase: SubPhase, *, share: float, sigma_m: Any, bias_m: Any) -> dict[str, Any]:
    """Arguments of a missed-detection limit."""
    budget = rules.budget
    return {
        "containment_m": phase.containment_m,
        "sigma_tse_m": np.sqrt(np.square(sigma_m) + budget.sigma_fte_m**2 + budget.sigma_pde_m**2),
        "projection": rules.curves[mode.service].projection,
        "allotted_risk": share * phase.integrity_risk,
        "p_fault": fault_probability(mode, rules.rates[case]),
        "bias_hor_m": bias_m,
    }


def margins(rules: Rules, mode: Mode, case: str, phase: SubPhase, *, share: float, sigma_m: Any, bias_m: Any) -> Floats:
    """Decades that the ground monitors have to spare."""
    curve = rules.curves[mode.service]
    numbers = hazard(rules, mode, case, phase, share=share, sigma_m=sigma_m, bias_m=bias_m)
    return gbas.monitor_margin(service=mode.service, stretch=curve.stretch, **numbers)


def coasting(config: SurfaceMovement, rules: Rules, mode: Mode, case: str, sky: Sky, *, covariance_m2: Floats | None) -> Floats:
    """Accuracy, single- and multi-fault level; shape (epochs, times, sub-phases, biases, 3), NaN where there is none."""
    rates, shares, grid = rules.rates[case], rules.allocation, config.grid
    flat = np.ascontiguousarray
    single = len(mode.systems) == 1
    demands = []
    for phase in rules.phases.values():
        multipliers = gbas.factors(
            phase.integrity_risk, share=shares.no_fault_and_receiver, axes=shares.axes, receiver_fault=shares.receiver_fault
        )
        allotted = shares.coasting_fault * phase.integrity_risk
        rule = rraim.rule(multipliers, phase.continuity_risk, allotted, ordering=config.method.ordering, form=config.method.form)
        demands.append((phase.speed_mps, rule))
    shape = sky.az_rad.shape
    gps, galileo = (gnss.CONSTELLATIONS.index(name) for name in ("gps", "galileo"))
    wide = {} if single else {gps: rates.gps_wide_per_hour, galileo: rates.galileo_wide_per_hour}
    job = {
        "fix": rraim.fix(
            flat(sky.az_rad).ravel(),
            flat(sky.el_rad).ravel(),
            shape,
            constellation=[int(c) for c in sky.systems],
            service=mode.service,
            aided_covariance_m2=covariance_m2,
        ),
        "az_now_rad": flat(sky.az_now_rad).ravel(),
        "el_now_rad": flat(sky.el_now_rad).ravel(),
        "coasting_s": list(grid.coasting_s),
        "demands": demands,
        "unmonitored": shares.unmonitored,
        "bias_m": list(grid.bias_m),
        "carrier": rules.carriers[mode.carrier].numbers(),
        "rate_per_hour": rraim.by_system("p_sat", {gps: rates.gps_per_hour, galileo: rates.galileo_per_hour}, 0.0),
        "wide_per_hour": rraim.by_system("p_const", wide, 0.0),
        "fault_lasts_s": None,
    }
    cells = _core.surface_cells(job)
    return cells.reshape(shape[0], len(grid.coasting_s), len(demands), len(grid.bias_m), 3)


def worldwide(step_s: float = 1800.0) -> tuple[float, float]:
    """Worst horizontal projections of one range over the globe: nominal GPS with GAST D, GPS and Galileo with GAST F.

    A grid of 10 by 20 degrees and a day.
    """
    orbits = gnss.constellation("gps") + gnss.constellation("galileo")
    lat, lon = (a.ravel() for a in np.meshgrid(np.radians(np.arange(-90, 91, 10)), np.radians(np.arange(-180, 180, 20))))
    sky = gnss.geometry(orbits, lat[:, None], lon[:, None], 0.0, np.arange(0.0, 86_400.0, step_s), mask_rad=float(np.radians(5.0)))
    first = orbits.constellation == 0
    alone = gbas.protection_levels(
        np.ascontiguousarray(sky.az_rad[..., first]), np.ascontiguousarray(sky.el_rad[..., first]), orbits.constellation[first], service="D"
    )
    both = gbas.protection_levels(sky.az_rad, sky.el_rad, orbits.constellation, service="F")
    return float(np.nanmax(alone.worst_projection)), float(np.nanmax(both.worst_projection))
