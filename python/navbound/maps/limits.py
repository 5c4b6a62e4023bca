"""What is required of a column of a map."""

from __future__ import annotations

from dataclasses import dataclass

from navbound import _core, kpi
from navbound.errors import InputError


@dataclass(frozen=True)
class Limit:
    """What is required of a column: at most this, with where the number comes from and how it is held."""

    column: str
    limit: float
    source: str = "the caller"
    provenance: str = "ours"

    def __post_init__(self) -> None:
        if not self.limit > 0:
            raise InputError(f"limits[{self.column}]", self.limit, domain="(0, inf)")


def limits_of(level: str, *, vertical: bool = True) -> list[Limit]:
    """Alert limits of a service level as limits of protection levels.

    Raises
    ------
    InputError
        No such level.
    """
    required = kpi.level(level)
    # The source of a level of the table speaks of its other demands too.
    sources = {row["id"]: row["limits_source"] for row in _core.service_levels()}
    source = f"{required.id}: {sources.get(required.id, required.source)}"
    limits = [Limit("hpl_m", required.hal_m, source, required.provenance["hal_m"])]
    if vertical and required.val_m is not None:
        limits.append(Limit("vpl_m", required.val_m, source, required.provenance["val_m"]))
    return limits
