//! State of one track.

use crate::assumed::Stated;
use crate::codec::{Damaged, Reader, Writer};
use crate::order::Waiting;
use crate::output::Kind;
use navbound_core::frame::EcefPosition;
use navbound_core::judge::{self, Judge};
use navbound_core::monitor::ahead::{Ahead, Reached};
use navbound_core::monitor::balance::{At, Balance, Window};
use navbound_core::monitor::drift::{self, Drift, Drifted, Led, Side, Sums};
use navbound_core::monitor::motion::{LastSpeed, Motion, Report};
use navbound_core::monitor::neighbours::{Height, Neighbours, Place};
use navbound_core::monitor::standing::{Fall, Gone, Owed, Resumed, Stood};
use navbound_core::monitor::way::{Mark, Through, Way};
use navbound_core::quantity::{GpsTime, Metres};

/// Everything that is kept of a track.
#[derive(Debug, Clone)]
pub(crate) struct Track {
    pub(crate) judge: Judge,
    /// How often it began anew: part of its keys.
    pub(crate) incarnation: u32,
    /// Incarnation and annunciation of the alerts in force, as their raises say: caution, warning, unavailable.
    pub(crate) open: [Option<(u32, GpsTime)>; 3],
    /// Time of the last record that the monitor took.
    pub(crate) last: Option<GpsTime>,
    /// Whether that record came exactly one sample period after the one before: only then is the next one known.
    pub(crate) stepped: bool,
    /// Distance along the path of the last foot.
    pub(crate) along: Option<Metres>,
    /// Its last different position, an earlier one, and its last jump.
    pub(crate) motion: Motion,
    /// Its last two positions.
    pub(crate) neighbours: Neighbours,
    /// Its way, and that by its speeds.
    pub(crate) balance: Balance,
    /// How far it goes aside of where its reported track leads.
    pub(crate) drift: Drift,
    pub(crate) waiting: Waiting,
    /// Whether a record of it stated an RNP.
    pub(crate) states_rnp: bool,
    /// What it stated of its accuracy, where one is assumed.
    pub(crate) stated: Stated,
    /// Whether its silence was noticed since the last record.
    pub(crate) silent: bool,
}

impl Track {
    pub(crate) fn new(judge: Judge, incarnation: u32) -> Self {
        Self {
            judge,
            incarnation,
            open: [None; 3],
            last: None,
            stepped: false,
            along: None,
            motion: Motion::default(),
            neighbours: Neighbours::default(),
            balance: Balance::default(),
            drift: Drift::default(),
            waiting: Waiting::default(),
            states_rnp: false,
            stated: Stated::default(),
            silent: false,
        }
    }

    /// Time of the next record, where the last ones came at the period.
    pub(crate) fn next(&self, period_s: f64) -> Option<GpsTime> {
        self.last.filter(|_| self.stepped).map(|last| last.plus_seconds(period_s))
    }

