"""Recorded tracks to the epoch table: files of several kinds, runways, approaches, truth, covariance, plausibility."""

from navbound.read.approaches import Gates
from navbound.read.epochs import Reading, read
from navbound.read.plausible import Limits
from navbound.read.runways import Runway, runway

__all__ = ["Gates", "Limits", "Reading", "Runway", "read", "runway"]
