"""Pictures of runs, tables and arrays with matplotlib, an extra: ``pip install 'navbound[plot]'``.

Every function draws one picture and returns its axes; ``ax`` says where. Colours are those of the report. What is not available is hatched
or left out, never drawn as within.
"""

from navbound.plot.errors import histogram, stanford, survival
from navbound.plot.places import approaches, availability, ellipse, ground_track, scatter, sky
from navbound.plot.series import bounds, deviation, levels, prediction, risk, states, status

__all__ = [
    "approaches",
    "availability",
    "bounds",
    "deviation",
    "ellipse",
    "ground_track",
    "histogram",
    "levels",
    "prediction",
    "risk",
    "scatter",
    "sky",
    "stanford",
    "states",
    "status",
    "survival",
]
