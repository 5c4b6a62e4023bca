"""What comes out of the fault campaign: a row for each kind and size, and the sums that the goals are about."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.records.base import Record

if TYPE_CHECKING:
    from rich.console import RenderableType

Z95 = 1.959963984540054
"""Normal deviate of a two-sided 95 % interval."""
REASONS_SHOWN = 3


class Share(Record):
    """A share of epochs, and the share of runs that have any, with its 95 % interval: runs are the sample, not seconds."""

    epochs: float
    runs: float
    runs_low: float
    runs_high: float


class Row(Record):
    """A kind of fault in one size."""

    kind: str
    family: str
    unit: str
    size: float | None
    n_runs: int
    n_ok: int
    """Epochs called ``ok`` after the fault began."""
    wrong: Share
    """Of the epochs called ``ok``: the true error is outside the 1e-5 bound."""
    normal_wrong: Share
    """Of the epochs with alert ``normal``: the same."""
    late: Share
    """Of the epochs with alert ``normal``: the total error has been outside RNP for longer than the time to alert."""
    detected: int
    """Runs in which the status left ``ok``."""
    delay_median_s: float | None
    delay_most_s: float | None
    error_most_m: float
    """Largest horizontal error of an epoch called ``ok``."""
    reasons: list[str]
    """Most frequent first."""


class Healthy(Record):
    """Before the faults, and on flights without any."""

    hours: float
    false_alerts: int
    false_alerts_per_hour: float
    false_alerts_per_hour_high: float
    """Upper limit of its 95 % interval."""
    not_ok_share: float


class Study(Record):
    """The campaign."""

    flights: int
    n_tiles: int
    n_runs: int
    rows: list[Row]
    healthy: Healthy
    single: Share
    """Integrity failures over all single faults."""
    single_epochs_ok: int

    def table(self) -> RenderableType:
        """Lay the campaign out for a terminal."""
        from navbound.studies.fault_campaign.table import render  # noqa: PLC0415 - rich is a matter of the terminal

        return render(self)


class HealthyStudy(Record):
    """Many flights without a fault."""

    flights: int
    seed: int
    healthy: Healthy
    n_ok: int
    n_ok_wrong: int
    """Epochs called ``ok`` with an error outside the 1e-5 bound."""
    n_late: int

    def table(self) -> RenderableType:
        """Lay the sums out for a terminal."""
        from navbound.studies.fault_campaign.table import render_healthy  # noqa: PLC0415 - rich is a matter of the terminal

        return render_healthy(self)


def wilson(failures: int, n: int) -> tuple[float, float]:
    """95 % interval of a share by Wilson's score: it does not collapse where none or all fail. Provenance: standard (Wilson 1927)."""
    if n == 0:
        return 0.0, 1.0
    p, zz = failures / n, Z95 * Z95
    centre = (p + zz / (2 * n)) / (1 + zz / n)
    half = Z95 * np.sqrt(p * (1 - p) / n + zz / (4 * n * n)) / (1 + zz / n)
    return max(0.0, float(centre - half)), min(1.0, float(centre + half))


def _share(frame: pl.DataFrame, wrong: str, of: str) -> Share:
    n, failed = frame.height, int((frame[wrong] > 0).sum())
    low, high = wilson(failed, n)
    total = float(frame[of].sum())
    return Share(epochs=float(frame[wrong].sum()) / total if total else 0.0, runs=failed / n if n else 0.0, runs_low=low, runs_high=high)


def _row(key: tuple[str, str, str, float], frame: pl.DataFrame) -> Row:
    delays = frame["delay_s"].to_numpy()
    finite = delays[np.isfinite(delays)]
    reported = Counter(reason for cell in frame["reasons"] for reason in cell.split("|") if reason)
    kind, family, unit, size = key
    return Row(
        kind=kind,
        family=family,
        unit=unit,
        size=None if np.isnan(size) else size,
        n_runs=frame.height,
        n_ok=int(frame["n_ok"].sum()),
        wrong=_share(frame, "n_ok_wrong", "n_ok"),
        normal_wrong=_share(frame, "n_normal_wrong", "n_normal"),
        late=_share(frame, "n_late", "n_normal"),
        detected=int(finite.size),
        delay_median_s=float(np.median(finite)) if finite.size else None,
        delay_most_s=float(finite.max()) if finite.size else None,
        error_most_m=float(frame["error_most_m"].to_numpy().max()),
        reasons=[reason for reason, _ in reported.most_common(REASONS_SHOWN)],
    )


def healthy(frame: pl.DataFrame) -> Healthy:
    """The sums over healthy flights, a row of counts each."""
    hours, alerts = float(frame["healthy_s"].sum()) / 3600, int(frame["n_false_alerts"].sum())
    # Upper 97.5 % limit of a Poisson mean by Wilson and Hilferty's cube; -ln 0.025 for none. Provenance: standard.
    n = alerts + 1
    most = n * (1 - 1 / (9 * n) + Z95 / (3 * np.sqrt(n))) ** 3
    return Healthy(
        hours=hours,
        false_alerts=alerts,
        false_alerts_per_hour=alerts / hours if hours else 0.0,
        false_alerts_per_hour_high=float(most / hours) if hours else float("inf"),
        not_ok_share=float(frame["healthy_not_ok_s"].sum()) / max(float(frame["healthy_s"].sum()), 1.0),
    )


def summed(tiles: list[tuple[tuple[str, str, str, float], pl.DataFrame]], *, flights: int, n_tiles: int) -> Study:
    """The rows of all tiles as a study."""
    keys = list(dict.fromkeys(key for key, _ in tiles))
    parts = {key: pl.concat([rows for other, rows in tiles if other == key]) for key in keys}
    faulty = [key for key in keys if key[1] != "none"]
    whole = pl.concat([rows for _, rows in tiles])
    single = [parts[key] for key in faulty if key[1] != "pair"]
    of_single = pl.concat(single) if single else whole.clear()
    # The healthy part before a fault is that of the same flights again and again: it counts once, as the flights without a fault.
    return Study(
        flights=flights,
        n_tiles=n_tiles,
        n_runs=whole.height,
        rows=[_row(key, parts[key]) for key in faulty],
        healthy=healthy(pl.concat([parts[key] for key in keys if key[1] == "none"])),
        single=_share(of_single, "n_ok_wrong", "n_ok"),
        single_epochs_ok=int(of_single["n_ok"].sum()) if of_single.height else 0,
    )
