"""`python -m navbound` is `navbound`."""

from navbound.cli.start import process

process()
