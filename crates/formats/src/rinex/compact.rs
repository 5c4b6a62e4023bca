//! Bodies of compact (Hatanaka) observation files: differences of whole numbers, and changes of text.
//!
//! Source: Y. Hatanaka, "A compression format and tools for GNSS observation data", Bulletin of the GSI 55 (2008); provenance: standard.

use super::header::Lines;
use super::heading::{Heading, satellite};
use super::number::columns;
use super::observation::Observations;
use super::plain::{Head, event, unread};
use super::value::indicators;
use navbound_core::signal::{Constellation, SatelliteId};

/// Why the last epoch of a file that was cut is lost; it says nothing against the one before.
const ENDS: &str = "the file ends within an epoch";
/// Highest order of difference.
const ORDER: usize = 9;

/// Which of the two compact formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// 1.0, of RINEX 2.
    First,
    /// 3.0 and 3.1, of RINEX 3 and 4.
    Third,
}

/// One number followed from epoch to epoch.
#[derive(Debug, Clone, Copy, Default)]
struct Arc {
    alive: bool,
    /// Order the arc grows to, and the one it has reached.
    limit: usize,
    order: usize,
    /// The number, its first difference, its second ...
    differences: [i64; ORDER + 1],
}

impl Arc {
    /// The number of this epoch; `None` for text that is neither a start nor a difference of a living arc.
    fn next(&mut self, field: &[u8]) -> Option<i64> {
        if let [order @ b'0'..=b'9', b'&', start @ ..] = field {
            *self = Self { alive: true, limit: usize::from(order - b'0'), order: 0, differences: [0; ORDER + 1] };
            self.differences[0] = integer(start)?;
            return Some(self.differences[0]);
        }
        let change = integer(field).filter(|_| self.alive)?;
        self.order = (self.order + 1).min(self.limit);
        if self.order == 0 {
            self.differences[0] = self.differences[0].wrapping_add(change);
            return Some(self.differences[0]);
        }
        self.differences[self.order] = change;
        for k in (0..self.order).rev() {
            self.differences[k] = self.differences[k].wrapping_add(self.differences[k + 1]);
        }
        Some(self.differences[0])
    }
}

