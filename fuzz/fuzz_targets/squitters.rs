//! Messages of Mode S: no panic, the same frames however they arrive, and every place that two halves make is one on Earth. The parity is made
//! right, so that what stands behind it is reached.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::mode_s::{self, Content, Cpr, LONG};
use navbound_formats::stream::{Beast, Frame, Framer, Protocol, beast};
use navbound_fuzz::within_budget;

fuzz_target!(|bytes: &[u8]| {
    let whole = within_budget(bytes, |bytes| messages(bytes, bytes.len().max(1)));
    assert_eq!(messages(bytes, 1), whole);
    mode_s::of_line(bytes);
    let mut last: Option<Cpr> = None;
    for message in bytes.chunks_exact(LONG) {
        let mut message: [u8; LONG] = message.try_into().unwrap_or_default();
        mode_s::with_parity(&mut message);
        let framed = beast::frame(&Beast { counter: [0; 6], message, length: LONG });
        assert_eq!(messages(&framed, 1), [message.to_vec()]);
        let Some(squitter) = mode_s::squitter(&message).expect("the parity is right") else { continue };
        let Content::Airborne { cpr, .. } = squitter.content else { continue };
        if let Some(fix) = last.replace(cpr).and_then(|last| cpr.with(last)) {
            assert!(fix.lat_deg.abs() <= 90.0 && (-180.0..180.0).contains(&fix.lon_deg), "{fix:?}");
        }
    }
});

/// Messages of a stream that arrives so many bytes at a time.
fn messages(bytes: &[u8], length: usize) -> Vec<Vec<u8>> {
    let (mut framer, mut found) = (Framer::new(Protocol::Beast), Vec::new());
    let mut take = |frame: Result<Frame<'_>, _>| {
        if let Ok(Frame::Beast(beast)) = frame {
            found.push(beast.message().to_vec());
        }
    };
    bytes.chunks(length).for_each(|piece| framer.push(piece, &mut take));
    framer.flush(&mut take);
    found
}
