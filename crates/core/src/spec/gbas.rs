//! Numbers of the GBAS error models, each with its mark. Nothing that was concluded rather than read is without one.
//!
//! Source: Song, Milner and No 2024, NAVIGATION 71(4), navi.673, with RTCA DO-245A and ICAO Annex 10 behind it. Our copy lost its
//! equations, tables and figures; what was recovered and how stands in `docs/methods/gbas.md`.

use crate::quantity::{Metres, Provenance, Radians};

/// How one number of a record is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mark {
    /// The number's name.
    pub name: &'static str,
    /// How we hold it.
    pub provenance: Provenance,
    /// Where from, or by which fit.
    pub why: &'static str,
}

const fn mark(name: &'static str, provenance: Provenance, why: &'static str) -> Mark {
    Mark { name, provenance, why }
}

/// `sqrt((a0 + a1 exp(-E / theta0))^2 / M + a2^2)`: one branch of a ground accuracy designator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundCurve {
    /// a0.
    pub a0: Metres,
    /// a1.
    pub a1: Metres,
    /// theta0.
    pub theta0: Radians,
    /// a2.
    pub a2: Metres,
}

/// `a + b exp(-E / theta)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirborneCurve {
    /// At high elevation.
    pub a: Metres,
    /// What low elevation adds.
    pub b: Metres,
    /// Scale.
    pub theta: Radians,
}

/// Residual ionosphere of single-frequency code.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ionosphere {
    /// Vertical gradient \[m/m\].
    pub gradient: f64,
    /// Distance from the ground station.
    pub distance: Metres,
    /// Speed that smoothing leaves behind \[m/s\].
    pub speed_mps: f64,
    /// Smoothing time constant \[s\].
    pub smoothing_s: f64,
}

/// The error model of one GBAS approach service type.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorModel {
    /// Name, as users choose it.
    pub id: &'static str,
    /// In words.
    pub title: &'static str,
    /// Ground multipath and noise below and above [`Self::split`].
    pub ground: [GroundCurve; 2],
    /// Where the branches meet.
    pub split: Radians,
    /// Reference receivers M.
    pub receivers: u8,
    /// What processing makes of the ground sigma.
    pub ground_factor: f64,
    /// Airborne multipath and noise.
    pub airborne: AirborneCurve,
    /// What processing makes of it.
    pub airborne_factor: f64,
    /// Refractivity uncertainty, times 1e-6 \[1\].
    pub refractivity: f64,
    /// Scale height of the troposphere.
    pub scale_height: Metres,
    /// Height of the aircraft above the ground station.
    pub height_difference: Metres,
    /// Elevation that troposphere and ionosphere are taken at for every satellite.
    pub atmosphere_elevation: Radians,
    /// Ionosphere, none for ionosphere-free code.
    pub ionosphere: Option<Ionosphere>,
    /// Shortest and longest time constant of smoothed multipath \[s\].
    pub multipath_s: [f64; 2],
    /// How its numbers are held.
    pub marks: &'static [Mark],
}

/// Errors of carrier phase differenced in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarrierModel {
    /// Noise of one phase.
    pub noise: Metres,
    /// Zenith gradient of the troposphere \[m/m\]; the aircraft moves by speed times time.
    pub troposphere_gradient: f64,
    /// Drift of satellite clock and orbit \[m/s\].
    pub clock_mps: f64,
    /// Vertical gradient of the ionosphere, none for dual-frequency phase \[m/m\].
    pub ionosphere_gradient: Option<f64>,
    /// How its numbers are held.
    pub marks: &'static [Mark],
}

const CURVE_C: [GroundCurve; 2] = [
    GroundCurve { a0: Metres::new(0.24), a1: Metres::new(0.0), theta0: Radians::degrees(15.5), a2: Metres::new(0.04) },
    GroundCurve { a0: Metres::new(0.15), a1: Metres::new(0.84), theta0: Radians::degrees(15.5), a2: Metres::new(0.04) },
];

