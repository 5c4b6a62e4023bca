"""The comparison of ANP evaluations as tables for a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import RenderableType

    from navbound.studies.anp_comparison.study import Case, Study


def _spread(low: float | None, high: float | None) -> str:
    return "-" if low is None or high is None else f"{100 * low:.1f}-{100 * high:.1f}"


def _pm(value: float, sd: float | None) -> str:
    return f"{value:.3f}" if sd is None else f"{value:.3f} ± {sd:.3f}"


def render(study: Study) -> RenderableType:
    """Lay the study out as tables."""
    from rich.console import Group  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    entries = Table(title="Published and computed, published sensors")
    for heading in ("table", "quantity", "published", "computed", "verdict", "why"):
        entries.add_column(heading, justify="right" if heading in {"published", "computed"} else "left", overflow="fold")
    for e in study.entries:
        entries.add_row(e.table, e.quantity, f"{e.published:g}", _pm(e.computed, e.computed_sd), e.verdict, e.why)
    tables = [table for case in study.cases for table in _case(case)]
    return Group(*tables, entries, *study.words)


def _case(case: Case) -> list[RenderableType]:
    from rich.table import Table  # noqa: PLC0415

    title = f"{case.name}: {case.title}, {case.flights} flights, {case.n_epochs} epochs"
    axes = Table(title=title)
    for heading in ("axis", "RMSE [m]", "filter's sigma [m]", "within own 95 % [%]", "CRPS [m]"):
        axes.add_column(heading, justify="left" if heading == "axis" else "right")
    for a in case.axes:
        axes.add_row(a.axis, _pm(a.rmse_m, a.rmse_sd_m), f"{a.sigma_m:.3f}", f"{100 * a.containment_own:.2f}", f"{a.crps_m:.3f}")
    joint = Table(title="As regions")
    for heading in ("evaluation", "held [%]", "sd between flights", "bootstrap of flights [%]"):
        joint.add_column(heading, justify="left" if heading == "evaluation" else "right")
    for j in case.joint:
        sd = "-" if j.containment_sd is None else f"{100 * j.containment_sd:.1f}"
        joint.add_row(j.evaluation, f"{100 * j.containment:.2f}", sd, _spread(j.containment_low, j.containment_high))
    bounds = Table(title="Read as bounds along an axis")
    headings = ("evaluation", "axis", "RMS [m]", "held [%]", "interval [%]", "MAPE of bound [%]", "of error", "Winkler [m]", "pinball [m]")
    for heading in headings:
        bounds.add_column(heading, justify="left" if heading in {"evaluation", "axis"} else "right")
    for b in case.bounds:
        scores = (f"{b.mape_of_bound:.1f}", f"{b.mape_of_error:.1f}", f"{b.winkler_m:.3f}", f"{b.pinball_m:.3f}")
        coverage = (f"{100 * b.containment:.2f}", _spread(b.containment_low, b.containment_high))
        bounds.add_row(b.evaluation, b.axis, f"{b.rms_m:.3f}", *coverage, *scores)
    return [axes, joint, bounds]
