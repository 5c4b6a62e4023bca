//! What a service offers at one instant: corrected satellites and the grid, before anyone asks from where.

use super::ionosphere::Grid;
use super::model::{Corrected, fast_degradation_m, steps, udre_variance_m2};
use crate::geometry::broadcast::in_axes_of_reception;
use crate::quantity::GpsTime;
use crate::signal::sbas::timeout::{FAST, RANGE_RATE_INTERVALS, Use};
use crate::signal::sbas::{
    ClockEphemerisCovariance, Correction, Degradation, IODF_ALERT, LongTerm, Satellite, ServiceRegions, Store, UDREI_NOT_MONITORED,
};
use crate::signal::{Klobuchar, SPEED_OF_LIGHT_MPS};
use crate::special::float::sqrt;
use nalgebra::Vector3;

/// Most satellites in one mask.
const SATELLITES: usize = crate::signal::sbas::MASK_MOST;
/// Most messages 27 in one issue.
const REGIONS: usize = 8;
/// From this UDRE indicator on a satellite is too poor for precision approach (standard).
const UDREI_TOO_POOR: u8 = 12;
/// e_C of message 28 when message 10 is not in force (en route only; inferred, the text was not read).
const UNKNOWN_COVARIANCE_M: f64 = 8.0;
const DAY_S: f64 = 86_400.0;

/// Position \[m\] and velocity \[m/s\] of a satellite, ECEF, from the navigation data of one issue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// Position \[m\].
    pub position_ecef_m: Vector3<f64>,
    /// Velocity in the turning axes \[m/s\].
    pub velocity_ecef_mps: Vector3<f64>,
}

/// A satellite that the service corrects now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranging {
    /// PRN code number.
    pub prn: u8,
    /// Issue of the navigation data.
    pub iode: u8,
    /// Corrected orbit.
    pub orbit: Orbit,
    /// What the long-term correction adds to the broadcast position \[m\], ECEF.
    pub moved_ecef_m: Vector3<f64>,
    /// To add to a measured range: fast correction with its rate \[m\].
    pub fast_m: f64,
    /// To add to the broadcast clock offset \[s\].
    pub clock_s: f64,
    /// What is left, before the user's place is known.
    pub corrected: Corrected,
    /// Message 28 and its e_C.
    pub covariance: Option<(ClockEphemerisCovariance, f64)>,
}

/// Why the service does not correct a satellite now.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Unserved {
    /// Nothing in force.
    #[error(transparent)]
    Correction(#[from] Correction),
    /// The service says so.
    #[error("UDRE indicator {0}")]
    Indicator(u8),
    /// Message 7 or 10 is missing.
    #[error("degradation parameters too old or never sent")]
    Degradation,
    /// The range rate has nothing to start from.
    #[error("no range rate")]
    RangeRate,
    /// Message 28 is sent, but none for this satellite is in force.
    #[error("clock-ephemeris covariance too old or never sent")]
    Covariance,
    /// No navigation data of the issue that is corrected.
    #[error("no navigation data of the issue corrected")]
    NavigationData,
}

/// Everything that does not depend on the user's place. No heap.
#[derive(Debug, Clone)]
pub struct Service {
    /// What it is used for.
    pub used_for: Use,
    /// When.
    pub now: GpsTime,
    /// The ionosphere that GPS broadcasts, for en route users where the grid does not serve them.
    pub broadcast_ionosphere: Option<Klobuchar>,
    /// The grid.
    pub grid: Grid,
    satellites: [Option<Ranging>; SATELLITES],
    /// Orbits of the same, number by number, for many users to look at several at once.
    orbits: Orbits,
    regions: [Option<ServiceRegions>; REGIONS],
    /// Message 0 is in force.
    pub stopped: bool,
    /// A PRN mask is in force.
    pub masked: bool,
    /// Satellites are missing because four seconds passed without a message.
    pub lost: bool,
}

/// Positions \[m\] and velocities \[m/s\], ECEF, axis by axis.
#[derive(Debug, Clone)]
pub(super) struct Orbits {
    count: usize,
    position: [[f64; SATELLITES]; 3],
    velocity: [[f64; SATELLITES]; 3],
}

impl Default for Orbits {
    fn default() -> Self {
        Self { count: 0, position: [[0.0; SATELLITES]; 3], velocity: [[0.0; SATELLITES]; 3] }
    }
}

