//! Observations to a log of u-blox RXM-RAWX frames, as the reader of [`super::ubx`] takes them.
//!
//! Source: u-blox F9 HPG 1.50 interface description, UBX-RXM-RAWX version 1; standard.

use super::table::{HALF_CYCLE, LOST};
use super::ubx::{RAWX, satellite, signal_of};
use crate::rinex::Observations;
use crate::stream::ubx::frame;
use navbound_core::quantity::OutOfDomain;
use navbound_core::signal::{Constellation, SatelliteId};
use std::collections::BTreeMap;

const WEEK_NS: i64 = 604_800_000_000_000;
/// Time of lock at which the receiver stops counting \[ms\].
const LONGEST_LOCK_MS: i64 = 64_500;
/// Measurements that the count of one frame holds.
const MOST: usize = 255;
/// `recStat`: leap seconds known; version of the message.
const LEAP_KNOWN: u8 = 1;
const VERSION: u8 = 1;
/// `trkStat`: pseudorange valid, phase valid, half cycle resolved.
const RANGE_VALID: u8 = 0b001;
const PHASE_VALID: u8 = 0b010;
const HALF_RESOLVED: u8 = 0b100;

/// System and number of a satellite, and the number of a signal, as UBX names them: those that the reader translates back.
fn names(of: SatelliteId, signal: [u8; 2]) -> Option<(u8, u8, u8)> {
    let (system, number) = (0..8_u8).flat_map(|s| (1..=255_u8).map(move |n| (s, n))).find(|(s, n)| satellite(*s, *n) == Some(of))?;
    let signal = (0..16_u8).find(|k| signal_of(system, *k) == Some(signal))?;
    Some((system, number, signal))
}

/// A log of RXM-RAWX frames, one an epoch, and how many signals it has no name for. Ranges and phases are written as they are, Doppler in
/// single precision, strengths in whole dB-Hz.
///
/// # Errors
/// [`OutOfDomain`] where there is no epoch, for more than 255 signals in one, and for a time before 1980.
pub fn rawx_log(o: &Observations, leap_seconds: i8) -> Result<(Vec<u8>, usize), OutOfDomain> {
    if o.n_epochs() == 0 {
        return Err(OutOfDomain { argument: "observations", value: 0.0, unit: "epochs", domain: "one epoch at least" });
    }
    let (mut log, mut left_out, mut lock) = (Vec::new(), 0, Lock::default());
    for epoch in 0..o.n_epochs() {
        let mut signals = Vec::new();
        for k in o.satellites(epoch) {
            for signal in signals_of(o, o.satellite[k].constellation) {
                match names(o.satellite[k], signal) {
                    Some(name) => signals.extend(measurement(o, (epoch, k), signal, name, &mut lock)),
                    None => left_out += 1,
                }
            }
        }
        log.extend(frame(RAWX, &payload(o, epoch, &signals, leap_seconds)?));
    }
    Ok((log, left_out))
}

fn payload(o: &Observations, epoch: usize, signals: &[[u8; 32]], leap_seconds: i8) -> Result<Vec<u8>, OutOfDomain> {
    let count = u8::try_from(signals.len()).map_err(|_| OutOfDomain {
        argument: "signals",
        value: signals.len() as f64,
        unit: "1",
        domain: "at most 255 in an epoch",
    })?;
    debug_assert!(signals.len() <= MOST);
    let ns = o.time[epoch].nanoseconds();
    let week = u16::try_from(ns.div_euclid(WEEK_NS)).ok().filter(|w| *w > 0);
    let week = week.ok_or(OutOfDomain { argument: "time_ns", value: ns as f64, unit: "ns", domain: "a week from 1 to 65535" })?;
    let mut payload = (ns.rem_euclid(WEEK_NS) as f64 * 1e-9).to_le_bytes().to_vec();
    payload.extend(week.to_le_bytes());
    payload.extend([leap_seconds.to_le_bytes()[0], count, LEAP_KNOWN, VERSION, 0, 0]);
    payload.extend(signals.iter().flatten());
    Ok(payload)
}

/// Band and attribute of the signals of a constellation.
fn signals_of(o: &Observations, constellation: Constellation) -> Vec<[u8; 2]> {
    let mut signals: Vec<[u8; 2]> = o.codes[constellation.index()].iter().map(|c| [c[1], c[2]]).collect();
    signals.sort_unstable();
    signals.dedup();
    signals
}

/// Since when each signal has been locked \[ns\].
type Lock = BTreeMap<(SatelliteId, [u8; 2]), i64>;

