"""Recorded tables that are too large for memory, from their pieces to a judged run: the results are those of the whole at once."""

from navbound.run.pieces.flights import Flights
from navbound.run.pieces.material import AUXILIARY, InPieces, Request, covariance_status, in_pieces, is_large
from navbound.run.pieces.truth import PiecedTruth
from navbound.run.pieces.ways import NoWay, OnApproach, OnRoute, Way, without_path

__all__ = [
    "AUXILIARY",
    "Flights",
    "InPieces",
    "NoWay",
    "OnApproach",
    "OnRoute",
    "PiecedTruth",
    "Request",
    "Way",
    "covariance_status",
    "in_pieces",
    "is_large",
    "without_path",
]
