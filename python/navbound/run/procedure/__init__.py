"""Recorded tracks against a published procedure: epochs with the deviation and the RNP of their leg, heights, and the answers."""

from navbound.run.procedure.answers import with_answers
from navbound.run.procedure.flown import Flown
from navbound.run.procedure.follow import OnProcedure, on_procedure

__all__ = ["Flown", "OnProcedure", "on_procedure", "with_answers"]