    /// The alert in force of a kind.
    pub(crate) fn open_mut(&mut self, kind: Kind) -> Option<&mut Option<(u32, GpsTime)>> {
        self.open.get_mut(kind as usize)
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        to.bytes(&self.judge.to_bytes());
        to.u32(self.incarnation);
        for open in self.open {
            to.option(open, |to, (incarnation, annunciation)| {
                to.u32(incarnation);
                to.i64(annunciation.nanoseconds());
            });
        }
        to.option(self.last, |to, time| to.i64(time.nanoseconds()));
        to.flag(self.stepped);
        to.option(self.along, |to, along| to.f64(along.m()));
        for each in [self.motion.last, self.motion.anchor] {
            to.option(each, report);
        }
        to.option(self.motion.jumped, |to, time| to.i64(time.nanoseconds()));
        to.option(self.motion.gone.seen, |to, time| to.i64(time.nanoseconds()));
        let gone = &self.motion.gone;
        [gone.way_m, gone.stood_s, gone.braked_mps].into_iter().for_each(|number| to.f64(number));
        to.option(gone.fell, |to, fall| {
            to.i64(fall.time.nanoseconds());
            [fall.lat_rad, fall.lon_rad].into_iter().for_each(|number| to.f64(number));
            to.flag(fall.from_moving);
        });
        to.option(gone.owed, |to, owed| {
            [owed.lat_rad, owed.lon_rad, owed.way_m].into_iter().for_each(|number| to.f64(number));
            to.option(owed.since, |to, since| to.i64(since.nanoseconds()));
        });
        to.option(gone.stood, |to, stood| {
            to.i64(stood.time.nanoseconds());
            [stood.lat_rad, stood.lon_rad, stood.way_m, stood.early_m].into_iter().for_each(|number| to.f64(number));
            to.flag(stood.stale);
        });
        to.f64(gone.late_s);
        to.option(gone.resumed, |to, resumed| {
            [resumed.lat_rad, resumed.lon_rad, resumed.behind_m].into_iter().for_each(|number| to.f64(number));
        });
        to.flag(gone.moved);
        to.f64(gone.crawled_s);
        to.option(self.motion.height, height);
        to.option(self.motion.way.last, |to, (place, so_far)| {
            report(to, place);
            mark(to, so_far);
        });
        to.option(self.motion.way.through, |to, through| {
            report(to, through.place);
            [through.moved_m, through.longest_s].into_iter().for_each(|number| to.f64(number));
        });
        for each in self.motion.way.marks {
            to.option(each, mark);
        }
        to.option(self.motion.way.behind, |to, since| to.i64(since.nanoseconds()));
        let ahead = &self.motion.ahead;
        to.option(ahead.last, |to, (time, speed_mps)| {
            to.i64(time.nanoseconds());
            to.f64(speed_mps);
        });
        to.f64(ahead.reported_m);
        for each in ahead.places {
            to.option(each, reached);
        }
        to.flag(ahead.ahead);
        to.option(self.motion.speed.reported, |to, (time, speed_mps)| {
            to.i64(time.nanoseconds());
            to.f64(speed_mps);
        });
        for place in self.neighbours.last {
            to.option(place, |to, place| {
                to.i64(place.time.nanoseconds());
                [place.lat_rad, place.lon_rad, place.variance_m2].into_iter().for_each(|number| to.f64(number));
            });
        }
        balance(to, &self.balance);
        drift(to, &self.drift);
        self.waiting.write(to);
        to.flag(self.states_rnp);
        to.option(self.stated.largest_m2, Writer::f64);
        to.flag(self.stated.lost);
        to.flag(self.silent);
    }

