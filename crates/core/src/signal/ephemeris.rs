//! What a satellite broadcasts of its orbit, clock and health.
//!
//! Source: IS-GPS-200 20.3.3.3 and 20.3.3.4, Galileo OS SIS ICD 5.1, BDS-SIS-ICD-B1I 5.2 and 5.3, RTCA DO-229 appendix A.4.4.11 (GEO);
//! provenance: standard. Field names follow those documents in words.

use super::{Carrier, Constellation, SPEED_OF_LIGHT_MPS, SatelliteId};
use crate::quantity::GpsTime;

/// The navigation message a record came from; clocks and group delays of two messages do not mix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Message {
    /// GPS legacy message.
    Lnav,
    /// Galileo integrity message: clock of E1 and E5b.
    Inav,
    /// Galileo freely accessible message: clock of E1 and E5a.
    Fnav,
    /// BeiDou message of medium and inclined satellites: clock of B3I.
    D1,
    /// BeiDou message of geostationary satellites.
    D2,
}

impl Message {
    /// The name RINEX 4 gives it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lnav => "LNAV",
            Self::Inav => "INAV",
            Self::Fnav => "FNAV",
            Self::D1 => "D1",
            Self::D2 => "D2",
        }
    }
}

/// Whether the satellite says it may be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Health {
    /// The word as RINEX carries it: GPS 6 bits, Galileo 9 bits, BeiDou SatH1.
    pub word: u16,
}

/// Keplerian broadcast record of a GPS, Galileo or BeiDou satellite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ephemeris {
    /// Whose.
    pub satellite: SatelliteId,
    /// From which message.
    pub message: Message,
    /// Reference time of the clock (toc).
    pub clock_time: GpsTime,
    /// Clock bias \[s\], drift \[s/s\], drift rate \[s/s²\] (af0, af1, af2).
    pub clock: [f64; 3],
    /// Reference time of the orbit (toe).
    pub orbit_time: GpsTime,
    /// When the message was sent, where the file says so.
    pub sent: Option<GpsTime>,
    /// Issue of data of the orbit: IODE, IODnav or AODE.
    pub issue_orbit: u16,
    /// Issue of data of the clock: IODC (GPS) or AODC (BeiDou); Galileo's single issue.
    pub issue_clock: u16,
    /// Square root of the semi-major axis \[sqrt(m)\].
    pub sqrt_a: f64,
    /// Eccentricity.
    pub eccentricity: f64,
    /// Inclination at the reference time \[rad\], and its rate \[rad/s\].
    pub inclination: [f64; 2],
    /// Longitude of the ascending node at the start of the week \[rad\], and rate of right ascension \[rad/s\].
    pub node: [f64; 2],
    /// Argument of perigee \[rad\].
    pub perigee: f64,
    /// Mean anomaly at the reference time \[rad\].
    pub mean_anomaly: f64,
    /// Correction of the mean motion \[rad/s\].
    pub delta_n: f64,
    /// Harmonic corrections of the argument of latitude \[rad\]: cosine, sine (cuc, cus).
    pub latitude_harmonics: [f64; 2],
    /// Of the radius \[m\] (crc, crs).
    pub radius_harmonics: [f64; 2],
    /// Of the inclination \[rad\] (cic, cis).
    pub inclination_harmonics: [f64; 2],
    /// Stated accuracy of the range \[m\] (URA, SISA); negative where the message says "no prediction".
    pub accuracy_m: f64,
    /// Health word.
    pub health: Health,
    /// Group delays \[s\]: GPS TGD; Galileo BGD E5a/E1, E5b/E1; BeiDou TGD1, TGD2.
    pub group_delay_s: [f64; 2],
    /// Fit interval \[s\], around the reference time.
    pub fit_interval_s: f64,
}

/// Accuracy from which none is predicted \[m\]: the upper end of index 14. Provenance: standard.
const LEAST_UNPREDICTED_M: f64 = 6144.0;

