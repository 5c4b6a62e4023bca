//! What is drawn on one flight: steering, ranges, carrier phase, the monitors on the ground, clock and start of the filter.

use super::{STEPS, Taxi};
use crate::philox::{Sensor, Stream};
use crate::sensors::{Markov, ReceiverClock};

/// Draws of one flight; a number depends on seed, flight and place alone. Tables are row by row, a column a satellite.
#[derive(Debug, Clone, Copy)]
pub struct GroundFlight<'a> {
    scenario: &'a Taxi,
    seed: u64,
    number: u64,
}

impl<'a> GroundFlight<'a> {
    /// Of a scenario, by its number.
    pub fn new(scenario: &'a Taxi, seed: u64, number: u64) -> Self {
        Self { scenario, seed, number }
    }

    fn stream(&self, sensor: Sensor, unit: usize) -> Stream {
        Stream::of_unit(self.seed, self.number, sensor, unit as u64)
    }

    /// First-order Gauss-Markov numbers of unit variance, a row a step and a column a unit.
    fn slow(&self, sensor: Sensor, n: usize, width: usize, steps: f64) -> Vec<f64> {
        let mut units: Vec<Markov> = (0..width).map(|k| Markov::new(self.stream(sensor, k), 1.0, steps)).collect();
        let mut series = Vec::with_capacity(n * width);
        for _ in 0..n {
            series.extend(units.iter().map(Markov::now));
            units.iter_mut().for_each(Markov::step);
        }
        series
    }

    /// Flight technical error of unit variance, second by second.
    pub fn steering(&self, n: usize) -> Vec<f64> {
        self.slow(Sensor::Steering, n, 1, self.scenario.motion.steering_time_s)
    }

    /// Errors of smoothed, corrected ranges, second by second \[m\]: a slow part, a constant bias, and the faults.
    ///
    /// `sigma_m` has a row a second, `lead` of them before the threshold, and NaN for a range that is not used; `faulty` is the column of
    /// each fault.
    pub fn range_errors(&self, sigma_m: &[f64], width: usize, lead: usize, faulty: &[usize]) -> Vec<f64> {
        let navigation = &self.scenario.navigation;
        let slow = self.slow(Sensor::SmoothedCode, sigma_m.len() / width, width, navigation.code_time_s);
        let most = navigation.bias_m;
        let bias: Vec<f64> = (0..width).map(|k| most * (2.0 * self.stream(Sensor::RangeBias, k).uniform() - 1.0)).collect();
        let mut errors: Vec<f64> = (0..sigma_m.len()).map(|i| sigma_m[i] * slow[i] + bias[i % width]).collect();
        for (fault, column) in self.scenario.faults.iter().zip(faulty) {
            for (second, row) in errors.chunks_exact_mut(width).skip(lead).enumerate() {
                row[*column] += fault.error_m(second as f64);
            }
        }
        errors
    }

    /// Errors of carrier phase since the last fix, [`STEPS`] instants a second: the fix itself and every instant after \[m\]; and the
    /// deviations of the rates that they make from instant to instant \[m/s\].
    ///
    /// ```text
    /// sigma^2 = 2 noise^2 + drift^2        two slow noises, at the fix and now, and one drift a satellite
    /// ```
    ///
    /// `sigma_m` has a row an instant, NaN for a satellite that is not followed; `at_fix` says with which the fix at second `fix_s` was
    /// made.
    pub fn phase_errors(&self, sigma_m: &[f64], at_fix: &[bool], noise_m: f64, fix_s: usize, faulty: &[usize]) -> (Vec<f64>, Vec<f64>) {
        let (width, stays) = (at_fix.len(), STEPS as f64 * self.scenario.navigation.phase_time_s);
        let n = sigma_m.len() / width;
        let noise = self.slow(Sensor::CarrierPhase, n + 1, width, stays);
        let drift: Vec<f64> = (0..width).map(|k| self.stream(Sensor::CarrierDrift, k).normal()).collect();
        // Noise that stays for a while changes little from instant to instant.
        let fresh = noise_m * (2.0 * (1.0 - (-1.0 / stays).exp())).sqrt();
        let start = at_fix.iter().map(|&used| if used { 0.0 } else { f64::NAN });
        let mut errors: Vec<f64> = start.clone().collect();
        let mut before: Vec<f64> = start.collect();
        let mut rates = Vec::with_capacity(sigma_m.len());
        for (step, row) in sigma_m.chunks_exact(width).enumerate() {
            let wrong = self.since(fix_s, step + 1, width, faulty);
            for k in 0..width {
                // A satellite that is not followed has no number: the largest of NaN and zero would be zero.
                let grown = if row[k].is_nan() { f64::NAN } else { (row[k] * row[k] - 2.0 * noise_m * noise_m).max(0.0).sqrt() };
                errors.push(noise_m * (noise[(step + 1) * width + k] - noise[k]) + grown * drift[k] + wrong[k]);
                rates.push(STEPS as f64 * fresh.hypot(grown - before[k]));
                before[k] = grown;
            }
        }
        (errors, rates)
    }

