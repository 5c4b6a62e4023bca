//! Gzip streams: no panic, and no more memory than the input can expand to.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::packed::unpack;
use navbound_fuzz::within_budget;

fuzz_target!(|bytes: &[u8]| {
    let _ = within_budget(bytes, |bytes| unpack(bytes).map(|plain| plain.len()));
});