    pub(crate) fn read(settings: &judge::Settings, from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let judge = Judge::from_bytes(from.bytes()?).map_err(|_| Damaged("the state of a monitor cannot be"))?;
        if judge.settings().monitor != settings.monitor {
            return Err(Damaged("the state of a monitor that was set otherwise"));
        }
        let incarnation = from.u32()?;
        let mut open = [None; 3];
        for each in &mut open {
            *each = from.option(|from| Ok((from.u32()?, GpsTime::from_nanoseconds(from.i64()?))))?;
        }
        let last = from.option(Reader::i64)?.map(GpsTime::from_nanoseconds);
        let stepped = from.flag()?;
        let along = from.option(Reader::f64)?.map(Metres::new);
        let (last_different, anchor) = (from.option(read_report)?, from.option(read_report)?);
        let jumped = from.option(Reader::i64)?.map(GpsTime::from_nanoseconds);
        let gone = Gone {
            seen: from.option(Reader::i64)?.map(GpsTime::from_nanoseconds),
            way_m: from.f64()?,
            stood_s: from.f64()?,
            braked_mps: from.f64()?,
            fell: from.option(|from| {
                let time = GpsTime::from_nanoseconds(from.i64()?);
                Ok(Fall { time, lat_rad: from.f64()?, lon_rad: from.f64()?, from_moving: from.flag()? })
            })?,
            owed: from.option(|from| {
                let [lat_rad, lon_rad, way_m] = [from.f64()?, from.f64()?, from.f64()?];
                Ok(Owed { lat_rad, lon_rad, way_m, since: from.option(Reader::i64)?.map(GpsTime::from_nanoseconds) })
            })?,
            stood: from.option(|from| {
                let time = GpsTime::from_nanoseconds(from.i64()?);
                let [lat_rad, lon_rad, way_m, early_m] = [from.f64()?, from.f64()?, from.f64()?, from.f64()?];
                Ok(Stood { time, lat_rad, lon_rad, way_m, early_m, stale: from.flag()? })
            })?,
            late_s: from.f64()?,
            resumed: from.option(|from| Ok(Resumed { lat_rad: from.f64()?, lon_rad: from.f64()?, behind_m: from.f64()? }))?,
            moved: from.flag()?,
            crawled_s: from.f64()?,
        };
        let height = from.option(read_height)?;
        let mut way = Way { last: from.option(|from| Ok((read_report(from)?, read_mark(from)?)))?, ..Way::default() };
        way.through = from.option(|from| Ok(Through { place: read_report(from)?, moved_m: from.f64()?, longest_s: from.f64()? }))?;
        for each in &mut way.marks {
            *each = from.option(read_mark)?;
        }
        way.behind = from.option(Reader::i64)?.map(GpsTime::from_nanoseconds);
        let last_speed = from.option(|from| Ok((GpsTime::from_nanoseconds(from.i64()?), from.f64()?)))?;
        let mut ahead = Ahead { last: last_speed, reported_m: from.f64()?, ..Ahead::default() };
        for each in &mut ahead.places {
            *each = from.option(read_reached)?;
        }
        ahead.ahead = from.flag()?;
        let reported = from.option(|from| Ok((GpsTime::from_nanoseconds(from.i64()?), from.f64()?)))?;
        let motion = Motion { last: last_different, anchor, jumped, gone, height, way, ahead, speed: LastSpeed { reported } };
        let place = |from: &mut Reader<'_>| {
            let time = GpsTime::from_nanoseconds(from.i64()?);
            Ok(Place { time, lat_rad: from.f64()?, lon_rad: from.f64()?, variance_m2: from.f64()? })
        };
        let neighbours = Neighbours { last: [from.option(place)?, from.option(place)?] };
        let (balance, drift, waiting) = (read_balance(from)?, read_drift(from)?, Waiting::read(from)?);
        let states_rnp = from.flag()?;
        let stated = Stated { largest_m2: from.option(Reader::f64)?, lost: from.flag()? };
        let silent = from.flag()?;
        Ok(Self { judge, incarnation, open, last, stepped, along, motion, neighbours, balance, drift, waiting, states_rnp, stated, silent })
    }
}

fn report(to: &mut Writer, report: Report) {
    to.i64(report.time.nanoseconds());
    [report.lat_rad, report.lon_rad, report.speed_mps, report.variance_m2].into_iter().for_each(|number| to.f64(number));
    to.option(report.height, height);
}

fn read_report(from: &mut Reader<'_>) -> Result<Report, Damaged> {
    let time = GpsTime::from_nanoseconds(from.i64()?);
    let [lat_rad, lon_rad, speed_mps, variance_m2] = [from.f64()?, from.f64()?, from.f64()?, from.f64()?];
    Ok(Report { time, fixed: None, lat_rad, lon_rad, speed_mps, variance_m2, height: from.option(read_height)? })
}

fn mark(to: &mut Writer, mark: Mark) {
    to.i64(mark.time.nanoseconds());
    [mark.moved_m, mark.reported_m].into_iter().for_each(|number| to.f64(number));
}

fn read_mark(from: &mut Reader<'_>) -> Result<Mark, Damaged> {
    Ok(Mark { time: GpsTime::from_nanoseconds(from.i64()?), moved_m: from.f64()?, reported_m: from.f64()? })
}

fn reached(to: &mut Writer, reached: Reached) {
    to.i64(reached.time.nanoseconds());
    reached.place.vector().iter().for_each(|number| to.f64(*number));
    [reached.reported_m, reached.fastest_mps].into_iter().for_each(|number| to.f64(number));
}

fn read_reached(from: &mut Reader<'_>) -> Result<Reached, Damaged> {
    let time = GpsTime::from_nanoseconds(from.i64()?);
    let place = EcefPosition::from_vector([from.f64()?, from.f64()?, from.f64()?].into());
    Ok(Reached { time, place, reported_m: from.f64()?, fastest_mps: from.f64()? })
}

fn height(to: &mut Writer, height: Height) {
    [height.h_m, height.variance_m2].into_iter().for_each(|number| to.f64(number));
}

fn read_height(from: &mut Reader<'_>) -> Result<Height, Damaged> {
    Ok(Height { h_m: from.f64()?, variance_m2: from.f64()? })
}

