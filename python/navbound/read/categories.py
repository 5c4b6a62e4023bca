"""Categories of accuracy and integrity that transponders send: what each stands for."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from collections.abc import Mapping

NACP_EPU_M = {
    11: 3.0,
    10: 10.0,
    9: 30.0,
    8: 0.05 * METRES_PER_NM,
    7: 0.1 * METRES_PER_NM,
    6: 0.3 * METRES_PER_NM,
    5: 0.5 * METRES_PER_NM,
    4: METRES_PER_NM,
    3: 2 * METRES_PER_NM,
    2: 4 * METRES_PER_NM,
    1: 10 * METRES_PER_NM,
}
"""Navigation accuracy category for position to the upper limit of the 95 % horizontal radius [m]; 0 is "unknown".

Provenance: inferred (RTCA DO-260B / EUROCAE ED-102A, coding of NACp); the document was not read.
"""

NIC_RC_M = {
    11: 7.5,
    10: 25.0,
    9: 75.0,
    8: 0.1 * METRES_PER_NM,
    7: 0.2 * METRES_PER_NM,
    6: 0.6 * METRES_PER_NM,
    5: METRES_PER_NM,
    4: 2 * METRES_PER_NM,
    3: 4 * METRES_PER_NM,
    2: 8 * METRES_PER_NM,
    1: 20 * METRES_PER_NM,
}
"""Navigation integrity category to the containment radius [m]; 0 is "unknown". For 6 the largest of its three radii.

Provenance: inferred (RTCA DO-260B / EUROCAE ED-102A, coding of NIC); the document was not read.
"""

NUCP_EPU_M = {
    9: 3.0,
    8: 10.0,
    7: 0.05 * METRES_PER_NM,
    6: 0.1 * METRES_PER_NM,
    5: 0.25 * METRES_PER_NM,
    4: 0.5 * METRES_PER_NM,
    3: METRES_PER_NM,
    2: 5 * METRES_PER_NM,
    1: 10 * METRES_PER_NM,
}
"""Navigation uncertainty category for position of version 0 to the upper limit of the 95 % horizontal radius [m]; 0 is "unknown".

Provenance: inferred (RTCA DO-260 / ICAO Doc 9871, coding of NUCp); the documents were not read.
"""

NUCP_RC_M = {
    9: 7.5,
    8: 25.0,
    7: 0.1 * METRES_PER_NM,
    6: 0.2 * METRES_PER_NM,
    5: 0.5 * METRES_PER_NM,
    4: METRES_PER_NM,
    3: 2 * METRES_PER_NM,
    2: 10 * METRES_PER_NM,
    1: 20 * METRES_PER_NM,
}
"""The same category to the horizontal protection level [m]; 0 is "unknown". Of a message on the ground 6 has none, which no table says.

Provenance: as `NUCP_EPU_M`.
"""

PIC_RC_M = {
    14: 7.5,
    13: 25.0,
    12: 75.0,
    11: 0.1 * METRES_PER_NM,
    10: 0.2 * METRES_PER_NM,
    9: 0.3 * METRES_PER_NM,
    8: 0.5 * METRES_PER_NM,
    7: 0.6 * METRES_PER_NM,
    6: METRES_PER_NM,
    5: 2 * METRES_PER_NM,
    4: 4 * METRES_PER_NM,
    3: 8 * METRES_PER_NM,
    2: 10 * METRES_PER_NM,
    1: 20 * METRES_PER_NM,
}
"""Position integrity category of surveillance reports to the containment radius [m]; 0 is "unknown".

Provenance: inferred (EUROCONTROL ASTERIX category 021, item 090); the document was not read, the radii are those of public decoders of it.
"""

SIL_RISK = {3: 1e-7, 2: 1e-5, 1: 1e-3}
"""Source integrity level to the risk, an hour or a sample, that the error exceeds the containment radius; 0 is "unknown".

Provenance: inferred (RTCA DO-260B / EUROCAE ED-102A, coding of SIL; read in the 1090 MHz Riddle); the document was not read.
"""


def nacp_sigma_m() -> dict[int, float]:
    """Give sigma of one axis for every NACp that has one.

    An EPU is less than the limit that its NACp stands for: the 95 % circle of this sigma, which is right to 1e-12, is so, too.
    """
    return axis_sigma_m(NACP_EPU_M)


def axis_sigma_m(limits_m: Mapping[int, float]) -> dict[int, float]:
    """Give the same for the upper limits of 95 % radii."""
    return {category: limit_m * (1.0 - 1e-11) * circular_sigma(0.05) for category, limit_m in limits_m.items()}


def circular_sigma(risk: float) -> float:
    """Give sigma of one axis as a share of the radius that a circular normal error exceeds with `risk`: 1 / sqrt(-2 ln risk)."""
    return 1.0 / math.sqrt(-2.0 * math.log(risk))
