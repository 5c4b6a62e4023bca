"""Kinds of shared files for `damage.py`: an excerpt of each, what its public reader makes of it, and what its bytes are protected by."""

from __future__ import annotations

import gzip
import io
import math
import re
import zipfile
from collections import Counter
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import polars as pl

from conftest import SHARED
from navbound import gnss, sbas
from navbound.errors import FormatError, InputError
from navbound.read import read
from navbound.run.evaluate.performance import Options, evaluate_files
from navbound.run.inputs.files import sort_out

DATA = SHARED / "data"
Cell = tuple[Hashable, str]
Cells = dict[Cell, Hashable]
"""Key of a record (satellite, time) and name of a number, to the number."""
Result = tuple[Cells, Counter[str]]
"""Numbers, and what is stated of losses."""


def cells(frame: pl.DataFrame, keys: list[str]) -> Cells:
    """Every number of a table by its row's key; what is not there has no cell."""
    names = [c for c in frame.columns if c not in keys]
    by_name: Cells = {}
    for row in frame.iter_rows(named=True):
        key = tuple(row[k] for k in keys)
        by_name[key, "is there"] = True
        by_name |= {(key, name): row[name] for name in names if row[name] is not None and row[name] == row[name]}
    return by_name


def tracks(path: Path) -> Result:
    reading = read(path)
    stated = Counter(f"{r.reason}: {r.count}" for r in reading.rejected) + Counter(reading.notes) + Counter(reading.unused)
    stated.update([f"rows without a position: {reading.left_out.height}", *(f"{k} is {v}" for k, v in reading.columns.items())])
    # A row that its reader does not believe, for instance one of two positions of one time, is no position.
    believed = reading.epochs.filter(pl.col("status") == "ok") if "status" in reading.epochs.columns else reading.epochs
    # Two messages of a receiver state an instant, each rounded by itself: the time of a row without the one is a nanosecond off.
    believed = believed.with_columns((pl.col("time_ns") / 100).round().cast(pl.Int64).alias("time_ns"))
    return cells(believed.drop("track", *({"status", "reason", "reason_id"} & set(believed.columns))), ["time_ns"]), stated


def observations(path: Path) -> Result:
    o = gnss.read_observations(path)
    by_name: Cells = {((int(t),), "is there"): True for t in o.time_ns}
    for system, codes in o.codes.items():
        for code in codes:
            column = o.column(system, code)
            keys = zip(column["time_ns"], column["satellite"], strict=True)
            rows = zip(keys, column["value"], column["loss_of_lock"], strict=True)
            by_name |= {((*key, code), "value"): value for key, value, _ in rows if value is not None and not math.isnan(value)}
    stated = Counter(r.reason for r in o.refused) + Counter({f"skipped {k}": v for k, v in o.skipped.items()})
    stated[f"refused {o.n_refused}"] = 1
    stated += _ends(path)
    return by_name, stated


def _ends(path: Path) -> Counter[str]:
    """What a run says of a text that was cut within a line."""
    try:
        return Counter(sort_out([path]).cut_words())
    except (FormatError, InputError):
        return Counter()


def navigation(path: Path) -> Result:
    n = gnss.read_navigation(path)
    stated = Counter(r.reason for r in n.refused) + Counter({f"skipped {k}": v for k, v in n.skipped.items()})
    stated += _ends(path)
    return cells(n.records(), ["satellite", "orbit_time_ns", "clock_time_ns", "message"]), stated


def orbits(path: Path) -> Result:
    p = gnss.read_orbits(path)
    # At the records of the file, from its second hour on: a polynomial of order 10 has to stand around each.
    first, step = _sp3_times(path.with_name(f"sound-{path.name}"))
    times = first + step * np.arange(0, 12)
    by_name: Cells = {}
    for satellite in p.satellites:
        ecef, _, clock = p.states(satellite, times)
        for t, position, c in zip(times, ecef, clock, strict=True):
            # A satellite's table is one record: its polynomial goes through the neighbours of an epoch too.
            by_name |= {
                ((satellite,), f"{axis} at {t}"): round(v, 3) for axis, v in zip("xyz", position.tolist(), strict=True) if not math.isnan(v)
            }
            if not math.isnan(c):
                by_name[(satellite,), f"clock at {t}"] = round(float(c), 12)
    stated = Counter(r.reason for r in p.refused) + Counter({f"skipped {k}": v for k, v in p.skipped.items()})
    stated[f"positions {p.n_positions}, clocks {p.n_clocks}"] = 1
    return by_name, stated


@cache
def _sp3_times(path: Path) -> tuple[int, int]:
    """First record and step of the undamaged file, by its second line. [ns]"""
    head = path.read_text().splitlines()[1].split()
    return (int(head[1]) * 604_800 + round(float(head[2]))) * 1_000_000_000, round(float(head[3])) * 1_000_000_000


