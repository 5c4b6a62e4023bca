"""Tables with a path or a truth that are read and judged in pieces: what the whole gives at once, to the last bit."""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import navbound
from navbound import NavboundError
from navbound.read.runways import runway
from navbound.report import payload
from navbound.run.directory import Run

START_S = 1_483_300_000
RADIUS_M = 6.371e6


def place(lat_deg: float, lon_deg: float, north_m: float, east_m: float) -> tuple[float, float]:
    """A flat map is near enough for made-up tracks."""
    east_rad = east_m / (RADIUS_M * math.cos(math.radians(lat_deg)))
    return lat_deg + math.degrees(north_m / RADIUS_M), lon_deg + math.degrees(east_rad)


def text(rows: list[dict[str, Any]]) -> str:
    names = list(dict.fromkeys(name for row in rows for name in row))
    return "\n".join([",".join(names), *(",".join(str(row.get(name, "")) for name in names) for row in rows)]) + "\n"


def flown(track: str, to: str, seed: int, begin_s: int) -> list[dict[str, Any]]:
    """Twelve miles to a threshold at 70 m/s, a row in four seconds, with slow errors of some ten metres; some rows are missing."""
    rng, end = random.Random(seed), runway(to)
    course, cross, rows = end.course_rad, 0.0, list[dict[str, Any]]()
    for k in range(80):
        before = 22_000.0 - 280.0 * k
        cross = 0.9 * cross + rng.gauss(0.0, 8.0)
        north = -before * math.cos(course) - cross * math.sin(course)
        east = -before * math.sin(course) + cross * math.cos(course)
        at = math.degrees(end.lat_rad), math.degrees(end.lon_rad)
        lat, lon = place(*at, north, east)
        error = rng.gauss(0.0, 3.0), rng.gauss(0.0, 3.0)
        true = place(lat, lon, *error)
        row = {"timestamp": begin_s + 4 * k, "icao24": track, "callsign": f"AFR{seed}", "latitude": f"{lat:.8f}", "longitude": f"{lon:.8f}"}
        row |= {
            "geoaltitude": f"{before * 0.0524 + 100:.1f}",
            "groundspeed": 136.1,
            "track": f"{math.degrees(course) % 360:.2f}",
            "vertrate": -3.6,
        }
        row |= {"sde": 3.0 + k % 3, "sdn": 3.0, "truth_lat": f"{true[0]:.8f}", "truth_lon": f"{true[1]:.8f}"}
        if k % 29 != 7:
            rows.append(row)
    return rows


LANDED = (("b2", "LFPG/08R", 1), ("a1", "LFPG/09L", 2), ("c3", "LFPG/08R", 3), ("a1", "LFPG/08R", 4))


def landings() -> list[dict[str, Any]]:
    rows = [row for n, (track, to, seed) in enumerate(LANDED) for row in flown(track, to, seed, START_S + 900 * n)]
    rows[30] |= {"latitude": "x"}
    rows[40] |= {"truth_lat": "", "truth_lon": ""}
    # A truth that jumps for a while is none there.
    for row in rows[100:104]:
        row |= {"truth_lat": 55.0}
    return rows


def without(rows: list[dict[str, Any]], *names: str) -> list[dict[str, Any]]:
    return [{name: value for name, value in row.items() if name not in names} for row in rows]


def truth_of(rows: list[dict[str, Any]], *, tracks: bool) -> list[dict[str, Any]]:
    """A recording of the truth, a fifth of a second late and with a sigma of its own; of one vehicle alone without names."""
    kept = ("timestamp", "icao24") if tracks else ("timestamp",)
    true = [{name: row[name] for name in kept} | {"latitude": row["truth_lat"], "longitude": row["truth_lon"]} for row in rows]
    return [
        row | {"timestamp": f"{row['timestamp'] + 0.2:.1f}", "sde": 9.0 if k % 50 == 3 else 0.1, "sdn": 0.1} for k, row in enumerate(true)
    ]