impl Orbits {
    fn take(&mut self, satellites: &[Option<Ranging>; SATELLITES]) {
        self.count = 0;
        for (i, s) in satellites.iter().map_while(Option::as_ref).enumerate() {
            for axis in 0..3 {
                self.position[axis][i] = s.orbit.position_ecef_m[axis];
                self.velocity[axis][i] = s.orbit.velocity_ecef_mps[axis];
            }
            self.count += 1;
        }
    }

    /// Indices of those less than a kilometre below the horizon of a place: satellites move less during the signal's way, 0.14 s at 4 km/s.
    #[inline(always)]
    pub(super) fn above(&self, place: &Vector3<f64>, up: &Vector3<f64>) -> ([usize; SATELLITES], usize) {
        let level = up.dot(place) - 1000.0;
        let (mut numbers, mut n) = ([0; SATELLITES], 0);
        for i in 0..self.count {
            let height = up.x * self.position[0][i] + up.y * self.position[1][i] + up.z * self.position[2][i];
            numbers[n] = i;
            n += usize::from(height >= level);
        }
        (numbers, n)
    }

    /// Unit vectors from a place to the satellites when their signals left, in axes of reception.
    #[inline(always)]
    pub(super) fn towards<const L: usize>(&self, which: &[usize; L], from: &Vector3<f64>) -> [[f64; L]; 3] {
        let gather = |table: &[[f64; SATELLITES]; 3]| -> [[f64; L]; 3] {
            core::array::from_fn(|axis| core::array::from_fn(|l| table[axis][which[l]]))
        };
        let (position, velocity) = (gather(&self.position), gather(&self.velocity));
        let mut unit = [[0.0; L]; 3];
        for l in 0..L {
            let at = |k: usize| position[k][l] - from[k];
            let way_s = sqrt(at(0) * at(0) + at(1) * at(1) + at(2) * at(2)) / SPEED_OF_LIGHT_MPS;
            let sent = Vector3::new(
                position[0][l] - velocity[0][l] * way_s,
                position[1][l] - velocity[1][l] * way_s,
                position[2][l] - velocity[2][l] * way_s,
            );
            let line = in_axes_of_reception(&sent, way_s) - from;
            let inverse = 1.0 / sqrt(line.x * line.x + line.y * line.y + line.z * line.z);
            for k in 0..3 {
                unit[k][l] = line[k] * inverse;
            }
        }
        unit
    }
}

impl Service {
    /// Nothing offered.
    pub fn new(used_for: Use, broadcast_ionosphere: Option<Klobuchar>) -> Self {
        Self {
            used_for,
            now: GpsTime::default(),
            broadcast_ionosphere,
            grid: Grid::default(),
            satellites: [None; SATELLITES],
            orbits: Orbits::default(),
            regions: [None; REGIONS],
            stopped: false,
            masked: false,
            lost: false,
        }
    }

    /// Take what is in force now. `orbit` gives a satellite's orbit from the navigation data of an issue, or none.
    pub fn refresh(&mut self, store: &Store, now: GpsTime, orbit: impl Fn(u8, u8) -> Option<Orbit>) {
        self.now = now;
        self.satellites = [None; SATELLITES];
        self.orbits.count = 0;
        self.regions = [None; REGIONS];
        self.stopped = store.stopped(now);
        let prns = store.prns(self.used_for, now);
        self.lost = false;
        self.masked = !prns.is_empty() && !self.stopped;
        if !self.masked {
            return;
        }
        let mut free = self.satellites.iter_mut();
        for prn in prns {
            match ranging(store, *prn, self.used_for, now, &orbit) {
                Ok(satellite) => free.next().map_or((), |slot| *slot = Some(satellite)),
                Err(why) => self.lost |= why == Unserved::Correction(Correction::MessageLoss),
            }
        }
        self.orbits.take(&self.satellites);
        // Message 28 replaces 27: a service sends one of them.
        if !store.covariance_heard() {
            for (slot, regions) in self.regions.iter_mut().zip(store.regions(self.used_for, now)) {
                *slot = Some(*regions);
            }
        }
        self.grid.refresh(store, self.used_for, now);
    }

    /// Their orbits.
    pub(super) const fn orbits(&self) -> &Orbits {
        &self.orbits
    }

    /// Satellites corrected now, by the index of their orbit.
    pub(super) fn indexed(&self, index: usize) -> Option<&Ranging> {
        self.satellites.get(index)?.as_ref()
    }

