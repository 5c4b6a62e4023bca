"""What is declared of the ionosphere where it is described well, badly or not at all; skipped, aloud, where the files are not at hand."""

from __future__ import annotations

import gzip
import importlib.util
import itertools
import json
import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import InputError, _core, gnss
from navbound.gnss.constellation_doubts import contradicting
from navbound.gnss.signal_choice import smaller_covariance
from navbound.methods import bounds

EXAMPLES = Path(__file__).parents[1] / "examples" / "data"

Floats = np.ndarray[Any, np.dtype[np.float64]]
LINES = {"GPS": (b"GPSA", b"GPSB", b"ION ALPHA", b"ION BETA"), "Galileo": (b"GAL ",)}


def without(source: Path, folder: Path, *systems: str) -> Path:
    """A copy of a navigation file whose header lacks the ionosphere of some systems."""
    plain = gzip.decompress(source.read_bytes()) if source.suffix == ".gz" else source.read_bytes()
    head, end, records = plain.partition(b"END OF HEADER")
    marks = [mark for system in systems for mark in LINES[system]]
    absent = [line for line in head.split(b"\n") if any(line.startswith(m) or line[60:].startswith(m) for m in marks)]
    assert absent or not systems, source
    kept = b"\n".join(line for line in head.split(b"\n") if line not in absent)
    name = folder / f"without-{'-'.join(systems)}-{source.name.removesuffix('.gz')}"
    name.write_bytes(kept + end + records)
    return name


@cache
def recording(shared: Path, name: str) -> tuple[gnss.Observations, Path, tuple[float, ...]]:
    """Observations, navigation file and true position of a shared recording."""
    folder = shared / "gnss"
    if name == "ESBC":
        day = folder / "ESBC_2020_177"
        baselines = json.loads((shared / "baselines.json").read_text(encoding="utf-8"))
        observations = gnss.read_observations(day / "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz")
        return observations, day / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz", tuple(baselines["ESBC_2020_177"]["reference_ecef_m"])
    if name == "ARLM":
        observations = gnss.read_observations(folder / "ARLM_2015_200" / "arlm200x.15o")
        assert observations.approximate_ecef_m is not None
        return observations, folder / "ARLM_2015_200" / "arlm2000.15n", tuple(observations.approximate_ecef_m)
    lat, lon, h = (float(v) for v in (folder / "taroz_static" / "rover_position.txt").read_text().split())
    observations = gnss.read_observations(folder / "taroz_static" / "rover.obs.gz")
    return observations, folder / "taroz_static" / "base.nav", ecef(math.radians(lat), math.radians(lon), h)


def ecef(lat: float, lon: float, h: float) -> tuple[float, ...]:
    e2 = (2 - 1 / 298.257223563) / 298.257223563
    n = 6_378_137.0 / math.sqrt(1 - e2 * math.sin(lat) ** 2)
    return ((n + h) * math.cos(lat) * math.cos(lon), (n + h) * math.cos(lat) * math.sin(lon), (n * (1 - e2) + h) * math.sin(lat))


def nees(epochs: pl.DataFrame) -> float:
    error = epochs.select("nse_e_m", "nse_n_m", "nse_u_m").to_numpy()
    c = {k: epochs[f"cov_{k}_m2"].to_numpy() for k in ("ee", "en", "nn", "eu", "nu", "uu")}
    rows = [[c["ee"], c["en"], c["eu"]], [c["en"], c["nn"], c["nu"]], [c["eu"], c["nu"], c["uu"]]]
    covariance = np.moveaxis(np.array(rows), -1, 0)
    return float(np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[..., None])[..., 0]).mean())


