//! What is the same for every flight of a scenario: where the path is at each second, and what the satellites allow there.
//!
//! Geometry is taken at the planned position; an aircraft some hundred metres beside it sees the same sky.

use crate::plan::{Plan, Refused};
use crate::profile::Demand;
use crate::ranging;
use crate::scenario::{Fault, Navigation, Scenario};
use nalgebra::Matrix3;
use navbound_core::frame::{Covariance, Enu, Geodetic};
use navbound_core::geometry::{LineOfSight, Observer, Orbit};
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Unavailable};
use navbound_core::signal::Constellation;
use navbound_core::solution::wls;
use navbound_path::Place;

/// One second of the plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Instant {
    pub(crate) time_s: f64,
    pub(crate) demand: Demand,
    pub(crate) place: Place,
    pub(crate) sky: Sky,
}

impl Instant {
    /// Dilutions of precision, horizontal and vertical; NaN where there are none.
    pub(crate) fn dop(&self) -> [f64; 2] {
        self.sky.dilution.map_or([f64::NAN; 2], |d| [d.horizontal, d.vertical])
    }
}

/// What the satellites allow at an instant.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sky {
    pub(crate) n_sv: usize,
    pub(crate) dilution: Option<wls::Dilution>,
    /// Covariance of the true error.
    pub(crate) covariance: Result<Covariance<Enu>, Unavailable>,
    /// Its Cholesky factor; of the last instant that had one where there is none.
    pub(crate) factor: Matrix3<f64>,
}

/// A plan and what the satellites allow along it: all that flights share.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    pub(crate) plan: Plan,
    pub(crate) scenario: Scenario,
    pub(crate) instants: Vec<Instant>,
}

/// Satellites of the scenario, ready to state where they are.
struct Satellites(Vec<(Constellation, Orbit)>);

impl Outlook {
    /// The outlook of a scenario, one instant a second: the first at the begin, the last in the flight's last second.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn new(scenario: Scenario) -> Result<Self, Refused> {
        let plan = Plan::new(&scenario)?;
        let satellites = Satellites::new(&scenario.navigation)?;
        let mut instants: Vec<Instant> = Vec::new();
        let mut factor = Matrix3::zeros();
        let mut second = 0.0;
        while second < scenario.duration_s {
            let demand = plan.profile.at(second);
            let place = plan.route.at(Metres::new(demand.along_m))?;
            let at = Geodetic { point: place.point, height: Metres::new(demand.height_m) };
            let mut sky = satellites.sky(&at, scenario.start_ns as f64 * 1e-9 + second, &scenario.navigation)?;
            sky.degrade(degradation(&scenario.faults, second));
            sky.keep_factor(&mut factor);
            instants.push(Instant { time_s: second, demand, place, sky });
            second += 1.0;
        }
        Ok(Self { plan, scenario, instants })
    }

    /// How many seconds it has.
    pub fn seconds(&self) -> usize {
        self.instants.len()
    }
    /// Dilutions of precision at one of them, horizontal and vertical; NaN where there are none.
    pub fn dop(&self, second: usize) -> [f64; 2] {
        self.instants.get(second).map_or([f64::NAN; 2], Instant::dop)
    }
    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
}

impl Satellites {
    fn new(navigation: &Navigation) -> Result<Self, OutOfDomain> {
        let mut orbits = Vec::new();
        for system in &navigation.constellations {
            for slot in system.slots() {
                orbits.push((slot.satellite.constellation, Orbit::new(slot.elements)?));
            }
        }
        Ok(Self(orbits))
    }

    fn sky(&self, at: &Geodetic, orbit_time_s: f64, navigation: &Navigation) -> Result<Sky, OutOfDomain> {
        let observer = Observer::new(at);
        let mut sights = Vec::with_capacity(self.0.len());
        for (constellation, orbit) in &self.0 {
            let seen = observer.direction(&orbit.position(orbit_time_s))?;
            if seen.elevation().rad() >= navigation.mask_rad {
                sights.push(LineOfSight::new(seen, ranging::sigma(navigation, seen.elevation()), *constellation)?);
            }
        }
        let covariance = wls::covariance(sights.iter());
        Ok(Sky { n_sv: sights.len(), dilution: wls::dilution(sights.iter()).ok(), covariance, factor: Matrix3::zeros() })
    }
}

impl Sky {
    fn degrade(&mut self, sigma_factor: f64) {
        if let Ok(covariance) = &mut self.covariance {
            *covariance = Covariance::claim_symmetric(covariance.matrix() * (sigma_factor * sigma_factor));
        }
    }

    fn keep_factor(&mut self, last: &mut Matrix3<f64>) {
        if let Some(cholesky) = self.covariance.as_ref().ok().and_then(|c| c.matrix().cholesky()) {
            *last = cholesky.l();
        }
        self.factor = *last;
    }
}

fn degradation(faults: &[Fault], time_s: f64) -> f64 {
    let mut factor = 1.0;
    for fault in faults {
        if let Fault::DegradedRanging { start_s, duration_s, sigma_factor } = *fault
            && (start_s..start_s + duration_s).contains(&time_s)
        {
            factor *= sigma_factor;
        }
    }
    factor
}

/// Error across the path that faults add \[m\], positive right.
pub(crate) fn lateral_fault_m(faults: &[Fault], time_s: f64) -> f64 {
    let ramp = |fault: &Fault| match *fault {
        Fault::LateralRamp { start_s, duration_s, rate_mps } if (start_s..start_s + duration_s).contains(&time_s) => {
            rate_mps * (time_s - start_s)
        }
        _ => 0.0,
    };
    faults.iter().map(ramp).sum()
}

/// Unit vector to the right of a course, east-north-up.
pub(crate) fn right_of(course: Radians) -> nalgebra::Vector3<f64> {
    let (s, c) = course.rad().sin_cos();
    nalgebra::Vector3::new(c, -s, 0.0)
}
