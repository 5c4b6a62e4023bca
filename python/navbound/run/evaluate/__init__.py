"""Errors against protection levels: the parts of an evaluation, one a file, and the ICAO indicators over all of them."""
