"""`python -m navbound` is `navbound`."""

from navbound.cli import main

main()
