//! The records of one track that wait for their turn.

use crate::codec::{Damaged, Reader, Writer};
use crate::position::Position;
use navbound_core::quantity::GpsTime;

/// Records of a track that wait at most; beyond them the earliest is released.
pub(crate) const MOST_WAITING: usize = 8;

/// A record and its arrival.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arrived {
    pub(crate) position: Position,
    pub(crate) arrival: Option<GpsTime>,
}

/// What became of a record that was put in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Put {
    Last,
    Before,
    Repeated,
}

/// Records in the order of their times; those of one time in the order in which they came.
#[derive(Debug, Clone, Default)]
pub(crate) struct Waiting(Vec<Arrived>);

impl Waiting {
    pub(crate) fn put(&mut self, arrived: Arrived) -> Put {
        if self.0.iter().any(|other| other.position.same_as(&arrived.position)) {
            return Put::Repeated;
        }
        let place = self.0.partition_point(|other| other.position.time <= arrived.position.time);
        self.0.insert(place, arrived);
        if place + 1 == self.0.len() { Put::Last } else { Put::Before }
    }

    /// Time of the earliest.
    pub(crate) fn first(&self) -> Option<GpsTime> {
        self.0.first().map(|arrived| arrived.position.time)
    }

    /// The earliest, where its turn has come: the watermark has reached it, it is the one that follows in a row of
    /// exact periods, or too many wait.
    pub(crate) fn due(&mut self, watermark: GpsTime, next: Option<GpsTime>) -> Option<Arrived> {
        let first = self.first()?;
        let released = first <= watermark || next == Some(first) || self.0.len() > MOST_WAITING;
        released.then(|| self.0.remove(0))
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        to.u8(self.0.len() as u8);
        for arrived in &self.0 {
            arrived.position.write(to);
            to.option(arrived.arrival, |to, time| to.i64(time.nanoseconds()));
        }
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let n = usize::from(from.u8()?);
        if n > MOST_WAITING {
            return Err(Damaged("more records wait than a track keeps"));
        }
        let mut waiting = Vec::with_capacity(n);
        for _ in 0..n {
            let (position, arrival) = (Position::read(from)?, from.option(Reader::i64)?.map(GpsTime::from_nanoseconds));
            waiting.push(Arrived { position, arrival });
        }
        Ok(Self(waiting))
    }
}
