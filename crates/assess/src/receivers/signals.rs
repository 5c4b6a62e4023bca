//! Which pseudoranges make a range, and which navigation messages have a clock for them.

use navbound_core::signal::{Carrier, Constellation, Message};
use navbound_formats::rinex::Observations;

/// Which pseudoranges make a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signals {
    /// One: L1, E1, B1I.
    Single,
    /// An ionosphere-free pair: L1 and L2, E1 and E5a or E5b, B1I and B3I or B2I.
    Dual,
}

/// Signals that may make a constellation's ranges.
#[derive(Debug)]
pub struct Choice {
    /// Name in tables.
    pub name: &'static str,
    /// Band digits of RINEX, each with the attributes of codes in order of preference.
    bands: &'static [(u8, &'static [u8])],
    /// Messages by preference.
    pub(super) messages: &'static [Message],
    /// Of these the first so many have the clock of these very signals; the others get there by group delays.
    pub(super) own_clock: usize,
}

const LNAV: &[Message] = &[Message::Lnav];
const BEIDOU: &[Message] = &[Message::D1, Message::D2];
/// What most receivers track, then combined and encrypted forms.
const GPS_L1: &[u8] = b"CWPXLSY";
const E1: &[u8] = b"CXBZA";
const B1I: (u8, &[u8]) = (b'2', b"IXQ");
/// The clock of LNAV is that of L1 P(Y) and L2 P(Y) (IS-GPS-200 20.3.3.3.3.2). C/A differs from P(Y) by a constant of the satellite, up
/// to 0.7 m, that only CNAV broadcasts and the pair multiplies by 2.5: codes of the clock first.
const GPS_PAIR: &[(u8, &[u8])] = &[(b'1', b"PWYCXLS"), (b'2', b"PWYLXSC")];

/// What may make a constellation's ranges, by preference; nothing for a constellation that is not used. L1 and L5 of GPS would need the
/// inter-signal corrections of CNAV, which is not read.
const fn choices(constellation: Constellation, signals: Signals) -> &'static [Choice] {
    match (constellation, signals) {
        (Constellation::Gps, Signals::Single) => &[Choice { name: "L1", bands: &[(b'1', GPS_L1)], messages: LNAV, own_clock: 1 }],
        (Constellation::Gps, Signals::Dual) => &[Choice { name: "L1-L2", bands: GPS_PAIR, messages: LNAV, own_clock: 1 }],
        (Constellation::Galileo, Signals::Single) => {
            &[Choice { name: "E1", bands: &[(b'1', E1)], messages: &[Message::Inav, Message::Fnav], own_clock: 2 }]
        }
        (Constellation::Galileo, Signals::Dual) => &[
            Choice { name: "E1-E5a", bands: &[(b'1', E1), (b'5', b"QXI")], messages: &[Message::Fnav, Message::Inav], own_clock: 1 },
            Choice { name: "E1-E5b", bands: &[(b'1', E1), (b'7', b"QXI")], messages: &[Message::Inav], own_clock: 1 },
        ],
        (Constellation::BeiDou, Signals::Single) => &[Choice { name: "B1I", bands: &[B1I], messages: BEIDOU, own_clock: 2 }],
        (Constellation::BeiDou, Signals::Dual) => &[
            Choice { name: "B1I-B3I", bands: &[B1I, (b'6', b"IXQ")], messages: BEIDOU, own_clock: 2 },
            Choice { name: "B1I-B2I", bands: &[B1I, (b'7', b"IXQ")], messages: BEIDOU, own_clock: 2 },
        ],
        _ => &[],
    }
}

/// A pseudorange as measured.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measured {
    pub(super) carrier: Carrier,
    pub(super) pseudorange: f64,
    /// Its column.
    pub(super) column: usize,
}

/// One frequency of a constellation: columns of the observation table.
#[derive(Debug, Clone)]
pub(super) struct Band {
    carrier: Option<Carrier>,
    /// Pseudoranges by preference.
    pub(super) codes: Vec<usize>,
    /// Those of the precise code, which the clock of GPS is of.
    pub(super) precise_codes: Vec<usize>,
    /// Pseudorange, Doppler, strength, by how well they are tracked.
    tracked: Vec<(usize, Option<usize>, Option<usize>)>,
}

impl Band {
    fn new(constellation: Constellation, (band, attributes): (u8, &[u8]), observations: &Observations) -> Self {
        let column = |kind, attribute| observations.column(constellation, &[kind, band, attribute]);
        let by = |order: &[u8]| order.iter().filter_map(|a| Some((*a, column(b'C', *a)?))).collect::<Vec<_>>();
        // The strength of an encrypted code says how weakly it is tracked, not how strong the signal is.
        let tracking = if (constellation, band) == (Constellation::Gps, b'1') { GPS_L1 } else { attributes };
        Self {
            carrier: Carrier::from_band(constellation, band),
            codes: by(attributes).into_iter().map(|(_, code)| code).collect(),
            precise_codes: by(b"PWY").into_iter().map(|(_, code)| code).collect(),
            tracked: by(tracking).into_iter().map(|(a, code)| (code, column(b'D', a), column(b'S', a))).collect(),
        }
    }

    /// The first pseudorange that is there.
    pub(super) fn measured(&self, values: &[f64]) -> Option<Measured> {
        let carrier = self.carrier?;
        let at = |column: &usize| values.get(*column).copied().unwrap_or(f64::NAN);
        self.codes.iter().map(|c| Measured { carrier, pseudorange: at(c), column: *c }).find(|m| m.pseudorange > 0.0)
    }

    /// Doppler \[Hz\] and strength \[dB-Hz\] of the code that is tracked best; NaN where the receiver gives none.
    pub(super) fn tracking(&self, values: &[f64]) -> (f64, f64) {
        let at = |column: Option<usize>| column.and_then(|c| values.get(c)).copied().unwrap_or(f64::NAN);
        self.tracked.iter().find(|(code, ..)| at(Some(*code)) > 0.0).map_or((f64::NAN, f64::NAN), |(_, d, s)| (at(*d), at(*s)))
    }
}

/// What a constellation contributes: the same signals for all its satellites and epochs, because the receiver delays two pairs
/// differently and one clock of the constellation cannot take up both.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Which signals.
    pub choice: &'static Choice,
    pub(super) bands: Vec<Band>,
}

impl Plan {
    /// Of each choice that may serve, in the order of preference.
    pub(super) fn all(constellation: Constellation, signals: Signals, observations: &Observations) -> Vec<Self> {
        let plan = |choice: &'static Choice| {
            let bands = choice.bands.iter().map(|(band, attributes)| Band::new(constellation, (*band, attributes), observations));
            Self { choice, bands: bands.collect() }
        };
        choices(constellation, signals).iter().map(plan).collect()
    }

    /// Whether the file has a code of each frequency.
    pub(super) fn is_observed(&self) -> bool {
        self.bands.iter().all(|band| !band.codes.is_empty())
    }

    /// Columns of its pseudoranges.
    pub fn codes(&self) -> impl Iterator<Item = usize> + '_ {
        self.bands.iter().flat_map(|band| band.codes.iter().copied())
    }
}
