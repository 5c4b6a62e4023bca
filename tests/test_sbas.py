"""SBAS levels against recorded services: the MSAS hour to the printed digit, outages where the messages say, message 0 obeyed."""

from __future__ import annotations

import csv
import gzip
import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from navbound import sbas, verify
from navbound.errors import FormatError, InputError

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

WEEK_S = 2353 * 604_800
FIRST, LAST = 579_600, 583_200


def geodetic(x: float, y: float, z: float) -> dict[str, Any]:
    """WGS-84 latitude, longitude, height by fixed-point iteration: independent of the package."""
    e2 = 1 / 298.257223563 * (2 - 1 / 298.257223563)
    p = np.hypot(x, y)
    lat = np.arctan2(z, p * (1 - e2))
    for _ in range(20):
        n = 6378137.0 / np.sqrt(1 - e2 * np.sin(lat) ** 2)
        lat = np.arctan2(z + e2 * n * np.sin(lat), p)
    return {"lat_rad": float(lat), "lon_rad": float(np.arctan2(y, x)), "h_m": float(p / np.cos(lat) - n)}


MSAS_USER = geodetic(-3962108.2258, 3381309.0271, 3668678.5241)

# Virtual users of sbas/more: approximate positions in the headers of their files.
YPDN = geodetic(-4077146.1525, 4710655.7553, -1362258.0746)
ZBAA = geodetic(-2187028.0586, 4370327.6863, 4084814.0396)
RKSI = geodetic(-3011006.9521, 4077962.5197, 3858076.9562)


def seconds(first: int = FIRST, last: int = LAST) -> NDArray[np.int64]:
    return (WEEK_S + np.arange(first, last, dtype=np.int64)) * 1_000_000_000


def tow(time_ns: NDArray[np.int64]) -> NDArray[np.int64]:
    return time_ns // 1_000_000_000 - WEEK_S


@pytest.fixture(scope="module")
def folder(shared_data: Path) -> Path:
    return shared_data / "sbas"


@pytest.fixture(scope="module")
def msas(folder: Path) -> sbas.Messages:
    return sbas.read(folder / "msas137_2025046_17h.ems")


@pytest.fixture(scope="module")
def navigation(folder: Path) -> Path:
    return folder / "gps_2025046_17h_rinex3.nav"


@pytest.fixture(scope="module")
def approach(msas: sbas.Messages, navigation: Path) -> sbas.Levels:
    return sbas.protection_levels(msas, navigation, seconds(), **MSAS_USER, mode="pa")


@pytest.fixture(scope="module")
def oracle(folder: Path) -> dict[str, NDArray[np.float64]]:
    with (folder / "msas2025046_pl_1hz.csv").open() as f:
        rows = list(csv.DictReader(f))
    return {name: np.array([float(r[name]) for r in rows]) for name in rows[0]}


def test_the_msas_hour_is_that_of_the_independent_engine(approach: sbas.Levels, oracle: dict[str, NDArray[np.float64]]) -> None:
    assert oracle["tow_s"].size == 3239
    rows = oracle["tow_s"].astype(int) - FIRST
    assert (approach.mode[rows] == "pa").all()
    for name in ("hpl_m", "vpl_m"):
        relative = np.abs(getattr(approach, name)[rows] / oracle[name] - 1)
        # Required: 0.1 % on 99 %, 5 % on all, 1 cm in the median. Met: the oracle's print rounding (5e-5 m of 11.8 m) on every epoch.
        assert relative.max() < 1.5e-5
        assert np.median(np.abs(getattr(approach, name)[rows] - oracle[name])) < 1e-4
    assert (approach.n_sv[rows] == oracle["n_used"]).all()


def test_the_first_approach_epoch_is_the_specifications(approach: sbas.Levels) -> None:
    assert tow(seconds()[approach.mode == "pa"])[0] == 579_743


