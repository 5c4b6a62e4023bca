"""Two finished runs compared: what moved is named, what did not is not, and what cannot be compared is refused."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import jsonschema
import polars as pl
import pytest

import navbound
from navbound.cli import schema
from navbound.errors import FormatError, InputError
from navbound.records.comparison import Comparison
from navbound.report import comparison
from navbound.run import directory
from navbound.run.comparison.compare import compare

EPOCHS = 60
TRACKS = "track,time,lat,lon,sigma_m\n"


def rows(track: str, lat_deg: float = 48.0) -> str:
    """A minute towards the east at 60 m/s, a second apart."""
    return "".join(f"{track},2026-03-01T10:00:{second:02d}Z,{lat_deg},{2.0 + second * 0.0008},5\n" for second in range(EPOCHS))


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The same recording twice, judged by one sigma and by another, and another recording."""
    folder = tmp_path_factory.mktemp("runs")
    one, other = folder / "one.csv", folder / "other.csv"
    one.write_text("track,time,lat,lon\n" + "".join(line.rsplit(",", 1)[0] + "\n" for line in rows("a").splitlines()), encoding="utf-8")
    other.write_text(
        "track,time,lat,lon\n" + "".join(line.rsplit(",", 1)[0] + "\n" for line in rows("b", 50.0).splitlines()), encoding="utf-8"
    )
    for name, file, sigma_m in (("before", one, 5.0), ("again", one, 5.0), ("after", one, 300.0), ("other", other, 5.0)):
        navbound.analyze(file, spec="RNP 0.3", sigma_m=sigma_m, out=folder / name)
    return {name: folder / name for name in ("before", "again", "after", "other")}


def test_a_run_done_again_is_the_same(runs: dict[str, Path]) -> None:
    record = compare(runs["before"], runs["again"])
    assert record.same
    assert (record.n_common, record.n_only_a, record.n_only_b) == (EPOCHS, 0, 0)
    assert [record.numbers, record.columns, record.changes, record.settings] == [[], [], [], []]
    assert record.words == [
        f"{EPOCHS} epochs of both runs are compared, by track and time.",
        "No epoch changed its alert.",
        "No number moved.",
    ]


def test_a_larger_sigma_moves_the_bounds_and_changes_the_alert_of_every_epoch(runs: dict[str, Path]) -> None:
    record = compare(runs["before"], runs["after"])
    assert not record.same
    # 2.4477 sigma is the 95 % circle: 734 m are beyond RNP 0.3, 12 m are not.
    (count,) = [c for c in record.counts if c.column == "alert" and c.a == "normal"]
    assert (count.n_epochs, count.b) == (EPOCHS, "warning")
    (change,) = [c for c in record.changes if c.column == "alert"]
    assert (change.track, change.n_epochs, change.end_ns - change.start_ns) == ("a", EPOCHS, (EPOCHS - 1) * 1_000_000_000)
    circle = next(c for c in record.columns if c.column == "anp_circle_m")
    assert (circle.n_moved, circle.unit) == (EPOCHS, "m")
    assert circle.largest == pytest.approx(2.447747 * 295.0, rel=1e-6)
    assert {(s.what, s.a, s.b) for s in record.settings} == {("settings sigma_m", "5.0", "300.0")}
    share = next(n for n in record.numbers if n.group == "verdict" and n.name == "share_inside")
    assert (share.a, share.b, share.difference) == (1.0, 0.0, -1.0)
    assert "est_lat_rad" not in {c.column for c in record.columns}


def test_one_epoch_that_moved_is_named_with_its_place(runs: dict[str, Path], tmp_path: Path) -> None:
    run = directory.load(runs["before"])
    moved = run.epochs.with_columns(
        anp_circle_m=pl.when(pl.col("time_ns") == run.epochs["time_ns"][17]).then(pl.lit(99.0)).otherwise("anp_circle_m"),
        alert=pl.when(pl.int_range(pl.len()).is_between(20, 22)).then(pl.lit("caution")).otherwise("alert"),
    ).head(EPOCHS - 1)
    directory.Run(run.summary, run.record, moved, run.events, []).save(tmp_path / "moved")
    record = compare(runs["before"], tmp_path / "moved")
    (column,) = record.columns
    assert (column.column, column.n_moved, column.track, column.time_ns) == ("anp_circle_m", 1, "a", run.epochs["time_ns"][17])
    assert column.largest == pytest.approx(99.0 - run.epochs["anp_circle_m"][17])
    assert [(c.a, c.b, c.n_epochs, c.start_ns) for c in record.changes] == [("normal", "caution", 3, run.epochs["time_ns"][20])]
    assert (record.n_common, record.n_only_a, record.n_only_b) == (EPOCHS - 1, 1, 0)
    assert "1 epoch of A is not in B, 0 of B are not in A." in record.words


def test_what_cannot_be_compared_is_refused_in_a_sentence(runs: dict[str, Path], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a run is the same as itself"):
        compare(runs["before"], runs["before"])
    with pytest.raises(InputError, match="an epoch in common"):
        compare(runs["before"], runs["other"])
    shutil.copytree(runs["before"], tmp_path / "cut")
    (tmp_path / "cut" / "manifest.json").unlink()
    with pytest.raises(FormatError, match="did not finish"):
        compare(runs["before"], tmp_path / "cut")
    shutil.copytree(runs["before"], tmp_path / "changed")
    (tmp_path / "changed" / "summary.json").write_text("{}", encoding="utf-8")
    with pytest.raises(FormatError, match="its digest differs"):
        compare(tmp_path / "changed", runs["before"])


def test_the_command_writes_page_and_record_and_prints_what_the_schema_says(runs: dict[str, Path], tmp_path: Path) -> None:
    command = [sys.executable, "-m", "navbound", "compare", str(runs["before"]), str(runs["after"]), "--out", str(tmp_path / "c"), "--json"]
    printed = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert printed == json.loads((tmp_path / "c" / "comparison.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(schema.of("compare")).validate(printed)
    page = (tmp_path / "c" / "comparison.html").read_text(encoding="utf-8")
    assert f"{EPOCHS} epochs changed the alert: normal to warning at {EPOCHS}." in page
    assert "script" not in page.replace("script-src", "")


def test_names_in_the_page_are_no_markup(runs: dict[str, Path]) -> None:
    record = compare(runs["before"], runs["after"])
    named = record.model_copy(update={"a": record.a.model_copy(update={"title": "<b>x</b>"})})
    assert isinstance(named, Comparison)
    assert "<b>x</b>" not in comparison.page(named)
