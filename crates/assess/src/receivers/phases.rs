//! Code less phase of every satellite of a recording, as its positions use the code.

use super::ranges::{Source, combination};
use super::signals::{Measured, Plan};
use crate::smoothing::{lost, own_phases};
use nalgebra::Vector3;
use navbound_core::signal::{Carrier, Constellation};
use navbound_core::solution::led_off::{CodesAgainstPhases, Compared};
use navbound_formats::rinex::Observations;

const SYSTEMS: usize = Constellation::ALL.len();

/// Columns of the phases of each code's own carrier, by preference.
type Phases = Vec<Vec<usize>>;

/// The codes of a recording against their phases, epoch after epoch.
pub(crate) struct Compare<'a> {
    observations: &'a Observations,
    plans: &'a [Option<Plan>; SYSTEMS],
    phases: [Phases; SYSTEMS],
    codes: CodesAgainstPhases,
}

impl<'a> Compare<'a> {
    pub(crate) fn new(source: &Source<'a>) -> Self {
        let (observations, plans) = (source.observations, source.plans);
        let phases = std::array::from_fn(|system| {
            let codes = 0..if plans[system].is_some() { observations.codes[system].len() } else { 0 };
            codes.map(|code| own_phases(observations, system, code)).collect()
        });
        Self { observations, plans, phases, codes: CodesAgainstPhases::new(interval_s(observations)) }
    }

    /// Where the codes of the next epoch lead its position, by the satellites of it; none where there is no position. All epochs in the order
    /// of time.
    pub(crate) fn next(&mut self, epoch: usize, used: Option<&[Compared]>) -> Option<Vector3<f64>> {
        self.hear(epoch);
        self.codes.judge(self.observations.time[epoch], used?.iter().copied())
    }

    /// How many epochs were compared.
    pub(crate) const fn n_compared(&self) -> usize {
        self.codes.n_compared()
    }

    fn hear(&mut self, epoch: usize) {
        let (o, time) = (self.observations, self.observations.time[epoch]);
        for k in o.satellites(epoch) {
            let satellite = o.satellite[k];
            let system = satellite.constellation.index();
            let Some(plan) = &self.plans[system] else { continue };
            let values = o.values(k);
            let nothing = Measured { carrier: Carrier::L1, pseudorange: f64::NAN, column: 0 };
            let mut pair = [nothing; 2];
            let bands = plan.bands.len().min(2);
            pair.iter_mut().zip(&plan.bands).for_each(|(slot, band)| *slot = band.measured(values).unwrap_or(nothing));
            let (factors, _) = combination(&pair[..bands]);
            let code: f64 = factors.iter().zip(&pair[..bands]).map(|(f, m)| f * m.pseudorange).sum();
            let [first, second] = pair;
            let phase = self.phases[system].get(first.column).and_then(|p| p.iter().copied().find(|c| values[*c].is_finite()));
            let metres = phase.map_or(f64::NAN, |column| values[column] * first.carrier.wavelength_m());
            let slip = o.interrupted[epoch] || phase.is_some_and(|column| lost(o, o.value_range(k).start + column));
            // Other measurements are another arc.
            let track = [first.column, second.column, phase.unwrap_or(0)].iter().fold(0, |track, c| track << 10 | (*c as u32 & 0x3ff));
            self.codes.hear(time, satellite, code - metres, track, slip);
        }
    }
}

/// The median time between two epochs \[s\]; 0 of fewer than two.
fn interval_s(observations: &Observations) -> f64 {
    let mut steps_s: Vec<f64> = observations.time.windows(2).map(|pair| pair[1].seconds_since(pair[0])).collect();
    steps_s.sort_unstable_by(f64::total_cmp);
    steps_s.get(steps_s.len() / 2).copied().unwrap_or(0.0)
}