const MODEL_MARKS: &[Mark] = &[
    mark("ground", Provenance::Standard, "Annex 10 table B-74; that designator C applies is inferred"),
    mark("designator", Provenance::Inferred, "accuracy designator C, four receivers"),
    mark("airborne", Provenance::Printed, "table 2; the printed exponent lost its minus sign"),
    mark("refractivity", Provenance::Ours, "20, 8000 m and 10 m could not be established; the effect is 2 mm"),
    mark("atmosphere_elevation", Provenance::Printed, "5 degrees"),
    mark("multipath", Provenance::Printed, "time constants 26 to 2315 s (30 s smoothing), 54 to 2894 s (100 s)"),
];
const SINGLE_MARKS: &[Mark] = &[
    mark("airborne_factor", Provenance::Inferred, "sqrt(100/30): white noise scaled from 100 to 30 s of smoothing; the symbol is lost"),
    mark("ionosphere", Provenance::Printed, "7 km and 0.042 km/s; the gradient is printed 0.004 mm/km and read 4 mm/km"),
    MODEL_MARKS[0],
    MODEL_MARKS[1],
    MODEL_MARKS[2],
    MODEL_MARKS[3],
    MODEL_MARKS[4],
    MODEL_MARKS[5],
];
const DUAL_MARKS: &[Mark] = &[
    mark("ground_factor", Provenance::Printed, "2.6; theory has 2.588"),
    MODEL_MARKS[0],
    MODEL_MARKS[1],
    MODEL_MARKS[2],
    MODEL_MARKS[3],
    MODEL_MARKS[4],
    MODEL_MARKS[5],
];

/// sqrt(100/30).
const WHITE_30_S: f64 = 1.825_741_858_350_553_8;

/// GAST D: single-frequency code smoothed over 30 s.
pub const GAST_D: ErrorModel = ErrorModel {
    id: "D",
    title: "GAST D, single-frequency code, 30 s smoothing",
    ground: CURVE_C,
    split: Radians::degrees(35.0),
    receivers: 4,
    ground_factor: WHITE_30_S,
    airborne: AirborneCurve { a: Metres::new(0.13), b: Metres::new(0.17), theta: Radians::degrees(13.0) },
    airborne_factor: WHITE_30_S,
    refractivity: 20.0,
    scale_height: Metres::new(8000.0),
    height_difference: Metres::new(10.0),
    atmosphere_elevation: Radians::degrees(5.0),
    ionosphere: Some(Ionosphere { gradient: 4e-6, distance: Metres::new(7000.0), speed_mps: 42.0, smoothing_s: 30.0 }),
    multipath_s: [26.0, 2315.0],
    marks: SINGLE_MARKS,
};

/// GAST F: ionosphere-free code smoothed over 100 s.
pub const GAST_F: ErrorModel = ErrorModel {
    id: "F",
    title: "GAST F, ionosphere-free code, 100 s smoothing",
    ground_factor: 2.6,
    airborne: AirborneCurve { a: Metres::new(0.34), b: Metres::new(0.40), theta: Radians::degrees(14.0) },
    airborne_factor: 1.0,
    ionosphere: None,
    multipath_s: [54.0, 2894.0],
    marks: DUAL_MARKS,
    ..GAST_D
};

/// Every error model.
pub const ERROR_MODELS: &[ErrorModel] = &[GAST_D, GAST_F];

/// Dual-frequency phase differenced in time.
pub const CARRIER_DUAL: CarrierModel = CarrierModel {
    noise: Metres::new(0.020),
    troposphere_gradient: 1e-6,
    clock_mps: 0.3e-3,
    ionosphere_gradient: None,
    marks: &[
        mark("noise", Provenance::Printed, "\"about 2 cm\", for all satellites"),
        mark("troposphere_gradient", Provenance::Inferred, "form and 1 mm/km after the words of the paper; Walter 2008 was not found"),
        mark("clock", Provenance::Inferred, "0.3 mm/s, fitted to claim C18: 0.85 mm/s breaks it at 600 s"),
    ],
};

/// Phase of GAST D: the ionosphere decorrelates while the aircraft moves.
pub const CARRIER_SINGLE: CarrierModel = CarrierModel {
    ionosphere_gradient: Some(4e-6),
    marks: &[
        CARRIER_DUAL.marks[0],
        CARRIER_DUAL.marks[1],
        CARRIER_DUAL.marks[2],
        mark("ionosphere_gradient", Provenance::Inferred, "4 mm/km while coasting, so that single frequency suffers as the text says"),
    ],
    ..CARRIER_DUAL
};

/// Ground monitor: missed detection against the size of a range error E.
///
/// `1` below `start`, `10^(slope E + offset)` to `end`, `floor` beyond; E is divided by `stretch` first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MonitorCurve {
    /// Name, as users choose it.
    pub id: &'static str,
    /// Errors below are never detected.
    pub start: Metres,
    /// From here on the floor counts.
    pub end: Metres,
    /// Decades a metre.
    pub slope_per_m: f64,
    /// Decades.
    pub offset: f64,
    /// Missed detection of the largest errors.
    pub floor: f64,
    /// How many times larger an error must be than under the standard's curve.
    pub stretch: f64,
    /// Position error for a metre of range error: the worst horizontal projection.
    pub projection: f64,
    /// How its numbers are held.
    pub marks: &'static [Mark],
}

