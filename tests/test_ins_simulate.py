"""Simulated sensors as the rest of navbound sees them; their statistics are proven in crates/simulate/tests/sensors."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest

from ins_fixture import true_start
from navbound import FormatError, InputError, gnss, ins, scenario
from navbound.scenario.sensors import Imu

if TYPE_CHECKING:
    from numpy.typing import NDArray

ROOT = Path(__file__).parents[1]
TABLES = ("truth", "imu", "satellites", "dme", "vor", "baro", "clock")


def short(name: str = "beijing-shanghai", **sensors: object) -> scenario.Scenario:
    """Ten samples a second are enough to look at."""
    loaded = scenario.load(name)
    assert loaded.sensors is not None
    return loaded.model_copy(update={"sensors": loaded.sensors.model_copy(update={"rate_hz": 10} | sensors)})


@pytest.fixture(scope="module")
def sensed() -> ins.Sensed:
    return ins.simulate(short(path="planned"))


def ecef(sensed: ins.Sensed) -> pl.DataFrame:
    """Truth in Earth-fixed axes, by the textbook's closed form."""
    t = sensed.truth
    lat, lon, h = (t[c].to_numpy() for c in ("truth_lat_rad", "truth_lon_rad", "truth_h_m"))
    e2 = (2 - 1 / 298.257223563) / 298.257223563
    n = 6378137.0 / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    x, y, z = (n + h) * np.cos(lat) * np.cos(lon), (n + h) * np.cos(lat) * np.sin(lon), (n * (1 - e2) + h) * np.sin(lat)
    return pl.DataFrame({"time_ns": t["time_ns"], "x": x, "y": y, "z": z})


def test_every_column_is_in_the_glossary(sensed: ins.Sensed) -> None:
    glossary = (ROOT / "docs" / "notation.md").read_text(encoding="utf-8")
    declared = set(re.findall(r"`([a-z0-9_]+)`", glossary[glossary.index("## The epoch table") :]))
    for name in TABLES:
        table = getattr(sensed, name)
        assert table.height > 0
        assert set(table.columns) <= declared, name
        assert table.null_count().sum_horizontal().item() == 0


def test_rows_come_when_they_should(sensed: ins.Sensed) -> None:
    begin = sensed.scenario.start_ns
    assert sensed.imu["time_ns"].to_list() == [begin + k * 10**8 for k in range(1, 70811)]
    assert sensed.truth["time_ns"].to_list() == [begin + k * 10**9 for k in range(7082)]
    assert sensed.baro["time_ns"].to_list() == [begin + k * 10**9 for k in range(1, 7082)]
    seldom = ins.simulate(sensed.scenario, truth_interval_s=100.0).truth
    assert seldom.equals(sensed.truth.gather_every(100))


def test_ranges_are_distances_clock_and_errors_of_the_stated_size(sensed: ins.Sensed) -> None:
    result = (
        sensed.satellites.filter(pl.col("satellite").str.starts_with("G")).join(ecef(sensed), on="time_ns").join(sensed.clock, on="time_ns")
    )
    line = result.select(pl.col("sv_x_m") - pl.col("x"), pl.col("sv_y_m") - pl.col("y"), pl.col("sv_z_m") - pl.col("z")).to_numpy()
    residual = result["range_m"].to_numpy() - np.linalg.norm(line, axis=1) - result["clock_m"].to_numpy()
    sigma = np.hypot(result["sigma_white_m"].to_numpy(), result["sigma_correlated_m"].to_numpy())
    # Some 30 satellites rise, the slow parts of 1 m and 2 m at the zenith forget in half an hour to two hours: about 60 independent errors.
    assert abs(np.mean((residual / sigma) ** 2) - 1) < 4 * np.sqrt(2 / 60)
    assert np.abs(residual / sigma).max() < 6


