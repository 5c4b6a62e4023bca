//! Many flights of one scenario on all cores, as columns of the epoch table.

use crate::fused::MODES;
use crate::parallel;
use navbound_core::quantity::OutOfDomain;
use navbound_simulate::{Doubt, FlownEpoch, Outlook, fly};

/// Epochs of flights, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Flights {
    epochs: Vec<Vec<FlownEpoch>>,
    first: u64,
}

/// A column of numbers: its name in the epoch table and where it comes from.
pub type Column = (&'static str, fn(&FlownEpoch) -> f64);

/// Every column of numbers.
pub const COLUMNS: [Column; 58] = [
    ("est_lat_rad", |e| e.estimate[0]),
    ("est_lon_rad", |e| e.estimate[1]),
    ("est_h_m", |e| e.estimate[2]),
    ("truth_lat_rad", |e| e.truth[0]),
    ("truth_lon_rad", |e| e.truth[1]),
    ("truth_h_m", |e| e.truth[2]),
    ("cov_ee_m2", |e| e.covariance_m2[0]),
    ("cov_en_m2", |e| e.covariance_m2[1]),
    ("cov_nn_m2", |e| e.covariance_m2[2]),
    ("cov_eu_m2", |e| e.covariance_m2[3]),
    ("cov_nu_m2", |e| e.covariance_m2[4]),
    ("cov_uu_m2", |e| e.covariance_m2[5]),
    ("path_lat_rad", |e| e.path[0]),
    ("path_lon_rad", |e| e.path[1]),
    ("path_h_m", |e| e.path[2]),
    ("course_rad", |e| e.course_rad),
    ("path_angle_rad", |e| e.path_angle_rad),
    ("along_m", |e| e.along_m),
    ("ground_speed_mps", |e| e.ground_speed_mps),
    ("rnp_m", |e| e.rnp_m),
    ("fte_m", |e| e.fte_m[0]),
    ("fte_v_m", |e| e.fte_m[1]),
    ("nse_e_m", |e| e.nse_enu_m[0]),
    ("nse_n_m", |e| e.nse_enu_m[1]),
    ("nse_u_m", |e| e.nse_enu_m[2]),
    ("hdop", |e| e.dop[0]),
    ("vdop", |e| e.dop[1]),
    ("separation_m", |e| e.separation_m.map_or(f64::NAN, |s| s[0])),
    ("separation_limit_m", |e| e.separation_m.map_or(f64::NAN, |s| s[1])),
    ("innovation_memory", |e| e.memory.unwrap_or(f64::NAN)),
    ("innovation_range", |e| innovation(e, 0)),
    ("innovation_station", |e| innovation(e, 1)),
    ("innovation_baro", |e| innovation(e, 2)),
    ("bias_gyro_x_radps", |e| bias(e, 0, 0)),
    ("bias_gyro_y_radps", |e| bias(e, 0, 1)),
    ("bias_gyro_z_radps", |e| bias(e, 0, 2)),
    ("bias_accel_x_mps2", |e| bias(e, 1, 0)),
    ("bias_accel_y_mps2", |e| bias(e, 1, 1)),
    ("bias_accel_z_mps2", |e| bias(e, 1, 2)),
    ("sigma_bias_gyro_x_radps", |e| sigma_bias(e, 0, 0)),
    ("sigma_bias_gyro_y_radps", |e| sigma_bias(e, 0, 1)),
    ("sigma_bias_gyro_z_radps", |e| sigma_bias(e, 0, 2)),
    ("sigma_bias_accel_x_mps2", |e| sigma_bias(e, 1, 0)),
    ("sigma_bias_accel_y_mps2", |e| sigma_bias(e, 1, 1)),
    ("sigma_bias_accel_z_mps2", |e| sigma_bias(e, 1, 2)),
    ("hpl_m", |e| e.decision.and_then(|d| d.hpl_m).unwrap_or(f64::NAN)),
    ("vpl_m", |e| e.decision.and_then(|d| d.vpl_m).unwrap_or(f64::NAN)),
    // Whole numbers and codes; a double holds them exactly.
    ("n_sv", |e| f64::from(e.n_sv)),
    ("leg", |e| f64::from(e.leg)),
    ("phase", |e| f64::from(e.phase)),
    ("n_gated", |e| f64::from(e.n_gated)),
    ("nav_mode", |e| MODES.iter().position(|m| Some(*m) == e.mode).unwrap_or(MODES.len()) as f64),
    ("doubt", |e| match e.doubt {
        None => 0.0,
        Some(Doubt::Filters) => 1.0,
        Some(Doubt::Stations) => 2.0,
    }),
    ("decided", |e| e.decision.map_or(f64::NAN, |d| f64::from(d.status as u8))),
    ("source", |e| e.decision.map_or(f64::NAN, |d| f64::from(d.source as u8))),
    ("reasons", |e| e.decision.map_or(0.0, |d| f64::from(d.reasons.bits()))),
    ("leading", |e| e.decision.and_then(|d| d.leading()).map_or(-1.0, |r| f64::from(r as u8))),
    ("available", |e| f64::from(u8::from(e.reason.is_none()))),
];

fn innovation(epoch: &FlownEpoch, kind: usize) -> f64 {
    epoch.inside.and_then(|i| i.innovations[kind]).unwrap_or(f64::NAN)
}

fn bias(epoch: &FlownEpoch, sensor: usize, axis: usize) -> f64 {
    epoch.inside.and_then(|i| i.biases).map_or(f64::NAN, |b| b[sensor][axis])
}

fn sigma_bias(epoch: &FlownEpoch, sensor: usize, axis: usize) -> f64 {
    epoch.inside.and_then(|i| i.sigma_biases).map_or(f64::NAN, |b| b[sensor][axis])
}

/// Flights `first .. first + count` on all cores.
pub(crate) fn numbered<T: Send>(first: u64, count: u64, fly: impl Fn(u64) -> Result<T, OutOfDomain> + Sync) -> Result<Vec<T>, OutOfDomain> {
    let count = usize::try_from(first.saturating_add(count) - first).unwrap_or(usize::MAX);
    parallel::try_map(count, 1, |k| fly(first + k as u64))
}

impl Flights {
    /// Flights `first .. first + count`, each a function of scenario, seed and its number, whatever the threads.
    ///
    /// # Errors
    /// As [`fly`].
    pub fn fly(outlook: &Outlook, seed: u64, first: u64, count: u64) -> Result<Self, OutOfDomain> {
        Ok(Self { epochs: numbered(first, count, |number| fly(outlook, seed, number))?, first })
    }

    pub(crate) fn of(epochs: Vec<Vec<FlownEpoch>>, first: u64) -> Self {
        Self { epochs, first }
    }

    /// One column, all flights.
    pub fn column(&self, column: &Column) -> Vec<f64> {
        self.all().map(column.1).collect()
    }

    /// GPS time of every epoch \[ns\].
    pub fn time_ns(&self) -> Vec<i64> {
        self.all().map(|e| e.time_ns).collect()
    }

    /// Number of the flight that every epoch belongs to.
    pub fn number(&self) -> Vec<u32> {
        self.epochs.iter().zip(self.first..).flat_map(|(epochs, number)| core::iter::repeat_n(number as u32, epochs.len())).collect()
    }

    /// Why an estimate does not exist, for each epoch where it does not, in order.
    pub fn reasons(&self) -> Vec<String> {
        self.all().filter_map(|e| e.reason).map(|r| r.to_string()).collect()
    }

    /// The ids of these reasons.
    pub fn reason_ids(&self) -> Vec<&'static str> {
        self.all().filter_map(|e| e.reason).map(|r| r.reason_of_solution().id()).collect()
    }

    /// The epochs of the first flight.
    pub fn first_flight(&self) -> &[FlownEpoch] {
        self.epochs.first().map_or(&[], Vec::as_slice)
    }

    fn all(&self) -> impl Iterator<Item = &FlownEpoch> {
        self.epochs.iter().flatten()
    }
}
