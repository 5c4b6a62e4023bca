//! How the aircraft follows the estimated position: a guidance law, a bank and a path angle that lag behind it, and gusts.
//!
//! Ours. In path coordinates, y the true deviation to the right, psi the track relative to the path, phi the bank, kappa the curvature of
//! the path, w the gust:
//!
//! ```text
//! y'   = V sin psi + w                               psi' = g tan(phi)/V - kappa V cos(psi)/(1 - kappa y)
//! phi' = (phi_c - phi)/tau                           phi_c = atan(V^2 kappa/g) - (omega^2 y_est + 2 zeta omega y')/g
//! z'   = v - v_path + w_z                            v' = (v_c - v)/tau_v, limited          v_c = v_path(t + lead) - k z_est
//! ```
//!
//! The guidance sees the estimated deviation, y_est = y - nse: the flight technical error is what it leaves of y_est, and the true
//! deviation is the two together.

use crate::philox::{Sensor, Stream};
use crate::plan::{GRAVITY, Plan};
use crate::profile::Demand;
use crate::scenario::{Guidance, Gusts};
use navbound_core::quantity::Metres;

/// Integration steps a second.
pub(crate) const STEPS: usize = 10;
const STEP_S: f64 = 1.0 / STEPS as f64;

/// Nearer to the centre of a turn than this share of its radius the path has no coordinates; an aircraft that is led there keeps these.
const CENTRE_SHARE: f64 = 0.1;
/// Deviation above or below the path at which the guidance climbs or descends at its most \[m\].
const SEEN_MOST_M: f64 = 1e3;

/// True deviation from the path \[m\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Deviation {
    pub(crate) right_m: f64,
    pub(crate) up_m: f64,
}

/// An aircraft under way.
pub(crate) struct Aircraft<'a> {
    plan: &'a Plan,
    guidance: Guidance,
    deviation: Deviation,
    track_rad: f64,
    bank_rad: f64,
    /// Vertical speed \[m/s\].
    climb_mps: f64,
    lateral: Gust,
    vertical: Gust,
}

/// A gust: first-order Gauss-Markov, exact over a step.
struct Gust {
    stream: Stream,
    sigma_mps: f64,
    length_m: f64,
    now_mps: f64,
}

impl Gust {
    fn new(mut stream: Stream, sigma_mps: f64, length_m: f64) -> Self {
        let now_mps = sigma_mps * stream.normal();
        Self { stream, sigma_mps, length_m, now_mps }
    }

    fn step(&mut self, speed_mps: f64) -> f64 {
        let keep = (-STEP_S * speed_mps / self.length_m).exp();
        self.now_mps = keep * self.now_mps + self.sigma_mps * (1.0 - keep * keep).sqrt() * self.stream.normal();
        self.now_mps
    }
}

impl<'a> Aircraft<'a> {
    pub(crate) fn new(plan: &'a Plan, guidance: Guidance, gusts: Gusts, seed: u64, flight: u64) -> Self {
        let gust = |sensor, sigma| Gust::new(Stream::new(seed, flight, sensor), sigma, gusts.length_m);
        Self {
            plan,
            guidance,
            deviation: Deviation::default(),
            track_rad: 0.0,
            bank_rad: 0.0,
            climb_mps: 0.0,
            lateral: gust(Sensor::LateralGust, gusts.lateral_sigma_mps),
            vertical: gust(Sensor::VerticalGust, gusts.vertical_sigma_mps),
        }
    }

    pub(crate) fn deviation(&self) -> Deviation {
        self.deviation
    }

    /// One step from `time_s`, with the navigation error (true minus estimated) across and upwards.
    pub(crate) fn step(&mut self, time_s: f64, error: Deviation) {
        let demand = self.plan.profile.at(time_s);
        if time_s < self.plan.profile.airborne_s {
            // On the runway the nose wheel holds the centreline; the rotation into the climb is not modelled.
            self.climb_mps = self.plan.profile.at(self.plan.profile.airborne_s).climb_mps;
            return;
        }
        let seen = Deviation { right_m: self.deviation.right_m - error.right_m, up_m: self.deviation.up_m - error.up_m };
        self.step_lateral(&demand, seen.right_m);
        self.step_vertical(time_s, &demand, seen.up_m);
    }

    fn step_lateral(&mut self, demand: &Demand, seen_m: f64) {
        let g = self.guidance;
        let v = demand.speed_mps;
        let curvature = self.plan.route.curvature_per_m(Metres::new(demand.along_m));
        let drift = v * self.track_rad.sin() + self.lateral.step(v);
        let omega = g.lateral_frequency_radps;
        let pull = omega * omega * seen_m + 2.0 * g.lateral_damping * omega * drift;
        let required = (v * v * curvature / GRAVITY).atan() - pull / GRAVITY;
        let command = required.clamp(-g.bank_limit_rad, g.bank_limit_rad);
        self.bank_rad += STEP_S / g.bank_lag_s * (command - self.bank_rad);
        let path_rate = curvature * v * self.track_rad.cos() / (1.0 - curvature * self.deviation.right_m).max(CENTRE_SHARE);
        self.track_rad += STEP_S * (GRAVITY * self.bank_rad.tan() / v - path_rate);
        self.deviation.right_m += STEP_S * drift;
    }

    fn step_vertical(&mut self, time_s: f64, demand: &Demand, seen_m: f64) {
        let g = self.guidance;
        let ahead = self.plan.profile.at(time_s + g.vertical_lead_s).climb_mps;
        let command = ahead - g.vertical_gain_per_s * seen_m.clamp(-SEEN_MOST_M, SEEN_MOST_M);
        let acceleration =
            ((command - self.climb_mps) / g.path_angle_lag_s).clamp(-g.vertical_acceleration_mps2, g.vertical_acceleration_mps2);
        self.climb_mps += STEP_S * acceleration;
        self.deviation.up_m += STEP_S * (self.climb_mps - demand.climb_mps + self.vertical.step(demand.speed_mps));
    }
}
