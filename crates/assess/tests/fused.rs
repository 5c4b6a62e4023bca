//! Flights on a filter: what is carried over from the first path to the second, and what a unit in trouble does.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, its helpers too.

use navbound_assess::flights::COLUMNS;
use navbound_assess::fused::{Fused, navigate};
use navbound_simulate::{Scenario, Sensing, Sensors, Trajectory};

/// Fifteen minutes at ten samples a second.
fn sensing(change: impl FnOnce(&mut Sensors)) -> Sensing {
    let mut scenario: Scenario = serde_json::from_str(include_str!("../../simulate/tests/scenario.json")).unwrap();
    let mut sensors: Sensors = serde_json::from_str(include_str!("../../simulate/tests/sensors.json")).unwrap();
    sensors.rate_hz = 10;
    change(&mut sensors);
    scenario.sensors = Some(sensors);
    scenario.faults.clear();
    scenario.filter = Some(serde_json::from_str(include_str!("../../simulate/tests/filter.json")).unwrap());
    Sensing::new(scenario, None).unwrap()
}

/// The error that is carried over to the second path is the one that the sensors have along it. What differs: the specific force and the
/// turns that scale factors multiply, and the geometry, by some tens of metres in twenty thousand kilometres. A tenth of the claimed
/// deviation would not be noticed in any figure; most of the time it is a hundredth.
#[test]
fn the_error_is_that_of_the_second_path() {
    let sensing = sensing(|_| {});
    let flown = Fused::fly(&sensing, 5, 3, 1).unwrap();
    let numbers = |name: &str| {
        let column = COLUMNS.iter().find(|c| c.0 == name).unwrap();
        flown.flights.column(column)
    };
    let second = Trajectory::flown(sensing.outlook(), flown.flights.first_flight()).unwrap();
    let (again, _) = navigate(&sensing, &second, 5, 3).unwrap();
    let mut squares = [0.0; 3];
    for axis in 0..3 {
        let error = numbers(["nse_e_m", "nse_n_m", "nse_u_m"][axis]);
        let variance = numbers(["cov_ee_m2", "cov_nn_m2", "cov_uu_m2"][axis]);
        assert_eq!(error.len(), again.len());
        for k in 0..error.len() {
            let off = (again[k].error_enu_m[axis] - error[k]).powi(2) / variance[k];
            assert!(off < 0.3 * 0.3, "axis {axis} at {k} s: {} {}", again[k].error_enu_m[axis], error[k]);
            squares[axis] += off / error.len() as f64;
        }
    }
    assert!(squares.iter().all(|s| *s < 0.1 * 0.1), "{squares:?}");
}

#[test]
fn a_scenario_without_a_filter_is_refused() {
    let mut scenario: Scenario = serde_json::from_str(include_str!("../../simulate/tests/scenario.json")).unwrap();
    scenario.sensors = Some(serde_json::from_str(include_str!("../../simulate/tests/sensors.json")).unwrap());
    let sensing = Sensing::new(scenario, None).unwrap();
    assert_eq!(Fused::fly(&sensing, 5, 0, 1).unwrap_err().argument, "filter");
}
