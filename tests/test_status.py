"""Statuses and reasons are ids; a sentence decides nothing."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from navbound import InputError, gbas, gnss, rnp, status
from navbound.read.checks import plausible
from navbound.run.evaluate.monitored import decisions

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "python" / "navbound"

SENTENCES = {"reason", "words", "multi_reason"}
"""Names of what holds a sentence for people: columns, fields and variables."""

DECIDING_CALLS = {
    *("group_by", "value_counts", "unique", "n_unique", "partition_by", "is_in", "isin", "eq", "ne", "replace", "replace_strict"),
    *("removeprefix", "removesuffix", "partition", "rpartition", "split"),
    *("startswith", "starts_with", "endswith", "ends_with", "contains"),
}
"""Calls that decide by what their receiver or arguments hold."""


UNUSED_ROWS = {"read/beside/position_times.py", "read/checks/rejections.py", "read/tables/epochs.py", "read/tables/values.py"}
"""Readers count the rows of a file that they leave out by the text of the defect; no epoch's status comes of it. May only shrink."""


def _absence(node: ast.Call) -> bool:
    """An empty text that becomes none: `replace("", None)`."""
    texts = [c.value for a in node.args for c in ast.walk(a) if isinstance(c, ast.Constant)]
    return texts == ["", None]


def _sentence(node: ast.AST) -> bool:
    """Whether an expression is a sentence: a column, field or variable of that name."""
    if isinstance(node, ast.Name):
        return node.id in SENTENCES
    if isinstance(node, ast.Attribute):
        return node.attr in SENTENCES or (node.attr in {"str"} and _sentence(node.value))
    if isinstance(node, ast.Subscript):
        return (isinstance(node.slice, ast.Constant) and node.slice.value in SENTENCES) or _sentence(node.value)
    if isinstance(node, ast.Call):
        named = isinstance(node.func, ast.Attribute) and node.func.attr in {"col", "get_column", "pop", "get"}
        if named and any(isinstance(a, ast.Constant) and a.value in SENTENCES for a in node.args):
            return True
        inner = isinstance(node.func, ast.Attribute) and node.func.attr in {"fill_null", "cast", "str", "alias"}
        return inner and _sentence(node.func.value)  # type: ignore[attr-defined]
    return False


def _identity(node: ast.Compare) -> bool:
    return all(isinstance(op, ast.Is | ast.IsNot) for op in node.ops)


def decisions_by_sentence(source: str) -> list[int]:
    """Lines of a source text that compare, group by or parse a sentence."""
    lines = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Compare) and not _identity(node) and any(map(_sentence, (node.left, *node.comparators))):
            lines.append(node.lineno)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in DECIDING_CALLS and not _absence(node):
            named = node.func.attr in {"group_by", "unique", "partition_by"} and any(
                isinstance(a, ast.Constant) and a.value in SENTENCES for a in node.args
            )
            if named or _sentence(node.func.value):
                lines.append(node.lineno)
    return sorted(set(lines))


@pytest.mark.parametrize(
    "line",
    [
        'lost = epochs.filter(pl.col("reason") == "a fault that cannot be excluded")',
        'each = excluded["reason"].value_counts(sort=True)',
        'for r in found.epochs.group_by("reason").len(): pass',
        'solved = reason == ""',
        'status = np.where(level.reason != "", "a", "b")',
        'named = reason.removeprefix("excluded ")',
        'field = event.words.partition(": ")',
        'x = epochs["reason"].fill_null("").str.contains("fault")',
    ],
)
def test_the_search_sees_a_decision_by_sentence(line: str) -> None:
    assert decisions_by_sentence(line) == [1]


@pytest.mark.parametrize(
    "line",
    [
        'e.filter(pl.col("reason_id") == "fault_not_excluded")',
        "if reason is not None: pass",
        "table['reason'] = words",
        'pl.col("reason").replace("", None)',
    ],
)
def test_the_search_passes_ids_and_absence(line: str) -> None:
    assert decisions_by_sentence(line) == []


def test_nothing_decides_by_a_sentence() -> None:
    files = {str(p.relative_to(PACKAGE)): p for p in PACKAGE.rglob("*.py") if "_web" not in p.parts}
    assert len(files) > 50
    lines = {name: decisions_by_sentence(p.read_text(encoding="utf-8")) for name, p in files.items()}
    assert {name: value for name, value in lines.items() if value and name not in UNUSED_ROWS} == {}
    assert {name for name, value in lines.items() if value} >= UNUSED_ROWS, "an exception that is no longer needed"


