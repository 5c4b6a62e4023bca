"""Plans that name published procedures: the path is the published one, every leg has its own RNP, and what is not published is said."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest

from navbound import path, procedures
from navbound.errors import FormatError
from navbound.run.expected.flight import predict_flight
from navbound.run.expected.page import sections
from navbound.run.expected.way import JOIN, Way, way
from navbound.scenario.plan import PlannedProcedure
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from pathlib import Path

ROUTE = "name,lat_deg,lon_deg\nKSAT,29.5337,-98.4698\nMARCS,29.90,-98.05\n"
REQUIREMENTS = '[[requirements]]\nname = "en route"\nrnp_nm = 2.0\n'
HEAD = 'flight = "beijing-shanghai"\nduration_min = 24\nstations = []\n'
HEAD += "departure_height_ft = 809\narrival_height_ft = 480\ncruise_height_ft = 15000\n"


def approach(folder: Path, name: str = "KAUS/H18LZ:TRPPN", line: str | None = "RNP 0.3") -> str:
    text = f'[[procedures]]\ndatabase = "{folder / "procedures" / (name[:4] + ".txt")}"\nname = "{name}"\n'
    return text + ("" if line is None else f'line = "{line}"\n')


def predicted(folder: Path, text: str, route: str = ROUTE) -> Path:
    (folder / "route.csv").write_text(route, encoding="utf-8")
    file = folder / "plan.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_an_approach_is_flown_leg_by_leg_under_its_own_rnp(tmp_path: Path, shared_data: Path) -> None:
    result = predict_flight(predicted(tmp_path, HEAD + 'route = "route.csv"\n' + approach(shared_data) + REQUIREMENTS), with_hold=False)
    own = procedures.read(shared_data / "procedures" / "KAUS.txt").procedure("KAUS", "H18LZ", "TRPPN", line="RNP 0.3")
    published = {leg.fix: leg.rnp_m for leg in own.legs if leg.has_path}
    legs = result.record.legs
    assert {leg.leg.partition("-")[2]: leg.rnp_m for leg in legs if leg.phase not in {"en route", JOIN}} == published
    # Every second after the first fix is on the published path: the geometry of the procedure itself says so, arcs included.
    flown = result.seconds.filter(~pl.col("phase").is_in(["en route", JOIN]))
    feet = own.nearest(flown["lat_rad"].to_numpy(), flown["lon_rad"].to_numpy())
    turning = np.array([own.legs[k].radius_m is not None for k in feet.leg])
    assert turning.sum() > 100
    # An arc is LOOSE narrower than published, 5 mm of 5 km; the first fix is flown by with a turn of 47 degrees.
    assert np.abs(feet.cross_m[turning]).max() < 0.1
    assert np.abs(feet.cross_m[(flown["leg"] != "TRPPN-RUBZZ").to_numpy()]).max() < 1.0


def test_the_leg_to_a_procedure_has_no_rnp_and_is_not_judged(tmp_path: Path, shared_data: Path) -> None:
    plan = predicted(tmp_path, HEAD + 'route = "route.csv"\n' + approach(shared_data) + REQUIREMENTS)
    result = predict_flight(plan, with_hold=False)
    (join,) = [leg for leg in result.record.legs if leg.phase == JOIN]
    assert (join.leg, join.status) == ("MARCS-TRPPN", "no_rnp")
    compared = ("rnp_m", "hal_m", "p_anp_within", "p_tse_within", "p_level", "n_holes", "longest_hole_s", "first_without_s", "risk_2rnp")
    assert {getattr(join, name) for name in compared} == {None}
    seconds = result.seconds.filter(pl.col("phase") == JOIN)
    assert not seconds["rnp_m"].is_finite().any()
    assert not seconds["p_exceed_2rnp"].is_finite().any()
    # What needs no RNP is there.
    assert join.anp_max_m == seconds["anp_circle_m"].max()
    first = result.record.words[0]
    assert "kept on all 8 legs that have one" in first
    assert "1 of 9 legs have no RNP: nothing is said of them" in first
    assert any("21.27 NM from MARCS" in sentence for sentence in result.record.assumptions)
    assert any("NO RNP" in row for _, rows in sections(result.record) for row in rows)


def test_legs_without_a_coded_rnp_are_counted_with_the_one_that_joins(tmp_path: Path, shared_data: Path) -> None:
    plan = predicted(tmp_path, HEAD + 'route = "route.csv"\n' + approach(shared_data, line=None) + REQUIREMENTS)
    result = predict_flight(plan, with_hold=False)
    coded = procedures.read(shared_data / "procedures" / "KAUS.txt").procedure("KAUS", "H18LZ", "TRPPN")
    n_unknown = sum(1 for leg in coded.legs if leg.has_path and not np.isfinite(leg.rnp_m))
    assert sum(leg.status == "no_rnp" for leg in result.record.legs) == n_unknown + 1


def tried(database: Path, name: str) -> Way | str:
    """The path of a procedure, or why there is none."""
    try:
        return way("plan.toml", database.parent, [PlannedProcedure(database=str(database), name=name)], [], None)
    except FormatError as refusal:
        return str(refusal)


@pytest.mark.parametrize("airport", ["KAPF", "KAUS", "KBLV", "KDEN", "KDTW", "KMSP"])
def test_every_published_approach_gives_its_own_path_or_the_leg_that_has_none(airport: str, shared_data: Path) -> None:
    file = shared_data / "procedures" / f"{airport}.txt"
    base = procedures.read(file)
    n_flown = n_refused = 0
    for entry in base.entries:
        for transition in sorted({route.transition for route in entry.routes} - {""}) or [""]:
            name = f"{airport}/{entry.ident}" + (f":{transition}" if transition else "")
            flown = tried(file, name)
            if isinstance(flown, str):
                n_refused += 1
                # The leg with its number and the reason, or what the database itself says of the procedure.
                assert "procedures[0]" in flown
                continue
            n_flown += 1
            lat, lon = (np.array([point[name] for point in flown.waypoints]) for name in ("lat_rad", "lon_rad"))
            radius = np.array([point["radius_m"] or 0.0 for point in flown.waypoints])
            line = path.route(lat, lon, radius)
            own = base.procedure(airport, entry.ident, transition or None)
            joined = [k for k, (phase, _) in enumerate(flown.requirements) if phase == JOIN]
            if joined:
                continue
            along = np.linspace(0.0, line.length_m, 400)
            places = line.at(along)
            assert np.abs(own.nearest(places.lat_rad, places.lon_rad).cross_m).max() < 0.5, name
            assert line.length_m == pytest.approx(
                sum(leg.length_m for leg in own.legs if leg.has_path and leg.state != "holding"), rel=1e-5
            )
    # Approaches of RNP are whole in the file; most departures begin with a heading, which is no path.
    assert n_flown >= 3
    assert n_flown + n_refused >= 8


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('route = "route.csv"\n{approach}', "requirements: is missing"),
        ("{approach}{requirements}", "requirements: are for a route"),
        ('route = "route.csv"\n{approach}[[requirements]]\nname = "a"\nrnp_nm = 60000\n', "is outside (0, 37040], 20 NM"),
        ('{approach}[[procedures]]\ndatabase = "{folder}/procedures/KDEN.txt"\nname = "KDEN/BAYLR6:RW08"\n', "procedures[1]"),
        ('[[procedures]]\ndatabase = "{folder}/procedures/KAUS.txt"\nname = "KAUS/NOSUCH"\n', "NOSUCH"),
        ('[[procedures]]\ndatabase = "{folder}/procedures/KAUS.txt"\nname = "nonsense"\n', "AIRPORT/PROCEDURE"),
        ('[[procedures]]\ndatabase = "no-such.txt"\nname = "KAUS/H18LZ"\n', "no-such.txt"),
        (
            '[[procedures]]\ndatabase = "x"\nname = "KAUS/H18LZ"\nruns = 1\n',
            "is not a key of a plan; there are database, name, line, defaults",
        ),
        (
            'route = "route.csv"\n{approach}[[requirements]]\nname = "a"\nrnp_nm = 2\nuntil_waypoint = "NOWHERE"\n',
            "'NOWHERE' is not a waypoint",
        ),
        (
            'route = "route.csv"\n{approach}[[requirements]]\nname = "a"\nrnp_nm = 2\nuntil_before_end_nm = 5\n',
            "beside procedures name a waypoint",
        ),
    ],
)
def test_what_of_a_plan_with_procedures_is_refused(text: str, says: str, tmp_path: Path, shared_data: Path) -> None:
    filled = text.format(approach=approach(shared_data), requirements=REQUIREMENTS, folder=shared_data)
    with pytest.raises(FormatError) as refusal:
        predict_flight(predicted(tmp_path, HEAD + filled), with_hold=False)
    assert says in str(refusal.value)


def test_a_turn_that_does_not_fit_is_named(tmp_path: Path, shared_data: Path) -> None:
    """From the north the transition TRPPN begins with a turn of 160 degrees."""
    route = "name,lat_deg,lon_deg\nKDFW,32.8968,-97.0380\nHOARY,31.6,-97.3\n"
    plan = predicted(tmp_path, HEAD.replace("24", "45") + 'route = "route.csv"\n' + approach(shared_data) + REQUIREMENTS, route)
    with pytest.raises(FormatError, match="the turn at RUBZZ"):
        predict_flight(plan, with_hold=False)


def test_legs_of_another_rnp_are_other_legs(tmp_path: Path, shared_data: Path) -> None:
    """A route of two requirements, the second from its waypoint on."""
    text = HEAD + 'route = "route.csv"\n' + approach(shared_data)
    text += '[[requirements]]\nname = "terminal"\nrnp_nm = 1\nuntil_waypoint = "KBAZ"\n[[requirements]]\nname = "en route"\nrnp_nm = 2\n'
    route = ROUTE.replace("MARCS", "KBAZ,29.7,-98.28\nMARCS")
    result = predict_flight(predicted(tmp_path, text, route), with_hold=False)
    assert [(leg.leg, (leg.rnp_m or 0) / METRES_PER_NM) for leg in result.record.legs[:3]] == [
        ("KSAT-KBAZ", 1.0),
        ("KBAZ-MARCS", 2.0),
        ("MARCS-TRPPN", 0.0),
    ]