    /// How much the faults have grown from the fix to an instant, straight between whole seconds \[m\].
    fn since(&self, fix_s: usize, step: usize, width: usize, faulty: &[usize]) -> Vec<f64> {
        let (second, part) = (fix_s + step / STEPS, (step % STEPS) as f64 / STEPS as f64);
        let mut wrong = vec![0.0; width];
        for (fault, column) in self.scenario.faults.iter().zip(faulty) {
            let (here, next) = (fault.error_m(second as f64), fault.error_m(second as f64 + 1.0));
            wrong[*column] += here + part * (next - here) - fault.error_m(fix_s as f64);
        }
        wrong
    }

    /// One uniform number a fault: it is seen once the probability to miss it falls below.
    pub fn monitor(&self) -> Vec<f64> {
        (0..self.scenario.faults.len()).map(|k| self.stream(Sensor::GroundMonitor, k).uniform()).collect()
    }

    /// Standard normal numbers of range rates, a row a second.
    pub fn doppler(&self, n: usize, width: usize) -> Vec<f64> {
        let mut streams: Vec<Stream> = (0..width).map(|k| self.stream(Sensor::DopplerNoise, k)).collect();
        (0..n * width).map(|i| streams[i % width].normal()).collect()
    }

    /// Offset \[m\] and drift \[m/s\] of the receiver's clock at every instant, from densities of offset \[m²/s\] and drift \[m²/s³\].
    pub fn clock(&self, n: usize, densities: [f64; 2]) -> Vec<[f64; 2]> {
        let mut clock = ReceiverClock::from([0.0; 2], self.stream(Sensor::ReceiverClock, 0), 1.0 / STEPS as f64, densities);
        (0..n)
            .map(|_| {
                let now = clock.now();
                clock.step();
                now
            })
            .collect()
    }

