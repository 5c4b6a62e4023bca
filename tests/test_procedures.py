"""Published procedures against reference records made by other code, and what must not be guessed."""

from __future__ import annotations

import gzip
import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from navbound import FormatError, InputError, _core, path, procedures
from navbound.procedures import Database, Flight, Procedure

SHARED = Path(__file__).parents[1].parent / "shared"
REFERENCE = SHARED / "reference" / "ref-procedures.json"
SAMPLE = Path(__file__).parent / "procedures" / "KDEN_H26-Z.txt"
NM = 1852.0
here = pytest.mark.skipif(not REFERENCE.exists(), reason=f"SKIPPED ALOUD: no reference at {REFERENCE}")


@cache
def reference() -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads(REFERENCE.read_text(encoding="utf-8"))
    return loaded


def cases(name: str) -> list[dict[str, Any]]:
    return reference()[name] if REFERENCE.exists() else []


@cache
def database(file: str) -> Database:
    """A file as the reference names it."""
    folder = {"dev/": SHARED / "data" / "procedures", "infra: ": SHARED / "data" / "infra" / "cifp_faa_2604"}
    prefix = next(p for p in folder if file.startswith(p))
    return procedures.read(folder[prefix] / file.removeprefix(prefix))


def route_legs(base: Database, airport: str, ident: str, route_type: str, transition: str) -> list[dict[str, Any]]:
    """Legs of one route alone, as the core has them."""
    for index, entry in enumerate(base.entries):
        if (entry.airport, entry.ident) == (airport, ident):
            routes = [k for k, r in enumerate(entry.routes) if (r.route_type, r.transition) == (route_type, transition)]
            return base._core.path(index, routes, True, None, False)[0]
    raise AssertionError((airport, ident))


@here
@pytest.mark.parametrize("case", cases("records"), ids=lambda c: c["line"][6:29].replace(" ", "_"))
def test_every_field_of_a_record_is_that_of_the_reference(case: dict[str, Any], tmp_path: Path) -> None:
    file = tmp_path / "one.txt"
    file.write_text(case["line"] + "\n", encoding="ascii")
    base = procedures.read(file)
    (route,) = base.entries[0].routes
    (leg,) = route_legs(base, base.entries[0].airport, base.entries[0].ident, route.route_type, route.transition)
    ours = {
        "seq": leg["sequence"],
        "fix": leg["fix"],
        "fix_region": leg["fix_region"],
        "fix_section": leg["fix_section"],
        "path_terminator": leg["terminator"],
        "turn": leg["turn"],
        "course_field": leg["course_field"],
        "distance_field": leg["distance_field"],
        "altitude_description": leg["altitude_description"],
        "altitude1": leg["altitude_fields"][0],
        "altitude2": leg["altitude_fields"][1],
        "transition_altitude": leg["transition_altitude"],
        "speed_kt": leg["speed_kt"],
        "speed_description": leg["speed_description"],
        "centre_fix": leg["centre_fix"],
        "description": leg["description"],
    }
    expected = dict(case["expect"])
    # Of these the file has two to four digits; the way through metres and radians costs the last of sixteen.
    scaled = {
        "rnp_nm": (leg["rnp_coded_m"], 1 / NM),
        "arc_radius_nm": (leg["radius_coded_m"], 1 / NM),
        "theta_deg": (leg["theta_rad"], 180 / math.pi),
        "rho_nm": (leg["rho_m"], 1 / NM),
        "vertical_angle_deg": (leg["vertical_angle_rad"], 180 / math.pi),
    }
    for name, (value, unit) in scaled.items():
        reference = expected.pop(name)
        assert (value is None) == (reference is None), name
        assert value is None or value * unit == pytest.approx(reference, rel=1e-12), name
    assert {k: v.rstrip() if isinstance(v, str) else v for k, v in expected.items()} == ours


