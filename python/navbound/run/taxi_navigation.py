"""How the aircraft knows where it is on the ground: GBAS with an inertial system, then the last fix carried on by carrier phase.

One flight is worked out at a time: what the monitors take away depends on its errors.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING, Literal

import numpy as np

from navbound import gbas, gnss, rraim
from navbound.run import taxi_errors as errors
from navbound.run.surface_grid import MODES, Mode

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.gbas import SubPhase
    from navbound.run.taxi_motion import Movement
    from navbound.scenario.taxi import Taxi

    Floats = NDArray[np.float64]


FILTERED_EVERY_S = 20
"""In so many seconds a satellite moves by less than 0.2 degrees."""


@dataclass(frozen=True)
class Sky:
    """Satellites over the airport, one row a second; both angles NaN below the horizon [rad]."""

    names: tuple[str, ...]
    systems: NDArray[np.int64]
    az_rad: Floats
    el_rad: Floats


@dataclass(frozen=True)
class Happened:
    """A point of the flight: what, at which second, until when, and in words."""

    kind: str
    second: int
    until: int | None
    words: str


@dataclass
class Navigated:
    """What the aircraft knows, one row a second.

    Attributes
    ----------
    error_enu_m : ndarray, shape (n, 3)
        Estimate minus truth. [m]
    covariance_m2 : ndarray, shape (n, 3, 3)
        Claimed. [m²]
    hpl_m, hpl_multi_m, accuracy_m, n_sv : ndarray
        Protection levels for one fault and for all together, accuracy (95 %), satellites. [m, m, m, 1]
    status, reason : ndarray
        As in the epoch table.
    happened : list of Happened
        Faults and what the monitors did.
    """

    error_enu_m: Floats
    covariance_m2: Floats
    hpl_m: Floats
    hpl_multi_m: Floats
    accuracy_m: Floats
    n_sv: Floats
    status: NDArray[np.object_]
    reason: NDArray[np.object_]
    happened: list[Happened]


def mode_of(taxi: Taxi) -> Mode:
    """The processing mode of a scenario."""
    return next(m for m in MODES if m.id == taxi.navigation.mode)


def look(taxi: Taxi, movement: Movement) -> Sky:
    """Where the nominal satellites of the mode stand."""
    names = mode_of(taxi).systems
    orbits = gnss.constellation(names[0])
    for name in names[1:]:
        orbits += gnss.constellation(name)
    seconds = taxi.second_of_day + np.arange(len(movement.along_m))
    az, el = gnss.directions(orbits, movement.lat_rad, movement.lon_rad, taxi.height_m, seconds)
    up = el > 0
    return Sky(orbits.satellite, orbits.constellation, np.where(up, az, np.nan), np.where(up, el, np.nan))


class Navigator:
    """Everything that all flights of a scenario share."""

    def __init__(self, taxi: Taxi, movement: Movement, limits: dict[str, SubPhase], sky: Sky) -> None:
        self.taxi, self.movement, self.limits, self.sky = taxi, movement, limits, sky
        self.mode = mode_of(taxi)
        self.shares = gbas.allocation()
        self.rates = gbas.fault_rates()[taxi.navigation.case]
        self.carrier = gbas.carriers()[self.mode.carrier]
        self.fixes = int(np.argmax(movement.coasts))
        """Seconds before coasting; the fix that is carried on is the last of them."""

    def fly(self, seed: int, track: int) -> Navigated:
        """Navigate one flight."""
        n, wide = self.sky.el_rad.shape
        found = Navigated(
            np.full((n, 3), np.nan),
            np.full((n, 3, 3), np.nan),
            np.full(n, np.nan),
            np.full(n, np.nan),
            np.full(n, np.nan),
            np.zeros(n),
            np.full(n, "not_available", dtype=object),
            np.full(n, None, dtype=object),
            [],
        )
        faults = np.zeros((n, wide))
        for fault in self.taxi.faults:
            number = self.sky.names.index(fault.satellite)
            faults[:, number] += errors.size(fault, np.arange(float(n)))
            end = round(fault.start_s + fault.duration_s)
            words = f"range of {fault.satellite} begins to be wrong ({fault.kind})"
            found.happened.append(Happened("fault", int(np.ceil(fault.start_s)), end if end < n else None, words))
        withdrawn = self._withdrawn(seed, track, found)
        self._fix(seed, track, faults, withdrawn, found)
        self._coast(seed, track, faults, withdrawn, found)
        found.happened.append(Happened("transition", self.fixes, None, "the last fix is carried on by carrier phase: no code from here"))
        return found

    def _withdrawn(self, seed: int, track: int, found: Navigated) -> NDArray[np.bool_]:
        """Satellites that the ground monitors take away, from the second in which they see a fault."""
        gone = np.zeros(self.sky.el_rad.shape, dtype=bool)
        for k, fault in enumerate(self.taxi.faults):
            seconds = np.arange(float(self.fixes))
            missed = gbas.missed_by_monitor(np.abs(errors.size(fault, seconds)), self.mode.service)
            # One draw a fault: it is seen once the curve falls below.
            draw = 0.0 if fault.missed else errors.stream(seed, track, errors.MONITOR, k).uniform()
            seen = np.flatnonzero(missed < draw)
            if seen.size:
                gone[seen[0] :, self.sky.names.index(fault.satellite)] = True
                words = f"the ground monitors see {fault.satellite}: it is withdrawn"
                found.happened.append(Happened("withdrawn", int(seen[0]), None, words))
        return gone

    def _fix(self, seed: int, track: int, faults: Floats, withdrawn: NDArray[np.bool_], found: Navigated) -> None:
        """GBAS with an inertial system."""
        navigation, sky, last = self.taxi.navigation, self.sky, self.fixes
        used = (sky.el_rad[:last] >= navigation.mask_rad) & ~withdrawn[:last]
        az, el = np.where(used, sky.az_rad[:last], np.nan), np.where(used, sky.el_rad[:last], np.nan)
        claimed = self._aided(az, el, navigation.covariance)
        levels = {
            name: gbas.protection_levels(
                az, el, sky.systems, service=self.mode.service, k=self._factors(p), bias_m=navigation.bias_m, aided_covariance_m2=claimed
            )
            for name, p in self.limits.items()
            if name in set(self.movement.phase[:last])
        }
        sigma = gbas.range_sigma(el, self.mode.service).sigma_m
        ranges = sigma * self._series(seed, track, errors.CODE, navigation.code_time_s)[:last] + self._biases(seed, track) + faults[:last]
        ok = next(iter(levels.values())).status == "ok"
        sight = errors.Sight.of(az[ok], el[ok], sky.systems)
        error = sight.solve(sigma[ok], ranges[ok])
        if navigation.covariance != "snapshot":
            own = gnss.covariance(az[ok], el[ok], sigma[ok], sky.systems).enu_m2
            filtered = claimed if claimed is not None and navigation.covariance == "paper" else self._filtered(az, el, "paper")
            error = errors.scaled_to(error, own, filtered[ok])
        found.error_enu_m[:last][ok] = error
        self._take(found, slice(0, last), levels)
        found.hpl_multi_m[:last] = np.nan

    def _coast(self, seed: int, track: int, faults: Floats, withdrawn: NDArray[np.bool_], found: Navigated) -> None:
        """RRAIM: the last fix carried on; a satellite whose absence moves the position too far is left out."""
        navigation, sky, first = self.taxi.navigation, self.sky, self.fixes
        fix = first - 1
        n = len(sky.el_rad) - first
        seconds = np.arange(1.0, n + 1.0)
        moved = self.movement.along_m[first:] - self.movement.along_m[fix]
        at_fix = (sky.el_rad[fix] >= navigation.mask_rad) & ~withdrawn[fix]
        az0, el0 = np.where(at_fix, sky.az_rad[fix], np.nan), np.where(at_fix, sky.el_rad[fix], np.nan)
        followed = at_fix & (sky.el_rad[first:] >= navigation.coasting_mask_rad)
        noise = self._series(seed, track, errors.PHASE, navigation.phase_time_s)
        drift = np.array([errors.stream(seed, track, errors.DRIFT, k).standard_normal() for k in range(len(sky.names))])
        claimed = self._aided(az0[None], el0[None], navigation.covariance)
        excluded: set[int] = set()
        begin = 0
        while begin < n:
            el = np.where(followed[begin:], sky.el_rad[first + begin :], np.nan)
            az = np.where(followed[begin:], sky.az_rad[first + begin :], np.nan)
            sigma = gbas.carrier_sigma(el, (moved / seconds)[begin:, None], seconds[begin:, None], self.carrier)
            levels = self._carried_on(az0, el0, az, el, sigma, claimed, phase=self.movement.phase[first + begin :], seconds=seconds[begin:])
            slow = np.sqrt(np.maximum(sigma**2 - 2 * self.carrier.noise_m**2, 0.0))
            phase = self.carrier.noise_m * (noise[first + begin :] - noise[fix]) + slow * drift + faults[first + begin :] - faults[fix]
            here = slice(first + begin, None)
            self._take(found, here, levels)
            carried = next(iter(levels.values()))
            ok = carried.status == "ok"
            error, moves = self._propagate(found.error_enu_m[fix], (az0, el0), (az[ok], el[ok]), sigma[ok], phase[ok])
            found.error_enu_m[here][ok] = error
            if excluded:
                self._degrade(found, here, ok, excluded)
            alarm = self._alarm(moves, carried.subset_separation_m[ok], carried.n_sv[ok], phase=self.movement.phase[here][ok])
            if alarm is None:
                break
            epoch, number = int(np.flatnonzero(ok)[alarm[0]]), alarm[1]
            words = f"without {sky.names[number]} the position moves {alarm[2]:.2f} m, more than {alarm[3]:.2f} m: it is left out"
            found.happened.append(Happened("excluded", first + begin + epoch, None, words))
            excluded.add(number)
            # The alarm is of this second; the position without the satellite serves from the next one on.
            begin += epoch + 1
            followed[begin:, number] = False

    def _carried_on(  # noqa: PLR0917 - the sky then, the sky now, and how well both are known
        self,
        az0: Floats,
        el0: Floats,
        az: Floats,
        el: Floats,
        sigma: Floats,
        claimed: Floats | None,
        *,
        phase: NDArray[np.str_],
        seconds: Floats,
    ) -> dict[str, rraim.Levels]:
        shape = el.shape
        gps, galileo = (gnss.CONSTELLATIONS.index(name) for name in ("gps", "galileo"))
        wide = {} if len(self.mode.systems) == 1 else {gps: self.rates.gps_wide, galileo: self.rates.galileo_wide}
        levels = {}
        for name in dict.fromkeys(phase.tolist()):
            limit = self.limits[name]
            allotted = self.shares.coasting_fault * limit.integrity_risk
            # The prior of the sub-phase's last second: nowhere in it is a fault likelier.
            hours = seconds[phase == name].max() / 3600.0
            levels[name] = rraim.protection_levels(
                np.broadcast_to(az0, shape),
                np.broadcast_to(el0, shape),
                az,
                el,
                sigma,
                self.sky.systems,
                service=self.mode.service,
                aided_covariance_m2=None if claimed is None else np.broadcast_to(claimed[0], (len(el), 3, 3)),
                bias_m=self.taxi.navigation.bias_m,
                k=self._factors(limit),
                continuity_risk=limit.continuity_risk,
                allotted_risk=allotted,
                p_sat={gps: self.rates.gps_per_hour * hours, galileo: self.rates.galileo_per_hour * hours},
                p_const=wide,
                p_threshold=self.shares.unmonitored * allotted,
            )
        return levels

    def _propagate(
        self, error0: Floats, then: tuple[Floats, Floats], now: tuple[Floats, Floats], sigma: Floats, phase: Floats
    ) -> tuple[Floats, Floats]:
        """Error of the fix carried on, and how far the horizontal position moves without each satellite (equation 11)."""
        sight = errors.Sight.of(*now, self.sky.systems)
        before = errors.Sight.of(np.where(sight.used, then[0], np.nan), np.where(sight.used, then[1], np.nan), self.sky.systems)
        turned = (sight.rows - before.rows)[..., :3] @ error0
        change = sight.solve(sigma, phase - turned)
        moves = np.zeros(sight.used.shape)
        for number in np.flatnonzero(sight.used.any(axis=0)):
            apart = change - sight.without(int(number)).solve(sigma, phase - turned)
            moves[:, number] = np.hypot(apart[:, 0], apart[:, 1])
        return error0 + change, moves

    def _alarm(
        self, moves: Floats, separation_m: Floats, n_sv: NDArray[np.int64], *, phase: NDArray[np.str_]
    ) -> tuple[int, int, float, float] | None:
        """First epoch with a separation above its threshold k_FA d(P_ss), the satellite, the separation and the threshold."""
        risk = np.array([self.limits[name].continuity_risk for name in phase])
        factor = np.array([NormalDist().inv_cdf(1.0 - r / (2 * n)) for r, n in zip(risk, n_sv, strict=True)])
        threshold = factor[:, None] * separation_m
        above = np.flatnonzero((moves > threshold).any(axis=1))
        if not above.size:
            return None
        epoch = int(above[0])
        number = int(np.nanargmax(moves[epoch] / threshold[epoch]))
        return epoch, number, float(moves[epoch, number]), float(threshold[epoch, number])

    def _take(self, found: Navigated, here: slice, levels: dict[str, gbas.Levels] | dict[str, rraim.Levels]) -> None:
        """Copy each second's levels from those of its sub-phase."""
        phase = self.movement.phase[here]
        for name, level in levels.items():
            of = phase == name
            found.covariance_m2[here][of] = level.covariance_enu_m2[of]
            found.hpl_m[here][of] = level.hpl_m[of]
            found.accuracy_m[here][of] = level.accuracy_m[of]
            found.n_sv[here][of] = level.n_sv[of]
            found.status[here][of] = level.status[of]
            found.reason[here][of] = [r or None for r in level.reason[of]]
            if isinstance(level, rraim.Levels):
                found.hpl_multi_m[here][of] = level.hpl_multi_m[of]

    def _degrade(self, found: Navigated, here: slice, ok: NDArray[np.bool_], excluded: set[int]) -> None:
        names = ", ".join(self.sky.names[k] for k in sorted(excluded))
        found.status[here][ok] = "degraded"
        found.reason[here][ok] = f"{names} left out: carrier phase disagrees"

    def _factors(self, limit: SubPhase) -> gbas.Factors:
        shares = self.shares
        return gbas.factors(
            limit.integrity_risk, share=shares.no_fault_and_receiver, axes=shares.axes, receiver_fault=shares.receiver_fault
        )

    def _aided(self, az: Floats, el: Floats, form: str) -> Floats | None:
        """Claimed covariance of the fix; None for that of the ranges alone."""
        return None if form == "snapshot" else self._filtered(az, el, "paper" if form == "paper" else "bound")

    def _filtered(self, az: Floats, el: Floats, noise: Literal["paper", "bound"]) -> Floats:
        """Of a filter that has seen this sky for a while; worked out anew every few seconds and when a satellite comes or goes."""
        used = ~np.isnan(el)
        anew = np.arange(len(el)) % FILTERED_EVERY_S == 0
        anew[1:] |= (used[1:] != used[:-1]).any(axis=1)
        lat_rad = float(self.movement.lat_rad[0])
        # Under an empty sky there is no filter to ask, and no level that would use its covariance.
        found = np.tile(np.eye(3), (int(anew.sum()), 1, 1))
        seen = used[anew].any(axis=1)
        if seen.any():
            skies = az[anew][seen], el[anew][seen], self.sky.systems
            found[seen] = gbas.aided_covariance(*skies, lat_rad=lat_rad, service=self.mode.service, noise=noise)
        held: Floats = found[np.cumsum(anew) - 1]
        return held

    def _series(self, seed: int, track: int, use: int, time_s: float) -> Floats:
        n = len(self.sky.el_rad)
        every = [errors.gauss_markov(errors.stream(seed, track, use, k), n, time_s) for k in range(len(self.sky.names))]
        return np.stack(every, axis=-1)

    def _biases(self, seed: int, track: int) -> Floats:
        most = self.taxi.navigation.bias_m
        return np.array([errors.stream(seed, track, errors.BIAS, k).uniform(-most, most) for k in range(len(self.sky.names))])
