"""Write a corpus of small seeds for every fuzz target: the texts that the readers' own tests hold, frames made here, and beginnings of
real files where the shared data are there.

python3 fuzz/seeds.py    (writes fuzz/corpus/<target>/; nothing of it is committed: what is kept of our own stands in fuzz/kept)
"""

import gzip
import hashlib
import re
import struct
from pathlib import Path

HERE = Path(__file__).parent
FORMATS = HERE.parent / "crates" / "formats"


def texts(path: str) -> dict[str, str]:
    """Text constants of a Rust file by name."""
    source = (FORMATS / path).read_text(encoding="utf-8")
    found = re.findall(r'const (\w+): &str =\s*"((?:[^"\\]|\\.)*)";', source, re.DOTALL)
    plain = {name: re.sub(r"\\\n\s*", "", text).replace('\\"', '"').replace("\\n", "\n") for name, text in found}
    several = re.search(r"const \w+: \[&str; \d+\] = \[(.*?)\n\];", source, re.DOTALL)
    if several:
        each = re.findall(r'"((?:[^"\\]|\\.)*)"', several[1], re.DOTALL)
        plain |= {f"other{k}": re.sub(r"\\\n\s*", "", text).replace('\\"', '"') for k, text in enumerate(each)}
    return plain


def record(kind: int, payload: bytes) -> bytes:
    """One record of the target `receivers`: UBX 0 to 3, SBF 4 to 7."""
    return struct.pack("<BH", kind, len(payload)) + payload


def rawx(tow_s: float) -> bytes:
    """Two satellites of each system, two signals each."""
    systems = [(0, 0), (0, 3), (1, 0), (2, 0), (2, 6), (3, 0), (3, 2), (6, 0), (6, 2)]
    body = b"".join(
        struct.pack("<ddfBBBBHBBBBBB", 2.2e7 + k, 1.1e8 + k, -500.0, system, 121 if system == 1 else 5, signal, 7, 64000, 42, 1, 1, 1, 7, 0)
        for k, (system, signal) in enumerate(systems)
    )
    return struct.pack("<dHbBBBBB", tow_s, 2361, 18, len(systems), 1, 1, 0, 0) + body


def sfrbx(system: int, number: int, signal: int, words: list[int]) -> bytes:
    """A navigation message of one satellite."""
    return struct.pack("<BBBBBBBB", system, number, signal, 0, len(words), 0, 2, 0) + struct.pack(f"<{len(words)}I", *words)


def lnav(number: int) -> list[int]:
    """Ten words of 24 bits: preamble, a time, the subframe's number, and an orbit of some kind."""
    words = [0x8B0000, 1000 << 7 | number << 2] + [0x123456] * 8
    if number == 2:
        # sqrt(A) 5153.6 in the lower byte of word 8 and word 9; issue 0x34 in all three.
        words = [words[0], words[1], 0x340000, 0x112233, 0x445566, 0x778800, 0x001234, 0x1234A1, 0x0D0000, 0x100000]
    if number == 3:
        words[9] = 0x341234
    if number == 1:
        words[7] = 0x341000
    return words


