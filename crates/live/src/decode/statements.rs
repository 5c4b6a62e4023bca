//! What a line of JSON says of its own position under keys that are none of the contract.

use crate::codec::{Damaged, Reader, Writer};
use navbound_core::monitor::neighbours::east_north_m;
use navbound_formats::place::{self, Written};
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
    places: Places,
}

/// A position in radians.
pub(super) type LatLon = (f64, f64);

/// Parts of names by which tables know another place of the vehicle.
#[derive(Debug, Clone, Default, PartialEq)]
struct Places {
    latitude: BTreeSet<String>,
    longitude: BTreeSet<String>,
    /// Of a place that is none of the vehicle now.
    of_others: BTreeSet<String>,
    /// Of one that inertial sensors alone keep.
    inertial: BTreeSet<String>,
    /// Of a place with both coordinates in one value.
    pair: BTreeSet<String>,
    /// Of whole numbers that count something.
    counts: BTreeSet<String>,
    /// Of a hemisphere.
    hemisphere: BTreeSet<String>,
    /// Words of the hemispheres, below zero and above it, of a latitude and of a longitude.
    sides: [[BTreeSet<String>; 2]; 2],
    /// How far another place may be away, and one of inertial sensors \[m\].
    apart_m: [f64; 2],
}

/// Parts of names: latitude, longitude, what is none of the vehicle, inertial sensors, both coordinates in one, counts, hemispheres; words of
/// the south, the north, the west and the east; and how far such places may be away \[m\].
pub type PlaceWords = ([Vec<String>; 11], [f64; 2]);

/// Whole numbers up to it under a name that counts are no coordinates (ours) \[1\].
const MOST_COUNTED: f64 = 1e5;
/// Names beyond it are no pair's \[1\].
const LONGEST_OF_A_PAIR: usize = 200;
/// First parts of names of a height (ours).
const HEIGHTS: [&str; 5] = ["alt", "altitude", "height", "ele", "elevation"];
/// Nearer to zero a letter of a hemisphere contradicts nothing (ours) \[rad\].
const NO_SIDE_RAD: f64 = 1e-4;

impl Places {
    /// Whether a value with both coordinates contradicts the position, in whichever order they are; `None` where it is no place of the vehicle.
    fn pair_contradicts(&self, key: &str, value: &Value, (lat_rad, lon_rad): LatLon) -> Option<bool> {
        let parts = parts(key);
        let any = |words| has(&parts, words);
        let written = match value {
            Value::String(text) if plain(key).contains("geohash") => place::of_geohash(text),
            Value::String(text) => place::of_text(text),
            Value::Array(all) => numbers(all).map(|deg| Written { deg, ordered: false, by_itself: false }),
            _ => None,
        };
        let named = self.is_pair(&parts) || plain(key).contains("geohash");
        let written = written.filter(|written| (written.by_itself || named) && written.deg != [0.0; 2] && !any(&self.of_others))?;
        let apart_m = written.places_rad().map(|there| {
            let [east, north] = east_north_m([lat_rad, lon_rad], there);
            libm::hypot(east, north)
        });
        let [of_any, of_inertial] = self.apart_m;
        apart_m.reduce(f64::min).map(|apart_m| apart_m > if any(&self.inertial) { of_inertial } else { of_any })
    }

    /// Whether a name is one of a coordinate or of a height: it states where the vehicle is, and nothing of how well that is known.
    fn is_of_a_place(&self, name: &str) -> bool {
        let parts = parts(name);
        has(&parts, &self.latitude) || has(&parts, &self.longitude) || parts.first().is_some_and(|first| HEIGHTS.contains(&&**first))
    }

    /// Whether the parts of a name are those of both coordinates.
    fn is_pair(&self, parts: &[String]) -> bool {
        has(parts, &self.pair) || (has(parts, &self.latitude) && has(parts, &self.longitude))
    }

    /// Whether a number contradicts the position; `None` where by its name it is no coordinate of the vehicle.
    fn contradict(&self, key: &str, value: &Value, (lat_rad, lon_rad): LatLon) -> Option<bool> {
        let parts = parts(key);
        let any = |words| has(&parts, words);
        let is_latitude = any(&self.latitude);
        // A number that is named of both coordinates is neither of them.
        if is_latitude == any(&self.longitude) {
            return None;
        }
        let number = number(value);
        // Who has no position writes zeros.
        let number = number.filter(|number| *number != 0.0 && !any(&self.of_others))?;
        if any(&self.counts) && number.fract() == 0.0 && number.abs() <= MOST_COUNTED {
            return None;
        }
        let unit = |name: &str| parts.iter().any(|part| part == name);
        let other_rad = if unit("rad") { number } else { (number * if unit("e7") || unit("1e7") { 1e-7 } else { 1.0 }).to_radians() };
        let there = if is_latitude { [other_rad, lon_rad] } else { [lat_rad, other_rad] };
        let [east, north] = east_north_m([lat_rad, lon_rad], there);
        let apart_m = east.abs().max(north.abs());
        let [of_any, of_inertial] = self.apart_m;
        Some(apart_m > if any(&self.inertial) { of_inertial } else { of_any })
    }

