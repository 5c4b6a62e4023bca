"""Orbits and clocks of analysis centres, almanacs and carrier smoothing in positions; skipped, aloud, without the files."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from navbound import FormatError, InputError, evaluation, gnss

NS = 1_000_000_000
MIDNIGHT_NS = (2111 * 604_800 + 345_600) * NS
"""2020-06-25, by week and time of week of the orbit file's header."""


@pytest.fixture(scope="module")
def folder(shared_data: Path) -> Path:
    return shared_data / "gnss" / "ESBC_2020_177"


@pytest.fixture(scope="module")
def orbits(folder: Path) -> gnss.PreciseOrbits:
    days = [folder / f"GRG0MGXFIN_2020{day}0000_01D_15M_ORB.SP3.gz" for day in (176, 177)]
    return gnss.read_orbits([*days, folder / "GRG0MGXFIN_20201770000_01D_30S_CLK.CLK.gz"])


@pytest.fixture(scope="module")
def observed(folder: Path) -> tuple[gnss.Observations, gnss.Navigation]:
    observations = gnss.read_observations(folder / "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz")
    return observations, gnss.read_navigation(folder / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz")


@pytest.fixture(scope="module")
def truth(shared_data: Path) -> Any:
    return json.loads((shared_data / "baselines.json").read_text(encoding="utf-8"))["ESBC_2020_177"]["reference_ecef_m"]


def errors(epochs: pl.DataFrame) -> Any:
    result = epochs.select("nse_e_m", "nse_n_m", "nse_u_m").to_numpy()
    return result[np.isfinite(result[:, 0])]


def test_tables_come_back_at_their_nodes(orbits: gnss.PreciseOrbits) -> None:
    assert (orbits.n_clocks, orbits.clock_source, orbits.frames) == (215_999, "clock file", {"IGb14"})
    ecef, _, clock = orbits.states("E01", MIDNIGHT_NS)
    # The line of the file, to its millimetre; the velocity bends it by less.
    np.testing.assert_allclose(ecef, [-11562163.582, 14053114.306, 23345128.269], atol=1e-6)
    # -0.884707516318e-3 s in the clock file; relativity of an orbit with e below 0.001 is less than 3 ns.
    assert abs(clock + 0.884707516318e-3) < 3e-9
    assert np.isnan(orbits.states("E01", [MIDNIGHT_NS + 86_400 * NS])[0]).all()


def test_orbits_refuse_what_they_are_not(orbits: gnss.PreciseOrbits, folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="satellite = C01"):
        orbits.states("C01", MIDNIGHT_NS)
    with pytest.raises(InputError, match="time_ns"):
        orbits.states("E01", 0.5)
    with pytest.raises(InputError, match="paths"):
        gnss.read_orbits([])
    with pytest.raises(InputError, match="orbits"):
        gnss.read_orbits(folder / "GRG0MGXFIN_20201770000_01D_30S_CLK.CLK.gz")
    (tmp_path / "orbit.sp3").write_text("#zP2020  6 25", encoding="ascii")
    with pytest.raises(FormatError, match="SP3"):
        gnss.read_orbits(tmp_path / "orbit.sp3")
    (tmp_path / "orbit.sp3.gz").write_bytes(gzip.compress(b"#cP")[:-3])
    with pytest.raises(FormatError, match="gzip"):
        gnss.read_orbits(tmp_path / "orbit.sp3.gz")


# Without the antennas' offsets the height gains little; the horizontal errors of GPS on this day are mostly orbit and clock (G28).
@pytest.mark.parametrize(
    ("how", "share"),
    [
        ({"systems": "G"}, 0.7),
        ({"systems": "GE", "signals": "dual", "smoothing_s": 1800.0}, 0.8),
        ({"systems": "E", "signals": "dual"}, 1.1),
    ],
)
def test_precise_orbits_take_horizontal_error_away(
    observed: tuple[gnss.Observations, gnss.Navigation], orbits: gnss.PreciseOrbits, truth: Any, how: Any, share: float
) -> None:
    h95 = {}
    for name, precise in (("broadcast", None), ("precise", orbits)):
        error = errors(gnss.solve(*observed, orbits=precise, truth_ecef_m=truth, **how).epochs)
        h95[name] = np.quantile(np.hypot(error[:, 0], error[:, 1]), 0.95)
    # Galileo's broadcast orbits are as good as this receiver can tell: no worse is all that can be required.
    assert h95["precise"] < share * h95["broadcast"]


@pytest.mark.parametrize(("systems", "signals"), [("G", "single"), ("E", "single"), ("GE", "single"), ("E", "dual"), ("GE", "dual")])
def test_precise_orbits_keep_a_consistent_covariance(
    observed: tuple[gnss.Observations, gnss.Navigation], orbits: gnss.PreciseOrbits, truth: Any, systems: str, signals: Any
) -> None:
    positions = gnss.solve(*observed, systems=systems, signals=signals, orbits=orbits, truth_ecef_m=truth)
    # The signals of 00:00:00 left the day before, of which there is no clock; the orbits end at 23:45, 29 epochs before the last.
    absent = np.flatnonzero((positions.epochs["status"] == "not_available").to_numpy())
    assert absent.tolist() == [0, *range(2851, 2880)]
    assert positions.unused["not_tabulated"] > 0
    epochs = positions.epochs[1:-29]
    c = {k: epochs[f"cov_{k}_m2"].to_numpy() for k in ("ee", "en", "nn", "eu", "nu", "uu")}
    rows = [[c["ee"], c["en"], c["eu"]], [c["en"], c["nn"], c["nu"]], [c["eu"], c["nu"], c["uu"]]]
    nees = evaluation.nees(errors(positions.epochs), np.moveaxis(np.array(rows), -1, 0))
    # Not calibrated: cautious, never short.
    # With few ranges to spare the covariance covers readings that are not true: larger than this quiet day needs.
    assert 0.2 < nees.nees_mean < 3.0
    assert "GRG" in positions.models["orbits and clocks"]


@pytest.mark.parametrize("smoothing", ["hatch", "divergence-free"])
def test_smoothing_takes_noise_away_and_says_what_it_did(
    observed: tuple[gnss.Observations, gnss.Navigation], truth: Any, smoothing: Any
) -> None:
    def noise(**how: Any) -> float:
        error = errors(gnss.solve(*observed, systems="GE", signals="dual", truth_ecef_m=truth, **how).epochs)
        # From one epoch to the next only noise and multipath change.
        return float(np.std(np.diff(error, axis=0)))

    positions = gnss.solve(*observed, systems="GE", smoothing_s=300.0, smoothing=smoothing)
    assert positions.models["smoothing"].startswith(f"{smoothing}, 300 s; 9")
    # Ten epochs in the window: differences of successive means are ten times smaller than those of single codes, less multipath.
    assert noise(smoothing_s=300.0, smoothing=smoothing) < 0.35 * noise()


def test_smoothing_refuses_windows_that_are_none(observed: tuple[gnss.Observations, gnss.Navigation]) -> None:
    for wrong in (0.0, -1.0, float("nan"), 1e6):
        with pytest.raises(InputError, match="smoothing_s"):
            gnss.solve(*observed, smoothing_s=wrong)
    with pytest.raises(InputError, match="smoothing"):
        gnss.solve(*observed, smoothing_s=60.0, smoothing="kalman")  # type: ignore[arg-type]


def week_ns(week: int) -> int:
    return week * 604_800 * NS


def test_an_almanac_is_a_constellation(shared_data: Path) -> None:
    folder = shared_data / "gnss" / "almanacs"
    almanac = gnss.constellation(folder / "20160331.alm", near_ns=week_ns(1891))
    # Week 866 of 1024 after 1999-08-22, and the time of applicability in the file.
    assert almanac.reference_ns == week_ns(1024 + 866) + 589_824 * NS
    assert almanac.satellite[0] == "G01"
    sky = gnss.geometry(almanac, np.radians(41.3), np.radians(2.1), 0.0, np.arange(0.0, 86_400.0, 600.0), mask_rad=np.radians(5.0))
    # A healthy constellation of some thirty satellites shows six to thirteen above 5 degrees.
    assert sky.n_sv.min() >= 6
    assert sky.n_sv.max() <= 14


def test_an_almanac_of_another_form_gives_the_same_sky(shared_data: Path) -> None:
    folder = shared_data / "gnss" / "almanacs"
    near = week_ns(1891)
    yuma, sem = gnss.constellation(folder / "20160331.alm", near_ns=near), gnss.constellation(folder / "current.al3", near_ns=near)
    assert yuma.reference_ns is not None
    assert sem.reference_ns is not None
    at_ns = yuma.reference_ns
    names = [s for s in yuma.satellite if s in sem.satellite]
    directions = []
    for orbits in (yuma, sem):
        _, el = gnss.directions(orbits, np.radians(41.3), np.radians(2.1), 0.0, (at_ns - (orbits.reference_ns or 0)) / NS)
        directions.append(np.array([el[orbits.satellite.index(s)] for s in names]))
    # Four weeks apart, an almanac is wrong by some kilometres a day along the track: a degree or two of elevation. A wrong week
    # (1024 of them, or one) turns the sky by tens of degrees.
    assert len(names) >= 28
    assert np.degrees(np.median(np.abs(directions[0] - directions[1]))) < 2.0


def test_a_week_that_may_have_rolled_over_is_not_guessed(shared_data: Path, tmp_path: Path) -> None:
    path = shared_data / "gnss" / "almanacs" / "20160331.alm"
    assert gnss.constellation(path).reference_ns is None
    # Rewritten to the week of 2019-01-06, sent as 1011 of 1024; three months before the roll-over of 2019-04-07.
    rolled = tmp_path / "january.alm"
    rolled.write_text(path.read_text(encoding="ascii").replace("866", "1011"), encoding="ascii")
    for near in (2035, 2048, 2100):
        assert gnss.constellation(rolled, near_ns=week_ns(near)).reference_ns == week_ns(2035) + 589_824 * NS
    assert gnss.constellation(rolled, near_ns=week_ns(1000)).reference_ns == week_ns(1011) + 589_824 * NS


def test_unhealthy_satellites_are_left_out_unless_requested(shared_data: Path, tmp_path: Path) -> None:
    text = (shared_data / "gnss" / "almanacs" / "20160331.alm").read_text(encoding="ascii")
    path = tmp_path / "sick.alm"
    path.write_text(text.replace("Health:                     000", "Health:                     063", 1), encoding="ascii")
    assert "G01" not in gnss.constellation(path).satellite
    assert "G01" in gnss.constellation(path, unhealthy=True).satellite
    with pytest.raises(InputError, match="almanac"):
        gnss.constellation("glonass")
    (tmp_path / "broken.alm").write_text(text[:500], encoding="ascii")
    with pytest.raises(FormatError, match=r"broken\.alm"):
        gnss.constellation(tmp_path / "broken.alm")
