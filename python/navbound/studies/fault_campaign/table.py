"""The fault campaign as tables: for a terminal, and as text of the documentation."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import RenderableType

    from navbound.studies.fault_campaign.records import Healthy, HealthyStudy, Row, Share, Study

HEADINGS = (
    "fault",
    "size",
    "runs",
    "ok epochs",
    "of them wrong",
    "runs with any (95 %)",
    "late alerts",
    "left ok",
    "after [s]: median, most",
    "error while ok [m]",
    "reasons",
)


def cells(row: Row) -> list[str]:
    """A row of the table as text."""
    size = "" if row.size is None else f"{row.size:g} {row.unit}".strip()
    delay = "-" if row.delay_median_s is None or row.delay_most_s is None else f"{row.delay_median_s:.0f}, {row.delay_most_s:.0f}"
    return [
        row.kind,
        size,
        str(row.n_runs),
        str(row.n_ok),
        _share(row.wrong),
        f"{100 * row.wrong.runs_low:.0f} to {100 * row.wrong.runs_high:.0f} %",
        _share(row.late),
        f"{row.detected} of {row.n_runs}",
        delay,
        f"{row.error_most_m:.1f}",
        "; ".join(row.reasons),
    ]


def _share(share: Share) -> str:
    return "0" if share.epochs == 0 else f"{share.epochs:.2g}"


def words(study: Study) -> list[str]:
    """The sums that the goals are about."""
    h, s = study.healthy, study.single
    return [
        f"{study.n_runs} runs, {study.flights} flights for each kind, size and time.",
        f"Single faults: {s.epochs:.2g} of {study.single_epochs_ok} epochs called ok had an error outside the 1e-5 bound, in "
        f"{100 * s.runs:.1f} % of the runs (95 %: {100 * s.runs_low:.1f} to {100 * s.runs_high:.1f} %); the goal is 1e-4 of the epochs.",
        _words_of_healthy(h),
    ]


def _words_of_healthy(h: Healthy) -> str:
    return (
        f"Healthy: {h.false_alerts} false alerts in {h.hours:.1f} h, at most {h.false_alerts_per_hour_high:.2g} an hour at 95 %; "
        f"{100 * h.not_ok_share:.2g} % of the epochs not ok."
    )


def render_healthy(study: HealthyStudy) -> RenderableType:
    """Lay healthy flights out for a terminal."""
    from rich.console import Group  # noqa: PLC0415

    return Group(
        f"{study.flights} flights without a fault, seeds from {study.seed}.",
        _words_of_healthy(study.healthy),
        f"{study.n_ok_wrong} of {study.n_ok} epochs called ok had an error outside the 1e-5 bound; {study.n_late} epochs of late alerts.",
    )


def render(study: Study) -> RenderableType:
    """Lay the campaign out for a terminal."""
    from rich.console import Group  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    table = Table(title="Faults of sensors, and what the status says")
    for heading in HEADINGS:
        table.add_column(heading, justify="left" if heading in {"fault", "reasons"} else "right", overflow="fold")
    for row in study.rows:
        table.add_row(*cells(row))
    return Group(table, *words(study))


def markdown(study: Study) -> str:
    """The same as a table of the documentation."""
    lines = [f"| {' | '.join(HEADINGS)} |", f"|{'---|' * len(HEADINGS)}"]
    lines += [f"| {' | '.join(cells(row))} |" for row in study.rows]
    return "\n".join([*lines, "", *words(study)]) + "\n"