def receivers() -> list[bytes]:
    """One seed a message, and one of plain bytes a maker."""
    epoch = record(0, rawx(1000.0)) + record(0, rawx(1001.0))
    old = struct.pack("<IhBB", 1_000_000, 1481, 1, 0) + struct.pack("<ddfBbBB", 1.1e8, 2.2e7, 100.0, 5, 7, 40, 0)
    sfrb = b"".join(record(3, struct.pack("<BB10I", 1, 5, *lnav(n))) for n in (1, 2, 3))
    ems = texts("src/sbas/tests.rs")["EMS"].split()[-1]
    sbas = list(struct.unpack(">8I", bytes.fromhex(ems)))
    galileo = [[word << 24 | 0x01234567, 0x01000000, 0x02A00000, 0x01000000, 0x80000000, 0, 0, 0] for word in (1, 2, 3, 4, 5)]
    pages = b"".join(record(1, sfrbx(2, 5, 1, w)) for w in galileo)
    head = struct.pack("<IH", 1_000_000, 2361)
    first = struct.pack("<BBBBIiHbBHBB", 0, 0, 5, 5, 123456, 5000, 100, 1, 120, 30, 0, 1)
    second = struct.pack("<BBBBbBHHH", 3, 30, 120, 1, 1, 0, 10, 20, 30)
    measured = head + struct.pack("<BBBBBB", 1, 20, 12, 0, 0, 0) + first + second
    bits = head + struct.pack("<BBBBBB", 121, 1, 0, 0, 0, 0) + struct.pack("<8I", *sbas)
    return [
        b"f" + epoch + record(1, sfrbx(1, 137, 0, sbas)),
        b"f" + record(2, old) + sfrb,
        b"f" + epoch + pages,
        b"f" + record(4, measured) + record(5, bits),
        b"r\xb5\x62\x02\x15\x10\x00" + bytes(16),
        b"r$@" + bytes(16),
    ]


def positions() -> list[bytes]:
    """One epoch of each receiver as records of the target `positions`, and plain bytes of each."""

    def whole(kind: int, content: bytes) -> bytes:
        return bytes([kind]) + struct.pack("<H", len(content)) + content

    pvt = struct.pack("<IHBBBBBBIiBBBB", 1000, 2024, 6, 23, 12, 0, 1, 7, 20, -5, 3, 1, 0, 17)
    pvt += struct.pack("<iiiiII", 60_000_000, 472_500_000, 371_496, 323_000, 1_700, 2_500)
    cov = struct.pack("<IBBB9x12f", 1000, 0, 1, 1, 4.0, 0.5, -0.25, 9.0, 1.5, 16.0, *([0.0] * 6))
    level = struct.pack("<BBbBBBBB4xI7IHHI4x", 1, 5, -7, 1, 3, 0, 0, 0, 1000, 3000, 4000, 7000, 0, 0, 0, 0, 0, 0, 0)[:52]
    u_blox = whole(0, pvt.ljust(92, b"\0")) + whole(12, cov) + whole(20, level)
    head = struct.pack("<IHBB", 456_000_000, 2361, 1, 0)
    place = head + struct.pack("<3d5fdfBBBB", 0.82, 0.1, 371.5, 47.0, 3.0, 4.0, -0.5, 90.0, 0.0, 0.0, 0, 0, 12, 0)
    septentrio = whole(9, place) + whole(17, head + struct.pack("<10f", 4.0, 9.0, 16.0, 1.0, 0.5, -0.25, 0.0, 1.5, 0.0, 0.0))
    axes = head + struct.pack("<3d", 4e6, 4e5, 4.9e6) + place[32:]
    cartesian = whole(5, axes) + whole(13, head + struct.pack("<10f", 4.0, 9.0, 16.0, 1.0, 0.5, -0.25, 0.0, 1.5, 0.0, 0.0))
    sentences = ("GPZDA,120000.00,23,06,2024,00,00", "GPGGA,120001.00,4715.0,N,00600.0,E,1,12,0.9,100.0,M,40.0,M,,")
    text = b"".join(whole(2, s.encode()) for s in (*sentences, "GPGST,120001.00,1.0,4.0,2.0,45.0,3.0,3.0,5.0"))
    best = struct.pack("<II3dfI3f12xBB6x", 0, 16, 51.0, -114.0, 1000.0, -16.0, 61, 1.5, 0.9, 2.1, 9, 9)
    binary = whole(3, struct.pack("<13xBHI8x", 180, 1562, 515_265_000) + best)
    words = "COM1,0,50.0,FINESTEERING,2445,100.000,00000000,0000,1000;SOL_COMPUTED,SINGLE,49.0,2.5,100.0,47.0,WGS84,1.0,1.0,2.0"
    ascii_ = whole(7, f'{words},"",0.0,0.0,10,10,10,10,0,0,0,0'.encode())
    made = [u_blox, septentrio, cartesian, text, binary, ascii_]
    return [b"\x86" + each for each in made] + [b"\x01$GPGGA,,,,,,0,,,,,,,,*66\r\n", b"\x01#BESTPOSA,COM1", b"\x01\xaa\x44\x12\x1c"]


