//! What goes in: the grid, the demands, and one epoch of it.

use navbound_core::quantity::OutOfDomain;

/// Alert limits of one level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demand {
    /// Horizontal alert limit \[m\].
    pub hal_m: f64,
    /// Vertical alert limit \[m\]; none: the vertical is ignored.
    pub val_m: Option<f64>,
    /// Time to alert \[s\].
    pub tta_s: f64,
}

/// The epochs that are expected: `origin + slot * period`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    /// Instant of slot 0 \[GPS ns\].
    pub origin_ns: i64,
    /// Time between slots \[ns\].
    pub period_ns: i64,
}

impl Grid {
    /// The nearest slot.
    pub fn slot(&self, time_ns: i64) -> i64 {
        let from = i128::from(time_ns) - i128::from(self.origin_ns) + i128::from(self.period_ns / 2);
        // A quotient of two 64-bit numbers by at least one fits.
        i64::try_from(from.div_euclid(i128::from(self.period_ns))).unwrap_or(i64::MAX)
    }

    /// Instant of a slot \[GPS ns\].
    pub fn time_ns(&self, slot: i64) -> i64 {
        self.origin_ns.saturating_add(slot.saturating_mul(self.period_ns))
    }

    /// Duration of slots \[s\].
    pub fn seconds(&self, slots: u64) -> f64 {
        slots as f64 * self.period_ns as f64 * 1e-9
    }
}

/// How a campaign is evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The expected epochs.
    pub grid: Grid,
    /// The levels.
    pub demands: Vec<Demand>,
    /// Epochs of the continuity window.
    pub window: u64,
    /// Width of a Stanford bin \[m\].
    pub bin_m: f64,
    /// Bins of each axis; one more collects what lies beyond.
    pub n_bins: u32,
    /// Absent epochs are not expected.
    pub exclude_missing: bool,
}

impl Settings {
    /// The same, checked.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a period, limit, time or bin that is not positive and finite, and for none or too many bins.
    pub fn checked(self) -> Result<Self, OutOfDomain> {
        let positive = |argument, value: f64, unit| {
            if !(value > 0.0 && value < f64::INFINITY) {
                return Err(OutOfDomain { argument, value, unit, domain: "(0, inf)" });
            }
            Ok(())
        };
        positive("period_s", self.grid.period_ns as f64 * 1e-9, "s")?;
        positive("bin_m", self.bin_m, "m")?;
        for demand in &self.demands {
            positive("hal_m", demand.hal_m, "m")?;
            positive("val_m", demand.val_m.unwrap_or(1.0), "m")?;
            positive("tta_s", demand.tta_s, "s")?;
        }
        let outside = |argument, value: u64, domain| OutOfDomain { argument, value: value as f64, unit: "1", domain };
        if !(1..=10_000).contains(&self.n_bins) {
            return Err(outside("n_bins", u64::from(self.n_bins), "[1, 10000]"));
        }
        if self.window == 0 {
            return Err(outside("window", self.window, "[1, inf)"));
        }
        Ok(self)
    }
}

/// Why a level is not available at an epoch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The grid expects an epoch and there is none.
    Missing,
    /// No position with a protection level.
    NoSolution,
    /// A position without the vertical level that the demand needs.
    NoVertical,
    /// The horizontal level reaches its limit.
    Horizontal,
    /// The vertical level reaches its limit.
    Vertical,
    /// Both do.
    Both,
}

impl Cause {
    /// Every cause, by its index.
    pub const ALL: [Self; 6] = [Self::Missing, Self::NoSolution, Self::NoVertical, Self::Horizontal, Self::Vertical, Self::Both];

    /// The words of tables.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Missing => "no epoch",
            Self::NoSolution => "no solution",
            Self::NoVertical => "no vertical level",
            Self::Horizontal => "hpl",
            Self::Vertical => "vpl",
            Self::Both => "hpl and vpl",
        }
    }
}

/// What a table says about the receiver at an epoch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct State {
    /// Satellites in the solution; negative where not known.
    pub n_sv: i32,
    /// The caller's code of the mode; 0 where not known.
    pub mode: u32,
    /// The caller's code of the reason; 0 for none.
    pub reason: u32,
}

/// One epoch; NaN for what is not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Epoch {
    /// Where on the grid.
    pub slot: i64,
    /// Horizontal error, vertical error, horizontal level, vertical level \[m\].
    pub size_m: [f64; 4],
    /// Of the receiver.
    pub state: State,
}

/// Places in [`Epoch::size_m`].
pub(super) const HPE: usize = 0;
/// Vertical error.
pub(super) const VPE: usize = 1;
/// Horizontal level.
pub(super) const HPL: usize = 2;
/// Vertical level.
pub(super) const VPL: usize = 3;

impl Epoch {
    /// A position with a protection level.
    pub fn has_solution(&self) -> bool {
        !self.size_m[HPL].is_nan()
    }