def coverage(epochs: pl.DataFrame) -> dict[str, float]:
    """Shares of epochs whose error is inside its own bound: circles of 95 % and 1e-5, and the same of the height."""
    horizontal = np.hypot(epochs["nse_e_m"].to_numpy(), epochs["nse_n_m"].to_numpy())
    vertical, sigma = np.abs(epochs["nse_u_m"].to_numpy()), np.sqrt(epochs["cov_uu_m2"].to_numpy())
    circle = {risk: bounds(epochs, "anp-circle", risk).bound_m for risk in (0.05, 1e-5)}
    return {
        "circle": float((horizontal <= circle[0.05]).mean()),
        "circle 1e-5": float((horizontal <= circle[1e-5]).mean()),
        "height": float((vertical <= 1.96 * sigma).mean()),
        "height 1e-5": float((vertical <= 4.417 * sigma).mean()),
    }


CASES = [("ESBC", "G"), ("ESBC", "E"), ("ESBC", "GE"), ("ESBC", "GEC"), ("ARLM", "G"), ("Taroz", "G"), ("Taroz", "GE"), ("Taroz", "GEC")]


# Bounds of the specification: 0.93 of a day of some ten independent ionospheres, and 0.999 of the 1e-5 bounds.
@pytest.mark.parametrize(("name", "systems"), CASES)
def test_without_any_message_of_the_ionosphere_the_bounds_still_hold(shared_data: Path, tmp_path: Path, name: str, systems: str) -> None:
    observations, navigation, truth = recording(shared_data, name)
    absent = ("GPS",) if name == "ARLM" else ("GPS", "Galileo")
    messages = gnss.read_navigation(without(navigation, tmp_path, *absent))
    positions = gnss.solve(observations, messages, systems=systems, truth_ecef_m=truth)
    assert "ok" not in set(positions.epochs["status"])
    assert positions.epochs["reason"].drop_nulls().len() == positions.epochs.height
    assert "climatology, no message" in positions.models["ionosphere"]
    share = coverage(positions.epochs.drop_nulls("est_lat_rad"))
    assert min(share["circle"], share["height"]) >= 0.93, share
    assert min(share["circle 1e-5"], share["height 1e-5"]) >= 0.999, share


@pytest.mark.parametrize(("name", "systems"), [c for c in CASES if c[0] != "ARLM"])
def test_without_the_message_of_gps_that_of_galileo_serves(shared_data: Path, tmp_path: Path, name: str, systems: str) -> None:
    observations, navigation, truth = recording(shared_data, name)
    positions = gnss.solve(observations, gnss.read_navigation(without(navigation, tmp_path, "GPS")), systems=systems, truth_ecef_m=truth)
    assert "NTCM-G, Galileo message" in positions.models["ionosphere"]
    # Galileo of 2020 alone has often fewer than three ranges to spare: a fault could not be seen, and the position is doubted for that.
    assert positions.epochs["status"].to_list().count("ok") > (0.9 if systems == "E" else 0.99) * positions.epochs.height
    share = coverage(positions.epochs)
    assert min(share["circle"], share["height"]) >= 0.93, share
    assert min(share["circle 1e-5"], share["height 1e-5"]) >= 0.999, share
    assert nees(positions.epochs) < 4.0


# Which of these set a number stands in docs/methods/what-is-believable.md. The ESBC day is of the sun's minimum: 1 to 4 is required of it;
# five minutes or an hour are one draw of an ionosphere, which may as well be a good one.
@pytest.mark.parametrize(("name", "systems"), CASES)
def test_the_covariance_covers_the_errors(shared_data: Path, name: str, systems: str) -> None:
    observations, navigation, truth = recording(shared_data, name)
    positions = gnss.solve(observations, gnss.read_navigation(navigation), systems=systems, truth_ecef_m=truth)
    share = coverage(positions.epochs)
    # With few ranges to spare the covariance holds readings of them that are not true; it is then too large, never too small.
    assert (0.3 if systems == "E" else 1.0) <= nees(positions.epochs) <= 4.0
    assert min(share["circle"], share["height"]) >= 0.93, share
    assert min(share["circle 1e-5"], share["height 1e-5"]) >= 0.999, share


