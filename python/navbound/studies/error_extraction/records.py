"""The records of the Error Extraction study. Every bound in them is experimental, not integrity."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from navbound.records.base import Record
from navbound.sbas import EXTRACTION_LABEL

if TYPE_CHECKING:
    from rich.console import RenderableType

Verdict = Literal["reproducible", "not reproducible"]


class Availability(Record):
    """Share of solution epochs with both bounds below the alert limits; None where it was not published."""

    apv_i: float
    lpv_200: float | None
    apv_ii: float
    cat_i_12: float


class Stage(Record):
    """One step from the service's levels to the EE bound."""

    name: str
    cause: str
    """What changed from the stage before."""
    origin: Literal["published", "computed"]
    availability: Availability
    hpe95_m: float | None = None
    vpe95_m: float | None = None
    vpe_max_m: float | None = None
    safety_h_max: float | None = None
    """Largest horizontal error over its bound."""
    safety_v_max: float | None = None
    n_misleading: int | None = None
    """Epochs with an error beyond its bound."""


class Cause(Record):
    """What one cause adds to the availability, in shares of the solution epochs."""

    cause: str
    gain: Availability


class Correlation(Record):
    """How long the position error of the day remembers, and the beta that follows."""

    axis: Literal["e", "n", "u"]
    r_60_s: float
    r_300_s: float
    r_600_s: float
    tau_s: float
    """-300 s / ln r(300 s)."""
    beta_1_hz: float
    """For that tau at 1 Hz, the paper's rate."""
    beta_measured: float
    """From the measured autocorrelation at the day's own rate."""


class BiasReading(Record):
    """Vertical bias bound of a recorded hour with the service's weights."""

    from_dop_m_median: float
    from_dop_m_max: float
    exact_m_median: float
    exact_m_max: float
    worst_ratio: float
    """Exact worst bias over mu sqrt(N) VDOP, the published form without its allowance."""


class Spread(Record):
    """One number of many runs; None where it never happened."""

    least: float | None
    median: float | None
    most: float | None
    share_never: float


class FaultEntry(Record):
    """One number of the fault table, and whether it comes out again."""

    fault: str
    quantity: Literal["peak bound [m]", "first error > bound [s]", "first bound >= VAL [s]", "error > VAL with bound < VAL [s]"]
    stated: float | None
    """As computed before, from one run; None: never."""
    found: Spread
    verdict: Verdict


class RiskOfMemory(Record):
    """Share of samples beyond the noise bound when the error is Gauss-Markov: what becomes of a stated risk."""

    tau_s: float
    risk: float
    """Stated."""
    stated: float
    """As computed before, by a semi-analytic way."""
    found: float
    """Of corrected errors, drawn."""
    standard_error: float
    verdict: Verdict


class RiskOfLaw(Record):
    """Share of independent errors of one law beyond the noise bound: what becomes of a stated risk."""

    law: str
    risk: float
    """Stated."""
    stated: float
    """As computed before."""
    found: float
    standard_error: float
    verdict: Verdict


class Claim(Record):
    """One claim of the paper and what became of it."""

    claim: str
    published: str
    computed: str
    verdict: Verdict
    why: str


class Study(Record):
    """Error Extraction on one real day, and under faults."""

    label: str = EXTRACTION_LABEL
    may_alert: Literal[False] = False
    positions: str
    n_epochs: int
    n_judged: int
    """Epochs after the filter has settled, the same for every stage."""
    settings: dict[str, float | int | str]
    day: Stage
    """The service's levels over all solution epochs of the day."""
    stages: list[Stage]
    split: list[Cause]
    correlations: list[Correlation]
    bias: BiasReading | None
    claims: list[Claim]
    faults: list[FaultEntry]
    n_fault_runs: int
    held: list[RiskOfMemory]
    """At a stated risk of 1e-3, counted."""
    held_small: list[RiskOfMemory]
    """At 5e-8, the tail given each window."""
    held_laws: list[RiskOfLaw]
    words: list[str]

    def table(self) -> RenderableType:
        """Lay the study out as tables for a terminal."""
        from navbound.studies.error_extraction.table import render  # noqa: PLC0415

        return render(self)