impl Ephemeris {
    /// May be used for ranging on this carrier, as far as the satellite itself says.
    ///
    /// GPS: health word 0. BeiDou: SatH1 0. Galileo: data valid and signal healthy on the carriers the message serves; I/NAV does not state
    /// the health of E5a, so that its word never forbids E5a.
    pub const fn healthy(&self, carrier: Carrier) -> bool {
        let word = self.health.word;
        match self.satellite.constellation {
            Constellation::Galileo => {
                // Bits 0-2: E1-B data validity and signal health; 3-5: E5a; 6-8: E5b (RINEX 4.00, table A8).
                let mask = match carrier {
                    Carrier::L5 => 0b000_111_000,
                    Carrier::E5b => 0b111_000_000,
                    _ => 0b000_000_111,
                };
                // A word that never left one message has only its own bits set.
                word & mask == 0
            }
            _ => word == 0,
        }
    }

    /// Predicts its accuracy: GPS without one says 8192 m or more than 6144 m (IS-GPS-200 20.3.3.3.1.3, index 15), Galileo less than nothing.
    pub const fn predicts_accuracy(&self) -> bool {
        self.accuracy_m >= 0.0 && self.accuracy_m < LEAST_UNPREDICTED_M
    }

    /// May be counted on before its signals are heard: healthy on every carrier that the record speaks of, with a predicted accuracy.
    pub const fn is_promised(&self) -> bool {
        self.health.word == 0 && self.predicts_accuracy()
    }

    /// Group delay to subtract from the broadcast clock for a user of one carrier \[s\]; `None` where the message does not serve it.
    ///
    /// ```text
    /// GPS      L1: TGD      L2: (f1/f2)^2 TGD                    IS-GPS-200 20.3.3.3.3.2
    /// Galileo  E1: BGD(E1,E5b) of I/NAV, BGD(E1,E5a) of F/NAV; E5: (f1/f5)^2 of the same   OS SIS ICD 5.1.5
    ///          E5a with I/NAV: BGD(E1,E5b) + ((f1/f5a)^2 - 1) BGD(E1,E5a), so that
    ///          clock(E1,E5a) = clock(E1,E5b) + BGD(E1,E5a) - BGD(E1,E5b): both give one clock of E1       re-derived
    /// BeiDou   B1I: TGD1    B2I: TGD2    B3I: 0                  BDS-SIS-ICD-B1I 5.2.4.10
    /// ```
    pub fn group_delay(&self, carrier: Carrier) -> Option<f64> {
        let [first, second] = self.group_delay_s;
        let scaled = |delay: f64| {
            let ratio = Carrier::L1.frequency_hz() / carrier.frequency_hz();
            Some(ratio * ratio * delay)
        };
        match (self.message, carrier) {
            (Message::Lnav, Carrier::L1 | Carrier::L2) | (Message::Fnav, Carrier::L1 | Carrier::L5) => scaled(first),
            (Message::Inav, Carrier::L1 | Carrier::E5b) => scaled(second),
            (Message::Inav, Carrier::L5) => Some(second + scaled(first)? - first),
            (Message::D1 | Message::D2, Carrier::B1I) => Some(first),
            (Message::D1 | Message::D2, Carrier::E5b) => Some(second),
            (Message::D1 | Message::D2, Carrier::B3I) => Some(0.0),
            _ => None,
        }
    }

    /// May be used at this time: within half the fit interval of the reference time.
    pub fn covers(&self, time: GpsTime) -> bool {
        time.seconds_since(self.orbit_time).abs() <= 0.5 * self.fit_interval_s
    }
}

/// Where the record stands whose reference time is nearest, among those that cover the time; `None` when none does. Records sorted by
/// reference time. Of two equally near, the earlier.
pub fn nearest(records: &[Ephemeris], time: GpsTime) -> Option<usize> {
    let after = records.partition_point(|r| r.orbit_time <= time);
    let gap = |k: &usize| (records[*k].orbit_time.nanoseconds() - time.nanoseconds()).unsigned_abs();
    let neighbours = [after.checked_sub(1), Some(after).filter(|k| *k < records.len())];
    neighbours.into_iter().flatten().filter(|k| records[*k].covers(time)).min_by_key(gap)
}