    /// The signs of latitude and longitude that a text states as a hemisphere; `None` each where it states none, or has no name of that
    /// coordinate or of a hemisphere.
    fn signs(&self, key: &str, value: &Value) -> [Option<f64>; 2] {
        let Value::String(text) = value else { return [None; 2] };
        let word: String = text.chars().filter(|c| c.is_alphabetic()).flat_map(char::to_uppercase).collect();
        let parts = parts(key);
        let any = |words| has(&parts, words);
        let of_any = any(&self.hemisphere) || self.hemisphere.contains(&plain(key));
        let letters = |axis: usize| match word.as_bytes() {
            [one @ (b'N' | b'S'), other @ (b'E' | b'W')] => Some(if [*one, *other][axis] == [b'S', b'W'][axis] { -1.0 } else { 1.0 }),
            _ => [-1.0, 1.0].into_iter().zip(&self.sides[axis]).find_map(|(sign, words)| words.contains(&word).then_some(sign)),
        };
        let stated = |axis: usize, named: bool| letters(axis).filter(|_| (named || of_any) && !any(&self.of_others));
        [stated(0, any(&self.latitude)), stated(1, any(&self.longitude))]
    }

    /// Whether a value is a letter or a word of a hemisphere and nothing else, under a name of a coordinate or of a hemisphere.
    fn is_hemisphere(&self, key: &str, value: &Value) -> bool {
        value.as_str().is_some_and(|text| !has_digits(text)) && self.signs(key, value) != [None; 2]
    }

    /// Whether a text is of a hemisphere on the other side of the position; `None` where it states none.
    fn hemisphere_contradicts(&self, key: &str, value: &Value, (lat_rad, lon_rad): LatLon) -> Option<bool> {
        let signs = self.signs(key, value).into_iter().zip([lat_rad, lon_rad]);
        let beyond = signs.filter_map(|(sign, angle_rad)| sign.map(|sign| angle_rad.abs() > NO_SIDE_RAD && sign * angle_rad < 0.0));
        // A number beside its letter that nobody could read was not compared.
        beyond.reduce(|one, other| one || other).filter(|against| *against || self.is_hemisphere(key, value))
    }
}

/// Whether a name has one of these parts, numbered or not.
fn has(parts: &[String], words: &BTreeSet<String>) -> bool {
    parts.iter().any(|part| words.contains(part.trim_end_matches(|c: char| c.is_ascii_digit())))
}

fn has_digits(text: &str) -> bool {
    text.contains(|c: char| c.is_ascii_digit())
}

/// A number, or a text of a coordinate.
fn number(value: &Value) -> Option<f64> {
    value.as_f64().or_else(|| value.as_str().and_then(place::of_coordinate))
}

/// The two numbers of a list that may be a place, with a height at most.
fn numbers(all: &[Value]) -> Option<[f64; 2]> {
    let numbers: Option<Vec<f64>> = all.iter().map(number).collect();
    match *numbers? {
        [first, second] | [first, second, _] => Some([first, second]),
        _ => None,
    }
}

