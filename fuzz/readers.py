"""Coverage-guided fuzzing of the readers that are written in Python, by Atheris (dependency group ``fuzz``).

python fuzz/readers.py TARGET [options of libFuzzer] [corpus]

A target's input is refused by one of navbound's own errors, or read with every row accounted for; in time linear in its length.
"""

from __future__ import annotations

import json
import math
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

import atheris

with atheris.instrument_imports(include=["navbound"]):
    import numpy as np

    from navbound import scenario
    from navbound.storage.folders import MANIFEST, require_whole
    from navbound.errors import FormatError, InputError
    from navbound.read import read
    from navbound.read.tables.columns import assign
    from navbound.scale.checkpoint import Folder

if TYPE_CHECKING:
    from collections.abc import Callable

REFUSALS = (FormatError, InputError)
BASE_S, EACH_BYTE_S = 1.0, 1e-4
"""Processor time that a call may take, and that each byte may add: about a hundred times the usual with coverage counters. [s, s/B]"""
KEPT = "row used without it"
"""In the reason of a refused value whose row stays."""

memory = Path("/dev/shm")
SCRATCH = Path(tempfile.mkdtemp(prefix="navbound-fuzz-", dir=memory if memory.is_dir() else None))


def put(name: str, content: bytes) -> Path:
    """A file in memory."""
    path = SCRATCH / name
    path.write_bytes(content)
    return path


def table(content: bytes) -> None:
    """Tables of text, Parquet and logs: positions are on the Earth, times in order, and every row is an epoch or counted."""
    try:
        reading = read(put("input", content))
    except REFUSALS:
        return
    epochs = reading.epochs
    for name, most in (("est_lat_rad", math.pi / 2), ("est_lon_rad", 2 * math.pi)):
        assert epochs[name].is_finite().all()
        assert float(epochs[name].abs().max()) <= most  # type: ignore[arg-type]
    for _, group in epochs.group_by("track"):
        assert group["time_ns"].is_sorted()
    lost = sum(r.count for r in reading.rejected if KEPT not in r.reason)
    if reading.source.n_rows is not None and not content.startswith((b"%", b"$", b"\xb5", b"#", b"\xaa")):
        assert epochs.height + lost == reading.source.n_rows, (epochs.height, lost, reading.source.n_rows)


def as_json(content: bytes) -> None:
    """Tables of JSON."""
    table(content if content[:1] in b"[{" else b"[" + content)


def columns(content: bytes) -> None:
    """Names of columns, and what is declared of them."""
    text = content.decode("utf-8", "replace").split("\n")
    declared = dict(line.partition("=")[::2] for line in text[1:4])
    try:
        found = assign(text[0].split(","), declared, Path("input"))
    except REFUSALS:
        return
    used = [c.name for c in [*found.columns.values(), *found.times]]
    assert not set(used) & set(found.unused)


def scenarios(content: bytes) -> None:
    """Scenarios of flights and of taxiing."""
    path = put("input.toml", content)
    try:
        scenario.read(path)
    except REFUSALS:
        return


TILE = {"level_m": np.arange(6.0), "n": np.arange(3)}


def checkpoint(content: bytes) -> None:
    """A kept tile that was changed is not taken: positions and bytes in turn are changed."""
    folder = Folder(SCRATCH / "tiles", "a job")
    folder.store(0, "a tile", TILE)
    file = folder.file(0, "a tile")
    whole = bytearray(file.read_bytes())
    changed = bytearray(whole)
    for low, high, value in zip(content[::3], content[1::3], content[2::3], strict=False):
        changed[(low | high << 8) % len(changed)] = value
    file.write_bytes(changed)
    found = folder.load(0, "a tile")
    assert (found is None) == (changed != whole)
    file.write_bytes(content)
    assert folder.load(0, "a tile") is None


def manifest(content: bytes) -> None:
    """The manifest of a finished job."""
    folder = SCRATCH / "run"
    folder.mkdir(exist_ok=True)
    (folder / "a.json").write_text("{}")
    (folder / MANIFEST).write_bytes(content)
    try:
        require_whole(folder, ["a.json"], "a run")
    except REFUSALS:
        return
    assert json.loads(content)["files"]["a.json"]


TARGETS: dict[str, Callable[[bytes], None]] = {
    "table": table,
    "json": as_json,
    "columns": columns,
    "toml": scenarios,
    "checkpoint": checkpoint,
    "manifest": manifest,
}


def budgeted(target: Callable[[bytes], None]) -> Callable[[bytes], None]:
    """The same, within a time that is linear in the length."""

    def call(content: bytes) -> None:
        begin = time.thread_time()
        target(content)
        taken = time.thread_time() - begin
        allowed = BASE_S + EACH_BYTE_S * len(content)
        assert taken <= allowed, f"{len(content)} bytes took {taken:.2f} s, more than the {allowed:.2f} s that are allowed"

    return call


def main() -> None:
    """Run one target."""
    name = sys.argv.pop(1) if len(sys.argv) > 1 else ""
    if name not in TARGETS:
        sys.exit(f"fuzz/readers.py: {name!r} is no target; one of {', '.join(TARGETS)}")
    os.chdir(Path(__file__).parent)
    atheris.Setup(sys.argv, budgeted(TARGETS[name]))
    atheris.Fuzz()


if __name__ == "__main__":
    main()
