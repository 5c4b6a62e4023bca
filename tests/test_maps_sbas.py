"""SBAS maps: who hears the service, when its log begins to serve, and why a user has no level."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from navbound import maps, sbas
from navbound.errors import FormatError, InputError
from navbound.maps.service import WARM_UP_S
from navbound.maps.sources import Times

EUROPE = maps.Grid.degrees(5.0, (20.0, 75.0, -40.0, 50.0))
WORLD = maps.Grid.degrees(15.0)
RADIUS_M = 42_164_000.0
"""Of a geostationary orbit."""


def made(folder: Path, log: str, *, step_s: float = 300.0, grid: maps.Grid = WORLD, **options: object) -> maps.Map:
    navigation = "gps_2012299_12h.12N" if log.startswith("egnos") else "gps_2025046_17h.25N"
    times = Times(step_s=step_s)
    return maps.make(
        "sbas",
        grid=grid,
        messages=folder / log,
        navigation=(folder / navigation,),
        times=times,
        **options,  # type: ignore[arg-type]
    )


@pytest.fixture(scope="session")
def more(shared_data: Path) -> Path:
    return shared_data / "sbas" / "more"


def outcomes(made_map: maps.Map) -> dict[str, float]:
    return {one.name: one.share for one in made_map.summary.outcomes}


def test_a_user_hears_a_satellite_above_the_mask(more: Path) -> None:
    """The elevation of a geostationary satellite over a sphere: tan e = (cos c - r/R) / sin c, c the angle at the Earth's centre."""
    made_map = made(more, "prn137_2025046_17h.ems.gz", mode="npa").points
    # Message 9 of the log puts PRN 137 at 127.03° E; here it is worked out from the numbers of the message.
    x, y, z = -25397444.16, 33665308.96, -19613.2
    lat, lon = made_map["lat_rad"].to_numpy(), made_map["lon_rad"].to_numpy()
    up = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    cosine = np.array([x, y, z]) / math.hypot(x, y, z) @ up
    elevation = np.arctan2(cosine - 6_371_000.0 / RADIUS_M, np.sqrt(1 - cosine**2))
    # The sphere is some 0.2° off the ellipsoid; cells nearer to the mask than that decide nothing.
    clear = np.abs(elevation - math.radians(5.0)) > math.radians(0.3)
    assert clear.sum() > 250
    heard = elevation > math.radians(5.0)
    assert (made_map["p_no_signal"].to_numpy() == 1.0)[clear & ~heard].all()
    assert (made_map["p_no_signal"].to_numpy() == 0.0)[clear & heard].all()
    assert (made_map["n_sv_least"].to_numpy() == 0)[clear & ~heard].all()


@pytest.mark.parametrize("log", ["prn137_2025046_17h.ems.gz", "prn137_loss_2025046_17h.ems.gz", "prn130_2025046_17h.ems.gz"])
def test_every_user_and_instant_has_one_outcome(more: Path, log: str) -> None:
    made_map = made(more, log, mode="pa")
    shares = outcomes(made_map)
    assert sum(shares.values()) == pytest.approx(1.0, abs=1e-12)
    causes = [c.name for c in maps.KINDS["sbas"].causes]
    assert (made_map.points.select("p_available", *causes).sum_horizontal() <= 1 + 1e-12).all()
    assert shares["p_no_signal"] > 0.5, "more than half of the Earth does not see a geostationary satellite"


def test_the_service_area_of_egnos_is_the_one_its_messages_declare(more: Path) -> None:
    """Message 27 of the log: outside 20..70° N, 40° W..40° E every error bound of a satellite is a hundred times as large."""
    made_map = made(more, "egnos_2012299.ems", prn=120, grid=EUROPE)
    lat, lon = np.degrees(made_map.points["lat_rad"].to_numpy()), np.degrees(made_map.points["lon_rad"].to_numpy())
    available = made_map.points["p_available"].to_numpy()
    inside = (lat > 20) & (lat < 70) & (lon > -40) & (lon < 40)
    assert available[~inside].max() == 0.0
    # The core of the service: from Lisbon to Warsaw, from Sicily to southern Norway.
    core = (lat > 37) & (lat < 58) & (lon > -9) & (lon < 21)
    assert core.sum() >= 24
    assert available[core].min() == 1.0


