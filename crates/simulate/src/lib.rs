//! Scenario and seed to truth and estimate: a simulator is a reader that also knows the truth.
//!
//! A [`Scenario`] becomes an [`Outlook`] once (route, heights and speeds, satellite geometry: the same for every flight), and [`fly`] turns
//! that into a flight for each number. A scenario with sensors becomes a [`Sensing`], whose [`SensedFlight`] delivers what an inertial unit,
//! receivers and an altimeter would: records of `navbound_core::signal`. A [`Taxi`] becomes a [`Driven`] route on the ground, and a
//! [`GroundFlight`] draws the errors of each number on it. Random numbers are counted, not drawn in turn: a flight depends on scenario, seed and number only.

mod aircraft;
mod flight;
mod ground;
mod navigator;
mod outlook;
mod philox;
mod plan;
mod profile;
mod ranging;
mod scenario;
mod sensors;
mod station;
mod trajectory;

pub use flight::{Doubt, FlownEpoch, Inside, Navigated, fly, fly_by};
pub use ground::{Driven, GroundFlight, RangeFault, RouteMotion, RoutePoint, Taxi, TaxiNavigation};
pub use navigator::{BelievedErrors, Coupling, Navigator};
pub use outlook::Outlook;
pub use philox::ERROR_FREE;
pub use plan::{PhaseRange, Plan, Refused};
pub use scenario::{Fault, Guidance, Gusts, Navigation, Phase, ProfileSettings, Scenario, System, Turns, Waypoint};
pub use sensors::{
    Baro, Coverage, Dme, Envelope, Gnss, Imu, PathFlown, RangeMode, RangeParts, ReceiverFault, SensedFlight, Sensing, SensorFault, Sensors,
    Station, StationKind, Step, Trouble, Vor,
};
pub use station::{Heard, IONOSPHERE, Measured, RawEpoch, RawStation, WrongRange, broadcast, carriers, hear};
pub use trajectory::{Cursor, Motion, Trajectory};
