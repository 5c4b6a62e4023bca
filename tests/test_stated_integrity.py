"""What a recording states of the validity and the integrity of its own positions: understood it decides, not understood it is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import navbound
from navbound import FormatError
from navbound.records.run import Verdict
from test_verdict import first_sentence, table

N = 400
BAD = slice(100, 200)


def stating(tmp_path: Path, name: str, fine: object, bad: object, *, sigma_m: float | None = None) -> Verdict:
    values = np.array([fine] * N, dtype=object)
    values[BAD] = bad
    return navbound.analyze(table(tmp_path / "a.csv", N, added={name: [str(v) for v in values]}), sigma_m=sigma_m).summary.verdict


@pytest.mark.parametrize(
    ("name", "fine", "bad"),
    [
        ("valid", 1, 0),
        ("valid", "true", "false"),
        ("position_valid", "A", "V"),
        ("valid", "1.0", "0.0"),
        ("valid", 1, "maybe"),
        ("fix", 1, 0),
        ("fix", "3D", "none"),
        ("fix_quality", 1, 0),
        ("fix_quality", 4, 6),
        ("gps_quality", 1, 8),
        ("fix_type", 3, 1),
        ("Q", 1, 0),
        ("mode", "A", "N"),
        ("mode", "GNSS", "dead reckoning"),
        ("sol_status", "SOL_COMPUTED", "INSUFFICIENT_OBS"),
        ("nav_mode", "NAV", "DR"),
        ("gps_status", "A", "V"),
        ("posValid", 1, 0),
        ("FixMode", 3, 1),
        ("Fix Type", "3D Fix", "No Fix"),
        ("dead_reckoning", 0, 1),
        ("isDeadReckoning", "false", "true"),
        ("gps_denied", "no", "yes"),
        ("coasting", 0, 12.5),
        ("is_predicted", 0, 1),
        ("used", 1, 0),
        ("sol_stat", "SOL_COMPUTED", "COV_TRACE"),
        ("nuc_p", 8, 0),
        # Words of alarms count in a column of states too.
        ("fix", "3D", "integrity lost"),
        ("fix", "3D", "SPOOFING"),
        ("fix", "3D", "simulated"),
        ("fix_type", 3, "do not use"),
        ("quality", "fix", "unreliable"),
        ("gps", "valid", "unavail"),
        ("gps", "true", "false"),
        ("gnss", "3D", "no"),
        ("mode", "GNSS", "off"),
        ("n_sv", 9, 0),
        ("hdop", 1.2, 99.99),
        ("PDOP", 30.0, 30.1),
        ("SSM", "NO", "NCD"),
        ("ssm", "Normal", "FW"),
        ("lat_ssm", "NO", "functional test"),
        ("good", 1, 0),
        ("ok", "true", "false"),
        ("locked", 1, 0),
        ("gps_lock", "3D", "searching"),
        ("suspect", 0, 1),
        ("held", "false", "true"),
        ("imputed", "no", "yes"),
        ("coast", 0, 1),
        ("dr", 0, 1),
        ("no_position", "P", "N"),
        ("no_position", "false", "Y"),
        ("no_position", 0, 1),
        ("seconds_since_update", 0.4, 45),
        ("age_s", 1.0, 2.1),
        ("gps_age", 1.0, 2.1),
        ("last_pos_age", 1.0, 45.0),
        ("time_since_last_fix", 1.0, 45.0),
        ("numSV", 9, 2),
        ("gps_outage", 0, 1),
        ("gnss_loss", "false", "true"),
        ("unusable", 0, 1),
        ("synthetic", 0, 1),
        ("quality", "good", "BAD"),
        ("sol_type", "NARROW_INT", "NONE"),
        ("crc_ok", 1, 0),
        ("quality_flag", "good", "BAD"),
        ("last_update_s", 1.0, 120.0),
        ("source_of_position", "GPS", "ESTIMATED"),
        ("gps_source", "GPS", "IRS"),
        ("gps_ssm", "NO", "NCD"),
    ],
)
def test_a_row_that_is_not_valid_by_its_own_recording_is_not_judged(tmp_path: Path, name: str, fine: object, bad: object) -> None:
    verdict = stating(tmp_path, name, fine, bad)
    assert (verdict.id, verdict.n_judged, verdict.unread) == ("not_shown", N - 100, [])
    assert stating(tmp_path, name, fine, fine).id == "inside"


@pytest.mark.parametrize(
    ("name", "fine", "bad"),
    [
        ("raim", "OK", "ALERT"),
        ("sda", 2, 0),
        ("exclude", 0, 1),
        ("flag_bad", 0, 1),
        ("bit_fail", 0, 1),
        ("confidence_pct", 99, 0),
        ("crew", "", "MAP SHIFT"),
        ("ecam", "", "NAV ACCUR DOWNGRAD"),
        ("annunc", "", "POS UNCERTAIN"),
        ("fms_msg", "", "VERIFY POSITION"),
        ("meldung", "", "GPS verloren"),
        ("remarques", "", "perte GPS"),
        ("estado", "", "sin señal"),
        ("spoof", 0, 1),
        ("jam", "false", "true"),
        ("anomaly", 0, 2),
        ("err_flag", 0, 1),
        ("hil_exceeded", "no", "yes"),
        ("Integrity failed", 0, 1),
        ("fix_lost", "false", "true"),
        ("nav_error_detected", 0, 1),
        ("gnss_anomaly", "none", "multipath"),
        ("raim_alert", 0, 1),
        ("integrity", "ok", "lost"),
        ("integrity_status", "safe", "caution"),
        ("spoofing_state", 1, 2),
        ("jamming", 0, 1),
        ("fault", "false", "true"),
        ("alarm", "none", "RNP ALERT"),
        ("invalid", 0, 1),
        ("unable_rnp", 0, 1),
        ("unhealthy", 0, 1),
        ("gpsOkBefore", "", 1764300000.0),
        ("sil", 3, 0),
        ("isSuspicious", 0, 1),
        ("untrusted", "false", "true"),
        ("bad_position", 0, 1),
        ("SIL", "2", "0"),
        ("trust", 5, 0),
        ("confidence", "high", "low"),
        ("unable_req_nav_perf", "FALSE", "TRUE"),
        ("anp_alert", 0, 1),
        ("faulty", 0, 1),
        ("gps_interference", "LOW", "HIGH"),
        ("stale", "false", "true"),
        ("raim_flag", 0, 1),
        ("MockLocation", 0, 1),
        ("isFromMockProvider", "false", "true"),
        ("is_spoofed", "false", "true"),
        ("sim", 0, 1),
        ("mi", 0, 1),
        ("navaccuracydowngrad", 0, 1),
        # A column that nothing knows, by the words that stand in it.
        ("msg", "", "GPS PRIMARY LOST"),
        ("message", "GPS PRIMARY OK", "UNABLE REQD NAV PERF-RNP"),
        ("fms_text", "cruise", "nav accur downgrade"),
        ("state_word", "normal", "warning"),
        ("remark", "no alert", "No position"),
        ("eicas", "", "NAV UNAVAIL"),
        ("ecam", "", "FM POS DISAGREE"),
        ("ecam", "", "NOT FOR NAV"),
        ("note", "", "INTEG LOSS"),
        ("remarks", "", "dead reckoning"),
        ("integrity", "ok", "N"),
        ("comment", "", "position not to be used"),
        ("event", "", "GNSS outage"),
        ("EICAS", "", "NAV ACCUR LOW"),
        ("annunciation", "", "HAL EXCEEDED"),
        ("FMA", "NAV", "IRS NAV ONLY"),
        ("remarks", "", "IRS ONLY"),
        ("info", "", "no satellites"),
        ("info", "", "antenna disconnected"),
        ("note", "", "extrapolated"),
        ("note", "ended outage", "simulated data"),
        ("log", "", "\x1b[31mWARNING\x1b[0m"),
    ],
)
def test_an_alert_under_any_of_its_names_is_one(tmp_path: Path, name: str, fine: object, bad: object) -> None:
    verdict = stating(tmp_path, name, fine, bad)
    assert (verdict.id, verdict.n_stated_alert) == ("not_shown", 100)
    assert stating(tmp_path, name, fine, fine).id == "inside"


@pytest.mark.parametrize(
    ("name", "value", "named"),
    [
        ("mode", "LOITER", "mode (loiter)"),
        ("confidence", "0.95", "confidence (0.95)"),
        ("jamming_level", "3", "jamming_level (3)"),
        ("raim", "1", "raim (1)"),
        ("fix_quality", "12", "fix_quality (12)"),
        ("hacc", "300", "hacc"),
        ("p95", "300", "p95"),
        ("navperf", "300", "navperf"),
        ("figure_of_merit", "9", "figure_of_merit"),
        ("rnp_actual", "300", "rnp_actual"),
        ("pte", "300", "pte"),
        ("jam_ind", "200", "jam_ind"),
        ("rtk_status", "x", "rtk_status"),
        ("posAccuracy", "9", "posAccuracy"),
        ("valid", "", "valid (empty)"),
        ("NSE", "3000", "NSE"),
        ("err_h_m", "4000", "err_h_m"),
        ("HFOM", "2000", "HFOM"),
        ("age_s", "old", "age_s (old)"),
        ("age", "900", "age"),
        ("SSM", "1", "SSM (1)"),
        ("note", "outage is over", "note (outage is over)"),
        ("sat_count", "0", "sat_count"),
        ("cdi", "2.5", "cdi"),
    ],
)
def test_what_is_not_understood_is_named(tmp_path: Path, name: str, value: str, named: str) -> None:
    verdict = stating(tmp_path, name, value, value)
    assert verdict.unread == [named]
    assert (
        f"Not understood and not used, though the names speak of accuracy, of integrity or of another position: {named}." in verdict.words
    )


def test_several_statements_count_together(tmp_path: Path) -> None:
    added = {"valid": [1] * N, "gps_valid": [1] * 300 + [0] * 100, "raim": ["ok"] * N, "alarm": ["x"] + ["none"] * (N - 1)}
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, added=added)).summary.verdict
    assert (verdict.n_judged, verdict.n_stated_alert) == (300, 1)


def test_the_transponders_columns_are_no_statements(tmp_path: Path) -> None:
    added = {"alert": ["true"] * N, "spi": ["false"] * N, "squawk": ["7000"] * N}
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, added=added)).summary.verdict
    assert (verdict.id, verdict.n_stated_alert, verdict.unread) == ("inside", 0, [])


@pytest.mark.parametrize(("nac_p", "expected"), [(10, "inside"), (9, "not_shown"), (4, "not_shown"), (0, "not_shown")])
def test_an_accuracy_category_beside_a_covariance_is_compared(tmp_path: Path, nac_p: int, expected: str) -> None:
    """NACp 9 states a 95 % radius of 10 to 30 m (coding of DO-260B); twice the distance root mean square of 3 m is 8.5 m."""
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, added={"nac_p": [nac_p] * N})).summary.verdict
    assert (verdict.id, verdict.n_stated_worse) == (expected, 0 if expected == "inside" else N)


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("nic", 8, "inside"),
        ("nic", 6, "inside"),
        ("nic", 5, "not_shown"),
        ("nic", 0, "not_shown"),
        ("rc", 1111, "inside"),
        ("rc", 1112, "not_shown"),
    ],
)
def test_a_containment_radius_beyond_twice_rnp_is_against_it(tmp_path: Path, name: str, value: int, expected: str) -> None:
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, added={name: [value] * N})).summary.verdict
    assert (verdict.id, verdict.n_stated_uncontained) == (expected, 0 if expected == "inside" else N)


def test_a_typed_sigma_states_what_it_overrules_and_a_larger_one_of_the_file_counts(tmp_path: Path) -> None:
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=40.0), sigma_m=3.0).summary.verdict
    assert (verdict.id, verdict.n_stated_worse) == ("not_shown", N)
    assert "a sigma of 3 m in each axis, typed by the user over the file's own accuracy (sigma 40 to 40 m)" in first_sentence(verdict.words)
    verdict = navbound.analyze(table(tmp_path / "b.csv", N, sigma_m=2.0), sigma_m=3.0).summary.verdict
    assert (verdict.id, verdict.n_stated_worse) == ("inside", 0)
    assert "over the file's own accuracy (sigma 2 to 2 m)" in first_sentence(verdict.words)


def test_an_epu_beside_the_files_own_sigma_counts_under_a_typed_one_too(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", N, added={"epu_m": np.full(N, 200.0)})
    assert navbound.analyze(path, sigma_m=3.0).summary.verdict.n_stated_worse == N


@pytest.mark.parametrize(
    ("added", "sigma_m"),
    [
        ({"sigma_n_m": 40_000.0}, 3.0),
        ({"sigma_n_m": 400.0, "sigma_e_m": ""}, 3.0),
        ({"cov_nn_m2": 160_000.0}, 3.0),
        ({"cov_ee_m2": 160_000.0, "cov_nn_m2": 160_000.0}, 3.0),
        ({"sigma_e_m": 3.0, "sigma_n_m": 3.0, "sdn": 400.0}, None),
        ({"cov_ee_m2": 9.0, "cov_nn_m2": 9.0, "sigma_n_m": 400.0}, None),
        ({"cov_ee_m2": 9.0, "cov_nn_m2": 9.0, "cov_en_m2": 0.0, "sigma_n_m": 400.0}, None),
    ],
)
def test_half_a_statement_of_accuracy_counts(tmp_path: Path, added: dict[str, object], sigma_m: float | None) -> None:
    """One axis, variances without their correlation, two columns of one quantity."""
    for number, n_worse in ((None, N), (1.0, 0)):
        values = {name: value if value == "" or number is None else number for name, value in added.items()}
        path = table(tmp_path / "a.csv", N, sigma_m=None, added={name: [str(value)] * N for name, value in values.items()})
        verdict = navbound.analyze(path, sigma_m=sigma_m).summary.verdict
        assert (verdict.id, verdict.n_stated_worse) == ("not_shown" if n_worse else "inside", n_worse), values


def test_variances_without_their_correlation_make_a_covariance_that_is_worded_so(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", N, sigma_m=None, added={"cov_ee_m2": [160_000.0] * N, "cov_nn_m2": [160_000.0] * N})
    run = navbound.analyze(path)
    assert run.summary.verdict.id == "outside"
    assert any("from the file's variances; axes taken as uncorrelated" in each for each in run.summary.assumptions)


def test_pieces_state_the_same(tmp_path: Path) -> None:
    added = {
        "valid": [1] * 300 + [0] * 100,
        "mode": ["A"] * 200 + ["LOITER"] * 200,
        "raim_alert": [0] * 390 + [1] * 10,
        "nic": [0] * N,
        "hacc": [1] * N,
    }
    path = table(tmp_path / "a.csv", N, added=added)
    for sigma_m in (None, 2.0):
        whole = navbound.analyze(path, sigma_m=sigma_m).summary.verdict
        # Nine pieces: no end of one is where a value changes, and every value is in several.
        assert whole == navbound.analyze(path, sigma_m=sigma_m, piece_rows=47).summary.verdict
        assert whole.unread == ["mode (loiter)", "hacc"]


@pytest.mark.parametrize("name", ["integrity", "raim", "fde"])
@pytest.mark.parametrize("word", ["no", "none", "off"])
def test_no_integrity_is_no_absence_of_an_alert(tmp_path: Path, name: str, word: str) -> None:
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, added={name: [word] * N})).summary.verdict
    assert (verdict.id, verdict.n_stated_alert) == ("not_shown", N)


@pytest.mark.parametrize("first", [True, False])
def test_an_alert_of_a_repeated_row_is_an_alert(tmp_path: Path, first: bool) -> None:
    path = table(tmp_path / "a.csv", N, added={"alert": ["none"] * N})
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    twice = [both for row in rows for both in ((row, row.replace("none", "warning"))[:: 1 if first else -1])]
    path.write_text("\n".join([head, *twice]) + "\n", encoding="utf-8")
    verdict = navbound.analyze(path).summary.verdict
    assert (verdict.id, verdict.n_stated_alert) == ("not_shown", N)


@pytest.mark.parametrize("worse_first", [True, False])
def test_a_hazard_of_a_repeated_row_is_a_hazard(tmp_path: Path, worse_first: bool) -> None:
    rows = []
    for k in range(300):
        good, bad = f"{1_400_000_000 + k},20,25,1.0,1.5", f"{1_400_000_000 + k},20,25,900.0,1.5"
        rows += [good] if not 100 <= k < 112 else [bad, good] if worse_first else [good, bad]
    path = tmp_path / "levels.csv"
    path.write_text("\n".join(["time_s,hpl_m,vpl_m,hpe_m,vpe_m", *rows]) + "\n", encoding="utf-8")
    run = navbound.evaluate(path, levels="APV-I")
    assert run.summary.verdict.id == "not_believable"


@pytest.mark.parametrize("twin", ["HPE_M", "Hpe_m", "hpe_m [m]"])
def test_columns_whose_names_differ_in_writing_alone_are_refused(tmp_path: Path, twin: str) -> None:
    path = tmp_path / "levels.csv"
    rows = [f"{1_400_000_000 + k},20,25,1.0,1.5,900" for k in range(60)]
    path.write_text("\n".join([f"time_s,hpl_m,vpl_m,hpe_m,vpe_m,{twin}", *rows]) + "\n", encoding="utf-8")
    with pytest.raises(FormatError, match="one name in another writing"):
        navbound.evaluate(path, levels="APV-I")
    declared = navbound.evaluate(path, levels="APV-I", columns={"hpe_m": "hpe_m:m"}).summary.verdict
    assert declared.id != "not_believable"


@pytest.mark.parametrize(
    ("name", "value", "beyond"),
    [("xtk", 500.0, False), ("xte", -600.0, True), ("cross_track_nm", 0.5, True), ("lateral_deviation_nm", -0.2, False)],
)
def test_a_deviation_under_any_of_its_names_is_weighed(tmp_path: Path, name: str, value: float, beyond: bool) -> None:
    verdict = stating(tmp_path, name, 5.0 if "nm" not in name else 0.003, value)
    assert (verdict.id, verdict.n_stated_beyond) == (("not_shown", 100) if beyond else ("inside", 0))


def in_objects(tmp_path: Path, name: str, fine: str, bad: str, piece_rows: int | None = None) -> Verdict:
    """Objects of JSON in the fields of a text table."""
    cells = [bad if BAD.start <= k < BAD.stop else fine for k in range(N)]
    return navbound.analyze(table(tmp_path / "a.csv", N, added={name: cells}), piece_rows=piece_rows).summary.verdict


OBJECTS = [
    ("info", '{"status":"ok","integrity":"normal"}', '{"status":"ok","integrity":"FAILED"}'),
    ("health", '{"status":"ok"}', '{"status":"ok","integrity":"FAILED"}'),
    ("info", '{"alert":"none","raim":"ok"}', '{"alert":"none","raim":"fault"}'),
    ("info", '{"note":"no remarks"}', '{"note":"no remarks","gps":"GPS PRIMARY LOST"}'),
    ("flags", '{"is_ok":true,"spoofed":false}', '{"is_ok":true,"spoofed":true}'),
    ("info", '{"receiver":{"valid":true,"name":"a"}}', '{"receiver":{"valid":false,"name":"a"}}'),
    ("info", '[{"valid":true,"of":"a"},{"valid":true,"of":"b"}]', '[{"valid":true,"of":"a"},{"valid":false,"of":"none"}]'),
    ("info", "{'valid': True, 'mode': 'GNSS'}", "{'valid': False, 'mode': 'GNSS'}"),
]


@pytest.mark.parametrize(("name", "fine", "bad"), OBJECTS)
def test_each_key_of_an_object_in_a_field_is_heard(tmp_path: Path, name: str, fine: str, bad: str) -> None:
    verdict = in_objects(tmp_path, name, fine, bad)
    assert verdict.id == "not_shown"
    assert in_objects(tmp_path, name, fine, bad, piece_rows=70).id == "not_shown"
    assert in_objects(tmp_path, name, fine, bad, piece_rows=70).n_judged == verdict.n_judged


@pytest.mark.parametrize(("name", "fine"), [(name, fine) for name, fine, _ in OBJECTS if name != "health"])
def test_keys_of_objects_that_say_nothing_against_a_position_leave_it(tmp_path: Path, name: str, fine: str) -> None:
    assert in_objects(tmp_path, name, fine, fine).id == "inside"


def test_an_alarm_in_one_piece_alone_is_one(tmp_path: Path) -> None:
    """A text that is no statement in most pieces: it ended as a bug of navbound."""
    words = ["GPS PRIMARY LOST" if k == N // 2 else "cruise" for k in range(N)]
    path = table(tmp_path / "a.csv", N, added={"remark": words})
    whole = navbound.analyze(path).summary.verdict
    assert (whole.id, whole.n_stated_alert) == ("not_shown", 1)
    assert navbound.analyze(path, piece_rows=47).summary.verdict == whole


@pytest.mark.parametrize("name", ["nav_accuracy", "NavAccur", "accuracy"])
@pytest.mark.parametrize(("word", "shown"), [("LOW", False), ("Downgraded", False), ("HIGH", True)])
def test_an_accuracy_in_words_is_heard(tmp_path: Path, name: str, word: str, shown: bool) -> None:
    verdict = stating(tmp_path, name, "HIGH", word)
    assert (verdict.id == "inside", verdict.n_stated_alert, verdict.unread) == (shown, 0 if shown else 100, [])


def test_an_accuracy_in_numbers_is_a_length(tmp_path: Path) -> None:
    verdict = stating(tmp_path, "nav_accuracy", 3, 5000)
    assert (verdict.id, verdict.n_stated_worse, verdict.n_stated_alert) == ("not_shown", 100, 0)


@pytest.mark.parametrize(
    ("fine", "bad"),
    [("status=ok;alert=none", "status=ok;alert=none;integrity=failed"), ("no alert | RAIM ok", "no alert | RAIM lost")],
)
def test_a_good_word_of_one_statement_takes_back_no_alarm_of_another(tmp_path: Path, fine: str, bad: str) -> None:
    assert (stating(tmp_path, "info", fine, bad).id, stating(tmp_path, "info", fine, fine).id) == ("not_shown", "inside")
