"""GBAS/INS and RRAIM for surface movement, after Song, Milner and No 2024: what can be reproduced, with whose satellites, claim by claim.

The paper's tables did not reach us; the requirements are rebuilt and every number here carries how it is held. One configuration is laid
over the one that ships (``scenario/shipped/studies/surface-movement.toml``); an almanac or navigation file on the command line
replaces the nominal satellites.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import gbas
from navbound.errors import InputError
from navbound.gbas.modes import K95, MODES, Mode
from navbound.studies.surface_movement import claims, grid, sky
from navbound.studies.surface_movement import scenario as surface
from navbound.studies.surface_movement.records import Before, Cell, Curve, Errors, Margin, Number, Phase, Study

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from navbound.gbas import Levels, Mark
    from navbound.studies.surface_movement.grid import Rules
    from navbound.studies.surface_movement.records import Quantity
    from navbound.studies.surface_movement.scenario import SurfaceMovement
    from navbound.studies.surface_movement.sky import Sky

    Floats = NDArray[np.float64]

WEAKEST = ("given", "ours", "inferred", "re-derived", "standard", "printed")
"""How a group of numbers is held is how its weakest one is."""
SEED = 673


def run(files: Sequence[str | Path] = (), *, progress: Callable[[int, int], None] | None = None) -> Study:
    """Do the study.

    Parameters
    ----------
    files : sequence of path
        A configuration (``.toml``), and files of satellites: YUMA or SEM for GPS, RINEX navigation for both constellations.
    progress : callable, optional
        Called with the modes done and their total.

    Returns
    -------
    Study
        Cells, curves, claims with their verdicts, and every number with its mark.

    Raises
    ------
    InputError
        Two configurations, an unknown sub-phase, a budget that cannot be met, an almanac of another week.
    FormatError
        A file that cannot be read.
    """
    config = configured([Path(f) for f in files])
    return study(config, sky.look(config), progress)


def study(config: SurfaceMovement, sky: Sky, progress: Callable[[int, int], None] | None = None) -> Study:
    """The study of given skies."""
    rules = grid.rules(config)
    tell, results = progress or (lambda _done, _all: None), []
    for done, mode in enumerate(MODES):
        tell(done, len(MODES))
        results.append(_mode(config, rules, mode, sky.of(mode.systems)))
    tell(len(results), len(results))
    befores = [f.before for f in results]
    margins = [m for f in results for m in f.margins]
    cells = [c for f in results for c in f.cells]
    aided = claims.aided_ratios(config, sky)
    grids = {f.mode.id: f.levels_of_cells[grid.CASES[0]] for f in results}
    judged = claims.judge(config, rules, befores, cells, grids=grids, aided=aided)
    return Study(
        title=config.title,
        constellation=sky.words,
        configuration=config,
        numbers=list(_numbers(rules)),
        phases=[_phase(rules, name) for name in rules.phases],
        before=befores,
        margins=margins,
        cells=cells,
        curves=[c for f in results for c in f.curves],
        errors=[f.errors for f in results],
        claims=judged,
        words=_words(config, sky),
    )


def configured(files: list[Path]) -> SurfaceMovement:
    """The configuration that files on a command line amount to."""
    tables = [f for f in files if f.suffix == ".toml"]
    if len(tables) > 1:
        raise InputError("files", len(tables), "1", "{0, 1}: configurations")
    config = surface.load(tables[0] if tables else None)
    geometry: dict[str, Any] = {}
    for file in (f for f in files if f.suffix != ".toml"):
        rinex = sky.is_rinex(file)
        geometry |= dict.fromkeys(sky.SYSTEMS if rinex else ("gps",), str(file))
    return config.model_copy(update={"geometry": config.geometry.model_copy(update=geometry)})


class _ModeResults:
    """Everything about one mode."""

    def __init__(self, mode: Mode) -> None:
        self.mode = mode
        self.margins: list[Margin] = []
        self.cells: list[Cell] = []
        self.curves: list[Curve] = []
        self.before: Before
        self.errors: Errors
        self.levels_of_cells: dict[str, Floats] = {}


def _mode(config: SurfaceMovement, rules: Rules, mode: Mode, sky: Sky) -> _ModeResults:
    result = _ModeResults(mode)
    covariance = grid.aided(config, mode, sky)
    first = next(iter(rules.phases.values()))
    levels = grid.before(config, mode, sky, first.integrity_risk, covariance)
    biases = np.asarray(config.grid.bias_m)
    gain = grid.gain(config, levels)
    result.before = _before(mode, levels, gain, biases)
    result.errors = _errors(mode, levels, gain, float(biases.max()))
    statistic = np.nanmedian if config.method.missed_detection == "median" else np.nanmax
    # The worst direction of the covariance used.
    sigma = (levels.accuracy_m - levels.bias_hor_m) / K95
    typical, typical_gain = float(statistic(sigma)), float(statistic(gain))
    for case in grid.CASES:
        if case == grid.CASES[0] or len(mode.systems) > 1:
            result.levels_of_cells[case] = grid.coasting(config, rules, mode, case, sky, covariance_m2=covariance)
        else:
            result.levels_of_cells[case] = result.levels_of_cells[grid.CASES[0]]
        for k, (name, phase) in enumerate(rules.phases.items()):
            own = (
                grid.before(config, mode, sky, phase.integrity_risk, covariance) if phase.integrity_risk != first.integrity_risk else levels
            )
            decades = grid.margins(rules, mode, case, phase, share=rules.allocation.ground, sigma_m=typical, bias_m=biases * typical_gain)
            result.margins.append(Margin(mode=mode.id, case=case, phase=name, decades=decades.tolist()))
            cells = result.levels_of_cells[case][:, :, k]
            place = {"mode": mode.id, "case": case, "phase": name}
            result.cells += list(
                _cells_before(place, own, gain, biases, accuracy_m=rules.accuracy_m[name], hal_m=phase.hal_m, decades=decades)
            )
            result.cells += list(_cells_coasting(config, rules, mode, place, cells, statistic=statistic))
            result.curves.append(_curve(rules, mode, case, name, typical))
    return result


def _before(mode: Mode, levels: Levels, gain: Floats, biases: Floats) -> Before:
    ok = levels.status == "ok"

    def worst(values: Floats) -> list[float]:
        return [float(np.max(values[ok] + b * gain[ok])) for b in biases] if ok.any() else []

    return Before(
        mode=mode.id,
        n_epochs=int(ok.size),
        n_unavailable=int((~ok).sum()),
        n_sv_min=int(levels.n_sv.min()),
        n_sv_mean=float(levels.n_sv.mean()),
        sigma_major_median_m=float(np.nanmedian(levels.sigma_major_m)),
        sigma_major_max_m=float(np.nanmax(levels.sigma_major_m)),
        bias_gain_median=float(np.nanmedian(gain)),
        bias_gain_max=float(np.nanmax(gain)),
        worst_projection=float(np.nanmax(levels.worst_projection)),
        hpl_max_m=worst(levels.hpl_m),
        accuracy_max_m=worst(levels.accuracy_m),
    )


def _errors(mode: Mode, levels: Levels, gain: Floats, bias_m: float) -> Errors:
    """One draw of noise an epoch, and the bias at its worst in a random direction."""
    ok = levels.status == "ok"
    generator = np.random.Generator(np.random.Philox(SEED))
    roots = np.linalg.cholesky(levels.covariance_enu_m2[ok][:, :2, :2])
    noise = np.einsum("nij,nj->ni", roots, generator.standard_normal((int(ok.sum()), 2)))
    direction = generator.uniform(0, 2 * np.pi, int(ok.sum()))
    shift = bias_m * gain[ok][:, None] * np.stack([np.cos(direction), np.sin(direction)], axis=-1)
    level = levels.hpl_m[ok] + bias_m * gain[ok]
    return Errors(mode=mode.id, hpe_m=np.linalg.norm(noise + shift, axis=-1).tolist(), hpl_m=level.tolist())


def _cells_before(
    place: dict[str, str], levels: Levels, gain: Floats, biases: Floats, *, accuracy_m: float, hal_m: float, decades: Floats
) -> Iterator[Cell]:
    steps = biases[None, :] * gain[:, None]
    yield _cell("accuracy", place, 0.0, levels.accuracy_m[:, None] + steps, biases, limit=accuracy_m)
    yield _cell("single", place, 0.0, levels.hpl_m[:, None] + steps, biases, limit=hal_m)
    yield _monitor_cell(place, 0.0, decades, biases)


def _cells_coasting(
    config: SurfaceMovement, rules: Rules, mode: Mode, place: dict[str, str], cells: Floats, *, statistic: Any
) -> Iterator[Cell]:
    biases, phase = np.asarray(config.grid.bias_m), rules.phases[place["phase"]]
    limits: tuple[tuple[Quantity, float], ...] = (
        ("accuracy", rules.accuracy_m[place["phase"]]),
        ("single", phase.hal_m),
        ("multi", phase.hal_m),
    )
    for t, seconds in enumerate(config.grid.coasting_s):
        for q, (quantity, limit) in enumerate(limits):
            yield _cell(quantity, place, seconds, cells[:, t, :, q], biases, limit=limit)
        accuracy = cells[:, t, :, 0]
        if np.isnan(accuracy).all():
            continue
        # Accuracy is 1.96 sigma and the effect of the bias.
        none = accuracy[:, 0] - biases[0] * _slope(accuracy, biases)
        sigma, gain = float(statistic(none)) / K95, float(statistic(_slope(accuracy, biases)))
        share = rules.allocation.coasting_ground
        decades = grid.margins(rules, mode, place["case"], phase, share=share, sigma_m=sigma, bias_m=biases * gain)
        yield _monitor_cell(place, seconds, decades, biases)


def _slope(accuracy: Floats, biases: Floats) -> Floats:
    """Metres of accuracy for a metre of bias; 0 where only one size is requested."""
    spread = float(biases[-1] - biases[0])
    return (accuracy[:, -1] - accuracy[:, 0]) / spread if spread else np.zeros(len(accuracy))


def _cell(quantity: Quantity, place: dict[str, str], seconds: float, values: Floats, biases: Floats, *, limit: float) -> Cell:
    """The largest bias with every epoch within the limit; an epoch without a value is not."""
    passes = values <= limit
    every = passes.all(axis=0)
    worst = float(np.max(values[:, 0])) if not np.isnan(values[:, 0]).any() else None
    largest = float(biases[every].max()) if every.any() else None
    return Cell(quantity=quantity, **place, coasting_s=seconds, bias_m=largest, worst_m=worst, share=float(passes[:, 0].mean()))


def _monitor_cell(place: dict[str, str], seconds: float, decades: Floats, biases: Floats) -> Cell:
    good = decades >= 0
    largest = float(biases[good].max()) if good.any() else None
    return Cell(quantity="monitor", **place, coasting_s=seconds, bias_m=largest, worst_m=float(decades[0]), share=float(good[0]))


def _curve(rules: Rules, mode: Mode, case: str, name: str, sigma_m: float) -> Curve:
    curve = rules.curves[mode.service]
    error = np.linspace(0.0, 1.2 * curve.end_m * curve.stretch, 121)
    numbers = grid.hazard(rules, mode, case, rules.phases[name], share=rules.allocation.ground, sigma_m=sigma_m, bias_m=0.0)
    return Curve(
        mode=mode.id,
        case=case,
        phase=name,
        error_m=error.tolist(),
        limit=gbas.missed_detection_limit(error, **numbers).tolist(),
        monitor=gbas.missed_by_monitor(error, mode.service, stretch=curve.stretch).tolist(),
    )


def _phase(rules: Rules, name: str) -> Phase:
    p = rules.phases[name]
    provenance = min((m.held for m in p.marks), key=WEAKEST.index)
    if any(m.held == "inferred" for m in p.marks):
        provenance = "inferred"
    return Phase(
        id=p.id,
        title=p.title,
        containment_m=p.containment_m,
        hal_m=p.hal_m,
        accuracy_m=rules.accuracy_m[name],
        integrity_risk=p.integrity_risk,
        continuity_risk=p.continuity_risk,
        speed_mps=p.speed_mps,
        held=provenance,
    )


def _numbers(rules: Rules) -> Iterator[Number]:
    """Everything taken as given, with its mark."""

    def each(where: str, marks: Sequence[Mark], record: Any = None) -> Iterator[Number]:
        for m in marks:
            fields = vars(record) if record is not None else {}
            named = (v for k, v in fields.items() if k == m.name or k.startswith(f"{m.name}_"))
            value = next((f"{v:g}" for v in named if isinstance(v, (int, float))), "")
            yield Number(name=f"{where}: {m.name}", value=value, held=m.held, why=m.why)

    for name, phase in rules.phases.items():
        yield from each(f"sub-phase {name}", phase.marks, phase)
    yield from each("allocation", rules.allocation.marks, rules.allocation)
    yield from each("error budget", rules.budget.marks, rules.budget)
    for name, rates in rules.rates.items():
        yield from each(f"fault rates, case {name}", rates.marks, rates)
    for service, marks in gbas.model_marks().items():
        yield from each(f"GAST {service}" if service in gbas.SERVICES else service, marks)
    for name, carrier in rules.carriers.items():
        yield from each(f"phase, {name} frequency", carrier.marks, carrier)
    for service, curve in rules.curves.items():
        yield from each(f"monitor of GAST {service}", curve.marks, curve)


def _words(config: SurfaceMovement, sky: Sky) -> list[str]:
    words = [
        f"Every verdict belongs to {sky.words}; the paper used geometries of January 2019 that are not public.",
        "Requirements are inferred: the paper's table did not reach us. A claim that was used to choose a number is marked fitted: it is "
        "no evidence.",
        "No column is a statement of safety: with the noise model that bounds, the covariance with an inertial system is larger, not "
        "smaller, than that of the ranges alone (claim C04).",
    ]
    if not sky.dated:
        words.append(
            "Nominal satellites: typical of the constellations, not of a date. With an almanac of a date the verdicts are that date's."
        )
    if config.method.covariance == "paper":
        words.append("The covariance is the paper's form, which nothing shows to bound.")
    return words
