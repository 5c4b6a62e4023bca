//! The optimal pair, and when to change it.

use super::{Admission, Pair, RangeModel, Sight};
use crate::quantity::{GpsTime, Metres, OutOfDomain, Radians};

/// What makes a pair better than another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Figure {
    /// Smallest distance root mean square.
    Drms,
    /// Smallest standard deviation across the active leg.
    Across(Radians),
}

impl Figure {
    /// The figure of a pair; `None` where it is not admissible.
    pub fn of(&self, pair: &Pair) -> Option<Metres> {
        let figure = match self {
            Self::Drms => pair.drms(),
            Self::Across(course) => pair.lateral_sigma(*course),
        };
        figure.filter(|_| pair.admissible)
    }
}

/// A pair by the places of its stations in the list, with its figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Best {
    /// Places of the stations in the list.
    pub stations: [usize; 2],
    /// What it determines.
    pub pair: Pair,
    /// Its figure.
    pub figure: Metres,
}

/// The admissible pair with the smallest figure, of all pairs; the first of equals. `None` when no pair is admissible: the least bad pair is
/// not an answer. Sights that are not usable are `None` in the list.
///
/// # Errors
/// As [`Pair::of`].
pub fn best_pair(
    sights: &[Option<Sight>],
    figure: Figure,
    range: &RangeModel,
    admission: &Admission,
    sigma_altitude: Metres,
) -> Result<Option<Best>, OutOfDomain> {
    let mut best: Option<Best> = None;
    for (i, a) in sights.iter().enumerate() {
        let Some(a) = a else { continue };
        for (j, b) in sights.iter().enumerate().skip(i + 1) {
            let Some(b) = b else { continue };
            let pair = Pair::of([a, b], range, admission, sigma_altitude)?;
            let Some(merit) = figure.of(&pair) else { continue };
            if best.is_none_or(|known| merit < known.figure) {
                best = Some(Best { stations: [i, j], pair, figure: merit });
            }
        }
    }
    Ok(best)
}

/// When a better pair replaces the one in use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Switching {
    /// Share by which another pair must be better.
    pub share: f64,
    /// For how long without interruption \[s\].
    pub hold_s: f64,
}

impl Switching {
    /// 5 % for 10 s. Ours.
    pub const USUAL: Self = Self { share: 0.05, hold_s: 10.0 };
}

/// The pair in use along a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Selector {
    switching: Switching,
    current: Option<[usize; 2]>,
    better_since: Option<GpsTime>,
}

impl Selector {
    /// Nothing selected yet.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the share is in \[0, 1) and the time is not negative.
    pub fn new(switching: Switching) -> Result<Self, OutOfDomain> {
        if !(switching.share >= 0.0 && switching.share < 1.0) {
            return Err(OutOfDomain { argument: "switching_share", value: switching.share, unit: "1", domain: "[0, 1)" });
        }
        if !(switching.hold_s >= 0.0 && switching.hold_s.is_finite()) {
            return Err(OutOfDomain { argument: "switching_hold_s", value: switching.hold_s, unit: "s", domain: "[0, inf)" });
        }
        Ok(Self { switching, current: None, better_since: None })
    }

    /// The pair in use at an instant. `best` is the optimal one of all pairs now, `look` works out any pair now (`None`: not admissible).
    ///
    /// A pair that is no longer admissible is left at once; a better one waits until it has been better by the share for the time. When the
    /// clock is set back the wait begins anew.
    pub fn step(&mut self, time: GpsTime, best: Option<Best>, look: impl Fn([usize; 2]) -> Option<Best>) -> Option<Best> {
        let current = self.current.and_then(look);
        let (Some(best), Some(current)) = (best, current) else {
            self.better_since = None;
            self.current = best.map(|b| b.stations);
            return best;
        };
        if !(best.figure.m() < (1.0 - self.switching.share) * current.figure.m()) {
            self.better_since = None;
            return Some(current);
        }
        let since = self.better_since.filter(|since| *since <= time).unwrap_or(time);
        if time.seconds_since(since) < self.switching.hold_s {
            self.better_since = Some(since);
            return Some(current);
        }
        self.better_since = None;
        self.current = Some(best.stations);
        Some(best)
    }
}
