"""`navbound predict`: holes of detection and exclusion at a place and on a route, and what is refused."""

from __future__ import annotations

import json
import math
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from navbound import gnss, kpi, raim
from navbound.errors import InputError
from navbound.maps.sources import Times
from navbound.run.predict import Request, place, predict, route
from navbound.time import gps_ns

if TYPE_CHECKING:
    from collections.abc import Callable

    from conftest import Ended

USAGE, UNREADABLE = 2, 3


EIGHT_HOURS = Times(None, 8 * 3600.0, 300.0)


def test_holes_are_where_the_levels_are_outside_the_limit() -> None:
    """Counted again from the levels; six satellites out of service so that there are holes."""
    gone = ("G01", "G05", "G09", "G13", "G17", "G21")
    result = predict(Request(["gps"], EIGHT_HOURS, ("RNP 0.1",), gone), [place("55.5,8.45,60"), place("10,10")])
    orbits = gnss.constellation("gps").without(gone)
    for line in result.lines:
        here = next(p for p in result.places if p.name == line.place)
        levels = raim.predict(orbits, here.lat_rad[0], here.lon_rad[0], here.h_m[0], EIGHT_HOURS.offsets_s())
        for function, level in (("detection", levels.hpl_m), ("exclusion", levels.hel_m)):
            outside = ~(level <= 0.1 * 1852.0)
            holes = [h for h in result.holes if h.place == line.place and h.function == function]
            assert sum(h.end_s - h.start_s for h in holes) == 300.0 * outside.sum()
            inside = [(h.start_s, h.end_s) for h in holes]
            assert all(any(a <= t < b for a, b in inside) == out for t, out in zip(EIGHT_HOURS.offsets_s(), outside, strict=True))
        assert line.p_exclusion == float((levels.hel_m <= 0.1 * 1852.0).mean())
        assert line.p_exclusion is not None
        assert line.p_detection >= line.p_exclusion
    assert any(line.n_holes_exclusion for line in result.lines)
    assert result.satellites == list(orbits.satellite)
    assert any("inferred" in words for words in result.assumptions)
    assert result.limits[0].provenance == "inferred"


def test_a_satellite_out_of_service_never_helps() -> None:
    request = Request(["gps"], EIGHT_HOURS, ("NPA",))
    whole = predict(request, [place("55.5,8.45")]).lines[0]
    less = predict(Request(["gps"], EIGHT_HOURS, ("NPA",), ("G01", "G02", "G03", "G04", "G05")), [place("55.5,8.45")]).lines[0]
    assert less.p_exclusion is not None
    assert whole.p_exclusion is not None
    assert less.p_exclusion < whole.p_exclusion
    assert less.p_detection <= whole.p_detection


def test_satellites_are_left_out_by_name_and_only_those_that_are_there() -> None:
    orbits = gnss.constellation("gps")
    less = orbits.without(["G03", "G07"])
    assert less.satellite == tuple(s for s in orbits.satellite if s not in {"G03", "G07"})
    kept = [i for i, s in enumerate(orbits.satellite) if s in less.satellite]
    assert np.array_equal(less.elements(), orbits.elements()[kept])
    assert orbits.without([]).satellite == orbits.satellite
    with pytest.raises(InputError, match="E01"):
        orbits.without(["G03", "E01"])


def test_limits_are_rnp_values_or_service_levels() -> None:
    assert (kpi.level("RNP 0.3").hal_m, kpi.level("rnp 2").hal_m) == (0.3 * 1852.0, 2 * 1852.0)
    assert set(kpi.level("RNP 0.3").provenance.values()) == {"inferred"}
    for wrong in ("RNP", "RNP -1", "RNP 0", "RNP nan", "RNP AR"):
        with pytest.raises(InputError):
            kpi.level(wrong)


def test_a_route_fails_where_one_of_its_points_fails(tmp_path: Path) -> None:
    file = tmp_path / "north.csv"
    file.write_text("name,lat_deg,lon_deg\nA,40,10\nB,60,10\n", encoding="utf-8")
    along = route(file)
    assert len(along.lat_rad) >= 40  # 1200 NM by at most 30
    gone = ("G01", "G05", "G09", "G13")
    request = Request(["gps"], EIGHT_HOURS, ("RNP 0.1",), gone)
    whole = predict(request, [along]).lines[0]
    orbits = gnss.constellation("gps").without(gone)
    levels = raim.predict(orbits, along.lat_rad, along.lon_rad, 0.0, EIGHT_HOURS.offsets_s())
    assert whole.p_exclusion == float((levels.hel_m <= 185.2).all(axis=-1).mean())


def test_places_are_coordinates_or_runways() -> None:
    here = place("48.5,-2.25,120")
    assert (here.lat_rad, here.lon_rad, here.h_m) == ([math.radians(48.5)], [math.radians(-2.25)], [120.0])
    assert abs(place("LFPG/08R").lat_rad[0] - math.radians(49.0)) < 0.01
    for wrong in ("91,0", "0,181", "1", "1,2,3,4", "here", "nan,0", "0,0,inf", "LFPG/99X", "XXXX/01"):
        with pytest.raises(InputError) as refusal:
            place(wrong)
        assert refusal.value.argument == "at"


