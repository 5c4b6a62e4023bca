//! Code less phase of every satellite of a recording, as its positions use the code.

use super::ranges::{Source, combination};
use super::signals::{Measured, Plan};
use crate::smoothing::{lost, other_phases, own_phases};
use nalgebra::Vector3;
use navbound_core::quantity::Metres;
use navbound_core::signal::smoothing::divergence_free;
use navbound_core::signal::{Carrier, Constellation};
use navbound_core::solution::led_off::{CodesAgainstPhases, Compared, Comparisons, Heard};
use navbound_formats::rinex::Observations;

const SYSTEMS: usize = Constellation::ALL.len();

/// Columns of the phases of each code's own carrier, by preference, and those of other carriers.
type Phases = Vec<(Vec<usize>, Vec<(usize, Carrier)>)>;

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
            codes.map(|code| (own_phases(observations, system, code), other_phases(observations, system, code))).collect()
        });
        Self { observations, plans, phases, codes: CodesAgainstPhases::new(interval_s(observations)) }
    }

    /// Where the codes of the next epoch lead its position, by the satellites of it; none where there is no position. All epochs in the order
    /// of time.
    pub(crate) fn next(&mut self, epoch: usize, used: Option<&[Compared]>) -> Option<Vector3<f64>> {
        self.hear(epoch);
        self.codes.judge(self.observations.time[epoch], used?.iter().copied())
    }

    /// What was made of the epochs.
    pub(crate) const fn comparisons(&self) -> Comparisons {
        self.codes.comparisons()
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
            let there = |column: usize| values[column].is_finite();
            let metres = |column: usize, carrier: Carrier| Metres::new(values[column] * carrier.wavelength_m());
            let of_code = self.phases[system].get(first.column);
            let one = of_code.and_then(|(own, _)| own.iter().copied().find(|c| there(*c)));
            let other = of_code.and_then(|(_, others)| others.iter().copied().find(|(c, _)| there(*c)));
            let phase_m = one.map_or(f64::NAN, |column| {
                let own = (first.carrier, metres(column, first.carrier));
                let Some((second, carrier)) = other else { return own.1.m() };
                let as_code_m = divergence_free(own, (carrier, metres(second, carrier))).m();
                // The ionosphere is not in the codes of a pair: half way between the phase and one that runs as its code.
                if bands > 1 { 0.5 * (own.1.m() + as_code_m) } else { as_code_m }
            });
            let phases = one.into_iter().chain(other.map(|(column, _)| column));
            let slip = o.interrupted[epoch] || phases.clone().any(|column| lost(o, o.value_range(k).start + column));
            // Other measurements are another arc.
            let track =
                [first.column, second.column].into_iter().chain(phases).fold(0_u32, |track, c| track.rotate_left(8) ^ (c as u32 + 1));
            let heard = Heard { satellite, less_phase_m: code - phase_m, diverges: other.is_none(), track, lost: slip };
            self.codes.hear(time, &heard);
        }
    }
}

/// The median time between two epochs \[s\]; 0 of fewer than two.
fn interval_s(observations: &Observations) -> f64 {
    let mut steps_s: Vec<f64> = observations.time.windows(2).map(|pair| pair[1].seconds_since(pair[0])).collect();
    steps_s.sort_unstable_by(f64::total_cmp);
    steps_s.get(steps_s.len() / 2).copied().unwrap_or(0.0)
}
