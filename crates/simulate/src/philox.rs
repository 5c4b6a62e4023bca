//! Counter-based random numbers: Philox4x64-10.
//!
//! Source: Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011; printed. A number is a function of seed,
//! stream and place in the stream, so results cannot depend on threads, on tiles, or on what else was drawn.

use navbound_core::special::one_sided_factor;

const MULTIPLIERS: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];
const WEYL: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];
const ROUNDS: usize = 10;

/// Four random words from a counter and a key.
pub(crate) fn block(mut counter: [u64; 4], mut key: [u64; 2]) -> [u64; 4] {
    for _ in 0..ROUNDS {
        let wide = [u128::from(MULTIPLIERS[0]) * u128::from(counter[0]), u128::from(MULTIPLIERS[1]) * u128::from(counter[2])];
        let (high, low) = (wide.map(|w| (w >> 64) as u64), wide.map(|w| w as u64));
        counter = [high[1] ^ counter[1] ^ key[0], low[1], high[0] ^ counter[3] ^ key[1], low[0]];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

/// What a stream of random numbers is for; each has its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sensor {
    Navigation,
    LateralGust,
    VerticalGust,
    /// Gyroscope triad: what is drawn once.
    GyroConstants,
    /// Gyroscope triad: in-run bias and noise.
    Gyro,
    /// Accelerometers, likewise.
    AccelerometerConstants,
    Accelerometer,
    ReceiverClock,
    /// Of a constellation.
    SystemBias,
    /// Of a satellite: white code noise, white Doppler noise, and the slow parts.
    CodeNoise,
    DopplerNoise,
    SignalInSpace,
    Ionosphere,
    Multipath,
    Troposphere,
    PhaseNoise,
    /// Of a station.
    DmeBias,
    DmeNoise,
    VorBias,
    VorNoise,
    BaroConstants,
    Baro,
    /// What the navigation filter starts with that is wrong.
    FilterStart,
    /// On the ground, of the aircraft: how it steers.
    Steering,
    /// Of a satellite: smoothed and corrected code, its constant part, carrier phase, and its drift since a fix.
    SmoothedCode,
    RangeBias,
    CarrierPhase,
    CarrierDrift,
    /// Of a fault: whether the ground monitors see it.
    GroundMonitor,
}

/// The number of the flight without errors: every normal number of its streams is zero, so that each sensor measures the truth and the
/// filter's covariance is what is expected before a flight.
pub const ERROR_FREE: u64 = u64::MAX;

/// A stream of random numbers for one sensor of one flight.
#[derive(Debug, Clone)]
pub(crate) struct Stream {
    key: [u64; 2],
    flight: u64,
    /// Which satellite, station or axis, where there are several.
    unit: u64,
    next: u64,
    words: [u64; 4],
}

impl Stream {
    pub(crate) fn new(seed: u64, flight: u64, sensor: Sensor) -> Self {
        Self::of_unit(seed, flight, sensor, 0)
    }

    /// The stream of one of several satellites, stations or axes.
    pub(crate) fn of_unit(seed: u64, flight: u64, sensor: Sensor, unit: u64) -> Self {
        Self { key: [seed, sensor as u64], flight, unit, next: 0, words: [0; 4] }
    }

    fn word(&mut self) -> u64 {
        let place = (self.next % 4) as usize;
        if place == 0 {
            self.words = block([self.next / 4, self.flight, self.unit, 0], self.key);
        }
        self.next += 1;
        self.words[place]
    }

    /// A standard normal number: the quantile of a uniform one, which needs one word whatever the value.
    pub(crate) fn normal(&mut self) -> f64 {
        if self.flight == ERROR_FREE {
            return 0.0;
        }
        one_sided_factor(self.uniform())
    }

    /// 53 bits and a half, so neither 0 nor 1.
    pub(crate) fn uniform(&mut self) -> f64 {
        ((self.word() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0
    }

    /// Two independent standard normal numbers by the method of Box and Muller (Ann. Math. Stat. 29, 1958): four times as fast as the
    /// quantile, for sensors that need millions.
    pub(crate) fn normal_pair(&mut self) -> [f64; 2] {
        if self.flight == ERROR_FREE {
            return [0.0; 2];
        }
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        let (s, c) = (core::f64::consts::TAU * self.uniform()).sin_cos();
        [radius * c, radius * s]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flight_without_errors_has_none_and_the_one_before_it_has() {
        let drawn = |flight| {
            let mut stream = Stream::of_unit(7, flight, Sensor::DmeBias, 3);
            [stream.normal(), stream.normal_pair()[0], stream.normal_pair()[1]]
        };
        assert_eq!(drawn(ERROR_FREE), [0.0; 3]);
        assert!(drawn(ERROR_FREE - 1).iter().all(|x| *x != 0.0));
    }

    #[test]
    fn the_published_answers_are_met() {
        // Random123, tests/kat_vectors, lines "philox4x64 10".
        let answers = [
            ([0; 4], [0; 2], [0x1655_4d9e_ca36_314c, 0xdb20_fe9d_672d_0fdc, 0xd7e7_72ce_e186_176b, 0x7e68_b68a_ec7b_a23b]),
            ([u64::MAX; 4], [u64::MAX; 2], [0x87b0_92c3_013f_e90b, 0x438c_3c67_be8d_0224, 0x9cc7_d7c6_9cd7_77b6, 0xa09c_aebf_594f_0ba0]),
            (
                [0x243f_6a88_85a3_08d3, 0x1319_8a2e_0370_7344, 0xa409_3822_299f_31d0, 0x082e_fa98_ec4e_6c89],
                [0x4528_21e6_38d0_1377, 0xbe54_66cf_34e9_0c6c],
                [0xa528_f454_03e6_1d95, 0x38c7_2dbd_566e_9788, 0xa5a1_610e_72fd_18b5, 0x57bd_43b5_e52b_7fe6],
            ),
        ];
        for (counter, key, expected) in answers {
            assert_eq!(block(counter, key), expected);
        }
    }

    #[test]
    fn normal_numbers_are_normal() {
        // 1e5 draws: mean within 4/sqrt(n), variance within 4 sqrt(2/n), and as many beyond 1.96 as belong there (4 standard errors).
        let mut stream = Stream::new(7, 3, Sensor::Navigation);
        let draws: Vec<f64> = (0..100_000).map(|_| stream.normal()).collect();
        let n = draws.len() as f64;
        let mean = draws.iter().sum::<f64>() / n;
        let variance = draws.iter().map(|x| x * x).sum::<f64>() / n - mean * mean;
        let beyond = draws.iter().filter(|x| x.abs() > 1.959_964).count() as f64 / n;
        assert!(mean.abs() < 0.0127, "{mean}");
        assert!((variance - 1.0).abs() < 0.0179, "{variance}");
        assert!((beyond - 0.05).abs() < 0.00276, "{beyond}");
    }

    #[test]
    fn pairs_are_normal_and_independent() {
        // As above; the products have variance 1, so their mean is within 4/sqrt(n) of zero.
        let mut stream = Stream::new(7, 3, Sensor::Gyro);
        let pairs: Vec<[f64; 2]> = (0..100_000).map(|_| stream.normal_pair()).collect();
        let mean = |f: fn(&[f64; 2]) -> f64| pairs.iter().map(f).sum::<f64>() / pairs.len() as f64;
        assert!(mean(|p| p[0]).abs() < 0.0127 && mean(|p| p[1]).abs() < 0.0127 && mean(|p| p[0] * p[1]).abs() < 0.0127);
        assert!((mean(|p| p[0] * p[0]) - 1.0).abs() < 0.0179 && (mean(|p| p[1] * p[1]) - 1.0).abs() < 0.0179);
        let beyond = mean(|p| f64::from(u8::from(p[0].abs() > 1.959_964)));
        assert!((beyond - 0.05).abs() < 0.00276, "{beyond}");
    }

    #[test]
    fn streams_of_other_seeds_flights_and_sensors_differ() {
        let first = |seed, flight, sensor| Stream::new(seed, flight, sensor).normal();
        let numbers = [
            first(1, 0, Sensor::Navigation),
            first(2, 0, Sensor::Navigation),
            first(1, 1, Sensor::Navigation),
            first(1, 0, Sensor::LateralGust),
            first(1, 0, Sensor::VerticalGust),
            Stream::of_unit(1, 0, Sensor::Navigation, 1).normal(),
        ];
        for i in 0..numbers.len() {
            for j in 0..i {
                assert!((numbers[i] - numbers[j]).abs() > 1e-12);
            }
        }
    }
}
