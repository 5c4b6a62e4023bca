"""Plans whose levels are those of SBAS, from messages that were sent before."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np
import pytest

from navbound import gnss, sbas
from navbound.errors import FormatError
from navbound.run.expected.flight import Expected, predict_flight
from navbound.time import gps_ns

if TYPE_CHECKING:
    from pathlib import Path

LOG, ORBITS = "msas137_2025046_17h.ems", "gps_2025046_17h_rinex3.nav"
ROUTE = "name,lat_deg,lon_deg\nRJFF,33.5859,130.4507\nKOCHI,33.55,133.3\nRJOO,34.7855,135.4382\n"
DEPARTURE = "2025-02-15T17:09:42Z"


def head(folder: Path, departure: str = DEPARTURE) -> str:
    return f"""flight = "beijing-shanghai"
departure_utc = {departure}
duration_min = 45
route = "route.csv"
orbits = ["{folder}/{ORBITS}"]
stations = []
departure_shifts_min = [0, 60]
[[requirements]]
name = "en route"
rnp_nm = 1
"""


def log(folder: Path) -> str:
    return f'[sbas]\nmessages = "{folder}/{LOG}"\nnavigation = ["{folder}/{ORBITS}"]\n'


MONITOR = '[equipment]\nmonitor = "sbas"\n'


def expected(folder: Path, text: str) -> Expected:
    (folder / "route.csv").write_text(ROUTE, encoding="utf-8")
    file = folder / "plan.toml"
    file.write_text(text, encoding="utf-8")
    return predict_flight(file, with_hold=False)


@pytest.fixture(name="folder")
def _folder(shared_data: Path) -> Path:
    return shared_data / "sbas"


def test_the_levels_are_those_of_the_messages_at_the_same_instants(folder: Path, tmp_path: Path) -> None:
    """Bit for bit, as the part of RAIM is that of ``navbound predict raim``."""
    result = expected(tmp_path, head(folder) + MONITOR + log(folder))
    rows = result.shown
    start = gps_ns(datetime(2025, 2, 15, 17, 9, 42, tzinfo=UTC))
    own = sbas.protection_levels(
        sbas.read(folder / LOG).of(137),
        [folder / ORBITS],
        start + (rows["time_s"].to_numpy() * 1e9).astype(np.int64),
        lat_rad=rows["lat_rad"].to_numpy(),
        lon_rad=rows["lon_rad"].to_numpy(),
        h_m=rows["h_m"].to_numpy(),
        mask_rad=np.radians(7.0),  # of the shipped flight's receiver
    )
    np.testing.assert_array_equal(rows["hpl_m"].to_numpy(), own.hpl_m)
    np.testing.assert_array_equal(rows["n_sv_monitor"].to_numpy(), own.n_sv)
    assert np.isfinite(own.hpl_m).all()
    assert {leg.p_level for leg in result.record.legs} == {1.0}
    assert any("sent on the same day at the same time of day" in sentence for sentence in result.record.assumptions)


def test_messages_of_another_day_are_taken_at_the_same_time_of_day(folder: Path, tmp_path: Path) -> None:
    later = expected(tmp_path, head(folder, "2025-02-16T17:09:42Z") + MONITOR + log(folder))
    assert any("sent 1 day before at the same time of day" in sentence for sentence in later.record.assumptions)
    (tmp_path / "same").mkdir()
    same = expected(tmp_path / "same", head(folder) + MONITOR + log(folder))
    # The satellites of the filter are another day's, and it steers: the aircraft is some millimetres elsewhere.
    np.testing.assert_allclose(later.shown["hpl_m"].to_numpy(), same.shown["hpl_m"].to_numpy(), rtol=1e-7)


def test_outside_the_log_there_is_no_level(folder: Path, tmp_path: Path) -> None:
    """The log ends at 17:59:42; half an hour later a quarter of the flight is left of it."""
    result = expected(tmp_path, head(folder, "2025-02-15T17:39:42Z") + MONITOR + log(folder))
    time_s, level = result.shown["time_s"].to_numpy(), result.shown["hpl_m"].to_numpy()
    assert np.isfinite(level[time_s < 1200]).all()
    # Corrections are in force for some minutes after the last message (time-outs of DO-229, 360 s at most).
    assert np.isnan(level[time_s > 1200 + 360]).all()
    assert {hole.reason for hole in result.record.holes} == {"service"}
    shift = {s.shift_s: s for s in result.record.shifts}
    assert shift[3600.0].p_level == 0.0


def test_a_satellite_out_by_notice_is_not_in_the_level(folder: Path, tmp_path: Path) -> None:
    whole = expected(tmp_path, head(folder) + MONITOR + log(folder)).shown
    (tmp_path / "out").mkdir()
    at = gps_ns(datetime(2025, 2, 15, 17, 30, tzinfo=UTC))
    names = gnss.read_navigation(folder / ORBITS).orbits("gps", at).satellite
    lower = 0
    for name in names:
        text = head(folder) + MONITOR + log(folder) + f'[[notices]]\nsatellites = ["{name}"]\n'
        less = expected(tmp_path / "out", text).shown
        n = whole["n_sv_monitor"].to_numpy() - less["n_sv_monitor"].to_numpy()
        assert set(np.unique(n)) <= {0, 1}, name
        # Fewer satellites, never a smaller level.
        assert (less["hpl_m"].to_numpy()[n == 1] >= whole["hpl_m"].to_numpy()[n == 1]).all()
        # The filter has a satellite less, and it steers: the aircraft is some millimetres elsewhere.
        np.testing.assert_allclose(less["hpl_m"].to_numpy()[n == 0], whole["hpl_m"].to_numpy()[n == 0], rtol=1e-7)
        lower += bool((n == 1).any())
        if lower == 3:
            break
    assert lower == 3


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (MONITOR, "needs [sbas] with messages that were sent before"),
        ("{log}", 'is for equipment.monitor = "sbas"'),
        (MONITOR + '[sbas]\nmessages = "none.ems"\nnavigation = ["x"]\n', "sbas.messages"),
        (MONITOR + '[sbas]\nmessages = "{folder}/{name}"\nnavigation = ["none.nav"]\n', "sbas.navigation"),
        (MONITOR + '[sbas]\nmessages = "{folder}/{name}"\nnavigation = ["{folder}/{orbits}"]\nprn = 120\n', "sbas.messages"),
        (MONITOR + '[sbas]\nmessages = "x"\nnavigation = []\n', "sbas.navigation"),
        ('[equipment]\nmonitor = "spas"\n', "spas"),
    ],
)
def test_what_is_refused(text: str, says: str, folder: Path, tmp_path: Path) -> None:
    filled = text.format(log=log(folder), folder=folder, name=LOG, orbits=ORBITS)
    with pytest.raises(FormatError) as refusal:
        expected(tmp_path, head(folder) + filled)
    assert says in str(refusal.value)


def test_a_flight_of_no_date_meets_no_messages(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="sbas needs departure_utc"):
        expected(tmp_path, head(folder).replace(f"departure_utc = {DEPARTURE}\n", "") + MONITOR + log(folder))


def test_what_of_the_log_is_lost_is_reported_with_the_levels(folder: Path, tmp_path: Path) -> None:
    """A hole of ten minutes and three lines that are no messages."""
    lines = (folder / LOG).read_text().splitlines()
    kept = [line for k, line in enumerate(lines) if not 1200 <= k < 1800]
    for k in (100, 200, 300):
        kept[k] = kept[k][:30] + "Z" * 10 + kept[k][40:]
    (tmp_path / "cut.ems").write_text("\n".join(kept) + "\n")
    text = head(folder) + MONITOR + log(folder).replace(f"{folder}/{LOG}", "cut.ems")
    words = " ".join(expected(tmp_path, text).record.assumptions)
    assert "cut.ems: " in words
    assert "gaps of more than 4 s, the longest 601 s" in words
    assert "3 lines of the log refused as damaged" in words
