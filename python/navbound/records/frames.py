"""Frames of a fixed shape that stages hand to each other."""

from __future__ import annotations

import polars as pl

LEFT_OUT = {"track": pl.String, "time_ns": pl.Int64}
"""Rows of a recording that cannot be judged: which track, and when (null where not even the time is known)."""