def test_an_almanac_serves_its_own_week(shared_data: Path) -> None:
    file, day_ns = shared_data / "gnss" / "almanacs" / "20160331.alm", 86_400_000_000_000
    start_ns = gps_ns(datetime(2016, 4, 1, tzinfo=UTC))
    request = Request([file], Times(start_ns, 3600.0, 300.0), ("NPA",), ("G05",))
    prediction = predict(request, [place("50,8")])
    assert prediction.times.start_utc == "2016-04-01 00:00:00"
    assert "G05" not in prediction.satellites
    assert len(prediction.satellites) > 25
    with pytest.raises(InputError, match=r"date = 2016-04-21 00:00:00 UTC.*within a week of the almanac, which is of 2016-04-02 19:50:07"):
        predict(Request([file], Times(start_ns + 20 * day_ns, 3600.0, 300.0)), [place("50,8")])


def test_the_command_prints_a_table_and_json_and_refuses_in_a_sentence(shared_data: Path, navbound: Callable[..., Ended]) -> None:
    navigation = shared_data / "gnss" / "ESBC_2020_177" / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz"
    common = ("predict", "raim", navigation, "--at", "55.5,8.45", "--hours", "2", "--every-s", "300")
    shown = navbound(*common, "--date", "2020-06-25T06:00", "--spec", "RNP 0.3", "--spec", "NPA")
    assert shown.status == 0, shown.stderr
    for words in ("RNP 0.3", "NPA", "2020-06-25 06:00:00 UTC", "inferred", "exclusion"):
        assert words in shown.stdout
    data = json.loads(navbound(*common, "--date", "2020-06-25T06:00", "--without", "G05", "--json").stdout)
    assert data["without"] == ["G05"]
    assert "G05" not in data["satellites"]
    assert data["times"]["n"] == 24
    # RAIM receivers use GPS; more only where it is requested.
    assert {name[0] for name in data["satellites"]} == {"G"}
    more = json.loads(navbound(*common, "--date", "2020-06-25T06:00", "--systems", "GE", "--json").stdout)
    assert {name[0] for name in more["satellites"]} == {"G", "E"}
    absent = navbound("predict", "raim", "gps", "--at", "0,0", "--hours", "1", "--systems", "GC")
    assert "BeiDou is among the constellations of the receiver, and no satellite of it is in the orbits." in " ".join(absent.stdout.split())
    assert np.isclose(data["limits"][0]["hal_m"], 0.3 * 1852.0)
    refusals: list[tuple[tuple[str | Path, ...], int, str]] = [
        (("predict", "waas", "gps", "--at", "0,0"), USAGE, "raim"),
        (("predict", "raim", "gps"), USAGE, "at"),
        (("predict", "raim", "gps", "--at", "0,0", "--date", "2026-11-22"), USAGE, "nominal orbits"),
        (("predict", "raim", "gps", "--at", "0,0", "--without", "G77"), USAGE, "G77"),
        (("predict", "raim", "gps", "--at", "0,0", "--spec", "RNP x"), USAGE, "RNP"),
        (("predict", "raim", "gps", "--at", "0,0", "--spec", "LPV-9"), USAGE, "LPV-200"),
        (("predict", "raim", "gps", "--at", "0,0", "--every-s", "0"), USAGE, "step_s"),
        (("predict", "raim", "gps", "--at", "0,0", "--date", "tomorrow"), USAGE, "date"),
        (("predict", "raim", "gps", "--at", "0,0", "--mask-deg", "95"), USAGE, "mask_rad"),
        (("predict", "raim", "gps", "--at", "0,0", "--systems", "X"), USAGE, "systems"),
        (("predict", "raim", "gps", "--at", "0,0", "--systems", "E"), USAGE, "systems"),
        (("predict", "raim", "gps", "--at", "0,0", "--at", "0,0"), USAGE, "once"),
        (("predict", "raim", "gps", "--at", "XXXX/08R"), USAGE, "--at = XXXX/08R: no airport of that name"),
        (("predict", "raim", "gps", "--at", "LFPG/99"), USAGE, "--at = LFPG/99: no runway of LFPG of that name; there are 08H"),
        (("predict", "raim", "no-such.al3", "--at", "0,0"), USAGE, "almanac"),
        (("predict", "raim", __file__, "--at", "0,0"), UNREADABLE, "almanac"),
        ((*common, "--date", "2020-08-25"), USAGE, "day"),
    ]
    for arguments, status, named in refusals:
        refused = navbound(*arguments)
        assert refused.status == status, (arguments, refused.stdout, refused.stderr)
        assert named in refused.stderr, (arguments, refused.stderr)
        assert "Traceback" not in refused.stderr


@pytest.mark.parametrize("date", ["0001-01-01", "2300-01-01", "9999-12-31"])
def test_a_date_that_no_time_holds_is_refused(navbound: Callable[..., Ended], date: str) -> None:
    ended = navbound("predict", "raim", "gps", "--at", "LFPG/08R", "--hours", "1", "--date", date)
    assert (ended.status, "an instant of the years 1680 to 2259" in ended.stderr) == (USAGE, True)
