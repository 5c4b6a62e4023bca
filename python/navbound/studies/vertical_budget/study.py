"""The worked example of the vertical error budget of RNP AR done again, term by term, and a contradiction in the same order.

FAA Order 8260.52 prints every term of one budget on the last page of its appendix 1, but not what it was worked out from. The inputs here
are inferred: each meets all printed digits of its terms. The term of temperature fits no round temperature; it is taken as printed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from navbound import tse, vertical
from navbound.records.base import Record
from navbound.units import METRES_PER_FT, METRES_PER_NM

if TYPE_CHECKING:
    from rich.console import RenderableType

RNP_NM, ANGLE_DEG, ALTITUDE_FT, THRESHOLD_FT = 0.14, 3.0, 4500.0, 1200.0
SEMISPAN_FT, BANK_DEG = 68.0, 18.0
ISAD_FT = -174.5432
"""As printed; the hypsometric law has it 14.9 K below the standard temperature."""
PRINTED_FT = {"anpe": 54.6117, "wpr": 3.1445, "fte": 75.0, "ase": 77.468, "vae": 11.02, "atis": 20.0, "veb": 359.6163}

HEIGHT_FT, CORRECTION_FT, CROSSING_FT, TOUCHDOWN_FT = 300.0, 12.88, 52.0, 3.0
"""Formulas 4-8 and 4-9, p. 4-7: height above touchdown, correction, crossing height, and touchdown zone above the threshold."""
PRINTED_D_FT = {"formula 4-8": 5034.98, "formula 4-9": 4977.81}


class Term(Record):
    """One term of the budget."""

    name: str
    printed_ft: float
    ours_ft: float


class Distance(Record):
    """The distance that the order prints twice."""

    name: str
    printed_ft: float
    ours_ft: float


class Reading(Record):
    """What the factor 4/3 means, by what the terms are taken for."""

    terms_are: str
    sigmas: float
    risk_below: float


class Study(Record):
    """The example and the contradiction."""

    terms: list[Term]
    distances: list[Distance]
    readings: list[Reading]
    isa_deviation_k: float
    """Deviation from the standard atmosphere at which the law gives the printed effect of temperature."""
    words: list[str]

    def table(self) -> RenderableType:
        """Lay the study out for a terminal."""
        return _render(self)


def run() -> Study:
    """Work the example out."""
    altitude, threshold = ALTITUDE_FT * METRES_PER_FT, THRESHOLD_FT * METRES_PER_FT
    budget = vertical.budget(
        RNP_NM * METRES_PER_NM,
        math.radians(ANGLE_DEG),
        altitude,
        threshold,
        isad_m=ISAD_FT * METRES_PER_FT,
        body_geometry_m=vertical.turn_geometry(SEMISPAN_FT * METRES_PER_FT, math.radians(BANK_DEG)),
    )
    terms = [
        Term(name=name, printed_ft=printed, ours_ft=float(getattr(budget, f"{name}_m")) / METRES_PER_FT)
        for name, printed in PRINTED_FT.items()
    ]
    slope = math.tan(math.radians(ANGLE_DEG))
    above = {"formula 4-8": TOUCHDOWN_FT, "formula 4-9": 0.0}
    distances = [
        Distance(name=name, printed_ft=printed, ours_ft=(HEIGHT_FT + CORRECTION_FT + above[name] - CROSSING_FT) / slope)
        for name, printed in PRINTED_D_FT.items()
    ]
    # Two-sided: 99.7 % of a normal error are within this many standard deviations.
    of_share = float(tse.factors(0.003).two_sided)
    kinds = {"three standard deviations": 3.0, "99.7 % of the errors": of_share}
    readings = [
        Reading(terms_are=kind, sigmas=4.0 / 3.0 * k, risk_below=float(vertical.risk_below(0.0, 1.0, 4.0 / 3.0 * k)))
        for kind, k in kinds.items()
    ]
    words = [
        f"Inputs, inferred from the printed terms: RNP {RNP_NM}, {ANGLE_DEG:g} degrees, {ALTITUDE_FT:g} ft, threshold {THRESHOLD_FT:g} ft, "
        f"semispan {SEMISPAN_FT:g} ft at a bank of {BANK_DEG:g} degrees. The effect of temperature, {ISAD_FT} ft, is taken as printed.",
        "The order contradicts itself on p. 4-7: the example of formula 4-9 goes on with a distance that leaves the 3 ft of the touchdown "
        "zone above the threshold out. With them the printed decision altitude of 712.88 ft is 715.88 ft.",
    ]
    return Study(
        terms=terms, distances=distances, readings=readings, isa_deviation_k=_deviation(altitude - threshold, threshold), words=words
    )


def _deviation(above_m: float, threshold_m: float) -> float:
    """Deviation at which the law has the printed effect: by halves, to a millikelvin."""
    low, high = -60.0, 0.0
    while high - low > 1e-3:
        middle = 0.5 * (low + high)
        effect = float(vertical.true_height(above_m, threshold_m, middle)) - above_m
        low, high = (middle, high) if effect < ISAD_FT * METRES_PER_FT else (low, middle)
    return 0.5 * (low + high)


def _render(study: Study) -> RenderableType:
    from rich.console import Group  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    terms = Table(title="Vertical error budget, FAA Order 8260.52, appendix 1 [ft]")
    for heading in ("term", "printed", "ours"):
        terms.add_column(heading, justify="left" if heading == "term" else "right")
    for term in study.terms:
        terms.add_row(term.name, f"{term.printed_ft:g}", f"{term.ours_ft:.4f}")
    distances = Table(title="Distance of formulas 4-8 and 4-9, p. 4-7 [ft]")
    for heading in ("formula", "printed", "ours"):
        distances.add_column(heading, justify="left" if heading == "formula" else "right")
    for distance in study.distances:
        distances.add_row(distance.name, f"{distance.printed_ft:g}", f"{distance.ours_ft:.2f}")
    readings = Table(title="What 4/3 of the root means, on one side")
    for heading in ("the terms are", "standard deviations", "risk below"):
        readings.add_column(heading, justify="left" if heading == "the terms are" else "right")
    for reading in study.readings:
        readings.add_row(reading.terms_are, f"{reading.sigmas:.3f}", f"{reading.risk_below:.2e}")
    law = f"By the hypsometric law the printed effect of temperature is that of {study.isa_deviation_k:.1f} K from the standard atmosphere."
    return Group(terms, distances, readings, law, *study.words)
