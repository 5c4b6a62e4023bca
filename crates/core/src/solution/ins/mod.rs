//! Inertial navigation and its aiding: strapdown mechanization, error dynamics, closed-loop filter.
//!
//! - [`Strapdown`]: increments of angle and velocity become position, velocity and attitude.
//! - [`Filter`]: the same with fifteen error states and a further one for everything that stays wrong for a while: clock, constellations,
//!   barometer, stations, satellites.
//! - [`Fusion`]: one filter or several, in the form that [`Settings::form`] names, and the one without satellites beside them.
//! - [`Mode`], [`Innovations`]: what keeps the position now, and what the innovations say of the filter.
//!
//! Local axes point north, east and down and the equations hold the tangent of the latitude: within 0.1 degree of a pole a state is
//! refused, and no wander angle is carried.

mod after_gap;
mod against;
mod aid;
mod align;
mod biases;
mod covariance;
#[cfg(test)]
mod covariance_tests;
mod delay;
mod dynamics;
mod entry;
mod federated;
mod filter;
#[cfg(test)]
mod forms_tests;
mod fusion;
mod innovation;
mod jump;
mod loose;
mod measure;
mod mode;
mod sane;
mod settings;
mod slots;
mod state;
mod stations;
mod strapdown;
mod together;

pub use after_gap::Resumption;
pub use against::{Difference, is_sane, judgeable};
pub use aid::{Aided, Wheels};
pub use align::{COURSE_FROM_MPS, coarse};
pub use biases::BiasEstimate;
pub use entry::Refusal;
pub use filter::{Advance, Filter, STATE_AGE_MOST_S, Samples, Solution, Stop};
pub use fusion::{Beside, Fusion};
pub use innovation::{Innovations, Kind, MEMORY_S, PAIRS_LEAST};
pub use mode::Mode;
pub use settings::{ClockModel, ErrorModel, Form, GATE, ImuModel, Patience, SensorNoise, Settings, StartSigma};
pub use slots::Further;
pub use state::{Attitude, LATITUDE_MOST_RAD, NavState};
pub use strapdown::{PROVENANCE, SOURCE, Strapdown};
pub use together::{Block, Together};
