//! The further states of the filter: which they are, what they are worth, when they come and go.

use super::covariance::{BASE, FURTHER, Fade, Joint};
use super::settings::ClockModel;
use crate::quantity::GpsTime;
use crate::signal::{Constellation, SatelliteId};
use nalgebra::{Matrix3, Vector3};

/// What a further state is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Further {
    /// Receiver clock, as a length, and its rate.
    Clock,
    /// See [`Further::Clock`].
    ClockDrift,
    /// A constellation's time against the first one's.
    InterSystem(Constellation),
    /// Barometric altimeter.
    Baro,
    /// A DME station, by its place in the table of the flight.
    Dme(u16),
    /// A VOR station, likewise.
    Vor(u16),
    /// What stays in the ranges to a satellite.
    Satellite(SatelliteId),
    /// What stays in a position solved from ranges (the loose form), one of three numbers with variance 1 that its errors are made of.
    SolvedPosition(u8),
    /// The vehicle's heading and pitch against the inertial unit's, where it cannot slip sideways.
    MountHeading,
    /// See [`Further::MountHeading`].
    MountPitch,
}

#[derive(Debug, Clone, Copy)]
struct Slot {
    what: Further,
    value: f64,
    sigma: f64,
    tau_s: f64,
    seen: GpsTime,
}

/// Up to [`FURTHER`] of them, without holes: the last takes the place of one that goes.
#[derive(Debug, Clone)]
pub(super) struct Slots {
    n: usize,
    slot: [Slot; FURTHER],
    settled: GpsTime,
}

/// A first-order Gauss-Markov process, or a constant where tau is infinite.
#[derive(Debug, Clone, Copy)]
pub(super) struct Process {
    pub(super) sigma: f64,
    /// Deviation at the begin: sigma where it is stationary.
    pub(super) first: f64,
    pub(super) tau_s: f64,
}

impl Process {
    pub(super) const fn stationary(sigma: f64, tau_s: f64) -> Self {
        Self { sigma, first: sigma, tau_s }
    }

    pub(super) const fn constant(sigma: f64) -> Self {
        Self::stationary(sigma, f64::INFINITY)
    }
}

impl Slots {
    pub(super) fn new(time: GpsTime) -> Self {
        let empty = Slot { what: Further::Clock, value: 0.0, sigma: 0.0, tau_s: f64::INFINITY, seen: time };
        Self { n: 0, slot: [empty; FURTHER], settled: time }
    }

    pub(super) const fn len(&self) -> usize {
        self.n
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (Further, f64)> + '_ {
        self.slot[..self.n].iter().map(|s| (s.what, s.value))
    }

    /// Place in the joint state.
    pub(super) fn find(&self, what: Further) -> Option<usize> {
        self.slot[..self.n].iter().position(|s| s.what == what).map(|k| BASE + k)
    }

    pub(super) fn value(&self, place: usize) -> f64 {
        self.slot[place - BASE].value
    }

    pub(super) fn correct(&mut self, x: &[f64]) {
        for (slot, dx) in self.slot[..self.n].iter_mut().zip(x) {
            slot.value += dx;
        }
    }

    /// A measurement of it was used at this time.
    pub(super) fn saw(&mut self, place: usize, time: GpsTime) {
        self.slot[place - BASE].seen = time;
    }

    /// The state's place, new with this process and value if need be; `None` when all places are taken.
    pub(super) fn ensure(&mut self, joint: &mut Joint, what: Further, process: Process, value: f64) -> Option<usize> {
        if let Some(place) = self.find(what) {
            let slot = &mut self.slot[place - BASE];
            // The budget of a satellite changes with its elevation, that of a barometer with the height. The process noise follows and the
            // estimate stays; what the budget gains or loses was not in the estimate, or is no longer: that much is not known of it.
            let changed = (process.sigma * process.sigma - slot.sigma * slot.sigma).abs();
            (slot.sigma, slot.tau_s) = (process.sigma, process.tau_s);
            joint.add_variance(place, changed);
            return Some(place);
        }
        if self.n == FURTHER && !self.evict(joint) {
            return None;
        }
        let place = BASE + self.n;
        self.slot[self.n] = Slot { what, value, sigma: process.sigma, tau_s: process.tau_s, seen: self.settled };
        self.n += 1;
        joint.resize(self.n);
        joint.reset(place, process.first * process.first);
        Some(place)
    }

