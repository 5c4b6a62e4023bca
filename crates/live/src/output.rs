//! What a lane says: one epoch a judged record, one transition an alert that began or ended.

use crate::codec::{Damaged, Reader, Writer};
use crate::position::{TrackId, reason, status};
use navbound_core::monitor::rnp::{self, Acceptance, Alert, Event};
use navbound_core::quantity::{GpsTime, Reason, Status};

/// What an alert is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// The accuracy bound of a track is not within RNP.
    Caution,
    /// Its integrity bound is not within twice RNP.
    Warning,
    /// A track is not monitored.
    Unavailable,
    /// The reader is alive and the source is silent.
    Quiet,
    /// The source's times are out of what its arrivals permit.
    Clock,
    /// A tenth of what arrives is damaged.
    Garbled,
    /// More tracks than are watched.
    FleetFull,
    /// The connection to the source is lost.
    SourceLost,
}

impl Kind {
    /// All, in the order of their codes.
    pub const ALL: [Self; 8] =
        [Self::Caution, Self::Warning, Self::Unavailable, Self::Quiet, Self::Clock, Self::Garbled, Self::FleetFull, Self::SourceLost];

    /// The word of the event table and of keys.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Caution => rnp::Kind::Caution.word(),
            Self::Warning => rnp::Kind::Warning.word(),
            Self::Unavailable => rnp::Kind::Unavailable.word(),
            Self::Quiet => "quiet",
            Self::Clock => "clock",
            Self::Garbled => "garbled",
            Self::FleetFull => "fleet_full",
            Self::SourceLost => "source_lost",
        }
    }

    pub(crate) const fn of(kind: rnp::Kind) -> Self {
        match kind {
            rnp::Kind::Caution => Self::Caution,
            rnp::Kind::Warning => Self::Warning,
            rnp::Kind::Unavailable => Self::Unavailable,
        }
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        Self::ALL.get(usize::from(from.u8()?)).copied().ok_or(Damaged("no such kind of alert"))
    }
}

/// What became of an alert.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Turn {
    /// It began.
    Raised,
    /// It ended.
    Cleared,
    /// Its track was forgotten while it lasted.
    Expired,
}

impl Turn {
    /// All, in the order of their codes.
    pub const ALL: [Self; 3] = [Self::Raised, Self::Cleared, Self::Expired];

    /// The last part of a key.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Raised => "raised",
            Self::Cleared => "cleared",
            Self::Expired => "expired",
        }
    }
}

/// An alert that began or ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// Whose; `None` for an alert of the source itself.
    pub track: Option<TrackId>,
    /// How often the track began anew.
    pub incarnation: u32,
    /// What it is about.
    pub kind: Kind,
    /// What became of it.
    pub turn: Turn,
    /// When the alert was raised, as its raise says: part of the key.
    pub annunciation: GpsTime,
    /// When the condition began.
    pub onset: GpsTime,
    /// When it ended.
    pub clear: Option<GpsTime>,
    /// Largest bound meanwhile \[m\].
    pub peak_m: f64,
    /// The limit where the margin was least \[m\].
    pub limit_m: f64,
    /// Least limit minus bound \[m\].
    pub min_margin_m: f64,
    /// Applicability of the record, or the event time, that decided it.
    pub event: GpsTime,
    /// Arrival of the input that decided it, where it is known.
    pub arrival: Option<GpsTime>,
}

impl Transition {
    /// Unique, and the same whenever the journal is read again.
    pub fn key(&self) -> String {
        let track = self.track.as_ref().map_or("source", TrackId::name);
        let prefix = if self.track.is_some() { "" } else { "feed:" };
        format!("{prefix}{track}/{}/{}/{}/{}", self.incarnation, self.kind.word(), self.annunciation.nanoseconds(), self.turn.word())
    }

    pub(crate) fn with_event(self, event: &Event) -> Self {
        Self {
            onset: event.onset,
            clear: event.clear,
            peak_m: event.peak.m(),
            limit_m: event.limit.m(),
            min_margin_m: event.min_margin.m(),
            ..self
        }
    }
}

/// A record that was judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EpochOut {
    /// Whose.
    pub track: TrackId,
    /// Applicability.
    pub time: GpsTime,
    /// Arrival of its bytes, where it is known.
    pub arrival: Option<GpsTime>,
    /// Whether the position was usable.
    pub status: Status,
    /// Why it was not, or why it has no bound.
    pub reason: Option<Reason>,
    /// Whether the monitor took it.
    pub acceptance: Acceptance,
    /// The alert in force after it.
    pub alert: Alert,
    /// Bound at the accuracy risk, bound at the integrity risk, what was compared with twice RNP, RNP, flight technical error, standard
    /// deviation across the path, horizontal protection level \[m\]; latitude, longitude \[rad\], height \[m\]; then what is shown beside
    /// the judgement: [`NUMBERS`]. NaN where there is none.
    pub numbers: [f64; NUMBERS.len()],
    /// What keeps the position, in the source's word.
    pub nav_mode: Option<TrackId>,
}

