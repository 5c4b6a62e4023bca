//! What a line of JSON says of its own position under keys that are none of the contract.

use crate::codec::{Damaged, Reader, Writer};
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Names under which recordings state the validity or the integrity of their positions, as tables have them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Statements {
    kinds: Vec<Kind>,
    by_name: BTreeMap<String, usize>,
    /// Words of `nav_mode` that speak against the position.
    modes: BTreeSet<String>,
}

#[derive(Debug, Clone, PartialEq)]
struct Kind {
    fine: BTreeSet<String>,
    /// The smallest and the largest number that says nothing.
    within: [Option<f64>; 2],
}

impl Kind {
    /// Whether a value, or any value of a list, speaks against the position. A list of nothing raises no flag, and states nothing else.
    fn against(&self, value: &Value) -> bool {
        if let Value::Array(all) = value {
            return if all.is_empty() { !self.is_flag() } else { all.iter().any(|each| self.against(each)) };
        }
        let number = value.as_f64().or_else(|| value.as_str().and_then(|text| text.trim().parse().ok()));
        let [least, most] = self.within;
        let ranged = least.is_some() || most.is_some();
        let within = number.is_some_and(|n: f64| ranged && least.is_none_or(|least| n >= least) && most.is_none_or(|most| n <= most));
        !within && !self.fine.contains(&word(value))
    }

    /// Whether it is a flag that is raised against a position: where it is not raised it says nothing.
    fn is_flag(&self) -> bool {
        self.fine.contains("false")
    }
}

/// Kinds of statements: names, words that say nothing against the position, the smallest and the largest number that says nothing.
pub type StatementRow = (Vec<String>, Vec<String>, Option<f64>, Option<f64>);

impl Statements {
    /// Of kinds, and of words of `nav_mode` that speak against the position.
    pub fn new(kinds: Vec<StatementRow>, modes: Vec<String>) -> Self {
        let mut all = Self { modes: modes.into_iter().collect(), ..Self::default() };
        for (names, fine, least, most) in kinds {
            all.by_name.extend(names.into_iter().map(|name| (plain(&name), all.kinds.len())));
            all.kinds.push(Kind { fine: fine.into_iter().collect(), within: [least, most] });
        }
        all
    }

    fn kind(&self, key: &str) -> Option<&Kind> {
        self.kinds.get(*self.by_name.get(&plain(key))?)
    }

    /// Whether a value speaks against its position; `None` where neither the key nor anything in the value is a statement that is known.
    /// Within an object a name is one of its own, and one behind that of the object; a text is a list of flags that are raised.
    fn speaks_against(&self, key: &str, value: &Value) -> Option<bool> {
        let any = |spoken: &mut dyn Iterator<Item = bool>| spoken.reduce(|one, other| one || other);
        match value {
            Value::Object(inner) => any(&mut inner.iter().filter_map(|(name, each)| {
                self.speaks_against(&format!("{key}_{name}"), each).or_else(|| self.speaks_against(name, each))
            }))
            // What is said of a position in words that nobody knows speaks against it.
            .or_else(|| self.kind(key).map(|_| true)),
            _ if self.kind(key).is_some() => self.kind(key).map(|kind| kind.against(value)),
            Value::Array(all) => any(&mut all.iter().filter_map(|each| self.speaks_against(key, each))),
            Value::String(text) => text.split([',', ';', '|']).any(|flag| self.kind(flag).is_some_and(Kind::is_flag)).then_some(true),
            _ => None,
        }
    }

    /// Whether a position that is kept in this way is none.
    pub(super) fn stopped(&self, mode: &str) -> bool {
        self.modes.contains(&spelled(mode))
    }
}

/// A name without case, blanks and strokes.
fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

fn spelled(text: &str) -> String {
    text.trim().chars().map(|c| if matches!(c, ' ' | '-' | '/') { '_' } else { c.to_ascii_lowercase() }).collect()
}

fn word(value: &Value) -> String {
    match value {
        Value::String(text) => spelled(text),
        // 1 and 1.0 are one number.
        Value::Number(number) => number.as_f64().map_or_else(String::new, |number| number.to_string()),
        other => other.to_string(),
    }
}

/// Names of keys that are counted; further ones are counted together.
const MOST_NAMES: usize = 20;
/// Characters of a name that are kept.
const LONGEST_NAME: usize = 40;
const OTHERS: &str = "(others)";

/// Keys that were passed over, by name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct PassedOver(pub(crate) BTreeMap<String, u64>);

impl PassedOver {
    fn count(&mut self, key: &str) {
        // Text from the air: it is printed.
        let name: String = key.chars().take(LONGEST_NAME).map(|c| if c.is_ascii_graphic() { c } else { '?' }).collect();
        let known = self.0.contains_key(&name) || self.0.len() < MOST_NAMES;
        *self.0.entry(if known { name } else { OTHERS.to_owned() }).or_default() += 1;
    }

    pub(super) fn write(&self, to: &mut Writer) {
        to.u32(self.0.len() as u32);
        for (name, n) in &self.0 {
            to.bytes(name.as_bytes());
            to.u64(*n);
        }
    }

    pub(super) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
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

/// Whether a line speaks against its position under a key that is not `known`; the other such keys are counted. One that cannot be read to
/// its end (a number that is none, half of a character, a hundred brackets) may say anything, and is not believed.
pub(super) fn heard(line: &[u8], known: &[&str], statements: &Statements, passed_over: &mut PassedOver) -> bool {
    let mut from = serde_json::Deserializer::from_slice(line);
    from.deserialize_map(Others { known, statements, passed_over }).unwrap_or(true)
}

struct Others<'a> {
    known: &'a [&'a str],
    statements: &'a Statements,
    passed_over: &'a mut PassedOver,
}

impl<'de> Visitor<'de> for Others<'_> {
    type Value = bool;

    fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<bool, A::Error> {
        let mut against = false;
        while let Some(Key(key)) = map.next_key()? {
            if self.known.contains(&&*key) {
                map.next_value::<IgnoredAny>()?;
                continue;
            }
            match self.statements.speaks_against(&key, &map.next_value()?) {
                Some(so) => against |= so,
                None => self.passed_over.count(&key),
            }
        }
        Ok(against)
    }
}

/// A key, without a copy where it has no escapes.
#[derive(Deserialize)]
struct Key<'a>(#[serde(borrow)] std::borrow::Cow<'a, str>);
