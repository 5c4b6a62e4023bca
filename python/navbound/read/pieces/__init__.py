"""Tables that are too large for memory: read, sorted and kept in pieces, with the same rows, counts and words as at once.

``chunks`` cuts a text file at the ends of lines, ``order`` sorts by distribution to pieces that lie on the disk, and
``reading`` is the reader; ``truth`` keeps a recorded truth.
"""

from navbound.read.pieces.reading import PIECE_ROWS, Beside, PiecedReading, read_pieces
from navbound.storage.frames import Frames

__all__ = ["PIECE_ROWS", "Beside", "Frames", "PiecedReading", "read_pieces"]
