"""What a file calls things is shown so that it can do no harm: on a terminal, in a spreadsheet, in a browser."""

from __future__ import annotations

import base64
import csv
import hashlib
import json
import re
import subprocess
import sys
import unicodedata
from pathlib import Path

import polars as pl
import pytest

import report_fixture
from navbound import FormatError, InputError
from navbound.errors import UNSEEN, visible
from navbound.read import read
from navbound.records.run import Rejection
from navbound.report import render
from navbound.run.evaluate.levels import SCHEMA
from navbound.write.field_csv import write_csv

EVIL = "DLH\x1b]0;title\x07\x1b[31m1\u202e2\u2066\u20283\x9b"
HARMLESS = "DLH]0;title[31m123"


def test_control_and_direction_characters_are_the_unseen_ones() -> None:
    assert visible(EVIL) == HARMLESS
    assert visible("Zürich – 東京 £ עברית") == "Zürich – 東京 £ עברית"
    unseen = {chr(c) for c in range(0x11000) if re.fullmatch(UNSEEN, chr(c))}
    assert {c for c in map(chr, range(0x11000)) if unicodedata.category(c) in {"Cc", "Zl", "Zp"}} <= unseen
    turning = {
        c
        for c in map(chr, range(0x11000))
        if unicodedata.bidirectional(c) in {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}
    }
    assert turning <= unseen


def test_no_message_and_no_record_holds_one() -> None:
    for refusal in (FormatError(EVIL, EVIL, 3, EVIL), InputError(EVIL, EVIL, EVIL, EVIL)):
        assert re.search(UNSEEN, str(refusal)) is None
    assert Rejection(file=EVIL, reason=EVIL, count=1, first_line=1, example=EVIL).example == HARMLESS


def table(folder: Path, name: str) -> Path:
    path = folder / f"{EVIL.replace('/', '')}.csv"
    rows = "\n".join(f"{1_700_000_000 + k},{50 + 1e-3 * k},8,10000,{name}" for k in range(60))
    path.write_text(
        f"timestamp,latitude,longitude,geoaltitude,callsign,{EVIL}\n".replace("\u2028", "") + rows.replace("\n", ",1\n") + ",1\n"
    )
    return path


def test_a_run_over_a_hostile_file_shows_none(tmp_path: Path) -> None:
    path = table(tmp_path, EVIL.replace("\u2028", ""))
    assert set(read(path).epochs["callsign"]) == {HARMLESS.upper()}
    done = subprocess.run(
        [sys.executable, "-m", "navbound", "analyze", str(path), "--out", str(tmp_path / "run")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert "traceback" not in done.stderr.lower()
    shown = done.stdout + done.stderr + (tmp_path / "run" / "report.html").read_text().split("<script>")[0]
    assert re.search(UNSEEN, shown.replace("\n", "")) is None
    for record in ("summary.json", "run.json"):
        text = json.dumps(json.loads((tmp_path / "run" / record).read_text()), ensure_ascii=False)
        assert re.search(UNSEEN, text) is None
        assert "\\u001b" not in text


def test_no_cell_of_a_spreadsheet_is_a_formula(tmp_path: Path) -> None:
    names = ["=1+1", "+49", "-cmd|' /C calc'!A0", "@SUM(A1)", "  =2", "plain", "a=b"]
    epochs = pl.DataFrame({"time_ns": list(range(len(names))), "track": names, "nse_e_m": [-1.5] * len(names)})
    full = pl.DataFrame(schema=SCHEMA)
    full = pl.concat([full, epochs.select(pl.col(c).cast(SCHEMA[c]) for c in epochs.columns)], how="diagonal")
    write_csv([full], tmp_path / "epochs.csv")
    with (tmp_path / "epochs.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["RECEIVER"] for row in rows] == ["'" + n if n.lstrip()[0] in "=+-@" else n for n in names]
    # Numbers stay numbers, of either sign.
    assert {float(row["EERR"]) for row in rows} == {1.5}
    cells = [cell for row in rows for cell in row.values() if cell and cell.lstrip()[0] in "=+-@"]
    for cell in cells:
        float(cell)


def test_a_report_runs_its_own_script_and_no_other(tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=20)
    page = render(fixture.summary, fixture.record, fixture.epochs, fixture.events, fixture.waypoints, tmp_path).read_text(encoding="utf-8")
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)
    assert policy is not None
    allowed = next(part.split()[1:] for part in policy[1].replace("&#39;", "'").split(";") if part.split()[0] == "script-src")
    scripts = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    assert len(scripts) == 1
    assert allowed == [f"'sha256-{base64.b64encode(hashlib.sha256(s.encode()).digest()).decode()}'" for s in scripts]


@pytest.mark.parametrize(
    "template", sorted((Path(__file__).parents[1] / "python" / "navbound" / "report").glob("*.j2")), ids=lambda p: p.name
)
def test_every_page_forbids_scripts_that_it_does_not_name(template: Path) -> None:
    text = template.read_text(encoding="utf-8")
    assert "default-src 'none'" in text
    assert "script-src 'unsafe-inline'" not in text
