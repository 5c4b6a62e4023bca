"""Files to try navbound on: simulated by navbound, with truth, the same bytes whenever they are made again with one version."""

from navbound.examples.files import EXAMPLES, PLACE_ECEF_M, Example, make

__all__ = ["EXAMPLES", "PLACE_ECEF_M", "Example", "make"]
