//! The forms behind one interface: one filter or several, and the one without satellites beside them.

use super::aid::{Aided, Wheels};
use super::entry::Refusal;
use super::federated::{master, shared};
use super::filter::{Advance, Filter, Samples, Solution, Stop};
use super::innovation::{Innovations, Kind};
use super::loose::Receiver;
use super::mode::Mode;
use super::settings::{ClockModel, Form, Settings, StartSigma};
use super::slots::Further;
use super::state::NavState;
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{GpsTime, OutOfDomain};
use crate::signal::{ImuIncrement, TimedAiding};

/// Inertial samples and measurements to one solution, in the form of its [`Settings`].
///
/// The filter beside the main one has stations, altimeter and inertial unit and never a satellite: the reversion filter of the tight and
/// the loose form, one of both of the federated.
#[derive(Debug, Clone)]
pub struct Fusion {
    pub(super) settings: Settings,
    pub(super) main: Filter,
    pub(super) beside: Option<Filter>,
    receiver: Receiver,
    /// Whether everything the filter beside knows is known to the main one too.
    pub(super) nested: bool,
}

/// The filter without satellites, and how far the one with them is from it.
#[derive(Debug, Clone, Copy)]
pub struct Beside {
    /// What it says.
    pub solution: Solution,
    /// The filter with satellites less the one without.
    pub difference: Displacement<Enu>,
    /// Covariance of that difference.
    pub covariance: Covariance<Enu>,
}

impl Fusion {
    /// Begin.
    ///
    /// # Errors
    /// As [`Filter::new`].
    pub fn new(start: NavState, sigma: &StartSigma, settings: Settings) -> Result<Self, OutOfDomain> {
        settings.check()?;
        let federated = settings.form == Form::Federated;
        let (wider, shared_settings) = if federated { shared(sigma, &settings) } else { (*sigma, settings) };
        let main = Filter::new(start, &wider, shared_settings)?;
        let beside = if federated || settings.reversion { Some(main.clone()) } else { None };
        Ok(Self { settings, main, beside, receiver: Receiver::new(), nested: !federated })
    }

    /// The filter with satellites begins anew, knowing as much as these deviations say; the one beside it goes on.
    pub(super) fn renew(&mut self, at: NavState, sigma: &StartSigma) -> Result<(), OutOfDomain> {
        let mut settings = self.settings;
        // The clock has wandered since the begin: its drift is as little known as that of any receiver.
        settings.clock.drift_mps = settings.clock.drift_mps.max(ClockModel::default().drift_mps);
        let anew = Self::new(at, sigma, settings)?;
        let entry = self.main.entry.uncounted();
        (self.main, self.receiver, self.nested) = (anew.main, anew.receiver, false);
        self.main.entry = entry;
        Ok(())
    }

    /// One inertial sample further; what became of it in the main filter.
    pub fn advance(&mut self, sample: &ImuIncrement) -> Advance {
        if let Some(beside) = &mut self.beside {
            beside.advance(sample);
        }
        let outcome = self.main.advance(sample);
        // Each finds its own attitude after a hole.
        self.nested &= !matches!(outcome, Advance::AfterGap { .. });
        outcome
    }

    /// Whether a measurement of this time is judged: not before the start, too old, or in a hole of the inertial samples.
    pub fn judges(&self, time: GpsTime) -> bool {
        self.main.stopped().is_none() && self.main.age_of(time).is_some()
    }

    /// Measurements of one kind and one time; how many of them are used in a filter.
    pub fn aid(&mut self, together: &[TimedAiding]) -> usize {
        let Some(first) = together.first() else { return 0 };
        let satellites = matches!(Kind::of(&first.aiding), Kind::Range | Kind::RangeRate | Kind::FixPosition);
        let mut used = 0;
        if let Some(beside) = self.beside.as_mut().filter(|_| !satellites) {
            used = aid(beside, together);
        }
        match self.settings.form {
            Form::Loose if Kind::of(&first.aiding) == Kind::Range => self.main.aid_loosely(&mut self.receiver, together),
            Form::Federated if !satellites => used,
            _ => aid(&mut self.main, together),
        }
    }

    /// As [`Filter::roll`], in every filter that may know of it without being counted twice.
    pub fn roll(&mut self, wheels: &Wheels) -> Aided {
        if let Some(beside) = self.beside.as_mut().filter(|_| self.settings.form != Form::Federated) {
            beside.roll(wheels);
        }
        self.main.roll(wheels)
    }

    /// Everything of this time: the main filter's, or what the master makes of both; `None` as for [`Filter::solution`].
    pub fn solution(&mut self, at: GpsTime) -> Option<Solution> {
        let main = self.main.solution(at)?;
        match &mut self.beside {
            Some(beside) if self.settings.form == Form::Federated && together(&self.main, beside) => {
                Some(master(&mut self.main, beside)).filter(Solution::is_sound)
            }
            _ => Some(main),
        }
    }

