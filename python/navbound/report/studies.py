"""What a study leaves in a folder: its records, and a page where it has one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.report import surface
from navbound.run.surface_records import Study as SurfaceStudy
from navbound.studies.fault_campaign.records import Study as CampaignStudy
from navbound.studies.fault_campaign.table import markdown

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.run.studies import Study


def write(study: Study, out: Path) -> Path:
    """Write ``study.json``, and ``report.html`` or ``table.md`` for a study that has a page; say which file to look at.

    Raises
    ------
    FormatError
        A folder that cannot be written.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        shown = out / "study.json"
        shown.write_text(study.model_dump_json(indent=1), encoding="utf-8")
        if isinstance(study, SurfaceStudy):
            shown = out / "report.html"
            shown.write_text(surface.html(study), encoding="utf-8")
        elif isinstance(study, CampaignStudy):
            shown = out / "table.md"
            shown.write_text(markdown(study), encoding="utf-8")
    except OSError as e:
        raise FormatError(out, f"cannot be written: {e.strerror}") from e
    return shown