def test_every_term_is_that_of_the_independent_engine(msas: sbas.Messages, navigation: Path, folder: Path) -> None:
    with (folder / "msas2025046_sigma_every60s.csv").open() as f:
        rows = list(csv.DictReader(f))
    instants = sorted({int(r["tow_s"]) for r in rows})
    result = sbas.satellites(msas, navigation, (WEEK_S + np.array(instants)) * 1_000_000_000, **MSAS_USER, mode="pa")
    at = {(instants[e], p): i for i, (e, p) in enumerate(zip(result.epoch.tolist(), result.prn.tolist(), strict=True))}
    assert set(at) == {(int(r["tow_s"]), int(r["prn"])) for r in rows}
    names = {
        "sigma_total": "sigma_m",
        "sigma_flt": "sigma_flt_m",
        "sigma_uire": "sigma_uire_m",
        "sigma_tropo": "sigma_tropo_m",
        "sigma_air": "sigma_air_m",
    }
    for r in rows:
        i = at[(int(r["tow_s"]), int(r["prn"]))]
        assert np.degrees(result.el_rad[i]) == pytest.approx(float(r["el_deg"]), abs=6e-4)  # three decimals
        assert np.degrees(result.az_rad[i]) == pytest.approx(float(r["az_deg"]), abs=6e-3)
        assert result.delta_udre[i] == pytest.approx(float(r["delta_udre"]), abs=6e-4)
        for theirs, ours in names.items():
            # Four decimals; at the horizon the oracle's solved position, centimetres to metres off, moves the obliquity by 2e-4 m.
            assert getattr(result, ours)[i] == pytest.approx(float(r[theirs]), abs=3e-4), (r, ours)


def test_a_second_in_the_tags_is_noticed(folder: Path, navigation: Path, oracle: dict[str, NDArray[np.float64]]) -> None:
    late = sbas.read(folder / "msas137_2025046_17h.ems", tag="start")
    rows = oracle["tow_s"].astype(int) - FIRST
    levels = sbas.protection_levels(late, navigation, seconds(), **MSAS_USER, mode="pa")
    assert (np.abs(levels.vpl_m[rows] / oracle["vpl_m"] - 1) < 0.01).mean() < 0.9


def test_three_logs_of_one_hour_hold_the_same_messages(folder: Path, msas: sbas.Messages) -> None:
    raw = sbas.read(folder / "046r_sbas.txt.gz")
    own = raw.of(137)
    # The EMS file tags one second later than the end (its origin note says so).
    assert (own.time_ns + 1_000_000_000 == msas.time_ns).all()
    assert (own.data == msas.data).all()
    ended = sbas.read(folder / "more" / "prn137_2025046_17h.ems.gz")
    assert (ended.time_ns == own.time_ns).all()
    assert (ended.data == own.data).all()
    assert raw.format == "RTKLIB sbs"
    assert msas.format == "EMS"
    # Everything that is no L1 message of the log is counted with its reason.
    with gzip.open(folder / "046r_sbas.txt.gz", "rt") as f:
        assert raw.time_ns.size + len(raw.refused) == sum(1 for line in f if line.strip())


def test_decoding_gives_every_type_of_the_log(folder: Path, msas: sbas.Messages) -> None:
    decoded = sbas.decode(msas)
    kinds = {d.type for d in decoded}
    assert kinds == {1, 2, 3, 4, 7, 9, 10, 17, 18, 25, 26, 28, 63}
    mask = next(d for d in decoded if d.type == 1).fields
    assert mask["prn"] == [*range(1, 33), 137]
    geo = next(d for d in decoded if d.type == 9).fields
    assert np.linalg.norm(geo["position_ecef_m"]) == pytest.approx(42_164_000, rel=2e-3)  # the geostationary radius
    others = {d.type for prn in ("122", "134") for d in sbas.decode(sbas.read(folder / "more" / f"prn{prn}_2025046_17h.ems.gz"))}
    assert {0, 12, 27, 62} <= others


@pytest.mark.parametrize("prn", [122, 130])
def test_message_0_obeyed_leaves_not_one_solution(folder: Path, navigation: Path, prn: int) -> None:
    log = sbas.read(folder / "more" / f"prn{prn}_2025046_17h.ems.gz")
    place = YPDN if prn == 122 else ZBAA
    obeyed = sbas.protection_levels(log, navigation, seconds(), **place)
    first = tow(log.time_ns[[d.type == 0 for d in sbas.decode(log)]])[0]
    assert first - FIRST < 10
    assert (obeyed.mode == "").all()
    assert np.isnan(obeyed.hpl_m).all()
    assert any("do not use" in r for r in obeyed.reasons)
    # The explicit, labelled way round it: the signal does carry a service, and every level says what it is.
    tested = sbas.protection_levels(log, navigation, seconds(), **place, test_signal=True)
    assert (tested.mode == "pa").mean() > 0.5
    assert set(tested.status.tolist()) <= {"degraded", "not_available"}
    assert tested.test_signal


def test_the_korean_service_gives_approach_levels_at_seoul(folder: Path, navigation: Path) -> None:
    log = sbas.read(folder / "more" / "prn134_2025046_17h.ems.gz")
    levels = sbas.protection_levels(log, navigation, seconds(), **RKSI)
    good = levels.mode == "pa"
    assert good[600:].mean() > 0.95
    assert np.median(levels.hpl_m[good]) < 40
    assert np.median(levels.vpl_m[good]) < 50
    # Message 27 makes the user outside its regions pay: the same service seen from northern Australia.
    far = sbas.satellites(log, navigation, seconds(580_800, 580_801), **YPDN, mode="npa")
    near = sbas.satellites(log, navigation, seconds(580_800, 580_801), **RKSI, mode="npa")
    assert near.delta_udre.size > 0
    assert set(near.delta_udre.tolist()) != set(far.delta_udre.tolist())


