"""An almanac is text without an end: what it lacks and what of it is not used stands in the result."""

from __future__ import annotations

import math
from pathlib import Path

from navbound import gnss, maps
from navbound.maps.sources import Times

BLOCK = """******** Week {week} almanac for PRN-{number:02d} ********
ID:                         {number:02d}
Health:                     {health:03d}
Eccentricity:               0.5E-002
Time of Applicability(s):  {time:.4f}
Orbital Inclination(rad):   0.96
Rate of Right Ascen(r/s):  -0.79E-008
SQRT(A)  (m 1/2):           5153.6
Right Ascen at Week(rad):   {node:.6f}
Argument of Perigee(rad):   0.45
Mean Anom(rad):             {anomaly:.6f}
Af0(s):                     0.1E-004
Af1(s/s):                   0.0
week:                        {week}

"""


def block(number: int, week: int = 866, health: int = 0, time: float = 589_824.0) -> str:
    angle = math.remainder(2.4 * number, math.tau)
    return BLOCK.format(number=number, week=week, health=health, time=time, node=angle, anomaly=math.remainder(3.0 * angle, math.tau))


def notes(file: Path, content: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    file.write_text(content)
    orbits = gnss.constellation(file)
    return orbits.satellite, orbits.notes


def test_a_cut_between_two_satellites_is_reported(tmp_path: Path) -> None:
    file = tmp_path / "yuma.alm"
    names, of_all = notes(file, "".join(block(n) for n in range(1, 33)))
    assert (len(names), of_all) == (32, ("yuma.alm: 32 satellites.",))
    names, of_cut = notes(file, "".join(block(n) for n in range(1, 29)))
    assert of_cut == ("yuma.alm: 28 satellites without G29, G30, G31, G32.",)
    names, of_half = notes(file, "".join(block(n) for n in range(1, 17)))
    assert len(names) == 16
    assert "16 satellites without G17" in of_half[0]
    assert "fewer than the 24 slots of GPS, so the file is cut or is not a whole almanac" in of_half[0]


def test_another_week_than_most_is_left_out_and_reported(tmp_path: Path) -> None:
    content = "".join(block(n, week=867 if n in {3, 20} else 866, health=63 if n == 5 else 0) for n in range(1, 33))
    names, of_mixed = notes(tmp_path / "yuma.alm", content)
    assert len(names) == 29
    assert not {"G03", "G05", "G20"} & set(names)
    assert of_mixed == (
        "yuma.alm: 32 satellites.",
        "yuma.alm: G05 is unhealthy and left out.",
        "yuma.alm: 2 satellites are of another week or time than most, by more than half a week, and left out: G03, G20.",
    )
    # A week's end between two times of one almanac is none.
    names, of_end = notes(
        tmp_path / "yuma.alm", "".join(block(n, *((866, 0, 602_112.0) if n % 2 else (867, 0, 4096.0))) for n in range(1, 33))
    )
    assert (len(names), of_end) == (32, ("yuma.alm: 32 satellites.",))


def test_a_map_and_a_joined_sky_say_it(tmp_path: Path) -> None:
    file = tmp_path / "yuma.alm"
    file.write_text("".join(block(n) for n in range(1, 21)))
    made = maps.make("dop", grid=maps.Grid.degrees(60.0), times=Times(None, 3600.0, 3600.0), constellation=(file,))
    assert any("20 satellites without" in words for words in made.summary.assumptions)
    orbits = gnss.constellation(file)
    assert (orbits + gnss.constellation("galileo")).notes == orbits.notes == orbits.without(["G01"]).notes


def test_healthy_almanacs_are_read_as_before(shared_data: Path) -> None:
    folder = shared_data / "gnss" / "almanacs"
    expected = {"20160331.alm": (31, "31 satellites without G04."), "yuma377.txt": (30, "30 satellites without G")}
    for name, (n, words) in expected.items():
        orbits = gnss.constellation(folder / name, unhealthy=True)
        assert len(orbits.satellite) == n
        assert len(orbits.notes) == 1
        assert words in orbits.notes[0]
        assert "cut" not in orbits.notes[0]
    assert not any("cut" in words or "another week" in words for words in gnss.constellation(folder / "current.al3").notes)
    # Nominal constellations are whole by definition.
    assert gnss.constellation("gps").notes == ()