def repeated(found: dict[str, list[bytes]]) -> list[bytes]:
    """A text for every reader, cut in a beginning and a piece; the generator takes lengths from the end of its input."""
    kinds = ("observations", "navigation", "clocks", "orbits", "almanac", "sbas", "receivers", "packed", "rtklib", "positions", "positions")
    return [bytes([k]) + seed[:500] for k, kind in enumerate(kinds) for seed in found[kind][:2]]


TABLE = b"timestamp,latitude,longitude,altitude (ft),groundspeed,track,hpl_m\n" + b"".join(
    b"%d,%.5f,10.0,%d,97.2,0,12.5\n" % (1_700_000_000 + k, 50 + k / 2000, 300 + k) for k in range(12)
)
ISO = (
    b"time;lat (deg);lon [rad];status\n2016-12-31T23:59:59Z;1;0.5;ok\n2016-12-31T23:59:60Z;1.0001;0.5;ok\n2017-01-01 00:00:00+00:00;nan;;\n"
)
RECORDS = b'[{"time_ns": 1300000000000000000, "est_lat_rad": 0.5, "est_lon_rad": 1}, {"time_ns": null, "est_lat_rad": "x"}]'
TRACE = b'{"icao": "abc", "timestamp": 1.7e9, "trace": [[0.5, 50, 10, "ground", 97, 0, 0, null, {"nic": 8, "rc": 186}, "adsb", 100]]}'
BY_ROW = b'{"timestamp": {"0": 1700000000, "1": 1700000001}, "latitude": {"0": 50, "1": 50.0005}, "longitude": {"0": 1, "1": 2}}'


def python_corpus() -> dict[str, list[bytes]]:
    """Seeds of the targets in `readers.py`."""
    shipped = sorted((HERE.parent / "python" / "navbound" / "scenario").rglob("*.toml"))
    empty = hashlib.sha256(b"{}").hexdigest()
    return {
        "table": [TABLE, TABLE.replace(b",", b"\t"), ISO, b"gps_week,tow,lat,lon\n2200,1.5,1,2\n2200,604800,1,2\n2201,0,1,2\n"],
        "json": [RECORDS, TRACE, BY_ROW],
        "columns": [
            b"time,Latitude (deg),lon [rad],x\ntime=time:gps_s\nest_h_m=x:ft",
            b"t,breite,y\ntime=t:utc_ms\nest_lat_rad=breite:deg",
        ],
        "toml": [b'base = "beijing-shanghai"\nduration_s = 6000\n', *(path.read_bytes()[:LONGEST] for path in shipped)],
        "checkpoint": [b"\0\0\1", bytes(range(30))],
        "manifest": [b'{"files": {"a.json": "%s"}}' % empty.encode(), b'{"files": {"a.json": null}}', b'{"files": []}'],
    }


