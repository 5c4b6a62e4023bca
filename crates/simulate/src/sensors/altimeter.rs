//! The barometric altimeter.
//!
//! ```text
//! said = lag(h) + bias + share dT (lag(h) - h_departure) + noise       lag' = (h - lag) / tau
//! ```
//!
//! The temperature error is that of air warmer or colder than the standard atmosphere's, one number a flight: the setting is right at the
//! departure, and the error grows with the height above it. What is said of the slow part includes it.

use super::faults::SensorFault;
use super::markov::{Markov, correlated_error};
use super::settings::Baro;
use crate::philox::{Sensor, Stream};
use navbound_core::quantity::{GpsTime, Metres};
use navbound_core::signal::{Aiding, BaroHeight, TimedAiding};

/// An altimeter under way.
pub(crate) struct Altimeter<'a> {
    settings: &'a Baro,
    blockages: Vec<&'a SensorFault>,
    freezes: Vec<&'a SensorFault>,
    last: Option<BaroHeight>,
    departure_m: f64,
    temperature_k: f64,
    bias: Markov,
    noise: Stream,
    /// Height that has come through the lag \[m\].
    lagged_m: f64,
    /// Share of the way to the true height that a sample covers.
    follow: f64,
}

impl<'a> Altimeter<'a> {
    /// `departure_m` is the height at the begin, `sample_s` the time between calls of [`Altimeter::follow`].
    pub(crate) fn new(settings: &'a Baro, faults: &'a [SensorFault], departure_m: f64, sample_s: f64, seed: u64, flight: u64) -> Self {
        let temperature_k = settings.temperature_sigma_k * Stream::new(seed, flight, Sensor::BaroConstants).normal();
        Self {
            settings,
            blockages: faults.iter().filter(|f| matches!(f, SensorFault::BaroBlockage { .. })).collect(),
            freezes: faults.iter().filter(|f| matches!(f, SensorFault::BaroFrozen { .. })).collect(),
            last: None,
            departure_m,
            temperature_k,
            bias: Markov::new(Stream::of_unit(seed, flight, Sensor::Baro, 1), settings.interval_s, settings.bias_time_s),
            noise: Stream::new(seed, flight, Sensor::Baro),
            lagged_m: departure_m,
            // exp(-inf) is 0: without a lag all of the way.
            follow: 1.0 - (-sample_s / settings.lag_s).exp(),
        }
    }

    /// One sample of the true height.
    pub(crate) fn follow(&mut self, time_s: f64, height_m: f64) {
        if self.blockages.iter().all(|b| b.since(time_s).is_none()) {
            self.lagged_m += self.follow * (height_m - self.lagged_m);
        }
    }

    pub(crate) fn measure(&mut self, time_s: f64, time: GpsTime, out: &mut Vec<TimedAiding>) {
        let s = self.settings;
        self.bias.step();
        let climbed = self.lagged_m - self.departure_m;
        let slow = s.bias_sigma_m * self.bias.now() + s.temperature_share * self.temperature_k * climbed;
        // At one height the air's error is a constant; where the height changes, so does the declared deviation.
        let (sigma, correlation_time_s) =
            correlated_error(s.temperature_share * s.temperature_sigma_k * climbed, s.bias_sigma_m, s.bias_time_s);
        let height = BaroHeight {
            height: Metres::new(self.lagged_m + slow + s.noise_sigma_m * self.noise.normal()),
            sigma_white: Metres::new(s.noise_sigma_m),
            sigma_bias: Metres::new(sigma),
            correlation_time_s,
        };
        let frozen = self.last.filter(|_| self.freezes.iter().any(|f| f.since(time_s).is_some()));
        let reported = frozen.unwrap_or(height);
        self.last = Some(reported);
        out.push(TimedAiding { time, aiding: Aiding::Baro(reported) });
    }
}
