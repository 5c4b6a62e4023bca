"""How the aircraft knows where it is on the ground: GBAS with an inertial system, then the last fix carried on by carrier phase.

One flight is worked out at a time: what the monitors take away depends on its errors.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import gbas, gnss, rraim
from navbound.ground.inertial import Inertial, InertialFlight, Solved
from navbound.ground.sky import STEPS, Sky, line, look, mode_of, way
from navbound.scenario.taxi import check_satellites
from navbound.status import REASONS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.gbas import SubPhase
    from navbound.ground.motion import Movement
    from navbound.scenario.taxi import Taxi

    Floats = NDArray[np.float64]
    Angles = tuple[Floats, Floats]
    Draw = tuple[int, int]


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
    status, reason_id, reason : ndarray
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
    reason_id: NDArray[np.object_]
    reason: NDArray[np.object_]
    happened: list[Happened]


@dataclass(frozen=True)
class Phases:
    """Phase while coasting, a column a satellite; NaN for one that is not followed.

    Attributes
    ----------
    at_fix : ndarray of bool, shape (n,)
        Which satellites the fix was made with.
    sigma_m : ndarray, shape (coasting, n)
        Of phase differenced since the fix (equation 20). [m]
    error_m : ndarray, shape (steps + 1, n)
        From the fix on, :data:`STEPS` instants a second. [m]
    sigma_rate_mps : ndarray, shape (steps, n)
        Of the rates it makes from instant to instant. [m/s]
    """

    at_fix: NDArray[np.bool_]
    sigma_m: Floats
    error_m: Floats
    sigma_rate_mps: Floats


def seen(sky: Sky, rows: int | slice, used: NDArray[np.bool_]) -> Angles:
    """Azimuth and elevation of the satellites used, NaN for the others [rad]."""
    return np.where(used, sky.az_rad[rows], np.nan), np.where(used, sky.el_rad[rows], np.nan)


def moved_by(response: Floats, range_m: Floats) -> Floats:
    """Position that range errors make, east, north, up [m]; a range that is NaN is not used; shape (..., 3)."""
    moved: Floats = (response @ np.nan_to_num(range_m, nan=0.0)[..., None])[..., 0]
    return moved


class Navigator:
    """Everything that all flights of a scenario share."""

    def __init__(self, taxi: Taxi, movement: Movement, limits: dict[str, SubPhase]) -> None:
        self.taxi, self.movement, self.limits = taxi, movement, limits
        flown = way(taxi, movement)
        self.lead, fine = flown.lead, look(taxi, flown)
        self.approach = fine.rows(slice(None, None, STEPS))
        self.sky: Sky = self.approach.rows(slice(flown.lead, None))
        check_satellites(taxi, self.sky.names)
        self.faulty = [self.sky.names.index(fault.satellite) for fault in taxi.faults]
        self.mode = mode_of(taxi)
        self.shares = gbas.allocation()
        self.rates = gbas.fault_rates()[taxi.navigation.case]
        self.carrier = gbas.carriers()[self.mode.carrier]
        self.fixes = int(np.argmax(movement.coasts))
        """Seconds before coasting; the fix that is carried on is the last of them."""
        self.inertial = None if taxi.navigation.covariance == "snapshot" else Inertial(taxi, movement, flown, fine)

    def fly(self, seed: int, track: int) -> Navigated:
        """Navigate one flight."""
        n = len(self.sky.el_rad)
        navigated = Navigated(
            np.full((n, 3), np.nan),
            np.full((n, 3, 3), np.nan),
            np.full(n, np.nan),
            np.full(n, np.nan),
            np.full(n, np.nan),
            np.zeros(n),
            np.full(n, "not_available", dtype=object),
            np.full(n, None, dtype=object),
            np.full(n, None, dtype=object),
            [],
        )
        for fault in self.taxi.faults:
            end = round(fault.start_s + fault.duration_s)
            words = f"range of {fault.satellite} begins to be wrong ({fault.kind})"
            navigated.happened.append(Happened("fault", int(np.ceil(fault.start_s)), end if end < n else None, words))
        draw = (seed, track)
        withdrawn = self._withdrawn(draw, navigated)
        flight = None if self.inertial is None else self.inertial.flight(seed, track)
        ranges = self._range_errors(draw, withdrawn)
        phases = self._phase_errors(draw, withdrawn)
        solved = None if flight is None else flight.solve(ranges, phases.error_m, phases.sigma_rate_mps)
        self._fix(ranges[self.lead :], solved, navigated)
        self._coast(ranges, phases, flight, solved, navigated)
        navigated.happened.append(
            Happened("transition", self.fixes, None, "the last fix is carried on by carrier phase: no code from here")
        )
        return navigated

    def _withdrawn(self, draw: Draw, navigated: Navigated) -> NDArray[np.bool_]:
        """Satellites that the ground monitors take away, from the second in which they see a fault."""
        gone = np.zeros(self.sky.el_rad.shape, dtype=bool)
        # One draw a fault: it is seen once the curve falls below.
        for k, (fault, chance) in enumerate(zip(self.taxi.faults, self.movement.core.monitor(draw), strict=True)):
            missed = gbas.missed_by_monitor(np.abs(self.movement.core.fault(k, self.fixes)), self.mode.service)
            seen = np.flatnonzero(missed < (0.0 if fault.missed else chance))
            if seen.size:
                gone[seen[0] :, self.faulty[k]] = True
                words = f"the ground monitors see {fault.satellite}: it is withdrawn"
                navigated.happened.append(Happened("withdrawn", int(seen[0]), None, words))
        return gone

    def _range_errors(self, draw: Draw, withdrawn: NDArray[np.bool_]) -> Floats:
        """Errors of corrected, smoothed ranges from the begin of the approach to the last fix; NaN for one that is not used [m]."""
        n = self.lead + self.fixes
        el = self.approach.el_rad[:n]
        used = el >= self.taxi.navigation.mask_rad
        used[self.lead :] &= ~withdrawn[: self.fixes]
        sigma = gbas.range_sigma(np.where(used, el, np.nan), self.mode.service).sigma_m
        return self.movement.core.range_errors(draw, sigma, self.lead, self.faulty).reshape(el.shape)

    def _phase_errors(self, draw: Draw, withdrawn: NDArray[np.bool_]) -> Phases:
        """Errors of phase from the last fix on, of satellites that are followed; their sigma is that of equation 20."""
        navigation, sky, fix = self.taxi.navigation, self.sky, self.fixes - 1
        steps, wide = STEPS * (len(sky.el_rad) - self.fixes), len(sky.names)
        seconds = np.arange(1.0, steps + 1.0) / STEPS
        # A satellite is followed through a second at whose end it is.
        ends = fix + np.ceil(seconds).astype(np.int64)
        at_fix = (sky.el_rad[fix] >= navigation.mask_rad) & ~withdrawn[fix]
        el = np.where(at_fix & (sky.el_rad[ends] >= navigation.coasting_mask_rad), sky.el_rad[ends], np.nan)
        along = np.interp(fix + seconds, np.arange(len(sky.el_rad)), self.movement.along_m)
        speed = (along - self.movement.along_m[fix]) / seconds
        sigma = gbas.carrier_sigma(el, speed[:, None], seconds[:, None], self.carrier)
        noise_and_fix = (self.carrier.noise_m, fix)
        error, sigma_rate = self.movement.core.phase_errors(draw, sigma, at_fix.tolist(), noise_and_fix, self.faulty)
        return Phases(at_fix, sigma[STEPS - 1 :: STEPS], error.reshape(-1, wide), sigma_rate.reshape(-1, wide))

    def _fix(self, ranges: Floats, solved: Solved | None, navigated: Navigated) -> None:
        """GBAS with an inertial system."""
        sky, last = self.sky, self.fixes
        used = ~np.isnan(ranges)
        az, el = seen(sky, slice(last), used)
        levels = {
            name: gbas.protection_levels(
                az,
                el,
                sky.systems,
                service=self.mode.service,
                k=self._factors(p),
                bias_m=self.taxi.navigation.bias_m,
                aided_covariance_m2=None if solved is None else solved.covariance_m2[:last],
            )
            for name, p in self.limits.items()
            if name in set(self.movement.phase[:last])
        }
        ok = next(iter(levels.values())).status == "ok"
        if solved is None:
            response = gnss.responses(az[ok], el[ok], gbas.range_sigma(el[ok], self.mode.service).sigma_m, sky.systems)
            navigated.error_enu_m[:last][ok] = moved_by(response, ranges[ok])
        else:
            navigated.error_enu_m[:last][ok] = solved.error_enu_m[:last][ok]
        self._take(navigated, slice(0, last), levels)
        navigated.hpl_multi_m[:last] = np.nan

    def _coast(self, ranges: Floats, phases: Phases, flight: InertialFlight | None, solved: Solved | None, navigated: Navigated) -> None:
        """RRAIM: the last fix carried on; a satellite whose absence moves the position too far is left out."""
        sky, first = self.sky, self.fixes
        fix = first - 1
        n = len(sky.el_rad) - first
        then = seen(sky, fix, phases.at_fix)
        claimed = None if solved is None else solved.covariance_m2[fix]
        error = phases.error_m.copy()
        excluded: set[int] = set()
        begin = 0
        while begin < n:
            here = slice(first + begin, None)
            phase = error[STEPS * (begin + 1) :: STEPS]
            followed = ~np.isnan(phase)
            now = seen(sky, here, followed)
            sigma = np.where(followed, phases.sigma_m[begin:], np.nan)
            levels = self._carried_on(then, now, sigma, claimed, phase=self.movement.phase[here], seconds=np.arange(begin + 1.0, n + 1.0))
            self._take(navigated, here, levels)
            carried = next(iter(levels.values()))
            ok = carried.status == "ok"
            change, moves = self._propagate(navigated.error_enu_m[fix], then, (now[0][ok], now[1][ok]), sigma[ok], phase[ok])
            navigated.error_enu_m[here][ok] = navigated.error_enu_m[fix] + change if solved is None else solved.error_enu_m[here][ok]
            if excluded:
                self._degrade(navigated, here, ok, excluded)
            thresholds = {name: level.subset_threshold_m[ok] for name, level in levels.items()}
            alarm = self._alarm(moves, thresholds, self.movement.phase[here][ok])
            if alarm is None:
                break
            epoch, number = int(np.flatnonzero(ok)[alarm[0]]), alarm[1]
            words = f"without {sky.names[number]} the position moves {alarm[2]:.2f} m, more than {alarm[3]:.2f} m: it is left out"
            navigated.happened.append(Happened("excluded", first + begin + epoch, None, words))
            excluded.add(number)
            # The alarm is of this second; from the next one on serves the position that has not had the satellite since the fix.
            begin += epoch + 1
            error[:, number] = np.nan
            if flight is not None:
                solved = flight.solve(ranges, error, phases.sigma_rate_mps)

    def _carried_on(
        self,
        then: Angles,
        now: Angles,
        sigma: Floats,
        claimed: Floats | None,
        *,
        phase: NDArray[np.str_],
        seconds: Floats,
    ) -> dict[str, rraim.Levels]:
        shape = sigma.shape
        gps, galileo = (gnss.CONSTELLATIONS.index(name) for name in ("gps", "galileo"))
        rates, single = self.rates, len(self.mode.systems) == 1
        wide = {} if single else {gps: rates.gps_wide_per_hour, galileo: rates.galileo_wide_per_hour}
        levels = {}
        for name in dict.fromkeys(phase.tolist()):
            limit = self.limits[name]
            allotted = self.shares.coasting_fault * limit.integrity_risk
            # The prior of the sub-phase's last second: nowhere in it is a fault likelier.
            hours = seconds[phase == name].max() / 3600.0
            levels[name] = rraim.protection_levels(
                np.broadcast_to(then[0], shape),
                np.broadcast_to(then[1], shape),
                *now,
                sigma,
                self.sky.systems,
                service=self.mode.service,
                aided_covariance_m2=None if claimed is None else np.broadcast_to(claimed, (len(sigma), 3, 3)),
                bias_m=self.taxi.navigation.bias_m,
                k=self._factors(limit),
                continuity_risk=limit.continuity_risk,
                allotted_risk=allotted,
                p_sat={gps: rates.gps_per_hour * hours, galileo: rates.galileo_per_hour * hours},
                p_const={system: per_hour * hours for system, per_hour in wide.items()},
                p_threshold=self.shares.unmonitored * allotted,
            )
        return levels

    def _propagate(self, error0: Floats, then: Angles, now: Angles, sigma: Floats, phase: Floats) -> tuple[Floats, Floats]:
        """Change of the error of a fix that phase alone carries on, and how far it moves without each satellite (equation 11)."""
        turned = (line(*then) - line(*now)) @ error0
        change = moved_by(gnss.responses(*now, sigma, self.sky.systems), phase - turned)
        moves = np.zeros(sigma.shape)
        for number in np.flatnonzero((~np.isnan(sigma)).any(axis=0)):
            less = np.where(np.arange(sigma.shape[1]) == number, np.nan, sigma)
            some = np.where(np.isnan(less), np.nan, now[0]), np.where(np.isnan(less), np.nan, now[1])
            apart = change - moved_by(gnss.responses(*some, less, self.sky.systems), np.where(np.isnan(less), np.nan, phase - turned))
            moves[:, number] = np.hypot(apart[:, 0], apart[:, 1])
        return change, moves

    @staticmethod
    def _alarm(moves: Floats, thresholds: dict[str, Floats], phase: NDArray[np.str_]) -> tuple[int, int, float, float] | None:
        """First epoch with a separation above its threshold, the satellite, the separation and the threshold."""
        threshold = np.full(moves.shape, np.nan)
        for name, of_phase in thresholds.items():
            threshold[phase == name] = of_phase[phase == name]
        above = np.flatnonzero((moves > threshold).any(axis=1))
        if not above.size:
            return None
        epoch = int(above[0])
        number = int(np.nanargmax(moves[epoch] / threshold[epoch]))
        return epoch, number, float(moves[epoch, number]), float(threshold[epoch, number])

    def _take(self, navigated: Navigated, here: slice, levels: dict[str, gbas.Levels] | dict[str, rraim.Levels]) -> None:
        """Copy each second's levels from those of its sub-phase."""
        phase = self.movement.phase[here]
        for name, level in levels.items():
            of = phase == name
            navigated.covariance_m2[here][of] = level.covariance_enu_m2[of]
            navigated.hpl_m[here][of] = level.hpl_m[of]
            navigated.accuracy_m[here][of] = level.accuracy_m[of]
            navigated.n_sv[here][of] = level.n_sv[of]
            navigated.status[here][of] = level.status[of]
            navigated.reason_id[here][of] = [r or None for r in level.reason_id[of]]
            navigated.reason[here][of] = [r or None for r in level.reason[of]]
            if isinstance(level, rraim.Levels):
                navigated.hpl_multi_m[here][of] = level.hpl_multi_m[of]

    def _degrade(self, navigated: Navigated, here: slice, ok: NDArray[np.bool_], excluded: set[int]) -> None:
        names = ", ".join(self.sky.names[k] for k in sorted(excluded))
        excluded_by_phase = REASONS["carrier_excluded"]
        navigated.status[here][ok] = excluded_by_phase.status
        navigated.reason_id[here][ok] = excluded_by_phase.id
        navigated.reason[here][ok] = f"{names} {excluded_by_phase.words}"

    def _factors(self, limit: SubPhase) -> gbas.Factors:
        shares = self.shares
        return gbas.factors(
            limit.integrity_risk, share=shares.no_fault_and_receiver, axes=shares.axes, receiver_fault=shares.receiver_fault
        )
