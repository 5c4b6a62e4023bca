"""Speed of navbound.araim: a world grid under 24 GPS and 24 Galileo satellites, detection and exclusion; sidereon beside it.

sidereon takes one epoch a call and lines of sight, not orbits; its objects are made beforehand. MAAST under Octave is not run here.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import araim_peer
from clock import Row, seconds, show, wall
from navbound import araim, gnss

if TYPE_CHECKING:
    from numpy.typing import NDArray

PEER_EPOCHS = 300
DAY = """
import numpy as np
from navbound import araim, gnss
orbits = gnss.constellation("gps") + gnss.constellation("galileo")
lat, lon = np.meshgrid(np.radians(np.arange(-85, 90, 10.0)), np.radians(np.arange(-175, 180, 10.0)), indexing="ij")
def job():
    araim.predict(orbits, lat, lon, 0.0, np.arange(288) * 300.0)
"""


def measure() -> list[Row]:
    """One row a measurement."""
    orbits = gnss.constellation("gps") + gnss.constellation("galileo")
    lat, lon = np.meshgrid(np.radians(np.arange(-85, 90, 10.0)), np.radians(np.arange(-175, 180, 10.0)), indexing="ij")
    instants = np.arange(0, 86_400, 3600.0)

    def levels(every: int, *, service: str = "lpv-200", exclusion: bool = False) -> araim.Levels:
        return araim.predict(orbits, lat, lon, 0.0, instants[::every], service=service, exclusion=exclusion)

    computed = levels(1)
    n, ok = computed.vpl_m.size, computed.status == "ok"
    few = levels(6, exclusion=True).vpl_m.size
    words = f"{computed.n_sv.mean():.1f} satellites, {computed.n_modes.mean():.1f} modes, mean VPL {computed.vpl_m[ok].mean():.2f} m"
    excluded = seconds(lambda: levels(6, exclusion=True)) / few
    day, spent = wall(DAY)
    day_n = lat.size * 288
    return [
        Row("araim detection", seconds(lambda: levels(1)) / n, n, f"geometry and sigmas included; {words}", goal_s=5e-6),
        Row("araim with exclusion", excluded, few, "the largest levels over every likely exclusion", goal_s=60e-6),
        Row(
            "araim world day, detection",
            day / day_n,
            day_n,
            f"wall clock on all cores; {day:.2f} s the day, {spent:.2f} s CPU",
            goal_s=1.0 / day_n,
        ),
        Row("raim detection", seconds(lambda: levels(1, service="raim")) / n, n, "one fault at a time"),
        Row("raim with exclusion", seconds(lambda: levels(6, service="raim", exclusion=True), 3) / few, few, "every satellite in turn"),
        *beside_sidereon(orbits, lat.ravel(), lon.ravel()),
    ]


def beside_sidereon(orbits: gnss.Orbits, lat: NDArray[np.float64], lon: NDArray[np.float64]) -> list[Row]:
    """Levels of the same lines of sight and sigmas, ours in one call and one epoch a call, sidereon's one epoch a call."""
    try:
        sidereon = importlib.import_module("sidereon")
    except ImportError:
        print("SKIPPED: sidereon is not installed (uv sync --group oracle), so no peer row", file=sys.stderr)
        return []
    sky = gnss.geometry(orbits, lat, lon, 0.0, 0.0, mask_rad=np.radians(5.0))
    az, el = (x[:PEER_EPOCHS] for x in (sky.az_rad, sky.el_rad))
    unit = np.stack([np.cos(el) * np.sin(az), np.cos(el) * np.cos(az), np.sin(el)], axis=-1)
    systems = np.asarray(orbits.constellation)
    local = 0.2 + 0.15 / (np.sin(el) ** 2 + 0.01)
    sigma_int, sigma_acc = np.sqrt(araim_peer.URA_M**2 + local), np.sqrt(araim_peer.URE_M**2 + local)
    seen = ~np.isnan(el)
    skies = [(unit[k, seen[k]], systems[seen[k]], sigma_int[k, seen[k]], sigma_acc[k, seen[k]]) for k in range(len(el))]
    theirs = [araim_peer.arguments(sidereon, *sky) for sky in skies]
    n = len(skies)
    batch = seconds(lambda: araim_peer.ours(unit, systems, sigma_int, sigma_acc)) / n
    single = seconds(lambda: [araim_peer.ours(*sky) for sky in skies]) / n
    peer = seconds(lambda: [sidereon.araim(*each) for each in theirs]) / n
    return [
        Row("araim levels of given lines of sight", batch, n, "one call for all"),
        Row("the same, a call an epoch", single, n, "the language's boundary included"),
        Row("sidereon, a call an epoch", peer, n, f"{peer / batch:.0f} times the batch, {peer / single:.1f} times the single call"),
    ]


if __name__ == "__main__":
    show(measure())
