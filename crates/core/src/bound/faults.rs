//! Fault modes: which satellites may be wrong together, how likely, and which of them must be monitored. The one front end of advanced RAIM and
//! of relative RAIM.
//!
//! ```text
//! events    every satellite with P_sat, every constellation with P_const; P(set) = P_0 prod p / (1 - p)
//! order     r_max = the least r with P(more than r events) <= P_unmonitored, at least 2, at most what the method allows
//! merge     sets of events that mean the same satellites are one mode; sets inside a constellation less likely than
//!           the consolidation share of its own fault count with it
//! keep      modes too likely to be left out; then, fewest satellites or likeliest first, until what is left is at most P_unmonitored
//! ```
//!
//! Specification: Blanch et al. 2015 and Working Group C's airborne algorithm description v3.0; the order of modes of equal size is that
//! of their events (standard, checked on 17 cases of MAAST for ARAIM 2).

use crate::quantity::{OutOfDomain, Reason};
use crate::signal::Constellation;

/// Most satellites of one solution.
pub const MOST_SATELLITES: usize = 64;
/// Most monitored fault modes, the fault-free one among them.
pub const MOST_MODES: usize = super::level_equation::MOST_TERMS;
/// Most sets of events that are looked at: two faults at a time of 64 satellites and five constellations are 2416.
const MOST_LISTED: usize = 4096;
const CLOCKS: usize = Constellation::ALL.len();
const MOST_EVENTS: usize = MOST_SATELLITES + CLOCKS;

/// What a fault mode takes away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaultMode {
    /// All satellites in fault, bit i for satellite i of the solution.
    pub satellites: u64,
    /// Constellations of which every satellite is in fault, bit c for index c.
    pub constellations: u8,
    /// Its probability.
    pub p: f64,
}

/// The monitored fault modes of one set of satellites, the fault-free one first.
#[derive(Debug, Clone)]
pub struct FaultModes {
    list: [FaultMode; MOST_MODES],
    count: usize,
    left: f64,
}

/// Why there are no fault modes.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoModes {
    /// A prior outside its domain.
    #[error(transparent)]
    OutOfDomain(#[from] OutOfDomain),
    /// More satellites than there is room for.
    #[error("{have} satellites; {MOST_SATELLITES} can be monitored")]
    TooManySatellites {
        /// Satellites at hand.
        have: usize,
    },
    /// Priors so large that more modes must be monitored than there is room for.
    #[error("more than {MOST_MODES} fault modes must be monitored")]
    TooManyModes,
    /// More modes likely enough to be excluded than decisions are weighed.
    #[error("more than {most} fault modes may have to be excluded")]
    TooManyDecisions {
        /// As many as there is room for.
        most: usize,
    },
}

impl NoModes {
    /// Its entry in the list of reasons.
    pub const fn reason(&self) -> Reason {
        match self {
            Self::OutOfDomain(_) => Reason::InvalidNumber,
            Self::TooManySatellites { .. } | Self::TooManyModes | Self::TooManyDecisions { .. } => Reason::TooMany,
        }
    }
}

/// Which modes a method must monitor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watch {
    /// Modes more likely than this are always monitored.
    pub always: f64,
    /// What is left unmonitored may be as likely as this together.
    pub unmonitored: f64,
    /// A set of satellites of one constellation less likely than this share of the fault of the whole is counted with the whole.
    pub consolidation: f64,
    /// Most events at a time that are looked at; more count as not monitored.
    pub most_at_once: usize,
    /// Which modes are taken first.
    pub first: First,
}

/// The order in which modes are taken until the rest is rare enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum First {
    /// Fewest satellites, as the reference algorithm of advanced RAIM does.
    Smallest,
    /// The most likely ones: fewest modes.
    Likeliest,
}

/// A satellite as an event: whose it is, and how likely it is in fault.
pub type Prior = (Constellation, f64);

const NONE: FaultMode = FaultMode { satellites: 0, constellations: 0, p: 0.0 };

impl FaultModes {
    /// The modes of satellites with their priors and those of their constellations in the order of [`Constellation::index`]. An event with the
    /// prior zero does not happen.
    ///
    /// # Errors
    /// [`NoModes`].
    pub fn of(satellites: &[Prior], p_const: &[f64; CLOCKS], watch: &Watch) -> Result<Self, NoModes> {
        let events = Events::new(satellites, p_const)?;
        let (order, beyond) = events.order(watch);
        let mut listed = Listed::default();
        events.list(order, &mut listed)?;
        listed.consolidate(&events, watch.consolidation);
        match watch.first {
            First::Smallest => listed.by_size(satellites.len()),
            First::Likeliest => listed.by_probability(),
        }
        let mut modes = Self { list: [NONE; MOST_MODES], count: 0, left: beyond };
        modes.keep(&mut listed, watch, &events)?;
        Ok(modes)
    }

