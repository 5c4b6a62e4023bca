//! The vertical of an approach: the error budget of RNP AR, what an aircraft has to meet, and the error off a descending path.

mod budget;
mod off_path;

pub use budget::{Approach, Budget, Constants, FEET, METRES, requirement, turn_geometry};
pub use off_path::{off_path_sigma, risk_below};
