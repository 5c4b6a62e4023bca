//! The further states of the filter: which they are, what they are worth, when they come and go.

use super::covariance::{BASE, FURTHER, Fade, Joint};
use super::settings::ClockModel;
use crate::quantity::GpsTime;
use crate::signal::{Constellation, SatelliteId};

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
    pub(super) tau_s: f64,
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
            // The budget of a satellite changes with its elevation: the process noise follows, the estimate stays.
            (slot.sigma, slot.tau_s) = (process.sigma, process.tau_s);
            return Some(place);
        }
        if self.n == FURTHER && !self.evict(joint) {
            return None;
        }
        let place = BASE + self.n;
        self.slot[self.n] = Slot { what, value, sigma: process.sigma, tau_s: process.tau_s, seen: self.settled };
        self.n += 1;
        joint.resize(self.n);
        joint.reset(place, process.sigma * process.sigma);
        Some(place)
    }

    /// Places of clock and drift; a new clock starts at the value that the first range gives.
    pub(super) fn ensure_clock(&mut self, joint: &mut Joint, model: &ClockModel, first: f64) -> Option<[usize; 2]> {
        let constant = |sigma| Process { sigma, tau_s: f64::INFINITY };
        self.ensure(joint, Further::ClockDrift, constant(model.drift_mps), 0.0)?;
        let clock = self.ensure(joint, Further::Clock, constant(model.bias_m), first)?;
        // The second may have moved the first.
        Some([clock, self.find(Further::ClockDrift)?])
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