    /// The correction of one satellite.
    pub fn satellite(&self, prn: u8) -> Option<&Ranging> {
        self.satellites().find(|s| s.prn == prn)
    }

    /// Satellites corrected now.
    pub fn satellites(&self) -> impl Iterator<Item = &Ranging> {
        // They stand first.
        self.satellites.iter().map_while(Option::as_ref)
    }

    /// Factor of the UDRE by the user's place (message 27), 1 where nobody sent one. Of regions that overlap, the one of the highest
    /// priority counts, and of equals the smaller factor (standard).
    pub fn region_factor(&self, lat_deg: f64, lon_deg: f64) -> f64 {
        // They stand first: mostly there are none, and every user asks.
        if self.regions[0].is_none() {
            return 1.0;
        }
        let inside = |s: &&ServiceRegions| s.regions.iter().flatten().any(|r| r.contains(lat_deg, lon_deg));
        let best = self.regions.iter().flatten().filter(inside).map(|s| (s.priority, s.inside));
        let best = best.reduce(|a, b| if b.0 > a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a });
        let outside = || self.regions.iter().flatten().map(|s| s.outside).fold(1.0, f64::max);
        best.map_or_else(outside, |(_, factor)| factor)
    }
}

/// One satellite's correction.
///
/// # Errors
/// [`Unserved`]: the first thing that lacks.
pub fn ranging(store: &Store, prn: u8, used_for: Use, now: GpsTime, orbit: impl Fn(u8, u8) -> Option<Orbit>) -> Result<Ranging, Unserved> {
    let satellite = store.satellite(prn, used_for, now)?;
    let approach = used_for == Use::PrecisionApproach;
    let limit = if approach { UDREI_TOO_POOR } else { UDREI_NOT_MONITORED };
    let udre_m2 = udre_variance_m2(satellite.udrei).filter(|_| satellite.udrei < limit);
    let udre_m2 = udre_m2.ok_or(Unserved::Indicator(satellite.udrei))?;
    let degradation = store.degradation(used_for, now);
    let rate = RangeRate::new(&satellite, used_for, now)?;
    // The newest long-term correction for which there are navigation data: a new issue may be announced before it is held.
    let candidates = satellite.long_term.iter().flatten();
    let (long_term, sent, orbit) =
        candidates.filter_map(|(l, sent)| Some((*l, *sent, orbit(prn, l.iode)?))).next().ok_or(Unserved::NavigationData)?;
    let terms = match (degradation, satellite.ageing) {
        (Some(d), Some((indicator, latency_s))) => {
            let (factor, _) = FAST.get(usize::from(indicator)).copied().ok_or(Unserved::Degradation)?;
            let age = now.seconds_since(satellite.udre_applies);
            let fc = fast_degradation_m(factor, age, f64::from(latency_s));
            let er = if satellite.aged { d.er_m } else { 0.0 };
            Some([fc, rate.degradation_m(d), long_term_degradation_m(&long_term, sent, now, d), er])
        }
        _ if approach => return Err(Unserved::Degradation),
        _ => None,
    };
    let covariance = match satellite.covariance {
        Some(c) => Some((c, degradation.map_or(UNKNOWN_COVARIANCE_M, |d| d.covariance * c.scale))),
        None if store.covariance_heard() => return Err(Unserved::Covariance),
        None => None,
    };
    let since = since_time_of_day(&long_term, now);
    let moved = |value: f64, rate: fn(&crate::signal::sbas::LongTermRates) -> f64| {
        value + long_term.rates.as_ref().map_or(0.0, |r| rate(r) * since)
    };
    let [x, y, z] = long_term.position_ecef_m;
    let delta =
        Vector3::new(moved(x, |r| r.velocity_ecef_mps[0]), moved(y, |r| r.velocity_ecef_mps[1]), moved(z, |r| r.velocity_ecef_mps[2]));
    Ok(Ranging {
        prn,
        iode: long_term.iode,
        orbit: Orbit { position_ecef_m: orbit.position_ecef_m + delta, ..orbit },
        moved_ecef_m: delta,
        fast_m: satellite.fast.correction_m + rate.mps * rate.age_s,
        clock_s: moved(long_term.clock_s, |r| r.drift),
        corrected: Corrected { udre_m: sqrt(udre_m2), degradation_m: terms, rss: degradation.is_some_and(|d| d.rss_udre) },
        covariance,
    })
}

