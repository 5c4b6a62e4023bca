//! What the instructions of are counted: every method and every algorithm of the lists, the monitor, and a navigated flight.
//!
//! Prints a line for each, its name and how often it is called, and enters [`mark`] before and after the calls, so that a counter that
//! follows the program (`bench/instructions.py`) knows where each begins and ends. What is prepared once is prepared before that.
#![allow(clippy::print_stdout, reason = "its lines are what it is for")]

use nalgebra::{Matrix3, Vector3};
use navbound_assess::fused::navigate;
use navbound_core::bound::{ALGORITHMS, AlertBound, Alerting, Algorithm, Sight, Task, methods, with_algorithm};
use navbound_core::frame::{Covariance, Displacement};
use navbound_core::monitor::rnp::{Chain, Monitor, Observation, Settings};
use navbound_core::quantity::{GpsTime, Metres, Radians, Risk};
use navbound_core::signal::Constellation;
use navbound_core::solution::Epoch;
use navbound_simulate::{Scenario, Sensing, Sensors};
use std::error::Error;
use std::hint::black_box;

#[path = "../../core/tests/common/sky.rs"]
mod sky;

/// Calls of a bound.
const MANY: u32 = 100;
/// Calls of protection levels, of which one lists thousands of fault modes.
const FEW: u32 = 5;

fn main() -> Result<(), Box<dyn Error>> {
    bounds()?;
    for entry in ALGORITHMS.iter().filter(|entry| entry.columns.is_some()) {
        with_algorithm(entry.protection.id, Levels);
    }
    monitor()?;
    flight()
}

/// The counter begins anew whenever this is entered; it must not vanish into its callers.
#[inline(never)]
fn mark() {
    black_box(());
}

fn counted(name: &str, calls: u32, mut call: impl FnMut(u32)) {
    println!("{name} {calls}");
    // Pages are touched and what is found out once about the processor is known.
    call(0);
    mark();
    for k in 1..=calls {
        call(k);
    }
    mark();
}

/// Every bound of one epoch at 1e-5, or at 0.05 where its source has no factor for the other.
fn bounds() -> Result<(), Box<dyn Error>> {
    let factor = Matrix3::new(6.0, 0.0, 0.0, 2.5, 9.0, 0.0, -1.0, 3.0, 14.0);
    let epoch = Epoch {
        time: Some(GpsTime::from_nanoseconds(1)),
        course: Some(Radians::new(0.4)),
        path_angle: Some(Radians::new(-0.05)),
        offset: Some(Displacement::from_vector(Vector3::new(-25.0, 6.0, -9.0))),
        covariance: Some(Covariance::claim_symmetric(factor * factor.transpose())),
        mean: None,
        rnp: Some(Metres::nautical_miles(0.3)),
    };
    for method in methods() {
        let mut risks = [Risk::new(1e-5)?, Risk::new(0.05)?].into_iter();
        if let Some(risk) = risks.find(|risk| (method.bound)(&epoch, *risk).is_ok()) {
            counted(method.id, MANY, |_| _ = black_box((method.bound)(black_box(&epoch), risk)));
        }
    }
    Ok(())
}

/// An algorithm's levels of nine satellites by its usual settings.
struct Levels;

impl Task for Levels {
    type Output = ();
    fn with<A: Algorithm>(self) {
        let sights = sky::SKY.map(|(az, el, sigma)| {
            let (az, el) = (f64::to_radians(az), f64::to_radians(el));
            let unit = Vector3::new(el.cos() * az.sin(), el.cos() * az.cos(), el.sin());
            let plain = Sight::plain(unit, Constellation::Gps, sigma * sigma);
            Sight { receiver_faulty_m2: 1.5 * sigma * sigma, p_sat: 1e-5, ..plain }
        });
        let mut algorithm = Box::new(A::new(&A::usual()));
        counted(A::PROTECTION.id, FEW, |_| _ = black_box(algorithm.levels(black_box(&sights)).is_ok()));
    }
}

/// The monitor through a caution and back.
fn monitor() -> Result<(), Box<dyn Error>> {
    let chain =
        Chain { sample_period_s: 1.0, sensor_latency_s: 0.0, filter_s: 0.0, computing_s: 0.0, display_s: 0.0, time_to_alert_s: 10.0 };
    let settings = Settings { chain, raise_delay_s: 3.0, clear_delay_s: 10.0, clear_ratio: 0.95, stale_after_s: 2.0 };
    let bound = |bound_m: f64| -> Result<AlertBound, Box<dyn Error>> {
        Ok(Alerting::of("tse-exact").map_err(|e| format!("{e:?}"))?.claim_evaluated(Metres::new(bound_m)))
    };
    let (inside, outside) = (bound(400.0)?, bound(600.0)?);
    let mut monitor = Monitor::new(settings)?;
    counted("rnp-monitor", MANY, |k| {
        let accuracy = if k % 40 < 10 { outside } else { inside };
        let time = GpsTime::from_nanoseconds(i64::from(k) * 1_000_000_000);
        black_box(monitor.step(&Observation { time, accuracy, integrity: inside, rnp: Metres::new(500.0), usable: true }));
    });
    Ok(())
}

/// Fifteen minutes at ten samples a second: sensors, filter with the one without satellites beside it, and what is decided of each position.
fn flight() -> Result<(), Box<dyn Error>> {
    let mut scenario: Scenario = serde_json::from_str(include_str!("../../simulate/tests/scenario.json"))?;
    let mut sensors: Sensors = serde_json::from_str(include_str!("../../simulate/tests/sensors.json"))?;
    sensors.rate_hz = 10;
    scenario.sensors = Some(sensors);
    scenario.faults.clear();
    scenario.filter = Some(serde_json::from_str(include_str!("../../simulate/tests/filter.json"))?);
    let sensing = Sensing::new(scenario, None)?;
    let path = sensing.trajectory(5, 3)?;
    // Once: what is prepared within it is nothing beside the rest.
    counted("navigated-flight", 1, |k| _ = k > 0 && black_box(navigate(&sensing, &path, 5, 3).is_ok()));
    Ok(())
}
