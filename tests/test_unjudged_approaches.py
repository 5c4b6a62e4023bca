"""An approach that strays before it is one is counted, said, and no part of "inside"; so are rows without a position at its end."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest

import navbound
from navbound.records.run import Verdict
from navbound.run.verdict import rule
from test_approach_ends import LANDS, flown, veering
from test_verdict import GOOD


def verdict(path: Path, tracks: dict[str, pl.DataFrame], piece_rows: int | None = None) -> Verdict:
    rows = [rows.with_columns(track=pl.lit(name)) for name, rows in tracks.items()]
    degrees = [pl.col(f"est_{axis}_rad").degrees().alias(f"{axis}_deg") for axis in ("lat", "lon")]
    table = pl.concat(rows).select(
        "time_ns",
        "altitude_m",
        *degrees,
        icao24="track",
        vertical_rate_mps="vertical_rate_mps",
        sigma_e_m=pl.lit(3.0),
        sigma_n_m=pl.lit(3.0),
    )
    table.rename({"lat_deg": "latitude", "lon_deg": "longitude", "altitude_m": "alt_m"}).write_csv(path)
    return navbound.analyze(path, path="LSZH/14", spec="RNP AR 0.1", piece_rows=piece_rows).summary.verdict


STRAYS = flown(veering(6000.0, 60.0))
"""Off by 150 m at 5.85 km before the threshold: no point inside the gates after that."""


@pytest.mark.parametrize("piece_rows", [None, 100])
def test_an_approach_that_strays_early_is_counted_and_not_inside(tmp_path: Path, piece_rows: int | None) -> None:
    lands = verdict(tmp_path / "a.csv", {"a": flown(LANDS)}, piece_rows)
    assert (lands.id, lands.n_approaches, lands.n_unjudged_approaches) == ("inside", 1, 0)
    strays = verdict(tmp_path / "b.csv", {"a": flown(LANDS), "b": STRAYS}, piece_rows)
    assert (strays.id, strays.n_approaches, strays.n_unjudged_approaches) == ("not_shown", 1, 1)
    first = strays.words.split(". ")[0]
    assert "1 of 2 approaches is not judged" in first
    assert "At least 95 % of the approaches must be judged." in strays.words


@pytest.mark.parametrize(("n", "n_unjudged", "expected"), [(5, 0, "inside"), (19, 1, "inside"), (18, 1, "not_shown"), (0, 1, "not_shown")])
def test_the_share_of_approaches_is_that_of_epochs(n: int, n_unjudged: int, expected: str) -> None:
    facts = rule.TrackFacts(**{**vars(GOOD), "n_approaches": n, "n_unjudged_approaches": n_unjudged})
    assert rule.of_tracks(facts) == expected


@pytest.mark.parametrize("piece_rows", [None, 100])
@pytest.mark.parametrize(("before_m", "n_lost"), [(2040.0, 18), (1500.0, 9), (960.0, 0)])
def test_rows_without_a_position_at_its_end_are_missing(tmp_path: Path, before_m: float, n_lost: int, piece_rows: int | None) -> None:
    """From 2040 m at 60 m/s it is before 926 m for 18 rows more; those after it are on the ground."""
    lost = flown(LANDS).with_columns(
        pl.when(pl.int_range(pl.len()) <= (12_000.0 - before_m) / 60.0).then(pl.col(name)).alias(name)
        for name in ("est_lat_rad", "est_lon_rad")
    )
    judged = verdict(tmp_path / "a.csv", {"a": lost}, piece_rows)
    assert judged.n_missing == n_lost