def contradicted(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Three instants have two places: most pieces know no such row."""
    return [each for k, row in enumerate(rows) for each in ([row, row | {"latitude": 47.0}] if k in {17, 120, 121} else [row])]


ROUTE = "name,lat_deg,lon_deg\n" + "\n".join(
    f"{name},{lat:.6f},{lon:.6f}"
    for name, (lat, lon) in zip("AB", [place(48.9958, 2.5529, -200.0, -21_000.0), place(48.9958, 2.5529, 200.0, 3_000.0)], strict=True)
)


def cases(folder: Path) -> dict[str, tuple[Path, dict[str, Any]]]:
    """Tables, and what they are compared with."""
    rows = landings()
    plain = without(rows, "truth_lat", "truth_lon")
    one = [row for row in rows if row["icao24"] == "b2"]
    files = {
        "plain": text(plain),
        "own": text(rows),
        "truth": text(truth_of(rows, tracks=True)),
        "one": text(without(one, "truth_lat", "truth_lon")),
        "true": text(truth_of(one, tracks=False)),
        "two": text(contradicted(plain)),
        "twice": text(contradicted(truth_of(rows, tracks=True))),
        "still": text(
            [row | {"latitude": f"{48.0 + 1e-6 * (k % 7):.7f}", "longitude": 2.5, "groundspeed": 0.0} for k, row in enumerate(plain[:60])]
        ),
        "route": ROUTE,
    }
    for name, content in files.items():
        (folder / f"{name}.csv").write_text(content)
    at = {name: folder / f"{name}.csv" for name in files}
    return {
        "approaches": (at["plain"], {"path": "LFPG/08R,LFPG/09L"}),
        "any": (at["plain"], {"path": "auto"}),
        "route": (at["plain"], {"path": at["route"]}),
        "own truth on approaches": (at["own"], {"path": "LFPG/08R,LFPG/09L"}),
        "own truth": (at["own"], {}),
        "truth of each": (at["plain"], {"truth": at["truth"], "truth_tolerance_s": 0.3}),
        "positions that contradict each other": (at["two"], {"truth": at["truth"], "truth_tolerance_s": 0.3}),
        "truth that contradicts itself": (at["plain"], {"truth": at["twice"], "truth_tolerance_s": 0.3}),
        "truth on a route": (at["plain"], {"truth": at["truth"], "truth_tolerance_s": 0.3, "path": at["route"]}),
        "truth of all": (at["one"], {"truth": at["true"], "truth_tolerance_s": 0.3}),
        "fixed": (at["still"], {"truth": "4269200.0,186400.0,4716900.0"}),
    }


CASES = (
    "approaches",
    "any",
    "route",
    "own truth on approaches",
    "own truth",
    "truth of each",
    "positions that contradict each other",
    "truth that contradicts itself",
    "truth on a route",
    "truth of all",
    "fixed",
)


def page(run: Run) -> payload.Page:
    return payload.build(run.summary, run.record, run.table, run.events, run.waypoints)


@pytest.mark.parametrize("case", CASES)
def test_pieces_give_the_bits_of_the_whole(tmp_path: Path, case: str) -> None:
    file, more = cases(tmp_path)[case]
    whole = navbound.analyze(file, **more)
    assert isinstance(whole.table, pl.DataFrame)
    # Shorter than a track, so that every track is cut.
    run = navbound.analyze(file, piece_rows=50, **more)
    assert not isinstance(run.table, pl.DataFrame), "it must have been read in pieces"
    assert run.summary.model_dump_json() == whole.summary.model_dump_json()
    assert run.epochs.equals(whole.epochs)
    assert run.epochs.schema == whole.epochs.schema
    assert run.events.equals(whole.events)
    assert run.record.settings == whole.record.settings
    assert run.record.inputs == whole.record.inputs
    one, other = page(whole), page(run)
    assert one.tracks == other.tracks
    assert one.data | {"record": None} == other.data | {"record": None}


def test_the_tables_have_what_they_are_to_show(tmp_path: Path) -> None:
    """Otherwise their pieces would agree on nothing."""
    # At once: pieces state the same, which is the test above.
    runs = {case: navbound.analyze(file, **more) for case, (file, more) in cases(tmp_path).items()}
    assert [t.track for t in runs["approaches"].summary.tracks] == ["a1 LFPG/08R", "a1 LFPG/09L", "b2 LFPG/08R", "c3 LFPG/08R"]
    assert runs["approaches"].summary.groups
    assert runs["approaches"].summary.bands
    assert runs["any"].summary.cross_track
    assert any("beyond the end of the route" in r.reason for r in runs["route"].summary.rejected)
    for case in ("own truth", "truth of each"):
        honesty = runs[case].summary.honesty
        assert honesty is not None
        assert honesty.n > 200
        assert runs[case].summary.verdict.n_truth_doubted > 0
        assert runs[case].summary.verdict.belief is not None
    assert "own standard deviation" in runs["truth of each"].summary.verdict.truth_doubts
    assert runs["truth of all"].summary.verdict.n_truth > 50
    assert runs["fixed"].summary.verdict.truth_known


def refused(file: Path, **more: Any) -> str:
    with pytest.raises(NavboundError) as error:
        navbound.analyze(file, **more)
    return str(error.value)


def test_refusals_of_path_and_truth_are_those_of_the_whole(tmp_path: Path) -> None:
    made = cases(tmp_path)
    file, truth = made["approaches"][0], made["truth of each"][1]["truth"]
    far = tmp_path / "far.csv"
    far.write_text("name,lat_deg,lon_deg\nA,10,10\nB,10,11\n")
    for more in ({"path": "EDDF/07R"}, {"path": far}, {"truth": truth}, {"truth": truth, "truth_tolerance_s": -1.0}, {"path": "XXXX/99"}):
        assert refused(file, piece_rows=50, **more) == refused(file, **more), more


def test_a_large_table_with_a_truth_is_read_in_pieces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, more = cases(tmp_path)["truth of each"]
    monkeypatch.setattr("navbound.run.pieces.material.LARGE_BYTES", 1000)
    assert not isinstance(navbound.analyze(file, **more).table, pl.DataFrame)
