"""A file whose own accuracies contradict each other shows nothing by the smaller of them."""

from __future__ import annotations

import functools
import math
from pathlib import Path

import numpy as np
import pytest

import navbound
from test_verdict import table

N = 400
SIGMA_M = 3.0
TWO_DRMS_M = 2.0 * math.sqrt(2.0) * SIGMA_M


@pytest.mark.parametrize(("epu_m", "expected"), [(5000.0, "not_shown"), (1.01 * TWO_DRMS_M, "not_shown"), (0.99 * TWO_DRMS_M, "inside")])
def test_an_epu_beyond_the_covariance_is_against_it(tmp_path: Path, epu_m: float, expected: str) -> None:
    summary = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={"epu_m": np.full(N, epu_m)})).summary
    assert summary.verdict.id == expected
    assert summary.verdict.n_stated_worse == (N if expected == "not_shown" else 0)
    assert any("Stated beside it and not used: EPU" in words for words in summary.assumptions)


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        # Read as metres, as nothing states a unit: worse than the covariance allows, or not.
        ("hAcc", 1.01 * TWO_DRMS_M, "not_shown"),
        ("hAcc", 0.99 * TWO_DRMS_M, "inside"),
        ("hAcc (mm)", 990.0 * TWO_DRMS_M, "inside"),
        ("hAcc (mm)", 1010.0 * TWO_DRMS_M, "not_shown"),
        ("eph_ft", 0.99 * TWO_DRMS_M / 0.3048, "inside"),
        ("eph_ft", 1.01 * TWO_DRMS_M / 0.3048, "not_shown"),
        ("horizontal_accuracy", -300.0, "not_shown"),
        ("CEP50", math.inf, "not_shown"),
        ("NSE", 3000.0, "not_shown"),
        ("err2d", 3000.0, "not_shown"),
        ("h95", 3000.0, "not_shown"),
        ("h95", 1.0, "inside"),
        ("mrse", 3000.0, "not_shown"),
        ("err2d", 1.0, "inside"),
        ("error2D", 3000.0, "not_shown"),
        ("HPE95", 3000.0, "not_shown"),
        ("hAcc95", 3000.0, "not_shown"),
        # No lengths, or none of the position across the ground.
        ("speed_accuracy", 300.0, "inside"),
        ("vAcc", 300.0, "inside"),
        ("headAcc", 300.0, "inside"),
        ("acc_x", 300.0, "inside"),
        ("error_code", 300.0, "inside"),
        ("verr95", 3000.0, "inside"),
        ("std_yaw", 300.0, "inside"),
        ("accuracy (deg)", 300.0, "inside"),
    ],
)
def test_a_column_of_accuracy_that_nothing_reads_is_compared(tmp_path: Path, name: str, value: float, expected: str) -> None:
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={name: np.full(N, value)})).summary.verdict
    assert (verdict.id, verdict.n_stated_worse) == (expected, N if expected == "not_shown" else 0)
    assert ("--map" in verdict.words and name in verdict.words) == (expected == "not_shown")


@pytest.mark.parametrize("sigma_m", [None, SIGMA_M])
def test_it_is_compared_with_a_sigma_that_is_typed(tmp_path: Path, sigma_m: float | None) -> None:
    values = np.full(N, 4.0)
    values[150] = 900.0
    path = table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={"accuracy": values})
    whole = navbound.analyze(path, sigma_m=sigma_m).summary.verdict
    assert (whole.id, whole.n_stated_worse) == ("not_shown", 1)
    declared = navbound.analyze(path, sigma_m=sigma_m, columns={"epu_m": "accuracy:mm"}).summary.verdict
    assert declared.id == "inside"


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("HIL (m)", 2400.0, "not_shown"),
        ("HPL_SBAS", 2400.0, "not_shown"),
        ("gps hpl [NM]", 1.3, "not_shown"),
        ("gps hpl [NM]", 0.5, "inside"),
        ("Horizontal Integrity Limit", 2400.0, "not_shown"),
        ("Horizontal Protection Level RAIM (ft)", 4000.0, "not_shown"),
        ("HPL_SBAS", 100.0, "inside"),
        # None of the position across the ground, or no length.
        ("Vertical Protection Level SBAS", 2400.0, "inside"),
        ("hpl_flag", 2400.0, "inside"),
    ],
)
def test_a_level_under_a_name_that_nothing_reads_is_compared(tmp_path: Path, name: str, value: float, expected: str) -> None:
    path = table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={name: np.full(N, value)})
    verdict = navbound.analyze(path).summary.verdict
    assert (verdict.id, verdict.n_stated_uncontained) == (expected, N if expected == "not_shown" else 0)
    assert name in " ".join(verdict.unread)
    assert navbound.analyze(path, sigma_m=SIGMA_M).summary.verdict.id == expected