    /// How wrong the filter starts, in its standard deviations: position, velocity, attitude.
    pub fn start(&self) -> [f64; 9] {
        let mut stream = self.stream(Sensor::FilterStart, 0);
        [(); 9].map(|()| stream.normal())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taxi(phase_time_s: f64, faults: &str) -> Taxi {
        let text = format!(
            r#"{{"motion": {{"touchdown_along_m": 300.0, "touchdown_speed_mps": 60.0, "braking_mps2": 2.0,
                "acceleration_mps2": 0.5, "lateral_acceleration_mps2": 1.0, "steering_time_s": 8.0}},
                "navigation": {{"transition": "B", "bias_m": 0.25, "code_time_s": 100.0, "phase_time_s": {phase_time_s}}},
                "faults": [{faults}], "points": []}}"#
        );
        serde_json::from_str(&text).expect("a scenario")
    }

    const RAMP: &str = r#"{"kind": "range-ramp", "start_s": 2.0, "duration_s": 100.0, "rate_mps": 0.5}"#;

    fn mean(values: impl Iterator<Item = f64>) -> f64 {
        let (n, sum) = values.fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v));
        sum / n
    }

    #[test]
    fn steering_has_unit_variance_and_its_correlation_time() {
        let taxi = taxi(30.0, "");
        let x = GroundFlight::new(&taxi, 3, 0).steering(400_000);
        let keep = (-1.0_f64 / 8.0).exp();
        // A variance from n numbers of correlation r scatters by sqrt(2 (1 + r²) / (1 - r²) / n) = 0.0063; four times that.
        let variance = mean(x.iter().map(|v| v * v));
        assert!((variance - 1.0).abs() < 0.026, "{variance}");
        let next = mean(x.windows(2).map(|w| w[0] * w[1]));
        assert!((next - keep).abs() < 0.026, "{next}");
    }

    #[test]
    fn ranges_have_their_sigma_a_constant_bias_and_the_fault() {
        let taxi = taxi(30.0, RAMP);
        let (width, lead, n) = (2, 3, 8);
        let silent = vec![0.0; width * n];
        let mut biases = Vec::new();
        for number in 0..20_000 {
            let errors = GroundFlight::new(&taxi, 3, number).range_errors(&silent, width, lead, &[1]);
            biases.push(errors[0]);
            // The bias stays, and the second satellite's error grows by half a metre a second from two seconds behind the threshold.
            assert!((1..n).all(|k| errors[2 * k].to_bits() == errors[0].to_bits()));
            let grown: Vec<f64> = (0..n).map(|k| errors[2 * k + 1] - errors[1]).collect();
            assert!(grown.iter().zip([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 1.0]).all(|(g, w)| (g - w).abs() < 1e-12), "{grown:?}");
        }
        // Uniform in ±0.25 m: variance 0.25² / 3, whose scatter is 0.9 / sqrt(n) of it (kurtosis 1.8); four times that is 0.026.
        assert!(biases.iter().all(|b| b.abs() <= 0.25));
        assert!((mean(biases.iter().map(|b| b * b)) / (0.0625 / 3.0) - 1.0).abs() < 0.026);
        // A range that is not used has no error; sigma scales a number of unit variance: 0.04, scatter of 20 000 draws 1 %.
        let of = |number| GroundFlight::new(&taxi, 4, number).range_errors(&[0.2, f64::NAN], 2, 0, &[0]);
        assert!(of(0)[1].is_nan());
        let variance = mean((0..20_000).map(|number| of(number)[0].powi(2))) - 0.0625 / 3.0;
        assert!((variance / 0.04 - 1.0).abs() < 0.06, "{variance}");
    }

    #[test]
    fn phase_has_the_deviation_that_is_declared() {
        // Noise that is new at every instant: errors ten instants after the fix share nothing with it but the drift.
        let taxi = taxi(0.04, RAMP);
        let sigma = [[0.03, 0.05, f64::NAN]; 10].concat();
        let at = |number| GroundFlight::new(&taxi, 3, number).phase_errors(&sigma, &[true, true, false], 0.02, 4, &[1]);
        let rows: Vec<Vec<f64>> = (0..20_000).map(|number| at(number).0).collect();
        // 2 sigma_phi² + drift² = sigma²; 4 standard errors of a variance of 20 000 draws are 4 %.
        let variance = |row: usize, k: usize, wrong: f64| mean(rows.iter().map(|r| (r[3 * row + k] - wrong).powi(2)));
        assert!((variance(10, 0, 0.0) / 0.0009 - 1.0).abs() < 0.04);
        // Two seconds of half a metre each are added to the second satellite, straight between whole seconds.
        assert!((variance(10, 1, 1.0) / 0.0025 - 1.0).abs() < 0.04);
        assert!((variance(3, 1, 0.3) / 0.0025 - 1.0).abs() < 0.04);
        assert!(rows[0][..2] == [0.0, 0.0] && rows[0][2].is_nan() && rows[0][5].is_nan());
        // From instant to instant sqrt(2) sigma_phi, and at the first the drift besides, five times a second.
        let rates = at(0).1;
        let (first, later) = (5.0 * 0.03, 5.0 * 2.0_f64.sqrt() * 0.02);
        // exp(-1 / 0.2) = 0.7 % of the variance is kept.
        assert!((rates[0] / first - 1.0).abs() < 0.004 && (rates[3] / later - 1.0).abs() < 0.004, "{rates:?}");
    }

    #[test]
    fn satellites_and_flights_do_not_disturb_one_another() {
        let taxi = taxi(30.0, RAMP);
        let ranges = |number, width: usize| GroundFlight::new(&taxi, 3, number).range_errors(&vec![1.0; 4 * width], width, 0, &[0]);
        let (narrow, wide) = (ranges(0, 2), ranges(0, 5));
        for row in 0..4 {
            assert_eq!(narrow[2 * row..2 * row + 2], wide[5 * row..5 * row + 2]);
        }
        assert_ne!(narrow, ranges(1, 2));
        let flight = GroundFlight::new(&taxi, 3, 0);
        let mut first: Vec<f64> = flight.start().to_vec();
        first.extend(flight.monitor());
        first.extend([flight.steering(1)[0], flight.doppler(1, 1)[0], narrow[0], narrow[1]]);
        for i in 0..first.len() {
            assert!(first[..i].iter().all(|other| (first[i] - other).abs() > 1e-12));
        }
    }

    #[test]
    fn the_clock_moves_as_its_densities_say() {
        let taxi = taxi(30.0, "");
        let (frequency, walk, n) = (0.01, 0.04, 51);
        let ends: Vec<[f64; 2]> = (0..20_000).map(|k| GroundFlight::new(&taxi, 3, k).clock(n, [frequency, walk])[n - 1]).collect();
        // After 10 s: Sb t + Sd t³ / 3 and Sd t; 4 standard errors of a variance of 20 000 draws are 4 %.
        assert!((mean(ends.iter().map(|e| e[0] * e[0])) / (0.1 + 40.0 / 3.0) - 1.0).abs() < 0.04);
        assert!((mean(ends.iter().map(|e| e[1] * e[1])) / 0.4 - 1.0).abs() < 0.04);
    }
}
