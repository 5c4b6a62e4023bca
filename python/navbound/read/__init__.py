"""Recorded tracks to the epoch table: files of several kinds, runways, approaches, truth, covariance, plausibility."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from navbound.read.approaches import Gates
    from navbound.read.checks.limits import Limits
    from navbound.read.runways import Runway, runway
    from navbound.read.tables.epochs import Reading, read

_HOMES = {
    "Gates": "approaches",
    "Limits": "checks.limits",
    "Reading": "tables.epochs",
    "Runway": "runways",
    "read": "tables.epochs",
    "runway": "runways",
}

__all__ = ["Gates", "Limits", "Reading", "Runway", "read", "runway"]


def __getattr__(name: str) -> object:
    """Load the tables that a function needs only when it is used: live monitors read none."""
    if name in _HOMES:
        return getattr(import_module(f"navbound.read.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'navbound.read' has no attribute {name!r}")
