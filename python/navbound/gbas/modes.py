"""The processing modes of GBAS on the surface, and the factor of its accuracies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from navbound import _core

K95 = float(_core.chi_factor(1, np.array([0.05]))[0])
"""The two-sided 95 % factor behind every accuracy here."""


@dataclass(frozen=True)
class Mode:
    """One way to process: name, service, phase differenced in time, constellations, words."""

    id: str
    service: Literal["D", "F"]
    carrier: str
    systems: tuple[str, ...]
    words: str


MODES = (
    Mode("D", "D", "single", ("gps",), "GAST D, GPS"),
    Mode("F1", "F", "dual", ("gps",), "GAST F, GPS"),
    Mode("F2", "F", "dual", ("gps", "galileo"), "GAST F, GPS and Galileo"),
)
