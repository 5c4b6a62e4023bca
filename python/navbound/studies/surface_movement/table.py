"""The surface-movement study for a terminal; every table of requirements says how they are held."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Group
from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import RenderableType

    from navbound.studies.surface_movement.records import Cell, Study

HEADINGS = {
    "accuracy": "Accuracy, 95 %",
    "single": "Single-fault level (before coasting: H0 and H1)",
    "multi": "Multi-fault level",
    "monitor": "Ground monitors' missed detection",
}


def render(study: Study) -> RenderableType:
    """Lay the study out: requirements, modes, maps, claims, numbers, words."""
    maps = [_map(study, quantity, case) for quantity in HEADINGS for case in _cases(study, quantity)]
    return Group(_phases(study), _before(study), *maps, _claims(study), _numbers(study), *map(escape, study.words))


def held(study: Study) -> str:
    """How the requirements are held, for every title they stand behind."""
    return ", ".join(sorted({p.held for p in study.phases}))


def bias_words(cell: Cell) -> str:
    """The largest bias of a cell."""
    return "-" if cell.bias_m is None else f"{cell.bias_m:g}"


def _table(title: str, headings: Sequence[str]) -> Table:
    table = Table(title=escape(title))
    for k, heading in enumerate(headings):
        table.add_column(escape(heading), justify="left" if k < 1 else "right", overflow="fold")
    return table


def _phases(study: Study) -> Table:
    table = _table(
        f"Requirements ({held(study)})",
        ("sub-phase", "containment, m", "HAL, m", "accuracy 95 %, m", "integrity", "continuity", "speed, m/s", "held"),
    )
    for p in study.phases:
        numbers = (f"{p.containment_m:g}", f"{p.hal_m:g}", f"{p.accuracy_m:.2f}", f"{p.integrity_risk:g}", f"{p.continuity_risk:g}")
        table.add_row(f"{p.id} {p.title}", *numbers, f"{p.speed_mps:g}", p.held)
    return table


def _before(study: Study) -> Table:
    table = _table(
        f"Before coasting, {study.constellation}",
        ("mode", "epochs", "without", "satellites", "sigma median / max, m", "gain median / max", "projection", "HPL at most, m, by bias"),
    )
    for b in study.before:
        sigma = f"{b.sigma_major_median_m:.3f} / {b.sigma_major_max_m:.3f}"
        gains = f"{b.bias_gain_median:.2f} / {b.bias_gain_max:.2f}"
        levels = " ".join(f"{v:.2f}" for v in b.hpl_max_m)
        sv = f"{b.n_sv_min}-, mean {b.n_sv_mean:.1f}"
        table.add_row(b.mode, str(b.n_epochs), str(b.n_unavailable), sv, sigma, gains, f"{b.worst_projection:.2f}", levels)
    return table


def _cases(study: Study, quantity: str) -> list[str]:
    """Cases that differ for a quantity."""
    of = {
        case: [(c.mode, c.phase, c.coasting_s, c.bias_m) for c in study.cells if (c.quantity, c.case) == (quantity, case)] for case in "AB"
    }
    return ["A"] if of["A"] == of["B"] else ["A", "B"]


def _map(study: Study, quantity: str, case: str) -> Table:
    cells = [c for c in study.cells if c.quantity == quantity and c.case == case]
    times = sorted({c.coasting_s for c in cells})
    title = f"{HEADINGS[quantity]}: largest nominal bias, m, with every epoch within the limit; case {case} (limits {held(study)})"
    table = _table(title, ("sub-phase, mode", *("before" if t == 0 else f"{t:g} s" for t in times)))
    for phase in [p.id for p in study.phases]:
        for mode in [b.mode for b in study.before]:
            row = {c.coasting_s: bias_words(c) for c in cells if c.phase == phase and c.mode == mode}
            table.add_row(f"{phase} {mode}", *(row.get(t, "") for t in times))
    return table


def _claims(study: Study) -> Table:
    table = _table(f"The paper's claims with {study.constellation}", ("id", "claim", "found", "verdict", "31 satellites of January 2020"))
    for c in study.claims:
        verdict = f"{c.verdict} (fitted: {c.fitted})" if c.fitted else c.verdict
        table.add_row(c.id, c.claim, c.found, verdict, c.expected)
    return table


def _numbers(study: Study) -> Table:
    table = _table("Numbers taken as given", ("number", "value", "held", "why"))
    for n in study.numbers:
        table.add_row(*map(escape, (n.name, n.value, n.held, n.why)))
    return table
