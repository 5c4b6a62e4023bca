"""What a study leaves in a folder: its records, and a page where it has one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.storage import folders
from navbound.studies.fault_campaign.records import Study as CampaignStudy
from navbound.studies.fault_campaign.table import markdown
from navbound.studies.surface_movement import page as surface_page
from navbound.studies.surface_movement.records import Study as SurfaceStudy

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.studies.registry import Study


RECORD, REPORT, TABLE = "study.json", "report.html", "table.md"


def write(study: Study, out: Path) -> Path:
    """Write ``study.json``, and ``report.html`` or ``table.md`` for a study that has a page; say which file to look at.

    Raises
    ------
    FormatError
        A folder that cannot be written, or holds something else.
    """
    with folders.own(out, {RECORD, REPORT, TABLE}, "a study's") as folder:
        folder.text(RECORD, study.model_dump_json(indent=1))
        if isinstance(study, SurfaceStudy):
            folder.text(REPORT, surface_page.html(study))
            return out / REPORT
        if isinstance(study, CampaignStudy):
            folder.text(TABLE, markdown(study))
            return out / TABLE
        return out / RECORD