def almanac(path: Path) -> Result:
    o = gnss.constellation(path, near_ns=1_467_000_000_000_000_000)
    columns = ("semi_major_m", "eccentricity", "inclination_rad", "node_rad", "perigee_rad", "mean_anomaly_rad", "node_rate_radps")
    by_name: Cells = {
        ((satellite,), name): float(getattr(o, name)[k]) for k, satellite in enumerate(o.satellite) for name in columns if hasattr(o, name)
    }
    return by_name | {(("reference",), "time"): o.reference_ns}, Counter()


def messages(path: Path) -> Result:
    log = sbas.read(path)
    rows = zip(log.time_ns.tolist(), log.prn.tolist(), (row.tobytes() for row in log.data), strict=True)
    return {((t, prn), "data"): data for t, prn, data in rows}, Counter(r.reason for r in log.refused)


def levels(*files: Path) -> Result:
    run = evaluate_files(list(files), Options(levels=["APV-I"]))
    names = ("time_ns", "est_lat_rad", "est_lon_rad", "est_h_m", "hpl_m", "vpl_m")
    stated = Counter(f"{Path(r.file).name} {r.reason}: {r.count}" for r in run.summary.rejected) + Counter(run.summary.assumptions)
    assert run.epochs is not None
    return cells(run.epochs.select(n for n in names if n in run.epochs.columns), ["time_ns"]), stated


def _bytes(name: str) -> bytes:
    stored = (DATA / name).read_bytes()
    return gzip.decompress(stored) if stored[:2] == b"\x1f\x8b" else stored


def head(name: str, n_bytes: int, record: bytes = b"") -> Callable[[], bytes]:
    """The beginning of a text, whole lines; or whole records, by the pattern that the first line of one has."""

    def make() -> bytes:
        content = _bytes(name)
        if len(content) <= n_bytes:
            return content
        if record:
            return content[: [m.start() + 1 for m in re.finditer(b"\n" + record, content[:n_bytes])][-1]]
        return content[: content.rindex(b"\n", 0, n_bytes) + 1]

    return make


def whole(name: str, n_bytes: int = 1 << 20, frame: bytes = b"") -> Callable[[], bytes]:
    """The beginning of a log, up to where a frame begins."""

    def make() -> bytes:
        content = _bytes(name)
        return content if len(content) <= n_bytes else content[: content.rindex(frame, 0, n_bytes)]

    return make


def epochs(name: str, n: int, mark: bytes) -> Callable[[], bytes]:
    """The head of an observation or orbit file and its first epochs, the end mark of an orbit file after them."""

    def make() -> bytes:
        content = _bytes(name)
        at = [m.start() + 1 for m in re.finditer(b"\n" + mark, content)]
        return content if len(at) <= n else content[: at[n]] + (b"EOF\n" if mark == b"\\* " else b"")

    return make


def fourth(name: str, n: int) -> Callable[[], bytes]:
    """The head of a navigation file of version 4 and its first records of orbits."""

    def make() -> bytes:
        head, *records = _bytes(name).split(b"\n> ")
        return b"\n> ".join([head, *[r for r in records if r.startswith(b"EPH")][:n]]) + b"\n"

    return make


def columns(name: str, n: int) -> Callable[[], bytes]:
    """The first rows of a JSON file of columns."""

    def make() -> bytes:
        frame = read(DATA / name).epochs.head(n)
        shown = frame.select(timestamp=pl.col("time_ns") // 1_000_000_000, latitude=pl.col("est_lat_rad").degrees(),
                             longitude=pl.col("est_lon_rad").degrees(), altitude=pl.col("altitude_m"))  # fmt: skip
        return shown.write_json().replace(",", ",\n").encode()

    return make


def table(name: str, n: int) -> Callable[[], bytes]:
    return lambda: read(DATA / name).epochs.head(n).drop("track").write_csv().encode()


def packed(pack: Callable[[bytes], bytes], make: Callable[[], bytes]) -> Callable[[], bytes]:
    return lambda: pack(make())


def zipped(content: bytes) -> bytes:
    with zipfile.ZipFile(made := io.BytesIO(), "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a", content)
    return made.getvalue()


@dataclass(frozen=True)
class Kind:
    """A kind of file.

    `protection`: ``none`` (every line is data), ``record`` (each record has a checksum: what is read was written), ``parity`` (a sum that
    does not see bytes change places or come twice), ``file`` (the whole has one). `beside`: files that are read with it, undamaged.
    `keeps_repeats`: of two records of one key both are read, as of a satellite whose number became another's.
    """

    make: Callable[[], bytes]
    name: str
    result: Callable[..., Result]
    protection: str = "none"
    binary: bool = False
    beside: tuple[str, ...] = ()
    weight: float = 1.0
    keeps_repeats: bool = False