def test_a_log_serves_from_its_warm_up_to_its_end(more: Path) -> None:
    log = more / "prn137_2025046_17h.ems.gz"
    heard = sbas.read(log)
    words = " ".join(made(more, log.name, grid=maps.Grid.degrees(5.0, (30.0, 40.0, 130.0, 140.0))).summary.assumptions)
    # 3599 s from the first to the last message: 2999 s are left, ten steps of 300 s.
    assert "10 instants, 300 s apart, from 2025-02-15 17:09:42 UTC on" in words
    assert "PRN 137: 3600 messages" in words
    lat, lon = math.radians(35.0), math.radians(139.0)
    begin = int(heard.time_ns.min()) + np.array([0, round(WARM_UP_S * 1e9)])
    levels = sbas.protection_levels(heard, more / "gps_2025046_17h.25N", begin, mode="pa", lat_rad=lat, lon_rad=lon, h_m=0.0)
    assert levels.status.tolist() == ["not_available", "ok"], "the warm-up is not long enough, or not needed"


def test_what_a_log_lacks_is_reported(more: Path) -> None:
    lossy = " ".join(made(more, "prn137_loss_2025046_17h.ems.gz").summary.assumptions)
    assert "5 gaps of more than 4 s, the longest 21 s" in lossy
    assert "5 lines of the log refused as damaged" in lossy
    assert "1 of them saying that the service is not to be used" in lossy
    test_signal = made(more, "prn130_2025046_17h.ems.gz", mode="npa")
    assert "600 of them saying" in " ".join(test_signal.summary.assumptions)
    assert test_signal.summary.available_mean == 0.0
    assert outcomes(test_signal)["p_no_service"] == pytest.approx(1 - outcomes(test_signal)["p_no_signal"], abs=1e-12)


def test_instants_beyond_the_log_have_no_level_and_are_counted(more: Path) -> None:
    log = more / "prn137_2025046_17h.ems.gz"
    last = int(sbas.read(log).time_ns.max())
    late = Times(last - 300 * 10**9, duration_s=1_800.0, step_s=300.0)
    place = maps.Grid.degrees(5.0, (33.0, 38.0, 137.0, 142.0))
    made_map = maps.make("sbas", grid=place, messages=log, navigation=(more / "gps_2025046_17h.25N",), times=late)
    # Instants at -300 and 0 s of the end are within; of the four after it each comes later than any correction may be old.
    assert "4 of the instants are outside the log" in " ".join(made_map.summary.assumptions)
    assert outcomes(made_map)["p_available"] == pytest.approx(2 / 6, abs=1e-12)
    assert outcomes(made_map)["p_no_service"] == pytest.approx(4 / 6, abs=1e-12)


@pytest.mark.parametrize(("prn", "named"), [(None, "several satellites, 120, 126"), (129, "one of 120, 126")])
def test_where_there_are_several_senders_one_has_to_be_named(more: Path, prn: int | None, named: str) -> None:
    with pytest.raises(InputError, match=named):
        made(more, "egnos_2012299.ems", prn=prn)


def test_what_is_no_message_log_is_refused(more: Path) -> None:
    with pytest.raises(FormatError, match="25N"):
        made(more, "gps_2025046_17h.25N")


def test_without_a_place_of_the_satellite_everyone_hears_it_and_the_map_says_so(more: Path, tmp_path: Path) -> None:
    kept = [
        line
        for line in (more / "egnos_2012299.ems").read_text(encoding="ascii").splitlines()
        if line.split()[0] == "120" and line.split()[7] not in {"9", "17"}
    ]
    assert len(kept) == 1255 - 13 - 6
    log = tmp_path / "egnos_no_place.ems"
    log.write_text("\n".join(kept) + "\n", encoding="ascii")
    made_map = maps.make("sbas", grid=EUROPE, messages=log, navigation=(more / "gps_2012299_12h.12N",), mode="npa")
    assert outcomes(made_map)["p_no_signal"] == 0.0
    assert "does not say where its satellite is" in " ".join(made_map.summary.assumptions)


def test_a_higher_mask_narrows_the_footprint(more: Path) -> None:
    low, high = (outcomes(made(more, "prn137_2025046_17h.ems.gz", mask_rad=math.radians(m)))["p_no_signal"] for m in (5.0, 20.0))
    # A cap of the angle arccos(R cos e / r) - e: 76.3° at 5°, 61.8° at 20°, (1 - cos c) / 2 of the Earth. Cells of 15°
    # round it by a few per cent.
    assert low == pytest.approx(1 - 0.382, abs=0.03)
    assert high == pytest.approx(1 - 0.264, abs=0.03)