    /// Places of clock and drift; a new clock starts at the value that the first range gives.
    pub(super) fn ensure_clock(&mut self, joint: &mut Joint, model: &ClockModel, first: f64) -> Option<[usize; 2]> {
        self.ensure(joint, Further::ClockDrift, Process::constant(model.drift_mps), 0.0)?;
        let clock = self.ensure(joint, Further::Clock, Process::constant(model.bias_m), first)?;
        // The second may have moved the first.
        Some([clock, self.find(Further::ClockDrift)?])
    }

    /// Three states become a mixture of themselves, `z <- A z` plus noise of variance `q`.
    pub(super) fn mix(&mut self, joint: &mut Joint, places: [usize; 3], a: &Matrix3<f64>, q: &Matrix3<f64>) {
        let mixed = a * Vector3::from(places.map(|place| self.value(place)));
        for (k, place) in places.into_iter().enumerate() {
            self.slot[place - BASE].value = mixed[k];
        }
        joint.mix(places, a, q);
    }

    /// A value of which nothing is known any more but about where it is.
    pub(super) fn set_anew(&mut self, joint: &mut Joint, place: usize, value: f64, sigma: f64) {
        self.slot[place - BASE].value = value;
        joint.reset(place, sigma * sigma);
    }

    /// The station or satellite unseen for longest makes room.
    fn evict(&mut self, joint: &mut Joint) -> bool {
        let leaving = |s: &Slot| matches!(s.what, Further::Dme(_) | Further::Vor(_) | Further::Satellite(_));
        let oldest = (0..self.n).filter(|k| leaving(&self.slot[*k])).min_by_key(|k| self.slot[*k].seen);
        oldest.map(|k| self.remove(joint, k)).is_some()
    }

    fn remove(&mut self, joint: &mut Joint, k: usize) {
        let last = self.n - 1;
        if k == last {
            joint.reset(BASE + k, 0.0);
        } else {
            self.slot[k] = self.slot[last];
            joint.move_state(BASE + last, BASE + k);
        }
        self.n = last;
        joint.resize(self.n);
    }