/// Broadcast state of a geostationary augmentation satellite, in Earth-fixed axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeoEphemeris {
    /// Whose.
    pub satellite: SatelliteId,
    /// Reference time.
    pub time: GpsTime,
    /// Clock offset \[s\] and drift \[s/s\] against SBAS network time.
    pub clock: [f64; 2],
    /// Position \[m\].
    pub position_m: [f64; 3],
    /// Velocity \[m/s\].
    pub velocity_mps: [f64; 3],
    /// Acceleration \[m/s²\].
    pub acceleration_mps2: [f64; 3],
    /// Stated accuracy (URA) \[m\]; what the file carries, which differs between writers.
    pub accuracy_m: f64,
    /// Health word, 0 good.
    pub health: Health,
    /// Issue of data.
    pub issue: u16,
}

/// Coefficients of the broadcast single-frequency ionosphere of GPS or BeiDou.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Klobuchar {
    /// Amplitude: \[s\], \[s/semicircle\], \[s/semicircle²\], \[s/semicircle³\].
    pub alpha: [f64; 4],
    /// Period, likewise.
    pub beta: [f64; 4],
}

/// Largest size of each coefficient that eight bits with its scale hold (IS-GPS-200 table 20-X). Standard.
const MOST_ALPHA: [f64; 4] = [128.0 / 1_073_741_824.0, 128.0 / 134_217_728.0, 128.0 / 16_777_216.0, 128.0 / 16_777_216.0];
/// The same of the period.
const MOST_BETA: [f64; 4] = [128.0 * 2048.0, 128.0 * 16_384.0, 128.0 * 65_536.0, 128.0 * 65_536.0];
/// Largest daily delay overhead that a message of any day states somewhere on the Earth \[m\]: below is a third of the least one seen (1.6 m
/// at 47 sfu), above is what the climatology reaches at 500 sfu (0.04 m/sfu), twice the strongest sun of a century of monthly means. Ours.
const ACTIVITY_M: (f64, f64) = (0.5, 20.0);

impl Klobuchar {
    /// Largest daily delay overhead that the message states anywhere \[m\]; NaN where a coefficient is.
    ///
    /// ```text
    /// activity = c max over |phi_m| <= 0.3 semicircles of sum alpha_n phi_m^n       IS-GPS-200 20.3.3.5.2.5; derived
    /// ```
    pub fn activity_m(&self) -> f64 {
        let amplitude = |step: i32| {
            let phi = 0.01 * f64::from(step);
            let [a, b, c, d] = self.alpha;
            a + phi * (b + phi * (c + phi * d))
        };
        if self.alpha.iter().chain(&self.beta).any(|value| value.is_nan()) {
            return f64::NAN;
        }
        SPEED_OF_LIGHT_MPS * (-30..=30).map(amplitude).fold(0.0, f64::max)
    }

    /// Whether every coefficient is zero: a field without content.
    pub fn is_empty(&self) -> bool {
        self.alpha == [0.0; 4]
    }

    /// Why no satellite sends these coefficients on any day; `None` where one may.
    pub fn implausible(&self) -> Option<&'static str> {
        let within = |values: &[f64; 4], most: &[f64; 4]| values.iter().zip(most).all(|(value, most)| value.abs() <= *most);
        if !within(&self.alpha, &MOST_ALPHA) || !within(&self.beta, &MOST_BETA) {
            return Some("a coefficient is larger than its eight bits can hold; the message counts as missing");
        }
        let activity_m = self.activity_m();
        if activity_m >= ACTIVITY_M.0 && activity_m <= ACTIVITY_M.1 {
            return None;
        }
        Some("its largest delay overhead is outside [0.5, 20] m, which no sun makes; the message counts as missing")
    }
}
