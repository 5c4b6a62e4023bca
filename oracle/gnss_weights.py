"""The weights of positions: how they are calibrated, and what they say on data they were not calibrated on.

Two factors are found on one set of epochs, in this order, and nothing else is:

1. ``range_factor`` without truth: the residuals of all epochs, weighted, sum to their redundancy.
2. ``shared_factor`` with truth: the mean normalised squared error is 3.

``python oracle/gnss_weights.py`` prints both for the first half of the ESBC day, and the accuracy and consistency of the shipped weights
and of those just calibrated on everything else at hand.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy import optimize, special, stats

from navbound import gnss

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64] | np.float64

FOLDER = Path(__file__).resolve().parents[2] / "shared" / "data"
ESBC = FOLDER / "gnss" / "ESBC_2020_177"
WEEK_S = 604_800


@dataclass(frozen=True)
class Recording:
    """Files of one receiver with its true positions, and the part of its epochs that is meant."""

    name: str
    observations: gnss.Observations
    navigation: gnss.Navigation
    truth_ecef_m: NDArray[np.float64]
    part: tuple[int | None, int | None] = (None, None)

    def solve(self, systems: str, factors: tuple[float, float] = (1.0, 1.0)) -> pl.DataFrame:
        """The epoch table of the part."""
        solved = gnss.solve(
            self.observations,
            self.navigation,
            systems=systems,
            range_factor=factors[0],
            shared_factor=factors[1],
            truth_ecef_m=self.truth_ecef_m,
        )
        return solved.epochs[slice(*self.part)]


def recordings() -> dict[str, Recording]:
    """Everything at hand."""
    gnss_folder = FOLDER / "gnss"
    baseline = json.loads((FOLDER / "baselines.json").read_text(encoding="utf-8"))
    day = gnss.read_observations(ESBC / "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz")
    broadcast = gnss.read_navigation(ESBC / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz")
    esbc = np.array(baseline["ESBC_2020_177"]["reference_ecef_m"])
    arlm = gnss.read_observations(gnss_folder / "ARLM_2015_200" / "arlm200x.15o")
    header = arlm.approximate_ecef_m
    taroz = gnss_folder / "taroz_static"
    place = [float(v) for v in (taroz / "rover_position.txt").read_text().split()]
    read = [
        Recording("ESBC, first half", day, broadcast, esbc, (None, 1440)),
        Recording("ESBC, second half", day, broadcast, esbc, (1440, None)),
        Recording(
            "ARLM", arlm, gnss.read_navigation(gnss_folder / "ARLM_2015_200" / "arlm2000.15n"), np.zeros(3) if header is None else header
        ),
        Recording(
            "Taroz static rover",
            gnss.read_observations(taroz / "rover.obs.gz"),
            gnss.read_navigation(taroz / "base.nav"),
            ecef(np.radians(place[0]), np.radians(place[1]), np.float64(place[2])),
        ),
        hong_kong(gnss_folder / "HK_TST_2019_118"),
    ]
    return {r.name: r for r in read}


def hong_kong(folder: Path) -> Recording:
    """The car in the streets: truth each second, between which it is drawn straight."""
    observations = gnss.read_observations(folder / "COM3_190428_124409.obs")
    navigation = gnss.read_navigation([folder / "hksc1180.19n", folder / "hksc1180.19b"])
    week, second, lat, lon, h = np.loadtxt(folder / "groundTruth_TST.csv", delimiter=",").T
    known = ecef(np.radians(lat), np.radians(lon), h)
    start = week[0] * WEEK_S
    time_s = (observations.time_ns - int(start) * 10**9) * 1e-9
    truth_s = second + (week - week[0]) * WEEK_S
    truth = np.column_stack([np.interp(time_s, truth_s, known[:, k], np.nan, np.nan) for k in range(3)])
    return Recording("HK, streets", observations, navigation, truth)


def ecef(lat: Numbers, lon: Numbers, h: Numbers) -> NDArray[np.float64]:
    """Earth-fixed coordinates of WGS-84 positions."""
    flattening = 1 / 298.257223563
    e2 = flattening * (2 - flattening)
    n = 6_378_137.0 / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    return np.stack([(n + h) * np.cos(lat) * np.cos(lon), (n + h) * np.cos(lat) * np.sin(lon), (n * (1 - e2) + h) * np.sin(lat)], axis=-1)


def squares(epochs: pl.DataFrame) -> NDArray[np.float64]:
    """Normalised squared error of each epoch; NaN where there is none."""
    error = epochs.select("nse_e_m", "nse_n_m", "nse_u_m").fill_null(np.nan).to_numpy()
    c = {k: epochs[f"cov_{k}_m2"].fill_null(np.nan).to_numpy() for k in ("ee", "en", "nn", "eu", "nu", "uu")}
    rows = [[c["ee"], c["en"], c["eu"]], [c["en"], c["nn"], c["nu"]], [c["eu"], c["nu"], c["uu"]]]
    covariance = np.moveaxis(np.array(rows), -1, 0)
    good = np.isfinite(error).all(axis=1) & np.isfinite(covariance).all(axis=(1, 2))
    squares = np.full(epochs.height, np.nan)
    squares[good] = np.einsum("ni,ni->n", error[good], np.linalg.solve(covariance[good], error[good][..., None])[..., 0])
    return squares


def variance_factor(epochs: pl.DataFrame) -> float:
    """Sum of weighted squared residuals over redundancy, from the risk that stands beside each."""
    risk, redundancy = (epochs[c].cast(float).fill_null(np.nan).to_numpy() for c in ("p_residual", "n_redundant"))
    good = np.isfinite(risk) & (redundancy > 0) & (risk > 0)
    return float(2 * special.gammainccinv(redundancy[good] / 2, risk[good]).sum() / redundancy[good].sum())


def calibrate(recording: Recording, systems: str) -> tuple[float, float]:
    """The two factors."""
    # Weights matter to the residuals little, their scale only: two rounds settle it.
    on_ranges = 1.0
    for _ in range(3):
        on_ranges *= np.sqrt(variance_factor(recording.solve(systems, (on_ranges, 1.0))))

    def excess(shared: float) -> float:
        return float(np.nanmean(squares(recording.solve(systems, (on_ranges, shared))))) - 3.0

    # Errors that nobody shares may be enough to explain the position, or no shared ones may be.
    if excess(0.0) <= 0.0:
        return on_ranges, 0.0
    return on_ranges, float(optimize.brentq(excess, 0.0, 20.0, xtol=1e-3))


def report(recording: Recording, systems: str, factors: tuple[float, float]) -> list[str]:
    """One line a status: how many, accuracy, consistency."""
    epochs = recording.solve(systems, factors)
    square = squares(epochs)
    horizontal = np.hypot(*(epochs[c].fill_null(np.nan).to_numpy() for c in ("nse_e_m", "nse_n_m")))
    lines = []
    for status in ("ok", "degraded"):
        selected = (epochs["status"] == status).to_numpy() & np.isfinite(square)
        if selected.any():
            h95, mean, median = np.quantile(horizontal[selected], 0.95), square[selected].mean(), np.median(square[selected])
            inside = float((square[selected] <= stats.chi2.ppf(0.95, 3)).mean())
            lines.append(
                f"{recording.name:20s} {systems:4s} {status:9s} n {selected.sum():5d}  H95 {h95:7.2f} m"
                f"  NEES mean {mean:8.2f} median {median:6.2f}  in 95 % {inside:.3f}"
            )
    return lines


def main() -> None:
    """Calibrate, then tell of everything."""
    known = recordings()
    shipped = (1.0, 1.0)
    for systems in ("G", "GE", "GEC"):
        factors = calibrate(known["ESBC, first half"], systems)
        print(f"calibrated on the first half of the ESBC day, {systems}: ranges {factors[0]:.3f}, shared {factors[1]:.3f}")
        for name, recording in known.items():
            if name == "ARLM" and systems != "G":
                continue
            of = systems.replace("E", "") if name.startswith("HK") else systems
            for label, weights in (("shipped", shipped), ("calibrated", factors)):
                for line in report(recording, of, weights):
                    print(f"  {label:10s} {line}")


if __name__ == "__main__":
    main()