    /// No fault, and each satellite alone; nothing else can happen: what receivers without priors assume.
    ///
    /// # Errors
    /// [`NoModes::TooManySatellites`].
    pub fn single(satellites: &[Prior]) -> Result<Self, NoModes> {
        if satellites.len() > MOST_SATELLITES {
            return Err(NoModes::TooManySatellites { have: satellites.len() });
        }
        let mut modes = Self { list: [NONE; MOST_MODES], count: 1 + satellites.len(), left: 0.0 };
        modes.list[0].p = 1.0;
        for (i, (slot, (constellation, p))) in modes.list[1..].iter_mut().zip(satellites).enumerate() {
            let alone = satellites.iter().filter(|s| s.0 == *constellation).count() == 1;
            let constellations = if alone { 1 << constellation.index() } else { 0 };
            *slot = FaultMode { satellites: 1 << i, constellations, p: *p };
        }
        Ok(modes)
    }

    /// The modes.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &FaultMode> + Clone {
        self.list[..self.count].iter()
    }

    /// Probability of all modes that are not monitored.
    pub const fn left(&self) -> f64 {
        self.left
    }

    /// How many.
    pub const fn len(&self) -> usize {
        self.count
    }

    /// None: never, the fault-free one is always there.
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    fn keep(&mut self, listed: &mut Listed, watch: &Watch, events: &Events) -> Result<(), NoModes> {
        let likely = |s: &Set| s.p > watch.always;
        self.left += listed.sets().filter(|s| !likely(s)).map(|s| s.p).sum::<f64>();
        for k in 0..listed.count {
            let set = listed.at(k);
            let fill = !likely(&set) && self.left > watch.unmonitored;
            if !(likely(&set) || fill) {
                continue;
            }
            if fill {
                self.left -= set.p;
            }
            let slot = self.list.get_mut(self.count).ok_or(NoModes::TooManyModes)?;
            *slot = FaultMode { satellites: set.mask, constellations: events.whole(set.mask), p: set.p };
            self.count += 1;
        }
        Ok(())
    }
}

/// Independent events: satellites first, then the constellations in use.
struct Events {
    p: [f64; MOST_EVENTS],
    mask: [u64; MOST_EVENTS],
    count: usize,
    /// Satellites of each constellation.
    members: [u64; CLOCKS],
    fault_free: f64,
}

impl Events {
    fn new(satellites: &[Prior], p_const: &[f64; CLOCKS]) -> Result<Self, NoModes> {
        if satellites.len() > MOST_SATELLITES {
            return Err(NoModes::TooManySatellites { have: satellites.len() });
        }
        let mut events = Self { p: [0.0; MOST_EVENTS], mask: [0; MOST_EVENTS], count: 0, members: [0; CLOCKS], fault_free: 1.0 };
        for (i, (constellation, p)) in satellites.iter().enumerate() {
            events.members[constellation.index()] |= 1 << i;
            events.push("p_sat", *p, 1 << i)?;
        }
        for c in 0..CLOCKS {
            if events.members[c] != 0 {
                events.push("p_const", p_const[c], events.members[c])?;
            }
        }
        Ok(events)
    }

    fn push(&mut self, argument: &'static str, p: f64, mask: u64) -> Result<(), NoModes> {
        if !(0.0..1.0).contains(&p) {
            return Err(OutOfDomain { argument, value: p, unit: "1", domain: "[0, 1)" }.into());
        }
        if p == 0.0 {
            return Ok(());
        }
        (self.p[self.count], self.mask[self.count]) = (p, mask);
        self.count += 1;
        self.fault_free *= 1.0 - p;
        Ok(())
    }

    /// How many events at a time must be looked at, and the probability of more.
    fn order(&self, watch: &Watch) -> (usize, f64) {
        // Probability of exactly k events, event by event.
        let mut exactly = [0.0; MOST_EVENTS + 1];
        exactly[0] = 1.0;
        for (e, p) in self.p[..self.count].iter().enumerate() {
            for k in (0..=e + 1).rev() {
                exactly[k] = exactly[k] * (1.0 - p) + if k > 0 { exactly[k - 1] * p } else { 0.0 };
            }
        }
        let beyond = |r: usize| exactly[..=self.count].iter().skip(r + 1).rev().sum::<f64>();
        let enough = (2..self.count).find(|r| beyond(*r) <= watch.unmonitored).unwrap_or(self.count);
        let order = enough.min(watch.most_at_once);
        (order, beyond(order))
    }