def test_the_damaged_hour_stops_and_starts_where_the_messages_say(folder: Path, navigation: Path) -> None:
    whole = sbas.read(folder / "more" / "prn137_2025046_17h.ems.gz")
    damaged = sbas.read(folder / "more" / "prn137_loss_2025046_17h.ems.gz")
    assert damaged.refused
    levels = sbas.protection_levels(damaged, navigation, seconds(), **MSAS_USER)
    stop = int(tow(damaged.time_ns[[d.type == 0 for d in sbas.decode(damaged)]])[0])
    at = tow(seconds())
    # From the second after the message on, for a minute, nothing; then as after a start.
    silent = (at > stop) & (at <= stop + 60)
    assert (levels.mode[silent] == "").all()
    assert levels.mode[at == stop] != ""
    assert (levels.mode[at > stop + 60] == "pa").any()
    undamaged = sbas.protection_levels(whole, navigation, seconds(), **MSAS_USER)
    assert (levels.mode == "pa").sum() < (undamaged.mode == "pa").sum()
    # Every other second without approach follows from a run of four lost messages or more: it begins five seconds after the end of the
    # last one heard, and ends when each satellite has an indicator of its own again (and, where the correction was lost, two corrections
    # for its rate), 13 s after the run at the latest.
    lost = np.setdiff1d(tow(whole.time_ns), tow(damaged.time_ns))
    runs = np.split(lost, np.flatnonzero(np.diff(lost) > 1) + 1)
    long = [(int(run[0]), int(run[-1])) for run in runs if run.size >= 4]
    assert len(long) >= 2
    out = (levels.mode != "pa") & (at > 579_742) & ((at <= stop) | (at > stop + 240))
    explained = np.zeros_like(out)
    for first, last in long:
        explained |= (at >= first + 4) & (at <= last + 13)
        silence = (at >= first + 4) & (at <= last + 1) & (at > 579_742)
        assert not (levels.mode[silence] == "pa").any(), (first, last)
    assert not (out & ~explained).any()


def test_fast_corrections_cut_off_end_approach_after_twelve_seconds(msas: sbas.Messages, navigation: Path) -> None:
    cut = 581_000
    kinds = np.array([d.type for d in sbas.decode(msas)])
    keep = ~(np.isin(kinds, [2, 3, 4, 5]) & (tow(msas.time_ns) > cut))
    levels = sbas.protection_levels(
        replace(msas, time_ns=msas.time_ns[keep], prn=msas.prn[keep], data=msas.data[keep]), navigation, seconds(), **MSAS_USER
    )
    last_pa = tow(seconds()[levels.mode == "pa"])[-1]
    last_npa = tow(seconds()[levels.mode == "npa"])[-1]
    # The last indicators of the four satellites that make a solution end within the 6 s before the cut.
    assert cut + 12 - 6 <= last_pa <= cut + 12
    assert cut + 18 - 6 <= last_npa <= cut + 18


def test_real_egnos_with_a_third_of_the_messages_missing(folder: Path) -> None:
    log = sbas.read(folder / "more" / "egnos_2012299.ems")
    start, end = int(log.time_ns[0]), int(log.time_ns[-1])
    instants = np.arange(start, end, 3_000_000_000, dtype=np.int64)
    place = geodetic(4245466.5, 701695.0, 4692747.5)  # of the observation file, a solution of its own
    computed = {p: sbas.protection_levels(log.of(p), folder / "more" / "gps_2012299_12h.12N", instants, **place) for p in (120, 126)}
    for p, levels in computed.items():
        heard = log.of(p).time_ns
        with_level = instants[levels.mode != ""]
        assert with_level.size > 0, p
        assert with_level[0] > heard[0]
        assert with_level[-1] <= heard[-1] + 18_000_000_000
        good = levels.mode != ""
        assert (levels.hpl_m[good] > 0).all()
        assert np.isnan(levels.hpl_m[~good]).all()


