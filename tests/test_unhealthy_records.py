"""A satellite that a navigation file calls unhealthy serves no prediction, and is named."""

from __future__ import annotations

from pathlib import Path

import pytest

from navbound import gnss
from navbound.errors import InputError
from navbound.maps.sources import Times
from navbound.run.predict import Request, place, predict

BROADCAST = Path(__file__).parents[1] / "examples" / "data" / "broadcast.rnx"
STATED_LINE, ACCURACY, HEALTH = 6, slice(4, 23), slice(23, 42)
"""Of a record in RINEX 3: the line after the first six, its first and second field."""


def changed(folder: Path, name: str, which: set[int], *, field: slice = HEALTH, value: float | None = 63) -> Path:
    """The example file with one field of some records of a satellite, counted from 0, by default unhealthy; None leaves it blank."""
    lines = BROADCAST.read_text(encoding="ascii").splitlines()
    begins = [k for k, line in enumerate(lines) if line.startswith(f"{name} ")]
    for number in which:
        line = lines[begins[number] + STATED_LINE]
        written = " " * 19 if value is None else f"{value:19.12e}".replace("e", "D")
        lines[begins[number] + STATED_LINE] = line[: field.start] + written + line[field.stop :]
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


def test_satellites_whose_records_cannot_be_read_are_named(tmp_path: Path) -> None:
    n = records("G05")
    all_of_it, one = (gnss.constellation(changed(tmp_path, "G05", which, value=float("nan"))) for which in (set(range(n)), {0}))
    assert ("G05" in all_of_it.satellite, "G05" in one.satellite) == (False, True)
    assert all_of_it.notes[0].startswith(f"b.rnx: {n} records cannot be read (the first in line ")
    assert all_of_it.notes[0].endswith("; G05 left out, without any other.")
    assert one.notes[0].startswith("b.rnx: 1 record cannot be read (the first in line ")
    assert "left out" not in one.notes[0]


@pytest.mark.parametrize(("which", "healthy"), [(0, False), (1, True)])
def test_the_nearest_record_says_whether_a_satellite_is_healthy(tmp_path: Path, which: int, healthy: bool) -> None:
    table = gnss.read_navigation(BROADCAST).records()
    first_ns = table.filter(table["satellite"] == "G05")["orbit_time_ns"].min()
    assert isinstance(first_ns, int)
    orbits = gnss.read_navigation(changed(tmp_path, "G05", {which})).orbits("gps", first_ns)
    assert ("G05" in orbits.satellite) == healthy


@pytest.mark.parametrize(
    ("letter", "field", "value", "promised"),
    [
        ("E", HEALTH, 0b000_010_000, False),
        ("E", HEALTH, None, False),
        ("E", ACCURACY, None, False),
        ("G", HEALTH, None, False),
        ("G", HEALTH, 0.5, False),
        ("G", ACCURACY, None, False),
        ("E", HEALTH, 0b010_000_000, False),
        ("E", HEALTH, 0, True),
        ("E", ACCURACY, -1.0, False),
        ("G", ACCURACY, 8192.0, False),
        ("G", ACCURACY, 6144.0, False),
        ("G", ACCURACY, 4096.0, True),
    ],
)
def test_what_any_signal_or_the_accuracy_forbids_is_not_counted_on(
    tmp_path: Path, letter: str, field: slice, value: float | None, promised: bool
) -> None:
    name = next(s for s in gnss.constellation(BROADCAST).satellite if s.startswith(letter))
    orbits = gnss.constellation(changed(tmp_path, name, {0}, field=field, value=value))
    assert (name in orbits.satellite, any(name in note for note in orbits.notes)) == (promised, not promised)


def test_a_satellite_without_a_record_near_is_named(tmp_path: Path) -> None:
    text = BROADCAST.read_text(encoding="ascii")
    lines = text.splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith("G05 "))
    year, month, day = (int(word) for word in lines[at].split()[1:4])
    path = tmp_path / "b.rnx"
    path.write_text(text.replace(f"G05 {year} {month:02d} {day:02d}", f"G05 {year + 1} {month:02d} {day:02d}"), encoding="ascii")
    first_ns = int(gnss.read_navigation(BROADCAST).records()["orbit_time_ns"].min())  # type: ignore[arg-type]
    orbits = gnss.constellation(path, near_ns=first_ns)
    assert "G05" not in orbits.satellite
    assert any("more than a day" in note and "G05" in note for note in orbits.notes)


def test_a_receiver_whose_constellation_is_unhealthy_is_refused_with_the_reason(tmp_path: Path) -> None:
    text = BROADCAST.read_text(encoding="ascii").splitlines()
    for at, line in enumerate(text):
        if line.startswith("G"):
            stated = text[at + STATED_LINE]
            text[at + STATED_LINE] = stated[: HEALTH.start] + f"{63:19.12e}".replace("e", "D") + stated[HEALTH.stop :]
    path = tmp_path / "b.rnx"
    path.write_text("\n".join(text) + "\n", encoding="ascii")
    with pytest.raises(InputError, match="G05"):
        predict(Request([path], Times(step_s=3600.0), systems="G"), [place("0,0")])
