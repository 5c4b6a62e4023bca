//! Scenarios as the core takes them: no panic, and a plan that can be flown has a length and phases, or there is a refusal.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_fuzz::within_budget;
use navbound_simulate::{Plan, Scenario};

fuzz_target!(|bytes: &[u8]| {
    within_budget(bytes, |bytes| {
        let Ok(scenario) = serde_json::from_slice::<Scenario>(bytes) else { return };
        let Ok(plan) = Plan::new(&scenario) else { return };
        assert!(plan.length().m().is_finite() && plan.length().m() > 0.0);
        assert!(plan.cruise_speed_mps() > 0.0);
        assert!(!plan.phases().is_empty());
    });
});