/// The rate of the fast correction.
struct RangeRate {
    mps: f64,
    /// Since the newest correction \[s\].
    age_s: f64,
    /// Between the two corrections \[s\]; zero where no rate is needed.
    interval_s: f64,
    factor_mps2: f64,
    time_out_s: f64,
    /// No correction in between was missed.
    consecutive: bool,
    alert: bool,
}

impl RangeRate {
    fn new(satellite: &Satellite, used_for: Use, now: GpsTime) -> Result<Self, Unserved> {
        let newest = satellite.fast;
        let age_s = now.seconds_since(newest.applies);
        let indicator = satellite.ageing.map_or(0, |(indicator, _)| indicator);
        let (factor_mps2, out) = FAST.get(usize::from(indicator)).copied().ok_or(Unserved::Degradation)?;
        let time_out_s = f64::from(out.seconds(used_for));
        let none = Self { mps: 0.0, age_s, interval_s: 0.0, factor_mps2, time_out_s, consecutive: true, alert: false };
        // Indicator 0 (or none known): corrections change so slowly that no rate is taken.
        if factor_mps2 == 0.0 {
            return Ok(none);
        }
        let earlier = satellite.earlier.ok_or(Unserved::RangeRate)?;
        let interval_s = newest.applies.seconds_since(earlier.applies);
        if !(interval_s > 0.0 && interval_s <= time_out_s && age_s <= RANGE_RATE_INTERVALS * interval_s) {
            return Err(Unserved::RangeRate);
        }
        Ok(Self {
            mps: (newest.correction_m - earlier.correction_m) / interval_s,
            interval_s,
            consecutive: (newest.iodf + 3 - earlier.iodf) % 3 == 1,
            alert: newest.iodf == IODF_ALERT || earlier.iodf == IODF_ALERT,
            ..none
        })
    }

    /// ```text
    /// e_rrc = 0                                                     no rate, or no correction in between was missed
    ///       = (a I_fc / 4 + B_rrc / dt) (t - t_of)                  one was missed
    ///       = (a |dt - I_fc / 2| / 2 + B_rrc / dt) (t - t_of)       an alert, dt off half of the time-out
    /// ```
    fn degradation_m(&self, d: &Degradation) -> f64 {
        let off_m = if self.interval_s == 0.0 {
            return 0.0;
        } else if self.alert {
            let off_s = (self.interval_s - 0.5 * self.time_out_s).abs();
            if off_s == 0.0 {
                return 0.0;
            }
            0.5 * self.factor_mps2 * off_s
        } else if self.consecutive {
            return 0.0;
        } else {
            0.25 * self.factor_mps2 * self.time_out_s
        };
        (off_m + d.rrc_m / self.interval_s) * self.age_s
    }
}

/// ```text
/// e_ltc = C_v0 floor((t - t_ltc) / I_v0)                                      velocity code 0
///       = 0                                             t0 < t < t0 + I_v1    velocity code 1
///       = C_lsb + C_v1 max(0, t0 - t, t - t0 - I_v1)    else
/// ```
fn long_term_degradation_m(long_term: &LongTerm, sent: GpsTime, now: GpsTime, d: &Degradation) -> f64 {
    if long_term.rates.is_none() {
        return d.ltc_v0_m * steps(now.seconds_since(sent), d.ltc_v0_s);
    }
    let since = since_time_of_day(long_term, now);
    if since > 0.0 && since < d.ltc_v1_s {
        return 0.0;
    }
    d.ltc_lsb_m + d.ltc_v1_mps * (-since).max(since - d.ltc_v1_s).max(0.0)
}

/// Seconds since a long-term correction's time of applicability, to the nearest day; zero for one without.
fn since_time_of_day(long_term: &LongTerm, now: GpsTime) -> f64 {
    let Some(rates) = &long_term.rates else { return 0.0 };
    let day = (now.nanoseconds().rem_euclid(DAY_S as i64 * 1_000_000_000)) as f64 * 1e-9;
    let since = day - f64::from(rates.time_of_day_s);
    if since > 0.5 * DAY_S {
        since - DAY_S
    } else if since < -0.5 * DAY_S {
        since + DAY_S
    } else {
        since
    }
}

#[cfg(test)]
#[path = "service_tests.rs"]
mod tests;