fn at(to: &mut Writer, at: At) {
    to.i64(at.time_ns);
    [at.lat_rad, at.lon_rad, at.speed_mps].into_iter().for_each(|number| to.f64(number));
}

fn read_at(from: &mut Reader<'_>) -> Result<At, Damaged> {
    Ok(At { time_ns: from.i64()?, lat_rad: from.f64()?, lon_rad: from.f64()?, speed_mps: from.f64()? })
}

fn balance(to: &mut Writer, balance: &Balance) {
    to.option(balance.window, |to, window| {
        [window.begin, window.spoken, window.leg, window.last].into_iter().for_each(|place| at(to, place));
        to.i64(window.longest_ns);
        window.moved_m.into_iter().chain(window.reported_m).for_each(|number| to.f64(number));
    });
    balance.ways_m.into_iter().for_each(|number| to.f64(number));
}

fn read_balance(from: &mut Reader<'_>) -> Result<Balance, Damaged> {
    let window = from.option(|from| {
        Ok(Window {
            begin: read_at(from)?,
            spoken: read_at(from)?,
            leg: read_at(from)?,
            last: read_at(from)?,
            longest_ns: from.i64()?,
            moved_m: [from.f64()?, from.f64()?],
            reported_m: [from.f64()?, from.f64()?],
        })
    })?;
    Ok(Balance { window, ways_m: [from.f64()?, from.f64()?] })
}

fn drift(to: &mut Writer, drift: &Drift) {
    to.option(drift.window, |to, window| {
        for led in [window.begin, window.last] {
            at(to, led.at);
            [led.track_rad, led.sigma_m].into_iter().for_each(|number| to.f64(number));
        }
        [window.since_ns, window.repeated_ns].into_iter().for_each(|time_ns| to.i64(time_ns));
        to.f64(window.way_m);
        window.lead_m.into_iter().chain(window.moved_m).for_each(|number| to.f64(number));
    });
    to.flag(drift.fitted);
    to.u32(drift.repeats);
    // Without a minute they are what they were at first.
    for side in drift.sums.sides.as_flattened() {
        to.option(Some(side).filter(|side| side.n > 0), |to, side| {
            [side.beyond_m, side.aside_m, side.way_m, side.noise_m].into_iter().for_each(|number| to.f64(number));
            to.u32(side.n);
        });
    }
    for worst in drift.sums.worst {
        to.option(Some(worst).filter(|worst| worst.n > 0), |to, worst| {
            [worst.over_m, worst.aside_m, worst.way_m].into_iter().for_each(|number| to.f64(number));
            to.u32(worst.n);
        });
    }
    drift.sums.on_grid.into_iter().for_each(|on_grid| to.flag(on_grid));
}

fn read_drift(from: &mut Reader<'_>) -> Result<Drift, Damaged> {
    let led = |from: &mut Reader<'_>| Ok(Led { at: read_at(from)?, track_rad: from.f64()?, sigma_m: from.f64()? });
    let window = from.option(|from| {
        Ok(drift::Window {
            begin: led(from)?,
            last: led(from)?,
            since_ns: from.i64()?,
            repeated_ns: from.i64()?,
            way_m: from.f64()?,
            lead_m: [from.f64()?, from.f64()?],
            moved_m: [from.f64()?, from.f64()?],
        })
    })?;
    let mut drift = Drift { window, fitted: from.flag()?, repeats: from.u32()?, sums: Sums::default() };
    for side in drift.sums.sides.as_flattened_mut() {
        let minutes = from.option(|from| {
            let [beyond_m, aside_m, way_m, noise_m] = [from.f64()?, from.f64()?, from.f64()?, from.f64()?];
            Ok(Side { beyond_m, aside_m, way_m, noise_m, n: from.u32()? })
        })?;
        *side = minutes.unwrap_or_default();
    }
    for worst in &mut drift.sums.worst {
        let minutes = from.option(|from| Ok(Drifted { over_m: from.f64()?, aside_m: from.f64()?, way_m: from.f64()?, n: from.u32()? }))?;
        *worst = minutes.unwrap_or(*worst);
    }
    for on_grid in &mut drift.sums.on_grid {
        *on_grid = from.flag()?;
    }
    Ok(drift)
}
