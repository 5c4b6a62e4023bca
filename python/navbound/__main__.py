"""`python -m navbound` is `navbound`."""

from navbound.cli.main import main

main()
