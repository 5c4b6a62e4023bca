//! Settings outside their domain are refused by name.

use super::common::scenario;
use navbound_simulate::{Outlook, Refused, Scenario, Sensing, SensorFault, Sensors};

type Change = fn(&mut Sensors);

fn refused(scenario: Scenario) -> &'static str {
    match Sensing::new(scenario, None) {
        Err(Refused::Value(e)) => e.argument,
        Err(Refused::Item(at)) => at.error.argument,
        Ok(_) => "accepted",
    }
}

#[test]
fn what_no_sensor_can_be_is_refused_by_name() {
    let changes: [(&str, Change); 23] = [
        ("rate_hz", |s| s.rate_hz = 0),
        ("rate_hz", |s| s.rate_hz = 90),
        ("rate_hz", |s| s.rate_hz = 500),
        ("gyro_bias_radps", |s| s.imu.gyro_bias_radps = f64::NAN),
        ("accelerometer_scale", |s| s.imu.accelerometer_scale = 1.0),
        ("in_run_time_s", |s| s.imu.in_run_time_s = 0.0),
        ("constellations", |s| s.gnss.as_mut().unwrap().constellations.clear()),
        ("mask_rad", |s| s.gnss.as_mut().unwrap().mask_rad = -0.1),
        ("interval_s", |s| s.gnss.as_mut().unwrap().interval_s = 0.0123),
        ("interval_s", |s| s.baro.as_mut().unwrap().interval_s = 0.0),
        ("interval_s", |s| s.dme.as_mut().unwrap().interval_s = f64::NAN),
        ("seed_sigma_m", |s| s.gnss.as_mut().unwrap().seed_sigma_m = 0.0),
        ("ranging_time_s", |s| s.gnss.as_mut().unwrap().parts.ranging_time_s = 0.0),
        ("range_least_m", |s| s.vor.as_mut().unwrap().coverage.range_least_m = 1e6),
        ("noise_sigma_m", |s| s.baro.as_mut().unwrap().noise_sigma_m = -1.0),
        ("height_m", |s| s.stations[0].height_m = f64::INFINITY),
        ("duration_s", |s| s.faults = vec![SensorFault::Interference { start_s: 1.0, duration_s: 0.0 }]),
        ("start_s", |s| s.faults = vec![SensorFault::Interference { start_s: f64::NAN, duration_s: 1.0 }]),
        ("satellite", |s| {
            s.faults = vec![SensorFault::SatelliteStep { start_s: 1.0, duration_s: 1.0, satellite: "Ä5".into(), step_m: 1.0 }];
        }),
        ("satellite", |s| {
            // GPS has 24 nominal slots.
            s.faults = vec![SensorFault::SatelliteStep { start_s: 1.0, duration_s: 1.0, satellite: "G25".into(), step_m: 1.0 }];
        }),
        ("station", |s| {
            // The third station offers no ranges.
            s.faults = vec![SensorFault::DmeBias { start_s: 1.0, duration_s: 1.0, station: "R".into(), bias_m: 1.0 }];
        }),
        ("gyro_radps", |s| {
            s.faults = vec![SensorFault::ImuBiasJump { start_s: 1.0, gyro_radps: [0.0, 2.0, 0.0], accelerometer_mps2: [0.0; 3] }];
        }),
        ("up_mps", |s| {
            s.faults = vec![SensorFault::Spoofing { start_s: 1.0, duration_s: 1.0, right_mps: 0.0, up_mps: f64::NAN, rates: true }];
        }),
    ];
    for (argument, change) in changes {
        let mut scenario = scenario();
        change(scenario.sensors.as_mut().unwrap());
        assert_eq!(refused(scenario), argument);
    }
}

#[test]
fn sensors_must_be_there_and_records_must_cover_the_flight() {
    let mut bare = scenario();
    bare.sensors = None;
    assert_eq!(refused(bare), "sensors");
    let Err(Refused::Value(e)) = Sensing::new(scenario(), Some(&[])) else { unreachable!("no records describe no satellites") };
    assert_eq!(e.argument, "navigation");
}

#[test]
fn a_station_off_the_earth_is_refused() {
    let mut scenario = scenario();
    scenario.sensors.as_mut().unwrap().stations[0].lat_rad = 2.0;
    let sensing = Sensing::new(scenario, None).unwrap();
    let trajectory = sensing.trajectory(1, 0).unwrap();
    assert!(sensing.flight(&trajectory, 1, 0).is_err_and(|e| e.argument == "lat_rad"));
}

#[test]
fn times_that_are_none_are_refused() {
    let sensing = Sensing::new(scenario(), None).unwrap();
    let trajectory = sensing.trajectory(1, 0).unwrap();
    assert!(trajectory.cursor().at(f64::NAN).is_err());
}

#[test]
fn sensors_change_nothing_of_a_flight_without_them() {
    let mut bare = scenario();
    bare.sensors = None;
    let fly = |s: Scenario| navbound_simulate::fly(&Outlook::new(s).unwrap(), 3, 0).unwrap();
    assert_eq!(fly(bare), fly(scenario()));
}
