"""What a user calls a requirement ("RNP 0.3", "RNP AR 0.1", "RNP APCH") to its accuracy, with where it comes from."""

from __future__ import annotations

import re
from dataclasses import dataclass

from navbound import rnp
from navbound.errors import InputError, NotFoundError
from navbound.units import METRES_PER_NM

SHORT_NAMES = {"RNP AR": "RNP AR APCH"}
"""Names that people say."""

DEFAULT_PHASE = "final"
"""Recorded tracks are judged on approaches unless another phase is named."""


@dataclass(frozen=True)
class Requirement:
    """A navigation specification as it will be judged.

    Attributes
    ----------
    words : str
        As reports print it.
    rnp_m : float
        Lateral accuracy. [m]
    source : str
        Where the value comes from, with its provenance word.
    """

    words: str
    rnp_m: float
    source: str


def requirement(spec: str, phase: str | None = None) -> Requirement:
    """Read a navigation specification from its usual name.

    Parameters
    ----------
    spec : str
        ``RNP x`` with any accuracy x in nautical miles; or a name of :func:`navbound.rnp.specifications`, followed by an accuracy
        where the specification leaves a choice ("RNP AR 0.1").
    phase : str, optional
        Phase of flight, where the name alone does not decide; the final approach unless given.

    Raises
    ------
    InputError
        Not a specification, a phase it does not have, or an accuracy it does not allow.
    """
    text = re.sub(r"\s+", " ", spec.strip())
    plain = re.fullmatch(r"RNP (\d+(?:\.\d+)?)", text, re.IGNORECASE)
    if plain:
        return _value(text.upper(), float(plain.group(1)))
    match = re.fullmatch(r"(.*?)(?: (\d+(?:\.\d+)?))?", text)
    stem, value = (match.group(1), match.group(2)) if match else (text, None)
    names = {s.name for s in rnp.specifications()}
    if text.upper() in names:
        stem, value = text, None
    name = SHORT_NAMES.get(stem.upper(), stem.upper())
    if name not in names:
        raise NotFoundError("spec", spec, "specification", sorted(names | set(SHORT_NAMES)), "or RNP x with x in NM")
    cell = rnp.specification(name, phase or _phase(name), None if value is None else float(value) * METRES_PER_NM)
    words = f"{name} {cell.accuracy_m / METRES_PER_NM:g}" if cell.accuracy_least_m < cell.accuracy_most_m else name
    return Requirement(f"{words} ({cell.phase.replace('_', ' ')})", cell.accuracy_m, f"{cell.source} ({cell.provenance})")


def _value(words: str, rnp_nm: float) -> Requirement:
    if not 0 < rnp_nm <= 20:
        raise InputError("spec", words, domain="RNP values in (0, 20] NM")
    return Requirement(words, rnp_nm * METRES_PER_NM, "the value itself: accuracy x NM at 95 %, containment 2x at 1e-5 (printed)")


def _phase(name: str) -> str:
    phases = [s.phase for s in rnp.specifications() if s.name == name]
    return DEFAULT_PHASE if DEFAULT_PHASE in phases else phases[0]