@here
@pytest.mark.parametrize("case", cases("rf"), ids=lambda c: f"{c['airport']}-{c['procedure']}-{c['transition']}-{c['seq']}")
def test_an_arc_is_that_of_the_reference(case: dict[str, Any]) -> None:
    legs = route_legs(database(case["file"]), case["airport"], case["procedure"], case["route_type"], case["transition"])
    (leg,) = [x for x in legs if x["sequence"] == case["seq"]]
    tolerance = reference()["tolerances"]["rf"]
    # Where the centre moves by more than 5 m the reference itself is good to 2 cm.
    wide = case["centre_moved_m"] > 5
    ours = {
        "start_to_published_centre_m": leg["start_to_centre_m"],
        "end_to_published_centre_m": leg["end_to_centre_m"],
        "centre_moved_m": leg["centre_moved_m"],
        "radius_m": leg["radius_m"],
        "turn_deg": abs(math.degrees(leg["turn_rad"])),
        "length_m": leg["length_m"],
        "course_begin_deg": math.degrees(leg["course_begin_rad"]),
        "course_end_deg": math.degrees(leg["course_end_rad"]),
    }
    for name, value in ours.items():
        allowed = 0.02 if wide and name in {"radius_m", "length_m"} else tolerance[name]
        assert abs(value - case[name]) <= allowed, name
    assert (leg["turn_rad"] > 0) == (case["turn"] == "R")
    assert leg["rnp_coded_m"] == pytest.approx(case["rnp_nm"] * NM) if case["rnp_nm"] else leg["rnp_coded_m"] is None


def joined(case: dict[str, Any]) -> Procedure:
    return database(case["file"]).procedure(case["airport"], case["procedure"], case["transition"] or None)


@here
@pytest.mark.parametrize("case", cases("paths"), ids=lambda c: f"{c['airport']}-{c['procedure']}-{c['transition']}")
def test_positions_beside_a_procedure_are_those_of_the_reference(case: dict[str, Any]) -> None:
    procedure = joined(case)
    flown = [k for k, leg in enumerate(procedure.legs) if leg.has_path]
    assert [(procedure.legs[k].sequence, procedure.legs[k].fix, procedure.legs[k].terminator) for k in flown] == [
        (x["seq"], x["fix"], x["path_terminator"]) for x in case["legs"]
    ]
    assert [procedure.legs[k].length_m for k in flown] == pytest.approx([x["length_m"] for x in case["legs"]], abs=0.002)
    assert [procedure.legs[k].rnp_m / NM for k in flown] == pytest.approx([x["rnp_nm"] for x in case["legs"]])
    assert procedure.length_m == pytest.approx(case["total_m"], abs=0.01)
    points = case["points"]
    feet = procedure.nearest(np.radians([p["lat_deg"] for p in points]), np.radians([p["lon_deg"] for p in points]))
    assert feet.leg.tolist() == [flown[p["leg"]] for p in points]
    moved = np.array([(procedure.legs[k].centre_moved_m or 0.0) > 5 for k in feet.leg])
    assert (np.abs(feet.cross_m - [p["cross_m"] for p in points]) <= np.where(moved, 0.02, 0.002)).all()
    assert (np.abs(feet.along_m - [p["along_m"] for p in points]) <= 0.01).all()
    assert (np.abs(np.degrees(feet.course_rad) - [p["course_deg"] for p in points]) <= 1e-4).all()