def corpus() -> dict[str, list[bytes]]:
    """Seeds of every target."""
    observation, navigation = texts("src/rinex/observation_tests.rs"), texts("src/rinex/navigation_tests.rs")
    almanac, pos, sbas = texts("src/almanac_tests.rs"), texts("tests/rtklib.rs"), texts("src/sbas/tests.rs")
    clock, sp3 = texts("src/rinex/clock.rs"), texts("src/sp3.rs")
    records = [text for name, text in navigation.items() if name != "HEADER"]
    third = [navigation["HEADER"] + text for text in records]
    # Every second record also behind the header of version 4, which titles each.
    fourth = [navigation["HEADER"].replace("3.02", "4.00", 1) + "> EPH G01 LNAV\n" + text for text in records]
    plain = {
        "arinc424": [(HERE.parent / "tests" / "procedures" / "KDEN_H26-Z.txt").read_text(encoding="ascii")],
        "observations": list(observation.values()),
        "navigation": [*third, *fourth, *records],
        "almanac": list(almanac.values()),
        "clocks": [clock["HEAD"] + clock["BODY"]],
        "orbits": [sp3["HEAD"] + sp3["BODY"]],
        "rtklib": list(pos.values()),
        "sbas": list(sbas.values()),
    }
    found = {target: [text.encode() for text in several] for target, several in plain.items()}
    found["packed"] = [gzip.compress(text, mtime=0) for text in (found["sbas"][0], b"", bytes(5000))] + [b"\x1f\x9d", b"PK\x03\x04"]
    found["receivers"], found["positions"] = receivers(), positions()
    # The two halves of a place, bare and in a frame.
    halves = [bytes.fromhex(f"8d4b100058b5{rest}") for rest in ("00ac528d53a98812", "0420ea89b38a211c")]
    found["squitters"] = [b"".join(halves), b"\x1a3" + bytes(7) + halves[0], b"*" + halves[0].hex().encode() + b";"]
    found["solutions"] = [bytes(range(256)), struct.pack("<q10d", 10**18, 0.5, 1.0, 100.0, 4.0, 1.0, 4.0, 0.5, 0.5, 9.0, 0.0)]
    found["repeated"] = repeated(found)
    found["smoothing"] = [struct.pack("<d" + "q3dB" * 3, 100.0, *(v for k in range(3) for v in (k * 10**9, 2e7 + k, 2e7, 2e7, 0)))]
    return found | python_corpus()


REAL = {
    "observations": ("*.[0-9][0-9]o", "*.[0-9][0-9]d", "*_MO.rnx", "*_MO.crx"),
    "navigation": ("*.[0-9][0-9]n", "*_MN.rnx", "*_GN.rnx"),
    "orbits": ("*.sp3", "*.SP3"),
    "clocks": ("*.clk", "*.CLK"),
    "almanac": ("*.al3", "*.alm"),
    "rtklib": ("*.pos",),
    "sbas": ("*.ems", "*.sbs"),
    "packed": ("*.gz",),
    "arinc424": ("K???.txt",),
    "table": ("*.csv",),
    "json": ("*.json",),
}
"""What real files of a target are called."""
LONGEST, MOST = 4096, 6
"""Bytes of a real file that make a seed, and real seeds of a target: the corpus stays small. [B, 1]"""


def real(folder: Path) -> dict[str, list[bytes]]:
    """Beginnings of real files, whole lines of those that are text; unpacked unless packing is what is read."""
    found: dict[str, list[bytes]] = {}
    for target, patterns in REAL.items():
        endings = patterns if target == "packed" else [p + tail for p in patterns for tail in ("", ".gz")]
        for path in sorted({p for ending in endings for p in folder.rglob(ending)})[:MOST]:
            opened = gzip.open if path.suffix == ".gz" and target != "packed" else open
            with opened(path, "rb") as file:
                start = file.read(LONGEST)
            found.setdefault(target, []).append(start if target == "packed" else start[: start.rfind(b"\n") + 1] or start)
    return found


def main() -> None:
    """Write them."""
    from_files = real(HERE.parents[1] / "shared" / "data")
    for target, own in corpus().items():
        seeds = own + from_files.get(target, [])
        folder = HERE / "corpus" / target
        folder.mkdir(parents=True, exist_ok=True)
        for k, seed in enumerate(seeds):
            (folder / f"seed{k:02d}").write_bytes(seed)
        print(f"{target}: {len(seeds)} seeds, {sum(map(len, seeds))} bytes")


if __name__ == "__main__":
    main()
