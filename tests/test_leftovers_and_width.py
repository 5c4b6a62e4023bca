"""A job that cannot write leaves nothing behind; a table too wide to be taken apart is refused at once."""

from __future__ import annotations

import gzip
import json
import subprocess
import sys
import time
from pathlib import Path

import polars as pl
import pytest

import navbound
from navbound import FormatError
from navbound.read.tables.table import MOST_COLUMNS
from test_verdict import table


def test_a_limit_on_the_size_of_files_leaves_nothing(tmp_path: Path) -> None:
    """The records are small enough, the page is not."""
    path, out = table(tmp_path / "a.csv"), tmp_path / "run"
    limited = f"ulimit -f 128; exec {sys.executable} -m navbound analyze {path} --out {out}"
    done = subprocess.run(["bash", "-c", limited], capture_output=True, text=True, check=False)
    assert done.returncode == 3, done.stderr
    assert "cannot be written" in done.stderr
    assert list(out.iterdir()) == []


def wide(path: Path, n: int) -> Path:
    rows = {"time_s": [1.7e9, 1.7e9 + 1], "lat": [50.0, 50.001], "lon": [4.0, 4.0]} | {f"c{k}": [1, 1] for k in range(n - 3)}
    if path.suffix == ".parquet":
        pl.DataFrame(rows).write_parquet(path)
    elif path.suffix == ".json":
        path.write_text(json.dumps(rows))
    else:
        lines = "\n".join(",".join(map(str, line)) for line in [rows.keys(), *zip(*rows.values(), strict=True)])
        path.write_bytes(gzip.compress(lines.encode()) if path.suffix == ".gz" else lines.encode())
    return path


@pytest.mark.parametrize("name", ["a.csv", "a.csv.gz", "a.json", "a.parquet"])
def test_a_table_of_very_many_columns_is_refused_with_the_limit(tmp_path: Path, name: str) -> None:
    path = wide(tmp_path / name, MOST_COLUMNS + 1)
    with pytest.raises(FormatError, match=f"a table of {MOST_COLUMNS + 1} columns; at most {MOST_COLUMNS} are read"):
        navbound.analyze(path)


def test_the_widest_table_is_read_in_seconds(tmp_path: Path) -> None:
    path = wide(tmp_path / "a.csv", MOST_COLUMNS)
    start = time.process_time()
    summary = navbound.analyze(path).summary
    # Ten times what it took where this was written: quadratic time takes far more.
    assert time.process_time() - start < 30.0
    assert any(f"c99 and {MOST_COLUMNS - 103} more" in words for words in summary.assumptions)
