//! What every fuzz target shares: a reader's time is linear in its input.

use cpu_time::ThreadTime;
use navbound_formats::packed::unpack;
use std::time::Duration;

/// What a call may take before its input counts. [s]
const BASE: Duration = Duration::from_millis(200);
/// What each byte may add: some hundred times what the slowest reader takes with the coverage counters and overflow checks of a fuzz
/// build, so that the sanitizer and a page fault fit. [s/B]
const EACH_BYTE: Duration = Duration::from_micros(20);

/// Do something with an input, within its budget of processor time; a packed input counts with what it unpacks to.
///
/// # Panics
/// Where it takes longer.
pub fn within_budget<R>(bytes: &[u8], work: impl FnOnce(&[u8]) -> R) -> R {
    let length = unpack(bytes).map_or(0, |plain| plain.len()).max(bytes.len());
    let allowed = BASE + EACH_BYTE * u32::try_from(length).expect("inputs are small");
    let begin = ThreadTime::now();
    let result = work(bytes);
    let taken = begin.elapsed();
    assert!(taken <= allowed, "{length} bytes took {taken:?}, more than the {allowed:?} that are allowed");
    result
}