@pytest.mark.parametrize("name", ["ESBC", "Taroz"])
def test_more_satellites_do_not_make_the_covariance_less_believable(shared_data: Path, name: str) -> None:
    observations, navigation, truth = recording(shared_data, name)
    messages = gnss.read_navigation(navigation)
    shares = [coverage(gnss.solve(observations, messages, systems=systems, truth_ecef_m=truth).epochs) for systems in ("G", "GE", "GEC")]
    for fewer, more in itertools.pairwise(shares):
        # A day holds some ten independent ionospheres: one of them in ten is the sampling of a share.
        assert more["circle"] >= fewer["circle"] - 0.1
        assert more["height"] >= fewer["height"] - 0.1


def test_no_correction_counts_as_error_with_its_whole_size(shared_data: Path) -> None:
    observations, navigation, truth = recording(shared_data, "Taroz")
    positions = gnss.solve(observations, gnss.read_navigation(navigation), ionosphere="none", truth_ecef_m=truth)
    assert "ok" not in set(positions.epochs["status"])
    # At noon of a year of an active sun a height is wrong by more than ten metres, and says so.
    assert float(np.median(np.abs(positions.epochs["nse_u_m"].to_numpy()))) > 5.0
    assert min(coverage(positions.epochs).values()) >= 0.93


def test_a_message_of_another_time_does_not_serve(shared_data: Path, tmp_path: Path) -> None:
    observations, navigation, _ = recording(shared_data, "ESBC")
    old = shared_data / "gnss" / "ARLM_2015_200" / "arlm2000.15n"
    messages = gnss.read_navigation([old, without(navigation, tmp_path, "GPS", "Galileo")])
    assert "climatology" in gnss.solve(observations, messages).models["ionosphere"]
    with pytest.raises(InputError, match="ionosphere"):
        gnss.solve(observations, messages, ionosphere="broadcast")
    # Of two messages the nearer: the day's own, whatever the order of the files.
    both = gnss.read_navigation([old, navigation])
    own = gnss.solve(observations, gnss.read_navigation(navigation), systems="G").epochs["est_h_m"].to_numpy()
    assert np.array_equal(gnss.solve(observations, both, systems="G").epochs["est_h_m"].to_numpy(), own)


def test_messages_of_zeros_are_no_messages(shared_data: Path, tmp_path: Path) -> None:
    observations, navigation, _ = recording(shared_data, "Taroz")
    text = navigation.read_bytes()
    lines = text.split(b"\n")
    zero = b"  0.0000E+00" * 4
    empty = [line[:5] + zero + line[53:] if line[:4] in {b"GPSA", b"GAL "} else line for line in lines]
    path = tmp_path / "zeros.nav"
    path.write_bytes(b"\n".join(empty))
    positions = gnss.solve(observations, gnss.read_navigation(path))
    assert "climatology" in positions.models["ionosphere"]
    assert "ok" not in set(positions.epochs["status"])


def test_two_frequencies_are_taken_where_they_state_the_smaller_covariance(shared_data: Path, tmp_path: Path) -> None:
    observations, navigation, truth = recording(shared_data, "Taroz")
    messages = gnss.read_navigation(navigation)
    # At the sun's maximum the pair is the better one, and the better one is taken.
    positions = gnss.solve(observations, messages, systems="GE", signals="auto", truth_ecef_m=truth)
    single, dual = (gnss.solve(observations, messages, systems="GE", signals=s, truth_ecef_m=truth) for s in ("single", "dual"))
    assert positions.models["signals"].startswith("ionosphere-free pairs: median sigma")
    assert positions.epochs.equals(dual.epochs)
    error = [np.sqrt((p.epochs.select("nse_e_m", "nse_n_m", "nse_u_m").to_numpy() ** 2).sum(axis=1).mean()) for p in (single, dual)]
    assert error[1] < error[0]
    # At its minimum one frequency is.
    observations, navigation, _ = recording(shared_data, "ESBC")
    quiet = gnss.solve(observations, gnss.read_navigation(navigation), systems="GE", signals="auto")
    assert quiet.models["signals"].startswith("one pseudorange: median sigma")
    # Nobody describes the ionosphere: the pair needs no message, and its epochs are not degraded by that.
    nothing = gnss.read_navigation(without(navigation, tmp_path, "GPS", "Galileo"))
    alone = gnss.solve(observations, nothing, systems="GE", signals="auto")
    assert alone.models["signals"].startswith("ionosphere-free pairs")
    assert alone.epochs["status"].to_list().count("ok") > 0.99 * alone.epochs.height


