"""Where the aircraft should be, as points for a map; nothing is judged by them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navbound.live.zones import path_of

if TYPE_CHECKING:
    from navbound.live.settings import Settings

MOST_POINTS = 2000
LINE_BEFORE_M, LINE_BEHIND_M = 40_000.0, 10_000.0
"""How much of a path without ends is drawn, before and behind its first point. [m]"""
_RECORDED = ("path_lat_rad", "path_lon_rad", "course_rad", "rnp_m")

Points = list[list[float]]


def points(settings: Settings, source: str) -> Points:
    """Latitude, longitude, course [rad] and RNP [m] along the path of the settings, else along a run's; none where neither is known."""
    if settings.path is not None:
        return _sampled(settings)
    import polars as pl  # noqa: PLC0415  (workers of a fleet have no map, and a library of tables takes memory of each)

    from navbound.live.recording import EPOCHS  # noqa: PLC0415

    run = Path(source) / EPOCHS
    if "://" in source or not run.is_file() or not set(_RECORDED) <= set(pl.read_parquet_schema(run)):
        return []
    epochs = pl.read_parquet(run, columns=["track", *_RECORDED]).filter(pl.col("track") == pl.col("track").first()).drop_nulls()
    rows = epochs.gather_every(math.ceil(epochs.height / MOST_POINTS) or 1).select(_RECORDED)
    return [_rounded(row) for row in rows.iter_rows() if all(map(math.isfinite, row))]


def _sampled(settings: Settings) -> Points:
    path = path_of(settings.path or "")
    ends = (0.0, path.length_m) if math.isfinite(path.length_m) else (-LINE_BEFORE_M, LINE_BEHIND_M)
    places = path.at(np.linspace(*ends, 500))
    columns = zip(places.lat_rad.tolist(), places.lon_rad.tolist(), places.course_rad.tolist(), strict=True)
    return [_rounded((*column, settings.rnp_m)) for column in columns]


def _rounded(row: tuple[float, ...]) -> list[float]:
    # A nanoradian is 6 mm on the ground.
    return [round(value, 9) for value in row]
