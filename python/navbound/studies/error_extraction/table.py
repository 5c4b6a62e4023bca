"""The Error Extraction study for a terminal; every table says that the bound is experimental, not integrity."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Group
from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from rich.console import RenderableType

    from navbound.studies.error_extraction.records import Availability, RiskOfMemory, Spread, Study

LEVELS = ("APV-I", "LPV-200", "APV-II", "CAT-I (12 m)")


def render(study: Study) -> RenderableType:
    """Lay the study out: stages, causes, claims, memory of the error, bias, faults, words."""
    parts: list[RenderableType] = [_stages(study), _split(study), _claims(study), _memory(study)]
    if study.bias is not None:
        b = study.bias
        parts.append(
            f"Vertical bias bound of the recorded MSAS hour ({study.label}): eq. 7 median {b.from_dop_m_median:.1f} m, at most "
            f"{b.from_dop_m_max:.1f} m; exact median {b.exact_m_median:.1f} m, at most {b.exact_m_max:.1f} m and "
            f"{b.worst_ratio:.3f} times mu sqrt(N) VDOP."
        )
    return Group(*parts, _faults(study), _risks(study, study.held), _risks(study, study.held_small), _risks_of_laws(study), *study.words)


def _titled(study: Study, title: str, *headings: str) -> Table:
    table = Table(title=escape(f"{title}\nEE bound ({study.label})"))
    for k, heading in enumerate(headings):
        table.add_column(escape(heading), justify="left" if k == 0 else "right")
    return table


def _shares(availability: Availability, *, signed: bool = False) -> list[str]:
    values = (availability.apv_i, availability.lpv_200, availability.apv_ii, availability.cat_i_12)
    digits = "+.1f" if signed else ".1f"
    return ["" if v is None else f"{100 * v:{digits}}" for v in values]


def _number(value: float | None, digits: int = 2) -> str:
    return "" if value is None else f"{value:.{digits}f}"


def _stages(study: Study) -> Table:
    title = f"{study.positions}: availability of {study.n_judged} of {study.n_epochs} solution epochs [%], errors 95 % [m]"
    headings = ("bound", "what changed", *LEVELS, "HPE", "VPE", "VPE max", "SI max H", "SI max V", "MI")
    table = _titled(study, title, *headings)
    for s in study.stages:
        numbers = [_number(v) for v in (s.hpe95_m, s.vpe95_m, s.vpe_max_m, s.safety_h_max, s.safety_v_max)]
        misleading = "" if s.n_misleading is None else str(s.n_misleading)
        table.add_row(s.name, s.cause, *_shares(s.availability), *numbers, misleading)
    return table


def _split(study: Study) -> Table:
    table = _titled(study, "The gain by cause [points]", "cause", *LEVELS)
    for cause in study.split:
        table.add_row(cause.cause, *_shares(cause.gain, signed=True))
    return table


def _claims(study: Study) -> Table:
    table = _titled(study, "The published claims", "claim", "published", "computed", "verdict", "why")
    for c in study.claims:
        table.add_row(c.claim, c.published, c.computed, c.verdict, c.why)
    return table


def _memory(study: Study) -> Table:
    headings = ("axis", "r(60 s)", "r(300 s)", "r(600 s)", "tau [s]", "beta at 1 Hz", "beta measured, at the day's rate")
    table = _titled(study, f"Memory of the error, and the beta it asks for where {study.settings['beta']} was used", *headings)
    for c in study.correlations:
        numbers = [_number(v) for v in (c.r_60_s, c.r_300_s, c.r_600_s)]
        table.add_row(c.axis, *numbers, f"{c.tau_s:.0f}", _number(c.beta_1_hz), _number(c.beta_measured))
    return table


def _faults(study: Study) -> Table:
    title = f"Faults, vertical, VAL 50 m, {study.n_fault_runs} runs each: least / median / most"
    table = _titled(study, title, "fault", "quantity", "stated before", "found", "verdict")
    for f in study.faults:
        table.add_row(f.fault, escape(f.quantity), "never" if f.stated is None else f"{f.stated:g}", _spread(f.found), f.verdict)
    return table


def _risks(study: Study, rows: list[RiskOfMemory]) -> Table:
    title = f"Share of Gauss-Markov errors beyond the noise bound (stated risk {rows[0].risk:g})"
    table = _titled(study, title, "tau [s]", "stated before", "found", "standard error", "verdict")
    for h in rows:
        table.add_row(f"{h.tau_s:g}", f"{h.stated:.2g}", f"{h.found:.2g}", f"{h.standard_error:.1g}", h.verdict)
    return table


def _risks_of_laws(study: Study) -> Table:
    title = "Share of independent errors beyond the noise bound, by their law"
    table = _titled(study, title, "law of the error", "stated risk", "stated before", "found", "standard error", "verdict")
    for h in study.held_laws:
        table.add_row(h.law, f"{h.risk:g}", f"{h.stated:.2g}", f"{h.found:.2g}", f"{h.standard_error:.1g}", h.verdict)
    return table


def _spread(spread: Spread) -> str:
    if spread.least is None or spread.median is None or spread.most is None:
        return "never"
    never = f", never in {spread.share_never:.0%}" if spread.share_never else ""
    return f"{spread.least:.0f} / {spread.median:.0f} / {spread.most:.0f}{never}"
