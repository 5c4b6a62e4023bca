//! Other places of the vehicle that a line of JSON states, as tables know them by their names.

use navbound_core::monitor::neighbours::east_north_m;
use navbound_formats::place::{self, Written};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// A position in radians.
pub(super) type LatLon = (f64, f64);

/// Parts of names by which tables know another place of the vehicle.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Places {
    pub(super) latitude: BTreeSet<String>,
    pub(super) longitude: BTreeSet<String>,
    /// Of a place that is none of the vehicle now.
    pub(super) of_others: BTreeSet<String>,
    /// Of one that inertial sensors alone keep.
    pub(super) inertial: BTreeSet<String>,
    /// Of a place with both coordinates in one value.
    pub(super) pair: BTreeSet<String>,
    /// Of whole numbers that count something.
    pub(super) counts: BTreeSet<String>,
    /// Of a hemisphere.
    pub(super) hemisphere: BTreeSet<String>,
    /// Words of the hemispheres, below zero and above it, of a latitude and of a longitude.
    pub(super) sides: [[BTreeSet<String>; 2]; 2],
    /// How far another place may be away, and one of inertial sensors \[m\].
    pub(super) apart_m: [f64; 2],
}

/// Parts of names: latitude, longitude, what is none of the vehicle, inertial sensors, both coordinates in one, counts, hemispheres; words of
/// the south, the north, the west and the east; and how far such places may be away \[m\].
pub type PlaceWords = ([Vec<String>; 11], [f64; 2]);

/// Whole numbers up to it under a name that counts are no coordinates (ours) \[1\].
const MOST_COUNTED: f64 = 1e5;
/// Names beyond it are no pair's \[1\].
const LONGEST_OF_A_PAIR: usize = 200;
/// First parts of names of a height, of a motion and of a time (ours).
const HEIGHTS: [&str; 5] = ["alt", "altitude", "height", "ele", "elevation"];
const MOTIONS: [&str; 12] =
    ["speed", "velocity", "heading", "course", "track", "bearing", "climb", "time", "timestamp", "date", "utc", "datetime"];
/// Nearer to zero a letter of a hemisphere contradicts nothing (ours) \[rad\].
const NO_SIDE_RAD: f64 = 1e-4;

impl Places {
    /// Whether a value with both coordinates contradicts the position, in whichever order they are; `None` where it is no place of the vehicle.
    /// `named`: a list of two numbers under this name is one, whatever its parts are.
    pub(super) fn pair_contradicts(&self, key: &str, value: &Value, (lat_rad, lon_rad): LatLon, named: bool) -> Option<bool> {
        let parts = parts(key);
        let any = |words| has(&parts, words);
        let is_geohash = plain(key).contains("geohash");
        let written = if is_geohash { value.as_str().and_then(place::of_geohash) } else { of_value(value) };
        let named = named || is_geohash || self.is_pair(&parts);
        let written = written.filter(|written| (written.by_itself || named) && written.deg != [0.0; 2] && !any(&self.of_others))?;
        let apart_m = written.places_rad().map(|there| {
            let [east, north] = east_north_m([lat_rad, lon_rad], there);
            libm::hypot(east, north)
        });
        let [of_any, of_inertial] = self.apart_m;
        apart_m.reduce(f64::min).map(|apart_m| apart_m > if any(&self.inertial) { of_inertial } else { of_any })
    }

    /// The letters of hemispheres among the fields of one object.
    pub(super) fn letters<'a>(&self, fields: impl Iterator<Item = (&'a str, &'a Value)>) -> Letters<'_> {
        let mut of: BTreeMap<(usize, String), Option<&str>> = BTreeMap::new();
        for (name, value) in fields.filter(|(_, value)| value.as_str().is_some_and(|text| !has_digits(text))) {
            for (axis, sign) in self.signs(name, value).into_iter().enumerate() {
                let Some(letter) = sign.map(|sign| LETTERS[axis][usize::from(sign > 0.0)]) else { continue };
                let whose: Vec<String> = parts(name).into_iter().filter(|part| !(part.is_empty() || SIDE.contains(&&**part))).collect();
                // Two that differ say nothing of one number.
                of.entry((axis, whose.join("_")))
                    .and_modify(|known| *known = known.filter(|known| *known == letter))
                    .or_insert(Some(letter));
            }
        }
        Letters { places: self, of }
    }

    /// Whether a value is a list or a text of two numbers.
    pub(super) fn is_two_numbers(value: &Value) -> bool {
        of_value(value).is_some()
    }

    /// Whether a name is one of a coordinate, a height, a motion or a time: it states where the vehicle is, and nothing of how well that is known.
    pub(super) fn is_of_a_place(&self, name: &str) -> bool {
        let parts = parts(name);
        has(&parts, &self.latitude)
            || has(&parts, &self.longitude)
            || parts.first().is_some_and(|first| HEIGHTS.contains(&&**first) || MOTIONS.contains(&&**first))
    }

    /// Whether the parts of a name are those of both coordinates.
    fn is_pair(&self, parts: &[String]) -> bool {
        has(parts, &self.pair) || (has(parts, &self.latitude) && has(parts, &self.longitude))
    }