/// A whole number of at most 18 digits.
fn integer(text: &[u8]) -> Option<i64> {
    let (negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        rest => (false, rest),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0_i64;
    for b in digits {
        let digit = b.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = value * 10 + i64::from(digit);
    }
    Some(if negative { -value } else { value })
}

/// What is known of a satellite from the epoch before.
#[derive(Debug, Clone, Default)]
struct Track {
    /// Epoch in which it was last seen, counted from 1; 0 never.
    seen: usize,
    arcs: Vec<Arc>,
    flags: Vec<u8>,
}

/// Memory of the reader.
struct State {
    epoch: Vec<u8>,
    clock: Arc,
    tracks: Vec<Track>,
    /// Epochs since the file began.
    count: usize,
    /// Epochs before this one are forgotten: the file started anew.
    since: usize,
}

pub(super) fn read(mut lines: Lines<'_>, kind: Kind, heading: &Heading, o: &mut Observations) {
    let tracks = vec![Track::default(); Constellation::ALL.len() * 100];
    let mut state = State { epoch: Vec::new(), clock: Arc::default(), tracks, count: 1, since: 1 };
    // Lines without a beginning: their number, and the first of them.
    let (mut waiting, mut since) = (0_usize, 0_usize);
    // Whether the epoch before this line ended right before it.
    let mut follows = false;
    while let Some(line) = lines.next() {
        let starts = line.first() == Some(&if kind == Kind::First { b'&' } else { b'>' });
        if starts {
            lost(&mut waiting, since, o);
            state.epoch.clear();
            state.since = state.count;
        } else if state.epoch.is_empty() {
            // Lost, or never begun: wait for a fresh start.
            if waiting == 0 {
                since = lines.number;
            }
            waiting += usize::from(!line.trim_ascii().is_empty());
            continue;
        }
        if line.trim_ascii().is_empty() && lines.rest().is_empty() {
            break;
        }
        change(&mut state.epoch, line);
        if starts && kind == Kind::First {
            state.epoch[0] = b' ';
        }
        let head = if kind == Kind::First { Head::second(&state.epoch, heading.time) } else { Head::third(&state.epoch, heading.time) };
        let n_before = o.n_epochs();
        let outcome = head.and_then(|mut head| {
            if head.observes() {
                epoch(&mut lines, kind, &mut head, &mut state, heading, o)
            } else {
                event(&mut lines, &head, head.count, o);
                Ok(())
            }
        });
        if let Err(reason) = outcome {
            o.lose(lines.number, &format!("{reason}; everything up to the next fresh start is lost"), &state.epoch);
            o.abandon_epoch();
            state.epoch.clear();
            if follows && reason != ENDS {
                // With a line too many or too few in it, its satellites have each other's numbers.
                o.take_back_epoch();
                o.lose(lines.number, "what follows is no epoch, so the one before it was left out as well", b"");
            }
        }
        follows = o.n_epochs() > n_before;
    }
    lost(&mut waiting, since, o);
}

/// Count lines that belong to no epoch whose beginning was read.
fn lost(waiting: &mut usize, since: usize, o: &mut Observations) {
    if *waiting > 0 {
        o.lose(since, &format!("{waiting} lines before a fresh start, which nothing explains"), b"");
        *waiting = 0;
    }
}

/// Characters that changed: blank stays, `&` becomes blank.
fn change(text: &mut Vec<u8>, line: &[u8]) {
    for (k, b) in line.iter().enumerate() {
        let new = match b {
            b' ' => None,
            b'&' => Some(b' '),
            other => Some(*other),
        };
        match (text.get_mut(k), new) {
            (Some(old), Some(new)) => *old = new,
            (Some(_), None) => {}
            (None, new) => text.push(new.unwrap_or(b' ')),
        }
    }
}

fn epoch(
    lines: &mut Lines<'_>,
    kind: Kind,
    head: &mut Head,
    state: &mut State,
    heading: &Heading,
    o: &mut Observations,
) -> Result<(), &'static str> {
    let (first, unit) = if kind == Kind::First { (32, 1e9) } else { (41, 1e12) };
    let clock = lines.next().ok_or(ENDS)?.trim_ascii();
    head.clock_offset_s = f64::NAN;
    if clock.is_empty() {
        state.clock.alive = false;
    } else {
        head.clock_offset_s = state.clock.next(clock).ok_or("the clock offset is not a number")? as f64 / unit;
    }
    state.count += 1;
    for k in 0..head.count {
        let name = columns(&state.epoch, first + 3 * k, first + 3 * k + 3);
        let line = lines.next().ok_or(ENDS)?;
        match satellite(name, heading.system) {
            Ok(satellite) => {
                let track = &mut state.tracks[satellite.constellation.index() * 100 + usize::from(satellite.number)];
                // Seen in the epoch before, and after the last fresh start?
                if track.seen + 1 != state.count || track.seen <= state.since {
                    track.flags.clear();
                    track.arcs.clear();
                }
                track.seen = state.count;
                data(line, satellite, track, lines.number, o);
            }
            Err(letter) => unread(letter, name, lines.number, o),
        }
    }
    if let Some(time) = head.time {
        o.end_epoch(time, head.flag == 1, head.clock_offset_s, lines.number);
    }
    Ok(())
}

/// Fields separated by single blanks, then the changes of the indicators.
fn data(line: &[u8], satellite: SatelliteId, track: &mut Track, number: usize, o: &mut Observations) {
    o.begin_satellite(satellite);
    let n = o.n_codes(satellite.constellation);
    track.arcs.resize(n, Arc::default());
    let first_value = o.value.len();
    let mut rest = line;
    for (k, arc) in track.arcs.iter_mut().enumerate() {
        // Fields are short: a plain loop beats a search.
        let end = rest.iter().position(|b| *b == b' ').unwrap_or(rest.len());
        let field = &rest[..end];
        rest = rest.get(end + 1..).unwrap_or_default();
        let value = if field.is_empty() { None } else { arc.next(field) };
        arc.alive = value.is_some();
        if value.is_none() && !field.is_empty() {
            o.refuse(number, &format!("observation {}", k + 1), "not a difference of a number that was there before", field);
        }
        o.push(value.map_or(f64::NAN, |v| v as f64 / 1000.0), 0);
    }
    change(&mut track.flags, rest);
    for (k, pair) in track.flags.chunks(2).take(n).enumerate() {
        match indicators(pair[0], pair.get(1).copied().unwrap_or(b' ')) {
            Some(indicator) => o.indicator[first_value + k] = indicator,
            None => o.refuse(number, &format!("indicators {}", k + 1), "not digits", pair),
        }
    }
}
