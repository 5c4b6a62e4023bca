//! Scenario and seed to truth and estimate: a simulator is a reader that also knows the truth.
//!
//! A [`Scenario`] becomes an [`Outlook`] once (route, heights and speeds, satellite geometry: the same for every flight), and [`fly`] turns
//! that into a flight for each number. Random numbers are counted, not drawn in turn: a flight depends on scenario, seed and number only.

mod aircraft;
mod flight;
mod outlook;
mod philox;
mod plan;
mod profile;
mod ranging;
mod scenario;

pub use flight::{FlownEpoch, fly};
pub use outlook::Outlook;
pub use plan::{PhaseRange, Plan, Refused};
pub use scenario::{Fault, Guidance, Gusts, Navigation, Phase, ProfileSettings, Scenario, System, Turns, Waypoint};