    /// Constellations wholly inside a set.
    fn whole(&self, mask: u64) -> u8 {
        (0..CLOCKS).filter(|c| self.members[*c] != 0 && mask & self.members[*c] == self.members[*c]).fold(0, |w, c| w | 1 << c)
    }

    /// Every set of at most `order` events, fewest events first, each number of events in the order of the events.
    fn list(&self, order: usize, listed: &mut Listed) -> Result<(), NoModes> {
        listed.add(self, Set { mask: 0, p: self.fault_free })?;
        for size in 1..=order {
            self.extend(size, 0, Set { mask: 0, p: self.fault_free }, listed)?;
        }
        Ok(())
    }

    /// Sets of `size` more events from `first` on.
    fn extend(&self, size: usize, first: usize, set: Set, listed: &mut Listed) -> Result<(), NoModes> {
        for e in first..self.count {
            let larger = Set { mask: set.mask | self.mask[e], p: set.p * (self.p[e] / (1.0 - self.p[e])) };
            if size == 1 {
                listed.add(self, larger)?;
            } else {
                self.extend(size - 1, e + 1, larger, listed)?;
            }
        }
        Ok(())
    }
}

/// A set of satellites and how likely it is.
#[derive(Debug, Clone, Copy)]
struct Set {
    mask: u64,
    p: f64,
}

/// Sets in their order.
struct Listed {
    set: [Set; MOST_LISTED],
    count: usize,
    /// Places of the sets that hold a whole constellation: only these can be met twice.
    whole: [u16; MOST_LISTED],
    wholes: usize,
    /// Places in the order by size.
    sorted: [u16; MOST_LISTED],
}

impl Default for Listed {
    fn default() -> Self {
        let none = Set { mask: 0, p: 0.0 };
        Self { set: [none; MOST_LISTED], count: 0, whole: [0; MOST_LISTED], wholes: 0, sorted: [0; MOST_LISTED] }
    }
}

impl Listed {
    fn sets(&self) -> impl Iterator<Item = &Set> {
        (0..self.count).map(|k| &self.set[usize::from(self.sorted[k])])
    }

    fn at(&self, k: usize) -> Set {
        self.set[usize::from(self.sorted[k])]
    }

    /// One more set, or more probability for one that is there.
    fn add(&mut self, events: &Events, set: Set) -> Result<(), NoModes> {
        if events.whole(set.mask) != 0 {
            if let Some(place) = self.place(set.mask) {
                self.set[place].p += set.p;
                return Ok(());
            }
            if self.count < MOST_LISTED {
                self.whole[self.wholes] = self.count as u16;
                self.wholes += 1;
            }
        }
        *self.set.get_mut(self.count).ok_or(NoModes::TooManyModes)? = set;
        self.count += 1;
        Ok(())
    }

    fn place(&self, mask: u64) -> Option<usize> {
        self.whole[..self.wholes].iter().map(|k| usize::from(*k)).find(|k| self.set[*k].mask == mask)
    }

    /// Unlikely sets inside a constellation count with the fault of the whole; they become sets without probability.
    fn consolidate(&mut self, events: &Events, share: f64) {
        for members in events.members {
            let Some(whole) = self.place(members).filter(|_| members != 0) else { continue };
            let limit = share * self.set[whole].p;
            for k in 0..self.count {
                let set = self.set[k];
                let inside = set.mask != 0 && set.mask != members && set.mask & !members == 0;
                if inside && set.p < limit {
                    self.set[whole].p += set.p;
                    self.set[k].p = 0.0;
                }
            }
        }
    }

    /// Fewest satellites first, sets of one size in their order; sets without probability leave.
    fn by_size(&mut self, satellites: usize) {
        let mut count = 0;
        for size in 0..=satellites as u32 {
            for k in 0..self.count {
                if self.set[k].p > 0.0 && self.set[k].mask.count_ones() == size {
                    self.sorted[count] = k as u16;
                    count += 1;
                }
            }
        }
        self.count = count;
    }

    /// Likeliest first after the fault-free one, sets equally likely in their order; sets without probability leave.
    fn by_probability(&mut self) {
        let mut count = 0;
        for k in (0..self.count).filter(|k| self.set[*k].p > 0.0) {
            self.sorted[count] = k as u16;
            count += 1;
        }
        let set = &self.set;
        let key = |k: &u16| set[usize::from(*k)];
        self.sorted[..count].sort_unstable_by(|a, b| {
            let (x, y) = (key(a), key(b));
            (x.mask != 0).cmp(&(y.mask != 0)).then(y.p.total_cmp(&x.p)).then(a.cmp(b))
        });
        self.count = count;
    }
}
