//! Positions of a receiver as reports, and the state of their decoder as bytes.

use super::Decoded;
use super::keys::Names;
use crate::codec::{Damaged, Reader, Writer};
use crate::counters::Refused;
use crate::position::{Position, Shown, TrackId};
use navbound_core::quantity::{Reason, Status};
use navbound_formats::receiver::position::{Dated, Datum, Decoder, Ends, Heard, Item, Kind, MOST_MESSAGES, Message, Near, OfDay, State};

/// A report, or why there is none; nothing for a date or a datum.
pub(super) fn decoded(item: Item, track: TrackId, against: &mut Names) -> Option<Decoded> {
    match item {
        Item::Dated(_) | Item::Datum(_) => None,
        Item::Unpaired(_) => Some(Err(Refused::AccuracyAlone)),
        Item::Malformed(malformed) => {
            against.count(malformed.reason);
            Some(Err(Refused::ShortMessage))
        }
        Item::Position(position) => {
            let Some(time) = position.time else { return Some(Err(Refused::Undated)) };
            let usable = position.absent.is_none();
            position.absent.iter().for_each(|absent| against.count(&absent.stated));
            Some(Ok(Position {
                lat_rad: position.lat_rad,
                lon_rad: position.lon_rad,
                h_m: position.h_m,
                ground_speed_mps: position.ground_speed_mps,
                ground_track_rad: position.ground_track_rad,
                covariance_m2: position.covariance_m2,
                hpl_m: position.hpl_m,
                status: if usable { Status::Ok } else { Status::NotAvailable },
                reason: (!usable).then_some(Reason::Reported),
                shown: Shown { n_sv: position.n_sv.map(f64::from), ..Shown::default() },
                ..Position::new(track, time)
            }))
        }
    }
}

pub(super) fn write(decoder: &Decoder, to: &mut Writer) {
    let (state, Heard { dated, datum, gga, near, against, loose_m }) = decoder.state();
    to.option(state.key, Writer::i64);
    to.u32(state.messages.len() as u32);
    for message in &state.messages {
        to.u32(message.kind);
        to.u64(message.record);
        to.bytes(&message.body);
    }
    to.u32(state.newest);
    to.u32(state.last);
    to.option(state.finished, Writer::i64);
    to.flag(state.waits);
    to.option(*dated, |to, Dated { year, month, day, of_day: OfDay(of_day_ns) }| {
        to.i64(i64::from(year));
        to.u8(month);
        to.u8(day);
        to.i64(of_day_ns);
    });
    for stated in [&datum.of_epoch, &datum.newest] {
        to.option(stated.as_deref(), |to, stated| to.bytes(stated.as_bytes()));
    }
    datum.talker.iter().for_each(|byte| to.u8(*byte));
    to.flag(*gga);
    to.option(*near, |to, Near { place: (lat_rad, lon_rad), of_day: OfDay(of_day_ns) }| {
        to.f64(lat_rad);
        to.f64(lon_rad);
        to.i64(of_day_ns);
    });
    to.option(against.as_deref(), |to, stated| to.bytes(stated.as_bytes()));
    to.option(*loose_m, Writer::f64);
}

fn stated(from: &mut Reader<'_>) -> Result<Option<String>, Damaged> {
    from.option(|from| from.bytes().and_then(|text| core::str::from_utf8(text).map(str::to_owned).map_err(|_| Damaged("not a text"))))
}

pub(super) fn read(kind: Kind, from: &mut Reader<'_>) -> Result<Decoder, Damaged> {
    let (key, n) = (from.option(Reader::i64)?, from.u32()?);
    if n as usize > MOST_MESSAGES {
        return Err(Damaged("more messages than an epoch has"));
    }
    let messages = (0..n).map(|_| Ok(Message { kind: from.u32()?, record: from.u64()?, body: from.bytes()?.to_vec() }));
    let messages = messages.collect::<Result<_, _>>()?;
    let (newest, last, finished, waits) = (from.u32()?, from.u32()?, from.option(Reader::i64)?, from.flag()?);
    let state = State { key, messages, newest, last, finished, waits };
    let dated = from.option(|from| {
        let (year, month, day) = (i32::try_from(from.i64()?).map_err(|_| Damaged("not a year"))?, from.u8()?, from.u8()?);
        Ok(Dated { year, month, day, of_day: OfDay(from.i64()?) })
    })?;
    let (of_epoch, newest) = (stated(from)?, stated(from)?);
    let datum = Datum { of_epoch, newest, talker: [from.u8()?, from.u8()?] };
    let gga = from.flag()?;
    let near = from.option(|from| Ok(Near { place: (from.f64()?, from.f64()?), of_day: OfDay(from.i64()?) }))?;
    let (against, loose_m) = (stated(from)?, from.option(Reader::f64)?);
    Ok(Decoder::with_state(kind, Ends::WithLast, state, Heard { dated, datum, gga, near, against, loose_m }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use navbound_formats::stream::Frame;

    #[test]
    fn statements_that_hold_beyond_their_epoch_are_written_down() {
        let mut decoder = Decoder::new(Kind::Nmea, Ends::WithLast);
        for body in [
            "GPGGA,120000.00,4900.0,N,00230.0,E,1,08,1.0,100.0,M,47.0,M,,",
            "GPRMC,120000.50,A,4910.0,N,00230.0,E,1.0,0.0,221126,,,A",
            "GPGST,120000.70,1.0,,,,2.0,3.0,4.0",
            "GPGLL,4900.0,N,00230.0,E,120000.80,A,A",
            "GPGGA,,,,,,0",
            "GPRMC,120000.00,A,4900.0,N,00230.0,E,1.0,0.0,221126,,,A",
            "GPDTM,NAD27,,,,,,,W84",
            "GPDTM,W84,,,,,,,W84",
        ] {
            decoder.take(&Frame::Nmea(body.as_bytes()), 0, &mut Vec::new());
            let mut to = Writer::default();
            write(&decoder, &mut to);
            let mut from = Reader(&to.0);
            let again = read(Kind::Nmea, &mut from).unwrap();
            from.finish().unwrap();
            assert_eq!(again.state(), decoder.state(), "{body}");
        }
        let heard = decoder.state().1;
        assert!(heard.dated.is_some() && heard.datum.of_epoch.is_some() && heard.datum.newest.is_none() && heard.gga);
    }
}
