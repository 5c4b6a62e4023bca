"""One map: options, tiles, results, words."""

from __future__ import annotations

import math
import platform
from dataclasses import fields
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core, scale
from navbound.algorithms import Column
from navbound.errors import ConflictError, InputError, NotFoundError
from navbound.maps import files
from navbound.maps.grid import Grid
from navbound.maps.kinds import Kind, kinds
from navbound.maps.limits import Limit, limits_of
from navbound.maps.sources import File, Times
from navbound.maps.statistics import PERCENTILES, Evaluate, Tile, percentile_name
from navbound.records import maps as map_records
from navbound.records.maps import Map
from navbound.table.arguments import checked
from navbound.time import utc_text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

COVERAGE_AT = (0.95, 0.99, 0.995, 0.999)
"""Availabilities at which the share of the area is reported."""
_ROUNDING = 1e-12
"""Less than this is left of shares that make one: some millions of additions of weights below one. [1]"""
_RESULT_BYTES = 80.0
"""A number of every column for a user and an instant, and its sorted copy. [B]"""


@checked
def make(
    kind: str,
    *,
    grid: Grid | None = None,
    limits: Mapping[str, float] | None = None,
    level: str | None = None,
    backend: str = "serial",
    checkpoint: str | Path | None = None,
    workers: scale.Workers | None = None,
    progress: Callable[[int, int], None] | None = None,
    out: str | Path | None = None,
    command: str = "",
    **options: object,
) -> Map:
    """Evaluate a grid of users over a day.

    Parameters
    ----------
    kind : str
        A name of :func:`kinds`.
    grid : Grid, optional
        Users; without it the world in cells of five degrees.
    limits : mapping of column to float, optional
        What is required, in the unit of the column; without it that of the kind.
    level : str, optional
        A service level of `navbound.kpi.levels` instead: its alert limits.
    backend, checkpoint, workers, progress
        As in :func:`navbound.scale.map_tiles`.
    out : str or Path, optional
        Run directory to write; without it nothing is written.
    command : str, optional
        For the run record.
    **options
        The arguments of the kind: the fields of ``kinds()[kind].options``.

    Returns
    -------
    Map
        One row a grid point: percentiles of every column over the day, and the share of epochs within all limits.

    Raises
    ------
    InputError
        No such kind, an option that it does not take, a number outside its domain, an almanac of another week.
    FormatError
        A file that cannot be read, or a folder that cannot be written.
    """
    known = kinds()
    if kind not in known:
        raise NotFoundError("kind", kind, "kind of map", known)
    entry = known[kind]
    grid = grid or Grid()
    job = _options(entry, options)
    required = _limits(entry, job, limits, level)
    evaluate = Evaluate(
        job.levels(),
        tuple(c.name for c in entry.columns),
        tuple((one.column, one.limit) for one in required),
        tuple(c.name for c in entry.causes),
    )
    with files.own(out) as folder:
        lat, lon = grid.points()
        n_epochs = job.n_epochs()
        tiles = [Tile(lat[s], lon[s]) for s in scale.cut(len(grid), n_epochs * entry.user_epoch_s, n_epochs * _RESULT_BYTES)]
        parts = scale.map_tiles(evaluate, tiles, backend=backend, checkpoint=checkpoint, progress=progress, workers=workers)
        columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        points = pl.DataFrame({"lat_rad": lat, "lon_rad": lon} | columns)
        summary = _summary(entry, grid, points, required, job)
        record = map_records.MapRecord(
            navbound_version=_core.__version__,
            command=command,
            created_utc=datetime.now(UTC).isoformat(timespec="seconds"),
            kind=kind,
            options={f.name: _option_words(getattr(job, f.name)) for f in fields(job)},
            inputs=_inputs(job),
            backend=backend,
            n_tiles=len(tiles),
            platform=platform.platform(),
        )
        return files.write(Map(summary, record, points), folder)


def _options(kind: Kind, options: dict[str, object]) -> Any:
    known = [f.name for f in fields(kind.options)]  # type: ignore[arg-type]
    for name in options:
        if name not in known:
            raise ConflictError(name, because=f"{kind.id} takes {', '.join(known)}")
    return kind.options(**options)


def _limits(kind: Kind, job: Any, limits: Mapping[str, float] | None, level: str | None) -> list[Limit]:
    names = [column.name for column in kind.columns]
    if limits and level:
        raise ConflictError("level", excludes=("limits",))
    if level:
        requested = [one for one in limits_of(level) if one.column in names]
        if not requested:
            raise ConflictError("level", because=f"{kind.id} gives {', '.join(names)}")
        return requested
    if not limits:
        return list(job.limits())
    for name in limits:
        if name not in names:
            raise InputError("limits", name, domain=f"columns of {kind.id}: {', '.join(names)}")
    return [Limit(name, float(limit)) for name, limit in limits.items()]


def _option_words(value: object) -> str:
    """As the caller wrote it, not as Python shows it."""
    if isinstance(value, Times):
        start = "usual start" if value.start_ns is None else f"from {utc_text(value.start_ns)} UTC"
        length = "usual length" if value.duration_s is None else f"{value.duration_s:g} s"
        return f"{start}, {length}, every {value.step_s:g} s"
    if isinstance(value, tuple):
        return ", ".join(map(_option_words, value)) or "none"
    if isinstance(value, float):
        return f"{value:.9g}"
    return "none" if value is None else str(value)


