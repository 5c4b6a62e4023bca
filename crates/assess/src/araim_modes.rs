//! Fault modes that were worked out once, for the epochs and exclusions that ask for them again.

use navbound_core::bound::Sight;
use navbound_core::bound::araim::modes::{Book, FaultModes, MOST_SATELLITES, NoModes};
use navbound_core::bound::araim::service::Service;
use navbound_core::signal::Constellation;
use std::collections::HashMap;

/// Fault modes by the constellations of the satellites: where satellites of one constellation share a prior these tell them all.
pub(crate) struct Known {
    p_const: [f64; Constellation::ALL.len()],
    uniform: bool,
    places: HashMap<Key, usize>,
    modes: Vec<FaultModes>,
    /// What was requested last: exclusions of one constellation's satellites ask for the same again and again.
    last: Option<(Key, usize)>,
}

/// Sets of fault modes that are kept, 12 kB each; a program that asks for single epochs all day does not grow.
const MOST_KEPT: usize = 256;

/// Constellations of the satellites in their order.
type Key = [u8; MOST_SATELLITES];

impl Known {
    pub(crate) fn new(p_const: [f64; Constellation::ALL.len()], uniform: bool) -> Self {
        Self { p_const, uniform, places: HashMap::new(), modes: Vec::new(), last: None }
    }

    fn place(&mut self, key: Key, sights: &[Sight], service: &Service) -> Result<usize, NoModes> {
        if let Some(place) = self.places.get(&key) {
            return Ok(*place);
        }
        if self.modes.len() == MOST_KEPT {
            self.places.clear();
            self.modes.clear();
            self.last = None;
        }
        self.modes.push(service.modes(sights, &self.p_const)?);
        self.places.insert(key, self.modes.len() - 1);
        Ok(self.modes.len() - 1)
    }
}

impl Book for Known {
    fn modes(&mut self, sights: &[Sight], service: &Service) -> Result<&FaultModes, NoModes> {
        if !self.uniform {
            self.modes.clear();
            self.modes.push(service.modes(sights, &self.p_const)?);
            return Ok(&self.modes[0]);
        }
        let mut key = [u8::MAX; MOST_SATELLITES];
        for (slot, sight) in key.iter_mut().zip(sights) {
            *slot = sight.constellation.index() as u8;
        }
        let place = match self.last {
            Some((last, place)) if last == key => place,
            _ => self.place(key, sights, service)?,
        };
        self.last = Some((key, place));
        Ok(&self.modes[place])
    }
}
