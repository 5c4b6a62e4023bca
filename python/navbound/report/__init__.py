"""A run's records as one self-contained HTML page. Selection, packing and clipping only: nothing is computed here."""

from navbound.report.render import render

__all__ = ["render"]