    /// Bring values and covariance to a time, and forget satellites that have set.
    pub(super) fn settle(&mut self, joint: &mut Joint, time: GpsTime, model: &ClockModel, set_after_s: f64) {
        let dt = time.seconds_since(self.settled);
        if self.n == 0 || !(dt > 0.0) {
            self.settled = time;
            return;
        }
        let mut fades = [Fade { factor: 1.0, variance: 0.0 }; FURTHER];
        for (slot, fade) in self.slot[..self.n].iter_mut().zip(&mut fades) {
            *fade = Fade::gauss_markov(slot.sigma, slot.tau_s, dt);
            slot.value *= fade.factor;
        }
        joint.settle(&fades[..self.n]);
        if let Some((clock, drift)) = self.find(Further::Clock).zip(self.find(Further::ClockDrift)) {
            self.slot[clock - BASE].value += dt * self.value(drift);
            let (qf, qw) = (model.frequency_m2ps, model.walk_m2ps3);
            joint.integrate(clock, drift, dt, [qf * dt + qw * dt * dt * dt / 3.0, 0.5 * qw * dt * dt, qw * dt]);
        }
        self.settled = time;
        for k in (0..self.n).rev() {
            let slot = &self.slot[k];
            if matches!(slot.what, Further::Satellite(_)) && time.seconds_since(slot.seen) > set_after_s {
                self.remove(joint, k);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::covariance::{Row, WIDTH};
    use super::super::dynamics::NAV;
    use super::*;

    const SLOW: Process = Process::stationary(5.0, 100.0);

    fn at(seconds: f64) -> GpsTime {
        GpsTime::default().plus_seconds(seconds)
    }
    fn satellite(number: u8) -> Further {
        Further::Satellite(SatelliteId { constellation: Constellation::Gps, number })
    }
    fn empty() -> (Joint, Slots) {
        (Joint::new(&[1.0; NAV]), Slots::new(at(0.0)))
    }
    /// A range that holds the position, the clock and the satellite's own state ties them together.
    fn tie(joint: &mut Joint, places: [usize; 2]) {
        let row = Row::empty().with(0, 0.6).with(1, -0.3).with(places[0], 1.0).with(places[1], 1.0);
        joint.update(&row, 0.0, 1.0, &mut [0.0; WIDTH]);
    }

    #[test]
    fn a_satellite_that_sets_leaves_the_others_as_they_are() {
        let (mut joint, mut slots) = empty();
        let model = ClockModel::default();
        let [clock, drift] = slots.ensure_clock(&mut joint, &model, 7.0).unwrap();
        for number in 1..=3 {
            let place = slots.ensure(&mut joint, satellite(number), SLOW, 0.0).unwrap();
            tie(&mut joint, [clock, place]);
        }
        let third = slots.find(satellite(3)).unwrap();
        let before = [joint.get(third, third), joint.get(third, clock), joint.get(third, 0), joint.get(clock, drift)];
        slots.remove(&mut joint, slots.find(satellite(1)).unwrap() - BASE);
        let third = slots.find(satellite(3)).unwrap();
        assert_eq!(before, [joint.get(third, third), joint.get(third, clock), joint.get(third, 0), joint.get(clock, drift)]);
        assert_eq!((slots.len(), slots.value(clock)), (4, 7.0));
        // What rises again knows nothing of before.
        let again = slots.ensure(&mut joint, satellite(1), SLOW, 0.0).unwrap();
        assert_eq!((joint.get(again, again), joint.get(again, clock), joint.get(0, again)), (25.0, 0.0, 0.0));
    }

    #[test]
    fn a_process_that_is_not_stationary_begins_as_it_says() {
        let (mut joint, mut slots) = empty();
        let place = slots.ensure(&mut joint, satellite(1), Process { first: 2.0, ..SLOW }, 0.0).unwrap();
        assert_eq!(joint.get(place, place), 4.0);
        slots.settle(&mut joint, at(100.0), &ClockModel::default(), 600.0);
        // After one time constant e^-2 of the begin and the rest of the 25 m² of the process, to rounding.
        let kept = (-2.0_f64).exp();
        assert!((joint.get(place, place) - (4.0 * kept + 25.0 * (1.0 - kept))).abs() < 1e-12);
    }

    #[test]
    fn unseen_satellites_are_forgotten_and_stations_are_not() {
        let (mut joint, mut slots) = empty();
        let model = ClockModel::default();
        let seen = slots.ensure(&mut joint, satellite(1), SLOW, 0.0).unwrap();
        slots.ensure(&mut joint, satellite(2), SLOW, 0.0).unwrap();
        slots.ensure(&mut joint, Further::Dme(4), Process::constant(90.0), 0.0).unwrap();
        slots.saw(seen, at(50.0));
        slots.settle(&mut joint, at(70.0), &model, 60.0);
        assert!(slots.find(satellite(1)).is_some() && slots.find(satellite(2)).is_none());
        let station = slots.find(Further::Dme(4)).unwrap();
        assert_eq!(joint.get(station, station), 8100.0);
    }

    #[test]
    fn with_all_places_taken_the_longest_unseen_makes_room_and_nothing_else_does() {
        let (mut joint, mut slots) = empty();
        for k in 0..FURTHER {
            let place = slots.ensure(&mut joint, Further::Dme(k as u16), SLOW, 0.0).unwrap();
            slots.saw(place, at(if k == 20 { 1.0 } else { 2.0 }));
        }
        assert!(slots.ensure(&mut joint, Further::Baro, SLOW, 0.0).is_some());
        assert!(slots.find(Further::Dme(20)).is_none() && slots.find(Further::Dme(19)).is_some());
        let (mut joint, mut slots) = empty();
        for k in 0..FURTHER {
            slots.slot[k].what = Further::Baro;
        }
        slots.n = FURTHER;
        assert!(slots.ensure(&mut joint, Further::Dme(1), SLOW, 0.0).is_none());
    }

    /// A clock without a bias of its own drifts: variance of the bias grows by drift dt, and by the noise's integrals.
    #[test]
    fn a_clock_grows_with_its_drift() {
        let (mut joint, mut slots) = empty();
        let model = ClockModel { bias_m: 2.0, drift_mps: 3.0, frequency_m2ps: 0.5, walk_m2ps3: 0.06, inter_system_m: 1.0 };
        let [clock, drift] = slots.ensure_clock(&mut joint, &model, 0.0).unwrap();
        slots.settle(&mut joint, at(10.0), &model, 60.0);
        // 4 + 900 + 0.5 * 10 + 0.06 * 1000 / 3; 90 + 0.06 * 100 / 2; 9 + 0.6, to the rounding of some additions.
        let variances = [joint.get(clock, clock), joint.get(clock, drift), joint.get(drift, drift)];
        assert!(variances.iter().zip([929.0, 93.0, 9.6]).all(|(f, e)| (f - e).abs() < 1e-12 * e), "{variances:?}");
    }
}
