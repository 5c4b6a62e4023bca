//! Files as they are kept: plain, or packed by gzip (RFC 1952), Unix compress (`.Z`) or zip.

mod compress;
mod zip;

use crate::refusal::Unreadable;
use flate2::bufread::MultiGzDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Largest plain size that is unpacked \[bytes\]: fifty times the largest daily file, and no bomb.
const LARGEST: u64 = 4 << 30;

/// Plain bytes per packed byte that are unpacked \[1\]: logs and tables pack to a third, repeated rows to a fiftieth, a bomb to a thousandth.
const LARGEST_RATIO: u64 = 200;

/// What is unpacked whatever its ratio \[bytes\]: small enough for every machine, and a short file of few different rows is no bomb.
const ALWAYS: u64 = 64 << 20;

/// How much a file may unpack to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limit {
    /// Plain bytes in all.
    pub total: u64,
    /// Plain bytes per packed byte, above 64 MiB.
    pub ratio: u64,
}

impl Default for Limit {
    fn default() -> Self {
        Self { total: LARGEST, ratio: LARGEST_RATIO }
    }
}

impl Limit {
    /// Plain bytes that a file of so many packed bytes may have.
    #[must_use]
    pub fn most(self, packed: usize) -> u64 {
        self.total.min(self.ratio.saturating_mul(packed as u64).max(ALWAYS))
    }
}

/// The plain bytes of a file, within the limit that stands without another.
///
/// # Errors
/// As [`unpack_within`].
pub fn unpack(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Unreadable> {
    unpack_within(bytes, Limit::default())
}

/// The plain bytes of a file.
///
/// # Errors
/// [`Unreadable`] for a damaged stream, one above the limit, an archive of several files, or another packing (bzip2, xz), which is named.
pub fn unpack_within(bytes: &[u8], limit: Limit) -> Result<Cow<'_, [u8]>, Unreadable> {
    let most = limit.most(bytes.len());
    match bytes {
        [0x1f, 0x8b, ..] => gunzip(bytes, most).map(Cow::Owned),
        [0x1f, 0x9d, stream @ ..] => {
            let damaged = |e| Unreadable::whole(format!("the compress (.Z) stream is damaged: {e}"));
            compress::unpack(stream, most).map(Cow::Owned).map_err(damaged)
        }
        [b'P', b'K', 3, 4, ..] | [b'P', b'K', 5, 6, ..] => {
            zip::unpack(bytes, most).map(Cow::Owned).map_err(|e| Unreadable::whole(format!("the zip archive cannot be read: {e}")))
        }
        [b'B', b'Z', b'h', ..] => Err(other("bzip2")),
        [0xfd, b'7', b'z', b'X', b'Z', ..] => Err(other("xz")),
        _ => Ok(Cow::Borrowed(bytes)),
    }
}

fn other(packing: &str) -> Unreadable {
    Unreadable::whole(format!("the file is packed by {packing}; unpack it, or pack it by gzip"))
}

fn gunzip(bytes: &[u8], most: u64) -> Result<Vec<u8>, Unreadable> {
    // The last four bytes hold the plain size modulo 2^32: a hint for the first allocation, never more than deflate can expand to.
    let stated = bytes.last_chunk::<4>().map_or(0, |b| u32::from_le_bytes(*b) as usize);
    let expected = (stated as u64).min(most).min(bytes.len() as u64 * 1032);
    let mut plain = Vec::new();
    plain.try_reserve(expected as usize).map_err(|_| too_large(bytes.len(), most))?;
    let damaged = |e: std::io::Error| Unreadable::whole(format!("the gzip stream is damaged: {e}"));
    MultiGzDecoder::new(bytes).take(most.saturating_add(1)).read_to_end(&mut plain).map_err(damaged)?;
    if plain.len() as u64 > most {
        return Err(too_large(bytes.len(), most));
    }
    Ok(plain)
}

fn too_large(packed: usize, most: u64) -> Unreadable {
    let (packed, most) = (packed as f64 / 1e6, most as f64 / 1e6);
    Unreadable::whole(format!("its {packed:.1} MB unpack to more than the {most:.0} MB that are allowed"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn gzip(plain: &[u8]) -> Vec<u8> {
        let mut e = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        e.write_all(plain).unwrap();
        e.finish().unwrap()
    }

    #[test]
    fn plain_files_pass_and_gzip_files_are_unpacked_member_by_member() {
        assert_eq!(&*unpack(b"plain").unwrap(), b"plain");
        let two = [gzip(b"first "), gzip(b"second")].concat();
        assert_eq!(&*unpack(&two).unwrap(), b"first second");
    }

    #[test]
    fn a_gzip_file_cut_short_or_changed_is_refused() {
        let whole = gzip(&[b'x'; 1000]);
        assert!(unpack(&whole[..whole.len() - 9]).unwrap_err().reason.contains("gzip"));
        let mut changed = whole.clone();
        let last = changed.len() - 6;
        changed[last] ^= 1;
        assert!(unpack(&changed).unwrap_err().reason.contains("damaged"));
    }

    #[test]
    fn a_file_above_the_limit_is_refused_and_one_at_the_limit_is_not() {
        let thousand = gzip(&[b'0'; 1000]);
        let within = |total| unpack_within(&thousand, Limit { total, ..Limit::default() });
        assert_eq!(within(1000).unwrap().len(), 1000);
        assert!(within(999).unwrap_err().reason.contains("are allowed"));
        // A few packed bytes may always unpack to 64 MiB, many to the ratio of them, and none to more than the total.
        let most = |packed| Limit { total: 1 << 30, ratio: 200 }.most(packed);
        assert_eq!([most(0), most(1 << 20), most(1 << 30)], [64 << 20, 200 << 20, 1 << 30]);
    }

    #[test]
    fn other_packings_are_named() {
        assert!(unpack(b"BZh9").unwrap_err().reason.contains("bzip2"));
    }
}
