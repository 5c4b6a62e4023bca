"""A satellite that a navigation file calls unhealthy serves no prediction, and is named."""

from __future__ import annotations

from pathlib import Path

import pytest

from navbound import gnss

BROADCAST = Path(__file__).parents[1] / "examples" / "data" / "broadcast.rnx"
HEALTH_LINE, HEALTH = 6, slice(23, 42)
"""Of a record of GPS in RINEX 3: the line after the first six, its second field."""


def changed(folder: Path, name: str, which: set[int]) -> Path:
    """The example file with some records of a satellite unhealthy, counted from 0."""
    lines = BROADCAST.read_text(encoding="ascii").splitlines()
    begins = [k for k, line in enumerate(lines) if line.startswith(f"{name} ")]
    for number in which:
        line = lines[begins[number] + HEALTH_LINE]
        lines[begins[number] + HEALTH_LINE] = line[: HEALTH.start] + f"{63:19.12e}".replace("e", "D") + line[HEALTH.stop :]
    path = folder / "b.rnx"
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def records(name: str) -> int:
    return int((gnss.read_navigation(BROADCAST).records()["satellite"] == name).sum())


def test_one_unhealthy_record_leaves_a_satellite_out_of_the_day_and_names_it(tmp_path: Path) -> None:
    n = records("G05")
    assert n > 1
    whole = gnss.constellation(BROADCAST)
    assert ("G05" in whole.satellite, whole.notes) == (True, ())
    for which, words in (({n - 1}, f"G05 (1 of {n} records)"), ({0}, f"G05 (1 of {n} records)"), (set(range(n)), "G05.")):
        path = changed(tmp_path, "G05", which)
        left = gnss.constellation(path)
        assert set(whole.satellite) - set(left.satellite) == {"G05"}
        assert len(left.notes) == 1
        assert words in left.notes[0]
        kept = gnss.constellation(path, unhealthy=True)
        assert (set(kept.satellite), kept.notes) == (set(whole.satellite), ())


@pytest.mark.parametrize(("which", "healthy"), [(0, False), (1, True)])
def test_the_nearest_record_says_whether_a_satellite_is_healthy(tmp_path: Path, which: int, healthy: bool) -> None:
    table = gnss.read_navigation(BROADCAST).records()
    first_ns = table.filter(table["satellite"] == "G05")["orbit_time_ns"].min()
    assert isinstance(first_ns, int)
    orbits = gnss.read_navigation(changed(tmp_path, "G05", {which})).orbits("gps", first_ns)
    assert ("G05" in orbits.satellite) == healthy