/// GAST D.
pub const MONITOR_D: MonitorCurve = MonitorCurve {
    id: "D",
    start: Metres::new(0.75),
    end: Metres::new(2.7),
    slope_per_m: -2.56,
    offset: 1.92,
    floor: 1e-5,
    stretch: 1.0,
    projection: 2.0,
    marks: &[
        mark("curve", Provenance::Inferred, "ICAO Annex 10 appendix B, which was not read"),
        mark("projection", Provenance::Printed, "2"),
    ],
};

/// GAST F.
pub const MONITOR_F: MonitorCurve = MonitorCurve {
    id: "F",
    stretch: 2.2,
    projection: 0.7,
    marks: &[
        mark("curve", Provenance::Inferred, "the curve of GAST D at E / 2.2; 2.2 is fitted to claims C08 to C11"),
        mark("projection", Provenance::Printed, "0.7"),
    ],
    ..MONITOR_D
};

/// Every monitor curve.
pub const MONITOR_CURVES: &[MonitorCurve] = &[MONITOR_D, MONITOR_F];

/// An inertial system and the receiver's clock and Doppler beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertial {
    /// Gyro bias \[rad/s\].
    pub gyro_bias_radps: f64,
    /// Angular random walk \[rad/sqrt(s)\].
    pub gyro_walk_rad_per_root_s: f64,
    /// Accelerometer bias \[m/s²\].
    pub accelerometer_bias_mps2: f64,
    /// Velocity random walk \[m/s/sqrt(s)\].
    pub accelerometer_walk_mps_per_root_s: f64,
    /// Power of the clock's white frequency noise, h0 \[s\].
    pub clock_h0_s: f64,
    /// Power of the clock's frequency walk, h-2 \[1/s\].
    pub clock_h_minus_2_per_s: f64,
    /// Standard deviation of a range rate \[m/s\].
    pub doppler_mps: f64,
    /// White part of a smoothed pseudorange.
    pub receiver_noise: Metres,
    /// How its numbers are held.
    pub marks: &'static [Mark],
}

const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;

/// The inertial system of the study.
pub const INERTIAL: Inertial = Inertial {
    gyro_bias_radps: 0.035 / 3600.0 * core::f64::consts::PI / 180.0,
    gyro_walk_rad_per_root_s: 0.006 / 60.0 * core::f64::consts::PI / 180.0,
    accelerometer_bias_mps2: 0.035e-3 * STANDARD_GRAVITY_MPS2,
    accelerometer_walk_mps_per_root_s: 30e-6 * STANDARD_GRAVITY_MPS2,
    clock_h0_s: 2e-19,
    clock_h_minus_2_per_s: 2e-20,
    doppler_mps: 0.05,
    receiver_noise: Metres::new(0.05),
    marks: &[
        mark(
            "gyro",
            Provenance::Printed,
            "0.035 deg/h, 0.006 deg/sqrt(h); the scale factor errors do nothing to an aircraft that does not turn",
        ),
        mark("accelerometer_bias", Provenance::Printed, "0.035 mg"),
        mark("accelerometer_walk", Provenance::Ours, "30 ug/sqrt(Hz), could not be established"),
        mark("clock", Provenance::Standard, "temperature-compensated crystal of Brown and Hwang; only the name is printed"),
        mark("doppler", Provenance::Ours, "0.05 m/s, could not be established"),
        mark("receiver_noise", Provenance::Ours, "0.05 m, \"a small receiver term\""),
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_single_frequency_factor_is_the_root_it_says() {
        assert!((WHITE_30_S * WHITE_30_S - 100.0 / 30.0).abs() < 1e-15);
    }

    #[test]
    fn every_inferred_number_says_how_it_was_concluded() {
        let all = ERROR_MODELS.iter().flat_map(|m| m.marks).chain(MONITOR_CURVES.iter().flat_map(|m| m.marks)).chain(CARRIER_SINGLE.marks);
        let inferred = all.filter(|m| m.provenance == Provenance::Inferred);
        assert!(inferred.clone().count() >= 5);
        assert!(inferred.into_iter().all(|m| m.why.len() > 10));
    }
}
