"""How long an inertial unit keeps an RNP, and what correlated epochs are worth: reference cases of other code, and limits."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from navbound.errors import InputError
from navbound.evaluation import containment
from navbound.evaluation.independence import effective_number
from navbound.ins.coasting import AIDED, SPECIFICATION, Channel, circles, coasting_hold_s, drift_hold_s, sigmas, system
from navbound.units import METRES_PER_NM

REFERENCE: dict[str, Any] = json.loads((Path(__file__).parent / "reference_prediction.json").read_text(encoding="utf-8"))
NAMES = {"navigation grade, aided before": AIDED, "navigation grade, specification": SPECIFICATION}


def channel(case: dict[str, Any]) -> Channel:
    return Channel(
        case["sigma_r_m"],
        case["sigma_v_mps"],
        case["sigma_tilt_rad"],
        case["sigma_accel_bias_mps2"],
        case["sigma_gyro_rad_s"],
        case["correlation_tilt_bias"],
        case["accel_noise_mps2_rthz"],
        case["gyro_noise_rads_rthz"],
    )


@pytest.mark.parametrize("case", REFERENCE["coasting"], ids=lambda c: c["name"])
def test_one_channel_grows_as_the_reference(case: dict[str, Any]) -> None:
    times = [row["time_s"] for row in case["series"]]
    sigma, sigma_v = sigmas(channel(case), times)
    # The reference is exact to its digits; the series is summed in doubles.
    np.testing.assert_allclose(sigma, [row["sigma_m"] for row in case["series"]], rtol=1e-6)
    np.testing.assert_allclose(sigma_v, [row["sigma_v_mps"] for row in case["series"]], rtol=1e-6)
    np.testing.assert_allclose(circles(channel(case), times), [row["circle95_m"] for row in case["series"]], rtol=1e-6)


@pytest.mark.parametrize("case", REFERENCE["coasting"], ids=lambda c: c["name"])
def test_the_shipped_channels_are_those_of_the_reference(case: dict[str, Any]) -> None:
    for name in Channel.__dataclass_fields__:
        assert getattr(NAMES[case["name"]], name) == pytest.approx(getattr(channel(case), name), rel=1e-12)


def test_tilt_and_bias_of_an_alignment_cancel() -> None:
    """One deterministic run: a bias with the tilt that levelling leaves moves nothing at first; of the other sign it moves twice."""
    bias, dt = 1e-3, 0.1
    moved = {}
    for sign in (1.0, -1.0):
        state = np.array([0.0, 0.0, sign * bias / 9.80665, bias, 0.0])
        for _ in range(600):
            state = state + dt * (system() @ state)
        moved[sign] = state[0]
    assert abs(moved[1.0]) < 1e-9
    # 2 b t^2 / 2 = 3.6 m after a minute; Euler's step and the Schuler oscillation take a part in a thousand.
    assert moved[-1.0] == pytest.approx(bias * 60.0**2, rel=3e-3)


def test_another_correlation_of_tilt_and_bias_is_far_off() -> None:
    # Circles at 600 s: 46.8 m at +0.95; 128 and 175 m at 0 and -0.95 (specification D.4, rounded to whole metres).
    case = REFERENCE["coasting"][0]
    for correlation, circle in ((0.95, 46.8), (0.0, 128.0), (-0.95, 175.0)):
        changed = channel(case | {"correlation_tilt_bias": correlation})
        assert circles(changed, [600.0])[0] == pytest.approx(circle, abs=0.5 if correlation <= 0 else 0.05)


@pytest.mark.parametrize("case", REFERENCE["hold"])
def test_drift_holds_as_the_reference(case: dict[str, float]) -> None:
    rnp, fte, start = (case[key] * METRES_PER_NM for key in ("rnp_nm", "fte95_nm", "epu0_nm"))
    drift = case["drift_nm_per_h"] * METRES_PER_NM / 3600
    for rule in ("epu", "rss", "exact"):
        hours = drift_hold_s(rnp, fte, start, drift, rule) / 3600
        assert hours == pytest.approx(case[f"hold_{rule}_h"], rel=1e-10)


def test_the_published_limit_of_rnp_10_is_the_exact_rule() -> None:
    # 6.2 h in the documents; 10 / (2 x 1.9600 / 2.4477) = 6.244.
    hours = drift_hold_s(10 * METRES_PER_NM, 0.0, 0.0, 2 * METRES_PER_NM / 3600, "exact") / 3600
    assert hours == pytest.approx(6.244, abs=5e-4)


@pytest.mark.parametrize(("rnp_nm", "specified_min", "aided_min"), [(0.1, 12, 20), (0.3, 24, 32), (0.5, 30, 41), (1, 41, 67), (2, 67, 148)])
def test_the_table_of_hold_times(rnp_nm: float, specified_min: int, aided_min: int) -> None:
    """The specification's table in minutes: first whole minute beyond."""
    for unit, minutes in ((SPECIFICATION, specified_min), (AIDED, aided_min)):
        seconds = coasting_hold_s(unit, rnp_nm * METRES_PER_NM, 4 * 3600.0)
        assert seconds is not None
        assert seconds / 60 == pytest.approx(minutes, abs=1)


def test_a_limit_that_is_not_exceeded_says_so() -> None:
    assert coasting_hold_s(AIDED, 4 * METRES_PER_NM, 4 * 3600.0) is None


@pytest.mark.parametrize("case", REFERENCE["effective_number"])
def test_effective_numbers(case: dict[str, float]) -> None:
    mean, variance = effective_number(case["duration_s"], case["step_s"], case["tau_s"])
    assert mean == pytest.approx(case["effective_for_mean"], rel=1e-9)
    assert variance == pytest.approx(case["effective_for_variance"], rel=1e-9)


@pytest.mark.parametrize("case", REFERENCE["coverage_interval"])
def test_coverage_intervals(case: dict[str, float]) -> None:
    n, inside = int(case["epochs_independent"]), int(case["inside"])
    limits = containment(n - inside, n, float(n), 0.05)
    assert limits.coverage_low == pytest.approx(case["low"], abs=1e-9)
    assert limits.coverage_high == pytest.approx(case["high"], abs=1e-9)


def test_what_is_refused() -> None:
    with pytest.raises(InputError, match="tau_s"):
        effective_number(10.0, 1.0, 0.0)
    with pytest.raises(InputError, match="fte95_m"):
        drift_hold_s(100.0, 100.0, 0.0, 1.0, "rss")
    with pytest.raises(InputError, match="drift_mps"):
        drift_hold_s(100.0, 0.0, 0.0, math.nan, "epu")
    with pytest.raises(InputError, match="time_s"):
        sigmas(AIDED, [60.0, 0.0])
    with pytest.raises(InputError, match="correlation_tilt_bias"):
        Channel(1.0, 1.0, 1.0, 1.0, 1.0, 1.5, 1.0, 1.0)