def test_where_the_file_has_one_frequency_auto_says_so(shared_data: Path) -> None:
    folder = shared_data / "gnss" / "HK_TST_2019_118"
    observations = gnss.read_observations(folder / "COM3_190428_124409.obs")
    messages = gnss.read_navigation([folder / "hksc1180.19n", folder / "hksc1180.19b"])
    positions = gnss.solve(observations, messages, systems="GC", signals="auto")
    assert positions.models["signals"].startswith("one pseudorange; ionosphere-free pairs give 0 of its")


def test_the_run_states_what_was_used(shared_data: Path, tmp_path: Path) -> None:
    folder = shared_data / "gnss" / "taroz_static"
    files = [folder / "rover.obs.gz", folder / "base.nav"]
    used = {"signals": "single", "systems": "GE", "ionosphere": "climatology", "mask_rad": math.radians(7.5)}
    run = navbound.analyze(files, **used, out=tmp_path / "run")  # type: ignore[arg-type]
    words = " ".join(run.summary.assumptions)
    assert "signals: one pseudorange" in words
    assert "ionosphere: climatology, no message" in words
    record = json.loads((tmp_path / "run" / "run.json").read_text(encoding="utf-8"))
    assert "mask: elevation 7.5 deg and more" in words
    assert record["settings"]["solving"] == used
    with pytest.raises(InputError, match="signals"):
        navbound.analyze(files, signals="triple")
    table = tmp_path / "track.csv"
    table.write_text("time_ns,est_lat_rad,est_lon_rad,est_h_m\n0,0.1,0.2,10\n", encoding="utf-8")
    with pytest.raises(InputError, match="ionosphere"):
        navbound.analyze(table, ionosphere="none")
    with pytest.raises(InputError, match="mask_rad"):
        navbound.analyze(table, mask_rad=0.1)