    /// The filter without satellites, if there is one, and both run and speak of this time.
    ///
    /// ```text
    /// V(difference) = V(without) - V(with)      the filter with satellites knows everything the other knows, and is optimal
    ///               = V(without) + V(with)      bound for errors without negative correlation: federated, or after a new start
    /// ```
    pub fn beside(&mut self, at: GpsTime) -> Option<Beside> {
        let without = self.beside.as_mut().filter(|b| together(&self.main, b))?;
        let (with, solution) = (self.main.solution(at)?, without.solution(at)?);
        let (a, b) = (with.state.position().ok()?, solution.state.position().ok()?);
        let difference = crate::frame::ecef_from_geodetic(&a).minus(&crate::frame::ecef_from_geodetic(&b)).to_enu(&b.point);
        let (v, w) = (with.covariance.matrix(), solution.covariance.matrix());
        let covariance = Covariance::claim_symmetric(if self.nested { w - v } else { w + v });
        Some(Beside { solution, difference, covariance })
    }

    /// Sums of the innovations of a kind, of the filter that has it.
    pub fn innovations(&self, kind: Kind) -> &Innovations {
        match &self.beside {
            Some(beside) if self.settings.form == Form::Federated && matches!(kind, Kind::Dme | Kind::Vor | Kind::Baro) => {
                beside.innovations(kind)
            }
            _ => self.main.innovations(kind),
        }
    }
    /// The largest innovation of a kind since this was last called, over its gate, of the filter that [`Fusion::innovations`] speaks of.
    pub fn take_largest(&mut self, kind: Kind) -> Option<f64> {
        match &mut self.beside {
            Some(beside) if self.settings.form == Form::Federated && matches!(kind, Kind::Dme | Kind::Vor | Kind::Baro) => {
                beside.innovations_mut(kind).take_largest()
            }
            _ => self.main.innovations_mut(kind).take_largest(),
        }
    }

    /// The further states and their values, of both filters in the federated form: lengths \[m\], rates \[m/s\], angles \[rad\], and
    /// numbers of variance 1 for what stays in a solved position.
    pub fn further(&self) -> impl Iterator<Item = (Further, f64)> + '_ {
        let second = self.beside.as_ref().filter(|_| self.settings.form == Form::Federated);
        self.main.further().chain(second.into_iter().flat_map(Filter::further))
    }

    /// Number of states, of every filter.
    pub fn n_states(&self) -> usize {
        self.main.n_states() + self.beside.as_ref().map_or(0, Filter::n_states)
    }

    /// What keeps the position of the main filter.
    pub fn mode(&self) -> Mode {
        self.main.modes.mode()
    }

    /// Position, velocity and attitude of the main filter.
    pub const fn state(&self) -> &NavState {
        self.main.state()
    }
    /// Counters of the inertial samples.
    pub const fn samples(&self) -> &Samples {
        self.main.samples()
    }
    /// Whether it speaks of the last sample: not in a hole before a measurement.
    pub fn is_current(&self) -> bool {
        self.main.is_current()
    }
    /// How often the receiver's clock has jumped and was set anew.
    pub const fn clock_jumps(&self) -> u32 {
        self.main.clock_jumps()
    }
    /// Stations that are left out now, of the filter that has them.
    pub fn stations_left_out(&self) -> impl Iterator<Item = Further> + '_ {
        let second = self.beside.as_ref().filter(|_| self.settings.form == Form::Federated);
        self.main.stations_left_out().chain(second.into_iter().flat_map(Filter::stations_left_out))
    }
    /// As [`Filter::fixes_are_late`], of the main filter.
    pub const fn fixes_are_late(&self) -> bool {
        self.main.fixes_are_late()
    }
    /// As [`Filter::fix_delay_s`], of the main filter.
    pub fn fix_delay_s(&self) -> Option<f64> {
        self.main.fix_delay_s()
    }
    /// Measurements that were not used before any gate, in the order of [`Refusal::ALL`]; of both filters in the federated form.
    pub fn refusals(&self) -> [u64; Refusal::ALL.len()] {
        let second = self.beside.as_ref().filter(|_| self.settings.form == Form::Federated).map(Filter::refusals);
        core::array::from_fn(|k| self.main.refusals()[k] + second.map_or(0, |counts| counts[k]))
    }
    /// Why it has stopped, if it has.
    pub const fn stopped(&self) -> Option<&Stop> {
        self.main.stopped()
    }
    /// Of when it speaks.
    pub fn time(&self) -> GpsTime {
        self.main.time()
    }
}

/// Whether both speak, and of the same instant: after a hole each waits for a measurement of its own.
fn together(main: &Filter, beside: &Filter) -> bool {
    main.is_current() && beside.is_current() && main.time() == beside.time()
}

fn aid(filter: &mut Filter, together: &[TimedAiding]) -> usize {
    together.iter().filter(|timed| matches!(filter.aid(timed), Aided::Used { .. })).count()
}
