"""Pictures over time: deviation, bounds against RNP, levels against limits, risk, states of RNP, steps of a prediction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from navbound.errors import InputError
from navbound.kpi import level
from navbound.methods import method
from navbound.plot.parts import axes, colours, column, finish, mark_absent, mark_alerts, track_of
from navbound.status import USABLE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from navbound.run.expected.flight import Expected

SMALLEST = 1e-12
"""No law of errors is known to hold farther out; risks below it are drawn there. [1]"""


def deviation(of: Any, *, track: str | None = None, bound: str | None = "tse-exact", ax: Axes | None = None) -> Axes:
    """Flight technical error with the bound of the total error on both sides, against RNP.

    Parameters
    ----------
    of : Run or data frame or mapping
        Epochs with ``fte_m`` and ``rnp_m``; and the column of `bound`.
    track : str, optional
        Which; may be left out where there is one.
    bound : str, optional
        Method of the bound, or None.
    ax : Axes, optional
        Where; new axes without it.

    Raises
    ------
    InputError
        A column or track that is not there, or no path, so no deviation.
    """
    one = track_of(of, track)
    fte, rnp = one.numbers("fte_m"), column(one.epochs, "rnp_m")
    if not np.isfinite(fte).any():
        raise InputError("of", "epochs without a flight technical error", domain="a track with a path")
    ax, palette = axes(ax), colours()
    for sign in (1, -1):
        ax.plot(one.minutes, sign * rnp, color=palette["limit"], linestyle="--", label="RNP" if sign > 0 else None)
    if bound is not None:
        total = one.numbers(method(bound).column)
        # The bound is a number for both sides together: no total error is beyond it.
        ax.fill_between(one.minutes, -total, total, color=palette["muted"], alpha=0.25, linewidth=0, label=f"95 % bound, {bound}")
        mark_absent(ax, one, np.isfinite(total))
    ax.plot(one.minutes, fte, color=palette["path"], linewidth=1.2, label="flight technical error")
    mark_alerts(ax, one)
    return finish(ax, f"Deviation from the path, {one.name}", one.words, "right of the path [m]")


def bounds(
    of: Any, *, track: str | None = None, methods: Sequence[str] = ("tse-exact",), integrity: bool = False, ax: Axes | None = None
) -> Axes:
    """Bounds of some methods against RNP, with the alerts.

    Parameters
    ----------
    of : Run or data frame or mapping
        Epochs with the columns of the methods and ``rnp_m``.
    methods : sequence of str
        Ids, as ``navbound methods`` lists them.
    integrity : bool
        The bounds at the risk of integrity, against twice RNP.
    """
    one = track_of(of, track)
    ax, palette = axes(ax), colours()
    factor = 2.0 if integrity else 1.0
    ax.plot(
        one.minutes, factor * column(one.epochs, "rnp_m"), color=palette["limit"], linestyle="--", label="2 RNP" if integrity else "RNP"
    )
    known = np.zeros(len(one.minutes), dtype=bool)
    for id_ in methods:
        values = one.numbers(method(id_).integrity_column if integrity else method(id_).column)
        known |= np.isfinite(values)
        ax.plot(one.minutes, values, linewidth=1.2, label=id_)
    mark_absent(ax, one, known)
    mark_alerts(ax, one)
    ax.set_ylim(bottom=0)
    return finish(
        ax,
        f"{'Integrity' if integrity else 'Accuracy'} bounds against {'twice ' if integrity else ''}RNP, {one.name}",
        one.words,
        "bound [m]",
    )


def risk(of: Any, *, track: str | None = None, required: float | None = None, ax: Axes | None = None) -> Axes:
    """Risk of a total error beyond RNP and beyond twice RNP. Risks below 1e-12 are drawn there."""
    one = track_of(of, track)
    ax, palette = axes(ax), colours()
    for name, label, colour in (
        ("p_exceed_rnp", "beyond RNP", palette["caution"]),
        ("p_exceed_2rnp", "beyond twice RNP", palette["warning"]),
    ):
        ax.semilogy(one.minutes, np.maximum(one.numbers(name), SMALLEST), color=colour, label=label)
    if required is not None:
        ax.axhline(required, color=palette["limit"], linestyle="--", label=f"required, {required:g}")
    ax.set_ylim(SMALLEST, 2.0)
    return finish(ax, f"Risk, {one.name}", one.words, "probability [1]")


def states(of: Any, *, track: str | None = None, names: Sequence[str] | None = None, ax: Axes | None = None) -> Axes:
    """Probabilities of the states of RNP, stacked.

    Parameters
    ----------
    names : sequence of str, optional
        Names of the states in their order; of a run they are known.
    """
    one = track_of(of, track)
    columns = [name for name in one.epochs.columns if name.startswith("p_state_")]
    if not columns:
        raise InputError("of", "epochs without states", domain="epochs with p_state_1, p_state_2, ...")
    summary = getattr(of, "summary", None)
    known = names or (list(summary.states) if summary is not None and summary.states else None)
    labels = list(known or []) + [f"state {k + 1}" for k in range(len(known or []), len(columns))]
    ax = axes(ax)
    shares = [np.nan_to_num(one.numbers(name)) for name in columns]
    ax.stackplot(one.minutes, *shares, labels=labels[: len(columns)], alpha=0.85)
    mark_absent(ax, one, np.isfinite(one.numbers(columns[0])))
    ax.set_ylim(0, 1)
    return finish(ax, f"State of RNP, {one.name}", one.words, "probability [1]")


def levels(of: Any, *, track: str | None = None, service: str | None = None, vertical: bool = False, ax: Axes | None = None) -> Axes:
    """Protection level and error over time, against the alert limit of a service level.

    Parameters
    ----------
    of : Run or data frame or mapping
        Epochs with ``hpl_m`` or ``vpl_m``; and ``hpe_m`` or ``vpe_m``, where the errors are known.
    service : str, optional
        Name of a service level, such as ``APV-I``.
    vertical : bool
        Vertical ones.
    """
    one = track_of(of, track)
    ax, palette = axes(ax), colours()
    name, error = ("vpl_m", "vpe_m") if vertical else ("hpl_m", "hpe_m")
    level_m = one.numbers(name)
    ax.plot(one.minutes, level_m, color=palette["limit"], label="VPL" if vertical else "HPL")
    if error in one.epochs.columns:
        ax.plot(one.minutes, np.abs(one.numbers(error)), color=palette["path"], linewidth=0.9, label="error")
        beyond = np.abs(one.numbers(error)) > level_m
        if beyond.any():
            ax.plot(one.minutes[beyond], np.abs(one.numbers(error))[beyond], "x", color=palette["warning"], label="error beyond the level")
    if service is not None:
        known = level(service)
        limit = known.val_m if vertical else known.hal_m
        if limit is None or not np.isfinite(limit):
            raise InputError("service", service, domain=f"service levels with a {'vertical' if vertical else 'horizontal'} alert limit")
        ax.axhline(limit, color=palette["warning"], linestyle="--", label=f"alert limit {service}")
    mark_absent(ax, one, np.isfinite(level_m))
    ax.set_ylim(bottom=0)
    return finish(ax, f"{'Vertical' if vertical else 'Horizontal'} protection, {one.name}", one.words, "length [m]")


def status(of: Any, *, track: str | None = None, ax: Axes | None = None) -> Axes:
    """Which epochs were judged: status over time, one row a status, with the share of each."""
    one = track_of(of, track)
    ax, palette = axes(ax), colours()
    values = one.epochs["status"].to_numpy()
    rows = [name for name in (*USABLE, *sorted(set(values) - set(USABLE))) if (values == name).any()]
    for row, name in enumerate(rows):
        here = values == name
        colour = palette["normal"] if name == "ok" else palette["caution"] if name in USABLE else palette["warning"]
        ax.plot(one.minutes[here], np.full(here.sum(), row), "|", markersize=12, color=colour)
    ax.set_yticks(range(len(rows)), [f"{name}, {100 * np.mean(values == name):.2f} %" for name in rows])
    ax.set_ylim(-0.6, len(rows) - 0.4)
    return finish(ax, f"Status, {one.name}", one.words, "", legend=False)


def prediction(expected: Expected, *, ax: Axes | None = None) -> Axes:
    """Time line of a predicted flight: circle, total error and level against RNP. Legs without an RNP have none drawn.

    Parameters
    ----------
    expected : Expected
        From :func:`navbound.run.expected.flight.predict_flight`.
    """
    ax, palette = axes(ax), colours()
    seconds, shown = expected.seconds, expected.shown
    minutes = seconds["time_s"].to_numpy() / 60
    ax.semilogy(minutes, column(seconds, "rnp_m"), color=palette["limit"], linestyle="--", label="RNP")
    ax.semilogy(minutes, column(seconds, "tse_accuracy_m"), color=palette["muted"], label="95 % total error across the path")
    ax.semilogy(minutes, column(seconds, "anp_circle_m"), color=palette["ink"], label="95 % circle of navigation")
    ax.semilogy(shown["time_s"].to_numpy() / 60, column(shown, "hpl_m"), color=palette["path"], linestyle=":", label="protection level")
    for outage in expected.record.outages:
        if outage.what == "jamming":
            ax.axvspan(outage.start_s / 60, outage.end_s / 60, color=palette["warning"], alpha=0.12, linewidth=0)
    return finish(ax, expected.record.title, "time after departure [min]", "length [m]")
