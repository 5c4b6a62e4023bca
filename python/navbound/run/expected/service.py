"""Levels of a plan from messages that an augmentation service sent before, at the same time of day."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import gnss, sbas
from navbound.algorithms import Sent, entry
from navbound.errors import FormatError, NavboundError
from navbound.maps.service import log_words
from navbound.maps.sources import NS, File, messages

if TYPE_CHECKING:
    from pathlib import Path

    import polars as pl
    from numpy.typing import NDArray

    from navbound.scenario.plan import SbasLog

    Floats = NDArray[np.float64]

DAY_NS = 86_400 * NS


@dataclass(frozen=True)
class Service:
    """Messages and orbits of a day, and how long before the flight they were sent.

    Attributes
    ----------
    heard : Messages
        Of one satellite.
    navigation : Navigation
        Of the same day.
    mode : str
        What the level is for.
    days : int
        Whole days from the messages to the flight; below zero where they were sent after it. [d]
    name : str
        Of the log.
    """

    heard: sbas.Messages
    navigation: gnss.Navigation
    mode: str
    days: int
    name: str

    def levels(self, rows: pl.DataFrame, start_ns: int, shift_s: float, mask_rad: float, without: frozenset[str]) -> tuple[Floats, Floats]:
        """Level [m], NaN without one, and number of satellites [1] at rows with ``time_s`` and a place."""
        time_ns = start_ns + np.rint((rows["time_s"].to_numpy() + shift_s) * NS).astype(np.int64) - self.days * DAY_NS
        lat, lon, h = (rows[name].to_numpy() for name in ("lat_rad", "lon_rad", "h_m"))
        navigation = self.navigation.without(sorted(without)) if without else self.navigation
        called = entry(Sent, "equipment.monitor", "sbas")
        levels = called(self.heard, navigation, time_ns, lat_rad=lat, lon_rad=lon, h_m=h, mode=self.mode, mask_rad=mask_rad)
        return np.where(levels.status == "ok", levels.hpl_m, np.nan), levels.n_sv

    def words(self) -> list[str]:
        """What the levels rest on."""
        sent = "on the same day"
        if self.days:
            sent = f"{abs(self.days)} day{'s' if abs(self.days) > 1 else ''} {'before' if self.days > 0 else 'after'}"
        return [
            f"Levels: SBAS PRN {int(self.heard.prn[0])} from messages that were sent {sent} at the same time of day, "
            "with the satellites of that day; what will be sent is not known. Outside the log there is no level.",
            f"{self.name}: {log_words(self.heard)}",
        ]


def service(file: str | Path, folder: Path, log: SbasLog, start_ns: int) -> Service:
    """Read the log of a plan.

    Raises
    ------
    FormatError
        A file that cannot be read, a log without messages or with those of several satellites: with the plan's key.
    """
    try:
        heard = messages(File.of(folder / log.messages), log.prn)
    except NavboundError as e:
        raise FormatError(file, str(e), field="sbas.messages") from e
    try:
        navigation = gnss.read_navigation([folder / name for name in log.navigation])
    except NavboundError as e:
        raise FormatError(file, str(e), field="sbas.navigation") from e
    days = (start_ns - int(heard.time_ns.min())) // DAY_NS
    return Service(heard, navigation, log.mode, days, log.messages)
