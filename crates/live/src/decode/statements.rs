//! What a line of JSON says of its own position under keys that are none of the contract.

use super::keys::Keys;
use super::places::{LatLon, PlaceWords, Places, halves, plain, stem};
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// Names under which recordings state the validity or the integrity of their positions, as tables have them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Statements {
    kinds: Vec<Kind>,
    by_name: BTreeMap<String, usize>,
    /// Words of `nav_mode` that speak against the position.
    modes: BTreeSet<String>,
    places: Places,
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
    /// Of kinds, of words of `nav_mode` that speak against the position, and of names of other places.
    pub fn new(kinds: Vec<StatementRow>, modes: Vec<String>, (words, apart_m): PlaceWords) -> Self {
        let [latitude, longitude, of_others, inertial, pair, counts, hemisphere, south, north, west, east] =
            words.map(|each| each.into_iter().collect());
        let sides = [[south, north], [west, east]];
        let places = Places { latitude, longitude, of_others, inertial, pair, counts, hemisphere, sides, apart_m };
        let mut all = Self { modes: modes.into_iter().collect(), places, ..Self::default() };
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
            Value::Object(inner) => any(&mut inner.iter().filter(|(name, _)| !is_shape(inner, name)).filter_map(|(name, each)| {
                self.speaks_against(&format!("{key}_{name}"), each).or_else(|| self.speaks_against(name, each))
            }))
            // What is said of a position in words that nobody knows speaks against it.
            .or_else(|| self.kind(key).filter(|_| !inner.keys().all(|name| self.places.is_of_a_place(name))).map(|_| true)),
            Value::String(text) if written(text).is_some() => written(text).and_then(|value| self.speaks_against(key, &value)),
            // A letter of a hemisphere is no number of satellites.
            _ if self.places.is_hemisphere(key, value) => None,
            _ if self.kind(key).is_some() => self.kind(key).map(|kind| kind.against(value)),
            Value::Array(all) => any(&mut all.iter().filter_map(|each| self.speaks_against(key, each))),
            Value::String(text) => text.split([',', ';', '|']).any(|flag| self.kind(flag).is_some_and(Kind::is_flag)).then_some(true),
            _ => None,
        }
    }

    /// What [`Self::speaks_against`] says beside another place: a list or a text that is that place states nothing more.
    fn beside(&self, key: &str, value: &Value, elsewhere: Option<bool>) -> Option<bool> {
        let is_place = elsewhere == Some(false) && self.kind(key).is_some() && Places::is_two_numbers(value);
        if is_place { None } else { self.speaks_against(key, value) }
    }

    /// Whether another place of the vehicle, or an object or a list that holds one, contradicts the position; `None` where there is none.
    fn elsewhere(&self, key: &str, value: &Value, at: LatLon) -> Option<bool> {
        let any = |compared: &mut dyn Iterator<Item = bool>| compared.reduce(|one, other| one || other);
        match value {
            Value::Object(inner) => {
                let letters = self.places.letters(inner.iter().map(|(name, each)| (&**name, each)));
                let each = inner.iter().filter_map(|(name, each)| {
                    self.elsewhere(&format!("{key}_{name}"), letters.signed(name, each).as_ref().unwrap_or(each), at)
                });
                let halves = halves(inner.iter().map(|(name, each)| (&**name, each)));
                let pairs =
                    halves.iter().filter_map(|(stem, pair)| self.places.pair_contradicts(&format!("{key}_{stem}"), pair, at, false));
                any(&mut each.chain(pairs))
            }
            Value::Array(all) if all.len() == 1 || all.iter().any(|each| each.is_object() || each.is_array()) => {
                any(&mut all.iter().filter_map(|each| self.elsewhere(key, each, at)))
            }
            Value::String(text) if written(text).is_some() => written(text).and_then(|value| self.elsewhere(key, &value, at)),
            _ => any(&mut [
                self.places.contradict(key, value, at),
                self.places.pair_contradicts(key, value, at, self.kind(key).is_some()),
                self.places.hemisphere_contradicts(key, value, at),
            ]
            .into_iter()
            .flatten()),
        }
    }

    /// Whether a position that is kept in this way is none.
    pub(super) fn stopped(&self, mode: &str) -> bool {
        self.modes.contains(&spelled(mode))
    }
}

/// Whether a name is the `type` of something with coordinates, which is a shape.
fn is_shape(of: &serde_json::Map<String, Value>, name: &str) -> bool {
    name == "type" && ["coordinates", "geometry"].iter().any(|key| of.contains_key(*key))
}

/// An object or a list of JSON that is written into a text.
fn written(text: &str) -> Option<Value> {
    text.trim_start().starts_with(['{', '[']).then(|| serde_json::from_str(text).ok()).flatten()
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

/// Whether a line speaks against its position under a key that is not `known`; the other such keys are counted. One that cannot be read to
/// its end (a number that is none, half of a character, a hundred brackets) may say anything, and is not believed.
pub(super) fn heard(line: &[u8], known: &[&str], at: Option<LatLon>, statements: &Statements, keys: &mut Keys) -> bool {
    let mut from = serde_json::Deserializer::from_slice(line);
    let Ok(others) = from.deserialize_map(Others { known }) else {
        keys.against.count("a line that is not read to its end");
        return true;
    };
    let letters = statements.places.letters(others.iter().map(|(key, value)| (&**key, value)));
    let (mut against, mut numbered) = (false, Vec::new());
    for (key, value) in &others {
        let signed = letters.signed(key, value);
        let elsewhere = at.and_then(|at| statements.elsewhere(key, signed.as_ref().unwrap_or(value), at));
        match (elsewhere, statements.beside(key, value, elsewhere)) {
            (None, None) if stem(key).is_some() => numbered.push((&**key, value)),
            (None, None) => keys.passed_over.count(key),
            (Some(true), _) | (_, Some(true)) => {
                keys.against.count(key);
                against = true;
            }
            _ => {}
        }
    }
    let pairs = halves(numbered.iter().copied());
    let compared = |stem: &str| at.and_then(|at| statements.places.pair_contradicts(stem, pairs.get(stem)?, at, false));
    for (key, _) in numbered {
        match stem(key).and_then(compared) {
            Some(false) => {}
            Some(true) => {
                keys.against.count(key);
                against = true;
            }
            None => keys.passed_over.count(key),
        }
    }
    against
}

/// The fields of a line that are not known.
struct Others<'a> {
    known: &'a [&'a str],
}

impl<'de> Visitor<'de> for Others<'_> {
    type Value = Vec<(Cow<'de, str>, Value)>;

    fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut others = Vec::new();
        while let Some(Key(key)) = map.next_key()? {
            if self.known.contains(&&*key) {
                map.next_value::<IgnoredAny>()?;
            } else {
                others.push((key, map.next_value()?));
            }
        }
        Ok(others)
    }
}

/// A key, without a copy where it has no escapes.
#[derive(Deserialize)]
struct Key<'a>(#[serde(borrow)] Cow<'a, str>);
