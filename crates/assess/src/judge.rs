//! Loops over [`navbound_core::judge`]: an epoch table of many tracks, in pieces of any length.

use crate::bounds::{self, Refused, at, reason_code};
use crate::parallel;
use navbound_core::bound::{Bound, Method};
use navbound_core::judge::{Errors, Evaluated, Judge, Judged, Sample, Settings};
use navbound_core::monitor::rnp::{Alert, Counters, Event};
use navbound_core::quantity::encoding::BadBytes;
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Status, Unavailable};

/// Rows in one task of the pool.
const ROWS_PER_TASK: usize = 1024;
/// Rows that are evaluated before they are followed: enough for all cores, and little memory.
const ROWS_PER_BLOCK: usize = 65_536;

/// Columns of the navigation error, `nse_e_m`, `nse_n_m`, `nse_u_m`; a NaN is an absent value.
pub type Errs<'a> = [Option<&'a [f64]>; 3];

/// Errors of every row.
pub fn errors(columns: &bounds::Columns<'_>, nse_m: Errs<'_>) -> Vec<Errors> {
    let of = |row| with_truth(columns.sample(row), nse_m, row).errors();
    parallel::map(columns.len, ROWS_PER_TASK, of)
}

fn with_truth(sample: Sample, [east, north, up]: Errs<'_>, row: usize) -> Sample {
    Sample { nse_en_m: at(east, row).zip(at(north, row)).map(|(e, n)| [e, n]), nse_u_m: at(up, row), ..sample }
}

/// How a table is judged.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The judge of each track; whether its epochs should have a level is a matter of the track.
    pub settings: Settings,
    /// Methods whose bounds are stated beside that of the judging one.
    pub beside: Vec<&'static Method>,
}

/// What a table says of its epochs, all columns of one length.
#[derive(Debug, Clone, Copy)]
pub struct Columns<'a> {
    /// Path, covariance and limit.
    pub epochs: bounds::Columns<'a>,
    /// Navigation errors.
    pub nse_m: Errs<'a>,
    /// `hpl_m`.
    pub hpl_m: Option<&'a [f64]>,
    /// `time_ns`.
    pub time_ns: &'a [i64],
    /// `status`.
    pub status: &'a [Status],
    /// Track of each row, as an index.
    pub track: &'a [u32],
}

impl Columns<'_> {
    /// # Errors
    /// [`OutOfDomain`] unless times, statuses and tracks have the length of the table.
    fn checked(&self) -> Result<(), OutOfDomain> {
        for (argument, len) in [("time_ns", self.time_ns.len()), ("status", self.status.len()), ("track", self.track.len())] {
            if len != self.epochs.len {
                return Err(OutOfDomain { argument, value: len as f64, unit: "rows", domain: "the number of epochs" });
            }
        }
        Ok(())
    }

    /// The epoch of one row of all columns.
    #[must_use]
    pub fn sample(&self, row: usize) -> Sample {
        let time = GpsTime::from_nanoseconds(self.time_ns[row]);
        let timed = Sample { time, status: self.status[row], hpl: at(self.hpl_m, row).map(Metres::new), ..self.epochs.sample(row) };
        with_truth(timed, self.nse_m, row)
    }
}