def test_a_level_under_its_full_name_is_read(tmp_path: Path) -> None:
    name = "Horizontal Protection Level (m)"
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={name: np.full(N, 2400.0)})).summary.verdict
    assert (verdict.id, verdict.unread) == ("outside", [])


@pytest.mark.parametrize(
    ("name", "value", "states"), [("hAcc", 3.0, True), ("HIL", 30.0, True), ("note", 3.0, False), ("vAcc", 3.0, False)]
)
def test_a_file_with_an_accuracy_that_is_not_understood_states_one(tmp_path: Path, name: str, value: float, states: bool) -> None:
    path = table(tmp_path / "a.csv", N, sigma_m=None, added={name: np.full(N, value)})
    for summary in (navbound.analyze(path).summary, navbound.analyze(path, piece_rows=100).summary):
        words = next(each for each in summary.assumptions if each.startswith("Covariance: none."))
        assert (f"states accuracies that are not understood ({name})" in words) == states
        assert ("states no accuracy" in words) != states


def test_the_sentence_of_a_receiver_about_its_error_is_its_accuracy(tmp_path: Path) -> None:
    path = tmp_path / "a.nmea"
    lines = [f"GPGGA,1000{k:02d}.00,47{k * 0.03:07.4f},N,00800.0000,E,1,09,1.0,500.0,M,47.0,M,," for k in range(30)]
    date = "GPRMC,100000.00,A,4700.0000,N,00800.0000,E,0.0,0.0,060524,,,A"

    def whole(sentence: str) -> str:
        return f"${sentence}*{functools.reduce(lambda a, b: a ^ ord(b), sentence, 0):02X}\r\n"

    for error_m, id_ in ((2.0, "inside"), (900.0, "not_shown")):
        of_garmin = [each for line in lines for each in (line, f"PGRME,{error_m},M,45.0,M,25.0,M")]
        path.write_bytes("".join(map(whole, [date, *of_garmin])).encode())
        run = navbound.analyze(path, sigma_m=5.0)
        assert run.summary.verdict.id == id_
        assert run.epochs["cov_ee_m2"].to_list() == [25.0] * 30
        assert navbound.analyze(path).epochs["cov_ee_m2"].to_list() == pytest.approx([error_m**2] * 30)
    assert any("PGRME states an error and not its share of errors" in each for each in navbound.analyze(path).summary.assumptions)


@pytest.mark.parametrize(("name", "value"), [("off_track", 3000.0), ("offtrack_nm", -2.0), ("crosstrack_error", -3000.0), ("HPE", 3000.0)])
def test_a_distance_off_the_track_is_an_error(tmp_path: Path, name: str, value: float) -> None:
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={name: np.full(N, value)})).summary.verdict
    assert (verdict.id, verdict.n_stated_beyond) == ("not_shown", N)


@pytest.mark.parametrize("name", ["residual", "misfit_m", "pos_dev", "unc", "ci95"])
def test_a_name_that_may_be_an_error_is_named_and_not_compared(tmp_path: Path, name: str) -> None:
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={name: np.full(N, 3000.0)})).summary.verdict
    assert (verdict.id, verdict.unread) == ("inside", [name])
    assert f"of another position: {name}" in verdict.words


def test_a_text_among_the_numbers_that_are_compared_is_counted(tmp_path: Path) -> None:
    texts = ["1.5"] * N
    texts[7], texts[8], texts[9], texts[10], texts[11] = "wide", "bad", "", "nan", "5 m"
    summary = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={"hAcc": texts})).summary
    assert summary.verdict.id == "inside"
    (counted,) = [each for each in summary.rejected if "hAcc" in each.reason]
    assert (counted.reason, counted.count, counted.example) == ("hAcc: not a number; not compared", 2, "wide")


@pytest.mark.parametrize("name", ["accuracy", "h_acc", "cep", "drms", "hAcc", "h_err"])
@pytest.mark.parametrize(
    "written",
    [
        "2500 m (95%)",
        "2500 m",
        "2500.0 M",
        "2.5 km",
        "8202 ft",
        "±2500 m",
        ">= 10 NM",
        "> 5000",
        "2.5e3 m",
        "1.5 nautical miles",
        "+/- 2500 m",
    ],
)
def test_an_accuracy_with_its_unit_in_the_field_is_compared(tmp_path: Path, name: str, written: str) -> None:
    for n_far in (N, 5):
        texts = ["5 m"] * (N - n_far) + [written] * n_far
        verdict = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added={name: texts})).summary.verdict
        assert (verdict.id, verdict.n_stated_worse) == ("not_shown", n_far)
    near = navbound.analyze(table(tmp_path / "b.csv", N, sigma_m=SIGMA_M, added={name: ["5 m", "0.005 km"] * (N // 2)}))
    assert (near.summary.verdict.id, near.summary.rejected) == ("inside", [])
