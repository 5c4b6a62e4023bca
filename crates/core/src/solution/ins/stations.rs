//! Stations on the ground that contradict the filter: left out until they agree again.
//!
//! A gate for each measurement lets one in six of the ranges pass that are wrong by five deviations of their white part, and each drags the
//! position and the height along. A station is therefore judged as a whole: what one measurement hides in its noise shows in the sum of
//! several.

use super::covariance::FURTHER;
use super::slots::Further;
use crate::special::float::sqrt;

/// Share of the innovations' growth that is expected of chance: steps of more than twice it are looked for (ours).
const SLACK: f64 = 1.0;
/// Sum at which a station is left out. Of white innovations this comes, by Siegmund's approximation `exp(2 k (h + 1.166 k)) / 2 k²` with
/// slack k and limit h, once in 5e7 measurements a side (ours).
const LIMIT: f64 = 8.0;
/// Measurements on end over which a station that was left out must agree in the mean, and within how many deviations (ours).
const TRIAL: u32 = 30;
const TRIAL_DEVIATIONS: f64 = 2.0;

/// What is remembered of a station.
#[derive(Debug, Clone, Copy, Default)]
struct Record {
    /// Sums of the normalised innovations, upwards and downwards, less the slack.
    up: f64,
    down: f64,
    trial: Option<Trial>,
}

/// A station left out: the sum of its innovations.
#[derive(Debug, Clone, Copy, Default)]
struct Trial {
    n: u32,
    sum: f64,
}

/// A station's standing after a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// The measurement may be used.
    Good,
    /// It contradicts the filter from now on.
    LeftOut,
    /// It still does.
    Waiting,
}

/// A measurement as the filter sees it before its use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub(super) innovation: f64,
    /// Variance of its white part, and of what the states say.
    pub(super) white: f64,
    pub(super) states: f64,
}

/// The stations of a flight.
#[derive(Debug, Clone)]
pub(super) struct Stations {
    n: usize,
    record: [(Further, Record); FURTHER],
}

impl Stations {
    pub(super) const fn new() -> Self {
        Self { n: 0, record: [(Further::Clock, Record { up: 0.0, down: 0.0, trial: None }); FURTHER] }
    }

    /// Stations that are left out now.
    pub(super) fn left_out(&self) -> impl Iterator<Item = Further> + '_ {
        self.record[..self.n].iter().filter(|(_, r)| r.trial.is_some()).map(|(what, _)| *what)
    }

    /// Whether a station's measurement may be used, the squared gate being `gate`. With all places taken the station first come is
    /// forgotten.
    pub(super) fn judge(&mut self, what: Further, look: &Look, gate: f64) -> Standing {
        let known = self.record[..self.n].iter().position(|(w, _)| *w == what);
        let place = known.unwrap_or_else(|| {
            if self.n == FURTHER {
                self.record.rotate_left(1);
                self.n -= 1;
            }
            self.record[self.n] = (what, Record::default());
            self.n += 1;
            self.n - 1
        });
        self.record[place].1.judge(look, gate)
    }
}

impl Record {
    fn judge(&mut self, look: &Look, gate: f64) -> Standing {
        if let Some(trial) = &mut self.trial {
            trial.n += 1;
            trial.sum += look.innovation;
            if trial.n < TRIAL {
                return Standing::Waiting;
            }
            let n = f64::from(trial.n);
            // What the states do not know is the same in all of them; only the white part is averaged.
            let deviation = sqrt(look.white / n + look.states);
            let agrees = (trial.sum / n).abs() <= TRIAL_DEVIATIONS * deviation;
            self.trial = if agrees { None } else { Some(Trial::default()) };
            return if agrees { Standing::Good } else { Standing::Waiting };
        }
        let normalised = look.innovation / sqrt(look.white + look.states);
        self.up = (self.up + normalised - SLACK).max(0.0);
        self.down = (self.down - normalised - SLACK).max(0.0);
        if normalised * normalised <= gate && self.up <= LIMIT && self.down <= LIMIT {
            return Standing::Good;
        }
        *self = Self { up: 0.0, down: 0.0, trial: Some(Trial::default()) };
        Standing::LeftOut
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GATE: f64 = 15.0;

    fn look(innovation: f64) -> Look {
        Look { innovation, white: 100.0, states: 21.0 }
    }

    /// Eleven metres are one deviation of a measurement: 2.4 of them pass any gate, and six measurements on end do not.
    #[test]
    fn what_one_measurement_hides_shows_in_several() {
        let mut stations = Stations::new();
        let judged: Vec<_> = (0..7).map(|_| stations.judge(Further::Dme(3), &look(26.4), GATE)).collect();
        // 1.4 a measurement over the slack: the sixth brings 8.4.
        assert!(judged[..5].iter().all(|s| *s == Standing::Good), "{judged:?}");
        assert_eq!(judged[5..], [Standing::LeftOut, Standing::Waiting]);
        assert_eq!(stations.left_out().collect::<Vec<_>>(), [Further::Dme(3)]);
        // Another station, and one deviation for ever, are not touched.
        assert!((0..1000).all(|_| stations.judge(Further::Vor(3), &look(11.0), GATE) == Standing::Good));
    }

    #[test]
    fn a_gated_station_stays_out_until_it_agrees_in_the_mean() {
        let mut stations = Stations::new();
        assert_eq!(stations.judge(Further::Dme(1), &look(-60.0), GATE), Standing::LeftOut);
        // Twice the deviation of a mean of thirty is 9.9 m: 12 m do not agree, although one of them is nothing.
        let still = (0..90).map(|_| stations.judge(Further::Dme(1), &look(12.0), GATE));
        assert!(still.into_iter().all(|s| s == Standing::Waiting));
        let again: Vec<_> = (0..30).map(|_| stations.judge(Further::Dme(1), &look(5.0), GATE)).collect();
        assert!(again[..29].iter().all(|s| *s == Standing::Waiting));
        assert_eq!(again[29], Standing::Good);
        assert_eq!(stations.left_out().count(), 0);
    }

    #[test]
    fn what_is_no_number_is_left_out() {
        assert_eq!(Stations::new().judge(Further::Dme(1), &look(f64::NAN), GATE), Standing::LeftOut);
    }
}
