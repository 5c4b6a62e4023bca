"""The paper's nineteen checkable statements on surface movement, each judged from the study's cells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from navbound import gbas
from navbound.gbas.modes import MODES
from navbound.studies.surface_movement import grid
from navbound.studies.surface_movement.records import Claim

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from navbound.studies.surface_movement.grid import Rules
    from navbound.studies.surface_movement.records import Before, Cell
    from navbound.studies.surface_movement.scenario import SurfaceMovement
    from navbound.studies.surface_movement.sky import Sky

    Floats = NDArray[np.float64]

NEEDED_PHASES = ("RET", "NTW", "ATW", "TL", "SLL")
TAXIWAYS = ("RET", "NTW")
SPARSE_S = 1800.0
"""Between the geometries that fixed the clock drift of claim C18, which is judged over all."""
AIDED_SKIES = 6
TSC_CHOICE = "containment of ATW, TL and SLL"
STRETCH = "2.2 of the monitor of GAST F"


@dataclass(frozen=True)
class Evidence:
    """What a claim is judged from."""

    config: SurfaceMovement
    rules: Rules
    before: dict[str, Before]
    cells: dict[tuple[str, str, str, str, float], Cell]
    grids: dict[str, Floats]
    aided: dict[str, tuple[float, float]]

    def cell(self, quantity: str, mode: str, phase: str, seconds: float = 0.0, case: str = "A") -> Cell:
        """One cell."""
        return self.cells[quantity, mode, case, phase, seconds]

    def largest(self, quantity: str, mode: str, phase: str, seconds: float = 0.0, case: str = "A") -> float:
        """The largest bias of a cell; -1 where not even none passes."""
        bias_m = self.cell(quantity, mode, phase, seconds, case).bias_m
        return -1.0 if bias_m is None else bias_m

    @property
    def times(self) -> list[float]:
        """Coasting times."""
        return list(self.config.grid.coasting_s)

    def triple(self, quantity: str, phase: str, seconds: float, case: str = "A") -> str:
        """The largest biases of the three modes in words."""
        return ", ".join(f"{m.id} {shown(self.largest(quantity, m.id, phase, seconds, case))}" for m in MODES)


def shown(bias_m: float) -> str:
    """A largest bias in words."""
    return "none" if bias_m < 0 else f"{bias_m:g}"


def aided_ratios(config: SurfaceMovement, sky: Sky) -> dict[str, tuple[float, float]]:
    """Least and largest ratio of the deviation with an inertial system to that of ranges alone, by form of the noise, over some skies."""
    by_form: dict[str, list[float]] = {"paper": [], "bound": []}
    some = np.linspace(0, len(sky.az_rad) - 1, min(AIDED_SKIES, len(sky.az_rad))).astype(int)
    for mode in MODES:
        own = sky.of(mode.systems)
        az, el = own.az_rad[some], own.el_rad[some]
        alone = gbas.protection_levels(az, el, own.systems, service=mode.service)
        usable = alone.status == "ok"
        for form in by_form:
            lat_rad = float(np.radians(config.airport.lat_deg))
            covariance = gbas.aided_covariance(
                az[usable], el[usable], own.systems, lat_rad=lat_rad, service=mode.service, noise="paper" if form == "paper" else "bound"
            )
            both = gbas.protection_levels(az[usable], el[usable], own.systems, service=mode.service, aided_covariance_m2=covariance)
            by_form[form] += (both.sigma_m / alone.sigma_m[usable]).tolist()
    return {form: (min(ratios), max(ratios)) for form, ratios in by_form.items() if ratios}


def judge(
    config: SurfaceMovement,
    rules: Rules,
    befores: Sequence[Before],
    cells: Sequence[Cell],
    *,
    grids: dict[str, Floats],
    aided: dict[str, tuple[float, float]],
) -> list[Claim]:
    """A verdict on each claim; none where the configuration leaves out what it is about."""
    table: dict[tuple[str, str, str, str, float], Cell] = {(c.quantity, c.mode, c.case, c.phase, c.coasting_s): c for c in cells}
    evidence = Evidence(config, rules, {b.mode: b for b in befores}, table, grids, aided)
    whole = all(p in rules.phases for p in NEEDED_PHASES) and max(config.grid.bias_m) >= 0.5 and not any(b.n_unavailable for b in befores)
    needed = {10.0, 20.0, 60.0, 600.0} <= set(config.grid.coasting_s)
    claims = []
    for entry in CLAIMS:
        if whole and needed:
            verdict, evidence_words = entry.judge(evidence)
        else:
            verdict, evidence_words = "not judged", "the configuration leaves out what the claim is about, or an epoch has no solution"
        claims.append(
            Claim(id=entry.id, claim=entry.claim, found=evidence_words, verdict=verdict, fitted=entry.fitted, expected=entry.expected)
        )
    return claims


Verdict = Literal["reproduced", "not reproduced", "only without a bound", "bounded", "by construction", "fixes a number", "not judged"]
Judged = tuple[Verdict, str]


def _if(holds: bool, evidence: str, verdict: Verdict = "reproduced") -> Judged:
    return (verdict if holds else "not reproduced"), evidence


def _c01(e: Evidence) -> Judged:
    limit = e.rules.phases["NTW"].hal_m
    worst = {m: e.before[m].hpl_max_m[-1] for m in ("D", "F2")}
    return _if(all(v <= limit for v in worst.values()), f"worst HPL {worst['D']:.2f} m (D), {worst['F2']:.2f} m (F2), limit {limit:g} m")


def _c02(e: Evidence) -> Judged:
    d, f = (e.largest("accuracy", m, "NTW") for m in ("D", "F2"))
    return _if(d == 0.3 and f == 0.4, f"largest bias {shown(d)} m (D), {shown(f)} m (F2)")


def _c03(e: Evidence) -> Judged:
    d, f = (e.largest("accuracy", m, "NTW") for m in ("D", "F2"))
    return _if(f > d, f"accuracy: {shown(f)} m (F2) against {shown(d)} m (D)")


def _c04(e: Evidence) -> Judged:
    (low, high), (low_b, high_b) = e.aided["paper"], e.aided["bound"]
    sentence = f"sigma ratio {low:.2f} to {high:.2f} with the paper's noise, {low_b:.1f} to {high_b:.1f} with noise that bounds"
    return _if(high < 1 and low_b > 1, sentence, "only without a bound")


def _c05(e: Evidence) -> Judged:
    d, f = grid.worldwide()
    own = f"here {e.before['D'].worst_projection:.2f} and {e.before['F2'].worst_projection:.2f}"
    return _if(d <= 2.0 and f <= 0.7, f"nominal satellites, worldwide: {d:.2f} (D) and {f:.2f} (F2); {own}", "bounded")


def _c06(e: Evidence) -> Judged:
    d, f = (e.largest("monitor", m, "NTW") for m in ("D", "F2"))
    return _if(f > d >= 0, f"taxiway: {shown(d)} m (D), {shown(f)} m (F2)")


def _c07(e: Evidence) -> Judged:
    a, b = (e.largest("monitor", "F2", "NTW", case=case) for case in grid.CASES)
    return _if(b > a, f"taxiway: {shown(b)} m (B) against {shown(a)} m (A)")


def _c08(e: Evidence) -> Judged:
    feasible = all(e.largest(q, m, p) >= 0 for q in ("accuracy", "single", "monitor") for m in ("D", "F2") for p in TAXIWAYS)
    d, a, b = e.largest("monitor", "D", "NTW"), e.largest("monitor", "F2", "NTW"), e.largest("monitor", "F2", "NTW", case="B")
    return _if(feasible and a >= d + 0.3, f"monitor: {shown(d)} m (D), {shown(a)} / {shown(b)} m (F2, case A / B)")


def _c09(e: Evidence) -> Judged:
    others = all(e.largest("monitor", m, p, case="B") < 0 for m in ("D", "F1") for p in ("ATW", "TL"))
    b = [e.largest("monitor", "F2", p, case="B") for p in ("ATW", "TL")]
    a = [e.largest("monitor", "F2", p) for p in ("ATW", "TL")]
    sentence = f"F2: {', '.join(map(shown, b))} in case B, {', '.join(map(shown, a))} in case A; D and F1 {'none' if others else 'some'}"
    return _if(others and b == [0.0, 0.0], sentence)


def _c10(e: Evidence) -> Judged:
    met = [m.id for m in MODES for case in grid.CASES if e.largest("monitor", m.id, "SLL", case=case) >= 0]
    return _if(not met, f"met by {', '.join(met)}" if met else "met by none")


def _c11(e: Evidence) -> Judged:
    d = e.largest("monitor", "D", "NTW") >= 0 > e.largest("monitor", "D", "ATW")
    f = e.largest("monitor", "F2", "TL", case="B") >= 0 > e.largest("monitor", "F2", "SLL", case="B")
    bias = e.largest("monitor", "F2", "NTW")
    where = f"D {'up to' if d else 'not only up to'} the taxiway, F2 {'up to' if f else 'not only up to'} the taxi lane (case B)"
    return _if(d and f and bias == 0.4, f"{where}; taxiway with F2 up to {shown(bias)} m")


def _ordered(e: Evidence, quantity: str) -> tuple[bool, bool]:
    """F2 at least D at least F1 in every cell, and somewhere more."""
    rows = [[e.largest(quantity, m, p, t) for m in ("F2", "D", "F1")] for p in NEEDED_PHASES for t in e.times]
    return all(f2 >= d >= f1 for f2, d, f1 in rows), any(f2 > d > f1 for f2, d, f1 in rows)


def _c12(e: Evidence) -> Judged:
    _, strict = _ordered(e, "accuracy")
    d, f1 = e.largest("accuracy", "D", "NTW", 10.0), e.largest("accuracy", "F1", "NTW", 10.0)
    at = e.triple("accuracy", "NTW", 10.0)
    long = e.triple("accuracy", "NTW", 600.0)
    best = all(
        e.largest("accuracy", "F2", p, t) >= e.largest("accuracy", m, p, t) for m in ("D", "F1") for p in NEEDED_PHASES for t in e.times
    )
    return _if(best and strict and d > f1, f"NTW at 10 s: {at}; at 600 s: {long}")


def _c13(e: Evidence) -> Judged:
    ordered, strict = _ordered(e, "single")
    return _if(ordered and strict, f"NTW at 10 s: {e.triple('single', 'NTW', 10.0)}; ATW: {e.triple('single', 'ATW', 10.0)}")


def _c14(e: Evidence) -> Judged:
    pairs = [
        (e.largest("multi", m.id, p, t, case), e.largest("single", m.id, p, t, case))
        for m in MODES
        for p in NEEDED_PHASES
        for t in e.times
        for case in grid.CASES
    ]
    above = sum(multi > single for multi, single in pairs)
    return _if(above == 0, f"multi-fault above single-fault in {above} of {len(pairs)} cells")


def _worst(e: Evidence, mode: str, seconds: float) -> float:
    worst_m = e.cell("multi", mode, "SLL", seconds).worst_m
    return np.inf if worst_m is None else worst_m


def _c15(e: Evidence) -> Judged:
    short, long = 10.0, 600.0
    d, f = ([_worst(e, m, t) for t in (short, long)] for m in ("D", "F2"))
    sentence = f"level without bias {d[0]:.2f} (D) against {f[0]:.2f} m (F2) at 10 s, {d[1]:.1f} against {f[1]:.1f} m at 600 s"
    return _if(d[0] < f[0] and f[1] < d[1], sentence)


def _c16(e: Evidence) -> Judged:
    places = [("ATW", 60.0), ("TL", 20.0), ("TL", 60.0)]
    pairs = [(e.largest("multi", "F1", *place), e.largest("multi", "F2", *place)) for place in places]
    sentence = "; ".join(f"{p} at {t:g} s: F1 {shown(a)}, F2 {shown(b)}" for (p, t), (a, b) in zip(places, pairs, strict=True))
    return _if(all(a > b for a, b in pairs), sentence)


def _c17(e: Evidence) -> Judged:
    more = [
        (m.id, p, t)
        for m in MODES
        for p in NEEDED_PHASES
        for t in e.times
        if e.largest("monitor", m.id, p, t) > e.largest("monitor", m.id, p)
    ]
    return _if(not more, f"larger while coasting in {len(more)} cells", "by construction")


def _c18(e: Evidence) -> Judged:
    every = round(max(1.0, SPARSE_S / e.config.geometry.step_s))
    biases = np.asarray(e.config.grid.bias_m)
    last = e.times.index(600.0)
    names = list(e.rules.phases)

    def largest(mode: str, step: int) -> float:
        within = [e.grids[mode][::step, last, names.index(p), :, 1] <= e.rules.phases[p].hal_m for p in TAXIWAYS]
        good = np.logical_and.reduce([w.all(axis=0) for w in within])
        return float(biases[good].max()) if good.any() else -1.0

    sparse = {m.id: largest(m.id, every) for m in MODES}
    dense = {m.id: largest(m.id, 1) for m in MODES}
    words = [", ".join(f"{m} {shown(v)}" for m, v in shares.items()) for shares in (sparse, dense)]
    sentence = f"single fault at 600 s: {words[1]} over all geometries; {words[0]} over those 30 min apart, by which the number was fixed"
    return _if(all(v >= 0 for v in dense.values()), sentence, "fixes a number")


def _c19(e: Evidence) -> Judged:
    multi = [c for c in e.cells.values() if c.quantity == "multi" and c.case == "A"]
    empty = sum(c.bias_m is None for c in multi)
    return _if(empty > 0, f"{empty} of {len(multi)} cells of the multi-fault map")


@dataclass(frozen=True)
class _Entry:
    id: str
    claim: str
    expected: str
    judge: Callable[[Evidence], Judged]
    fitted: str = ""


CLAIMS = (
    _Entry(
        "C01",
        "taxiway: HPL within HAL for D and F even with 0.5 m of bias",
        "reproduced: 4.34 (D), 3.27 m (F2)",
        _c01,
        "worst direction in equation 5",
    ),
    _Entry("C02", "taxiway: accuracy met only below 0.4 m (D) and 0.5 m (F)", "reproduced: 0.3 (D), 0.4 m (F2)", _c02),
    _Entry("C03", "F allows slightly more than D before coasting", "reproduced", _c03),
    _Entry(
        "C04", "sigma with the inertial system below that of the ranges", "only with the paper's noise: 0.89-0.95 against 2.6-3.3", _c04
    ),
    _Entry("C05", "worst horizontal projection 2 (D) and 0.7 (F) over the globe", "bounded: 1.46 and 0.50", _c05),
    _Entry("C06", "missed detection: larger bias with F than D", "reproduced: 0 (D), 0.4 m (F2)", _c06),
    _Entry("C07", "case B allows more than case A", "reproduced: 0.5 against 0.4 m", _c07),
    _Entry("C08", "rapid exit and taxiway feasible, ample margin for F", "reproduced: 0 (D), 0.4/0.5 m (F2)", _c08, STRETCH),
    _Entry(
        "C09", "apron taxiway and taxi lane only with F2 and only without bias", "reproduced for case B", _c09, f"{STRETCH}; {TSC_CHOICE}"
    ),
    _Entry("C10", "stand lead-in line never met", "reproduced", _c10, f"{STRETCH}; {TSC_CHOICE}"),
    _Entry("C11", "transition with D before the apron, with F before the stand; taxiway up to 0.4 m", "reproduced", _c11, STRETCH),
    _Entry("C12", "coasting accuracy: F2 best, D slightly better than F1", "reproduced: 0.4 / 0.3 / 0.2 m on the taxiway", _c12),
    _Entry("C13", "single-fault level: F2 at least D at least F1", "reproduced", _c13),
    _Entry("C14", "multi-fault bias at most single-fault bias everywhere", "reproduced", _c14),
    _Entry("C15", "multi-fault at the stand: D beats F2 for short coasting, F2 wins for long", "not reproduced for short coasting", _c15),
    _Entry("C16", "multi-fault: F1 slightly above F2 on ATW at 60 s and TL at 20-60 s", "not reproduced", _c16),
    _Entry("C17", "biases while coasting at most those before", "by construction", _c17),
    _Entry(
        "C18",
        "rapid exit and taxiway met with margin by all modes while coasting",
        "fixes the clock drift: 0.4, 0.2, 0.5 m",
        _c18,
        "clock drift 0.3 mm/s",
    ),
    _Entry("C19", "the multi-fault map has boxes without any bias", "reproduced", _c19),
)
