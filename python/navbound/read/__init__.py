"""Recorded tracks to the epoch table: files of several kinds, runways, approaches, truth, covariance, plausibility."""

from navbound.read.approaches import Gates
from navbound.read.checks.plausible import Limits
from navbound.read.runways import Runway, runway
from navbound.read.tables.epochs import Reading, read

__all__ = ["Gates", "Limits", "Reading", "Runway", "read", "runway"]
