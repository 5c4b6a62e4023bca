"""The judging stage over pieces: every stage of a row as at once, the monitors carried on from piece to piece."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.read.pieces import Frames

if TYPE_CHECKING:
    from collections.abc import Callable

    import polars as pl

    from navbound.rnp import TrackMonitors


def judged(epochs: Frames, bounded: Callable[[pl.DataFrame], pl.DataFrame], monitors: TrackMonitors, *, with_levels: bool) -> Frames:
    """Every piece with its bounds and alerts.

    Parameters
    ----------
    epochs : Frames
        Ready to be judged, without a path.
    bounded : callable
        Gives rows their errors and bounds.
    monitors : TrackMonitors
        Of every track.
    with_levels : bool
        Some epoch has a protection level.
    """
    judged = Frames()
    for piece in epochs:
        rows = bounded(piece)
        alert, compared_m = monitors.judge(rows)
        if with_levels:
            rows = rows.with_columns(compared_m)
        judged.put(rows.with_columns(alert.alias("alert")))
    return judged