CSV = "sbas/msas2025046_pl_1hz.csv"
USER = "sbas/virtual_user_2025046_17h.25O.gz"
NAV = "sbas/gps_2025046_17h_rinex3.nav"
VILL = "gnss/VILL_2018_170_nav/VILL00ESP_R_20181700000_01D_MN.rnx.gz"
EMS = "sbas/more/prn137_2025046_17h.ems.gz"
KIRUNA = "aircraft/calibration/kiruna.json.gz"
KINDS: dict[str, Kind] = {
    "CSV track": Kind(table(KIRUNA, 80), "a.csv", tracks),
    "JSON records": Kind(columns(KIRUNA, 60), "a.json", tracks),
    "CSV in gzip": Kind(packed(lambda b: gzip.compress(b, mtime=0), table(KIRUNA, 80)), "a.csv.gz", tracks, "file", binary=True),
    "CSV in zip": Kind(packed(zipped, table(KIRUNA, 80)), "a.zip", tracks, "file", binary=True),
    "RTKLIB solutions": Kind(head("gnss/taroz_static/baseline/taroz_rover_G.pos.gz", 12_000), "a.pos", tracks),
    "RTKLIB solutions, RTK": Kind(head("gnss_imu/taroz_kinematic/rover_1Hz_rtk.pos", 12_000), "b.pos", tracks),
    "NMEA, RTK": Kind(head("rxlogs/gpsd/nmea-rtk.log", 12_000), "a.nmea", tracks, "parity"),
    "NMEA, u-blox 8": Kind(head("rxlogs/gpsd/ublox-8.log", 15_000), "b.nmea", tracks, "parity"),
    "u-blox M8L": Kind(whole("rxlogs/gpsd/ublox-neo-m8l.log", 16_000, b"\xb5\x62"), "a.ubx", tracks, "record", binary=True),
    "Septentrio": Kind(whole("rxlogs/pysbf2/pygpsdata_x5pvt.log"), "a.sbf", tracks, "record", binary=True),
    "NovAtel": Kind(whole("rxlogs/novatel/oemv_200911218.gps", 120_000, b"\xaa\x44\x12"), "a.gps", tracks, "record", binary=True),
    "u-blox measurements": Kind(whole("rxlogs/pyubx2/pygpsdata-RXMRAWX.log"), "r.ubx", observations, "record", binary=True),
    "Septentrio measurements": Kind(whole("rxlogs/pysbf2/pygpsdata_x5_measurements.log"), "r.sbf", observations, "record", binary=True),
    "RINEX 3 observations": Kind(epochs(USER, 25, b">"), "a.rnx", observations),
    "RINEX 2 observations": Kind(head("gnss/ARLM_2015_200/arlm200x.15o", 16_000, b" 15  7"), "a.15o", observations),
    "RINEX 3 compact": Kind(head("gnss/ESBC_2020_177/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz", 40_000, b" {12,}"), "a.crx", observations),
    "RINEX 3 navigation": Kind(head(VILL, 16_000, b"[A-Z]"), "a.nav", navigation, keeps_repeats=True),
    "RINEX 2 navigation": Kind(head("gnss/igs_2010_182/brdc1820.10n", 12_000, b"[ 0-9][0-9] 10 "), "a.10n", navigation, keeps_repeats=True),
    "RINEX 4 navigation": Kind(
        fourth("gnss/rinex4_2023_071/BRD400DLR_S_20230710000_01D_MN.rnx.gz", 40), "b.rnx", navigation, keeps_repeats=True
    ),
    "SP3": Kind(epochs("gnss/igs_2010_182/igs15904.sp3", 12, b"\\* "), "a.sp3", orbits),
    "almanac, YUMA": Kind(head("gnss/almanacs/20160331.alm", 20_000), "a.alm", almanac),
    "almanac, SEM": Kind(head("gnss/almanacs/current.al3", 20_000), "a.al3", almanac),
    "EMS": Kind(head(EMS, 16_000), "a.ems", messages),
    "levels from damaged observations": Kind(epochs(USER, 40, b">"), "l.rnx", levels, beside=("nav", "ems"), weight=0.04),
    "levels from damaged navigation": Kind(whole(NAV), "l.nav", levels, beside=("obs", "ems"), weight=0.04),
    "levels from damaged messages": Kind(head(EMS, 60_000), "l.ems", levels, beside=("obs", "nav"), weight=0.04),
}
BESIDE = {"obs": ("sound.rnx", epochs(USER, 40, b">")), "nav": ("sound.nav", whole(NAV)), "ems": ("sound.ems", head(EMS, 60_000))}
