"""One epoch, one step: errors, bounds, risks, state, status and alert of an epoch, for a table and for a stream alike.

:class:`Judge` takes one aircraft epoch by epoch, as a live monitor does. :class:`Judges` takes the tracks of a table, at once or in pieces.
Both are the same step of the core, so they give the same bits. :class:`Settings` says how.
"""

from navbound.judge.epoch import Judge, Judged
from navbound.judge.settings import Settings
from navbound.judge.table import Judges, with_levels

__all__ = ["Judge", "Judged", "Judges", "Settings", "with_levels"]
