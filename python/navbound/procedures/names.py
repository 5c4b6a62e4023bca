"""A procedure's name as a person types it."""

from __future__ import annotations

import re

from navbound.errors import InputError


def parts(name: str) -> tuple[str, str, str | None]:
    """Airport, procedure and transition of ``KDEN/H26-Z:FUZZZ``.

    Raises
    ------
    InputError
        Another form.
    """
    match = re.fullmatch(r"([A-Za-z0-9]{2,4})/([^/:]{1,6})(?::([^/:]+))?", name.strip())
    if match is None:
        raise InputError("procedure", name, domain="AIRPORT/PROCEDURE or AIRPORT/PROCEDURE:TRANSITION, such as KDEN/H26-Z:FUZZZ")
    airport, ident, transition = match.groups()
    return airport.upper(), ident.upper(), transition.upper() if transition else None


def as_sentence(text: str) -> str:
    """A remark as a sentence: a capital in front, one point behind."""
    return f"{text[0].upper()}{text[1:].removesuffix('.')}."