@pytest.fixture(scope="module")
def transcription() -> ModuleType:
    """The model from its equations, in degrees."""
    path = Path(__file__).parents[1] / "oracle" / "ntcm_degrees.py"
    spec = importlib.util.spec_from_file_location("ntcm_degrees", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_model_is_that_of_an_independent_transcription(transcription: ModuleType) -> None:
    rng = np.random.default_rng(20)
    for _ in range(300):
        lat, lon = rng.uniform(-85, 85), rng.uniform(-180, 180)
        azimuth, elevation, hours, level = rng.uniform(0, 360), rng.uniform(5, 89.9), rng.uniform(0, 24), rng.uniform(0, 300)
        day = int(rng.integers(1, 366))
        # Days of 2021 since 6 January 1980: its first of January is day 14971.
        time_ns = (14_971 + day - 1) * 86_400 * 10**9 + round(hours * 3600e9)
        ours = _core.ntcm_delay(
            level, (math.radians(lat), math.radians(lon), 0.0), (math.radians(azimuth), math.radians(elevation)), time_ns
        )
        # Both lose some digits where an arc sine is steep.
        assert ours == pytest.approx(transcription.delay_m(level, (lat, lon), (azimuth, elevation), hours, day), rel=1e-9, abs=1e-12)


@dataclass(frozen=True)
class Solution:
    """As much of positions as the choice looks at."""

    epochs: pl.DataFrame
    models: dict[str, str]


def solution(status: str, variance_m2: float) -> Solution:
    axes = {f"cov_{axis}_m2": [variance_m2] * 10 for axis in ("ee", "nn", "uu")}
    return Solution(pl.DataFrame({"status": [status] * 10, **axes}), {"signals": "kind: words"})


@pytest.mark.parametrize(
    ("single", "dual", "taken"),
    [
        (solution("degraded", 1.0), solution("ok", 2.0), "ionosphere-free pairs"),
        (solution("ok", 1.0), solution("ok", 2.0), "one pseudorange"),
        (solution("degraded", 1.0), solution("degraded", 2.0), "one pseudorange"),
        (solution("ok", 2.0), solution("ok", 1.0), "ionosphere-free pairs"),
    ],
)
def test_positions_that_nobody_vouches_for_are_not_taken_for_their_covariance(single: Solution, dual: Solution, taken: str) -> None:
    selected_positions = smaller_covariance({"single": single, "dual": dual}.__getitem__)  # type: ignore[arg-type]
    assert selected_positions.models["signals"].startswith(taken)


@pytest.mark.parametrize(("shift_m", "doubted"), [(0.0, False), (90.0, False), (120.0, True), (554.0, True), (5000.0, True)])
def test_a_header_of_another_place_than_a_standing_receiver_s_leaves_nothing_shown(
    shared_data: Path, tmp_path: Path, shift_m: float, doubted: bool
) -> None:
    folder = shared_data / "gnss" / "taroz_static"
    text = gzip.decompress((folder / "rover.obs.gz").read_bytes()).decode("latin-1")
    lines = text.splitlines(keepends=True)
    at = next(k for k, line in enumerate(lines) if "APPROX POSITION XYZ" in line)
    navigation = folder / "base.nav"
    place = [float(word) for word in lines[at].split()[:3]]
    # East, so that the distance is horizontal.
    east = np.array([-place[1], place[0]]) / np.hypot(place[0], place[1]) * shift_m
    lines[at] = f"{place[0] + east[0]:14.4f}{place[1] + east[1]:14.4f}{place[2]:14.4f}{'':18}APPROX POSITION XYZ\n"
    path = tmp_path / "rover.obs"
    path.write_text("".join(lines), encoding="latin-1")
    verdict = navbound.analyze([path, navigation]).summary.verdict
    assert any("approximate position of the header" in each for each in verdict.position_doubts) == doubted
    assert (verdict.id == "inside") == (not doubted)
    if doubted:
        settled = navbound.analyze([path, navigation], truth=",".join(map(str, place))).summary.verdict
        assert not settled.position_doubts


def test_a_verdict_says_why_epochs_are_not_ok(tmp_path: Path) -> None:
    verdict = navbound.analyze([EXAMPLES / "station.rnx", EXAMPLES / "broadcast.rnx"], signals="single", ionosphere="none").summary.verdict
    assert verdict.n_reason == {"ionosphere_undescribed": verdict.n_degraded}
    assert (
        f"Epochs that are not ok: no message describes the ionosphere: heights can be wrong by metres ({verdict.n_degraded})."
        in verdict.words
    )
    whole = navbound.analyze([EXAMPLES / "station.rnx", EXAMPLES / "broadcast.rnx"]).summary.verdict
    assert sum(whole.n_reason.values()) == whole.n_epochs - whole.n_missing - whole.n_judged


@pytest.mark.parametrize("protection", ["given", "raim"])
@pytest.mark.parametrize("moved", [False, True])
def test_levels_at_another_place_than_the_header_s_say_so(tmp_path: Path, protection: str, moved: bool) -> None:
    lines = (EXAMPLES / "station.rnx").read_text(encoding="ascii").splitlines(keepends=True)
    at = next(k for k, line in enumerate(lines) if "APPROX POSITION XYZ" in line)
    place = [float(word) for word in lines[at].split()[:3]]
    lines[at] = f"{place[0]:14.4f}{place[1] + 500.0 * moved:14.4f}{place[2]:14.4f}{'':18}APPROX POSITION XYZ\n"
    (tmp_path / "station.rnx").write_text("".join(lines), encoding="ascii")
    files = [tmp_path / "station.rnx", EXAMPLES / "broadcast.rnx"]
    verdict = navbound.evaluate(files, levels="NPA", protection=protection).summary.verdict
    assert any("approximate position of the header" in each for each in verdict.position_doubts) == moved
    assert ("approximate position of the header" in verdict.words) == moved
    settled = navbound.evaluate(files, levels="NPA", protection=protection, truth=",".join(map(str, place))).summary.verdict
    assert not settled.position_doubts


def with_biased_ranges(folder: Path, letter: str, sigma_m: float) -> Path:
    """The example's station with an error of its own in all ranges of each satellite of a constellation."""
    rng, bias_m = np.random.default_rng(3), dict[str, float]()
    lines, body = [], False
    for line in (EXAMPLES / "station.rnx").read_text(encoding="ascii").splitlines():
        changed = line
        if body and line.startswith(letter):
            bias_m.setdefault(line[:3], sigma_m * float(rng.standard_normal()))
            fields = [line[at : at + 16] for at in range(3, len(line), 16)]
            ranges = [field[:14].strip() and 1.5e7 < float(field[:14]) < 4.5e7 for field in fields]
            moved = [f"{float(f[:14]) + bias_m[line[:3]]:14.3f}{f[14:]}" if r else f for f, r in zip(fields, ranges, strict=True)]
            changed = line[:3] + "".join(moved)
        body |= "END OF HEADER" in line
        lines.append(changed)
    path = folder / "station.rnx"
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


@pytest.mark.parametrize(("letter", "others", "name"), [("E", "G", "Galileo"), ("G", "E", "GPS")])
def test_the_constellation_that_contradicts_the_others_is_named(tmp_path: Path, letter: str, others: str, name: str) -> None:
    path, navigation = with_biased_ranges(tmp_path, letter, 5.0), EXAMPLES / "broadcast.rnx"
    verdict = navbound.analyze([path, navigation]).summary.verdict
    assert verdict.id in {"not_shown", "nothing_judged"}
    assert [each for each in verdict.position_doubts if name in each and f"--systems {others} " in each] == verdict.position_doubts
    assert len(verdict.position_doubts) == 1
    settled = navbound.analyze([path, navigation], systems=others).summary.verdict
    assert settled.position_doubts == []
    assert settled.n_judged > 2 * verdict.n_judged


@dataclass(frozen=True)
class Reasons:
    """As much of positions as the search looks at: 100 epochs, of which some are contradicted."""

    n_contradicted: int
    codes: dict[str, list[str]]
    of_others: str | None = None

    @property
    def epochs(self) -> pl.DataFrame:
        ids = ["residuals_contradict"] * self.n_contradicted + [self.of_others] * (100 - self.n_contradicted)
        return pl.DataFrame({"est_lat_rad": [0.5] * 100, "reason_id": ids, "status": ["degraded" if id_ else "ok" for id_ in ids]})


@pytest.mark.parametrize(
    ("alone", "words"),
    [
        ({"GE": 2, "GC": 80, "EC": 80}, "BeiDou contradict the others"),
        ({"GE": 2, "GC": 2, "EC": 80}, "Galileo and BeiDou contradict each other"),
        ({"GE": 60, "GC": 80, "EC": 80}, None),
    ],
)
def test_a_constellation_is_named_only_where_one_alone_settles_it(alone: dict[str, int], words: str | None) -> None:
    codes = {letter: ["C1C"] for letter in "GEC"}
    doubts = contradicting(Reasons(80, codes), lambda letters: Reasons(alone[letters], codes))  # type: ignore[arg-type, return-value]
    assert [words in each for each in doubts if words] == ([True] if words else [])
    assert contradicting(Reasons(20, codes), {}.__getitem__) == []  # type: ignore[arg-type]


def test_ranges_without_one_to_spare_contradict_nobody() -> None:
    """Four ranges of Galileo have no residual: that nothing speaks against them blames nobody else."""
    codes = {letter: ["C1C"] for letter in "GE"}
    untested = {letter: Reasons(0, codes, "no_redundancy") for letter in "GE"}
    assert contradicting(Reasons(40, codes), untested.__getitem__) == []  # type: ignore[arg-type]


def test_a_healthy_station_has_no_constellation_in_doubt() -> None:
    assert navbound.analyze([EXAMPLES / "station.rnx", EXAMPLES / "broadcast.rnx"]).summary.verdict.position_doubts == []
