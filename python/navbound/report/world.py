"""The page of a map: the same template and bundle as a run's, with the grid as packed columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound.report import packing
from navbound.report.coast import clip_coastline
from navbound.report.payload import Page
from navbound.report.render import write_page

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.records.maps import Map

_SHARE = "share_available"
"""The page's name of ``p_available``: shares near one need the same fineness as those near nothing, so not their logarithm."""


MOST_VALUES = 2_000_000
"""Numbers that the page holds, some three bytes each; a finer map has its availability and the columns after it that fit. [1]"""


def render(made: Map, out: Path) -> Path:
    """Write the report of a map as a single HTML file that needs no network.

    Parameters
    ----------
    made : Map
        The map.
    out : Path
        File to write.

    Returns
    -------
    Path
        The file written.
    """
    # What became of the rest is reported for the whole area; at each point it stands in map.parquet.
    columns = {"lat_rad", "lon_rad", "n_sv_least"} | {outcome.name for outcome in made.summary.outcomes} - {"p_available"}
    shown = [name for name in made.points.columns if name not in columns]
    fitting = max(1, MOST_VALUES // made.points.height)
    names, left_out = shown[:fitting], shown[fitting:]
    packed = [packing.pack(_SHARE if name == "p_available" else name, made.points[name].cast(float).to_numpy()) for name in names]
    g = made.summary.grid
    south, west, north, east = (float(np.degrees(v)) for v in (g.south_rad, g.west_rad, g.north_rad, g.east_rad))
    data = {
        "schema_id": "navbound-world-1",
        "summary": made.summary.model_dump(mode="json"),
        "record": made.record.model_dump(mode="json"),
        "columns": [column.head() for column in packed],
        "left_out": left_out,
        "coastline": clip_coastline(south, west, north, east),
    }
    return write_page(made.summary.title, made.summary.words, Page(data=data, tracks=[packing.deflate(packed)]), out)
