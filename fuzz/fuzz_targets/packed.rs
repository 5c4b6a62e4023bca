//! Gzip streams: no panic, and no more memory than the input can expand to.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::packed::unpack;

fuzz_target!(|bytes: &[u8]| {
    let _ = unpack(bytes);
});