def _inputs(job: Any) -> dict[str, str]:
    """Digests of the files among the options."""
    values = [getattr(job, f.name) for f in fields(job)]
    flat = [item for value in values for item in (value if isinstance(value, tuple) else (value,))]
    paths = [Path(item) for item in flat if isinstance(item, (str, Path)) and str(item)]
    return {str(path): File.of(path).sha256 for path in paths if path.is_file()}


def _summary(kind: Kind, grid: Grid, points: pl.DataFrame, required: list[Limit], job: Any) -> map_records.MapSummary:
    n_epochs = job.n_epochs()
    weights, available = grid.weights(), points["p_available"].to_numpy()
    coverage = [map_records.MapCoverage(available=at, share=_share(weights, available >= at)) for at in COVERAGE_AT]
    worst = int(np.argmin(available))
    where = map_records.MapWorst(
        lat_rad=float(points["lat_rad"][worst]),
        lon_rad=float(points["lon_rad"][worst]),
        available=float(available[worst]),
        share=_share(weights, available == available[worst]),
    )
    own = {f.name: getattr(grid, f.name) for f in fields(grid)}
    return map_records.MapSummary(
        kind=kind.id,
        title=f"{kind.title}: {grid.n_lat} × {grid.n_lon} points" + ("" if n_epochs == 1 else f", {n_epochs} epochs"),
        words=_words(kind, required, coverage, where, n_epochs),
        source=kind.source,
        grid=map_records.MapGrid(n_lat=grid.n_lat, n_lon=grid.n_lon, **own),
        n_epochs=n_epochs,
        percentiles=list(PERCENTILES) if n_epochs > 1 else [],
        columns=[_column(column, points, weights) for column in kind.columns],
        limits=[map_records.MapLimit(column=a.column, limit=a.limit, source=a.source, provenance=a.provenance) for a in required],
        coverage=coverage,
        available_mean=float(np.clip((weights * available).sum(), 0.0, 1.0)),
        outcomes=_outcomes(kind, points, weights),
        worst=where,
        assumptions=job.assumptions(),
    )


def _share(weights: np.ndarray[Any, np.dtype[np.float64]], where: np.ndarray[Any, np.dtype[np.bool_]]) -> float:
    # All of the area is 1, however the weights are rounded.
    return 1.0 if where.all() else float(weights[where].sum())


def _outcomes(kind: Kind, points: pl.DataFrame, weights: np.ndarray[Any, np.dtype[np.float64]]) -> list[map_records.MapOutcome]:
    named = {"p_available": "Within the limits"} | {cause.name: cause.title for cause in kind.causes}
    shares = {name: float(np.clip((weights * points[name].to_numpy()).sum(), 0.0, 1.0)) for name in named}
    # What is left has a number; a rounding of the shares is none of it.
    beyond = 1.0 - sum(shares.values())
    outcomes = [map_records.MapOutcome(name=name, title=title, share=shares[name]) for name, title in named.items()]
    rest = map_records.MapOutcome(name="beyond", title="Beyond the limits", share=beyond if beyond > _ROUNDING else 0.0)
    return [outcomes[0], rest, *outcomes[1:]]


def _column(column: Column, points: pl.DataFrame, weights: np.ndarray[Any, np.dtype[np.float64]]) -> map_records.MapColumn:
    names = {f"{p:g}": percentile_name(column.name, p) for p in PERCENTILES}
    present = {p: name for p, name in names.items() if name in points.columns} or {"": column.name}
    typical = {p: _half(points[name].to_numpy(), weights) for p, name in present.items()}
    return map_records.MapColumn(name=column.name, title=column.title, unit=column.unit, typical=typical)


def _half(values: np.ndarray[Any, np.dtype[np.float64]], weights: np.ndarray[Any, np.dtype[np.float64]]) -> float | None:
    """The number that half of the area is within."""
    order = np.argsort(values, kind="stable")
    place = min(int(np.searchsorted(np.cumsum(weights[order]), 0.5)), len(values) - 1)
    value = float(values[order[place]])
    return value if math.isfinite(value) else None


def _words(kind: Kind, required: list[Limit], coverage: list[map_records.MapCoverage], worst: map_records.MapWorst, n_epochs: int) -> str:
    units = {column.name: "" if column.unit == "1" else " m" for column in kind.columns}
    titles = {column.name: column.title[0].lower() + column.title[1:] for column in kind.columns}
    within = " and ".join(f"{titles[a.column]} of at most {a.limit:.6g}{units[a.column]}" for a in required)
    if n_epochs == 1:
        return f"{_percent(coverage[0].share)} of the area has a {within}."
    parts = [
        f"{_percent(c.share)} of the area for at least {100 * c.available:g} % of the time"
        for c in coverage
        if c.available in (0.99, 0.995)
    ]
    if worst.available == 1.0:
        return f"A {within}: everywhere, at every instant."
    if worst.available == 0.0:
        return f"A {within}: on {', on '.join(parts)}; at no instant on {_percent(worst.share)}."
    lat, lon = math.degrees(worst.lat_rad), math.degrees(worst.lon_rad)
    place = f"{abs(lat):.1f}° {'N' if lat >= 0 else 'S'}, {abs(lon):.1f}° {'E' if lon >= 0 else 'W'}"
    return f"A {within}: on {', on '.join(parts)}. Least at {place}: {_percent(worst.available)} of the time."


def _percent(share: float) -> str:
    """A share that is never rounded up to all or down to nothing."""
    if share in (0.0, 1.0):
        return f"{100 * share:g} %"
    return f"{min(max(100 * share, 0.01), 99.99):.2f} %"
