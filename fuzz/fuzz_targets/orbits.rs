//! SP3: no panic, and a state at every instant or a refusal.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::sp3::read;
use navbound_fuzz::within_budget;

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut p) = within_budget(bytes, read) else { return };
    p.merge(p.clone());
    let tables = p.tables();
    for (satellite, nodes) in &p.orbits {
        for node in nodes {
            let _ = tables.state(*satellite, node.time.plus_seconds(0.5));
        }
    }
});