impl Plan {
    /// Names of the columns of [`Plan::numbers`], in their order. [`Plan::beside_names`] are those after them.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let errors = ["nse_h_m", "nse_3d_m", "nse_along_m", "nse_cross_m", "tse_m", "tse_v_m", "sigma_cross_m"].map(String::from);
        let risks = ["p_exceed_rnp", "p_exceed_2rnp"].map(String::from);
        let states = (1..=self.n_states()).map(|k| format!("p_state_{k}"));
        let compared = ["integrity_compared_m".to_owned()];
        let own = bound_columns(self.settings.method.method());
        errors.into_iter().chain(own).chain(risks).chain(compared).chain(states).collect()
    }

    /// Names of the columns of both bounds of each method beside the judging one.
    #[must_use]
    pub fn beside_names(&self) -> Vec<String> {
        self.beside.iter().flat_map(|method| bound_columns(method)).collect()
    }

    fn n_states(&self) -> usize {
        self.settings.states.map_or(0, |table| table.n_states())
    }

    /// The numbers of one judged epoch \[m, 1\]; NaN where there is none.
    pub fn numbers<'a>(&self, judged: &'a Judged) -> impl Iterator<Item = f64> + 'a {
        let (evaluated, errors) = (&judged.evaluated, &judged.evaluated.errors);
        let along_path = [errors.horizontal_m, errors.spatial_m, errors.along_m, errors.cross_m, errors.tse_m, errors.tse_v_m];
        let bound =
            |bound: Option<Result<_, Unavailable>>| bound.and_then(Result::ok).map(|b: navbound_core::bound::AlertBound| b.length().m());
        let own = [bound(evaluated.accuracy), bound(evaluated.integrity)];
        let risks = [0, 1].map(|k| evaluated.exceedance.map(|risk| risk[k]));
        let states = (0..self.n_states()).map(|k| evaluated.state_probability.and_then(|p| p.get(k).copied()));
        let stated = along_path.into_iter().chain([errors.sigma_cross_m]).chain(own).chain(risks);
        stated.chain([Some(judged.integrity_compared.m())]).chain(states).map(|number| number.unwrap_or(f64::NAN))
    }

    /// Both bounds of a method beside the judging one \[m\]; NaN where there is none.
    #[must_use]
    pub fn beside(&self, method: &'static Method, sample: &Sample) -> [f64; 2] {
        let length = |bound: Result<Bound, Unavailable>| bound.map_or(f64::NAN, |b| b.length().m());
        self.settings.beside(method, sample).map_or([f64::NAN; 2], |bounds| bounds.map(length))
    }
}

impl Plan {
    /// All numbers of one judged epoch, in the order of [`Plan::names`] and [`Plan::beside_names`].
    #[must_use]
    pub fn row(&self, sample: &Sample, judged: &Judged) -> Vec<f64> {
        self.numbers(judged).chain(self.beside.iter().flat_map(|method| self.beside(method, sample))).collect()
    }

    /// The judge of a state that was written under these settings.
    ///
    /// # Errors
    /// [`BadBytes`] of the bytes, and where they were written under other settings.
    pub fn resumed(&self, bytes: &[u8]) -> Result<Judge, BadBytes> {
        let judge = Judge::from_bytes(bytes)?;
        let (written, own) = (judge.settings(), &self.settings);
        let same = [
            ("method", written.method.method().id == own.method.method().id),
            ("risk_accuracy", written.accuracy == own.accuracy),
            ("risk_integrity", written.integrity == own.integrity),
            ("states", written.states == own.states),
            ("monitor", written.monitor == own.monitor),
        ];
        same.iter().find(|(_, same)| !same).map_or(Ok(judge), |(setting, _)| Err(BadBytes::Value(setting)))
    }
}

fn bound_columns(method: &Method) -> [String; 2] {
    let name = method.id.replace('-', "_");
    [format!("{name}_m"), format!("{name}_integrity_m")]
}

/// What was decided of some rows.
#[derive(Debug, Clone)]
pub struct Piece {
    /// Columns of numbers, named by [`Plan::names`] and [`Plan::beside_names`].
    pub numbers: Vec<Vec<f64>>,
    /// Whether each epoch was judged: its own status, or that of the reason against it.
    pub status: Vec<Status>,
    /// 0 where the epoch was judged or its source did not permit it, otherwise 1 + index into `reasons`.
    pub reason: Vec<u32>,
    /// Distinct reasons, in order of first appearance.
    pub reasons: Vec<Refused>,
    /// The tightest state within the accuracy risk.
    pub state: Vec<Option<u8>>,
    /// The alert in force after each row.
    pub alert: Vec<Alert>,
}

impl Piece {
    fn new(n_columns: usize, n: usize) -> Self {
        Self {
            numbers: (0..n_columns).map(|_| Vec::with_capacity(n)).collect(),
            status: Vec::with_capacity(n),
            reason: Vec::with_capacity(n),
            reasons: Vec::new(),
            state: Vec::with_capacity(n),
            alert: Vec::with_capacity(n),
        }
    }

