"""Published procedures: the navigation database, the path and the RNP of every leg, contradictions in the data, and a flight along it.

The reader and the geometry are the core's (`crates/formats/src/arinc424`, `crates/path/src/legs`). Distances are in metres and angles in
radians; nautical miles, feet and degrees exist in the file and on the screen.
"""

from navbound.procedures.database import Database, Entry, Refused, RouteEntry, read
from navbound.procedures.findings import Finding
from navbound.procedures.flight import Flight, LegResult, Limits, judge
from navbound.procedures.legs import Followed, Leg, LegFeet, LevelOfService, Procedure
from navbound.procedures.vertical import VerticalPath, surface_below, vertical_path

__all__ = [
    "Database",
    "Entry",
    "Finding",
    "Flight",
    "Followed",
    "Leg",
    "LegFeet",
    "LegResult",
    "LevelOfService",
    "Limits",
    "Procedure",
    "Refused",
    "RouteEntry",
    "VerticalPath",
    "judge",
    "read",
    "surface_below",
    "vertical_path",
]