def test_users_share_what_is_the_same_for_all(msas: sbas.Messages, navigation: Path) -> None:
    lat = MSAS_USER["lat_rad"] + np.radians(np.linspace(-3.0, 3.0, 7))
    instants = seconds(581_000, 581_020)
    grid = sbas.protection_levels(msas, navigation, instants[:, None], lat_rad=lat, lon_rad=MSAS_USER["lon_rad"], h_m=0.0)
    assert grid.hpl_m.shape == (20, 7)
    alone = sbas.protection_levels(msas, navigation, instants[::-1], lat_rad=lat[5], lon_rad=MSAS_USER["lon_rad"], h_m=0.0)
    assert (grid.hpl_m[::-1, 5] == alone.hpl_m).all()
    assert (grid.vpl_m[::-1, 5] == alone.vpl_m).all()


def test_a_poorer_receiver_and_a_higher_mask_never_lower_a_level(msas: sbas.Messages, navigation: Path) -> None:
    args = (msas, navigation, seconds(581_000, 581_060))
    plain = sbas.protection_levels(*args, **MSAS_USER)
    assert (sbas.protection_levels(*args, **MSAS_USER, noise_m=1.0).vpl_m > plain.vpl_m).all()
    assert (sbas.protection_levels(*args, **MSAS_USER, mask_rad=np.radians(15.0)).vpl_m >= plain.vpl_m).all()


def test_wrong_arguments_are_named(msas: sbas.Messages, navigation: Path, folder: Path, tmp_path: Path) -> None:
    t = seconds(581_000, 581_002)
    with pytest.raises(InputError, match="mode"):
        sbas.protection_levels(msas, navigation, t, **MSAS_USER, mode="cat-i")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="mask_rad"):
        sbas.protection_levels(msas, navigation, t, **MSAS_USER, mask_rad=float("nan"))
    with pytest.raises(InputError, match="noise_m"):
        sbas.protection_levels(msas, navigation, t, **MSAS_USER, noise_m=-1.0)
    with pytest.raises(InputError, match=r"lat_rad\[1\]"):
        sbas.protection_levels(msas, navigation, t, lat_rad=[0.6, 2.0], lon_rad=2.4, h_m=0.0)
    with pytest.raises(InputError, match="h_m"):
        sbas.protection_levels(msas, navigation, t, lat_rad=0.6, lon_rad=2.4, h_m=np.nan)
    with pytest.raises(InputError, match="time_ns"):
        sbas.protection_levels(msas, navigation, [1.0], **MSAS_USER)
    with pytest.raises(InputError, match="PRNs"):
        sbas.protection_levels(sbas.read(folder / "more" / "egnos_2012299.ems"), navigation, t, **MSAS_USER)
    damaged = msas.data.copy()
    damaged[3, 7] ^= 1
    with pytest.raises(InputError, match=r"data\[3\]"):
        sbas.decode(replace(msas, data=damaged))
    with pytest.raises(InputError, match="tag"):
        sbas.read(navigation, tag="middle")  # type: ignore[arg-type]
    with pytest.raises(FormatError, match=r"nowhere\.ems: No such file"):
        sbas.read(tmp_path / "nowhere.ems")
    with pytest.raises(FormatError, match="neither EMS"):
        sbas.read(navigation)
    broken = tmp_path / "x.nav"
    broken.write_text("nothing")
    with pytest.raises(FormatError):
        sbas.protection_levels(msas, broken, t, **MSAS_USER)


def test_every_case_of_the_reference_stands_in_the_vectors(shared_data: Path) -> None:
    reference = json.loads((shared_data.parent / "reference" / "ref-sbas-kpi.json").read_text())["do229"]
    cases = verify.load(verify.VECTORS / "sbas-do229.toml").cases
    assert [(c.expect["hpl_pa_m"], c.expect["vpl_m"]) for c in cases] == [(r["HPL_PA"], r["VPL"]) for r in reference]


def test_terms_outside_their_domain_are_named() -> None:
    sky: dict[str, Any] = {"az_rad": [0.0, 1.5, 3.0, 4.5, 5.5], "el_rad": [1.4, 0.5, 0.4, 0.6, 0.3], "x_pp": 0.5, "y_pp": 0.5}
    four = np.full((5, 4), 5)
    assert sbas.levels_from_terms(**sky, udrei=5, givei=four).vpl_m > 0
    for name, value in [
        ("udrei", 14),
        ("udrei", 2.5),
        ("givei", np.full((5, 4), 15)),
        ("delta_udre", 0.9),
        ("e_ltc_m", np.nan),
        ("x_pp", 1.5),
    ]:
        with pytest.raises(InputError, match=name):
            sbas.levels_from_terms(**{**sky, "udrei": 5, "givei": four, name: value})
    with pytest.raises(InputError, match="satellites that determine"):
        sbas.levels_from_terms(az_rad=[0.0, 1.0, 2.0], el_rad=[0.5, 0.5, 0.5], x_pp=0.5, y_pp=0.5, udrei=5, givei=np.full((3, 4), 5))
