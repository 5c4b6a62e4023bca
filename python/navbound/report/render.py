"""The page itself: template, bundle and payload in one file."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import escape

from navbound.errors import InputError
from navbound.report import payload

if TYPE_CHECKING:
    import polars as pl

    from navbound.read.pieces import Frames
    from navbound.records.run import RunRecord, Summary, Waypoint

_NEEDED = ("track", "time_ns")


def render(  # noqa: PLR0917 - the parts of a run, in the order of its files
    summary: Summary,
    record: RunRecord,
    epochs: pl.DataFrame | Frames,
    events: pl.DataFrame,
    waypoints: list[Waypoint],
    out: Path,
    *,
    satellites: pl.DataFrame | None = None,
) -> Path:
    """Write the report of one run as a single HTML file that needs no network.

    Parameters
    ----------
    summary : Summary
        What the run found (summary.json).
    record : RunRecord
        What it takes to do it again (run.json).
    epochs : DataFrame or Frames
        The epoch table of docs/notation.md; each chart appears when its columns do.
    events : DataFrame
        Alerts and points of the flight.
    waypoints : list of Waypoint
        Points to draw and name on the map.
    out : Path
        File to write, or an existing directory, which receives ``report.html``.
    satellites : DataFrame, optional
        What became of every satellite heard, where positions were solved.

    Returns
    -------
    Path
        The file written. Values in it are kept to the resolution that it states, 1 mm for lengths.

    Raises
    ------
    InputError
        ``epochs`` lacks ``track`` or ``time_ns``.
    """
    for name in _NEEDED:
        if name not in epochs.columns:
            raise InputError("epochs", f"columns {epochs.columns}", domain=f"tables with a column {name}")
    page = payload.build(summary, record, epochs, events, waypoints, satellites=satellites)
    return write_page(summary.title, summary.verdict.words, page, out / "report.html" if out.is_dir() else out)


def write_page(title: str, words: str, page: payload.Page, target: Path) -> Path:
    """Write a page: its title, what it found in words for a browser without scripts, and its data."""
    target.parent.mkdir(parents=True, exist_ok=True)
    # The page is written whole or not at all: a report cut short could pass for a report.
    partial = target.with_name(target.name + ".partial")
    try:
        partial.write_text(_html(title, words, page), encoding="utf-8")
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)
    return target


def _html(title: str, words: str, page: payload.Page) -> str:
    web = files("navbound").joinpath("_web")
    template = files("navbound").joinpath("report/template.html").read_text(encoding="utf-8")
    script = web.joinpath("report.js").read_text(encoding="utf-8")
    blocks = (f'<script type="text/plain" id="navbound-track-{k}">{escape(track)}</script>\n' for k, track in enumerate(page.tracks))
    parts = {
        "title": escape(title),
        "words": escape(words),
        "css": web.joinpath("report.css").read_text(encoding="utf-8") + _footer(title, page.data),
        "script": script,
        "script_hash": escape(f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}"),
        "data": script_safe(page.data),
        "tracks": "".join(blocks),
    }
    # What a part holds is not searched for names of parts; a template engine would take longer to load than the page to write.
    return re.sub(r"\{\{ (\w+) \}\}", lambda name: parts[name[1]], template)


def _footer(title: str, data: dict[str, Any]) -> str:
    """What stands at the foot of every printed page, beside its number: what it is of, who made it and when."""
    record = data.get("record") or data.get("map") or {}
    made = [
        f"navbound {record[name]}" if name == "navbound_version" else record[name]
        for name in ("navbound_version", "created_utc")
        if record.get(name)
    ]
    text = re.sub(r"[^\w .,:;()/+-]", lambda sign: f"\\{ord(sign[0]):x} ", " · ".join([title, *made]))
    return f'@page {{ @bottom-left {{ content: "{text}"; font: 8px system-ui, sans-serif; color: #454d55; }} }}'


def script_safe(data: object) -> str:
    """JSON that no text inside it can turn into markup: every ``<``, ``>`` and ``&`` is escaped."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return (
        text.replace("<", "\\u003c")
        .replace(">", "\\u003e")
        .replace("&", "\\u0026")
        .replace("\u2028", "\\u2028")
        .replace("\u2029", "\\u2029")
    )