    fn put(&mut self, plan: &Plan, judged: &Judged) {
        let reasons = &mut self.reasons;
        self.reason.push(judged.evaluated.unjudged().map_or(0, |why| reason_code(reasons, why)));
        self.status.push(judged.evaluated.status);
        self.state.push(judged.evaluated.tightest_level);
        self.alert.push(judged.step.alert);
        for (column, number) in self.numbers.iter_mut().zip(plan.numbers(judged)) {
            column.push(number);
        }
    }
}

/// One judge per track, which take their rows in pieces of any length. The rows are the arrival clock: one that is dropped for its time
/// counts as one sample period of silence.
#[derive(Debug, Clone)]
pub struct Judges {
    plan: Plan,
    tracks: Vec<Judge>,
    events: Vec<(u32, Event)>,
}

impl Judges {
    /// One judge for each entry, which says whether its track has a protection level anywhere.
    ///
    /// # Errors
    /// [`OutOfDomain`] for settings of the monitor that cannot be.
    pub fn new(plan: Plan, with_levels: &[bool]) -> Result<Self, OutOfDomain> {
        let judge = |has: &bool| Judge::new(Settings { with_levels: *has, ..plan.settings });
        let tracks = with_levels.iter().map(judge).collect::<Result<_, _>>()?;
        Ok(Self { plan, tracks, events: Vec::new() })
    }

    /// How they judge.
    #[must_use]
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Judge the next rows. The result does not depend on the number of cores.
    ///
    /// # Errors
    /// [`OutOfDomain`] for columns of unequal length and the index of a track that is none.
    pub fn judge(&mut self, columns: &Columns<'_>) -> Result<Piece, OutOfDomain> {
        columns.checked()?;
        let n = columns.epochs.len;
        let mut piece = Piece::new(self.plan.names().len(), n);
        for first in (0..n).step_by(ROWS_PER_BLOCK) {
            self.block(columns, first..n.min(first + ROWS_PER_BLOCK), &mut piece)?;
        }
        for method in &self.plan.beside {
            let bounds = |row| self.plan.beside(method, &columns.sample(row));
            let (accuracy, integrity) = parallel::map(n, ROWS_PER_TASK, |row| bounds(row).into()).into_iter().unzip();
            piece.numbers.extend([accuracy, integrity]);
        }
        Ok(piece)
    }

    /// Evaluate rows on all cores, then follow them in their order.
    fn block(&mut self, columns: &Columns<'_>, rows: core::ops::Range<usize>, piece: &mut Piece) -> Result<(), OutOfDomain> {
        let settings = &self.plan.settings;
        let evaluate = |row| settings.evaluate(&columns.sample(row));
        let evaluated: Vec<Evaluated> = parallel::map(rows.len(), ROWS_PER_TASK, |k| evaluate(rows.start + k));
        for (row, evaluated) in rows.zip(evaluated) {
            let track = columns.track[row];
            let Some(judge) = self.tracks.get_mut(track as usize) else {
                return Err(OutOfDomain { argument: "track", value: f64::from(track), unit: "1", domain: "[0, n_tracks)" });
            };
            let judged = judge.follow(&columns.sample(row), evaluated);
            self.events.extend(judged.step.ended.iter().flatten().map(|event| (track, *event)));
            piece.put(&self.plan, &judged);
        }
        Ok(())
    }

    /// Events so far and those that last, and their tracks, by track and then by annunciation.
    #[must_use]
    pub fn events(&self) -> Vec<(u32, Event)> {
        let mut events = self.events.clone();
        for (track, judge) in (0..).zip(&self.tracks) {
            events.extend(judge.monitor().open_events().map(|event| (track, *event)));
        }
        events.sort_by_key(|(track, event)| (*track, event.annunciation, event.onset));
        events
    }

    /// Counters of each track.
    #[must_use]
    pub fn counters(&self) -> Vec<Counters> {
        self.tracks.iter().map(|judge| *judge.monitor().counters()).collect()
    }
}