    /// Whether a number contradicts the position; `None` where by its name it is no coordinate of the vehicle.
    pub(super) fn contradict(&self, key: &str, value: &Value, (lat_rad, lon_rad): LatLon) -> Option<bool> {
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
    pub(super) fn is_hemisphere(&self, key: &str, value: &Value) -> bool {
        value.as_str().is_some_and(|text| !has_digits(text)) && self.signs(key, value) != [None; 2]
    }

    /// Whether a text is of a hemisphere on the other side of the position; `None` where it states none.
    pub(super) fn hemisphere_contradicts(&self, key: &str, value: &Value, (lat_rad, lon_rad): LatLon) -> Option<bool> {
        let signs = self.signs(key, value).into_iter().zip([lat_rad, lon_rad]);
        let beyond = signs.filter_map(|(sign, angle_rad)| sign.map(|sign| angle_rad.abs() > NO_SIDE_RAD && sign * angle_rad < 0.0));
        // A number beside its letter that nobody could read was not compared.
        beyond.reduce(|one, other| one || other).filter(|against| *against || self.is_hemisphere(key, value))
    }
}

/// Letters of hemispheres that stand under keys of their own, by the axis and the name of what they sign.
pub(super) struct Letters<'a> {
    places: &'a Places,
    of: BTreeMap<(usize, String), Option<&'static str>>,
}

impl Letters<'_> {
    /// A coordinate without a sign with its letter, `lat` with `lat_dir`; `None` where it has none.
    pub(super) fn signed(&self, name: &str, value: &Value) -> Option<Value> {
        if self.of.is_empty() {
            return None;
        }
        let text = match value {
            Value::Number(number) if number.as_f64().is_some_and(|number| number >= 0.0) => number.to_string(),
            Value::Array(_) => number(value).filter(|number| *number >= 0.0)?.to_string(),
            Value::String(text) if text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.') => text.clone(),
            _ => return None,
        };
        let parts: Vec<String> = parts(name).into_iter().filter(|part| !part.is_empty()).collect();
        let axes = [&self.places.latitude, &self.places.longitude];
        let (axis, _) = axes.iter().enumerate().find(|(_, words)| has(&parts, words))?;
        let bare = || self.of.get(&(axis, String::new())).filter(|_| parts.len() == 1);
        let letter = (*self.of.get(&(axis, parts.join("_"))).or_else(bare)?)?;
        Some(Value::String(format!("{text} {letter}")))
    }
}

/// Letters below zero and above it, of a latitude and of a longitude.
const LETTERS: [[&str; 2]; 2] = [["S", "N"], ["W", "E"]];
/// Parts of a name of letters that say nothing of whose they are (ours).
const SIDE: [&str; 16] =
    ["dir", "direction", "ref", "hem", "hemi", "hemisphere", "indicator", "ind", "cardinal", "sign", "ns", "ew", "n", "s", "e", "w"];

/// The two numbers of a list or a text that may be a place.
fn of_value(value: &Value) -> Option<Written> {
    match value {
        Value::String(text) => place::of_text(text),
        Value::Array(all) => numbers(all).map(|deg| Written { deg, ordered: false, by_itself: false }),
        _ => None,
    }
}

/// Whether a name has one of these parts, numbered or not.
fn has(parts: &[String], words: &BTreeSet<String>) -> bool {
    parts.iter().any(|part| words.contains(part.trim_end_matches(|c: char| c.is_ascii_digit())))
}

fn has_digits(text: &str) -> bool {
    text.contains(|c: char| c.is_ascii_digit())
}

/// A number, a text of a coordinate, or degrees, minutes and seconds in a list, as EXIF has them.
fn number(value: &Value) -> Option<f64> {
    if let Value::Array(all) = value {
        let [degrees, rest @ ..] = all.as_slice() else { return None };
        let parts: Vec<f64> = rest.iter().map(Value::as_f64).collect::<Option<_>>()?;
        let sexagesimal = (1..=2).contains(&parts.len()) && parts.iter().all(|part| (0.0..60.0).contains(part));
        let [minutes, seconds] = [parts.first().copied()?, parts.get(1).copied().unwrap_or(0.0)];
        return degrees
            .as_f64()
            .filter(|degrees| sexagesimal && degrees.fract() == 0.0)
            .map(|degrees| degrees + (minutes / 60.0 + seconds / 3600.0).copysign(degrees));
    }
    value.as_f64().or_else(|| value.as_str().and_then(place::of_coordinate))
}

/// The two numbers of a list that may be a place, with a height at most.
fn numbers(all: &[Value]) -> Option<[f64; 2]> {
    let numbers: Option<Vec<f64>> = all.iter().map(|each| number(each).filter(|_| !each.is_array())).collect();
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

/// What a name is without its last digit, where it ends with one: `gps_lat_lon_0` and `gps_lat_lon_1` are one pair.
pub(super) fn stem(name: &str) -> Option<&str> {
    let bare = |text: &str| text.trim_end_matches(|c: char| !c.is_ascii_alphanumeric()).len();
    let of = |length: usize| name.get(..length);
    let digitless = of(bare(name)).filter(|_| name.len() <= LONGEST_OF_A_PAIR)?.strip_suffix(|c: char| c.is_ascii_digit())?;
    of(bare(digitless)).filter(|stem| !stem.is_empty())
}

/// Pairs of numbers under names of one stem, by it.
pub(super) fn halves<'a>(all: impl Iterator<Item = (&'a str, &'a Value)>) -> BTreeMap<&'a str, Value> {
    let mut by_stem: BTreeMap<&str, Vec<Value>> = BTreeMap::new();
    for (stem, value) in all.filter_map(|(name, value)| Some((stem(name)?, value))).filter(|(_, value)| number(value).is_some()) {
        by_stem.entry(stem).or_default().push(value.clone());
    }
    by_stem.into_iter().filter(|(_, pair)| pair.len() == 2).map(|(stem, pair)| (stem, Value::Array(pair))).collect()
}

/// A name without case, blanks and strokes.
pub(super) fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}
