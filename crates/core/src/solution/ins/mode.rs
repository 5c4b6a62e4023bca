//! What aids the inertial navigator now, with patience in both directions.

use super::settings::Patience;
use crate::quantity::GpsTime;

/// What keeps the position: the best of what is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mode {
    /// A hole in the inertial samples has passed and the attitude is not yet as good as it will be.
    Aligning,
    /// Nothing: the covariance grows as the inertial errors do.
    Coasting,
    /// A bearing and a range.
    VorDme,
    /// Two ranges.
    DmeDme,
    /// Satellites, or a solved position.
    Gnss,
}

impl Mode {
    const AIDED: [Self; 3] = [Self::VorDme, Self::DmeDme, Self::Gnss];
    /// The word of tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Aligning => "aligning",
            Self::Coasting => "coasting",
            Self::VorDme => "vor_dme",
            Self::DmeDme => "dme_dme",
            Self::Gnss => "gnss",
        }
    }
}

/// Least number of satellites that keep a position and a clock.
const SATELLITES: usize = 4;
/// Sources remembered for a mode; more add nothing to the question.
const SOURCES: usize = 8;
/// Time for which a measurement counts as being there \[s\]; a second and a half lets one 1 Hz measurement go missing by jitter only.
const PRESENT_S: f64 = 1.5;

/// The last measurements that were used, by source.
#[derive(Debug, Clone, Copy)]
struct Recent {
    seen: [Option<(u64, GpsTime)>; SOURCES],
}

impl Recent {
    const fn new() -> Self {
        Self { seen: [None; SOURCES] }
    }
    fn saw(&mut self, source: u64, time: GpsTime) {
        let same = self.seen.iter().position(|s| s.is_some_and(|(id, _)| id == source));
        let oldest = || (0..SOURCES).min_by_key(|k| self.seen[*k].map(|(_, t)| t)).unwrap_or(0);
        let place = same.unwrap_or_else(oldest);
        self.seen[place] = Some((source, time));
    }
    fn count(&self, now: GpsTime) -> usize {
        self.seen.iter().flatten().filter(|(_, t)| now.seconds_since(*t) <= PRESENT_S).count()
    }
}

/// Which of the aids were used lately.
#[derive(Debug, Clone, Copy)]
pub(super) struct Modes {
    patience: Patience,
    satellites: Recent,
    dme: Recent,
    vor: Recent,
    fix: Recent,
    mode: Mode,
    /// Since when each aided mode has been possible without a break, and when it last was.
    since: [Option<GpsTime>; 3],
    last: [Option<GpsTime>; 3],
}

impl Modes {
    pub(super) fn new(patience: Patience) -> Self {
        let none = Recent::new();
        let (since, last) = ([None; 3], [None; 3]);
        Self { patience, satellites: none, dme: none, vor: none, fix: none, mode: Mode::Coasting, since, last }
    }

    pub(super) const fn mode(&self) -> Mode {
        self.mode
    }

    pub(super) fn satellite(&mut self, source: u64, time: GpsTime) {
        self.satellites.saw(source, time);
    }
    pub(super) fn dme(&mut self, station: u16, time: GpsTime) {
        self.dme.saw(station.into(), time);
    }
    pub(super) fn vor(&mut self, station: u16, time: GpsTime) {
        self.vor.saw(station.into(), time);
    }
    pub(super) fn fix(&mut self, time: GpsTime) {
        self.fix.saw(0, time);
    }

    /// Time passes: an aided mode is left `lose_s` after it was last possible, and entered when it has been possible for `gain_s`; the
    /// first mode of all is entered at once.
    pub(super) fn tick(&mut self, now: GpsTime) {
        let dme = self.dme.count(now);
        let possible =
            [dme >= 1 && self.vor.count(now) >= 1, dme >= 2, self.fix.count(now) >= 1 || self.satellites.count(now) >= SATELLITES];
        let first = self.last.iter().all(Option::is_none);
        for k in 0..3 {
            if possible[k] {
                self.since[k].get_or_insert(now);
                self.last[k] = Some(now);
            } else {
                self.since[k] = None;
            }
        }
        let available = |k: usize| self.last[k].is_some_and(|t| now.seconds_since(t) <= self.patience.lose_s);
        let ripe = |k: usize| first || self.since[k].is_some_and(|t| now.seconds_since(t) >= self.patience.gain_s);
        let keep = |k: usize| Mode::AIDED[k] <= self.mode && available(k);
        let best = (0..3).rev().find(|&k| keep(k) || (possible[k] && ripe(k)));
        self.mode = best.map_or(Mode::Coasting, |k| Mode::AIDED[k]);
    }
}