def test_an_error_free_run_of_the_mechanization_closes_to_a_metre_in_two_hours(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    text = 'base = "beijing-shanghai-seed"\n[sensors.imu]\ngrade = "perfect"\n'
    file.write_text(text, encoding="utf-8")
    loaded = scenario.load(file)
    assert loaded.sensors is not None
    bare = loaded.sensors.model_copy(update={"gnss": None, "dme": None, "vor": None, "baro": None})
    flown = ins.simulate(loaded.model_copy(update={"sensors": bare}))
    start = true_start(flown)
    imu = ins.Imu(
        time_ns=flown.imu["time_ns"].to_numpy(),
        angle_rad=flown.imu.select("angle_x_rad", "angle_y_rad", "angle_z_rad").to_numpy(),
        velocity_mps=flown.imu.select("velocity_x_mps", "velocity_y_mps", "velocity_z_mps").to_numpy(),
        interval_s=flown.imu["interval_s"].to_numpy(),
    )
    result = ins.mechanize(imu, start).position[199::200]
    truth = flown.truth[1:].select("truth_lat_rad", "truth_lon_rad", "truth_h_m").to_numpy()
    # Metres on a sphere: a per cent of a metre at most.
    apart = (result - truth) * np.array([6.37e6, 6.37e6 * np.cos(0.6), 1.0])
    assert np.abs(apart).max() < 1.0


PERFECT = Imu(**dict.fromkeys(Imu.model_fields, 0.0) | {"in_run_time_s": 3600.0})


def bend(n: int = 90) -> NDArray[np.float64]:
    """Straight on, a quarter turn to the right in 15 s, straight on; 10 m/s."""
    turn = np.clip((np.arange(n) - 30.0) / 15.0, 0.0, 1.0) * np.pi / 2
    north, east = np.cumsum(10.0 * np.cos(turn)), np.cumsum(10.0 * np.sin(turn))
    return np.stack([0.72 + north / 6.3628e6, 0.04 + east / (6.3858e6 * np.cos(0.72)), np.full(n, 50.0)], axis=-1)


def test_a_way_on_wheels_closes_and_does_not_bank() -> None:
    put = bend()
    rolled = ins.roll(0, put, PERFECT, rate_hz=50)
    truth = rolled.truth.select("truth_lat_rad", "truth_lon_rad", "truth_h_m").to_numpy()
    metres = np.array([6.3628e6, 6.3858e6 * np.cos(0.72), 1.0])
    # The spline's second moment cuts a corner of curvature by centimetres where the turn begins.
    assert np.abs((truth - put) * metres).max() < 0.15
    assert rolled.truth["roll_rad"].abs().max() == 0.0
    # v² / R: 10 m/s and a quarter turn in 15 s.
    assert rolled.truth["force_y_mps2"][37] == pytest.approx(10.0 * np.pi / 30.0, rel=2e-3)
    velocity, attitude = (
        tuple(rolled.truth.select(names).row(0))
        for names in (["vel_n_mps", "vel_e_mps", "vel_d_mps"], ["roll_rad", "pitch_rad", "heading_rad"])
    )
    track = ins.mechanize(ins.Imu.of_table(rolled.imu), ins.Start(0, tuple(truth[0]), velocity, attitude))
    # Increments are exact to fourth order and the mechanization to third: a millimetre in a minute and a half.
    assert np.abs((track.position[49::50] - truth[1:]) * metres).max() < 2e-3


def test_units_on_wheels_err_by_flight_and_refuse_what_is_none() -> None:
    wrong = PERFECT.model_copy(update={"gyro_noise_radprts": 1e-5})
    first, again, other = (ins.roll(0, bend(), wrong, seed=3, flight=k).imu for k in (0, 0, 1))
    assert first.equals(again)
    assert not first["angle_x_rad"].equals(other["angle_x_rad"])
    assert ins.roll(0, bend(), wrong, truth_interval_s=0.2).truth.height == 89 * 5 + 1
    for arguments, argument in (
        ((bend()[:5], PERFECT), "position"),
        ((bend()[:, :2], PERFECT), "position"),
        ((np.where(np.arange(90)[:, None] == 7, np.nan, bend()), PERFECT), "position"),
        ((np.repeat(bend()[:1], 20, axis=0), PERFECT), "ground speed"),
        ((bend(), PERFECT.model_copy(update={"gyro_scale": 2.0})), "gyro_scale"),
    ):
        with pytest.raises(InputError, match=argument):
            ins.roll(0, *arguments)
    for keywords in ({"rate_hz": 7}, {"truth_interval_s": 0.03}, {"seed": -1}):
        with pytest.raises(InputError, match=next(iter(keywords))):
            ins.roll(0, bend(), PERFECT, **keywords)


def test_nothing_is_heard_while_jammed() -> None:
    times = ins.simulate(short("beijing-shanghai-jammed")).satellites["time_ns"].unique().sort().to_numpy()
    seconds = (times - scenario.load("beijing-shanghai").start_ns) // 10**9
    assert seconds.tolist() == [*range(1, 2400), *range(3600, 7082)]


def test_the_seed_is_the_scenarios_unless_stated() -> None:
    flown = short("beijing-shanghai-seed", gnss=None, dme=None, vor=None)
    a, b = ins.simulate(flown), ins.simulate(flown, 0, flown.seed)
    assert a.imu.equals(b.imu)
    assert not ins.simulate(flown, 1).imu.equals(a.imu)
    assert not ins.simulate(flown, 0, 5).imu.equals(a.imu)
    assert a.satellites.height == 0
    assert a.satellites.schema["satellite"] == pl.String


def test_broadcast_orbits_serve_as_well(shared_data: Path) -> None:
    path = shared_data / "gnss" / "ESBC_2020_177" / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz"
    navigation = gnss.read_navigation(path)
    base = short("beijing-shanghai", path="planned", dme=None, vor=None, baro=None)
    day = base.model_copy(update={"start_gps": base.start_gps.replace(year=2020, month=6, day=25, hour=10)})
    result = ins.simulate(day, navigation=navigation)
    counts = result.satellites.group_by("time_ns").len()["len"]
    # Full constellations of 2020 over East Asia above 7 degrees: some 8 to 12 of GPS and Galileo, 12 to 22 of BeiDou.
    assert counts.min() >= 20  # type: ignore[operator]
    assert counts.max() <= 50  # type: ignore[operator]
    assert {s[0] for s in result.satellites["satellite"].unique()} == {"G", "E", "C"}
    with pytest.raises(InputError, match="navigation"):
        ins.simulate(base, navigation=navigation)


@pytest.mark.parametrize(
    ("arguments", "argument"),
    [
        ({"scenario": "beijing-shanghai-drawn"}, "scenario"),
        ({"flight": -1}, "flight"),
        ({"seed": 2**64}, "seed"),
        ({"truth_interval_s": 0.0}, "truth_interval_s"),
        ({"truth_interval_s": 0.0123}, "truth_interval_s"),
        ({"truth_interval_s": float("nan")}, "truth_interval_s"),
    ],
)
def test_what_cannot_be_sensed_is_refused(arguments: dict[str, object], argument: str) -> None:
    with pytest.raises(InputError) as caught:
        ins.simulate(**({"scenario": "beijing-shanghai-real"} | arguments))  # type: ignore[arg-type]
    assert caught.value.argument == argument


@pytest.mark.parametrize(
    ("text", "field", "message"),
    [
        ('[sensors.imu]\ngrade = "best"', "sensors.imu.grade", "navigation"),
        ("[sensors]\nrate_hz = 90", "sensors.rate_hz", "divisors"),
        ("[sensors.imu]\ngyro_bias_degph = -1.0", "sensors.imu.gyro_bias_degph", "[0, inf)"),
        ('[sensors.gnss]\nmode = "best"', "sensors.gnss.mode", "'seed' or 'real'"),
        ("[sensors.baro]\nlag = 1.0", "sensors.baro.lag", "not a key"),
        ('[[sensors.faults]]\nkind = "meteor"', "sensors.faults[0]", "'satellite-step'"),
        ('[[sensors.faults]]\nkind = "interference"\nstart_s = 1.0', "sensors.faults.0.duration_s", "missing"),
        (
            '[[sensors.faults]]\nkind = "dme-bias"\nstart_s = 1.0\nduration_s = 1.0\nstation = "XXX"\nbias_m = 1.0',
            None,
            "names of stations",
        ),
    ],
)
def test_a_wrong_sensor_is_explained(tmp_path: Path, text: str, field: str | None, message: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(f'base = "beijing-shanghai-real"\n{text}\n', encoding="utf-8")
    with pytest.raises(FormatError) as caught:
        scenario.load(file)
    assert message in str(caught.value)
    if field is not None:
        assert caught.value.field == field


def test_a_grade_gives_way_to_numbers_beside_it(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('base = "beijing-shanghai-real"\n[sensors.imu]\ngyro_bias_degph = 0.5\n', encoding="utf-8")
    mine, base = scenario.load(file).sensors, scenario.load("beijing-shanghai-real").sensors
    assert mine is not None
    assert base is not None
    assert mine.imu.gyro_bias_radps == pytest.approx(np.radians(0.5) / 3600, rel=1e-12)
    assert mine.imu == base.imu.model_copy(update={"gyro_bias_radps": mine.imu.gyro_bias_radps})
    # The published biases: 0.01 deg/h and 1e-4 g.
    assert base.imu.gyro_bias_radps == pytest.approx(4.84814e-8, rel=1e-5)
    assert base.imu.accelerometer_bias_mps2 == pytest.approx(9.80665e-4, rel=1e-12)


def test_the_rust_tests_fly_the_shipped_flight() -> None:
    kept = json.loads((ROOT / "crates" / "simulate" / "tests" / "beijing-shanghai.json").read_text(encoding="utf-8"))
    shipped = json.loads(scenario.load("beijing-shanghai-drawn").core_json())
    assert shipped.pop("sensors") is None
    assert shipped.pop("filter") is None
    assert kept == shipped
