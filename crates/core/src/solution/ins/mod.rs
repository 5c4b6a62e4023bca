//! Inertial navigation and its aiding: strapdown mechanization, error dynamics, closed-loop filter.
//!
//! - [`Strapdown`]: increments of angle and velocity become position, velocity and attitude.
//! - [`Filter`]: the same with fifteen error states and a further one for everything that stays wrong for a while: clock, constellations,
//!   barometer, stations, satellites. Loose aiding is a [`crate::signal::Aiding::Fix`] to the same filter.
//! - [`Mode`], [`Innovations`]: what keeps the position now, and what the innovations say of the filter.
//!
//! Local axes point north, east and down and the equations hold the tangent of the latitude: within 0.1 degree of a pole a state is
//! refused, and no wander angle is carried.

mod aid;
mod align;
mod covariance;
#[cfg(test)]
mod covariance_tests;
mod dynamics;
mod filter;
mod innovation;
mod measure;
mod mode;
mod sane;
mod settings;
mod slots;
mod state;
mod strapdown;

pub use aid::{Aided, Wheels};
pub use align::{COURSE_FROM_MPS, coarse};
pub use filter::{Advance, Filter, Samples, Solution, Stop};
pub use innovation::{Innovations, Kind};
pub use mode::Mode;
pub use settings::{ClockModel, ErrorModel, GATE, ImuModel, Patience, SensorNoise, Settings, StartSigma};
pub use slots::Further;
pub use state::{Attitude, LATITUDE_MOST_RAD, NavState};
pub use strapdown::{PROVENANCE, SOURCE, Strapdown};