def recorded(case: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    trace = json.loads(gzip.decompress((SHARED / "data" / case["track"]).read_bytes()))["trace"]
    first, last = case["time_window_s"]
    rows = np.array([row[:3] for row in trace if first <= row[0] <= last], dtype=np.float64)
    return rows[:, 0], np.radians(rows[:, 1]), np.radians(rows[:, 2])


@here
@pytest.mark.parametrize("case", cases("tracks"), ids=lambda c: f"{c['airport']}-{c['procedure']}")
def test_a_real_flight_is_that_of_the_reference(case: dict[str, Any]) -> None:
    procedure = joined(case)
    time, lat, lon = recorded(case)
    flight = procedures.judge(procedure, time, lat, lon)
    judged = flight.followed.status == "ok"
    points = case["points"]
    assert time[judged].tolist() == [p["time_s"] for p in points]
    assert np.abs(flight.followed.cross_m[judged] - [p["cross_m"] for p in points]).max() <= 0.002
    assert np.abs(flight.followed.along_m[judged] - [p["along_m"] for p in points]).max() <= 0.01
    by_fix = {leg.fix: leg for leg in flight.legs if leg.n}
    assert list(by_fix) == [x["fix"] for x in case["legs"]]
    for expected in case["legs"]:
        leg = by_fix[expected["fix"]]
        assert leg.n == leg.n_inside == leg.n_inside_twice == expected["n"]
        ours = (leg.mean_m, leg.rms_m, leg.max_abs_m)
        assert ours == pytest.approx([expected[k] for k in ("mean_m", "rms_m", "max_abs_m")], abs=0.01)
    assert flight.n_inside == flight.n == case["n"]


@here
def test_a_flight_shifted_by_700_m_is_outside_rnp_and_within_twice_rnp() -> None:
    case = next(c for c in cases("tracks") if c["airport"] == "KDEN")
    procedure = joined(case)
    time, lat, lon = recorded(case)
    # The approach is flown to the west: right is north, and 700 m of it are 700 m of a meridian (M = 6,361 km at 39.8 degrees; derived).
    flight = procedures.judge(procedure, time, lat + 700.0 / 6_361_000.0, lon)
    (last,) = [leg for leg in flight.legs if leg.fix == "RW26"]
    assert (last.n, last.n_inside, last.n_inside_twice) == (16, 0, 16)
    assert last.mean_m == pytest.approx(700, abs=2)
    assert flight.verdict == "not within RNP; within twice RNP"
    assert math.isnan(flight.most_exceeding)


@here
def test_one_approach_cannot_show_a_small_risk() -> None:
    case = next(c for c in cases("tracks") if c["airport"] == "KDEN")
    flight: Flight = procedures.judge(joined(case), *recorded(case))
    assert flight.n_effective <= flight.n
    # No exceedance in n independent epochs leaves 1 - 0.05^(1/n) open, about 3/n (derived).
    assert flight.most_exceeding == pytest.approx(1 - 0.05 ** (1 / flight.n_effective))
    assert flight.most_exceeding > 1e-2
    assert "cannot show 1e-5" in flight.words[-1]


CONTRADICTIONS = {
    "KDEN.txt": {("KDEN/H17LZ//30", "rnp_grows"), ("KDEN/H17LZ//30", "rnp_and_level")},
    "KAUS.txt": {("KAUS/H18RZ//30", "rnp_and_level"), ("KAUS/H18RZ/SMRFF/60", "course"), ("KAUS/H18RZ/XWING/50", "course")},
    "KAPF.txt": {("KAPF/H05-Z//30", "rnp_missing"), ("KAPF/H23-Z//30", "rnp_missing")},
    "KBLV.txt": {("KBLV/H32LZ/WITKR/30", "centre"), ("KBLV/H32LZ/WITKR/30", "radius")},
    "KDTW.txt": {("KDTW/H04LW/SKRUG/30", "radius")},
    "KMSP.txt": set(),
}
"""Slips of cycle 2604 as the survey of the national file lists them."""


@pytest.mark.parametrize("file", CONTRADICTIONS)
def test_the_contradictions_of_a_file_are_those_of_the_survey(shared_data: Path, file: str) -> None:
    text = (shared_data / "procedures" / file).read_text(encoding="ascii").splitlines()
    findings = [f for f in procedures.read(shared_data / "procedures" / file).contradictions() if not f.remark]
    assert {(f.where, f.kind) for f in findings} == CONTRADICTIONS[file]
    for f in findings:
        assert text[f.line - 1][6:10] == f.airport
        assert text[f.line - 1][13:19].strip() == f.procedure


def test_a_contradicted_level_is_judged_only_as_selected(shared_data: Path) -> None:
    base = procedures.read(shared_data / "procedures" / "KDEN.txt")
    unselected = base.procedure("KDEN", "H17LZ", "GOLFN").legs[-1]
    assert unselected.rnp_origin == "contradicted"
    assert unselected.rnp_coded_m == pytest.approx(3 * NM)
    assert math.isnan(unselected.rnp_m)
    selected = base.procedure("KDEN", "H17LZ", "GOLFN", line="RNP 0.3").legs[-1]
    assert (selected.rnp_origin, selected.rnp_differs) == ("selected", True)
    assert selected.rnp_m == pytest.approx(0.3 * NM)
    with pytest.raises(InputError, match=r"RNP 0\.1, RNP 0\.3, RNP 3"):
        base.procedure("KDEN", "H17LZ", "GOLFN", line="RNP 0.5")


def test_a_leg_without_rnp_takes_a_default_only_where_it_is_allowed(shared_data: Path) -> None:
    base = procedures.read(shared_data / "procedures" / "KAPF.txt")
    last = base.procedure("KAPF", "H05-Z", "COLER").legs[-1]
    assert (last.rnp_origin, math.isnan(last.rnp_m)) == ("not_coded", True)
    allowed = base.procedure("KAPF", "H05-Z", "COLER", defaults=True).legs[-1]
    assert allowed.rnp_origin == "default"
    assert allowed.rnp_m == pytest.approx(0.3 * NM)


def test_positions_on_a_leg_without_rnp_are_counted_and_not_judged(shared_data: Path) -> None:
    procedure = procedures.read(shared_data / "procedures" / "KAPF.txt").procedure("KAPF", "H05-Z", "COLER")
    place = procedure.core.at(len(procedure.legs) - 1, np.linspace(100.0, 3000.0, 30))
    flight = procedures.judge(procedure, np.arange(30.0), place["lat_rad"], place["lon_rad"])
    assert (flight.n, flight.n_without_rnp) == (0, 30)
    assert flight.verdict.startswith("not shown")


def test_a_name_that_is_not_there_is_refused_with_those_that_are() -> None:
    with pytest.raises(InputError, match=r"airport = KXXX.*KDEN"):
        path.procedure(SAMPLE, "KXXX", "H26-Z")
    with pytest.raises(InputError, match=r"procedure = H26-X.*H26-Z"):
        path.procedure(SAMPLE, "KDEN", "H26-X")
    with pytest.raises(InputError, match=r"transition = JIBAT.*CAPTJ, FUZZZ"):
        path.procedure(SAMPLE, "KDEN", "H26-Z", "JIBAT")
    with pytest.raises(InputError, match="line = RNP much"):
        path.procedure(SAMPLE, "KDEN", "H26-Z", "FUZZZ", line="RNP much")


def test_a_route_with_a_refused_line_is_refused_with_its_number(tmp_path: Path) -> None:
    lines = SAMPLE.read_text(encoding="ascii").splitlines()
    cut = next(k for k, line in enumerate(lines) if "JPBAGK2PC0E    010TF" in line)
    lines[cut] = lines[cut][:90]
    file = tmp_path / "cut.txt"
    file.write_text("\n".join(lines) + "\n", encoding="ascii")
    with pytest.raises(FormatError, match="not 132 characters long") as refusal:
        path.procedure(file, "KDEN", "H26-Z", "FUZZZ")
    assert refusal.value.line == cut + 1
    # The other transition is whole; the file's refused line is said all the same.
    other = path.procedure(file, "KDEN", "H26-Z", "CAPTJ")
    assert any("1 of" in note for note in other.notes)


def test_a_route_with_a_lost_line_is_refused_where_it_is_lost(tmp_path: Path) -> None:
    lines = SAMPLE.read_text(encoding="ascii").splitlines()
    lost = next(k for k, line in enumerate(lines) if "JPBAGK2PC0E    010TF" in line)
    del lines[lost]
    file = tmp_path / "lost.txt"
    file.write_text("\n".join(lines) + "\n", encoding="ascii")
    with pytest.raises(FormatError, match="1 record is missing by the record numbers") as refusal:
        path.procedure(file, "KDEN", "H26-Z", "FUZZZ")
    assert refusal.value.line == lost + 1
    assert [f.line for f in procedures.read(file).contradictions() if f.kind == "missing"] == [lost + 1]
    path.procedure(file, "KDEN", "H26-Z", "CAPTJ")


def test_no_published_file_lacks_a_line_by_its_record_numbers(shared_data: Path) -> None:
    files = [*(shared_data / "procedures").glob("*.txt"), *(shared_data / "infra" / "cifp_faa_2604").glob("K*.txt")]
    routes = [(entry.ident, route.gaps) for file in files for entry in procedures.read(file).entries for route in entry.routes]
    assert len(files) >= 9
    assert [each for each in routes if each[1]] == []


def test_a_fix_that_is_not_in_the_file_takes_its_leg_and_the_next(tmp_path: Path) -> None:
    text = SAMPLE.read_text(encoding="ascii")
    file = tmp_path / "less.txt"
    file.write_text("".join(line + "\n" for line in text.splitlines() if "PKDENK2CJPBAG" not in line.replace(" ", "", 1)), encoding="ascii")
    procedure = path.procedure(file, "KDEN", "H26-Z", "FUZZZ")
    assert [x.state for x in procedure.legs] == ["point", "no_fix", "no_start", "full"]
    assert math.isnan(procedure.length_m)
    assert any(f.kind == "unresolved" for f in procedures.read(file).contradictions())


def test_an_rnp_that_no_such_procedure_has_is_contradicted(tmp_path: Path) -> None:
    text = SAMPLE.read_text(encoding="ascii")
    damaged = tmp_path / "rnp.txt"
    damaged.write_text(text.replace("010RF", "990RF").replace("010TF", "051TF"), encoding="ascii")
    base = procedures.read(damaged)
    legs = base.procedure("KDEN", "H26-Z", "CAPTJ").legs
    of_arcs = [(one.rnp_origin, np.isnan(one.rnp_m)) for one in legs if one.terminator == "RF"]
    assert of_arcs
    assert set(of_arcs) == {("contradicted", True)}
    assert {one.rnp_m for one in legs if one.terminator == "TF" and one.part == "approach"} == {0.5 * 1852.0}
    findings = [one for one in base.contradictions() if one.kind == "rnp_too_large"]
    assert len(findings) >= len(of_arcs)
    assert all("99" in one.words and "5" in one.words for one in findings)
    assert not any(one.kind == "rnp_too_large" for one in procedures.read(SAMPLE).contradictions())


def test_a_fix_far_from_its_airport_belongs_to_no_approach(tmp_path: Path) -> None:
    text = SAMPLE.read_text(encoding="ascii")
    line = next(one for one in text.splitlines() if one[12:18] == "CBCALN")
    at = line.index("N39")
    damaged = tmp_path / "far.txt"
    damaged.write_text(text.replace(line, f"{line[:at]}N29{line[at + 3 :]}"), encoding="ascii")
    whole, legs = (procedures.read(file).procedure("KDEN", "H26-Z", "CAPTJ").legs for file in (SAMPLE, damaged))
    k = next(k for k, one in enumerate(whole) if one.fix == "BCALN")
    assert whole[k].state == "full"
    assert legs[k].state == "impossible"
    assert not legs[k].has_path


def test_a_missed_approach_with_an_open_end_loses_its_distances_and_keeps_its_legs() -> None:
    procedure = path.procedure(SAMPLE, "KDEN", "H26-Z", "FUZZZ", missed=True)
    assert [(x.terminator, x.state) for x in procedure.legs[4:]] == [("CA", "open_end"), ("DF", "no_start"), ("HM", "holding")]
    assert math.isinf(procedure.legs[4].length_m)
    assert math.isnan(procedure.legs[6].begin_m)


def test_the_words_of_the_core_have_sentences() -> None:
    states, _, kinds = _core.procedure_words()
    from navbound.procedures.findings import _WORDS  # noqa: PLC0415
    from navbound.procedures.legs import STATES  # noqa: PLC0415

    assert set(states) == set(STATES)
    assert set(kinds) == set(_WORDS)