def _watched(sentences: dict[str, str]) -> pl.DataFrame:
    """Seven epochs of a monitor on board, in the sentences of a registry."""
    rows = [
        (1.0, 100.0, 0, None, None),
        (1.0, 100.0, 0, None, None),
        (1.0, None, 0, "fault_not_excluded", None),
        (1.0, 120.0, 1, "fault_excluded", "G05"),
        (1.0, 120.0, 1, "fault_excluded", "G05"),
        (1.0, None, 0, "fault_not_detectable", None),
        (None, None, 0, "too_few_satellites", None),
    ]
    table = pl.DataFrame(
        rows,
        schema={"est_lat_rad": pl.Float64, "hpl_m": pl.Float64, "n_excluded": pl.Int64, "reason_id": pl.String, "excluded_sv": pl.String},
        orient="row",
    )
    return table.with_columns(pl.col("reason_id").replace_strict(sentences, default=None).alias("reason"))


def test_a_sentence_of_another_wording_changes_no_count() -> None:
    """The counts of the monitor: three faults detected, two excluded, one not; one epoch where none could be detected."""
    sentences = {id_: entry.words for id_, entry in status.REASONS.items()}
    decided = decisions(_watched(sentences))
    assert "a fault detected at 3, excluded at 2 (G05 at 2), not to be excluded at 1" in decided[0]
    assert "no way to detect a fault at 1" in decided[0]
    for changed in sentences:
        other = decisions(_watched(sentences | {changed: "reworded"}))
        assert other == decided, changed


def test_a_sentence_of_another_wording_changes_no_status(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every status that Python decides with the registry, with every sentence of it changed."""
    epochs = pl.DataFrame(
        {
            "track": ["a"] * 200,
            "time_ns": [i * 1_000_000_000 for i in range(200)],
            "est_lat_rad": [0.7 + (0.01 if i > 100 else 0.0) for i in range(200)],
            "est_lon_rad": [0.3] * 200,
            "ground_speed_mps": [100.0] * 200,
        }
    )
    before, _ = plausible.check(epochs)
    monkeypatch.setattr(status, "REASONS", {k: replace(v, words="reworded") for k, v in status.REASONS.items()})
    after, _ = plausible.check(epochs)
    assert before["status"].to_list() == after["status"].to_list()
    assert before["status"].n_unique() > 2
    assert before["reason_id"].to_list() == after["reason_id"].to_list()
    assert set(after["reason"].drop_nulls()) == {"reworded"} != set(before["reason"].drop_nulls())


def test_every_id_is_of_the_registry_and_gives_the_status_of_its_epoch() -> None:
    assert {entry.status for entry in status.REASONS.values()} <= set(status.STATUSES)
    assert set(status.USABLE) | set(status.UNUSABLE) == set(status.STATUSES)
    assert (rnp.USABLE, rnp.UNUSABLE) == (status.USABLE, status.UNUSABLE)
    with pytest.raises(InputError, match="reason_id = a fault that cannot be excluded"):
        status.reason("a fault that cannot be excluded")


def test_levels_without_a_result_carry_the_id_of_their_reason() -> None:
    az = np.radians([[0.0, 120.0, 240.0, np.nan], [0.0, 90.0, 180.0, 270.0], [0.0, 120.0, 240.0, 60.0]])
    el = np.radians([[40.0, 50.0, 60.0, np.nan], [30.0, 30.0, 30.0, 30.0], [20.0, 30.0, 40.0, 85.0]])
    of = {"too_few_satellites": "not_available", "singular": "not_available", "": "ok"}
    solution = gnss.covariance(az, el, 1.0)
    assert dict(zip(solution.reason_id.tolist(), solution.status.tolist(), strict=True)) == of
    dilution = gnss.dop(az, el)
    assert dict(zip(dilution.reason_id.tolist(), dilution.status.tolist(), strict=True)) == of
    levels = gbas.protection_levels(az, el, sigma_m=1.0, sigma_h1_m=1.0)
    assert dict(zip(levels.reason_id.tolist(), levels.status.tolist(), strict=True)) == of
