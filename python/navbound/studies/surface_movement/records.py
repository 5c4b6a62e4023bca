"""What the surface-movement study leaves behind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from navbound.records.base import Record
from navbound.studies.surface_movement.scenario import SurfaceMovement

if TYPE_CHECKING:
    from rich.console import RenderableType

Quantity = Literal["accuracy", "single", "multi", "monitor"]


class Number(Record):
    """A number the study takes as given, with how it is held; it is never shown without."""

    name: str
    value: str
    held: Literal["printed", "re-derived", "standard", "ours", "inferred", "given"]
    why: str


class Phase(Record):
    """A sub-phase and its requirements."""

    id: str
    title: str
    containment_m: float
    hal_m: float
    accuracy_m: float
    """95 %, from the containment and the error budget."""
    integrity_risk: float
    continuity_risk: float
    speed_mps: float
    held: str
    """How the numbers are held: the weakest of their marks."""


class Before(Record):
    """One mode before coasting, over all geometries."""

    mode: str
    n_epochs: int
    n_unavailable: int
    n_sv_min: int
    n_sv_mean: float
    sigma_major_median_m: float
    sigma_major_max_m: float
    bias_gain_median: float
    bias_gain_max: float
    worst_projection: float
    hpl_max_m: list[float]
    """Largest protection level for each size of the bias."""
    accuracy_max_m: list[float]
    """Largest 95 % error for each size of the bias."""


class Margin(Record):
    """Decades between missed-detection limit and monitor, one for each size of the bias."""

    mode: str
    case: str
    phase: str
    decades: list[float]


class Cell(Record):
    """The largest nominal bias for which every epoch passes."""

    quantity: Quantity
    mode: str
    case: str
    phase: str
    coasting_s: float
    """0 before coasting."""
    bias_m: float | None
    """None: not even without bias."""
    worst_m: float | None
    """Largest value without bias; for the monitor the margin in decades."""
    share: float
    """Share of epochs that pass without bias; for the monitor 0 or 1."""


class Curve(Record):
    """Missed-detection limit against the monitor."""

    mode: str
    case: str
    phase: str
    error_m: list[float]
    limit: list[float]
    monitor: list[float]


class Errors(Record):
    """Simulated error against level: one draw of noise and bias an epoch."""

    mode: str
    hpe_m: list[float]
    hpl_m: list[float]


class Claim(Record):
    """One of the paper's statements."""

    id: str
    claim: str
    found: str
    verdict: Literal["reproduced", "not reproduced", "only without a bound", "bounded", "by construction", "fixes a number", "not judged"]
    fitted: str
    """Which inferred number was chosen by looking at this claim; empty where none was."""
    expected: str
    """What our specification found with the 31 satellites of January 2020."""


class Study(Record):
    """The whole study."""

    schema_id: Literal["navbound-surface-movement-1"] = "navbound-surface-movement-1"
    title: str
    constellation: str
    """Whose verdicts these are."""
    configuration: SurfaceMovement
    numbers: list[Number]
    phases: list[Phase]
    before: list[Before]
    margins: list[Margin]
    cells: list[Cell]
    curves: list[Curve]
    errors: list[Errors]
    claims: list[Claim]
    words: list[str]

    def table(self) -> RenderableType:
        """Lay the study out for a terminal."""
        from navbound.studies.surface_movement import table  # noqa: PLC0415

        return table.render(self)
