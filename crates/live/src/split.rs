//! Lines and messages of many aircraft to lanes: the lane of a track is a hash of its name, so that a track has one lane for the life of a fleet.

use crate::decode::{Format, track_of};
use navbound_formats::stream::{Frame, Framer, beast};

/// FNV-1a of 64 bits (Fowler, Noll, Vo).
fn hash(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// Parts the lines or messages of a source by lane. Between two pieces it keeps an unfinished one.
#[derive(Debug, Clone)]
pub struct Splitter {
    format: Format,
    n_lanes: usize,
    framer: Framer,
}

impl Splitter {
    /// Of a format to a number of lanes.
    pub fn new(format: Format, n_lanes: usize) -> Self {
        Self { format, n_lanes: n_lanes.max(1), framer: Framer::new(format.protocol()) }
    }

    /// Whole lines or frames of the next bytes, by lane. What names no track, and a line that is too long, goes to the first lane, which
    /// counts it.
    pub fn push(&mut self, bytes: &[u8]) -> Vec<Vec<u8>> {
        let mut lanes = vec![Vec::new(); self.n_lanes];
        let (format, n_lanes) = (self.format, self.n_lanes as u64);
        self.framer.push(bytes, &mut |frame| {
            let place = frame.ok().and_then(|frame| track_of(format, &frame)).map_or(0, |track| (hash(track.name()) % n_lanes) as usize);
            let Some(lane) = lanes.get_mut(place) else { return };
            match (frame, format) {
                (Ok(Frame::Line(line)), _) => lane.extend(line.iter().chain(b"\n")),
                (Ok(Frame::Beast(message)), _) => lane.extend(beast::frame(&message)),
                // A frame that the lane cannot read either stands for the one that was damaged.
                (Err(_), Format::Beast) => lane.extend(beast::DAMAGED),
                (Err(_), _) => lane.extend(b"?\n"),
                (Ok(_), _) => {}
            }
        });
        lanes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_published_one() {
        // Test vectors of the authors' page: of nothing, "a" and "foobar".
        assert_eq!((hash(""), hash("a"), hash("foobar")), (0xcbf2_9ce4_8422_2325, 0xaf63_dc4c_8601_ec8c, 0x8594_4171_f739_67e8));
    }

    #[test]
    fn any_cutting_gives_the_same_lines_to_the_same_lanes() {
        let text: String = (0..200).map(|k| format!("{{\"v\":1,\"track\":\"{:06x}\",\"time_ns\":{k}}}\n", k % 20)).collect();
        let bytes = format!("{text}no line\n");
        let whole = Splitter::new(Format::Json, 4).push(bytes.as_bytes());
        for cut in [1, 7, 100] {
            let (mut splitter, mut lanes) = (Splitter::new(Format::Json, 4), vec![Vec::new(); 4]);
            for piece in bytes.as_bytes().chunks(cut) {
                lanes.iter_mut().zip(splitter.push(piece)).for_each(|(lane, more)| lane.extend(more));
            }
            assert_eq!(lanes, whole);
        }
        assert_eq!(whole.iter().map(Vec::len).sum::<usize>(), bytes.len());
        assert!(whole.iter().all(|lane| !lane.is_empty()) && whole[0].ends_with(b"no line\n"));
    }
}
