"""Configuration of the surface-movement study: what ships, and files that give only what differs."""

from __future__ import annotations

import tomllib
from datetime import datetime
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError, field_validator

from navbound.errors import FormatError
from navbound.scenario.part import Part

SHIPPED = Path(__file__).parents[2] / "scenario" / "shipped" / "studies" / "surface-movement.toml"
NOMINAL = {"gps": ("gps", "gps-expanded"), "galileo": ("galileo",)}
"""Shipped constellations that a system may be given by name; ``nominal`` is the first."""


class Airport(Part):
    """Where."""

    name: str = Field(min_length=1)
    lat_deg: float = Field(ge=-90, le=90)
    lon_deg: float = Field(ge=-180, le=180)
    h_m: float = Field(ge=-1000, le=10_000)


class Geometry(Part):
    """Whose satellites, and when."""

    gps: str
    galileo: str
    start: datetime | None = None
    step_s: float = Field(ge=10, le=3600)
    duration_s: float = Field(gt=0, le=7 * 86_400)
    mask_deg: float = Field(gt=0, lt=90)
    coasting_mask_deg: float = Field(ge=0, lt=90)


class Grid(Part):
    """Coasting times and sizes of the nominal bias."""

    coasting_s: list[float] = Field(min_length=1, max_length=32)
    bias_m: list[float] = Field(min_length=1, max_length=32)

    @field_validator("bias_m")
    @classmethod
    def _from_zero(cls, values: list[float]) -> list[float]:
        if values[0] != 0 or any(b <= a for a, b in pairwise(values)):
            raise ValueError("sizes of the bias begin with 0 and grow")
        return values


class Method(Part):
    """Where the paper can be read in more ways than one."""

    form: Literal["major", "norm"]
    ordering: Literal["exact", "rss", "sum"]
    missed_detection: Literal["median", "worst"]
    covariance: Literal["snapshot", "paper", "bound"]


class OwnNumbers(Part):
    """Numbers of the user's instead of the rebuilt ones."""

    clock_mps: float | None = Field(default=None, ge=0)
    gast_f_stretch: float | None = Field(default=None, gt=0)
    gast_f_projection: float | None = Field(default=None, gt=0)
    gast_d_projection: float | None = Field(default=None, gt=0)
    sigma_fte_m: float | None = Field(default=None, ge=0)
    sigma_pde_m: float | None = Field(default=None, ge=0)


class Requirement(Part):
    """One sub-phase of the user's."""

    id: str = Field(min_length=1)
    title: str
    containment_m: float = Field(gt=0)
    hal_m: float = Field(gt=0)
    integrity_risk: float = Field(ge=1e-300, le=0.5)
    continuity_risk: float = Field(ge=1e-300, le=0.5)
    speed_mps: float = Field(ge=0)
    exposure_s: float = Field(gt=0)


class SurfaceMovement(Part):
    """The configuration."""

    title: str
    airport: Airport
    geometry: Geometry
    grid: Grid
    method: Method
    given: OwnNumbers = OwnNumbers()
    requirement: list[Requirement] = Field(default_factory=list)
    only: list[str] = Field(default_factory=list)
    """Sub-phases to look at, by name; all without it."""


def load(path: Path | None = None) -> SurfaceMovement:
    """Read the configuration, laid over the one that ships.

    Parameters
    ----------
    path : Path, optional
        A TOML file that gives what differs.

    Raises
    ------
    FormatError
        Not TOML, an unknown key, a value of the wrong type or outside its domain.
    """
    table = tomllib.loads(SHIPPED.read_text(encoding="utf-8"))
    if path is not None:
        try:
            table = _laid_over(table, tomllib.loads(path.read_text(encoding="utf-8")))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
            raise FormatError(path, f"not TOML: {e}") from e
        except OSError as e:
            raise FormatError(path, f"cannot be read: {e.strerror}") from e
        _resolve(table, path.parent)
    try:
        return SurfaceMovement.model_validate(table)
    except ValidationError as e:
        first = e.errors()[0]
        problem = "is missing" if first["type"] == "missing" else f"{first['input']!r}: {first['msg']}"
        raise FormatError(path or SHIPPED, problem, field=_place(table, first["loc"])) from e


def _place(table: dict[str, Any], location: tuple[str | int, ...]) -> str:
    """Where in a file something is: rows counted from one, with their name."""
    place, at = "", table
    for part in location:
        at = at[part] if isinstance(at, (dict, list)) and (isinstance(part, int) or part in at) else None  # type: ignore[index,assignment]
        if isinstance(part, int):
            name = at.get("id") if isinstance(at, dict) else None
            place += f" {part + 1}" + (f" ({name})" if name else "")
        else:
            place += f".{part}" if place else part
    return place


def _laid_over(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    """Tables key by key; anything else replaced as a whole."""
    both = {k for k in above if isinstance(above[k], dict) and isinstance(below.get(k), dict)}
    return {**below, **above, **{k: _laid_over(below[k], above[k]) for k in both}}


def nominal(system: str, name: str) -> str | None:
    """Name in :func:`navbound.gnss.constellation` of a shipped constellation; None for the path of a file."""
    return system if name == "nominal" else name if name in NOMINAL[system] else None


def _resolve(table: dict[str, Any], folder: Path) -> None:
    """Relative paths of constellations count from the file."""
    geometry = table.get("geometry")
    if not isinstance(geometry, dict):
        return
    for system in ("gps", "galileo"):
        name = geometry.get(system)
        if isinstance(name, str) and nominal(system, name) is None:
            geometry[system] = str(folder / name)
