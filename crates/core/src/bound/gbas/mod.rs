//! GBAS: from error models to protection levels and to what ground monitors must detect.
//!
//! In the order of the flow: [`range`] (errors of one range), [`snapshot`] (weighted solution), [`bias`] (worst effect of nominal
//! biases), [`levels`] (no fault, one faulty reference receiver), [`detection`] (missed-detection limit), [`noise`] (smoothed multipath of
//! unknown time constant), [`aided`] (the covariance with an inertial system), [`offset`] (whether a model of that noise bounds).

pub mod aided;
pub mod bias;
pub mod detection;
pub mod levels;
pub mod noise;
pub mod offset;
pub mod range;
pub mod snapshot;

/// Document of the system; our copy has no equations, tables or figures.
pub const SOURCE: &str = "Song, Milner and No 2024, NAVIGATION 71(4), navi.673, rebuilt: equations 2 to 10 after RTCA DO-245A and DO-253";

/// Most satellites in one solution.
pub const MOST_SATELLITES: usize = 48;
