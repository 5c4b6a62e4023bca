//! Tables one after the other, any number of them.

use super::epoch::{Columns, Epoch, Refused, Settings};
use super::runs::Stretch;
use super::select::Selector;
use super::tally::Tally;
use crate::parallel;
use navbound_core::quantity::OutOfDomain;

/// Epochs of one tally; a constant, so that sums do not depend on the number of threads.
const CHUNK: usize = 16_384;

/// What a run of epochs is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Not available.
    Loss,
    /// Available, with an error beyond its limit.
    Hazard,
    /// Available, with an error beyond its level.
    Misleading,
}

impl Kind {
    /// Every kind, by its index.
    pub const ALL: [Self; 3] = [Self::Loss, Self::Hazard, Self::Misleading];

    /// The word of tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Loss => "loss",
            Self::Hazard => "hazard",
            Self::Misleading => "mi",
        }
    }
}

/// A run that is over, or that the data end in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Index of the level.
    pub level: usize,
    /// What.
    pub kind: Kind,
    /// From when to when.
    pub run: Stretch,
    /// The data end first.
    pub open: bool,
}

/// Runs of one level and kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Totals {
    /// Runs.
    pub n: u64,
    /// Those longer than the time to alert.
    pub n_over_tta: u64,
    /// Epochs of the longest.
    pub longest: u64,
}

/// Everything a finished campaign amounts to, apart from percentiles.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Events that had not been handed out, in no particular order.
    pub events: Vec<Event>,
    /// A row of kinds for each level.
    pub totals: Vec<[Totals; 3]>,
}

/// A campaign under way.
#[derive(Debug, Clone)]
pub struct Campaign {
    settings: Settings,
    tally: Tally,
    totals: Vec<[Totals; 3]>,
    n_repeated: u64,
}

impl Campaign {
    /// Nothing yet.
    ///
    /// # Errors
    /// As [`Settings::checked`].
    pub fn new(settings: Settings) -> Result<Self, OutOfDomain> {
        let settings = settings.checked()?;
        let (tally, totals) = (Tally::new(&settings), vec![[Totals::default(); 3]; settings.demands.len()]);
        Ok(Self { settings, tally, totals, n_repeated: 0 })
    }

    /// How it is evaluated.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What has been added so far.
    pub const fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Rows of an instant that already had one.
    pub const fn n_repeated(&self) -> u64 {
        self.n_repeated
    }

    /// The next table, later than those before; the events that are over with it.
    ///
    /// # Errors
    /// As [`Columns::epochs`].
    pub fn add(&mut self, columns: &Columns<'_>) -> Result<Vec<Event>, Refused> {
        let (epochs, repeated) = columns.epochs(&self.settings.grid, self.tally.span.map(|(_, last)| last))?;
        self.n_repeated += repeated;
        let settings = &self.settings;
        let parts: Vec<Tally> = parallel::parts(epochs.len(), CHUNK, |part| tally_of(&epochs[part], settings));
        for part in parts {
            self.tally.append(part, settings);
        }
        let mut events = Vec::new();
        for (level, tally) in self.tally.levels.iter_mut().enumerate() {
            for (runs, kind) in tally.runs.iter_mut().zip(Kind::ALL) {
                events.extend(runs.drain().into_iter().map(|run| Event { level, kind, run, open: false }));
            }
        }
        count(&mut self.totals, &events, &self.settings);
        Ok(events)
    }

    /// What is left at the end of the data; the campaign may go on.
    pub fn outcome(&self) -> Outcome {
        let (mut events, mut totals) = (Vec::new(), self.totals.clone());
        for (level, tally) in self.tally.levels.iter().enumerate() {
            for (runs, kind) in tally.runs.iter().zip(Kind::ALL) {
                events.extend(runs.clone().finish().into_iter().map(|(run, open)| Event { level, kind, run, open }));
            }
        }
        count(&mut totals, &events, &self.settings);
        Outcome { events, totals }
    }

    /// A selection of the percentiles of everything added so far.
    pub fn selector(&self) -> Selector {
        Selector::new(&self.tally, &self.settings)
    }
}

fn tally_of(epochs: &[Epoch], settings: &Settings) -> Tally {
    let mut tally = Tally::new(settings);
    epochs.iter().for_each(|epoch| tally.add(epoch, settings));
    tally
}

fn count(totals: &mut [[Totals; 3]], events: &[Event], settings: &Settings) {
    for event in events {
        let total = &mut totals[event.level][event.kind as usize];
        total.n += 1;
        total.n_over_tta += u64::from(settings.grid.seconds(event.run.n) > settings.demands[event.level].tta_s);
        total.longest = total.longest.max(event.run.n);
    }
}
