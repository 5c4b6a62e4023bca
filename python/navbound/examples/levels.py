"""A day of protection levels with their errors: what ARAIM says of a station's measurements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound import araim
from navbound.examples.station import Station, measure

if TYPE_CHECKING:
    from collections.abc import Sequence


def levels(station: Station, place_ecef_m: Sequence[float]) -> pl.DataFrame:
    """Levels and errors of every epoch under the names that a table of them usually has; lengths to the millimetre."""
    recording = measure(station, "PARIS")
    epochs = araim.watch(recording.observations, recording.navigation, truth_ecef_m=place_ecef_m).epochs
    lengths = ("nse_e_m", "nse_n_m", "nse_u_m", "hpl_m", "vpl_m")
    return epochs.select("time_ns", *(pl.col(name).round(3) for name in lengths), "n_sv", "status", "reason_id")