/// Parts of a name, in small letters: at what is neither letter nor digit, and before a capital.
fn parts(name: &str) -> Vec<String> {
    let (mut parted, mut last) = (String::new(), '_');
    for c in name.chars() {
        if c.is_ascii_uppercase() && (last.is_ascii_lowercase() || last.is_ascii_digit()) {
            parted.push('_');
        }
        parted.push(c.to_ascii_lowercase());
        last = c;
    }
    parted.split(|c: char| !c.is_ascii_alphanumeric()).map(str::to_owned).collect()
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

    /// Whether another place of the vehicle, or an object or a list that holds one, contradicts the position; `None` where there is none.
    fn elsewhere(&self, key: &str, value: &Value, at: LatLon) -> Option<bool> {
        let any = |compared: &mut dyn Iterator<Item = bool>| compared.reduce(|one, other| one || other);
        match value {
            Value::Object(inner) => {
                let each = inner.iter().filter_map(|(name, each)| self.elsewhere(&format!("{key}_{name}"), each, at));
                let halves = halves(inner.iter().map(|(name, each)| (&**name, each)));
                let pairs = halves.iter().filter_map(|(stem, pair)| self.places.pair_contradicts(&format!("{key}_{stem}"), pair, at));
                any(&mut each.chain(pairs))
            }
            Value::Array(all) if all.len() == 1 || all.iter().any(|each| each.is_object() || each.is_array()) => {
                any(&mut all.iter().filter_map(|each| self.elsewhere(key, each, at)))
            }
            Value::String(text) if written(text).is_some() => written(text).and_then(|value| self.elsewhere(key, &value, at)),
            _ => any(&mut [
                self.places.contradict(key, value, at),
                self.places.pair_contradicts(key, value, at),
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

/// What a name is without its last digit, where it ends with one: `gps_lat_lon_0` and `gps_lat_lon_1` are one pair.
fn stem(name: &str) -> Option<&str> {
    let bare = |text: &str| text.trim_end_matches(|c: char| !c.is_ascii_alphanumeric()).len();
    let of = |length: usize| name.get(..length);
    let digitless = of(bare(name)).filter(|_| name.len() <= LONGEST_OF_A_PAIR)?.strip_suffix(|c: char| c.is_ascii_digit())?;
    of(bare(digitless)).filter(|stem| !stem.is_empty())
}

/// Pairs of numbers under names of one stem, by it.
fn halves<'a>(all: impl Iterator<Item = (&'a str, &'a Value)>) -> BTreeMap<&'a str, Value> {
    let mut by_stem: BTreeMap<&str, Vec<Value>> = BTreeMap::new();
    for (stem, value) in all.filter_map(|(name, value)| Some((stem(name)?, value))).filter(|(_, value)| number(value).is_some()) {
        by_stem.entry(stem).or_default().push(value.clone());
    }
    by_stem.into_iter().filter(|(_, pair)| pair.len() == 2).map(|(stem, pair)| (stem, Value::Array(pair))).collect()
}

/// Whether a name is the `type` of something with coordinates, which is a shape.
fn is_shape(of: &serde_json::Map<String, Value>, name: &str) -> bool {
    name == "type" && ["coordinates", "geometry"].iter().any(|key| of.contains_key(*key))
}

/// An object or a list of JSON that is written into a text.
fn written(text: &str) -> Option<Value> {
    text.trim_start().starts_with(['{', '[']).then(|| serde_json::from_str(text).ok()).flatten()
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
const MOST_NAMES: usize = 200;
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
pub(super) fn heard(line: &[u8], known: &[&str], at: Option<LatLon>, statements: &Statements, passed_over: &mut PassedOver) -> bool {
    let mut from = serde_json::Deserializer::from_slice(line);
    from.deserialize_map(Others { known, at, statements, passed_over }).unwrap_or(true)
}

struct Others<'a> {
    known: &'a [&'a str],
    /// The position of the line.
    at: Option<LatLon>,
    statements: &'a Statements,
    passed_over: &'a mut PassedOver,
}

impl<'de> Visitor<'de> for Others<'_> {
    type Value = bool;

    fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<bool, A::Error> {
        let (mut against, mut numbered) = (false, Vec::new());
        while let Some(Key(key)) = map.next_key()? {
            if self.known.contains(&&*key) {
                map.next_value::<IgnoredAny>()?;
                continue;
            }
            let value: Value = map.next_value()?;
            let elsewhere = self.at.and_then(|at| self.statements.elsewhere(&key, &value, at));
            match (elsewhere, self.statements.speaks_against(&key, &value)) {
                (None, None) if stem(&key).is_some() => numbered.push((key.into_owned(), value)),
                (None, None) => self.passed_over.count(&key),
                (elsewhere, spoken) => against |= elsewhere.unwrap_or(false) || spoken.unwrap_or(false),
            }
        }
        let pairs = halves(numbered.iter().map(|(key, value): &(String, Value)| (&**key, value)));
        let compared = |stem: &str| self.at.and_then(|at| self.statements.places.pair_contradicts(stem, pairs.get(stem)?, at));
        for (key, _) in &numbered {
            match stem(key).and_then(compared) {
                Some(contradicts) => against |= contradicts,
                None => self.passed_over.count(key),
            }
        }
        Ok(against)
    }
}

/// A key, without a copy where it has no escapes.
#[derive(Deserialize)]
struct Key<'a>(#[serde(borrow)] std::borrow::Cow<'a, str>);
