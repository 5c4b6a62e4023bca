"""The indicators as sentences: what a reader wants to know first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.run.words import length, share

if TYPE_CHECKING:
    from navbound.run.kpi_records import LevelResult, Performance


def performance_words(result: Performance) -> list[str]:
    """Accuracy, then each level: availability, continuity, integrity."""
    days = result.n_expected * result.period_s / 86_400
    absent = " absent epochs are not expected" if result.exclude_missing else f" {result.n_missing} absent"
    words = [
        f"{result.n_solution} of {result.n_expected} expected epochs have a protection level ({days:.3g} days every {result.period_s:g} s,"
        f"{absent}, {result.n_no_solution} without a solution)."
    ]
    both = [axis.error_m for axis in result.axes]
    if both[0] is not None:
        vertical = "" if both[1] is None else f", vertical {length(both[1].p95)}"
        words.append(f"Accuracy (95 %): horizontal {length(both[0].p95)}{vertical}.")
    else:
        words.append("Without truth neither accuracy nor integrity can be judged.")
    return words + [_level(found, result) for found in result.levels]


def _level(found: LevelResult, result: Performance) -> str:
    said = f"{found.level.id}: available {share(found.availability_expected)} of the epochs expected"
    said += f" ({share(found.availability_low)} to {share(found.availability_high)}, {found.n_effective:.0f} effective epochs)"
    if found.continuity_risk is None:
        return said + "; never available, so continuity has no value."
    meaning = "" if found.window_meaningful else " (not meaningful at this sampling period)"
    said += f", {found.n_continuity_events} discontinuities, continuity risk {found.continuity_risk:.2g} in {found.window_s:g} s{meaning}"
    if result.truth_known:
        over = f", {found.n_hazard_over_tta} longer than {found.level.tta_s:g} s" if found.n_hazard_events else ""
        said += f"; hazards {found.n_hazard_events}{over}; misleading information at {found.n_mi_epochs} available epochs"
    return said + "."