/// Names of [`EpochOut::numbers`].
pub const NUMBERS: [&str; 26] = [
    "accuracy_bound_m",
    "integrity_bound_m",
    "integrity_compared_m",
    "rnp_m",
    "fte_m",
    "sigma_cross_m",
    "hpl_m",
    "est_lat_rad",
    "est_lon_rad",
    "est_h_m",
    "fte_v_m",
    "course_rad",
    "cov_ee_m2",
    "cov_en_m2",
    "cov_nn_m2",
    "anp_cross_m",
    "anp_circle_m",
    "anp_vertical_m",
    "vpl_m",
    "hal_m",
    "val_m",
    "n_sv",
    "caution_in_s",
    "nic",
    "nac_p",
    "sil",
];

/// One output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Output {
    /// A record that was judged.
    Epoch(EpochOut),
    /// An alert that began or ended.
    Transition(Transition),
}

const ACCEPTANCES: [Acceptance; 4] = [Acceptance::Accepted, Acceptance::Duplicate, Acceptance::Late, Acceptance::ClockSetBack];
const ALERTS: [Alert; 4] = [Alert::Normal, Alert::Caution, Alert::Warning, Alert::Unavailable];

/// Place in a list of the few values of a type.
fn code<T: PartialEq>(of: &[T], value: &T) -> u8 {
    of.iter().position(|each| each == value).unwrap_or(of.len()) as u8
}

impl Output {
    /// Appends its bytes.
    pub fn append(&self, bytes: &mut Vec<u8>) {
        let mut to = Writer(core::mem::take(bytes));
        self.write(&mut to);
        *bytes = to.0;
    }

    fn write(&self, to: &mut Writer) {
        let optional = |to: &mut Writer, time: Option<GpsTime>| to.option(time, |to, time| to.i64(time.nanoseconds()));
        match self {
            Self::Epoch(e) => {
                to.u8(0);
                e.track.write(to);
                to.i64(e.time.nanoseconds());
                optional(to, e.arrival);
                to.u8(e.status as u8);
                to.option(e.reason, |to, reason| to.u8(reason as u8));
                to.u8(code(&ACCEPTANCES, &e.acceptance));
                to.u8(code(&ALERTS, &e.alert));
                e.numbers.iter().for_each(|number| to.f64(*number));
                to.option(e.nav_mode, |to, mode| mode.write(to));
            }
            Self::Transition(t) => {
                to.u8(1);
                to.option(t.track, |to, track| track.write(to));
                to.u32(t.incarnation);
                to.u8(t.kind as u8);
                to.u8(t.turn as u8);
                to.i64(t.annunciation.nanoseconds());
                to.i64(t.onset.nanoseconds());
                optional(to, t.clear);
                [t.peak_m, t.limit_m, t.min_margin_m].into_iter().for_each(|number| to.f64(number));
                to.i64(t.event.nanoseconds());
                optional(to, t.arrival);
            }
        }
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let time = |from: &mut Reader<'_>| from.i64().map(GpsTime::from_nanoseconds);
        match from.u8()? {
            0 => Ok(Self::Epoch(EpochOut {
                track: TrackId::read(from)?,
                time: time(from)?,
                arrival: from.option(time)?,
                status: status(from)?,
                reason: from.option(reason)?,
                acceptance: *ACCEPTANCES.get(usize::from(from.u8()?)).ok_or(Damaged("no such acceptance"))?,
                alert: *ALERTS.get(usize::from(from.u8()?)).ok_or(Damaged("no such alert"))?,
                numbers: {
                    let mut numbers = [0.0; NUMBERS.len()];
                    for number in &mut numbers {
                        *number = from.f64()?;
                    }
                    numbers
                },
                nav_mode: from.option(TrackId::read)?,
            })),
            1 => Ok(Self::Transition(Transition {
                track: from.option(TrackId::read)?,
                incarnation: from.u32()?,
                kind: Kind::read(from)?,
                turn: *Turn::ALL.get(usize::from(from.u8()?)).ok_or(Damaged("no such transition"))?,
                annunciation: time(from)?,
                onset: time(from)?,
                clear: from.option(time)?,
                peak_m: from.f64()?,
                limit_m: from.f64()?,
                min_margin_m: from.f64()?,
                event: time(from)?,
                arrival: from.option(time)?,
            })),
            _ => Err(Damaged("an output of no known kind")),
        }
    }

    /// Outputs that were written one after the other.
    ///
    /// # Errors
    /// [`Damaged`] for what is no output.
    pub fn all(bytes: &[u8]) -> Result<Vec<Self>, Damaged> {
        let (mut from, mut outputs) = (Reader(bytes), Vec::new());
        while !from.0.is_empty() {
            outputs.push(Self::read(&mut from)?);
        }
        Ok(outputs)
    }
}
