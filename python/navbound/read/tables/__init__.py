"""Tables of any origin to columns in SI with GPS time: bytes to cells, cells to numbers, names to meanings, written times to GPS time."""