fn measurement(
    o: &Observations,
    (epoch, k): (usize, usize),
    signal: [u8; 2],
    (system, number, identifier): (u8, u8, u8),
    lock: &mut Lock,
) -> Option<[u8; 32]> {
    let constellation = o.satellite[k].constellation;
    let at = |kind: u8| o.column(constellation, &[kind, signal[0], signal[1]]);
    let value = |kind: u8| at(kind).map_or(f64::NAN, |c| o.values(k)[c]);
    let (range, phase, doppler, cn0) = (value(b'C'), value(b'L'), value(b'D'), value(b'S'));
    if range.is_nan() && phase.is_nan() {
        return None;
    }
    let indicator = at(b'L').map_or(0, |c| o.indicator[o.value_range(k).start + c]);
    let now = o.time[epoch].nanoseconds();
    let since = lock.entry((o.satellite[k], signal)).or_insert(now - 1_000_000);
    if indicator & LOST != 0 {
        *since = now;
    }
    let locked_ms = ((now - *since) / 1_000_000).min(LONGEST_LOCK_MS);
    let flag = |on: bool, bit: u8| if on { bit } else { 0 };
    let status = flag(!range.is_nan(), RANGE_VALID) | flag(!phase.is_nan(), PHASE_VALID) | flag(indicator & HALF_CYCLE == 0, HALF_RESOLVED);
    let mut m = [0; 32];
    let zero = |v: f64| if v.is_nan() { 0.0 } else { v };
    m[..8].copy_from_slice(&zero(range).to_le_bytes());
    m[8..16].copy_from_slice(&zero(phase).to_le_bytes());
    m[16..20].copy_from_slice(&(doppler as f32).to_le_bytes());
    m[20..23].copy_from_slice(&[system, number, identifier]);
    m[24..26].copy_from_slice(&(locked_ms as u16).to_le_bytes());
    m[26] = zero(cn0).round() as u8;
    m[30] = status;
    Some(m)
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use super::*;
    use navbound_core::quantity::GpsTime;
    use proptest::prelude::*;

    fn log(rows: &[(u8, f64, f64, f64, bool)]) -> Observations {
        let mut o = Observations::default();
        o.codes[0] = [*b"C1C", *b"L1C", *b"D1C", *b"S1C"].to_vec();
        o.codes[2] = [*b"C5Q", *b"L5Q", *b"D5Q", *b"S5Q"].to_vec();
        for (n, (number, range, doppler, cn0, lost)) in rows.iter().enumerate() {
            let time = GpsTime::from_nanoseconds(2303 * WEEK_NS + n as i64 * 1_000_000_000);
            let indicator = if *lost { LOST } else { 0 };
            let values = vec![(*range, 0), (5.0 * range, indicator), (*doppler, 0), (cn0.round(), 0)];
            let gps = SatelliteId { constellation: Constellation::Gps, number: *number };
            let galileo = SatelliteId { constellation: Constellation::Galileo, number: *number };
            o.add_epoch(time, &[(gps, values.clone()), (galileo, values)]).unwrap();
        }
        o
    }

    proptest! {
        // Ranges and phases are doubles: the same bits. Doppler is single: half a unit of its last place, 6e-8 of the value.
        #[test]
        fn measurements_come_back(rows in proptest::collection::vec(
            (1_u8..32, 1.9e7..4e7_f64, -5000.0..5000.0_f64, 20.0..55.0_f64, any::<bool>()), 1..12)) {
            let o = log(&rows);
            let (bytes, left_out) = rawx_log(&o, 18).unwrap();
            prop_assert_eq!(left_out, 0);
            let back = read(&bytes).unwrap().observations;
            prop_assert_eq!((back.n_refused, &back.time, &back.satellite, &back.codes), (0, &o.time, &o.satellite, &o.codes));
            for k in 0..o.satellite.len() {
                let (a, b) = (o.values(k), back.values(k));
                prop_assert_eq!((a[0], a[1], a[3]), (b[0], b[1], b[3]));
                prop_assert!((a[2] - b[2]).abs() <= 6e-8 * a[2].abs());
            }
            // The flag of the phase, wherever it was set.
            for (a, b) in o.indicator.iter().zip(&back.indicator) {
                prop_assert!(a & LOST == 0 || b & LOST != 0);
            }
        }
    }

    #[test]
    fn a_signal_without_a_name_is_counted() {
        let mut o = Observations::default();
        o.codes[0] = vec![*b"C1W"];
        let gps = SatelliteId { constellation: Constellation::Gps, number: 1 };
        o.add_epoch(GpsTime::from_nanoseconds(WEEK_NS), &[(gps, vec![(2e7, 0)])]).unwrap();
        assert_eq!(rawx_log(&o, 18).unwrap().1, 1);
        assert_eq!(rawx_log(&Observations::default(), 18).unwrap_err().argument, "observations");
    }
}
