"""A refusal is one of four sentences: outside a domain, in conflict, not found, unreadable."""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import navbound
from navbound import dme, gbas, rnp
from navbound.errors import ConflictError, InputError, NotFoundError
from navbound.run.evaluate.monitored import monitored
from navbound.run.inputs.solving import Solving

ROWS = "time,lat,lon,h_m,cov_ee_m2,cov_en_m2,cov_nn_m2\n" + "".join(
    f"2026-11-22T12:00:{k:02d}Z,{49 + k * 0.0003:.6f},2.5,100.0,2.0,0.0,2.0\n" for k in range(30)
)

NETWORK = dme.Stations.of({"A": (0.70, 0.1, 0.0), "B": (0.71, 0.1, 0.0)})


@pytest.fixture
def track(tmp_path: Path) -> Path:
    path = tmp_path / "track.csv"
    path.write_text(ROWS)
    return path


def refusal(*words: object) -> str:
    done = subprocess.run([sys.executable, "-m", "navbound", *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stdout + done.stderr
    return done.stderr


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--protection", "raim"], "--protection needs --levels: it is an option of navbound evaluate"),
        (["--database", "x.dat"], "--database needs --procedure"),
        (["--missed"], "--missed needs --procedure"),
        (["--mask", "95"], "--mask = 95.0 [deg] is outside [0, 90)"),
        (["--signals", "dual"], "--signals cannot be used here: there are no measurements to solve"),
        (["--sigma-m", "-3"], "--sigma-m = -3.0 [m] is outside (0, inf)"),
        (["--spec", "rnp-0.3"], "did you mean RNP 0.3?"),
        (["--path", "LFPG/08X"], "--path = LFPG/08X: no runway of LFPG of that name; there are 08H"),
    ],
)
def test_the_command_line_names_the_option_as_it_is_typed(track: Path, words: list[str], sentence: str) -> None:
    assert sentence in refusal("analyze", track, *words)


def test_a_study_of_one_process_says_so() -> None:
    assert "--backend cannot be used here: this study runs in one process" in refusal("study", "surface-movement", "--backend", "dask")


def test_a_map_of_a_service_needs_its_messages_and_their_orbits() -> None:
    assert "kind needs --messages: sbas takes the levels of a message log" in refusal("map", "sbas")
    assert "--messages needs --navigation: the orbits are those of the log's day" in refusal("map", "sbas", "--messages", "day.ems")


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: gbas.protection_levels([0.1], [1.0], sigma_m=0.3), "sigma_m needs sigma_h1_m"),
        (lambda: gbas.protection_levels([0.1], [1.0], sigma_h1_m=0.3), "sigma_h1_m needs sigma_m"),
        (lambda: dme.solve([1.0, 2.0], NETWORK, 0.0, sigma_altitude_m=0.0, prior_lat_rad=0.7), "prior_lat_rad needs prior_lon_rad"),
        (lambda: monitored(Solving(ionosphere="none")), "ionosphere cannot stand beside protection: single signals take"),
    ],
)
def test_an_argument_names_the_one_that_it_needs_or_excludes(call: Callable[[], object], sentence: str) -> None:
    with pytest.raises(ConflictError) as refused:
        call()
    assert str(refused.value).startswith(sentence)


def test_python_names_the_argument(track: Path) -> None:
    with pytest.raises(ConflictError, match=r"^signals cannot be used here"):
        navbound.analyze(track, signals="dual")
    with pytest.raises(NotFoundError, match=r"^spec = RNPAR: no specification of that name; .*did you mean RNP AR\?$"):
        navbound.analyze(track, spec="RNPAR")


@pytest.mark.parametrize("value", ["zzz", "", "\x1b[31mRNP", "9" * 50])
def test_a_name_that_is_near_nothing_has_no_suggestion(value: str) -> None:
    with pytest.raises(NotFoundError) as refused:
        rnp.requirement.requirement(value)
    assert "did you mean" not in str(refused.value)
    assert "\x1b" not in str(refused.value)


@pytest.mark.parametrize(
    "error",
    [
        InputError("risk", 2.0, "1", "(0, 0.5]", 3),
        ConflictError("path", excludes=("procedure",), because="one is enough", value="LFPG/08R"),
        ConflictError("workers", needs=("backend", "cluster")),
        NotFoundError("method", "x", "method", ["tse-exact"], "or none"),
    ],
)
def test_a_refusal_crosses_from_a_worker_unchanged(error: InputError) -> None:
    copy = pickle.loads(pickle.dumps(error))
    assert (type(copy), str(copy), vars(copy)) == (type(error), str(error), vars(error))


def test_a_mapping_of_columns_that_changes_nothing_is_reported(tmp_path: Path) -> None:
    head = "%  GPST  latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio\n"
    rows = "".join(f"2026/11/22 12:00:{k:02d}.000 {49 + k * 3e-4:.9f} 2.5 150.0 5 10 1.0 1.0 2.0 0.0 0.0 0.0 0.0 0.0\n" for k in range(30))
    path = tmp_path / "a.pos"
    path.write_text(head + rows)
    run = navbound.analyze(path, columns={"est_h_m": "height(ft)"})
    assert any("change nothing in a.pos" in words for words in run.summary.assumptions)
