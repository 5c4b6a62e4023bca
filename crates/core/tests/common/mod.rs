//! What several tests of the judge share.
#![allow(clippy::unwrap_used, reason = "a helper of tests may stop at the first surprise, too")]

pub(crate) mod sky;

use navbound_core::bound::Alerting;
use navbound_core::judge::Settings;
use navbound_core::monitor::rnp::{Chain, Settings as MonitorSettings};
use navbound_core::monitor::state::StateTable;
use navbound_core::quantity::{Metres, Risk};

/// A judge of the exact bound with one epoch a second, no delay in the chain, and states of so many nautical miles.
pub(crate) fn settings(method: &str, states_nm: &[f64], raise_delay_s: f64, with_levels: bool) -> Settings {
    let chain = Chain {
        sample_period_s: 1.0,
        sensor_latency_s: 0.0,
        filter_s: 0.0,
        computing_s: 0.0,
        display_s: 0.0,
        time_to_alert_s: f64::INFINITY,
    };
    let levels: Vec<Metres> = states_nm.iter().map(|nm| Metres::new(1852.0 * nm)).collect();
    Settings {
        method: Alerting::of(method).unwrap(),
        accuracy: Risk::ACCURACY,
        integrity: Risk::new(1e-5).unwrap(),
        states: (!levels.is_empty()).then(|| StateTable::new(&levels).unwrap()),
        monitor: MonitorSettings { chain, raise_delay_s, clear_delay_s: 10.0, clear_ratio: 0.95, stale_after_s: 2.0 },
        with_levels,
    }
}
