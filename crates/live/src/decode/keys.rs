//! Keys of lines, and words of messages, that are counted by name.

use crate::codec::{Damaged, Reader, Writer};
use std::collections::BTreeMap;

/// Names of keys that are counted; further ones are counted together.
const MOST_NAMES: usize = 200;
/// Characters of a name that are kept.
const LONGEST_NAME: usize = 40;
const OTHERS: &str = "(others)";

/// What lines and messages had beside their positions.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Keys {
    /// Keys that were passed over.
    pub(crate) passed_over: Names,
    /// Keys, and words of a receiver's messages, that took positions away.
    pub(crate) against: Names,
}

impl Keys {
    pub(super) fn write(&self, to: &mut Writer) {
        self.passed_over.write(to);
        self.against.write(to);
    }

    pub(super) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Ok(Self { passed_over: Names::read(from)?, against: Names::read(from)? })
    }
}

/// How often each name came.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Names(pub(crate) BTreeMap<String, u64>);

impl Names {
    pub(super) fn count(&mut self, name: &str) {
        // Text from the air: it is printed.
        let name: String = name.chars().take(LONGEST_NAME).map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect();
        let known = self.0.contains_key(&name) || self.0.len() < MOST_NAMES;
        *self.0.entry(if known { name } else { OTHERS.to_owned() }).or_default() += 1;
    }

    fn write(&self, to: &mut Writer) {
        to.u32(self.0.len() as u32);
        for (name, n) in &self.0 {
            to.bytes(name.as_bytes());
            to.u64(*n);
        }
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let mut all = Self::default();
        for _ in 0..from.u32()? {
            let name = core::str::from_utf8(from.bytes()?).map_err(|_| Damaged("the name of a key that is no text"))?.to_owned();
            all.0.insert(name, from.u64()?);
        }
        if all.0.len() > MOST_NAMES + 1 {
            return Err(Damaged("more names of keys than are kept"));
        }
        Ok(all)
    }
}