    /// Why `demand` is not met, none where it is (strictly: a level equal to its limit is not).
    pub fn lacks(&self, demand: &Demand) -> Option<Cause> {
        if !self.has_solution() {
            return Some(Cause::NoSolution);
        }
        let horizontal = self.size_m[HPL] < demand.hal_m;
        let Some(val) = demand.val_m else { return (!horizontal).then_some(Cause::Horizontal) };
        if self.size_m[VPL].is_nan() {
            return Some(Cause::NoVertical);
        }
        match (horizontal, self.size_m[VPL] < val) {
            (true, true) => None,
            (false, true) => Some(Cause::Horizontal),
            (true, false) => Some(Cause::Vertical),
            (false, false) => Some(Cause::Both),
        }
    }

    /// An error beyond its limit, in an axis that the demand limits.
    pub fn beyond_limit(&self, demand: &Demand) -> bool {
        self.size_m[HPE] > demand.hal_m || demand.val_m.is_some_and(|val| self.size_m[VPE] > val)
    }

    /// An error beyond its protection level, in an axis that the demand limits.
    pub fn beyond_level(&self, demand: Option<&Demand>) -> bool {
        let vertical = demand.is_none_or(|d| d.val_m.is_some());
        self.size_m[HPE] > self.size_m[HPL] || (vertical && self.size_m[VPE] > self.size_m[VPL])
    }
}

/// A table's columns, of equal length, in the order of time; NaN for what is not known.
#[derive(Debug, Clone, Copy)]
pub struct Columns<'a> {
    /// GPS time \[ns\].
    pub time_ns: &'a [i64],
    /// Errors east, north, up \[m\].
    pub nse_m: [&'a [f64]; 3],
    /// Horizontal protection level; NaN where there is no solution \[m\].
    pub hpl_m: &'a [f64],
    /// Vertical protection level \[m\].
    pub vpl_m: &'a [f64],
    /// Satellites; negative where not known.
    pub n_sv: &'a [i32],
    /// Codes of the mode.
    pub mode: &'a [u32],
    /// Codes of the reason.
    pub reason: &'a [u32],
}

/// A row that was refused, and why.
pub type Refused = (Option<usize>, OutOfDomain);

impl Columns<'_> {
    /// Rows as epochs after slot `last`; a row whose slot is not after the one before is left out, and counted.
    ///
    /// # Errors
    /// [`OutOfDomain`] for columns of unequal length, times that fall, errors that are infinite, or levels that are not positive.
    pub fn epochs(&self, grid: &Grid, last: Option<i64>) -> Result<(Vec<Epoch>, u64), Refused> {
        self.same_length()?;
        let mut epochs: Vec<Epoch> = Vec::with_capacity(self.time_ns.len());
        let mut newest = last;
        for row in 0..self.time_ns.len() {
            if row > 0 && self.time_ns[row] < self.time_ns[row - 1] {
                let value = self.time_ns[row] as f64;
                return Err((Some(row), OutOfDomain { argument: "time_ns", value, unit: "ns", domain: "times that do not fall" }));
            }
            let epoch = self.epoch(row, grid)?;
            if newest.is_none_or(|slot| epoch.slot > slot) {
                newest = Some(epoch.slot);
                epochs.push(epoch);
            }
        }
        let repeated = (self.time_ns.len() - epochs.len()) as u64;
        Ok((epochs, repeated))
    }

    fn epoch(&self, row: usize, grid: &Grid) -> Result<Epoch, Refused> {
        let [e, n, u] = self.nse_m.map(|column| column[row]);
        for (argument, value) in [("nse_e_m", e), ("nse_n_m", n), ("nse_u_m", u)] {
            if value.is_infinite() {
                return Err((Some(row), OutOfDomain { argument, value, unit: "m", domain: "finite numbers, NaN for none" }));
            }
        }
        for (argument, value) in [("hpl_m", self.hpl_m[row]), ("vpl_m", self.vpl_m[row])] {
            if !(value.is_nan() || (value > 0.0 && value < f64::INFINITY)) {
                return Err((Some(row), OutOfDomain { argument, value, unit: "m", domain: "(0, inf), NaN for none" }));
            }
        }
        Ok(Epoch {
            slot: grid.slot(self.time_ns[row]),
            size_m: [(e * e + n * n).sqrt(), u.abs(), self.hpl_m[row], self.vpl_m[row]],
            state: State { n_sv: self.n_sv[row], mode: self.mode[row], reason: self.reason[row] },
        })
    }

    fn same_length(&self) -> Result<(), Refused> {
        let expected = self.time_ns.len();
        let lengths = [
            ("nse_e_m", self.nse_m[0].len()),
            ("nse_n_m", self.nse_m[1].len()),
            ("nse_u_m", self.nse_m[2].len()),
            ("hpl_m", self.hpl_m.len()),
            ("vpl_m", self.vpl_m.len()),
            ("n_sv", self.n_sv.len()),
            ("mode", self.mode.len()),
            ("reason", self.reason.len()),
        ];
        match lengths.into_iter().find(|(_, length)| *length != expected) {
            None => Ok(()),
            Some((argument, length)) => {
                Err((None, OutOfDomain { argument, value: length as f64, unit: "rows", domain: "the number of times" }))
            }
        }
    }
}
